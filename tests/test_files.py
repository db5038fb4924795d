"""Results on disk: what is read is what was written, bit by bit; tables; reruns."""

import csv
import json
import pickle
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle_runs import RUNS

import manutec_r3 as r3
from manutec_r3.experiment import Experiment
from manutec_r3.files import recipe
from manutec_r3.signals import descriptions, signal_names
from manutec_r3.simulation import set_up

LOAD = r3.Load(12.0, (0.05, -0.02, 0.2))
MOTION = r3.Quintic([0.0] * 3, [0.3, -0.2, 0.4], 0.4)
HOLDING = r3.Robot(4), r3.Hold([0.1, 0.2, 0.3])


def xarray():
    """The library, or the test is left out."""
    pytest.importorskip("h5netcdf", reason="needs the extra files")
    return pytest.importorskip("xarray", reason="needs the extra files")


def run(model=4, motion=MOTION, t_end=0.5, *, robot=None, **options):
    """A quick run, with events of all kinds."""
    return r3.simulate(robot or r3.Robot(model=model, load=LOAD), motion, t_end, **options)


def scenario(name, **options):
    return r3.Scenario.load(name).run(**options)


def failing():
    """What there is of a run that ends in chattering on its way."""
    with pytest.raises(r3.SimulationError) as failed:
        r3.simulate(*HOLDING, 0.02, start=[0.0] * 4 + [1e8] + [0.0] * 31)
    return failed.value.result


def failing_at_once():
    with pytest.raises(r3.SimulationError) as failed:
        r3.simulate(*HOLDING, 0.02, start=[0.0] * 3 + [1e100] * 3 + [0.0] * 30)
    return failed.value.result


def limited(**options):
    """A motion beyond limits."""
    return run(motion=r3.Quintic([0.0] * 3, [1.0, 1.0, 0.6], 0.3), **options)


SPLINE = r3.Spline([0.0, 0.2, 0.35], [[0.0] * 3, [0.1, 0.3, -0.1], [0.2, 0.1, 1 / 3]])
SEQUENCE = r3.Sequence([MOTION, r3.Hold([0.3, -0.2, 0.4], 0.1), r3.Quintic(MOTION.end, [0] * 3, 1)])
RESULTS = {
    "figure9": lambda: scenario("figure9-quintic", t_end=0.6),
    "full-robot": lambda: scenario("full-robot", t_end=0.4),
    "one-axis": lambda: scenario("one-axis"),
    "exponential": lambda: run(3, RUNS["3-quintic"]._motion(r3), method="exponential"),
    "sampled": lambda: run(
        robot=r3.Robot(4, controller="sampled"), method="exponential", list_samples=True
    ),
    "bdf": lambda: run(
        robot=r3.Robot(3, LOAD, stiction="stiff-damper"), motion=r3.Hold([0.1] * 6), t_end=0.1
    ),
    "times": lambda: run(times=[0.4, 0.1, 0.1, 0.3]),
    "from-a-state": lambda: run(start=r3.Robot(4).state_from([0.1] * 3, [0.1, -0.2, 0.3])),
    "torques": lambda: run(
        robot=r3.Robot(2, controller=None), motion=None, motor_torque=[1.0, 2.0, -1.0]
    ),
    "pushed": lambda: run(
        3, r3.Hold([0.1] * 6), 0.2, tip_force=[30.0, -20.0, 10.0], brakes=[False] * 5 + [True]
    ),
    "external": lambda: run(
        robot=r3.Robot(4, controller="external"), command=np.array([0.1, -0.2, 0.3])
    ),
    "spline": lambda: run(motion=SPLINE, start="arm"),
    "sequence": lambda: run(motion=SEQUENCE, t_end=0.6),
    "options": lambda: run(
        robot=r3.Robot(
            4,
            LOAD,
            rotor_coupling=["full", "simplified", "full"],
            gear_damping="contact",
            arm="six-arm",
            creep_rate=0.0,
            voltage_limit=1.5,
            table_1={"K_V": 0.35, "p": {2: 200.0}},
            table_2={"friction": {3: [(0, 0.6), (100, 0.8)]}, "b": np.array([0.01, 0.05, 0.0])},
            table_3={"arms": {1: {"I33": 1 / 3}}, "joint_limits": [np.inf] * 6},
        )
    ),
    "listed-limits": lambda: limited(list_limits=True),
    "enforced-limits": lambda: limited(enforce_limits=True),
    "failed": failing,
    "failed-at-once": failing_at_once,
    "without-events": lambda: run(2, r3.Hold([0.0] * 3), 0.1),
}


