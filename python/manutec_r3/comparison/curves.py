"""Reference curves from a file of comma-separated values: time, then a column for each curve."""

import csv
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..signals import signal_names, signal_unit

# A signal or the quantity of a state, and the axis that it belongs to.
CurveName = tuple[str, int]


def read_curves(
    path: str | Path, columns: Mapping[str, CurveName] | None
) -> tuple[np.ndarray, dict[CurveName, np.ndarray]]:
    """Read reference curves.

    Parameters
    ----------
    path : str or Path
        A line of names, then lines of numbers in SI units. The first column is the time [s], which
        does not decrease; an instant that stands twice is a jump.
    columns : mapping of str to (str, int), optional
        Names of columns, each with the signal and axis that it holds; others are left out. Default:
        all columns, named such as ``joint_angle[1]`` or ``joint_angle[1] [rad]``.

    Returns
    -------
    time : ndarray (n,)
    curves : dict of (str, int) to ndarray (n,)
        By signal and axis.

    Raises
    ------
    ValueError, TypeError
        File, line and column, what was expected, what arrived.
    OSError
        If the file cannot be read.
    """
    if columns is not None:
        _check(columns)
    names, table = _read_table(path)
    time = table[:, 0]
    backward = np.flatnonzero(np.diff(time) < 0.0)
    if backward.size:
        raise ValueError(
            f"{path}: expected a first column of times [s] that do not decrease, "
            f"got {time[backward[0] + 1]:g} after {time[backward[0]]:g}"
        )
    curves: dict[CurveName, np.ndarray] = {}
    for name, (signal, axis) in (_named(path, names[1:]) if columns is None else columns).items():
        if name not in names[1:]:
            raise ValueError(f"{path}: expected a column {name!r}, got {', '.join(names)}")
        if (signal, axis) in curves:
            raise ValueError(f"{path}: column {name!r}: there are two columns of {signal}[{axis}]")
        curves[signal, axis] = table[:, names.index(name)]
    return time, curves


def _check(columns: Mapping[str, CurveName]) -> None:
    if not isinstance(columns, Mapping):
        raise TypeError(f"columns: expected {{'name': (signal, axis)}}, got {columns!r}")
    for name, curve in columns.items():
        if not isinstance(curve, tuple | list) or len(curve) != 2:
            raise TypeError(f"columns: expected (signal, axis) for {name!r}, got {curve!r}")


def _read_table(path: str | Path) -> tuple[list[str], np.ndarray]:
    """Names of the columns, and their numbers (n, n_columns)."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        lines = csv.reader(file, skipinitialspace=True)
        names = [name.strip() for name in next(lines, [])]
        if len(names) < 2:
            raise ValueError(
                f"{path}: expected names of columns, time first, with commas between, got {names}"
            )
        rows = [_numbers(f"{path}, line {lines.line_num}", names, line) for line in lines if line]
    if len(rows) < 2:
        raise ValueError(f"{path}: expected two lines of numbers or more, got {len(rows)}")
    return names, np.array(rows)


def _numbers(place: str, names: list[str], line: list[str]) -> list[float]:
    if len(line) != len(names):
        raise ValueError(f"{place}: expected {len(names)} numbers, got {len(line)}")
    numbers = []
    for name, text in zip(names, line, strict=True):
        try:
            numbers.append(float(text))
        except ValueError:
            numbers.append(np.nan)
        if not np.isfinite(numbers[-1]):
            raise ValueError(f"{place}, column {name!r}: expected a finite number, got {text!r}")
    return numbers


def _named(path: str | Path, names: list[str]) -> dict[str, CurveName]:
    """Signal and axis of each column, as its name says."""
    columns = {}
    for name in names:
        match = re.fullmatch(r"(\w+)\[(\d+)\](?: \[(.+)\])?", name)
        if not match:
            raise ValueError(
                f"{path}: expected columns named such as 'joint_angle[1]', got {name!r}; "
                "columns={'name': (signal, axis)} says what others hold"
            )
        signal, axis, unit = match.groups()
        if unit and signal in signal_names and unit != signal_unit(signal):
            raise ValueError(f"{path}: expected {signal} in {signal_unit(signal)}, got {name!r}")
        columns[name] = (signal, int(axis))
    return columns
