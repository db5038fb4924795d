"""Tables with numbers of one's own: how they are given, what arrives, and what is refused."""

import pickle
import re

import hypothesis
import numpy as np
import pytest
from hypothesis import strategies as st

import manutec_r3 as r3
from manutec_r3 import _core

NAN, INF = float("nan"), float("inf")
MODELS = (1, 2, 3, 4, "full-robot", "one-axis")


def robot_with(table, symbol, value, model=3):
    return r3.Robot(model, **{table: {symbol: value}})


def row_of(table, symbol, value, model=3):
    """A row as the robot has it after it was replaced."""
    return robot_with(table, symbol, value, model).parameters[table][symbol]


# --- how rows are given ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("given", "row"),
    [
        (0.25, [0.25] * 6),
        ({2: 0.25, 6: 0.5}, [0.3, 0.25, 0.3, 0.3, 0.3, 0.5]),
        ({np.int64(3): np.float32(0.25)}, [0.3, 0.3, 0.25, 0.3, 0.3, 0.3]),
        ([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]),
        (np.full(6, 0.25), [0.25] * 6),
        ({}, [0.3] * 6),
    ],
)
def test_a_row_is_one_number_or_a_sequence_or_a_mapping_of_axes(given, row):
    robot = robot_with("table_1", "K_V", given)
    assert robot.parameters["table_1"].pop("K_V") == row
    # nothing else has changed
    expected, tables = r3.Robot().parameters, robot.parameters
    del expected["table_1"]["K_V"], tables["table_1"]["K_V"]
    assert tables == expected


def test_a_row_of_the_one_axis_has_one_entry():
    for value in (0.25, [0.25], {1: 0.25}):
        assert row_of("table_1", "ks", value, "one-axis") == [0.25]


def test_what_is_one_number_for_the_whole_robot_is_given_as_one():
    assert row_of("table_1", "T", 0.004) == 0.004
    assert row_of("table_3", "gravity", 1.62) == 1.62


def test_points_of_friction_replace_all_points_of_an_axis():
    points = [(0.0, 0.3), (50.0, 0.4), (200.0, 0.5)]
    friction = row_of("table_2", "friction", {1: np.array(points)})
    assert friction[0] == tuple(points)
    assert friction[1:] == r3.Robot().parameters["table_2"]["friction"][1:]


def test_an_arm_keeps_what_is_not_given():
    arms = row_of("table_3", "arms", {6: {"I33": 0.01, "centre_of_mass": [0.0, 0.0, 0.1]}})
    usual = r3.Robot().parameters["table_3"]["arms"]
    assert arms[:5] == usual[:5]
    assert arms[5] == usual[5] | {"I33": 0.01, "centre_of_mass": [0.0, 0.0, 0.1]}


def test_a_joint_limit_may_be_infinite_which_is_none():
    assert row_of("table_3", "joint_limits", {1: INF})[:2] == [INF, 2.01]
    assert row_of("table_3", "joint_limits", np.inf) == [INF] * 6


def test_a_robot_keeps_its_tables_when_those_that_it_was_given_change():
    friction = {1: [[0.0, 0.3], [100.0, 0.4]]}
    robot = robot_with("table_2", "friction", friction)
    friction[1][1][1] = 0.7
    assert robot == robot_with("table_2", "friction", {1: [[0.0, 0.3], [100.0, 0.4]]})
    assert robot.table_2["friction"][1][1][1] == 0.4


@pytest.mark.parametrize("model", MODELS)
def test_all_tables_of_a_robot_can_be_given_back(model):
    robot = r3.Robot(model)
    assert r3.Robot(model, **robot.parameters) == robot


def test_robots_with_equal_numbers_are_equal_however_they_are_given():
    assert robot_with("table_1", "K_V", {4: 0.3}) == r3.Robot()
    assert robot_with("table_1", "K_V", {4: 0.31}) != r3.Robot()
    assert hash(robot_with("table_1", "K_V", {4: 0.3})) == hash(r3.Robot())
    robot = r3.Robot(table_2={"b": {2: 0.05}}, table_3={"rn": {2: "z"}})
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert again.parameters == robot.parameters


