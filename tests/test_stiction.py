"""Dry friction: sticking, break-away, reversal, and the choice among combinations."""

from dataclasses import replace
from functools import cache
from itertools import pairwise, product

import numpy as np
import pytest
from independent import (
    BACKLASH,
    FRICTION_POINTS,
    GEAR_RATIO,
    STICKING_LIMIT,
    STIFFNESS,
    Hold,
    Hybrid,
    IndependentRobot,
)
from oracle_runs import ECCENTRIC, RUNS, times_of

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import ranges, sequence

# Runs with much sticking and sliding, two of them with six axes.
LIVELY = ["section-10", "3-quintic", "3-hold-disturbed", "3-saturated", "4-quintic"]
LOWEST_FRICTION = np.array([points[0][1] for points in FRICTION_POINTS])


@pytest.fixture(scope="module", params=LIVELY)
def result(request):
    return RUNS[request.param].simulate()


def test_while_it_slides_friction_is_that_of_the_table(result):
    table = result.robot.sliding_friction(result.rotor_rate)
    slides = result.branches["friction"] != 0
    assert slides.any()
    # Roundoff of 1 N m. Where a rotor just stops or reverses its rate is 0, of any sign.
    moves = slides & (np.abs(result.rotor_rate) > 1e-9)
    np.testing.assert_allclose(result.friction_torque[moves], table[moves], rtol=0, atol=1e-14)
    np.testing.assert_array_equal(result.robot.sliding_friction(0.0 * result.rotor_rate), 0.0)


def test_friction_of_the_table_goes_on_beyond_its_last_point():
    """Axis 1: from 0.40 N m at rate 0 to 0.53 N m at 160 rad/s (Table 2)."""
    both_ways = r3.Robot(3).sliding_friction([[320.0] + [0.0] * 5, [-320.0] + [0.0] * 5])
    np.testing.assert_allclose(both_ways[:, 0], [0.66, -0.66], rtol=0, atol=1e-15)
    with pytest.raises(ValueError, match=r"rotor_rate: expected 6 values \[rad/s\]"):
        r3.Robot(3).sliding_friction([1.0, 2.0])


def switches(result):
    """Events of friction, each with the recorded instants before and after it."""
    for event in result.events:
        if event.element == "friction":
            instants = np.flatnonzero(result.time == event.time)
            yield event, event.axis - 1, instants[0], instants[-1]


def everywhere(result):
    """All recorded instants, and others inside every step."""
    steps = np.unique(result.time)
    inside = steps[:-1, None] + np.diff(steps)[:, None] * [0.001, 0.137, 0.61, 0.993]
    return result, result.at(inside.ravel())


# --- sticking -------------------------------------------------------------------------------------


def test_a_sticking_axis_has_exactly_no_rate_and_no_acceleration(result):
    for samples in everywhere(result):
        sticks = samples.branches["friction"] == 0
        assert sticks.sum() > 50
        np.testing.assert_array_equal(samples.rotor_rate[sticks], 0.0)
        # On axes 1 to 3 the rotor sticks, while the joint swings on its elastic gear.
        rigid = sticks[:, 3:]
        np.testing.assert_array_equal(samples.joint_rate[:, 3:][rigid], 0.0)
        np.testing.assert_array_equal(samples.joint_acceleration[:, 3:][rigid], 0.0)


def test_a_sticking_rotor_stays_where_it_is(result):
    _, samples = everywhere(result)
    sticks = samples.branches["friction"] == 0
    stays = sticks[:-1] & sticks[1:]
    # Rotors of elastic gears are known as deflection + p * joint: their sum is exact to roundoff of
    # angles of some hundred radians.
    assert np.abs(np.diff(samples.rotor_angle, axis=0)[stays]).max() <= 1e-12


def test_friction_of_a_sticking_axis_stays_within_its_limit(result):
    for samples in everywhere(result):
        sticks = samples.branches["friction"] == 0
        limit = np.broadcast_to(STICKING_LIMIT[: sticks.shape[1]], sticks.shape)
        # Roundoff where it has just reached the limit.
        assert np.all(np.abs(samples.friction_torque[sticks]) <= limit[sticks] + 1e-12)


