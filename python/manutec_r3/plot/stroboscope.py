"""The arm in equal intervals of time, as the report's Figure 8 shows it."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Literal

import numpy as np

from .panels import check_result, head, single
from .style import COLUMN, EMPHASIS, HAIR, LINE, SIMULATED, SMALL, TEXT, label, tidy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..result import Result
    from ..robot import Robot

_POINTS_OF_PATH = 600
_PALEST = 0.2  # opacity of the first pose
_MARGIN = 0.12  # of the extent of the arm, for the instants written beside it
_APART = 0.15  # of the extent of the arm: instants that are closer are not both written
_AXES = {"side": ("forward [m]", "height [m]"), "top": ("x [m]", "y [m]")}


def stroboscope(
    result: "Result",
    n: int = 11,
    view: Literal["side", "top"] = "side",
    axes: "Axes | Figure | None" = None,
) -> "Axes":
    """Draw the arm in equal intervals of time, and the path of its load.

    Parameters
    ----------
    result : Result
        A simulation.
    n : int
        Number of poses, from the start to the end of the run; the first is the palest.
    view : {"side", "top"}
        From the side: the vertical plane that turns with arm 1, in which arms 2 and 3 have their
        true lengths. From the top: the horizontal plane of the world.
    axes : Axes or Figure, optional
        Where to draw; default: a new figure.

    Returns
    -------
    Axes

    Raises
    ------
    TypeError, ValueError
        What was expected, what arrived; also if the robot has no arm, only an inertia.
    ImportError
        If Matplotlib is not installed.
    """
    check_result(result)
    if result.robot.model == "one-axis":
        raise ValueError("result: expected a robot with an arm, got model one-axis")
    if isinstance(n, bool) or not isinstance(n, int | np.integer):
        raise TypeError(f"n: expected a number of poses, got {n!r}")
    if n < 2:
        raise ValueError(f"n: expected two poses or more, got {n}")
    if view not in _AXES:
        raise ValueError(f"view: expected 'side' or 'top', got {view!r}")
    panel = single(axes, (COLUMN, 88.0))
    draw_poses(panel, result.robot, lambda t: result.at(t).joint_angle, result.t_end, n, view)
    head(panel, f"The arm from the {view}", f"every {result.t_end / (n - 1):.3g} s", columns=2)
    return panel


def draw_poses(
    panel: "Axes",
    robot: "Robot",
    angle: Callable[[np.ndarray], np.ndarray],
    t_end: float,
    n: int,
    view: str,
    apart: float = _APART,
) -> None:
    """Draw n poses of a robot on a panel, of joint angles (n, n_axes) as a function of times.

    Instants are written beside ends that are apart, by that part of the extent of all poses.
    """
    time = np.linspace(0.0, t_end, n)
    poses = _seen(robot, angle(time), view)
    path = _seen(robot, angle(np.linspace(0.0, t_end, _POINTS_OF_PATH)), view)[:, -1]

    if view == "side":
        panel.axhline(0.0, color=LINE, linewidth=HAIR, zorder=0)  # the floor
    for pose, opacity in zip(poses, np.linspace(_PALEST, 1.0, n), strict=True):
        panel.plot(
            *pose.T,
            color=SIMULATED,
            alpha=opacity,
            linewidth=1.6,
            marker="o",
            markersize=2.2,
            solid_joinstyle="round",
            label="arm",
        )
    moved = "load" if robot.load.mass else "tip"
    panel.plot(*path.T, color=EMPHASIS, linewidth=0.8, zorder=3, label=f"path of the {moved}")
    panel.plot(
        *poses[:, -1].T, color=EMPHASIS, marker="o", markersize=3.0, linestyle="none", zorder=3
    )
    _write_instants(panel, time, poses, apart)
    tidy(panel)
    seen = np.concatenate((poses.reshape(-1, 2), path))
    low, high = seen.min(axis=0), seen.max(axis=0)
    around = _MARGIN * (high - low).max()
    panel.update_datalim((low - around, high + around))  # as margins are not kept with this aspect
    panel.margins(0.0)
    panel.set_aspect("equal", adjustable="datalim")
    label(panel, *_AXES[view])


def _seen(robot: "Robot", angles: np.ndarray, view: str) -> np.ndarray:
    """Foot, joints and load or tip as they are seen, (n, 8, 2) [m]."""
    frames = robot.link_poses(angles)[:, :, :3, 3]
    points = np.concatenate((frames, robot.load_position(angles)[:, None]), axis=1)
    points[:, 0] = 0.0
    height = robot.parameters["table_3"]["shoulder_height"]
    points[:, 0, 2] = -height
    x, y, z = np.moveaxis(points, -1, 0)
    if view == "top":
        return np.stack((x, y), axis=-1)
    # a positive angle of axis 2 leans the arm towards -y, and axis 1 turns that about z
    turned = angles[:, :1]
    return np.stack((x * np.sin(turned) - y * np.cos(turned), z + height), axis=-1)


def _write_instants(panel: "Axes", time: np.ndarray, poses: np.ndarray, apart: float) -> None:
    """Write beside the ends of poses when they are, if they are far enough from each other."""
    from matplotlib.patheffects import withStroke

    ends = poses[:, -1]
    extent = np.ptp(poses.reshape(-1, 2), axis=0).max()
    written = np.empty((0, 2))
    for k in (0, len(ends) - 1, *range(1, len(ends) - 1)):
        if (np.hypot(*(written - ends[k]).T) < apart * extent).any():
            continue
        written = np.vstack((written, ends[k]))
        outward = ends[k] - poses[k, -2]
        length = np.hypot(*outward)
        across, up = outward / length if length > 0.0 else (0.0, 1.0)
        panel.annotate(
            f"{time[k]:.3g} s",
            xy=ends[k],
            xytext=(5.0 * across, 5.0 * up),
            textcoords="offset points",
            ha=_side(across, "right", "center", "left"),
            va=_side(up, "top", "center", "bottom"),
            fontsize=SMALL,
            color=TEXT,
            zorder=5,
            path_effects=[withStroke(linewidth=1.5, foreground="white")],
        )


def _side(direction: float, negative: str, between: str, positive: str) -> str:
    """Choose how a text is aligned that lies in some direction."""
    if abs(direction) < 0.4:
        return between
    return positive if direction > 0.0 else negative
