"""Options of the robot: each against a closed form, an identity, or an independent solution.

Whole runs with each option are compared with the independent implementation in `test_models.py`;
what holds sticking axes is in `test_stiction.py`.
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from independent import (
    BACKLASH,
    DAMPING,
    GEAR_RATIO,
    STICKING_LIMIT,
    STIFFNESS,
    TABLE_1,
    TABLE_3,
    UNIT,
    Hybrid,
    IndependentRobot,
)
from oracle_runs import AT_ZERO, BENT, ECCENTRIC, RUNS, times_of
from test_energy import balance

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import sequence

LOAD = r3.Load(8.0, ECCENTRIC)
THERE = (0.1, -0.2, 0.5, 0.7, -0.3, 0.1)

# --- sampled position controllers -----------------------------------------------------------------


def test_a_sampled_controller_is_an_external_one_in_a_loop():
    robot, motion, period = r3.Robot(3, LOAD, "sampled"), r3.Quintic(BENT, THERE, 0.25), 0.008
    sampled = r3.simulate(robot, motion, 50 * period, rtol=1e-10)

    simulator = r3.Simulator(robot.replace(controller="external"), motion, rtol=1e-10)
    events = []
    for k in range(50):
        error = GEAR_RATIO * motion.angle(k * period) - simulator.rotor_angle
        feedforward = TABLE_1["K_D"] * GEAR_RATIO * motion.rate(k * period)
        simulator.command = TABLE_1["K_V"] * error + feedforward
        events += simulator.step(period)

    assert sequence(events) == sequence(sampled.events)
    assert len(events) > 50
    # The loop reads and sets at instants that are roundoff apart from k T: measured are 3e-15 s and
    # 1e-11 of the states' nominal values, 2e-10 with contracted products.
    assert times_of(events) == pytest.approx(times_of(sampled.events), rel=0, abs=1e-13)
    apart = np.abs(simulator.state - sampled.at(50 * period).state[0])
    contracted = r3.build_info().processor != "baseline"
    assert np.max(apart / robot.state_nominals) <= (1e-9 if contracted else 1e-10)


@pytest.mark.parametrize("model", [2, 3])
def test_sampling_differs_from_continuous_control_by_the_first_order_of_its_period(model):
    robot = r3.Robot(model, LOAD)
    n = robot.n_axes
    motion, times = r3.Quintic(BENT[:n], THERE[:n], 0.25), np.linspace(0.0, 0.3, 61)

    def errors(**options):
        return r3.simulate(robot.replace(**options), motion, 0.3, rtol=1e-10).at(times)

    continuous = errors().control_error
    sampled = [
        errors(controller="sampled", table_1={"T": period}).control_error - continuous
        for period in (8e-4, 4e-4, 2e-4)
    ]
    for longer, shorter in pairwise(sampled):
        assert np.abs(shorter).max() > 1e-4
        # Halved, but for the second order: 2 %, then 1 %.
        assert np.abs(longer - 2.0 * shorter).max() <= 0.06 * np.abs(shorter).max()


def test_samples_are_listed_on_request_and_always_counted():
    robot, motion = r3.Robot(2, LOAD, "sampled"), r3.Quintic(BENT[:3], THERE[:3], 0.25)
    counted = r3.simulate(robot, motion, 0.3)
    listed = r3.simulate(robot, motion, 0.3, list_samples=True)
    samples = [event for event in listed.events if event.element == "sample"]
    assert samples == [(k * 0.008, 0, "sample", 0, 0) for k in range(1, 38)]
    assert [event for event in listed.events if event.element != "sample"] == list(counted.events)
    np.testing.assert_array_equal(listed.state[-1], counted.state[-1])
    for result in (counted, listed):
        assert result.statistics.samples == 37
        # Held commands jump: the first derivative of the next step is all that is computed again.
        assert 0.9 <= result.statistics.evaluations_per_sample <= 1.0
    assert len(counted.events) > 5


def test_samples_end_a_step_to_the_next_event_only_if_they_are_listed():
    robot, motion = r3.Robot(1, LOAD, "sampled"), r3.Hold(BENT)
    assert r3.Simulator(robot, motion).step_to_event(t_end=0.1) is None
    simulator = r3.Simulator(robot, motion, list_samples=True)
    for k in range(1, 4):
        assert simulator.step_to_event() == (k * 0.008, 0, "sample", 0, 0)
        assert simulator.time == k * 0.008


def test_at_one_instant_the_reference_comes_first_then_the_sample_then_the_axes():
    push = r3.Input(lambda t: [0.0, 0.0, 9e3 * (t >= 0.016)], knots=[0.016])
    events = r3.simulate(
        r3.Robot(3, controller="sampled"),
        r3.Quintic(BENT, BENT, 0.016),
        0.02,
        list_samples=True,
        tip_force=push,
    ).events
    at_once = [event[1:3] for event in events if event.time == 0.016]
    assert at_once[:2] == [(0, "reference"), (0, "sample")]
    assert at_once[2:] == [(axis, "friction") for axis in sorted(axis for axis, _ in at_once[2:])]
    assert len(at_once) >= 4


# --- coupling of rotors ---------------------------------------------------------------------------

MIXED = ("full", "simplified", "full", "full", "simplified", "full")


def test_coupling_adds_the_product_of_ratio_inertia_and_cosine_to_the_mass_matrix():
    q = np.array([0.3, -0.5, 0.8, 0.4, -0.6, 0.2])
    gained = r3.Robot(1).mass_matrix(q)
    gained -= r3.Robot(1, rotor_coupling="simplified").mass_matrix(q)
    # Joint 2 and rotor 3 turn about x of arm 2: <an_2, rn_3> = 1 in every pose.
    assert gained[1, 2] == pytest.approx(60.0 * 1.3e-3, rel=1e-12)
    # Rotor 2 turns about x of arm 1: normal to joint 1. Nothing carries rotor 1.
    assert gained[0, 1] == pytest.approx(0.0, abs=1e-14)
    np.testing.assert_array_equal(np.diag(gained), 0.0)


@pytest.mark.parametrize("coupling", ["full", MIXED])
@pytest.mark.parametrize("rn", [None, ("x", "z", "z", "x", "z", "x")], ids=["report", "other"])
def test_carried_rotors_add_the_torques_of_the_specification(coupling, rn):
    tables = {"table_3": rn and {"rn": rn}}
    carried = r3.Robot(1, LOAD, rotor_coupling=coupling, **tables)
    fixed = r3.Robot(1, LOAD, rotor_coupling="simplified", **tables)
    rJ = np.array(carried.parameters["table_3"]["rJ"]) * np.equal(carried.rotor_coupling, "full")
    axes, rotors = ("z", "x", "x", "z", "x", "z"), carried.parameters["table_3"]["rn"]
    rng = np.random.default_rng(6)
    for _ in range(10):
        q, qd, qdd = rng.uniform(-2.0, 2.0, 6), *rng.normal(0.0, [[3.0], [30.0]], (2, 6))
        turn = carried.link_poses(q)[:, :3, :3]
        an = np.array([turn[j] @ UNIT[axes[j]] for j in range(6)])
        expected = np.zeros(6)
        w, dw = np.zeros(3), np.zeros(3)  # of the arm before joint j
        for j in range(6):
            # spec 6, with rq' = p aq'
            rn_j, rqd, rqdd = (
                turn[j] @ UNIT[rotors[j]],
                GEAR_RATIO[j] * qd[j],
                GEAR_RATIO[j] * qdd[j],
            )
            for i in range(j):
                expected[i] += rJ[j] * (rqdd * an[i] @ rn_j + rqd * an[i] @ np.cross(w, rn_j))
            expected[j] += GEAR_RATIO[j] * rJ[j] * rn_j @ dw
            dw = dw + qdd[j] * an[j] + qd[j] * np.cross(w, an[j])
            w = w + qd[j] * an[j]
        gained = carried.inverse_dynamics(q, qd, qdd) - fixed.inverse_dynamics(q, qd, qdd)
        assert np.abs(expected).max() > 0.5
        assert gained == pytest.approx(expected, rel=0, abs=1e-10)  # of torques of 1e4 N m


def test_coupling_vanishes_with_the_inertia_of_the_rotors():
    rng = np.random.default_rng(5)
    q, qd, tau = rng.uniform(-2.0, 2.0, 6), rng.normal(0.0, 3.0, 6), rng.normal(0.0, 200.0, 6)
    inertia = np.array(r3.Robot(1).parameters["table_3"]["rJ"])

    def difference(share):
        tables = {"table_3": {"rJ": share * inertia, "arms": {6: {"I33": 0.4}}}}
        full, simplified = (
            r3.Robot(1, LOAD, rotor_coupling=coupling, **tables).forward_dynamics(q, qd, tau)
            for coupling in ("full", "simplified")
        )
        return full - simplified

    assert np.abs(difference(1.0)).max() > 0.1  # rad/s^2
    # Proportional to rJ, where p^2 rJ (13 kg m^2 on axis 1) is small beside the arms.
    assert 10.0 * difference(1e-5) == pytest.approx(difference(1e-4), rel=0.02, abs=1e-9)


# --- damping in contact only ----------------------------------------------------------------------


@pytest.fixture(scope="module", params=["3-contact", "4-contact-coupled", "4-contact-landing"])
def contact(request):
    return RUNS[request.param].simulate(rtol=1e-9)


def deflections(samples):
    """Deflections of elastic gears and their rates, rotor side."""
    p = GEAR_RATIO[:3]
    return (
        samples.rotor_angle[:, :3] - p * samples.joint_angle[:, :3],
        samples.rotor_rate[:, :3] - p * samples.joint_rate[:, :3],
    )


def test_in_the_gap_a_gear_transmits_exactly_nothing(contact):
    in_gap = contact.branches["backlash"][:, :2] == 0
    assert in_gap.sum() > 50
    np.testing.assert_array_equal(contact.gear_torque[:, :2][in_gap], 0.0)
    _, rate = deflections(contact)
    assert np.abs(DAMPING * rate)[:, :2][in_gap].max() > 0.01  # a damper would be seen


def test_outside_the_gap_and_without_one_the_damper_acts(contact):
    deflection, rate = deflections(contact)
    touches = contact.branches["backlash"][:, :3] != 0
    touches[:, 2] = True  # no backlash
    stretch = deflection - contact.branches["backlash"][:, :3] * BACKLASH
    expected = np.where(touches, STIFFNESS * stretch + DAMPING * rate, 0.0)
    # Roundoff of rotor angles of 100 rad on stiff gears.
    assert contact.gear_torque[:, :3] == pytest.approx(expected, rel=0, abs=1e-11)


def test_torque_jumps_by_that_of_the_damper_where_teeth_meet_and_part(contact):
    _, rate = deflections(contact)
    seen = 0
    for event in contact.events:
        if event.element != "backlash":
            continue
        before, *_, after = np.flatnonzero(contact.time == event.time)
        axis = event.axis - 1
        jump = (contact.gear_torque[after] - contact.gear_torque[before])[axis]
        damper = DAMPING[axis] * rate[before, axis]
        # The spring is within roundoff of its edge.
        assert jump == pytest.approx(damper if event.before == 0 else -damper, rel=0, abs=1e-11)
        assert event.before * event.after == 0
        seen += abs(damper) > 1e-3
    assert seen >= 2


def test_without_backlash_it_does_not_matter_where_the_damper_acts():
    run = RUNS["3-hold-disturbed"]
    tight = run.robot.replace(table_2={"b": 0.0})
    parallel, in_contact = (
        r3.simulate(
            tight.replace(gear_damping=gear_damping),
            r3.Hold(BENT),
            0.2,
            start=tight.state_from(**run.start),
        )
        for gear_damping in ("parallel", "contact")
    )
    np.testing.assert_array_equal(in_contact.state, parallel.state)
    assert in_contact.events == parallel.events
    assert "backlash" not in in_contact.events.element
    assert len(in_contact.events) > 20


# --- brakes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("braked", "own"), [(3, 4), (1, 2)])
@pytest.mark.parametrize("controller", ["continuous", "sampled"])
def test_with_all_brakes_on_six_axes_move_as_three(braked, own, controller):
    end = (0.3, 0.25, -0.4, 0.0, 0.0, 0.0)
    motion = r3.Quintic(AT_ZERO, end, 0.3)
    with_brakes = r3.simulate(
        r3.Robot(braked, LOAD, controller), motion, 0.6, brakes=True, rtol=1e-10
    )
    without = r3.simulate(r3.Robot(own, LOAD, controller, arm="six-arm"), motion, 0.6, rtol=1e-10)
    assert sequence(with_brakes.events) == sequence(without.events)
    assert len(with_brakes.events) > 10
    # Other equations, of other sizes, at a tolerance of 1e-10: ten times that.
    assert times_of(with_brakes.events) == pytest.approx(times_of(without.events), rel=0, abs=1e-9)
    times = np.linspace(0.0, 0.6, 61)
    got, expected = with_brakes.at(times), without.at(times)
    for signal in ("joint_angle", "control_error", "motor_torque"):
        error = getattr(got, signal)[:, :3] - getattr(expected, signal)
        assert np.abs(error).max() <= 1e-9, signal
    for signal in ("joint_angle", "joint_rate", "joint_acceleration", "rotor_rate"):
        np.testing.assert_array_equal(getattr(with_brakes, signal)[:, 3:], 0.0)


def test_an_axis_that_moves_cannot_be_braked():
    robot = r3.Robot(3, controller=None)
    start = robot.state_from(AT_ZERO, (0.0, 0.0, 0.0, 0.0, 0.5, 0.0))
    simulator = r3.Simulator(robot, start=start)
    simulator.brakes = [False, False, False, True, False, True]
    with pytest.raises(
        ValueError, match=r"^brakes of axis 5: expected an axis at rest, got .*0\.5 rad/s$"
    ):
        simulator.brakes = True
    # Nothing has changed, and it can once it has come to rest.
    np.testing.assert_array_equal(simulator.brakes, [False, False, False, True, False, True])
    simulator.step(1.0)
    assert simulator.joint_rate[4] == 0.0
    simulator.brakes = True
    np.testing.assert_array_equal(simulator.brakes, [False] * 3 + [True] * 3)


def test_released_brakes_leave_axes_to_friction():
    # Stretched out to the side, with a load that friction alone cannot hold on axis 5.
    load = (40.0, (0.05, 0.0, 0.25))
    robot = r3.Robot(3, r3.Load(*load, bounds=False), controller=None)
    pose = np.array([0.2, 0.1, -0.1, 0.3, 1.5, 0.4])
    simulator = r3.Simulator(robot, start=robot.rest_state(r3.Hold(pose), "arm"), brakes=True)
    torque = robot.inverse_dynamics(pose, np.zeros(6), np.zeros(6)) / GEAR_RATIO
    torque[3:] = 0.0
    simulator.motor_torque = torque
    np.testing.assert_array_equal(simulator.branches["friction"], 0)
    assert abs(simulator.friction_torque[4]) > STICKING_LIMIT[4]  # the brake holds more
    simulator.step(0.01)
    np.testing.assert_array_equal(simulator.branches["friction"], 0)

    simulator.brakes = False
    oracle = IndependentRobot(3, *load, controller=None)
    hybrid = Hybrid(oracle, motor_torque=torque)
    x = oracle.state_from(
        simulator.joint_angle,
        simulator.joint_rate,
        simulator.rotor_angle,
        simulator.rotor_rate,
    )
    hybrid.start(x)
    np.testing.assert_array_equal(simulator.branches["friction"], hybrid.friction)
    assert hybrid.friction[4] != 0
    expected = hybrid.signals(0.0, x)
    for signal in ("joint_acceleration", "friction_torque"):
        got = getattr(simulator, signal)
        assert got == pytest.approx(expected[signal], rel=1e-9, abs=1e-9), signal
    assert simulator.step(0.0)[0] == (0.01, 5, "friction", 0, hybrid.friction[4])


# --- limits of voltages, creeping rotors ----------------------------------------------------------

# The motion of the benchmark run in two thirds of its time asks for more torque than there is.
TOO_FAST = r3.Quintic(AT_ZERO, (1.0, 1.0, 0.6, -0.2, -0.15, -0.1), 0.8)


def test_a_limit_on_the_voltage_keeps_the_axis_that_is_lost_without():
    robot, limit = r3.Robot(3, r3.Load(15.0)), 10.0
    lost = r3.simulate(robot, TOO_FAST, 1.5)
    kept = r3.simulate(robot.replace(voltage_limit=limit), TOO_FAST, 1.5)
    assert np.abs(lost.voltage).max() > 3.0 * limit
    assert np.abs(lost.control_error[-1]).max() > 0.3
    assert np.abs(kept.control_error[-1]).max() < 5e-3
    steps = np.unique(kept.time)
    inside = kept.at((steps[:-1, None] + np.diff(steps)[:, None] * [0.1, 0.5, 0.9]).ravel())
    for samples in (kept, inside):
        # Roundoff where it has just reached the limit.
        assert np.abs(samples.voltage).max() <= limit * (1.0 + 1e-12)
        at_limit = samples.branches["voltage_limit"]
        np.testing.assert_array_equal(
            samples.voltage[at_limit != 0], limit * at_limit[at_limit != 0]
        )
        assert (at_limit != 0).sum() > 100
    changes = [(e.before, e.after) for e in kept.events if e.element == "voltage_limit"]
    assert {(0, 1), (1, 0)} <= set(changes) or {(0, -1), (-1, 0)} <= set(changes)


def test_a_limit_that_is_not_reached_changes_nothing():
    run = RUNS["3-quintic"]
    free, limited = (
        r3.simulate(run.robot.replace(voltage_limit=limit), r3.Quintic(*run.motion[1:]), 0.5)
        for limit in (None, 30.0)
    )
    np.testing.assert_array_equal(limited.state, free.state)
    assert limited.events == free.events


def test_only_robots_with_a_limit_on_the_voltage_have_branches_of_it():
    for limit in (None, 10.0):
        simulator = r3.Simulator(r3.Robot(2, voltage_limit=limit), r3.Hold([0.0] * 3))
        assert ("voltage_limit" in simulator.branches) == (limit is not None)


@pytest.mark.parametrize("creep_rate", [1e-6, 1e-9])
def test_a_rotor_counts_as_sticking_where_its_decaying_rate_falls_below_the_creep_rate(creep_rate):
    # In a gap without end a rotor turns alone: with viscous friction its rate decays for ever.
    slope, inertia, rate = 0.01, 1.3e-3, 2.0
    gears = {
        "b": {1: 1e3},
        "d": {1: 0.0},
        "friction": {1: ((0.0, 0.0), (100.0, 100.0 * slope))},
        "rM_h": {1: 0.1},
    }
    robot = r3.Robot(4, controller=None, creep_rate=creep_rate, table_2=gears)
    start = robot.state_from([0.0] * 3, rotor_rate=[rate, 0.0, 0.0])
    result = r3.simulate(robot, None, 3.0, start=start, rtol=1e-12)
    assert sequence(result.events) == [(1, "friction", 1, 0)]
    expected = inertia / slope * np.log(rate / creep_rate)
    # Measured are 3e-9 s and 1e-5 s: errors of 1e-13 rad/s after two seconds, times ten.
    assert result.events[0].time == pytest.approx(expected, rel=0, abs=0.13 * 1e-12 / creep_rate)
    before, *_, after = np.flatnonzero(result.time == result.events[0].time)
    assert result.rotor_rate[before, 0] == pytest.approx(creep_rate, rel=1e-3)
    assert result.rotor_rate[after, 0] == 0.0

    never = r3.simulate(robot.replace(creep_rate=0.0), None, 3.0, start=start, rtol=1e-12)
    assert len(never.events) == 0


def test_creeping_rotors_stick_earlier_by_the_time_that_they_would_need_to_stop():
    run, creep_rate = RUNS["4-trapezoid"], 1e-5
    stops = {}
    for rate in (0.0, creep_rate):
        robot = run.robot.replace(creep_rate=rate)
        result = r3.simulate(robot, r3.Trapezoid(*run.motion[1:]), 0.6, rtol=1e-11)
        stop = next(event for event in result.events if event[2:] == ("friction", -1, 0))
        before = np.flatnonzero(result.time == stop.time)[0]
        stops[rate] = stop, before, result
    (still, before, exact), (creeping, _, _) = stops[0.0], stops[creep_rate]
    axis = still.axis - 1
    assert still.axis == creeping.axis <= 3
    drive = exact.motor_torque - exact.gear_torque - exact.friction_torque
    acceleration = drive[before, axis] / 1.3e-3
    # To first order: it changes by a few per mille meanwhile.
    expected = creep_rate / abs(acceleration)
    assert still.time - creeping.time == pytest.approx(expected, rel=0.02)


# --- any combination ------------------------------------------------------------------------------

MODELS = (1, 2, 3, 4, "full-robot", "one-axis")
N_AXES = dict(zip(MODELS, (6, 3, 6, 3, 6, 1), strict=True))
# Rows of Tables 2 and 3 that every model has.
TABLES = (
    None,
    {"table_3": {"gravity": 1.62}},
    {"table_2": {"b": 0.005, "c": 30.0, "d": {1: 0.02}}, "table_3": {"rJ": {1: 2e-3}}},
)


def usually(default, *others):
    """Half of all times the default."""
    return st.sampled_from([default] * len(others) + list(others))


@st.composite
def robots(draw, model):
    """Arguments of a robot, some of which do not fit the model or each other."""
    level = st.sampled_from(["full", "simplified"])
    couplings = st.one_of(st.none(), level, st.tuples(*[level] * N_AXES[model]))
    return {
        "model": model,
        "load": draw(usually(None, r3.Load(12.0, ECCENTRIC))),
        "controller": draw(usually("continuous", "sampled", "external", None)),
        "rotor_coupling": draw(couplings),
        "gear_damping": draw(usually("parallel", "contact")),
        "stiction": draw(usually("exact", "stiff-spring", "stiff-damper")),
        "arm": draw(usually(None, "lumped", "six-arm")),
        "creep_rate": draw(usually(1e-9, 0.0, 1e-6)),
        "voltage_limit": draw(usually(None, 0.3, 5.0)),
        **(draw(st.sampled_from(TABLES)) or {}),
    }


def unfit(options):
    """Names of the options that a model does not have (spec 6, 7, 11)."""
    model, names = options["model"], set()
    variant, three = isinstance(model, str), model in (2, 4)
    if variant:
        if options["controller"] in ("sampled", "external"):
            names.add("controller")
        if options["rotor_coupling"] is not None and "full" in options["rotor_coupling"]:
            names.add("rotor_coupling")
    if model in (1, 2) and options["gear_damping"] != "parallel":
        names.add("gear_damping")
    if model not in (3, "full-robot") and options["stiction"] != "exact":
        names.add("stiction")
    if not three and options["arm"] == "lumped":
        names.add("arm")
    if model == "one-axis" and options["load"] is not None:
        names.add("load")
    if options["voltage_limit"] and (variant or options["controller"] is None):
        names.add("voltage_limit")
    return names


class OneAxis:
    """Energies of two masses, an elastic gear between them, as `balance` asks for them."""

    n_elastic = 1

    def __init__(self, robot):
        rows = {**robot.parameters["table_1"], **robot.parameters["table_2"]}
        self.p, self.b, self.c, self.d = (rows[name][0] for name in "pbcd")
        self.rotor, self.load = robot.parameters["table_3"]["rJ"][0], 19.5
        self.in_contact_only = robot.gear_damping == "contact"

    def kinetic_energy(self, q, qd, rotor_rate):
        return (self.load * qd[0] ** 2 + self.rotor * rotor_rate[0] ** 2) / 2.0

    def potential_energy(self, q):
        return 0.0

    def elastic_energy(self, q, rotor_angle):
        return self.c * max(abs(rotor_angle[0] - self.p * q[0]) - self.b, 0.0) ** 2 / 2.0

    def damping_power(self, q, qd, rotor_angle, rotor_rate):
        touches = (np.abs(rotor_angle - self.p * q) > self.b) | (not self.in_contact_only)
        touches |= self.b == 0.0
        return (self.d * touches * (rotor_rate - self.p * qd) ** 2)[:, 0]


def independent_robot(robot):
    """The independent implementation's robot; to it, other arms are but another Table 3."""
    if robot.model == "one-axis":
        return OneAxis(robot)
    tables = robot.parameters
    bodies = {name: tables["table_3"][name] for name in TABLE_3 if name in tables["table_3"]}
    bodies["arms"] = dict(enumerate(bodies["arms"], start=1))
    return IndependentRobot(
        3 if robot.model == "full-robot" else robot.model,
        robot.load.mass,
        robot.load.position,
        rotor_coupling=robot.rotor_coupling,
        gear_damping=robot.gear_damping,
        arm=robot.arm,
        table_1={"p": tables["table_1"]["p"]},
        table_2={name: tables["table_2"][name] for name in "bcd"} if robot.has_real_gears else {},
        table_3=bodies,
    )


