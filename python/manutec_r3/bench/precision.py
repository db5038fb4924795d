"""What a tolerance means, and what it costs: error and work of each method over its tolerances."""

from collections.abc import Sequence
from typing import NamedTuple, get_args

from .. import _core
from ..experiment import Method
from ..scenario import Scenario
from .runs import TOLERANCES, Outcome, bare_run, exact_run, outcome
from .timing import Timing, side_by_side


class Point(NamedTuple):
    """A run of one method at one tolerance.

    Attributes
    ----------
    method : {"exponential", "erk", "bdf"}
    rtol : float
    is_default : bool
        Whether `rtol` is what the method takes if nothing is said.
    outcome : Outcome
        Error, events and work.
    time : Timing
        Without recording.
    """

    method: Method
    rtol: float
    is_default: bool
    outcome: Outcome
    time: Timing


def work_precision(
    scenario: Scenario, tolerances: Sequence[float] = TOLERANCES, repeats: int = 3
) -> list[Point]:
    """Measure all methods at all tolerances and at their defaults, from loose to tight."""
    exact = exact_run(scenario)
    runs = []
    for method in get_args(Method):
        default = _core.default_tolerance(_core.Method[method])
        runs += [(method, rtol, rtol == default) for rtol in sorted({*tolerances, default})[::-1]]
    outcomes = [outcome(scenario.run(method=m, rtol=rtol), exact) for m, rtol, _ in runs]
    programs = {f"{m} {rtol}": bare_run(scenario, method=m, rtol=rtol) for m, rtol, _ in runs}
    times = side_by_side(programs, repeats).values()
    return [
        Point(*run, found, time) for run, found, time in zip(runs, outcomes, times, strict=True)
    ]
