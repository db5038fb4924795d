"""The arm alone: multibody data, equations of motion with ideal gears, kinematics."""

import json
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from independent import IndependentRobot

import manutec_r3 as r3

# Computed with the original routine R3M2SI (Otter, Tuerk: The DFVLR models 1 and 2 of the Manutec
# r3 robot, DFVLR-Mitt. 88-13, 1988).
R3M2SI = json.loads((files("manutec_r3.comparison") / "references" / "r3m2si.json").read_text())[
    "cases"
]

ROBOTS = [
    r3.Robot(model=model, load=load)
    for model in (1, 2, 3, 4)
    for load in (r3.Load(), r3.Load(mass=15.0), r3.Load(mass=7.5, position=(0.06, -0.08, 0.2)))
]


def motion_states(robot, n=50):
    """Random angles, rates within the joint rate limits, and accelerations."""
    random = np.random.default_rng(20241)
    shape = (n, robot.n_axes)
    return random.uniform(-3, 3, shape), random.uniform(-4, 4, shape), random.normal(0, 20, shape)


def relative_error(actual, expected):
    """Largest error of each row relative to the row's largest component."""
    return np.max(np.abs(actual - expected), -1) / np.max(np.abs(expected), -1)


@pytest.mark.parametrize("algorithm", ["composite", "articulated"])
@pytest.mark.parametrize("case", R3M2SI)
def test_accelerations_of_the_original_routine_are_reproduced(case, algorithm):
    robot = r3.Robot(model=2, load=r3.Load(mass=case["load_mass"]))
    qdd = robot.forward_dynamics(case["q"], case["qd"], case["tau"], algorithm=algorithm)
    # Roundoff of a 3 by 3 solve, about 1e-15, with room for the conditioning of M.
    assert relative_error(qdd, np.array(case["qdd"])) < 1e-12


@pytest.mark.parametrize("robot", ROBOTS, ids=repr)
def test_equations_agree_with_jacobians_in_world_coordinates(robot):
    oracle = IndependentRobot(robot.model, robot.load.mass, robot.load.position)
    q, qd, tau = motion_states(robot)
    for k in range(len(q)):
        # Roundoff of sums of some hundred terms: 1e-15 to 1e-14.
        np.testing.assert_allclose(robot.mass_matrix(q[k]), oracle.mass_matrix(q[k]), atol=1e-12)
        expected = oracle.forward_dynamics(q[k], qd[k], tau[k])
        assert relative_error(robot.forward_dynamics(q[k], qd[k], tau[k]), expected) < 1e-11


@pytest.mark.parametrize("robot", ROBOTS, ids=repr)
def test_forward_and_inverse_dynamics_are_inverse_to_each_other(robot):
    q, qd, qdd = motion_states(robot)
    tau = robot.inverse_dynamics(q, qd, qdd)
    bias = robot.inverse_dynamics(q, qd, np.zeros_like(qdd))
    inertial = np.einsum("kij,kj->ki", robot.mass_matrix(q), qdd)
    # Identities: only roundoff, amplified by the condition number of M, about 1e3.
    assert relative_error(inertial + bias, tau).max() < 1e-13
    for algorithm in ("composite", "articulated"):
        found = robot.forward_dynamics(q, qd, tau, algorithm=algorithm)
        assert relative_error(found, qdd).max() < 1e-11


@pytest.mark.parametrize("robot", ROBOTS, ids=repr)
def test_articulated_bodies_agree_with_composite_bodies(robot):
    q, qd, tau = motion_states(robot)
    composite = robot.forward_dynamics(q, qd, tau)
    articulated = robot.forward_dynamics(q, qd, tau, algorithm="articulated")
    assert relative_error(articulated, composite).max() < 1e-12  # roundoff


@pytest.mark.parametrize("robot", ROBOTS, ids=repr)
def test_mass_matrix_is_symmetric_and_positive_definite(robot):
    M = robot.mass_matrix(motion_states(robot)[0])
    np.testing.assert_array_equal(M, np.swapaxes(M, 1, 2))
    # Every axis carries at least its own rotor, and none less than axis 6: p^2 rJ = 0.42 kg m^2.
    # Coupling takes a little of it away.
    assert np.linalg.eigvalsh(M).min() > 0.4


@pytest.mark.parametrize("robot", ROBOTS, ids=repr)
def test_power_of_the_torques_is_the_change_of_energy(robot):
    """The kinetic energy of M and the potential energy of the load and the arms."""
    q, qd, qdd = motion_states(robot, n=5)
    arms = potential_bodies(robot)

    def energy(q, qd):
        poses = robot.link_poses(q)
        potential = sum(m * 9.81 * (poses[arm] @ [*centre, 1.0])[2] for arm, m, centre in arms)
        return 0.5 * qd @ robot.mass_matrix(q) @ qd + potential

    for k in range(len(q)):
        h = 1e-5  # [s], central differences: error h^2 times the third derivative, about 1e-8
        later = energy(q[k] + h * qd[k] + h**2 / 2 * qdd[k], qd[k] + h * qdd[k])
        earlier = energy(q[k] - h * qd[k] + h**2 / 2 * qdd[k], qd[k] - h * qdd[k])
        power = robot.inverse_dynamics(q[k], qd[k], qdd[k]) @ qd[k]
        scale = np.abs(robot.inverse_dynamics(q[k], qd[k], qdd[k])) @ np.abs(qd[k])
        assert abs((later - earlier) / (2 * h) - power) < 1e-6 * scale


