"""`check` passes here, and each of its rows fails when what it expects or computes is falsified."""

import copy
from importlib.resources import files

import numpy as np
import pytest
from typer.testing import CliRunner

import manutec_r3 as r3
from manutec_r3.command_line import app
from manutec_r3.comparison import checks as module

WHAT = (
    *("acceleration", "hold", "control error", "motor torque", "events", "work"),
    *("signals of one-axis", "friction modes of one-axis", "friction modes of full-robot"),
)


@pytest.fixture(scope="module")
def rows():
    return r3.check()


def failed(rows):
    """What does not pass, by a word of it."""
    return [word for word, row in zip(WHAT, rows, strict=True) if not row.passed]


@pytest.fixture
def falsify(monkeypatch):
    """Puts something else in the place of a reference, for what follows."""

    def put(name, change):
        original = module._reference

        def changed(asked):
            data = copy.deepcopy(original(asked))
            if asked == name:
                change(data)
            return data

        monkeypatch.setattr(module, "_reference", changed)

    return put


def set_parameter(monkeypatch, table, key, change):
    """Let robots say that a parameter is another."""
    original = r3.Robot.parameters.fget

    def parameters(robot):
        tables = original(robot)
        return tables | {table: tables[table] | {key: change(np.array(tables[table][key]))}}

    monkeypatch.setattr(r3.Robot, "parameters", property(parameters))


def test_the_published_numbers_are_reproduced(rows):
    assert failed(rows) == []
    for word, row in zip(WHAT, rows, strict=True):
        assert word in row.what
        assert row.source


def test_rows_say_what_was_expected_and_found(rows):
    _, holding, errors, torques, events, _, signals, modes, changes = rows
    assert holding.expected == holding.found == "0.0 -746.7 -263.7"
    assert errors.expected == errors.found == "8.09 10.06 6.89 1.46 2.07 1.27"
    assert torques.expected == torques.found == "2.81 5.43 7.04 0.28 1.20 0.17"
    assert events.found == "60: 26 dead zone, 20 friction, 13 backlash, 1 reference"
    assert signals.what == "7 signals of one-axis at 15 instants"
    # published are seven digits of the instants, which are known to 1e-6 s
    forward, *_, again = modes.found.split("\n")
    assert (forward, again) == ("0.000652 forward", "1.353624 forward")
    assert changes.expected == changes.found == "34: 4 10 9 4 4 3"


def test_every_reference_is_installed_and_says_where_it_comes_from():
    names = [
        file.name.removesuffix(".json")
        for file in (files("manutec_r3.comparison") / "references").iterdir()
    ]
    assert {"r3m2si", "holding", "figure9_quintic", "one_axis", "full_robot"} == set(names)
    for name in names:
        assert module._reference(name)["about"]


def test_all_cases_of_the_original_routine_are_computed(rows):
    assert len(module._reference("r3m2si")["cases"]) == 20
    assert "20 cases" in rows[0].what


@pytest.mark.parametrize("case", [0, 19])
def test_accelerations_fail_if_one_number_is_another(falsify, case):
    def change(data):
        data["cases"][case]["qdd"][1] *= 1.0 + 1e-10

    falsify("r3m2si", change)
    assert failed(r3.check()) == ["acceleration"]


def test_holding_torques_fail_by_a_printed_digit(falsify):
    def change(data):
        data["tau"][2] += 0.1

    falsify("holding", change)
    assert failed(r3.check()) == ["hold"]


@pytest.mark.parametrize(
    ("signal", "digit", "word"),
    [("control_error", 1e-5, "control error"), ("motor_torque", 1e-2, "motor torque")],
)
@pytest.mark.parametrize("axis", [1, 6])
def test_peaks_fail_by_a_printed_digit_of_one_axis(rows, falsify, signal, digit, word, axis):
    def change(data):
        data[signal][axis - 1] += digit

    falsify("figure9_quintic", change)
    assert failed(r3.check()) == [word]


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [({"friction": 21}, 1), ({"friction": 21, "backlash": 12}, 2), ({"torque_limit": 1}, 1)],
)
def test_events_fail_if_one_is_of_another_kind(falsify, changes, wrong):
    falsify("figure9_quintic", lambda data: data["events"].update(changes))
    rows = r3.check()
    assert failed(rows) == ["events"]
    assert rows[4].deviation == wrong


