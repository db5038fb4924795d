"""Optimal motions: published optima, limits between the points, arrival under the torques alone.

The published task: model 2 without load from (0, -1.5, 0) to (1, -1.95, 1) rad, volts within 7.5 V
at 1.2 N m/V, so that motor torques are within 9 N m; rates within (3.0, 1.5, 5.2) rad/s (von Stryk,
Schlemmer, 1994; spec 10).
"""

import pickle

import numpy as np
import pytest

import manutec_r3 as r3

UNLOADED = r3.Robot(2)
LOADED = r3.Robot(2, load=r3.Load(15.0))
PUBLISHED = {
    "robot": UNLOADED,
    "start": (0.0, -1.5, 0.0),
    "end": (1.0, -1.95, 1.0),
    "effort": "voltage",
    "torque_per_volt": 1.2,
    "torque_limit": 7.5 * 1.2,
    "rate_limit": (3.0, 1.5, 5.2),
}
DOWN = {"robot": LOADED, "start": [0.0] * 3, "end": [1.0, 1.0, 0.6], "n_pieces": 10}


@pytest.fixture(scope="module")
def least_effort():
    return r3.optimal_motion(**PUBLISHED, duration=0.53)


@pytest.fixture(scope="module")
def least_time():
    return r3.optimal_motion(**PUBLISHED)


@pytest.fixture(scope="module")
def compromise():
    return r3.optimal_motion(**DOWN, effort_weight=0.01)


@pytest.fixture(scope="module", params=["least_effort", "least_time", "compromise"])
def motion(request):
    return request.getfixturevalue(request.param)


# --- published ------------------------------------------------------------------------------------


def test_torque_per_volt_of_the_literature_is_that_of_the_motors_times_the_gears():
    ratio = np.array(UNLOADED.parameters["table_1"]["p"][:3])
    np.testing.assert_allclose(1.2 * ratio, [-126.0, 252.0, 72.0], rtol=1e-14)


def test_least_effort_in_0_53_s_is_the_published_one(least_effort):
    # PSOPT prints 20.4061 on a coarser mesh; independent collocation 20.40425 (spec 10).
    assert least_effort.effort == pytest.approx(20.40425, abs=1e-4)
    assert least_effort.effort_unit == "V^2 s"
    assert least_effort.duration == 0.53


def test_the_unit_of_the_effort_does_not_matter(least_effort):
    """Motor torque per volt a thousand times as large: volts a thousandth."""
    smaller = r3.optimal_motion(**PUBLISHED | {"torque_per_volt": 1200.0}, duration=0.53)
    # Roundoff of the solver; measured 4e-14.
    assert smaller.effort * 1e6 == pytest.approx(least_effort.effort, rel=1e-12)
    t = np.linspace(0.0, 0.53, 50)
    np.testing.assert_allclose(smaller.angle(t), least_effort.angle(t), rtol=0, atol=1e-9)


def test_least_time_is_the_published_one(least_time):
    assert least_time.duration == pytest.approx(0.49519, abs=2e-5)


def test_a_finer_mesh_finds_the_same_effort(least_effort):
    finer = r3.optimal_motion(**PUBLISHED, duration=0.53, n_pieces=50)
    # Measured 3e-6: where the torque of axis 1 meets its limit within a piece.
    assert finer.effort == pytest.approx(least_effort.effort, abs=3e-5)


# --- what every optimum keeps ---------------------------------------------------------------------


def test_the_core_driven_by_the_torques_alone_arrives(motion):
    """The run that `end_error` reports, and another: with the torques in a table of cubics."""
    assert motion.end_error < 1e-10  # measured 1e-11; the promise is 1e-6
    arm = r3.Robot(2, load=motion.robot.load, controller=None)
    run = r3.simulate(
        arm,
        None,
        t_end=motion.duration,
        start=arm.state_from(joint_angle=motion.angle(0.0)),
        motor_torque=r3.Input(motion.motor_torque, knots=motion.knots[1:-1]),
        rtol=1e-9,
    )
    t = np.linspace(0.0, motion.duration, 50)
    np.testing.assert_allclose(run.at(t).joint_angle, motion.angle(t), rtol=0, atol=1e-7)


