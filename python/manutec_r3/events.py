"""The table of events of a run."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, SupportsIndex, overload

import numpy as np

from . import files, html

if TYPE_CHECKING:
    from pandas import DataFrame

# A reader of a notebook sees no more of a long list.
_SHOWN = 60


class Event(NamedTuple):
    """A branch has switched, the reference has passed a knot, a sample, or a limit was passed.

    Attributes
    ----------
    time : float
        When [s].
    axis : int
        1 to n_axes; 0: the whole robot.
    element : str
        ``dead_zone``, ``torque_limit``, ``voltage_limit``, ``backlash`` or ``friction`` of an axis;
        ``reference`` or ``sample``; if asked for, ``limit`` of an axis.
    before, after : int
        Branches -1, 0, +1. Friction: the rotor, in the Modelica variant the joint on axes 4 to 6,
        slides backward, sticks, slides forward. Limit: 0 is within it. Reference and sample: 0.
    """

    time: float
    axis: int
    element: str
    before: int
    after: int


class Events:
    """Events in the order of time; columns are arrays (n,).

    Attributes
    ----------
    time, axis, element, before, after : ndarray (n,)
        See `Event`.
    """

    def __init__(self, events: Iterable[Event]) -> None:
        self._rows = tuple(Event(*event) for event in events)
        columns = tuple(zip(*self._rows, strict=True)) or ((),) * len(Event._fields)
        self.time = np.array(columns[0], float)
        self.axis = np.array(columns[1], int)
        self.element = np.array(columns[2], str)
        self.before = np.array(columns[3], int)
        self.after = np.array(columns[4], int)

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Event]:
        return iter(self._rows)

    @overload
    def __getitem__(self, index: SupportsIndex) -> Event: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Event, ...]: ...
    def __getitem__(self, index: SupportsIndex | slice) -> Event | tuple[Event, ...]:
        return self._rows[index]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Events) and self._rows == other._rows

    def __hash__(self) -> int:
        return hash(self._rows)

    def to_pandas(self) -> "DataFrame":
        """Return a table of pandas: a row for each event, with the columns above.

        Raises
        ------
        ImportError
            Without the extra ``files``.
        """
        try:
            from pandas import DataFrame
        except ImportError:
            raise files.missing("pandas", "to_pandas") from None
        return DataFrame({column: getattr(self, column) for column in Event._fields})

    def to_csv(self, path: str | Path) -> None:
        """Write a table of comma-separated values, times [s] to the last digit.

        Parameters
        ----------
        path : str or Path
            Where to.

        Raises
        ------
        OSError
            If the file cannot be written.
        """
        files.csv.write_events(path, self)

    def __repr__(self) -> str:
        return f"<{len(self)} events>"

    def _repr_html_(self) -> str:
        shown = self._rows[:_SHOWN]
        title = f"{len(self)} events" + (f", the first {_SHOWN}" if len(self) > _SHOWN else "")
        rows = ((f"{e.time:.9f}", e.axis, e.element.replace("_", " "), *e[3:]) for e in shown)
        return html.table(title, ("time [s]", *Event._fields[1:]), rows)