@pytest.mark.parametrize(
    ("table", "key", "change"),
    [
        ("table_2", "d", lambda d: d * [1.0, 1.0, 1.001]),
        ("table_2", "c", lambda c: c * [1.0, 1.001, 1.0]),
        ("table_2", "b", lambda b: np.add(b, [1e-5, 0.0, 0.0])),
        ("table_3", "rJ", lambda J: J * [1.0, 1.0, 1.001, 1.0, 1.0, 1.0]),
    ],
)
def test_energy_does_not_balance_with_another_parameter(monkeypatch, table, key, change):
    set_parameter(monkeypatch, table, key, change)
    assert failed(r3.check()) == ["work"]


def test_energy_does_not_balance_with_another_mass_matrix(monkeypatch):
    original = r3.Robot.mass_matrix
    monkeypatch.setattr(r3.Robot, "mass_matrix", lambda robot, q: 1.0001 * original(robot, q))
    assert failed(r3.check()) == ["work"]


def test_energy_does_not_balance_with_another_load():
    """The load is in the mass matrix, and in the work against gravity."""
    reference = module._reference("figure9_quintic")
    run = r3.Scenario.load("figure9-quintic").run()
    run.robot = r3.Robot(model=3, load=r3.Load(15.0001, bounds=False))
    assert not module._energy(run, reference).passed
    run.robot = r3.Robot(model=3, load=r3.Load(15.0))
    assert module._energy(run, reference).passed


# --- the Modelica variant -------------------------------------------------------------------------


@pytest.mark.parametrize("signal", ["joint_angle", "deflection_rate", "controller", "voltage"])
@pytest.mark.parametrize("instant", [0, 14])
def test_a_signal_of_the_one_axis_that_is_another_is_named(falsify, signal, instant):
    def change(data):
        lowest, highest = data["range"][signal]
        data["at_instants"][signal][instant] += 1e-4 * (highest - lowest)

    falsify("one_axis", change)
    rows = r3.check()
    assert failed(rows) == ["signals of one-axis"]
    # beside what the published run itself is off
    assert rows[6].deviation == pytest.approx(1e-4, abs=1e-6)
    assert signal.replace("_", " ") in rows[6].found


def test_modes_of_the_one_axis_fail_if_one_begins_at_another_time(falsify):
    def change(data):
        data["friction_changes"]["time"][2] += 1e-5

    falsify("one_axis", change)
    rows = r3.check()
    assert failed(rows) == ["friction modes of one-axis"]
    assert rows[7].deviation == pytest.approx(1e-5, abs=1e-6)


@pytest.mark.parametrize("missing", [True, False])
def test_modes_of_the_one_axis_fail_if_one_is_another_or_missing(falsify, missing):
    def change(data):
        for column in data["friction_changes"].values():
            if missing:
                del column[3]
            else:
                column[3] = 1

    falsify("one_axis", change)
    rows = r3.check()
    assert failed(rows) == ["friction modes of one-axis"]
    assert rows[7].deviation == np.inf


def test_changes_of_the_full_robot_fail_if_an_axis_has_another_number(falsify):
    def change(data):
        data["friction_changes"][0] += 1
        data["friction_changes"][1] -= 1

    falsify("full_robot", change)
    rows = r3.check()
    assert failed(rows) == ["friction modes of full-robot"]
    assert rows[8].deviation == 2.0


# --- the command ----------------------------------------------------------------------------------


def test_the_command_prints_a_table_and_ends_well(rows):
    done = CliRunner().invoke(app, ["check"], env={"COLUMNS": "200"})
    assert done.exit_code == 0
    for row in rows:
        (line,) = (line for line in done.stdout.splitlines() if row.what in line)
        assert row.expected.splitlines()[0] in line
        assert row.found.splitlines()[0] in line
        assert all(line in done.stdout for line in row.found.splitlines())
        assert line.rstrip().endswith("passed")
        assert row.source in done.stdout
    assert done.stdout.endswith("All 9 checks passed.\n")


def test_the_command_says_what_failed_and_ends_with_1(falsify):
    def change(data):
        data["tau"][1] = 0.0

    falsify("holding", change)
    done = CliRunner().invoke(app, ["check"], env={"COLUMNS": "200"})
    assert done.exit_code == 1
    (line,) = (line for line in done.stdout.splitlines() if "FAILED" in line)
    assert "0.0 0.0 -263.7" in line
    assert done.stderr == "error: 1 of 9 checks failed\n"
