"""Limits are watched beside a run: what is beyond them, from when to when, and by how much."""

import pickle
import re
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from oracle_runs import AT_ZERO, RUNS, OracleRun
from scipy.optimize import brentq, minimize_scalar

import manutec_r3 as r3

RUN = RUNS["section-10"]
METHODS = ["exponential", "erk", "bdf"]
# The experiment of the report in 0.8 s instead of 1.2 s.
TOO_FAST = OracleRun(3, ("Quintic", AT_ZERO, RUN.motion[2], 0.8), 1.5, mass=15.0)
# In which much is exceeded, on both sides.
LIVELY = ["2-trapezoid-saturated", "3-saturated", "4-quintic"]

JOINT_LIMITS = np.array([2.97, 2.01, 2.86, np.inf, np.inf, np.inf])  # Table 3
ROTOR_RATE_LIMITS = np.array([315.0, 315.0, 315.0, 335.0, 335.0, 366.0])  # Table 1
NOMINAL_TORQUE = 4.0
SUSTAINED = 0.05


@pytest.fixture(scope="module")
def free():
    return RUN.simulate()


def kinds(excesses):
    """What is exceeded, and how often."""
    return Counter((excess.what, excess.axis) for excess in excesses)


def only(excesses, what):
    return [excess for excess in excesses if excess.what == what]


def maximum(function, begin, end):
    """Where a function is largest, and minus its value there."""
    options = {"xatol": 1e-10}  # s
    return minimize_scalar(
        lambda t: -function(t), bounds=(begin, end), method="bounded", options=options
    )


def root_mean_square(result, axis):
    """Of a motor torque since the start, as a function of an instant: by Gauss quadrature."""
    points, weights = np.polynomial.legendre.leggauss(8)
    steps = np.unique(result.time)

    def integral(begin, end):
        half = (end - begin)[:, None] / 2.0
        inside = begin[:, None] + half * (1.0 + points)
        torque = result.at(inside.ravel()).motor_torque[:, axis - 1].reshape(inside.shape)
        return np.sum(torque**2 * weights * half, axis=1)

    until = np.append(0.0, np.cumsum(integral(steps[:-1], steps[1:])))

    def function(t):
        step = np.searchsorted(steps, t) - 1
        (rest,) = integral(steps[[step]], np.array([t]))
        return np.sqrt((until[step] + rest) / t)

    return function


def thrown(rate, t_end=0.3, angle=(0.0, 0.0, 0.0), **options):
    """Arms without motors, at first upright, that begin with these joint rates."""
    robot = r3.Robot(model=2, controller=None)
    start = robot.state_from(angle, rate)
    return r3.simulate(robot, None, t_end, start=start, **options)


