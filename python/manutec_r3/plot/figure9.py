"""Angles, errors and torques of all axes over time: the report's Figure 9."""

from typing import TYPE_CHECKING

import numpy as np

from .panels import check_result, explain, grid, has_whole_figure, name_of
from .stays import mark_knots, shade, sticking
from .style import BROAD, HAIR, LINE, PAGE, REFERENCE, SIMULATED, THIN, entitle, label, note, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result


def figure9(result: "Result", axes: "np.ndarray | Figure | None" = None) -> np.ndarray:
    """Draw a result as the report's Figure 9 does.

    For each axis the joint angle with its reference, the control error and the motor torque,
    the latter two with their largest deviation from zero. The time during which the axis sticks is
    shaded; dotted lines stand at the knots of the reference.

    Parameters
    ----------
    result : Result
        A simulation.
    axes : ndarray of Axes (n_axes, 3) or Figure, optional
        Where to draw; default: a new figure, with a heading and a legend.

    Returns
    -------
    ndarray of Axes (n_axes, 3)

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    n = result.robot.n_axes
    size = (PAGE, 28.0 + 27.0 * n)
    panels = grid(axes, (n, 3), "angle, error and torque of each axis", size, sharex=True)

    for i, (angle, error, torque) in enumerate(panels):
        if result.motion is not None:
            reference = result.reference_angle[:, i]
            angle.plot(result.time, reference, color=REFERENCE, linewidth=BROAD, label="reference")
        _draw(angle, result.time, result.joint_angle[:, i])
        _draw(error, result.time, 1e3 * result.control_error[:, i], unit="mrad")
        _draw(torque, result.time, result.motor_torque[:, i], unit="N m")
        for panel in (angle, error, torque):
            shade(panel, *sticking(result, axis=i + 1), label="axis sticks")
            mark_knots(panel, result)
            tidy(panel)
        label(angle, y=f"axis {i + 1}")

    titles = ("Joint angle [rad]", "Control error [mrad]", "Motor torque [N m]")
    for panel, title in zip(panels[0], titles, strict=True):
        entitle(panel, title, pad=13.0)
    for panel in panels[-1]:
        label(panel, x="time [s]")
    if has_whole_figure(axes):
        panels[0, 0].figure.align_ylabels(panels[:, 0])
        explain(panels, name_of(result))
    return panels


def _draw(panel: "Axes", time: np.ndarray, values: np.ndarray, unit: str | None = None) -> None:
    """Draw a signal, with a line at zero and its peak if there is a unit to name it in."""
    if np.isnan(values).all():  # there is no control error without a motion
        note(panel, "no reference")
        panel.tick_params(left=False, labelleft=False)
        return
    panel.plot(time, values, color=SIMULATED, linewidth=THIN, label="simulated")
    if unit:
        if values.any():
            panel.axhline(0.0, color=LINE, linewidth=HAIR, zorder=1)
        peak = np.argmax(np.abs(values))
        note(panel, f"peak {values[peak]:#.3g} {unit} at {time[peak]:.2f} s")
