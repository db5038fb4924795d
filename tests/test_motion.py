"""Motions that users bring: splines, sequences, functions of time."""

import gc
import pickle
import weakref
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

import manutec_r3 as r3

EPS = np.finfo(float).eps
END = np.array([1.0, 1.0, 0.6, -0.2, -0.15, -0.1])
QUINTIC = r3.Quintic([0.0] * 6, END, 1.2)
QUANTITIES = ("angle", "rate", "acceleration")
few = settings(max_examples=50, deadline=None)


def switches(events):
    return [(event.axis, event.element, event.before, event.after) for event in events]


def assert_same_run(got, expected, t_end):
    """The same events, and signals that differ by what roundoff of the reference makes of them."""
    assert switches(got.events) == switches(expected.events)
    # Measured 5e-13 s; the instants themselves are known to 1e-9 s at the default tolerance.
    np.testing.assert_allclose(got.events.time, expected.events.time, rtol=0, atol=1e-9)
    times = np.linspace(0.0, t_end, 301)
    # Measured 2e-14 rad and 1e-8 N m: the fast modes of the current controllers answer to roundoff.
    for signal, tolerance in (
        ("joint_angle", 2e-13),
        ("control_error", 2e-13),
        ("motor_torque", 3e-8),
    ):
        a, b = (getattr(result.at(times), signal) for result in (got, expected))
        np.testing.assert_allclose(a, b, rtol=0, atol=tolerance, err_msg=signal)


# --- functions that other motions are made of, at the top of a module so that they are pickled ----


def quintic_angle(t):
    x = t / 1.2
    return END * (x**3 * (10.0 - 15.0 * x + 6.0 * x**2))


def quintic_rate(t):
    x = t / 1.2
    return END * (30.0 * x**2 * (1.0 - x) ** 2 / 1.2)


def quintic_acceleration(t):
    x = t / 1.2
    return END * (60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / 1.2**2)


def tent_angle(t, n=3):
    """Up at 1 rad/s until 0.1 s, down again until 0.2 s."""
    return [t if t < 0.1 else 0.2 - t] * n


def tent_rate(t, n=3):
    return [1.0 if t < 0.1 else -1.0] * n


def by_functions():
    return r3.FunctionMotion(quintic_angle, quintic_rate, 1.2)


# --- splines --------------------------------------------------------------------------------------


@st.composite
def splines(draw, n_axes=3):
    gaps = draw(st.lists(st.floats(0.02, 1.0), min_size=1, max_size=7))
    times = draw(st.floats(0.0, 1.0)) + np.cumsum([0.0, *gaps])
    row = st.lists(st.floats(-3.0, 3.0), min_size=n_axes, max_size=n_axes)
    return times, np.array(draw(st.lists(row, min_size=len(times), max_size=len(times))))


@few
@given(points=splines())
def test_a_spline_is_the_clamped_cubic_spline(points):
    times, angles = points
    motion, expected = r3.Spline(times, angles), CubicSpline(times, angles, bc_type="clamped")
    t = np.linspace(times[0], times[-1], 200)[:-1]
    shortest = np.diff(times).min()
    for derivative, quantity in enumerate(QUANTITIES):
        # 6 rad, and roundoff that the shortest of the pieces magnifies with each derivative
        scale = 6.0 / shortest**derivative
        np.testing.assert_allclose(
            getattr(motion, quantity)(t), expected(t, derivative), rtol=0, atol=200 * EPS * scale
        )


@few
@given(points=splines())
def test_a_spline_goes_through_its_points_and_rests_at_both_ends(points):
    times, angles = points
    motion = r3.Spline(times, angles)
    np.testing.assert_array_equal(motion.angle(times), angles)
    np.testing.assert_array_equal(motion.knots, times)
    assert motion.duration == times[-1]
    for outside, angle in ((times[0] - 1e-3, angles[0]), (times[-1] + 1.0, angles[-1])):
        np.testing.assert_array_equal(motion.angle(outside), angle)
        assert not motion.rate(outside).any()
        assert not motion.acceleration(outside).any()
    assert not motion.rate([times[0], times[-1]]).any()


def test_two_points_are_joined_by_the_cubic_of_rest_to_rest():
    motion = r3.Spline([0.5, 2.5], [[0.0], [1.0]])
    x = np.linspace(0.0, 1.0, 11)[:-1]
    got = motion.angle(0.5 + 2.0 * x)[:, 0]
    np.testing.assert_allclose(got, x**2 * (3.0 - 2.0 * x), rtol=0, atol=4 * EPS)


