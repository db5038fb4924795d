"""How long runs take: methods side by side at stated errors, recording, many runs at once."""

import json
import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from time import perf_counter
from typing import Any, Literal, get_args

import numpy as np

import manutec_r3 as r3

from .. import _core
from ..comparison.accuracy import PROMISED, Recorded, inside_steps, largest_errors, sequence
from ..events import Event
from ..experiment import Method
from ..result import Result
from ..robot import Load
from ..scenario import Scenario
from ..simulation import Simulator
from .report import Row, Table
from .timing import Timing, side_by_side

# Far tighter than what is judged by it.
_EXACT = 1e-12
# From loose to tight: the first that is right is enough for a run.
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)


@dataclass(frozen=True)
class Outcome:
    """How right a run is, and what it took.

    Attributes
    ----------
    error : float
        Largest of control errors and motor torques, in parts of the range of its axis.
    same_events : bool
        Whether all events are those of the exact run.
    evaluations, steps : int
        Of the right-hand side; accepted.
    """

    error: float
    same_events: bool
    evaluations: int
    steps: int

    @property
    def is_right(self) -> bool:
        """Whether it is as right as default tolerances promise."""
        return self.same_events and self.error <= PROMISED

    def row(self, name: str, time: Timing) -> Row:
        """Return it with its name and its time."""
        work = f"{self.evaluations} evaluations, {self.steps} steps"
        return Row(name, time, work, self.error, PROMISED, self.same_events)


def exact_run(scenario: Scenario) -> Result:
    """Return what others are judged by."""
    return scenario.run(method="erk", rtol=_EXACT)


def outcome(result: Result, exact: Result) -> Outcome:
    """Judge a run at its steps and between them."""
    work = result.statistics
    now = result.at(inside_steps(result))
    return _judged(now, result.events, exact, work.evaluations, work.steps)


def _judged(
    got: Recorded, events: Iterable[Event], exact: Result, evaluations: int, steps: int
) -> Outcome:
    error = max(largest_errors(got, exact).values())
    same_events = sequence(events) == sequence(exact.events)
    return Outcome(error, same_events, evaluations, steps)


def bare_run(scenario: Scenario, **options: Any) -> Callable[[], np.ndarray]:
    """Return a program that simulates and keeps nothing but the last state."""

    def program() -> np.ndarray:
        simulator = Simulator(**scenario._arguments | options)
        simulator.step(scenario.t_end)
        return simulator.state

    return program


# --- methods side by side -----------------------------------------------------------------------


def figure9(repeats: int) -> Table:
    """Time the benchmark run by all methods, and by SciPy."""
    return _methods(
        "figure9",
        "Figure 9, 1.5 s of model 3 with 15 kg",
        Scenario.load("figure9-quintic"),
        repeats,
        notes=f"{_NOTES} SciPy: `solve_ivp` from Python, with event functions.",
        with_scipy=True,
    )


def sampled(repeats: int) -> Table:
    """Time the benchmark run with sampled position controllers."""
    scenario = Scenario.load("figure9-quintic")
    scenario = replace(scenario, robot=scenario.robot.replace(controller="sampled"))
    return _methods(
        "sampled", "The same, position controllers sampled every 8 ms", scenario, repeats
    )


def full_robot(repeats: int) -> Table:
    """Time the Modelica variant beside what is published of it."""
    table = _methods(
        "full-robot", "FullRobot of the Modelica variant", Scenario.load("full-robot"), repeats
    )
    reference = files("manutec_r3.comparison") / "references" / "full_robot.json"
    published = json.loads(reference.read_text(encoding="utf-8"))["published_work"]
    seconds = published["seconds"]
    row = Row(published["by"], Timing(seconds, seconds), published["work"])
    return replace(table, rows=[*table.rows, row], notes=f"{table.notes} {published['about']}")


