"""Pictures of a result; they need Matplotlib: ``pip install "manutec-r3[plot]"``."""

from typing import TYPE_CHECKING

import numpy as np

from .compare import Comparison, CurveComparison
from .result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Told apart in grey print and with any colour vision: the reference is broad and pale, what
# follows it is thin and dark.
_SIMULATED = "#0b3c6f"
_REFERENCE = "#f2a541"
_STICKING = "#e3e7eb"
_LINE = "#9aa2ab"
_TEXT = "#333a42"
_TUBE = "#fbe3c0"
_OUTSIDE = "#f3c6c9"
_DIFFERENT = "#b3202c"


def sticking(result: Result, axis: int) -> tuple[np.ndarray, np.ndarray]:
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
    sticks = result.branches["friction"][:, axis - 1] == 0
    edges = np.flatnonzero(np.diff(sticks, prepend=False, append=False))
    # An event's instant is recorded both before and after it, so the first and the last sample
    # of a stay are its exact ends.
    return result.time[edges[::2]], result.time[edges[1::2] - 1]


def figure9(result: Result) -> "Figure":
    """Draw a result as the report's Figure 9 does.

    For each axis the joint angle with its reference, the control error and the motor torque,
    the latter two with their largest deviation from zero. The time during which the axis sticks is
    shaded; dotted lines stand at the knots of the reference.

    Parameters
    ----------
    result : Result
        A simulation.

    Returns
    -------
    matplotlib.figure.Figure
        Independent of `matplotlib.pyplot`; its ``savefig("figure9.png")`` writes it.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    n = result.robot.n_axes
    figure = _figure(_title(result), height=1.8 + 1.65 * n)
    panels = figure.subplots(n, 3, sharex=True, squeeze=False)

    for i, (angle, error, torque) in enumerate(panels):
        if result.motion is not None:
            reference = result.reference_angle[:, i]
            angle.plot(result.time, reference, color=_REFERENCE, linewidth=4.5, label="reference")
        _draw(angle, result.time, result.joint_angle[:, i])
        _draw(error, result.time, 1e3 * result.control_error[:, i], unit="mrad")
        _draw(torque, result.time, result.motor_torque[:, i], unit="N m")
        for panel in (angle, error, torque):
            _shade(panel, result, axis=i + 1)
            _tidy(panel)
        angle.set_ylabel(f"axis {i + 1}", fontsize=11, color=_TEXT)

    titles = ("Joint angle [rad]", "Control error [mrad]", "Motor torque [N m]")
    for panel, title in zip(panels[0], titles, strict=True):
        panel.set_title(title, loc="left", fontsize=11, fontweight="bold", color=_TEXT, pad=20)
    for panel in panels[-1]:
        panel.set_xlabel("time [s]", fontsize=10, color=_TEXT)
    figure.align_ylabels(panels[:, 0])
    _explain(figure, panels[:, 0])
    return figure


def comparison(compared: Comparison, n: int = 3) -> "Figure":
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
        Number of curves.

    Returns
    -------
    matplotlib.figure.Figure
        Independent of `matplotlib.pyplot`; its ``savefig("comparison.png")`` writes it.

    Raises
    ------
    ValueError, TypeError
        If `n` is no positive integer.
    ImportError
        If Matplotlib is not installed.
    """
    if isinstance(n, bool) or not isinstance(n, int):
        raise TypeError(f"n: expected a number of curves, got {n!r}")
    if n < 1:
        raise ValueError(f"n: expected one curve or more, got {n}")
    worst = compared.worst(n)
    figure = _figure(_verdict(compared), height=5.6)
    panels = figure.subplots(2, len(worst), sharex=True, squeeze=False, height_ratios=(2, 1))
    for curve, (above, below) in zip(worst, panels.T, strict=True):
        _draw_tube(above, curve)
        _draw_difference(below, curve, compared.width * curve.range)
        for panel in (above, below):
            _mark(panel, compared, curve)
            _tidy(panel)
        signal = curve.signal.replace("_", " ").capitalize()
        title = f"{signal} {curve.axis} [{_typeset(curve.unit)}]"
        above.set_title(title, loc="left", fontsize=11, fontweight="bold", color=_TEXT, pad=10)
        below.set_xlabel("time [s]", fontsize=10, color=_TEXT)
    panels[1, 0].set_ylabel("difference", fontsize=11, color=_TEXT)
    figure.align_ylabels(panels[:, 0])
    _explain(figure, panels.ravel())
    return figure


def _verdict(compared: Comparison) -> str:
    outside = sum(not curve.agrees for curve in compared.curves)
    curves = f"{outside} of {len(compared.curves)} curves leave the tube"
    if not outside:
        curves = f"all {len(compared.curves)} curves stay inside the tube"
    if compared.events is None:
        return curves.capitalize()
    return f"{curves.capitalize()}, events {'agree' if compared.events_agree else 'differ'}"


def _typeset(unit: str) -> str:
    return unit.replace("^2", "\N{SUPERSCRIPT TWO}")


def _draw_tube(panel: "Axes", curve: CurveComparison) -> None:
    panel.fill_between(
        curve.time, curve.lower, curve.upper, color=_TUBE, linewidth=0.0, label="tube"
    )
    panel.plot(
        curve.reference_time, curve.reference, color=_REFERENCE, linewidth=3.0, label="reference"
    )
    panel.plot(curve.time, curve.value, color=_SIMULATED, linewidth=1.2, label="result")


