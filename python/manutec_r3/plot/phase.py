"""The phase plane of an axis: its rate over its angle, or the same of its control error."""

from typing import TYPE_CHECKING, Literal

from .panels import check_axis, check_result, head, single
from .style import (
    BROAD,
    COLUMN,
    EMPHASIS,
    HAIR,
    LINE,
    POINT,
    REFERENCE,
    SIMULATED,
    THIN,
    label,
    tidy,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result


def phase(
    result: "Result",
    axis: int = 1,
    of: Literal["angle", "error"] = "angle",
    axes: "Axes | Figure | None" = None,
) -> "Axes":
    """Draw the phase plane of an axis, joint side.

    Parameters
    ----------
    result : Result
        A simulation.
    axis : int
        1 to n_axes.
    of : {"angle", "error"}
        The joint rate over the joint angle, with the reference behind it; or the rate of the
        control error over the control error.
    axes : Axes or Figure, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived; also if there is no reference that an error could be of.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    axis = check_axis(result, axis)
    if of not in ("angle", "error"):
        raise ValueError(f"of: expected 'angle' or 'error', got {of!r}")
    if of == "error" and result.motion is None:
        raise ValueError("of: expected 'angle', as without a motion there is no control error")
    panel = single(axes, (COLUMN, 68.0))
    k = axis - 1
    angle, rate = result.joint_angle[:, k], result.joint_rate[:, k]
    if of == "error":
        # 1e3 makes milliradians
        angle = 1e3 * result.control_error[:, k]
        rate = 1e3 * (result.reference_rate[:, k] - rate)
    elif result.motion is not None:
        panel.plot(
            *(result.reference_angle[:, k], result.reference_rate[:, k]),
            color=REFERENCE,
            linewidth=BROAD,
            label="reference",
        )
    panel.axhline(0.0, color=LINE, linewidth=HAIR, zorder=0)
    panel.axvline(0.0, color=LINE, linewidth=HAIR, zorder=0)
    panel.plot(angle, rate, color=SIMULATED, linewidth=THIN, label="simulated")
    for instant, face, name in ((0, "white", "start"), (-1, EMPHASIS, "end")):
        panel.plot(angle[instant], rate[instant], markerfacecolor=face, label=name, **POINT)
    tidy(panel)
    panel.margins(0.06)
    if of == "error":
        label(panel, x="control error [mrad]", y="rate of the control error [mrad/s]")
    else:
        label(panel, x="joint angle [rad]", y="joint rate [rad/s]")
    head(panel, f"Phase plane of axis {axis}", columns=4)
    return panel