_NOTES = (
    "Methods with their rtol; nothing is recorded. Error: largest of control errors and motor "
    f"torques in parts of the range of its axis, against a run at rtol {_EXACT:g}, at steps and, "
    "but for SciPy, between them. Enough here: the loosest power of ten that gives the same events "
    f"and an error below {PROMISED:g}."
)


def _methods(
    part: str,
    title: str,
    scenario: Scenario,
    repeats: int,
    notes: str = "Errors as in figure9.",
    with_scipy: bool = False,
) -> Table:
    exact = exact_run(scenario)
    programs: dict[str, Callable[[], object]] = {}
    outcomes = {}
    for method in sorted(get_args(Method), key=lambda method: method != exact.method):
        for name, result in _runs(scenario, exact, method):
            programs[name] = bare_run(scenario, method=method, rtol=result.rtol)
            outcomes[name] = outcome(result, exact)
        if method == "exponential":  # what the last row takes if no run has been before
            cold = f"{name}, first run"
            programs[cold], outcomes[cold] = _cold(programs[name]), outcomes[name]
    missing = []
    if with_scipy:
        try:
            name, program, found = _by_scipy(scenario, exact)
        except ImportError as reason:
            missing = [Row("SciPy", None, f"not measured: {reason}")]
        else:
            programs[name], outcomes[name] = program, found
    timings = side_by_side(programs, repeats)
    rows = [outcomes[name].row(name, timings[name]) for name in programs]
    return Table(part, title, "ms", [*rows, *missing], notes)


def _runs(scenario: Scenario, exact: Result, method: Method) -> Iterator[tuple[str, Result]]:
    """Simulate at the default tolerance; and, as that is for any motion, as loosely as will do."""
    usual = scenario.run(method=method)
    yield f"{method} {usual.rtol:g}, default", usual
    for rtol in TOLERANCES:
        if rtol <= usual.rtol:
            break
        result = scenario.run(method=method, rtol=rtol)
        if outcome(result, exact).is_right:
            yield f"{method} {rtol:g}, enough here", result
            break


def _cold(program: Callable[[], object]) -> Callable[[], object]:
    """Return a program that begins without the matrices that runs of one robot share."""

    def forgetful() -> object:
        _core.forget_propagators()
        return program()

    return forgetful


def _by_scipy(scenario: Scenario, exact: Result) -> tuple[str, Callable[[], object], Outcome]:
    """Simulate by SciPy, as loosely as will do."""
    from . import scipy_run

    for rtol in TOLERANCES:
        run = scipy_run.run(scenario, rtol)
        found = _judged(run, run.events, exact, run.evaluations, run.steps)
        if found.is_right:
            break
    name = f"SciPy {scipy_run.METHOD} {rtol:g}, enough here"
    return name, partial(scipy_run.run, scenario, rtol), found


# --- as an FMU ----------------------------------------------------------------------------------


def exported(repeats: int) -> Table:
    """Time the benchmark run beside its FMU in another program."""
    scenario = Scenario.load("figure9-quintic")
    exact = exact_run(scenario)
    usual = scenario.run()
    names = [f"{usual.method} {usual.rtol:g}, default"]
    programs: dict[str, Callable[[], object]] = {names[0]: bare_run(scenario)}
    rows = {names[0]: outcome(usual, exact).row}
    title = "Figure 9 as an FMU"
    try:
        from .fmpy_run import ExportedRun, version
    except ImportError as reason:
        timings = side_by_side(programs, repeats)
        found = [rows[names[0]](names[0], timings[names[0]])]
        missing = Row("FMPy", None, f"not measured: {reason}")
        return Table("fmu", title, "ms", [*found, missing], "Errors as in figure9.")
    kinds: dict[Literal["ModelExchange", "CoSimulation"], float] = {
        "ModelExchange": 1e-8,
        "CoSimulation": usual.rtol,
    }
    with ExportedRun(scenario) as fmu:
        for kind, rtol in kinds.items():
            ours = [event for event in exact.events if event.element != "reference"]
            got = fmu.run(kind, rtol)
            error = max(largest_errors(got, exact).values())
            same = sequence(got.events) == sequence(ours)
            name = f"FMPy {version}, {kind} {rtol:g}"
            programs[name] = partial(fmu.last_angles, kind, rtol)
            rows[name] = partial(_fmu_row, kind, error, same)
        timings = side_by_side(programs, repeats)
    return Table(
        "fmu",
        title,
        "ms",
        [rows[name](name, timings[name]) for name in programs],
        "Model Exchange: FMPy's CVODE integrates; Co-Simulation: we do, inside the FMU. FMPy calls "
        "both from Python, every 10 ms and at events. Errors as in figure9, where it records.",
    )


