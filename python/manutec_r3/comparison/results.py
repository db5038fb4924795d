"""Whether a result agrees with another, or with reference curves, and where they part.

Curves are judged as csv-compare of the Modelica Association does: around the reference `r` lies a
tube that reaches by `w` of its range to either side, in time and in value,

    min r(s) - w R <= y(t) <= max r(s) + w R    for |s - t| <= w (end - begin),

and the curve `y` must stay inside. So a jump at an event may come a little sooner or later. The
range `R` of an axis is its own, and at least 1e-3 of the largest axis'.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .. import plot as pictures
from ..arguments import number
from ..events import Events
from ..result import Result, Samples
from ..robot import Robot
from ..signals import signal_names, signal_unit
from .curves import CurveName, read_curves
from .events import EventComparison, compare_events

# What moves less is at rest: its range counts as this much in SI units. Of a robot that holds still
# the tolerance of the integrator leaves 1e-6 rad/s^2 and 1e-6 N m, half of the tube's 2e-6.
_SMALLEST_RANGE = 1e-3
# Into so many parts the time is divided, besides the instants that the results recorded.
_PARTS = 2000
# These are listed on request, and switch no branch.
_LISTED_ON_REQUEST = ("sample", "limit")


@dataclass(frozen=True, eq=False)
class CurveComparison:
    """A curve of one axis beside its reference.

    Attributes
    ----------
    signal : str
        Such as ``joint_angle``.
    axis : int
        1 to n_axes.
    unit : str
        Of the signal.
    range : float
        What deviations and the tube are relative to [unit].
    deviation : float
        Largest distance between both at one instant, away from events [unit]; NaN if no instant is
        away from events.
    instant : float
        Where that is [s].
    time, value, lower, upper : ndarray (n,)
        The curve, and the ends of the tube.
    reference_time, reference : ndarray (m,)
        The reference.
    difference_time, difference : ndarray (k,)
        Curve minus reference at the instants that both have; NaN near events.
    """

    signal: str
    axis: int
    unit: str
    range: float
    deviation: float
    instant: float
    time: np.ndarray = field(repr=False)
    value: np.ndarray = field(repr=False)
    lower: np.ndarray = field(repr=False)
    upper: np.ndarray = field(repr=False)
    reference_time: np.ndarray = field(repr=False)
    reference: np.ndarray = field(repr=False)
    difference_time: np.ndarray = field(repr=False)
    difference: np.ndarray = field(repr=False)

    @property
    def relative_deviation(self) -> float:
        """Largest deviation in parts of the range."""
        return self.deviation / self.range

    @property
    def outside(self) -> np.ndarray:
        """Where along `time` the curve is outside the tube (n,)."""
        return (self.value < self.lower) | (self.value > self.upper)

    @property
    def agrees(self) -> bool:
        """Whether the curve stays inside the tube."""
        return not self.outside.any()

    @property
    def leaves_at(self) -> float | None:
        """First instant outside the tube [s]; None if there is none."""
        return None if self.agrees else float(self.time[self.outside][0])


@dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` has found; printed, it says so in words.

    Attributes
    ----------
    curves : tuple of CurveComparison
        Signal by signal, axis by axis.
    events : EventComparison or None
        None if the reference has no list of events.
    begin, end : float
        What both have in common [s].
    width : float
        By how much the tubes reach to either side, in parts of the time and of each range.
    margin : float
        Pointwise deviations are those at instants further than this from all events [s].
    """

    curves: tuple[CurveComparison, ...]
    events: EventComparison | None
    begin: float
    end: float
    width: float
    margin: float

    @property
    def tube(self) -> float:
        """By how much the tubes reach to either side in time [s]."""
        return self.width * (self.end - self.begin)

    @property
    def agrees(self) -> bool:
        """Whether all curves stay inside their tubes and the events agree, if there are any."""
        return all(curve.agrees for curve in self.curves) and self.events_agree

    @property
    def events_agree(self) -> bool:
        """Whether the events come in the same sequence, no further apart than the tube reaches."""
        return self.events is None or (
            self.events.same_sequence and self.events.largest_time_difference <= self.tube
        )

    def curve(self, signal: str, axis: int) -> CurveComparison:
        """Return the comparison of one signal of one axis."""
        for curve in self.curves:
            if (curve.signal, curve.axis) == (signal, axis):
                return curve
        raise ValueError(f"{signal!r} of axis {axis!r} was not compared")

    def worst(self, n: int | None = None) -> list[CurveComparison]:
        """Return curves, those that leave their tubes first, then by their relative deviation.

        Parameters
        ----------
        n : int, optional
            How many; default: all.
        """
        return sorted(self.curves, key=lambda c: (not c.agrees, _relative(c)), reverse=True)[:n]

    plot = pictures.comparison  # takes a comparison first: a method as it is

    def __str__(self) -> str:
        lines = [
            f"{'agrees' if self.agrees else 'differs'} from {self.begin:g} to {self.end:g} s",
            f"curves: {sum(curve.agrees for curve in self.curves)} of {len(self.curves)} stay "
            f"inside the tube, {self.tube:.3g} s to either side in time",
        ]
        if self.events is None:
            lines.append("events: the reference has no list of them")
        else:
            lines.append("events: " + str(self.events).replace("\n", "\n        "))
        lines += ["", f"largest deviations more than {self.margin:.2g} s away from events:"]
        for signal in dict.fromkeys(curve.signal for curve in self.curves):
            lines.append("  " + _line([c for c in self.curves if c.signal == signal]))
        return "\n".join(lines)


