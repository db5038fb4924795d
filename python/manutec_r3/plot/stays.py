"""How long an element of an axis stays in which branch, and bars that show it over time."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from .style import LINE, SHADE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..result import Result


class Stays(NamedTuple):
    """Intervals of time, one after the other, and the branch in each of them; arrays (n,)."""

    begin: np.ndarray
    end: np.ndarray
    branch: np.ndarray


def stays(result: "Result", axis: int, element: str) -> Stays:
    """Return in which branch an element of an axis is when: between the start, events, the end."""
    switches = [e for e in result.events if (e.axis, e.element) == (axis, element)]
    instants = [0.0, *(switch.time for switch in switches), result.t_end]
    first = result.at(0.0).branches[element][0, axis - 1]
    branches = [int(first), *(switch.after for switch in switches)]
    return Stays(np.array(instants[:-1]), np.array(instants[1:]), np.array(branches))


def sticking(result: "Result", axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Intervals in which an axis sticks.

    Parameters
    ----------
    result : Result
        A simulation.
    axis : int
        1 to n_axes.

    Returns
    -------
    begin, end : ndarray (k,)
        Exact event times [s], or the ends of the simulation; none in models 1 and 2, whose gears
        are ideal.
    """
    if not result.robot.has_real_gears:
        return np.empty(0), np.empty(0)
    friction = stays(result, axis, "friction")
    sticks = friction.branch == 0
    return friction.begin[sticks], friction.end[sticks]


def shade(
    panel: "Axes",
    begin: np.ndarray,
    end: np.ndarray,
    *,
    label: str,
    color: str = SHADE,
    linewidth: float = 0.0,
) -> None:
    """Shade intervals of time behind all else, over the whole height."""
    if begin.size:
        panel.broken_barh(
            list(zip(begin, end - begin, strict=True)),
            (0.0, 1.0),
            transform=panel.get_xaxis_transform(),
            color=color,
            linewidth=linewidth,
            zorder=0,
            label=label,
        )


def mark_knots(panel: "Axes", result: "Result") -> None:
    """Mark, behind all else, where the reference is not smooth."""
    for event in result.events:
        if event.element == "reference":
            panel.axvline(
                event.time,
                color=LINE,
                linestyle=":",
                linewidth=0.8,
                zorder=1,
                label="knot of the reference",
            )
