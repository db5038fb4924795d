"""Many runs on a Dask cluster: robots and motions travel to its workers, results come back."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files import parquet
from .many import Results, carrying, simulate_many

if TYPE_CHECKING:
    from distributed import Client

# A task should take much longer than the millisecond that Dask needs for it; but there should be
# enough of them to keep all workers busy to the end, and to lose little with a worker.
_TASKS_PER_THREAD = 8


def simulate(
    client: "Client",
    runs: list,
    arguments: dict[str, Any],
    folder: Path | None,
    progress: Callable[[int], None] | None,
) -> Results | Path:
    """Simulate runs that have been checked, with `arguments` of `simulate_many`.

    A task is some runs. What a worker has not delivered when it is lost others do again.
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise ImportError("client: expected Dask; pip install 'manutec-r3[dask]'") from None
    if not isinstance(client, Client):
        raise TypeError(f"client: expected a distributed.Client, got {client!r}")
    n_threads = max(1, sum(client.nthreads().values()))
    size = min(max(1, len(runs) // (_TASKS_PER_THREAD * n_threads)), parquet.ROWS)
    results: list = [None] * len(runs)
    tasks = {}
    for first in range(0, len(runs), size):
        some = runs[first : first + size]
        future = client.submit(_task, some, arguments, folder, first, pure=False)
        tasks[future] = slice(first, first + len(some))
    n_finished = 0
    try:
        for future in as_completed(tasks):
            task = tasks[future]
            try:
                results[task] = future.result()
            except Exception as error:  # of the cluster: those of runs are among the results
                results[task] = [error] * len(results[task])
                if folder is not None:
                    parquet.write(folder, arguments["record"], task.start, results[task])
            future.release()
            n_finished += len(results[task])
            if progress is not None:
                progress(n_finished)
    except BaseException as stopped:
        client.cancel(list(tasks))
        raise carrying(stopped, folder or Results(results), n_finished, len(runs)) from None
    return folder or Results(results)


def _task(runs: list, arguments: dict[str, Any], folder: Path | None, first: int) -> list:
    """Simulate some runs; with a folder what came of them goes there."""
    results = simulate_many(runs, workers=1, **arguments)
    if folder is None:
        return list(results)
    parquet.write(folder, arguments["record"], first, results)
    return [None] * len(results)
