"""Commands that draw what came out of a run."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from .. import plot as pictures
from .app import SourceArgument, app, fail, result_of, say

Kind = Literal["figure9", "events", "friction", "backlash", "phase", "stroboscope"]
_OF_ONE_AXIS = ("friction", "backlash", "phase")


@app.command()
def plot(
    run: SourceArgument,
    kind: Annotated[Kind, typer.Option(help="Which picture.")] = "figure9",
    axis: Annotated[
        int | None, typer.Option(help=f"Of which axis; for {', '.join(_OF_ONE_AXIS)}; default: 1.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(help="File to write (.png, .pdf, .svg); default: from run and kind."),
    ] = None,
) -> None:
    """Draw a picture of a run.

    figure9: angles, errors and torques; events: which branch when; friction: torque over rate, on
    its characteristic; backlash: deflection of a gear with its gap; phase: rate over angle;
    stroboscope: the arm at equal intervals of time, as the report's Figure 8.
    """
    if axis is not None and kind not in _OF_ONE_AXIS:
        fail(f"axis: expected none for {kind}, got {axis}")
    of_axis = {} if axis is None else {"axis": axis}
    result = result_of(run)
    file = output or Path(f"{Path(run).stem}-{kind}.png")
    try:
        figure = pictures.new_figure()
        getattr(pictures, kind)(result, **of_axis, axes=figure)
        figure.savefig(file, dpi=300)
    except (ImportError, OSError, TypeError, ValueError) as error:
        fail(error)
    say(f"wrote {file}")


@app.command()
def animate(
    run: SourceArgument,
    output: Annotated[
        Path | None, typer.Option(help="File to write (.html); default: from the run.")
    ] = None,
    magnify: Annotated[
        float, typer.Option(help="Of the control error that the ghost shows, so many times.")
    ] = 1.0,
) -> None:
    """Write a page that shows a run in three dimensions, in any browser, without a network."""
    result = result_of(run)
    file = output or Path(f"{Path(run).stem}.html")
    try:
        result.animate(file, magnify=magnify)
    except (ImportError, OSError, TypeError, ValueError) as error:
        fail(error)
    say(f"wrote {file}")
