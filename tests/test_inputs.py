"""What acts from outside: forces on the tip, and inputs that are functions of time."""

import numpy as np
import pytest
from independent import GEAR_RATIO, STICKING_LIMIT
from oracle_runs import BENT, ECCENTRIC, times_of
from scipy.linalg import expm

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import sequence

LOAD = r3.Load(4.0, ECCENTRIC)
FORCE = np.array([30.0, -20.0, 40.0])  # N

# --- a force on the tip ---------------------------------------------------------------------------


def jacobian(robot, q):
    """Velocity of the load per joint rate (3, n_axes), by differences of its position."""
    step = 1e-6 * np.eye(robot.n_axes)
    # Errors of 1e-16 / 1e-6, and of the square of the step.
    return (robot.load_position(q + step) - robot.load_position(q - step)).T / 2e-6


@pytest.mark.parametrize("model", [1, 2])
def test_a_force_on_the_tip_accelerates_ideal_gears_by_its_lever(model):
    robot = r3.Robot(model, LOAD, controller=None)
    rng = np.random.default_rng(model)
    for _ in range(5):
        q, qd, torque = rng.normal(0.0, 1.0, (3, robot.n_axes))
        simulator = r3.Simulator(
            robot, start=robot.state_from(q, qd), motor_torque=torque, tip_force=FORCE
        )
        tau = GEAR_RATIO[: robot.n_axes] * torque + jacobian(robot, q).T @ FORCE
        bias = robot.inverse_dynamics(q, qd, np.zeros(robot.n_axes))
        expected = np.linalg.solve(robot.mass_matrix(q), tau - bias)
        # As exact as the differences.
        assert simulator.joint_acceleration == pytest.approx(expected, rel=1e-8, abs=1e-7)


def test_friction_balances_a_small_force_on_a_robot_at_rest():
    # Strong dampers, so that the arms have come to rest on their gears soon.
    robot = r3.Robot(3, LOAD, table_2={"d": (0.5, 0.2, 0.5)})
    free = r3.Simulator(robot, r3.Hold(BENT))
    pushed = r3.Simulator(robot, r3.Hold(BENT), tip_force=FORCE)
    assert {event.element for event in pushed.step(2.0)} <= {"backlash"}
    np.testing.assert_array_equal(pushed.branches["friction"], 0)
    np.testing.assert_array_equal(pushed.rotor_rate, 0.0)
    assert np.abs(pushed.joint_rate).max() <= 1e-9
    q, rest = pushed.joint_angle, np.zeros(6)
    held = robot.inverse_dynamics(q, rest, rest) - jacobian(robot, q).T @ FORCE
    # As exact as the differences; motors give what they gave before, within the tolerance.
    assert pushed.joint_torque == pytest.approx(held, rel=0, abs=1e-6)
    assert pushed.motor_torque == pytest.approx(free.motor_torque, rel=0, abs=1e-8)
    friction = pushed.motor_torque - held / GEAR_RATIO
    assert pushed.friction_torque == pytest.approx(friction, rel=0, abs=1e-8)
    assert np.abs(friction).max() > 0.05
    assert np.all(np.abs(friction) < STICKING_LIMIT)


def test_a_force_downwards_on_an_empty_hand_weighs_as_a_load():
    weight = r3.Simulator(r3.Robot(1, LOAD), r3.Hold(BENT)).joint_torque
    empty = r3.Robot(1, r3.Load(0.0, LOAD.position), controller=None)
    simulator = r3.Simulator(
        empty,
        start=empty.state_from(BENT),
        motor_torque=weight / GEAR_RATIO,
        tip_force=[0.0, 0.0, -9.81 * LOAD.mass],
    )
    # Hundreds of N m balance to roundoff, on a small inertia.
    assert simulator.joint_acceleration == pytest.approx(np.zeros(6), abs=1e-10)


# --- functions of time ----------------------------------------------------------------------------

STEP = 0.0371  # s


def torques(t):
    return np.array([0.9, -1.2, 1.0, 0.5, -0.7, 0.3]) if t >= STEP else np.zeros(6)


def commands(t):
    return np.array([0.4, -0.5, 0.6, -0.3, 0.4, -0.2]) * (1.0 if t < STEP else -1.0)


def push(t):
    return FORCE * (1.0 if t < STEP else 20.0)


