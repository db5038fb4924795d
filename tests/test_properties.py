"""What holds in every run: with random models, loads, poses, motions."""

from itertools import product

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from independent import (
    BACKLASH,
    DEAD_ZONE,
    GEAR_RATIO,
    STICKING_LIMIT,
    TORQUE_LIMIT,
    Hold,
    Hybrid,
    IndependentRobot,
)
from oracle_runs import OracleRun, times_of

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import sequence

# Reproducible, and for each model as many examples as fit in a few seconds.
few = settings(max_examples=8, deadline=None, derandomize=True)
every_model = pytest.mark.parametrize("model", [1, 2, 3, 4])


def angles(n, largest):
    return st.tuples(*[st.floats(-largest, largest)] * n)


@st.composite
def loads(draw):
    """Mass and position of a load, within its bounds."""
    radius, direction = draw(st.floats(0.0, 0.099)), draw(st.floats(0.0, 6.28))
    height = draw(st.floats(0.15, 0.25))
    position = (radius * np.cos(direction), radius * np.sin(direction), height)
    return draw(st.floats(0.0, 15.0)), position


@st.composite
def runs(draw, model):
    """A third of a second of a model with any load and motion; held poses begin with a push."""
    n = 6 if model in (1, 3) else 3
    mass, position = draw(loads())
    begin, step = draw(angles(n, 1.0)), draw(angles(n, 0.5))
    end = tuple(np.add(begin, step))
    start = None
    kind = draw(st.sampled_from(["Quintic", "Trapezoid", "Hold"]))
    if kind == "Quintic":
        motion = (kind, begin, end, draw(st.floats(0.2, 0.5)))
    elif kind == "Trapezoid":
        end = (*end[:-1], begin[-1] + 0.1)  # no motion of nothing
        rate, acceleration = (draw(st.floats(low, high)) for low, high in ((0.5, 3), (4, 20)))
        motion = (kind, begin, end, (rate,) * n, (acceleration,) * n)
    else:
        motion = (kind, begin)
        start = {
            "joint_angle": tuple(np.add(begin, np.divide(step, 50.0))),
            "joint_rate": draw(angles(n, 0.5)),
            "motor_torque": draw(angles(n, 2.0)),
        }
    return OracleRun(model, motion, 0.35, mass, position, start)


def lively(model):
    """A motion too quick for the robot: everything that can happen does, both ways."""
    n = 6 if model in (1, 3) else 3
    end = (0.5, -0.4, 0.5, -2.0, 2.0, -2.0)[:n]
    return OracleRun(model, ("Quintic", (0.0,) * n, end, 0.3), 0.8, 15.0)


def everywhere(result):
    """All recorded instants, and others inside every step."""
    steps = np.unique(result.time)
    inside = steps[:-1, None] + np.diff(steps)[:, None] * [0.01, 0.3, 0.9]
    return result, result.at(inside.ravel())


def state(samples, robot, name):
    """The states of one quantity along a run."""
    return samples.state[:, [label.startswith(f"{name}[") for label in robot.state_names]]


def changes(run):
    """What happened in a run, as (element, before, after)."""
    return {(event.element, event.before, event.after) for event in run.events}


def both_ways(*elements):
    """All changes of elements that go into a zone and out of it on both sides."""
    ways = ((0, 1), (1, 0), (0, -1), (-1, 0))
    return {(element, *way) for element in elements for way in ways}


# --- laws of the parts ----------------------------------------------------------------------------


@every_model
def test_branches_agree_with_the_values_that_they_belong_to(model):
    n = 6 if model in (1, 3) else 3
    happened = set()

    @few
    @example(lively(model))
    @given(runs(model))
    def agree(run):
        result = run.simulate()
        happened.update(changes(result))
        for samples in everywhere(result):
            deflection = samples.rotor_angle - GEAR_RATIO[:n] * samples.joint_angle
            zones = {
                "dead_zone": (samples.voltage, DEAD_ZONE[:n]),
                "torque_limit": (state(samples, run.robot, "pt2_torque"), TORQUE_LIMIT[:n]),
            }
            if model in (3, 4):
                zones["backlash"] = (deflection[:, :2], BACKLASH[:2])
            for element, (value, half) in zones.items():
                branch = samples.branches[element][:, : value.shape[1]]
                # At an edge itself, which events hit to roundoff, either branch may be right.
                inside, outside = np.abs(value) < half - 1e-9, np.abs(value) > half + 1e-9
                np.testing.assert_array_equal(branch[inside], 0)
                np.testing.assert_array_equal(branch[outside], np.sign(value[outside]))
            if model in (1, 2):
                for element in ("friction", "backlash"):
                    np.testing.assert_array_equal(samples.branches[element], 0)

    agree()
    gears = ("backlash",) if model in (3, 4) else ()
    assert happened >= both_ways("dead_zone", "torque_limit", *gears)  # not one was left out


