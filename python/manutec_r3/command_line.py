"""The command `manutec-r3`: runs scenarios, says what came out, writes it to a folder."""

import json
from collections import Counter
from itertools import groupby
from operator import attrgetter
from pathlib import Path
from typing import Annotated, NoReturn

import numpy as np
import typer
from rich import box
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from .bench import PARTS, for_markdown, for_terminal, machine
from .check import Check
from .check import check as compute_checks
from .errors import SimulationError
from .experiment import Method
from .plot import figure9, new_figure
from .result import Result
from .scenario import Scenario, scenarios

app = typer.Typer(
    help="Simulation of the industrial robot Manutec r3: arm, drives and controllers.",
    add_completion=False,
    no_args_is_help=True,
)
ScenarioArgument = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A name from `list`, or your own TOML file.")
]


def main() -> None:
    """Run the command line."""
    app()


@app.command()
def run(
    scenario: ScenarioArgument,
    rtol: Annotated[
        float | None, typer.Option(help="Relative tolerance; default: the scenario's.")
    ] = None,
    method: Annotated[
        Method | None, typer.Option(help="Integrator; default: the scenario's.")
    ] = None,
    output: Annotated[
        Path | None, typer.Option(help="Folder to write; default: the scenario's name.")
    ] = None,
) -> None:
    """Simulate a scenario, print a summary, write the result, its events and a picture."""
    experiment = _load(scenario)
    overrides = {"rtol": rtol, "method": method}
    overrides = {name: value for name, value in overrides.items() if value is not None}
    failure = None
    try:
        result = _simulate(experiment, overrides)
    except SimulationError as error:
        if error.result is None:
            _fail(error)
        failure, result = error, error.result
    except (TypeError, ValueError) as error:
        _fail(f"{scenario}: {error}")
    out = Console(highlight=False)
    _summarise(out, experiment, result)
    try:
        _write(out, experiment, result, output or Path(experiment.name))
    except OSError as error:
        _fail(error)
    if failure:
        _fail(f"{failure}; the folder holds what was computed until then")


@app.command("list")
def list_scenarios() -> None:
    """List the scenarios that come with the package."""
    table = Table(box=None, show_header=False, pad_edge=False)
    for name in scenarios():
        table.add_row(name, Scenario.load(name).description)
    Console(highlight=False).print(table)


@app.command()
def show(scenario: ScenarioArgument) -> None:
    """Print a scenario's TOML text: a start for your own."""
    print(_load(scenario).source, end="")


@app.command()
def check() -> None:
    """Compute published numbers on this machine, and compare; exit code 1 if any is missed."""
    checks = compute_checks()
    out = Console(highlight=False)
    out.print(_verdicts(checks))
    failed = sum(not row.passed for row in checks)
    if failed:
        _fail(f"{failed} of {len(checks)} checks failed")
    out.print(f"\nAll {len(checks)} checks passed.")


@app.command()
def bench(
    parts: Annotated[
        list[str] | None, typer.Argument(help=f"What to measure: {', '.join(PARTS)}; default: all.")
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, help="How often, side by side.")] = 30,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print Markdown.")] = False,
) -> None:
    """Measure work, error and time beside peers; exit code 1 if anything is wrong."""
    for part in parts or ():
        if part not in PARTS:
            _fail(f"parts: expected some of {', '.join(PARTS)}, got {part!r}")
    out, about, tables = Console(highlight=False), machine(), []
    if not as_json:
        separator = "; " if as_markdown else "\n"
        print(separator.join(f"{what}: {value}" for what, value in about.items()), end="\n\n")
    for part in parts or PARTS:
        tables.append(PARTS[part](repeats))
        if as_markdown:
            print(for_markdown(tables[-1]), flush=True)
        elif not as_json:
            out.print(for_terminal(tables[-1]))
            out.print()
    if as_json:
        print(json.dumps({"machine": about, "tables": [table.as_dict() for table in tables]}))
    wrong = [
        f"{table.part}: {row.name}" for table in tables for row in table.rows if not row.is_right
    ]
    if wrong:
        _fail(f"error or events are not as promised: {'; '.join(wrong)}")


def _load(name: str) -> Scenario:
    try:
        return Scenario.load(name)
    except (OSError, ValueError) as error:
        _fail(error)


