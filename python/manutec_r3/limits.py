"""Limits that are watched beside a run and never disturb it (specification section 8).

    joint_angle       |aq|                         beyond |aq|_max of Table 3
    rotor_rate        |rq'|                        beyond |rq'|_max of Table 1
    nominal_torque    sqrt(1/t int_0^t rF^2 dt)    beyond |rF|_nom of Table 1: continuous operation
    saturation        time at the torque limit     beyond 0.05 s: then the rate controller winds up

Inside a step of the integrator each is smooth. It is sampled there at Gauss-Lobatto nodes, which
integrate it to roundoff and show where it turns. Between nodes and turning points it is monotone,
so that an excess is found even if it begins and ends between two steps; both instants are found by
bisection on the dense output.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import Legendre, legval

from . import _core
from .events import Event

if TYPE_CHECKING:
    from .robot import Robot

    # From instants (n,) and the steps (n,) they belong to: signals, or one of them (n, n_axes).
    SamplesInside = Callable[[np.ndarray, np.ndarray], Any]  # Samples of a run
    Inside = Callable[[np.ndarray, np.ndarray], np.ndarray]

# A motor that is at its torque limit for longer than this is told [s]: longer than the slowest time
# constant of the rate controllers, `T_a` = 0.04 s.
_SUSTAINED = 0.05
# What is beyond a limit by no more than this, relative to the limit, rests at it but for roundoff.
_ROUNDOFF = 1e-13
# A quantity that gets beyond its limit between two nodes is beyond this part of it at one of them:
# the accuracy of the steps leaves it no time for more.
_NEAR = 0.8
# As many bring any step down to the last digit of time.
_HALVINGS = 53
# So many steps are evaluated at a time, lest a long run should fill the memory.
_BLOCK = 4096

# Gauss-Lobatto nodes of a step, from 0 to 1: they integrate polynomials of degree 11. From values
# there the matrices make the Legendre series through them, and its slopes and its integrals from 0
# at the nodes.
_N_NODES = 7
_NODES = np.concatenate(
    ([0.0], Legendre.basis(_N_NODES - 1, domain=[0.0, 1.0]).deriv().roots(), [1.0])
)
_LEGENDRE = [Legendre.basis(degree, domain=[0.0, 1.0]) for degree in range(_N_NODES)]
_SERIES = np.linalg.inv(np.column_stack([P(_NODES) for P in _LEGENDRE]))
_SLOPE = np.column_stack([P.deriv()(_NODES) for P in _LEGENDRE]) @ _SERIES
_INTEGRAL = np.column_stack([P.integ(lbnd=0.0)(_NODES) for P in _LEGENDRE]) @ _SERIES

_UNITS = {"joint_angle": "rad", "rotor_rate": "rad/s", "nominal_torque": "N m", "saturation": "s"}
_WORDS = {"nominal_torque": "root mean square of the motor torque"}


class LimitExcess(NamedTuple):
    """A limit was exceeded for a while.

    Attributes
    ----------
    what : str
        ``joint_angle``, ``rotor_rate``, ``nominal_torque`` (root mean square of the motor torque
        since the start) or ``saturation`` (time for which the motor has been at its torque limit).
    axis : int
        1 to n_axes.
    begin, end : float
        From when to when [s]; the ends of the run if it began or ended beyond the limit. A
        saturation is told from the instant at which it has lasted too long.
    side : int
        -1, +1: the sign of what was too large; of a saturation, that of the torque.
    limit : float
        In `unit`, as in the tables of `Robot.parameters`; of a saturation 0.05 s.
    peak : float
        The largest magnitude that was reached, in `unit`.
    """

    what: str
    axis: int
    begin: float
    end: float
    side: int
    limit: float
    peak: float

    @property
    def unit(self) -> str:
        """Unit of `limit` and `peak`."""
        return _UNITS[self.what]

    def __str__(self) -> str:
        words = _WORDS.get(self.what, self.what.replace("_", " "))
        return f"{words} of axis {self.axis} beyond {self.limit:g} {self.unit}"


def limit_excesses(
    robot: "Robot", trajectory: _core.Trajectory, samples: "SamplesInside"
) -> tuple[LimitExcess, ...]:
    """Find where a run is beyond a limit.

    Parameters
    ----------
    robot : Robot
        Its tables have the limits.
    trajectory : Trajectory
        The steps of the run.
    samples : callable
        Signals at instants (n,) inside the steps (n,) that they belong to.

    Returns
    -------
    tuple of LimitExcess
        In the order of their beginnings.
    """
    motors, arms = robot.parameters["table_1"], robot.parameters["table_3"]
    steps = _Steps(robot.n_axes, trajectory, samples)
    found = [*steps.beyond("joint_angle", arms["joint_limits"]), *steps.saturated()]
    if "rF_nom" in motors:  # of the Modelica variant no limits of motors are known
        found += steps.beyond("rotor_rate", motors["rotor_rate_max"])
        found += steps.beyond_nominal_torque(motors["rF_nom"])
    return tuple(sorted(found, key=lambda excess: excess.begin))


def limit_events(excesses: tuple[LimitExcess, ...], t_end: float) -> list[Event]:
    """Return beginnings and ends inside (0, t_end) as events, which are not sorted."""
    events = []
    for excess in excesses:
        events.append(Event(excess.begin, excess.axis, "limit", 0, excess.side))
        events.append(Event(excess.end, excess.axis, "limit", excess.side, 0))
    return [event for event in events if 0.0 < event.time < t_end]


class _Steps:
    """The steps of a run and what is watched at their nodes: arrays (n_steps, n_nodes, n_axes)."""

    def __init__(self, n_axes: int, trajectory: _core.Trajectory, samples: "SamplesInside") -> None:
        self._samples = samples
        self.begin, self.end = trajectory.begin, trajectory.end
        self.size = self.end - self.begin
        self.time = self.begin[:, None] + self.size[:, None] * _NODES
        self.time[:, -1] = self.end
        self.at_nodes = {
            signal: np.empty((*self.time.shape, n_axes))
            for signal in ("joint_angle", "rotor_rate", "motor_torque")
        }
        self.torque_limit = np.empty((len(self.begin), n_axes), int)  # its branch in each step
        for first in range(0, len(self.begin), _BLOCK):
            block = slice(first, first + _BLOCK)
            step = np.arange(len(self.begin))[block]
            now = samples(self.time[block].ravel(), np.repeat(step, _N_NODES))
            for signal, values in self.at_nodes.items():
                values[block] = getattr(now, signal).reshape(len(step), _N_NODES, n_axes)
            self.torque_limit[block] = now.branches["torque_limit"][::_N_NODES]

    def beyond(self, signal: str, limit: Sequence[float]) -> list[LimitExcess]:
        """Find where a signal is beyond its limits, one for each axis."""

        def inside(time: np.ndarray, step: np.ndarray) -> np.ndarray:
            return getattr(self._samples(time, step), signal)

        return self._beyond(signal, np.array(limit), self.at_nodes[signal], inside)

    def beyond_nominal_torque(self, nominal: Sequence[float]) -> list[LimitExcess]:
        """Find where the root mean square of the motor torque is beyond its limits.

        What is integrated is `rF^2 - |rF|_nom^2`, so that a motor at its nominal torque is not
        beyond it by roundoff.
        """
        square = np.square(nominal[: self.torque_limit.shape[1]])
        surplus = self.at_nodes["motor_torque"] ** 2 - square
        of_step = self.size[:, None] * (_INTEGRAL[-1] @ surplus)
        before = np.cumsum(of_step, axis=0) - of_step

        def mean(integral: np.ndarray, time: np.ndarray, at_once: np.ndarray) -> np.ndarray:
            elapsed = np.maximum(time, np.finfo(float).tiny)
            return square + np.where(time > 0.0, integral / elapsed, at_once)

        def inside(time: np.ndarray, step: np.ndarray) -> np.ndarray:
            size = (time - self.begin[step])[:, None]
            nodes = self.begin[step, None] + size * _NODES
            now = self._samples(nodes.ravel(), np.repeat(step, _N_NODES))
            surplus = now.motor_torque.reshape(*nodes.shape, len(square)) ** 2 - square
            integral = before[step] + size * (_INTEGRAL[-1] @ surplus)
            return mean(integral, time[:, None], surplus[:, 0])

        integral = before[:, None] + self.size[:, None, None] * (_INTEGRAL @ surplus)
        at_nodes = mean(integral, self.time[:, :, None], surplus)
        return [
            excess._replace(limit=float(np.sqrt(excess.limit)), peak=float(np.sqrt(excess.peak)))
            for excess in self._beyond("nominal_torque", square, at_nodes, inside)
        ]

    def saturated(self) -> list[LimitExcess]:
        """Find motors that are at their torque limit for too long without a break."""
        found = []
        for axis, branch in enumerate(self.torque_limit.T, start=1):
            for side in (-1, 1):
                for first, last in _stretches(branch == side):
                    begin, end = float(self.begin[first]), float(self.end[last])
                    too_long = begin + _SUSTAINED
                    if too_long < end:
                        told = ("saturation", axis, too_long, end, side, _SUSTAINED, end - begin)
                        found.append(LimitExcess(*told))
        return found

    def _beyond(
        self, what: str, limits: np.ndarray, at_nodes: np.ndarray, inside: "Inside"
    ) -> list[LimitExcess]:
        """Find where a quantity, which is smooth in each step, is beyond its limits."""
        n_axes = at_nodes.shape[-1]
        limit = limits[:n_axes]
        turning_time, turning_step, turning_axis = self._turning_points(at_nodes, _NEAR * limit)
        turning = inside(turning_time, turning_step)[np.arange(len(turning_axis)), turning_axis]
        found = []
        for axis in range(n_axes):
            own = turning_axis == axis
            time = np.append(self.time, turning_time[own])
            step = np.append(np.repeat(np.arange(len(self.begin)), _N_NODES), turning_step[own])
            value = np.append(at_nodes[:, :, axis], turning[own])
            order = np.lexsort((time, step))
            knots = _Knots(time[order], step[order], value[order])
            found += _excesses(what, axis, float(limit[axis]), knots, inside)
        return found

    def _turning_points(
        self, at_nodes: np.ndarray, near: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Instants, steps and axes at which a quantity turns, if it is as large as `near`."""
        slope = _SLOPE @ at_nodes
        large = np.abs(at_nodes) > near
        turns = (slope[:, :-1] * slope[:, 1:] < 0.0) & (large[:, :-1] | large[:, 1:])
        step, node, axis = np.nonzero(turns)
        series = (_SERIES @ slope)[step, :, axis].T
        rises = slope[step, node, axis] > 0.0
        inside = _outermost(
            lambda x: (legval(2.0 * x - 1.0, series, tensor=False) > 0.0) == rises,
            _NODES[node],
            _NODES[node + 1],
        )
        return self.begin[step] + self.size[step] * inside, step, axis