def _relative(curve: CurveComparison) -> float:
    """Relative deviation, such that curves without one are the least."""
    return float(np.nan_to_num(curve.relative_deviation, nan=-1.0))


def _line(curves: list[CurveComparison]) -> str:
    """Describe all axes of a signal: the largest deviation, the axes that leave their tubes."""
    worst = max(curves, key=_relative)
    line = f"{worst.signal:24}"
    if worst.deviation == 0.0:
        line += "none"
    else:
        line += (
            f"{worst.deviation:.1e} {worst.unit:7} {worst.relative_deviation:7.1e} of the range, "
            f"axis {worst.axis} at {worst.instant:.6g} s"
        )
    left = {curve.axis: at for curve in curves if (at := curve.leaves_at) is not None}
    if left:
        axes = ", ".join(map(str, left))
        line += f"; outside: axis {axes} from {min(left.values()):.6g} s"
    return line


def compare(
    result: Result,
    reference: Result | str | Path,
    *,
    columns: Mapping[str, CurveName] | None = None,
    signals: Sequence[str] | None = None,
    axes: Sequence[int] | None = None,
    width: float = 2e-3,
) -> Comparison:
    """Compare a result with another, or with a file of reference curves.

    Compared is the time that both have in common. Curves of two results are compared at all steps
    of both and in between; with a file, at the instants of the file.

    Parameters
    ----------
    result : Result
        What is judged.
    reference : Result, str or Path
        What it is judged by; a path is that of a file of comma-separated values in SI units with
        one line of names. Its first column is the time, an instant that stands twice is a jump.
    columns : mapping of str to (str, int), optional
        What the columns of the file hold, such as ``{"axis1.phi": ("joint_angle", 1)}``; others are
        left out. Default: all columns, named such as ``joint_angle[1]``.
    signals : sequence of str, optional
        Signals of a result, or quantities of `Robot.state_names`. Default: all signals that both
        have.
    axes : sequence of int, optional
        Which axes, 1 to n_axes; events of the whole robot belong to each of them. Default: all.
    width : float
        By how much the tube reaches to either side, in parts of the time and of each range.

    Returns
    -------
    Comparison

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived.
    OSError
        If the file cannot be read.

    Notes
    -----
    Away from events means: further from all events of both than their instants differ. If their
    sequence differs, or if the reference has none but jumps, further than the tube is wide.

    A range below 1e-3 in SI units counts as that: what moves less is at rest.

    Examples
    --------
    >>> scenario = r3.Scenario.load("figure9-quintic")
    >>> comparison = r3.compare(scenario.run(), scenario.run(method="exponential"))
    >>> comparison.agrees, comparison.events.same_sequence
    (True, True)
    >>> comparison.curve("motor_torque", axis=2).relative_deviation < 1e-6
    True
    """
    if not isinstance(result, Result):
        raise TypeError(f"result: expected a Result, got {result!r}")
    if not isinstance(reference, Result | str | Path):
        raise TypeError(f"reference: expected a Result or the path of a file, got {reference!r}")
    width = number("width", width, "-")
    if not 0.0 < width < 1.0:
        raise ValueError(f"width: expected a part of the range between 0 and 1, got {width:g}")
    if isinstance(reference, Result):
        if columns is not None:
            raise ValueError("columns: expected none for a reference that is a Result")
        names = _names_of_results(result, reference, signals, axes)
        ours, theirs, instants = _traces_of_results(result, reference, names)
    else:
        time, curves = read_curves(reference, columns)
        names = _names_of_columns(result.robot, curves, signals, axes)
        ours, theirs, instants = _traces_of_columns(result, time, curves, names)

    begin, end = float(instants[0]), float(instants[-1])
    tube = width * (end - begin)
    events, margin, theirs_at = None, tube, theirs.jumps
    if isinstance(reference, Result):
        chosen = {axis for _, axis in names} | {0}
        lists = [_switches(run.events, chosen, begin, end) for run in (result, reference)]
        events, theirs_at = compare_events(*lists), lists[1].time
        if events.same_sequence:
            margin = min(tube, events.largest_time_difference)
    away = _away(instants, np.concatenate((result.events.time, theirs_at)), margin)
    return Comparison(
        tuple(_compare_curves(result.robot, names, ours, theirs, instants, away, tube, width)),
        events,
        begin,
        end,
        width,
        margin,
    )


