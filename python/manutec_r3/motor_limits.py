"""What planners are asked for, checked: limits of the motors, given or of Table 1, and angles."""

from typing import Any

import numpy as np

from .arguments import Floats, number, per_axis
from .robot import Robot


def check_motors_are_known(robot: Any) -> None:
    """Refuse what is no robot, and one whose motors have no limits in its tables.

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived.
    """
    if not isinstance(robot, Robot):
        raise TypeError(f"robot: expected a Robot, got {robot!r}")
    if robot.model not in (1, 2, 3, 4):
        raise ValueError(
            f"robot: expected model 1, 2, 3 or 4, whose motors are known, got {robot.model!r}"
        )


def gear_ratios(robot: Robot) -> np.ndarray:
    """Return p of each axis: (n_axes,)."""
    return np.array(robot.parameters["table_1"]["p"][: robot.n_axes])


def torque_limits(robot: Robot, given: float | Floats | None) -> np.ndarray:
    """Return limits of the motor torques [N m], motor side; default: ``rF_max``."""
    if given is None:
        return np.array(robot.parameters["table_1"]["rF_max"][: robot.n_axes])
    return positive_per_axis("torque_limit", given, "N m", robot.n_axes)


def rate_limits(robot: Robot, given: float | Floats | None) -> np.ndarray:
    """Return limits of the joint rates [rad/s]; default: ``rotor_rate_max`` over the gear ratio."""
    if given is None:
        of_rotors = robot.parameters["table_1"]["rotor_rate_max"][: robot.n_axes]
        return of_rotors / np.abs(gear_ratios(robot))
    return positive_per_axis("rate_limit", given, "rad/s", robot.n_axes)


def positive_per_axis(name: str, value: float | Floats, unit: str, n_axes: int) -> np.ndarray:
    """Return positive numbers (n_axes,) from one for all axes, or one for each."""
    if np.ndim(value) == 0:
        return np.full(n_axes, positive(name, value, unit))
    values = per_axis(name, value, unit, n_axes)
    if values.ndim != 1:
        raise ValueError(
            f"{name}: expected one number [{unit}] or {n_axes} of them, got shape {values.shape}"
        )
    for axis in np.flatnonzero(values <= 0.0):
        raise ValueError(
            f"{name} of axis {axis + 1}: expected more than 0 {unit}, got {values[axis]:g} {unit}"
        )
    return values


def positive(name: str, value: Any, unit: str) -> float:
    """Return a positive number."""
    checked = number(name, value, unit)
    if checked <= 0.0:
        raise ValueError(f"{name}: expected more than 0 [{unit}], got {checked:g}")
    return checked


def count(name: str, value: Any, least: int) -> int:
    """Return a whole number that is not too small."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name}: expected a whole number, got {value!r}")
    if value < least:
        raise ValueError(f"{name}: expected {least} or more, got {value}")
    return int(value)


def angles(name: str, value: Floats, n_axes: int) -> np.ndarray:
    """Return joint angles (n_axes,) [rad]."""
    one_each = per_axis(name, value, "rad", n_axes)
    if one_each.ndim != 1:
        raise ValueError(f"{name}: expected {n_axes} angles [rad], got shape {one_each.shape}")
    return one_each