@every_model
def test_motor_torques_obey_their_limit(model):
    largest = []

    @few
    @example(lively(model))
    @given(runs(model))
    def obey(run):
        for samples in everywhere(run.simulate()):
            free = state(samples, run.robot, "pt2_torque")
            limited = np.clip(free, -9.0, 9.0)
            # Where it has just reached the limit, within roundoff of t.
            assert samples.motor_torque == pytest.approx(limited, rel=0, abs=1e-9)
            largest.append((-free.min(), free.max()))

    obey()
    assert np.max(largest, axis=0).min() > 10.0  # the limit did matter, forward and backward


@every_model
@few
@given(data=st.data())
def test_gears_transmit_torques_and_rates(model, data):
    run = data.draw(runs(model))
    n = run.robot.n_axes
    e = 3 if run.model in (3, 4) else 0
    for samples in everywhere(run.simulate()):
        np.testing.assert_array_equal(samples.joint_torque, GEAR_RATIO[:n] * samples.gear_torque)
        turned = GEAR_RATIO[:n] * samples.joint_angle
        np.testing.assert_array_equal(samples.rotor_angle[:, e:], turned[:, e:])
        turning = GEAR_RATIO[:n] * samples.joint_rate
        np.testing.assert_array_equal(samples.rotor_rate[:, e:], turning[:, e:])
        left = samples.motor_torque - samples.friction_torque
        rigid = samples.gear_torque[:, e:]
        assert rigid == pytest.approx(left[:, e:], rel=0, abs=1e-13)  # roundoff


@pytest.mark.parametrize("model", [3, 4])
def test_friction_opposes_sliding_and_holds_sticking_rotors_within_its_limit(model):
    happened, stuck = set(), []

    @few
    @example(lively(model))
    @given(runs(model))
    def opposes_and_holds(run):
        result = run.simulate()
        happened.update(changes(result))
        for samples in everywhere(result):
            branch, rate = samples.branches["friction"], samples.rotor_rate
            slides = (branch != 0) & (np.abs(rate) > 1e-12)  # but for roundoff at events
            np.testing.assert_array_equal(np.sign(rate[slides]), branch[slides])
            assert np.all(samples.friction_torque[slides] * branch[slides] > 0.1)
            sticks = branch == 0
            np.testing.assert_array_equal(rate[sticks], 0.0)
            excess = np.abs(samples.friction_torque) - STICKING_LIMIT[: run.robot.n_axes]
            assert np.all(excess[sticks] <= 1e-12)
            stuck.append(sticks.any(axis=0))

    opposes_and_holds()
    reversals = {("friction", 1, -1), ("friction", -1, 1)}
    assert happened >= both_ways("friction") | reversals
    assert np.any(stuck, axis=0).all()  # every axis


@every_model
@few
@given(data=st.data())
def test_the_reference_is_the_motion(model, data):
    run = data.draw(runs(model))
    result = run.simulate()
    angle, rate = result.motion.angle(result.time), result.motion.rate(result.time)
    # Before a knot the old piece of the motion counts: right and left differ by roundoff.
    assert result.reference_angle == pytest.approx(angle, rel=0, abs=1e-14)
    assert result.reference_rate == pytest.approx(rate, rel=0, abs=1e-12)
    error = result.reference_angle - result.joint_angle
    np.testing.assert_array_equal(result.control_error, error)


@every_model
@few
@given(data=st.data())
def test_events_are_in_order_and_say_what_the_branches_do(model, data):
    run = data.draw(runs(model))
    result = run.simulate()
    assert np.all(np.diff(times_of(result.events)) >= 0.0)
    instants, count = np.unique(result.time, return_counts=True)
    np.testing.assert_array_equal(instants[count == 2], np.unique(times_of(result.events)))
    assert count.max() <= 2
    for event in result.events:
        assert 0.0 < event.time < run.t_end
        instants = np.flatnonzero(result.time == event.time)
        assert len(instants) == 2
        if event.axis == 0:
            assert event.time in result.motion.knots
            continue
        branch = result.branches[event.element][instants, event.axis - 1]
        assert (event.before, event.after) == tuple(branch)
        assert event.before != event.after


# --- symmetries -----------------------------------------------------------------------------------


def shifted(run, angle):
    """The same run with axis 1, which is vertical, turned by an angle."""

    def shift(q):
        return (q[0] + angle, *q[1:])

    kind, *rest = run.motion
    ends = 1 if kind == "Hold" else 2
    motion = (kind, *(shift(q) for q in rest[:ends]), *rest[ends:])
    start = run.start and {**run.start, "joint_angle": shift(run.start["joint_angle"])}
    return OracleRun(run.model, motion, run.t_end, run.mass, run.position, start)