# --- sequences ------------------------------------------------------------------------------------


@st.composite
def members(draw, most=5, nested=True):
    """Motions of three axes, each from where the one before has ended."""
    n_members = draw(st.integers(1, most))
    motions, here = [], np.zeros(3)
    for _ in range(n_members):
        there = np.array(draw(st.lists(st.floats(-2, 2), min_size=3, max_size=3)))
        duration = draw(st.floats(0.1, 2.0))
        kinds = ["quintic", "trapezoid", "spline", "hold", "function", *["sequence"] * nested]
        match draw(st.sampled_from(kinds)):
            case "quintic":
                motion = r3.Quintic(here, there, duration)
            case "trapezoid":
                motion = r3.Trapezoid(here, there, [1.5] * 3, [5.0] * 3)
            case "spline":
                motion = r3.Spline([0.05, 0.05 + duration, 0.2 + duration], [here, there, here])
            case "hold":
                motion = r3.Hold(here, draw(st.sampled_from([0.0, duration])))
            case "function":
                motion = swing(here, there, duration)
            case "sequence":
                motion = r3.Sequence([r3.Quintic(here, there, duration), r3.Hold(there, 0.3)])
        motions.append(motion)
        here = motion.angle(motion.duration)
    return motions


def swing(here, there, duration):
    """From here to there along a cosine."""
    w, half = np.pi / duration, 0.5 * (there - here)
    return r3.FunctionMotion(
        lambda t: here + half * (1.0 - np.cos(w * t)),
        lambda t: half * w * np.sin(w * t),
        duration,
        acceleration=lambda t: half * w**2 * np.cos(w * t),
    )


def begins_of(motions):
    """When each begins, and when the last ends: sums from left to right."""
    begins = [0.0]
    for motion in motions:
        begins.append(begins[-1] + motion.duration)
    return begins


@few
@given(motions=members(), part=st.floats(0.0, 1.0), data=st.data())
def test_in_its_time_each_member_gives_exactly_what_it_gives_alone(motions, part, data):
    sequence, begins = r3.Sequence(motions), begins_of(motions)
    k = data.draw(st.integers(0, len(motions) - 1))
    t = begins[k] + part * motions[k].duration
    # Away from knots, at which sums round: then a member may already be a piece ahead alone.
    assume(begins[k] <= t < begins[k + 1])
    assume(not (np.abs(motions[k].knots - (t - begins[k])) < 1e-9).any())
    for quantity in QUANTITIES:
        alone = getattr(motions[k], quantity)(t - begins[k])
        np.testing.assert_array_equal(getattr(sequence, quantity)(t), alone)


@few
@given(motions=members())
def test_where_two_members_meet_the_later_one_holds(motions):
    sequence, begins = r3.Sequence(motions), begins_of(motions)
    assert sequence.duration == begins[-1]
    for k, motion in enumerate(motions):
        if begins[k + 1] > begins[k]:  # it has any time of its own
            for quantity in QUANTITIES:
                first = getattr(motion, quantity)(0.0)
                np.testing.assert_array_equal(getattr(sequence, quantity)(begins[k]), first)
    last = motions[-1].angle(motions[-1].duration)
    for t in (begins[-1], begins[-1] + 1.0):
        np.testing.assert_array_equal(sequence.angle(t), last)
        assert not sequence.rate(t).any()


@few
@given(motions=members())
def test_knots_of_a_sequence_are_those_of_its_members_and_where_they_meet(motions):
    knots, begins = r3.Sequence(motions).knots, begins_of(motions)
    expected = {begin + knot for begin, m in zip(begins, motions, strict=False) for knot in m.knots}
    np.testing.assert_array_equal(knots, sorted(expected | set(begins[1:-1])))


def test_knots_of_a_sequence_in_an_example():
    there, back = r3.Quintic([0.0], [1.0], 1.0), r3.Trapezoid([1.0], [0.0], [2.0], [8.0])
    sequence = r3.Sequence([there, r3.Hold([1.0], 0.5), back])  # 0.25 s, 0.25 s, 0.25 s
    assert sequence.knots.tolist() == [0.0, 1.0, 1.5, 1.75, 2.0, 2.25]
    assert sequence.duration == 2.25
    waits = r3.Sequence([r3.Hold([0.0], 0.5), there, r3.Hold([1.0], 0.5)])
    assert waits.knots.tolist() == [0.5, 1.5]  # where a hold begins or ends the whole is smooth
    assert waits.duration == 2.0