def test_friction_holds_a_sticking_rotor_in_balance(result):
    for samples in everywhere(result):
        sticks = samples.branches["friction"] == 0
        balance = samples.motor_torque - samples.gear_torque - samples.friction_torque
        assert np.abs(balance[sticks]).max() <= 1e-13  # roundoff of a few N m


@pytest.mark.parametrize("method", ["exponential", "erk", "bdf"])
def test_a_robot_at_rest_stays_exactly_at_rest(method):
    robot = r3.Robot(model=3, load=r3.Load(12.0, ECCENTRIC))
    result = r3.simulate(robot, r3.Hold((0.3, -0.5, 0.8, 0.4, -0.6, 0.2)), 10.0, method=method)
    assert len(result.events) == 0
    np.testing.assert_array_equal(result.rotor_rate, 0.0)
    np.testing.assert_array_equal(result.joint_rate[:, 3:], 0.0)
    np.testing.assert_array_equal(result.joint_acceleration[:, 3:], 0.0)
    np.testing.assert_array_equal(np.ptp(result.joint_angle[:, 3:], axis=0), 0.0)
    # Arms 1 to 3 hang on springs: roundoff of the balance may move them by roundoff.
    assert np.abs(result.joint_rate).max() <= 1e-13
    assert np.ptp(result.joint_angle, axis=0).max() <= 1e-15


# --- between sticking and sliding -----------------------------------------------------------------


def test_axes_break_away_exactly_at_their_limit(result):
    seen = 0
    for event, axis, before, after in switches(result):
        if event.before != 0:
            continue
        torque = result.friction_torque[before, axis]
        # Within roundoff of t of the crossing; torques change by less than 1e3 N m/s.
        assert abs(torque) == pytest.approx(STICKING_LIMIT[axis], rel=0, abs=1e-12)
        assert event.after == np.sign(torque)
        # It begins at zero, with the friction of sliding.
        assert result.rotor_rate[after, axis] == 0.0
        assert result.friction_torque[after, axis] == event.after * LOWEST_FRICTION[axis]
        seen += 1
    assert seen >= 3


def test_axes_stick_when_they_come_to_rest_within_their_limit(result):
    seen = 0
    for event, axis, before, after in switches(result):
        if event.after != 0:
            continue
        # Zero within roundoff of t; rotors of axes 1 to 3 that creep count as sticking at 1e-9.
        assert abs(result.rotor_rate[before, axis]) <= (1e-9 if axis < 3 else 1e-12)
        assert result.rotor_rate[after, axis] == 0.0
        assert abs(result.friction_torque[after, axis]) <= STICKING_LIMIT[axis]
        seen += 1
    assert seen >= 2


@pytest.mark.parametrize("name", ["3-hold-disturbed", "4-quintic"])
def test_a_reversal_without_sticking_is_one_event(name):
    result = RUNS[name].simulate()
    reversals = [s for s in switches(result) if s[0].before * s[0].after == -1]
    assert len(reversals) >= 4
    for event, axis, before, after in reversals:
        assert abs(result.rotor_rate[before, axis]) <= 1e-12  # within roundoff of t
        assert result.rotor_rate[after, axis] == 0.0
        friction = LOWEST_FRICTION[axis]
        assert result.friction_torque[before, axis] == pytest.approx(event.before * friction)
        assert result.friction_torque[after, axis] == event.after * friction
        if axis < 3:
            drive = result.motor_torque[after, axis] - result.gear_torque[after, axis]
            assert event.after * drive > STICKING_LIMIT[axis]
        of_axis = [e for e in result.events if e.time == event.time and e.axis == event.axis]
        assert of_axis == [event]


def test_friction_opposes_the_rotor_whichever_way_its_gear_turns(result):
    for samples in everywhere(result):
        branch = samples.branches["friction"]
        # Roundoff is left of rates just before they are set to zero.
        moving = (branch != 0) & (np.abs(samples.rotor_rate) > 1e-12)
        np.testing.assert_array_equal(branch[moving], np.sign(samples.rotor_rate[moving]))
        np.testing.assert_array_equal(branch[moving], np.sign(samples.friction_torque[moving]))
        joint = GEAR_RATIO[: branch.shape[1]] * samples.joint_rate
        rigid = moving & (np.arange(branch.shape[1]) >= 3)
        np.testing.assert_array_equal(branch[rigid], np.sign(joint[rigid]))


