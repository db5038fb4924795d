"""Motions by the planners of others: along a given path, and with limited jerk.

Thin layers over TOPP-RA and Ruckig: ``pip install "manutec-r3[paths]"``. The core's own inverse
dynamics checks what they return.
"""

from typing import Any

import numpy as np

from ..arguments import Floats, PerAxis, angles, count, per_axis, positive_per_axis
from ..errors import OptimisationError
from ..files.missing import missing
from ..motion import PiecewisePolynomial
from ..robot import Robot
from .motor_limits import check_motors_are_known, gear_ratios, rate_limits, torque_limits

# By how much of it a limit may be exceeded. TOPP-RA keeps limits at its grid points; between them,
# with constant acceleration along the path, none of 200 random paths exceeded them by as much.
_EXCESS = 0.01
_SAMPLES_OF_PIECE = 11  # of a grid's short pieces, on which accelerations change hardly
# Between two waypoints, but not shorter than this part of the path: TOPP-RA rounds to 1e-8.
_LEAST_INTERVALS, _SHORTEST_INTERVAL = 50, 1e-4
_SHORTEST_CHORD = 1e-6  # [rad]
_SHORTEST_PIECE = 1e-12  # [s]: what rounding makes of two instants that are one

# Of x^0 to x^5: the quintic with given angles, slopes and bends at x = 0 and x = 1.
_HERMITE = np.linalg.inv(
    [
        [1, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 0],
        [0, 0, 2, 0, 0, 0],
        [1, 1, 1, 1, 1, 1],
        [0, 1, 2, 3, 4, 5],
        [0, 0, 2, 6, 12, 20],
    ]
)


def fastest_along(
    robot: Robot,
    waypoints: PerAxis,
    torque_limit: float | Floats | None = None,
    rate_limit: float | Floats | None = None,
    *,
    friction: bool = False,
    n_grid: int = 200,
) -> PiecewisePolynomial:
    """Find the fastest motion along a path, from rest to rest, by TOPP-RA.

    The path is the natural cubic spline through the waypoints over the length of its chords. Along
    it TOPP-RA finds the largest acceleration that motor torques, with ideal gears, and joint rates
    allow, constant on each interval of a grid.

    Parameters
    ----------
    robot : Robot
        Model 1 to 4.
    waypoints : array_like (n, n_axes)
        Joint angles [rad], two or more, each at least 1e-6 rad from the one before.
    torque_limit : float or sequence of n_axes floats, optional
        Of the motors, motor side [N m]; default: ``rF_max`` of Table 1.
    rate_limit : float or sequence of n_axes floats, optional
        Joint side [rad/s]; default: ``rotor_rate_max`` of Table 1 over the gear ratio.
    friction : bool
        Whether the motors are to overcome the friction of Table 2 as well. As much as it takes at
        most up to the rate limit is left of their torque for it.
    n_grid : int
        Number of intervals, and of pieces of the motion; more where it takes that to have 50 of
        them between two waypoints, or fewer between close ones.

    Returns
    -------
    PiecewisePolynomial

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    OptimisationError
        If no motion along the path is within the limits, or a limit, that of joint angles included,
        is exceeded by more than 1 % between grid points.
    ImportError
        If TOPP-RA is not installed.

    References
    ----------
    H. Pham, Q.-C. Pham: A New Approach to Time-Optimal Path Parameterization Based on Reachability
    Analysis, IEEE Transactions on Robotics 34 (2018).
    """
    try:
        import toppra
        from toppra.algorithm import TOPPRA
        from toppra.constraint import JointVelocityConstraint, SecondOrderConstraint
    except ImportError:
        raise missing("toppra", "fastest_along", "paths") from None
    limits = _Limits(robot, torque_limit, rate_limit, friction)
    points = _waypoints(waypoints, robot.n_axes)
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if chords.min() < _SHORTEST_CHORD:
        raise ValueError(
            f"waypoints: expected each at least {_SHORTEST_CHORD:g} rad from the one before, got "
            f"{chords.min():g} rad"
        )
    path = toppra.SplineInterpolator(np.append(0.0, np.cumsum(chords)), points, bc_type="natural")
    # What friction may take is left to it in both directions, also where it helps to brake.
    torque = limits.torque - limits.largest_friction()
    for axis in np.flatnonzero(torque <= 0.0):
        raise OptimisationError(f"friction of axis {axis + 1} takes all of the motor torque")
    constraints = [
        JointVelocityConstraint(np.column_stack((-limits.rate, limits.rate))),
        SecondOrderConstraint.joint_torque_constraint(
            limits.motor_torque, np.column_stack((-torque, torque)), np.zeros(robot.n_axes)
        ),
    ]
    grid = _grid(chords, count("n_grid", n_grid, 2))
    _, speed, _ = TOPPRA(constraints, path, gridpoints=grid).compute_parameterization(0.0, 0.0)
    if speed is None or not np.isfinite(speed).all():
        raise OptimisationError("TOPP-RA found no motion along the path within the limits")
    motion = _along(path, grid, speed)
    limits.check(motion)
    return motion


