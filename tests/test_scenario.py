"""Scenarios: what comes with the package, files of one's own, and mistakes in them."""

import pickle
import re
import tomllib
from datetime import date
from random import Random

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

import manutec_r3 as r3

MINE = """
description = "a short one"
t_end = 0.05
start = "arm"
[robot]
model = 4
load = { mass = 2.5 }
[motion]
type = "hold"
angles = [0.1, -0.2, 0.3]
[solver]
rtol = 1e-6
method = "bdf"
"""


@pytest.fixture
def write(tmp_path):
    """Writes a scenario file, returns its path."""

    def write(text):
        path = tmp_path / "mine.toml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def test_every_scenario_of_the_package_loads_under_its_name():
    assert {"figure9", "figure9-quintic", "full-robot", "one-axis"} <= set(r3.scenarios())
    for name in r3.scenarios():
        scenario = r3.Scenario.load(name)
        assert scenario.name == name
        assert scenario.description
        assert scenario.t_end > 0.0


def test_figure9_quintic_is_the_published_experiment_on_a_quintic():
    scenario = r3.Scenario.load("figure9-quintic")
    assert scenario.robot == r3.Robot(model=3, load=r3.Load(15.0, (0.0, 0.0, 0.25)))
    assert scenario.t_end == 1.5
    assert scenario.motion.duration == 1.2
    np.testing.assert_array_equal(scenario.motion.angle(0.0), np.zeros(6))
    np.testing.assert_array_equal(scenario.motion.angle(1.2), [1.0, 1.0, 0.6, -0.2, -0.15, -0.1])


def test_figure9_is_the_published_experiment_on_an_optimal_motion():
    """By the report's rules, within the ranges of its plots (spec 9)."""
    scenario, quintic = r3.Scenario.load("figure9"), r3.Scenario.load("figure9-quintic")
    assert scenario.robot == quintic.robot
    assert scenario.published == quintic.published
    assert scenario.t_end == 1.5
    assert 1.2 <= scenario.motion.duration <= 1.3
    np.testing.assert_array_equal(scenario.motion.angle(0.0), np.zeros(6))
    shoulder = scenario.robot.parameters["table_3"]["shoulder_height"]
    height = scenario.robot.load_position(scenario.motion.angle(1.5))[2] + shoulder
    assert height < 0.9  # of 2.155 m at the start [m]
    result = scenario.run()
    for signal, (lowest, highest) in scenario.published.items():
        values = getattr(result, signal)
        assert lowest <= values.min() < values.max() <= highest, signal
    assert {excess.what for excess in result.limits} == {"nominal_torque"}  # the load is held


def test_the_command_computes_the_motion_of_figure9_anew():
    from manutec_r3.planning import figure9

    stored = r3.Scenario.load("figure9").motion
    anew = figure9.motion()
    t = np.linspace(0.0, 1.5, 301)
    # As far as IPOPT determines an optimum, on any machine; here they differ by 1e-12 rad.
    np.testing.assert_allclose(stored.angle(t)[:, :3], anew.angle(t), rtol=0, atol=1e-6)
    assert not stored.angle(t)[:, 3:].any()
    said = tomllib.loads(figure9.file())
    kept = tomllib.loads(r3.Scenario.load("figure9").source)
    for name in ("times", "coefficients"):
        np.testing.assert_allclose(said["motion"].pop(name), kept["motion"].pop(name), atol=1e-6)
    assert said == kept
    assert anew.torque_margins.min() > -7e-3  # the reserve is beyond these margins
    assert anew.rate_margins.min() > -5e-3