def assert_same(got, expected):
    """Two results are one and the same, bit by bit."""
    for name in ("time", *expected.signals):
        one, other = getattr(got, name), getattr(expected, name)
        assert (one.dtype, one.shape) == (other.dtype, other.shape), name
        assert one.tobytes() == other.tobytes(), name  # NaN and -0.0 as well
    assert list(got.branches) == list(expected.branches)
    for name, branches in expected.branches.items():
        np.testing.assert_array_equal(got.branches[name], branches)
    assert got.events == expected.events
    assert got.limits == expected.limits
    assert (got.robot, got.motion) == (expected.robot, expected.motion)
    for name in ("method", "rtol", "t_end", "status", "provenance"):
        assert getattr(got, name) == getattr(expected, name), name


# NetCDF4 takes half a second each: one of each kind of array and text.
BY_NETCDF = ("figure9", "exponential", "options", "enforced-limits", "failed-at-once", "pushed")


@pytest.mark.parametrize(
    ("name", "file"),
    [*((name, "run.npz") for name in RESULTS), *((name, "run.nc") for name in BY_NETCDF)],
)
def test_what_is_read_is_what_was_written(name, file, tmp_path):
    if file == "run.nc":
        xarray()
    path = tmp_path / file
    result = RESULTS[name]()
    result.save(path)
    loaded = r3.Result.load(path)
    assert_same(loaded, result)
    assert loaded.statistics == result.statistics
    assert [event._asdict() for event in loaded.events] == [e._asdict() for e in result.events]

    instants = np.linspace(0.0, result.t_end, 57)
    inside, inside_loaded = result.at(instants), loaded.at(instants)
    for signal in result.signals:
        assert getattr(inside_loaded, signal).tobytes() == getattr(inside, signal).tobytes()


@pytest.mark.parametrize("name", [name for name in RESULTS if not name.startswith("failed")])
def test_a_result_repeats_itself(name, tmp_path):
    result = RESULTS[name]()
    assert_same(result.rerun(), result)
    result.save(tmp_path / "run.npz")
    assert_same(r3.Result.load(tmp_path / "run.npz").rerun(), result)
    assert_same(pickle.loads(pickle.dumps(result)).rerun(), result)


def test_a_failed_run_fails_again(tmp_path):
    result = failing()
    result.save(tmp_path / "run.npz")
    with pytest.raises(r3.SimulationError) as failed:
        r3.Result.load(tmp_path / "run.npz").rerun()
    assert_same(failed.value.result, result)


def test_overrides_change_a_rerun_and_nothing_else():
    result = run(rtol=1e-6, t_end=0.1)
    other = result.rerun(rtol=1e-9, t_end=0.2)
    assert (other.rtol, other.t_end, other.method) == (1e-9, 0.2, "erk")
    assert_same(other, run(rtol=1e-9, t_end=0.2))


def test_results_of_many_runs_repeat_themselves():
    figure9 = r3.Scenario.load("figure9-quintic")
    pair, of_scenario = r3.simulate_many([(r3.Robot(4), MOTION), figure9], 0.1, rtol=1e-6)
    for result in (pair, of_scenario):
        assert_same(result.rerun(), result)
    assert pair.provenance["scenario"] == ""
    assert of_scenario.provenance["scenario"] == figure9.source


