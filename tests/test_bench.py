"""The benchmarks: what they print is right or said to be wrong. How long it takes is not tested."""

import json
import shutil
from typing import get_args

import numpy as np
import pytest
from typer.testing import CliRunner

import manutec_r3 as r3
from manutec_r3 import _core, bench, command_line
from manutec_r3.bench import Row, Table, arm, for_markdown, peers, precision, runs
from manutec_r3.bench.timing import Timing, each_of_many, many, side_by_side
from manutec_r3.comparison.accuracy import sequence
from manutec_r3.experiment import Method
from manutec_r3.export.arm.tree import arm_tree
from manutec_r3.inputs import gather

SHORT = r3.Scenario(
    "short", r3.Robot(model=4), r3.Quintic([0, 0, 0], [0.2, 0.15, -0.1], 0.3), t_end=0.3
)
SECOND = Timing(1.0, 1.0)


def command(*arguments):
    return CliRunner().invoke(command_line.app, ["bench", *arguments])


# --- a wrong answer fails -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("row", "is_right"),
    [
        (Row("as promised", SECOND, error=1e-7, allowed=1e-6, same_events=True), True),
        (Row("inaccurate", SECOND, error=2e-6, allowed=1e-6, same_events=True), False),
        (Row("other events", SECOND, error=1e-7, allowed=1e-6, same_events=False), False),
        (Row("no number", SECOND, error=np.nan, allowed=1e-6, same_events=True), False),
        (Row("no error known", SECOND, allowed=1e-6), False),
        (Row("nothing promised", SECOND), True),
    ],
    ids=lambda value: value.name if isinstance(value, Row) else "",
)
def test_a_row_is_right_if_error_and_events_are_as_promised(row, is_right):
    assert row.is_right == is_right


@pytest.mark.parametrize("how", [(), ("--json",), ("--markdown",)])
def test_a_wrong_answer_fails_however_fast_it_is(monkeypatch, how):
    fast = Row("fast", Timing(0.1, 0.1), error=1e-3, allowed=1e-6)
    table = Table("race", "A race", "ms", [Row("slow", SECOND, error=0.0, allowed=1e-6), fast])
    monkeypatch.setattr(command_line.judging, "PARTS", {"race": lambda repeats: table})
    done = command(*how)
    assert done.exit_code == 1
    assert "not as promised: race: fast" in done.stderr
    assert "fast" in done.stdout  # the table is there all the same


def test_a_run_at_a_loose_tolerance_is_wrong():
    exact = runs.exact_run(SHORT)
    assert runs.outcome(SHORT.run(), exact).is_right
    assert not runs.outcome(SHORT.run(rtol=1e-3), exact).is_right


def test_a_run_with_other_events_is_wrong():
    exact = runs.exact_run(SHORT)
    assert runs.outcome(SHORT.run(), exact).same_events
    stuck = r3.simulate(SHORT.robot.replace(table_2={"rM_h": 5.0}), SHORT.motion, 0.3)
    assert not runs.outcome(stuck, exact).same_events


def test_a_peer_that_disagrees_is_wrong_and_not_timed(monkeypatch):
    ours = arm.PLAIN_ARM

    def almost(*pose):
        return ours.forward_dynamics(*pose) * (1.0 + 1e-11)

    monkeypatch.setattr(arm, "peers", lambda plain: [peers.Peer("almost", "wrong", almost)])
    *right, wrong = arm.forward_dynamics(repeats=1).rows
    assert all(row.is_right and row.time for row in right)
    assert not wrong.is_right
    assert wrong.time is None
    assert wrong.error == pytest.approx(1e-11, rel=1e-3)


# --- peers --------------------------------------------------------------------------------------


