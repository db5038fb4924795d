"""Friction of an axis over the rate of its rotor, on its characteristic."""

from typing import TYPE_CHECKING

import numpy as np

from .panels import check_axis, check_result, head, single
from .stays import sticking
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

_BEYOND = 1.08  # the characteristic is drawn a little further than the rotor turned


def friction(result: "Result", axis: int = 1, axes: "Axes | Figure | None" = None) -> "Axes":
    """Draw the friction torque of an axis over its rotor rate.

    Behind it lies the characteristic NL3 of the axis (specification section 5.1): two branches
    while it slides, and at rest whatever torque is needed, up to the sticking limit. The moments in
    which the axis sticks are marked.

    Parameters
    ----------
    result : Result
        A simulation.
    axis : int
        1 to n_axes.
    axes : Axes or Figure, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived; also if gears are ideal.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    axis = check_axis(result, axis)
    robot = result.robot
    if not robot.has_real_gears:
        raise ValueError(
            f"result: expected a robot whose gears have friction, got model {robot.model}"
        )
    panel = single(axes, (COLUMN, 68.0))
    rate, torque = result.rotor_rate[:, axis - 1], result.friction_torque[:, axis - 1]
    sticks = result.branches["friction"][:, axis - 1] == 0

    panel.axhline(0.0, color=LINE, linewidth=HAIR, zorder=0)
    panel.plot(
        *_characteristic(result, axis, largest=np.abs(rate).max()),
        color=REFERENCE,
        linewidth=BROAD,
        label="characteristic",
    )
    panel.plot(rate, torque, color=SIMULATED, linewidth=THIN, label="simulated")
    _mark_sticking(panel, torque, sticks)
    tidy(panel)
    panel.margins(x=0.02)
    label(panel, x="rotor rate [rad/s]", y="friction torque, motor side [N m]")
    begin, end = sticking(result, axis)
    times = f"{len(begin)} time{'' if len(begin) == 1 else 's'}"
    remark = f"sticks {times}, {np.sum(end - begin):.3f} s in all" if len(begin) else "never sticks"
    head(panel, f"Friction of axis {axis}", remark)
    return panel


def _mark_sticking(panel: "Axes", torque: np.ndarray, sticks: np.ndarray) -> None:
    """Mark the torques while the rotor stands, and those of the moments at both ends."""
    if not sticks.any():
        return
    held = np.where(sticks, torque, np.nan)
    panel.plot(
        *(np.zeros(len(held)), held),
        color=EMPHASIS,
        linewidth=1.6,
        marker="o",  # else a torque that stays the same could not be seen
        markersize=1.6,
        label="sticks",
    )
    # An event's instant is recorded both before and after it: the first and the last sample of a
    # stay are its exact ends.
    edges = np.flatnonzero(np.diff(sticks, prepend=False, append=False))
    comes, goes = edges[::2], edges[1::2] - 1
    ends = {"comes to rest": comes[comes > 0], "breaks away": goes[goes < len(sticks) - 1]}
    for (name, at), face in zip(ends.items(), ("white", EMPHASIS), strict=True):
        if len(at):
            panel.plot(np.zeros(len(at)), torque[at], markerfacecolor=face, label=name, **POINT)


def _characteristic(result: "Result", axis: int, largest: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the characteristic as far as a rate, its last segment extended if necessary."""
    table = result.robot.parameters["table_2"]
    rates, torques = np.array(table["friction"][axis - 1]).T
    end = _BEYOND * largest if largest > 0.0 else rates[-1]
    last = result.robot.sliding_friction(np.full(result.robot.n_axes, end))[axis - 1]
    inside = rates < end
    corner_rates = np.concatenate(([0.0], rates[inside], [end]))
    corner_torques = np.concatenate(([table["rM_h"][axis - 1]], torques[inside], [last]))
    return _odd(corner_rates), _odd(corner_torques)


def _odd(values: np.ndarray) -> np.ndarray:
    """Return values that start at zero rate, with their opposites before them."""
    return np.concatenate((-values[::-1], values))