def test_a_loaded_result_is_the_written_one_on_another_build_too(tmp_path):
    """What was computed is read, not computed again."""
    result = run(t_end=0.2)
    result.save(tmp_path / "run.npz")
    script = (
        "import sys, pickle, manutec_r3 as r3; r = r3.Result.load(sys.argv[1]); "
        "o = r.rerun(); p = r.provenance['processor'], o.provenance['processor']; "
        "sys.stdout.buffer.write(pickle.dumps((p, r.joint_acceleration, r.motor_power)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, tmp_path / "run.npz"],
        env={"MANUTEC_R3_PROCESSOR": "baseline", "PYTHONPATH": ":".join(filter(None, sys.path))},
        capture_output=True,
    )
    assert done.returncode == 0, done.stderr.decode()
    processors, acceleration, power = pickle.loads(done.stdout)
    assert processors == (r3.build_info().processor, "baseline")
    assert acceleration.tobytes() == result.joint_acceleration.tobytes()
    assert power.tobytes() == result.motor_power.tobytes()


# --- provenance ---------------------------------------------------------------------------------


def test_a_result_says_where_it_comes_from():
    built = r3.build_info()
    figure9 = r3.Scenario.load("figure9-quintic")
    assert figure9.run(t_end=0.05, rtol=1e-6, method="bdf").provenance == {
        "version": built.version,
        "scenario": figure9.source,
        "method": "bdf",
        "rtol": 1e-6,
        "processor": built.processor,
        "compiler": built.compiler,
        "flags": built.flags,
        "sundials": built.sundials,
        "eigen": built.eigen,
    }


# --- what a file cannot hold --------------------------------------------------------------------


def swing(t):
    """Torques of three motors [N m]."""
    return [np.sin(9.0 * t), np.cos(5.0 * t), -1.0]


def push(t):
    """A force on the tip [N]."""
    return [20.0 * t, 0.0, -10.0]


FUNCTIONS = r3.FunctionMotion(
    lambda t: [0.1 * t**3] * 3, lambda t: [0.3 * t**2] * 3, 0.4, knots=[0.2]
)


@pytest.mark.parametrize(
    ("name", "value", "given"),
    [
        ("motion", FUNCTIONS, {}),
        ("motion", r3.Sequence([FUNCTIONS]), {}),
        ("motor_torque", r3.Input(swing, [0.1]), {"controller": None}),
        ("tip_force", push, {}),
    ],
)
def test_without_its_functions_a_loaded_result_says_what_it_lacks(name, value, given, tmp_path):
    arguments = {"motion": MOTION if given == {} else None, name: value}
    result = run(robot=r3.Robot(4, LOAD, **given), t_end=0.15, **arguments)
    result.save(tmp_path / "run.npz")
    loaded = r3.Result.load(tmp_path / "run.npz")
    for signal in ("time", *result.signals):  # arrays, events and limits are complete
        assert getattr(loaded, signal).tobytes() == getattr(result, signal).tobytes()
    assert (loaded.events, loaded.limits) == (result.events, result.limits)
    lacks = f"{name}: it was a function, which the file of this result could not hold"
    with pytest.raises(ValueError, match=lacks):
        _ = loaded.at(0.1).motor_torque
    with pytest.raises(ValueError, match=lacks):
        loaded.rerun()
    again = loaded.rerun(**{name: value})
    assert again.state.tobytes() == result.state.tobytes()
    assert "not in the file" in repr(loaded.motion) or name != "motion"


def test_the_file_says_what_it_lacks(tmp_path):
    run(motion=FUNCTIONS, tip_force=push, t_end=0.01).save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as archive:
        assert archive["not_in_file"] == "motion tip_force"


# --- what is no such file -----------------------------------------------------------------------