def test_limits_are_kept_between_the_knots(motion, request):
    loaded = motion.robot == LOADED
    torque_limit = np.full(3, 9.0)
    rate_limit = 315.0 / np.array([105.0, 210.0, 60.0]) if loaded else PUBLISHED["rate_limit"]
    t = np.linspace(0.0, motion.duration, 20001)[:-1]
    assert (np.abs(motion.motor_torque(t)) / torque_limit).max() < 1.0 + 1.1e-3  # the tolerance
    assert (np.abs(motion.rate(t)) / rate_limit).max() < 1.0 + 1.1e-3
    # Margins are those of samples, as close to each other as 1/40 of a piece.
    largest = np.abs(motion.motor_torque(t)).max(axis=0)
    np.testing.assert_allclose(motion.torque_margins, torque_limit - largest, rtol=0, atol=5e-3)
    largest = np.abs(motion.rate(t)).max(axis=0)
    np.testing.assert_allclose(motion.rate_margins, rate_limit - largest, rtol=0, atol=5e-3)


def test_margins_of_angles_are_those_that_the_motion_leaves(compromise):
    t = np.linspace(0.0, compromise.duration, 20001)
    limits = np.array(LOADED.parameters["table_3"]["joint_limits"][:3])
    left = limits - np.abs(compromise.angle(t)).max(axis=0)
    np.testing.assert_allclose(compromise.angle_margins, left, rtol=0, atol=1e-4)
    assert not compromise.angle_margins.flags.writeable


def test_an_angle_limit_is_kept(compromise):
    """On its way axis 3 would go further than to its end."""
    assert np.abs(compromise.angle(np.linspace(0, 1, 99) * compromise.duration))[:, 2].max() > 0.61
    within = r3.optimal_motion(**DOWN, effort_weight=0.01, angle_limit=[1.0, 1.0, 0.605])
    assert within.angle_margins.min() > -0.605e-3  # the tolerance
    assert within.duration + 0.01 * within.effort > compromise.duration + 0.01 * compromise.effort


def test_a_slow_motion_of_an_arm_that_would_fall_arrives():
    slow = r3.optimal_motion(**DOWN, duration=10.0)
    # What the run leaves at its tolerance of 1e-10 grows some twentyfold in a second, for 2 s;
    # measured 6e-9.
    assert slow.end_error < 6e-8


def test_it_goes_from_rest_to_rest_without_a_jump(motion):
    assert motion.knots[0] == 0.0
    for end in (0.0, motion.duration * (1.0 - 1e-12)):
        np.testing.assert_allclose(motion.rate(end), 0.0, rtol=0, atol=1e-9)
    before = motion.knots[1:] * (1.0 - 1e-14)
    # Roundoff of 1 / (1e-14 of the time) in the rates' slopes, of up to 1e3 rad/s^2.
    np.testing.assert_allclose(motion.angle(before), motion.angle(motion.knots[1:]), atol=1e-12)
    np.testing.assert_allclose(
        motion.rate(before)[:-1], motion.rate(motion.knots[1:-1]), rtol=0, atol=1e-10
    )
    assert motion.defects.shape == (3,)
    assert motion.defects.max() < 1e-12  # roundoff of up to 1e3 rad/s^2; measured 3e-14


def test_effort_is_the_integral_of_the_squared_torques(compromise):
    t = np.linspace(0.0, compromise.duration, 200001)[:-1] + compromise.duration / 400000
    mean = (compromise.motor_torque(t) ** 2).sum(axis=1).mean()
    # The midpoint rule across jumps at the knots.
    assert compromise.effort == pytest.approx(compromise.duration * mean, rel=1e-5)
    assert compromise.effort_unit == "N^2 m^2 s"


def test_no_neighbour_with_the_same_ends_takes_less():
    """Optimality, seen from outside: bows of an axis, up or down, cost more.

    The duration is so long that no limit is met, where a neighbour might gain by breaking it.
    """
    least_effort = r3.optimal_motion(**PUBLISHED, duration=1.0)
    assert (least_effort.torque_margins > 0.1).all()
    assert (least_effort.rate_margins > 0.1).all()
    duration = least_effort.duration
    t = np.linspace(0.0, duration, 20001)[:-1] + duration / 40000
    ratio = np.array(UNLOADED.parameters["table_1"]["p"][:3])

    def effort(bow):
        s = np.pi * t[:, None] / duration
        shape = (
            np.sin(s) ** 2,
            np.sin(2 * s) * np.pi / duration,
            2 * np.cos(2 * s) * (np.pi / duration) ** 2,
        )
        moved = (
            quantity(t) + bow * by
            for quantity, by in zip(
                (least_effort.angle, least_effort.rate, least_effort.acceleration),
                shape,
                strict=True,
            )
        )
        volts = UNLOADED.inverse_dynamics(*moved) / ratio / 1.2
        return duration * (volts**2).sum(axis=1).mean()

    here = effort(np.zeros(3))
    for axis in range(3):
        for size in (-1e-3, 1e-3):
            assert effort(size * np.eye(3)[axis]) > here


