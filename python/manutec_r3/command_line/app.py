"""What the commands have in common: arguments, exit codes, where results come from, progress."""

import json
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from ..errors import SimulationError, SimulationInterrupted
from ..experiment import Method
from ..result import Result
from ..scenario import Scenario

# How a command ends: it is the answer of those that judge.
ANSWER_IS_NO = 1  # a check or a comparison fails, a run ends before its time
WRONG_INPUT = 2  # as of wrong options
INTERRUPTED = 130

app = typer.Typer(
    help="Simulation of the industrial robot Manutec r3: arm, drives and controllers.",
    epilog=(
        "Exit codes: 0 done; 1 a check or comparison fails, or a run ended before its time; "
        "2 wrong input; 130 interrupted."
    ),
    no_args_is_help=True,
)

ScenarioArgument = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A name from `list`, or your own TOML file.")
]
SourceArgument = Annotated[
    str,
    typer.Argument(
        metavar="RUN", help="A name from `list`, a TOML file, or a result file (.npz, .nc)."
    ),
]
RtolOption = Annotated[
    float | None, typer.Option(help="Relative tolerance; default: the scenario's.")
]
MethodOption = Annotated[Method | None, typer.Option(help="Integrator; default: the scenario's.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON, for machines.")]


def console() -> Console:
    """Return what prints on the terminal as it is now."""
    return Console(highlight=False)


def say(text: str) -> None:
    """Print a line as it is."""
    console().print(text, markup=False, soft_wrap=True)


def print_json(data: Any) -> None:
    """Print data; what is not a number becomes null."""
    print(json.dumps(_without_nan(data), indent=2))


def _without_nan(data: Any) -> Any:
    if isinstance(data, dict):
        return {key: _without_nan(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_without_nan(value) for value in data]
    return None if data != data else data


def fail(message: str | Exception, code: int = WRONG_INPUT) -> NoReturn:
    """End with a message."""
    if isinstance(message, OSError):
        message = f"{message.filename}: {message.strerror}"
    terminal = Console(stderr=True, highlight=False, soft_wrap=True)
    terminal.print(f"[bold red]error:[/] {escape(str(message))}")
    raise typer.Exit(code)


def scenario_of(name: str) -> Scenario:
    """Load a scenario, or end with what is wrong."""
    try:
        return Scenario.load(name)
    except (OSError, ValueError) as error:
        fail(error)


def result_of(source: str) -> Result:
    """Run a scenario, or load a result file: whole, or it ends with the reason."""
    if Path(source).suffix in (".npz", ".nc"):
        try:
            return Result.load(source)
        except (ImportError, OSError, ValueError) as error:
            fail(error)
    result, end = simulate(scenario_of(source))
    if end is not None:
        stop(end)
    return result


def stop(end: SimulationError | SimulationInterrupted, remark: str = "") -> NoReturn:
    """End with the reason why a run has."""
    interrupted = isinstance(end, SimulationInterrupted)
    fail(f"{end}{remark}", INTERRUPTED if interrupted else ANSWER_IS_NO)


def simulate(
    scenario: Scenario, **overrides: Any
) -> tuple[Result, SimulationError | SimulationInterrupted | None]:
    """Simulate, with a progress bar if someone watches, or end because it could not begin.

    Returns
    -------
    result : Result
        As far as it came.
    end : SimulationError or SimulationInterrupted or None
        Why it ended before its time, if it did.
    """
    given = {name: value for name, value in overrides.items() if value is not None}
    try:
        with _Bar(scenario) as bar:
            return scenario.run(progress=bar.update, **given), None
    except (SimulationError, SimulationInterrupted) as end:
        if end.result is None:
            stop(end)
        return end.result, end
    except (TypeError, ValueError) as error:
        fail(f"{scenario.name}: {error}")


class _Bar:
    """Time simulated, speed and events, on a terminal only."""

    def __init__(self, scenario: Scenario) -> None:
        terminal = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.completed:.2f} of {task.total:g} s"),
            TextColumn("{task.fields[events]} events"),
            TextColumn("{task.fields[speed]}"),
            TimeElapsedColumn(),
            console=terminal,
            transient=True,
            disable=not terminal.is_terminal,
        )
        self._task = self._progress.add_task(
            scenario.name, total=scenario.t_end, events=0, speed=""
        )

    def __enter__(self) -> "_Bar":
        self._progress.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._progress.stop()

    def update(self, time: float, n_events: int) -> None:
        """Show how far it has come."""
        elapsed = self._progress.tasks[self._task].elapsed
        speed = f"{time / elapsed:.3g} times real time" if elapsed else ""
        self._progress.update(self._task, completed=time, events=n_events, speed=speed)
