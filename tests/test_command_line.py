"""The command `manutec-r3`: what it prints, what it writes, how it ends."""

import csv
import json
import re
import signal
import sys
from importlib.metadata import version
from time import sleep

import numpy as np
import pytest
from child import child
from typer.testing import CliRunner

import manutec_r3 as r3
from manutec_r3.command_line import app

SHORT = """
t_end = 0.02
[robot]
model = 4
[motion]
type = "hold"
angles = [0.1, 0.2, 0.3]
"""


@pytest.fixture
def command(tmp_path, monkeypatch):
    """Runs the command in an empty folder, in which `short.toml` is a quick scenario."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short.toml").write_text(SHORT)
    return lambda *arguments: CliRunner().invoke(app, [str(a) for a in arguments])


def one_line(stderr):
    """The message, of which there is only one, without a traceback."""
    (line,) = stderr.splitlines()
    return line


def test_run_prints_the_peaks_of_figure_9(command):
    done = command("run", "figure9-quintic")
    assert done.exit_code == 0
    rows = re.findall(r"^ +(\d) +(\S+) to (\S+) +(\S+) +(\S+) *$", done.stdout, re.MULTILINE)
    assert [int(row[0]) for row in rows] == [1, 2, 3, 4, 5, 6]
    # two independent implementations of the model print these digits
    assert [row[3] for row in rows] == ["8.09", "10.06", "6.89", "1.46", "2.07", "1.27"]
    assert [row[4] for row in rows] == ["2.81", "5.43", "7.04", "0.28", "1.20", "0.17"]
    assert "60: 26 dead zone, 20 friction, 13 backlash, 1 reference" in done.stdout
    assert "All axes stay within the published ranges." in done.stdout
    assert "times as fast as real time" in done.stdout
    assert done.stderr == ""  # no progress bar where nobody watches


def test_run_writes_what_it_lists(command, tmp_path):
    done = command("run", "figure9-quintic")
    listed = re.findall(r"^wrote (.+)$", done.stdout, re.MULTILINE)
    written = {str(path.relative_to(tmp_path)) for path in tmp_path.glob("figure9-quintic/*")}
    assert set(listed) == written
    assert {path.name for path in tmp_path.glob("figure9-quintic/*")} == {
        "result.npz",
        "events.csv",
        "figure9-quintic.png",
    }


def test_the_archive_holds_the_whole_run_without_pickles(command, tmp_path):
    command("run", "short.toml", "--rtol", "1e-6")
    result = r3.Scenario.load("short.toml").run(rtol=1e-6)  # a repeated run is bit-identical
    with np.load(tmp_path / "short/result.npz", allow_pickle=False) as archive:
        for signal in ("time", *result.signals[:-1]):
            np.testing.assert_array_equal(archive[signal], getattr(result, signal))
        np.testing.assert_array_equal(archive["states"], result.state)
        for element, branches in result.branches.items():
            np.testing.assert_array_equal(archive[f"branches_{element}"], branches)
        for column in ("time", "axis", "element", "before", "after"):
            events = getattr(result.events, column)
            np.testing.assert_array_equal(archive[f"event_{column}"], events)
        assert archive["event_element"].dtype.kind == "U"
        assert tuple(archive["state"]) == tuple(result.robot.state_names)
        assert tuple(archive["state_unit"]) == tuple(result.robot.state_units)
        assert archive["scenario"] == SHORT
        assert archive["method"] == "erk"
        assert float(archive["rtol"]) == 1e-6
        assert archive["version"] == version("manutec-r3")


def test_the_events_are_written_to_the_last_digit(command, tmp_path):
    command("run", "figure9-quintic")
    result = r3.Scenario.load("figure9-quintic").run()  # a repeated run is bit-identical
    with open(tmp_path / "figure9-quintic/events.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["time [s]", "axis", "element", "before", "after"]
    assert [(float(t), int(i), e, int(b), int(a)) for t, i, e, b, a in rows] == [
        (e.time, e.axis, e.element, e.before, e.after) for e in result.events
    ]


def test_options_choose_tolerance_method_and_folder(command, tmp_path):
    done = command("run", "short.toml", "--rtol", "1e-5", "--method", "bdf", "--output", "a/b")
    assert done.exit_code == 0
    assert "(bdf, rtol 1e-05)" in done.stdout
    assert {p.name for p in tmp_path.glob("a/b/*")} == {"result.npz", "events.csv", "short.png"}


def test_a_signal_outside_its_published_range_is_named(command, tmp_path):
    (tmp_path / "tight.toml").write_text(SHORT + "[published]\njoint_angle = [0.15, 1.0]\n")
    done = command("run", "tight.toml")
    assert done.exit_code == 0
    assert "Outside the published range: joint angle of axis 1." in done.stdout


def test_excesses_of_limits_are_a_table_and_sustained_saturation_is_a_warning(
    command, tmp_path, monkeypatch
):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)  # the picture takes its time
    fast = command("show", "figure9-quintic").stdout.replace("duration = 1.2", "duration = 0.8")
    (tmp_path / "fast.toml").write_text(fast)
    printed = {name: command("run", name).stdout for name in ("figure9-quintic", "fast.toml")}

    def rows(text):
        found = re.findall(r"^ +(\d)   ([a-z]+(?: [a-z]+)?)  +(\d\S* .*)$", text, re.MULTILINE)
        return [(int(axis), what, *re.split(" {2,}", row.rstrip())) for axis, what, row in found]

    assert rows(printed["figure9-quintic"]) == [
        (2, "rotor rate", "315 rad/s", "334 rad/s", "0.502 to 0.704", "1"),
        (3, "nominal torque", "4 N m", "4.7 N m", "0.929 to 1.500", "1"),
    ]
    assert "Sustained saturation" not in printed["figure9-quintic"]
    assert rows(printed["fast.toml"])[-1] == (
        *(3, "saturation", "0.05 s"),
        *("0.639 s", "0.159 to 0.281", "4"),  # the longest, when the first was, how many
    )
    warning = "Sustained saturation winds up the rate controllers: axis 3."
    assert warning in printed["fast.toml"]


def test_run_writes_the_modelica_variant(command, tmp_path):
    done = command("run", "one-axis")
    assert done.exit_code == 0
    assert "9: 6 friction, 3 reference" in done.stdout
    with np.load(tmp_path / "one-axis/result.npz") as archive:
        assert archive["joint_angle"].shape == (len(archive["time"]), 1)
        assert set(archive["event_element"]) == {"friction", "reference"}
    assert (tmp_path / "one-axis/one-axis.png").exists()


LIMITED = """
t_end = 0.1
[robot]
model = 4
controller = "sampled"
voltage_limit = 0.4
[motion]
type = "quintic"
start = [0, 0, 0]
end = [0.1, 0.1, 0.1]
duration = 0.2
"""
DRIVEN = """
t_end = 0.02
[robot]
model = 3
controller = "none"
[inputs]
motor_torque = [1, 0, 0, 0, 0, 0]
"""


def test_run_writes_limited_voltages_and_counts_samples(command, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)  # the picture takes its time
    (tmp_path / "limited.toml").write_text(LIMITED)
    done = command("run", "limited.toml")
    assert done.exit_code == 0
    assert re.search(r"^samples +12, \S+ evaluations each *$", done.stdout, re.MULTILINE)
    result = r3.Scenario.load("limited.toml").run()
    with np.load(tmp_path / "limited/result.npz") as archive:
        np.testing.assert_array_equal(
            archive["branches_voltage_limit"], result.branches["voltage_limit"]
        )
        assert archive["branches_voltage_limit"].any()
        assert "voltage_limit" in archive["event_element"]


def test_run_goes_without_a_motion(command, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    (tmp_path / "driven.toml").write_text(DRIVEN)
    done = command("run", "driven.toml")
    assert done.exit_code == 0
    assert "nan" not in done.stdout
    assert re.search(r"^ +1 +\S+ to \S+ +- +1\.00 *$", done.stdout, re.MULTILINE)
    with np.load(tmp_path / "driven/result.npz") as archive:
        assert np.isnan(archive["control_error"]).all()
        np.testing.assert_array_equal(archive["motor_torque"][:, 0], 1.0)


def test_nothing_is_said_of_limits_that_are_kept(command):
    assert "exceeded" not in command("run", "short.toml").stdout


def test_without_matplotlib_the_rest_is_written(command, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    done = command("run", "short.toml")
    assert done.exit_code == 0
    assert 'pip install "manutec-r3[plot]"' in done.stdout
    assert {p.name for p in tmp_path.glob("short/*")} == {"result.npz", "events.csv"}


def test_a_failed_simulation_writes_what_was_computed(command, tmp_path):
    (tmp_path / "wild.toml").write_text(f"start = {[0.0] * 3 + [1e100] * 3 + [0.0] * 30}\n{SHORT}")
    done = command("run", "wild.toml")
    assert done.exit_code == 1
    assert "the simulation ended at t = 0 s" in one_line(done.stderr)
    with np.load(tmp_path / "wild/result.npz") as archive:
        np.testing.assert_array_equal(archive["joint_rate"], [[1e100] * 3])


def test_a_simulation_that_fails_on_its_way_is_written_until_then(command, tmp_path):
    # Axis 2 at 10^8 rad/s throws the light axis 3 back and forth ever faster.
    (tmp_path / "wild.toml").write_text(f"start = {[0.0] * 4 + [1e8] + [0.0] * 31}\n{SHORT}")
    done = command("run", "wild.toml")
    assert done.exit_code == 1
    assert re.search(
        "ended at t = .* s: chattering: friction of axis 3 .*; the folder holds",
        one_line(done.stderr),
    )
    with pytest.raises(r3.SimulationError) as failed:
        r3.Scenario.load("wild.toml").run()
    until_then = failed.value.result
    assert 0.0 < until_then.time[-1] < 0.02
    with np.load(tmp_path / "wild/result.npz") as archive:
        np.testing.assert_array_equal(archive["time"], until_then.time)
        np.testing.assert_array_equal(archive["joint_angle"], until_then.joint_angle)
        assert len(archive["event_time"]) == len(until_then.events) > 0


def test_a_simulation_that_cannot_begin_is_one_line(command, tmp_path):
    six_axes = SHORT.replace("model = 4", "model = 3").replace("0.3]", "0.3, 0, 0, 0]")
    start = [0.0] * 11 + [1e300] + [0.0] * 54
    (tmp_path / "wild.toml").write_text(f"start = {start}\n{six_axes}")
    done = command("run", "wild.toml")
    assert done.exit_code == 1
    assert "the simulation ended at t = 0 s" in one_line(done.stderr)
    assert not (tmp_path / "wild").exists()


def test_an_interrupted_run_keeps_what_was_computed(tmp_path):
    # At rest for a thousand seconds: nobody waits for the end of it.
    text = SHORT.replace("0.02", "1e6").replace("[motion]", 'controller = "sampled"\n[motion]')
    (tmp_path / "long.toml").write_text(text)
    program = [sys.executable, "-m", "manutec_r3", "run", "long.toml"]
    for seconds in (1.5, 5.0, 30.0):  # until it has begun, on a machine that is busy
        with child(*program, cwd=tmp_path) as running:
            sleep(seconds)
            running.send_signal(signal.SIGINT)
            _, said = running.communicate(timeout=60)
        if "simulation" in said:
            break
    assert running.returncode == 130
    assert "the simulation was interrupted at t = " in one_line(said)
    result = r3.Result.load(tmp_path / "long/result.npz")
    assert 0.0 < result.time[-1] < 1e6
    assert result.status.startswith("interrupted at ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["run", "figur9"], "did you mean 'figure9'"),
        (["show", "figur9"], "did you mean 'figure9'"),
        (["run", "none.toml"], "none.toml: "),
        (["run", "wrong.toml"], "wrong.toml: t_end is missing"),
        (["run", "short.toml", "--rtol", "-1"], "rtol"),
        (["run", "short.toml", "--output", "short.toml"], "short.toml: "),
        (["plot", "none.npz"], "none.npz: "),
        (["plot", "short.toml", "--axis", "2"], "axis: expected none for figure9, got 2"),
        (["plot", "short.toml", "--kind", "phase", "--axis", "7"], "axis: expected "),
        (["plot", "short.toml", "--output", "none/a.png"], "none/a.png: "),
        (["animate", "short.toml", "--magnify", "nan"], "magnify: expected "),
        (["compare", "short.toml", "none.csv"], "none.csv: "),
        (["compare", "short.toml", "short.toml", "--width", "-1"], "width: expected "),
    ],
)
def test_a_mistake_is_one_line_and_exit_code_2(command, tmp_path, arguments, message):
    (tmp_path / "wrong.toml").write_text(SHORT.replace("t_end = 0.02", ""))
    done = command(*arguments)
    assert done.exit_code == 2
    assert message in one_line(done.stderr)


@pytest.mark.parametrize(
    "arguments",
    [["run"], ["fly"], ["run", "figure9-quintic", "--method", "euler"], ["list", "--all"]],
)
def test_wrong_usage_is_exit_code_2(command, arguments):
    assert command(*arguments).exit_code == 2


def test_list_describes_every_scenario(command):
    words = " ".join(command("list").stdout.split())
    for name in r3.scenarios():
        assert f"{name} {r3.Scenario.load(name).description}" in words


def test_what_show_prints_is_a_scenario(command, tmp_path):
    (tmp_path / "mine.toml").write_text(command("show", "figure9-quintic").stdout)
    assert r3.Scenario.load("mine.toml").source == r3.Scenario.load("figure9-quintic").source


# --- what machines read -------------------------------------------------------------------------


def test_run_tells_machines_the_same(command):
    done = command("run", "figure9-quintic", "--json")
    said = json.loads(done.stdout)
    result = r3.Scenario.load("figure9-quintic").run()
    assert said["status"] == "completed"
    assert said["events"] == {"dead_zone": 26, "friction": 20, "backlash": 13, "reference": 1}
    highest = result.joint_angle.max(axis=0).tolist()
    assert said["signals"]["joint_angle"]["highest"] == highest
    assert said["statistics"]["steps"] == result.statistics.steps
    assert [excess["axis"] for excess in said["limits"]] == [e.axis for e in result.limits]
    assert said["files"] == [
        "figure9-quintic/result.npz",
        "figure9-quintic/events.csv",
        "figure9-quintic/figure9-quintic.png",
    ]


def test_what_is_not_a_number_is_null(command, tmp_path):
    still = 't_end = 0.01\n[robot]\nmodel = 2\ncontroller = "none"\n'
    (tmp_path / "still.toml").write_text(still)
    said = json.loads(command("run", "still.toml", "--json").stdout)
    assert set(said["signals"]) == {"joint_angle", "motor_torque"}  # no motion, no error


def test_lists_and_checks_are_data_as_well(command):
    assert set(json.loads(command("list", "--json").stdout)) == set(r3.scenarios())
    checks = json.loads(command("check", "--json").stdout)
    assert len(checks) == len(r3.check())
    assert all(check["passed"] for check in checks)


# --- results on disk ----------------------------------------------------------------------------


def test_pictures_are_drawn_from_a_result_on_disk(command, tmp_path):
    command("run", "short.toml")
    for kind in ("figure9", "events", "friction", "backlash", "phase", "stroboscope"):
        done = command("plot", "short/result.npz", "--kind", kind)
        assert done.stdout == f"wrote result-{kind}.png\n"
        assert (tmp_path / f"result-{kind}.png").read_bytes()[:4] == b"\x89PNG"


def test_a_page_is_written_from_a_result_on_disk(command, tmp_path):
    command("run", "short.toml")
    done = command("animate", "short/result.npz", "--output", "page.html")
    assert done.stdout == "wrote page.html\n"
    assert "<!doctype html>" in (tmp_path / "page.html").read_text(encoding="utf-8").lower()


def test_runs_are_compared(command):
    command("run", "short.toml")
    same = command("compare", "short/result.npz", "short.toml")
    assert (same.exit_code, same.stdout.splitlines()[0]) == (0, "agrees from 0 to 0.02 s")
    differs = command("compare", "sampled-control", "figure9-quintic", "--json")
    assert differs.exit_code == 1
    said = json.loads(differs.stdout)
    assert not said["agrees"]
    assert {curve["signal"] for curve in said["curves"]} >= {"joint_angle", "motor_torque"}