@pytest.mark.parametrize(
    ("model", "start", "end", "breaks"),
    [
        (
            "full-robot",
            np.radians([-60, 20, 90, 0, -110, 0]),
            np.radians([60, -70, -35, 45, 110, 45]),
            [0.117424, 1.238621, 1.356045],  # spec M, "Reference motion", to 1e-6 s
        ),
        ("one-axis", [0.0], [np.radians(120)], [0.3, np.radians(40), np.radians(40) + 0.3]),
    ],
)
def test_the_modelica_variant_moves_as_specified(model, start, end, breaks):
    scenario = r3.Scenario.load(model)
    assert scenario.robot == r3.Robot(model)
    np.testing.assert_allclose(scenario.motion.angle(0.0), start, rtol=1e-15)
    np.testing.assert_allclose(scenario.motion.angle(2.0), end, rtol=1e-15)
    np.testing.assert_allclose(scenario.motion.knots[1:], breaks, rtol=0, atol=5e-7)
    assert scenario.t_end == pytest.approx(scenario.motion.duration + 0.5, rel=1e-15)


def test_a_file_says_everything_about_its_run(write):
    scenario = r3.Scenario.load(write(MINE))
    assert scenario.name == "mine"
    assert scenario.description == "a short one"
    result = scenario.run()
    assert result.robot == r3.Robot(model=4, load=r3.Load(2.5))
    assert result.time[-1] == 0.05
    assert (result.method, result.rtol) == ("bdf", 1e-6)
    np.testing.assert_array_equal(result.joint_angle[0], [0.1, -0.2, 0.3])  # start = "arm"


def test_a_path_may_be_a_string(write):
    path = write(MINE)
    assert r3.Scenario.load(str(path)).source == r3.Scenario.load(path).source == MINE


@pytest.mark.parametrize(
    "motion",
    [
        r3.Quintic([0.0] * 3, [0.1, 0.2, 0.3], 0.5),
        r3.Trapezoid([0.0] * 3, [0.1, 0.2, 0.3], [2.5] * 3, [10.0] * 3),
        r3.Spline([0.0, 0.2, 0.5], [[0.0] * 3, [0.1, 0.2, 0.3], [0.0] * 3]),
        r3.Hold([0.1, 0.2, 0.3], 0.5),
        r3.Sequence([r3.Hold([0.0] * 3, 0.25), r3.Quintic([0.0] * 3, [0.1, 0.2, 0.3], 0.5)]),
    ],
    ids=lambda motion: type(motion).__name__,
)
def test_each_motion_has_its_table(write, motion):
    table = {
        r3.Quintic: 'type = "quintic"\nstart = [0, 0, 0]\nend = [0.1, 0.2, 0.3]\nduration = 0.5',
        r3.Trapezoid: 'type = "trapezoid"\nstart = [0, 0, 0]\nend = [0.1, 0.2, 0.3]\n'
        "rate = [2.5, 2.5, 2.5]\nacceleration = [10, 10, 10]",
        r3.Spline: 'type = "spline"\ntimes = [0, 0.2, 0.5]\n'
        "angles = [[0, 0, 0], [0.1, 0.2, 0.3], [0, 0, 0]]",
        r3.Hold: 'type = "hold"\nangles = [0.1, 0.2, 0.3]\nduration = 0.5',
        r3.Sequence: 'type = "sequence"\n'
        '[[motion.motions]]\ntype = "hold"\nangles = [0, 0, 0]\nduration = 0.25\n'
        '[[motion.motions]]\ntype = "quintic"\nstart = [0, 0, 0]\nend = [0.1, 0.2, 0.3]\n'
        "duration = 0.5",
    }[type(motion)]
    loaded = r3.Scenario.load(write(f"t_end = 1\n[robot]\nmodel = 2\n[motion]\n{table}\n")).motion
    assert loaded == motion


def test_arguments_of_run_take_the_place_of_the_scenarios_own(write):
    result = r3.Scenario.load(write(MINE)).run(rtol=1e-5, method="erk", t_end=0.01, times=[0.005])
    assert (result.rtol, result.method, result.t_end) == (1e-5, "erk", 0.01)
    assert 0.005 in result.time


