"""Reference motions: the joint angles that the controllers are to follow."""

import weakref
from abc import ABC, abstractmethod
from collections import abc
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, html
from .arguments import Floats, PerAxis, floats, number, numbers


class Motion(ABC):
    """What all motions have in common.

    Use `Quintic`, `Trapezoid`, `Spline`, `PiecewisePolynomial`, `Hold`, a `Sequence` of them, or a
    `FunctionMotion`.

    A motion begins at 0 s; before, it rests at its start. It is immutable, comparable, picklable.
    At its knots it is right-continuous.
    """

    if TYPE_CHECKING:  # a field of some motions, others compute it

        @property
        def duration(self) -> float:
            """Time from start to end [s]."""

    @property
    @abstractmethod
    def _compiled(self) -> _core.Motion:
        """The motion in the core."""

    def __getstate__(self) -> dict:
        return {name: value for name, value in self.__dict__.items() if name != "_compiled"}

    def _freeze(self, **fields: object) -> None:
        """Set fields of a frozen dataclass, then check them all by building the core's motion."""
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        _ = self._compiled

    @property
    def n_axes(self) -> int:
        """Number of axes: 1, 3 or 6."""
        return self._compiled.n_axes

    @property
    def knots(self) -> np.ndarray:
        """Instants at which the motion is not smooth [s]."""
        return self._compiled.knots

    def angle(self, t: float | Floats) -> np.ndarray:
        """Joint angles at time(s) `t` [s].

        Returns
        -------
        ndarray (..., n_axes)
            Angles [rad], for `t` of shape (...).
        """
        return self._evaluate(t, lambda t: self._compiled.reference(t)[0])

    def rate(self, t: float | Floats) -> np.ndarray:
        """Joint rates at time(s) `t` [s].

        Returns
        -------
        ndarray (..., n_axes)
            Rates [rad/s], for `t` of shape (...).
        """
        return self._evaluate(t, lambda t: self._compiled.reference(t)[1])

    def acceleration(self, t: float | Floats) -> np.ndarray:
        """Joint accelerations at time(s) `t` [s].

        Returns
        -------
        ndarray (..., n_axes)
            Accelerations [rad/s^2], for `t` of shape (...).
        """
        return self._evaluate(t, self._compiled.acceleration)

    def _repr_html_(self) -> str:
        ends = np.transpose([self.angle(0.0), self.angle(self.duration)]).tolist()
        return html.table(
            f"{type(self).__name__}: {self.duration:g} s, knots at "
            + ", ".join(f"{knot:.6g}" for knot in self.knots)
            + " s",
            ("axis", "start [rad]", "end [rad]"),
            ((axis, *row) for axis, row in enumerate(ends, start=1)),
        )

    def _evaluate(
        self, t: float | Floats, function: Callable[[np.ndarray], np.ndarray]
    ) -> np.ndarray:
        instants = floats("t", t, "s")
        return function(instants.ravel()).reshape(*instants.shape, self.n_axes)


def _tuple(name: str, values: Floats, unit: str) -> tuple[float, ...]:
    array = numbers(name, values, f"1, 3 or 6 numbers [{unit}], one per axis")
    if array.ndim != 1:
        raise ValueError(
            f"{name}: expected 1, 3 or 6 values [{unit}], one per axis, got shape {array.shape}"
        )
    return tuple(array.tolist())


def _instants(name: str, values: Floats) -> tuple[float, ...]:
    array = numbers(name, values, "instants [s]")
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a list of instants [s], got shape {array.shape}")
    return tuple(array.tolist())


