"""A run as a web page: one file that needs no network, whatever browser opens it.

The page is `page.html`, with the style `page.css`, the script `page.js`, the run and three.js
inside. three.js comes with trimesh, which makes the shapes: it needs NumPy alone, and its own
viewer carries a three.js that runs from a file.
"""

import json
import re
from base64 import b64encode
from collections.abc import Iterator
from functools import cache
from html import escape
from importlib.resources import files
from os import PathLike
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np
import trimesh
from trimesh.viewer.notebook import scene_to_html

from ..arguments import number
from ..robot import Robot
from ..shapes import floor_height
from . import meshes
from .elements import FRICTION_COLOURS, REFERENCE_COLOUR, WORDS, in_words
from .poses import arm_names, arm_poses

if TYPE_CHECKING:
    from ..result import Result

_RATE = 200.0  # frames per second, if that makes no more than
_FRAMES = 2000  # which keeps a page of six axes below 3 MB
_MOST_FRAMES = 100_000


class Animation:
    """A page that shows a run: the robot in three dimensions and, beside it, its axes.

    In a notebook it shows itself.

    Parameters
    ----------
    result : Result
        A simulation.
    rate : float, optional
        Frames per second of the run; between them the page interpolates. Default: 200, or as many
        as keep the page below 3 MB.
    magnify : float
        How many times the control error is shown: the ghost stands at the joint angles plus
        `magnify` times their control errors, at the reference if that is 1.

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived.

    Attributes
    ----------
    html : str
        The page.
    """

    def __init__(
        self, result: "Result", *, rate: float | None = None, magnify: float = 1.0
    ) -> None:
        magnify = number("magnify", magnify, "1")
        if magnify <= 0.0:
            raise ValueError(f"magnify: expected a positive number, got {magnify:g}")
        time = _frames(result.t_end, rate)
        self.html = Template(_file("page.html")).substitute(
            title=result.robot.title,
            css=_file("page.css"),
            run=json.dumps(_run(result, time, magnify), allow_nan=False),
            three=three(),
            script=_file("page.js"),
        )

    def save(self, path: str | PathLike[str]) -> None:
        """Write the page to a file."""
        if not isinstance(path, str | PathLike):
            raise TypeError(f"path: expected a name of a file, got {path!r}")
        Path(path).write_text(self.html, encoding="utf-8")

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.html)}" allowfullscreen '
            'style="width: 100%; height: 640px; border: 1px solid #d3d9df; border-radius: 8px">'
            "</iframe>"
        )


def _frames(t_end: float, rate: float | None) -> np.ndarray:
    """Return the instants of the frames (n,) [s]: the ends of the run and what lies between."""
    if rate is None:
        n = min(round(_RATE * t_end), _FRAMES)
    else:
        rate = number("rate", rate, "1/s")
        most = _MOST_FRAMES / t_end if t_end else np.inf
        if not 0.0 < rate <= most:
            raise ValueError(
                f"rate: expected frames per second [1/s] above 0 and, for {t_end:g} s, up to "
                f"{most:g}, got {rate:g}"
            )
        n = int(np.ceil(rate * t_end))
    return np.linspace(0.0, t_end, max(n, 1) + 1)


def _run(result: "Result", time: np.ndarray, magnify: float) -> dict[str, Any]:
    """Return what the page knows of a run."""
    robot, now = result.robot, result.at(time)
    follows = result.motion is not None
    ghost = now.joint_angle + magnify * now.control_error if follows else None
    model = meshes.scene(robot).export(file_type="glb", include_normals=True)
    return {
        "facts": " \N{MIDDLE DOT} ".join(_facts(result, len(time) - 1)),
        "ghost": {
            "words": "reference" if magnify == 1.0 else f"control error {magnify:g} times",
            "colour": REFERENCE_COLOUR,
        },
        "duration": result.t_end,
        "frames": len(time),
        "axes": robot.n_axes,
        "arms": arm_names(robot),
        "floor": floor_height(robot),
        "model": b64encode(model).decode(),
        "poses": _base64(arm_poses(robot, now.joint_angle)),
        "reference_poses": None if ghost is None else _base64(arm_poses(robot, ghost)),
        "motor_torque": _base64(now.motor_torque),
        "control_error": _base64(now.control_error) if follows else None,
        "branches": _stays(result),
        "friction": {"words": WORDS["friction"], "colours": FRICTION_COLOURS},
        "events": [(event.time, in_words(event)) for event in result.events],
    }


def _facts(result: "Result", n_frames: int) -> Iterator[str]:
    robot = result.robot
    if robot.n_axes == 1:
        yield f"inertia {robot.parameters['table_3']['arms'][0]['I33']:g} kg m\N{SUPERSCRIPT TWO}"
    else:
        yield f"load {robot.load.mass:g} kg" if robot.load.mass else "no load"
    yield f"{len(result.events)} events"
    if result.t_end:
        yield f"{n_frames / result.t_end:.3g} frames per second"


def _stays(result: "Result") -> dict[str, list[list[list[float]] | None]]:
    """Return, of each element and axis, when which branch begins; None if there is no element."""
    stays: dict[str, list[list[list[float]] | None]] = {}
    for element, branches in result.branches.items():
        stays[element] = [
            _stays_of(result.time, branch) if _has(result.robot, element, axis) else None
            for axis, branch in enumerate(branches.T, start=1)
        ]
    return stays


def _has(robot: Robot, element: str, axis: int) -> bool:
    """Whether an axis has an element that switches; without a gap backlash does not."""
    if element == "backlash" and robot.has_real_gears and axis <= 3:
        return robot.parameters["table_2"]["b"][axis - 1] > 0.0
    return f"{element}_upper[{axis}]" in robot.indicator_names


def _stays_of(time: np.ndarray, branch: np.ndarray) -> list[list[float]]:
    """Return beginnings [s] and branches, from those of all instants."""
    first = np.flatnonzero(np.diff(branch, prepend=branch[0] + 1))
    return [[float(time[k]), int(branch[k])] for k in first]


def _base64(array: np.ndarray) -> str:
    return b64encode(array.astype("<f4").tobytes()).decode()


def _file(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


@cache
def three() -> str:
    """Return three.js with its licence and its reader of glTF, from the viewer of trimesh."""
    viewer = scene_to_html(trimesh.Scene(trimesh.creation.box()))
    found = re.search(
        r"<script>(/\*\*\s*\* @license.*?THREE\.GLTFLoader=GLTFLoader;\}\)\(\);)", viewer, re.S
    )
    if found is None:
        raise ImportError(
            f"the viewer of trimesh {trimesh.__version__} has no three.js where it was: "
            'pip install "manutec-r3[animation]" installs a version that has'
        )
    return found[1]
