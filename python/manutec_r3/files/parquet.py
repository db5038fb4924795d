"""Records of many runs as Parquet files: one row per run, in files of some hundred rows.

A file `runs-000000500.parquet` begins with run 500. Columns are

* ``run``: its place in the order; ``status``: ``completed``, or what ended it;
* ``t_end`` [s], ``method``, ``rtol`` and each of `Statistics`; empty if it could not begin;
* of ``record="events"``: ``event_time`` [s], ``event_axis``, ``event_element``, ``event_before``,
  ``event_after``: lists with an entry for each event;
* of ``"final"`` and ``"peaks"``: each signal, a list with an entry for each axis; of ``"final"``
  ``state`` and the branches of each element as well: ``branches_friction`` and so on.

``pandas.read_parquet(folder)`` or ``pyarrow.parquet.read_table(folder)`` reads all of them.
"""

from collections.abc import Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import _core
from ..errors import SimulationError
from ..events import Event
from ..many_runs.records import EventRecord, FinalRecord, Record, RunRecord
from ..result import Result, Statistics
from ..signals import signal_names
from .missing import missing

if TYPE_CHECKING:
    from pyarrow import Schema

# As many runs are held in memory, and then written to one file.
ROWS = 500


def checked_folder(path: str | Path, record: Record) -> Path:
    """Return the folder for files of these records, which must not be there yet."""
    if record == "all":
        raise ValueError(
            "to_parquet: expected record='events', 'final' or 'peaks' with it, as a whole result "
            "is no row of a table"
        )
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise missing("pyarrow", "to_parquet", "dask") from None
    folder = Path(path)
    if folder.exists():
        raise ValueError(f"to_parquet: expected a folder that is not there yet, got {str(path)!r}")
    return folder


def write(
    folder: Path, record: Record, first: int, outcomes: Iterable[RunRecord | Exception | None]
) -> None:
    """Write a file of outcomes in their order, from run `first` on; what is None is left out."""
    from pyarrow import Table
    from pyarrow.parquet import write_table

    rows = [_row(first + k, one) for k, one in enumerate(outcomes) if one is not None]
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"runs-{first:09}.parquet"
    # In one move: who is killed meanwhile leaves no file that looks complete.
    unfinished = file.with_suffix(".unfinished")
    write_table(Table.from_pylist(rows, schema=_schema(record)), unfinished)
    unfinished.replace(file)


def _schema(record: Record) -> "Schema":
    import pyarrow as pa

    number, numbers, count = pa.float64(), pa.list_(pa.float64()), pa.int64()
    columns = {"run": count, "status": pa.string(), "t_end": number}
    columns |= {"method": pa.string(), "rtol": number}
    columns |= {of.name: number if of.type is float else count for of in fields(Statistics)}
    if record == "events":
        of_field = {"time": number, "element": pa.string()}
        columns |= {f"event_{name}": pa.list_(of_field.get(name, count)) for name in Event._fields}
    else:
        columns |= dict.fromkeys(signal_names, numbers)
    if record == "final":
        columns["state"] = numbers
        columns |= {f"branches_{name}": pa.list_(pa.int8()) for name in _core.axis_elements}
    return pa.schema(columns.items())


def _row(run: int, outcome: RunRecord | Result | Exception) -> dict[str, Any]:
    """Return the columns of a run that are not empty."""
    row: dict[str, Any] = {"run": run}
    if isinstance(outcome, Exception):
        row["status"] = f"{type(outcome).__name__}: {outcome}"
        if not isinstance(outcome, SimulationError) or outcome.result is None:
            return row
        outcome = outcome.result
    row |= {name: getattr(outcome, name) for name in ("status", "t_end", "method", "rtol")}
    row |= asdict(outcome.statistics)
    if isinstance(outcome, EventRecord):
        row |= {f"event_{name}": getattr(outcome.events, name) for name in Event._fields}
        return row
    row |= {name: getattr(outcome, name) for name in signal_names}
    if isinstance(outcome, FinalRecord):
        row["state"] = outcome.state
        row |= {f"branches_{name}": branches for name, branches in outcome.branches.items()}
    return row