HOLD = 'type = "hold"\nangles = [0.1, -0.2, 0.3]\n'
OPTIONS = """
t_end = 0.01
[robot]
model = 3
controller = "none"
rotor_coupling = ["full", "full", "full", "full", "full", "simplified"]
gear_damping = "contact"
stiction = "stiff-spring"
stiffness = 1e6
creep_rate = 0.0
load = { mass = 20.0, position = [0.2, 0.0, 0.4], bounds = false }
[robot.table_1]
nothing = 0
[robot.table_2]
b = { 2 = 0.05, 3 = 0.01 }
friction = { 4 = [[0.0, 0.2], [100.0, 0.3]] }
[robot.table_3]
joint_limits = { 4 = 3.5, 1 = inf }
rn = { 2 = "z" }
[robot.table_3.arms.6]
I33 = 0.01
[inputs]
motor_torque = [0.1, 0.2, 0.3, 0.0, 0.0, 0.0]
tip_force = [0.0, 0.0, -10.0]
brakes = [false, false, false, true, false, true]
"""


def test_a_file_has_all_options_and_inputs_of_a_robot(write):
    text = OPTIONS.replace("nothing = 0", "rF_nom = 3.5")
    scenario = r3.Scenario.load(write(text))
    assert scenario.robot == r3.Robot(
        model=3,
        load=r3.Load(20.0, (0.2, 0.0, 0.4), bounds=False),
        controller=None,
        rotor_coupling=("full",) * 5 + ("simplified",),
        gear_damping="contact",
        stiction="stiff-spring",
        stiffness=1e6,
        creep_rate=0.0,
        table_1={"rF_nom": 3.5},
        table_2={"b": {2: 0.05, 3: 0.01}, "friction": {4: [(0.0, 0.2), (100.0, 0.3)]}},
        table_3={
            "joint_limits": {4: 3.5, 1: np.inf},
            "rn": {2: "z"},
            "arms": {6: {"I33": 0.01}},
        },
    )
    assert scenario.motion is None
    result = scenario.run()
    assert result.method == "bdf"
    expected = np.tile([0.1, 0.2, 0.3, 0.0, 0.0, 0.0], (len(result.time), 1))
    np.testing.assert_array_equal(result.motor_torque, expected)


@pytest.mark.parametrize(
    ("robot", "expected"),
    [
        ('model = 4\ncontroller = "sampled"', {"model": 4, "controller": "sampled"}),
        ('model = 2\narm = "six-arm"', {"model": 2, "arm": "six-arm"}),
        ("model = 4\nvoltage_limit = 5", {"model": 4, "voltage_limit": 5.0}),
    ],
)
def test_a_file_names_other_models(write, robot, expected):
    scenario = r3.Scenario.load(write(f"t_end = 1\n[robot]\n{robot}\n[motion]\n{HOLD}"))
    assert scenario.robot == r3.Robot(**expected)


def test_commands_are_inputs_in_a_file(write):
    robot = 'model = 4\ncontroller = "external"'
    text = f"t_end = 0.01\n[robot]\n{robot}\n[inputs]\ncommand = [0.1, 0.2, 0.3]\n"
    result = r3.Scenario.load(write(text)).run()
    assert (result.voltage[-1] > 0.1).all()


