"""The arm with ideal gears as a tree of links and joints: what URDF and MJCF can say.

Its equations of motion are those of spec 6 with simplified rotors: on joint ``j`` the rotor is an
armature ``p^2 rJ``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ... import shapes
from ...robot import Robot
from .bodies import Body, rigid_bodies
from .primitives import Primitive, primitives


class Link(NamedTuple):
    """What moves as one.

    Attributes
    ----------
    name : str
    body : Body or None
        None if another link has its mass, or nothing moves it.
    shapes : list of Primitive
        What it looks like.
    """

    name: str
    body: Body | None
    shapes: list[Primitive]


@dataclass(frozen=True)
class Joint:
    """Joint of an arm with the one before.

    Attributes
    ----------
    axis : int
        Its number.
    parent, child : str
        Names of the links that it joins.
    offset : ndarray (3,)
        Where it is in the frame of its parent [m]; at angle zero the frames are parallel.
    about_x : bool
        Whether it turns about x, else about z.
    moves : bool
        False where a brake holds it, at angle zero.
    angle_limit : float
        Largest magnitude of its angle [rad]; infinite if there is none.
    gear_ratio : float
        ``p``: rotor angle by joint angle.
    rotor_inertia : float
        ``rJ`` [kg m^2], motor side.
    motor_torque_limit, rotor_rate_limit : float
        Motor side [N m, rad/s]; infinite if there is none.
    """

    axis: int
    parent: str
    child: str
    offset: np.ndarray
    about_x: bool
    moves: bool
    angle_limit: float
    gear_ratio: float
    rotor_inertia: float
    motor_torque_limit: float
    rotor_rate_limit: float

    @property
    def name(self) -> str:
        """``joint_1`` to ``joint_6``."""
        return f"joint_{self.axis}"

    @property
    def motor(self) -> str:
        """``motor_1`` to ``motor_6``."""
        return f"motor_{self.axis}"

    @property
    def direction(self) -> tuple[int, int, int]:
        """About which it turns, a unit vector."""
        return (1, 0, 0) if self.about_x else (0, 0, 1)

    @property
    def armature(self) -> float:
        """Inertia of the rotor, joint side [kg m^2]."""
        return self.gear_ratio**2 * self.rotor_inertia

    @property
    def torque_limit(self) -> float:
        """Of the motor, joint side [N m]."""
        return abs(self.gear_ratio) * self.motor_torque_limit

    @property
    def rate_limit(self) -> float:
        """Of the rotor, joint side [rad/s]."""
        return self.rotor_rate_limit / abs(self.gear_ratio)


@dataclass(frozen=True)
class ArmTree:
    """Links and joints of a robot.

    Attributes
    ----------
    links : list of Link
        The base, whose frame is that of the world, and the arms in their own frames.
    joints : list of Joint
        Joint 1 to the last, which moves the last link.
    tip : ndarray (3,) or None
        The place of the load in the frame of the last arm [m]; None if there is none.
    gravity : float
        Along -z of the base [m/s^2].
    remarks : list of str
        What is not said of the robot, or said otherwise, whatever the format.
    """

    links: list[Link]
    joints: list[Joint]
    tip: np.ndarray | None
    gravity: float
    remarks: list[str]

    @property
    def bodies(self) -> list[Body]:
        """Those of the links that have one, in their order."""
        return [link.body for link in self.links if link.body]

    @property
    def moving_joints(self) -> list[Joint]:
        """Those that no brake holds, in the order of the axes."""
        return [joint for joint in self.joints if joint.moves]


def arm_tree(robot: Robot) -> ArmTree:
    """Return links and joints of a robot of any model.

    Raises
    ------
    TypeError
        If it is no robot.
    ValueError
        If an arm is no rigid body: which, what was expected, what arrived.
    """
    if not isinstance(robot, Robot):
        raise TypeError(f"robot: expected a Robot, got {robot!r}")
    joints = list(_joints(robot))
    bodies, of_bodies = rigid_bodies(robot)
    parts = shapes.arms(robot)
    has_tip = len(joints) == 6
    if has_tip:
        parts["arm_6"] += parts.pop("load", [])
    names = ["base", *(joint.child for joint in joints)]
    body_of = dict(zip(names[1:], bodies, strict=False))
    return ArmTree(
        links=[Link(name, body_of.get(name), primitives(parts[name])) for name in names],
        joints=joints,
        tip=np.array(robot.load.position) if has_tip else None,
        gravity=robot.parameters["table_3"]["gravity"],
        remarks=[*_remarks(robot, joints), *of_bodies],
    )


def _joints(robot: Robot) -> Iterator[Joint]:
    tables = robot.parameters
    motors, table_3 = tables["table_1"], tables["table_3"]
    for j, arm in enumerate(table_3["arms"]):
        yield Joint(
            axis=j + 1,
            parent=f"arm_{j}" if j else "base",
            child=f"arm_{j + 1}",
            offset=np.array(arm["offset"]),
            about_x=arm["axis"] == "x",
            moves=j < robot.n_axes,
            angle_limit=table_3["joint_limits"][j],
            gear_ratio=motors["p"][j],
            rotor_inertia=table_3["rJ"][j],
            # The Modelica variant has no limits.
            motor_torque_limit=motors["b"][j] if "b" in motors else np.inf,
            rotor_rate_limit=motors.get("rotor_rate_max", [np.inf] * 6)[j],
        )


def _remarks(robot: Robot, joints: list[Joint]) -> Iterator[str]:
    yield (
        "Controllers, motor dynamics, friction, elasticity and backlash are left out: gears are "
        "ideal."
    )
    if "full" in robot.rotor_coupling:
        yield (
            "Rotors act on their own joints only, as with rotor_coupling='simplified': what their "
            "spin does to the arms that carry them is left out."
        )
    if not all(joint.moves for joint in joints):
        yield "Joints 4 to 6 are fixed, as brakes hold them."
    moving = [joint for joint in joints if joint.moves]
    endless = [str(joint.axis) for joint in moving if np.isinf(joint.angle_limit)]
    if len(endless) < len(moving):
        yield "Joint angles are only watched in manutec_r3; here programs may stop them at limits."
    if endless:
        yield f"Axes that turn without end, since no limit is known: {', '.join(endless)}."