def potential_bodies(robot):
    """(arm, mass, centre of mass) of everything that has weight."""
    table = robot.parameters["table_3"]
    arms = list(enumerate(table["arms"], start=1))
    if robot.n_axes == 3:
        arms = [*arms[:2], (3, table["lumped_arm_3"])]
    bodies = [(arm, data["mass"], data["centre_of_mass"]) for arm, data in arms]
    return [*bodies, (6, robot.load.mass, robot.load.position)]


def test_no_gravity_torque_acts_on_the_stretched_robot():
    for robot in (r3.Robot(model=m, load=r3.Load(mass=15.0)) for m in (1, 2, 3, 4)):
        zero = np.zeros(robot.n_axes)
        centred = [0.0 if abs(t) < 1e-13 else t for t in robot.inverse_dynamics(zero, zero, zero)]
        assert centred == [0.0] * robot.n_axes  # 1e-13 N m: roundoff of torques of 1000 N m


def test_holding_torques_of_the_horizontal_arm():
    """Printed in the specification: section 3, last paragraph."""
    robot = r3.Robot(model=2, load=r3.Load(mass=15.0))
    q = [0.0, np.pi / 2, 0.0]
    tau = robot.inverse_dynamics(q, [0.0] * 3, [0.0] * 3)
    np.testing.assert_allclose(tau[1:], [-746.7, -263.7], atol=0.05)  # the printed digits
    # A position: roundoff of one multiplication.
    np.testing.assert_allclose(robot.load_position(q), [0.0, -1.48, 0.0], atol=1e-15)


def test_tables_are_those_of_the_report():
    tables = r3.Robot().parameters
    assert tables["table_1"]["p"] == [-105, 210, 60, -99, 79.2, -99]
    assert tables["table_1"]["K_M"] == [1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842]
    assert tables["table_1"]["w_i"] == [4590, 5500, 5500, 6250, 6250, 7400]
    assert tables["table_1"]["a"] == [0.094, 0.094, 0.094, 0.022, 0.096, 0.044]
    assert tables["table_2"]["c"] == [43, 8, 58]
    assert tables["table_2"]["b"] == [0.01, 0.06, 0.0]
    assert tables["table_2"]["rM_h"] == [0.4, 0.5, 0.7, 0.27, 0.5, 0.17]
    assert tables["table_2"]["friction"][1] == ((0, 0.5), (130, 0.6), (360, 0.7))
    assert tables["table_3"]["rJ"] == [1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5]
    assert tables["table_3"]["arms"][1]["mass"] == 56.5
    assert tables["table_3"]["lumped_arm_3"]["I13"] == 0.33
    assert tables["table_3"]["joint_limits"] == [2.97, 2.01, 2.86, np.inf, np.inf, np.inf]


@pytest.mark.parametrize(
    ("model", "axes", "states", "indicators"),
    [(1, 6, 60, 24), (2, 3, 30, 12), (3, 6, 66, 42), (4, 3, 36, 24)],
)
def test_orders_and_indicators_are_those_of_table_4(model, axes, states, indicators):
    robot = r3.Robot(model=model)
    assert (robot.n_axes, robot.n_states, robot.n_indicators) == (axes, states, indicators)
    assert len(set(robot.state_names)) == len(robot.state_units) == states
    assert len(robot.state_nominals) == states and (robot.state_nominals > 0).all()
    assert len(set(robot.indicator_names)) == indicators


@settings(max_examples=50, deadline=None, derandomize=True)
@given(
    shift=st.floats(-3, 3),
    pose=st.lists(st.floats(-3, 3), min_size=6, max_size=6),
    mass=st.floats(0, 15),
)
def test_turning_the_whole_robot_about_the_vertical_changes_nothing(shift, pose, mass):
    robot = r3.Robot(model=1, load=r3.Load(mass=mass))
    turned = [pose[0] + shift, *pose[1:]]
    np.testing.assert_array_equal(robot.mass_matrix(turned), robot.mass_matrix(pose))
    c, s = np.cos(shift), np.sin(shift)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    # Roundoff of a position of at most 1.5 m.
    np.testing.assert_allclose(
        robot.load_position(turned), turn @ robot.load_position(pose), atol=1e-14
    )


@settings(max_examples=50, deadline=None, derandomize=True)
@given(pose=st.lists(st.floats(-3, 3), min_size=6, max_size=6), mass=st.floats(0.1, 15))
def test_load_adds_its_weight_at_its_place(pose, mass):
    """Gravity torques of the load are minus its weight times the gradient of its height."""
    loaded, empty = r3.Robot(model=1, load=r3.Load(mass=mass)), r3.Robot(model=1)
    zero = np.zeros(6)
    added = loaded.inverse_dynamics(pose, zero, zero) - empty.inverse_dynamics(pose, zero, zero)
    h = 1e-5
    step = h * np.eye(6)
    height = loaded.load_position(pose + step)[:, 2] - loaded.load_position(pose - step)[:, 2]
    # Central differences: h^2 times a height of 1.5 m, and roundoff / h, both below 1e-9 m.
    np.testing.assert_allclose(added, mass * 9.81 * height / (2 * h), atol=1e-7)


