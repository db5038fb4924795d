"""Compromises between time and effort: their curve, and the arm along some, as in Figure 8."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .panels import explain, grid, has_whole_figure
from .stroboscope import draw_poses
from .style import (
    PAGE,
    POINT,
    SIMULATED,
    SMALL,
    TEXT,
    THIN,
    entitle,
    label,
    tidy,
    typeset,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..planning import ParetoMotions

_SHOWN = 3  # motions beside the curve: the fastest, one between, the slowest
_INTERVAL = 0.1  # between poses [s]: the same for all, so that the fast motion shows few
_APART = 0.25  # of the extent of the arm: panels are small


def pareto(motions: "ParetoMotions", axes: "np.ndarray | Figure | None" = None) -> np.ndarray:
    """Draw the curve of time and effort, and the arm along three of its motions.

    Parameters
    ----------
    motions : ParetoMotions
        What `pareto_motions` returned.
    axes : ndarray of Axes (1, 4) or Figure, optional
        Where to draw; default: a new figure, with a heading and a legend.

    Returns
    -------
    ndarray of Axes (1, 4)
        The curve; the arm from the side about every 0.1 s: along the fastest motion, the middle one
        of the sequence, the slowest.

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived.
    ImportError
        If Matplotlib is not installed.
    """
    from ..planning import ParetoMotions  # which draws itself by this function

    if not isinstance(motions, ParetoMotions):
        raise TypeError(f"motions: expected what `pareto_motions` returns, got {motions!r}")
    panels = grid(
        axes, (1, 1 + _SHOWN), "curve and arms", (PAGE, 66.0), width_ratios=(1.5, 1, 1, 1)
    )
    curve, *arms = panels[0]
    shown = [0, len(motions) // 2, len(motions) - 1]
    _draw_curve(curve, motions, shown)
    for panel, place in zip(arms, shown, strict=True):
        motion = motions[place]
        n = 1 + max(1, round(motion.duration / _INTERVAL))
        draw_poses(panel, motion.robot, motion.angle, motion.duration, n, "side", _APART)
        entitle(panel, f"{motion.duration:.3f} s")
    if has_whole_figure(axes):
        explain(panels, "Optimal motions between least time and least effort")
    return panels


def _draw_curve(panel: "Axes", motions: "ParetoMotions", shown: list[int]) -> None:
    panel.plot(
        motions.duration,
        motions.effort,
        color=SIMULATED,
        linewidth=THIN,
        label="optimal motions, by weight of the effort",
    )
    panel.plot(motions.duration, motions.effort, color=SIMULATED, marker=".", linestyle="none")
    style: dict[str, Any] = POINT | {"fillstyle": "none"}
    panel.plot(motions.duration[shown], motions.effort[shown], **style, label="shown beside")
    for weight, time, effort in zip(
        motions.effort_weights, motions.duration, motions.effort, strict=True
    ):
        panel.annotate(
            f"{weight:.2g}",
            xy=(time, effort),
            xytext=(4.0, 3.0),
            textcoords="offset points",
            fontsize=SMALL,
            color=TEXT,
        )
    tidy(panel)
    panel.margins(x=0.12)
    unit = typeset(motions[0].effort_unit)
    label(panel, "duration [s]", f"effort [{unit}]")
    entitle(panel, "Time and effort")
