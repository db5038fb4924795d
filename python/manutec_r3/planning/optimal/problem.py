"""The optimisation problem, and its solution on a given mesh.

Of an arm whose joints are to go from rest at `start` to rest at `end` in the time T,

    minimise    a T + b E,     E = int_0^T sum_i (rF_i / scale_i)^2 dt
    subject to  |rF_i| <= torque limit,  |aq_i'| <= rate limit,  |aq_i| <= angle limit,

with ideal gears, p rF = tau(q, qd, qdd): the torques that a motion needs (inverse dynamics), so
that no mass matrix is inverted. Unknown are the motion's `Pieces` in normalised time s = t / T,
and T:

    q(s),   qd = (dq/ds) / T,   qdd = (d^2q/ds^2) / T^2.

The integral is a sum over Radau's points of the pieces, and limits hold at points. What is asked at
a point k depends on z_k = (q, dq/ds, d^2q/ds^2, T) there, which is linear in the unknowns,
z = M v. So everything is one small function and its derivatives, evaluated at all points:

    gradient M^T grad(z),   Jacobian diag(J_k) M,   Hessian M^T diag(H_k) M.
"""

from dataclasses import dataclass
from functools import cached_property
from time import perf_counter
from typing import Any, NamedTuple

import casadi as ca
import numpy as np

from ...robot import Robot
from ..motor_limits import gear_ratios
from .dynamics import inverse_dynamics
from .pieces import RADAU_POINTS, RADAU_WEIGHTS, Pieces, Points

# Of the conditions of optimality, with an objective that is about 1. What the barrier leaves of it
# is larger by the number of limits, a thousand: least times are found to 1e-6, least efforts to as
# many digits with less.
_TOLERANCE_OF_TIME = 1e-9
_TOLERANCE_OF_EFFORT = 1e-8
# Where roundoff does not let it come so far, three such iterations in a row are as good.
_ACCEPTABLE = 3e-8
_MOST_ITERATIONS = 1000
# A free duration is not less than this part of the one to begin with.
_SHORTEST = 0.01

# The barrier with which IPOPT begins: its own for a guess from afar;
# little where the motion is nearly known; next to none where the multipliers are known as well.
# Refinement takes half of the iterations then, to the same optimum.
_FROM_NEARBY: dict[str, Any] = {"mu_init": 1e-6}
_WITH_MULTIPLIERS: dict[str, Any] = {"mu_init": 1e-9, "warm_start_init_point": "yes"} | {
    f"warm_start_{what}_push": 1e-9 for what in ("bound", "slack_bound", "mult_bound")
}


@dataclass(frozen=True)
class Task:
    """What is asked for; arrays have shape (n_axes,).

    Attributes
    ----------
    robot : Robot
        Its arm moves.
    start, end : ndarray
        Joint angles [rad].
    duration : float or None
        Given, or free [s].
    time_weight, effort_weight : float
        The numbers a and b above.
    effort_scale : ndarray
        Torques are divided by it: 1, or the torque per volt [N m/V].
    torque_limit : ndarray
        Motor side [N m].
    rate_limit : ndarray
        Joint side [rad/s].
    angle_limit : ndarray
        [rad], infinite where there is none.
    smooth : bool
        Whether accelerations are to be continuous, and zero at both ends.
    """

    robot: Robot
    start: np.ndarray
    end: np.ndarray
    duration: float | None
    time_weight: float
    effort_weight: float
    effort_scale: np.ndarray
    torque_limit: np.ndarray
    rate_limit: np.ndarray
    angle_limit: np.ndarray
    smooth: bool

    @property
    def gear_ratio(self) -> np.ndarray:
        """Of each axis."""
        return gear_ratios(self.robot)

    @cached_property
    def at_point(self) -> "_AtPoint":
        """What is asked at a point."""
        return _AtPoint.of(self)


@dataclass(frozen=True)
class _AtPoint:
    """Functions of z = (q, dq/ds, d^2q/ds^2, T), their derivatives, and a point's weight."""

    value: ca.Function  # z, weight -> weight b T sum (rF / scale)^2, constraints
    gradient: ca.Function  # z, weight -> of the cost
    jacobian: ca.Function  # z -> of the constraints
    hessian: ca.Function  # z, weight, multiplier of the cost, of the constraints -> Hessian

    @classmethod
    def of(cls, task: Task) -> "_AtPoint":
        n = task.robot.n_axes
        z, weight, of_cost = ca.SX.sym("z", 3 * n + 1), ca.SX.sym("weight"), ca.SX.sym("of_cost")
        q, slope, bend, T = ca.vertsplit(z, [0, n, 2 * n, 3 * n, 3 * n + 1])
        rate = slope / T
        torque = inverse_dynamics(task.robot)(q, rate, bend / T**2) / ca.DM(task.gear_ratio)
        cost = weight * task.effort_weight * T * ca.sumsqr(torque / ca.DM(task.effort_scale))
        limited = ca.vertcat(torque / ca.DM(task.torque_limit), rate / ca.DM(task.rate_limit))
        bounded = np.flatnonzero(np.isfinite(task.angle_limit)).tolist()
        limited = ca.vertcat(limited, q[bounded] / ca.DM(task.angle_limit[bounded]))
        of_limits = ca.SX.sym("of_limits", limited.shape[0])
        hessian, _ = ca.hessian(of_cost * cost + ca.dot(of_limits, limited), z)
        # Full blocks, so that all of them stand in a matrix in the order in which they come.
        gradient, jacobian = ca.gradient(cost, z), ca.densify(ca.jacobian(limited, z))
        return cls(
            ca.Function("value", [z, weight], [cost, limited]),
            ca.Function("gradient", [z, weight], [ca.densify(gradient)]),
            ca.Function("jacobian", [z], [jacobian]),
            ca.Function("hessian", [z, weight, of_cost, of_limits], [ca.densify(hessian)]),
        )


