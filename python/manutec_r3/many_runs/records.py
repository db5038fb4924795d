"""What is kept of one of many runs: less than a `Result`, whose trajectory takes megabytes."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ..events import Events
from ..experiment import Method
from ..motion import Motion
from ..result import Statistics
from ..robot import Robot
from ..signals import Signals, signal_names

Record = Literal["all", "events", "final", "peaks"]


@dataclass(frozen=True, eq=False)
class RunRecord:
    """What every record of a run has.

    Attributes
    ----------
    robot : Robot
        What was simulated.
    motion : Motion or None
        Its reference.
    method : {"exponential", "erk", "bdf"}
        Integration method.
    rtol : float
        Its tolerance.
    t_end : float
        Where the run ended [s].
    statistics : Statistics
        What it took.
    status : str
        ``completed``, or why it ended before its time.
    """

    robot: Robot = field(repr=False)
    motion: Motion | None = field(repr=False)
    method: Method
    rtol: float
    t_end: float
    statistics: Statistics = field(repr=False)
    status: str


@dataclass(frozen=True, eq=False)
class EventRecord(RunRecord):
    """The events of a run.

    Attributes
    ----------
    events : Events
        As those of a `Result`.
    robot, motion, method, rtol, t_end, statistics, status
        As those of a `Result`.
    """

    events: Events


@dataclass(frozen=True, eq=False)
class FinalRecord(RunRecord, Signals):
    """Where a run ended: its signals at `t_end` are attributes, arrays (n_axes,).

    Attributes
    ----------
    signals : ndarray (n_signals, n_axes)
        All signals there.
    state : ndarray (n_states,)
        The state there.
    branches : dict of str to ndarray (n_axes,)
        The branch of each element there: -1, 0, +1.
    robot, motion, method, rtol, t_end, statistics, status
        As those of a `Result`.
    """

    signals: np.ndarray = field(repr=False)  # (n_signals, n_axes)
    state: np.ndarray = field(repr=False)
    branches: dict[str, np.ndarray] = field(repr=False)

    def _signal(self, name: str) -> np.ndarray:
        return self.signals[signal_names.index(name)]


@dataclass(frozen=True, eq=False)
class PeakRecord(RunRecord, Signals):
    """The largest magnitude of each signal of a run, on each axis: arrays (n_axes,).

    They are those of the instants that a `Result` has: ``record.motor_torque`` is bit by bit
    ``abs(result.motor_torque).max(axis=0)``. Instants are all steps of the integrator, or the
    `times` that were asked for, and events on both sides. A maximum between two steps is missed by
    what the signal changes there: of one that is smooth, by little.

    Attributes
    ----------
    signals : ndarray (n_signals, n_axes)
        All of these.
    robot, motion, method, rtol, t_end, statistics, status
        As those of a `Result`.
    """

    signals: np.ndarray = field(repr=False)  # (n_signals, n_axes)

    def _signal(self, name: str) -> np.ndarray:
        return self.signals[signal_names.index(name)]