def disturbed(robot):
    """A twentieth of a second after a start in which every axis moves."""
    n = robot.n_axes
    bent, rates = np.array(BENT[:n]), np.array([-0.4, 0.3, 0.5, -1.0, 0.6, -0.8])[:n]
    start = robot.state_from(bent + 0.002, rates)
    inputs = {
        None: {"motor_torque": [0.5, -1.0, 0.8, -0.3, 0.4, 0.2][:n]},
        "external": {"command": [0.2] * n},
    }
    return r3.simulate(robot, r3.Hold(bent), 0.05, start=start, **inputs.get(robot.controller, {}))


@pytest.mark.parametrize("model", MODELS)
def test_any_combination_of_options_is_refused_with_a_reason_or_runs_with_a_closing_balance(model):
    refused, ran = [], []

    @settings(max_examples=24, deadline=None, derandomize=True)
    @given(robots(model))
    def is_refused_or_runs(options):
        wrong = unfit(options)
        if wrong:
            with pytest.raises(ValueError, match=r"^\w+( of axis \d)?: expected .*") as refusal:
                r3.Robot(**options)
            assert str(refusal.value).split(":")[0].split(" ")[0] in wrong
            refused.append(options)
            return
        robot = r3.Robot(**options)
        books = balance(disturbed(robot), independent_robot(robot))
        # Measured are 7e-10, at the default tolerances. Springs that hold axes ring between steps:
        # their power is not known better than to 2e-5.
        share = 2e-4 if robot.stiction == "stiff-spring" else 7e-9
        assert books.gap <= share * books.turned_over
        ran.append(options)

    is_refused_or_runs()
    assert len(refused) >= 3
    assert len(ran) >= 3