def test_other_endings_are_refused(tmp_path):
    expected = "path: expected a file that ends in .nc or .npz, got '.*run.mat'"
    with pytest.raises(ValueError, match=expected):
        run(t_end=0.01).save(tmp_path / "run.mat")
    with pytest.raises(ValueError, match=expected):
        r3.Result.load(tmp_path / "run.mat")
    with pytest.raises(TypeError, match="path: expected the path of a file, got 3"):
        r3.Result.load(3)
    with pytest.raises(FileNotFoundError):
        r3.Result.load(tmp_path / "missing.npz")


def changed(path, **entries):
    """Rewrite an archive with some entries changed, or left out if None."""
    with np.load(path) as archive:
        everything = dict(archive) | entries
    np.savez(path, **{name: value for name, value in everything.items() if value is not None})


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ({"layout": 7}, "expected a run that was recorded in layout 2, got 7"),
        ({"layout": None}, "expected what Result.save writes, 'layout' is missing"),
        ({"joint_angle": None}, "expected what Result.save writes, 'joint_angle' is missing"),
        ({"step_end": np.zeros(3)}, "steps and modes: expected arrays that fit each other"),
        ({"step_mode": None}, "'step_mode' is missing"),
        ({"time": np.zeros(2)}, "expected the instants of its steps and events"),
        ({"experiment": "no JSON"}, "Expecting value"),
        ({"experiment": "[]"}, "experiment: list indices"),
        ({"experiment": json.dumps({"robot": {"model": 9}})}, "model: expected 1, .*, got 9"),
        ({"experiment": json.dumps({"robot": {"model": 4}})}, "'motion' is missing"),
    ],
)
def test_a_file_that_is_something_else_is_refused(tmp_path, entries, message):
    path = tmp_path / "run.npz"
    run(t_end=0.02).save(path)
    changed(path, **entries)
    with pytest.raises(ValueError, match=f"run.npz: .*{message}"):
        r3.Result.load(path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"no archive at all", b"\x93NUMPY"])
def test_garbage_is_refused(tmp_path, content):
    (tmp_path / "run.npz").write_bytes(content)
    with pytest.raises(ValueError, match=r"run\.npz: "):
        r3.Result.load(tmp_path / "run.npz")


def test_a_mode_that_is_not_there_is_refused(tmp_path):
    path = tmp_path / "run.npz"
    run(t_end=0.02).save(path)
    with np.load(path) as archive:
        mode = archive["step_mode"]
    changed(path, step_mode=mode + 1000)
    with pytest.raises(ValueError, match="mode of a step: expected a number below"):
        r3.Result.load(path)


# --- experiments as text ------------------------------------------------------------------------

numbers = st.floats(-1e3, 1e3)
angles = st.lists(numbers, min_size=3, max_size=3)
positive = st.floats(1e-3, 1e3)
motions = st.one_of(
    st.builds(r3.Quintic, angles, angles, positive),
    st.builds(r3.Hold, angles, st.floats(0.0, 10.0)),
    st.builds(
        lambda start, way: r3.Trapezoid(
            start, [a + w for a, w in zip(start, way, strict=True)], [1.0] * 3, [2] * 3
        ),
        angles,
        st.lists(st.floats(0.1, 1e3), min_size=3, max_size=3),
    ),
    st.builds(
        lambda first, last, end: r3.Sequence([r3.Quintic(first, last, end), r3.Hold(last)]),
        angles,
        angles,
        positive,
    ),
)
robots = st.builds(
    lambda mass, k_v, i33, coupling, limit: r3.Robot(
        4,
        r3.Load(mass, bounds=False),
        rotor_coupling=coupling,
        voltage_limit=limit,
        table_1={"K_V": k_v},
        table_3={"arms": {2: {"I33": i33}}},
    ),
    st.floats(0.0, 1e3),
    st.one_of(positive, st.dictionaries(st.integers(1, 6), positive)),
    st.floats(0.7, 2.5),  # of a body that there can be
    st.lists(st.sampled_from(["full", "simplified"]), min_size=3, max_size=3),
    st.one_of(st.none(), st.floats(0.2, 10.0)),
)