def mirrored(run):
    """The same run in a mirror, the x-z plane: all axes turn the other way."""

    def mirror(q):
        return tuple(-value for value in q)

    kind, *rest = run.motion
    ends = 1 if kind == "Hold" else 2
    motion = (kind, *(mirror(q) for q in rest[:ends]), *rest[ends:])
    start = run.start and {name: mirror(values) for name, values in run.start.items()}
    x, y, z = run.position
    return OracleRun(run.model, motion, run.t_end, run.mass, (x, -y, z), start)


@every_model
@few
@given(data=st.data(), angle=st.floats(-1.0, 1.0))
def test_turning_the_robot_about_the_vertical_changes_nothing_else(model, data, angle):
    run = data.draw(runs(model))
    plain, turned = run.simulate(rtol=1e-10), shifted(run, angle).simulate(rtol=1e-10)
    assert sequence(turned.events) == sequence(plain.events)
    # Roundoff of the angles of axis 1, and what chance steps of the integrator make of it.
    assert times_of(turned.events) == pytest.approx(times_of(plain.events), rel=0, abs=1e-8)
    times = np.linspace(0.0, run.t_end, 50)
    for signal in ("joint_rate", "control_error"):
        got, expected = (getattr(result.at(times), signal) for result in (turned, plain))
        assert got == pytest.approx(expected, rel=0, abs=1e-8), signal


@every_model
@pytest.mark.parametrize("method", ["exponential", "erk"])
@few
@given(data=st.data())
def test_a_mirrored_robot_moves_in_the_mirror(model, method, data):
    run = data.draw(runs(model))
    plain, other = run.simulate(method=method), mirrored(run).simulate(method=method)
    # Arms are symmetrical to the x-z plane, and signs do not round: exactly so.
    np.testing.assert_array_equal(other.time, plain.time)
    np.testing.assert_array_equal(other.state, -plain.state)
    assert sequence(other.events) == [
        (axis, element, -before, -after) for axis, element, before, after in sequence(plain.events)
    ]


@every_model
@few
@given(data=st.data(), load=loads())
def test_a_load_without_mass_may_sit_anywhere(model, data, load):
    run = data.draw(runs(model))
    here, there = (
        OracleRun(run.model, run.motion, run.t_end, 0.0, position, run.start).simulate()
        for position in (run.position, load[1])
    )
    np.testing.assert_array_equal(here.state, there.state)


# --- against the independent implementation -------------------------------------------------------


@every_model
def test_any_state_accelerates_as_in_the_independent_implementation(model):
    n = 6 if model in (1, 3) else 3
    real = model in (3, 4)
    rng, decided = np.random.default_rng(model), set()
    for _ in range(40):
        load = rng.uniform(0.0, 15.0), (*rng.uniform(-0.07, 0.07, 2), rng.uniform(0.15, 0.25))
        q = rng.uniform(-np.pi, np.pi, n)
        moves = rng.random(n) < 0.7  # all others rest, and hardly anything drives them
        qd = rng.normal(0.0, 1.5, n) * moves
        torque = rng.normal(0.0, 8.0, n) * np.where(moves, 1.0, 0.03)
        values = {"joint_angle": q, "joint_rate": qd, "motor_torque": torque}
        if real:
            values["rotor_angle"], values["rotor_rate"] = GEAR_RATIO[:n] * q, GEAR_RATIO[:n] * qd
            values["rotor_angle"][:3] += rng.normal(0.0, 0.1, 3) * np.where(moves[:3], 1.0, 0.05)
            values["rotor_rate"][:3] += rng.normal(0.0, 5.0, 3) * moves[:3]
        robot, oracle = r3.Robot(model=model, load=r3.Load(*load)), IndependentRobot(model, *load)
        start, x = robot.state_from(**values), oracle.state_from(**values)
        voltage = rng.normal(0.0, 0.1, n)
        start[robot.state_names.index("voltage[1]") :][:n] = voltage
        x[oracle.slices["voltage"]] = voltage

        simulator = r3.Simulator(robot, r3.Hold(q), start=start)
        hybrid = Hybrid(oracle, Hold(q))
        hybrid.start(x)
        for element in ("dead_zone", "torque_limit", "backlash", "friction"):
            branches = simulator.branches[element]
            np.testing.assert_array_equal(branches, getattr(hybrid, element))
            decided.update((element, branch) for branch in branches)
        expected = hybrid.signals(0.0, x)
        scale = np.abs(expected["joint_acceleration"]).max()
        # Roundoff of rotor angles of 600 rad on stiff gears, and the condition of the mass matrix.
        assert simulator.joint_acceleration == pytest.approx(
            expected["joint_acceleration"], rel=0, abs=1e-10 * scale + 1e-10
        )
        for signal in ("motor_torque", "friction_torque", "rotor_rate", "voltage"):
            got = getattr(simulator, signal)
            assert got == pytest.approx(expected[signal], rel=1e-10, abs=1e-10), signal

    elements = ("dead_zone", "torque_limit", *(("backlash", "friction") if real else ()))
    assert decided >= set(product(elements, (-1, 0, 1)))  # nothing was left out