def test_link_poses_are_rotations_at_the_joints():
    robot = r3.Robot(model=1)
    poses = robot.link_poses(motion_states(robot)[0])
    R = poses[..., :3, :3]
    # Orthonormal to roundoff.
    np.testing.assert_allclose(R @ np.swapaxes(R, -1, -2), np.broadcast_to(np.eye(3), R.shape),
                               atol=1e-14)  # fmt: skip
    np.testing.assert_array_equal(poses[:, 0], np.broadcast_to(np.eye(4), (len(poses), 4, 4)))


@pytest.mark.parametrize("model", [1, 2])
def test_world_and_frames_of_the_arms(model):
    robot = r3.Robot(model=model, load=r3.Load(mass=15.0, position=(0.0, 0.0, 0.25)))
    zero = np.zeros(robot.n_axes)
    stretched = robot.link_poses(zero)
    np.testing.assert_array_equal(stretched[:, :3, :3], np.tile(np.eye(3), (7, 1, 1)))
    # Joints 1 and 2, 3 and 4, 5 and 6 are at one place each, and all above each other.
    np.testing.assert_array_equal(stretched[:, :2, 3], 0.0)
    np.testing.assert_array_equal(stretched[:, 2, 3], [0, 0, 0, 0.5, 0.5, 1.23, 1.23])
    assert robot.load_position(zero) == pytest.approx([0, 0, 1.48], rel=1e-15)  # a sum
    # A positive angle of axis 2 leans the arm towards -y.
    leaning = robot.load_position([0, np.pi / 2, *zero[2:]])
    assert leaning == pytest.approx([0, -1.48, 0], rel=1e-15, abs=1e-15)


def test_gears_of_the_arm_alone_are_ideal_in_every_model():
    p2rJ = np.multiply([105, 210, 60, 99, 79.2, 99], [105, 210, 60, 99, 79.2, 99])
    p2rJ = p2rJ * [1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5]
    for model in (1, 3):
        M = r3.Robot(model=model).mass_matrix(np.zeros(6))
        assert np.all(np.diag(M) >= p2rJ * (1.0 - 1e-15))
    full, simplified = (r3.Robot(model=model).mass_matrix([0.1] * 6) for model in (1, 3))
    np.testing.assert_allclose(np.diag(full), np.diag(simplified), rtol=4e-15)  # roundoff
    assert full[0, 1] == pytest.approx(simplified[0, 1], abs=1e-12)  # rotor 2 lies across axis 1
    # Rotor 3 spins about an axis parallel to joint 2: coupled in model 1 only, p_3 rJ_3.
    assert full[1, 2] - simplified[1, 2] == pytest.approx(60 * 1.3e-3, rel=1e-10)


def test_arrays_of_poses_are_evaluated_row_by_row():
    robot = r3.Robot(model=1, load=r3.Load(mass=3.0))
    q, qd, tau = (a.reshape(5, 10, 6) for a in motion_states(robot))
    qdd = robot.forward_dynamics(q, qd, tau)
    assert qdd.shape == (5, 10, 6)
    np.testing.assert_array_equal(qdd[3, 4], robot.forward_dynamics(q[3, 4], qd[3, 4], tau[3, 4]))
    assert robot.mass_matrix(q).shape == (5, 10, 6, 6)
    assert robot.link_poses(q).shape == (5, 10, 7, 4, 4)
    assert robot.load_position(q).shape == (5, 10, 3)
    one_pose = robot.forward_dynamics(q[0, 0], qd, tau)  # broadcast
    np.testing.assert_array_equal(
        one_pose[2, 3], robot.forward_dynamics(q[0, 0], qd[2, 3], tau[2, 3])
    )


def test_wrong_arguments_of_the_arm_are_refused():
    robot = r3.Robot(model=2)
    good = np.zeros(3)
    with pytest.raises(ValueError, match=r"q: expected 3 values \[rad\].*got shape \(6,\)"):
        robot.forward_dynamics(np.zeros(6), good, good)
    with pytest.raises(ValueError, match=r"tau of axis 2: .*finite.*\[N m\], got nan"):
        robot.forward_dynamics(good, good, [0.0, np.nan, 0.0])
    with pytest.raises(ValueError, match=r"shapes.*q \(2, 3\), qd \(4, 3\)"):
        robot.inverse_dynamics(np.zeros((2, 3)), np.zeros((4, 3)), good)
    with pytest.raises(TypeError, match=r"q: expected 3 numbers \[rad\], one per axis"):
        robot.mass_matrix("home")
    with pytest.raises(ValueError, match=r"algorithm: expected .* got 'fast'"):
        robot.forward_dynamics(good, good, good, algorithm="fast")
