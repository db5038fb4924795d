"""Models 1 to 4 against the independent implementation, with loads and motions of many kinds.

`oracle_runs.py` says what the runs are, and where what they are compared with comes from.
"""

import numpy as np
import pytest
from independent import IndependentRobot
from oracle_runs import ECCENTRIC, RUNS, SIGNALS, stored, times_of
from scipy.integrate import solve_ivp

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import ranges, sequence

RTOL = 1e-9


@pytest.fixture(scope="module", params=RUNS)
def pair(request):
    """A run of the package, and the same of the independent implementation."""
    run = RUNS[request.param]
    # Without controllers nothing makes the steps short: the tolerance alone limits them.
    rtol = RTOL if run.options.get("controller", "continuous") else 0.1 * RTOL
    return run.simulate(rtol=rtol), stored(request.param)


def test_events_are_those_of_the_independent_implementation(pair):
    result, expected = pair
    assert sequence(result.events) == sequence(expected.events)
    # 1e-6 s is what the package promises at this tolerance, 7e-12 s what it does: ten times that.
    assert times_of(result.events) == pytest.approx(times_of(expected.events), rel=0, abs=1e-10)


@pytest.mark.parametrize("signal", SIGNALS)
def test_signals_are_those_of_the_independent_implementation(pair, signal):
    result, expected = pair
    got, wanted = getattr(result.at(expected.time), signal), getattr(expected, signal)
    if np.isnan(wanted).any():  # without a controller, or a motion
        np.testing.assert_array_equal(got, wanted)
        return
    # 1e-6 of the range is what the package promises at this tolerance; 3e-10 is what it does, and
    # 6e-9 for the acceleration of axis 6 under a push. Where nothing moves, noise of 2e-11 is left.
    # Ten times that, of the acceleration three.
    share = 2e-8 if signal == "joint_acceleration" else 3e-9
    assert np.max(np.abs(got - wanted) - share * ranges(wanted)) <= 2e-10


@pytest.mark.parametrize(("name", "until"), [("2-trapezoid-saturated", 0.1), ("4-quintic", 0.05)])
def test_stored_runs_come_from_the_independent_implementation(name, until):
    again, expected = RUNS[name].simulate_independently(until, rtol=1e-10), stored(name)
    events = [event for event in expected.events if event[0] < until]
    assert sequence(again.events) == sequence(events)
    assert len(events) >= 3
    # The tolerance of this repetition is a hundred times that of the stored run. Its short steps
    # keep errors at 6e-15 s and 2e-12 N m; other versions of NumPy and SciPy may round otherwise.
    assert times_of(again.events) == pytest.approx(times_of(events), rel=0, abs=1e-12)
    n = len(again.time)
    assert again.motor_torque == pytest.approx(expected.motor_torque[:n], rel=0, abs=1e-9)


def test_simultaneous_events_are_at_one_instant_in_the_order_of_axes():
    events = list(RUNS["3-trapezoid"].simulate().events)
    first, second = events[2:4]
    assert (first[1:], second[1:]) == ((1, "dead_zone", 0, -1), (2, "dead_zone", 0, 1))
    assert first.time == second.time


# --- torques as inputs ----------------------------------------------------------------------------