def test_a_nested_sequence_is_a_member_as_any_other():
    a, b, c = (r3.Quintic([0.1 * k], [0.1 * k + 0.1], 0.3 + 0.1 * k) for k in range(3))
    nested, flat = r3.Sequence([a, r3.Sequence([b, c])]), r3.Sequence([a, b, c])
    np.testing.assert_allclose(nested.knots, flat.knots, rtol=2 * EPS)  # sums in another order
    t = np.linspace(-0.1, 1.5, 100)
    for quantity in QUANTITIES:
        got, expected = (getattr(motion, quantity)(t) for motion in (nested, flat))
        np.testing.assert_allclose(got, expected, rtol=0, atol=100 * EPS)  # 0.1 rad in 0.3 s


def test_a_robot_goes_there_waits_and_returns():
    there = r3.Quintic([0.0] * 3, [0.3, 0.2, -0.3], 0.3)
    back = r3.Quintic(there.end, there.start, 0.3)
    round_trip = r3.Sequence([there, r3.Hold(there.end, 0.3), back])
    robot = r3.Robot(model=4)
    whole, first = (r3.simulate(robot, m, t_end) for m, t_end in ((round_trip, 1.5), (there, 0.6)))
    # Until it begins to return nothing differs, not even by roundoff.
    before = whole.events.time < 0.59
    assert [e for e in whole.events if e.time < 0.59] == [e for e in first.events if e.time < 0.59]
    assert before.sum() > 10
    knots = [e.time for e in whole.events if e.element == "reference"]
    assert knots == round_trip.knots[1:].tolist()
    # Friction holds the axes somewhere in the dead zone of the current controllers, which are slow:
    # 6e-4 rad are left of the start.
    np.testing.assert_allclose(whole.joint_angle[-1], there.start, rtol=0, atol=5e-3)


@pytest.mark.parametrize("model", [2, 4])
def test_axes_of_a_sequence_that_rest_at_zero_may_have_brakes(model):
    few = r3.Quintic([0.0] * 3, [0.1] * 3, 0.1)
    many = r3.Quintic([0.0] * 6, [0.1] * 3 + [0.0] * 3, 0.1)
    a, b = (r3.simulate(r3.Robot(model=model), r3.Sequence([m]), 0.1) for m in (few, many))
    np.testing.assert_array_equal(a.state, b.state)


def test_knots_that_are_one_instant_are_one_event():
    twin = np.nextafter(0.1, 1.0)
    motion = r3.Spline([0.0, 0.1, twin, 0.2], [[0.0] * 3, [0.1] * 3, [0.1] * 3, [0.0] * 3])
    result = r3.simulate(r3.Robot(model=2), motion, 0.3)
    knots = [e.time for e in result.events if e.element == "reference"]
    assert knots == pytest.approx([0.1, 0.2], abs=4 * EPS)


# --- functions of time ----------------------------------------------------------------------------


def test_a_motion_by_functions_is_what_they_say():
    motion = by_functions()
    assert (motion.n_axes, motion.duration, motion.knots.tolist()) == (6, 1.2, [0.0, 1.2])
    t = np.linspace(0.0, 1.19, 30)
    np.testing.assert_array_equal(motion.angle(t), [quintic_angle(k) for k in t])
    np.testing.assert_array_equal(motion.rate(t), [quintic_rate(k) for k in t])
    for outside, angle in ((-1.0, quintic_angle(0.0)), (1.2, quintic_angle(1.2)), (9.0, END)):
        np.testing.assert_array_equal(motion.angle(outside), angle)
        assert not motion.rate(outside).any()


@few
@given(t=st.floats(0.0, 1.2, exclude_max=True))
def test_accelerations_are_given_or_are_differences_of_rates(t):
    exact = quintic_acceleration(t)
    given_ = r3.FunctionMotion(quintic_angle, quintic_rate, 1.2, (), quintic_acceleration)
    # Before a knot a function is asked four roundoffs of time early: 9e-16 s of 42 rad/s^3.
    np.testing.assert_allclose(given_.acceleration(t), exact, rtol=0, atol=1e-13)
    # (1e-5 s)^2 times the third derivative of a rate, 520 rad/s^4; roundoff of rates over 1e-5 s
    np.testing.assert_allclose(by_functions().acceleration(t), exact, rtol=0, atol=1e-7)


