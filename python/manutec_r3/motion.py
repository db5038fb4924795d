"""Reference motions: the joint angles that the controllers are to follow."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import _core
from .arguments import floats, number, numbers


class Motion(ABC):
    """What all motions have in common; use `Quintic`, `Trapezoid` or `Hold`.

    A motion begins at 0 s; before, it rests at its start. It is immutable, comparable, picklable.
    At its knots it is right-continuous.
    """

    duration: float

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
        """Number of axes: 3 or 6."""
        return self._compiled.n_axes

    @property
    def knots(self) -> np.ndarray:
        """Instants at which the motion is not smooth [s]."""
        return self._compiled.knots

    def angle(self, t: float | np.ndarray) -> np.ndarray:
        """Joint angles at time(s) `t` [s].

        Returns
        -------
        ndarray (..., n_axes)
            Angles [rad], for `t` of shape (...).
        """
        return self._evaluate(t, 0)

    def rate(self, t: float | np.ndarray) -> np.ndarray:
        """Joint rates at time(s) `t` [s]: an array (..., n_axes) [rad/s]."""
        return self._evaluate(t, 1)

    def acceleration(self, t: float | np.ndarray) -> np.ndarray:
        """Joint accelerations at time(s) `t` [s]: an array (..., n_axes) [rad/s^2]."""
        return self._evaluate(t, 2)

    def _evaluate(self, t: float | np.ndarray, derivative: int) -> np.ndarray:
        t = floats("t", t, "s")
        return self._compiled.evaluate(t.ravel())[derivative].reshape(*t.shape, self.n_axes)


def _tuple(name: str, values: Sequence[float], unit: str) -> tuple[float, ...]:
    array = numbers(name, values, f"3 or 6 numbers [{unit}], one per axis")
    if array.ndim != 1:
        raise ValueError(
            f"{name}: expected 3 or 6 values [{unit}], one per axis, got shape {array.shape}"
        )
    return tuple(array.tolist())


@dataclass(frozen=True)
class Quintic(Motion):
    """From rest to rest with zero acceleration at both ends, on all axes at once.

    ``start + (end - start) (10 x^3 - 15 x^4 + 6 x^5)`` with ``x = t / duration``.

    Parameters
    ----------
    start, end : sequence of 3 or 6 floats
        Joint angles [rad].
    duration : float
        Time from start to end [s], positive.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    duration: float

    def __post_init__(self) -> None:
        self._freeze(
            start=_tuple("start", self.start, "rad"),
            end=_tuple("end", self.end, "rad"),
            duration=number("duration", self.duration, "s"),
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
    start, end : sequence of 3 or 6 floats
        Joint angles [rad].
    rate : sequence of floats
        Largest joint rates [rad/s], positive.
    acceleration : sequence of floats
        Largest joint accelerations [rad/s^2], positive.

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    rate_limit: tuple[float, ...]
    acceleration_limit: tuple[float, ...]

    def __init__(
        self,
        start: Sequence[float],
        end: Sequence[float],
        rate: Sequence[float],
        acceleration: Sequence[float],
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
class Hold(Motion):
    """Stay where it is; the duration is zero.

    Parameters
    ----------
    angles : sequence of 3 or 6 floats
        Joint angles [rad].
    """

    angles: tuple[float, ...]

    def __post_init__(self) -> None:
        self._freeze(angles=_tuple("angles", self.angles, "rad"))

    @property
    def duration(self) -> float:
        """Zero [s]."""
        return self._compiled.duration

    @cached_property
    def _compiled(self) -> _core.Motion:
        return _core.hold(self.angles)
