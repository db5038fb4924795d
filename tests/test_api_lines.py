"""The lines that users rely on, as they write them, and what they mean.

Every test begins with lines of the public interface; the checks below them say what the names
promise. Physics is tested elsewhere: here it is shapes, names, semantics and lifetimes.
"""

import pickle
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from child import child

import manutec_r3 as r3

SIGNALS = (
    *("joint_angle", "joint_rate", "joint_acceleration", "rotor_angle", "rotor_rate"),
    *("reference_angle", "reference_rate", "control_error"),
    *("motor_torque", "gear_torque", "friction_torque", "joint_torque", "voltage"),
)
ELEMENTS = ("dead_zone", "torque_limit", "backlash", "friction")  # in the order of one instant
GEAR_RATIO = np.array([-105.0, 210.0, 60.0, -99.0, 79.2, -99.0])  # Table 1
EPS = np.finfo(float).eps

load = r3.Load(mass=15.0, position=(0.0, 0.0, 0.25))
robot = r3.Robot(model=3, load=load)
motion = r3.Quintic(start=[0] * 6, end=[1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)


@pytest.fixture(scope="module")
def result():
    return r3.simulate(robot, motion, t_end=1.5)


def motion_of(n_axes, *, end=1.2):
    """A motion for a robot with this many moving axes."""
    return r3.Quintic([0.0] * n_axes, [0.3] * n_axes, end)


# --- robot, load, motion ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "n_states", "n_indicators"), [(1, 12, 0), (2, 6, 0), (3, 18, 18), (4, 12, 12)]
)
def test_without_controller_there_is_nothing_electrical(model, n_states, n_indicators):
    robot = r3.Robot(model=model, controller=None)
    assert (robot.n_states, robot.n_indicators) == (n_states, n_indicators)
    assert not {"voltage[1]", "filter[1]", "pt2_torque[1]"} & set(robot.state_names)


@pytest.mark.parametrize(
    ("model", "controller", "n_axes", "n_states", "n_indicators"),
    [
        *((1, "continuous", 6, 60, 24), (2, "continuous", 3, 30, 12)),
        *((3, "continuous", 6, 66, 42), (4, "continuous", 3, 36, 24)),
        *((3, "sampled", 6, 66, 42), (4, "external", 3, 36, 24)),
        # the Modelica variant: no dead zones, no limits, no backlash
        *(("full-robot", "continuous", 6, 36, 18), ("one-axis", "continuous", 1, 7, 4)),
        *(("full-robot", None, 6, 18, 18), ("one-axis", None, 1, 4, 4)),
    ],
)
def test_each_model_has_its_size(model, controller, n_axes, n_states, n_indicators):
    robot = r3.Robot(model=model, controller=controller)
    assert (robot.n_axes, robot.n_states, robot.n_indicators) == (n_axes, n_states, n_indicators)
    for names in (robot.state_names, robot.state_units, robot.state_nominals):
        assert len(names) == n_states
    assert len(set(robot.indicator_names)) == n_indicators


def test_options_of_a_robot():
    r3.Robot(model=3, controller="sampled")
    r3.Robot(model=3, rotor_coupling="full")
    r3.Robot(model=3, gear_damping="contact")
    r3.Robot(model=3, stiction="stiff-spring")
    r3.Robot(model=2, arm="six-arm")
    usual = r3.Robot(model=3)
    assert usual.controller == "continuous"
    assert usual.rotor_coupling == ("simplified",) * 3 + ("full",) * 3
    assert (usual.gear_damping, usual.stiction, usual.arm) == ("parallel", "exact", "six-arm")
    assert r3.Robot(model=1).rotor_coupling == ("full",) * 6
    assert r3.Robot(model=2).arm == r3.Robot(model=4).arm == "lumped"
    assert r3.Robot(model=3, rotor_coupling="full").rotor_coupling == ("full",) * 6
    assert r3.Robot(model=4, rotor_coupling=["full"] * 3).rotor_coupling == ("full",) * 3


OPTIONS = [
    {"controller": "sampled"},
    {"controller": "external"},
    {"controller": None},
    {"rotor_coupling": "full"},
    {"rotor_coupling": ("full", "simplified") * 3},
    {"gear_damping": "contact"},
    {"stiction": "stiff-spring"},
    {"stiction": "stiff-damper", "stiffness": 1e6},
    {"creep_rate": 0.0},
    {"voltage_limit": 5.0},
    {"table_1": {"K_V": 0.25}},
    {"table_3": {"rn": {2: "z"}}},
]


@pytest.mark.parametrize("options", OPTIONS, ids=repr)
def test_a_robot_that_differs_in_an_option_is_another(options):
    robot = r3.Robot(model=3, **options)
    assert robot != r3.Robot(model=3)
    assert robot == r3.Robot(model=3, **options)
    assert hash(robot) == hash(r3.Robot(model=3, **options))
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert (repr(again), again.parameters) == (repr(robot), robot.parameters)
    assert eval(repr(robot), vars(r3)) == robot
    assert r3.Robot(model=3).replace(**options) == robot


def test_states_are_grouped_by_quantity_with_the_axis_fastest():
    assert (robot.n_axes, robot.n_states, robot.n_indicators) == (6, 66, 42)
    assert len(robot.indicator_names) == 42
    quantities = [name[:-3] for name in robot.state_names]
    assert list(dict.fromkeys(quantities)) == [
        *("joint_angle", "joint_rate", "deflection", "rotor_rate"),
        *("tachogenerator_1", "tachogenerator_2", "tachogenerator_3"),
        *("filter", "controller", "voltage", "pt2_torque", "pt2_torque_rate"),
    ]
    for quantity in dict.fromkeys(quantities):
        axes = [int(name[-2]) for name in robot.state_names if name[:-3] == quantity]
        elastic = quantity in ("deflection", "rotor_rate")  # gears of axes 1 to 3
        assert axes == list(range(1, 4 if elastic else 7))
    units = dict(zip(robot.state_names, robot.state_units, strict=True))
    assert (units["joint_angle[1]"], units["joint_rate[6]"]) == ("rad", "rad/s")
    assert (units["voltage[2]"], units["pt2_torque[3]"]) == ("V", "N m")


def test_a_state_from_quantities_of_the_axes():
    q, qd = np.linspace(0.1, 0.6, 6), np.linspace(-0.1, 0.4, 6)
    rq, rqd = GEAR_RATIO * q, GEAR_RATIO * qd
    rq[:3] += 0.02
    rqd[:3] += 0.5
    rF = np.linspace(-1.0, 1.0, 6)
    x = robot.state_from(
        joint_angle=q, joint_rate=qd, rotor_angle=rq, rotor_rate=rqd, motor_torque=rF
    )
    state = dict(zip(robot.state_names, x, strict=True))
    # what is given in one form and kept in another is rounded once
    for i in range(6):
        assert state.pop(f"joint_angle[{i + 1}]") == q[i]
        assert state.pop(f"joint_rate[{i + 1}]") == qd[i]
        assert state.pop(f"pt2_torque[{i + 1}]") == rF[i]
    for i in range(3):
        deflection = state.pop(f"deflection[{i + 1}]")
        assert deflection == pytest.approx(0.02, abs=4 * EPS * abs(rq[i]))
        assert state.pop(f"rotor_rate[{i + 1}]") == rqd[i]
    assert set(state.values()) == {0.0}  # the rest
    np.testing.assert_array_equal(r3.Simulator(robot, motion, start=x).state, x)


def test_a_start_is_a_name_or_the_state_that_it_stands_for():
    motion = r3.Hold([0.3, -0.5, 0.8, 0, 0, 0])
    x = robot.rest_state(motion)
    sim = r3.Simulator(robot, motion)
    np.testing.assert_array_equal(sim.state, x)
    np.testing.assert_array_equal(r3.Simulator(robot, motion, start="rotor").state, x)
    arm = r3.Simulator(robot, motion, start="arm")  # or the arms on the reference
    np.testing.assert_array_equal(arm.state, robot.rest_state(motion, "arm"))


