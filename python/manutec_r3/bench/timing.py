"""How long programs take, side by side on a machine that has other work as well.

They take turns, so that what disturbs one disturbs all; the least of many times is what a program
takes when nothing disturbs it.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from time import process_time

# Beyond so many seconds a program is not run again, but for the three times that make a median.
_BUDGET = 3.0
_FEWEST = 3

one, many = 1, 256  # turns of a loop


@dataclass(frozen=True)
class Timing:
    """Time [s] of one execution.

    Attributes
    ----------
    minimum, median : float
        Of all repeats.
    """

    minimum: float
    median: float


def side_by_side(
    programs: Mapping[str, Callable[[], object]],
    repeats: int,
    clock: Callable[[], float] = process_time,
) -> dict[str, Timing]:
    """Time programs that take turns.

    Parameters
    ----------
    programs : mapping of str to callable
        What to execute, by its name.
    repeats : int
        How often, after a first execution that does not count.
    clock : callable
        Time [s]; default: the processor time of this process.
    """
    for program in programs.values():
        program()
    seconds: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(repeats):
        for name, program in programs.items():
            if len(seconds[name]) >= _FEWEST and sum(seconds[name]) > _BUDGET:
                continue
            began = clock()
            program()
            seconds[name].append(clock() - began)
    return {name: Timing(min(spent), median(spent)) for name, spent in seconds.items()}


def each_of_many(
    loops: Mapping[str, Callable[[int], object]],
    repeats: int,
    clock: Callable[[], float] = process_time,
) -> dict[str, Timing]:
    """Time one turn of loops that are compiled: what calling them from Python takes is left out.

    Each loop is called for one turn as well as for many, and the difference is what counts.

    Parameters
    ----------
    loops : mapping of str to callable
        Functions of the number of turns, `one` or `many`.
    repeats, clock
        As of `side_by_side`.
    """
    programs = {}
    for name, loop in loops.items():
        programs[name] = lambda loop=loop: loop(many)
        programs[f"{name}, one"] = lambda loop=loop: loop(one)
    timings = side_by_side(programs, repeats, clock)

    def each(name: str, seconds: float) -> float:
        return (seconds - timings[f"{name}, one"].minimum) / (many - one)

    return {
        name: Timing(each(name, timings[name].minimum), each(name, timings[name].median))
        for name in loops
    }
