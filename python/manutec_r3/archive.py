"""A result on disk: `result.npz`, which NumPy opens without this package, and `events.csv`."""

import csv
from importlib.metadata import version
from pathlib import Path

import numpy as np

from .result import Result

_EVENT_COLUMNS = ("time", "axis", "element", "before", "after")


def write_npz(path: str | Path, result: Result, scenario: str = "") -> None:
    """Write a result as a NumPy archive, without pickled objects.

    Parameters
    ----------
    path : str or Path
        Where to.
    result : Result
        What to write.
    scenario : str
        The TOML text of its scenario.

    Notes
    -----
    The archive holds

    * ``time`` (n,) [s] and each signal of the result under its own name, (n, n_axes) or
      (n, n_states), in SI units; an event's instant stands twice, before and after;
    * ``branches_<element>`` (n, n_axes): -1, 0, +1 along ``time``; friction 0: sticking;
    * ``event_time`` [s], ``event_axis``, ``event_element``, ``event_before``, ``event_after``;
    * ``state_names``, ``state_units`` (n_states,);
    * as texts where it comes from: ``version`` of manutec-r3, ``scenario``, ``method``, ``rtol``.
    """
    np.savez(
        path,
        time=result.time,
        **{signal: getattr(result, signal) for signal in result.signals},
        **{f"branches_{element}": branch for element, branch in result.branches.items()},
        **{f"event_{column}": getattr(result.events, column) for column in _EVENT_COLUMNS},
        state_names=np.array(result.robot.state_names, str),
        state_units=np.array(result.robot.state_units, str),
        version=version("manutec-r3"),
        scenario=scenario,
        method=str(result.method),
        rtol=str(result.rtol),
    )


def write_events(path: str | Path, result: Result) -> None:
    """Write the events of a result as a table of comma-separated values.

    One line for each event: its time [s] to the last digit, its axis (0: the whole robot), its
    element, and the branch before and after.
    """
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time [s]", *_EVENT_COLUMNS[1:]])
        for event in result.events:
            row = [getattr(event, column) for column in _EVENT_COLUMNS]
            table.writerow([repr(float(row[0])), *row[1:]])
