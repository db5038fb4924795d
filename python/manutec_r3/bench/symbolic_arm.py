"""Forward dynamics of the plain arm as a CasADi expression, from which it generates C.

Newton and Euler in the frames of the arms for the torques at ``qdd = 0``, composite bodies for the
mass matrix, ``M = L D L^T`` for the solution: as in our core. CasADi leaves out what is
zero in this arm and unrolls everything else.
"""

import casadi as ca
import numpy as np

from ..export.arm.tree import ArmTree


def forward_dynamics(arm: ArmTree) -> ca.Function:
    """Return joint accelerations (6,) as a function of angles, rates and torques (6,)."""
    q, qd, tau = (ca.SX.sym(name, 6) for name in ("q", "qd", "tau"))
    turn = [_turn(q[j], joint.about_x) for j, joint in enumerate(arm.joints)]
    axis = [ca.SX(joint.direction) for joint in arm.joints]
    bodies = [_about_joint(*body) for body in arm.bodies]
    at = [ca.SX(joint.offset) for joint in arm.joints]
    armature = [joint.armature for joint in arm.joints]

    factor, diagonal, order = ca.ldl(_mass_matrix(turn, axis, at, bodies, armature))
    qdd = ca.ldl_solve(
        tau - _bias(turn, axis, at, bodies, qd, arm.gravity), factor, diagonal, order
    )
    return ca.Function("forward_dynamics", [q, qd, tau], [ca.cse(qdd)])


def _turn(angle: ca.SX, about_x: bool) -> ca.SX:
    c, s = ca.cos(angle), ca.sin(angle)
    rows = ([1, 0, 0], [0, c, -s], [0, s, c]) if about_x else ([c, -s, 0], [s, c, 0], [0, 0, 1])
    return ca.vertcat(*(ca.horzcat(*row) for row in rows))


def _about_joint(mass: float, centre: np.ndarray, inertia: np.ndarray) -> tuple:
    """Mass, first moments, inertia about the joint."""
    shifted = inertia + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return mass, ca.SX(mass * centre), ca.SX(shifted)


def _bias(turn: list, axis: list, at: list, bodies: list, qd: ca.SX, gravity: float) -> ca.SX:
    """Torques at ``qdd = 0``."""
    w, wd, a = ca.SX(3, 1), ca.SX(3, 1), ca.SX([0, 0, gravity])
    forces = []
    for j, (mass, first, inertia) in enumerate(bodies):
        a = turn[j].T @ (a + ca.cross(wd, at[j]) + ca.cross(w, ca.cross(w, at[j])))
        w, wd = turn[j].T @ w, turn[j].T @ wd
        wd += ca.cross(w, axis[j] * qd[j])
        w += axis[j] * qd[j]
        force = mass * a + ca.cross(wd, first) + ca.cross(w, ca.cross(w, first))
        moment = ca.cross(first, a) + inertia @ wd + ca.cross(w, inertia @ w)
        forces.append((force, moment))
    torque = [ca.SX(0)] * 6
    force, moment = ca.SX(3, 1), ca.SX(3, 1)
    for j in reversed(range(6)):
        force, moment = force + forces[j][0], moment + forces[j][1]
        torque[j] = axis[j].T @ moment
        force = turn[j] @ force
        moment = turn[j] @ moment + ca.cross(at[j], force)
    return ca.vertcat(*torque)


def _mass_matrix(turn: list, axis: list, at: list, bodies: list, armature: list) -> ca.SX:
    mass_matrix = ca.SX(np.diag(armature))
    mass, first, inertia = 0.0, ca.SX(3, 1), ca.SX(3, 3)
    for j in reversed(range(6)):
        mass, first, inertia = (
            ours + theirs for ours, theirs in zip((mass, first, inertia), bodies[j], strict=True)
        )
        # Force and moment that turn arms j to 6 about axis j with unit acceleration.
        force, moment = ca.cross(axis[j], first), inertia @ axis[j]
        mass_matrix[j, j] += axis[j].T @ moment
        for i in reversed(range(j)):
            force = turn[i + 1] @ force
            moment = turn[i + 1] @ moment + ca.cross(at[i + 1], force)
            mass_matrix[i, j] = mass_matrix[j, i] = axis[i].T @ moment
        # All of it seen from the preceding arm.
        turned, across = turn[j] @ first, ca.skew(at[j])
        inertia = turn[j] @ inertia @ turn[j].T - (
            across @ ca.skew(turned) + ca.skew(turned) @ across + mass * across @ across
        )
        first = turned + mass * at[j]
    return mass_matrix