def test_a_peer_that_is_not_there_is_a_row_with_the_reason(monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    pytest.importorskip("casadi")
    (row,) = (row for row in arm.forward_dynamics(repeats=1).rows if "CasADi" in row.name)
    assert row.time is None
    assert row.work == "not measured: there is no C compiler 'no-such-compiler'"
    assert row.is_right


@pytest.mark.parametrize("module", ["pinocchio", "mujoco", "casadi"])
def test_peers_agree_with_the_arm_alone(module):
    pytest.importorskip(module)
    if module != "pinocchio" and not shutil.which("cc"):
        pytest.skip("there is no C compiler")
    (make,) = (make for _, make in peers._PEERS if make.__name__ == f"_{module}")
    rng = np.random.default_rng(5)
    q, qd, tau = rng.uniform(-2.0, 2.0, (3, many, 6))
    expected = arm.PLAIN_ARM.forward_dynamics(q, qd, tau)
    for peer in make(arm_tree(arm.PLAIN_ARM)):
        error = np.abs(peer.forward_dynamics(q, qd, tau) - expected).max(axis=1)
        # Measured: 2e-14 of the largest acceleration of a pose; ten times that.
        assert (error <= 2e-13 * np.abs(expected).max(axis=1)).all()


def test_scipy_finds_the_same_events_with_event_functions_of_its_own():
    from manutec_r3.bench import scipy_run

    exact = runs.exact_run(SHORT)
    run = scipy_run.run(SHORT, rtol=1e-9)
    assert sequence(run.events) == sequence(exact.events)
    assert len(run.events) > 5
    # Measured: 1.1e-12 s; it looks for roots within 4 ulp of t, on an interpolant.
    times = [event.time for event in run.events]
    assert times == pytest.approx(exact.events.time, rel=0, abs=1e-10)
    assert runs.largest_errors(run, exact)["motor_torque"] <= 1e-7


def test_a_system_evaluates_many_instants_as_it_does_one():
    result = SHORT.run()
    t, x = result.time[:20], result.state[:20]
    inputs, _ = gather(SHORT.robot, SHORT.motion, {})
    system = _core.System(SHORT.robot._compiled, inputs._compiled)
    system.initialise(0.0, x[0])
    for evaluate in (system.derivatives, system.indicators, system.signals):
        together = evaluate(t, x)
        for k in range(20):
            np.testing.assert_array_equal(evaluate(t[k], x[k])[0], together[k])
        assert evaluate(t[:0], x[:0]).shape == (0, together.shape[1])


# --- the harness --------------------------------------------------------------------------------


class Clock:
    """Time that passes only when a program says so."""

    now = 0.0

    def __call__(self):
        return self.now

    def spend(self, seconds):
        self.now += seconds


def test_programs_take_turns_and_the_first_time_does_not_count():
    clock, turns = Clock(), []
    spend = {"a": iter([50.0, 3.0, 1.0, 2.0]), "b": iter([50.0, 1.0, 1.0, 4.0])}

    def program(name):
        turns.append(name)
        clock.spend(next(spend[name]))

    timings = side_by_side({n: lambda n=n: program(n) for n in "ab"}, repeats=3, clock=clock)
    assert "".join(turns) == "abababab"
    assert timings == {"a": Timing(1.0, 2.0), "b": Timing(1.0, 1.0)}


def test_slow_programs_are_repeated_less_often():
    clock, turns = Clock(), []
    side_by_side({"slow": lambda: (turns.append(1), clock.spend(5.0))}, repeats=30, clock=clock)
    assert len(turns) == 1 + 3


def test_what_a_call_takes_does_not_count_in_a_loop():
    clock = Clock()
    timings = each_of_many({"loop": lambda n: clock.spend(5.0 + 0.25 * n)}, repeats=2, clock=clock)
    assert timings["loop"] == Timing(0.25, 0.25)


def test_ratios_are_those_to_the_first_row():
    table = Table("race", "A race", "s", [Row("a", SECOND), Row("b", Timing(3.0, 9.0))])
    assert [table.ratio(row) for row in table.rows] == [1.0, 3.0]


def test_a_table_shows_what_is_wrong_and_leaves_empty_columns_out():
    rows = [
        Row("a", Timing(1.5e-3, 2e-3), error=1e-7, allowed=1e-6, same_events=True),
        Row("b", Timing(0.15, 0.15), error=1e-5, allowed=1e-6, same_events=False),
    ]
    lines = for_markdown(Table("race", "A race", "ms", rows)).splitlines()
    assert lines[2:] == [
        "|  | error | events | time, ms | median | ratio |",
        "| --- | ---: | --- | ---: | ---: | ---: |",
        "| a | 1.0e-07 | same | 1.50 | 2.00 | 1 |",
        "| b | 1.0e-05 > 1e-06 | DIFFERENT | 150 | 150 | 100 |",
    ]


# --- what is measured ---------------------------------------------------------------------------


def test_every_method_is_in_the_table_of_a_run_with_its_default():
    table = bench.PARTS["full-robot"](1)
    for method in get_args(Method):
        usual = [row for row in table.rows if row.name.startswith(method) and "default" in row.name]
        assert len(usual) == 1
        assert usual[0].error <= 1e-6
        assert usual[0].same_events
    published = table.rows[-1]
    assert (published.time.minimum, published.error) == (0.501, None)
    assert "7487 evaluations, 530 Jacobians" in published.work


def test_every_model_is_in_the_table_of_right_hand_sides():
    rows = bench.PARTS["right-hand-side"](1).rows
    assert [row.name for row in rows[1:]] == ["model 1", "model 2", "model 4", "full-robot"]
    assert rows[0].name == "model 3"
    assert rows[0].work == "66 states"


def test_a_tighter_tolerance_costs_more_and_is_more_accurate():
    points = precision.work_precision(SHORT, [1e-5, 1e-7, 1e-9], repeats=1)
    for method in get_args(Method):
        found = [point.outcome for point in points if point.method == method]
        errors, work = zip(*((o.error, o.evaluations) for o in found), strict=True)
        assert sorted(errors, reverse=True) == list(errors)
        assert sorted(work) == list(work)
        (default,) = (p for p in points if p.method == method and p.is_default)
        assert default.outcome.is_right


def test_json_has_the_machine_and_times_in_seconds():
    done = command("recording", "--repeats", "1", "--json")
    assert done.exit_code == 0
    said = json.loads(done.stdout)
    assert said["machine"]["processor"]
    (table,) = said["tables"]
    assert table["part"] == "recording"
    assert table["rows"][0]["ratio"] == 1.0
    assert all(0.0 < row["minimum"] <= row["median"] < 60.0 for row in table["rows"])


def test_an_unknown_part_is_refused():
    done = command("figure8")
    assert done.exit_code == 2
    assert "parts: expected some of right-hand-side, " in done.stderr