# --- what is compared ---------------------------------------------------------------------------


def _names_of_results(
    result: Result, reference: Result, signals: Sequence[str] | None, axes: Sequence[int] | None
) -> list[CurveName]:
    robots = (result.robot, reference.robot)
    if axes is None and robots[0].n_axes != robots[1].n_axes:
        raise ValueError(
            f"axes: expected those to compare, as the robots have {robots[0].n_axes} and "
            f"{robots[1].n_axes} axes"
        )
    axes = _axes("axes", range(1, robots[0].n_axes + 1) if axes is None else axes, robots)
    if signals is None:
        signals = [s for s in signal_names if all(_is_finite(r, s) for r in (result, reference))]
    names = []
    for signal in _signals("signals", signals, robots):
        if signal in signal_names and not all(_is_finite(r, signal) for r in (result, reference)):
            raise ValueError(f"signals: expected what both results have, got {signal!r}")
        names += [(signal, a) for a in axes if all(_has(robot, signal, a) for robot in robots)]
    return _not_empty(names)


def _names_of_columns(
    robot: Robot,
    curves: Iterable[CurveName],
    signals: Sequence[str] | None,
    axes: Sequence[int] | None,
) -> list[CurveName]:
    for signal, axis in curves:
        _signals("columns", [signal], [robot])
        _axes("columns", [axis], [robot])
        if not _has(robot, signal, axis):
            raise ValueError(f"columns: expected an axis that has {signal!r}, got axis {axis}")
    wanted_signals = None if signals is None else _signals("signals", signals, [robot])
    wanted_axes = None if axes is None else _axes("axes", axes, [robot])
    return _not_empty(
        [
            (signal, axis)
            for signal, axis in curves
            if (wanted_signals is None or signal in wanted_signals)
            and (wanted_axes is None or axis in wanted_axes)
        ]
    )


def _not_empty(names: list[CurveName]) -> list[CurveName]:
    if not names:
        raise ValueError("signals, axes: expected curves that both sides have, there are none")
    return names


def _axes(argument: str, axes: Sequence[int], robots: Iterable[Robot]) -> list[int]:
    n = min(robot.n_axes for robot in robots)
    if isinstance(axes, str) or not isinstance(axes, Iterable):
        raise TypeError(f"{argument}: expected a sequence of integers, got {axes!r}")
    for axis in axes:
        if isinstance(axis, bool) or not isinstance(axis, int | np.integer):
            raise TypeError(f"{argument}: expected integers from 1 to {n}, got {axis!r}")
        if not 1 <= axis <= n:
            raise ValueError(f"{argument}: expected integers from 1 to {n}, got {axis}")
    return [int(axis) for axis in axes]


