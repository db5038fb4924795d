"""Independent reference implementation of the Manutec r3 models 1 to 4: a test oracle.

Written from the equations of Franke and Otter 1993 (*The Manutec r3 Benchmark Models for the
Dynamic Simulation of Robots*) as restated in the project specification ("spec. N" cites its section
N), with other methods than the fast core:

* rigid bodies by explicit geometric Jacobians and the projected Newton-Euler equations in world
  coordinates;
* rotors as bodies that spin in the arm which carries them, minus the same rotors frozen;
* stiction by trying all combinations of sticking and sliding;
* integration by `scipy.integrate.DOP853` with short steps, indicators watched inside each step, and
  every event located by integrating afresh to the root.

It is slow (about half a minute for a second of model 3) and knows all options of the robot but the
stiff approximations of sticking.

    motion = Quintic([0] * 6, [1.0, 1.0, 0.6, -0.2, -0.15, -0.1], 1.2)
    run = simulate(IndependentRobot(3, load_mass=15.0), motion, 1.5)
    run.control_error, run.events
"""

from itertools import product
from types import SimpleNamespace

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

# Controller and motor (spec. 4)
TABLE_1 = {
    "T": 0.008,
    "p": np.array([-105.0, 210.0, 60.0, -99.0, 79.2, -99.0]),
    "K_V": np.full(6, 0.3),
    "K_D": np.full(6, 0.03),
    "K_S": np.full(6, 340.8),
    "T_0": np.full(6, 9.95e-3),
    "T_e": np.full(6, 0.56e-3),
    "T_a": np.full(6, 40e-3),
    "T_b": np.full(6, 20.2e-3),
    "K_T": np.full(6, 0.03),
    "w_p": np.full(6, 2014.0),
    "D_p": np.full(6, 0.294),
    "w_e": np.full(6, 1180.0),
    "K_M": np.array([1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842]),
    "w_i": np.array([4590.0, 5500.0, 5500.0, 6250.0, 6250.0, 7400.0]),
    "D_i": np.array([0.6, 0.6, 0.6, 0.55, 0.55, 0.27]),
    "a": np.array([0.094, 0.094, 0.094, 0.022, 0.096, 0.044]),
    "b": np.full(6, 9.0),
}

# Rotor and gear (spec. 5): elastic gears of axes 1 to 3, friction of all axes as points (rotor
# rate, torque)
TABLE_2 = {
    "b": np.array([0.01, 0.06, 0.0]),
    "c": np.array([43.0, 8.0, 58.0]),
    "d": np.array([0.005, 0.01, 0.04]),
    "rM_h": np.array([0.4, 0.5, 0.7, 0.27, 0.5, 0.17]),
    "friction": (
        ((0.0, 0.4), (160.0, 0.53)),
        ((0.0, 0.5), (130.0, 0.6), (360.0, 0.7)),
        ((0.0, 0.7), (130.0, 0.9), (360.0, 1.0)),
        ((0.0, 0.22), (300.0, 0.52)),
        ((0.0, 0.38), (100.0, 0.42), (300.0, 0.5)),
        ((0.0, 0.11), (360.0, 0.15)),
    ),
}