def _draw_difference(panel: "Axes", curve: CurveComparison, tube: float) -> None:
    panel.plot(curve.difference_time, curve.difference, color=_SIMULATED, linewidth=1.2)
    shown = panel.get_ylim()
    panel.axhspan(-tube, tube, color=_TUBE, linewidth=0.0, zorder=0.5)
    panel.axhline(0.0, color=_LINE, linewidth=0.6, zorder=1)
    panel.set_ylim(shown)
    panel.ticklabel_format(axis="y", scilimits=(-3, 4))
    if np.isfinite(curve.deviation):
        deviation = f"{curve.deviation:#.3g} {_typeset(curve.unit)} at {curve.instant:.3f} s"
        _note(panel, f"largest {deviation}")


def _mark(panel: "Axes", compared: Comparison, curve: CurveComparison) -> None:
    """Mark, behind the curves, when the curve is outside its tube and events that differ."""
    edges = np.flatnonzero(np.diff(curve.outside, prepend=False, append=False))
    begin, last = curve.time[edges[::2]], curve.time[edges[1::2] - 1]
    # With an edge, else a single instant could not be seen.
    _bars(panel, begin, last, color=_OUTSIDE, label="outside the tube", linewidth=0.6)
    if compared.events is not None:
        for event in (*compared.events.extra, *compared.events.missing):
            panel.axvline(
                event.time,
                color=_DIFFERENT,
                linestyle="--",
                linewidth=0.7,
                zorder=1,
                label="event that only one has",
            )


def _figure(title: str, height: float) -> "Figure":
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError('a picture needs Matplotlib: pip install "manutec-r3[plot]"') from error
    figure = Figure(figsize=(11.0, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.06)
    figure.suptitle(title, fontsize=14, fontweight="bold", color=_TEXT)
    return figure


def _title(result: Result) -> str:
    robot = result.robot
    carried = f"load {robot.load.mass:g} kg" if robot.load.mass else "no load"
    if robot.model == "full-robot":
        return f"Manutec r3, full robot of the Modelica variant, {carried}"
    if robot.model == "one-axis":
        inertia = robot.parameters["table_3"]["arms"][0]["I33"]
        moved = f"{inertia:g} {_typeset('kg m^2')}"
        return f"Manutec r3, one axis of the Modelica variant, inertia {moved}"
    return f"Manutec r3, model {robot.model}, {carried}"


def _draw(panel: "Axes", time: np.ndarray, values: np.ndarray, unit: str | None = None) -> None:
    """Draw a signal, with a line at zero and its peak if there is a unit to name it in."""
    if np.isnan(values).all():  # there is no control error without a motion
        _note(panel, "no reference")
        panel.tick_params(left=False, labelleft=False)
        return
    panel.plot(time, values, color=_SIMULATED, linewidth=1.2, label="simulated")
    if unit:
        if values.any():
            panel.axhline(0.0, color=_LINE, linewidth=0.6, zorder=1)
        peak = np.argmax(np.abs(values))
        _note(panel, f"peak {values[peak]:#.3g} {unit} at {time[peak]:.2f} s")


def _note(panel: "Axes", text: str) -> None:
    """Write above a panel, on the right."""
    panel.annotate(
        text.replace("-", "\N{MINUS SIGN}"),
        xy=(1.0, 1.0),
        xycoords="axes fraction",
        xytext=(0.0, 4.0),
        textcoords="offset points",
        horizontalalignment="right",
        fontsize=8.5,
        color=_TEXT,
    )


def _shade(panel: "Axes", result: Result, axis: int) -> None:
    """Mark, behind the signals, when the axis sticks and the knots of the reference."""
    _bars(panel, *sticking(result, axis), color=_STICKING, label="axis sticks")
    for event in result.events:
        if event.element == "reference":
            panel.axvline(
                event.time, color=_LINE, linestyle=":", zorder=1, label="knot of the reference"
            )


def _bars(
    panel: "Axes",
    begin: np.ndarray,
    end: np.ndarray,
    *,
    color: str,
    label: str,
    linewidth: float = 0.0,
) -> None:
    """Shade intervals of time behind all else, over the whole height."""
    if begin.size:
        panel.broken_barh(
            np.column_stack((begin, end - begin)),
            (0.0, 1.0),
            transform=panel.get_xaxis_transform(),
            color=color,
            linewidth=linewidth,
            zorder=0,
            label=label,
        )


def _tidy(panel: "Axes") -> None:
    panel.spines[["top", "right"]].set_visible(False)
    panel.spines[["left", "bottom"]].set_color(_LINE)
    panel.tick_params(labelsize=9, color=_LINE, labelcolor=_TEXT)
    panel.locator_params("x", nbins=6, steps=(1, 2, 3, 5, 10))
    panel.locator_params("y", nbins=5, steps=(1, 2, 5, 10))
    panel.margins(x=0.0, y=0.1)


def _explain(figure: "Figure", panels: np.ndarray) -> None:
    """Explain below what is drawn in the panels, once."""
    handles = {
        label: handle
        for panel in panels
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=len(handles),
        frameon=False,
        fontsize=10,
        labelcolor=_TEXT,
    )
