"""The Modelica variant against an independent implementation and against what is published.

`modelica.py` is that implementation, and says where the stored runs come from. The package carries
a table of what is published of the one axis, `comparison/references/one_axis.json`; the whole
published file is read where it lies beside the repository.
"""

import csv
import json
from functools import cache
from importlib.resources import files
from pathlib import Path

import modelica
import numpy as np
import pytest
from oracle_runs import times_of
from scipy.linalg import expm

import manutec_r3 as r3
from manutec_r3.comparison.accuracy import ranges, sequence

MODELS = ("full-robot", "one-axis")
PUBLISHED = json.loads(
    (files("manutec_r3.comparison") / "references" / "one_axis.json").read_text(encoding="utf-8")
)
PUBLISHED_FILE = Path(__file__).parents[2] / "shared" / "reference" / "OneAxis.csv"
# The published run was made with a tolerance of 1e-6: its events are off by up to 1.4e-7 s, its
# signals by up to 1.1e-6 of their range. About ten times that.
PUBLISHED_TIMES = {"rel": 0, "abs": 1e-6}
PUBLISHED_ERROR = 1e-5


@cache
def simulated(model):
    """A run of the package."""
    return r3.Scenario.load(model).run(rtol=1e-9)


# --- against the independent implementation -------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
def test_events_are_those_of_the_independent_implementation(model):
    result, expected = simulated(model), modelica.stored(model)
    assert sequence(result.events) == sequence(expected.events)
    # What is asked for; to be set to ten times what the package does.
    assert times_of(result.events) == pytest.approx(times_of(expected.events), rel=0, abs=1e-8)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("signal", modelica.SIGNALS)
def test_signals_are_those_of_the_independent_implementation(model, signal):
    result, expected = simulated(model), modelica.stored(model)
    error = np.abs(getattr(result.at(expected.time), signal) - getattr(expected, signal))
    # What is asked for; to be set to ten times what the package does.
    assert np.max(error / ranges(getattr(expected, signal))) <= 1e-7


@pytest.mark.parametrize(("model", "until"), [("full-robot", 0.031), ("one-axis", 0.03)])
def test_stored_runs_come_from_the_independent_implementation(model, until):
    expected = modelica.stored(model)
    times = expected.time[expected.time < until]
    again = modelica.simulate(model, until, times, rtol=1e-9, max_step=1e-3)
    events = [event for event in expected.events if event[0] < until]
    assert sequence(again.events) == sequence(events)
    assert len(events) >= 1
    assert len(times) >= 1
    # Longer steps and a looser tolerance than those of the stored run: 3e-13 s apart, and 5e-12 of
    # the range. Ten times that.
    assert times_of(again.events) == pytest.approx(times_of(events), rel=0, abs=3e-12)
    for signal in modelica.SIGNALS:
        stored = getattr(expected, signal)
        error = np.abs(getattr(again, signal) - stored[: len(times)])
        assert np.max(error / ranges(stored)) <= 5e-11, signal


def test_the_arms_of_the_full_robot_hang_as_heavily_as_specified():
    robot = modelica.ModelicaRobot("full-robot")
    _, bias = robot.arm.equations(robot.motion.start, np.zeros(6))
    # spec. M, "Start": rounded to 1e-3 N m
    assert bias == pytest.approx([0.0, -460.573, -256.400, 14.058, -14.960, 0.0], rel=0, abs=5e-4)


def test_the_full_robot_switches_the_friction_of_its_axes_34_times():
    events = modelica.stored("full-robot").events
    assert sum(element == "friction" for _, _, element, _, _ in events) == 34


# --- against what is published of the one axis ----------------------------------------------------


def published_quantities(run, controller):
    """What is published of the one axis, from the signals of a run, {name: (n,)}.

    The deflection of the gear is small beside the angles that it is the difference of: it says
    more than they do.
    """
    ratio = modelica.GEAR_RATIO[1]
    values = {
        "joint_angle": run.joint_angle,
        "joint_rate": run.joint_rate,
        "deflection": run.rotor_angle - ratio * run.joint_angle,
        "deflection_rate": run.rotor_rate - ratio * run.joint_rate,
        "controller": controller,
        "voltage": run.voltage,
        "motor_torque": run.motor_torque,
    }
    return {name: value[:, 0] for name, value in values.items()}