MISTAKES = [
    ("t_end = 0.05", "t_emd = 0.05", "unknown key 't_emd', did you mean 't_end'"),
    ("t_end = 0.05", "", r"t_end is missing, expected a positive time \[s\]"),
    ("t_end = 0.05", "t_end = -1.0", r"t_end: expected a positive time \[s\], got -1.0"),
    ("t_end = 0.05", "t_end = nan", r"t_end: expected a positive time \[s\], got nan"),
    ("t_end = 0.05", "t_end = true", r"t_end: expected a positive time \[s\], got True"),
    ("t_end = 0.05", "t_end = ", "line 3"),
    ('"arm"', '"wheel"', "start: expected .* got 'wheel'"),
    ("model = 4", "model = 5", r"\[robot\]: .*model.* got 5"),
    ("model = 4", "model = 4.0", r"\[robot\]: model: expected a number or a name, got 4\.0"),
    ("model = 4", 'model = "full"', r"\[robot\]: model: expected .*'full-robot'.*, got 'full'"),
    ("model = 4", 'model = 4\ncontroller = "pid"', r"\[robot\]: controller: .*, got 'pid'"),
    ("model = 4", 'model = 4\nstiction = "stiff-spring"', r"\[robot\]: stiction: .* for model 4"),
    ("model = 4", "model = 4\nstiffness = 0", r"\[robot\]: stiffness: .*\[N m/rad, .*\], got 0"),
    (
        "model = 4",
        "model = 4\ngear_dampin = 1",
        r"\[robot\]: unknown .*did you mean 'gear_damping'",
    ),
    ("model = 4", "model = 4\ntable_1 = 3", r"\[robot\]: table_1: expected a table, got 3"),
    (
        *("model = 4", "model = 4\ntable_1 = { KV = 1 }"),
        r"\[robot\]: table_1: unknown symbol 'KV', did you mean 'K_V'",
    ),
    (
        *("model = 4", "model = 4\ntable_1 = { K_V = { 7 = 0.3 } }"),
        r"\[robot\]: table_1 K_V: expected an axis from 1 to 6, got 7",
    ),
    (
        *("model = 4", "model = 4\ntable_1 = { K_V = { x = 0.3 } }"),
        r"\[robot\]: table_1 K_V: expected the number of an axis, got 'x'",
    ),
    (
        *("model = 4", "model = 4\ntable_2 = { c = { 3 = -1 } }"),
        r"\[robot\]: table_2 c of axis 3: expected a positive .*\[N m/rad\], got -1",
    ),
    ("mass = 2.5", "mass = 20, bounds = 0", r"\[robot.load\]: bounds: .*true or false, got 0"),
    ("angles = [0.1, -0.2, 0.3]", "angles = [0.1]", "motion: expected 3 axes for model 4, got 1"),
    ('"arm"', "[0.0, 0.0]", "start: expected a state vector of 36 values, got 2"),
    ("[solver]", "[inputs]\nbrakes = 1\n[solver]", r"\[inputs\]: brakes: .*true, .*, got 1"),
    (
        *("[solver]", "[inputs]\ncomand = [0]\n[solver]"),
        r"\[inputs\]: unknown key 'comand', did you mean 'command'",
    ),
    (
        *("[solver]", "[inputs]\ntip_force = [0, nan, 0]\n[solver]"),
        r"\[inputs\]: tip_force: expected three components \[N\], got \[0, nan, 0\]",
    ),
    (
        *("[solver]", "[inputs]\ncommand = [0, 0, 0]\n[solver]"),
        "command: expected a robot with controller='external' .*, got controller='continuous'",
    ),
    ("[motion]", "[inputs]", r"\[inputs\]: unknown key 'type'"),
    ("mass = 2.5", "maas = 2.5", r"\[robot.load\]: unknown key 'maas', did you mean 'mass'"),
    ("mass = 2.5", 'mass = "2.5"', r"\[robot.load\]: mass: expected a mass \[kg\], got '2.5'"),
    ("mass = 2.5", "mass = 20", r"\[robot.load\]: .*mass.*20"),
    ("mass = 2.5", "mass = 1, position = [0, 0.2]", r"\[robot.load\]: position: .* \[m\], got"),
    ('"hold"', '"holt"', r"\[motion\]: type: expected .* got 'holt', did you mean 'hold'"),
    ("angles", "angle", r"\[motion\]: unknown key 'angle', did you mean 'angles'"),
    ('"hold"', '"function"', r"\[motion\]: type: expected .* got 'function'"),
    ('"hold"', '"spline"\ntimes = [0, 1]', r"\[motion\]: angles: expected a list of lists"),
    (
        'type = "hold"\nangles = [0.1, -0.2, 0.3]',
        'type = "sequence"\nmotions = [{ type = "hold", angels = [0] }]',
        r"\[motion\]: motions\[0\]: unknown key 'angels', did you mean 'angles'",
    ),
    (
        'type = "hold"\nangles = [0.1, -0.2, 0.3]',
        'type = "sequence"\nmotions = [3]',
        r"\[motion\]: motions: expected a list of tables, one for each motion, got \[3\]",
    ),
    ("[0.1, -0.2, 0.3]", "0.1", r"\[motion\]: angles: .* \[rad\], got 0.1"),
    ("rtol = 1e-6", "rtol = 0", r"\[solver\]: rtol: expected a positive number, got 0"),
    ('"bdf"', '"euler"', r"\[solver\]: method: expected .* got 'euler'"),
    ("[solver]", "[published]\nmotor_torque = [1, -1]\n[solver]", r"\[published\]: motor_torque: "),
]


