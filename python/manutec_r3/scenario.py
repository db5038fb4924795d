"""Scenarios: an experiment in one TOML file, the robot, its motion and how it is simulated."""

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from difflib import get_close_matches
from importlib.resources import files
from importlib.resources.abc import Traversable
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, Self, get_args

from . import html
from .errors import SimulationError
from .experiment import Method
from .motion import Hold, Motion, Quintic, Sequence, Spline, Trapezoid
from .result import Result
from .robot import Load, Robot
from .simulation import Simulator, simulate
from .tables import TABLES

_FOLDER = files(__package__) / "scenarios"

# The report's own motion was never published: until there is one by the same rules, the quintic.
_ALIASES = {"figure9": "figure9-quintic"}


def scenarios() -> list[str]:
    """Names of the scenarios that come with the package."""
    names = [file.name.removesuffix(".toml") for file in _FOLDER.iterdir()]
    return sorted([*names, *_ALIASES])


@dataclass(frozen=True)
class Scenario:
    """An experiment with the robot.

    Attributes
    ----------
    name : str
        What it is called.
    robot : Robot
        What is simulated.
    motion : Motion
        The reference of its joint angles. In a file: any but a `FunctionMotion`.
    t_end : float
        End of the simulation [s]; it begins at 0.
    description : str
        One line about it.
    start : {"rotor", "arm"} or list of float, optional
        What rests on the reference at first, or the state to start from; see `simulate`.
    rtol : float, optional
        Tolerance relative to the states' nominal values; default: the method's own.
    method : {"exponential", "erk", "bdf"}, optional
        Integration method; default: the robot's own.
    inputs : dict
        What acts from outside: ``motor_torque``, ``command``, ``tip_force``, ``brakes``; see
        `simulate`.
    published : dict of str to (float, float)
        Lowest and highest value of ``joint_angle`` [rad], ``control_error`` [rad] and
        ``motor_torque`` [N m] over all axes, as far as they are published.
    source : str
        The TOML text that it was loaded from.
    """

    name: str
    robot: Robot
    motion: Motion | None
    t_end: float
    description: str = ""
    start: str | list[float] | None = None
    rtol: float | None = None
    method: Method | None = None
    inputs: Mapping[str, Any] = field(default_factory=dict)
    published: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    source: str = field(default="", repr=False, compare=False)

    @classmethod
    def load(cls, name_or_path: str | Path) -> Self:
        """Load a scenario of the package by its name, or any other from its TOML file.

        Parameters
        ----------
        name_or_path : str or Path
            One of `scenarios()`, or a path that ends in ``.toml``.

        Raises
        ------
        ValueError
            If no scenario has this name, or if the file does not describe one: the message names
            the file, the key, what was expected and what arrived.
        OSError
            If the file cannot be read.
        """
        name, file = _find(name_or_path)
        content = file.read_bytes()
        with _at(file):
            source = content.decode()
            scenario = cls(name, **_settings(tomllib.loads(source)), source=source)
            with suppress(SimulationError):  # a start that no run can begin with is left to `run`
                Simulator(**scenario._arguments)
        return scenario

    def run(self, **overrides: Any) -> Result:
        """Simulate.

        Parameters
        ----------
        **overrides
            Arguments of `simulate` that take the place of the scenario's own, such as ``rtol``,
            or that it does not have, such as ``times``.
        """
        arguments = {"t_end": self.t_end} | self._arguments | overrides
        return simulate(**arguments, _scenario=self.source)

    def _repr_html_(self) -> str:
        given = {
            "end": f"{self.t_end:g} s",
            "start": self.start,
            "rtol": self.rtol,
            "method": self.method,
            **self.inputs,
        }
        about = {name: value for name, value in given.items() if value is not None}
        motion = self.motion._repr_html_() if self.motion else ""
        return (
            html.facts(f"{self.name}: {self.description}", about)
            + self.robot._repr_html_()
            + motion
        )

    @property
    def _arguments(self) -> dict[str, Any]:
        """What a `Simulator` is made of."""
        names = ("robot", "motion", "rtol", "method", "start")
        return {name: getattr(self, name) for name in names} | dict(self.inputs)


