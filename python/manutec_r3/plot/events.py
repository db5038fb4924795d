"""A timeline of all elements that switch: which branch when."""

from typing import TYPE_CHECKING

import numpy as np

from .panels import check_result, head, name_of, single
from .stays import Stays, mark_knots, stays
from .style import BRANCHES, PAGE, SMALL, TEXT, label, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result
    from ..robot import Robot

# What branches mean, whatever the element.
_MEANINGS = {
    1: "+1: above, slides forward",
    0: "0: within, sticks",
    -1: "\N{MINUS SIGN}1: below, slides backward",
}
# Where the bar of a branch lies in its row, lower end and height: seen without colours too.
_PLACES = {1: (0.0, 0.4), 0: (-0.08, 0.16), -1: (-0.4, 0.4)}
_BETWEEN_AXES = 0.7  # of a row
_LEFT = -48.0  # of the rows: the number of the axis [pt]


def events(result: "Result", axes: "Axes | Figure | None" = None) -> "Axes":
    """Draw a timeline by axis and element: which branch when.

    Each row is an element of an axis. Its bar lies above the middle in branch +1 and below it in
    branch -1; in branch 0 it is thin. Torques, voltages and deflections are above, within or below
    their limits, dead zone or gap; friction slides forward, sticks or slides backward. A gear
    without a gap is always in contact and has no row. Excesses of limits and samples have rows if
    the result lists them. Dotted lines stand at the knots of the reference.

    Parameters
    ----------
    result : Result
        A simulation.
    axes : Axes or Figure, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    TypeError
        What was expected, what arrived.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    rows = _rows(result)
    n_groups = len({axis for axis, _, _ in rows})
    panel = single(axes, (PAGE, 27.0 + 3.6 * (len(rows) + _BETWEEN_AXES * n_groups)))

    place, places, first_of_axis = 0.0, [], {}
    for axis, _, row in rows:
        if axis not in first_of_axis:
            place -= _BETWEEN_AXES
            first_of_axis[axis] = place
        _draw(panel, place, row)
        places.append(place)
        place -= 1.0
    for axis, place_of_first in first_of_axis.items():
        panel.annotate(
            f"axis {axis}" if axis else "robot",
            xy=(0.0, place_of_first),
            xycoords=panel.get_yaxis_transform(),
            xytext=(_LEFT, 0.0),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=SMALL,
            fontweight="bold",
            color=TEXT,
        )
    mark_knots(panel, result)
    tidy(panel)
    panel.set_yticks(places, [element.replace("_", " ") for _, element, _ in rows])
    panel.tick_params(axis="y", length=0.0)
    panel.spines["left"].set_visible(False)
    panel.set_ylim(place + 0.3, 0.2)
    label(panel, x="time [s]")
    count = len(result.events)
    remark = f"{count} event{'' if count == 1 else 's'}" if rows else "no element switches"
    head(panel, name_of(result), remark, columns=4)
    return panel


def _rows(result: "Result") -> list[tuple[int, str, Stays]]:
    """Return what has a row: axis (0: the whole robot), element, and its stays."""
    robot = result.robot
    rows = []
    if "sample" in result.events.element:
        instants = result.events.time[result.events.element == "sample"]
        rows.append((0, "sample", Stays(instants, instants, np.ones(len(instants), int))))
    for axis in range(1, robot.n_axes + 1):
        for element in robot._compiled.elements:
            if _switches(robot, axis, element):
                rows.append((axis, element, stays(result, axis, element)))
        if "limit" in result.events.element:
            excesses = [excess for excess in result.limits if excess.axis == axis]
            columns = zip(*((e.begin, e.end, e.side) for e in excesses), strict=True)
            if excesses:
                rows.append((axis, "limit", Stays(*map(np.array, columns))))
    return rows


def _switches(robot: "Robot", axis: int, element: str) -> bool:
    """Whether an axis has an element that can switch."""
    if element == "voltage_limit":  # an option of the whole robot, not among its indicators
        return True
    if f"{element}_upper[{axis}]" not in robot.indicator_names:
        return False
    return element != "backlash" or robot.parameters["table_2"]["b"][axis - 1] > 0.0


def _draw(panel: "Axes", place: float, row: Stays) -> None:
    """Draw the bars of a row around its place."""
    for branch, meaning in _MEANINGS.items():
        chosen = row.branch == branch
        if chosen.any():
            lower, height = _PLACES[branch]
            panel.broken_barh(
                list(zip(row.begin[chosen], (row.end - row.begin)[chosen], strict=True)),
                (place + lower, height),
                color=BRANCHES[branch],
                linewidth=0.3,  # else a short stay could not be seen
                label=meaning,
            )