def _fmu_row(kind: str, error: float, same: bool, name: str, time: Timing) -> Row:
    work = "CVODE, BDF" if kind == "ModelExchange" else "our integrator"
    return Row(name, time, work, error, PROMISED, same)


# --- recording ----------------------------------------------------------------------------------


def recording(repeats: int) -> Table:
    """Time what results and signals add to a run, by the default method and by the quickest."""
    scenario = Scenario.load("figure9-quintic")
    times = np.linspace(0.0, scenario.t_end, 1000)

    def programs_of(method: Method) -> dict[str, Callable[[], object]]:
        return {
            f"{method}: nothing": bare_run(scenario, method=method),
            f"{method}: all signals at 1000 times": (
                lambda: scenario.run(method=method, times=times).motor_torque
            ),
            f"{method}: all signals at every step": (
                lambda: scenario.run(method=method).motor_torque
            ),
        }

    programs = programs_of("erk") | programs_of("exponential")
    timings = side_by_side(programs, repeats)
    return Table(
        "recording",
        "Figure 9, by what is recorded",
        "ms",
        [Row(name, timings[name]) for name in programs],
        "All signals of all axes are read once.",
    )


# --- many runs ----------------------------------------------------------------------------------

_N_RUNS = 100


def many_runs(repeats: int) -> Table:
    """Time many runs by `simulate_many`, beside processes that share them."""
    scenario = Scenario.load("figure9-quintic")
    masses = np.linspace(0.0, 15.0, _N_RUNS)
    runs = [(scenario.robot.replace(load=Load(mass)), scenario.motion) for mass in masses]
    n = os.cpu_count() or 1
    shares = [(runs[k::n], scenario.t_end) for k in range(n)]
    with ProcessPoolExecutor(n) as pool:

        def by_processes() -> list[np.ndarray]:
            states: list[Any] = [None] * len(runs)
            for k, share in enumerate(pool.map(_last_states, *zip(*shares, strict=True))):
                states[k::n] = share
            return states

        def by_simulate_many() -> list[np.ndarray]:
            finals = r3.simulate_many(runs, t_end=scenario.t_end, record="final", workers=n)
            return [final.state for final in finals]

        off = float(np.abs(np.subtract(by_simulate_many(), by_processes())).max())
        programs = {f"{n} processes": by_processes, f"simulate_many, {n} threads": by_simulate_many}
        timings = side_by_side(programs, repeats, clock=perf_counter)
    names = list(programs)
    return Table(
        "many-runs",
        f"{_N_RUNS} runs of Figure 9 with loads from 0 to 15 kg",
        "ms",
        [
            Row(names[0], timings[names[0]], "one run after the other in each"),
            Row(names[1], timings[names[1]], "record final", off, allowed=0.0),
        ],
        "Wall-clock time. Error: of the last states, which must be equal bit by bit.",
    )


def _last_states(runs: Sequence[tuple], t_end: float) -> list[np.ndarray]:
    states = []
    for robot, motion in runs:
        simulator = Simulator(robot, motion)
        simulator.step(t_end)
        states.append(simulator.state)
    return states