# --- what is exceeded -----------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
def test_the_benchmark_run_exceeds_the_rotor_rate_of_axis_2_and_the_torque_of_axis_3(method):
    result = RUN.simulate(method=method)
    rate, torque = result.limits
    assert rate[:2] == ("rotor_rate", 2)
    assert torque[:2] == ("nominal_torque", 3)
    assert (rate.side, rate.limit, rate.unit, round(rate.peak)) == (1, 315.0, "rad/s", 334)
    assert (torque.side, torque.limit, torque.unit) == (1, NOMINAL_TORQUE, "N m")

    def surplus(t):
        return result.at(t).rotor_rate[0, 1] - 315.0

    top = maximum(surplus, rate.begin, rate.end)
    # On the same dense output crossings differ by roundoff of the rate, 1e-13 / 1e3 s.
    assert rate.begin == pytest.approx(brentq(surplus, 0.4, top.x, xtol=1e-15), rel=0, abs=1e-12)
    assert rate.end == pytest.approx(brentq(surplus, top.x, 0.8, xtol=1e-15), rel=0, abs=1e-12)
    assert rate.peak == pytest.approx(315.0 - top.fun, rel=1e-12)  # flat there: roundoff

    mean = root_mean_square(result, 3)
    crossing = brentq(lambda t: mean(t) - NOMINAL_TORQUE, 0.5, 1.2, xtol=1e-15)
    # Two quadratures agree to 1e-14; the mean rises by 5 N m/s.
    assert torque.begin == pytest.approx(crossing, rel=0, abs=1e-12)
    assert torque.end == result.t_end  # it ended beyond it, and still rose
    assert torque.peak == pytest.approx(mean(result.t_end), rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_a_push_needs_more_than_the_nominal_torque_for_a_moment(method):
    result = RUNS["1-hold-disturbed"].simulate(method=method)
    assert kinds(result.limits) == dict.fromkeys(
        [("nominal_torque", 1), ("nominal_torque", 2), ("nominal_torque", 5)], 1
    )
    for excess in result.limits:
        mean = root_mean_square(result, excess.axis)
        # The mean changes by more than 20 N m/s there: 5e-14 s, roundoff. Inside steps of "erk"
        # polynomials and steps take turns, which are equal within the tolerance: 2e-12 N m.
        off = 2e-11 if method == "erk" else 1e-12
        for edge in (excess.begin, excess.end):
            assert mean(edge) == pytest.approx(NOMINAL_TORQUE, rel=0, abs=off)
        top = maximum(mean, excess.begin, excess.end)
        assert excess.peak == pytest.approx(-top.fun, rel=1e-12)


@pytest.mark.parametrize("rate", [20.0, -12.0])
@pytest.mark.parametrize("method", METHODS)
def test_an_arm_that_turns_steadily_passes_its_limit_when_it_should(method, rate):
    # Upright, turning about the vertical, nothing else moves: aq = rate t.
    result = thrown([rate, 0.0, 0.0], method=method)
    (angle,) = only(result.limits, "joint_angle")
    assert (angle.axis, angle.side, angle.limit) == (1, np.sign(rate), 2.97)
    assert angle.begin == pytest.approx(2.97 / abs(rate), rel=1e-12)  # roundoff of many steps
    assert angle.end == result.t_end
    assert angle.peak == pytest.approx(abs(rate) * result.t_end, rel=1e-12)
    # It turned too fast from the beginning to the end.
    (turning,) = only(result.limits, "rotor_rate")
    assert (turning.axis, turning.side) == (1, -np.sign(rate))  # the gear ratio is negative
    assert (turning.begin, turning.end) == (0.0, result.t_end)
    assert turning.peak == pytest.approx(105.0 * abs(rate), rel=1e-12)


@pytest.mark.parametrize("model", [1, 2, 3, 4])
def test_a_motor_that_holds_more_than_its_nominal_torque_does_so_all_the_time(model):
    n = 6 if model in (1, 3) else 3
    robot = r3.Robot(model=model, load=r3.Load(mass=15.0))
    result = r3.simulate(robot, r3.Hold([0.0, np.pi / 2, 0.0, 0.0, 0.0, 0.0][:n]), 0.2)
    (torque,) = result.limits  # axis 2 holds more at the joint, less at the motor
    assert torque[:5] == ("nominal_torque", 3, 0.0, 0.2, 1)
    # The mean of what does not change; with real gears the hold drifts by 2e-11 of it.
    assert torque.peak == pytest.approx(abs(result.motor_torque[0, 2]), rel=2e-10)
    if model == 2:
        assert round(60.0 * torque.peak, 1) == 263.7  # spec section 3


def test_a_motion_that_is_too_fast_saturates_a_motor_for_long():
    result = TOO_FAST.simulate()
    saturated = only(result.limits, "saturation")
    assert kinds(saturated) == {("saturation", 3): 4}
    assert {excess.side for excess in saturated} == {-1, 1}
    # Its switches are events: those that last, the last one to the end of the run.
    assert any(e.element == "torque_limit" and e.axis == 2 for e in result.events)  # but shortly
    switches = [e for e in result.events if e.element == "torque_limit" and e.axis == 3]
    ends = [*(e.time for e in switches[1:]), result.t_end]
    lasting = [
        (e.time, end, e.after)
        for e, end in zip(switches, ends, strict=True)
        if e.after != 0 and end - e.time > SUSTAINED
    ]
    assert [(e.begin, e.end, e.side) for e in saturated] == [
        (begin + SUSTAINED, end, side) for begin, end, side in lasting
    ]
    assert [e.peak for e in saturated] == [end - begin for begin, end, _ in lasting]
    assert {(e.limit, e.unit) for e in saturated} == {(SUSTAINED, "s")}


@pytest.mark.parametrize("method", METHODS)
def test_an_excess_of_microseconds_between_two_steps_is_found(method):
    def fall(angle):
        """Arm 3 falls out of this angle, fastest where it hangs."""
        result = thrown([0.0, 0.0, 0.0], 1.5, [0.0, 0.0, angle], method=method)
        fastest = np.argmax(result.rotor_rate[:, 2])
        top = maximum(
            lambda t: result.at(t).rotor_rate[0, 2],
            *result.time[[fastest - 1, fastest + 1]],
        )
        return -top.fun, result

    angle = brentq(lambda a: fall(a)[0] - 315.0 * (1.0 + 1e-10), 0.2, 1.0, xtol=1e-14)
    peak, result = fall(angle)
    assert peak > 315.0
    assert result.rotor_rate[:, 2].max() < 315.0  # at no step
    (excess,) = [excess for excess in result.limits if excess[:2] == ("rotor_rate", 3)]
    assert 0.0 < excess.end - excess.begin < 1e-5
    assert excess.peak == pytest.approx(peak, rel=1e-12)
    # A little less, and nothing is exceeded.
    assert ("rotor_rate", 3) not in kinds(fall(angle + 1e-8)[1].limits)


def test_an_arm_that_rests_at_its_limits_is_not_beyond_them():
    angle, excess = np.array([-2.97, 2.01, -2.86, 0.4, -0.6, 0.2]), []
    for mass in range(1, 11):
        robot = r3.Robot(model=1, load=r3.Load(mass))
        result = r3.simulate(robot, r3.Hold(angle), 0.5)
        excess.append(np.abs(result.joint_angle[:, :3]) - np.abs(angle[:3]))
        assert result.limits == ()
    assert 0.0 < np.concatenate(excess).max() < 1e-13  # but for roundoff it would be


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", LIVELY)
def test_what_is_told_is_what_a_fine_grid_shows(name, method):
    result = RUNS[name].simulate(method=method)
    grid = np.linspace(0.0, result.t_end, 4001)
    now = result.at(grid)
    n = result.robot.n_axes
    shown = {
        "joint_angle": (now.joint_angle, JOINT_LIMITS[:n]),
        "rotor_rate": (now.rotor_rate, ROTOR_RATE_LIMITS[:n]),
    }
    for what, (value, limit) in shown.items():
        beyond = np.zeros((len(grid), n), int)
        for excess in only(result.limits, what):
            beyond[(grid >= excess.begin) & (grid <= excess.end), excess.axis - 1] = excess.side
            axis = value[:, excess.axis - 1]
            during = (grid >= excess.begin) & (grid <= excess.end)
            assert np.abs(axis[during]).max() <= excess.peak
            # Accelerations change by less than 1e7 rad/s^3, the grid is 2e-4 s wide.
            assert np.abs(axis[during]).max() == pytest.approx(excess.peak, rel=0, abs=0.5)
        np.testing.assert_array_equal(beyond, np.where(np.abs(value) > limit, np.sign(value), 0))
    assert only(result.limits, "rotor_rate")


@pytest.mark.parametrize("name", LIVELY)
def test_excesses_are_in_order_and_of_one_axis_apart(name):
    excesses = RUNS[name].simulate().limits
    assert list(excesses) == sorted(excesses, key=lambda excess: excess.begin)
    for what, axis in kinds(excesses):
        own = [excess for excess in excesses if excess[:2] == (what, axis)]
        assert all(a.end < b.begin for a, b in pairwise(own))
        assert all(excess.peak >= excess.limit for excess in own)


def test_an_excess_says_what_it_is():
    excess = r3.LimitExcess("rotor_rate", 2, 0.5, 0.7, 1, 315.0, 334.0)
    assert str(excess) == "rotor rate of axis 2 beyond 315 rad/s"
    torque = r3.LimitExcess("nominal_torque", 3, 0.9, 1.5, 1, 4.0, 4.7)
    assert str(torque) == "root mean square of the motor torque of axis 3 beyond 4 N m"


# --- nobody is disturbed --------------------------------------------------------------------------


def test_nothing_is_computed_before_it_is_asked_for(monkeypatch):
    def refuse(*_):
        raise AssertionError("limits were computed")

    monkeypatch.setattr("manutec_r3.result.limit_excesses", refuse)
    result = RUN.simulate(t_end=0.1)
    assert result.status == "completed"
    with pytest.raises(AssertionError, match="limits were computed"):
        _ = result.limits


def test_a_run_is_the_same_whether_limits_are_listed_or_not(free):
    listed = RUN.simulate(list_limits=True)
    assert listed.limits == free.limits
    assert listed.status == free.status == "completed"
    steps = np.isin(listed.time, free.time)
    np.testing.assert_array_equal(listed.time[steps], free.time)
    np.testing.assert_array_equal(listed.state[steps], free.state)
    assert listed.statistics.evaluations == free.statistics.evaluations
    assert listed.statistics.events == free.statistics.events == len(free.events) == 60


def test_limits_survive_pickling(free):
    assert pickle.loads(pickle.dumps(free)).limits == free.limits


# --- limits among the events ----------------------------------------------------------------------


@pytest.mark.parametrize("times", [None, [0.0, 0.3, 0.6]])
def test_listed_limits_are_events_in_the_order_of_time(free, times):
    rate, torque = free.limits
    listed = RUN.simulate(list_limits=True, times=times)
    told = [event for event in listed.events if event.element == "limit"]
    assert told == [  # the end of the run is no event
        (rate.begin, 2, "limit", 0, 1),
        (rate.end, 2, "limit", 1, 0),
        (torque.begin, 3, "limit", 0, 1),
    ]
    assert [event for event in listed.events if event.element != "limit"] == list(free.events)
    assert np.all(np.diff(listed.events.time) >= 0.0)
    # As at any event, both sides are recorded.
    for event in told:
        (sides,) = np.nonzero(listed.time == event.time)
        assert len(sides) == 2
        np.testing.assert_array_equal(listed.state[sides[0]], listed.at(event.time).state[0])
        np.testing.assert_array_equal(listed.state[sides[1]], listed.at(event.time).state[0])


def test_both_sides_of_a_limit_are_told():
    listed = RUNS["3-saturated"].simulate(list_limits=True)
    told = [e for e in listed.events if e.element == "limit" and e.axis == 6]
    assert [(e.before, e.after) for e in told] == [(0, -1), (-1, 0)]


def test_events_of_limits_lie_inside_the_run():
    listed = thrown([20.0, 0.0, 0.0], list_limits=True)
    assert only(listed.limits, "rotor_rate")[0].begin == 0.0
    (angle,) = only(listed.limits, "joint_angle")
    assert list(listed.events) == [(angle.begin, 1, "limit", 0, 1)]


# --- enforcement ----------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", ["section-10", *LIVELY])
def test_an_enforced_run_is_the_free_one_until_it_ends_at_a_limit(name, method):
    run = RUNS[name]
    free = run.simulate(method=method)
    enforced = run.simulate(method=method, enforce_limits=True)
    first = free.limits[0]
    assert enforced.t_end == enforced.time[-1] == first.begin
    assert enforced.status == f"ended at {first.begin:.6g} s: {first}"
    assert enforced.limits == (first._replace(end=first.begin, peak=first.limit),)
    assert list(enforced.events) == [e for e in free.events if e.time < first.begin]

    n = len(enforced) - 1
    least = 40 if method == "exponential" else 50  # its steps are longer
    assert n == np.count_nonzero(free.time < first.begin) > least
    np.testing.assert_array_equal(enforced.time[:n], free.time[:n])
    times = np.linspace(0.0, first.begin, 101)
    there, then = enforced.at(times), free.at(times)
    for signal in enforced.signals:
        recorded = getattr(enforced, signal)
        np.testing.assert_array_equal(recorded[:n], getattr(free, signal)[:n])
        np.testing.assert_array_equal(recorded[n], getattr(free.at(first.begin), signal)[0])
        np.testing.assert_array_equal(getattr(there, signal), getattr(then, signal))
    for element, branches in enforced.branches.items():
        np.testing.assert_array_equal(branches[:n], free.branches[element][:n])
    with pytest.raises(ValueError, match="times: expected instants from 0 to"):
        enforced.at(first.begin + 1e-6)


def test_the_status_says_what_was_exceeded():
    result = RUN.simulate(enforce_limits=True)
    assert result.status == "ended at 0.501637 s: rotor rate of axis 2 beyond 315 rad/s"


def test_times_beyond_the_end_are_not_recorded(free):
    result = RUN.simulate(enforce_limits=True, times=[0.2, 0.4, 0.6, 0.8])
    assert np.isin([0.2, 0.4], result.time).all()
    assert result.time[-1] < result.t_end < 0.6
    np.testing.assert_array_equal(result.at(0.4).state, free.at(0.4).state)


def test_a_run_within_its_limits_is_not_ended():
    free = RUNS["4-trapezoid"].simulate()
    enforced = RUNS["4-trapezoid"].simulate(enforce_limits=True, list_limits=True)
    assert enforced.limits == free.limits == ()
    assert enforced.status == "completed"
    assert enforced.events == free.events
    np.testing.assert_array_equal(enforced.state, free.state)


@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_begins_beyond_a_limit_ends_there(method):
    result = thrown([20.0, 0.0, -6.0], method=method, enforce_limits=True)
    assert result.status == (
        "ended at 0 s: rotor rate of axis 1 beyond 315 rad/s, rotor rate of axis 3 beyond 315 rad/s"
    )
    assert result.t_end == 0.0
    np.testing.assert_array_equal(result.time, [0.0])
    np.testing.assert_array_equal(result.joint_rate, [[20.0, 0.0, -6.0]])
    assert [(e.axis, e.begin, e.end, e.side) for e in result.limits] == [
        (1, 0.0, 0.0, -1),
        (3, 0.0, 0.0, -1),
    ]
    assert [e.peak for e in result.limits] == pytest.approx([2100.0, 360.0], rel=1e-15)
    assert len(result.events) == 0


@pytest.fixture
def fails_at(monkeypatch):
    """Lets every run fail at an instant."""

    def arrange(instant):
        advance = r3.Simulator._advance

        def until_then(self, target, **options):
            advance(self, instant, **options)
            raise r3.SimulationError(self.time, self.state, self.branches, "arranged")

        monkeypatch.setattr(r3.Simulator, "_advance", until_then)

    return arrange


def test_a_failure_beyond_a_limit_does_not_matter_to_an_enforced_run(fails_at):
    enforced = RUN.simulate(enforce_limits=True)
    fails_at(0.6)
    again = RUN.simulate(enforce_limits=True)
    assert (again.status, again.events, again.limits) == (
        enforced.status,
        enforced.events,
        enforced.limits,
    )
    np.testing.assert_array_equal(again.state, enforced.state)


@pytest.mark.parametrize(("instant", "enforce"), [(0.4, True), (0.6, False)])
def test_any_other_failure_is_raised(fails_at, instant, enforce):
    fails_at(instant)
    with pytest.raises(r3.SimulationError, match="arranged") as failed:
        RUN.simulate(enforce_limits=enforce)
    assert failed.value.result.t_end == instant
    assert failed.value.result.status == f"failed at {instant} s: arranged"


@pytest.mark.parametrize("option", ["list_limits", "enforce_limits"])
def test_options_are_true_or_false(option):
    with pytest.raises(TypeError, match=re.escape(f"{option}: expected True or False, got 'yes'")):
        RUN.simulate(**{option: "yes"})