def test_friction_of_a_sliding_axis_follows_its_characteristic(result):
    for samples in everywhere(result):
        for axis in range(result.robot.n_axes):
            rate = np.abs(samples.rotor_rate[:, axis])
            slides = samples.branches["friction"][:, axis] != 0
            (w0, r0), (w1, r1) = FRICTION_POINTS[axis][-2:]
            expected = np.where(
                rate < w1,
                np.interp(rate, *np.transpose(FRICTION_POINTS[axis])),
                r0 + (rate - w0) * (r1 - r0) / (w1 - w0),
            )
            got = np.abs(samples.friction_torque[:, axis])
            # A kink is located within roundoff of t.
            assert got[slides] == pytest.approx(expected[slides], rel=0, abs=1e-12)


# --- the decision from a state --------------------------------------------------------------------

AT_REST = (0.2, -0.3, 0.5, 0.7, -0.9, 0.4)


def decide(model, state, **options):
    """Branches of friction that the package and brute force decide from a state."""
    load = (7.0, ECCENTRIC)
    robot = r3.Robot(model=model, load=r3.Load(*load), **options)
    motion = np.zeros(robot.n_axes)
    simulator = r3.Simulator(robot, r3.Hold(motion), start=robot.state_from(**state))
    independent = IndependentRobot(model, *load, **options)
    brute_force = Hybrid(independent, Hold(motion))
    brute_force.start(independent.state_from(**state))
    return simulator, brute_force


def test_any_state_with_resting_axes_is_decided_as_by_brute_force():
    rng = np.random.default_rng(8)
    decisions = set()
    for _ in range(400):
        q = rng.uniform(-1.5, 1.5, 6)
        moves = rng.random(6) < 0.2
        qd = np.where(moves, rng.normal(0.0, 1.0, 6), 0.0)
        # Motors that roughly hold the arms against gravity, give or take some sticking limits.
        torque = IndependentRobot(3, 7.0, ECCENTRIC).bias(q, qd) / GEAR_RATIO
        torque += rng.normal(0.0, 1.0, 6) * STICKING_LIMIT
        stretch = np.clip(torque, -3.0, 3.0) / [43.0, 8.0, 58.0, np.inf, np.inf, np.inf]
        state = {
            "joint_angle": q,
            "joint_rate": qd,
            "rotor_angle": GEAR_RATIO * q + stretch,
            "motor_torque": torque,
        }
        simulator, brute_force = decide(3, state)
        agree(simulator, brute_force)
        decisions.add(tuple(simulator.branches["friction"][3:]))
    assert decisions == set(product((-1, 0, 1), repeat=3))  # nothing was left out


def test_carried_rotors_stick_or_slide_in_all_64_combinations_as_by_brute_force():
    robot = IndependentRobot(3, 7.0, ECCENTRIC)
    rng = np.random.default_rng(64)
    combinations, joint_decisions, carried_decisions = set(), 0, 0
    for slide in [*product((False, True), repeat=6)] * 3:
        q = rng.uniform(-1.5, 1.5, 6)
        # Gears roughly hold the arms; each motor pushes beyond that, as far as its axis would slide
        # or stick alone.
        torque = robot.bias(q, np.zeros(6)) / GEAR_RATIO
        torque[:3] += rng.normal(0.0, 1.0, 3)
        stretch = np.zeros(6)
        stretch[:3] = torque[:3] / STIFFNESS + np.sign(torque[:3]) * BACKLASH
        push = np.where(slide, rng.uniform(1.0, 1.7, 6), rng.uniform(0.0, 1.0, 6))
        state = {
            "joint_angle": q,
            "rotor_angle": GEAR_RATIO * q + stretch,
            "motor_torque": torque + push * rng.choice((-1, 1), 6) * STICKING_LIMIT,
        }
        simulator, brute_force = decide(3, state, rotor_coupling="full")
        agree(simulator, brute_force)
        slides = simulator.branches["friction"] != 0
        combinations.add(tuple(slides))
        joint_decisions += np.any(slides != slide)
        load, start = simulator.robot.load, simulator.robot.state_from(**state)
        fixed = r3.Simulator(r3.Robot(3, load), r3.Hold(np.zeros(6)), start=start)
        carried_decisions += np.any(fixed.branches["friction"] != simulator.branches["friction"])
    assert len(combinations) == 64  # nothing was left out
    assert joint_decisions >= 20  # axes decide otherwise together
    assert carried_decisions >= 3  # and otherwise again if rotors 1 to 3 are among them


