"""What a run is made of as JSON, without loss; nothing in it is ever executed.

Numbers are written to the last digit that matters. Functions cannot be written: what stands in
their place says so when somebody needs it.
"""

import json
from html import escape
from typing import Any, NoReturn, cast

import numpy as np

from .. import _core, plain
from ..experiment import Experiment, Method, Setup
from ..inputs import Held, Input, Inputs, input_of
from ..motion import Motion
from ..robot import Robot


def write(experiment: Experiment) -> tuple[str, list[str]]:
    """Return the text, and the names of arguments that it lacks."""
    data, not_in_file = {}, []
    for name, value in experiment.arguments.items():
        try:
            data[name] = _data(value)
        except _IsFunction:
            not_in_file.append(name)
            data[name] = {"function": sorted({*getattr(value, "knots", ())})}
    return json.dumps(data), not_in_file


def read(text: str, scenario: str) -> Experiment:
    """Return what `write` has written.

    Raises
    ------
    ValueError, KeyError
        If it is something else.
    """
    try:
        data = json.loads(text)
        robot = plain.robot(data["robot"])
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


# --- plain data ---------------------------------------------------------------------------------


class _IsFunction(Exception):
    """Functions cannot be written."""


def _data(value: Any) -> Any:
    """Plain data of an argument."""
    if isinstance(value, Robot):
        return plain.of_robot(value)
    if isinstance(value, Input):
        raise _IsFunction
    try:
        return plain.of_value(value)
    except TypeError:  # a motion that is made of functions
        raise _IsFunction from None


def _motion(data: dict[str, Any]) -> Motion:
    return MotionNotInFile() if "function" in data else plain.motion(data)


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