def _signals(argument: str, signals: Sequence[str], robots: Iterable[Robot]) -> list[str]:
    if isinstance(signals, str) or not isinstance(signals, Iterable):
        raise TypeError(f"{argument}: expected a sequence of names, got {signals!r}")
    for signal in signals:
        for robot in robots:
            states = dict.fromkeys(name.split("[")[0] for name in robot.state_names)
            if signal not in signal_names and signal not in states:
                known = ", ".join(dict.fromkeys((*signal_names, *states)))
                raise ValueError(f"{argument}: expected some of {known}; got {signal!r}")
    return list(signals)


def _has(robot: Robot, signal: str, axis: int) -> bool:
    return signal in signal_names or f"{signal}[{axis}]" in robot.state_names


def _is_finite(result: Result, signal: str) -> bool:
    """Whether a result has a signal: without a motion, for example, references are NaN."""
    return bool(np.isfinite(getattr(result, signal)).all())


def _switches(events: Events, axes: set[int], begin: float, end: float) -> Events:
    """Events between begin and end that both runs list, of some axes."""
    return Events(
        event
        for event in events
        if event.axis in axes
        and event.element not in _LISTED_ON_REQUEST
        and begin < event.time < end
    )


# --- the curves ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Traces:
    """Curves of one side, linear between instants; at a jump its instant stands twice."""

    time: np.ndarray  # (n,)
    values: np.ndarray  # (n, n_curves)

    @property
    def jumps(self) -> np.ndarray:
        return self.time[1:][np.diff(self.time) == 0.0]

    def at(self, instants: np.ndarray) -> np.ndarray:
        """Values at some of its own instants, at a jump those after it."""
        return self.values[np.searchsorted(self.time, instants, side="right") - 1]


def _traces_of_results(
    result: Result, reference: Result, names: list[CurveName]
) -> tuple[_Traces, _Traces, np.ndarray]:
    """Curves of two results, with the same instants but for jumps, and these instants."""
    end = min(result.t_end, reference.t_end)
    if end <= 0.0:
        raise ValueError(
            "expected results that have a time in common, got ends at "
            f"{result.t_end:g} and {reference.t_end:g} s"
        )
    even = np.linspace(0.0, end, 1 + _PARTS)
    instants = np.unique(np.concatenate((even, result.time, reference.time)))
    instants = instants[instants <= end]
    ours, theirs = (_recorded(run, names, instants) for run in (result, reference))
    return ours, theirs, instants


def _recorded(result: Result, names: list[CurveName], instants: np.ndarray) -> _Traces:
    """Return what was recorded, both sides of events, and the values at all other instants."""
    others = result.at(np.setdiff1d(instants, result.time))
    time = np.concatenate((result.time, others.time))
    values = np.concatenate([_values(part, result.robot, names) for part in (result, others)])
    order = np.argsort(time, kind="stable")
    order = order[time[order] <= instants[-1]]
    return _Traces(time[order], values[order])


def _traces_of_columns(
    result: Result,
    time: np.ndarray,
    curves: Mapping[CurveName, np.ndarray],
    names: list[CurveName],
) -> tuple[_Traces, _Traces, np.ndarray]:
    """Curves of a result at the instants of a file, those of the file, and these instants."""
    common = (time >= 0.0) & (time <= result.t_end)
    instants = np.unique(time[common])
    if len(instants) < 2:
        raise ValueError(
            f"reference: expected two instants or more from 0 to {result.t_end:g} s, "
            f"got {len(instants)} of those from {time[0]:g} to {time[-1]:g} s"
        )
    values = np.column_stack([curves[name] for name in names])
    samples = result.at(instants)
    ours = _Traces(instants, _values(samples, result.robot, names))
    return ours, _Traces(time[common], values[common]), instants


def _values(samples: Samples, robot: Robot, names: list[CurveName]) -> np.ndarray:
    """Curves (n, n_curves) of a result or of samples of it."""
    return np.column_stack([curve_of(samples, robot, *name) for name in names])


def curve_of(samples: Samples, robot: Robot, signal: str, axis: int) -> np.ndarray:
    """Return a signal of one axis, or a state by its quantity (n,)."""
    if signal in signal_names:
        return getattr(samples, signal)[:, axis - 1]
    return samples.state[:, robot.state_names.index(f"{signal}[{axis}]")]


# --- the comparison -----------------------------------------------------------------------------


