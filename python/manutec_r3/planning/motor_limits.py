"""Limits of the motors that planners keep: given, or those of Table 1."""

from typing import Any

import numpy as np

from ..arguments import Floats, positive_per_axis
from ..robot import Robot


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