@settings(max_examples=50, deadline=None)
@given(robot=robots, motion=motions, values=st.lists(numbers, max_size=5))
def test_experiments_survive_as_text(robot, motion, values):
    values = np.array(values)
    setup = set_up(robot, motion)._replace(start=values)
    text, not_in_file = recipe.write(Experiment(setup, 1.0, values))
    again = recipe.read(text, "")
    assert not not_in_file
    assert (again.setup.inputs.robot, again.setup.inputs.motion) == (robot, motion)
    assert repr(again.setup.inputs.robot) == repr(robot)
    assert again.setup.start.tobytes() == again.times.tobytes() == values.tobytes()


# --- xarray and pandas --------------------------------------------------------------------------


def test_a_dataset_has_dimensions_units_descriptions_and_provenance():
    xarray()
    result = run()
    data = result.to_xarray()
    assert dict(data.sizes) == {"time": len(result), "axis": 3, "state": 36}
    assert data.attrs == result.provenance
    for name in signal_names:
        assert data[name].dims == ("time", "axis")
        assert (data[name].units, data[name].long_name) == descriptions[name]
        np.testing.assert_array_equal(data[name], getattr(result, name))
    np.testing.assert_array_equal(data.states, result.state)
    assert tuple(data.state.values) == result.robot.state_names
    assert tuple(data.state_unit.values) == result.robot.state_units
    for name, branches in result.branches.items():
        np.testing.assert_array_equal(data[f"branches_{name}"], branches)
    assert data.time.units == "s"
    assert data.branches_friction.flag_meanings == "sliding_backward sticking sliding_forward"
    angle = data.joint_angle.sel(axis=2)  # axes are counted from 1
    np.testing.assert_array_equal(angle, result.joint_angle[:, 1])


def test_samples_are_a_dataset_that_selects_by_time():
    xarray()
    result = run()
    data = result.at(np.linspace(0.0, 0.5, 51)).to_xarray()
    assert data.attrs == result.provenance
    nearest = data.motor_torque.sel(time=0.2003, axis=1, method="nearest")
    assert float(nearest) == result.at(0.2).motor_torque[0, 0]


def test_others_open_the_file_by_xarray_alone(tmp_path):
    library = xarray()
    result = scenario("figure9-quintic", t_end=0.1)
    result.save(tmp_path / "run.nc")
    with library.open_dataset(tmp_path / "run.nc") as data:
        np.testing.assert_array_equal(data.motor_torque, result.motor_torque)
        assert data.motor_torque.units == "N m"
        assert list(data.event_element.values) == list(result.events.element)
        assert data.scenario == result.provenance["scenario"]
        assert data.status == "completed"
        assert data.steps == result.statistics.steps


def test_events_are_a_table_of_pandas():
    pytest.importorskip("pandas", reason="needs the extra files")
    events = run().events
    table = events.to_pandas()
    assert list(table.columns) == ["time", "axis", "element", "before", "after"]
    assert [tuple(row) for row in table.itertuples(index=False)] == [tuple(e) for e in events]
    friction = table[table.element == "friction"]
    assert set(friction.after) <= {-1, 0, 1} and len(friction) > 3
    assert len(run(2, r3.Hold([0.0] * 3), 0.1).events.to_pandas()) == 0