def _find(name_or_path: str | Path) -> tuple[str, Traversable]:
    """Name and file of a scenario."""
    path = Path(name_or_path)
    if path.suffix == ".toml":
        return path.stem, path
    name = str(name_or_path)
    if name not in scenarios():
        raise ValueError(
            f"no scenario {name!r} comes with the package{_hint(name, scenarios())}; "
            "one of your own is a path that ends in .toml"
        )
    return name, _FOLDER / f"{_ALIASES.get(name, name)}.toml"


# --- from TOML --------------------------------------------------------------------------------


class _Kind(NamedTuple):
    """What a key expects, in words and as a test."""

    expected: str
    accepts: Callable[[Any], bool]


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)


def _is_list(value: Any, length: int | None = None) -> bool:
    return isinstance(value, list) and all(map(_is_number, value)) and length in (None, len(value))


def _positive(what: str) -> _Kind:
    return _Kind(f"a positive {what}", lambda value: _is_number(value) and value > 0)


def _list_of(what: str) -> _Kind:
    return _Kind(f"a list of {what}", _is_list)


_TABLE = _Kind("a table", lambda value: isinstance(value, dict))
_TEXT = _Kind("a text", lambda value: isinstance(value, str))
_START = _Kind(
    '"rotor", "arm" or a state as a list of numbers',
    lambda value: value in ("rotor", "arm") or _is_list(value),
)
_METHOD = _Kind("one of " + ", ".join(get_args(Method)), lambda value: value in get_args(Method))
_RANGE = _Kind(
    "the lowest and the highest value",
    lambda value: _is_list(value, 2) and value[0] < value[1],
)
_ANGLES = _list_of("joint angles [rad]")
_PATH = {"start": _ANGLES, "end": _ANGLES}
_ROWS = _Kind(
    "a list of lists of joint angles [rad], one for each time",
    lambda value: isinstance(value, list) and all(map(_is_list, value)),
)
_TABLES = _Kind(
    "a list of tables, one for each motion",
    lambda value: isinstance(value, list) and all(isinstance(entry, dict) for entry in value),
)

# Each motion with its keys, which are names of its arguments: required and optional ones.
_MOTIONS = {
    "quintic": (Quintic, {**_PATH, "duration": _positive("time [s]")}, {}),
    "trapezoid": (
        Trapezoid,
        {
            **_PATH,
            "rate": _list_of("joint rates [rad/s]"),
            "acceleration": _list_of("joint accelerations [rad/s^2]"),
        },
        {},
    ),
    "spline": (Spline, {"times": _list_of("instants [s]"), "angles": _ROWS}, {}),
    "hold": (Hold, {"angles": _ANGLES}, {"duration": _Kind("a time [s]", _is_number)}),
    "sequence": (Sequence, {"motions": _TABLES}, {}),
}
_SCENARIO = {"t_end": _positive("time [s]"), "robot": _TABLE}
_SCENARIO_OPTIONS = {
    "description": _TEXT,
    "motion": _TABLE,
    "start": _START,
    "inputs": _TABLE,
    "solver": _TABLE,
    "published": _TABLE,
}
_ROBOT = {"model": _Kind("a number or a name", lambda value: type(value) in (int, str))}
# What options and tables may be the robot itself knows.
_ROBOT_OPTIONS = {
    "load": _TABLE,
    "controller": _TEXT,
    "rotor_coupling": _Kind("a text or a list of texts", lambda value: type(value) in (str, list)),
    "gear_damping": _TEXT,
    "stiction": _TEXT,
    "arm": _TEXT,
    "stiffness": _positive("stiffness [N m/rad, N m s/rad]"),
    "creep_rate": _Kind("a rate [rad/s]", _is_number),
    "voltage_limit": _positive("voltage [V]"),
    **dict.fromkeys(TABLES, _TABLE),
}
_LOAD = {"mass": _Kind("a mass [kg]", _is_number)}
_FLAG = _Kind("true or false", lambda value: isinstance(value, bool))
_BRAKES = _Kind(
    "true, false or a list of them",
    lambda value: all(isinstance(on, bool) for on in (value if type(value) is list else [value])),
)
_POINT = _Kind("three coordinates [m]", lambda value: _is_list(value, 3))
_LOAD_OPTIONS = {"position": _POINT, "bounds": _FLAG}
_INPUTS_OPTIONS = {
    "motor_torque": _list_of("motor torques [N m]"),
    "command": _list_of("voltages [V]"),
    "tip_force": _Kind("three components [N]", lambda value: _is_list(value, 3)),
    "brakes": _BRAKES,
}
_SOLVER_OPTIONS = {"rtol": _positive("number"), "method": _METHOD}
_PUBLISHED_OPTIONS = dict.fromkeys(("joint_angle", "control_error", "motor_torque"), _RANGE)


