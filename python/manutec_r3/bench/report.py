"""What benchmarks print: work, error, time and ratio of each row, and on which machine."""

import platform
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table as RichTable

import manutec_r3 as r3

from .timing import Timing

_UNITS = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_HEADINGS = ("", "work", "error", "events", "time", "median", "ratio")
_WORDS = ("", "work", "events")


@dataclass(frozen=True)
class Row:
    """What one program did, and how long it took.

    Attributes
    ----------
    name : str
        What was executed.
    time : Timing or None
        None if it was not: `work` says why.
    work : str
        How much was done for it, or what exactly was measured.
    error : float or None
        How far the answer is off; None if nobody published it or there is nothing to compare.
    allowed : float or None
        How far it may be off.
    same_events : bool or None
        Whether events are those of the reference; None if there are none.
    """

    name: str
    time: Timing | None
    work: str = ""
    error: float | None = None
    allowed: float | None = None
    same_events: bool | None = None

    @property
    def is_right(self) -> bool:
        """Whether error and events are as promised: without that its time means nothing."""
        accurate = self.allowed is None or (self.error is not None and self.error <= self.allowed)
        return accurate and self.same_events is not False


@dataclass(frozen=True)
class Table:
    """Rows that are compared with each other.

    Attributes
    ----------
    part : str
        The name by which it is asked for.
    title : str
        What all rows do.
    unit : {"s", "ms", "us", "ns"}
        Of times.
    rows : sequence of Row
        Ratios are relative to the first one.
    notes : str
        What was measured, and how.
    """

    part: str
    title: str
    unit: str
    rows: Sequence[Row]
    notes: str = ""

    @property
    def is_right(self) -> bool:
        """Whether all rows are right."""
        return all(row.is_right for row in self.rows)

    def ratio(self, row: Row) -> float | None:
        """Time of a row, in those of the first one: of the minima."""
        first = self.rows[0].time
        return None if row.time is None or first is None else row.time.minimum / first.minimum

    def cells(self) -> list[tuple[str, ...]]:
        """Return what each row shows under `_HEADINGS`."""
        return [
            (
                row.name,
                row.work,
                "" if row.error is None else f"{row.error:.1e}" + _too_large(row),
                "" if row.same_events is None else "same" if row.same_events else "DIFFERENT",
                *(self._time(row, of) for of in ("minimum", "median")),
                "" if (ratio := self.ratio(row)) is None else f"{ratio:.3g}",
            )
            for row in self.rows
        ]

    def _time(self, row: Row, of: str) -> str:
        if row.time is None:
            return ""
        value = _UNITS[self.unit] * getattr(row.time, of)
        return f"{value:.0f}" if value >= 100.0 else f"{value:#.3g}"

    def headings(self) -> list[str]:
        """Return `_HEADINGS` with the unit of times."""
        return [f"{name}, {self.unit}" if name == "time" else name for name in _HEADINGS]

    def as_dict(self) -> dict[str, Any]:
        """Return what is to be read by programs; times in seconds."""
        return {
            "part": self.part,
            "title": self.title,
            "notes": self.notes,
            "rows": [
                {
                    "name": row.name,
                    "work": row.work,
                    "error": row.error,
                    "allowed": row.allowed,
                    "same_events": row.same_events,
                    "minimum": row.time and row.time.minimum,
                    "median": row.time and row.time.median,
                    "ratio": self.ratio(row),
                    "is_right": row.is_right,
                }
                for row in self.rows
            ],
        }


def _too_large(row: Row) -> str:
    if row.allowed is None or row.error is None or row.error <= row.allowed:
        return ""
    return f" > {row.allowed:.0e}"


def filled(table: Table) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Headings and cells of the columns of a table that are not empty."""
    columns = zip(table.headings(), *table.cells(), strict=True)
    headings, *rows = zip(*(column for column in columns if any(column[1:])), strict=True)
    return headings, rows


def for_terminal(table: Table) -> RichTable:
    """Return a table that Rich prints; rows that are wrong stand out."""
    headings, rows = filled(table)
    printed = RichTable(
        box=box.SIMPLE_HEAD,
        show_edge=False,
        header_style="",
        title=table.title,
        title_style="bold",
        title_justify="left",
        caption=table.notes or None,
        caption_justify="left",
    )
    for heading in headings:
        is_number = heading not in _WORDS
        printed.add_column(heading, justify="right" if is_number else "left", no_wrap=is_number)
    for row, cells in zip(table.rows, rows, strict=True):
        printed.add_row(*cells, style=None if row.is_right else "bold red")
    return printed


def for_markdown(table: Table) -> str:
    """Return a table as the README has it."""
    headings, rows = filled(table)
    rule = ["---" if heading in _WORDS else "---:" for heading in headings]
    lines = [headings, rule, *rows]
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return f"**{table.title}**\n\n{text}\n" + (f"\n{table.notes}\n" if table.notes else "")


def machine() -> dict[str, str]:
    """Return processor, compiler and version: what times depend on."""
    about = {"manutec-r3": version("manutec-r3"), "processor": _processor()}
    return about | _build() | {"system": platform.platform(), "Python": platform.python_version()}


def _build() -> dict[str, str]:
    """Compiler and options of the core."""
    info = r3.build_info()
    return {"built for": info.processor, "compiler": info.compiler, "options": info.flags}


def _processor() -> str:
    """Its name; Python knows only its kind on Linux."""
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        for line in cpuinfo.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
