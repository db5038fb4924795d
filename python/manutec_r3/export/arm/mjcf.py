"""The arm as MJCF, the format of MuJoCo, which Pinocchio and Drake read too.

It has gravity, and ``p^2 rJ`` as the armature of a joint. A motor drives its joint by ``p`` times
its torque.
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


def export_mjcf(robot: Robot, path: str | PathLike[str]) -> tuple[str, ...]:
    """Write the arm with ideal gears as MJCF.

    Bodies ``base`` and ``arm_1`` to ``arm_6``, whose frames are those of `Robot.link_poses`, joints
    ``joint_1`` to ``joint_6``, a site ``tip`` where the load is, and motors ``motor_1`` to
    ``motor_6``, whose controls are motor torques [N m]. The motion is that of
    ``Robot(rotor_coupling="simplified").forward_dynamics``.

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
    >>> remarks = r3.export_mjcf(r3.Robot(model=1, load=r3.Load(15.0)), "r3.xml")
    >>> remarks[0]
    'Controllers, motor dynamics, friction, elasticity and backlash are left out: gears are ideal.'
    """
    tree = arm_tree(robot)
    remarks = (*tree.remarks, *_remarks(tree))
    root = document(tree)
    with_remarks(root, robot.title, remarks)
    write(root, path)
    return remarks


def document(tree: ArmTree) -> Element:
    """Return the root of the document."""
    root = Element("mujoco", model="manutec_r3")
    SubElement(root, "compiler", angle="radian")
    SubElement(root, "option", gravity=numbers(0.0, 0.0, -tree.gravity))
    default = SubElement(root, "default")
    SubElement(default, "geom", contype="0", conaffinity="0", mass="0")  # shapes are to be seen
    asset = SubElement(root, "asset")
    for name, material in MATERIALS.items():
        look = {"rgba": short(*(c / 255.0 for c in colour(name)), 1.0)}
        look |= {"metallic": short(material.metallic), "roughness": short(material.roughness)}
        SubElement(asset, "material", {"name": name} | look)
    base, *arms = tree.links
    body = _add_body(SubElement(root, "worldbody"), base, np.zeros(3))
    for joint, arm in zip(tree.joints, arms, strict=True):
        body = _add_body(body, arm, joint.offset, joint if joint.moves else None)
    if tree.tip is not None:
        SubElement(body, "site", name="tip", pos=numbers(*tree.tip), size="0.005")
    actuator = SubElement(root, "actuator")
    for joint in tree.moving_joints:
        _add_motor(actuator, joint)
    return root


def _remarks(tree: ArmTree) -> tuple[str, ...]:
    rates = [joint.rate_limit for joint in tree.moving_joints]
    if not np.all(np.isfinite(rates)):
        return ()
    limits = ", ".join(f"{rate:.4g}" for rate in rates)
    return (f"MJCF has no place for limits of joint rates: {limits} rad/s.",)


def _add_body(
    parent: Element, link: Link, offset: np.ndarray, joint: Joint | None = None
) -> Element:
    body = SubElement(parent, "body", name=link.name, pos=numbers(*offset))
    if joint:
        _add_joint(body, joint)
    if link.body:
        _add_inertial(body, link.body)
    for shape in link.shapes:
        _add_geom(body, shape)
    return body


def _add_joint(body: Element, joint: Joint) -> None:
    hinge = {"name": joint.name, "type": "hinge", "axis": numbers(*joint.direction)}
    if np.isfinite(joint.angle_limit):
        hinge["range"] = numbers(-joint.angle_limit, joint.angle_limit)
    SubElement(body, "joint", hinge | {"armature": numbers(joint.armature)})


def _add_inertial(element: Element, body: Body) -> None:
    xx, yy, zz = np.diag(body.inertia)
    xy, xz, yz = body.inertia[0, 1], body.inertia[0, 2], body.inertia[1, 2]
    place = {"pos": numbers(*body.centre), "mass": numbers(body.mass)}
    SubElement(element, "inertial", place | {"fullinertia": numbers(xx, yy, zz, xy, xz, yz)})


def _add_geom(body: Element, shape: Primitive) -> None:
    size = shape.size
    if shape.kind != "sphere":  # half lengths and half edges
        size = (size[0], size[1] / 2.0) if shape.kind == "cylinder" else tuple(np.divide(size, 2.0))
    x, y, _ = shape.rotation.T
    place = {"pos": short(*shape.position), "xyaxes": short(*x, *y)}
    look = {"type": shape.kind, "size": short(*size), "material": shape.material}
    SubElement(body, "geom", look | place)


def _add_motor(actuator: Element, joint: Joint) -> None:
    motor = {"name": joint.motor, "joint": joint.name}
    motor["gear"] = numbers(joint.gear_ratio)
    if np.isfinite(joint.motor_torque_limit):
        motor["ctrlrange"] = numbers(-joint.motor_torque_limit, joint.motor_torque_limit)
    SubElement(actuator, "motor", motor)