def test_replacing_changes_what_is_given_and_nothing_else():
    robot = r3.Robot(table_1={"K_V": {1: 0.2}, "K_D": 0.02}, table_3={"arms": {6: {"mass": 1.0}}})
    other = robot.replace(table_1={"K_V": {2: 0.4}}, table_3={"arms": {6: {"I33": 0.01}}})
    assert other.parameters["table_1"]["K_V"] == [0.2, 0.4, 0.3, 0.3, 0.3, 0.3]
    assert other.parameters["table_1"]["K_D"] == [0.02] * 6
    arm_6 = other.parameters["table_3"]["arms"][5]
    assert (arm_6["mass"], arm_6["I33"]) == (1.0, 0.01)
    assert other.replace(table_1=None).parameters["table_1"] == r3.Robot().parameters["table_1"]


# --- what is refused ------------------------------------------------------------------------------


def numbers_of(model):
    """Every number of the tables of a model: where it stands, its unit, how to replace it."""
    tables, units = r3.Robot(model).parameters, _core.table_units(model)
    for table, rows in tables.items():
        for symbol, row in rows.items():
            for axis, old in enumerate(row if isinstance(row, list | tuple) else (row,), start=1):
                where = f"{table} {symbol}"
                if isinstance(row, list | tuple):
                    where += f" of axis {axis}"
                if isinstance(old, float):
                    if where.startswith("table_2 friction"):
                        continue
                    unit = units[table][symbol]
                    of_axis = isinstance(row, list)
                    yield (
                        where,
                        unit,
                        (table, symbol),
                        lambda x, a=axis, of=of_axis: {a: x} if of else x,
                    )
                elif isinstance(old, dict):
                    for inner, number in old.items():
                        if isinstance(number, float):
                            of_axis = isinstance(row, tuple)
                            yield (
                                f"{where}, {inner}",
                                units[table][inner],
                                (table, symbol),
                                lambda x, a=axis, k=inner, of=of_axis: (
                                    {a: {k: x}} if of else {k: x}
                                ),
                            )


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("wrong", [NAN, -INF, "1", None, True, 1j, [1.0]], ids=repr)
def test_what_is_no_number_is_refused_wherever_there_is_one(model, wrong):
    all_numbers = list(numbers_of(model))
    assert len(all_numbers) > (15 if model == "one-axis" else 80)
    for where, unit, (table, symbol), put in all_numbers:
        message = f"^{re.escape(where)}: expected .*number.* {re.escape(f'[{unit}]')}, got "
        with pytest.raises((ValueError, TypeError), match=message):
            robot_with(table, symbol, put(wrong), model)


