"""Motions along paths and with limited jerk, by TOPP-RA and Ruckig."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import manutec_r3 as r3

ROBOT = r3.Robot(2, load=r3.Load(15.0))
WAYPOINTS = np.array([[0.0, 0.0, 0.0], [0.3, 0.6, 0.2], [1.0, 1.0, 0.6]])


def motor_torque(robot, motion, t):
    tau = robot.inverse_dynamics(motion.angle(t), motion.rate(t), motion.acceleration(t))
    return tau / robot.parameters["table_1"]["p"][:3]


def inside(motion, n=20001):
    return np.linspace(0.0, motion.duration, n)[:-1]


@pytest.fixture(scope="module")
def along():
    pytest.importorskip("toppra", reason="needs the extra paths")
    return r3.fastest_along(ROBOT, WAYPOINTS)


def test_it_stays_on_the_path(along):
    chords = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(WAYPOINTS, axis=0), axis=1)))
    path = CubicSpline(chords, WAYPOINTS, bc_type="natural")
    s = np.linspace(0.0, chords[-1], 200001)
    angles = along.angle(inside(along, 101))
    distance = [np.abs(path(s) - angle).max(axis=1).min() for angle in angles]
    assert max(distance) < 1e-5  # the points of the path are as far apart
    np.testing.assert_allclose(along.angle(0.0), WAYPOINTS[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(along.angle(along.duration), WAYPOINTS[-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(along.rate(along.duration * (1 - 1e-13)), 0.0, rtol=0, atol=1e-9)


def test_one_motor_is_always_at_a_limit_and_none_beyond(along):
    limits = np.full(3, 9.0), 315.0 / np.array([105.0, 210.0, 60.0])
    t = inside(along)
    used = np.hstack((motor_torque(ROBOT, along, t) / limits[0], along.rate(t) / limits[1]))
    largest = np.abs(used).max(axis=1)
    assert largest.max() < 1.0005  # between points of the grid; measured 1.00004
    # Fastest: at each instant something is at its limit, but for intervals where that changes.
    assert np.mean(largest > 0.99) > 0.95


def test_friction_may_be_largest_at_rest():
    """As much as that is left for it: where a table falls, the motion is slow at both ends."""
    falling = {"friction": {2: ((0.0, 3.0), (100.0, 0.2), (360.0, 0.3))}, "rM_h": {2: 3.0}}
    motion = r3.fastest_along(ROBOT.replace(table_2=falling), WAYPOINTS, friction=True)
    # TOPP-RA may exceed limits between the points of its grid; here it stays 4e-7 N m below.
    assert np.abs(motor_torque(ROBOT, motion, inside(motion)))[:, 1].max() < 6.000004


def test_no_random_path_leads_beyond_a_limit():
    """`fastest_along` itself refuses an excess of 1 %, which paths with many waypoints come to."""
    random = np.random.default_rng(0)
    for _ in range(20):
        size = (random.integers(2, 8), 3)
        motion = r3.fastest_along(ROBOT, random.uniform(-1.0, 1.0, size) * [2.5, 1.2, 2.0])
        assert np.abs(motor_torque(ROBOT, motion, inside(motion))).max() < 1.01 * 9.0


@pytest.mark.parametrize("apart", [0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1.1e-6])
def test_waypoints_may_be_close(along, apart):
    """There the path bends sharply: grids have all waypoints, where third derivatives jump."""
    between = WAYPOINTS[1] + [0.0, 0.0, apart]
    motion = r3.fastest_along(ROBOT, np.insert(WAYPOINTS, 2, between, axis=0))
    at_waypoints = [np.abs(motion.angle(motion.knots) - w).max(axis=1).min() for w in WAYPOINTS]
    assert max(at_waypoints) < 1e-12


def test_six_axes_go_along_a_path_and_with_limited_jerk():
    robot, end = r3.Robot(1, load=r3.Load(15.0)), [1.0, 1.0, 0.6, -0.2, -0.15, -0.1]
    along = r3.fastest_along(robot, [[0.0] * 6, end], friction=True)
    smooth = r3.jerk_limited_motion(robot, [0.0] * 6, end, 4.0, 50.0, friction=True)
    for motion in (along, smooth):
        np.testing.assert_allclose(motion.angle(motion.duration), end, rtol=0, atol=1e-12)
    assert along.duration < smooth.duration


def test_angles_beyond_their_limits_are_refused():
    """A spline overshoots its waypoints."""
    with pytest.raises(r3.OptimisationError, match=r"angle of axis 2: expected at most 2\.01 rad"):
        r3.fastest_along(ROBOT, [[0, 1.0, 0], [0, 2.01, 0], [0.4, 2.01, 0], [0.8, 1.0, 0]])


def test_a_finer_grid_finds_nearly_the_same_time(along):
    finer = r3.fastest_along(ROBOT, WAYPOINTS, n_grid=400)
    assert finer.duration == pytest.approx(along.duration, rel=1e-3)  # measured 2e-4
    assert finer.duration < along.duration


def test_friction_leaves_less_for_the_motion(along):
    slower = r3.fastest_along(ROBOT, WAYPOINTS, friction=True)
    assert slower.duration > along.duration
    left = 9.0 - np.array([0.53 + 155 * 0.13 / 160, 0.6 + 185 * 0.1 / 230, 0.9 + 185 * 0.1 / 230])
    assert (np.abs(motor_torque(ROBOT, slower, inside(slower))).max(axis=0) < 1.001 * left).all()


def test_the_motion_between_two_points_is_slower_than_the_optimal_one():
    pytest.importorskip("toppra", reason="needs the extra paths")
    pytest.importorskip("casadi", reason="needs the extra optimal")
    straight = r3.fastest_along(ROBOT, WAYPOINTS[[0, 2]])
    free = r3.optimal_motion(ROBOT, WAYPOINTS[0], WAYPOINTS[2], n_pieces=10, limit_tolerance=1e-2)
    assert free.duration < straight.duration


@pytest.fixture(scope="module")
def smooth():
    pytest.importorskip("ruckig", reason="needs the extra paths")
    return r3.jerk_limited_motion(ROBOT, [0, 0, 0], [1.0, 0.5, 0.0], [10.0, 8.0, 5.0], 100.0)


def test_rates_accelerations_and_jerks_are_limited_and_axes_arrive_at_once(smooth):
    t = inside(smooth)
    assert np.abs(smooth.rate(t)).max() <= 3.0
    assert (np.abs(smooth.acceleration(t)).max(axis=0) < [10.0 + 1e-9, 8.0 + 1e-9, 1e-9]).all()
    jerk = np.diff(smooth.acceleration(t), axis=0) / (t[1] - t[0])
    assert np.abs(jerk).max() < 100.0 + 1e-6  # so accelerations do not jump
    np.testing.assert_allclose(smooth.angle(smooth.duration), [1.0, 0.5, 0.0], rtol=0, atol=1e-12)


def test_axis_1_alone_takes_the_time_of_the_closed_form(smooth):
    """Seven phases without one at the rate limit: jerk j for a / j, cruise at a, and back."""
    a, j, way = 10.0, 100.0, 1.0
    ramp = a / j
    # way = v^2 / a + v a / j, and the motion takes 2 v / a + 2 a / j
    v = (-ramp + np.sqrt(ramp**2 + 4.0 * way / a)) * a / 2.0
    assert smooth.duration == pytest.approx(2.0 * v / a + 2.0 * ramp, abs=1e-12)


def test_torques_beyond_the_limits_are_refused():
    pytest.importorskip("ruckig", reason="needs the extra paths")
    asked = (ROBOT, [0, 0, 0], [1.0, 1.0, 0.6], 30.0, 1000.0)
    with pytest.raises(
        r3.OptimisationError, match=r"motor torque of axis \d: expected at most 9 N"
    ):
        r3.jerk_limited_motion(*asked)
    calm = (ROBOT, [0, 0, 0], [1.0, 0.0, 0.0], 3.0, 30.0)  # upright: as hard to drive as to brake
    motion = r3.jerk_limited_motion(*calm)
    needed = np.abs(motor_torque(ROBOT, motion, inside(motion))).max()
    r3.jerk_limited_motion(*calm, torque_limit=needed + 0.01)
    with pytest.raises(r3.OptimisationError, match="motor torque"):  # friction is added
        r3.jerk_limited_motion(*calm, torque_limit=needed + 0.01, friction=True)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"robot": r3.Robot("one-axis")}, ValueError, "robot: expected model 1, 2, 3 or 4"),
        ({"waypoints": [[0.0] * 3]}, ValueError, r"waypoints: expected shape \(n, 3\)"),
        ({"waypoints": [[0.0] * 3] * 2}, ValueError, "waypoints: expected each at least 1e-06 rad"),
        ({"torque_limit": -1.0}, ValueError, "torque_limit: expected more than 0"),
        ({"torque_limit": 0.5, "friction": True}, r3.OptimisationError, "friction of axis 1"),
        ({"torque_limit": 2.0}, r3.OptimisationError, "TOPP-RA found no motion along the path"),
        ({"friction": 1}, TypeError, "friction: expected True or False, got 1"),
        ({"n_grid": 1}, ValueError, "n_grid: expected 2 or more, got 1"),
    ],
)
def test_a_mistake_is_refused_at_the_door(arguments, error, message):
    pytest.importorskip("toppra", reason="needs the extra paths")
    with pytest.raises(error, match=message):
        r3.fastest_along(**{"robot": ROBOT, "waypoints": WAYPOINTS} | arguments)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"start": [0.0, 0.0]}, ValueError, r"start: expected 3 values \[rad\]"),
        ({"end": [0.0] * 3}, ValueError, "end: expected other angles than at the start"),
        ({"jerk_limit": 0.0}, ValueError, "jerk_limit: expected more than 0"),
    ],
)
def test_ruckig_is_asked_for_what_makes_sense(arguments, error, message):
    pytest.importorskip("ruckig", reason="needs the extra paths")
    usual = {"start": [0.0] * 3, "end": [0.5] * 3, "acceleration_limit": 5.0, "jerk_limit": 50.0}
    with pytest.raises(error, match=message):
        r3.jerk_limited_motion(ROBOT, **usual | arguments)


def test_without_the_planners_it_says_what_to_install(monkeypatch):
    import sys

    for name in ("toppra", "ruckig"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=r"pip install 'manutec-r3\[paths\]'"):
        r3.fastest_along(ROBOT, WAYPOINTS)
    with pytest.raises(ImportError, match=r"pip install 'manutec-r3\[paths\]'"):
        r3.jerk_limited_motion(ROBOT, [0.0] * 3, [1.0] * 3, 5.0, 50.0)