def agree(simulator, brute_force):
    """Assert that both have decided alike, and what follows."""
    np.testing.assert_array_equal(simulator.branches["friction"], brute_force.friction)
    signals = brute_force.signals(0.0, simulator_state(simulator, brute_force))
    # Accelerations are solved for in another way: roundoff, times the condition of M.
    for name in ("joint_acceleration", "friction_torque"):
        assert getattr(simulator, name) == pytest.approx(signals[name], rel=1e-10, abs=1e-10)


def simulator_state(simulator, brute_force):
    """State of the independent implementation at the simulator's present instant."""
    return brute_force.robot.state_from(
        joint_angle=simulator.joint_angle,
        joint_rate=simulator.joint_rate,
        rotor_angle=simulator.rotor_angle,
        rotor_rate=simulator.rotor_rate,
        motor_torque=simulator.motor_torque,
    )


@pytest.mark.parametrize("pushed", list(product((False, True), repeat=3)))
def test_axes_4_to_6_stick_or_slide_in_each_combination(pushed):
    # Upright and without load no gravity acts, and coupling between these axes is weak.
    torque = np.zeros(6)
    torque[3:] = np.where(pushed, 1.5, 0.5) * STICKING_LIMIT[3:]
    robot = r3.Robot(model=3)
    start = robot.state_from(np.zeros(6), motor_torque=torque)
    simulator = r3.Simulator(robot, r3.Hold(np.zeros(6)), start=start)
    np.testing.assert_array_equal(simulator.branches["friction"], [0, 0, 0, *pushed])
    acceleration = simulator.joint_acceleration[3:]
    np.testing.assert_array_equal(acceleration != 0.0, pushed)
    np.testing.assert_array_equal(np.sign(GEAR_RATIO[3:] * acceleration)[list(pushed)], 1.0)


def test_torques_beyond_all_limits_set_all_axes_sliding():
    torque = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    robot = r3.Robot(model=3)
    start = robot.state_from(np.zeros(6), motor_torque=torque)
    simulator = r3.Simulator(robot, r3.Hold(np.zeros(6)), start=start)
    np.testing.assert_array_equal(simulator.branches["friction"], np.sign(torque))
    np.testing.assert_array_equal(simulator.friction_torque, np.sign(torque) * LOWEST_FRICTION)


@pytest.mark.parametrize("model", [3, 4])
def test_a_robot_at_rest_sticks_on_all_axes_at_the_start(model):
    n = 6 if model == 3 else 3
    robot = r3.Robot(model=model, load=r3.Load(10.0))
    simulator = r3.Simulator(robot, r3.Hold(AT_REST[:n]))
    np.testing.assert_array_equal(simulator.branches["friction"], np.zeros(n))
    assert simulator.friction_torque == pytest.approx(np.zeros(n), abs=1e-12)  # motors balance


def test_the_sticking_limit_itself_still_holds():
    robot = r3.Robot(model=3)
    torque = [0.4, -0.5, 0.7, 0.0, 0.0, 0.0]
    for factor, expected in ((1.0, 0), (1.0 + 1e-15, 1)):
        start = robot.state_from(np.zeros(6), motor_torque=factor * np.array(torque))
        simulator = r3.Simulator(robot, r3.Hold(np.zeros(6)), start=start)
        branches = simulator.branches["friction"][:3]
        np.testing.assert_array_equal(branches, expected * np.array([1, -1, 1]))


# --- springs and dampers that hold axes 4 to 6 ----------------------------------------------------

SOFT = ["stiff-spring", "stiff-damper"]


@cache
def exact_run(name):
    """A run with exact sticking, far more accurate than what it is compared with."""
    return RUNS[name].simulate(rtol=1e-11)


