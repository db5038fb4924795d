"""Robots and motions as plain data: tables, lists, texts, numbers; what files consist of.

Nothing is lost: what is made of the data again is equal. Functions are no data.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from .motion import Hold, Motion, PiecewisePolynomial, Quintic, Sequence, Spline, Trapezoid
from .robot import Load, Robot
from .tables import TABLES

# Each motion by its name, with its arguments and the attributes that hold them.
MOTIONS: dict[str, tuple[type[Motion], dict[str, str]]] = {
    "quintic": (Quintic, {"start": "start", "end": "end", "duration": "duration"}),
    "trapezoid": (
        Trapezoid,
        {
            "start": "start",
            "end": "end",
            "rate": "rate_limit",
            "acceleration": "acceleration_limit",
        },
    ),
    "spline": (Spline, {"times": "times", "angles": "angles"}),
    "piecewise-polynomial": (
        PiecewisePolynomial,
        {"times": "times", "coefficients": "coefficients"},
    ),
    "hold": (Hold, {"angles": "angles", "duration": "duration"}),
    "sequence": (Sequence, {"motions": "motions"}),
}


def of_robot(robot: Robot) -> dict[str, Any]:
    """Return its arguments, as far as they are not those of its model."""
    usual = Robot(robot.model)
    table: dict[str, Any] = {"model": robot.model}
    for argument in fields(Robot)[1:]:
        value = getattr(robot, argument.name)
        if value == getattr(usual, argument.name):
            continue
        if isinstance(value, Load):
            value = _of_load(value)
        table[argument.name] = "none" if value is None else of_value(value)
    return table


def _of_load(load: Load) -> dict[str, Any]:
    table = {"mass": load.mass, "position": load.position}
    return table if load.bounds else table | {"bounds": False}


def robot(table: Mapping[str, Any]) -> Robot:
    """Return the robot of such a table.

    Raises
    ------
    ValueError, TypeError
        As the robot does.
    """
    options = dict(table)
    if isinstance(options.get("load"), Mapping):
        options["load"] = Load(**options["load"])
    if options.get("controller") == "none":
        options["controller"] = None
    for name in TABLES:
        if name in options:
            options[name] = _by_axis(options[name])
    return Robot(**options)


def _by_axis(value: Any) -> Any:
    """Make numbers of the keys that name axes: in files they are texts."""
    if not isinstance(value, Mapping):
        return value
    return {int(key) if key.isdecimal() else key: _by_axis(entry) for key, entry in value.items()}


def of_motion(motion: Motion) -> dict[str, Any]:
    """Return its arguments, with the name of its type.

    Raises
    ------
    TypeError
        If it, or a member of it, is made of functions.
    """
    for name, (kind, arguments) in MOTIONS.items():
        if isinstance(motion, kind):
            values = {argument: getattr(motion, held) for argument, held in arguments.items()}
            return {"type": name} | {key: of_value(value) for key, value in values.items()}
    raise TypeError(f"motion: expected one of {', '.join(MOTIONS)}, got {motion!r}")


def motion(table: Mapping[str, Any]) -> Motion:
    """Return the motion of such a table.

    Raises
    ------
    ValueError, TypeError
        As the motion does.
    """
    arguments = dict(table)
    kind, _ = MOTIONS[arguments.pop("type")]
    if kind is Sequence:
        arguments["motions"] = [motion(member) for member in arguments["motions"]]
    return kind(**arguments)


def of_value(value: Any) -> Any:
    """Return plain data: of mappings, sequences, motions, what NumPy makes of numbers."""
    if isinstance(value, Motion):
        return of_motion(value)
    if isinstance(value, Mapping):
        return {str(key): of_value(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, list | tuple):
        return [of_value(entry) for entry in value]
    return value
