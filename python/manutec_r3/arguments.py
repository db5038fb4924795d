"""At the door: what users pass becomes arrays of floats, or a clear error."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from math import isfinite
from typing import Any

import numpy as np

# What users may pass for numbers: one for each axis or instant; rows of one for each axis.
Floats = Sequence[float] | np.ndarray
PerAxis = Floats | Sequence[Floats]


def numbers(name: str, value: Any, expected: str) -> np.ndarray:
    """Return an array of floats from numbers, not from texts, truth values or nothing."""
    try:
        array = np.asarray(value)
    except ValueError:  # ragged
        array = np.array(None)
    if array.dtype.kind not in "iuf" or (array is not value and _has_truth_value(value)):
        raise TypeError(f"{name}: expected {expected}, got {value!r}")
    return array.astype(float)


def _has_truth_value(value: Any) -> bool:
    """Whether there is one among numbers, of which NumPy makes a number too."""
    return any(isinstance(entry, bool | np.bool_) for entry in np.ravel(np.array(value, object)))


def number(name: str, value: Any, unit: str) -> float:
    """Return a finite float; errors name the argument and its unit."""
    if type(value) is float and isfinite(value):
        return value  # the usual case, a hundred times faster: there may be a hundred thousand runs
    array = numbers(name, value, f"one number [{unit}]")
    if array.ndim != 0:
        raise ValueError(f"{name}: expected one number [{unit}], got shape {array.shape}")
    if not np.isfinite(array):
        raise ValueError(f"{name}: expected a finite number [{unit}], got {array}")
    return float(array)


def floats(name: str, value: Any, unit: str) -> np.ndarray:
    """Return an array of finite floats; errors name the argument, its unit and the entry."""
    array = numbers(name, value, f"numbers [{unit}]")
    if not np.isfinite(array).all():
        entry = tuple(int(k) for k in np.argwhere(~np.isfinite(array))[0])
        place = f" at index {entry[0] if len(entry) == 1 else entry}" if entry else ""
        raise ValueError(f"{name}: expected finite values [{unit}], got {array[entry]}{place}")
    return array


def per_axis(name: str, value: Any, unit: str, n_axes: int) -> np.ndarray:
    """Return an array (..., n_axes) of finite floats; errors name the argument, axis and unit."""
    array = numbers(name, value, f"{n_axes} numbers [{unit}], one per axis")
    if array.ndim == 0 or array.shape[-1] != n_axes:
        raise ValueError(
            f"{name}: expected {n_axes} values [{unit}] along the last dimension, one per axis, "
            f"got shape {array.shape}"
        )
    if not np.isfinite(array).all():
        entry = tuple(np.argwhere(~np.isfinite(array))[0])
        raise ValueError(
            f"{name} of axis {entry[-1] + 1}: expected a finite value [{unit}], got {array[entry]}"
        )
    return array


def positive_per_axis(name: str, value: Any, unit: str, n_axes: int) -> np.ndarray:
    """Return positive numbers (n_axes,) from one for all axes, or one for each."""
    if np.ndim(value) == 0:
        return np.full(n_axes, positive(name, value, unit))
    values = per_axis(name, value, unit, n_axes)
    if values.ndim != 1:
        raise ValueError(
            f"{name}: expected one number [{unit}] or {n_axes} of them, got shape {values.shape}"
        )
    for axis in np.flatnonzero(values <= 0.0):
        raise ValueError(
            f"{name} of axis {axis + 1}: expected more than 0 {unit}, got {values[axis]:g} {unit}"
        )
    return values


def positive(name: str, value: Any, unit: str) -> float:
    """Return a positive number."""
    checked = number(name, value, unit)
    if checked <= 0.0:
        raise ValueError(f"{name}: expected more than 0 [{unit}], got {checked:g}")
    return checked


def count(name: str, value: Any, least: int) -> int:
    """Return a whole number that is not too small."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise TypeError(f"{name}: expected a whole number, got {value!r}")
    if value < least:
        raise ValueError(f"{name}: expected {least} or more, got {value}")
    return int(value)


def angles(name: str, value: Any, n_axes: int) -> np.ndarray:
    """Return joint angles (n_axes,) [rad]."""
    one_each = per_axis(name, value, "rad", n_axes)
    if one_each.ndim != 1:
        raise ValueError(f"{name}: expected {n_axes} angles [rad], got shape {one_each.shape}")
    return one_each


def hint(name: object, known: Iterable[str]) -> str:
    """Suggest what may have been meant, or all that is known."""
    return near(name, known) or f", known are {', '.join(known)}"


def near(name: object, known: Iterable[str]) -> str:
    """Suggest what may have been meant."""
    close = get_close_matches(str(name), known, n=1)
    return f", did you mean {close[0]!r}?" if close else ""
