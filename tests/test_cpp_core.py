"""The C++ core, built without Python and tested by the programs in ``tests/cpp``.

Each ``TEST`` in a C++ source is a test case here, and so is the program ``figure9``.
"""

import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

SOURCE = Path(__file__).parents[1]

# The names stand in the sources, where CMake reads them, too: they are known before anything is
# built.
NAMES = [
    f"{source.stem}.{name}"
    for source in sorted((SOURCE / "tests" / "cpp").glob("*.cpp"))
    for name in re.findall(r"^TEST\((\w+)\)", source.read_text(encoding="utf-8"), re.MULTILINE)
] + ["figure9"]


def _tool(name):
    """Full path of cmake or ctest, of the test extra if it is installed."""
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    assert found, f"{name} is missing: pip install '.[test]'"
    return found


def _run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Configure, build and run; what each test said, by its name."""
    build = tmp_path_factory.mktemp("cpp_core")
    report = build / "report.xml"
    _run(
        *(_tool("cmake"), "-S", SOURCE, "-B", build, "-G", "Ninja"),
        f"-DCMAKE_MAKE_PROGRAM={_tool('ninja')}",
        f"-DPython_EXECUTABLE={sys.executable}",
        *("-DMANUTEC_R3_PYTHON=OFF", "-DMANUTEC_R3_TESTS=ON"),
        "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON",
    )
    _run(_tool("cmake"), "--build", build)
    # The report tells which tests fail.
    subprocess.run(
        [_tool("ctest"), "--test-dir", build, "--output-junit", report, "--parallel", "2"],
        capture_output=True,
    )
    return {case.get("name"): case for case in ElementTree.parse(report).iter("testcase")}


def test_every_cpp_test_is_known(results):
    assert sorted(results) == sorted(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_cpp(results, name):
    case = results[name]
    assert case.get("status") == "run", case.findtext("system-out")
