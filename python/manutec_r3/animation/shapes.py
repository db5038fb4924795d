"""The robot as simple shapes: each part is the convex hull of discs with rounded edges.

What is known of the robot are its axes (specification section 3), and they are where the core has
them: lengths of the arms come from `Robot.link_poses`, the height of the shoulder above the floor
from Table 3. Arm 2 stands beside the plane of the axes, as its centre of mass does. All other sizes
are made up, to look like a robot; nothing but pictures depends on them.
"""

from collections.abc import Iterable, Iterator

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from ..robot import Robot
from .elements import rgb

# Colours, how metallic and how rough.
_MATERIALS = {
    "paint": ("#e4e6e4", 0.0, 0.42),
    "casting": ("#3d4853", 0.0, 0.48),
    "steel": ("#9aa3ab", 0.3, 0.35),
    "load": ("#0b3c6f", 0.0, 0.35),
    "branch": ("#8d97a1", 0.0, 0.4),  # the page colours it as the friction of the joint
}
_SIDES = 36  # of what is round
_EDGE = np.linspace(0.0, np.pi / 2.0, 4)  # of a disc
_CREASE = np.radians(35.0)  # a sharper edge is not smoothed

_STEEL_DENSITY = 7850.0  # kg/m^3: size of the load

X, Z = np.eye(3)[0], np.eye(3)[2]

Part = tuple[str, trimesh.Trimesh]


def disc(
    middle: tuple[float, float, float],
    axis: np.ndarray,
    radius: float,
    length: float,
    edge: float = 0.012,
) -> np.ndarray:
    """Points (n, 3) of a disc, or of a drum, whose edges are rounded [m]."""
    turn = np.linspace(0.0, 2.0 * np.pi, _SIDES, endpoint=False)
    across = np.roll(axis, 1), np.roll(axis, 2)  # axes of coordinates stay right-handed
    round_trip = np.outer(np.cos(turn), across[0]) + np.outer(np.sin(turn), across[1])
    edge = min(edge, length / 2.0, radius)
    rings = [
        (side * (length / 2.0 - edge + edge * np.sin(a)), radius - edge + edge * np.cos(a))
        for side in (-1.0, 1.0)
        for a in _EDGE
    ]
    points = [height * axis + r * round_trip for height, r in rings]
    return np.concatenate(points) + np.array(middle)


