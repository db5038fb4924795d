"""Numbers of one's own in Tables 1 to 3: laws by which the robot follows them."""

import pickle

import numpy as np
import pytest
from oracle_runs import BENT, ECCENTRIC, times_of

import manutec_r3 as r3
from manutec_r3 import Load, Robot
from manutec_r3.comparison.accuracy import sequence

MOTION = r3.Quintic(BENT, (0.1, -0.3, 0.6, 0.6, -0.4, 0.0), 0.25)
LOAD = Load(6.0, ECCENTRIC)
PLAIN = Robot(3, LOAD)


def row(table, symbol, robot=PLAIN):
    return np.array(robot.parameters[table][symbol])


def run(robot):
    return r3.simulate(robot, MOTION, 0.4, rtol=1e-11)


@pytest.fixture(scope="module")
def plain():
    return run(PLAIN)


def assert_same(scaled, plain, factors):
    """Assert that all signals are the same but for some factors."""
    assert sequence(scaled.events) == sequence(plain.events)
    assert len(plain.events) > 30
    # Powers of two do not round, but square roots in tolerances and other orders of products may:
    # measured are 3e-15 s, where a*b + c is rounded once 1.1e-13 s, and 4e-13 of the largest value.
    assert times_of(scaled.events) == pytest.approx(times_of(plain.events), rel=0, abs=1e-12)
    times = np.linspace(0.0, 0.4, 41)
    a, b = scaled.at(times), plain.at(times)
    for name in ("joint_angle", "rotor_rate", "motor_torque", "friction_torque", "voltage"):
        expected = getattr(b, name) * factors.get(name, 1.0)
        error = np.abs(getattr(a, name) - expected).max()
        assert error <= 4e-12 * np.abs(expected).max(), name


def test_half_the_voltage_is_enough_for_motors_of_twice_the_constant(plain):
    stronger = PLAIN.replace(
        table_1={
            "K_M": 2.0 * row("table_1", "K_M"),
            "K_S": 0.5 * row("table_1", "K_S"),
            "a": 0.5 * row("table_1", "a"),
        }
    )
    assert_same(run(stronger), plain, {"voltage": 0.5})


def test_controllers_and_tachogenerators_in_other_units_do_the_same(plain):
    finer = PLAIN.replace(
        table_1={
            **{name: 4.0 * row("table_1", name) for name in ("K_V", "K_D", "K_T")},
            "K_S": 0.25 * row("table_1", "K_S"),
        }
    )
    assert_same(run(finer), plain, {})


def test_a_robot_of_twice_the_mass_moves_alike_under_twice_the_torques(plain):
    # Everything that weighs, holds, rubs or drives doubles: units of mass are free.
    arms = {
        axis: {name: 2.0 * arm[name] for name in ("mass", "I11", "I22", "I33", "I13")}
        for axis, arm in enumerate(PLAIN.parameters["table_3"]["arms"], start=1)
    }
    friction = {
        axis: [(rate, 2.0 * torque) for rate, torque in points]
        for axis, points in enumerate(PLAIN.parameters["table_2"]["friction"], start=1)
    }
    heavier = Robot(
        3,
        Load(2.0 * LOAD.mass, LOAD.position),
        table_1={name: 2.0 * row("table_1", name) for name in ("K_M", "b")},
        table_2={
            **{name: 2.0 * row("table_2", name) for name in ("c", "d", "rM_h")},
            "friction": friction,
        },
        table_3={"arms": arms, "rJ": 2.0 * row("table_3", "rJ")},
    )
    assert_same(run(heavier), plain, {"motor_torque": 2.0, "friction_torque": 2.0})
    q = np.array(BENT)
    assert heavier.mass_matrix(q) == pytest.approx(2.0 * PLAIN.mass_matrix(q), rel=1e-14)


@pytest.mark.parametrize("model", [1, 2, 3, 4, "full-robot"])
def test_holding_torques_are_proportional_to_gravity(model):
    def holding(gravity):
        robot = Robot(model, table_3={"gravity": gravity})
        rest = np.zeros(robot.n_axes)
        return robot.inverse_dynamics(np.array(BENT[: robot.n_axes]), rest, rest)

    np.testing.assert_array_equal(holding(0.0), 0.0)
    assert np.abs(holding(9.81)).max() > 100.0
    assert holding(1.62) == pytest.approx(1.62 / 9.81 * holding(9.81), rel=1e-13)


def test_without_gravity_a_robot_rests_without_torques_and_does_not_sag():
    robot = PLAIN.replace(table_3={"gravity": 0.0})
    simulator = r3.Simulator(robot, r3.Hold(BENT))
    for signal in ("motor_torque", "friction_torque", "gear_torque", "voltage", "control_error"):
        assert getattr(simulator, signal) == pytest.approx(np.zeros(6), rel=0, abs=1e-12), signal


