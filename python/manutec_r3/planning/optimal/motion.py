"""The optimal motion of an arm: its arguments, what is returned, and the checks that it passes."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

import numpy as np

from ...arguments import Floats, angles, count, number, positive, positive_per_axis
from ...errors import OptimisationError
from ...files.missing import missing
from ...inputs import Input
from ...motion import PiecewisePolynomial
from ...robot import Robot
from ...simulation import simulate
from ..motor_limits import check_motors_are_known, gear_ratios, rate_limits, torque_limits

if TYPE_CHECKING:
    from .problem import Solution, Task

Effort = Literal["torque", "voltage"]

_EFFORT_UNITS = {"torque": "N^2 m^2 s", "voltage": "V^2 s"}
# The core, driven by the motor torques of an optimum, must arrive within this [rad].
_LARGEST_END_ERROR = 1e-6
# Of that run, which is to show the error of the motion, not its own.
_RUN_TOLERANCE = 1e-10
_LONGEST_RUN = 2.0  # [s]
# Gauss's points on a piece, for the integral of the effort; exact for polynomials of degree 11.
_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(6)


class SolverStatistics(NamedTuple):
    """How an optimum was found.

    Attributes
    ----------
    status : str
        Of the last solve, in the words of IPOPT.
    solves : int
        How often IPOPT ran: once for each start, then on finer meshes.
    iterations : int
        Of all solves.
    seconds : float
        Of all solves.
    pieces : int
        Of the motion.
    objectives : tuple of float
        What each start has led to on the first mesh; infinite where it has led nowhere.
    """

    status: str
    solves: int
    iterations: int
    seconds: float
    pieces: int
    objectives: tuple[float, ...]


@dataclass(frozen=True, eq=False, repr=False, init=False)
class OptimalMotion(PiecewisePolynomial):
    """What `optimal_motion` has found: a `PiecewisePolynomial`, with what is known about it.

    Attributes
    ----------
    robot : Robot
        Whose arm it is optimal for.
    effort : float
        Integral of the squared motor torques or volts, in `effort_unit`.
    effort_unit : str
        ``N^2 m^2 s`` or ``V^2 s``.
    torque_margins : ndarray (n_axes,)
        What the largest motor torque leaves of its limit [N m]; less than zero beyond it.
    rate_margins, angle_margins : ndarray (n_axes,)
        The same of the joint rates [rad/s] and angles [rad].
    defects : ndarray (n_axes,)
        Largest differences between its accelerations and those that the core's equations of motion
        give under the optimiser's torques [rad/s^2]: roundoff, because torques follow from the
        motion, at each point on any mesh. What a mesh is worth the margins tell, and `end_error`.
    statistics : SolverStatistics
        How it was found.
    """

    robot: Robot
    effort: float
    effort_unit: str
    torque_margins: np.ndarray
    rate_margins: np.ndarray
    angle_margins: np.ndarray
    defects: np.ndarray
    statistics: SolverStatistics

    def __init__(self, times: Floats, coefficients: np.ndarray, **facts: Any) -> None:
        super().__init__(times, coefficients)
        for fact in facts.values():
            if isinstance(fact, np.ndarray):
                fact.setflags(write=False)
        self._freeze(**facts)

    @cached_property
    def end_error(self) -> float:
        """By how much the core, driven by the motor torques alone, misses the end [rad].

        An arm that stands upright falls: roundoff grows more than twentyfold in a second. A motion
        of 3 s or more is driven in parts of about 2 s, each from the motion's own angles and rates,
        and this is the largest miss at the end of one.
        """
        robot = self.robot
        arm = Robot(
            1 if robot.n_axes == 6 else 2,
            load=robot.load,
            controller=None,
            rotor_coupling=robot.rotor_coupling,
            arm=robot.arm,
            table_1=robot.table_1,
            table_3=robot.table_3,
        )
        ends = np.linspace(0.0, self.duration, 1 + max(1, round(self.duration / _LONGEST_RUN)))
        return max(_miss(arm, self, begin, end) for begin, end in pairwise(ends.tolist()))

    def motor_torque(self, t: float | Floats) -> np.ndarray:
        """Motor torques that move the arm so, with ideal gears.

        Parameters
        ----------
        t : float or array_like (...)
            Instants [s].

        Returns
        -------
        ndarray (..., n_axes)
            Torques [N m], motor side.
        """
        tau = self.robot.inverse_dynamics(self.angle(t), self.rate(t), self.acceleration(t))
        return tau / gear_ratios(self.robot)


def optimal_motion(
    robot: Robot,
    start: Floats,
    end: Floats,
    duration: float | None = None,
    effort: Effort = "torque",
    effort_weight: float = 1e-5,
    torque_limit: float | Floats | None = None,
    rate_limit: float | Floats | None = None,
    torque_per_volt: float | Floats | None = None,
    *,
    angle_limit: float | Floats | None = None,
    smooth: bool = False,
    n_pieces: int = 40,
    starts: int = 1,
    limit_tolerance: float = 1e-3,
) -> OptimalMotion:
    """Find the motion from rest to rest with least effort, or with least time and effort.

    With ideal gears and without friction (specification section 6), the motor torques that a motion
    needs are ``rF = tau(q, qd, qdd) / p``. If the duration is given, their effort is minimised,
    ``int sum rF^2 dt``; if it is free, ``duration + effort_weight effort`` is: least time with a
    small weight, a smooth and slower motion with a larger one. Collocation at Radau's points, three
    on each piece, solved by IPOPT; the core's own equations are differentiated.

    Parameters
    ----------
    robot : Robot
        Model 1 to 4; gears, friction, controllers and motors are left out. Of models 3 and 4 rotors
        1 to 3 are coupled in the simplified way, unless one says otherwise (`rotor_coupling`).
    start, end : sequence of n_axes floats
        Joint angles [rad].
    duration : float, optional
        From start to end [s]; default: free.
    effort : {"torque", "voltage"}
        What is squared: motor torques, or motor torques over `torque_per_volt`.
    effort_weight : float
        If the duration is free: seconds that a unit of the effort is worth [s / (N^2 m^2 s) or
        s / (V^2 s)]. The default is small against the time, and large enough to keep axes still
        that have time left.
    torque_limit : float or sequence of n_axes floats, optional
        Of the motors, motor side [N m]; default: ``rF_max`` of Table 1.
    rate_limit : float or sequence of n_axes floats, optional
        Joint side [rad/s]; default: ``rotor_rate_max`` of Table 1 over the gear ratio.
    torque_per_volt : float or sequence of n_axes floats, optional
        Motor side [N m/V], for ``effort="voltage"``; default: ``K_M`` of Table 1. The literature on
        optimal control of this robot has 1.2 N m/V on axes 1 to 3.
    angle_limit : float or sequence of n_axes floats, optional
        Largest magnitude of the joint angles [rad]; default: ``joint_limits`` of Table 3.
    smooth : bool
        Whether accelerations are to be continuous, and zero at both ends: torques then do not jump,
        which real gears and controllers could not follow. They change from one to another within a
        piece, so that few pieces make a smooth motion.
    n_pieces : int
        Of the first mesh, which is refined where limits ask for it.
    starts : int
        The search is local. The first start is the straight line, further ones bow it at
        random, always the same; the best result is taken.
    limit_tolerance : float
        By how much of itself a limit may be exceeded between the points at which it is imposed.

    Returns
    -------
    OptimalMotion
        A motion like any other, with effort, margins and the solver's statistics.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    OptimisationError
        If no motion was found, if limits are exceeded by more than the tolerance, or if the core
        that is driven by the motor torques misses the end by more than 1e-6 rad.
    ImportError
        If CasADi is not installed.

    Examples
    --------
    >>> robot = r3.Robot(model=2, load=r3.Load(15.0))
    >>> motion = r3.optimal_motion(robot, [0, 0, 0], [1.0, 1.0, 0.6], n_pieces=10)
    >>> motion.duration < 0.8, motion.end_error < 1e-6
    (True, True)
    """
    try:
        from .search import optimum
    except ImportError:
        raise missing("casadi", "optimal_motion", "optimal") from None
    task = _task(
        robot,
        start,
        end,
        duration,
        effort,
        effort_weight,
        torque_limit,
        rate_limit,
        torque_per_volt,
        angle_limit,
        smooth,
    )
    tolerance = positive("limit_tolerance", limit_tolerance, "1")
    if tolerance >= 1.0:
        raise ValueError(f"limit_tolerance: expected a part of the limits, got {tolerance:g}")
    found = optimum(task, count("n_pieces", n_pieces, 2), count("starts", starts, 1), tolerance)
    solution = found.solution
    motion = OptimalMotion(
        solution.duration * solution.pieces.mesh,
        solution.pieces.coefficients(solution.unknowns),
        robot=robot,
        effort=solution.effort(task, 0.5 + 0.5 * _GAUSS_POINTS, 0.5 * _GAUSS_WEIGHTS),
        effort_unit=_EFFORT_UNITS[effort],
        **_margins(task, solution),
        defects=_defects(task, solution),
        statistics=SolverStatistics(
            solution.status,
            found.n_solves,
            found.iterations,
            found.seconds,
            solution.pieces.n,
            found.objectives,
        ),
    )
    if motion.end_error > _LARGEST_END_ERROR:
        raise OptimisationError(
            f"driven by the optimal torques the arm misses the end by {motion.end_error:.2g} rad, "
            f"expected at most {_LARGEST_END_ERROR:g} rad: try a larger n_pieces"
        )
    return motion


# --- at the door ----------------------------------------------------------------------------------


def _task(
    robot: Robot,
    start: Floats,
    end: Floats,
    duration: float | None,
    effort: Effort,
    effort_weight: float,
    torque_limit: float | Floats | None,
    rate_limit: float | Floats | None,
    torque_per_volt: float | Floats | None,
    angle_limit: float | Floats | None,
    smooth: bool,
) -> "Task":
    """Check the arguments; what is missing the robot's tables say."""
    from .problem import Task

    check_motors_are_known(robot)
    if not isinstance(effort, str) or effort not in get_args(Effort):
        raise ValueError(f"effort: expected 'torque' or 'voltage', got {effort!r}")
    if torque_per_volt is not None and effort != "voltage":
        raise ValueError(
            "torque_per_volt: expected with effort='voltage' only, got "
            f"{torque_per_volt!r} with effort={effort!r}"
        )
    if not isinstance(smooth, bool):
        raise TypeError(f"smooth: expected True or False, got {smooth!r}")
    weight = number("effort_weight", effort_weight, "s per unit of the effort")
    if weight < 0.0:
        raise ValueError(f"effort_weight: expected none below 0, got {weight:g}")
    n = robot.n_axes
    others = {
        "angle_limit": (angle_limit, "rad", robot.parameters["table_3"]["joint_limits"]),
        "torque_per_volt": (torque_per_volt, "N m/V", robot.parameters["table_1"]["K_M"]),
    }
    given = {
        name: np.array(usual[:n]) if value is None else positive_per_axis(name, value, unit, n)
        for name, (value, unit, usual) in others.items()
    }
    ends = {name: angles(name, value, n) for name, value in (("start", start), ("end", end))}
    for name, there in ends.items():
        for axis in np.flatnonzero(np.abs(there) > given["angle_limit"]):
            raise ValueError(
                f"{name} of axis {axis + 1}: expected an angle within "
                f"+-{given['angle_limit'][axis]:g} rad, got {there[axis]:g} rad"
            )
    if (ends["start"] == ends["end"]).all():
        raise ValueError(f"end: expected other angles than at the start [rad], got {end!r}")
    return Task(
        robot,
        ends["start"],
        ends["end"],
        None if duration is None else positive("duration", duration, "s"),
        time_weight=1.0 if duration is None else 0.0,
        effort_weight=weight if duration is None else 1.0,
        effort_scale=given["torque_per_volt"] if effort == "voltage" else np.ones(n),
        torque_limit=torque_limits(robot, torque_limit),
        rate_limit=rate_limits(robot, rate_limit),
        angle_limit=given["angle_limit"],
        smooth=smooth,
    )


