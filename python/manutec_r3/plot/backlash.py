"""Deflection of an elastic gear over time, with the gap between its teeth."""

from typing import TYPE_CHECKING

import numpy as np

from .panels import check_axis, check_result, head, single
from .stays import mark_knots, shade, stays
from .style import COLUMN, HAIR, REFERENCE, SIMULATED, THIN, TUBE, label, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result


def backlash(result: "Result", axis: int = 1, axes: "Axes | Figure | None" = None) -> "Axes":
    """Draw the deflection of an elastic gear, seen from the rotor, `delta = rq - p aq`.

    Behind it lies the gap of the backlash, `|delta| <= b` (specification section 5.2). The time in
    which the teeth have no contact is shaded; dotted lines stand at the knots of the reference.

    Parameters
    ----------
    result : Result
        A simulation.
    axis : int
        1 to 3, as the gears of axes 4 to 6 are rigid.
    axes : Axes or Figure, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived; also if the gear is rigid.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    axis = check_axis(result, axis)
    robot = result.robot
    if f"deflection[{axis}]" not in robot.state_names:
        got = f"axis {axis} of model {robot.model}"
        raise ValueError(f"axis: expected one with an elastic gear, got {got}")
    panel = single(axes, (COLUMN, 62.0))
    deflection = result.state[:, robot.state_names.index(f"deflection[{axis}]")]
    half_gap = robot.parameters["table_2"]["b"][axis - 1]
    teeth = stays(result, axis, "backlash")
    # without a gap the branch is always 0, and the teeth are always in contact
    apart = (teeth.branch == 0) & (half_gap > 0.0)

    panel.plot(result.time, deflection, color=SIMULATED, linewidth=THIN, label="simulated")
    shade(panel, teeth.begin[apart], teeth.end[apart], label="no contact")
    if half_gap > 0.0:
        panel.axhspan(-half_gap, half_gap, color=TUBE, linewidth=0.0, zorder=0.5, label="gap")
        for edge in (-half_gap, half_gap):
            panel.axhline(edge, color=REFERENCE, linewidth=HAIR, zorder=1)
    mark_knots(panel, result)
    tidy(panel)
    label(panel, x="time [s]", y="deflection, motor side [rad]")
    open_time = np.sum((teeth.end - teeth.begin)[apart])
    remark = f"no contact for {open_time:.3f} s" if apart.any() else "always in contact"
    head(panel, f"Gear of axis {axis}", remark, columns=2)
    return panel
