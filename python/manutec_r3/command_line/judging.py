"""Commands that judge: exit code 1 if the answer is no."""

import json
from typing import Annotated

import typer
from rich import box
from rich.markup import escape
from rich.table import Table

from ..bench import PARTS, for_markdown, for_terminal, machine
from ..comparison import Check
from ..comparison import check as compute_checks
from ..comparison import compare as compare_results
from .app import (
    ANSWER_IS_NO,
    JsonOption,
    SourceArgument,
    app,
    console,
    fail,
    print_json,
    result_of,
    say,
)


@app.command()
def check(as_json: JsonOption = False) -> None:
    """Compute published numbers on this machine, and compare."""
    checks = compute_checks()
    failed = sum(not row.passed for row in checks)
    if as_json:
        print_json([row._asdict() | {"passed": row.passed} for row in checks])
    else:
        console().print(_verdicts(checks))
    if failed:
        fail(f"{failed} of {len(checks)} checks failed", ANSWER_IS_NO)
    if not as_json:
        console().print(f"\nAll {len(checks)} checks passed.")


@app.command()
def compare(
    run: SourceArgument,
    reference: Annotated[
        str,
        typer.Argument(
            metavar="REFERENCE",
            help="The same, or a file of reference curves (.csv): a first column of time [s], then "
            "columns such as joint_angle[1].",
        ),
    ],
    width: Annotated[
        float,
        typer.Option(help="Reach of the tube to either side, in parts of time and of each range."),
    ] = 2e-3,
    as_json: JsonOption = False,
) -> None:
    """Say where two runs part: curves that leave a tube around the reference, and events."""
    judged = result_of(run)
    by = reference if reference.endswith(".csv") else result_of(reference)
    try:
        compared = compare_results(judged, by, width=width)
    except (OSError, TypeError, ValueError) as error:
        fail(error)
    agrees = compared.agrees and compared.events_agree is not False
    if as_json:
        print_json(
            {
                "agrees": agrees,
                "events_agree": compared.events_agree,
                "begin": compared.begin,
                "end": compared.end,
                "curves": [
                    {
                        "signal": curve.signal,
                        "axis": curve.axis,
                        "unit": curve.unit,
                        "deviation": curve.deviation,
                        "relative_deviation": curve.relative_deviation,
                        "instant": curve.instant,
                        "leaves_at": curve.leaves_at,
                    }
                    for curve in compared.curves
                ],
            }
        )
    else:
        say(str(compared))
    if not agrees:
        raise typer.Exit(ANSWER_IS_NO)


@app.command()
def bench(
    parts: Annotated[
        list[str] | None, typer.Argument(help=f"What to measure: {', '.join(PARTS)}; default: all.")
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, help="How often, side by side.")] = 30,
    as_json: JsonOption = False,
    as_markdown: Annotated[bool, typer.Option("--markdown", help="Print Markdown.")] = False,
) -> None:
    """Measure work, error and time beside peers; exit code 1 if anything is wrong."""
    for part in parts or ():
        if part not in PARTS:
            fail(f"parts: expected some of {', '.join(PARTS)}, got {part!r}")
    about, tables = machine(), []
    if not as_json:
        separator = "; " if as_markdown else "\n"
        print(separator.join(f"{what}: {value}" for what, value in about.items()), end="\n\n")
    for part in parts or PARTS:
        tables.append(PARTS[part](repeats))
        if as_markdown:
            print(for_markdown(tables[-1]), flush=True)
        elif not as_json:
            console().print(for_terminal(tables[-1]))
            console().print()
    if as_json:
        print(json.dumps({"machine": about, "tables": [table.as_dict() for table in tables]}))
    wrong = [
        f"{table.part}: {row.name}" for table in tables for row in table.rows if not row.is_right
    ]
    if wrong:
        fail(f"error or events are not as promised: {'; '.join(wrong)}", ANSWER_IS_NO)


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