# Multibody data (spec. 3). Arm 1 is known by its I33 only, arm 6 has neither mass nor inertia of
# its own (only the rotor and the load count there). The lumped arm 3 is that of models 2 and 4 with
# joints 4 to 6 blocked. Rotor axes are given in the preceding arm.
ARM_COLUMNS = ("axis", "offset", "mass", "centre_of_mass", "I11", "I22", "I33", "I13")
ARMS = (
    ("z", (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0), 0.0, 0.0, 1.16, 0.0),
    ("x", (0.0, 0.0, 0.0), 56.5, (0.172, 0.0, 0.205), 2.58, 2.73, 0.64, -0.46),
    ("x", (0.0, 0.0, 0.5), 26.4, (0.064, 0.0, -0.034), 0.279, 0.413, 0.245, -0.070),
    ("z", (0.0, 0.0, 0.0), 28.7, (0.0, 0.0, 0.32), 1.67, 1.67, 0.081, 0.0),
    ("x", (0.0, 0.0, 0.73), 5.2, (0.0, 0.0, 0.023), 0.0125, 0.0153, 0.0081, 0.0),
    ("z", (0.0, 0.0, 0.0), 0.0, (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0),
)
LUMPED_ARM_3 = ("x", (0.0, 0.0, 0.5), 60.3, (0.028, 0.0, 0.202), 5.41, 5.60, 0.39, 0.33)
TABLE_3 = {
    "arms": [dict(zip(ARM_COLUMNS, row, strict=True)) for row in ARMS],
    "lumped_arm_3": dict(zip(ARM_COLUMNS, LUMPED_ARM_3, strict=True)),
    "rJ": np.array([1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5]),
    "rn": ("z", "x", "x", "z", "x", "z"),
    "gravity": 9.81,  # along -z of the world (spec. 2)
}

# Names of some columns, for tests.
GEAR_RATIO, K_M, DEAD_ZONE, TORQUE_LIMIT = (TABLE_1[name] for name in ("p", "K_M", "a", "b"))
BACKLASH, STIFFNESS, DAMPING = (TABLE_2[name] for name in ("b", "c", "d"))
STICKING_LIMIT, FRICTION_POINTS = TABLE_2["rM_h"], TABLE_2["friction"]

UNIT = {"x": np.array([1.0, 0.0, 0.0]), "z": np.array([0.0, 0.0, 1.0])}
# N m, spec. 4: below it the start is exactly in the middle of dead zone and backlash.
ZERO_TORQUE = 1e-12
# In the order in which the events of an axis at one instant are told.
ELEMENTS = ("dead_zone", "torque_limit", "voltage_limit", "backlash", "friction")
# rotor_*: elastic gears (axes 1 to 3 of models 3 and 4) only
MECHANICAL_STATES = ("joint_angle", "joint_rate", "rotor_angle", "rotor_rate")
ELECTRICAL_STATES = (
    "tachogenerator_1", "tachogenerator_2", "tachogenerator_3", "filter", "controller", "voltage",
    "pt2_torque", "pt2_torque_rate",
)  # fmt: skip
STATE_GROUPS = MECHANICAL_STATES + ELECTRICAL_STATES
NOMINAL = dict.fromkeys(STATE_GROUPS, 1.0)
NOMINAL.update(rotor_rate=100.0, tachogenerator_3=2e3, pt2_torque_rate=5e3)


def replaced(old, new):
    """`old` with `new` in its place; a mapping replaces some entries, by name or by axis (1...)."""
    if isinstance(new, dict):
        if isinstance(old, dict):
            return {**old, **{name: replaced(old[name], value) for name, value in new.items()}}
        entries = list(old)
        for axis, value in new.items():
            entries[axis - 1] = replaced(entries[axis - 1], value)
        new = entries
    if isinstance(old, np.ndarray):
        return np.broadcast_to(np.asarray(new, float), old.shape)
    return new


def one_instant(t, other):
    """Whether two times are one instant: closer than four units in the last place (spec. 8)."""
    return abs(t - other) <= 4.0 * np.spacing(max(abs(t), abs(other)))


# --- motions and inputs ---------------------------------------------------------------------------


class Source:
    """Something that depends on time, smooth between its knots, right-continuous at them.

    Attributes
    ----------
    knots : tuple of float
        Instants at which it is not smooth [s].
    """

    def __init__(self, knots=()):
        self.knots = tuple(float(t) for t in knots)

    def segment(self, t):
        """Number of knots up to and including `t`."""
        return sum(t >= knot for knot in self.knots)


class Smooth(Source):
    """An input that is a smooth function of time [s]."""

    def __init__(self, function):
        super().__init__()
        self.function = function

    def value(self, t, segment):
        """Value at `t`."""
        return np.asarray(self.function(t), float)


class Steps(Source):
    """An input that is constant between its knots: one value more than knots."""

    def __init__(self, knots, values):
        super().__init__(knots)
        self.values = np.asarray(values, float)

    def value(self, t, segment):
        """Value on a given segment."""
        return self.values[segment]


def as_input(given, size):
    """An input from a constant, a function of time, `Steps`; zeros if nothing is given."""
    if isinstance(given, Source):
        return given
    if callable(given):
        return Smooth(given)
    return Steps((), [np.zeros(size) if given is None else given])


class Motion(Source):
    """A straight line in joint space, `start + (end - start) s(t)`, smooth between its knots."""

    def __init__(self, start, end, knots):
        super().__init__(knots)
        self.start, self.end = np.asarray(start, float), np.asarray(end, float)

    def path(self, t, segment):
        """`s` and `s'` on one segment, whose formula is continued beyond its knots."""
        raise NotImplementedError

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


NEXT = np.array([1, 2, 0])  # of x, y, z


def cross(a, b):
    """Cross products along the last axis (`numpy.cross` is slow for small arrays)."""
    return (a * b.take(NEXT, -1) - a.take(NEXT, -1) * b).take(NEXT, -1)


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
        Its place in the frame of arm 6 [m], also where a force on the tip acts.
    controller, rotor_coupling, gear_damping, arm, creep_rate, voltage_limit
        Options as of `manutec_r3.Robot`.
    table_1, table_2, table_3 : dict, optional
        Entries that replace those of `TABLE_1`, `TABLE_2`, `TABLE_3`.

    Attributes
    ----------
    n_axes, n_elastic, n_states : int
        Moving axes; leading axes with an elastic gear, whose rotors have states of their own;
        continuous states.
    ratio : ndarray (n_axes,)
        Gear ratios.
    """

    def __init__(
        self,
        model,
        load_mass=0.0,
        load_position=(0.0, 0.0, 0.25),
        *,
        controller="continuous",
        rotor_coupling=None,
        gear_damping="parallel",
        arm=None,
        creep_rate=1e-9,
        voltage_limit=None,
        table_1=None,
        table_2=None,
        table_3=None,
    ):
        self.model, self.controller, self.gear_damping = model, controller, gear_damping
        self.creep_rate, self.voltage_limit = creep_rate, voltage_limit
        self.n_axes = n = 6 if model in (1, 3) else 3
        self.real_gears = model in (3, 4)
        self.n_elastic = e = 3 if self.real_gears else 0
        self._take_drives(replaced(TABLE_1, table_1 or {}), replaced(TABLE_2, table_2 or {}))
        if arm is None:
            arm = "six-arm" if n == 6 else "lumped"
        table_3 = replaced(TABLE_3, table_3 or {})
        self._take_bodies(table_3, arm, load_mass, np.asarray(load_position, float))
        if rotor_coupling is None:
            rotor_coupling = ["simplified"] * e + ["full"] * (n - e)
        self._take_rotors(table_3, np.broadcast_to(rotor_coupling, n))

        self.slices, at = {}, 0
        for name in STATE_GROUPS:
            size = self.n_elastic if name.startswith("rotor") else n
            if name in ELECTRICAL_STATES and controller is None:
                size = 0
            self.slices[name] = slice(at, at + size)
            at += size
        self.n_states = at

    def _take_drives(self, table_1, table_2):
        """Controllers, motors and gears."""
        n, e = self.n_axes, self.n_elastic
        self.sampling_time = table_1["T"]
        self.electrical = SimpleNamespace(
            **{name: value[:n] for name, value in table_1.items() if name != "T"}
        )
        self.ratio = self.electrical.p
        self.dead_zone, self.torque_limit = self.electrical.a, self.electrical.b
        self.backlash, self.stiffness, self.damping = (table_2[name][:e] for name in "bcd")
        self.sticking_limit, self.friction_points = table_2["rM_h"][:n], table_2["friction"][:n]

    def _take_bodies(self, table, arm, load_mass, load_position):
        """Joints; bodies: the arms, those behind blocked joints fixed to the last moving arm, load.

        Blocked joints stand at zero (spec. 7): the frames behind them are shifted only.
        """
        n = self.n_axes
        self.gravity = table["gravity"]
        joints, arms = table["arms"][:n], table["arms"]
        if arm == "lumped":
            joints = arms = [*arms[:2], table["lumped_arm_3"]]
        self.axis_name = [joint["axis"] for joint in joints]
        self.axis = np.array([UNIT[name] for name in self.axis_name])
        self.offset = np.array([joint["offset"] for joint in joints])
        behind = [np.zeros(3)] * n  # of the frames of all arms in the last moving arm
        for blocked in table["arms"][n:]:
            behind.append(behind[-1] + blocked["offset"])
        self.carrier = np.minimum(np.arange(len(arms) + 1), n - 1)
        self.mass = np.array([*(body["mass"] for body in arms), load_mass])
        self.centre = np.array(
            [
                *(
                    shift + body["centre_of_mass"]
                    for shift, body in zip(behind, arms, strict=False)
                ),
                behind[-1] + load_position,
            ]
        )
        self.inertia = np.zeros((len(arms) + 1, 3, 3))
        for k, body in enumerate(arms):
            i11, i22, i33, i13 = (body[name] for name in ("I11", "I22", "I33", "I13"))
            self.inertia[k] = [[i11, 0.0, i13], [0.0, i22, 0.0], [i13, 0.0, i33]]
        # body b moves with joint i
        self.moves = (np.arange(n)[None, :] <= self.carrier[:, None]).astype(float)

    def _take_rotors(self, table, coupling):
        """Rotors (spec. 6): which arm carries them, and which coordinate turns them."""
        n, e = self.n_axes, self.n_elastic
        axes = np.arange(n)
        self.rotor_inertia = table["rJ"][:n]
        self.rotor_axis = np.array([UNIT[name] for name in table["rn"][:n]])
        # "full": the preceding arm carries rotor j; "simplified": the base does (0)
        self.rotor_carrier = np.where(np.asarray(coupling) == "full", axes, 0)
        # the arm that carries rotor j moves with joint i
        self.rotor_moves = (axes[None, :] < self.rotor_carrier[:, None]).astype(float)
        # Rates of joints (n) and elastic rotors (e): rotor j turns by `lever[j]` times coordinate
        # `turns[j]`.
        self.turns = np.where(axes < e, n + axes, axes)
        self.lever = np.where(axes < e, 1.0, self.ratio)
        self.spin = np.zeros((n, n + e))
        self.spin[axes, self.turns] = self.lever
        # what the rates of joints are to all rates with ideal gears: rq' = p aq'
        self.ideal = np.vstack((np.eye(n), np.diag(self.ratio)[:e]))

    # -- projected Newton-Euler equations in world coordinates

    def _poses(self, q):
        """World orientation of base and arms (n+1, 3, 3), joint origins and axes (n, 3)."""
        turn, origin = [np.eye(3)], [np.zeros(3)]
        for j in range(self.n_axes):
            origin.append(origin[-1] + turn[-1] @ self.offset[j])
            turn.append(turn[-1] @ rotation(self.axis_name[j], q[j]))
        turn = np.array(turn)
        return turn, np.array(origin[1:]), (turn[:-1] @ self.axis[:, :, None])[:, :, 0]

    def _equations(self, q, qd, rotor_rate):
        """`M`, `bias` of `M v' + bias = f` for the rates `v` of joints (n) and elastic rotors (e).

        `M = sum J^T I J` and `bias = sum J^T (rate of change of momentum at v' = 0, less gravity)`
        over bodies and rotors.
        """
        turn, origin, axis = self._poses(q)
        n, size = self.n_axes, self.n_axes + self.n_elastic
        rates = np.concatenate((qd, rotor_rate))

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
        force = self.mass[:, None] * (acceleration + self.gravity * UNIT["z"])
        momentum = (inertia @ bw[:, :, None])[:, :, 0]
        torque = (inertia @ balpha[:, :, None])[:, :, 0] + cross(bw, momentum)
        mass, bias = np.zeros((size, size)), np.zeros(size)
        mass[:n, :n] = (
            (jv * self.mass[:, None, None]) @ jv.transpose(0, 2, 1)
            + jw @ inertia @ jw.transpose(0, 2, 1)
        ).sum(0)
        bias[:n] = (jv @ force[:, :, None] + jw @ torque[:, :, None]).sum(0)[:, 0]

        # Rotors (spec. 6): spinning minus frozen, as the arms contain them frozen. Only the inertia
        # about the rotor's own axis matters: the part across it is the same in both. Momentum
        # `rJ along <along, w>` changes by `rJ (swing <along, w> + along <along, alpha>)`.
        carrier = self.rotor_carrier
        along = (turn[carrier] @ self.rotor_axis[:, :, None])[:, :, 0]
        swing = cross(w[carrier], along)  # rate of change of the rotor's axis
        turning = (along * alpha[carrier]).sum(1)
        carried, tilted = np.zeros((n, size)), np.zeros((n, size))  # J along, J swing
        carried[:, :n] = self.rotor_moves * (along @ axis.T)
        tilted[:, :n] = self.rotor_moves * (swing @ axis.T)
        for sign, axial in ((1.0, carried + self.spin), (-1.0, carried)):
            inertia = sign * self.rotor_inertia
            mass += (axial.T * inertia) @ axial
            bias += (inertia * (axial @ rates)) @ tilted + (inertia * turning) @ axial
        return mass, bias

    def mass_matrix(self, q):
        """Joint-space mass matrix (n_axes, n_axes) with ideal gears, rotors included [kg m^2]."""
        rest = np.zeros(self.n_axes + self.n_elastic)
        mass, _ = self._equations(np.asarray(q, float), *np.split(rest, [self.n_axes]))
        return self.ideal.T @ mass @ self.ideal

    def bias(self, q, qd):
        """Joint torques [N m] at `qdd = 0`: centrifugal, Coriolis, gyroscopic and gravity terms."""
        rates = self.ideal @ np.asarray(qd, float)
        _, bias = self._equations(np.asarray(q, float), *np.split(rates, [self.n_axes]))
        return self.ideal.T @ bias

    def forward_dynamics(self, q, qd, tau):
        """Joint accelerations [rad/s^2] under joint torques [N m], ideal gears, no friction."""
        torque = np.asarray(tau, float) - self.bias(q, qd)
        return np.linalg.solve(self.mass_matrix(q), torque)

    def load_position(self, q):
        """Place of the load in the world [m], origin on axes 1 to 3."""
        turn, origin, _ = self._poses(np.asarray(q, float))
        return origin[-1] + turn[-1] @ self.centre[-1]

    def load_jacobian(self, q):
        """Velocity of the load in the world [m/s] per joint rate [rad/s]: (3, n_axes)."""
        _, origin, axis = self._poses(np.asarray(q, float))
        return cross(axis, self.load_position(q) - origin).T

    # -- energy and power

    def kinetic_energy(self, q, qd, elastic_rotor_rate=()):
        """Kinetic energy of arms, load and rotors [J]; rates of elastic gears' rotors [rad/s]."""
        rates = np.concatenate((qd, elastic_rotor_rate))
        mass, _ = self._equations(np.asarray(q, float), *np.split(rates, [self.n_axes]))
        return rates @ mass @ rates / 2.0

    def potential_energy(self, q):
        """Energy of gravity [J], zero at the height of joint 2."""
        turn, origin, _ = self._poses(np.asarray(q, float))
        turned = turn[1:][self.carrier] @ self.centre[:, :, None]
        return self.gravity * self.mass @ (origin[self.carrier] + turned[:, :, 0])[:, 2]

    def elastic_energy(self, q, elastic_rotor_angle):
        """Energy of the springs of elastic gears [J] at rotor angles (..., n_elastic) [rad]."""
        deflection = elastic_rotor_angle - (self.ratio * q)[..., : self.n_elastic]
        stretch = np.maximum(np.abs(deflection) - self.backlash, 0.0)
        return (self.stiffness * stretch**2).sum(-1) / 2.0

    def damping_power(self, q, qd, elastic_rotor_angle, elastic_rotor_rate):
        """What the dampers of elastic gears take [W]: with "contact" only where teeth touch."""
        deflection = elastic_rotor_angle - (self.ratio * q)[..., : self.n_elastic]
        rate = elastic_rotor_rate - (self.ratio * qd)[..., : self.n_elastic]
        acts = (np.abs(deflection) > self.backlash) | (self.backlash == 0.0)
        acts |= self.gear_damping == "parallel"
        return (self.damping * acts * rate**2).sum(-1)

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

    def rest_state(self, motion, start="rotor"):
        """State at rest (spec. 4): no friction, motors hold the arms against gravity.

        Rotors are on the reference and arms sag (`start="rotor"`), or arms are on the reference and
        rotors are deflected ("arm").
        """
        e, rest = self.n_elastic, np.zeros(self.n_axes)
        reference = motion.reference(0.0, motion.segment(0.0))[0][: self.n_axes]
        q = reference
        for _ in range(200):
            torque = self.bias(q, rest) / self.ratio
            torque[np.abs(torque) < ZERO_TORQUE] = 0.0
            deflection = torque[:e] / self.stiffness + self.backlash * np.sign(torque[:e])
            sagged = reference.copy()
            if start == "rotor":
                sagged[:e] -= deflection / self.ratio[:e]
            if np.max(np.abs(sagged - q)) < 1e-16:
                break
            q = sagged
        if np.any(np.abs(torque) > self.torque_limit):
            raise ValueError("the motors cannot hold the robot at the start of the motion")
        rotor_angle = self.ratio * sagged
        rotor_angle[:e] += deflection
        if start == "rotor":
            rotor_angle = self.ratio * reference
        if self.controller is None:
            return self.state_from(sagged, rotor_angle=rotor_angle)
        voltage = torque / self.electrical.K_M + self.dead_zone * np.sign(torque)
        return self.state_from(
            sagged,
            rotor_angle=rotor_angle,
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
        Output of the rate controller [V]; desired minus actual joint angle [rad]. NaN without a
        controller or without a motion.
    state : ndarray (n, n_states)
        Groups and order of `STATE_GROUPS`.
    events : list of (time, axis, element, before, after)
        Axis 1 to 6 (0: whole robot); elements 'reference' and those of `ELEMENTS`.
    evaluations : int
        Number of evaluations of the equations.
    """


class Hybrid:
    """A robot with its motion and inputs, and branches that only events change (spec. 8).

    Parameters
    ----------
    robot : IndependentRobot
    motion : Motion or None
    motor_torque, command, tip_force
        Inputs, as of `simulate`.
    """

    def __init__(self, robot, motion=None, motor_torque=None, command=None, tip_force=None):
        self.robot, self.motion = robot, motion
        self.n, self.e, self.p = robot.n_axes, robot.n_elastic, robot.ratio
        n, e = self.n, self.e
        self.motor_torque_input = as_input(motor_torque, n)
        self.command_input = as_input(command, n)
        self.tip_force = None if tip_force is None else as_input(tip_force, 3)
        self.torque_sources = {self.motor_torque_input, self.tip_force}  # they may set axes sliding
        sources = {motion, self.command_input} | self.torque_sources
        self.segment = {source: source.segment(0.0) for source in sources - {None}}
        for element in ELEMENTS:
            setattr(self, element, np.zeros(n, int))
        self.piece = np.zeros(n, int)  # of the friction characteristic
        self.armed = np.zeros(n, bool)  # creep threshold
        self.sampled_command = np.zeros(n)
        # Axes whose decisions to stick depend on each other: rotors that turn as if their axis were
        # fixed decide alone.
        alone = (np.arange(n) < e) & (robot.rotor_carrier == 0)
        self.groups = [[int(i)] for i in np.flatnonzero(alone)]
        self.groups.append([int(i) for i in np.flatnonzero(~alone)])
        self.evaluations = 0
        self._freeze()

    def _freeze(self):
        """Coefficients that follow from the branches."""
        n, e, robot = self.n, self.e, self.robot
        self.in_contact = (robot.backlash == 0.0) | (self.backlash[:e] != 0)
        self.damped = self.in_contact | (robot.gear_damping == "parallel")
        self.sliding = self.friction != 0
        # friction on its present straight piece: rM = s (offset + slope |rq'|), |rq'| = s rq'
        # (spec. 5.1)
        self.offset, self.slope = np.zeros(n), np.zeros(n)
        self.lower, self.upper = np.full(n, -np.inf), np.full(n, np.inf)
        if not robot.real_gears:
            self.sliding[:] = True  # without friction
            return
        for i in range(n):
            points, k = robot.friction_points[i], self.piece[i]
            (w0, r0), (w1, r1) = points[k], points[k + 1]
            self.slope[i] = (r1 - r0) / (w1 - w0)
            self.offset[i] = r0 - self.slope[i] * w0
            if k > 0:
                self.lower[i] = w0
            if k + 2 < len(points):
                self.upper[i] = w1

    def split(self, x):
        """Views of the state groups; `x` is (n_states,) or (points, n_states)."""
        return {name: x[..., where] for name, where in self.robot.slices.items()}

    def _rotor(self, z):
        """Angles and rates of all rotors: states of their own, or rigid gears (spec. 2)."""
        angle, rate = self.p * z["joint_angle"], self.p * z["joint_rate"]
        angle[..., : self.e], rate[..., : self.e] = z["rotor_angle"], z["rotor_rate"]
        return angle, rate

    def _motor_torque(self, t, z):
        """`rF`: NL2 on its present branch (spec. 4), or the input."""
        if self.robot.controller is None:
            return self.motor_torque_input.value(t, self.segment[self.motor_torque_input])
        limit = self.robot.torque_limit
        return np.where(self.torque_limit == 0, z["pt2_torque"], self.torque_limit * limit)

    def _deflection(self, z):
        """`delta` and `delta'` of elastic gears (spec. 5.2)."""
        e, p = self.e, self.p[: self.e]
        return (
            z["rotor_angle"] - p * z["joint_angle"][..., :e],
            z["rotor_rate"] - p * z["joint_rate"][..., :e],
        )

    def _gear_torque(self, z):
        """`tau` of elastic gears (spec. 5.2, 11): spring with backlash, damper."""
        deflection, rate = self._deflection(z)
        robot = self.robot
        stretch = deflection - self.backlash[: self.e] * robot.backlash
        return robot.stiffness * self.in_contact * stretch + robot.damping * self.damped * rate

    def _equations(self, z):
        """`M`, `bias` of the robot in a state."""
        return self.robot._equations(z["joint_angle"], z["joint_rate"], z["rotor_rate"])

    def mechanics(self, t, z, equations=None):
        """Accelerations of joints and elastic rotors, `rF` and `rM` with the present branches.

        Equations of motion of spec. 6. Where an axis sticks (spec. 5.2, 5.3) the acceleration of
        its rotor is zero, the others are solved for, and `rM` is what its row lacks.
        """
        n, e, robot = self.n, self.e, self.robot
        mass, bias = self._equations(z) if equations is None else equations
        motor = self._motor_torque(t, z)
        # s (o + k s w)
        friction = self.friction * self.offset + self.slope * self._rotor(z)[1] * self.sliding
        force = np.zeros(n + e)
        force[robot.turns] = robot.lever * (motor - friction)
        gear = self._gear_torque(z)
        force[:e] += self.p[:e] * gear
        force[n:] -= gear
        if self.tip_force is not None:
            push = self.tip_force.value(t, self.segment[self.tip_force])
            force[:n] += robot.load_jacobian(z["joint_angle"]).T @ push

        stuck = np.flatnonzero(~self.sliding)
        free = np.ones(n + e, bool)
        free[robot.turns[stuck]] = False
        acceleration = np.zeros(n + e)
        acceleration[free] = np.linalg.solve(mass[np.ix_(free, free)], (force - bias)[free])
        missing = force - bias - mass @ acceleration
        friction[stuck] = missing[robot.turns[stuck]] / robot.lever[stuck]
        return acceleration, motor, friction

    def _position_controller(self, t, z):
        """`u_c` with rate feedforward (spec. 4), as if it were continuous."""
        c = self.robot.electrical
        desired, desired_rate = self.motion.reference(t, self.segment[self.motion])
        angle = self._rotor(z)[0]
        return c.K_V * (c.p * desired[: self.n] - angle) + c.K_D * c.p * desired_rate[: self.n]

    def _rate_error(self, t, z):
        """`e = u_c - y` (spec. 4)."""
        c = self.robot.electrical
        if self.robot.controller == "continuous":
            command = self._position_controller(t, z)
        elif self.robot.controller == "sampled":
            command = self.sampled_command
        else:
            command = self.command_input.value(t, self.segment[self.command_input])
        # feedback filter (s T_a + 1)/(s T_b + 1) = T_a/T_b + (1 - T_a/T_b)/(s T_b + 1)
        lead = c.T_a / c.T_b
        return command - (lead * z["tachogenerator_2"] + (1.0 - lead) * z["filter"])

    def _voltage_drive(self, t, z):
        """`T_e U'` of the rate controller without a limit: `w + K_S T_0 e - U`."""
        c = self.robot.electrical
        return z["controller"] + c.K_S * c.T_0 * self._rate_error(t, z) - z["voltage"]

    def derivatives(self, t, x):
        """Right-hand side, smooth while branches and segments of the sources are frozen."""
        self.evaluations += 1
        z, out = self.split(x), np.empty_like(x)
        d = self.split(out)
        acceleration, _, _ = self.mechanics(t, z)
        d["joint_angle"][:], d["rotor_angle"][:] = z["joint_rate"], z["rotor_rate"]
        d["joint_rate"][:], d["rotor_rate"][:] = np.split(acceleration, [self.n])
        if self.robot.controller is not None:
            self._electrical_derivatives(t, z, d)
        return out

    def _electrical_derivatives(self, t, z, d):
        """Spec. 4."""
        c = self.robot.electrical
        # tachogenerator: PT1 (output x1), then PT2 (output u_t = x2, x3 = x2')
        x1, u_t, x3 = z["tachogenerator_1"], z["tachogenerator_2"], z["tachogenerator_3"]
        d["tachogenerator_1"][:] = c.w_e * (c.K_T * self._rotor(z)[1] - x1)
        d["tachogenerator_2"][:] = x3
        d["tachogenerator_3"][:] = c.w_p**2 * (x1 - u_t) - 2.0 * c.D_p * c.w_p * x3
        d["filter"][:] = (u_t - z["filter"]) / c.T_b
        # rate controller: w' = K_S e;  U = (w + K_S T_0 e) / (s T_e + 1). At its limit U rests and
        # w tends to it: where U is let go (w + K_S T_0 e = U) w' is the same on both sides. If w
        # rested too, it might drive U back at once, and U would chatter.
        free = self.voltage_limit == 0
        tracking = (z["voltage"] - z["controller"]) / c.T_0
        d["controller"][:] = np.where(free, c.K_S * self._rate_error(t, z), tracking)
        d["voltage"][:] = free * self._voltage_drive(t, z) / c.T_e
        # NL1, motor
        v = np.where(self.dead_zone == 0, 0.0, z["voltage"] - self.dead_zone * c.a)
        m, m_rate = z["pt2_torque"], z["pt2_torque_rate"]
        d["pt2_torque"][:] = m_rate
        d["pt2_torque_rate"][:] = c.w_i**2 * (c.K_M * v - m) - 2.0 * c.D_i * c.w_i * m_rate

    # -- indicators (spec. 7, 8): positive inside the domain of the present branch

    def watch(self, times, points):
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
        z, robot = self.split(points), self.robot
        columns, labels = [], []

        def add(column, *label):
            columns.append(column)
            labels.append(label)

        def edges(element, values, halves, leave=None):
            """Out of the middle at its edges, and back into it (or as `leave` says)."""
            for i, half in enumerate(halves):
                s, value = getattr(self, element)[i], values[:, i]
                if s == 0:
                    add(half - value, element, i, 1)
                    add(half + value, element, i, -1)
                else:
                    add(s * value - half if leave is None else s * leave[:, i], element, i, 0)

        if robot.controller is not None:
            edges("dead_zone", z["voltage"], robot.dead_zone)
            edges("torque_limit", z["pt2_torque"], robot.torque_limit)
            if robot.voltage_limit is not None:
                drive = self._at_all(self._voltage_drive, times, points)
                limits = np.full(self.n, robot.voltage_limit)
                edges("voltage_limit", z["voltage"], limits, drive)
        armed = self.armed.copy()
        if not robot.real_gears:
            return np.array(columns).reshape(-1, len(points)).T, labels, armed

        # no backlash: in contact for ever
        edges(
            "backlash", self._deflection(z)[0], np.where(robot.backlash > 0, robot.backlash, np.inf)
        )
        friction = np.zeros((len(points), self.n))
        if not self.sliding.all():
            friction = self._at_all(lambda t, z: self.mechanics(t, z)[2], times, points)
        rate = self._rotor(z)[1]
        for i, s in enumerate(self.friction):
            if s == 0:
                add(robot.sticking_limit[i] - np.abs(friction[:, i]), "limit", i, None)
                continue
            speed = s * rate[:, i]
            add(speed, "rate", i, None)
            if np.isfinite(self.upper[i]):
                add(self.upper[i] - speed, "kink", i, self.piece[i] + 1)
            if np.isfinite(self.lower[i]):
                add(speed - self.lower[i], "kink", i, self.piece[i] - 1)
            if i < self.e and robot.creep_rate > 0.0:
                ready = np.logical_or.accumulate(speed > 10.0 * robot.creep_rate) | armed[i]
                add(np.where(ready, speed - robot.creep_rate, 1.0), "creep", i, None)
                armed[i] = ready[-1]
        return np.array(columns).T, labels, armed

    def _at_all(self, function, times, points):
        """Values of `function(t, z)` at several instants."""
        states = map(self.split, points)
        return np.array([function(t, z) for t, z in zip(times, states, strict=True)])

    # -- decisions

    def start(self, x):
        """Decide branches by physics; a value exactly on an edge goes where its rate points."""

        def side(value, rate, half):
            outside = (np.abs(value) > half) | (
                (np.abs(value) == half) & (np.sign(value) * rate > 0.0)
            )
            return np.where(outside, np.sign(value), 0.0).astype(int)

        z, robot = self.split(x), self.robot
        if robot.controller == "sampled":
            self.sampled_command = self._position_controller(0.0, z)
        d = self.split(self.derivatives(0.0, x))
        if robot.controller is not None:
            self.dead_zone = side(z["voltage"], d["voltage"], robot.dead_zone)
            self.torque_limit = side(z["pt2_torque"], z["pt2_torque_rate"], robot.torque_limit)
        if robot.voltage_limit is not None:
            if np.any(np.abs(z["voltage"]) > robot.voltage_limit):
                raise ValueError("a voltage is beyond its limit at the start")
            self._decide_voltage_limits(0.0, z, range(self.n), ())
        if robot.real_gears:
            contact = side(*self._deflection(z), robot.backlash)
            self.backlash[: self.e] = np.where(robot.backlash > 0.0, contact, 0)
            rate = self._rotor(z)[1]
            self.friction = np.sign(rate).astype(int)
            for i, w in enumerate(rate):
                inner = robot.friction_points[i][1:-1]
                self.piece[i] = sum(abs(w) >= point[0] for point in inner)
            self.armed = np.abs(rate) > 10.0 * robot.creep_rate
            self._freeze()
            self._decide_friction(0.0, z, range(self.n), (), np.zeros(self.n, bool))

    def _decide_voltage_limits(self, t, z, concerned, released):
        """At the limit `U` stays where its own equation would drive it on."""
        drive, limit = self._voltage_drive(t, z), self.robot.voltage_limit
        for i in concerned:
            side = int(np.sign(z["voltage"][i]))
            stays = abs(z["voltage"][i]) == limit and side * drive[i] > 0.0
            self.voltage_limit[i] = side if stays and i not in released else 0

    def _decide_friction(self, t, z, concerned, released, stuck):
        """Axes at zero rate stick or slide: each group of coupled axes that is concerned."""
        rate = self._rotor(z)[1]
        equations = self._equations(z)
        for group in self.groups:
            at_zero = [i for i in group if rate[i] == 0.0]
            if at_zero and not set(group).isdisjoint(concerned):
                self._combine(t, z, equations, at_zero, released, stuck)

    def _combine(self, t, z, equations, at_zero, released, stuck):
        """The rule of spec. 5.3 among all consistent combinations of sticking and sliding."""
        limit, lever, turns = self.robot.sticking_limit, self.robot.lever, self.robot.turns
        # Without a static peak (axes 1 to 3) an axis is released with no acceleration, which
        # roundoff may turn; it cannot be taken for the wrong direction, where it would be far below
        # zero.
        roundoff = 1e-9 * limit / self.robot.rotor_inertia
        self.piece[at_zero], self.armed[at_zero] = 0, False
        best = None
        # In the order of the last tie-break; most sticking axes first, behind which none is better.
        combinations = product((0, -1, 1), repeat=len(at_zero))
        for combination in sorted(combinations, key=lambda c: -c.count(0)):
            if best is not None and combination.count(0) < best[0][0]:
                break
            branches = list(zip(at_zero, combination, strict=True))
            if any(s == 0 and i in released for i, s in branches):
                continue
            self.friction[at_zero] = combination
            self._freeze()
            acceleration, _, friction = self.mechanics(t, z, equations)
            rotor_acceleration = lever * acceleration[turns]
            consistent = all(
                abs(friction[i]) <= limit[i] if s == 0 else s * rotor_acceleration[i] > -roundoff[i]
                for i, s in branches
            )
            if consistent:
                rank = (combination.count(0), sum(s == 0 and stuck[i] for i, s in branches))
                if best is None or rank > best[0]:
                    best = (rank, combination)
        if best is None:
            raise RuntimeError("no consistent combination of sticking and sliding axes")
        self.friction[at_zero] = best[1]
        self._freeze()

    def handle(self, t, x, due, fired):
        """Switch at `t` what is due (sources; 'sample') and what fired (labels): one decision.

        An axis may come to rest in `x`, a voltage be set to its limit.

        Returns
        -------
        list of (time, axis, element, before, after)
        """
        before = {element: getattr(self, element).copy() for element in ELEMENTS}
        z, robot = self.split(x), self.robot
        for source in due:
            if source != "sample":
                self.segment[source] += 1
        if "sample" in due:
            self.sampled_command = self._position_controller(t, z)

        rest, released, creeping = [], [], []
        for element, i, branch in fired:
            if element in ELEMENTS:
                getattr(self, element)[i] = branch
            elif element == "kink":
                self.piece[i] = branch
            else:
                {"rate": rest, "limit": released, "creep": creeping}[element].append(i)
        self._freeze()

        if robot.voltage_limit is not None:
            changed = [(i, branch) for element, i, branch in fired if element == "voltage_limit"]
            for i, branch in changed:
                if branch != 0:
                    z["voltage"][i] = branch * robot.voltage_limit
            command_jumps = "sample" in due or self.command_input in due
            concerned = range(self.n) if command_jumps else [i for i, _ in changed]
            released_voltages = [i for i, branch in changed if branch == 0]
            self._decide_voltage_limits(t, z, concerned, released_voltages)

        rest += [i for i in creeping if i not in rest and self._could_stick(t, z, i)]
        self.armed[creeping] = False
        for i in rest:
            z["rotor_rate" if i < self.e else "joint_rate"][i] = 0.0
        torque_jumps = not self.torque_sources.isdisjoint(due) or (
            robot.gear_damping == "contact" and np.any(self.backlash != before["backlash"])
        )
        concerned = range(self.n) if torque_jumps else rest + released
        if robot.real_gears and concerned:
            self._decide_friction(t, z, concerned, released, before["friction"] == 0)

        log = [(float(t), 0, "reference", 0, 0)] if self.motion in due else []
        for i in range(self.n):
            for element in ELEMENTS:
                old, new = int(before[element][i]), int(getattr(self, element)[i])
                if old != new:
                    log.append((float(t), i + 1, element, old, new))
        return log

    def _could_stick(self, t, z, i):
        """Whether a creeping axis (spec. 8) could stick here; else it slides on to its zero."""
        branch = self.friction[i]
        self.friction[i] = 0
        self._freeze()
        friction = self.mechanics(t, z)[2][i]
        self.friction[i] = branch
        self._freeze()
        return abs(friction) <= self.robot.sticking_limit[i]

    def signals(self, t, x):
        """All recorded signals at one instant."""
        z, nothing = self.split(x), np.full(self.n, np.nan)
        acceleration, motor, friction = self.mechanics(t, z)
        angle, rate = self._rotor(z)
        error = nothing
        if self.motion is not None:
            desired = self.motion.reference(t, self.segment[self.motion])[0][: self.n]
            error = desired - z["joint_angle"]
        return {
            "joint_angle": z["joint_angle"],
            "joint_rate": z["joint_rate"],
            "joint_acceleration": acceleration[: self.n],
            "rotor_angle": angle,
            "rotor_rate": rate,
            "motor_torque": motor,
            "friction_torque": friction,
            "voltage": nothing if self.robot.controller is None else z["voltage"],
            "state": x,
            "control_error": error,
        }


# --- simulation -----------------------------------------------------------------------------------


def simulate(
    robot,
    motion,
    t_end,
    rtol=1e-10,
    times=None,
    start=None,
    max_step=2e-4,
    inner_points=5,
    **inputs,
):
    """Simulate a robot that follows a motion.

    Parameters
    ----------
    robot : IndependentRobot
    motion : Motion or None
        Six axes, or three for models 2 and 4; None where no position controller needs it.
    t_end : float
        End [s]; the start is at 0.
    rtol : float
        Tolerance of the integration relative to each state's nominal value.
    times : array_like, optional
        Instants to record, ascending in [0, t_end]; default 201 equal steps' ends.
    start : {"rotor", "arm"} or ndarray, optional
        Which start at rest (default "rotor"; without a motion at zero angles), or a state vector
        (`IndependentRobot.state_from`).
    max_step : float
        Longest step of the integrator [s].
    inner_points : int
        Number of equidistant points in each step, its end among them, at which the indicators are
        watched.
    motor_torque, command, tip_force : array_like or callable or Steps, optional
        Inputs: torques of motors without controllers (n_axes) [N m]; `u_c` of "external"
        controllers (n_axes) [V]; force on the load in world coordinates (3) [N]. Constant, a smooth
        function of time, or constant between knots.

    Returns
    -------
    Run
    """
    system = Hybrid(robot, motion, **inputs)
    if start is None or isinstance(start, str):
        held = Hold(np.zeros(robot.n_axes)) if motion is None else motion
        x = robot.rest_state(held, start or "rotor")
    else:
        x = np.array(start, float)
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

    events, recent, timetable = [], [], _time_events(system, t_end)
    t = 0.0
    while t < t_end:
        stop = timetable[0][0] if timetable else t_end
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
        due = []
        if timetable and one_instant(t, stop):
            t = stop
            while timetable and one_instant(timetable[0][0], stop):
                due.append(timetable.pop(0)[1])
        log = system.handle(t, x, due, fired or [])
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


def _time_events(system, t_end):
    """Time events in (0, t_end), ascending: instants, and which source or 'sample' it is."""
    events = [(knot, source) for source in system.segment for knot in source.knots]
    if system.robot.controller == "sampled":
        period = system.robot.sampling_time
        events += [(k * period, "sample") for k in range(1, int(t_end / period) + 2)]
    return sorted((event for event in events if 0.0 < event[0] < t_end), key=lambda event: event[0])


def _first_events(system, t0, x0, t1, x1, dense, advance, inner_points):
    """First instant in (t0, t1] at which indicators leave their domains, and their labels.

    Returns None if there is none. The instant is a root along a fresh integration from `t0`.
    """
    grid = t0 + (t1 - t0) * np.arange(inner_points + 1) / inner_points
    points = np.vstack((x0, dense(grid[1:-1]).T, x1))
    values, labels, armed = system.watch(grid, points)
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
            return system.watch([*grid[:k], t], np.vstack((points[:k], x)))[0][-1, column]

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
    points = np.vstack((points[:first], advance(t0, x0, t)))
    system.armed = system.watch([*grid[:first], t], points)[2]
    return t, [label for root, label in roots if root - t <= 4.0 * np.spacing(t)]
