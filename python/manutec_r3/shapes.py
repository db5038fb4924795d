"""The robot as simple shapes: each part is one solid, or the convex hull of two.

What is known of the robot are its axes (specification section 3), and they are where the core has
them: lengths of the arms come from `Robot.link_poses`, the height of the shoulder above the floor
from Table 3. Arm 2 stands beside the plane of the axes, as its centre of mass does. All other sizes
are made up, to look like a robot; nothing but pictures depends on them.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np

from .robot import Robot


class Material(NamedTuple):
    """Of what a part seems to be: its colour as CSS writes it, how metallic, how rough."""

    colour: str
    metallic: float
    roughness: float


MATERIALS = {
    "paint": Material("#e4e6e4", 0.0, 0.42),
    "casting": Material("#3d4853", 0.0, 0.48),
    "steel": Material("#9aa3ab", 0.3, 0.35),
    "load": Material("#0b3c6f", 0.0, 0.35),
    "branch": Material("#8d97a1", 0.0, 0.4),  # the page colours it as the friction of the joint
}

_STEEL_DENSITY = 7850.0  # kg/m^3: size of the load

X, Z = np.eye(3)[0], np.eye(3)[2]


def rgb(colour: str) -> tuple[int, int, int]:
    """Return red, green and blue, 0 to 255, of a colour as CSS writes it."""
    red, green, blue = bytearray.fromhex(colour[1:])
    return red, green, blue


def colour(material: str) -> tuple[int, int, int]:
    """Red, green and blue of a material, 0 to 255, in the usual space sRGB."""
    return rgb(MATERIALS[material].colour)


class Disc(NamedTuple):
    """A disc, or a drum, whose edges are rounded [m]; its axis is an axis of coordinates."""

    middle: tuple[float, float, float]
    axis: np.ndarray
    radius: float
    length: float
    edge: float = 0.012


class Ball(NamedTuple):
    """A ball [m]."""

    middle: tuple[float, float, float]
    radius: float


class Part(NamedTuple):
    """What is made of one material: a solid, or the convex hull of two."""

    material: str
    solids: tuple[Disc | Ball, ...]


def _hull(material: str, *solids: Disc | Ball) -> Part:
    """Return a part."""
    return Part(material, solids)


def arms(robot: Robot) -> dict[str, list[Part]]:
    """Parts of the base, of each arm and of the load.

    Parameters
    ----------
    robot : Robot
        Its axes, its load.

    Returns
    -------
    dict
        ``base``, ``arm_1`` to ``arm_6`` (of one axis: ``arm_1``) and, if there is one, ``load``:
        lists of parts. The base is in the frame of the world, an arm in its own, the load in that
        of arm 6. The material ``branch`` marks the joint that moves an arm.
    """
    made = _one_axis(robot) if robot.n_axes == 1 else _six_arms(robot)
    return {arm: list(parts) for arm, parts in made.items()}


def floor_height(robot: Robot) -> float:
    """Where the floor is in the world [m]: the base is below the shoulder."""
    shoulder = robot.link_poses(np.zeros(robot.n_axes))[2, 2, 3]
    return float(shoulder - robot.parameters["table_3"]["shoulder_height"])


def _six_arms(robot: Robot) -> dict[str, Iterable[Part]]:
    origin = robot.link_poses(np.zeros(robot.n_axes))[1:, :3, 3]
    shoulder, elbow, roll, wrist, flange = np.diff(origin, axis=0)  # each from the joint before
    turret = floor_height(robot) + 0.375
    seat = min(0.12, 0.35 * wrist[2])  # where arm 4 begins, above its joint
    made: dict[str, Iterable[Part]] = {
        "base": _base(floor_height(robot), turret),
        "arm_1": _turret(turret, shoulder),
        "arm_2": _upper_arm(elbow),
        "arm_3": _elbow(roll + seat * Z),
        "arm_4": _forearm(seat, wrist),
        "arm_5": _wrist(flange),
        "arm_6": _flange(),
    }
    if robot.load.mass:
        made["load"] = _load(robot)
    return made


def _base(floor: float, top: float) -> Iterator[Part]:
    yield _hull("casting", Disc((0, 0, floor + 0.02), Z, 0.31, 0.04))
    column = Disc((0, 0, floor + 0.05), Z, 0.21, 0.04), Disc((0, 0, top - 0.05), Z, 0.165, 0.04)
    yield _hull("paint", *column)
    yield _hull("casting", Disc((0, 0, top - 0.02), Z, 0.175, 0.035))


def _turret(bottom: float, shoulder: np.ndarray) -> Iterator[Part]:
    yield _hull("branch", Disc((0, 0, bottom + 0.008), Z, 0.178, 0.016, 0.004))
    x, y, z = shoulder
    drum = Disc((x - 0.02, y, z), X, 0.135, 0.17)
    yield _hull("paint", Disc((0, 0, bottom + 0.05), Z, 0.18, 0.07), drum)
    yield _hull("casting", Disc((x - 0.17, y, z), X, 0.085, 0.15))
    yield _hull("steel", Disc((x - 0.25, y, z), X, 0.06, 0.03))
    # the motor of axis 1
    root = Disc((0, 0.1, bottom + 0.05), Z, 0.07, 0.06)
    yield _hull("casting", Disc((0, 0.2, bottom + 0.1), Z, 0.06, 0.2), root)


def _upper_arm(elbow: np.ndarray) -> Iterator[Part]:
    x, y, z = elbow
    yield _hull("branch", Disc((0.075, 0, 0), X, 0.132, 0.016, 0.004))
    lower = Disc((0.155, 0, 0), X, 0.135, 0.14, 0.025)
    upper = Disc((x + 0.15, y, z), X, 0.095, 0.115, 0.025)
    yield _hull("paint", lower, upper)
    yield _hull("casting", Disc((0.225, 0, 0), X, 0.095, 0.03))
    yield _hull("casting", Disc((x + 0.21, y, z), X, 0.065, 0.03))


def _elbow(seat: np.ndarray) -> Iterator[Part]:
    yield _hull("branch", Disc((0.085, 0, 0), X, 0.092, 0.016, 0.004))
    drum = Disc((-0.01, 0, 0), X, 0.095, 0.175, 0.02)
    yield _hull("paint", drum, Disc((seat[0], seat[1], seat[2] - 0.025), Z, 0.085, 0.05))
    # motors of axes 4 to 6 behind the elbow
    for angle in np.radians((90.0, 210.0, 330.0)):
        x, y = 0.048 * np.cos(angle) - 0.01, 0.048 * np.sin(angle)
        yield _hull("casting", Disc((x, y, -0.14), Z, 0.042, 0.2))
        yield _hull("steel", Disc((x, y, -0.245), Z, 0.03, 0.02))


def _forearm(seat: float, wrist: np.ndarray) -> Iterator[Part]:
    x, y, z = wrist
    yield _hull("branch", Disc((0, 0, seat + 0.008), Z, 0.082, 0.016, 0.004))
    fork = max(z - 0.13, seat + 0.03)
    lower, upper = Disc((0, 0, seat + 0.03), Z, 0.08, 0.03), Disc((x, y, fork), Z, 0.064, 0.03)
    yield _hull("paint", lower, upper)
    for side in (-1.0, 1.0):
        cheek = Disc((x + 0.052 * side, y, z), X, 0.046, 0.026)
        root = Disc((x + 0.045 * side, y, fork), X, 0.035, 0.026)
        yield _hull("paint", cheek, root)
        yield _hull("casting", Disc((x + 0.067 * side, y, z), X, 0.032, 0.014, 0.005))


def _wrist(flange: np.ndarray) -> Iterator[Part]:
    x, y, z = flange
    yield _hull("branch", Disc((0, 0, 0), X, 0.043, 0.074, 0.004))
    yield _hull("casting", Disc((0, 0, 0), X, 0.038, 0.072), Disc((x, y, z + 0.07), Z, 0.036, 0.03))


def _flange() -> Iterator[Part]:
    yield _hull("branch", Disc((0, 0, 0.092), Z, 0.042, 0.014, 0.004))
    yield _hull("steel", Disc((0, 0, 0.107), Z, 0.04, 0.016, 0.004))


def _load(robot: Robot) -> Iterator[Part]:
    radius = np.cbrt(3.0 * robot.load.mass / (4.0 * np.pi * _STEEL_DENSITY))
    yield _hull("steel", Disc((0, 0, 0.117), Z, 0.016, 0.02), Ball(robot.load.position, 0.013))
    yield _hull("load", Ball(robot.load.position, radius))


def _one_axis(robot: Robot) -> dict[str, Iterable[Part]]:
    """Return what turns about a vertical axis: a beam with two weights, on a column."""
    floor = floor_height(robot)
    weights = [_hull("load", Disc((0, y, 0.03), Z, 0.12, 0.16)) for y in (-0.5, 0.5)]
    beam = _hull("paint", *(Disc((0, y, 0.03), Z, 0.06, 0.06) for y in (-0.5, 0.5)))
    joint = _hull("branch", Disc((0, 0, -0.035), Z, 0.178, 0.016, 0.004))
    cap = _hull("casting", Disc((0, 0, 0.03), Z, 0.12, 0.11))
    return {"base": _base(floor, -0.045), "arm_1": [joint, beam, cap, *weights]}
