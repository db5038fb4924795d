"""The robot's shapes as what URDF and MJCF both have: boxes, cylinders and balls.

The hull of two solids becomes the solids and a bar between them, as thick as the thinner of both.
Rounded edges are left out.
"""

from collections.abc import Iterable, Iterator
from typing import Literal, NamedTuple

import numpy as np

from ...shapes import Ball, Disc, Part


class Primitive(NamedTuple):
    """A simple shape in the frame of its link.

    Attributes
    ----------
    kind : {"box", "cylinder", "sphere"}
    size : tuple of float
        Edges of a box; radius and length of a cylinder, along z; radius of a sphere [m].
    position : ndarray (3,)
        Of its middle [m].
    rotation : ndarray (3, 3)
        Columns are its axes.
    material : str
        One of `shapes.MATERIALS`.
    """

    kind: Literal["box", "cylinder", "sphere"]
    size: tuple[float, ...]
    position: np.ndarray
    rotation: np.ndarray
    material: str


def primitives(parts: Iterable[Part]) -> list[Primitive]:
    """Return the simple shapes of parts."""
    return [primitive for part in parts for primitive in _primitives(part)]


def _primitives(part: Part) -> Iterator[Primitive]:
    for solid in part.solids:
        yield _primitive(solid, part.material)
    if len(part.solids) == 2:
        yield from _bar(*part.solids, part.material)


def _primitive(solid: Disc | Ball, material: str) -> Primitive:
    middle = np.array(solid.middle, float)
    if isinstance(solid, Ball):
        return Primitive("sphere", (solid.radius,), middle, np.eye(3), material)
    size = (solid.radius, solid.length)
    return Primitive("cylinder", size, middle, _along(solid.axis), material)


def _bar(first: Disc | Ball, second: Disc | Ball, material: str) -> Iterator[Primitive]:
    """From middle to middle: a cylinder if their axes lie on that line, else a box."""
    ends = np.array([first.middle, second.middle], float)
    length = float(np.linalg.norm(ends[1] - ends[0]))
    if length == 0.0:
        return
    direction = (ends[1] - ends[0]) / length
    axes = [solid.axis for solid in (first, second) if isinstance(solid, Disc)]
    across = [np.cross(direction, axis) for axis in axes]
    middle = ends.mean(axis=0)
    if not np.any(across):
        radius = min(first.radius, second.radius)
        yield Primitive("cylinder", (radius, length), middle, _along(axes[0]), material)
        return
    y = max(across, key=lambda vector: float(np.linalg.norm(vector)))
    y = y / np.linalg.norm(y)
    rotation = np.column_stack((np.cross(y, direction), y, direction))
    width, depth = (
        2.0 * min(_half_width(first, side), _half_width(second, side)) for side in rotation.T[:2]
    )
    yield Primitive("box", (width, depth, length), middle, rotation, material)


def _half_width(solid: Disc | Ball, direction: np.ndarray) -> float:
    """How far a solid reaches from its middle in a direction [m]."""
    if isinstance(solid, Ball):
        return solid.radius
    along = abs(float(solid.axis @ direction))
    return solid.length / 2.0 * along + solid.radius * float(np.sqrt(max(0.0, 1.0 - along**2)))


def _along(axis: np.ndarray) -> np.ndarray:
    """Rotation that turns z into an axis of coordinates."""
    return np.column_stack((np.roll(axis, 1), np.roll(axis, 2), axis))
