"""Commands that write the robot for other programs."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from ..export import export_fmu, export_mjcf, export_urdf
from ..export.fmu.archive import FmiVersion, ReferenceOf
from ..robot import Robot
from .app import JsonOption, ScenarioArgument, app, fail, print_json, say, scenario_of

export = typer.Typer(help="Write the robot for other programs.", no_args_is_help=True)
app.add_typer(export, name="export")

OutputOption = Annotated[
    Path | None, typer.Option("--output", "-o", help="File to write; default: the scenario's name.")
]


@export.command()
def fmu(
    scenario: ScenarioArgument,
    output: OutputOption = None,
    fmi: Annotated[FmiVersion, typer.Option(help="Version of the standard.")] = "3.0",
    reference: Annotated[
        ReferenceOf, typer.Option(help="What the position controllers follow.")
    ] = "motion",
    as_json: JsonOption = False,
) -> None:
    """Write the whole robot as an FMU, for Model Exchange and Co-Simulation.

    Options, motion and start are those of the scenario; load, tables, torques or commands, and a
    force on the tip can be changed by the importer.

    Example: `manutec-r3 export fmu figure9 -o robot.fmu --fmi 2.0`.
    """
    what = scenario_of(scenario)
    file = output or Path(f"{what.name}.fmu")
    try:
        export_fmu(what, file, fmi=fmi, reference=reference)
    except (OSError, ValueError) as error:
        fail(error)
    if as_json:
        print_json({"file": str(file), "fmi": fmi})
        return
    say(f"wrote {file}")


@export.command()
def urdf(
    scenario: ScenarioArgument, output: OutputOption = None, as_json: JsonOption = False
) -> None:
    """Write the arm with ideal gears as URDF; say what URDF cannot."""
    _write(export_urdf, scenario, output, ".urdf", as_json)


@export.command()
def mjcf(
    scenario: ScenarioArgument, output: OutputOption = None, as_json: JsonOption = False
) -> None:
    """Write the arm with ideal gears as MJCF, the format of MuJoCo; say what MJCF cannot."""
    _write(export_mjcf, scenario, output, ".xml", as_json)


def _write(
    to_file: Callable[[Robot, Path], Sequence[str]],
    name: str,
    output: Path | None,
    suffix: str,
    as_json: bool,
) -> None:
    scenario = scenario_of(name)
    file = output or Path(f"{scenario.name}{suffix}")
    try:
        remarks = to_file(scenario.robot, file)
    except (OSError, ValueError) as error:
        fail(error)
    if as_json:
        print_json({"file": str(file), "remarks": remarks})
        return
    say(f"wrote {file}")
    for remark in remarks:
        say(f"* {remark}")
