"""What a run is made of as JSON, without loss; nothing in it is ever executed.

Numbers are written to the last digit that matters. Functions cannot be written: what stands in
their place says so when somebody needs it.
"""

import json
from collections.abc import Mapping
from dataclasses import fields
from html import escape
from typing import Any, NoReturn, cast

import numpy as np

from .. import _core
from ..experiment import Experiment, Method, Setup
from ..inputs import Held, Input, Inputs, input_of
from ..motion import Hold, Motion, Quintic, Sequence, Spline, Trapezoid
from ..robot import Load, Robot

# Arguments of the constructors, each with the attribute that holds it.
_MOTIONS = {
    Quintic: {"start": "start", "end": "end", "duration": "duration"},
    Trapezoid: {
        "start": "start",
        "end": "end",
        "rate": "rate_limit",
        "acceleration": "acceleration_limit",
    },
    Spline: {"times": "times", "angles": "angles"},
    Hold: {"angles": "angles", "duration": "duration"},
    Sequence: {"motions": "motions"},
}
_MOTION_NAMED = {kind.__name__: kind for kind in _MOTIONS}


def write(experiment: Experiment) -> tuple[str, list[str]]:
    """Return the text, and the names of arguments that it lacks."""
    data, not_in_file = {}, []
    for name, value in experiment.arguments.items():
        try:
            data[name] = _data(value)
        except _IsFunction:
            not_in_file.append(name)
            data[name] = {"function": sorted({*getattr(value, "knots", ())})}
    return json.dumps(data, default=_plain), not_in_file


def read(text: str, scenario: str) -> Experiment:
    """Return what `write` has written.

    Raises
    ------
    ValueError, KeyError
        If it is something else.
    """
    try:
        data = json.loads(text)
        robot = _robot(data["robot"])
        of_axes, _ = input_of(robot) or ("", "")
        motion = data["motion"]
        functions, held = zip(
            *(_input(name, data.get(name)) for name in (of_axes, "tip_force")), strict=True
        )
        inputs = Inputs(robot, motion and _motion(motion), *functions)
        start = data["start"]
        setup = Setup(
            inputs,
            Held(*held),
            data["brakes"],
            start if isinstance(start, str) else np.array(start),
            cast(Method, _core.Method[data["method"]].name),
            data["rtol"],
            data["list_samples"],
        )
        times = None if data["times"] is None else np.array(data["times"])
        limits = {name: data[name] for name in ("list_limits", "enforce_limits")}
        return Experiment(setup, data["t_end"], times, **limits, scenario=scenario)
    except (AttributeError, TypeError) as error:
        raise ValueError(f"experiment: {error}") from error


# --- to JSON ------------------------------------------------------------------------------------


class _IsFunction(Exception):
    """Functions cannot be written."""


def _data(value: Any) -> Any:
    """Plain data of an argument."""
    if isinstance(value, Robot | Load):
        return {of.name: _data(getattr(value, of.name)) for of in fields(value)}
    if isinstance(value, Motion):
        if type(value) not in _MOTIONS:
            raise _IsFunction
        attributes = _MOTIONS[type(value)]
        arguments = {name: _data(getattr(value, of)) for name, of in attributes.items()}
        return {"type": type(value).__name__, **arguments}
    if isinstance(value, Input):
        raise _IsFunction
    if isinstance(value, Mapping):  # of a table: by symbols, or by axes
        return {str(key): _data(entry) for key, entry in value.items()}
    if isinstance(value, tuple | list):
        return [_data(entry) for entry in value]
    return value


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy."""
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise TypeError(f"expected a number, got {value!r}")


# --- from JSON ----------------------------------------------------------------------------------


def _robot(data: dict[str, Any]) -> Robot:
    return Robot(**{**_by_axis(data), "load": Load(**data["load"])})


def _by_axis(value: Any) -> Any:
    """Make numbers of the keys that name axes: in JSON they are texts."""
    if not isinstance(value, dict):
        return value
    return {int(key) if key.isdecimal() else key: _by_axis(entry) for key, entry in value.items()}


def _motion(data: dict[str, Any]) -> Motion:
    if "function" in data:
        return MotionNotInFile()
    arguments = {name: value for name, value in data.items() if name != "type"}
    if "motions" in arguments:
        arguments["motions"] = [_motion(member) for member in arguments["motions"]]
    return _MOTION_NAMED[data["type"]](**arguments)


def _input(name: str, data: Any) -> tuple[Input | None, np.ndarray | None]:
    """Return a function of time, or what is held."""
    if isinstance(data, dict):
        return Input(_NotInFile(name), data["function"]), None
    return None, None if data is None else np.array(data)


# --- in place of functions ----------------------------------------------------------------------


def _is_not_in_file(name: str) -> NoReturn:
    raise ValueError(
        f"{name}: it was a function, which the file of this result could not hold: what is not in "
        f"the file cannot be computed. The run can be repeated with rerun({name}=...)"
    )


class _NotInFile:
    """A function that a file could not hold."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __call__(self, t: float) -> NoReturn:
        _is_not_in_file(self._name)

    def __repr__(self) -> str:
        return f"<the function {self._name}, which is not in the file>"


class MotionNotInFile(Motion):
    """A motion that a file could not hold: it was made of functions."""

    @property
    def duration(self) -> NoReturn:
        """Not known: raises a `ValueError`."""
        _is_not_in_file("motion")

    @property
    def _compiled(self) -> NoReturn:
        _is_not_in_file("motion")

    def __repr__(self) -> str:
        return "<a motion that is not in the file>"

    def _repr_html_(self) -> str:
        return escape(repr(self))
