"""What an error of a run is: how far its signals are off, in parts of each axis' range."""

from collections.abc import Iterable, Sequence
from typing import Protocol

import numpy as np

from ..events import Event
from ..result import Result

# What a tolerance promises, with the same events: errors of these signals below `PROMISED`.
JUDGED = ("control_error", "motor_torque")
PROMISED = 1e-6


def ranges(values: np.ndarray) -> np.ndarray:
    """Range of each axis (n_axes,), at least 1e-3 of the largest axis'."""
    extent = np.ptp(values, axis=0)
    return np.maximum(extent, 1e-3 * extent.max())


def inside_steps(result: Result) -> np.ndarray:
    """Instants inside the steps of a run, ends included; of four thousand steps, if it has more.

    Backward differences take small steps after each sample or event: a hundred thousand instants
    say no more than these.
    """
    steps = np.unique(result.time)
    every = -(-len(steps) // 4000)
    begin, length = steps[:-1:every, None], np.diff(steps)[::every, None]
    return np.append((begin + length * [0.0, 0.21, 0.5, 0.83]).ravel(), steps[-1])


class Recorded(Protocol):
    """Signals at some instants, each an attribute (n, n_axes)."""

    @property
    def time(self) -> np.ndarray:
        """The instants (n,) [s]."""


def largest_errors(
    got: Recorded, exact: Result, signals: Sequence[str] = JUDGED
) -> dict[str, float]:
    """Largest error of each signal over all axes, in parts of the range of its axis.

    Parameters
    ----------
    got : Samples or alike
        Signals of a run at some instants.
    exact : Result
        The same run at a far tighter tolerance.
    signals : sequence of str
        Names of signals.
    """
    expected = exact.at(got.time)
    largest = {}
    for signal in signals:
        error = np.abs(getattr(got, signal) - getattr(expected, signal))
        # Friction of ideal gears has no range, and no error.
        scale = ranges(getattr(exact, signal))
        largest[signal] = float(np.divide(error, scale, out=error, where=error > 0.0).max())
    return largest


def sequence(events: Iterable[Event]) -> list[tuple[int, str, int, int]]:
    """Events without their times: (axis, element, before, after)."""
    return [event[1:] for event in events]
