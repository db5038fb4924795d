"""What acts on a robot from outside: its motion, and torques, commands and forces."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from . import _core
from .arguments import Floats, floats, numbers, per_axis
from .motion import Motion
from .robot import Robot


@dataclass(frozen=True)
class Input:
    """An input as a function of time: motor torques, commands, or a force on the tip.

    The slow path: each evaluation of the robot's equations calls the function.

    Parameters
    ----------
    function : callable
        Takes the time [s], gives the values. At a knot it gives what comes after.
    knots : sequence of float
        Instants at which it is not smooth [s], ascending. Each is a time event; what is not
        declared costs accuracy.

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived.

    Examples
    --------
    A torque on axis 1 until 0.5 s:

    >>> torque = r3.Input(lambda t: [5.0 * (t < 0.5), 0.0, 0.0], knots=[0.5])
    >>> robot = r3.Robot(model=2, controller=None)
    >>> result = r3.simulate(robot, None, t_end=1.0, motor_torque=torque)
    >>> result.at([0.4, 0.5]).motor_torque[:, 0]
    array([5., 0.])
    """

    function: Callable[[float], Floats]
    knots: tuple[float, ...]

    def __init__(self, function: Callable[[float], Floats], knots: Floats = ()) -> None:
        if not callable(function):
            raise TypeError(f"function: expected a function of the time, got {function!r}")
        instants = floats("knots", knots, "s")
        if instants.ndim != 1 or (np.diff(instants) <= 0.0).any():
            raise ValueError(f"knots: expected instants [s] that ascend, got {knots!r}")
        object.__setattr__(self, "function", function)
        object.__setattr__(self, "knots", tuple(instants.tolist()))

    def __call__(self, t: float) -> Floats:
        """Values at `t` [s]."""
        return self.function(t)

    def _core(self, name: str, unit: str, size: int) -> _core.Input:
        def values(t: float) -> list[float]:
            where = f"{name} at {t:.9g} s"
            array = numbers(where, self.function(t), f"{size} numbers [{unit}]")
            if array.shape != (size,) or not np.isfinite(array).all():
                raise ValueError(f"{where}: expected {size} finite values [{unit}], got {array}")
            return array.tolist()

        return _core.Input(size, values, self.knots)


class Held(NamedTuple):
    """Inputs that are held until they are set again; None where there is nothing to set.

    Attributes
    ----------
    of_axes : ndarray (n_axes,) or None
        Motor torques [N m], or commands [V].
    tip_force : ndarray (3,) or None
        In the world [N].
    """

    of_axes: np.ndarray | None
    tip_force: np.ndarray | None


@dataclass(frozen=True)
class Inputs:
    """What acts on a robot as a function of time.

    Attributes
    ----------
    robot : Robot
        The robot.
    motion : Motion or None
        Reference of its joint angles.
    of_axes : Input or None
        Motor torques [N m] of a robot without controller, or commands [V] of an external one.
    tip_force : Input or None
        Force on the load in the world [N].
    """

    robot: Robot
    motion: Motion | None
    of_axes: Input | None = None
    tip_force: Input | None = None

    @cached_property
    def _compiled(self) -> _core.Inputs:
        name, unit = input_of(self.robot) or ("", "")
        return _core.Inputs(
            self.robot._core_motion(self.motion),
            None if self.of_axes is None else self.of_axes._core(name, unit, self.robot.n_axes),
            None if self.tip_force is None else self.tip_force._core("tip_force", "N", 3),
        )

    def __getstate__(self) -> dict:
        return {name: value for name, value in self.__dict__.items() if name != "_compiled"}


def input_of(robot: Robot) -> tuple[str, str] | None:
    """Name and unit of what the axes of a robot get from outside, if they do."""
    return {None: ("motor_torque", "N m"), "external": ("command", "V")}.get(robot.controller)


def gather(
    robot: Robot,
    motion: Motion | None,
    given: Mapping[str, Any],
) -> tuple[Inputs, Held]:
    """Return what is a function of time, and what is held.

    Parameters
    ----------
    robot, motion
        The robot and its reference.
    given : dict
        ``motor_torque``, ``command`` and ``tip_force``: None, numbers to hold, a function of time,
        or an `Input`.

    Raises
    ------
    ValueError, TypeError
        If an input does not fit the robot, or is missing.
    """
    if not isinstance(robot, Robot):
        raise TypeError(f"robot: expected a Robot, got {robot!r}")
    if motion is None and robot.controller in ("continuous", "sampled"):
        raise ValueError("motion: expected a motion for the controllers to follow, got None")
    name, unit = input_of(robot) or ("", "")
    for other in ("motor_torque", "command"):
        if given.get(other) is not None and other != name:
            needed = {"motor_torque": "None", "command": "'external'"}[other]
            raise ValueError(
                f"{other}: expected a robot with controller={needed} to set it, "
                f"got controller={robot.controller!r}"
            )
    if given.get("tip_force") is not None:
        check_has_tip(robot)
    functions: list[Input | None] = []
    held: list[np.ndarray | None] = []
    for which in (name, "tip_force"):
        value = given.get(which)
        if callable(value) and not isinstance(value, Input):
            value = Input(value)
        if value is None or isinstance(value, Input):
            functions.append(value)
            held.append(None)
            continue
        functions.append(None)
        if which == "tip_force":
            held.append(force(value))
        else:
            held.append(one_per_axis(which, value, unit, robot.n_axes))
    return Inputs(robot, motion, *functions), Held(*held)


def one_per_axis(name: str, value: Floats, unit: str, n_axes: int) -> np.ndarray:
    """Return an array (n_axes,)."""
    array = per_axis(name, value, unit, n_axes)
    if array.ndim != 1:
        raise ValueError(f"{name}: expected {n_axes} values [{unit}], got shape {array.shape}")
    return array


def check_has_tip(robot: Robot) -> None:
    """Refuse the robot that is an axis alone: a force would do nothing."""
    if robot.n_axes == 1:
        raise ValueError(f"tip_force: expected none for model {robot.model}, which has no tip")


def force(value: Floats) -> np.ndarray:
    """Return a force on the tip, an array (3,) [N]."""
    array = floats("tip_force", value, "N")
    if array.shape != (3,):
        raise ValueError(f"tip_force: expected three components [N], got shape {array.shape}")
    return array


def braked(value: Sequence[bool] | bool, n_axes: int) -> list[bool]:
    """Return which axes are braked: True stands for axes 4 to 6."""
    if isinstance(value, bool | np.bool_):
        return [bool(value) and axis > 3 for axis in range(1, n_axes + 1)]
    array = np.asarray(value)
    if array.dtype.kind != "b" or array.shape != (n_axes,):
        raise ValueError(
            f"brakes: expected True, False or {n_axes} of them, one per axis, got {value!r}"
        )
    return array.tolist()
