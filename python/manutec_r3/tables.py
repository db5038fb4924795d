"""Tables 1 to 3 with numbers of one's own: what is given takes the place of what stands there."""

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from .arguments import floats, number

TABLES = ("table_1", "table_2", "table_3")

# One body, not one per axis.
_BODIES = ("lumped_arm_3",)


def replaced(tables: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return tables in which rows are replaced.

    Parameters
    ----------
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
            if symbol in _BODIES:
                new = _entry(where, old, value)
            elif isinstance(old, list | tuple):
                new = _row(where, old, value)
            else:
                new = number(where, value, "SI")
            result[name][symbol] = new
    return result


def _row(where: str, old: Sequence, new: Any) -> Sequence:
    """One entry per axis."""
    n = len(old)
    if isinstance(new, Mapping):
        row = list(old)
        for axis, entry in new.items():
            if isinstance(axis, bool) or not isinstance(axis, int | np.integer):
                raise TypeError(f"{where}: expected the number of an axis, got {axis!r}")
            if not 1 <= axis <= n:
                raise ValueError(f"{where}: expected an axis from 1 to {n}, got {axis}")
            row[axis - 1] = _entry(f"{where} of axis {axis}", old[axis - 1], entry)
        return row
    if isinstance(old[0], float) and np.ndim(new) == 0 and not isinstance(new, str):
        new = [new] * n
    if isinstance(new, str) or not isinstance(new, Sequence | np.ndarray) or len(new) != n:
        raise ValueError(
            f"{where}: expected {n} entries, one per axis, or a mapping of axes to entries, "
            f"got {new!r}"
        )
    return [
        _entry(f"{where} of axis {axis}", entry, given)
        for axis, (entry, given) in enumerate(zip(old, new, strict=True), start=1)
    ]


def _entry(where: str, old: Any, new: Any) -> Any:
    """Check what takes the place of a number, an arm, points of friction, or a letter."""
    if isinstance(old, dict):
        if not isinstance(new, Mapping):
            raise TypeError(f"{where}: expected a mapping of symbols to values, got {new!r}")
        arm = dict(old)
        for symbol, value in new.items():
            _check_known(where, symbol, old)
            arm[symbol] = _entry(f"{where}, {symbol}", old[symbol], value)
        return arm
    if isinstance(old, str):
        if " rn " in where:
            return str(new)
        if new != old:
            raise ValueError(f"{where}: expected {old!r}, which cannot be replaced, got {new!r}")
        return old
    if not isinstance(old, list | tuple):
        # A joint limit may be infinite, which means none.
        return np.inf if "joint_limits" in where and new == np.inf else number(where, new, "SI")
    if isinstance(old[0], tuple):
        points = floats(where, new, "rad/s, N m")
        if points.ndim != 2 or points.shape[1] != 2:
            raise ValueError(
                f"{where}: expected points (rotor rate [rad/s], torque [N m]), "
                f"got shape {points.shape}"
            )
        return points.tolist()
    coordinates = floats(where, new, "m")
    if coordinates.shape != (3,):
        raise ValueError(f"{where}: expected three coordinates [m], got shape {coordinates.shape}")
    return coordinates.tolist()


def _check_known(where: str, symbol: object, known: Mapping[str, Any]) -> None:
    if symbol in known:
        return
    near = get_close_matches(str(symbol), known, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"known are {', '.join(known)}"
    raise ValueError(f"{where}: unknown symbol {symbol!r}, {hint}")