@pytest.mark.parametrize(
    ("library", "use", "message"),
    [
        ("xarray", lambda r: r.to_xarray(), "to_xarray: expected xarray, h5netcdf and h5py; "),
        ("h5netcdf", lambda r: r.save("run.nc"), "save: expected xarray, h5netcdf and h5py; "),
        (
            "xarray",
            lambda r: r3.Result.load("run.nc"),
            "load: expected xarray, h5netcdf and h5py; ",
        ),
        ("pandas", lambda r: r.events.to_pandas(), "to_pandas: expected pandas; "),
    ],
)
def test_who_misses_a_library_is_told_what_to_install(library, use, message, monkeypatch):
    result = run(t_end=0.01)
    monkeypatch.setitem(sys.modules, library, None)  # any import of it fails
    with pytest.raises(ImportError, match=f"{message}pip install 'manutec-r3.files.'"):
        use(result)


# --- comma-separated values ---------------------------------------------------------------------


def read_csv(path):
    with open(path, newline="", encoding="utf-8") as file:
        titles, *rows = csv.reader(file)
    return titles, rows


def test_a_table_has_units_and_all_digits(tmp_path):
    result = run()
    result.to_csv(tmp_path / "run.csv", signals=["joint_torque", "motor_power", "state"])
    titles, rows = read_csv(tmp_path / "run.csv")
    assert titles[:5] == [
        "time [s]",
        *(f"joint_torque[{axis}] [N m]" for axis in (1, 2, 3)),
        "motor_power[1] [W]",
    ]
    assert titles[-1] == "pt2_torque_rate[3] [N m/s]"
    expected = (result.time[:, None], result.joint_torque, result.motor_power, result.state)
    np.testing.assert_array_equal(np.array(rows, float), np.hstack(expected))


def test_a_table_has_all_signals_that_there_are(tmp_path):
    result = run(robot=r3.Robot(4, controller=None), motion=None)
    result.to_csv(tmp_path / "run.csv")
    titles, rows = read_csv(tmp_path / "run.csv")
    lacking = ("reference_angle", "reference_rate", "control_error", "command", "voltage")
    lacking += ("tachogenerator_voltage", "rate_error")
    there = [name for name in signal_names if name not in lacking]
    assert [title.split("[")[0] for title in titles[1::3]] == there
    assert not np.isnan(np.array(rows, float)).any()


def test_a_table_is_a_reference_to_compare_with(tmp_path):
    result = run()
    result.to_csv(tmp_path / "run.csv")
    compared = r3.compare(result, tmp_path / "run.csv")
    assert compared.agrees
    assert len(compared.curves) == 3 * len(signal_names)
    assert all(curve.deviation == 0.0 for curve in compared.curves)


def test_a_table_in_other_units_is_no_reference(tmp_path):
    (tmp_path / "run.csv").write_text("time [s],joint_angle[1] [deg]\n0,0\n1,1\n")
    with pytest.raises(ValueError, match=r"expected joint_angle in rad, got .*\[deg\]"):
        r3.compare(run(t_end=0.01), tmp_path / "run.csv")


def test_signals_of_a_table_are_checked(tmp_path):
    result = run(t_end=0.01)
    with pytest.raises(ValueError, match=r"expected some of joint_angle, .*, got 'angle'"):
        result.to_csv(tmp_path / "run.csv", signals=["angle"])
    with pytest.raises(TypeError, match="signals: expected a sequence of names, got 'joint_angle'"):
        result.to_csv(tmp_path / "run.csv", signals="joint_angle")


def test_samples_are_tables_as_well(tmp_path):
    samples = run().at([0.1, 0.2])
    samples.to_csv(tmp_path / "run.csv", ["joint_rate"])
    _, rows = read_csv(tmp_path / "run.csv")
    np.testing.assert_array_equal(np.array(rows, float)[:, 1:], samples.joint_rate)


def test_events_are_a_table_with_all_digits(tmp_path):
    events = run().events
    events.to_csv(tmp_path / "events.csv")
    titles, rows = read_csv(tmp_path / "events.csv")
    assert titles == ["time [s]", "axis", "element", "before", "after"]
    read = [(float(t), int(i), e, int(b), int(a)) for t, i, e, b, a in rows]
    assert read == [tuple(event) for event in events]
