"""Independent reference implementation of the Manutec r3 models 1 to 4: a test oracle.

Written from the equations of Franke and Otter 1993 (*The Manutec r3 Benchmark Models for the
Dynamic Simulation of Robots*) as restated in the project specification ("spec. N" cites its section
N), with other methods than the fast core:

* rigid bodies by explicit geometric Jacobians and the projected Newton-Euler equations in world
  coordinates;
* rotors as bodies that spin in the arm which carries them, minus the same rotors frozen;
* stiction of rigid gears by trying all combinations of sticking and sliding;
* integration by `scipy.integrate.DOP853` with short steps, indicators watched inside each step, and
  every event located by integrating afresh to the root.

It is slow (about half a minute for a second of model 3) and knows the default options only:
continuous controller, exact stiction, parallel gear damping, full rotor coupling in models 1 and 2,
simplified on axes 1 to 3 of models 3 and 4, lumped arm 3 in models 2 and 4.

    motion = Quintic([0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], 1.2)
    run = simulate(IndependentRobot(3, load_mass=15.0), motion, 1.5)
    run.control_error, run.events
"""

from itertools import product

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

GRAVITY = 9.81  # spec. 2: along -z of the world

# Table 3 (spec. 3): axis, offset from the preceding joint, mass, centre of mass, (I11, I22, I33,
# I13) about that centre. Arm 1 is known by its I33 only, arm 6 has neither mass nor inertia of its
# own (only the rotor and the load count there).
ARMS = (
    ("z", (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.16, 0.0)),
    ("x", (0.0, 0.0, 0.0), 56.5, (0.172, 0.0, 0.205), (2.58, 2.73, 0.64, -0.46)),
    ("x", (0.0, 0.0, 0.5), 26.4, (0.064, 0.0, -0.034), (0.279, 0.413, 0.245, -0.070)),
    ("z", (0.0, 0.0, 0.0), 28.7, (0.0, 0.0, 0.32), (1.67, 1.67, 0.081, 0.0)),
    ("x", (0.0, 0.0, 0.73), 5.2, (0.0, 0.0, 0.023), (0.0125, 0.0153, 0.0081, 0.0)),
    ("z", (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
)
# Arm 3 of models 2 and 4, joints 4 to 6 blocked (spec. 3); the load is counted from H5, 0.73 m
# above joint 3.
LUMPED_ARM_3 = ("x", (0.0, 0.0, 0.5), 60.3, (0.028, 0.0, 0.202), (5.41, 5.60, 0.39, 0.33))
H5_ABOVE_JOINT_3 = np.array([0.0, 0.0, 0.73])
UNIT = {"x": np.array([1.0, 0.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}
ROTOR_AXIS = ("z", "x", "x", "z", "x", "z")  # in the preceding arm
ROTOR_INERTIA = np.array([1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5])

# Table 1 (spec. 4)
GEAR_RATIO = np.array([-105.0, 210.0, 60.0, -99.0, 79.2, -99.0])
K_V, K_D, K_S, T_0, T_E, T_A, T_B = 0.3, 0.03, 340.8, 9.95e-3, 0.56e-3, 40e-3, 20.2e-3
K_T, W_P, D_P, W_E = 0.03, 2014.0, 0.294, 1180.0
K_M = np.array([1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842])
W_I = np.array([4590.0, 5500.0, 5500.0, 6250.0, 6250.0, 7400.0])
D_I = np.array([0.6, 0.6, 0.6, 0.55, 0.55, 0.27])
DEAD_ZONE = np.array([0.094, 0.094, 0.094, 0.022, 0.096, 0.044])
TORQUE_LIMIT = np.full(6, 9.0)

# Table 2 (spec. 5): elastic gears of axes 1 to 3, friction of all axes as points (rotor rate,
# torque)
BACKLASH = np.array([0.01, 0.06, 0.0])
STIFFNESS = np.array([43.0, 8.0, 58.0])
DAMPING = np.array([0.005, 0.01, 0.04])
STICKING_LIMIT = np.array([0.4, 0.5, 0.7, 0.27, 0.5, 0.17])
FRICTION_POINTS = (
    ((0.0, 0.4), (160.0, 0.53)),
    ((0.0, 0.5), (130.0, 0.6), (360.0, 0.7)),
    ((0.0, 0.7), (130.0, 0.9), (360.0, 1.0)),
    ((0.0, 0.22), (300.0, 0.52)),
    ((0.0, 0.38), (100.0, 0.42), (300.0, 0.5)),
    ((0.0, 0.11), (360.0, 0.15)),
)

CREEP_RATE, CREEP_ARMED = 1e-9, 1e-8  # rad/s, spec. 8: axes 1 to 3
# N m, spec. 4: below it the start is exactly in the middle of dead zone and backlash.
ZERO_TORQUE = 1e-12
ELEMENT_ORDER = {"dead_zone": 0, "torque_limit": 1, "backlash": 2, "friction": 3}
# rotor_*: elastic gears (axes 1 to 3 of models 3 and 4) only
STATE_GROUPS = (
    "joint_angle", "joint_rate", "rotor_angle", "rotor_rate",
    "tachogenerator_1", "tachogenerator_2", "tachogenerator_3", "filter", "controller", "voltage",
    "pt2_torque", "pt2_torque_rate",
)  # fmt: skip
NOMINAL = dict.fromkeys(STATE_GROUPS, 1.0)
NOMINAL.update(rotor_rate=100.0, tachogenerator_3=2e3, pt2_torque_rate=5e3)


# --- motions --------------------------------------------------------------------------------------


class Motion:
    """A straight line in joint space, `start + (end - start) s(t)`, smooth between its knots.

    Attributes
    ----------
    knots : tuple of float
        Instants at which the motion is not smooth [s].
    """

    def __init__(self, start, end, knots):
        self.start, self.end = np.asarray(start, float), np.asarray(end, float)
        self.knots = tuple(float(t) for t in knots)

    def path(self, t, segment):
        """`s` and `s'` on one segment, whose formula is continued beyond its knots."""
        raise NotImplementedError

    def segment(self, t):
        """Number of knots up to and including `t`: motions are right-continuous."""
        return sum(t >= knot for knot in self.knots)

    def reference(self, t, segment):
        """Angles [rad] and rates [rad/s] at `t` on a given segment."""
        s, s_rate = self.path(t, segment)
        return self.start + (self.end - self.start) * s, (self.end - self.start) * s_rate

    def _sample(self, t, which):
        t = np.asarray(t, float)
        values = [self.reference(u, self.segment(u))[which] for u in t.ravel()]
        return np.reshape(values, t.shape + self.start.shape)

    def angle(self, t):
        """Joint angles [rad] at time(s) `t`."""
        return self._sample(t, 0)

    def rate(self, t):
        """Joint rates [rad/s] at time(s) `t`."""
        return self._sample(t, 1)


class Quintic(Motion):
    """Rest to rest, zero acceleration at both ends: `s = 10 z^3 - 15 z^4 + 6 z^5`."""

    def __init__(self, start, end, duration):
        super().__init__(start, end, (0.0, duration))
        self.duration = float(duration)

    def path(self, t, segment):
        if segment != 1:
            return (0.0, 0.0) if segment == 0 else (1.0, 0.0)
        z = t / self.duration
        return z**3 * (10.0 + z * (-15.0 + 6.0 * z)), 30.0 * z**2 * (1.0 - z) ** 2 / self.duration


class Trapezoid(Motion):
    """Synchronised trapezoid of rates; triangular if the top rate is not met.

    Parameters
    ----------
    start, end : array_like
        Joint angles [rad].
    rate, acceleration : array_like
        Largest joint rates [rad/s] and accelerations [rad/s^2]; the slowest axis leads.
    """

    def __init__(self, start, end, rate, acceleration):
        distance = np.abs(np.subtract(end, start, dtype=float))
        self.top_rate = 1.0 / np.max(distance / rate)  # of the path parameter
        self.top_acceleration = 1.0 / np.max(distance / acceleration)
        if self.top_rate**2 < self.top_acceleration:
            ramp = self.top_rate / self.top_acceleration
            knots = (0.0, ramp, 1.0 / self.top_rate, 1.0 / self.top_rate + ramp)
        else:
            ramp = np.sqrt(1.0 / self.top_acceleration)
            knots = (0.0, ramp, 2.0 * ramp)
        super().__init__(start, end, knots)

    def path(self, t, segment):
        a = self.top_acceleration
        if segment == 0:
            return 0.0, 0.0
        if segment == len(self.knots):
            return 1.0, 0.0
        if segment == 1:
            return a * t**2 / 2.0, a * t
        if segment == len(self.knots) - 1:
            left = self.knots[-1] - t
            return 1.0 - a * left**2 / 2.0, a * left
        return a * self.knots[1] ** 2 / 2.0 + self.top_rate * (t - self.knots[1]), self.top_rate


class Hold(Motion):
    """Stay at the given joint angles [rad]."""

    def __init__(self, angles):
        super().__init__(angles, angles, ())

    def path(self, t, segment):
        return 0.0, 0.0


# --- the arm --------------------------------------------------------------------------------------


def cross(a, b):
    """Cross products along the last axis (`numpy.cross` is slow for small arrays)."""
    return a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]


def rotation(axis, angle):
    """Rotation matrix about body-fixed x or z (spec. 2)."""
    c, s = np.cos(angle), np.sin(angle)
    if axis == "x":
        return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


class IndependentRobot:
    """The parameters of one of the models of spec. 7, and its multibody part.

    Parameters
    ----------
    model : {1, 2, 3, 4}
        DLR model.
    load_mass : float
        Point mass of the load [kg].
    load_position : array_like
        Its place in the frame of arm 6 [m]; in models 2 and 4 that frame is at (0, 0, 0.73) in arm
        3.

    Attributes
    ----------
    n_axes, n_elastic, n_states : int
        Moving axes; leading axes with an elastic gear, whose rotors have states of their own;
        continuous states.
    """

    def __init__(self, model, load_mass=0.0, load_position=(0.0, 0.0, 0.25)):
        self.model = model
        self.n_axes = n = 6 if model in (1, 3) else 3
        self.real_gears = model in (3, 4)
        self.n_elastic = 3 if self.real_gears else 0
        self.n_states = 10 * n + 2 * self.n_elastic

        arms = ARMS if n == 6 else (*ARMS[:2], LUMPED_ARM_3)
        load_at = np.asarray(load_position, float) + (0.0 if n == 6 else H5_ABOVE_JOINT_3)
        self.axis_name = [arm[0] for arm in arms]
        self.axis = np.array([UNIT[arm[0]] for arm in arms])
        self.offset = np.array([arm[1] for arm in arms])
        # bodies: the arms and, last, the load, which sits on the last arm
        self.carrier = np.array([*range(n), n - 1])
        self.mass = np.array([*(arm[2] for arm in arms), load_mass])
        self.centre = np.array([*(arm[3] for arm in arms), load_at])
        self.inertia = np.zeros((n + 1, 3, 3))
        for body, (i11, i22, i33, i13) in enumerate(arm[4] for arm in arms):
            self.inertia[body] = [[i11, 0.0, i13], [0.0, i22, 0.0], [i13, 0.0, i33]]
        # body b moves with joint i
        self.moves = (np.arange(n)[None, :] <= self.carrier[:, None]).astype(float)

        self.ratio = GEAR_RATIO[:n]
        self.rotor_inertia = ROTOR_INERTIA[:n]
        self.rotor_axis = np.array([UNIT[name] for name in ROTOR_AXIS[:n]])
        # rotors that are part of the multibody system with full coupling (spec. 6): all, or those
        # of rigid real gears
        self.coupled = np.arange(self.n_elastic, n)
        # the arm that carries rotor j moves with joint i
        self.rotor_moves = (np.arange(n)[None, :] < self.coupled[:, None]).astype(float)

        self.slices, at = {}, 0
        for name in STATE_GROUPS:
            size = self.n_elastic if name.startswith("rotor") else n
            self.slices[name] = slice(at, at + size)
            at += size

    # -- projected Newton-Euler equations in world coordinates

    def _poses(self, q):
        """World orientation of base and arms (n+1, 3, 3), joint origins and axes (n, 3)."""
        turn, origin = [np.eye(3)], [np.zeros(3)]
        for j in range(self.n_axes):
            origin.append(origin[-1] + turn[-1] @ self.offset[j])
            turn.append(turn[-1] @ rotation(self.axis_name[j], q[j]))
        turn = np.array(turn)
        return turn, np.array(origin[1:]), (turn[:-1] @ self.axis[:, :, None])[:, :, 0]

    def _arm_equations(self, q, qd):
        """`M`, `bias` of `M qdd + bias = tau` with the coupled rotors, without the other rotors.

        `M = sum J^T I J` and `bias = sum J^T (rate of change of momentum at qdd = 0, less gravity)`
        over the bodies.
        """
        turn, origin, axis = self._poses(q)
        n = self.n_axes

        # velocities and, at qdd = 0, accelerations of arms: index 0 is the base
        w, alpha = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        spin = axis * qd[:, None]
        w[1:] = np.cumsum(spin, axis=0)
        alpha[1:] = np.cumsum(cross(w[:-1], spin), axis=0)
        step = np.diff(origin, axis=0, prepend=np.zeros((1, 3)))
        lift = cross(alpha[:-1], step) + cross(w[:-1], cross(w[:-1], step))
        origin_acceleration = np.cumsum(lift, axis=0)

        # bodies
        body_turn = turn[1:][self.carrier]
        arm_of_centre = (body_turn @ self.centre[:, :, None])[:, :, 0]
        centre = origin[self.carrier] + arm_of_centre
        inertia = body_turn @ self.inertia @ body_turn.transpose(0, 2, 1)
        # Jacobians, transposed
        lever = centre[:, None, :] - origin[None, :, :]
        jv = cross(axis[None, :, :], lever) * self.moves[:, :, None]
        jw = axis[None, :, :] * self.moves[:, :, None]
        bw, balpha = w[1:][self.carrier], alpha[1:][self.carrier]
        acceleration = origin_acceleration[self.carrier] + cross(balpha, arm_of_centre)
        acceleration = acceleration + cross(bw, cross(bw, arm_of_centre))
        force = self.mass[:, None] * (acceleration + GRAVITY * UNIT["z"])
        momentum = (inertia @ bw[:, :, None])[:, :, 0]
        torque = (inertia @ balpha[:, :, None])[:, :, 0] + cross(bw, momentum)
        mass = (
            (jv * self.mass[:, None, None]) @ jv.transpose(0, 2, 1)
            + jw @ inertia @ jw.transpose(0, 2, 1)
        ).sum(0)
        bias = (jv @ force[:, :, None] + jw @ torque[:, :, None]).sum(0)[:, 0]

        # Rotors (spec. 6), carried by the preceding arm: spinning minus frozen, as the arms contain
        # them frozen. Only the inertia about the rotor's own axis matters: the part across it is
        # the same in both.
        if self.coupled.size:
            k = np.arange(self.coupled.size)
            along = (turn[self.coupled] @ self.rotor_axis[self.coupled][:, :, None])[:, :, 0]
            swing = cross(w[self.coupled], along)  # rate of change of the rotor's axis
            ratio, inertia = self.ratio[self.coupled], self.rotor_inertia[self.coupled]
            j_frozen = axis[None, :, :] * self.rotor_moves[:, :, None]
            j_spinning = j_frozen.copy()
            j_spinning[k, self.coupled] += ratio[:, None] * along
            for sign, jacobian in ((1.0, j_spinning), (-1.0, j_frozen)):
                axial = (jacobian @ along[:, :, None])[:, :, 0]
                mass = mass + sign * (axial * inertia[:, None]).T @ axial
                change = (
                    swing * (axial @ qd)[:, None]
                    + along * (along * alpha[self.coupled]).sum(1)[:, None]
                )
                bias = (
                    bias + sign * (jacobian @ (inertia[:, None] * change)[:, :, None]).sum(0)[:, 0]
                )
        return mass, bias

    def _free_rotors(self):
        """Joint-side inertia of the rotors that are not coupled (spec. 6 "simplified")."""
        inertia = self.ratio**2 * self.rotor_inertia
        inertia[self.coupled] = 0.0
        return np.diag(inertia)

    def potential_energy(self, q):
        """Energy of gravity [J], zero at the height of joint 2."""
        turn, origin, _ = self._poses(np.asarray(q, float))
        centre = origin[self.carrier] + np.squeeze(
            turn[1:][self.carrier] @ self.centre[:, :, None], axis=2
        )
        return GRAVITY * self.mass @ centre[:, 2]

    def kinetic_energy(self, q, qd, elastic_rotor_rate=()):
        """Kinetic energy of arms, load and rotors [J]; rotors of elastic gears turn alone."""
        mass = self._arm_equations(np.asarray(q, float), np.zeros(self.n_axes))[0]
        rotors = self.rotor_inertia[: self.n_elastic] @ np.square(elastic_rotor_rate)
        return (qd @ mass @ qd + rotors) / 2.0

    def mass_matrix(self, q):
        """Joint-space mass matrix (n_axes, n_axes) with ideal gears, rotors included [kg m^2]."""
        return (
            self._arm_equations(np.asarray(q, float), np.zeros(self.n_axes))[0]
            + self._free_rotors()
        )

    def bias(self, q, qd):
        """Joint torques [N m] at `qdd = 0`: centrifugal, Coriolis, gyroscopic and gravity terms."""
        return self._arm_equations(np.asarray(q, float), np.asarray(qd, float))[1]

    def forward_dynamics(self, q, qd, tau):
        """Joint accelerations [rad/s^2] under joint torques [N m], ideal gears, no friction."""
        mass, bias = self._arm_equations(np.asarray(q, float), np.asarray(qd, float))
        return np.linalg.solve(mass + self._free_rotors(), np.asarray(tau, float) - bias)

    # -- states

    def state_from(
        self,
        joint_angle,
        joint_rate=None,
        rotor_angle=None,
        rotor_rate=None,
        motor_torque=None,
        **others,
    ):
        """State vector; what is not given is zero, except rotors: `p` times the joint.

        `motor_torque` sets the state `pt2_torque` and nothing else; `others` names any of
        `STATE_GROUPS`.
        """
        x = np.zeros(self.n_states)
        rate = np.zeros(self.n_axes) if joint_rate is None else np.asarray(joint_rate, float)
        values = {
            "joint_angle": joint_angle,
            "joint_rate": rate,
            "pt2_torque": motor_torque,
            **others,
        }
        values["rotor_angle"] = self.ratio * joint_angle if rotor_angle is None else rotor_angle
        values["rotor_rate"] = self.ratio * rate if rotor_rate is None else rotor_rate
        for name, value in values.items():
            if value is not None:
                where = self.slices[name]
                x[where] = np.asarray(value, float)[: where.stop - where.start]
        return x

    def rest_state(self, motion):
        """Default start (spec. 4): rotors on the reference, no friction, motors hold the arms."""
        reference = motion.reference(0.0, motion.segment(0.0))[0][: self.n_axes]
        e, q, rest = self.n_elastic, reference.copy(), np.zeros(self.n_axes)
        for _ in range(200):
            torque = self._arm_equations(q, rest)[1] / self.ratio
            torque[np.abs(torque) < ZERO_TORQUE] = 0.0
            deflection = torque[:e] / STIFFNESS[:e] + BACKLASH[:e] * np.sign(torque[:e])
            sagged = reference.copy()
            sagged[:e] -= deflection / self.ratio[:e]
            if np.max(np.abs(sagged - q)) < 1e-16:
                break
            q = sagged
        if np.any(np.abs(torque) > TORQUE_LIMIT[: self.n_axes]):
            raise ValueError("the motors cannot hold the robot at the start of the motion")
        voltage = torque / K_M[: self.n_axes] + DEAD_ZONE[: self.n_axes] * np.sign(torque)
        return self.state_from(
            sagged,
            rotor_angle=self.ratio * reference,
            motor_torque=torque,
            controller=voltage,
            voltage=voltage,
        )


# --- the hybrid system ----------------------------------------------------------------------------


class Run:
    """What a simulation gives.

    Attributes
    ----------
    time : ndarray (n,)
        The requested instants [s]; signals are right-continuous.
    joint_angle, joint_rate, joint_acceleration : ndarray (n, n_axes)
        Joint side [rad, rad/s, rad/s^2].
    rotor_angle, rotor_rate, motor_torque, friction_torque : ndarray (n, n_axes)
        Motor side [rad, rad/s, N m, N m].
    voltage, control_error : ndarray (n, n_axes)
        Output of the rate controller [V]; desired minus actual joint angle [rad].
    state : ndarray (n, n_states)
        Groups and order of `STATE_GROUPS`.
    events : list of (time, axis, element, before, after)
        Axis 1 to 6 (0: whole robot); elements 'dead_zone', 'torque_limit', 'backlash', 'friction',
        'reference'.
    evaluations : int
        Number of evaluations of the equations.
    """


class Hybrid:
    """A robot that follows a motion, with branches that only events change (spec. 8)."""

    def __init__(self, robot, motion):
        self.robot, self.motion = robot, motion
        n, e = robot.n_axes, robot.n_elastic
        self.segment = motion.segment(0.0)
        self.dead_zone, self.torque_limit, self.friction = (np.zeros(n, int) for _ in range(3))
        self.backlash = np.zeros(n, int)
        self.piece = np.zeros(n, int)  # of the friction characteristic
        self.armed = np.zeros(n, bool)  # creep threshold
        self.n, self.e = n, e
        self.p, self.a, self.b = robot.ratio, DEAD_ZONE[:n], TORQUE_LIMIT[:n]
        self.k_m, self.w_i, self.d_i = K_M[:n], W_I[:n], D_I[:n]
        self.limit = STICKING_LIMIT[:n]
        self.evaluations = 0
        self._freeze()

    def _freeze(self):
        """Coefficients that follow from the branches."""
        n, e = self.n, self.e
        self.in_contact = np.where(BACKLASH[:e] > 0.0, self.backlash[:e] != 0, True).astype(float)
        self.sliding = self.friction != 0
        # friction on its present straight piece: rM = s (offset + slope |rq'|), |rq'| = s rq'
        # (spec. 5.1)
        self.offset, self.slope = np.zeros(n), np.zeros(n)
        self.lower, self.upper = np.full(n, -np.inf), np.full(n, np.inf)
        if self.robot.real_gears:
            for i in range(n):
                points, k = FRICTION_POINTS[i], self.piece[i]
                (w0, r0), (w1, r1) = points[k], points[k + 1]
                self.slope[i] = (r1 - r0) / (w1 - w0)
                self.offset[i] = r0 - self.slope[i] * w0
                if k > 0:
                    self.lower[i] = w0
                if k + 2 < len(points):
                    self.upper[i] = w1
        self.held = (
            np.flatnonzero(~self.sliding & (np.arange(n) >= e))
            if self.robot.real_gears
            else np.zeros(0, int)
        )
        self.free = np.setdiff1d(np.arange(n), self.held)

    def split(self, x):
        """Views of the state groups; `x` is (n_states,) or (points, n_states)."""
        return {name: x[..., where] for name, where in self.robot.slices.items()}

    def _rotor(self, z):
        """Angles and rates of all rotors: states of their own, or rigid gears (spec. 2)."""
        angle, rate = self.p * z["joint_angle"], self.p * z["joint_rate"]
        angle[..., : self.e], rate[..., : self.e] = z["rotor_angle"], z["rotor_rate"]
        return angle, rate

    def _motor_torque(self, z):
        """`rF`: NL2 on its present branch (spec. 4)."""
        return np.where(self.torque_limit == 0, z["pt2_torque"], self.torque_limit * self.b)

    def _deflection(self, z):
        p, e = self.p[: self.e], self.e
        return z["rotor_angle"] - p * z["joint_angle"][..., :e], z["rotor_rate"] - p * z[
            "joint_rate"
        ][..., :e]

    def _gear_torque(self, z):
        """`tau` of elastic gears (spec. 5.2), damper parallel to the spring with its backlash."""
        deflection, rate = self._deflection(z)
        e = self.e
        return (
            STIFFNESS[:e] * self.in_contact * (deflection - self.backlash[:e] * BACKLASH[:e])
            + DAMPING[:e] * rate
        )

    def mechanics(self, z, arm=None):
        """Accelerations of joints and elastic rotors, `rF` and `rM` with the present branches.

        Sticking joints (spec. 5.3): the remaining accelerations are solved for with theirs zero,
        and `rM_i = rF_i - aL_i / p_i` with `aL_i = sum_j M_ij aq''_j - h_i`.
        """
        e, p = self.e, self.p
        rotor_rate = self._rotor(z)[1]
        motor = self._motor_torque(z)
        # s (o + k s w)
        friction = self.friction * self.offset + self.slope * rotor_rate * self.sliding
        joint_torque = p * (motor - friction)
        rotor_acceleration = np.zeros(e)
        if e:
            gear = self._gear_torque(z)
            drive = motor[:e] - gear
            friction[:e] = np.where(self.sliding[:e], friction[:e], drive)
            rotor_acceleration = np.where(
                self.sliding[:e], (drive - friction[:e]) / self.robot.rotor_inertia[:e], 0.0
            )
            joint_torque[:e] = p[:e] * gear
        mass, bias = (
            self.robot._arm_equations(z["joint_angle"], z["joint_rate"]) if arm is None else arm
        )
        acceleration = np.zeros(self.n)
        if self.held.size:
            f, s = self.free, self.held
            acceleration[f] = np.linalg.solve(mass[np.ix_(f, f)], (joint_torque - bias)[f])
            friction[s] = motor[s] - (mass[s] @ acceleration + bias[s]) / p[s]
        else:
            acceleration = np.linalg.solve(mass, joint_torque - bias)
        return acceleration, rotor_acceleration, motor, friction

    def derivatives(self, t, x):
        """Right-hand side, smooth while the branches and the segment of the motion are frozen."""
        self.evaluations += 1
        z, out = self.split(x), np.empty_like(x)
        d = self.split(out)
        acceleration, rotor_acceleration, _, _ = self.mechanics(z)
        angle, rate = self._rotor(z)
        d["joint_angle"][:], d["joint_rate"][:] = z["joint_rate"], acceleration
        d["rotor_angle"][:], d["rotor_rate"][:] = z["rotor_rate"], rotor_acceleration
        # spec. 4: position controller with feedforward
        desired, desired_rate = self.motion.reference(t, self.segment)
        command = K_V * (self.p * desired[: self.n] - angle) + K_D * self.p * desired_rate[: self.n]
        # tachogenerator: PT1 (output x1), then PT2 (output u_t = x2, x3 = x2')
        x1, u_t, x3 = z["tachogenerator_1"], z["tachogenerator_2"], z["tachogenerator_3"]
        d["tachogenerator_1"][:] = W_E * (K_T * rate - x1)
        d["tachogenerator_2"][:] = x3
        d["tachogenerator_3"][:] = W_P**2 * (x1 - u_t) - 2.0 * D_P * W_P * x3
        # feedback filter (s T_a + 1)/(s T_b + 1) = T_a/T_b + (1 - T_a/T_b)/(s T_b + 1)
        d["filter"][:] = (u_t - z["filter"]) / T_B
        feedback = T_A / T_B * u_t + (1.0 - T_A / T_B) * z["filter"]
        # rate controller: controller = K_S e / s;  U = (controller + K_S T_0 e) / (s T_e + 1)
        error = command - feedback
        d["controller"][:] = K_S * error
        d["voltage"][:] = (z["controller"] + K_S * T_0 * error - z["voltage"]) / T_E
        # NL1, motor
        v = np.where(self.dead_zone == 0, 0.0, z["voltage"] - self.dead_zone * self.a)
        m, m_rate = z["pt2_torque"], z["pt2_torque_rate"]
        d["pt2_torque"][:] = m_rate
        d["pt2_torque_rate"][:] = (
            self.w_i**2 * (self.k_m * v - m) - 2.0 * self.d_i * self.w_i * m_rate
        )
        return out

    # -- indicators (spec. 7, 8): positive inside the domain of the present branch

    def watch(self, points):
        """Indicators at consecutive states (k, n_states), the first the beginning of a step.

        Returns
        -------
        values : ndarray (k, m)
            Positive inside the domain; the constant 1 where an indicator means nothing in the
            present branch.
        labels : list of (element, axis index, next branch)
            What happens when the column leaves its domain; 'creep', 'rate', 'limit' and 'kink'
            belong to friction.
        armed : ndarray (n_axes,)
            Creep thresholds armed at the end of the points.
        """
        z = self.split(points)
        columns, labels = [], []

        def edges(element, branch, value, half):
            for i, s in enumerate(branch):
                if s == 0:
                    columns.extend((half[i] - value[:, i], half[i] + value[:, i]))
                    labels.extend(((element, i, 1), (element, i, -1)))
                else:
                    columns.append(s * value[:, i] - half[i])
                    labels.append((element, i, 0))

        edges("dead_zone", self.dead_zone, z["voltage"], self.a)
        edges("torque_limit", self.torque_limit, z["pt2_torque"], self.b)
        armed = self.armed.copy()
        if self.robot.real_gears:
            gaps = BACKLASH > 0.0
            deflection = self._deflection(z)[0]
            backlash, labels_so_far = self.backlash[: self.e], len(labels)
            edges("backlash", backlash[gaps], deflection[:, gaps], BACKLASH[gaps])
            for k in range(labels_so_far, len(labels)):
                labels[k] = ("backlash", int(np.flatnonzero(gaps)[labels[k][1]]), labels[k][2])
            _, rate = self._rotor(z)
            constraint = np.zeros((len(points), self.n))
            constraint[:, : self.e] = self._motor_torque(z)[:, : self.e] - self._gear_torque(z)
            if self.held.size:
                for k, x in enumerate(points):
                    constraint[k, self.e :] = self.mechanics(self.split(x))[3][self.e :]
            for i, s in enumerate(self.friction):
                if s == 0:
                    columns.append(self.limit[i] - np.abs(constraint[:, i]))
                    labels.append(("limit", i, None))
                    continue
                speed = s * rate[:, i]
                columns.append(speed)
                labels.append(("rate", i, None))
                if np.isfinite(self.upper[i]):
                    columns.append(self.upper[i] - speed)
                    labels.append(("kink", i, self.piece[i] + 1))
                if np.isfinite(self.lower[i]):
                    columns.append(speed - self.lower[i])
                    labels.append(("kink", i, self.piece[i] - 1))
                if i < self.e:
                    ready = np.logical_or.accumulate(speed > CREEP_ARMED) | armed[i]
                    columns.append(np.where(ready, speed - CREEP_RATE, 1.0))
                    labels.append(("creep", i, None))
                    armed[i] = ready[-1]
        return np.array(columns).T, labels, armed

    # -- decisions

    def start(self, x):
        """Decide branches by physics; a value exactly on an edge goes where its rate points."""

        def side(value, rate, half):
            outside = (np.abs(value) > half) | (
                (np.abs(value) == half) & (np.sign(value) * rate > 0.0)
            )
            return np.where(outside, np.sign(value), 0.0).astype(int)

        d, z = self.split(self.derivatives(0.0, x)), self.split(x)
        self.dead_zone = side(z["voltage"], d["voltage"], self.a)
        self.torque_limit = side(z["pt2_torque"], z["pt2_torque_rate"], self.b)
        if self.robot.real_gears:
            e = self.e
            self.backlash[:e] = np.where(
                BACKLASH[:e] > 0.0, side(*self._deflection(z), BACKLASH[:e]), 0
            )
            rate = self._rotor(z)[1]
            self.friction = np.sign(rate).astype(int)
            for i, w in enumerate(rate):
                self.piece[i] = sum(abs(w) >= point[0] for point in FRICTION_POINTS[i][1:-1])
            self.armed = np.abs(rate) > CREEP_ARMED
            self._freeze()
            self._decide_elastic(x, np.flatnonzero(rate[:e] == 0.0), ())
            self._decide_rigid(x, (), np.zeros(self.n, bool))
        self._freeze()

    def _decide_elastic(self, x, at_zero, released):
        """Axes 1 to 3 at zero rotor rate (spec. 5.2): stick within the limit, unless released."""
        z = self.split(x)
        drive = self._motor_torque(z)[: self.e] - self._gear_torque(z)
        for i in (*at_zero, *released):
            sticks = abs(drive[i]) <= self.limit[i] and i not in released
            self.friction[i] = 0 if sticks else int(np.sign(drive[i]))
            self.piece[i], self.armed[i] = 0, False

    def _decide_rigid(self, x, released, stuck):
        """Axes 4 to 6 at zero rate: the rule of spec. 5.3 among all consistent combinations."""
        z = self.split(x)
        zero = [i for i in range(self.e, self.n) if z["joint_rate"][i] == 0.0]
        if not zero:
            return
        arm = self.robot._arm_equations(z["joint_angle"], z["joint_rate"])
        self.piece[zero] = 0
        best = None
        for combination in product((0, -1, 1), repeat=len(zero)):  # the order of the last tie-break
            if any(s == 0 and i in released for i, s in zip(zero, combination, strict=True)):
                continue
            self.friction[zero] = combination
            self._freeze()
            acceleration, _, _, friction = self.mechanics(z, arm)
            rotor_acceleration = self.p * acceleration
            consistent = all(
                abs(friction[i]) <= self.limit[i] if s == 0 else s * rotor_acceleration[i] > 0.0
                for i, s in zip(zero, combination, strict=True)
            )
            if consistent:
                kept = sum(s == 0 and stuck[i] for i, s in zip(zero, combination, strict=True))
                rank = (combination.count(0), kept)
                if best is None or rank > best[0]:
                    best = (rank, combination)
        if best is None:
            raise RuntimeError("no consistent combination of sticking and sliding axes")
        self.friction[zero] = best[1]
        self._freeze()

    def handle(self, t, x, fired, log):
        """Switch the branches for the labels that fired at `t`; an axis may come to rest in `x`."""
        names = ("dead_zone", "torque_limit", "backlash", "friction")
        before = {name: getattr(self, name).copy() for name in names}
        z = self.split(x)
        rest, released = [], []
        for element, i, branch in fired:
            if element in ELEMENT_ORDER:
                getattr(self, element)[i] = branch
            elif element == "kink":
                self.piece[i] = branch
            elif element == "rate":
                rest.append(i)
            elif element == "limit":
                released.append(i)
            else:  # creep (spec. 8): sticks if it can, else it slides on to its zero
                self.armed[i] = False
                drive = self._motor_torque(z)[i] - self._gear_torque(z)[i]
                if abs(drive) <= self.limit[i] and i not in rest:
                    rest.append(i)
        self._freeze()
        if rest or released:
            e = self.e
            for i in rest:
                z["rotor_rate" if i < e else "joint_rate"][i] = 0.0
            self._decide_elastic(x, [i for i in rest if i < e], [i for i in released if i < e])
            if max(rest + released) >= e:
                self._decide_rigid(x, released, before["friction"] == 0)
            self._freeze()
        for i in range(self.n):
            for name in names:
                old, new = int(before[name][i]), int(getattr(self, name)[i])
                if old != new:
                    log.append((float(t), i + 1, name, old, new))

    def signals(self, t, x):
        """All recorded signals at one instant."""
        z = self.split(x)
        acceleration, _, motor, friction = self.mechanics(z)
        angle, rate = self._rotor(z)
        return {
            "joint_angle": z["joint_angle"],
            "joint_rate": z["joint_rate"],
            "joint_acceleration": acceleration,
            "rotor_angle": angle,
            "rotor_rate": rate,
            "motor_torque": motor,
            "friction_torque": friction,
            "voltage": z["voltage"],
            "state": x,
            "control_error": self.motion.reference(t, self.segment)[0][: self.n] - z["joint_angle"],
        }


# --- simulation -----------------------------------------------------------------------------------


def simulate(
    robot, motion, t_end, rtol=1e-10, times=None, start=None, max_step=2e-4, inner_points=5
):
    """Simulate a robot that follows a motion.

    Parameters
    ----------
    robot : IndependentRobot
    motion : Motion
        Six axes, or three for models 2 and 4.
    t_end : float
        End [s]; the start is at 0.
    rtol : float
        Tolerance of the integration relative to each state's nominal value.
    times : array_like, optional
        Instants to record, ascending in [0, t_end]; default 201 equal steps' ends.
    start : ndarray, optional
        State vector (`IndependentRobot.state_from`); default the start at rest.
    max_step : float
        Longest step of the integrator [s].
    inner_points : int
        Number of equidistant points in each step, its end among them, at which the indicators are
        watched.

    Returns
    -------
    Run
    """
    system = Hybrid(robot, motion)
    x = robot.rest_state(motion) if start is None else np.array(start, float)
    system.start(x)
    nominal = np.concatenate(
        [np.full(w.stop - w.start, NOMINAL[name]) for name, w in robot.slices.items()]
    )
    options = {"rtol": 3e-14, "atol": rtol * nominal, "max_step": max_step}

    def advance(t0, x0, t1):
        """State at `t1`, integrated afresh from the beginning of a step: no interpolant."""
        if t1 <= t0:
            return x0.copy()
        solver = DOP853(system.derivatives, t0, x0, t1, first_step=t1 - t0, **options)
        while solver.status == "running":
            solver.step()
        return solver.y

    times = np.linspace(0.0, t_end, 201) if times is None else np.asarray(times, float)
    recorded, pending = [], list(times)

    def record(t0, x0, t1, including_end=False):
        """Requested instants in [t0, t1): at an event the branches after it count."""
        while pending and (pending[0] < t1 or (including_end and pending[0] <= t1)):
            t = pending.pop(0)
            recorded.append(system.signals(t, advance(t0, x0, t)))

    events, recent = [], []
    knots = [k for k in motion.knots if 0.0 < k < t_end]
    t = 0.0
    while t < t_end:
        stop = knots[0] if knots else t_end
        solver = DOP853(system.derivatives, t, x, stop, **options)
        fired = None
        while fired is None and solver.status == "running":
            t0, x0 = t, x
            solver.step()
            if solver.status == "failed":
                raise RuntimeError(f"integration failed at t = {t0}")
            t, x = solver.t, solver.y.copy()
            found = _first_events(
                system, t0, x0, t, x, solver.dense_output(), advance, inner_points
            )
            if found is None:
                record(t0, x0, t)
            else:
                t, fired = found
                record(t0, x0, t)
                x = advance(t0, x0, t)
        log = []
        if knots and abs(t - knots[0]) <= 4.0 * np.spacing(t):
            t = knots.pop(0)
            log.append((t, 0, "reference", 0, 0))
            system.segment = motion.segment(t)
        if fired:
            system.handle(t, x, fired, log)
        if t < t_end:
            events.extend(log)
        # chattering (spec. 8)
        recent = [u for u in recent if u > t - 1e-3] + [t]
        if len(recent) > 1000:
            raise RuntimeError(f"chattering at t = {t}: {fired}")
    record(t, x, t_end, including_end=True)

    run = Run()
    run.time, run.events, run.evaluations = times, events, system.evaluations
    for name in recorded[0] if recorded else ():
        setattr(run, name, np.array([row[name] for row in recorded]))
    return run


def _first_events(system, t0, x0, t1, x1, dense, advance, inner_points):
    """First instant in (t0, t1] at which indicators leave their domains, and their labels.

    Returns None if there is none. The instant is a root along a fresh integration from `t0`.
    """
    grid = t0 + (t1 - t0) * np.arange(1, inner_points + 1) / inner_points
    points = np.vstack((x0, dense(grid[:-1]).T, x1))
    values, labels, armed = system.watch(points)
    grid = np.concatenate(([t0], grid))
    candidates = []
    for column in np.flatnonzero((values[1:] <= 0.0).any(axis=0)):
        k = 1 + int(np.argmax(values[1:, column] <= 0.0))
        candidates.append((k, column))
    if not candidates:
        system.armed = armed
        return None

    first = min(k for k, _ in candidates)
    roots = []
    for k, column in candidates:
        if k > first:
            continue

        label = labels[column]

        def value(t, x=None, k=k, column=column):
            x = advance(t0, x0, t) if x is None else x
            return system.watch(np.vstack((points[:k], x)))[0][-1, column]

        low, high = grid[k - 1], grid[k]
        if values[k - 1, column] <= 0.0:
            # just switched here, and out again within one piece of the step: look for the short
            # stay inside
            nearer = low + (high - low) * 2.0 ** -np.arange(1.0, 40.0)
            inside = [u for u in nearer if value(u, dense(u)) > 0.0]
            if not inside:
                roots.append((t0, label))
                continue
            low = max(inside)
        if value(low) <= 0.0:
            roots.append((low, label))
        elif value(high) > 0.0:
            roots.append((high, label))  # interpolant and integration disagree by round-off
        else:
            roots.append((brentq(value, low, high, xtol=1e-18, rtol=8.9e-16), label))
    t = min(root for root, _ in roots)
    system.armed = system.watch(np.vstack((points[:first], advance(t0, x0, t))))[2]
    return t, [label for root, label in roots if root - t <= 4.0 * np.spacing(t)]
