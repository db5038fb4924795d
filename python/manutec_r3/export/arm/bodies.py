"""Bodies of the arms that every program accepts: rigid bodies with a mass, the load among them.

The report does not give as much of all arms. Three things make such bodies of what it gives, none
of which has an effect on the motion:

* Arm 1 turns about an axis at rest. Of its body only the inertia about that axis counts.
* Two bodies that are joined by an axis z turn alike about x and y: they may exchange inertia
  ``diag(a, a, 0)``. Where of an arm, such as 6, only `I33` is known, the preceding arm lends it the
  rest.
* What has no mass, or no inertia about some axis, gets a grain of it. The armature of its joint is
  so much larger that the grain is lost in roundoff.
"""

from typing import Any, NamedTuple

import numpy as np

from ...robot import Robot

_GRAIN = 1e-14  # kg, kg m^2: MuJoCo refuses 1e-15; of p^2 rJ = 0.4 kg m^2 it is 2e-14
_ROUNDOFF = 1e-12  # in parts of a body's inertia, as the core has it


class Body(NamedTuple):
    """A rigid body in the frame of its arm.

    Attributes
    ----------
    mass : float
        [kg].
    centre : ndarray (3,)
        Centre of mass [m].
    inertia : ndarray (3, 3)
        About the centre of mass [kg m^2].
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    @property
    def second_moments(self) -> np.ndarray:
        """Integrals of x_i x_j over the mass, about its centre (3, 3) [kg m^2]."""
        return np.trace(self.inertia) / 2.0 * np.eye(3) - self.inertia

    @property
    def is_rigid(self) -> bool:
        """Whether principal moments fulfil the triangle inequality: no second moment negative."""
        smallest = np.linalg.eigvalsh(self.second_moments)[0]
        return bool(smallest >= -_ROUNDOFF * np.trace(self.inertia))


def rigid_bodies(robot: Robot) -> tuple[list[Body], list[str]]:
    """Return bodies of the arms, and what is not as in Table 3.

    Parameters
    ----------
    robot : Robot
        Any model.

    Returns
    -------
    bodies : list of Body
        Of each arm, or, where arms 3 to 6 are one lumped body, of arms 1 to 3. The last has the
        load.
    remarks : list of str

    Raises
    ------
    ValueError
        If an arm is no rigid body: which, what was expected, what arrived.
    """
    table_3 = robot.parameters["table_3"]
    arms, offsets = list(table_3["arms"]), [np.array(arm["offset"]) for arm in table_3["arms"]]
    remarks = []
    if robot.arm == "lumped":
        arms[2:] = [table_3["lumped_arm_3"]]
        remarks.append("Arm 3 has the mass and inertia of arms 3 to 6 and of the load.")
    bodies = [_body(arm) for arm in arms]
    remarks += _complete_arm_1(bodies)
    remarks += _complete_by_exchange(bodies, [arm["axis"] for arm in arms])
    if robot.load.mass:
        between = np.sum([np.zeros(3), *offsets[len(bodies) :]], axis=0)
        place = between + np.array(robot.load.position)
        bodies[-1] = _joined(bodies[-1], Body(robot.load.mass, place, np.zeros((3, 3))))
    remarks += _add_grains(bodies)
    return bodies, remarks


def _body(arm: dict[str, Any]) -> Body:
    """Return what Table 3 says of an arm, which is symmetrical to its x-z plane."""
    i11, i22, i33, i13 = (arm[name] for name in ("I11", "I22", "I33", "I13"))
    inertia = np.array([[i11, 0.0, i13], [0.0, i22, 0.0], [i13, 0.0, i33]])
    return Body(arm["mass"], np.array(arm["centre_of_mass"]), inertia)


def _complete_arm_1(bodies: list[Body]) -> list[str]:
    """Make a ball of 1 kg of arm 1, unless it is a rigid body with a mass."""
    mass, (x, y, _), inertia = bodies[0]
    if mass and bodies[0].is_rigid:
        return []
    about_axis = inertia[2, 2] + mass * (x**2 + y**2)
    bodies[0] = Body(1.0, np.zeros(3), about_axis * np.eye(3))
    return [
        "Of arm 1 only the inertia about its axis is known, and only that counts while the base is "
        "at rest: the rest is made up."
    ]


def _complete_by_exchange(bodies: list[Body], axes: list[str]) -> list[str]:
    """Have arms that turn about z borrow inertia about x and y from the arms before them."""
    remarks = []
    for j in range(1, len(bodies)):
        missing = -float(bodies[j].second_moments[2, 2])
        if axes[j] == "z" and missing > 0.0 and not bodies[j].is_rigid:
            exchanged = np.diag([missing, missing, 0.0])
            bodies[j] = bodies[j]._replace(inertia=bodies[j].inertia + exchanged)
            bodies[j - 1] = bodies[j - 1]._replace(inertia=bodies[j - 1].inertia - exchanged)
            remarks.append(
                f"Arm {j} has lent arm {j + 1} {missing:g} kg m^2 across axis {j + 1}: together "
                "they move as with Table 3."
            )
    for j, body in enumerate(bodies, start=1):
        if not body.is_rigid:
            moments = ", ".join(f"{moment:g}" for moment in np.diag(body.inertia))
            raise ValueError(
                f"table_3 arms of arm {j}: expected the inertia of a rigid body, none of whose "
                f"principal moments exceeds the sum of the others, got I11, I22, I33 = {moments} "
                f"kg m^2{' (less what the next arm needs)' if remarks else ''}"
            )
    return remarks


def _joined(*bodies: Body) -> Body:
    """Return one rigid body of several."""
    mass = sum(m for m, _, _ in bodies)
    centre = np.sum([m * c for m, c, _ in bodies], axis=0) / mass
    about_centre = [
        i + m * ((c - centre) @ (c - centre) * np.eye(3) - np.outer(c - centre, c - centre))
        for m, c, i in bodies
    ]
    return Body(mass, centre, np.sum(about_centre, axis=0))


def _add_grains(bodies: list[Body]) -> list[str]:
    """Leave no mass and no principal moment at zero."""
    remarks = []
    for j, (mass, centre, inertia) in enumerate(bodies):
        missing = _GRAIN - float(np.linalg.eigvalsh(inertia)[0])
        if mass < _GRAIN or missing > 0.0:
            grain = max(0.0, missing) * np.eye(3)
            bodies[j] = Body(max(mass, _GRAIN), centre, inertia + grain)
            remarks.append(
                f"Arm {j + 1} has no {'inertia about some axis' if mass else 'mass'}: {_GRAIN:g} "
                f"{'kg m^2' if mass else 'kg and kg m^2'} stand in, since programs refuse zero. "
                f"Joint {j + 1} is all but singular where the inertia of its rotor is not known."
            )
    return remarks