@pytest.mark.parametrize(
    ("name", "controller", "function"),
    [
        ("motor_torque", None, torques),
        ("command", "external", commands),
        ("tip_force", "continuous", push),
    ],
)
@pytest.mark.parametrize("method", ["exponential", "erk", "bdf"])
def test_a_step_at_a_knot_is_the_same_as_setting_the_input_at_that_instant(
    name, controller, function, method
):
    robot, options = r3.Robot(3, LOAD, controller), {"rtol": 1e-11, "method": method}
    motion = r3.Hold(BENT)
    by_function = r3.simulate(
        robot, motion, 0.1, **{name: r3.Input(function, knots=[STEP])}, **options
    )

    simulator = r3.Simulator(robot, motion, **{name: function(0.0)}, **options)
    events = simulator.step(STEP)
    setattr(simulator, name, function(STEP))
    events += simulator.step(0.1 - simulator.time)
    assert sequence(by_function.events) == sequence(events)
    assert len(events) >= 4
    at_step = times_of(events) == STEP
    np.testing.assert_array_equal(times_of(by_function.events) == STEP, at_step)
    # Measured are 1e-12 s, and 1e-12 of the states' nominal values with "erk", 8e-11 with "bdf".
    assert times_of(by_function.events) == pytest.approx(times_of(events), rel=0, abs=1e-11)
    apart = np.abs(by_function.state[-1] - simulator.state) / robot.state_nominals
    assert apart.max() <= 1e-9


# The one axis without friction; and cut in two by a gap without end, where the rotor turns alone.
FRICTIONLESS = {"friction": {1: ((0.0, 0.0), (1.0, 0.0))}, "rM_h": 0.0}
CUT_IN_TWO = {**FRICTIONLESS, "b": 1e3, "d": 0.0}


def test_a_knot_that_is_declared_is_met_exactly():
    robot = r3.Robot("one-axis", controller=None, table_2=CUT_IN_TWO)
    torque, rate, until = 0.2, 1.0, 0.05
    errors = []
    for knots in ([STEP], []):
        step = r3.Input(lambda t: [torque * (t >= STEP)], knots)
        start = robot.state_from([0.0], rotor_rate=[rate])
        simulator = r3.Simulator(robot, start=start, motor_torque=step)
        simulator.step(until)
        expected = rate + torque * (until - STEP) / 1.3e-3  # rJ rq'' = rF
        errors.append(abs(simulator.rotor_rate[0] - expected))
    assert errors[0] <= 1e-14  # roundoff
    assert errors[1] > 1e-9  # as the documentation warns


def test_an_oscillating_torque_moves_two_masses_as_its_closed_form():
    w, torque, (p, c, d, rotor, load) = 60.0, 0.4, (210.0, 8.0, 0.01, 1.3e-3, 19.5)
    robot = r3.Robot("one-axis", controller=None, table_2=FRICTIONLESS)
    result = r3.simulate(
        robot, None, 0.3, motor_torque=lambda t: [torque * np.cos(w * t)], rtol=1e-11
    )
    # x = (q, q', rq, rq', cos w t, sin w t) follows x' = A x.
    A = np.zeros((6, 6))
    A[0, 1] = A[2, 3] = 1.0
    spring = np.array([-p * c, -p * d, c, d, 0.0, 0.0])  # tau
    A[1], A[3] = p * spring / load, -spring / rotor
    A[3, 4] += torque / rotor
    A[4, 5], A[5, 4] = -w, w
    for t in np.linspace(0.0, 0.3, 7)[1:]:
        x = expm(A * t) @ [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        now = result.at(t)
        got = [now.joint_angle, now.joint_rate, now.rotor_angle, now.rotor_rate]
        assert np.ravel(got) == pytest.approx(x[:4], rel=1e-8, abs=1e-10)


@pytest.mark.parametrize("method", ["exponential", "erk", "bdf"])
def test_an_input_that_fails_while_another_is_set_leaves_no_trace(method):
    fails = False

    def torque(t):
        if fails:
            raise ZeroDivisionError("no torque now")
        return [0.5 * np.sin(20.0 * t)] * 6

    robot = r3.Robot(3, controller=None)
    tried, plain = (r3.Simulator(robot, motor_torque=torque, method=method) for _ in range(2))
    tried.step(0.011)
    plain.step(0.011)
    fails = True
    with pytest.raises(ZeroDivisionError, match="no torque now"):
        tried.tip_force = [100.0, 0.0, 0.0]
    fails = False
    np.testing.assert_array_equal(tried.tip_force, 0.0)
    tried.step(0.02)
    plain.step(0.02)
    # The integration has been restarted, which BDF does at order 1: the accuracy of its default.
    assert tried.state == pytest.approx(plain.state, rel=0, abs=1e-8)
