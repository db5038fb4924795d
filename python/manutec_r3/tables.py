"""Tables 1 to 3 with numbers of one's own: what is given takes the place of what stands there."""

from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from . import _core
from .arguments import floats, numbers

TABLES = ("table_1", "table_2", "table_3")


class Rows(Mapping):
    """Rows of a table, as they were given, that nobody can change."""

    def __init__(self, rows: Mapping[Any, Any]) -> None:
        self._rows = {key: _frozen(value) for key, value in rows.items()}

    def __getitem__(self, key: object) -> Any:
        return self._rows[key]

    def __iter__(self) -> Iterator:
        return iter(self._rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return repr(self._rows)


def _frozen(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Rows(value)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value


def replaced(
    model: int | str, tables: dict[str, Any], changes: Mapping[str, Any]
) -> dict[str, Any]:
    """Return tables in which rows are replaced.

    Parameters
    ----------
    model : int or str
        Of the robot.
    tables : dict
        ``table_1`` to ``table_3`` as `Robot.parameters` shows them.
    changes : mapping
        The same names with the rows to replace. A row of one entry per axis is given as a sequence
        of all of them, as a mapping of axes (from 1) to entries, or as one number for all.

    Raises
    ------
    ValueError, TypeError
        Which table, symbol and axis, what was expected, what arrived. What the numbers mean is
        checked by the core.
    """
    units = _core.table_units(model)
    result = dict(tables)
    for name, rows in changes.items():
        if rows is None:
            continue
        if not isinstance(rows, Mapping):
            raise TypeError(f"{name}: expected a mapping of symbols to values, got {rows!r}")
        result[name] = dict(tables[name])
        for symbol, value in rows.items():
            _check_known(name, symbol, tables[name])
            result[name][symbol] = _row(name, symbol, units[name], tables[name][symbol], value)
    return result


def _row(table: str, symbol: str, units: dict[str, str], old: Any, new: Any) -> Any:
    """Check what takes the place of a row."""
    where = f"{table} {symbol}"
    if not isinstance(old, list | tuple):  # of the whole robot
        return (
            _body(where, units, old, new)
            if symbol == "lumped_arm_3"
            else _number(where, units[symbol], new)
        )

    def entry(axis: int, value: Any) -> Any:
        here = f"{where} of axis {axis}"
        if symbol == "arms":
            return _body(here, units, old[axis - 1], value)
        if symbol == "friction":
            return _points(here, value)
        if symbol == "rn":
            return _letter(here, value)
        return _number(here, units[symbol], value, may_be_infinite=symbol == "joint_limits")

    n = len(old)
    if isinstance(new, Mapping):
        row = list(old)
        for axis, value in new.items():
            if isinstance(axis, bool) or not isinstance(axis, int | np.integer):
                raise TypeError(f"{where}: expected the number of an axis, got {axis!r}")
            if not 1 <= axis <= n:
                raise ValueError(f"{where}: expected an axis from 1 to {n}, got {axis}")
            row[axis - 1] = entry(int(axis), value)
        return row
    if isinstance(old[0], float) and isinstance(new, int | float | np.number):
        new = [new] * n
    if isinstance(new, str) or not isinstance(new, Sequence | np.ndarray) or len(new) != n:
        raise ValueError(
            f"{where}: expected {n} entries, one per axis, or a mapping of axes to entries, "
            f"got {new!r}"
        )
    return [entry(axis, value) for axis, value in enumerate(new, start=1)]


def _number(where: str, unit: str, value: Any, may_be_infinite: bool = False) -> float:
    array = numbers(where, value, f"one number [{unit}]")
    if array.ndim != 0:
        raise ValueError(f"{where}: expected one number [{unit}], got shape {array.shape}")
    if not (np.isfinite(array) or (may_be_infinite and array == np.inf)):
        raise ValueError(f"{where}: expected a finite number [{unit}], got {array}")
    return float(array)


def _points(where: str, value: Any) -> list:
    points = floats(where, value, "rad/s, N m")
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(
            f"{where}: expected points (rotor rate [rad/s], torque [N m]), got shape {points.shape}"
        )
    return points.tolist()


def _letter(where: str, value: Any) -> str:
    if value not in ("x", "y", "z"):
        raise ValueError(f"{where}: expected 'x', 'y' or 'z', got {value!r}")
    return value


def _body(where: str, units: dict[str, str], old: dict[str, Any], new: Any) -> dict[str, Any]:
    """Check what takes the place of an arm, or of some of its numbers."""
    if not isinstance(new, Mapping):
        raise TypeError(f"{where}: expected a mapping of symbols to values, got {new!r}")
    body = dict(old)
    for symbol, value in new.items():
        _check_known(where, symbol, old)
        here = f"{where}, {symbol}"
        if symbol == "axis" or (symbol == "offset" and "lumped_arm_3" in where):
            fixed = list(value) if symbol == "offset" else value
            if fixed != old[symbol]:
                raise ValueError(f"{here}: expected {old[symbol]!r}, which is fixed, got {value!r}")
        elif isinstance(old[symbol], float):
            body[symbol] = _number(here, units[symbol], value)
        else:
            coordinates = floats(here, value, units[symbol])
            if coordinates.shape != (3,):
                raise ValueError(
                    f"{here}: expected three coordinates [m], got shape {coordinates.shape}"
                )
            body[symbol] = coordinates.tolist()
    return body


def _check_known(where: str, symbol: object, known: Mapping[str, Any]) -> None:
    if symbol in known:
        return
    near = get_close_matches(str(symbol), known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"
    raise ValueError(f"{where}: unknown symbol {symbol!r}, {hint}")