def jerk_limited_motion(
    robot: Robot,
    start: Floats,
    end: Floats,
    acceleration_limit: float | Floats,
    jerk_limit: float | Floats,
    torque_limit: float | Floats | None = None,
    rate_limit: float | Floats | None = None,
    *,
    friction: bool = False,
) -> PiecewisePolynomial:
    """Find the fastest motion from rest to rest with limited rates, accelerations, jerks by Ruckig.

    All axes arrive at once. Their accelerations are continuous; pieces are cubic.

    Parameters
    ----------
    robot : Robot
        Model 1 to 4.
    start, end : sequence of n_axes floats
        Joint angles [rad].
    acceleration_limit, jerk_limit : float or sequence of n_axes floats
        Joint side [rad/s^2, rad/s^3].
    torque_limit, rate_limit, friction
        See `fastest_along`. Torques are not planned, only checked.

    Returns
    -------
    PiecewisePolynomial

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    OptimisationError
        If a motor torque or joint angle is beyond its limit by more than 1 %, or Ruckig fails.
    ImportError
        If Ruckig is not installed.

    References
    ----------
    L. Berscheid, T. Kroeger: Jerk-limited Real-time Trajectory Generation with Arbitrary Target
    States, Robotics: Science and Systems XVII (2021).
    """
    try:
        import ruckig
    except ImportError:
        raise missing("ruckig", "jerk_limited_motion", "paths") from None
    limits = _Limits(robot, torque_limit, rate_limit, friction)
    n = robot.n_axes
    task = ruckig.InputParameter(n)
    for place, name, value in (("current", "start", start), ("target", "end", end)):
        setattr(task, f"{place}_position", angles(name, value, n).tolist())
    task.max_velocity = limits.rate.tolist()
    for name, limit, unit in (
        ("acceleration", acceleration_limit, "rad/s^2"),
        ("jerk", jerk_limit, "rad/s^3"),
    ):
        each = positive_per_axis(f"{name}_limit", limit, unit, n)
        setattr(task, f"max_{name}", each.tolist())
    fast = ruckig.Trajectory(n)
    try:
        found = ruckig.Ruckig(n).calculate(task, fast) == ruckig.Result.Working
    except (ValueError, RuntimeError):  # a result without a name; numbers beyond its means
        found = False
    if not found:
        raise OptimisationError(f"Ruckig found no motion from {start!r} to {end!r}")
    if fast.duration == 0.0:
        raise ValueError(f"end: expected other angles than at the start [rad], got {end!r}")
    motion = _cubics(fast, np.array(task.target_position))
    limits.check(motion)
    return motion