def test_a_quintic_by_functions_is_the_same_run_as_the_quintic():
    robot = r3.Robot(model=3, load=r3.Load(15.0))
    expected, got = (r3.simulate(robot, motion, 1.5) for motion in (QUINTIC, by_functions()))
    assert len(expected.events) == 60
    assert_same_run(got, expected, 1.5)


def test_a_trapezoid_by_functions_with_its_knots_is_the_same_run_as_the_trapezoid():
    trapezoid = r3.Trapezoid([0.0] * 3, [0.3, 0.2, -0.3], [1.5] * 3, [10.0] * 3)
    (ramp, brake, end), way = trapezoid.knots[1:], np.array(trapezoid.end)
    top = 1.0 / brake  # rate of the path parameter

    def path(t):
        if t < ramp:
            return 0.5 * top / ramp * t**2
        return top * (t - 0.5 * ramp) if t < brake else 1.0 - 0.5 * top / ramp * (end - t) ** 2

    def path_rate(t):
        return top * (t / ramp if t < ramp else 1.0 if t < brake else (end - t) / ramp)

    motion = r3.FunctionMotion(
        lambda t: way * path(t), lambda t: way * path_rate(t), end, [ramp, brake]
    )
    np.testing.assert_array_equal(motion.knots, trapezoid.knots)
    robot = r3.Robot(model=4)
    assert_same_run(*(r3.simulate(robot, m, 0.5) for m in (motion, trapezoid)), 0.5)


@pytest.mark.parametrize("method", ["exponential", "erk", "bdf"])
def test_at_a_knot_each_side_has_its_own_rate(method):
    motion = r3.FunctionMotion(tent_angle, tent_rate, 0.2, [0.1])
    result = r3.simulate(r3.Robot(model=2), motion, 0.3, method=method)
    for knot, before, after in ((0.1, 1.0, -1.0), (0.2, -1.0, 0.0)):
        rates = result.reference_rate[result.time == knot]
        assert rates.tolist() == [[before] * 3, [after] * 3]


@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_functions_are_asked_for_times_of_the_present_piece_only(shift):
    asked = []

    def rate(t):
        asked.append(t)
        return tent_rate(t)

    motion = r3.FunctionMotion(tent_angle, rate, 0.2, [0.1])
    sequence = r3.Sequence([r3.Hold([0.0] * 3, shift), motion])
    simulator = r3.Simulator(r3.Robot(model=2), sequence)
    simulator.step(shift + 0.3)
    times = np.array(asked)
    second = times >= 0.1
    first_of_second = np.argmax(second)
    # No stage that ends the first piece asks for the second one.
    assert second[first_of_second:].all()
    for piece, begin, end in ((~second, 0.0, 0.1), (second, 0.1, 0.2)):
        assert times[piece].min() == begin
        assert 0.0 < end - times[piece].max() < 1e-15


@pytest.mark.parametrize(
    "motion",
    [
        r3.FunctionMotion(partial(tent_angle, n=1), partial(tent_rate, n=1), 0.2, [0.1]),
        r3.Quintic([0.0], [0.1], 0.2),
        r3.Trapezoid([0.0], [0.1], [1.0], [10.0]),
        r3.Spline([0.0, 0.2], [[0.0], [0.1]]),
        r3.Hold([0.1]),
        r3.Sequence([r3.Hold([0.1])]),
    ],
    ids=lambda motion: type(motion).__name__,
)
def test_a_motion_may_have_one_axis(motion):
    assert motion.n_axes == 1
    for quantity in QUANTITIES:
        assert getattr(motion, quantity)([0.05, 0.15]).shape == (2, 1)
    with pytest.raises(ValueError, match="motion: expected 6 axes for model 3, got 1"):
        r3.Simulator(r3.Robot(model=3), motion)


def test_runs_by_functions_in_threads_are_those_one_by_one():
    robot, motion = r3.Robot(model=2), r3.FunctionMotion(tent_angle, tent_rate, 0.2, [0.1])
    with ThreadPoolExecutor(2) as pool:
        runs = list(pool.map(lambda _: r3.simulate(robot, motion, 0.3), range(4)))
    for run in runs:
        np.testing.assert_array_equal(run.state, r3.simulate(robot, motion, 0.3).state)