def soft_run(name, stiction, stiffness=1e7, **options):
    """The same run with springs or dampers."""
    soft = replace(RUNS[name], options={"stiction": stiction, "stiffness": stiffness})
    return soft.simulate(**options)


def difference(soft, exact):
    """How far events [s] and angles (of each axis, relative to its range) are apart."""
    assert sequence(soft.events) == sequence(exact.events)
    times = np.linspace(0.0, soft.time[-1], 301)
    angle, expected = soft.at(times).joint_angle, exact.at(times).joint_angle
    apart = np.abs(times_of(soft.events) - times_of(exact.events))
    return apart.max(), (np.abs(angle - expected) / ranges(expected)).max(axis=0)


@pytest.mark.parametrize(
    ("name", "stiction"),
    [
        ("section-10", "stiff-spring"),
        ("3-quintic", "stiff-spring"),
        ("3-hold-disturbed", "stiff-spring"),
        ("section-10", "stiff-damper"),
        ("3-quintic", "stiff-damper"),
    ],
)
def test_springs_and_dampers_hardly_differ_from_exact_sticking(name, stiction):
    times, angles = difference(soft_run(name, stiction), exact_run(name))
    # Required; measured are 2e-7 s and 1.5e-7 with springs, 7e-9 s and 2e-10 with dampers.
    assert times <= 1e-5
    assert angles.max() <= 1e-6


@pytest.mark.parametrize(
    ("name", "stiction", "stiffness", "times", "factor"),
    [
        # A damper lags behind by J / k: first order, as far as the tolerance lets it be seen.
        ("section-10", "stiff-damper", (1e4, 1e5, 1e6), 7.1e-6, (9.5, 10.5)),
        # A spring yields by rM / k, and rings the less the stiffer it is.
        ("3-saturated", "stiff-spring", (1e3, 1e4), 1.8e-4, (9.0, 20.0)),
    ],
)
def test_the_stiffer_the_nearer_to_exact_sticking(name, stiction, stiffness, times, factor):
    runs = [soft_run(name, stiction, k, rtol=1e-9) for k in stiffness]
    apart = [difference(run, exact_run(name))[0] for run in runs]
    assert apart[0] == pytest.approx(times, rel=0.2)  # as measured: it is there to be seen
    for softer, stiffer in pairwise(apart):
        assert factor[0] <= softer / stiffer <= factor[1]


@pytest.mark.parametrize("stiction", SOFT)
def test_springs_and_dampers_take_over_the_torque_of_exact_sticking_and_do_not_ring(stiction):
    soft, exact = soft_run("section-10", stiction, rtol=1e-9), exact_run("section-10")
    for samples in everywhere(soft):
        expected = exact.at(samples.time)
        near_events = np.abs(samples.time[:, None] - times_of(exact.events)).min(axis=1) < 1e-5
        held = (samples.branches["friction"] == 0) & ~near_events[:, None]
        assert held[:, 3:].sum() > 5000
        error = np.abs(samples.friction_torque - expected.friction_torque) / STICKING_LIMIT
        # Required; measured are 2e-5 with springs, 2e-6 with dampers.
        assert error[held].max() <= 1e-3

    captures = 0
    pairs = zip(switches(soft), switches(exact), strict=True)
    for (event, axis, _, after), (_, _, _, exactly_after) in pairs:
        if event.after == 0 and axis >= 3:
            torque = soft.friction_torque[after, axis]
            expected = exact.friction_torque[exactly_after, axis]
            assert torque == pytest.approx(expected, rel=0, abs=1e-4 * STICKING_LIMIT[axis])
            captures += 1
    assert captures >= 3


RAMP = np.array([0.0, 0.0, 0.0, 2.7, -10.0, 0.85])  # N m/s: 0.1, 0.05 and 0.2 s to the limits


@pytest.mark.parametrize("axis", [4, 5, 6])
@pytest.mark.parametrize("stiction", ["exact", *SOFT])
def test_axes_break_away_when_a_growing_torque_reaches_their_limit(stiction, axis):
    # Upright nothing else acts, and what is held passes nothing on.
    slope = RAMP * (np.arange(1, 7) == axis)
    robot = r3.Robot(3, controller=None, stiction=stiction)
    result = r3.simulate(robot, None, 0.3, motor_torque=lambda t: slope * t)
    event = result.events[0]
    assert event[1:] == (axis, "friction", 0, np.sign(slope[axis - 1]))
    # Within the tolerance; a damper lags by 3e-11 s.
    limit = STICKING_LIMIT[axis - 1] / np.abs(slope[axis - 1])
    assert event.time == pytest.approx(limit, rel=0, abs=1e-12 if stiction == "exact" else 2e-7)