# each: table, symbol, what is given; what the message says of place, expectation and arrival
MISTAKES = [
    # signs
    ("table_1", "K_S", {2: 0.0}, r"K_S of axis 2: expected a positive .*\[1/s\], got 0"),
    ("table_1", "a", {3: -0.1}, r"a of axis 3: expected .*0 or more \[V\], got -0\.1"),
    ("table_1", "p", {5: 0.0}, r"p of axis 5: expected .*other than 0 \[1\], got 0"),
    ("table_1", "T", -0.008, r"T: expected a positive .*\[s\], got -0\.008"),
    ("table_2", "c", {1: 0.0}, r"c of axis 1: expected a positive .*\[N m/rad\], got 0"),
    ("table_2", "d", {1: -1.0}, r"d of axis 1: expected .*0 or more \[N m s/rad\], got -1"),
    ("table_2", "b", {2: -0.1}, r"b of axis 2: expected .*0 or more \[rad\], got -0\.1"),
    ("table_3", "rJ", {4: 0.0}, r"rJ of axis 4: expected a positive .*\[kg m\^2\], got 0"),
    ("table_3", "joint_limits", {1: 0.0}, r"joint_limits of axis 1: .*positive.*\[rad\], got 0"),
    ("table_3", "arms", {3: {"mass": -1.0}}, r"mass of arm 3: expected .*0 kg or more, got -1"),
    ("table_3", "arms", {1: {"I33": -1.0}}, r"I33 of arm 1: expected .*0 kg m\^2.*, got -1"),
    # friction
    (
        "table_2",
        "rM_h",
        {4: 0.1},
        r"rM_h of axis 4: expected at least rM_1, .*0\.22 \[N m\], .*0\.1",
    ),
    (
        *("table_2", "friction", {1: [(0.0, 0.5), (100.0, 0.6)]}),
        r"rM_h of axis 1: expected at least rM_1, .*0\.5 \[N m\], got 0\.4",
    ),
    ("table_2", "friction", {1: [(0.0, 0.4)]}, "friction of axis 1: .*two points or more.*, got 1"),
    (
        *("table_2", "friction", {2: [(1.0, 0.4), (2.0, 0.5)]}),
        r"friction of axis 2: expected rates that begin at 0 .*\[rad/s\], got 1",
    ),
    (
        *("table_2", "friction", {2: [(0.0, 0.4), (90.0, 0.5), (90.0, 0.6)]}),
        r"friction of axis 2: expected rates that .*increase \[rad/s\], got 90",
    ),
    (
        *("table_2", "friction", {2: [(0.0, 0.4), (90.0, -0.5), (100.0, 0.6)]}),
        r"friction of axis 2: expected .*0 or more \[N m\], got -0\.5",
    ),
    (
        *("table_2", "friction", {2: [(0.0, 0.4), (90.0, 0.5), (100.0, 0.3)]}),
        r"friction of axis 2: expected a last torque of at least .*, 0\.5 \[N m\], got 0\.3",
    ),
    (
        *("table_2", "friction", {6: [(0.0, 0.1), (90.0, NAN)]}),
        r"friction of axis 6: expected finite .*\[rad/s, N m\], got nan at index \(1, 1\)",
    ),
    ("table_2", "friction", {6: "flat"}, r"friction of axis 6: .*\[rad/s, N m\], got 'flat'"),
    ("table_2", "friction", {6: [0.0, 0.1]}, r"friction of axis 6: expected points .*shape \(2,\)"),
    ("table_2", "friction", 0.3, r"friction: expected 6 entries, one per axis, .*, got 0\.3"),
    # axes, lengths, letters
    ("table_1", "K_V", {0: 0.3}, "K_V: expected an axis from 1 to 6, got 0"),
    ("table_1", "K_V", {7: 0.3}, "K_V: expected an axis from 1 to 6, got 7"),
    ("table_1", "K_V", {"2": 0.3}, "K_V: expected the number of an axis, got '2'"),
    ("table_1", "K_V", {True: 0.3}, "K_V: expected the number of an axis, got True"),
    ("table_1", "K_V", [0.3] * 5, r"K_V: expected 6 entries, one per axis, .*, got \(0"),
    ("table_1", "K_V", "fast", "K_V: expected 6 entries, one per axis, .*, got 'fast'"),
    ("table_1", "T", [0.008] * 6, r"T: expected one number \[s\], got shape \(6,\)"),
    ("table_2", "c", {4: 50.0}, "c: expected an axis from 1 to 3, got 4"),
    ("table_2", "c", [50.0] * 6, r"c: expected 3 entries, one per axis, .*, got \(50"),
    ("table_3", "rn", {2: "w"}, "rn of axis 2: expected 'x', 'y' or 'z', got 'w'"),
    ("table_3", "rn", {2: 1}, "rn of axis 2: expected 'x', 'y' or 'z', got 1"),
    ("table_3", "rn", "zxxzxz", "rn: expected 6 entries, one per axis, .*, got 'zxxzxz'"),
    (
        "table_3",
        "gravity",
        [0.0, 0.0, -9.81],
        r"gravity: expected one number \[m/s\^2\], got shape",
    ),
    # arms
    ("table_3", "arms", {2: 56.5}, r"arms of axis 2: expected a mapping of symbols .*, got 56\.5"),
    ("table_3", "arms", {2: {"axis": "z"}}, "arms of axis 2, axis: expected 'x', .*, got 'z'"),
    (
        *("table_3", "arms", {2: {"centre_of_mass": [0.1, 0.2]}}),
        r"arms of axis 2, centre_of_mass: expected three coordinates \[m\], got shape \(2,\)",
    ),
    (
        *("table_3", "arms", {2: {"offset": [0.1, INF, 0.2]}}),
        r"arms of axis 2, offset: expected finite values \[m\], got inf at index 1",
    ),
    (
        *("table_3", "arms", {2: {"offset": [0.1, True, 0.2]}}),
        r"arms of axis 2, offset: expected numbers \[m\], got \(0\.1, True, 0\.2\)",
    ),
    # names, with a suggestion
    ("table_1", "KV", 0.3, ".*unknown symbol 'KV', did you mean 'K_V'"),
    ("table_2", "frction", 0.3, ".*unknown symbol 'frction', did you mean 'friction'"),
    ("table_2", "rJ", 0.3, ".*unknown symbol 'rJ', known are b, c, d, rM_h, friction"),
    ("table_3", "arms", {2: {"mas": 1.0}}, "arms of axis 2: unknown symbol 'mas', .*'mass'"),
]