# --- what may be asked ----------------------------------------------------------------------------


def test_more_weight_of_the_effort_is_slower_and_takes_less(compromise):
    motions = r3.pareto_motions(LOADED, DOWN["start"], DOWN["end"], [1e-3, 1e-2], n_pieces=10)
    assert motions.duration[0] < motions.duration[1]
    assert motions.effort[0] > motions.effort[1]
    assert motions[1] == compromise
    assert len(motions) == 2
    assert motions.effort_weights == (1e-3, 1e-2)
    # Of two motions neither is better in the sum that the other has made least.
    for k, weight in enumerate(motions.effort_weights):
        sums = motions.duration + weight * motions.effort
        assert sums.argmin() == k


def test_the_curve_is_drawn_with_the_arm_beside(compromise):
    motions = r3.ParetoMotions((0.01,), (compromise,))
    panels = motions.plot(axes=r3.plot.new_figure())
    assert panels.shape == (1, 4)
    curve = panels[0, 0].lines[0]
    np.testing.assert_array_equal(curve.get_xdata(), motions.duration)
    np.testing.assert_array_equal(curve.get_ydata(), motions.effort)
    assert panels[0, 1].get_title(loc="left") == f"{compromise.duration:.3f} s"
    with pytest.raises(TypeError, match="motions: expected what `pareto_motions` returns"):
        r3.plot.pareto([compromise])
    with pytest.raises(TypeError, match="motions: expected one OptimalMotion or more"):
        r3.ParetoMotions((), ())
    with pytest.raises(ValueError, match="effort_weights: expected one for each of 1 motions"):
        r3.ParetoMotions((0.01, 0.1), (compromise,))


def test_a_smooth_motion_has_no_jumps_of_acceleration(compromise):
    smooth = r3.optimal_motion(**DOWN, effort_weight=0.01, smooth=True)
    knots = smooth.knots
    before = smooth.acceleration(knots[1:] * (1.0 - 1e-13))
    after = np.vstack((smooth.acceleration(knots[1:-1]), np.zeros(3)))
    np.testing.assert_allclose(before, after, rtol=0, atol=1e-6)  # of about 10 rad/s^2
    np.testing.assert_allclose(smooth.acceleration(0.0), 0.0, rtol=0, atol=1e-6)
    weighed = [m.duration + 0.01 * m.effort for m in (compromise, smooth)]
    assert weighed[0] < weighed[1]


def test_further_starts_never_make_it_worse(compromise):
    several = r3.optimal_motion(**DOWN, effort_weight=0.01, starts=3)
    objectives = several.statistics.objectives
    assert len(objectives) == 3
    assert objectives[0] == compromise.statistics.objectives[0]
    weighed = [m.duration + 0.01 * m.effort for m in (several, compromise)]
    assert weighed[0] <= weighed[1] + 1e-4  # two meshes


def test_six_axes_with_their_rotors():
    end = [1.0, 1.0, 0.6, -0.2, -0.15, -0.1]
    motion = r3.optimal_motion(r3.Robot(1), [0.0] * 6, end, n_pieces=10)
    # Another implementation, with 80 pieces, found 0.718 s; 40 pieces give 0.71810 s here.
    assert motion.duration == pytest.approx(0.718, abs=1e-3)
    assert motion.end_error < 1e-9
    # A thousandth of the limits, of up to 9 N m and 4.2 rad/s.
    assert (motion.torque_margins > -9e-3).all()
    assert (motion.rate_margins > -4e-3).all()


def test_gears_and_friction_of_the_robot_play_no_part():
    """Models 2 and 4 differ in them, and in the rotors' coupling, which is told."""
    real = r3.Robot(4, load=LOADED.load, rotor_coupling="full")
    one, other = (r3.optimal_motion(**DOWN | {"robot": r}, duration=1.3) for r in (LOADED, real))
    assert one == other
    assert other.end_error < 1e-9


