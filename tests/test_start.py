"""Where a run begins: at rest with rotors or arms on the reference, or in a state of one's own."""

import independent
import numpy as np
import pytest
from independent import BACKLASH, DEAD_ZONE, GEAR_RATIO, K_M, STIFFNESS, IndependentRobot
from oracle_runs import BENT, ECCENTRIC, RUNS

import manutec_r3 as r3

MODELS = [1, 2, 3, 4]


def axes(model):
    return 6 if model in (1, 3) else 3


def at_rest(model, angles=BENT, start="rotor"):
    """A simulator at rest, with the load that all tests here carry."""
    robot = r3.Robot(model=model, load=r3.Load(11.0, ECCENTRIC))
    return r3.Simulator(robot, r3.Hold(angles[: axes(model)]), start=start)


def group(robot, state, name):
    """The states of one quantity."""
    return np.array(
        [
            x
            for x, label in zip(state, robot.state_names, strict=True)
            if label.split("[")[0] == name
        ]
    )


@pytest.mark.parametrize("model", MODELS)
def test_rotors_are_on_the_reference(model):
    simulator = at_rest(model)
    reference = GEAR_RATIO[: axes(model)] * BENT[: axes(model)]
    # Where gears are elastic rotors are deflection + p * joint: roundoff.
    assert simulator.rotor_angle == pytest.approx(reference, rel=1e-14)


@pytest.mark.parametrize("model", MODELS)
def test_motors_hold_the_arms_against_gravity(model):
    simulator = at_rest(model)
    oracle = IndependentRobot(model, 11.0, ECCENTRIC)
    gravity = oracle.bias(simulator.joint_angle, np.zeros(axes(model)))
    expected = gravity / oracle.ratio
    np.testing.assert_array_equal(np.abs(expected) > 1e-3, [False, *[True] * (axes(model) - 1)])
    assert simulator.motor_torque == pytest.approx(expected, rel=1e-13, abs=1e-13)
    assert simulator.gear_torque == pytest.approx(expected, rel=1e-12, abs=1e-13)
    assert simulator.friction_torque == pytest.approx(np.zeros(axes(model)), abs=1e-13)


@pytest.mark.parametrize("model", [3, 4])
def test_arms_sag_by_the_deflection_of_their_gears(model):
    simulator = at_rest(model)
    torque = simulator.motor_torque[:3]
    deflection = torque / STIFFNESS + BACKLASH * np.sign(torque)
    sag = simulator.control_error[:3] - deflection / GEAR_RATIO[:3]
    assert sag == pytest.approx(np.zeros(3), abs=1e-15)  # roundoff of angles near 1 rad
    assert abs(simulator.control_error[1]) > 3e-4
    np.testing.assert_array_equal(
        simulator.branches["backlash"], [0, *np.sign(torque[1:2]), 0] + [0] * (axes(model) - 3)
    )


@pytest.mark.parametrize("model", [1, 2])
def test_arms_with_ideal_gears_do_not_sag(model):
    np.testing.assert_array_equal(at_rest(model).control_error, np.zeros(axes(model)))


@pytest.mark.parametrize("model", MODELS)
def test_controllers_stand_where_they_hold_the_torque(model):
    simulator, n = at_rest(model), axes(model)
    torque = simulator.motor_torque
    voltage = torque / K_M[:n] + DEAD_ZONE[:n] * np.sign(torque)
    assert simulator.voltage == pytest.approx(voltage, rel=1e-14, abs=1e-15)
    controller = group(simulator.robot, simulator.state, "controller")
    np.testing.assert_array_equal(controller, simulator.voltage)
    for quiet in ("tachogenerator_1", "tachogenerator_2", "tachogenerator_3", "filter"):
        np.testing.assert_array_equal(group(simulator.robot, simulator.state, quiet), np.zeros(n))
    np.testing.assert_array_equal(simulator.branches["dead_zone"], np.sign(torque))


@pytest.mark.parametrize("start", ["rotor", "arm"])
@pytest.mark.parametrize("model", MODELS)
def test_nothing_accelerates_at_rest(model, start):
    simulator = at_rest(model, start=start)
    np.testing.assert_array_equal(simulator.joint_rate, np.zeros(axes(model)))
    # Kilonewtonmetres balance to roundoff, on inertias of half a kg m^2 and more.
    assert np.abs(simulator.joint_acceleration).max() <= 1e-11


