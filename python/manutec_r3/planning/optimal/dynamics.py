"""The core's equations of the arm as an expression that CasADi can differentiate.

The recursion of Newton and Euler stands in the core alone. There it has run on numbers that
remember how they were computed; here its tape is played again on symbols.
"""

from collections.abc import Callable
from typing import Any

import casadi as ca

from ... import _core
from ...robot import Robot

_OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
    "negate": lambda a, _: -a,
    "sine": lambda a, _: ca.sin(a),
    "cosine": lambda a, _: ca.cos(a),
}


def inverse_dynamics(robot: Robot) -> ca.Function:
    """Return `Robot.inverse_dynamics` as a function of symbols.

    Parameters
    ----------
    robot : Robot
        Its arm, with ideal gears and without friction (specification section 6).

    Returns
    -------
    casadi.Function
        Joint torques ``tau`` [N m] of angles ``q`` [rad], rates ``qd`` [rad/s] and accelerations
        ``qdd`` [rad/s^2], all (n_axes,).
    """
    lines, torques = _core.inverse_dynamics_tape(robot._compiled)
    arguments = {name: ca.SX.sym(name, robot.n_axes) for name in ("q", "qd", "qdd")}
    inputs = iter(ca.vertsplit(ca.vertcat(*arguments.values())))
    values: list[ca.SX] = []
    for operation, first, second, constant in lines:
        if operation == "input":
            value = next(inputs)
        elif operation == "constant":
            value = ca.SX(constant)
        else:
            value = _OPERATIONS[operation](values[first], values[second])
        values.append(value)
    tau = ca.vertcat(*(values[place] for place in torques))
    return ca.Function("inverse_dynamics", [*arguments.values()], [tau], [*arguments], ["tau"])
