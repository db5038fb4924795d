"""What may stand in the TOML file of a scenario, and what is said of a mistake in it.

Here are the keys, and what is expected of each; what fits together the robot and its motion know.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, get_args

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    StrictBool,
    StrictInt,
    StrictStr,
    ValidationError,
    model_validator,
)

from .arguments import hint, near
from .experiment import Method

# --- what is expected ---------------------------------------------------------------------------

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
Numbers = list[Number]
Three = Annotated[Numbers, Field(min_length=3, max_length=3)]
Range = Annotated[Numbers, Field(min_length=2, max_length=2)]


def _is(expected: str, default: Any = ..., **more: Any) -> Any:
    """Say in words what a key expects."""
    return Field(default, description=expected, **more)


class Table(BaseModel):
    """A table of the file: known keys only."""

    model_config = ConfigDict(extra="forbid", strict=True)


class LoadTable(Table):
    """``[robot.load]``."""

    mass: Number = _is("a mass [kg]")
    position: Three = _is("three coordinates [m]", [0.0, 0.0, 0.25])
    bounds: StrictBool = _is("true or false", True)


class RobotTable(Table):
    """``[robot]``: arguments of `Robot`, which knows what options there are."""

    model: StrictInt | StrictStr = _is("a number or a name")
    load: LoadTable | None = _is("a table", None)
    controller: StrictStr = _is("a text", "continuous")
    rotor_coupling: StrictStr | list[StrictStr] = _is("a text or a list of texts", None)
    gear_damping: StrictStr = _is("a text", "parallel")
    stiction: StrictStr = _is("a text", "exact")
    stiffness: Positive = _is("a positive stiffness [N m/rad, N m s/rad]", 1.0)
    arm: StrictStr = _is("a text", None)
    creep_rate: Number = _is("a rate [rad/s]", 0.0)
    voltage_limit: Positive = _is("a positive voltage [V]", None)
    table_1: dict[str, Any] = _is("a table", {})
    table_2: dict[str, Any] = _is("a table", {})
    table_3: dict[str, Any] = _is("a table", {})


_ANGLES = "a list of joint angles [rad]"


class QuinticTable(Table):
    """A `Quintic`."""

    type: Literal["quintic"]
    start: Numbers = _is(_ANGLES)
    end: Numbers = _is(_ANGLES)
    duration: Positive = _is("a positive time [s]")


class TrapezoidTable(Table):
    """A `Trapezoid`."""

    type: Literal["trapezoid"]
    start: Numbers = _is(_ANGLES)
    end: Numbers = _is(_ANGLES)
    rate: Numbers = _is("a list of joint rates [rad/s]")
    acceleration: Numbers = _is("a list of joint accelerations [rad/s^2]")


class SplineTable(Table):
    """A `Spline`."""

    type: Literal["spline"]
    times: Numbers = _is("a list of instants [s]")
    angles: list[Numbers] = _is("a list of lists of joint angles [rad], one for each time")


class PiecewisePolynomialTable(Table):
    """A `PiecewisePolynomial`."""

    type: Literal["piecewise-polynomial"]
    times: Numbers = _is("a list of instants [s]")
    coefficients: list[list[Numbers]] = _is(
        "for each piece a list of lists of coefficients [rad], one for each power of x"
    )


class HoldTable(Table):
    """A `Hold`."""

    type: Literal["hold"]
    angles: Numbers = _is(_ANGLES)
    duration: Number = _is("a time [s]", 0.0)


class SequenceTable(Table):
    """A `Sequence`."""

    type: Literal["sequence"]
    motions: list["MotionTable"] = _is("a list of tables, one for each motion")


MotionTable = Annotated[
    QuinticTable
    | TrapezoidTable
    | SplineTable
    | PiecewisePolynomialTable
    | HoldTable
    | SequenceTable,
    Field(discriminator="type"),
]


class InputsTable(Table):
    """``[inputs]``: what acts from outside, held all the time."""

    motor_torque: Numbers = _is("a list of motor torques [N m]", None)
    command: Numbers = _is("a list of voltages [V]", None)
    tip_force: Three = _is("three components [N]", None)
    brakes: StrictBool | list[StrictBool] = _is("true, false or a list of them", None)


class SolverTable(Table):
    """``[solver]``."""

    rtol: Positive = _is("a positive number", None)
    method: Method = _is(f"one of {', '.join(get_args(Method))}", None)


class RecordTable(Table):
    """``[record]``: what the result has, and where it ends."""

    times: Numbers = _is("a list of instants [s]", None)
    list_samples: StrictBool = _is("true or false", False)
    list_limits: StrictBool = _is("true or false", False)
    enforce_limits: StrictBool = _is("true or false", False)


class PublishedTable(Table):
    """``[published]``: the lowest and the highest value of all axes, as far as they are known."""

    joint_angle: Range = _is("the lowest and the highest value", None)
    control_error: Range = _is("the lowest and the highest value", None)
    motor_torque: Range = _is("the lowest and the highest value", None)

    @model_validator(mode="after")
    def _ascend(self) -> "PublishedTable":
        for signal in self.model_fields_set:
            lowest, highest = getattr(self, signal)
            if not lowest < highest:
                raise ValueError(signal)
        return self


class ScenarioTable(Table):
    """The whole file."""

    t_end: Positive = _is("a positive time [s]")
    robot: RobotTable = _is("a table")
    description: StrictStr = _is("a text", "")
    motion: MotionTable = _is("a table", None)
    start: Literal["rotor", "arm"] | Numbers = _is(
        '"rotor", "arm" or a state as a list of numbers', None
    )
    inputs: InputsTable = _is("a table", None)
    solver: SolverTable = _is("a table", None)
    record: RecordTable = _is("a table", None)
    published: PublishedTable = _is("a table", None)


# --- what is wrong ------------------------------------------------------------------------------

_TABLES: dict[str, type[Table]] = {
    "robot": RobotTable,
    "load": LoadTable,
    "inputs": InputsTable,
    "solver": SolverTable,
    "record": RecordTable,
    "published": PublishedTable,
}
_MOTION_TABLES: dict[str, type[Table]] = {
    get_args(table.model_fields["type"].annotation)[0]: table
    for table in get_args(get_args(MotionTable)[0])
}


def check(data: Mapping[str, Any]) -> None:
    """Refuse what is not the data of a scenario's file.

    Raises
    ------
    ValueError
        The table and the key, what was expected, what arrived; misspelt keys with what may have
        been meant.
    """
    try:
        ScenarioTable.model_validate(data)
    except ValidationError as refusal:
        errors = refusal.errors(include_url=False)
        # A misspelt key is the reason why the right one is missing.
        unknown = [error for error in errors if error["type"] == "extra_forbidden"]
        raise ValueError(_mistake((unknown or errors)[0], data)) from None


def _mistake(error: Mapping[str, Any], value: Any) -> str:
    """Say where an error is, and what it is, with the words of the tables above."""
    table: type[Table] = ScenarioTable
    where, path = "", list(error["loc"])
    while path:
        key = path.pop(0)
        if key not in table.model_fields:
            return f"{where}unknown key {key!r}{hint(key, table.model_fields)}"
        expected = table.model_fields[key].description
        if key not in value:
            return f"{where}{key} is missing, expected {expected}"
        if key == "motions" and path:
            inner, place = value[key][path[0]], f"{where}motions[{path.pop(0)}]: "
        else:
            inner, place = value[key], _inside(where, key)
        if not isinstance(inner, Mapping) or key not in (*_TABLES, "motion", "motions"):
            return f"{where}{key}: expected {expected}, got {value[key]!r}"
        where, value = place, inner
        if key in _TABLES:
            table = _TABLES[key]
        elif path:
            table = _MOTION_TABLES[path.pop(0)]
        else:
            return where + _wrong_type(value)
    key = str(error["ctx"]["error"])
    return f"{where}{key}: expected {table.model_fields[key].description}, got {value[key]!r}"


def _inside(where: str, key: str) -> str:
    """Return the heading of a table, as it stands in the file."""
    outer = where.removeprefix("[").removesuffix("]: ")
    return f"[{outer}.{key}]: " if outer else f"[{key}]: "


def _wrong_type(motion: Mapping[str, Any]) -> str:
    known = ", ".join(_MOTION_TABLES)
    if "type" not in motion:
        return f"type is missing, expected one of {known}"
    name = motion["type"]
    return f"type: expected one of {known}, got {name!r}{near(name, _MOTION_TABLES)}"
