"""The C++ core, built without Python and tested by programs of its own, under sanitizers.

Each ``TEST`` in ``tests/cpp`` is a test case here, and so is the program ``figure9``. So is each
``TEST`` in ``tests/fmu``, an importer in C, with every FMU that is exported for it.
"""

import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from math import prod
from pathlib import Path
from zipfile import ZipFile

import pytest

import manutec_r3 as r3
from manutec_r3.export import export_fmu

SOURCE = Path(__file__).parents[1]


def _names(sources):
    """Names of tests by file, known before anything is built: CMake reads them there, too."""
    return [
        (source.stem, name)
        for source in sorted((SOURCE / "tests").glob(sources))
        for name in re.findall(r"^TEST\((\w+)\)", source.read_text(encoding="utf-8"), re.MULTILINE)
    ]


NAMES = [f"{subject}.{name}" for subject, name in _names("cpp/*.cpp")] + ["figure9"]


def _tool(name):
    """Full path of cmake or ctest, of the test extra if it is installed."""
    found = shutil.which(name, path=str(Path(sys.executable).parent)) or shutil.which(name)
    assert found, f"{name} is missing: pip install '.[test]'"
    return found


def _run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}"


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    """Configure and build."""
    build = tmp_path_factory.mktemp("cpp_core")
    _run(
        *(_tool("cmake"), "-S", SOURCE, "-B", build, "-G", "Ninja"),
        f"-DCMAKE_MAKE_PROGRAM={_tool('ninja')}",
        f"-DPython_EXECUTABLE={sys.executable}",
        *("-DMANUTEC_R3_PYTHON=OFF", "-DMANUTEC_R3_TESTS=ON", "-DMANUTEC_R3_SANITIZERS=ON"),
        "-DCMAKE_COMPILE_WARNING_AS_ERROR=ON",
    )
    _run(_tool("cmake"), "--build", build)
    return build


@pytest.fixture(scope="module")
def results(build):
    """What each test of the core said, by its name."""
    report = build / "report.xml"
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


# --- the importer -------------------------------------------------------------------------------

ROBOTS = ("gears", "sampled", "ideal")
FMUS = [f"{robot}-{fmi}" for robot in ROBOTS for fmi in ("2.0", "3.0")]
IMPORTED = [
    (name, fmu)
    for subject, name in _names("fmu/*.c")
    for fmu in FMUS
    if not subject.startswith("fmi") or subject[-1] == fmu[-3]
]


def _export(robot, fmi, path):
    """Real gears that follow a motion, a sampled controller that follows inputs, no controller."""
    if robot == "gears":
        export_fmu("figure9-quintic", path, fmi=fmi)
    elif robot == "sampled":
        export_fmu("sampled-control", path, fmi=fmi, reference="input")
    else:
        falling = r3.Hold([0.0, 0.8, 0.4, 0.3, 0.5, 0.0])
        falls = r3.Scenario("falls", r3.Robot(model=1, controller=None), falling, 1.0)
        export_fmu(falls, path, fmi=fmi)


def _write_variables(folder, sampling_time):
    """Write what the importer has to know of the model description: arrays in one piece."""
    description = ElementTree.parse(folder / "modelDescription.xml").getroot()
    version = description.get("fmiVersion")[0]
    token = description.get("guid") or description.get("instantiationToken")
    lines = [f"{version} {token} {sampling_time}"]
    variables = {}
    for variable in description.find("ModelVariables"):
        name = re.sub(r"\[[\d,]+\]", "", variable.get("name"))
        size = prod(int(extent.get("start")) for extent in variable.iter("Dimension"))
        tag = variable[0].tag if version == "2" else variable.tag
        if tag == "Clock":
            continue
        kind = "integer" if tag in ("Integer", "Int32") else "real"
        first = variables.setdefault(name, [variable.get("valueReference"), 0, kind])
        first[1] += size
    lines += [f"{name} {first} {size} {kind}" for name, (first, size, kind) in variables.items()]
    (folder / "variables.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """Folders of exported FMUs, unpacked, by their names."""
    folders = {}
    for robot in ROBOTS:
        for fmi in ("2.0", "3.0"):
            folder = tmp_path_factory.mktemp(f"{robot}-{fmi[0]}")
            archive = folder.with_suffix(".fmu")
            _export(robot, fmi, archive)
            ZipFile(archive).extractall(folder)
            _write_variables(folder, 8e-3 if robot == "sampled" else 0.0)
            folders[f"{robot}-{fmi}"] = folder
    return folders


@pytest.fixture(scope="module")
def locales(tmp_path_factory):
    """Where the importer finds a locale with a decimal comma, if the machine can make one."""
    folder = tmp_path_factory.mktemp("locales")
    if localedef := shutil.which("localedef"):
        subprocess.run(
            [localedef, "-i", "de_DE", "-f", "UTF-8", folder / "de_DE.UTF-8"], capture_output=True
        )
    return folder


@pytest.mark.parametrize(("name", "fmu"), IMPORTED)
def test_fmu_is_imported(build, fmus, locales, name, fmu):
    another = FMUS[FMUS.index(fmu) - 2]
    run = subprocess.run(
        [
            build / "tests" / "fmu" / "fmu_importer",
            next((build / "cpp" / "fmi").glob("manutec_r3.*")),
            *(fmus[fmu], fmus[another], name),
        ],
        env=os.environ | ({"LOCPATH": str(locales)} if any(locales.iterdir()) else {}),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=60,
    )
    if run.returncode == 77:
        pytest.skip(run.stdout.strip())
    assert run.returncode == 0, run.stdout
