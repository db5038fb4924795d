"""Where a result and its reference part."""

from typing import TYPE_CHECKING

import numpy as np

from .panels import explain, grid, has_whole_figure
from .stays import shade
from .style import (
    BROAD,
    DIFFERENT,
    HAIR,
    LINE,
    OUTSIDE,
    PAGE,
    REFERENCE,
    SIMULATED,
    THIN,
    TUBE,
    entitle,
    label,
    note,
    tidy,
    typeset,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..comparison import Comparison, CurveComparison


def comparison(
    compared: "Comparison", n: int = 3, axes: "np.ndarray | Figure | None" = None
) -> np.ndarray:
    """Draw where a result and its reference part.

    For the curves that deviate most, those that leave their tubes first: the curve with its
    reference in the tube around it, and below the difference of both, with gaps near events, over
    what the tube allows in value. The time outside the tube is shaded; dashed lines stand at events
    that only one of both has.

    Parameters
    ----------
    compared : Comparison
        What `compare` returned.
    n : int
        Number of curves, at most as many as were compared.
    axes : ndarray of Axes (2, n) or Figure, optional
        Where to draw; default: a new figure, with a heading and a legend.

    Returns
    -------
    ndarray of Axes (2, n)

    Raises
    ------
    ValueError, TypeError
        What was expected, what arrived.
    ImportError
        If Matplotlib is not installed.
    """
    from ..comparison import Comparison  # which draws itself by this function

    if not isinstance(compared, Comparison):
        raise TypeError(f"compared: expected what `compare` returns, got {compared!r}")
    if isinstance(n, bool) or not isinstance(n, int):
        raise TypeError(f"n: expected a number of curves, got {n!r}")
    if n < 1:
        raise ValueError(f"n: expected one curve or more, got {n}")
    worst = compared.worst(n)
    shape, size = (2, len(worst)), (PAGE if len(worst) > 1 else 0.65 * PAGE, 88.0)
    panels = grid(axes, shape, "curve and difference", size, sharex=True, height_ratios=(2, 1))
    for curve, (above, below) in zip(worst, panels.T, strict=True):
        _draw_tube(above, curve)
        _draw_difference(below, curve, compared.width * curve.range)
        for panel in (above, below):
            _mark(panel, compared, curve)
            tidy(panel)
        signal = curve.signal.replace("_", " ").capitalize()
        entitle(above, f"{signal} {curve.axis} [{typeset(curve.unit)}]")
        label(below, x="time [s]")
        label(below, y=f"difference [{typeset(curve.unit)}]")
    if has_whole_figure(axes):
        panels[0, 0].figure.align_ylabels(panels[:, 0])
        explain(panels, _verdict(compared), columns=5 if len(worst) > 1 else 3)
    return panels


def _verdict(compared: "Comparison") -> str:
    outside = sum(not curve.agrees for curve in compared.curves)
    curves = f"{outside} of {len(compared.curves)} curves leave the tube"
    if not outside:
        curves = f"all {len(compared.curves)} curves stay inside the tube"
    if compared.events is None:
        return curves.capitalize()
    return f"{curves.capitalize()}, events {'agree' if compared.events_agree else 'differ'}"


def _draw_tube(panel: "Axes", curve: "CurveComparison") -> None:
    panel.fill_between(
        curve.time, curve.lower, curve.upper, color=TUBE, linewidth=0.0, label="tube"
    )
    panel.plot(
        curve.reference_time, curve.reference, color=REFERENCE, linewidth=BROAD, label="reference"
    )
    panel.plot(curve.time, curve.value, color=SIMULATED, linewidth=THIN, label="result")


def _draw_difference(panel: "Axes", curve: "CurveComparison", tube: float) -> None:
    panel.plot(curve.difference_time, curve.difference, color=SIMULATED, linewidth=THIN)
    shown = panel.get_ylim()
    panel.axhspan(-tube, tube, color=TUBE, linewidth=0.0, zorder=0.5)
    panel.axhline(0.0, color=LINE, linewidth=HAIR, zorder=1)
    panel.set_ylim(shown)
    panel.ticklabel_format(axis="y", scilimits=(-3, 4))
    if np.isfinite(curve.deviation):
        deviation = f"{curve.deviation:#.3g} {curve.unit} at {curve.instant:.3f} s"
        note(panel, f"largest {deviation}")


def _mark(panel: "Axes", compared: "Comparison", curve: "CurveComparison") -> None:
    """Mark, behind the curves, when the curve is outside its tube and events that differ."""
    edges = np.flatnonzero(np.diff(curve.outside, prepend=False, append=False))
    begin, last = curve.time[edges[::2]], curve.time[edges[1::2] - 1]
    # With an edge, else a single instant could not be seen.
    shade(panel, begin, last, color=OUTSIDE, label="outside the tube", linewidth=HAIR)
    if compared.events is not None:
        for event in (*compared.events.extra, *compared.events.missing):
            panel.axvline(
                event.time,
                color=DIFFERENT,
                linestyle="--",
                linewidth=HAIR,
                zorder=1,
                label="event that only one has",
            )