@dataclass(frozen=True)
class Quintic(Motion):
    """From rest to rest with zero acceleration at both ends, on all axes at once.

    ``start + (end - start) (10 x^3 - 15 x^4 + 6 x^5)`` with ``x = t / duration``.

    Parameters
    ----------
    start, end : sequence of 1, 3 or 6 floats
        Joint angles [rad].
    duration : float
        Time from start to end [s], positive.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.

    Examples
    --------
    >>> motion = r3.Quintic(start=[0.0, 0.0, 0.0], end=[1.0, 0.5, -0.5], duration=1.2)
    >>> motion.angle([0.0, 0.6, 1.2])
    array([[ 0.  ,  0.  ,  0.  ],
           [ 0.5 ,  0.25, -0.25],
           [ 1.  ,  0.5 , -0.5 ]])
    >>> motion.knots
    array([0. , 1.2])
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    duration: float

    def __init__(self, start: Floats, end: Floats, duration: float) -> None:
        self._freeze(
            start=_tuple("start", start, "rad"),
            end=_tuple("end", end, "rad"),
            duration=number("duration", duration, "s"),
        )

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.quintic(self.start, self.end, self.duration)


@dataclass(frozen=True, repr=False)
class Trapezoid(Motion):
    """Synchronised trapezoid of rates: constant acceleration, rate, deceleration.

    The slowest axis leads, the others keep pace with it. If the largest rate is not reached, the
    trapezoid is a triangle.

    Parameters
    ----------
    start, end : sequence of 1, 3 or 6 floats
        Joint angles [rad].
    rate : sequence of floats
        Largest joint rates [rad/s], positive.
    acceleration : sequence of floats
        Largest joint accelerations [rad/s^2], positive.

    Attributes
    ----------
    rate_limit, acceleration_limit : tuple of float
        The last two arguments.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.

    Examples
    --------
    >>> motion = r3.Trapezoid(start=[0] * 3, end=[1, 0.5, 0], rate=[2] * 3, acceleration=[10] * 3)
    >>> round(motion.duration, 12)
    0.7
    >>> motion.rate(motion.duration / 2).round(12)
    array([2., 1., 0.])
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    rate_limit: tuple[float, ...]
    acceleration_limit: tuple[float, ...]

    def __init__(
        self,
        start: Floats,
        end: Floats,
        rate: Floats,
        acceleration: Floats,
    ) -> None:
        self._freeze(
            start=_tuple("start", start, "rad"),
            end=_tuple("end", end, "rad"),
            rate_limit=_tuple("rate", rate, "rad/s"),
            acceleration_limit=_tuple("acceleration", acceleration, "rad/s^2"),
        )

    def __repr__(self) -> str:
        return (
            f"Trapezoid(start={self.start}, end={self.end}, rate={self.rate_limit}, "
            f"acceleration={self.acceleration_limit})"
        )

    @property
    def duration(self) -> float:
        """Time from start to end [s]."""
        return self._compiled.duration

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.trapezoid(self.start, self.end, self.rate_limit, self.acceleration_limit)


@dataclass(frozen=True)
class Spline(Motion):
    """The cubic spline through given angles: accelerations are continuous.

    It rests at the first angles until the first time, begins and ends with zero rate, and rests at
    the last angles from the last time on. Every time is a knot.

    Parameters
    ----------
    times : sequence of n floats
        Instants [s], at least two, ascending, the first not before 0.
    angles : array_like (n, n_axes)
        Joint angles [rad] at these instants, for 1, 3 or 6 axes.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.

    Examples
    --------
    >>> motion = r3.Spline(times=[0.0, 1.0, 2.0], angles=[[0.0] * 3, [1.0] * 3, [0.5] * 3])
    >>> motion.angle(1.0), motion.rate(2.0)
    (array([1., 1., 1.]), array([0., 0., 0.]))
    """

    times: tuple[float, ...]
    angles: tuple[tuple[float, ...], ...]

    def __init__(self, times: Floats, angles: PerAxis) -> None:
        instants = _instants("times", times)
        rows = numbers("angles", angles, "numbers [rad], a row of angles for each time")
        if rows.ndim != 2 or len(rows) != len(instants):
            raise ValueError(
                f"angles: expected shape ({len(instants)}, n_axes), a row of angles [rad] for each "
                f"time, got shape {rows.shape}"
            )
        self._freeze(times=instants, angles=tuple(map(tuple, rows.tolist())))

    @property
    def duration(self) -> float:
        """The last of the times [s]."""
        return self._compiled.duration

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.spline(self.times, self.angles)


