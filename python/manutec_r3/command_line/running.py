"""Commands that run scenarios and show them."""

from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from ..plot import figure9, new_figure
from ..result import Result
from ..scenario import Scenario, scenarios
from .app import (
    JsonOption,
    MethodOption,
    RtolOption,
    ScenarioArgument,
    app,
    console,
    fail,
    print_json,
    say,
    scenario_of,
    simulate,
    stop,
)
from .summary import as_data, summarise


@app.command()
def run(
    scenario: ScenarioArgument,
    rtol: RtolOption = None,
    method: MethodOption = None,
    output: Annotated[
        Path | None, typer.Option(help="Folder to write; default: the scenario's name.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Simulate a scenario; print a summary; write the result, its events and a picture.

    The folder then holds result.npz, which `plot`, `animate` and `compare` read as well as
    `manutec_r3.Result.load` in Python; events.csv, a line for each event; and a picture in the
    manner of the report's Figure 9, if Matplotlib is installed. Interrupted with Ctrl-C, it holds
    what was computed until then.

    Examples: `manutec-r3 run figure9`; `manutec-r3 run mine.toml --rtol 1e-9 --output accurate`.
    """
    experiment = scenario_of(scenario)
    result, end = simulate(experiment, rtol=rtol, method=method)
    try:
        files, missing = _write(experiment, result, output or Path(experiment.name))
    except OSError as error:
        fail(error)
    if as_json:
        print_json(as_data(experiment, result, files))
    else:
        summarise(console(), experiment, result)
        console().print()
        for file in files:
            say(f"wrote {file}")
        if missing:
            say(f"no picture: {missing}")
    if end is not None:
        stop(end, "; the folder holds what was computed until then")


@app.command("list")
def list_scenarios(as_json: JsonOption = False) -> None:
    """List the scenarios that come with the package."""
    described = {name: Scenario.load(name).description for name in scenarios()}
    if as_json:
        print_json(described)
        return
    table = Table(box=None, show_header=False, pad_edge=False)
    for name, description in described.items():
        table.add_row(name, description)
    console().print(table)


@app.command()
def show(scenario: ScenarioArgument) -> None:
    """Print a scenario's TOML text: a start for your own."""
    print(scenario_of(scenario).source, end="")


def _write(
    scenario: Scenario, result: Result, folder: Path
) -> tuple[list[Path], ImportError | None]:
    """Write result, events and picture. Return the files, and what keeps the picture away."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "result.npz", folder / "events.csv"]
    result.save(files[0])
    result.events.to_csv(files[1])
    try:
        picture = new_figure()
    except ImportError as error:
        return files, error
    figure9(result, picture)
    files.append(folder / f"{scenario.name}.png")
    picture.savefig(files[-1], dpi=300)
    return files, None