@pytest.mark.parametrize("stiction", SOFT)
def test_a_held_axis_yields_by_the_law_of_its_spring_or_damper(stiction):
    k = 1e4
    robot = r3.Robot(3, controller=None, stiction=stiction, stiffness=k)
    result = r3.simulate(robot, None, 0.04, motor_torque=lambda t: RAMP * t)
    t = np.linspace(0.0, 0.04, 21)[1:, None]
    assert len(result.events) == 0
    # rM = k (rq - rq_stick), or rM = k rq'; torques of other axes move none that is held.
    yielded = {"stiff-spring": RAMP * t / k, "stiff-damper": RAMP * t**2 / (2.0 * k)}[stiction]
    got = result.at(t.ravel()).rotor_angle[:, 3:]
    assert got == pytest.approx(yielded[:, 3:], rel=0, abs=1e-3 * np.abs(yielded).max())


@pytest.mark.parametrize("stiction", ["exact", *SOFT])
def test_brakes_hold_exactly_whatever_holds_sticking_axes(stiction):
    robot = r3.Robot(3, controller=None, stiction=stiction)
    torque = np.array([0.0, 0.0, 0.0, 9.0, -9.0, 9.0])
    result = r3.simulate(robot, None, 0.1, motor_torque=torque, brakes=[False] * 4 + [True] * 2)
    # Axis 4 has no brake here, and slides.
    assert result.joint_angle[-1, 3] < -0.1
    for signal in ("joint_angle", "joint_rate", "joint_acceleration", "rotor_rate"):
        np.testing.assert_array_equal(getattr(result, signal)[:, 4:], 0.0)


@pytest.mark.parametrize("stiction", SOFT)
def test_springs_and_dampers_are_integrated_by_the_implicit_method_alone(stiction):
    robot, motion = r3.Robot(3, stiction=stiction), r3.Hold(np.zeros(6))
    assert r3.Simulator(robot, motion).method == "bdf"
    assert r3.Simulator(r3.Robot(3), motion).method == "erk"
    for method in ("exponential", "erk"):
        message = (
            f"^method: expected 'bdf' for stiction='{stiction}', which is stiff, got '{method}'$"
        )
        with pytest.raises(ValueError, match=message):
            r3.Simulator(robot, motion, method=method)


@pytest.mark.parametrize("stiction", ["exact", *SOFT])
def test_brakes_can_be_put_on_whatever_holds_an_axis(stiction):
    motion = r3.Hold((0.3, -0.5, 0.8, 0.2, 0.3, 0.1))
    simulator = r3.Simulator(r3.Robot(3, r3.Load(15.0), stiction=stiction), motion)
    simulator.step(0.01)
    simulator.brakes = True
    simulator.step(0.01)
    np.testing.assert_array_equal(simulator.joint_rate[3:], 0.0)
    np.testing.assert_array_equal(simulator.brakes, [False] * 3 + [True] * 3)


@pytest.mark.parametrize("options", [{}, {"rotor_coupling": "full"}, {"gear_damping": "contact"}])
@pytest.mark.parametrize("axis", [2, 5])
def test_an_axis_without_friction_never_sticks(axis, options):
    table_2 = {"rM_h": {axis: 0.0}, "friction": {axis: [(0.0, 0.0), (100.0, 0.0)]}}
    robot = r3.Robot(3, r3.Load(15.0), table_2=table_2, **options)
    result = r3.simulate(robot, RUNS["section-10"]._motion(r3), 0.4)
    np.testing.assert_array_equal(result.friction_torque[:, axis - 1], 0.0)
    rubbed = {event.axis for event in result.events if event.element == "friction"}
    assert rubbed == {1, 2, 3, 4, 5, 6} - {axis}
    moves = result.joint_rate[result.time > 0.05, axis - 1]
    assert (moves != 0.0).all()