# --- a motion like any other ----------------------------------------------------------------------


def test_it_can_be_followed_stored_and_pickled(compromise, tmp_path):
    scenario = r3.Scenario("down", LOADED, compromise, t_end=1.5)
    scenario.save(tmp_path / "down.toml")
    loaded = r3.Scenario.load(tmp_path / "down.toml")
    assert loaded == scenario
    assert type(loaded.motion) is r3.PiecewisePolynomial
    again = pickle.loads(pickle.dumps(compromise))
    assert again == compromise
    assert again.effort == compromise.effort
    assert again.statistics == compromise.statistics
    run = scenario.run()
    np.testing.assert_array_equal(run.at([0.5]).reference_angle[0], compromise.angle(0.5))


# --- what is refused ------------------------------------------------------------------------------


def test_what_cannot_be_reached_is_told():
    with pytest.raises(r3.OptimisationError, match="IPOPT found no motion within the limits"):
        r3.optimal_motion(**DOWN, duration=0.3)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"robot": "r3"}, TypeError, "robot: expected a Robot, got 'r3'"),
        ({"robot": r3.Robot("one-axis")}, ValueError, "robot: expected model 1, 2, 3 or 4"),
        ({"start": [0.0] * 6}, ValueError, r"start: expected 3 values \[rad\]"),
        ({"end": [0.0, 2.5, 0.0]}, ValueError, r"end of axis 2: expected .* \+-2.01 rad, got 2.5"),
        ({"end": [0.0, np.nan, 0.0]}, ValueError, "end of axis 2: expected a finite value"),
        ({"end": [0.0] * 3}, ValueError, "end: expected other angles than at the start"),
        ({"duration": 0.0}, ValueError, r"duration: expected more than 0 \[s\], got 0"),
        ({"effort": "power"}, ValueError, "effort: expected 'torque' or 'voltage', got 'power'"),
        (
            {"effort": np.array(["torque"] * 2)},
            ValueError,
            "effort: expected 'torque' or 'voltage'",
        ),
        ({"effort_weight": -1.0}, ValueError, "effort_weight: expected none below 0, got -1"),
        ({"torque_limit": [9.0, 0.0, 9.0]}, ValueError, "torque_limit of axis 2: expected more"),
        ({"torque_limit": [9.0, 9.0]}, ValueError, r"torque_limit: expected 3 values \[N m\]"),
        ({"rate_limit": np.inf}, ValueError, r"rate_limit: expected a finite number \[rad/s\]"),
        ({"torque_per_volt": 1.2}, ValueError, "torque_per_volt: expected with effort='voltage'"),
        ({"smooth": 1}, TypeError, "smooth: expected True or False, got 1"),
        ({"n_pieces": 1}, ValueError, "n_pieces: expected 2 or more, got 1"),
        ({"starts": 0}, ValueError, "starts: expected 1 or more, got 0"),
        ({"starts": 1.5}, TypeError, "starts: expected a whole number, got 1.5"),
        ({"limit_tolerance": 0.0}, ValueError, "limit_tolerance: expected more than 0"),
        ({"limit_tolerance": 1.0}, ValueError, "limit_tolerance: expected a part of the limits"),
    ],
)
def test_a_mistake_is_refused_at_the_door(changes, error, message):
    with pytest.raises(error, match=message):
        r3.optimal_motion(**DOWN | changes)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"duration": 1.0}, TypeError, "duration: expected none"),
        ({"effort_weights": []}, ValueError, "effort_weights: expected weights that ascend"),
        ({"effort_weights": [0.1, 0.01]}, ValueError, "effort_weights: expected weights that"),
        ({"effort_weights": [-1.0, 0.01]}, ValueError, "effort_weights: expected weights that"),
    ],
)
def test_a_curve_has_free_durations_and_ascending_weights(changes, error, message):
    with pytest.raises(error, match=message):
        r3.pareto_motions(**DOWN | changes)


def test_without_casadi_it_says_what_to_install(monkeypatch):
    import sys

    for module in [m for m in sys.modules if m.startswith("manutec_r3.planning.optimal.")]:
        if module.rsplit(".", 1)[1] in ("search", "problem", "dynamics"):
            monkeypatch.delitem(sys.modules, module)
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(ImportError, match=r"pip install 'manutec-r3\[optimal\]'"):
        r3.optimal_motion(**DOWN)
