"""The robot's shapes as meshes, which are made by trimesh."""

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from .. import shapes
from ..robot import Robot
from ..shapes import MATERIALS, Ball, Disc, colour

_SIDES = 36  # of what is round
_EDGE = np.linspace(0.0, np.pi / 2.0, 4)  # of a disc
_CREASE = np.radians(35.0)  # a sharper edge is not smoothed


def points(solid: Disc | Ball) -> np.ndarray:
    """Points (n, 3) on the surface of a solid [m], of which it is the convex hull."""
    if isinstance(solid, Ball):
        sphere = trimesh.creation.icosphere(subdivisions=3, radius=solid.radius)
        return sphere.vertices + np.array(solid.middle)
    middle, axis, radius, length, edge = solid
    turn = np.linspace(0.0, 2.0 * np.pi, _SIDES, endpoint=False)
    across = np.roll(axis, 1), np.roll(axis, 2)  # axes of coordinates stay right-handed
    round_trip = np.outer(np.cos(turn), across[0]) + np.outer(np.sin(turn), across[1])
    edge = min(edge, length / 2.0, radius)
    rings = [
        (side * (length / 2.0 - edge + edge * np.sin(a)), radius - edge + edge * np.cos(a))
        for side in (-1.0, 1.0)
        for a in _EDGE
    ]
    on_rings = [height * axis + r * round_trip for height, r in rings]
    return np.concatenate(on_rings) + np.array(middle)


def arms(robot: Robot) -> dict[str, list[tuple[str, trimesh.Trimesh]]]:
    """Materials and meshes of the parts of `shapes.arms`: of an arm one mesh of each material."""
    made: dict[str, list[tuple[str, trimesh.Trimesh]]] = {}
    for arm, parts in shapes.arms(robot).items():
        of_material: dict[str, list[trimesh.Trimesh]] = {}
        for material, solids in parts:
            of_material.setdefault(material, []).append(_hull(solids))
        made[arm] = [(name, trimesh.util.concatenate(same)) for name, same in of_material.items()]
    return made


def _hull(solids: tuple[Disc | Ball, ...]) -> trimesh.Trimesh:
    """Return the convex hull of solids, smooth but for its sharp edges."""
    mesh = trimesh.convex.convex_hull(np.concatenate([points(solid) for solid in solids]))
    return trimesh.graph.smooth_shade(mesh, angle=_CREASE)


def scene(robot: Robot) -> trimesh.Scene:
    """Return the parts as a scene: nodes of the base, of the arms and, on arm 6, of the load."""
    made = trimesh.Scene()
    for arm, parts in arms(robot).items():
        made.graph.update(frame_to=arm, frame_from="arm_6" if arm == "load" else None)
        for material, mesh in parts:
            made.add_geometry(_painted(material, mesh), parent_node_name=arm)
    return made


def _painted(material: str, mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    _, metallic, rough = MATERIALS[material]
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