def hull(material: str, *discs: np.ndarray) -> Part:
    """Return the convex hull of discs, smooth but for its sharp edges."""
    mesh = trimesh.convex.convex_hull(np.concatenate(discs))
    return material, trimesh.graph.smooth_shade(mesh, angle=_CREASE)


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
        lists of materials and meshes [m]. The base is in the frame of the world, an arm in its own,
        the load in that of arm 6. The material ``branch`` marks the joint that moves an arm. Of an
        arm there is one mesh of each material.
    """
    if robot.n_axes == 1:
        made = _one_axis(robot)
    else:
        made = _six_arms(robot)
    return {arm: _by_material(parts) for arm, parts in made.items()}


def _by_material(parts: Iterable[Part]) -> list[Part]:
    meshes: dict[str, list[trimesh.Trimesh]] = {}
    for material, mesh in parts:
        meshes.setdefault(material, []).append(mesh)
    return [(material, trimesh.util.concatenate(same)) for material, same in meshes.items()]


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
    yield hull("casting", disc((0, 0, floor + 0.02), Z, 0.31, 0.04))
    column = disc((0, 0, floor + 0.05), Z, 0.21, 0.04), disc((0, 0, top - 0.05), Z, 0.165, 0.04)
    yield hull("paint", *column)
    yield hull("casting", disc((0, 0, top - 0.02), Z, 0.175, 0.035))


def _turret(bottom: float, shoulder: np.ndarray) -> Iterator[Part]:
    yield hull("branch", disc((0, 0, bottom + 0.008), Z, 0.178, 0.016, 0.004))
    x, y, z = shoulder
    drum = disc((x - 0.02, y, z), X, 0.135, 0.17)
    yield hull("paint", disc((0, 0, bottom + 0.05), Z, 0.18, 0.07), drum)
    yield hull("casting", disc((x - 0.17, y, z), X, 0.085, 0.15))
    yield hull("steel", disc((x - 0.25, y, z), X, 0.06, 0.03))
    # the motor of axis 1
    root = disc((0, 0.1, bottom + 0.05), Z, 0.07, 0.06)
    yield hull("casting", disc((0, 0.2, bottom + 0.1), Z, 0.06, 0.2), root)


def _upper_arm(elbow: np.ndarray) -> Iterator[Part]:
    x, y, z = elbow
    yield hull("branch", disc((0.075, 0, 0), X, 0.132, 0.016, 0.004))
    lower = disc((0.155, 0, 0), X, 0.135, 0.14, 0.025)
    upper = disc((x + 0.15, y, z), X, 0.095, 0.115, 0.025)
    yield hull("paint", lower, upper)
    yield hull("casting", disc((0.225, 0, 0), X, 0.095, 0.03))
    yield hull("casting", disc((x + 0.21, y, z), X, 0.065, 0.03))


def _elbow(seat: np.ndarray) -> Iterator[Part]:
    yield hull("branch", disc((0.085, 0, 0), X, 0.092, 0.016, 0.004))
    drum = disc((-0.01, 0, 0), X, 0.095, 0.175, 0.02)
    yield hull("paint", drum, disc((seat[0], seat[1], seat[2] - 0.025), Z, 0.085, 0.05))
    # motors of axes 4 to 6 behind the elbow
    for angle in np.radians((90.0, 210.0, 330.0)):
        x, y = 0.048 * np.cos(angle) - 0.01, 0.048 * np.sin(angle)
        yield hull("casting", disc((x, y, -0.14), Z, 0.042, 0.2))
        yield hull("steel", disc((x, y, -0.245), Z, 0.03, 0.02))


def _forearm(seat: float, wrist: np.ndarray) -> Iterator[Part]:
    x, y, z = wrist
    yield hull("branch", disc((0, 0, seat + 0.008), Z, 0.082, 0.016, 0.004))
    fork = max(z - 0.13, seat + 0.03)
    lower, upper = disc((0, 0, seat + 0.03), Z, 0.08, 0.03), disc((x, y, fork), Z, 0.064, 0.03)
    yield hull("paint", lower, upper)
    for side in (-1.0, 1.0):
        cheek = disc((x + 0.052 * side, y, z), X, 0.046, 0.026)
        root = disc((x + 0.045 * side, y, fork), X, 0.035, 0.026)
        yield hull("paint", cheek, root)
        yield hull("casting", disc((x + 0.067 * side, y, z), X, 0.032, 0.014, 0.005))


def _wrist(flange: np.ndarray) -> Iterator[Part]:
    x, y, z = flange
    yield hull("branch", disc((0, 0, 0), X, 0.043, 0.074, 0.004))
    yield hull("casting", disc((0, 0, 0), X, 0.038, 0.072), disc((x, y, z + 0.07), Z, 0.036, 0.03))


def _flange() -> Iterator[Part]:
    yield hull("branch", disc((0, 0, 0.092), Z, 0.042, 0.014, 0.004))
    yield hull("steel", disc((0, 0, 0.107), Z, 0.04, 0.016, 0.004))


def _load(robot: Robot) -> Iterator[Part]:
    centre = np.array(robot.load.position)
    radius = np.cbrt(3.0 * robot.load.mass / (4.0 * np.pi * _STEEL_DENSITY))
    yield hull("steel", disc((0, 0, 0.117), Z, 0.016, 0.02), ball(centre, 0.013))
    yield hull("load", ball(centre, radius))


def ball(centre: np.ndarray, radius: float) -> np.ndarray:
    """Points (n, 3) of a ball [m]."""
    return trimesh.creation.icosphere(subdivisions=3, radius=radius).vertices + centre


def _one_axis(robot: Robot) -> dict[str, Iterable[Part]]:
    """Return what turns about a vertical axis: a beam with two weights, on a column."""
    floor = floor_height(robot)
    weights = [hull("load", disc((0, y, 0.03), Z, 0.12, 0.16)) for y in (-0.5, 0.5)]
    beam = hull("paint", *(disc((0, y, 0.03), Z, 0.06, 0.06) for y in (-0.5, 0.5)))
    joint = hull("branch", disc((0, 0, -0.035), Z, 0.178, 0.016, 0.004))
    cap = hull("casting", disc((0, 0, 0.03), Z, 0.12, 0.11))
    return {"base": _base(floor, -0.045), "arm_1": [joint, beam, cap, *weights]}


def scene(robot: Robot) -> trimesh.Scene:
    """Return the parts as a scene: nodes of the base, of the arms and, on arm 6, of the load."""
    made = trimesh.Scene()
    for arm, parts in arms(robot).items():
        made.graph.update(frame_to=arm, frame_from="arm_6" if arm == "load" else None)
        for material, mesh in parts:
            made.add_geometry(_painted(material, mesh), parent_node_name=arm)
    return made


def colour(material: str) -> tuple[int, int, int]:
    """Red, green and blue of a material, 0 to 255, in the usual space sRGB."""
    return rgb(_MATERIALS[material][0])


def _painted(material: str, mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    _, metallic, rough = _MATERIALS[material]
    light = np.array(colour(material)) / 255.0  # glTF speaks of linear light
    light = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    look = PBRMaterial(
        name=material,
        baseColorFactor=[*light, 1.0],
        metallicFactor=metallic,
        roughnessFactor=rough,
    )
    mesh.visual = trimesh.visual.TextureVisuals(material=look)
    return mesh