@pytest.mark.parametrize(("right", "wrong", "message"), MISTAKES)
def test_a_mistake_is_named_with_file_table_and_key(write, right, wrong, message):
    path = write(MINE.replace(right, wrong, 1))
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: .*{message}"):
        r3.Scenario.load(path)


def test_a_file_that_is_no_text_is_refused_by_name(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match=f"^{re.escape(str(path))}: "):
        r3.Scenario.load(path)


def test_an_unknown_name_brings_the_nearest():
    with pytest.raises(ValueError, match=r"no scenario 'figur9' .* did you mean 'figure9'"):
        r3.Scenario.load("figur9")


def test_a_missing_file_is_an_operating_system_error(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"mine\.toml"):
        r3.Scenario.load(tmp_path / "mine.toml")


# --- written back -------------------------------------------------------------------------------


def every_scenario():
    return pytest.mark.parametrize("name", r3.scenarios())


@every_scenario()
def test_a_scenario_is_saved_as_it_was_loaded_comments_included(tmp_path, name):
    scenario = r3.Scenario.load(name)
    scenario.save(tmp_path / "copy.toml")
    assert (tmp_path / "copy.toml").read_text(encoding="utf-8") == scenario.source
    assert r3.Scenario.load(tmp_path / "copy.toml") == scenario


@every_scenario()
def test_a_scenario_that_was_changed_is_saved_without_loss(tmp_path, name):
    changed = r3.Scenario.load(name).replace(
        rtol=1 / 3 * 1e-6, record={"times": [0.1, 1 / 3], "list_limits": True}
    )
    changed.save(tmp_path / "changed.toml")
    again = r3.Scenario.load(tmp_path / "changed.toml")
    assert again == changed
    assert again != r3.Scenario.load(name)
    assert hash(again) == hash(changed)
    assert pickle.loads(pickle.dumps(again)) == changed


def test_every_option_is_saved_without_loss(write, tmp_path):
    text = OPTIONS.replace("nothing = 0", "rF_nom = 3.5")
    scenario = r3.Scenario.load(write(text))
    changed = scenario.replace(description='with "quotes"\nand lines')
    changed.save(tmp_path / "again.toml")
    again = r3.Scenario.load(tmp_path / "again.toml")
    assert again == changed
    assert again.robot.table_3 == scenario.robot.table_3


@given(angles=st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3), rtol=st.floats(1e-14, 1e-2))
@settings(max_examples=50, deadline=None)  # a file each
def test_numbers_are_saved_to_the_last_digit(tmp_path_factory, angles, rtol):
    path = tmp_path_factory.mktemp("numbers") / "mine.toml"
    robot = r3.Robot(model=4, load=r3.Load(abs(angles[0])), table_2={"b": {2: abs(angles[1])}})
    scenario = r3.Scenario("mine", robot, r3.Hold(angles), 1.0, rtol=rtol, start=[0.1] * 36)
    scenario.save(path)
    assert r3.Scenario.load(path) == scenario


