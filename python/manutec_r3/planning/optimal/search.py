"""From a first guess to a motion that keeps its limits everywhere.

A task is solved on equal pieces, from one guess or several. In a piece in which a motor torque
jumps from limit to limit no three points can keep it there, and when it jumps matters: such pieces
are cut into four, with more points. Elsewhere, and after that, points are added where limits are
exceeded between them, until they are not by more than a tolerance. The mesh never moves by itself:
a solver that may choose it finds motions that only the points believe in. Where accelerations are
to be continuous nothing jumps, and nothing is cut.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import OptimisationError
from .pieces import Pieces, Points
from .problem import Guess, Solution, Task, solve

# Radau's points leave out the beginning of a piece.
_BEGINNING = np.array([0.0])
_QUARTERS = np.array([0.0, 0.25, 0.5, 0.75])
# Where it is looked for limits that are exceeded.
_SAMPLES = np.linspace(0.0, 1.0, 41)
_MOST_ROUNDS = 8
# By how much of it a limit is exceeded between points where a torque jumps.
_JUMP = 0.003


@dataclass(frozen=True)
class Found:
    """An optimum.

    Attributes
    ----------
    solution : Solution
        With limits kept everywhere.
    objectives : tuple of float
        What each start has led to on equal pieces; infinite where the solver has failed.
    n_solves, iterations : int
        How often the solver ran, and its iterations in all.
    seconds : float
        Its time in all.
    """

    solution: Solution
    objectives: tuple[float, ...]
    n_solves: int
    iterations: int
    seconds: float


def optimum(task: Task, n_pieces: int, starts: int, limit_tolerance: float) -> Found:
    """Solve a task.

    Parameters
    ----------
    task : Task
        What is asked for.
    n_pieces : int
        Of the first mesh.
    starts : int
        How many guesses are tried on it; the best result is refined.
    limit_tolerance : float
        By how much of itself a limit may be exceeded.

    Raises
    ------
    OptimisationError
        If no start leads to a solution, or limits are exceeded after the last round.
    """
    pieces = Pieces(np.linspace(0.0, 1.0, n_pieces + 1))
    limit_points = Points.on_all(pieces.n, _BEGINNING)
    solved = [
        solve(task, pieces, limit_points, Guess(unknowns, _duration(task)))
        for unknowns in _guesses(task, pieces, starts)
    ]
    objectives = tuple(s.objective if s.succeeded else np.inf for s in solved)
    best = solved[int(np.argmin(objectives))]
    for may_cut in (not task.smooth, *[False] * _MOST_ROUNDS):
        if not best.succeeded:
            raise OptimisationError(f"IPOPT found no motion within the limits: {best.status}")
        excess = _excess(task, best)
        if excess.max() <= limit_tolerance:
            total = [sum(getattr(s, name) for s in solved) for name in ("iterations", "seconds")]
            return Found(best, objectives, len(solved), *total)
        limit_points = limit_points.and_also(_worst(excess, limit_tolerance))
        pieces, guess = best.pieces, Guess(best.unknowns, best.duration, True, best.multipliers)
        if may_cut:
            jumps = excess.max(axis=1) > _JUMP
            pieces, unknowns, limit_points = _cut(pieces, best.unknowns, limit_points, jumps)
            guess = Guess(unknowns, best.duration, True)  # other pieces have other constraints
        best = solve(task, pieces, limit_points, guess)
        solved.append(best)
    raise OptimisationError(
        f"limits are exceeded by {excess.max():.2g} of them between the points at which they hold, "
        f"expected at most {limit_tolerance:g}: try other n_pieces"
    )


def _cut(
    pieces: Pieces, unknowns: np.ndarray, limit_points: Points, which: np.ndarray
) -> tuple[Pieces, np.ndarray, Points]:
    """Cut some pieces (N,) of bool into four, with as many points on each."""
    first = np.cumsum(1 + 3 * which) - 1 - 3 * which  # what becomes of a piece, its first quarter
    kept = ~which[limit_points.piece]
    points = Points(first[limit_points.piece[kept]], limit_points.x[kept])
    halves, unknowns = pieces.halved(which, unknowns)
    quarters, unknowns = halves.halved(np.repeat(which, 1 + which), unknowns)
    new = np.flatnonzero(np.repeat(which, 1 + 3 * which))
    on_new = Points.on_all(len(new), _QUARTERS)
    return quarters, unknowns, points.and_also(Points(new[on_new.piece], on_new.x))


def _guesses(task: Task, pieces: Pieces, starts: int) -> list[np.ndarray]:
    """Return the straight line, then the same with random bows."""
    s = pieces.mesh[:, None]
    way = task.end - task.start
    no_bend = np.zeros((pieces.n, len(way)))
    straight = pieces.through(
        task.start + way * s**2 * (3.0 - 2.0 * s), 6.0 * way * s * (1.0 - s), no_bend
    )
    bow = pieces.through(np.sin(np.pi * s) ** 2, np.pi * np.sin(2.0 * np.pi * s), no_bend[:, :1])
    sizes = np.random.default_rng(0).uniform(-1.0, 1.0, (starts - 1, len(way)))  # [rad]
    return [straight, *(straight + bow * size for size in sizes)]


def _duration(task: Task) -> float:
    """Return a time to begin with [s]: half as much again as rates allow on the straight line."""
    if task.duration is not None:
        return task.duration
    return float(1.5 * np.max(1.5 * np.abs(task.end - task.start) / task.rate_limit))


def _excess(task: Task, solution: Solution) -> np.ndarray:
    """By how much of them limits are exceeded, by the core, at the samples (N, n) of the pieces."""
    q, qd, qdd = solution.at(Points.on_all(solution.pieces.n, _SAMPLES))
    torque = task.robot.inverse_dynamics(q, qd, qdd) / task.gear_ratio
    of_limits = np.abs(
        np.hstack((torque / task.torque_limit, qd / task.rate_limit, q / task.angle_limit))
    )
    return of_limits.max(axis=1).reshape(solution.pieces.n, -1) - 1.0


def _worst(excess: np.ndarray, tolerance: float) -> Points:
    """Where an excess is largest, as often as it is on a piece."""
    around = np.pad(excess, ((0, 0), (1, 1)), constant_values=-np.inf)
    peaks = (excess >= around[:, :-2]) & (excess >= around[:, 2:]) & (excess > 0.5 * tolerance)
    piece, sample = np.nonzero(peaks)
    return Points(piece, _SAMPLES[sample])
