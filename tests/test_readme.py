"""What the README says is so: its code runs and prints what it shows, its links lead somewhere."""

import re
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import manutec_r3 as r3

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CI = ROOT / ".ci" / "run"


def blocks():
    """Code and what it prints, in the order of the page."""
    return re.findall(r"^```python\n(.*?)^```$.*?^```text\n(.*?)^```$", README, re.M | re.S)


def test_the_code_prints_what_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where it writes files
    assert len(blocks()) == README.count("```python") == README.count("```text") > 0
    names = {}  # later blocks go on where earlier ones end
    for number, (code, shown) in enumerate(blocks(), start=1):
        said = StringIO()
        with redirect_stdout(said):
            exec(compile(code, f"README.md, block {number}", "exec"), names)
        assert said.getvalue() == shown


def commands():
    """The two commands of the first screen: to run the main job, to pass the tests."""
    return re.findall(r"^    (pip install .*)$", README, re.M)


@pytest.mark.skipif(not CI.exists(), reason="a source distribution has no .ci")
def test_the_command_that_passes_the_tests_is_the_one_that_is_run():
    assert commands()[1] == CI.read_text(encoding="utf-8").splitlines()[-1]


def test_the_command_that_runs_the_main_job_names_what_there_is():
    extra, scenario = re.fullmatch(
        r'pip install "\.\[(\w+)\]" && manutec-r3 run ([\w-]+)', commands()[0]
    ).groups()
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert re.search(rf"^{extra} = \[", project, re.M)
    assert scenario in r3.scenarios()


def test_the_table_of_models_is_right():
    rows = re.findall(r"^\| (\S+) \| (\d) \| .* \| (\d+) \| (\d+) \|$", README, re.M)
    models = [1, 2, 3, 4, "full-robot", "one-axis"]
    assert [row[0] for row in rows] == list(map(str, models))
    for model, (_, *numbers) in zip(models, rows, strict=True):
        robot = r3.Robot(model=model)
        assert list(map(int, numbers)) == [robot.n_axes, robot.n_states, robot.n_indicators]


def test_default_tolerances_are_right():
    for method in ("exponential", "erk", "bdf"):
        (said,) = re.findall(rf'(\S+) for `"{method}"`', README)
        sim = r3.Simulator(r3.Robot(model=2), r3.Hold([0, 0, 0]), method=method)
        assert sim.rtol == float(said)


def test_links_and_commands_lead_to_files_that_exist():
    links = re.findall(r"\]\(([^)#]+)\)", README)
    tests = re.findall(r"\btests/\w+\.py\b", README)
    assert len(links) > 5
    assert len(tests) > 5
    for path in {*links, *tests}:
        assert (ROOT / path).exists(), path


def test_pictures_are_light_enough_to_load():
    pictures = [ROOT / path for path in re.findall(r"!\[[^]]+\]\(([^)]+)\)", README)]
    assert len(pictures) == 3
    assert sum(path.stat().st_size for path in pictures) < 500_000


def test_versions_are_those_of_the_build():
    sundials = (ROOT / "cpp/cmake/sundials.cmake").read_text(encoding="utf-8")
    wheel = (ROOT / "cpp/cmake/sundials.txt").read_text(encoding="utf-8")
    oldest = re.search(r"find_package\(SUNDIALS (\d+\.\d+)", sundials)[1]
    fetched = re.search(r"^sundials4py==(\d+\.\d+)", wheel, re.M)[1]
    assert f"SUNDIALS {oldest} or later" in README
    assert f"SUNDIALS {fetched} as the wheel" in README
    assert "## 0.1.0" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