def by_package(times):
    """Quantities of the package's run at some instants, and its events."""
    result = simulated("one-axis")
    at = result.at(times)
    controller = at.state[:, [result.robot.state_names.index("controller[1]")]]
    return published_quantities(at, controller), result.events


def by_independent_implementation(times):
    """The same of the independent implementation."""
    # Less accurate than the stored run, and still a thousand times as accurate as the published.
    run = modelica.simulate("one-axis", times=times, rtol=1e-7, max_step=1e-3)
    where = modelica.ModelicaRobot("one-axis").slices["x"]
    return published_quantities(run, run.state[:, where]), run.events


@pytest.fixture(scope="module", params=[by_package, by_independent_implementation])
def one_axis(request):
    """A run of the one axis: quantities at the published instants, and events."""
    return request.param(np.array(PUBLISHED["at_instants"]["time"]))


def friction_changes(events):
    """Instants of changes of the friction mode; modes before and after."""
    rows = [event for event in events if event[2] == "friction"]
    time, _, _, before, after = zip(*rows, strict=True)
    return np.array(time), list(before), list(after)


def test_the_one_axis_is_where_it_was_published(one_axis):
    values, _ = one_axis
    assert {*values, "time", "friction"} == set(PUBLISHED["at_instants"])
    for name, value in values.items():
        low, high = PUBLISHED["range"][name]
        error = np.abs(value - PUBLISHED["at_instants"][name])
        assert np.max(error) <= PUBLISHED_ERROR * (high - low), name


def test_the_one_axis_slides_and_sticks_when_it_was_published(one_axis):
    time, before, after = friction_changes(one_axis[1])
    published = PUBLISHED["friction_changes"]
    assert (before, after) == (published["before"], published["after"])
    assert time == pytest.approx(np.array(published["time"]), **PUBLISHED_TIMES)
    mode = np.array([0, *after])[np.searchsorted(time, PUBLISHED["at_instants"]["time"])]
    np.testing.assert_array_equal(mode, PUBLISHED["at_instants"]["friction"])