def test_a_softer_gear_sags_in_inverse_proportion_to_its_stiffness():
    def sag(factor):
        robot = PLAIN.replace(table_2={"b": 0.0, "c": row("table_2", "c") / factor})
        simulator = r3.Simulator(robot, r3.Hold(BENT))
        return simulator.control_error[:3], simulator.motor_torque[:3] / row("table_2", "c")

    (once, of_torque), (twice, of_torque_twice) = sag(1.0), sag(2.0)
    # deflection tau / c, at the joint / p
    assert once == pytest.approx(of_torque / row("table_1", "p")[:3], rel=1e-9, abs=1e-14)
    assert twice == pytest.approx(
        2.0 * of_torque_twice / row("table_1", "p")[:3], rel=1e-9, abs=1e-14
    )


def test_a_wider_dead_zone_takes_more_voltage_for_the_same_torque():
    wider = PLAIN.replace(table_1={"a": {2: 0.5}})
    plain, other = (r3.Simulator(robot, r3.Hold(BENT)) for robot in (PLAIN, wider))
    np.testing.assert_array_equal(other.motor_torque, plain.motor_torque)
    more = np.sign(plain.motor_torque[1]) * (0.5 - 0.094)
    assert other.voltage - plain.voltage == pytest.approx([0, more, 0, 0, 0, 0], abs=1e-14)


def test_a_lower_torque_limit_is_where_the_motors_stop():
    result = r3.simulate(PLAIN.replace(table_1={"b": 1.5}), MOTION, 0.25)
    # Roundoff where it has just been reached.
    assert np.abs(result.motor_torque).max() == pytest.approx(1.5, rel=1e-15)
    assert "torque_limit" in result.events.element


# --- the same robot again -------------------------------------------------------------------------


def test_what_is_replaced_is_added_to_what_was_replaced_before():
    once = Robot(3, table_1={"K_V": 0.35, "K_D": 0.02}, table_3={"gravity": 1.62})
    twice = once.replace(table_1={"K_V": 0.4, "a": {1: 0.1}}, table_2={"b": 0.02})
    assert twice == Robot(
        3,
        table_1={"K_V": 0.4, "K_D": 0.02, "a": {1: 0.1}},
        table_2={"b": 0.02},
        table_3={"gravity": 1.62},
    )
    assert once == Robot(3, table_1={"K_V": 0.35, "K_D": 0.02}, table_3={"gravity": 1.62})
    assert twice.replace(table_1=None, table_2=None, table_3=None) == Robot(3)


ROBOTS = [
    PLAIN,
    Robot(2, arm="six-arm", controller=None),
    Robot(3, controller="sampled", rotor_coupling="full", gear_damping="contact"),
    Robot(3, stiction="stiff-spring", stiffness=1e6, creep_rate=0.0, voltage_limit=10.0),
    Robot(1, rotor_coupling=("full", "simplified", "full", "simplified", "full", "full")),
    Robot(3, table_1={"K_V": {2: 0.4}, "a": np.full(6, 0.1)}, table_3={"gravity": 1.62}),
    Robot(
        4,
        table_2={"friction": {1: [(0.0, 0.3), (100.0, 0.5)]}},
        table_3={"joint_limits": {1: np.inf}},
    ),
    Robot("full-robot"),
    Robot("one-axis", controller=None),
]


@pytest.mark.parametrize("robot", ROBOTS, ids=range(len(ROBOTS)))
def test_what_a_robot_prints_and_pickles_is_that_robot(robot):
    names = {"array": np.array, "inf": np.inf}
    exec("from manutec_r3 import *", names)
    for again in (eval(repr(robot), names), pickle.loads(pickle.dumps(robot))):
        assert again == robot
        assert hash(again) == hash(robot)
        assert again.parameters == robot.parameters
    assert sum(other == robot for other in ROBOTS) == 1


def test_nobody_can_change_the_tables_of_a_robot():
    given = {"K_V": np.full(6, 0.35), "a": {2: 0.05}}
    robot = r3.Robot(3, table_1=given)
    given["K_V"][0] = given["a"][2] = 9.0
    with pytest.raises(TypeError, match="does not support item assignment"):
        robot.table_1["K_V"] = 0.9
    with pytest.raises(TypeError, match="does not support item assignment"):
        robot.table_1["a"][2] = 0.9
    robot.parameters["table_1"]["K_V"][0] = 7.0
    assert robot.parameters["table_1"]["K_V"] == [0.35] * 6
    assert pickle.loads(pickle.dumps(robot)) == robot == r3.Robot(3, table_1=dict(robot.table_1))
