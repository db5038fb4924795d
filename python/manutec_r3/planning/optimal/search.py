"""From a first guess to a motion that keeps its limits everywhere.

A task is solved on equal pieces, from one guess or several. In a piece in which a motor torque
jumps from limit to limit no three points can keep it there, and when it jumps matters: such pieces
are cut into four, with more points. Elsewhere, and after that, points are added where limits are
exceeded between them, until they are not by more than a tolerance. The mesh never moves by itself:
a solver that may choose it finds motions that only the points believe in. Where accelerations are
to be continuous nothing jumps, and nothing is cut.
"""

from dataclasses import dataclass, replace

import numpy as np

from ...errors import OptimisationError
from .pieces import RADAU_POINTS, RADAU_WEIGHTS, Pieces, Points
from .problem import Guess, Solution, Task, Trial, solve

# Radau's points leave out the beginning of a piece.
_BEGINNING = np.array([0.0])
_QUARTERS = np.array([0.0, 0.25, 0.5, 0.75])
# Where it is looked for limits that are exceeded: between two, a parabola of accelerations can be
# higher by less than 1e-3 of what it changes by on its piece.
SAMPLES = np.linspace(0.0, 1.0, 41)
# Up to five have been needed for random ends, loads and meshes.
_MOST_ROUNDS = 8
_LARGEST_BOW = 1.0  # [rad]
# Of the torque limit, beside the weight of the arm.
_WORTH_MENTIONING = 0.1
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
    guesses = _guesses(task, pieces, starts)
    # The solver's tolerances are for an objective that is about 1.
    scale = _objective(task, guesses[0])
    task = replace(
        task, time_weight=task.time_weight / scale, effort_weight=task.effort_weight / scale
    )
    solved = [solve(task, limit_points, guess) for guess in guesses]
    objectives = tuple(scale * s.objective if s.succeeded else np.inf for s in solved)
    best = solved[int(np.argmin(objectives))]
    for n_rounds in range(_MOST_ROUNDS + 1):
        if not best.succeeded:
            raise OptimisationError(f"IPOPT found no motion within the limits: {best.status}")
        excess = _excess(task, best)
        if excess.max() <= limit_tolerance:
            total = [sum(getattr(s, name) for s in solved) for name in ("iterations", "seconds")]
            return Found(best, objectives, len(solved), *total)
        if n_rounds == _MOST_ROUNDS:
            break
        limit_points = limit_points.and_also(_worst(excess, limit_tolerance))
        if n_rounds == 0 and not task.smooth:
            guess, limit_points = _cut(best, limit_points, excess.max(axis=1) > _JUMP)
        else:
            guess = Guess(
                best.pieces,
                best.unknowns,
                best.duration,
                is_nearby=True,
                multipliers=best.multipliers,
            )
        best = solve(task, limit_points, guess)
        solved.append(best)
    raise OptimisationError(
        f"limits are exceeded by {excess.max():.2g} of them between the points at which they hold, "
        f"expected at most {limit_tolerance:g}: try other n_pieces"
    )


def _cut(solution: Solution, limit_points: Points, which: np.ndarray) -> tuple[Guess, Points]:
    """Cut some pieces (N,) of bool into four, with as many points on each."""
    first = np.cumsum(1 + 3 * which) - 1 - 3 * which  # what becomes of a piece, its first quarter
    kept = ~which[limit_points.piece]
    points = Points(first[limit_points.piece[kept]], limit_points.x[kept])
    halves, unknowns = solution.pieces.halved(which, solution.unknowns)
    quarters, unknowns = halves.halved(np.repeat(which, 1 + which), unknowns)
    new = np.flatnonzero(np.repeat(which, 1 + 3 * which))
    on_new = Points.on_all(len(new), _QUARTERS)
    # Other pieces have other constraints: no multipliers.
    guess = Guess(quarters, unknowns, solution.duration, is_nearby=True)
    return guess, points.and_also(Points(new[on_new.piece], on_new.x))


def _guesses(task: Task, pieces: Pieces, starts: int) -> list[Guess]:
    """Return the straight line, then the same with random bows."""
    s = pieces.mesh[:, None]
    way = task.end - task.start
    no_bend = np.zeros((pieces.n, len(way)))
    straight = pieces.through(
        task.start + way * s**2 * (3.0 - 2.0 * s), 6.0 * way * s * (1.0 - s), no_bend
    )
    bow = pieces.through(np.sin(np.pi * s) ** 2, np.pi * np.sin(2.0 * np.pi * s), no_bend[:, :1])
    sizes = np.random.default_rng(0).uniform(-_LARGEST_BOW, _LARGEST_BOW, (starts - 1, len(way)))
    duration = task.duration or _duration(task, pieces, straight)
    return [Guess(pieces, straight + bow * size, duration) for size in (0.0 * way, *sizes)]


def _duration(task: Task, pieces: Pieces, straight: np.ndarray) -> float:
    """Return a time to begin with [s], in which the straight line keeps the limits nearly.

    The largest rate of a cubic from rest to rest is 1.5 times its mean; half of the time is added.
    Torques are weight plus something over the square of the time: it must fit into what the weight
    leaves, as far as that is worth mentioning.
    """
    by_rates = 1.5 * 1.5 * np.max(np.abs(task.end - task.start) / task.rate_limit)
    points = Points.on_all(pieces.n, RADAU_POINTS)
    in_a_second = Trial(pieces, straight, 1.0)
    q, qd, qdd = in_a_second.at(points)
    weight = task.robot.inverse_dynamics(q, 0.0 * qd, 0.0 * qdd) / task.gear_ratio
    moving = np.abs(in_a_second.motor_torque(task, points) - weight)
    left = np.maximum(task.torque_limit - np.abs(weight), _WORTH_MENTIONING * task.torque_limit)
    return float(max(by_rates, np.sqrt(np.max(moving / left))))


def _objective(task: Task, guess: Guess) -> float:
    """Return a T + b E."""
    effort = guess.effort(task, RADAU_POINTS, RADAU_WEIGHTS)
    return task.time_weight * guess.duration + task.effort_weight * effort


def _excess(task: Task, solution: Solution) -> np.ndarray:
    """By how much of them limits are exceeded, by the core, at the samples (N, n) of the pieces."""
    points = Points.on_all(solution.pieces.n, SAMPLES)
    q, qd, _ = solution.at(points)
    torque = solution.motor_torque(task, points)
    of_limits = np.abs(
        np.hstack((torque / task.torque_limit, qd / task.rate_limit, q / task.angle_limit))
    )
    return of_limits.max(axis=1).reshape(solution.pieces.n, -1) - 1.0


def _worst(excess: np.ndarray, tolerance: float) -> Points:
    """Where an excess is largest, as often as it is on a piece."""
    around = np.pad(excess, ((0, 0), (1, 1)), constant_values=-np.inf)
    peaks = (excess >= around[:, :-2]) & (excess >= around[:, 2:]) & (excess > 0.5 * tolerance)
    piece, sample = np.nonzero(peaks)
    return Points(piece, SAMPLES[sample])