@pytest.mark.parametrize(("table", "symbol", "given", "message"), MISTAKES)
def test_a_mistake_is_named_with_table_symbol_and_axis(table, symbol, given, message):
    with pytest.raises((ValueError, TypeError), match=f"^{table}:? ?{message}"):
        robot_with(table, symbol, given)


@pytest.mark.parametrize(
    ("symbol", "given", "message"),
    [
        ("kp", {2: 5.0}, "kp: expected axis 1 only, got 2"),
        ("kp", [5.0] * 6, r"kp: expected one entry or .*, got \(5"),
        ("K_V", 0.3, ".*unknown symbol 'K_V', known are kp, ks"),
    ],
)
def test_the_one_axis_has_a_row_of_one(symbol, given, message):
    with pytest.raises(ValueError, match=f"^table_1:? ?{message}"):
        robot_with("table_1", symbol, given, "one-axis")


@pytest.mark.parametrize("given", [3, "K_V", [0.3] * 6, True])
def test_a_table_that_is_none_is_refused(given):
    with pytest.raises(TypeError, match=r"^table_2: expected a mapping of .* to values, got"):
        r3.Robot(table_2=given)


# --- rigid bodies ---------------------------------------------------------------------------------

moments = st.floats(0.01, 10.0)


@hypothesis.given(
    first=moments, second=moments, excess=st.floats(-1.0, 1.0), turn=st.floats(0.0, 3.2)
)
def test_an_inertia_is_accepted_if_a_rigid_body_may_have_it(first, second, excess, turn):
    """The largest principal moment is no larger than the sum of the others, whatever the axes.

    The third one is their sum and more, or less; the axes of the first and the third one are
    turned about that of the second one, which leaves the arm symmetrical to its x-z plane.
    """
    third = max(abs(first - second), (1.0 + excess) * (first + second))
    c, s = np.cos(turn), np.sin(turn)
    inertia = {
        "I11": c * c * first + s * s * third,
        "I22": second,
        "I33": s * s * first + c * c * third,
        "I13": c * s * (third - first),
    }
    given = {"arms": {4: inertia}}
    if excess < -1e-6:  # farther from the bound than roundoff
        r3.Robot(table_3=given)
    elif excess > 1e-6:
        with pytest.raises(ValueError, match=r"^table_3 inertia of arm 4: .*principal moments"):
            r3.Robot(table_3=given)