def _settings(data: dict[str, Any]) -> dict[str, Any]:
    """Attributes of a scenario from the data of its file."""
    _check(data, _SCENARIO, _SCENARIO_OPTIONS)
    settings = {key: data[key] for key in ("t_end", "description", "start") if key in data}
    settings["robot"] = _robot(data["robot"])
    with _at("[motion]"):
        settings["motion"] = _motion(data["motion"]) if "motion" in data else None
    with _at("[inputs]"):
        settings["inputs"] = _check(data.get("inputs", {}), {}, _INPUTS_OPTIONS)
    with _at("[solver]"):
        settings |= _check(data.get("solver", {}), {}, _SOLVER_OPTIONS)
    with _at("[published]"):
        published = _check(data.get("published", {}), {}, _PUBLISHED_OPTIONS)
        settings["published"] = {signal: tuple(ends) for signal, ends in published.items()}
    return settings


def _robot(table: dict[str, Any]) -> Robot:
    with _at("[robot]"):
        _check(table, _ROBOT, _ROBOT_OPTIONS)
    options = dict(table)
    if "load" in table:
        with _at("[robot.load]"):
            options["load"] = Load(**_check(table["load"], _LOAD, _LOAD_OPTIONS))
    if options.get("controller") == "none":
        options["controller"] = None
    for name in TABLES:
        if name in table:
            options[name] = _by_axis(table[name])
    with _at("[robot]"):
        return Robot(**options)


def _by_axis(table: Any) -> Any:
    """Make numbers of the keys that name axes: in TOML they are texts."""
    if not isinstance(table, dict):
        return table
    return {int(key) if key.isdecimal() else key: _by_axis(value) for key, value in table.items()}


def _motion(table: dict[str, Any]) -> Motion:
    known = ", ".join(_MOTIONS)
    if "type" not in table:
        raise ValueError(f"type is missing, expected one of {known}")
    name = table["type"]
    if not isinstance(name, str) or name not in _MOTIONS:
        raise ValueError(f"type: expected one of {known}, got {name!r}{_near(name, _MOTIONS)}")
    motion, required, optional = _MOTIONS[name]
    arguments = {key: value for key, value in table.items() if key != "type"}
    _check(arguments, required, optional)
    if motion is Sequence:
        arguments["motions"] = list(_members(table["motions"]))
    return motion(**arguments)


def _members(tables: list[dict[str, Any]]) -> Iterator[Motion]:
    for k, table in enumerate(tables):
        with _at(f"motions[{k}]"):
            yield _motion(table)


def _check(
    table: dict[str, Any], required: dict[str, _Kind], optional: dict[str, _Kind] | None = None
) -> dict[str, Any]:
    """Return a table that has what is required and nothing unknown, all of it as expected."""
    known = required | (optional or {})
    for key, value in table.items():
        if key not in known:
            raise ValueError(f"unknown key {key!r}{_hint(key, known)}")
        if not known[key].accepts(value):
            raise ValueError(f"{key}: expected {known[key].expected}, got {value!r}")
    for key, kind in required.items():
        if key not in table:
            raise ValueError(f"{key} is missing, expected {kind.expected}")
    return table


def _hint(name: object, known: Iterable[str]) -> str:
    """Suggest what may have been meant, or all that is known."""
    return _near(name, known) or f", known are {', '.join(known)}"


def _near(name: object, known: Iterable[str]) -> str:
    """Suggest what may have been meant."""
    near = get_close_matches(str(name), known, n=1)
    return f", did you mean {near[0]!r}?" if near else ""


@contextmanager
def _at(place: object) -> Iterator[None]:
    """Say in the errors of this block where they come from."""
    try:
        yield
    except (TypeError, ValueError) as error:
        raise ValueError(f"{place}: {error}") from error