def _simulate(scenario: Scenario, overrides: dict) -> Result:
    """Simulate, with a progress bar if someone watches."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed:.2f} of {task.total:g} s"),
        TimeElapsedColumn(),
    )
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    reached = 0.0

    def progress(time):
        nonlocal reached
        reached = time
        bar.update(task, completed=time)

    try:
        with bar:
            task = bar.add_task(scenario.name, total=scenario.t_end)
            return scenario.run(progress=progress, **overrides)
    except KeyboardInterrupt:
        console.print(f"interrupted at t = {reached:.3f} s, nothing is written", style="red")
        raise typer.Exit(130) from None


def _fail(message: str | Exception) -> NoReturn:
    """End with a message and exit code 1."""
    if isinstance(message, OSError):
        message = f"{message.filename}: {message.strerror}"
    console = Console(stderr=True, highlight=False, soft_wrap=True)
    console.print(f"[bold red]error:[/] {escape(str(message))}")
    raise typer.Exit(1)


# --- what came out ------------------------------------------------------------------------------

# What the summary shows of each signal: its unit, how many of them are one SI unit, and whether
# the largest magnitude or both ends of the range.
_SHOWN = {
    "joint_angle": ("rad", 1.0, "range"),
    "control_error": ("mrad", 1e3, "peak"),
    "motor_torque": ("N m", 1.0, "peak"),
}


def _summarise(out: Console, scenario: Scenario, result: Result) -> None:
    """Print the peaks of each axis beside the published ranges, excesses, events and the work."""
    out.print(f"[bold]{escape(scenario.name)}[/]  {escape(scenario.description)}\n")
    out.print(_peaks(scenario, result))
    out.print()
    if scenario.published:
        outside = _outside(scenario, result)
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
        heading = f"{_words(signal)}\n{shown}, {unit}"
        table.add_column(heading, footer=footer, justify="right", no_wrap=True)
    for axis, row in enumerate(zip(*cells, strict=True), start=1):
        table.add_row(str(axis), *row)
    return table


def _outside(scenario: Scenario, result: Result) -> list[str]:
    """Signals that leave their published range, each with its axis."""
    outside = []
    for signal, (lowest, highest) in scenario.published.items():
        values = getattr(result, signal)
        leaves = ((values < lowest) | (values > highest)).any(axis=0)
        outside += [f"{_words(signal)} of axis {axis}" for axis in 1 + np.flatnonzero(leaves)]
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
            _words(what),
            f"{times[0].limit:g} {times[0].unit}",
            f"{peak:.3g} {times[0].unit}",
            f"{times[0].begin:.3f} to {times[0].end:.3f}",
            str(len(times)),
        )
    return table


def _work(result: Result) -> Table:
    """Events by element, work and computing time."""
    work, simulated = result.statistics, float(result.time[-1])
    counts = Counter(_words(event.element) for event in result.events).most_common()
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


def _verdicts(checks: list[Check]) -> Table:
    """Tabulate what was expected and found, and by how much they differ."""
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, header_style="", pad_edge=False, leading=1)
    for heading in ("what\nsource", "expected", "found"):
        table.add_column(heading)
    table.add_column("deviation\nallowed", justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for row in checks:
        table.add_row(
            f"{escape(row.what)}\n[dim]{escape(row.source)}[/]",
            escape(row.expected),
            escape(row.found),
            f"{row.deviation:.1e}\n[dim]{row.tolerance:.1e}[/]",
            "passed" if row.passed else "[bold red]FAILED[/]",
        )
    return table


def _words(name: str) -> str:
    return name.replace("_", " ")


def _write(out: Console, scenario: Scenario, result: Result, folder: Path) -> None:
    """Write result, events and picture, and list them."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "result.npz", folder / "events.csv"]
    result.save(files[0])
    result.events.to_csv(files[1])
    missing = None
    try:
        picture = new_figure()
    except ImportError as error:
        missing = error
    else:
        figure9(result, picture)
        files.append(folder / f"{scenario.name}.png")
        picture.savefig(files[-1], dpi=300)
    out.print()
    for file in files:
        out.print(f"wrote {file}", markup=False, soft_wrap=True)
    if missing:
        out.print(f"no picture: {missing}", markup=False, soft_wrap=True)