@pytest.fixture(scope="module")
def published_file():
    """The published run as it was published: {name of the variable: values}."""
    if not PUBLISHED_FILE.exists():
        pytest.skip(f"the published run is not at {PUBLISHED_FILE}")
    with PUBLISHED_FILE.open(newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    return dict(zip(names, np.array(rows, float).T, strict=True))


def published_column(file, name):
    """A quantity in the package's terms: the table says which variable it is, and times what."""
    variable = PUBLISHED["variables"][name]
    return variable["factor"] * file[variable["name"]]


def tube(time, values, width):
    """Lowest and highest value within `width` of the whole duration, widened by `width` of range.

    The criterion by which Modelica tools are tested (csv-compare).
    """
    reach = width * np.ptp(time)
    first = np.searchsorted(time, time - reach)
    last = np.searchsorted(time, time + reach, side="right")
    near = [values[i:k] for i, k in zip(first, last, strict=True)]
    margin = width * np.ptp(values)
    return np.array([v.min() for v in near]) - margin, np.array([v.max() for v in near]) + margin


def test_the_table_is_from_the_published_file(published_file):
    instants = np.array(PUBLISHED["at_instants"]["time"])
    rows = np.searchsorted(published_file["time"], instants - 1e-9)
    for name, low_high in PUBLISHED["range"].items():
        column = published_column(published_file, name)
        # nine digits
        assert column[rows] == pytest.approx(PUBLISHED["at_instants"][name], rel=1e-8)
        assert (column.min(), column.max()) == pytest.approx(low_high, rel=1e-8)


def test_the_one_axis_stays_in_the_tube_around_the_published_run(published_file):
    time = published_file["time"]
    values, _ = by_package(time)
    for name, value in values.items():
        low, high = tube(time, published_column(published_file, name), 2e-3)
        assert np.all((low <= value) & (value <= high)), name


def test_the_one_axis_follows_the_published_run_at_all_its_points(published_file):
    values, _ = by_package(published_file["time"])
    for name, value in values.items():
        column = published_column(published_file, name)
        # What is published is continuous: events are no exception.
        assert np.max(np.abs(value - column)) <= PUBLISHED_ERROR * np.ptp(column), name


def test_the_one_axis_has_the_modes_of_the_published_run(published_file):
    mode = published_file["axis.gear.bearingFriction.mode"]
    switched = np.flatnonzero(np.diff(mode))
    time, before, after = friction_changes(simulated("one-axis").events)
    assert (before, after) == (mode[switched].tolist(), mode[switched + 1].tolist())
    assert time == pytest.approx(published_file["time"][switched], **PUBLISHED_TIMES)


# --- the arms, energy, and a closed form ----------------------------------------------------------


def any_states(n_axes, n=20):
    """Random angles, rates and accelerations."""
    rng = np.random.default_rng(7)
    shape = (n, n_axes)
    return rng.uniform(-2.0, 2.0, shape), rng.normal(0.0, 2.0, shape), rng.normal(0.0, 10.0, shape)


def test_the_arms_of_the_full_robot_are_those_of_modelica():
    # The independent implementation keeps Modelica's frames, y up, joints displaced in z.
    robot, arm = r3.Robot("full-robot"), modelica.FullArm()
    rotors = np.diag(modelica.GEAR_RATIO**2 * modelica.ROTOR_INERTIA)
    for q, qd, qdd in zip(*any_states(6), strict=True):
        mass, bias = arm.equations(q, qd)
        mass += rotors
        # Roundoff of sums of some hundred terms.
        assert robot.mass_matrix(q) == pytest.approx(mass, rel=0, abs=1e-11)
        tau = robot.inverse_dynamics(q, qd, qdd)
        assert tau == pytest.approx(mass @ qdd + bias, rel=0, abs=1e-10)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("algorithm", ["composite", "articulated"])
def test_forward_dynamics_of_both_kinds_undo_inverse_dynamics(model, algorithm):
    robot = r3.Robot(model)
    q, qd, qdd = any_states(robot.n_axes)
    tau = robot.inverse_dynamics(q, qd, qdd)
    again = robot.forward_dynamics(q, qd, tau, algorithm=algorithm)
    assert again == pytest.approx(qdd, rel=1e-11, abs=1e-11)  # roundoff, times the condition of M


def test_the_first_joint_of_the_full_robot_stands_as_high_and_the_second_as_far_as_specified():
    robot = r3.Robot("full-robot")
    pose = robot.link_poses(np.zeros(6))
    # spec. M, "Arms": (0, 0.324, 0.3) with y up is (0, -0.3, 0.324) with z up.
    assert pose[2, :3, 3] - pose[1, :3, 3] == pytest.approx([0.0, -0.3, 0.324], abs=1e-15)
    assert pose[4, :3, 3] - pose[3, :3, 3] == pytest.approx([0.0, 0.155, 0.414], abs=1e-15)
    load = robot.load_position(np.zeros(6)) - pose[6, :3, 3]
    assert load == pytest.approx([0.1, -0.1, 0.25], abs=1e-15)


def test_two_masses_move_as_their_closed_form():
    # One axis, constant torque beyond friction: linear as long as the rotor slides forward.
    p, c, d = modelica.GEAR_RATIO[1], modelica.STIFFNESS[1], modelica.DAMPING[1]
    rotor, load = modelica.ROTOR_INERTIA[1], modelica.LOAD_INERTIA
    robot, torque = r3.Robot("one-axis", controller=None), 2.0
    result = r3.simulate(robot, None, 0.2, motor_torque=[torque], rtol=1e-11)
    assert len(result.events) == 0
    assert result.rotor_rate[1:].min() > 0.0
    # x = (q, q', phi_m, w_m, 1) follows x' = A x.
    A = np.zeros((5, 5))
    A[0, 1] = A[2, 3] = 1.0
    spring = np.array([p * c, p * d, -c, -d, 0.0])  # T
    A[1], A[3] = -p * spring / load, spring / rotor
    A[3, 3] -= modelica.SLOPE[1] / rotor
    A[3, 4] += (torque - modelica.SLIDING_TORQUE[1]) / rotor
    for t in np.linspace(0.0, 0.2, 9)[1:]:
        x = expm(A * t) @ [0.0, 0.0, 0.0, 0.0, 1.0]
        now = result.at(t)
        got = [now.joint_angle, now.joint_rate, now.rotor_angle, now.rotor_rate]
        assert np.ravel(got) == pytest.approx(x[:4], rel=1e-9, abs=1e-11)