@dataclass(frozen=True, eq=False, repr=False)
class PiecewisePolynomial(Motion):
    """Polynomials of time, one for each axis and each piece between two times.

    On piece k, with ``x = (t - times[k]) / (times[k + 1] - times[k])``, the angles are
    ``coefficients[k][0] + coefficients[k][1] x + coefficients[k][2] x^2 + ...``. It rests before
    the first time and after the last. Every time is a knot. Two are equal if they move alike.

    Parameters
    ----------
    times : sequence of n + 1 floats
        Instants [s], at least two, ascending, the first not before 0.
    coefficients : array_like (n, n_powers, n_axes)
        Of the n pieces, of x^0, x^1, ... up to x^5, for 1, 3 or 6 axes [rad]. Each piece begins at
        the angles at which the one before has ended, within 1e-9 rad.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, piece, axis, unit), what was expected, what arrived.

    Examples
    --------
    Up with constant acceleration, and down again:

    >>> up, down = [[0.0], [0.0], [1.0]], [[1.0], [0.0], [-1.0]]
    >>> motion = r3.PiecewisePolynomial([0.0, 0.5, 1.0], [up, down])
    >>> motion.angle([0.25, 0.5, 1.0]).ravel()
    array([0.25, 1.  , 0.  ])
    """

    times: tuple[float, ...]
    coefficients: tuple[tuple[tuple[float, ...], ...], ...]

    def __init__(self, times: Floats, coefficients: np.ndarray | abc.Sequence[PerAxis]) -> None:
        instants = _instants("times", times)
        array = numbers(
            "coefficients",
            coefficients,
            "numbers [rad], for each piece and power a row of axes",
        )
        if array.ndim != 3 or len(array) != len(instants) - 1 or array.size == 0:
            raise ValueError(
                f"coefficients: expected shape ({len(instants) - 1}, n_powers, n_axes) [rad], for "
                f"each piece between two times and each power a row of axes, got shape "
                f"{array.shape}"
            )
        of_pieces = tuple(tuple(map(tuple, piece)) for piece in array.tolist())
        self._freeze(times=instants, coefficients=of_pieces)

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, PiecewisePolynomial)
            and self.times == other.times
            and self.coefficients == other.coefficients
        )

    def __hash__(self) -> int:
        return hash((self.times, self.coefficients))

    def __repr__(self) -> str:
        return (
            f"{type(self).__name__}({len(self.coefficients)} pieces of {self.n_axes} axes, "
            f"{self.times[0]:g} to {self.times[-1]:g} s)"
        )

    @property
    def duration(self) -> float:
        """The last of the times [s]."""
        return self._compiled.duration

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.polynomials(self.times, np.array(self.coefficients))


@dataclass(frozen=True)
class Hold(Motion):
    """Stay where it is.

    Parameters
    ----------
    angles : sequence of 1, 3 or 6 floats
        Joint angles [rad].
    duration : float
        For how long [s] until the next motion of a `Sequence` begins. Alone, it stays for ever.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.

    Examples
    --------
    >>> r3.Hold([0.3, -0.5, 0.8, 0.0, 0.0, 0.0]).angle(10.0)
    array([ 0.3, -0.5,  0.8,  0. ,  0. ,  0. ])
    """

    angles: tuple[float, ...]
    duration: float

    def __init__(self, angles: Floats, duration: float = 0.0) -> None:
        self._freeze(
            angles=_tuple("angles", angles, "rad"),
            duration=number("duration", duration, "s"),
        )

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.hold(self.angles, self.duration)


@dataclass(frozen=True)
class Sequence(Motion):
    """One motion after another; each begins when the one before has come to its end.

    Its knots are those of the members, shifted, and the instants where two members meet. In its
    time each member gives exactly what it gives alone.

    Parameters
    ----------
    motions : sequence of Motion
        At least one, of any type, all with as many axes. Each must begin where the one before ends,
        within 1e-9 rad.

    Raises
    ------
    ValueError, TypeError
        What was wrong: which motion, axis and instant, what was expected, what arrived.

    Examples
    --------
    >>> there = r3.Quintic(start=[0.0] * 6, end=[1.0] * 6, duration=1.0)
    >>> waiting = r3.Hold(there.end, duration=0.5)
    >>> back = r3.Quintic(start=there.end, end=there.start, duration=1.5)
    >>> motion = r3.Sequence([there, waiting, back])
    >>> motion.duration, motion.knots
    (3.0, array([0. , 1. , 1.5, 3. ]))
    """

    motions: tuple[Motion, ...]

    def __init__(self, motions: abc.Iterable[Motion]) -> None:
        if not isinstance(motions, abc.Iterable):
            raise TypeError(f"motions: expected a list of motions, got {motions!r}")
        members = tuple(motions)
        for k, motion in enumerate(members):
            if not isinstance(motion, Motion):
                raise TypeError(f"motions[{k}]: expected a motion, got {motion!r}")
        self._freeze(motions=members)

    @property
    def duration(self) -> float:
        """Sum of the durations [s]."""
        return self._compiled.duration

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.sequence([motion._compiled for motion in self.motions])