class _Limits:
    """Of motor torques and joint rates; arrays (n_axes,)."""

    def __init__(
        self,
        robot: Robot,
        torque: float | Floats | None,
        rate: float | Floats | None,
        friction: bool,
    ) -> None:
        check_motors_are_known(robot)
        if not isinstance(friction, bool):
            raise TypeError(f"friction: expected True or False, got {friction!r}")
        self.robot = robot
        self.torque = torque_limits(robot, torque)
        self.rate = rate_limits(robot, rate)
        self.angle = np.array(robot.parameters["table_3"]["joint_limits"][: robot.n_axes])
        self.friction = friction
        self._gear_ratio = gear_ratios(robot)

    def motor_torque(self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> np.ndarray:
        """Return torques (..., n_axes) [N m] with ideal gears."""
        return self.robot.inverse_dynamics(q, qd, qdd) / self._gear_ratio

    def friction_at(self, qd: np.ndarray) -> np.ndarray:
        """Return what friction takes at joint rates (..., n_axes), motor side [N m]."""
        if not self.friction:
            return np.zeros_like(qd)
        return self.robot.sliding_friction(self._gear_ratio * qd)

    def largest_friction(self) -> np.ndarray:
        """Return what friction takes at most up to the rate limits (n_axes,), motor side [N m]."""
        largest = np.abs(self.friction_at(self.rate))
        if self.friction:  # between rest and the limit its corners are what is largest
            rotor_rate = np.abs(self._gear_ratio * self.rate)
            table = self.robot.parameters["table_2"]["friction"]
            for axis, points in enumerate(table[: len(largest)]):
                corners = [torque for rate, torque in points if rate <= rotor_rate[axis]]
                largest[axis] = max(largest[axis], *corners)
        return largest

    def check(self, motion: PiecewisePolynomial) -> None:
        """Refuse a motion that is beyond a limit."""
        x = np.linspace(0.0, 1.0, _SAMPLES_OF_PIECE)[:-1]
        t = (motion.knots[:-1, None] + np.diff(motion.knots)[:, None] * x).ravel()
        q, qd = motion.angle(t), motion.rate(t)
        torque = self.motor_torque(q, qd, motion.acceleration(t))
        for what, values, limit, unit in (
            ("angle", q, self.angle, "rad"),
            ("motor torque", torque + self.friction_at(qd), self.torque, "N m"),
            ("joint rate", qd, self.rate, "rad/s"),
        ):
            largest = np.abs(values).max(axis=0)
            for axis in np.flatnonzero(largest > (1.0 + _EXCESS) * limit):
                raise OptimisationError(
                    f"{what} of axis {axis + 1}: expected at most {limit[axis]:g} {unit}, the "
                    f"motion takes {largest[axis]:.4g} {unit}"
                )


def _waypoints(waypoints: PerAxis, n_axes: int) -> np.ndarray:
    points = per_axis("waypoints", waypoints, "rad", n_axes)
    if points.ndim != 2 or len(points) < 2:
        raise ValueError(
            f"waypoints: expected shape (n, {n_axes}), two or more rows of angles [rad], got "
            f"shape {points.shape}"
        )
    return points


def _grid(chords: np.ndarray, n: int) -> np.ndarray:
    """Return about n + 1 points along chords (n_chords,), their ends among them."""
    ends = np.append(0.0, np.cumsum(chords))
    least = np.clip(chords / (_SHORTEST_INTERVAL * ends[-1]), 1, _LEAST_INTERVALS)
    shares = np.maximum(least, np.round(n * chords / ends[-1])).astype(int)
    parts = [
        np.linspace(a, b, share, endpoint=False)
        for a, b, share in zip(ends[:-1], ends[1:], shares, strict=True)
    ]
    return np.append(np.concatenate(parts), ends[-1])


def _along(path: Any, grid: np.ndarray, speed: np.ndarray) -> PiecewisePolynomial:
    """Follow a path with given speeds at grid points, and constant accelerations between them.

    Pieces are quintic, with the angles, rates and accelerations at the ends of intervals.
    """
    ds = np.diff(grid)
    length = 2.0 * ds / (speed[:-1] + speed[1:])
    acceleration = np.diff(speed**2) / (2.0 * ds)
    h = length[:, None]
    at_ends = []
    for side in (slice(None, -1), slice(1, None)):
        s, rate = grid[side], speed[side, None]
        bend = path(s, 2) * rate**2 + path(s, 1) * acceleration[:, None]
        at_ends += [path(s), h * path(s, 1) * rate, h**2 * bend]
    times = np.append(0.0, np.cumsum(length))
    return PiecewisePolynomial(times, np.einsum("pe,ena->npa", _HERMITE, at_ends))


def _cubics(fast: Any, end: np.ndarray) -> PiecewisePolynomial:
    """Return cubic pieces between all instants at which a jerk changes; the last meets the end."""
    ends = [np.cumsum([0.0, *profile.t]) for profile in fast.profiles[0]]
    times = np.unique(np.concatenate(ends).clip(max=fast.duration))
    times = times[np.append(True, np.diff(times) > _SHORTEST_PIECE)]
    middle = [fast.at_time(t) for t in (times[:-1] + times[1:]) / 2.0]
    angle, rate, acceleration = np.moveaxis(np.array(middle), 1, 0)
    h = np.diff(times)[:, None]
    jerk = np.array([_jerk(fast, t) for t in (times[:-1] + times[1:]) / 2.0])
    # From the middle of a piece, at x = 1/2, to its beginning.
    a0 = acceleration - jerk * h / 2
    v0 = rate - acceleration * h / 2 + jerk * h**2 / 8
    q0 = angle - rate * h / 2 + acceleration * h**2 / 8 - jerk * h**3 / 48
    pieces = np.stack((q0, v0 * h, a0 * h**2 / 2, jerk * h**3 / 6), axis=1)
    pieces[-1, 3] += end - pieces[-1].sum(axis=0)  # roundoff of Ruckig's
    return PiecewisePolynomial(times, pieces)


def _jerk(fast: Any, t: float) -> list[float]:
    return [p.j[int(np.searchsorted(np.cumsum(p.t), t))] for p in fast.profiles[0]]
