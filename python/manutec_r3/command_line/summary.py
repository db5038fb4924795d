"""What came out of a run: tables for people, data for machines."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict
from itertools import groupby
from operator import attrgetter
from typing import Any

import numpy as np
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from ..result import Result
from ..scenario import Scenario

# What the summary shows of each signal: its unit, how many of them are one SI unit, and whether
# the largest magnitude or both ends of the range.
_SHOWN = {
    "joint_angle": ("rad", 1.0, "range"),
    "control_error": ("mrad", 1e3, "peak"),
    "motor_torque": ("N m", 1.0, "peak"),
}


def summarise(out: Console, scenario: Scenario, result: Result) -> None:
    """Print the peaks of each axis beside the published ranges, excesses, events and the work."""
    out.print(f"[bold]{escape(scenario.name)}[/]  {escape(scenario.description)}\n")
    out.print(_peaks(scenario, result))
    out.print()
    if scenario.published:
        outside = signals_outside(scenario, result)
        out.print(
            f"[bold red]Outside the published range: {', '.join(outside)}.[/]"
            if outside
            else "All axes stay within the published ranges.",
            end="\n\n",
        )
    if result.limits:
        out.print(_excesses(result))
        out.print()
    winding_up = sorted({e.axis for e in result.limits if e.what == "saturation"})
    if winding_up:
        out.print(
            "[bold red]Sustained saturation winds up the rate controllers: "
            f"axis {', '.join(map(str, winding_up))}.[/]",
            end="\n\n",
        )
    out.print(_work(result))


def _peaks(scenario: Scenario, result: Result) -> Table:
    table = Table(
        box=box.SIMPLE_HEAD,
        show_edge=False,
        show_footer=bool(scenario.published),
        header_style="",
        footer_style="",
    )
    table.add_column("axis", footer="published", justify="right")
    cells = []
    for signal, (unit, scale, shown) in _SHOWN.items():
        values = scale * getattr(result, signal)
        if shown == "range":
            ends = zip(values.min(axis=0), values.max(axis=0), strict=True)
            cells.append([f"{lowest:.3f} to {highest:.3f}" for lowest, highest in ends])
        else:
            peaks = np.abs(values).max(axis=0)
            # There is no control error without a motion.
            cells.append(["-" if np.isnan(peak) else f"{peak:.2f}" for peak in peaks])
        footer = ""
        if signal in scenario.published:
            lowest, highest = scenario.published[signal]
            footer = f"{scale * lowest:g} to {scale * highest:g}"
        heading = f"{words(signal)}\n{shown}, {unit}"
        table.add_column(heading, footer=footer, justify="right", no_wrap=True)
    for axis, row in enumerate(zip(*cells, strict=True), start=1):
        table.add_row(str(axis), *row)
    return table


def signals_outside(scenario: Scenario, result: Result) -> list[str]:
    """Signals that leave their published range, each with its axis."""
    outside = []
    for signal, (lowest, highest) in scenario.published.items():
        values = getattr(result, signal)
        leaves = ((values < lowest) | (values > highest)).any(axis=0)
        outside += [f"{words(signal)} of axis {axis}" for axis in 1 + np.flatnonzero(leaves)]
    return outside


def _excesses(result: Result) -> Table:
    """One row for each limit of each axis that is exceeded."""
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, header_style="")
    table.add_column("axis", justify="right")
    table.add_column("exceeded", no_wrap=True)
    for heading in ("limit", "peak", "first, s", "times"):
        table.add_column(heading, justify="right", no_wrap=True)
    of_axis = attrgetter("axis", "what")
    for (axis, what), excesses in groupby(sorted(result.limits, key=of_axis), key=of_axis):
        times = list(excesses)
        peak = max(excess.peak for excess in times)
        table.add_row(
            str(axis),
            words(what),
            f"{times[0].limit:g} {times[0].unit}",
            f"{peak:.3g} {times[0].unit}",
            f"{times[0].begin:.3f} to {times[0].end:.3f}",
            str(len(times)),
        )
    return table


def _work(result: Result) -> Table:
    """Events by element, work and computing time."""
    work, simulated = result.statistics, float(result.time[-1])
    counts = Counter(words(event.element) for event in result.events).most_common()
    kinds = ", ".join(f"{count} {element}" for element, count in counts)
    table = Table.grid(padding=(0, 2))
    table.add_row("events", f"{len(result.events)}: {kinds}" if counts else "none")
    table.add_row(
        "work",
        f"{work.steps} steps, {work.evaluations} evaluations, {work.restarts} restarts "
        f"({result.method}, rtol {result.rtol:g})",
    )
    if work.samples:
        each = work.evaluations_per_sample
        table.add_row("samples", f"{work.samples}, {each:.3g} evaluations each")
    table.add_row(
        "time",
        f"{work.seconds:.3g} s for {simulated:g} s: "
        f"{simulated / work.seconds:.3g} times as fast as real time",
    )
    return table


def words(name: str) -> str:
    """Return a name as it is said."""
    return name.replace("_", " ")


def as_data(scenario: Scenario, result: Result, files: Iterable[object] = ()) -> dict[str, Any]:
    """Return the same for machines, as data for JSON in SI units."""
    peaks = {}
    for signal in _SHOWN:
        values = getattr(result, signal)
        if not np.isnan(values).all():
            ends = {"lowest": values.min(axis=0), "highest": values.max(axis=0)}
            peaks[signal] = {name: end.tolist() for name, end in ends.items()}
    return {
        "scenario": scenario.name,
        "status": result.status,
        "time": float(result.time[-1]),
        "provenance": {**result.provenance},
        "statistics": asdict(result.statistics),
        "events": dict(Counter(event.element for event in result.events)),
        "signals": peaks,
        "outside_published": signals_outside(scenario, result),
        "limits": [excess._asdict() for excess in result.limits],
        "files": [str(file) for file in files],
    }
