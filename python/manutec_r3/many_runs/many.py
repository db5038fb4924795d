"""Many runs at once: on all processors of a machine, or on those of a cluster."""

from __future__ import annotations  # help() shows short names of types

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Any,
    NamedTuple,
    SupportsIndex,
    TypedDict,
    Unpack,
    get_args,
    overload,
)

import numpy as np

from .. import _core
from ..arguments import Floats
from ..errors import SimulationError
from ..events import Event, Events
from ..experiment import Experiment, Method
from ..files import parquet
from ..motion import Motion
from ..result import Result, Statistics
from ..robot import Robot
from ..scenario import Scenario
from ..simulation import InputLike, result_of, set_up, span
from .records import EventRecord, FinalRecord, PeakRecord, Record

if TYPE_CHECKING:
    from distributed import Client

Outcome = Result | EventRecord | FinalRecord | PeakRecord | Exception


class Results(Sequence[Any]):
    """What came of many runs, in their order.

    An entry is what `simulate_many` was asked to record of a run: a `Result`, `EventRecord`,
    `FinalRecord` or `PeakRecord`. If the run failed it is what `simulate` would have raised, as a
    value: a `SimulationError`, with all that was computed in its ``result``; a `ValueError`, if
    there is no start at rest; or what a function of the user's own has raised. It is None if the
    work was stopped before.
    """

    def __init__(self, entries: Iterable[Outcome | Finished | None]) -> None:
        self._entries = list(entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __getitem__(self, index: SupportsIndex | slice) -> Any:
        if isinstance(index, slice):
            return Results(self._entries[index])
        entry = self._entries[index]
        if isinstance(entry, Finished):  # nobody has asked for it before
            entry = self._entries[index] = entry.outcome()
        return entry

    @property
    def failures(self) -> dict[int, Exception]:
        """What ended runs that failed, by their place in the order."""
        failed = (k for k, entry in enumerate(self._entries) if _has_failed(entry))
        return {k: self[k] for k in failed}

    @property
    def n_finished(self) -> int:
        """Number of runs that have ended, one way or the other."""
        return sum(entry is not None for entry in self._entries)

    def __reduce__(self) -> tuple:
        return Results, (list(self),)

    def __repr__(self) -> str:
        unfinished = len(self) - self.n_finished
        return f"<Results of {len(self)} runs, {sum(map(_has_failed, self._entries))} failed" + (
            f", {unfinished} not finished>" if unfinished else ">"
        )


def _has_failed(entry: object) -> bool:
    return entry.core.failed if isinstance(entry, Finished) else isinstance(entry, Exception)


class Finished(NamedTuple):
    """A run that the core has done; what it is for Python is made when somebody asks for it."""

    job: Experiment
    core: _core.Outcome
    record: Record

    def outcome(self) -> Outcome:
        """Return what `simulate` would return or raise, or what is to be recorded of it."""
        core = self.core
        try:
            core.raise_failure()
        except _core.SimulationFailure as failure:
            branches = self._branches() if core.began else {}
            error = SimulationError(core.time, core.state, branches, str(failure))
        except Exception as raised:
            return raised
        else:
            return self._kept("completed")
        if core.began:
            error.result = self._kept(error.status)  # type: ignore[assignment] # or a record
        return error

    def _branches(self) -> dict[str, np.ndarray]:
        branches = self.core.branches
        return {name: branches[name] for name in self.job.setup.inputs.robot._compiled.elements}

    def _kept(self, status: str) -> Outcome:
        core, setup = self.core, self.job.setup
        if self.record == "all":
            return result_of(self.job, core, core.events(), core.seconds, status)
        statistics = Statistics(**core.statistics, seconds=core.seconds)
        inputs = setup.inputs
        of_run = (inputs.robot, inputs.motion, setup.method, setup.rtol, core.time, statistics)
        if self.record == "events":
            events = Events(Event(*event) for event in core.events())
            return EventRecord(*of_run, status, events)
        if self.record == "final":
            return FinalRecord(*of_run, status, core.signals, core.final_state, self._branches())
        return PeakRecord(*of_run, status, core.signals)


_Runs = Iterable[tuple[Robot, Motion | None] | Scenario]


class _Options(TypedDict, total=False):
    """Options of `simulate_many`, for type checkers."""

    rtol: float | None
    method: Method | None
    start: str | Floats | None
    times: Floats | None
    list_samples: bool
    motor_torque: InputLike | None
    command: InputLike | None
    tip_force: InputLike | None
    brakes: bool | Sequence[bool] | None
    record: Record
    workers: int | None
    progress: Callable[[int], None] | None
    client: Client | None


@overload
def simulate_many(
    runs: _Runs, t_end: float | None = None, *, to_parquet: None = None, **options: Unpack[_Options]
) -> Results: ...
@overload
def simulate_many(
    runs: _Runs, t_end: float | None = None, *, to_parquet: str | Path, **options: Unpack[_Options]
) -> Path: ...
def simulate_many(
    runs: Iterable[tuple[Robot, Motion | None] | Scenario],
    t_end: float | None = None,
    *,
    rtol: float | None = None,
    method: Method | None = None,
    start: str | Floats | None = None,
    times: Floats | None = None,
    list_samples: bool = False,
    motor_torque: InputLike | None = None,
    command: InputLike | None = None,
    tip_force: InputLike | None = None,
    brakes: bool | Sequence[bool] | None = None,
    record: Record = "all",
    workers: int | None = None,
    progress: Callable[[int], None] | None = None,
    client: Client | None = None,
    to_parquet: str | Path | None = None,
) -> Results | Path:
    """Simulate many robots, each with its motion, on all processors.

    Each run is bit by bit the one that `simulate` makes of it alone, however many there are at a
    time, on processors that use the same build (see `build_info`).

    Parameters
    ----------
    runs : iterable of (Robot, Motion) or Scenario
        What to simulate. Robots and motions may be the same objects in many runs. The arguments
        below are those of all runs; a scenario has its own for what is not given.
    t_end : float
        End of the runs [s].
    rtol, method, start, times, list_samples, motor_torque, command, tip_force, brakes
        As in `simulate`.
    record : {"all", "events", "final", "peaks"}
        What to keep of each run: everything, a `Result` of a few megabytes; its events; where it
        ended; the largest magnitude of each signal. A hundred thousand of these fit into memory.
    workers : int, optional
        Number of threads; default: as many as there are processors.
    progress : callable, optional
        Called with the number of finished runs now and then.
    client : distributed.Client, optional
        A Dask cluster that does the work instead, many runs at a time. Needs the extra ``dask``.
    to_parquet : str or Path, optional
        A folder that does not exist yet, for Parquet files with one row per run, instead of
        results in memory; see `manutec_r3.files.parquet`. On a cluster all workers must reach it.
        Needs the extra ``dask`` as well, and a `record` that is not everything.

    Returns
    -------
    Results
        A sequence in the order of the runs. A run that fails stands in its place as an exception:
        it does not end the others. With `to_parquet` the folder.

    Raises
    ------
    ValueError, TypeError
        Before anything is simulated: which run, what was wrong, what was expected, what arrived.

    Notes
    -----
    Functions of the user's own (`FunctionMotion`, `Input`) are called by one thread at a time.

    Ctrl-C, or what `progress` raises, ends the work within one step of the integrators and leaves
    no threads. The exception carries what was finished until then as ``results``, with None in
    the place of the other runs.

    Examples
    --------
    >>> motion = r3.Quintic(start=[0] * 6, end=[1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
    >>> robots = [r3.Robot(model=3, load=r3.Load(mass)) for mass in (0.0, 5.0, 15.0)]
    >>> peaks = r3.simulate_many([(robot, motion) for robot in robots], t_end=1.5, record="peaks")
    >>> [round(float(peak.motor_torque[1]), 2) for peak in peaks]  # of axis 2 [N m]
    [3.59, 4.2, 5.43]
    """
    given = {
        "rtol": rtol,
        "method": method,
        "start": start,
        "motor_torque": motor_torque,
        "command": command,
        "tip_force": tip_force,
        "brakes": brakes,
        "list_samples": list_samples or None,
    }
    given = {name: value for name, value in given.items() if value is not None}
    if record not in get_args(Record):
        expected = ", ".join(map(repr, get_args(Record)))
        raise ValueError(f"record: expected one of {expected}, got {record!r}")
    if progress is not None and not callable(progress):
        raise TypeError(
            f"progress: expected a function of the number of finished runs, got {progress!r}"
        )
    runs = list(runs)
    jobs = [_job(f"runs[{k}]", run, t_end, times, given) for k, run in enumerate(runs)]
    folder = None if to_parquet is None else parquet.checked_folder(to_parquet, record)
    if client is not None:
        if workers is not None:
            raise ValueError(
                f"workers: expected none with a client, which has its own, got {workers!r}"
            )
        from . import cluster  # which in turn needs what is here

        arguments = {"t_end": t_end, "times": times, "record": record, **given}
        return cluster.simulate(client, runs, arguments, folder, progress)
    n_workers = _number_of(workers)
    n_at_a_time = parquet.ROWS if folder else len(jobs) or 1
    for first in range(0, len(jobs) or 1, n_at_a_time):
        some = jobs[first : first + n_at_a_time]
        results, stopped = _simulate(some, record, n_workers, _after(first, progress))
        if folder is not None:
            parquet.write(folder, record, first, results)
        if stopped is not None:
            raise carrying(stopped, folder or results, first + results.n_finished, len(jobs))
    return folder or results


def _after(first: int, progress: Callable[[int], None] | None) -> Callable[[int], None] | None:
    """Return what is called with the number of finished runs of those after the `first`."""
    return None if progress is None else lambda n_finished: progress(first + n_finished)


def _job(
    name: str, run: Any, t_end: float | None, times: Floats | None, given: dict[str, Any]
) -> Experiment:
    """Check a run and return it; errors begin with its name."""
    try:
        if isinstance(run, Scenario):
            t_end = run.t_end if t_end is None else t_end
            arguments, scenario = run._arguments, run.source
        elif isinstance(run, tuple | list) and len(run) == 2:
            arguments, scenario = dict(zip(("robot", "motion"), run, strict=True)), ""
        else:
            raise TypeError(f"expected a pair of Robot and Motion, or a Scenario, got {run!r}")
        if t_end is None:
            raise TypeError("t_end: expected a time [s], got None")
        setup = set_up(**arguments | given)
        return Experiment(setup, *span(t_end, times), scenario=scenario)
    except (TypeError, ValueError) as error:
        kind = TypeError if isinstance(error, TypeError) else ValueError
        raise kind(f"{name}: {error}") from error


def _number_of(workers: int | None) -> int:
    """How many threads."""
    if workers is None:
        available = getattr(os, "sched_getaffinity", None)
        return len(available(0)) if available else os.cpu_count() or 1
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 1:
        raise ValueError(f"workers: expected a positive number of threads, got {workers!r}")
    return workers


def _simulate(
    jobs: list[Experiment], record: Record, n_workers: int, progress: Callable[[int], None] | None
) -> tuple[Results, BaseException | None]:
    """Return what came of runs, and what has ended the work before its time."""
    batch = _core.Batch([_run(job) for job in jobs], _core.Record[record])
    stopped = None
    try:
        batch.run(min(n_workers, len(jobs)), progress)
    except BaseException as exception:
        stopped = exception
    return Results(
        None if outcome is None else Finished(job, outcome, record)
        for job, outcome in zip(jobs, batch.outcomes, strict=True)
    ), stopped


def carrying(
    stopped: BaseException, results: Results | Path, n_finished: int, n: int
) -> BaseException:
    """Return what has ended the work, with what was finished until then."""
    stopped.results = results  # type: ignore[attr-defined] # for who catches it
    stopped.add_note(f"{n_finished} of {n} runs are finished: `results` of this exception")
    return stopped


def _run(job: Experiment) -> _core.Run:
    setup = job.setup
    return _core.Run(
        setup.inputs.robot._compiled,
        setup.inputs._compiled,
        setup.start,
        job.t_end,
        job.times,
        setup.rtol,
        _core.Method[setup.method],
        setup.list_samples,
        setup.held.of_axes,
        setup.held.tip_force,
        setup.brakes,
    )
