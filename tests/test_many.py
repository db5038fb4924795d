"""Many runs at once are the runs one by one, bit by bit, whatever is kept of them."""

import pickle
import signal
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from child import child

import manutec_r3 as r3

SIGNALS = r3.Result.signals[:-1]
TASKS = Path("/proc/self/task")  # the threads of this process, in Linux

loaded = r3.Robot(model=3, load=r3.Load(mass=15.0))
sampled = loaded.replace(controller="sampled")
motion = r3.Quintic([0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
short = r3.Trapezoid([0] * 6, [0.1] * 6, rate=[2.5] * 6, acceleration=[10] * 6)
along_functions = r3.FunctionMotion(
    angle=lambda t: 0.1 * np.sin(t) * np.ones(6),
    rate=lambda t: 0.1 * np.cos(t) * np.ones(6),
    duration=1.0,
)
RUNS = [
    (loaded, motion),
    (sampled, motion),
    (loaded, short),
    (r3.Robot(model=2), r3.Quintic([0] * 3, [0.3] * 3, duration=0.3)),
    (r3.Robot(model=1), along_functions),
    (r3.Robot(model="full-robot"), short),
] * 2
T_END = 0.2

every_method = pytest.mark.parametrize("method", ["erk", "exponential", "bdf"])


@pytest.fixture(scope="module")
def alone():
    """Each run by itself."""
    return [r3.simulate(*run, T_END) for run in RUNS]


def assert_same(many, one):
    """A result is another one bit by bit."""
    assert many.events == one.events
    assert replace(many.statistics, seconds=0.0) == replace(one.statistics, seconds=0.0)
    assert (many.t_end, many.method, many.rtol, many.status) == (
        one.t_end,
        one.method,
        one.rtol,
        one.status,
    )
    np.testing.assert_array_equal(many.time, one.time)
    for name in one.signals:
        np.testing.assert_array_equal(getattr(many, name), getattr(one, name))
    for element, branches in one.branches.items():
        np.testing.assert_array_equal(many.branches[element], branches)


# --- the same runs ------------------------------------------------------------------------------


@pytest.mark.parametrize("workers", [1, 3, None])
def test_each_run_is_the_one_alone_bit_by_bit(alone, workers):
    results = r3.simulate_many(RUNS, t_end=T_END, workers=workers)
    assert len(results) == len(RUNS)
    assert results.failures == {}
    for result, (robot, follows), one in zip(results, RUNS, alone, strict=True):
        assert result.robot is robot
        assert result.motion is follows
        assert_same(result, one)
        np.testing.assert_array_equal(result.at([0.1]).state, one.at([0.1]).state)


@pytest.mark.parametrize(
    "arguments",
    [
        {"method": "bdf", "rtol": 1e-8},
        {"start": "arm", "times": [0.05, 0.07]},
        {"start": loaded.state_from([0.1] * 6, joint_rate=[0.3] * 6), "list_samples": True},
        {"tip_force": [100.0, 0.0, -50.0], "brakes": True},
        {"tip_force": r3.Input(lambda t: [0.0, 300.0 * t, 0.0], knots=[0.03])},
    ],
    ids=lambda arguments: " ".join(arguments),
)
def test_arguments_mean_what_they_mean_for_one_run(arguments):
    pairs = [(loaded, r3.Hold([0.1] * 6)), (sampled, r3.Hold([0.1] * 6))]
    for result, pair in zip(r3.simulate_many(pairs, 0.1, **arguments), pairs, strict=True):
        assert_same(result, r3.simulate(*pair, 0.1, **arguments))


def test_inputs_of_robots_without_controllers():
    free, driven = r3.Robot(model=4, controller=None), r3.Robot(model=4, controller="external")
    (held,) = r3.simulate_many([(free, None)], 0.1, motor_torque=[0.3, 0.8, 0.0])
    assert_same(held, r3.simulate(free, None, 0.1, motor_torque=[0.3, 0.8, 0.0]))
    (held,) = r3.simulate_many([(driven, None)], 0.1, command=[0.5] * 3)
    assert_same(held, r3.simulate(driven, None, 0.1, command=[0.5] * 3))


def test_scenarios_stand_for_their_runs():
    figure9, one_axis = r3.Scenario.load("figure9-quintic"), r3.Scenario.load("one-axis")
    results = r3.simulate_many([one_axis, figure9], t_end=0.1)
    assert_same(results[0], one_axis.run(t_end=0.1))
    assert_same(results[1], figure9.run(t_end=0.1))
    push = replace(figure9, t_end=0.05, inputs={"tip_force": [0.0, 0.0, -100.0]})
    assert_same(r3.simulate_many([push])[0], push.run())


def test_no_runs_give_no_results():
    assert list(r3.simulate_many([], t_end=1.0)) == []


# --- what is kept -------------------------------------------------------------------------------


def test_events_are_those_of_the_results(alone):
    for record, one in zip(r3.simulate_many(RUNS, T_END, record="events"), alone, strict=True):
        assert record.events == one.events
        assert record.statistics.evaluations == one.statistics.evaluations


@every_method
def test_final_values_are_the_last_of_the_results(method):
    runs = RUNS[:6]
    records = r3.simulate_many(runs, T_END, record="final", method=method)
    for record, run in zip(records, runs, strict=True):
        one = r3.simulate(*run, T_END, method=method)
        assert record.t_end == one.t_end
        np.testing.assert_array_equal(record.state, one.state[-1])
        for name in SIGNALS:
            np.testing.assert_array_equal(getattr(record, name), getattr(one, name)[-1])
        for element, branches in one.branches.items():
            np.testing.assert_array_equal(record.branches[element], branches[-1])


@every_method
@pytest.mark.parametrize("times", [None, [0.01, 0.1]])
def test_peaks_are_the_largest_magnitudes_of_the_results(times, method):
    """Of steps on all branches, whatever the branches at the end."""
    runs = RUNS[:6]
    records = r3.simulate_many(runs, T_END, times=times, record="peaks", method=method)
    for record, run in zip(records, runs, strict=True):
        one = r3.simulate(*run, T_END, times=times, method=method)
        for name in SIGNALS:
            largest = np.abs(getattr(one, name)).max(axis=0)
            np.testing.assert_array_equal(getattr(record, name), largest)


def test_peaks_of_what_a_robot_does_not_have_are_not_numbers():
    (record,) = r3.simulate_many([(r3.Robot(model=2, controller=None), None)], 0.1, record="peaks")
    assert np.isnan(record.control_error).all()
    assert np.isfinite(record.joint_angle).all()


@pytest.mark.parametrize("record", ["all", "events", "final", "peaks"])
def test_what_is_kept_survives_pickling(record):
    results = r3.simulate_many([(loaded, motion), (loaded, short)], 0.05, record=record)
    again = pickle.loads(pickle.dumps(results))
    assert len(again) == 2
    for one, other in zip(results, again, strict=True):
        assert type(one) is type(other)
        assert asdict(one.statistics) == asdict(other.statistics)
        assert one.robot == other.robot


def test_records_are_small():
    # A result of this run takes a megabyte.
    for record in ("events", "final", "peaks"):
        (kept,) = r3.simulate_many([(loaded, motion)], 0.5, record=record)
        assert len(pickle.dumps(kept)) < 10_000


# --- what goes wrong ----------------------------------------------------------------------------

BREAKS = r3.FunctionMotion(
    angle=lambda t: 0.1 * np.sin(t) * np.ones(6) if not 0.05 < t < 0.1 else 1 / 0,
    rate=lambda t: 0.1 * np.cos(t) * np.ones(6),
    duration=1.0,
)
TOO_HEAVY = r3.Robot(model=3, load=r3.Load(200.0, bounds=False))
STRETCHED = r3.Hold([0.0, 1.5, 0.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("record", ["all", "events", "final", "peaks"])
def test_a_run_that_fails_stands_in_its_place_and_loses_no_other(record):
    fast = loaded.state_from([0.0] * 6, joint_rate=[1e8, 0, 0, 0, 0, 0])
    cannot_go_on = r3.Scenario("fast", loaded, r3.Hold([0] * 6), T_END, start=fast)
    runs = [
        (loaded, short),
        cannot_go_on,
        (TOO_HEAVY, STRETCHED),
        (loaded, BREAKS),
        (loaded, short),
    ]
    results = r3.simulate_many(runs, T_END, record=record, workers=2)
    assert list(results.failures) == [1, 2, 3]

    with pytest.raises(r3.SimulationError) as expected:
        cannot_go_on.run()
    for name in ("time", "reason"):
        assert getattr(results[1], name) == getattr(expected.value, name)
    np.testing.assert_array_equal(results[1].state, expected.value.state)
    assert results[1].result.status == expected.value.result.status
    assert results[1].result.t_end == expected.value.time
    if record in ("all", "events"):
        assert results[1].result.events == expected.value.result.events
    if record == "final":
        np.testing.assert_array_equal(results[1].result.state, expected.value.result.state[-1])

    with pytest.raises(ValueError) as expected:
        r3.simulate(*runs[2], T_END)
    assert type(results[2]) is ValueError
    assert str(results[2]) == str(expected.value)
    assert type(results[3]) is ZeroDivisionError
    for good in (results[0], results[4]):
        assert good.status == "completed"


@pytest.mark.parametrize(
    ("runs", "arguments", "message"),
    [
        ([(loaded, motion), loaded], {}, r"runs\[1\]: expected a pair of Robot and Motion, or a"),
        ([(loaded, motion), (motion, loaded)], {}, r"runs\[1\]: robot: expected a Robot, got"),
        ([(loaded, motion), (loaded, r3.Hold([0] * 3))], {}, r"runs\[1\]: motion: "),
        ([(loaded, motion)], {"t_end": None}, r"runs\[0\]: t_end: expected a time \[s\], got None"),
        ([(loaded, motion)], {"t_end": -1.0}, r"runs\[0\]: t_end: expected a time after"),
        ([(loaded, motion)], {"times": [2.0]}, r"runs\[0\]: times: expected instants from 0 to"),
        ([(loaded, motion)], {"method": "euler"}, r"runs\[0\]: method: expected"),
        ([(loaded, motion)], {"start": "foot"}, r"start: expected 'rotor', 'arm' or a state"),
        ([(loaded, motion)], {"record": "some"}, "record: expected one of 'all', 'events', "),
        ([(loaded, motion)], {"workers": 0}, "workers: expected a positive number of threads"),
        ([(loaded, motion)], {"workers": True}, "workers: expected a positive number of threads"),
        ([(loaded, motion)], {"progress": 1}, "progress: expected a function"),
    ],
)
def test_what_is_wrong_is_told_before_anything_is_simulated(runs, arguments, message):
    def progress(n_finished):
        raise AssertionError("simulated")

    with pytest.raises((TypeError, ValueError), match=message):
        r3.simulate_many(runs, **{"t_end": 0.1, "progress": progress} | arguments)


# --- progress and interruption ------------------------------------------------------------------


def test_progress_counts_runs_up_to_all_of_them():
    told = []
    r3.simulate_many([(loaded, short)] * 40, 0.1, record="final", progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 40


def test_what_progress_raises_ends_the_work_and_keeps_what_is_finished():
    n_threads = len(list(TASKS.iterdir())) if TASKS.exists() else 0

    def enough(n_finished):
        if n_finished >= 2:
            raise RuntimeError("enough")

    runs = [(loaded, short)] * 2 + [(loaded, r3.Hold([0.3, -0.5, 0.8, 0, 0, 0]))] * 4
    scenarios = [r3.Scenario("", *run, t_end=0.1 if k < 2 else 1e4) for k, run in enumerate(runs)]
    with pytest.raises(RuntimeError, match="enough") as stopped:
        r3.simulate_many(scenarios, workers=2, record="final", progress=enough)
    results = stopped.value.results
    assert [one is not None for one in results] == [True, True, False, False, False, False]
    assert results.n_finished == 2
    assert stopped.value.__notes__ == ["2 of 6 runs are finished: `results` of this exception"]
    assert_final = r3.simulate(*runs[0], 0.1).state[-1]
    np.testing.assert_array_equal(results[0].state, assert_final)
    if TASKS.exists():
        assert len(list(TASKS.iterdir())) == n_threads


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends Ctrl-C to whole consoles")
def test_ctrl_c_ends_many_long_runs_at_once():
    script = """
import manutec_r3 as r3
from pathlib import Path
robot, hold = r3.Robot(model=3), r3.Hold([0.3, -0.5, 0.8, 0, 0, 0])
runs = [r3.Scenario("", robot, hold, t_end) for t_end in (0.01, 1e4, 1e4, 1e4)]
tasks = Path("/proc/self/task")
n_threads = len(list(tasks.iterdir())) if tasks.exists() else 0
told = []
def progress(n_finished):
    if n_finished == 1 and not told:
        told.append(n_finished)
        print("begins", flush=True)
try:
    r3.simulate_many(runs, workers=2, progress=progress)
except KeyboardInterrupt as stopped:
    n_more = len(list(tasks.iterdir())) - n_threads if tasks.exists() else 0
    print(stopped.results, n_more, "more threads")
"""
    with child(sys.executable, "-c", script) as process:
        assert process.stdout.readline() == "begins\n"
        began = time.perf_counter()
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=20)
    assert time.perf_counter() - began < 20.0  # tenths of a second, unless the machine is busy
    assert said == "<Results of 4 runs, 0 failed, 3 not finished> 0 more threads\n"
    assert process.returncode == 0