# A function of time [s] that gives one number per axis.
_Function = Callable[[float], Floats]


@dataclass(frozen=True, repr=False)
class FunctionMotion(Motion):
    """Any functions of time: the slow path.

    Each evaluation of the robot's equations calls `angle` and `rate` once: with NumPy inside them
    a run takes several times as long as one along polynomials.

    From 0 to `duration` the motion is what the functions say; it rests at ``angle(0)`` before and
    at ``angle(duration)`` after. Between neighbours of 0, `knots` and `duration` the functions must
    be smooth. They are asked for times of one such piece at a time, and never for a knot until what
    follows it is meant: at a knot they should give what holds right after it.

    Parameters
    ----------
    angle : callable
        Joint angles [rad] at a time [s]: a sequence of 1, 3 or 6 floats. With three moving axes
        (models 2 and 4) it must be three.
    rate : callable
        Joint rates [rad/s], the derivative of `angle`, for as many axes.
    duration : float
        Time from start to end [s], positive.
    knots : sequence of float
        Instants between 0 and `duration` [s], ascending, at which the functions are not smooth.
    acceleration : callable, optional
        Joint accelerations [rad/s^2], the derivative of `rate`. Default: from differences of
        `rate` over 1e-5 s. Simulations do not need it.

    Attributes
    ----------
    angle_function, rate_function, inner_knots, acceleration_function
        The arguments without the duration.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived; at any later time,
        too, if a function gives something else than finite numbers, one per axis.

    Notes
    -----
    What a function raises comes out of `simulate`, `Simulator.step` or whatever else has asked it.
    The motion is picklable if its functions are, equal to another if they are.

    Examples
    --------
    >>> def angle(t):
    ...     return [0.1 * (1.0 - np.cos(2.0 * t)), 0.0, 0.0]
    >>> def rate(t):
    ...     return [0.2 * np.sin(2.0 * t), 0.0, 0.0]
    >>> motion = r3.FunctionMotion(angle, rate, duration=np.pi)
    >>> motion.angle(np.pi / 2)
    array([0.2, 0. , 0. ])
    """

    angle_function: _Function
    rate_function: _Function
    duration: float
    inner_knots: tuple[float, ...]
    acceleration_function: _Function | None

    def __init__(
        self,
        angle: _Function,
        rate: _Function,
        duration: float,
        knots: Floats = (),
        acceleration: _Function | None = None,
    ) -> None:
        given = {"angle": angle, "rate": rate}
        if acceleration is not None:
            given["acceleration"] = acceleration
        for name, function in given.items():
            if not callable(function):
                raise TypeError(f"{name}: expected a function of the time [s], got {function!r}")
        self._freeze(
            angle_function=angle,
            rate_function=rate,
            duration=number("duration", duration, "s"),
            inner_knots=_instants("knots", knots),
            acceleration_function=acceleration,
        )

    def __repr__(self) -> str:
        return (
            f"FunctionMotion(angle={self.angle_function!r}, rate={self.rate_function!r}, "
            f"duration={self.duration}, knots={self.inner_knots}, "
            f"acceleration={self.acceleration_function!r})"
        )

    @cached_property
    def _compiled(self) -> _core.Motion:
        # The functions may refer to what holds this motion. The garbage collector, which cannot
        # look into the core, finds such cycles because the core refers to them weakly.
        motion: Any = weakref.proxy(self)
        return _core.functions(
            lambda t: motion.angle_function(t),
            lambda t: motion.rate_function(t),
            self.duration,
            self.inner_knots,
            None
            if self.acceleration_function is None
            else lambda t: motion.acceleration_function(t),
        )
