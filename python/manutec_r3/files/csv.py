"""Signals and events as tables of comma-separated values, with units in the first line."""

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..signals import signal_names, signal_unit

if TYPE_CHECKING:
    from ..events import Events
    from ..result import Samples


def write_samples(path: str | Path, samples: "Samples", signals: Sequence[str] | None) -> None:
    """Write signals along the time; see `Samples.to_csv`."""
    if signals is None:
        signals = [name for name in signal_names if not np.isnan(getattr(samples, name)).all()]
    if isinstance(signals, str) or not isinstance(signals, Iterable):
        raise TypeError(f"signals: expected a sequence of names, got {signals!r}")
    columns = {"time [s]": samples.time}
    for name in signals:
        if name not in samples.signals:
            known = ", ".join(samples.signals)
            raise ValueError(f"signals: expected some of {known}, got {name!r}")
        columns |= _columns(samples, name)
    # To Python's floats, which are written to the last digit that matters.
    _write(path, columns, zip(*(column.tolist() for column in columns.values()), strict=True))


def _columns(samples: "Samples", name: str) -> dict[str, np.ndarray]:
    robot, values = samples.robot, getattr(samples, name)
    if name == "state":
        names, units = robot.state_names, robot.state_units
    else:
        names = tuple(f"{name}[{axis}]" for axis in range(1, robot.n_axes + 1))
        units = (signal_unit(name),) * robot.n_axes
    titles = [f"{name} [{unit}]" for name, unit in zip(names, units, strict=True)]
    return dict(zip(titles, values.T, strict=True))


def write_events(path: str | Path, events: "Events") -> None:
    """Write a line for each event; see `Events.to_csv`."""
    _write(path, ["time [s]", "axis", "element", "before", "after"], events)


def _write(path: str | Path, titles: Iterable[str], rows: Iterable[Iterable]) -> None:
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(titles)
        table.writerows(rows)