# --- values ---------------------------------------------------------------------------------------

VALUES = [
    r3.Spline([0.0, 0.5, 1.0], np.arange(9.0).reshape(3, 3)),
    r3.Hold([0.1, 0.2, 0.3], 2.0),
    r3.Sequence([r3.Quintic([0.0] * 3, [0.1] * 3, 0.5), r3.Hold([0.1] * 3, 0.5)]),
    r3.FunctionMotion(
        quintic_angle, quintic_rate, duration=1.2, knots=[0.5], acceleration=quintic_acceleration
    ),
    r3.Sequence([r3.FunctionMotion(partial(tent_angle), partial(tent_rate), 0.2, [0.1])]),
]


@pytest.mark.parametrize("motion", VALUES[:-1], ids=lambda motion: type(motion).__name__)
def test_motions_are_immutable_picklable_comparable(motion):
    again = pickle.loads(pickle.dumps(motion))
    assert again == motion
    assert hash(again) == hash(motion)
    assert repr(again) == repr(motion)
    t = np.linspace(-0.1, 1.5, 20)
    np.testing.assert_array_equal(again.angle(t), motion.angle(t))
    for name in vars(motion):
        with pytest.raises(AttributeError):
            setattr(motion, name, None)


def test_a_sequence_is_picklable_if_its_functions_are():
    t = np.linspace(-0.1, 0.3, 20)
    again = pickle.loads(pickle.dumps(VALUES[-1]))
    np.testing.assert_array_equal(again.angle(t), VALUES[-1].angle(t))


def test_motions_by_functions_are_equal_if_their_functions_are():
    assert by_functions() == by_functions()
    assert by_functions() != r3.FunctionMotion(quintic_angle, quintic_rate, 1.2, [0.1])
    assert by_functions() != r3.FunctionMotion(quintic_angle, lambda t: quintic_rate(t), 1.2)


@pytest.mark.parametrize("wrap", [lambda motion: motion, lambda motion: r3.Sequence([motion])])
def test_nothing_keeps_functions_alive(wrap):
    class Planner:
        """Refers to its motion, which refers to it."""

        def __init__(self):
            self.motion = wrap(r3.FunctionMotion(self.angle, self.rate, 0.2, [0.1]))
            self.simulator = r3.Simulator(r3.Robot(model=2), self.motion)
            self.simulator.step(0.01)
            self.result = r3.simulate(r3.Robot(model=2), self.motion, 0.01)

        def angle(self, t):
            return tent_angle(t)

        def rate(self, t):
            return tent_rate(t)

    planner = Planner()
    alive = weakref.ref(planner)
    del planner
    gc.collect()
    assert alive() is None


# --- what goes wrong ------------------------------------------------------------------------------


class Trouble(Exception):
    pass


class Fails:
    """A rate that raises at one of its calls."""

    def __init__(self, call):
        self.left = call
        self.trouble = Trouble()

    def __call__(self, t):
        self.left -= 1
        if self.left == 0:
            raise self.trouble
        return tent_rate(t)


@pytest.mark.parametrize(("method", "n_failures"), [("exponential", 12), ("erk", 12), ("bdf", 4)])
def test_what_a_function_raises_comes_out_and_the_simulator_goes_on(method, n_failures):
    robot, asked = r3.Robot(model=4), []

    def simulator_with(rate):
        motion = r3.FunctionMotion(tent_angle, rate, 0.2, [0.1])
        return r3.Simulator(robot, motion, method=method)

    def rate(t):
        asked.append(t)
        return tent_rate(t)

    expected = simulator_with(rate).step(0.15)
    assert len(expected) > 10
    # Somewhere in the run, and where an event is handled.
    anywhere = np.linspace(100, len(asked), n_failures, dtype=int)
    at_events = 1 + np.flatnonzero(np.isin(asked, [event.time for event in expected]))
    for call in [*anywhere, *at_events[:n_failures]]:
        fails = Fails(call)
        simulator, events = simulator_with(fails), []
        with pytest.raises(Trouble) as caught:
            while simulator.time < 0.15:
                events += simulator.step(0.01)
        assert caught.value is fails.trouble
        events += simulator.step(0.15 - simulator.time)
        assert switches(events) == switches(expected)
        # A step is begun anew where it went wrong: accurate to the tolerance.
        np.testing.assert_allclose(
            [event.time for event in events],
            [event.time for event in expected],
            rtol=0,
            atol=1e-7,
        )