def test_tables_are_a_copy_through_which_the_robot_cannot_be_changed():
    tables = robot.parameters
    tables["table_1"]["p"] = None
    np.testing.assert_array_equal(robot.parameters["table_1"]["p"], GEAR_RATIO)


@pytest.mark.parametrize(
    "thing",
    [load, robot, motion, r3.Trapezoid([0] * 3, [1] * 3, [2.5] * 3, [10] * 3), r3.Hold([0] * 6)],
    ids=lambda thing: type(thing).__name__,
)
def test_inputs_are_immutable_picklable_comparable(thing):
    again = pickle.loads(pickle.dumps(thing))
    assert again == thing
    assert hash(again) == hash(thing)
    assert repr(again) == repr(thing)
    for name in vars(thing):
        with pytest.raises(AttributeError):
            setattr(thing, name, None)


def test_what_differs_is_not_equal():
    assert robot == r3.Robot(model=3, load=r3.Load(15.0))  # (0, 0, 0.25) is the default
    assert robot != r3.Robot(model=3)
    assert robot != r3.Robot(model=1, load=load)
    assert r3.Robot(model=3) == r3.Robot(model=3, load=r3.Load(mass=0.0))  # default: no load
    assert r3.Robot(model=2) != r3.Robot(model=2, controller=None)
    assert motion != r3.Quintic(motion.start, motion.end, duration=1.3)
    assert r3.Hold([0] * 3) != r3.Hold([0] * 6)


