"""The axes of a picture: those that are given, or those of a new figure in the size of print."""

from typing import TYPE_CHECKING, Any

import numpy as np

from .style import HEADING, LABEL, SMALL, TEXT, entitle, typeset

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result

_MILLIMETRE = 1.0 / 25.4  # inches, in which Matplotlib counts

_MISSING = 'a picture needs Matplotlib: pip install "manutec-r3[plot]"'


def new_figure() -> "Figure":
    """Return an empty figure that no window shows, for pictures that are only to be written.

    Returns
    -------
    matplotlib.figure.Figure
        It can be passed to any picture instead of axes, and takes its size.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError(_MISSING) from error
    return Figure()


def _shown_figure() -> "Figure":
    """Return a figure of pyplot, which notebooks show by themselves and scripts by its `show`."""
    new_figure()  # says what is missing
    from matplotlib import pyplot

    return pyplot.figure()


def grid(
    axes: Any, shape: tuple[int, int], what: str, size: tuple[float, float], **subplots: Any
) -> np.ndarray:
    """Return the panels to draw on, an array of that shape.

    Parameters
    ----------
    axes : array_like of Axes, Figure or None
        What the user gave.
    shape : (int, int)
        Rows and columns of panels.
    what : str
        What they are, for the error message.
    size : (float, float)
        Of a new figure, width and height [mm].
    **subplots
        How a new figure is divided.
    """
    if has_whole_figure(axes):
        axes = _shown_figure() if axes is None else axes
        axes.set_size_inches(*(_MILLIMETRE * length for length in size))
        axes.set_layout_engine("constrained", w_pad=0.04, h_pad=0.03)
        return axes.subplots(*shape, squeeze=False, **subplots)
    panels = np.asarray(axes, object)
    for panel in panels.flat:
        _check_axes(panel)
    if panels.shape != shape:
        raise ValueError(f"axes: expected shape {shape}, {what}, got {panels.shape}")
    return panels


def single(axes: Any, size: tuple[float, float]) -> "Axes":
    """Return the panel to draw on: the axes that the user gave, or the only ones of a figure."""
    if has_whole_figure(axes):
        return grid(axes, (1, 1), "one panel", size)[0, 0]
    _check_axes(axes)
    return axes


def has_whole_figure(axes: Any) -> bool:
    """Whether a picture has a figure of its own, with room for a heading and a legend."""
    if axes is None:
        return True
    from matplotlib.figure import Figure

    return isinstance(axes, Figure)


def _check_axes(axes: Any) -> None:
    from matplotlib.axes import Axes

    if not isinstance(axes, Axes):
        raise TypeError(f"axes: expected Axes of Matplotlib, got {axes!r}")


def explain(panels: np.ndarray, heading: str, columns: int = 6) -> None:
    """Write a heading above a whole figure, and explain below, once, what its panels show."""
    figure = panels.flat[0].figure
    figure.suptitle(heading, fontsize=HEADING, fontweight="bold", color=TEXT)
    handles = {
        label: handle
        for panel in panels.flat
        for handle, label in zip(*panel.get_legend_handles_labels(), strict=True)
    }
    figure.legend(
        handles.values(),
        handles.keys(),
        loc="outside lower center",
        ncols=min(columns, len(handles)),
        frameon=False,
        fontsize=LABEL,
        labelcolor=TEXT,
        handlelength=1.6,
        columnspacing=1.4,
    )


def head(panel: "Axes", title: str, remark: str = "", columns: int = 3) -> None:
    """Write title and remark above a panel and, below them, what it shows: never over the data."""
    handles, labels = panel.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    panel.legend(
        unique.values(),
        unique.keys(),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        ncols=columns,
        borderaxespad=0.2,
        borderpad=0.2,
        frameon=False,
        fontsize=SMALL,
        labelcolor=TEXT,
        handlelength=1.4,
        handletextpad=0.5,
        columnspacing=1.0,
        labelspacing=0.25,
    )
    rows = -(-len(unique) // columns)
    pad = 5.0 + 1.35 * SMALL * rows
    entitle(panel, title, pad=pad)
    panel.set_title(typeset(remark), loc="right", fontsize=SMALL, color=TEXT, pad=pad)


# --- what is drawn --------------------------------------------------------------------------------


def check_result(result: Any) -> None:
    """Refuse what is no result."""
    from ..result import Result  # which draws itself by these functions

    if not isinstance(result, Result):
        raise TypeError(f"result: expected a Result, got {result!r}")


def check_axis(result: "Result", axis: Any) -> int:
    """Return the number of an axis that the robot of a result has."""
    n = result.robot.n_axes
    expected = f"an axis from 1 to {n}" if n > 1 else "axis 1"
    if isinstance(axis, bool) or not isinstance(axis, int | np.integer):
        raise TypeError(f"axis: expected {expected}, got {axis!r}")
    if not 1 <= axis <= n:
        raise ValueError(f"axis: expected {expected}, got {axis}")
    return int(axis)


def name_of(result: "Result") -> str:
    """Say which robot and load a result is of."""
    robot = result.robot
    if robot.model == "one-axis":
        inertia = robot.parameters["table_3"]["arms"][0]["I33"]
        return f"{robot.title}, inertia {inertia:g} kg m\N{SUPERSCRIPT TWO}"
    carried = f"load {robot.load.mass:g} kg" if robot.load.mass else "no load"
    return f"{robot.title}, {carried}"