def test_what_a_function_raises_while_a_run_is_prepared_comes_out():
    fails = Fails(2)  # the first call is made when the motion is
    motion = r3.FunctionMotion(tent_angle, fails, 0.2, [0.1])
    with pytest.raises(Trouble) as caught:
        r3.Simulator(r3.Robot(model=4), motion)
    assert caught.value is fails.trouble


def test_what_a_function_raises_comes_out_of_simulate_and_of_results():
    rate = Fails(1000)
    motion = r3.FunctionMotion(tent_angle, rate, 0.2, [0.1])
    with pytest.raises(Trouble) as caught:
        r3.simulate(r3.Robot(model=4), motion, 0.3)
    assert caught.value is rate.trouble
    result = r3.simulate(r3.Robot(model=4), motion, 0.3)
    rate.left = 1
    with pytest.raises(Trouble):
        _ = result.reference_rate
    assert result.reference_rate.shape == (len(result.time), 3)


def constant(value):
    return lambda t: value


def functions(angle=(0.0,) * 3, rate=(0.0,) * 3, duration=1.0, **options):
    return r3.FunctionMotion(constant(angle), constant(rate), duration, **options)


NAN, INF = float("nan"), float("inf")
HOLD = r3.Hold([0.0] * 3)
BAD = [
    # splines
    (lambda: r3.Spline([0.0], [[0.0] * 3]), r"times: expected at least 2 instants \[s\], got 1"),
    (lambda: r3.Spline(0.0, [[0.0] * 3]), r"times: expected a list of instants \[s\], got shape"),
    (lambda: r3.Spline("ab", [[0.0] * 3]), r"times: expected instants \[s\], got 'ab'"),
    (
        lambda: r3.Spline([-0.1, 1], [[0.0] * 3] * 2),
        r"times\[0\]: expected a finite time from 0 s on, got -0\.1",
    ),
    (
        lambda: r3.Spline([0, 1, 1], [[0.0] * 3] * 3),
        r"times\[2\]: expected a finite time after 1 s, got 1",
    ),
    (lambda: r3.Spline([0, NAN], [[0.0] * 3] * 2), r"times\[1\]: .* after 0 s, got nan"),
    (lambda: r3.Spline([0, INF], [[0.0] * 3] * 2), r"times\[1\]: .* after 0 s, got inf"),
    (lambda: r3.Spline([0, 1], [[0.0] * 3]), r"angles: expected shape \(2, n_axes\).*\(1, 3\)"),
    (lambda: r3.Spline([0, 1], [0.0] * 2), r"angles: expected shape \(2, n_axes\).*\(2,\)"),
    (lambda: r3.Spline([0, 1], [[0.0] * 4] * 2), r"angles\[0\]: expected 1, 3 or 6 angles.*got 4"),
    (lambda: r3.Spline([0, 1], [[0.0], ["a"]]), r"angles: expected numbers \[rad\]"),
    (
        lambda: r3.Spline([0, 1], [[0.0] * 3, [0, 0, NAN]]),
        r"angles\[1\] of axis 3: expected a finite angle \[rad\], got nan",
    ),
    (
        lambda: r3.Spline([0, 1e-200, 1], [[0.0], [1.0], [0.0]]),
        r"angles of axis 1: expected finite rates \[rad/s\], got",
    ),
    # sequences
    (lambda: r3.Sequence([]), r"motions: expected at least one motion, got 0"),
    (lambda: r3.Sequence(3), r"motions: expected a list of motions, got 3"),
    (lambda: r3.Sequence([HOLD, [0] * 3]), r"motions\[1\]: expected a motion, got \[0, 0, 0\]"),
    (
        lambda: r3.Sequence([HOLD, r3.Hold([0] * 6)]),
        r"motions\[1\]: expected 3 axes as in motions\[0\], got 6",
    ),
    (
        lambda: r3.Sequence([r3.Quintic([0], [0.5], 1.5), r3.Hold([0.5 + 1e-8])]),
        r"motions\[1\]: expected to begin on axis 1 at 0\.5 rad, where motions\[0\] ends at 1\.5 s"
        r", got 0\.50000001",
    ),
    (lambda: r3.Hold([0] * 3, -1.0), r"duration: expected a finite time that is not neg.*, got -1"),
    (lambda: r3.Hold([0] * 3, NAN), r"duration: expected a finite number \[s\], got nan"),
    # functions
    (lambda: r3.FunctionMotion(1, constant([0.0]), 1), r"angle: expected a function .*, got 1"),
    (lambda: r3.FunctionMotion(constant([0.0]), None, 1), r"rate: expected a function .*got None"),
    (lambda: functions(acceleration=3), r"acceleration: expected a function of the time.*, got 3"),
    (lambda: functions(duration=0.0), r"duration: expected a positive finite time \[s\], got 0"),
    (lambda: functions(duration=INF), r"duration: expected a finite number \[s\], got inf"),
    (lambda: functions(knots=[0.5, 0.4]), r"knots\[1\]: expected a time after 0\.5 s.*, got 0\.4"),
    (lambda: functions(knots=[0.0]), r"knots\[0\]: expected a time after 0 s.*, got 0"),
    (lambda: functions(knots=[NAN]), r"knots\[0\]: expected a time after 0 s.*, got nan"),
    (lambda: functions(knots=[1.0]), r"duration: expected a time after 1 s.*, got 1"),
    (lambda: functions(knots="a"), r"knots: expected instants \[s\], got 'a'"),
    (lambda: functions(angle=[0.0] * 4), r"angle\(0 s\): expected 1, 3 or 6 angles \[rad\], got 4"),
    (lambda: functions(angle=0.0), r"angle\(0 s\): expected 1, 3 or 6 values.*got shape \(\)"),
    (lambda: functions(angle="abc"), r"angle\(0 s\): expected numbers \[rad\].*, got 'abc'"),
    (lambda: functions(angle=None), r"angle\(0 s\): expected numbers \[rad\].*, got None"),
    (
        lambda: functions(angle=[0.0, NAN, 0.0]),
        r"angle\(0 s\) of axis 2: expected a finite value \[rad\], got nan",
    ),
    (
        lambda: functions(rate=[0.0] * 2),
        r"rate\(0 s\): expected 3 values \[rad/s\], one per axis, got shape \(2,\)",
    ),
    (
        lambda: functions(rate=[0.0, 0.0, INF]),
        r"rate\(0 s\) of axis 3: expected a finite value \[rad/s\], got inf",
    ),
    (lambda: functions(rate=[True] * 3), r"rate\(0 s\): expected numbers \[rad/s\]"),
    (
        lambda: functions(acceleration=constant([1.0])),
        r"acceleration\(0 s\): expected 3 values \[rad/s\^2\], one per axis, got shape \(1,\)",
    ),
    (
        lambda: r3.simulate(r3.Robot(model=2), functions_of(6), 0.1),
        r"motion of axis 4: expected exactly 0 rad, where model 2 has a brake",
    ),
]