# --- what is found out about a motion, by the core ------------------------------------------------


def _margins(task: "Task", solution: "Solution") -> dict[str, np.ndarray]:
    from .pieces import Points
    from .search import SAMPLES

    points = Points.on_all(solution.pieces.n, SAMPLES)
    q, qd, _ = solution.at(points)
    torque = solution.motor_torque(task, points)
    return {
        "torque_margins": task.torque_limit - np.abs(torque).max(axis=0),
        "rate_margins": task.rate_limit - np.abs(qd).max(axis=0),
        "angle_margins": task.angle_limit - np.abs(q).max(axis=0),
    }


def _defects(task: "Task", solution: "Solution") -> np.ndarray:
    from .dynamics import inverse_dynamics
    from .pieces import RADAU_POINTS, Points

    q, qd, qdd = solution.at(Points.on_all(solution.pieces.n, RADAU_POINTS))
    tau = inverse_dynamics(task.robot).map(len(q))(q.T, qd.T, qdd.T).full().T
    return np.abs(task.robot.forward_dynamics(q, qd, tau) - qdd).max(axis=0)


def _miss(arm: Robot, motion: OptimalMotion, begin: float, end: float) -> float:
    """Return by how much an arm, driven by the motor torques for a while, misses it [rad]."""
    knots = motion.knots[(motion.knots > begin) & (motion.knots < end)] - begin
    result = simulate(
        arm,
        None,
        t_end=end - begin,
        start=arm.state_from(joint_angle=motion.angle(begin), joint_rate=motion.rate(begin)),
        motor_torque=Input(lambda t: motion.motor_torque(begin + t), knots=knots),
        method="erk",
        rtol=_RUN_TOLERANCE,
    )
    return float(np.abs(result.joint_angle[-1] - motion.angle(end)).max())
