"""Tables 1 to 3 with numbers of one's own: what is given takes the place of what stands there."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from .arguments import floats, hint, number

TABLES = ("table_1", "table_2", "table_3")

Units = Mapping[str, str]


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

    def __hash__(self) -> int:
        return hash(frozenset(self._rows.items()))

    def __repr__(self) -> str:
        return repr(self._rows)


def _frozen(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Rows(value)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(map(_frozen, value)) if isinstance(value, list | tuple) else value


def replaced(
    tables: Mapping[str, Any], changes: Mapping[str, Any], units: Mapping[str, Units]
) -> dict[str, Any]:
    """Return tables in which rows are replaced.

    Parameters
    ----------
    tables : mapping
        ``table_1`` to ``table_3`` as `Robot.parameters` shows them.
    changes : mapping
        The same names with the rows to replace. A row of one entry per axis is given as a sequence
        of all of them, as a mapping of axes (from 1) to entries, or as one number for all.
    units : mapping
        The same names with the units of their symbols.

    Raises
    ------
    ValueError, TypeError
        Which table, symbol and axis, what was expected, what arrived. What the numbers mean is
        checked by the core.
    """
    result = dict(tables)
    for name, rows in changes.items():
        if rows is None:
            continue
        if not isinstance(rows, Mapping):
            raise TypeError(f"{name}: expected a mapping of symbols to values, got {rows!r}")
        result[name] = dict(tables[name])
        for symbol, value in rows.items():
            _check_known(name, symbol, tables[name])
            where = f"{name} {symbol}"
            old = tables[name][symbol]
            if isinstance(old, list | tuple):
                new = _row(where, symbol, old, value, units[name])
            else:
                new = _entry(where, symbol, old, value, units[name])
            result[name][symbol] = new
    return result


def _row(where: str, symbol: str, old: Sequence, new: Any, units: Units) -> Sequence:
    """One entry per axis."""
    n = len(old)

    def entry(axis: int, given: Any) -> Any:
        return _entry(f"{where} of axis {axis}", symbol, old[axis - 1], given, units)

    if isinstance(new, Mapping):
        row = list(old)
        for axis, given in new.items():
            if isinstance(axis, bool) or not isinstance(axis, int | np.integer):
                raise TypeError(f"{where}: expected the number of an axis, got {axis!r}")
            if not 1 <= axis <= n:
                axes = f"an axis from 1 to {n}" if n > 1 else "axis 1 only"
                raise ValueError(f"{where}: expected {axes}, got {axis}")
            row[axis - 1] = entry(int(axis), given)
        return row
    if isinstance(old[0], float) and not isinstance(new, str | Sequence | np.ndarray):
        new = [new] * n
    if isinstance(new, str) or not isinstance(new, Sequence | np.ndarray) or len(new) != n:
        entries = f"{n} entries, one per axis," if n > 1 else "one entry"
        raise ValueError(
            f"{where}: expected {entries} or a mapping of axes to entries, got {new!r}"
        )
    return [entry(axis, given) for axis, given in enumerate(new, start=1)]


def _entry(where: str, symbol: str, old: Any, new: Any, units: Units) -> Any:
    """Check what takes the place of a number, an arm, points of friction, or a letter."""
    if isinstance(old, dict):
        if not isinstance(new, Mapping):
            raise TypeError(f"{where}: expected a mapping of symbols to values, got {new!r}")
        arm = dict(old)
        for inner, value in new.items():
            _check_known(where, inner, old)
            arm[inner] = _entry(f"{where}, {inner}", inner, old[inner], value, units)
        return arm
    if symbol == "axis":
        if new != old:
            raise ValueError(f"{where}: expected {old!r}, which cannot be replaced, got {new!r}")
        return old
    if symbol == "rn":
        if not isinstance(new, str) or new not in ("x", "y", "z"):
            raise ValueError(f"{where}: expected 'x', 'y' or 'z', got {new!r}")
        return new
    if symbol == "friction":
        points = floats(where, new, "rad/s, N m")
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(
                f"{where}: expected points (rotor rate [rad/s], torque [N m]), "
                f"got shape {points.shape}"
            )
        return points.tolist()
    unit = units[symbol]
    if not isinstance(old, list | tuple):
        # A joint limit may be infinite, which means none.
        is_no_limit = symbol == "joint_limits" and isinstance(new, float) and new == np.inf
        return new if is_no_limit else number(where, new, unit)
    coordinates = floats(where, new, unit)
    if coordinates.shape != (3,):
        raise ValueError(
            f"{where}: expected three coordinates [{unit}], got shape {coordinates.shape}"
        )
    return coordinates.tolist()


def _check_known(where: str, symbol: object, known: Mapping[str, Any]) -> None:
    if symbol in known:
        return
    raise ValueError(f"{where}: unknown symbol {symbol!r}{hint(symbol, known)}")