@pytest.mark.parametrize("model", MODELS)
def test_the_state_at_rest_is_that_of_the_independent_implementation(model):
    simulator = at_rest(model)
    oracle = IndependentRobot(model, 11.0, ECCENTRIC)
    expected = oracle.rest_state(independent.Hold(BENT[: axes(model)]))
    for name in ("joint_angle", "pt2_torque", "voltage", "controller"):
        got = group(simulator.robot, simulator.state, name)
        assert got == pytest.approx(expected[oracle.slices[name]], rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("model", MODELS)
def test_upright_everything_is_exactly_zero(model):
    robot = r3.Robot(model=model, load=r3.Load(15.0))
    np.testing.assert_array_equal(robot.rest_state(r3.Hold(np.zeros(axes(model)))), 0.0)


def test_a_torque_of_roundoff_counts_as_zero():
    # Leaning by 1e-17 rad takes 1e-17 N m: no reason to go to one edge of dead zone and backlash.
    state = r3.Robot(model=3).rest_state(r3.Hold([0.0, 1e-17, 0.0, 0.0, 0.0, 0.0]))
    np.testing.assert_array_equal(state[6:], 0.0)
    leaning = r3.Robot(model=3).rest_state(r3.Hold([0.0, 1e-9, 0.0, 0.0, 0.0, 0.0]))
    deflection = group(r3.Robot(model=3), leaning, "deflection")
    assert abs(deflection[1]) > 0.06


@pytest.mark.parametrize("model", MODELS)
def test_a_start_at_rest_has_no_event_at_once(model):
    robot = r3.Robot(model=model, load=r3.Load(15.0))
    end = np.array(BENT[: axes(model)])
    motion = r3.Quintic(np.zeros(axes(model)), end, 1.0)
    first = r3.Simulator(robot, motion).step_to_event()
    assert first.element == "dead_zone"
    assert first.time > 1e-3


def test_arms_are_on_the_reference_if_asked_for():
    simulator = at_rest(3, start="arm")
    np.testing.assert_array_equal(simulator.joint_angle, BENT)
    np.testing.assert_array_equal(simulator.control_error, 0.0)
    torque = simulator.motor_torque
    deflection = simulator.rotor_angle - GEAR_RATIO * BENT
    expected = torque[:3] / STIFFNESS + BACKLASH * np.sign(torque[:3])
    assert deflection[:3] == pytest.approx(expected, rel=0, abs=1e-12)  # of angles of 100 rad
    np.testing.assert_array_equal(deflection[3:], 0.0)
    # The controllers want their rotors back: only rest is lost, not balance.
    assert len(simulator.step(0.5)) > 0


def test_arms_or_rotors_on_the_reference_are_the_same_without_elastic_gears():
    motion, robot = r3.Hold(BENT), r3.Robot(model=1, load=r3.Load(4.0))
    np.testing.assert_array_equal(
        robot.rest_state(motion, "arm"), robot.rest_state(motion, "rotor")
    )


def test_a_start_names_its_state():
    robot, motion = r3.Robot(model=3), r3.Hold(BENT)
    for start in ("rotor", "arm"):
        by_state = r3.simulate(robot, motion, 0.05, start=robot.rest_state(motion, start))
        by_name = r3.simulate(robot, motion, 0.05, start=start)
        np.testing.assert_array_equal(by_name.state, by_state.state)


def test_a_pose_that_a_motor_cannot_hold_is_refused():
    heavy = r3.Load(mass=80.0, bounds=False)
    lying = r3.Hold([0.0, np.pi / 2, 0.0])
    with pytest.raises(
        ValueError, match=r"motor of axis 3 would need -14\.8\d+ N m.* at most 9 N m"
    ):
        r3.simulate(r3.Robot(model=4, load=heavy), lying, 0.1)
    r3.simulate(r3.Robot(model=4, load=r3.Load(mass=15.0)), lying, 0.01)


def test_the_load_of_table_3_needs_the_torques_of_the_specification():
    robot = r3.Robot(model=2, load=r3.Load(mass=15.0))
    torque = r3.Simulator(robot, r3.Hold([0.0, np.pi / 2, 0.0])).joint_torque
    assert torque == pytest.approx([0.0, -746.7, -263.7], abs=0.05)  # printed digits


# --- states of one's own --------------------------------------------------------------------------


def test_a_state_holds_what_it_was_made_from():
    robot = r3.Robot(model=3)
    rng = np.random.default_rng(2)
    q, qd, torque = rng.normal(size=(3, 6))
    rotor_angle, rotor_rate = GEAR_RATIO * q, GEAR_RATIO * qd
    rotor_angle[:3] += [0.2, -0.1, 0.05]
    rotor_rate[:3] += [3.0, -2.0, 1.0]
    state = robot.state_from(q, qd, rotor_angle, rotor_rate, torque)
    simulator = r3.Simulator(robot, r3.Hold(q), start=state)
    np.testing.assert_array_equal(simulator.joint_angle, q)
    np.testing.assert_array_equal(simulator.joint_rate, qd)
    assert simulator.rotor_angle == pytest.approx(rotor_angle, rel=1e-14)
    np.testing.assert_array_equal(simulator.rotor_rate[:3], rotor_rate[:3])
    np.testing.assert_array_equal(simulator.motor_torque, torque)
    np.testing.assert_array_equal(simulator.branches["backlash"], [1, -1, 0, 0, 0, 0])
    np.testing.assert_array_equal(simulator.branches["friction"], np.sign(rotor_rate))


def test_rotors_follow_their_joints_unless_given():
    robot = r3.Robot(model=3)
    simulator = r3.Simulator(
        robot, r3.Hold(BENT), start=robot.state_from(BENT, [0.1, -0.2, 0.3, -0.4, 0.5, -0.6])
    )
    assert simulator.rotor_angle == pytest.approx(GEAR_RATIO * BENT, rel=1e-15)
    assert simulator.rotor_rate == pytest.approx(GEAR_RATIO * simulator.joint_rate, rel=1e-15)
    np.testing.assert_array_equal(group(robot, simulator.state, "deflection"), 0.0)


def test_a_rotor_on_a_rigid_gear_cannot_be_elsewhere_than_its_joint():
    rotor_angle = GEAR_RATIO * BENT
    rotor_angle[4] += 0.1
    with pytest.raises(ValueError, match="rotor_angle of axis 5: the gear is rigid"):
        r3.Robot(model=3).state_from(BENT, rotor_angle=rotor_angle)
    with pytest.raises(ValueError, match="rotor_angle of axis 5: the gear is rigid"):
        r3.Robot(model=1).state_from(BENT, rotor_angle=rotor_angle)


def test_a_value_on_an_edge_goes_where_its_rate_points():
    robot = r3.Robot(model=3)
    for rate, branch in ((1.0, 1), (-1.0, 0), (0.0, 0)):
        start = robot.state_from(np.zeros(6), None, [0.01, 0, 0, 0, 0, 0], [rate, 0, 0, 0, 0, 0])
        simulator = r3.Simulator(robot, r3.Hold(np.zeros(6)), start=start)
        assert simulator.branches["backlash"][0] == branch


@pytest.mark.parametrize("edge", [-1.0, 1.0])
@pytest.mark.parametrize("way", [-0.3, 0.3])
def test_a_value_that_rests_on_an_edge_leaves_it_either_way(edge, way):
    """The backlash of axis 1 in model 3, the dead zone of axis 1 in model 2: zero rate at first."""
    robot = r3.Robot(model=3)
    start = robot.state_from([0.0] * 6, rotor_angle=[0.01 * edge, 0, 0, 0, 0, 0])
    motion = r3.Quintic([0.0] * 6, [way, 0, 0, 0, 0, 0], 0.5)
    after = r3.simulate(robot, motion, 0.05, start=start).at(0.05)
    deflection = after.rotor_angle[0, 0] + 105 * after.joint_angle[0, 0]
    outside = np.sign(deflection) * (abs(deflection) > 0.01)
    assert after.branches["backlash"][0, 0] == outside
    assert after.branches["friction"][0, 0] == -np.sign(way)  # p < 0; it has broken away

    robot = r3.Robot(model=2)
    motion = r3.Quintic([0.0] * 3, [way, 0, 0], 0.5)
    start = robot.rest_state(motion)
    for name in ("voltage[1]", "controller[1]"):
        start[robot.state_names.index(name)] = 0.094 * edge
    result = r3.simulate(robot, motion, 0.05, start=start)
    outside = np.sign(result.voltage[:, 0]) * (np.abs(result.voltage[:, 0]) > 0.094)
    inner = np.abs(np.abs(result.voltage[:, 0]) - 0.094) > 1e-9  # at an edge itself either is right
    np.testing.assert_array_equal(result.branches["dead_zone"][inner, 0], outside[inner])
    assert len(result.events) < 20


def test_a_run_may_begin_in_a_torque_limit():
    run = RUNS["1-hold-disturbed"]
    state = run.robot.state_from(**run.start, motor_torque=[10.0, 0.0, -9.5, 0.0, 0.0, 0.0])
    simulator = r3.Simulator(run.robot, r3.Hold(BENT), start=state)
    np.testing.assert_array_equal(simulator.branches["torque_limit"], [1, 0, -1, 0, 0, 0])
    np.testing.assert_array_equal(simulator.motor_torque, [9.0, 0.0, -9.0, 0.0, 0.0, 0.0])