@dataclass(frozen=True)
class Trial:
    """A motion, optimal or not.

    Attributes
    ----------
    pieces : Pieces
        On which mesh.
    unknowns : ndarray (3 N + 2, n_axes)
        Of the pieces.
    duration : float
        T [s].
    """

    pieces: Pieces
    unknowns: np.ndarray
    duration: float

    def at(self, points: Points) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Angles, rates and accelerations (n, n_axes) at n points."""
        q, slope, bend = (self.pieces.values(points, self.unknowns, k) for k in range(3))
        return q, slope / self.duration, bend / self.duration**2

    def motor_torque(self, task: Task, points: Points) -> np.ndarray:
        """Motor torques (n, n_axes) at n points, by the core [N m]."""
        return task.robot.inverse_dynamics(*self.at(points)) / task.gear_ratio

    def effort(self, task: Task, x: np.ndarray, weights: np.ndarray) -> float:
        """E, by a rule for integrals from 0 to 1 with some points x and weights (n,)."""
        torque = self.motor_torque(task, Points.on_all(self.pieces.n, x))
        squares = ((torque / task.effort_scale) ** 2).sum(axis=1).reshape(self.pieces.n, -1)
        return float(self.duration * self.pieces.length @ (squares @ weights))


@dataclass(frozen=True)
class Guess(Trial):
    """Where a solver begins.

    Attributes
    ----------
    is_nearby : bool
        Whether it solves a problem that differs little.
    multipliers : ndarray, optional
        Of that problem's constraints, if those are the first ones of this problem.
    """

    is_nearby: bool = False
    multipliers: np.ndarray | None = None


@dataclass(frozen=True)
class Solution(Trial):
    """What a solver has found.

    Attributes
    ----------
    objective : float
        a T + b E.
    multipliers : ndarray
        Of all constraints: continuous accelerations, then limits, point by point.
    status : str
        In the words of the solver.
    succeeded : bool
        Whether it is a solution.
    iterations : int
        Of the solver.
    seconds : float
        Time it took.
    """

    objective: float
    multipliers: np.ndarray
    status: str
    succeeded: bool
    iterations: int
    seconds: float


def solve(task: Task, limit_points: Points, guess: Guess) -> Solution:
    """Solve a task with IPOPT, on the mesh of a guess.

    Parameters
    ----------
    task : Task
        What is asked for.
    limit_points : Points
        Where limits hold besides Radau's points.
    guess : Guess
        To begin with.

    Returns
    -------
    Solution
        Successful or not.
    """
    began = perf_counter()
    program = _program(task, guess.pieces, limit_points)
    of_ipopt = {
        "print_level": 0,
        "sb": "yes",
        "tol": _TOLERANCE_OF_TIME if task.duration is None else _TOLERANCE_OF_EFFORT,
        "max_iter": _MOST_ITERATIONS,
        "acceptable_tol": _ACCEPTABLE,
        "acceptable_iter": 3,
        **_beginning(guess),
    }
    options = {**program.derivatives, "print_time": False, "ipopt": of_ipopt}
    solver = ca.nlpsol("optimal_motion", "ipopt", program.expressions, options)
    lower, upper = _bounds(task, guess.pieces, guess.duration)
    known = np.zeros(0) if guess.multipliers is None else guess.multipliers
    found = solver(
        x0=np.append(guess.unknowns.T.ravel(), guess.duration),
        lam_g0=np.append(known, np.zeros(len(program.largest) - len(known))),
        lbx=lower,
        ubx=upper,
        lbg=-program.largest,
        ubg=program.largest,
    )
    statistics = solver.stats()
    values = found["x"].full().ravel()
    return Solution(
        guess.pieces,
        values[:-1].reshape(task.robot.n_axes, -1).T,
        float(values[-1]),
        float(found["f"]),
        found["lam_g"].full().ravel(),
        statistics["return_status"],
        statistics["success"],
        statistics["iter_count"],
        perf_counter() - began,
    )


class _Program(NamedTuple):
    """A task on a mesh: f(v) least, |g(v)| <= largest; v are the unknowns, axis by axis, and T."""

    expressions: dict[str, ca.MX]
    derivatives: dict[str, ca.Function]
    largest: np.ndarray  # 0 for jumps of accelerations, 1 for limits, point by point


def _program(task: Task, pieces: Pieces, limit_points: Points) -> _Program:
    points = Points.on_all(pieces.n, RADAU_POINTS).and_also(limit_points)
    n = len(points.x)
    weights = np.zeros(n)
    weights[: 3 * pieces.n] = np.multiply.outer(pieces.length, RADAU_WEIGHTS).ravel()
    M = _linear_map(pieces, points, task.robot.n_axes)
    n_v = M.shape[1]
    jumps = _jumps_of_acceleration(pieces, task.robot.n_axes) if task.smooth else ca.DM(0, n_v)
    of_time = ca.DM.zeros(n_v)
    of_time[-1] = task.time_weight

    v, none = ca.MX.sym("v", n_v), ca.MX.sym("none", 0)
    z = ca.reshape(M @ v, -1, n)
    ask, weight = task.at_point, ca.DM(weights).T
    cost, limited = ask.value.map(n)(z, weight)
    f = ca.dot(of_time, v) + ca.sum2(cost)
    g = ca.vertcat(jumps @ v, ca.vec(limited))
    gradient, jacobian = ask.gradient.map(n)(z, weight), ask.jacobian.map(n)(z)
    of_f, of_g = ca.MX.sym("of_f"), ca.MX.sym("of_g", g.shape[0])
    hessian = ask.hessian.map(n)(z, weight, of_f, ca.reshape(of_g[jumps.shape[0] :], -1, n))

    grad_f = of_time + M.T @ ca.vec(gradient)
    jac_g = ca.vertcat(jumps, _diagonal(jacobian, n) @ M)
    hess_lag = ca.triu(M.T @ (_diagonal(hessian, n) @ M))
    # Names of inputs and outputs are those that CasADi wants.
    derivatives = {
        "grad_f": ca.Function("grad_f", [v, none], [f, grad_f], ["x", "p"], ["f", "grad_f_x"]),
        "jac_g": ca.Function("jac_g", [v, none], [g, jac_g], ["x", "p"], ["g", "jac_g_x"]),
        "hess_lag": ca.Function(
            "hess_lag",
            [v, none, of_f, of_g],
            [hess_lag],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        ),
    }
    largest = np.append(np.zeros(jumps.shape[0]), np.ones(limited.numel()))
    return _Program({"x": v, "p": none, "f": f, "g": g}, derivatives, largest)


def _beginning(guess: Guess) -> dict[str, Any]:
    """Return how IPOPT is to begin."""
    if guess.multipliers is not None:
        return _WITH_MULTIPLIERS
    return _FROM_NEARBY if guess.is_nearby else {}


def _linear_map(pieces: Pieces, points: Points, n_axes: int) -> ca.DM:
    """M: from unknowns, axis by axis, and T to z at all points, point by point."""
    n, n_z = len(points.x), 3 * n_axes + 1
    rows, columns, values = (
        [np.arange(n) * n_z + n_z - 1],
        [np.full(n, pieces.n_unknowns * n_axes)],
        [np.ones(n)],
    )
    for derivative in range(3):
        matrix = pieces.matrix(points, derivative)
        point, unknown = np.nonzero(matrix)
        for axis in range(n_axes):
            rows.append(point * n_z + derivative * n_axes + axis)
            columns.append(unknown + axis * pieces.n_unknowns)
            values.append(matrix[point, unknown])
    entries = (np.concatenate(parts).tolist() for parts in (rows, columns, values))
    return ca.DM.triplet(*entries, n * n_z, pieces.n_unknowns * n_axes + 1)


def _jumps_of_acceleration(pieces: Pieces, n_axes: int) -> ca.DM:
    """Return the matrix that gives jumps of d^2q/ds^2 at all mesh points, from and to rest."""
    all_pieces = np.arange(pieces.n)
    after = pieces.matrix(Points(all_pieces, np.zeros(pieces.n)), 2)
    before = pieces.matrix(Points(all_pieces, np.ones(pieces.n)), 2)
    of_axis = np.pad(after, ((0, 1), (0, 0))) - np.pad(before, ((1, 0), (0, 0)))
    of_axes = np.kron(np.eye(n_axes), of_axis)
    return ca.sparsify(ca.DM(np.pad(of_axes, ((0, 0), (0, 1)))))


def _diagonal(blocks: ca.MX, n: int) -> ca.MX:
    """Put n full blocks that stand side by side on the diagonal of a sparse matrix."""
    block = ca.Sparsity.dense(blocks.shape[0], blocks.shape[1] // n)
    return ca.MX(ca.diagcat(*[block] * n), ca.vec(blocks))


def _bounds(task: Task, pieces: Pieces, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds of all unknowns: rest at both ends, and the duration if given."""
    lower = np.full((pieces.n_unknowns, task.robot.n_axes), -np.inf)
    upper = -lower
    lower[pieces.ends["angle"]] = upper[pieces.ends["angle"]] = task.start, task.end
    lower[pieces.ends["slope"]] = upper[pieces.ends["slope"]] = 0.0
    if task.duration is None:
        shortest, longest = _SHORTEST * duration, np.inf
    else:
        shortest = longest = task.duration
    return np.append(lower.T.ravel(), shortest), np.append(upper.T.ravel(), longest)