def test_what_a_file_cannot_hold_is_refused(tmp_path):
    robot = r3.Robot(model=4, controller=None)
    scenario = r3.Scenario("mine", robot, None, 1.0, inputs={"motor_torque": lambda t: [t, 0, 0]})
    with pytest.raises(TypeError, match=r"inputs motor_torque: .* a file holds no function"):
        scenario.save(tmp_path / "mine.toml")
    motion = r3.FunctionMotion(lambda t: [t] * 3, lambda t: [1.0] * 3, duration=1.0)
    with pytest.raises(TypeError, match=r"motion: expected one of quintic, .*, got FunctionMotion"):
        r3.Scenario("mine", r3.Robot(model=4), motion, 1.0).save(tmp_path / "mine.toml")
    with pytest.raises(ValueError, match=r"path: expected one that ends in \.toml, got '.*x\.txt'"):
        r3.Scenario("mine", r3.Robot(model=4), r3.Hold([0.0] * 3), 1.0).save(tmp_path / "x.txt")


def test_a_file_says_what_to_record(write):
    text = MINE + "[record]\ntimes = [0.0, 0.02]\nlist_limits = true\n"
    result = r3.Scenario.load(write(text)).run()
    times = {0.0, 0.02, *(event.time for event in result.events), result.time[-1]}
    assert set(result.time) == times
    with pytest.raises(
        ValueError, match=r"\[record\]: list_samples: expected true or false, got 1"
    ):
        r3.Scenario.load(write(MINE + "[record]\nlist_samples = 1\n"))


# --- any file at all ----------------------------------------------------------------------------

WORDS = ("", "rotor", "sampled", "full", "hold", "sequence", "type", "1", "x", "\u00fc\n")
NUMBERS = (0, 1, -1, 6, 2**62, 0.0, -0.0, 1e-300, 1e300, 0.5, float("nan"), float("inf"))


def anything(random, depth=2):
    """A value that may stand in a file."""
    kinds = [
        lambda: random.choice(NUMBERS),
        lambda: random.uniform(-2.0, 2.0),
        lambda: random.choice(WORDS),
        lambda: random.random() < 0.5,
        lambda: date(2000, 1, random.randint(1, 28)),
        lambda: [anything(random, depth - 1) for _ in range(random.randint(0, 4))],
        lambda: {random.choice(WORDS): anything(random, depth - 1) for _ in range(3)},
    ]
    return random.choice(kinds if depth > 0 else kinds[:5])()


def places(table, before=()):
    """The paths of all entries of a table."""
    for key, value in table.items():
        yield (*before, key)
        if isinstance(value, dict):
            yield from places(value, (*before, key))


def with_mistakes(random):
    """The data of a file in which entries are replaced, removed, misspelt or new."""
    right = random.choice([MINE, OPTIONS.replace("nothing = 0", "rF_nom = 3.5")])
    data = tomllib.loads(right)
    for _ in range(random.randint(1, 3)):
        *outer, key = random.choice(list(places(data)))
        table = data
        for name in outer:
            table = table[name]
        change = random.choice(["replace", "remove", "misspell", "add"])
        if change == "replace":
            table[key] = anything(random)
        elif change == "add":
            table[random.choice(WORDS)] = anything(random)
        else:
            value = table.pop(key)
            if change == "misspell":
                table[key[:-1] + random.choice(["", "s", "_x"])] = value
    return data


# Chosen by one number each: choices by hypothesis itself would take ten times as long.
@given(seed=st.integers(0, 2**64))
@settings(max_examples=3_000, deadline=None)
def test_a_file_with_any_mistake_ends_in_a_clear_error_or_is_a_scenario(tmp_path_factory, seed):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_text(tomli_w.dumps(with_mistakes(Random(seed))), encoding="utf-8")
    try:
        scenario = r3.Scenario.load(path)
    except ValueError as error:
        assert str(error).startswith(f"{path}: ")
        assert "pydantic" not in str(error)
    else:
        assert scenario.source == path.read_text(encoding="utf-8")


@given(text=st.text(max_size=80))
@settings(max_examples=500, deadline=None)
def test_any_text_ends_in_a_clear_error(tmp_path_factory, text):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=re.escape(str(path))):
        r3.Scenario.load(path)