def test_motions_answer_for_one_instant_and_for_many():
    quintic = r3.Quintic(start=[0] * 6, end=[1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
    trapezoid = r3.Trapezoid(start=[0] * 6, end=[1] * 6, rate=[2.5] * 6, acceleration=[10] * 6)
    hold = r3.Hold([0.3, -0.5, 0.8, 0, 0, 0])
    t = np.linspace(-0.5, 2.0, 11)
    for motion in (quintic, trapezoid, hold):
        for quantity in (motion.angle, motion.rate, motion.acceleration):
            assert quantity(0.4).shape == (6,)
            assert quantity(t).shape == (11, 6)
            assert quantity(list(t)).shape == (11, 6)
            np.testing.assert_array_equal(quantity(t)[4], quantity(t[4]))
    np.testing.assert_array_equal(quintic.angle(0.6), 0.5 * quintic.angle(1.2))  # symmetric
    # 15/8 of the mean rate in the middle; a rounding for each operation of the polynomial
    np.testing.assert_allclose(quintic.rate(0.6), 1.875 / 1.2 * quintic.angle(1.2), rtol=16 * EPS)
    assert quintic.duration == 1.2
    np.testing.assert_array_equal(quintic.knots, [0.0, 1.2])
    # 1 rad at 2.5 rad/s takes 0.4 s, and 0.25 s more to get there and back from it at 10 rad/s^2
    assert trapezoid.duration == pytest.approx(0.65, rel=4 * EPS)  # sums of rounded times
    np.testing.assert_allclose(trapezoid.knots, [0.0, 0.25, 0.4, 0.65], rtol=4 * EPS)
    np.testing.assert_allclose(trapezoid.rate(0.3), 2.5, rtol=16 * EPS)
    np.testing.assert_array_equal(hold.angle(t), np.tile([0.3, -0.5, 0.8, 0, 0, 0], (11, 1)))
    assert (hold.duration, hold.knots.size) == (0.0, 0)


def test_a_motion_rests_before_its_start_and_after_its_end():
    for angle, t in ((motion.start, -1.0), (motion.start, 0.0), (motion.end, 1.2), (motion.end, 9)):
        np.testing.assert_array_equal(motion.angle(t), angle)
        np.testing.assert_array_equal(motion.rate(t), 0.0)


def test_motions_are_right_continuous_at_their_knots():
    trapezoid = r3.Trapezoid(start=[0] * 6, end=[1] * 6, rate=[2.5] * 6, acceleration=[10] * 6)
    first = [trapezoid.acceleration(knot)[0] for knot in trapezoid.knots]
    np.testing.assert_allclose(first, [10.0, 0.0, -10.0, 0.0], rtol=16 * EPS)  # rounded products
    assert first[1] == first[3] == 0.0


def test_the_slowest_axis_leads_a_trapezoid():
    trapezoid = r3.Trapezoid([0.0] * 3, [1.0, -2.0, 0.5], rate=[2.5] * 3, acceleration=[10.0] * 3)
    rate = trapezoid.rate(np.linspace(0.0, trapezoid.duration, 101))
    assert np.abs(rate).max() == pytest.approx(2.5, rel=16 * EPS)  # axis 2, rounded products
    np.testing.assert_allclose(rate[:, 0], -0.5 * rate[:, 1], rtol=16 * EPS)
    np.testing.assert_allclose(rate[:, 2], -0.25 * rate[:, 1], rtol=16 * EPS)


# --- simulate -----------------------------------------------------------------------------------


def test_simulate_in_one_line(result):
    result = r3.simulate(robot, motion, t_end=1.5)
    assert result.time[0] == 0.0
    assert result.time[-1] == 1.5
    assert (np.diff(result.time) >= 0.0).all()
    n = len(result.time)
    for name in SIGNALS:
        assert getattr(result, name).shape == (n, 6), name
        assert np.isfinite(getattr(result, name)).all(), name
    assert result.state.shape == (n, 66)


def test_simulate_with_everything_said():
    result = r3.simulate(
        robot, motion, t_end=1.5, rtol=1e-9, method="erk", start="rotor", times=[0.0, 0.5, 1.0, 1.5]
    )
    assert (result.method, result.rtol) == ("erk", 1e-9)
    events = np.unique(result.events.time)
    recorded = np.union1d(np.repeat(events, 2), [0.0, 0.5, 1.0, 1.5])
    np.testing.assert_array_equal(np.unique(result.time), recorded)
    assert len(result.time) == 4 + 2 * len(events)  # both sides of each event


def test_simulate_with_the_other_method_and_from_a_state():
    x = robot.rest_state(motion)
    result = r3.simulate(robot, motion, t_end=0.1, method="bdf", start=x)
    np.testing.assert_array_equal(result.state[0], x)
    assert result.method == "bdf"
    assert result.rtol < r3.simulate(robot, motion, t_end=0.1).rtol  # each has its own default


@pytest.mark.parametrize("model", [1, 2, 3, 4])
@pytest.mark.parametrize("controller", ["continuous", None])
def test_signals_have_a_column_for_each_moving_axis(model, controller):
    robot = r3.Robot(model=model, controller=controller)
    result = r3.simulate(robot, motion_of(robot.n_axes), t_end=0.05)
    for name in SIGNALS:
        assert getattr(result, name).shape == (len(result.time), robot.n_axes), name
    assert result.state.shape == (len(result.time), robot.n_states)
    for element in ELEMENTS:
        assert result.branches[element].shape == (len(result.time), robot.n_axes)


def test_signals_mean_what_their_names_say(result):
    # before its knot at 1.2 s the motion is the polynomial, which rounds to the end angle
    np.testing.assert_allclose(result.reference_angle, motion.angle(result.time), atol=4 * EPS)
    # differences and products of recorded numbers, rounded alike
    np.testing.assert_array_equal(result.control_error, result.reference_angle - result.joint_angle)
    p = GEAR_RATIO
    np.testing.assert_array_equal(result.joint_torque, p * result.gear_torque)
    np.testing.assert_array_equal(result.rotor_angle[:, 3:], (p * result.joint_angle)[:, 3:])
    np.testing.assert_array_equal(result.rotor_rate[:, 3:], (p * result.joint_rate)[:, 3:])
    # axes 4 to 6 are rigid; while one sticks its torques come from a solve, rounded a few times
    np.testing.assert_allclose(
        result.gear_torque[:, 3:],
        (result.motor_torque - result.friction_torque)[:, 3:],
        atol=64 * EPS * 10.0,
    )
    names = list(robot.state_names)
    np.testing.assert_array_equal(result.state[:, names.index("voltage[2]")], result.voltage[:, 1])
    # no limit of torque in this run: rF is the state of the motor
    np.testing.assert_array_equal(
        result.state[:, names.index("pt2_torque[5]")], result.motor_torque[:, 4]
    )
    # tau = c s + d delta' of axis 2, with s = 0 inside the gap of half-width b (Table 2)
    delta = result.state[:, names.index("deflection[2]")]
    delta_rate = result.rotor_rate[:, 1] - p[1] * result.joint_rate[:, 1]
    s = np.sign(delta) * np.maximum(np.abs(delta) - 0.06, 0.0)
    tau = 8.0 * s + 0.01 * delta_rate
    # the two rates are up to 334 rad/s and cancel
    np.testing.assert_allclose(result.gear_torque[:, 1], tau, atol=0.01 * 334 * 16 * EPS)


def test_what_a_robot_does_not_have_is_nan_or_zero():
    result = r3.simulate(r3.Robot(model=2, controller=None), None, t_end=0.05)
    for name in ("reference_angle", "reference_rate", "control_error", "voltage"):
        assert np.isnan(getattr(result, name)).all(), name
    for name in ("joint_angle", "joint_rate", "motor_torque", "friction_torque"):
        np.testing.assert_array_equal(getattr(result, name), 0.0)  # an equilibrium
    followed = r3.simulate(r3.Robot(model=2, controller=None), r3.Hold([0.1] * 3), t_end=0.05)
    assert np.isfinite(followed.control_error).all()  # to compare with, nothing follows it
    assert np.isnan(followed.voltage).all()
    ideal = r3.simulate(r3.Robot(model=1), motion_of(6), t_end=0.1)
    np.testing.assert_array_equal(ideal.friction_torque, 0.0)
    for element in ("friction", "backlash"):
        np.testing.assert_array_equal(ideal.branches[element], 0)


def test_dense_output_has_the_same_signals_at_any_times(result):
    samples = result.at([0.1, 0.2])
    for name in SIGNALS:
        assert getattr(samples, name).shape == (2, 6), name
    assert samples.state.shape == (2, 66)
    assert samples.branches["friction"].shape == (2, 6)
    np.testing.assert_array_equal(result.at([0.2, 0.1]).state, samples.state[::-1])
    np.testing.assert_array_equal(result.at(0.1).state, samples.state[:1])


def test_dense_output_is_right_continuous_at_events(result):
    times = np.unique(result.events.time)
    after = np.searchsorted(result.time, times, side="right") - 1
    samples = result.at(times)
    np.testing.assert_array_equal(samples.state, result.state[after])
    for name in SIGNALS:
        np.testing.assert_array_equal(getattr(samples, name), getattr(result, name)[after])
    for element in ELEMENTS:
        np.testing.assert_array_equal(samples.branches[element], result.branches[element][after])


def test_statistics_are_summed_over_restarts(result):
    work = result.statistics
    assert work.events == len(result.events) == 60
    # One restart for each instant with events, one for each passage of a rotor through the kink of
    # its friction, one when a rotor 1 to 3 has broken away and is faster than 1e-8 rad/s.
    instants = len(np.unique(result.events.time))
    fast = np.abs(result.rotor_rate[:, [1, 2, 4]]) > [130.0, 130.0, 100.0]  # Table 2
    kinks = np.count_nonzero(np.diff(fast, axis=0))
    starts = sum(e.element == "friction" and e.axis <= 3 and e.after != 0 for e in result.events)
    assert (instants, kinks, starts) == (60, 2, 7)
    assert work.restarts == instants + kinks + starts == 69
    assert work.evaluations > work.steps > len(result.events)
    assert work.samples == 0
    assert work.seconds > 0.0


def test_events_are_rows_and_columns(result):
    assert len(result.events) == 60
    for k, event in enumerate(result.events):
        columns = result.events
        assert event.time == columns.time[k]
        assert event.axis == columns.axis[k]
        assert event.element == columns.element[k]
        assert (event.before, event.after) == (columns.before[k], columns.after[k])
        assert event.element in (*ELEMENTS, "reference")
        if event.element == "reference":
            assert (event.axis, event.before, event.after) == (0, 0, 0)
        else:
            assert 1 <= event.axis <= 6
            assert {event.before, event.after} <= {-1, 0, 1}
            assert event.before != event.after


def test_a_result_survives_pickling(result):
    again = pickle.loads(pickle.dumps(result))
    assert again.events == result.events
    np.testing.assert_array_equal(again.state, result.state)
    np.testing.assert_array_equal(again.at(0.7).motor_torque, result.at(0.7).motor_torque)


def test_arrays_outlive_their_result():
    result = r3.simulate(robot, motion, t_end=0.1)
    angle, expected = result.joint_angle, result.joint_angle.copy()
    del result
    r3.simulate(robot, motion, t_end=0.1)  # reuses freed memory, if any was freed too early
    np.testing.assert_array_equal(angle, expected)


def test_a_sampled_run_counts_its_samples_and_lists_them_if_asked():
    robot = r3.Robot(model=4, controller="sampled")
    hold = r3.Hold([0.1, 0.2, 0.3])
    result = r3.simulate(robot, hold, t_end=0.05)
    assert result.statistics.samples == 6  # at 8, 16, ..., 48 ms; the one at the start is none
    assert "sample" not in result.events.element
    listed = r3.simulate(robot, hold, t_end=0.05, list_samples=True)
    samples = [event for event in listed.events if event.element == "sample"]
    assert [(e.axis, e.before, e.after) for e in samples] == [(0, 0, 0)] * 6
    np.testing.assert_array_equal([e.time for e in samples], 0.008 * np.arange(1, 7))
    assert [e for e in listed.events if e.element != "sample"] == list(result.events)
    assert listed.statistics.samples == 6
    # listing changes nothing; an instant of an event stands twice
    np.testing.assert_array_equal(listed.at(result.time).state, result.at(result.time).state)


def by_sine(t):
    return [np.sin(40.0 * t), 0.5, -0.2]


def test_inputs_are_held_or_functions_of_time():
    robot = r3.Robot(model=2, controller=None)
    held = r3.simulate(robot, None, t_end=0.05, motor_torque=[1.0, 2.0, 0.5])
    np.testing.assert_array_equal(held.motor_torque, np.tile([1.0, 2.0, 0.5], (len(held.time), 1)))
    moving = r3.simulate(robot, None, t_end=0.05, motor_torque=by_sine)
    np.testing.assert_array_equal(moving.motor_torque, [by_sine(t) for t in moving.time])
    with_knot = r3.simulate(robot, None, t_end=0.05, motor_torque=r3.Input(by_sine, knots=[0.02]))
    assert 0.02 in with_knot.time
    np.testing.assert_array_equal(with_knot.motor_torque, [by_sine(t) for t in with_knot.time])


@pytest.mark.parametrize(
    "run",
    [
        lambda: r3.simulate(r3.Robot(3, controller="sampled"), HOLD, 0.03, list_samples=True),
        lambda: r3.simulate(
            r3.Robot(2, controller=None), None, 0.03, motor_torque=r3.Input(by_sine, [0.02])
        ),
        lambda: r3.simulate(robot, HOLD, 0.03, tip_force=[10.0, 0.0, -20.0], brakes=True),
        lambda: r3.simulate(r3.Robot("one-axis"), r3.Quintic([0.0], [0.1], 0.1), 0.15),
        lambda: r3.simulate(r3.Robot(4, voltage_limit=1.5), motion_of(3, end=0.2), 0.1),
    ],
    ids=["samples", "function", "force-and-brakes", "one-axis", "voltage-limit"],
)
def test_a_run_with_options_and_inputs_survives_pickling(run):
    result = run()
    again = pickle.loads(pickle.dumps(result))
    assert again.events == result.events
    assert again.robot == result.robot
    assert again.motion == result.motion
    for name in (*SIGNALS, "state"):
        np.testing.assert_array_equal(getattr(again, name), getattr(result, name))
        at = getattr(again.at(0.0123), name)
        np.testing.assert_array_equal(at, getattr(result.at(0.0123), name))


# --- step by step -------------------------------------------------------------------------------


def test_a_step_goes_through_every_event_on_the_way(result):
    sim = r3.Simulator(robot, motion, rtol=1e-8)
    assert sim.step(1e-3) == []
    assert sim.time == 1e-3
    met = sim.step(0.1)
    assert [event.element for event in met][:2] == ["dead_zone", "dead_zone"]
    assert all(0.001 < event.time <= 0.101 for event in met)
    assert sim.step(0.0) == []


def test_without_an_end_it_looks_until_half_a_second_after_the_motion():
    sim = r3.Simulator(r3.Robot(model=1), r3.Quintic([0] * 6, [0.01] * 6, 0.1))
    while sim.step_to_event() is not None:
        pass
    assert sim.time == pytest.approx(0.6, rel=4 * EPS)  # a sum of rounded numbers
    sim.step(1.0)
    now = sim.time
    assert sim.step_to_event() is None
    assert sim.time == now  # never back


def test_an_event_at_the_end_is_left_for_the_next_call():
    sim = r3.Simulator(r3.Robot(model=2), r3.Quintic([0] * 3, [0] * 3, duration=0.1))
    assert sim.step_to_event(t_end=0.1) is None
    assert sim.time == 0.1
    assert sim.step_to_event(t_end=0.2) == (0.1, 0, "reference", 0, 0)
    assert sim.time == 0.1
    sim = r3.Simulator(r3.Robot(model=2), r3.Quintic([0] * 3, [0] * 3, duration=0.1))
    assert sim.step(0.1) == [(0.1, 0, "reference", 0, 0)]  # a step includes its end


def test_a_simulator_shows_every_signal_at_this_instant(result):
    sim = r3.Simulator(robot, motion)
    for event in result.events:
        sim.step_to_event()
        after = np.searchsorted(result.time, event.time, side="right") - 1
        for name in SIGNALS:
            assert getattr(sim, name).shape == (6,)
            np.testing.assert_array_equal(getattr(sim, name), getattr(result, name)[after])
        np.testing.assert_array_equal(sim.state, result.state[after])
        for element in ELEMENTS:
            assert sim.branches[element].shape == (6,)
            np.testing.assert_array_equal(sim.branches[element], result.branches[element][after])


def test_what_was_saved_outlives_its_simulator():
    sim = r3.Simulator(robot, motion)
    sim.step(0.5)
    saved, at_save = sim.save(), sim.state
    sim.step(0.1)
    del sim
    other = r3.Simulator(robot, motion)
    other.restore(saved)
    assert other.time == saved.time == 0.5
    np.testing.assert_array_equal(other.state, at_save)


def test_held_inputs_are_saved_and_restored():
    sim = r3.Simulator(robot, HOLD)
    sim.tip_force, sim.brakes = [10.0, 0.0, -20.0], [False] * 3 + [True, False, True]
    sim.step(0.01)
    saved = sim.save()
    expected = sim.step(0.1), sim.state
    sim.tip_force, sim.brakes = [0.0] * 3, False
    other = r3.Simulator(robot, HOLD)
    for restored in (sim, other):
        restored.restore(saved)
        np.testing.assert_array_equal(restored.tip_force, [10.0, 0.0, -20.0])
        np.testing.assert_array_equal(restored.brakes, [False] * 3 + [True, False, True])
        assert restored.step(0.1) == expected[0]
        np.testing.assert_array_equal(restored.state, expected[1])
    external = r3.Simulator(r3.Robot(model=4, controller="external"))
    external.command = [0.1, 0.2, 0.3]
    saved = external.save()
    external.command = [0.0] * 3
    external.restore(saved)
    np.testing.assert_array_equal(external.command, [0.1, 0.2, 0.3])


def test_a_state_with_another_input_of_time_is_refused():
    robot = r3.Robot(model=2, controller=None)
    saved = r3.Simulator(robot, motor_torque=by_sine).save()
    r3.Simulator(robot, motor_torque=by_sine).restore(saved)
    message = "saved: expected .* with motor_torque None; got one with motor_torque Input"
    with pytest.raises(ValueError, match=message):
        r3.Simulator(robot).restore(saved)


def test_what_another_robot_saved_is_refused():
    saved = r3.Simulator(robot, motion).save()
    other = r3.Simulator(r3.Robot(model=2), r3.Hold([0] * 3))
    with pytest.raises(ValueError, match="saved"):
        other.restore(saved)
    with pytest.raises(ValueError, match=r"saved: .*rtol 1e-06; got .*rtol 5e-08"):
        r3.Simulator(robot, motion, rtol=1e-6).restore(saved)


def test_a_motion_shows_how_to_make_it_again():
    for made in (motion, r3.Trapezoid([0] * 3, [1] * 3, [2.5] * 3, [10] * 3), r3.Hold([0.1] * 3)):
        assert eval(repr(made), vars(r3)) == made


def test_branches_are_decided_from_a_state_by_physics():
    x = robot.state_from(joint_angle=[0] * 6, rotor_angle=[0.02, -0.03, 0.01, 0, 0, 0])
    x[robot.state_names.index("voltage[4]")] = 0.03  # beyond the dead zone of 0.022 V
    x[robot.state_names.index("pt2_torque[1]")] = -10.0  # beyond the limit of 9 N m
    x[robot.state_names.index("rotor_rate[3]")] = -1.0
    sim = r3.Simulator(robot, motion, start=x)
    np.testing.assert_array_equal(sim.branches["dead_zone"], [0, 0, 0, 1, 0, 0])
    np.testing.assert_array_equal(sim.branches["torque_limit"], [-1, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(sim.branches["backlash"], [1, 0, 0, 0, 0, 0])  # 0.01, 0.06 rad
    # 9 N m and a tensed gear pull rotor 1 backward; rotor 3 moves; all others hold
    np.testing.assert_array_equal(sim.branches["friction"], [-1, 0, -1, 0, 0, 0])
    assert sim.motor_torque[0] == -9.0
    assert sim.time == 0.0
    assert sim.statistics["events"] == 0  # the decision at the start is no event


def test_motor_torques_are_inputs_without_a_controller():
    sim = r3.Simulator(r3.Robot(model=2, controller=None))
    np.testing.assert_array_equal(sim.motor_torque, 0.0)
    np.testing.assert_array_equal(sim.joint_angle, 0.0)
    sim.motor_torque = [1.0, 2.0, 0.5]
    sim.step(1e-3)
    np.testing.assert_array_equal(sim.motor_torque, [1.0, 2.0, 0.5])
    sim.step(1e-3)
    np.testing.assert_array_equal(sim.motor_torque, [1.0, 2.0, 0.5])  # held


def test_commands_are_inputs_of_an_external_controller():
    sim = r3.Simulator(r3.Robot(model=3, controller="external"))
    np.testing.assert_array_equal(sim.command, 0.0)
    sim.command = [0.1] * 6
    sim.step(8e-3)
    np.testing.assert_array_equal(sim.command, 0.1)  # V, held
    assert (sim.voltage > 0.1).all()  # the rate controllers integrate it
    assert np.isnan(sim.control_error).all()


def test_a_sampled_controller_shows_the_command_that_it_holds():
    sim = r3.Simulator(r3.Robot(model=3, controller="sampled"), motion)
    sim.step(0.1)
    held = sim.command
    sim.step(3e-3)  # to 0.103 s; the next sample is at 0.104 s
    np.testing.assert_array_equal(sim.command, held)
    sim.step(2e-3)
    assert (sim.command != held).any()


def test_samples_end_a_step_to_an_event_only_if_they_are_listed():
    robot, hold = r3.Robot(model=4, controller="sampled"), r3.Hold([0.1, 0.2, 0.3])
    sim = r3.Simulator(robot, hold, list_samples=True)
    assert sim.step_to_event() == (0.008, 0, "sample", 0, 0)
    sim = r3.Simulator(robot, hold)
    event = sim.step_to_event()
    assert event is None or event.element != "sample"
    assert sim.statistics["samples"] == int(sim.time / 0.008)


def test_a_function_that_raises_is_heard_unchanged_and_the_simulator_goes_on():
    class Mine(Exception):
        pass

    def torque(t):
        if t > 0.01 and broken:
            raise Mine("sensor", t)
        return [1.0, 0.0, 0.0]

    robot, broken = r3.Robot(model=2, controller=None), True
    sim = r3.Simulator(robot, motor_torque=torque)
    with pytest.raises(Mine) as caught:
        sim.step(0.02)
    assert caught.value.args[0] == "sensor"
    assert sim.time <= 0.01
    with pytest.raises(Mine):
        r3.simulate(robot, None, 0.02, motor_torque=torque)
    broken = False
    sim.step(0.02 - sim.time)
    whole = r3.Simulator(robot, motor_torque=torque)
    whole.step(0.02)
    np.testing.assert_array_equal(sim.state, whole.state)


def test_setting_an_input_decides_branches_at_once():
    sim = r3.Simulator(r3.Robot(model=3, controller=None))
    sim.step(0.01)
    np.testing.assert_array_equal(sim.branches["friction"], 0)
    sim.motor_torque = [1.0, -1.0, 1.0, -1.0, 0.0, 0.0]
    slides = [1, -1, 1, -1, 0, 0]
    np.testing.assert_array_equal(sim.branches["friction"], slides)
    assert sim.time == 0.01
    # they are told by the next step, in the order of the axes
    assert sim.step(0.0) == [(0.01, i + 1, "friction", 0, s) for i, s in enumerate(slides) if s]
    sim.motor_torque = [0.0] * 6
    sim.step(0.5)
    np.testing.assert_array_equal(sim.branches["friction"], 0)  # friction has stopped it


def test_the_events_of_one_instant_follow_without_advance():
    sim = r3.Simulator(r3.Robot(model=3, controller=None))
    sim.step(0.01)
    sim.motor_torque = [1.0] * 6
    for axis in range(1, 7):
        assert sim.step_to_event(t_end=0.02) == (0.01, axis, "friction", 0, 1)
        assert sim.time == 0.01


# --- the arm alone ------------------------------------------------------------------------------


@pytest.mark.parametrize("model", [1, 2, 3, 4, "full-robot", "one-axis"])
def test_the_arm_alone_for_one_pose_or_many(model):
    robot = r3.Robot(model=model)
    n = robot.n_axes
    random = np.random.default_rng(1)
    q, qd, tau = random.uniform(-1.0, 1.0, (3, 5, 2, n))
    qdd = robot.forward_dynamics(q, qd, tau)
    assert qdd.shape == robot.inverse_dynamics(q, qd, qdd).shape == (5, 2, n)
    assert robot.mass_matrix(q).shape == (5, 2, n, n)
    assert robot.link_poses(q).shape == (5, 2, 7, 4, 4)
    assert robot.load_position(q).shape == (5, 2, 3)
    assert robot.forward_dynamics(list(q[3, 1]), list(qd[3, 1]), list(tau[3, 1])).shape == (n,)
    # one rate and one torque for all poses
    assert robot.forward_dynamics(q, qd[0, 0], tau[0, 0]).shape == (5, 2, n)


def test_the_arm_is_written_for_other_programs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for remarks in (r3.export_urdf(robot, "r3.urdf"), r3.export_mjcf(robot, tmp_path / "r3.xml")):
        assert all(isinstance(remark, str) for remark in remarks)
    assert {path.name for path in tmp_path.iterdir()} == {"r3.urdf", "r3.xml"}


# --- meanings that must not differ --------------------------------------------------------------


@pytest.mark.parametrize("model", [2, 4])
def test_models_2_and_4_accept_motions_of_six_axes_with_the_last_at_zero(model):
    robot = r3.Robot(model=model, load=load)
    six = r3.simulate(robot, r3.Quintic([0] * 6, [0.3, 0.2, 0.1, 0, 0, 0], 0.3), t_end=0.5)
    assert six.reference_angle.shape == (len(six.time), 3)


def test_an_element_that_an_axis_lacks_has_branch_zero(result):
    np.testing.assert_array_equal(result.branches["backlash"][:, 3:], 0)  # rigid gears
    np.testing.assert_array_equal(result.branches["backlash"][:, 2], 0)  # no backlash: b = 0


def test_knots_at_the_ends_are_no_events():
    robot = r3.Robot(model=2)
    trapezoid = r3.Trapezoid([0] * 3, [1] * 3, rate=[2.5] * 3, acceleration=[10] * 3)
    for t_end, n_knots in ((trapezoid.knots[2], 1), (trapezoid.duration, 2), (1.0, 3)):
        result = r3.simulate(robot, trapezoid, t_end=t_end)
        met = result.events.time[result.events.element == "reference"]
        np.testing.assert_array_equal(met, trapezoid.knots[1 : 1 + n_knots])


# --- scenarios and the command ------------------------------------------------------------------


def test_a_scenario_is_the_same_run(result):
    assert {"figure9", "figure9-quintic"} <= set(r3.scenarios())
    scenario = r3.Scenario.load("figure9-quintic").run()
    assert scenario.events == result.events
    np.testing.assert_array_equal(scenario.state, result.state)


def test_the_modelica_variant_is_a_scenario_with_the_same_result_type():
    assert {"full-robot", "one-axis"} <= set(r3.scenarios())
    result = r3.Scenario.load("full-robot").run(rtol=1e-8)
    assert isinstance(result, r3.Result)
    assert result.rtol == 1e-8
    assert result.time[-1] == result.t_end == r3.Scenario.load("full-robot").t_end
    for name in SIGNALS:
        assert getattr(result, name).shape == (len(result.time), 6), name
        assert np.isfinite(getattr(result, name)).all(), name
    assert set(result.events.element) == {"friction", "reference"}
    np.testing.assert_array_equal(result.control_error[0], 0.0)  # the joints are on the reference


def test_the_command_runs_figure9(result, tmp_path):
    command = [sys.executable, "-c", "from manutec_r3.command_line import main; main()"]
    done = subprocess.run(
        [*command, "run", "figure9-quintic"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "60: 26 dead zone, 20 friction, 13 backlash, 1 reference" in done.stdout
    with np.load(tmp_path / "figure9-quintic" / "result.npz") as archive:
        np.testing.assert_array_equal(archive["control_error"], result.control_error)


# --- errors -------------------------------------------------------------------------------------

NAN, INF = float("nan"), float("inf")
HOLD = r3.Hold([0] * 6)


def simulate(robot=robot, motion=HOLD, t_end=0.01, **options):
    return r3.simulate(robot, motion, t_end, **options)


def simulator(model=3, controller="continuous"):
    robot = r3.Robot(model=model, controller=controller)
    return r3.Simulator(robot, r3.Hold([0.0] * robot.n_axes))


def set_torque(torque, controller=None):
    simulator(2, controller).motor_torque = torque


def set_input(robot, name, value, **options):
    setattr(r3.Simulator(robot, HOLD, **options), name, value)


def pushed(torque):
    return r3.simulate(r3.Robot(model=2, controller=None), None, 0.01, motor_torque=torque)


def beyond_voltage_limit(voltage):
    """A state in which the voltage of axis 2 is this."""
    start = robot.rest_state(HOLD)
    start[robot.state_names.index("voltage[2]")] = voltage
    return start


def braked_while_it_moves():
    sim = r3.Simulator(robot, motion)
    sim.step(0.5)
    sim.brakes = True


# each: what is done; what the message says of field, axis, unit, expected and arrived value
BAD = [
    # robot and load
    (lambda: r3.Robot(model=5), r"model: expected 1, 2, 3, 4, 'full-robot' or 'one-axis', got 5"),
    (
        lambda: r3.Robot(model="3"),
        r"model: expected 1, 2, 3, 4, 'full-robot' or 'one-axis', got '3'",
    ),
    (lambda: r3.Robot(load=15.0), r"load: expected a Load, got 15\.0"),
    (lambda: r3.Robot(model=10**30), r"model: expected 1, 2, 3, 4, .*, got 10000"),
    (lambda: r3.Robot(model=True), r"model: expected 1, 2, 3, 4, .*, got True"),
    (lambda: r3.Robot(controller="pid"), r"controller: expected .*'continuous'.*, got 'pid'"),
    (lambda: r3.Robot(controller=True), r"controller: expected .* or None, got True"),
    (
        lambda: r3.Robot(rotor_coupling="half"),
        r"rotor_coupling: expected 'full' or 'simplified', got 'half'",
    ),
    (
        lambda: r3.Robot(rotor_coupling=["full"] * 3),
        r"rotor_coupling: expected 'full', 'simplified' or 6 of them, got \['full', 'f.*\]",
    ),
    (
        lambda: r3.Robot(rotor_coupling=["full"] * 5 + [None]),
        r"rotor_coupling of axis 6: expected 'full' or 'simplified', got None",
    ),
    (
        lambda: r3.Robot(gear_damping=None),
        r"gear_damping: expected 'parallel' or 'contact', got None",
    ),
    (
        lambda: r3.Robot(stiction=None),
        r"stiction: expected 'exact', .* or 'stiff-damper', got None",
    ),
    (lambda: r3.Robot(stiffness=0.0), r"stiffness: expected a positive .*\[N m/rad, .*\], got 0"),
    (lambda: r3.Robot(stiffness=NAN), r"stiffness: expected a finite .*\[N m/rad, .*\], got nan"),
    (lambda: r3.Robot(stiffness=True), r"stiffness: expected one number .*\], got True"),
    (lambda: r3.Robot(creep_rate=-1.0), r"creep_rate: expected .*0 rad/s or more, got -1"),
    (lambda: r3.Robot(creep_rate="1"), r"creep_rate: expected one number \[rad/s\], got '1'"),
    (lambda: r3.Robot(voltage_limit=-1.0), r"voltage_limit: expected a positive .*\[V\], got -1"),
    (lambda: r3.Robot(voltage_limit=INF), r"voltage_limit: expected a finite .*\[V\], got inf"),
    (
        lambda: r3.Robot(voltage_limit=0.09),
        r"voltage_limit: expected more than .*0\.096 V, got 0\.09 V",
    ),
    (lambda: r3.Robot(2, arm="six"), r"arm: expected 'lumped' or 'six-arm', got 'six'"),
    # options that a model does not have
    (
        lambda: r3.Robot(1, gear_damping="contact"),
        r"gear_damping: expected 'parallel' for model 1, whose gears are ideal, got 'contact'",
    ),
    (
        lambda: r3.Robot(2, stiction="stiff-spring"),
        r"stiction: expected 'exact' for model 2, which has no friction, got 'stiff-spring'",
    ),
    (
        lambda: r3.Robot(4, stiction="stiff-damper"),
        r"stiction: expected 'exact' for model 4, whose gears are all elastic, got 'stiff-damper'",
    ),
    (
        lambda: r3.Robot(3, arm="lumped"),
        r"arm: expected 'six-arm' for model 3, whose joints 4 to 6 are not blocked, got 'lumped'",
    ),
    (
        lambda: r3.Robot("full-robot", controller="sampled"),
        r"controller: expected 'continuous' or None for model full-robot, got 'sampled'",
    ),
    (
        lambda: r3.Robot("full-robot", rotor_coupling="full"),
        r"rotor_coupling of axis 1: expected 'simplified' for model full-robot, .*, got 'full'",
    ),
    (
        lambda: r3.Robot("one-axis", voltage_limit=5.0),
        r"voltage_limit: expected none for model one-axis, .* rate controllers .*, got 5",
    ),
    (
        lambda: r3.Robot(3, controller=None, voltage_limit=5.0),
        r"voltage_limit: expected none with controller=None, .* rate controllers .*, got 5",
    ),
    (lambda: r3.Robot("one-axis", load=load), r"load: expected none for model one-axis; .*inertia"),
    (lambda: r3.Robot().replace(stictoin="exact"), r"replace: expected one of .*, got 'stictoin'"),
    (lambda: r3.Load(-1.0), r"load\.mass: expected .*0 kg.*, got -1 kg"),
    (lambda: r3.Load(15.1), r"load\.mass: expected 0 to 15 kg, got 15\.1 kg"),
    (lambda: r3.Load(NAN), r"load\.mass: expected .*finite.*\[kg\], got nan"),
    (lambda: r3.Load("1"), r"load\.mass: expected .*number.*\[kg\], got '1'"),
    (lambda: r3.Load(None), r"load\.mass: expected .*number.*\[kg\], got None"),
    (lambda: r3.Load(1.0, (0.0, 0.2)), r"load\.position: expected three .*\[m\], got .*2"),
    (lambda: r3.Load(1.0, (0, INF, 0.2)), r"load\.position.*: expected .*finite.*\[m\], got inf"),
    (lambda: r3.Load(1.0, (0.1, 0.1, 0.2)), r"load\.position.*expected 0 to 0\.1 m, got 0\.1414"),
    (
        lambda: r3.Load(1.0, (0, 0, 0.3)),
        r"load\.position\[2\]: expected 0\.15 to 0\.25 m, got 0\.3",
    ),
    (lambda: r3.Load(-1.0, bounds=False), r"load\.mass: expected .*0 kg.*, got -1 kg"),
    # motions
    (lambda: r3.Quintic([0] * 4, [0] * 4, 1.0), r"start: expected 1, 3 or 6 .*\[rad\], got 4"),
    (lambda: r3.Quintic([0] * 6, [0] * 5, 1.0), r"end: expected 6 .*, got 5"),
    (lambda: r3.Quintic(0.0, [0] * 6, 1.0), r"start: expected 1, 3 or 6 .*\[rad\].*\(\)"),
    (lambda: r3.Quintic([0, 0, NAN], [0] * 3, 1.0), r"start of axis 3: .*finite.*\[rad\], got nan"),
    (lambda: r3.Quintic([0] * 3, [0, INF, 0], 1.0), r"end of axis 2: .*finite.*\[rad\], got inf"),
    (lambda: r3.Quintic("abc", [0] * 3, 1.0), r"start: expected .*numbers \[rad\].*, got 'abc'"),
    (lambda: r3.Quintic([0] * 3, [0] * 3, 0.0), r"duration: expected a positive .*\[s\], got 0"),
    (lambda: r3.Quintic([0] * 3, [0] * 3, -1.0), r"duration: expected a positive .*\[s\], got -1"),
    (lambda: r3.Quintic([0] * 3, [0] * 3, NAN), r"duration: expected .*finite.*\[s\], got nan"),
    (
        lambda: r3.Trapezoid([0] * 3, [1] * 3, [1, -1, 1], [1] * 3),
        r"rate of axis 2: expected a positive .*\[rad/s\], got -1",
    ),
    (
        lambda: r3.Trapezoid([0] * 3, [1] * 3, [1] * 3, [0, 1, 1]),
        r"acceleration of axis 1: expected a positive .*\[rad/s\^2\], got 0",
    ),
    (
        lambda: r3.Trapezoid([0] * 3, [1] * 3, [1] * 3, [1, 1, NAN]),
        r"acceleration of axis 3: expected .*finite.*\[rad/s\^2\], got nan",
    ),
    (lambda: r3.Trapezoid([0] * 3, [1] * 3, [1] * 2, [1] * 3), r"rate: expected 3 values.*, got 2"),
    (lambda: r3.Hold([0, 0]), r"angles: expected 1, 3 or 6 angles \[rad\], got 2"),
    (lambda: r3.Hold([0, NAN, 0]), r"angles of axis 2: expected .*finite.*\[rad\], got nan"),
    (lambda: HOLD.angle(NAN), r"t: expected finite .*\[s\], got nan"),
    # runs
    (lambda: simulate(t_end=0.0), r"t_end: expected .*after .*0 s, got 0 s"),
    (lambda: simulate(t_end=-1.0), r"t_end: expected .*after .*0 s, got -1 s"),
    (lambda: simulate(t_end=NAN), r"t_end: expected .*finite.*\[s\], got nan"),
    (lambda: simulate(t_end="1"), r"t_end: expected .*number.*\[s\], got '1'"),
    (lambda: simulate(robot=3), r"robot: expected a Robot, got 3"),
    (lambda: simulate(motion=[0] * 6), r"motion: expected a .*Hold, got \[0"),
    (lambda: simulate(motion=None), r"motion: expected a motion .*, got None"),
    (lambda: simulate(motion=r3.Hold([0] * 3)), r"motion: expected 6 axes for model 3, got 3"),
    (
        lambda: simulate(r3.Robot(model=2), r3.Hold([0, 0, 0, 0, 0.1, 0])),
        r"motion of axis 5: expected exactly 0 rad, where model 2 has a brake",
    ),
    (
        lambda: simulate(r3.Robot(model=4), motion),
        r"motion of axis 4: expected exactly 0 rad, where model 4 has a brake",
    ),
    (
        lambda: simulate(r3.Robot("one-axis"), r3.Hold([0.0] * 3)),
        r"motion: expected 1 axis for model one-axis, got 3",
    ),
    (
        lambda: simulate(r3.Robot("full-robot"), r3.Hold([0.0])),
        r"motion: expected 6 axes for model full-robot, got 1",
    ),
    (
        lambda: simulate(r3.Robot(2), r3.Hold([0.0])),
        r"motion: expected 3 axes for model 2, got 1",
    ),
    (lambda: simulate(r3.Robot("one-axis"), None), r"motion: expected a motion .*, got None"),
    (lambda: simulate(rtol=0.0), r"rtol: expected .*1e-14 to 1e-2, got 0"),
    (lambda: simulate(rtol=NAN), r"rtol: expected .*finite.*got nan"),
    (
        lambda: simulate(method="euler"),
        r"method: expected one of 'exponential', 'erk', 'bdf', got 'euler'",
    ),
    (
        lambda: simulate(r3.Robot(stiction="stiff-spring"), method="erk"),
        r"method: expected 'bdf' for stiction='stiff-spring', .*, got 'erk'",
    ),
    (lambda: simulate(start="wheel"), r"start: expected 'rotor', 'arm' or a state.*, got 'wheel'"),
    (lambda: simulate(start=[0.0] * 60), r"start: expected a state vector of 66 values, got .*60"),
    (
        lambda: simulate(start=np.zeros((6, 11))),
        r"start: expected a state vector of 66 values, got",
    ),
    (lambda: simulate(start=["a"] * 66), r"start: expected .*, got"),
    (
        lambda: simulate(start=[0.0] * 15 + [INF] + [0.0] * 50),
        r"start: expected a finite rotor_rate of axis 1 \[rad/s\], got inf",
    ),
    (
        lambda: simulate(r3.Robot(voltage_limit=2.0), start=beyond_voltage_limit(2.5)),
        r"start: expected .*voltage of axis 2 \[V\] within its limit 2, got 2\.5",
    ),
    (
        lambda: simulate(r3.Robot(load=load, voltage_limit=0.5), r3.Hold([0, 1.5, 0, 0, 0, 0])),
        r"start: the rate controller of axis 2 would need .* V .*; expected at most 0\.5 V",
    ),
    (lambda: simulate(list_samples=1), r"list_samples: expected True or False, got 1"),
    (lambda: simulate(progress=3), r"progress: expected a function of .* events, got 3"),
    (lambda: simulate(times=[-1.0]), r"times: expected .*0 to 0\.01 s, got -1 s"),
    (lambda: simulate(times=[0.0, 0.02]), r"times: expected .*0 to 0\.01 s, got 0\.02 s"),
    (lambda: simulate(times=[NAN]), r"times: expected finite .*\[s\], got nan"),
    (lambda: simulate().at(0.02), r"times: expected .*0 to 0\.01 s, got 0\.02 s"),
    (lambda: simulate().at([0.0, NAN]), r"times: expected finite .*\[s\], got nan"),
    # inputs
    (
        lambda: simulate(motor_torque=[0.0] * 6),
        r"motor_torque: expected a robot with controller=None .*, got controller='continuous'",
    ),
    (
        lambda: simulate(r3.Robot(controller="sampled"), command=[0.0] * 6),
        r"command: expected a robot with controller='external' .*, got controller='sampled'",
    ),
    (lambda: pushed([0.0] * 6), r"motor_torque: expected 3 values \[N m\] .*, got shape \(6,\)"),
    (lambda: pushed(1.0), r"motor_torque: expected 3 values \[N m\] .*, got shape \(\)"),
    (lambda: pushed([0, NAN, 0]), r"motor_torque of axis 2: expected .*finite.*\[N m\], got nan"),
    (lambda: pushed([0.0, True, 0.0]), r"motor_torque: .*3 numbers \[N m\].*, got \[0\.0, True"),
    (
        lambda: pushed(lambda t: [0.0] * 6),
        r"motor_torque at 0 s: expected 3 finite values \[N m\], got \[0\. 0\. 0\. 0\. 0\. 0\.\]",
    ),
    (
        lambda: pushed(r3.Input(lambda t: [0.0, 0.0, 0.0 if t < 0.005 else INF], [0.005])),
        r"motor_torque at 0\.005 s: expected 3 finite values \[N m\], got \[ 0\.  0\. inf\]",
    ),
    (lambda: pushed(lambda t: None), r"motor_torque at 0 s: .*3 numbers \[N m\], got None"),
    (lambda: pushed(lambda t: ["a"] * 3), r"motor_torque at 0 s: .*3 numbers \[N m\], got \['a'"),
    (lambda: r3.Input(3.0), r"function: expected a function of the time, got 3\.0"),
    (lambda: r3.Input(by_sine, 0.1), r"knots: expected instants \[s\] that ascend, got 0\.1"),
    (lambda: r3.Input(by_sine, [0.2, 0.1]), r"knots: .*\[s\] that ascend, got \[0\.2, 0\.1\]"),
    (lambda: r3.Input(by_sine, [NAN]), r"knots: expected finite .*\[s\], got nan at index 0"),
    (lambda: r3.Input(by_sine, ["a"]), r"knots: expected numbers \[s\], got \['a'\]"),
    (lambda: simulate(tip_force=[0, 0]), r"tip_force: expected three .*\[N\], got shape \(2,\)"),
    (lambda: simulate(tip_force=[0, 0, NAN]), r"tip_force: expected finite .*\[N\], got nan .*2"),
    (
        lambda: simulate(tip_force=lambda t: [0.0]),
        r"tip_force at 0 s: expected 3 finite values \[N\], got \[0\.\]",
    ),
    (
        lambda: simulate(r3.Robot("one-axis"), r3.Hold([0]), tip_force=[0, 0, 1]),
        r"tip_force: expected none for model one-axis, which has no tip",
    ),
    (
        lambda: simulate(brakes=[True] + [False] * 5),
        r"brakes of axis 1: expected none, only axes 4 to 6 have brakes",
    ),
    (lambda: simulate(brakes=[False] * 3), r"brakes: expected True, False or 6 .*, got \[False, F"),
    (lambda: simulate(brakes=None), r"brakes: expected True, False or 6 of them, .*, got None"),
    (lambda: simulate(brakes=[0, 0, 0, 1, 1, 1]), r"brakes: expected True, False or 6 .*, got \[0"),
    (
        lambda: braked_while_it_moves(),
        r"brakes of axis 4: expected an axis at rest, got a joint rate of .* rad/s",
    ),
    # step by step
    (lambda: simulator().step(-1.0), r"dt: expected .*not negative, got -1 s"),
    (lambda: simulator().step(INF), r"dt: expected .*finite.*\[s\], got inf"),
    (lambda: simulator().step_to_event(t_end=-1.0), r"t_end: expected .*, got -1 s"),
    (
        lambda: r3.Simulator(r3.Robot(model=2, controller=None)).step_to_event(),
        r"t_end: expected a time \[s\]",
    ),
    (lambda: r3.Simulator(robot), r"motion: expected a motion .*, got None"),
    (lambda: set_torque([0.0] * 6), r"motor_torque: expected 3 values \[N m\].*, got .*6"),
    (lambda: set_torque([0, NAN, 0]), r"motor_torque of axis 2: expected .*\[N m\], got nan"),
    (lambda: set_torque([0.0] * 3, "continuous"), r"motor_torque: expected .*controller=None"),
    (
        lambda: set_input(r3.Robot(controller="external"), "command", [0.1] * 3),
        r"command: expected 6 values \[V\] .*, got shape \(3,\)",
    ),
    (
        lambda: set_input(r3.Robot(controller="sampled"), "command", [0.1] * 6),
        r"command: expected a robot with controller='external' .*, got controller='sampled'",
    ),
    (
        lambda: set_input(robot, "tip_force", [1, 2, 3], tip_force=lambda t: [0.0] * 3),
        r"tip_force: it is a function of time and cannot be set",
    ),
    # states and the arm alone
    (lambda: robot.state_from([0] * 3), r"joint_angle: expected 6 values \[rad\].*, got .*3"),
    (
        lambda: robot.state_from([0] * 6, joint_rate=[0, 0, 0, 0, 0, NAN]),
        r"joint_rate of axis 6: expected .*\[rad/s\], got nan",
    ),
    (
        lambda: robot.state_from([0] * 6, rotor_angle=[0, 0, 0, 1, 0, 0]),
        r"rotor_angle of axis 4: .*rigid, expected .*0 rad, got 1 rad",
    ),
    (lambda: robot.rest_state(HOLD, "wheel"), r"start: expected 'rotor', 'arm'.*, got 'wheel'"),
    (
        lambda: robot.forward_dynamics([0] * 6, [0] * 3, [0] * 6),
        r"qd: expected 6 values \[rad/s\].*, got .*3",
    ),
    (
        lambda: robot.inverse_dynamics([0] * 6, [0] * 6, [0, 0, 0, INF, 0, 0]),
        r"qdd of axis 4: expected .*\[rad/s\^2\], got inf",
    ),
    (lambda: robot.mass_matrix(0.0), r"q: expected 6 values \[rad\].*, got .*\(\)"),
    (
        lambda: robot.forward_dynamics(np.zeros((4, 6)), np.zeros((5, 6)), [0] * 6),
        r"expected shapes that fit .*q \(4, 6\), qd \(5, 6\), tau \(6,\)",
    ),
    # scenarios
    (lambda: r3.Scenario.load("figur9"), r"no scenario 'figur9'.*did you mean 'figure9'"),
]


@pytest.mark.parametrize(
    ("do", "message"), BAD, ids=[message.replace("\\", "") for _, message in BAD]
)
def test_a_mistake_is_refused_at_the_door(do, message):
    with pytest.raises((ValueError, TypeError, AttributeError), match=f"^{message}"):
        do()


@pytest.mark.parametrize("name", ["motor_torqe", "command"])
def test_a_simulator_refuses_to_be_given_what_it_does_not_have(name):
    with pytest.raises(AttributeError):
        setattr(simulator(), name, [0.0] * 6)


def test_a_run_that_cannot_go_on_says_where_and_why():
    # At 10^8 rad/s the couplings throw the light wrist back and forth without end.
    start = robot.state_from([0.0] * 6, joint_rate=[1e8, 0, 0, 0, 0, 0])
    with pytest.raises(r3.SimulationError, match=r"chattering: friction of axis \d") as caught:
        r3.simulate(robot, HOLD, t_end=0.1, start=start)
    error = caught.value
    assert 0.0 < error.time < 0.1
    assert error.state.shape == (66,)
    assert {element: branch.shape for element, branch in error.branches.items()} == dict.fromkeys(
        ELEMENTS, (6,)
    )
    assert error.reason in str(error)
    assert error.result.time[-1] == error.result.t_end == error.time
    assert len(error.result.events) > 0
    again = pickle.loads(pickle.dumps(error))
    assert (again.time, again.reason, str(again)) == (error.time, error.reason, str(error))
    assert again.result.events == error.result.events


def test_a_run_that_cannot_begin_has_a_result_of_one_instant():
    start = robot.state_from([0.0] * 6, joint_rate=[1e100] * 6)
    with pytest.raises(r3.SimulationError) as caught:
        r3.simulate(robot, HOLD, t_end=0.1, start=start)
    assert caught.value.time == 0.0
    np.testing.assert_array_equal(caught.value.result.time, [0.0])
    np.testing.assert_array_equal(caught.value.result.state, [caught.value.state])


def test_a_simulator_that_cannot_go_on_stays_where_it_came_to():
    sim = r3.Simulator(r3.Robot(model=2, controller=None))
    sim.step(0.1)
    before = sim.state
    sim.motor_torque = [1e300] * 3
    with pytest.raises(r3.SimulationError) as caught:
        sim.step(0.1)
    assert caught.value.time == sim.time == 0.1
    np.testing.assert_array_equal(sim.state, before)
    np.testing.assert_array_equal(caught.value.state, before)
    sim.motor_torque = [1.0] * 3
    assert sim.step(0.1) == []  # and can go on from there
    assert sim.time == pytest.approx(0.2, rel=4 * EPS)


# --- weight -------------------------------------------------------------------------------------


def test_importing_the_package_imports_nothing_heavy():
    extras = {"dask", "h5netcdf", "matplotlib", "pandas", "pyarrow", "scipy", "trimesh", "xarray"}
    script = f"import sys, manutec_r3; print(*{extras | {'pydantic', 'rich'}} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    assert done.stdout.split() == []


# --- threads, interruption, silence -------------------------------------------------------------


def test_two_threads_share_a_robot(result):
    trapezoid = r3.Trapezoid(start=[0] * 6, end=[0.5] * 6, rate=[2.5] * 6, acceleration=[10] * 6)
    alone = [result, r3.simulate(robot, trapezoid, t_end=1.0)]
    jobs = [(motion, 1.5), (trapezoid, 1.0)] * 4
    with ThreadPoolExecutor(max_workers=2) as threads:
        results = list(threads.map(lambda job: r3.simulate(robot, *job), jobs))
    for k, together in enumerate(results):
        assert together.events == alone[k % 2].events
        np.testing.assert_array_equal(together.state, alone[k % 2].state)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows sends Ctrl-C to whole consoles")
@pytest.mark.parametrize("how", ["r3.simulate(robot, hold, t_end=1e4)", "sim.step(1e4)"])
def test_ctrl_c_ends_a_long_run(how):
    script = f"""
import manutec_r3 as r3
robot, hold = r3.Robot(model=3), r3.Hold([0.3, -0.5, 0.8, 0, 0, 0])
sim = r3.Simulator(robot, hold)
print("begins", flush=True)
try:
    {how}
except KeyboardInterrupt:
    print(f"interrupted; still alive at {{sim.time:g}} s")
    sim.step(1e-3)
"""
    with child(sys.executable, "-c", script) as process:
        assert process.stdout.readline() == "begins\n"
        time.sleep(1.0)  # it is under way, and has minutes to go
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(
            timeout=20
        )  # well within a second, unless the machine is busy
    assert re.match("interrupted; still alive at", said)
    assert process.returncode == 0


def test_nothing_is_printed(capfd):
    r3.simulate(robot, motion, t_end=0.2)
    with pytest.raises(r3.SimulationError):
        simulate(start=robot.state_from([0.0] * 6, joint_rate=[1e100] * 6))
    assert capfd.readouterr() == ("", "")