def functions_of(n_axes):
    return functions([0.0] * n_axes, [0.0] * n_axes)


@pytest.mark.parametrize(
    ("do", "message"), BAD, ids=[message.replace("\\", "") for _, message in BAD]
)
def test_a_mistake_is_refused_at_the_door(do, message):
    with pytest.raises((ValueError, TypeError), match=f"^{message}"):
        do()


@pytest.mark.parametrize(
    ("wrong", "error", "message"),
    [
        ([0.0] * 2, ValueError, r"rate\(0\.0.* s\): expected 3 values .*, got shape \(2,\)"),
        ([0.0, NAN, 0.0], ValueError, r"rate\(0\.0.* s\) of axis 2: expected a finite .*, got nan"),
        (["0", "0", "0"], TypeError, r"rate\(0\.0.* s\): expected numbers \[rad/s\].*, got \['0'"),
        ([[0.0], [0.0, 1.0]], TypeError, r"rate\(0\.0.* s\): expected numbers .*, got \[\[0"),
    ],
)
def test_what_a_function_gives_during_a_run_is_checked(wrong, error, message):
    motion = r3.FunctionMotion(constant([0.0] * 3), lambda t: [0.0] * 3 if t < 0.05 else wrong, 0.2)
    with pytest.raises(error, match=f"^{message}"):
        r3.simulate(r3.Robot(model=2), motion, 0.1)
