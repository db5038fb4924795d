"""The arm as URDF, which Pinocchio, Drake, ROS and many others read.

URDF has no place for gravity, nor for rotors. Of these it has what Drake reads: ``rJ`` as
``drake:rotor_inertia``, ``|p|`` as ``drake:gear_ratio`` in the transmission of a joint.
"""

from os import PathLike
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from ...robot import Robot
from ...shapes import MATERIALS, colour
from .bodies import Body
from .primitives import Primitive
from .tree import ArmTree, Joint, Link, arm_tree
from .xml_file import numbers, short, with_remarks, write

_NO_LIMIT = 1e9  # where URDF wants a number beside others, and there is none


def export_urdf(robot: Robot, path: str | PathLike[str]) -> tuple[str, ...]:
    """Write the arm with ideal gears as URDF.

    Links ``base`` and ``arm_1`` to ``arm_6``, whose frames are those of `Robot.link_poses`, joints
    ``joint_1`` to ``joint_6``, and a link ``tip`` where the load is; a link ``world`` holds the
    base. The motion is that of ``Robot(rotor_coupling="simplified").forward_dynamics``, in programs
    that know the inertia of the rotors.

    Parameters
    ----------
    robot : Robot
        Any model.
    path : str or path-like
        The file to write.

    Returns
    -------
    tuple of str
        What the file does not say of the robot, or says otherwise; a comment in it says the same.

    Raises
    ------
    ValueError, TypeError
        What was wrong, what was expected, what arrived.

    Examples
    --------
    >>> remarks = r3.export_urdf(r3.Robot(model=1, load=r3.Load(15.0)), "r3.urdf")
    >>> remarks[-2]
    'URDF has no place for gravity: 9.81 m/s^2 along -z of the base.'
    """
    tree = arm_tree(robot)
    remarks = (*tree.remarks, *_remarks(tree))
    root = document(tree)
    with_remarks(root, robot.title, remarks)
    write(root, path)
    return remarks


def document(tree: ArmTree) -> Element:
    """Return the root of the document."""
    root = Element("robot", {"name": "manutec_r3", "xmlns:drake": "http://drake.mit.edu"})
    for material in MATERIALS:
        painted = SubElement(root, "material", name=material)
        SubElement(painted, "color", rgba=short(*(c / 255.0 for c in colour(material)), 1.0))
    SubElement(root, "link", name="world")
    _add_fixed(root, "base_on_world", "world", "base", np.zeros(3))
    for link in tree.links:
        _add_link(root, link)
    for joint in tree.joints:
        if joint.moves:
            _add_joint(root, joint)
        else:
            _add_fixed(root, joint.name, joint.parent, joint.child, joint.offset)
    if tree.tip is not None:
        SubElement(root, "link", name="tip")
        _add_fixed(root, "tip_on_arm_6", "arm_6", "tip", tree.tip)
    for joint in tree.moving_joints:
        _add_transmission(root, joint)
    return root


def _remarks(tree: ArmTree) -> tuple[str, ...]:
    armatures = ", ".join(f"{joint.armature:.10g}" for joint in tree.moving_joints)
    return (
        f"URDF has no place for gravity: {tree.gravity:g} m/s^2 along -z of the base.",
        f"URDF has no place for the inertia of rotors, p^2 rJ = {armatures} kg m^2 at the joints: "
        "Drake reads it from drake:rotor_inertia and drake:gear_ratio, Pinocchio has to be told "
        "(model.armature), for MuJoCo there is MJCF.",
    )


def _add_link(root: Element, link: Link) -> None:
    element = SubElement(root, "link", name=link.name)
    if link.body:
        _add_inertial(element, link.body)
    for shape in link.shapes:
        _add_visual(element, shape)


def _add_inertial(link: Element, body: Body) -> None:
    inertial = SubElement(link, "inertial")
    SubElement(inertial, "origin", xyz=numbers(*body.centre), rpy=numbers(0, 0, 0))
    SubElement(inertial, "mass", value=numbers(body.mass))
    moments = {
        f"i{'xyz'[row]}{'xyz'[column]}": numbers(body.inertia[row, column])
        for row in range(3)
        for column in range(row, 3)
    }
    SubElement(inertial, "inertia", moments)


def _add_visual(link: Element, shape: Primitive) -> None:
    visual = SubElement(link, "visual")
    place = {"xyz": short(*shape.position), "rpy": short(*_roll_pitch_yaw(shape.rotation))}
    SubElement(visual, "origin", place)
    geometry = SubElement(visual, "geometry")
    match shape.kind:
        case "box":
            SubElement(geometry, "box", size=short(*shape.size))
        case "cylinder":
            radius, length = shape.size
            SubElement(geometry, "cylinder", radius=short(radius), length=short(length))
        case "sphere":
            SubElement(geometry, "sphere", radius=short(*shape.size))
    SubElement(visual, "material", name=shape.material)


def _add_joint(root: Element, joint: Joint) -> None:
    is_limited = np.isfinite(joint.angle_limit)
    element = _add_any_joint(
        root,
        joint.name,
        "revolute" if is_limited else "continuous",
        joint.parent,
        joint.child,
        joint.offset,
    )
    SubElement(element, "axis", xyz=numbers(*joint.direction))
    if not np.isfinite([joint.angle_limit, joint.torque_limit, joint.rate_limit]).any():
        return
    limits = {
        "effort": numbers(min(joint.torque_limit, _NO_LIMIT)),
        "velocity": numbers(min(joint.rate_limit, _NO_LIMIT)),
    }
    if is_limited:
        limits |= {"lower": numbers(-joint.angle_limit), "upper": numbers(joint.angle_limit)}
    SubElement(element, "limit", limits)


def _add_fixed(root: Element, name: str, parent: str, child: str, offset: np.ndarray) -> None:
    _add_any_joint(root, name, "fixed", parent, child, offset)


def _add_any_joint(
    root: Element, name: str, kind: str, parent: str, child: str, offset: np.ndarray
) -> Element:
    element = SubElement(root, "joint", name=name, type=kind)
    SubElement(element, "origin", xyz=numbers(*offset), rpy=numbers(0, 0, 0))
    SubElement(element, "parent", link=parent)
    SubElement(element, "child", link=child)
    return element


def _add_transmission(root: Element, joint: Joint) -> None:
    transmission = SubElement(root, "transmission", name=f"transmission_{joint.axis}")
    SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
    driven = SubElement(transmission, "joint", name=joint.name)
    SubElement(driven, "hardwareInterface").text = "hardware_interface/EffortJointInterface"
    motor = SubElement(transmission, "actuator", name=joint.motor)
    SubElement(motor, "mechanicalReduction").text = numbers(joint.gear_ratio)
    SubElement(motor, "drake:rotor_inertia", value=numbers(joint.rotor_inertia))
    SubElement(motor, "drake:gear_ratio", value=numbers(abs(joint.gear_ratio)))


def _roll_pitch_yaw(rotation: np.ndarray) -> tuple[float, float, float]:
    """Angles about the fixed axes x, y, z, in this order, that make a rotation [rad]."""
    sine = -rotation[2, 0]
    if abs(sine) > 1.0 - 1e-12:  # z lies on x, about which roll and yaw turn alike
        yaw = 0.0
        roll = np.arctan2(np.sign(sine) * rotation[0, 1], rotation[1, 1])
    else:
        roll = np.arctan2(rotation[2, 1], rotation[2, 2])
        yaw = np.arctan2(rotation[1, 0], rotation[0, 0])
    return float(roll), float(np.arcsin(np.clip(sine, -1.0, 1.0))), float(yaw)