class _Knots(NamedTuple):
    """Instants (n,) of one axis in their order; between them a quantity is monotone."""

    time: np.ndarray
    step: np.ndarray
    value: np.ndarray


def _excesses(
    what: str, axis: int, limit: float, knots: _Knots, inside: "Inside"
) -> list[LimitExcess]:
    """Find where one axis, counted from 0, is beyond its limit."""
    threshold = limit * (1.0 + _ROUNDOFF)
    stretches = _stretches(np.abs(knots.value) > threshold)
    if not stretches:
        return []
    # Each stretch ends between its last knot and the next, or where a step ends; begins likewise.
    first, last = np.transpose(stretches)
    beyond = np.concatenate((first, last))
    within = np.concatenate((first - 1, last + 1)).clip(0, len(knots.time) - 1)
    step = knots.step[beyond]
    begins_ends = _outermost(
        lambda t: np.abs(inside(t, step)[:, axis]) > threshold,
        knots.time[beyond],
        np.where(knots.step[within] == step, knots.time[within], knots.time[beyond]),
    )
    begin, end = begins_ends.reshape(2, -1).tolist()
    found = []
    for k, (a, b) in enumerate(stretches):
        side = int(np.sign(knots.value[a]))
        peak = float(np.abs(knots.value[a : b + 1]).max())
        found.append(LimitExcess(what, axis + 1, begin[k], end[k], side, limit, peak))
    return found


def _stretches(holds: np.ndarray) -> list[tuple[int, int]]:
    """First and last index of each stretch in which something holds."""
    edges = np.flatnonzero(np.diff(holds, prepend=False, append=False))
    return list(zip(edges[::2], edges[1::2] - 1, strict=True))


def _outermost(
    holds: Callable[[np.ndarray], np.ndarray], begin: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """Find how far something holds that holds at `begin` and no more at `end`, by bisection."""
    for _ in range(_HALVINGS):
        middle = begin + (end - begin) / 2.0
        still = holds(middle)
        begin, end = np.where(still, middle, begin), np.where(still, end, middle)
    return begin