@pytest.mark.parametrize("model", [1, 2])
def test_torque_inputs_move_ideal_gears_by_the_forward_dynamics(model):
    rng = np.random.default_rng(model)
    n = 6 if model == 1 else 3
    oracle = IndependentRobot(model, 6.0, ECCENTRIC)
    robot = r3.Robot(model=model, load=r3.Load(6.0, ECCENTRIC), controller=None)
    q, qd = rng.uniform(-1.0, 1.0, n), rng.uniform(-1.0, 1.0, n)
    simulator = r3.Simulator(robot, rtol=1e-11, start=robot.state_from(q, qd))
    x = np.concatenate((q, qd))

    for _ in range(10):
        torque = rng.uniform(-3.0, 3.0, n)
        simulator.motor_torque = torque
        assert simulator.step(0.03) == []

        def move(t, x, torque=torque):
            return np.concatenate(
                (x[n:], oracle.forward_dynamics(x[:n], x[n:], oracle.ratio * torque))
            )

        x = solve_ivp(move, (0.0, 0.03), x, "DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
        # Both integrate to about 1e-11 in each of ten pieces; rates reach some rad/s.
        assert np.concatenate((simulator.joint_angle, simulator.joint_rate)) == pytest.approx(
            x, rel=0, abs=1e-8
        )
        np.testing.assert_array_equal(simulator.motor_torque, torque)
        np.testing.assert_array_equal(simulator.joint_torque, oracle.ratio * torque)


def test_a_torque_input_acts_at_once():
    robot = r3.Robot(model=2, controller=None)
    simulator = r3.Simulator(robot)
    at_rest = simulator.joint_acceleration
    simulator.motor_torque = [1.0, -0.5, 2.0]
    torque = np.array([1.0, -0.5, 2.0]) * [-105.0, 210.0, 60.0]
    gained = simulator.joint_acceleration - at_rest
    expected = np.linalg.solve(robot.mass_matrix(np.zeros(3)), torque)
    assert gained == pytest.approx(expected, rel=1e-13)  # roundoff


def test_a_torque_input_beyond_the_sticking_limit_sets_its_axis_sliding_at_once():
    robot = r3.Robot(model=3, controller=None)
    simulator = r3.Simulator(robot)
    simulator.step(0.01)
    np.testing.assert_array_equal(simulator.branches["friction"], 0)
    simulator.motor_torque = [0.41, 0.0, 0.0, -0.28, 0.0, 0.16]
    np.testing.assert_array_equal(simulator.branches["friction"], [1, 0, 0, -1, 0, 0])
    assert simulator.step(0.0) == [
        (0.01, 1, "friction", 0, 1),
        (0.01, 4, "friction", 0, -1),
    ]


def test_what_an_input_does_at_the_start_belongs_to_the_start():
    simulator = r3.Simulator(r3.Robot(model=3, controller=None))
    simulator.motor_torque = [0.41, 0.0, 0.0, -0.28, 0.0, 0.16]
    np.testing.assert_array_equal(simulator.branches["friction"], [1, 0, 0, -1, 0, 0])
    assert simulator.step(0.0) == []
    assert simulator.step_to_event(t_end=1.0).time > 0.0


@pytest.mark.parametrize("at", [0.0, 0.01])
def test_an_input_that_is_set_again_at_one_instant_is_decided_again(at):
    simulator = r3.Simulator(r3.Robot(model=3, controller=None))
    simulator.step(at)
    for push in (1.0, 0.0, -1.0, 1.0, 0.0):
        simulator.motor_torque = np.multiply(push, [1.0, 0.0, 0.0, 1.0, 0.0, 0.0])
        np.testing.assert_array_equal(simulator.branches["friction"], [push, 0, 0, push, 0, 0])
        assert (simulator.joint_acceleration[3] == 0.0) == (push == 0.0)
    np.testing.assert_array_equal(simulator.friction_torque, 0.0)
    np.testing.assert_array_equal(simulator.joint_acceleration, 0.0)
    simulator.step(0.1)
    np.testing.assert_array_equal(simulator.rotor_rate, 0.0)


@pytest.mark.parametrize("method", ["exponential", "erk", "bdf"])
def test_setting_a_torque_input_does_not_move_the_robot(method):
    robot = r3.Robot(model=3, load=r3.Load(6.0, ECCENTRIC), controller=None)
    start = robot.state_from([0.1, -0.2, 0.3, 0.4, -0.5, 0.6], [1.0, -1.0, 2.0, 1.0, -2.0, 3.0])
    simulator = r3.Simulator(robot, method=method, start=start)
    for dt in (0.01, 0.0007, 0.02):  # in the middle of steps of the integrator
        simulator.step(dt)
        before = simulator.state
        simulator.motor_torque = [4.0 * dt, -2.0, 1.0, 0.3, -0.4, 0.1]
        np.testing.assert_array_equal(simulator.state, before)


def test_a_torque_input_at_the_instant_of_a_knot_does_not_lose_the_knot():
    motion = r3.Quintic([0.0] * 3, [0.1] * 3, 0.1)
    simulator = r3.Simulator(r3.Robot(model=2, controller=None), motion)
    assert simulator.step_to_event(t_end=0.1) is None  # what lies at the end follows
    simulator.motor_torque = [1.0, 0.0, 0.0]
    assert simulator.step(0.05) == [(0.1, 0, "reference", 0, 0)]
    np.testing.assert_array_equal(simulator.reference_angle, [0.1, 0.1, 0.1])