def _compare_curves(
    robot: Robot,
    names: list[CurveName],
    ours: _Traces,
    theirs: _Traces,
    instants: np.ndarray,
    away: np.ndarray,
    tube: float,
    width: float,
) -> Iterable[CurveComparison]:
    ranges = _ranges(names, theirs.values)
    lower, upper = _tube(theirs, ours.time, tube)
    lower, upper = lower - width * ranges, upper + width * ranges
    difference = ours.at(instants) - theirs.at(instants)
    difference[~away] = np.nan
    for shared in (ours.time, theirs.time, instants):
        shared.flags.writeable = False
    for k, (signal, axis) in enumerate(names):
        arrays = (ours.values, lower, upper, theirs.values, difference)
        value, low, high, reference, deviations = (_frozen(array[:, k]) for array in arrays)
        furthest = np.argmax(np.where(away, np.abs(deviations), -1.0))
        yield CurveComparison(
            signal=signal,
            axis=axis,
            unit=_unit(robot, signal, axis),
            range=float(ranges[k]),
            deviation=float(np.abs(deviations[furthest])),
            instant=float(instants[furthest]) if away.any() else np.nan,
            time=ours.time,
            value=value,
            lower=low,
            upper=high,
            reference_time=theirs.time,
            reference=reference,
            difference_time=instants,
            difference=deviations,
        )


def _frozen(column: np.ndarray) -> np.ndarray:
    """Copy of a column that cannot be changed."""
    column = column.copy()
    column.flags.writeable = False
    return column


def _unit(robot: Robot, signal: str, axis: int) -> str:
    if signal in signal_names:
        return signal_unit(signal)
    return robot.state_units[robot.state_names.index(f"{signal}[{axis}]")]


def _ranges(names: list[CurveName], values: np.ndarray) -> np.ndarray:
    """Range of each curve, at least 1e-3 of that of the largest axis of the same signal."""
    own = np.ptp(values, axis=0)
    signals = np.array([signal for signal, _ in names])
    largest = np.array([own[signals == signal].max() for signal in signals])
    return np.maximum(np.maximum(own, 1e-3 * largest), _SMALLEST_RANGE)


def _tube(reference: _Traces, at: np.ndarray, tube: float) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest values of curves, linear between their instants, within +-tube of `at`."""
    # Extremes lie at instants of the reference or at the ends of a window: both in one table.
    begin, end = reference.time[[0, -1]]
    window = np.clip([at - tube, at + tube], begin, end)
    time = np.concatenate((reference.time, *window))
    values = np.concatenate((reference.values, *(_interpolate(reference, t) for t in window)))
    order = np.argsort(time, kind="stable")
    time, values = time[order], values[order]
    first = np.searchsorted(time, window[0], side="left")
    last = np.searchsorted(time, window[1], side="right")
    return (
        _extremes(np.minimum, values, first, last),
        _extremes(np.maximum, values, first, last),
    )


def _extremes(
    extreme: np.ufunc, values: np.ndarray, first: np.ndarray, last: np.ndarray
) -> np.ndarray:
    """Extremes of the rows from first to last, last excluded, of windows that overlap a lot."""
    # Two runs cover a window whose length is a power of two, the largest that fits into it.
    powers = np.frexp(last - first)[1] - 1
    found = np.empty((len(first), values.shape[1]))
    runs = values  # extremes of as many rows from each row on
    for power in range(powers.max() + 1):
        length, of_length = 1 << power, powers == power
        found[of_length] = extreme(runs[first[of_length]], runs[last[of_length] - length])
        runs = extreme(runs[:-length], runs[length:])
    return found


def _interpolate(curves: _Traces, t: np.ndarray) -> np.ndarray:
    before = np.searchsorted(curves.time, t, side="right") - 1
    before = np.minimum(before, len(curves.time) - 2)
    step = curves.time[before + 1] - curves.time[before]
    elapsed = t - curves.time[before]
    part = np.divide(elapsed, step, out=np.zeros_like(step), where=step > 0.0)[:, None]
    return (1.0 - part) * curves.values[before] + part * curves.values[before + 1]


def _away(instants: np.ndarray, events: np.ndarray, margin: float) -> np.ndarray:
    """Whether each instant is further than a margin from all events."""
    if not len(events):
        return np.ones(len(instants), bool)
    events = np.sort(events)
    after = np.searchsorted(events, instants)
    distance = np.abs(events[np.clip([after - 1, after], 0, len(events) - 1)] - instants)
    return distance.min(axis=0) > margin
