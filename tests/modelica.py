"""Independent implementation of the Modelica variant of the robot: a test oracle, and its runs.

Written from the equations of the Modelica Standard Library's `RobotR3` examples as restated in the
project specification of the variant ("spec. M"), whose friction is decided by the rules of the
project specification ("spec. N" cites its section N). It keeps Modelica's own frames (y up) and
takes the plainest way: geometric Jacobians body by body in world coordinates, all combinations of
sticking and sliding tried, `scipy.integrate.DOP853` with short steps, every event located by
integrating afresh to the root. A second of the full robot takes minutes, so what is compared is
kept in `data`; `python tests/modelica.py` computes it again.

    run = simulate("one-axis")
    run.joint_angle, run.events
"""

import json
from itertools import product
from pathlib import Path
from time import perf_counter

import numpy as np
from independent import Run, Trapezoid, cross
from scipy.integrate import DOP853
from scipy.optimize import brentq

RUNS_FILE = Path(__file__).parent / "data" / "modelica_runs.json"

# Table of spec. M, "Axis". Axes 1 to 3 have elastic gears, and friction at the rotor; axes 4 to 6
# rigid gears, and friction at the joint.
GEAR_RATIO = np.array([-105.0, 210.0, 60.0, -99.0, 79.2, -99.0])
FREQUENCY = np.array([4590.0, 5500.0, 5500.0, 6250.0, 6250.0, 7400.0])
TORQUE_PER_CURRENT = np.array([1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842])
DAMPING_RATIO = np.array([0.6, 0.6, 0.6, 0.55, 0.55, 0.27])
ROTOR_INERTIA = np.array([1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5])
STIFFNESS = np.array([43.0, 8.0, 58.0])
DAMPING = np.array([0.005, 0.01, 0.04])
SLIDING_TORQUE = np.array([0.4, 0.5, 0.7, 21.8, 30.1, 10.9])
SLOPE = np.array([0.13 / 160.0, 0.1 / 130.0, 0.2 / 130.0, 9.8, 0.03, 3.92])
STICKING_LIMIT = np.array([0.4, 0.5, 0.7, 26.7, 39.6, 16.8])  # peak times the sliding torque
KP, KS, TS = 5.0, 0.5, 0.05

# spec. M, "Arms": axis of the joint, offset to the next joint, mass, centre of mass and (I11, I22,
# I33, I21) about that centre; the load moves with arm 6.
ARMS = (
    ("y", (0.0, 0.324, 0.3), 1.0, (0.0, 0.0, 0.0), (0.001, 1.16, 0.001, 0.0)),
    ("x", (0.0, 0.65, 0.0), 56.5, (0.172, 0.205, 0.0), (2.58, 0.64, 2.73, -0.46)),
    ("x", (0.0, 0.414, -0.155), 26.4, (0.064, -0.034, 0.0), (0.279, 0.245, 0.413, -0.070)),
    ("y", (0.0, 0.186, 0.0), 28.7, (0.0, 0.0, 0.0), (1.67, 0.081, 1.67, 0.0)),
    ("x", (0.0, 0.125, 0.0), 5.2, (0.0, 0.0, 0.0), (1.25, 0.81, 1.53, 0.0)),
    ("y", (0.0, 0.0, 0.0), 0.5, (0.05, 0.05, 0.05), (0.001, 0.001, 0.001, 0.0)),
)
LOAD = (15.0, (0.1, 0.25, 0.1), (0.001, 0.001, 0.001, 0.0))
FIRST_JOINT = (0.0, 0.351, 0.0)
GRAVITY = np.array([0.0, -9.81, 0.0])
UNIT = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0])}
LOAD_INERTIA = 19.5  # kg m^2, spec. M: the one axis turns nothing else

CREEP_RATE, CREEP_ARMED = 1e-9, 1e-8  # rad/s, spec. 8: axes 1 to 3
SIGNALS = (
    "joint_angle", "joint_rate", "joint_acceleration", "rotor_angle", "rotor_rate", "motor_torque",
    "gear_torque", "joint_torque", "friction_torque", "voltage", "control_error",
)  # fmt: skip
STATES = ("q", "qd", "phi", "w_m", "x", "v", "i")  # of the axes; phi, w_m: elastic gears only


# --- the two arms ---------------------------------------------------------------------------------


def skew(a):
    """Matrix of the cross product with `a`."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def tensor(i11, i22, i33, i21):
    """Tensor of inertia [kg m^2]."""
    return np.array([[i11, i21, 0.0], [i21, i22, 0.0], [0.0, 0.0, i33]])


class FullArm:
    """Six arms and the load; joint rows `M qdd + bias = tau`, without rotors."""

    def __init__(self):
        self.bodies = [[(m, np.array(r), tensor(*i))] for _, _, m, r, i in ARMS]
        self.bodies[-1].append((LOAD[0], np.array(LOAD[1]), tensor(*LOAD[2])))
        self.offset = np.array([arm[1] for arm in ARMS])
        self.axis = np.array([UNIT[arm[0]] for arm in ARMS])
        self.turning = [(skew(axis), skew(axis) @ skew(axis)) for axis in self.axis]

    def equations(self, q, qd):
        """`M = sum J^T I J`, `bias = sum J^T (rate of momentum at qdd = 0, less gravity)`."""
        mass, bias = np.zeros((6, 6)), np.zeros(6)
        turn, origin, w, alpha = np.eye(3), np.array(FIRST_JOINT), np.zeros(3), np.zeros(3)
        acceleration = -GRAVITY  # of the origin, at qdd = 0
        axes, origins = np.zeros((6, 3)), np.zeros((6, 3))
        for j in range(6):
            # Rotation about a fixed axis with K = skew(axis): 1 + sin q K + (1 - cos q) K^2
            k, k_squared = self.turning[j]
            axes[j], origins[j] = turn @ self.axis[j], origin
            turn = turn @ (np.eye(3) + np.sin(q[j]) * k + (1.0 - np.cos(q[j])) * k_squared)
            alpha = alpha + qd[j] * cross(w, axes[j])
            w = w + qd[j] * axes[j]
            spin = skew(w)
            swing = skew(alpha) + spin @ spin  # acceleration of a point less that of the origin

            jw, moved = axes[: j + 1], np.s_[: j + 1]
            for m, centre, inertia in self.bodies[j]:
                lever = turn @ centre
                jv = cross(jw, origin + lever - origins[moved])
                inertia = turn @ inertia @ turn.T
                mass[moved, moved] += m * jv @ jv.T + jw @ inertia @ jw.T
                bias[moved] += jv @ (m * (acceleration + swing @ lever))
                bias[moved] += jw @ (inertia @ alpha + spin @ inertia @ w)
            step = turn @ self.offset[j]
            acceleration = acceleration + swing @ step
            origin = origin + step
        return mass, bias


class LoadInertia:
    """One joint that turns a body about its axis of symmetry."""

    def equations(self, q, qd):
        """`M`, and no bias."""
        return np.array([[LOAD_INERTIA]]), np.zeros(1)


# --- the hybrid system ----------------------------------------------------------------------------


class ModelicaRobot:
    """One of the two models with its motion, and friction modes that only events change.

    Parameters
    ----------
    model : {"full-robot", "one-axis"}

    Attributes
    ----------
    n, e : int
        Axes; leading axes with an elastic gear.
    motion : Trapezoid
    t_end : float
        End of the run: 0.5 s after rest [s].
    mode : ndarray of int (n,)
        -1 sliding backward, 0 sticking, +1 sliding forward: rotors of axes 1 to 3, joints 4 to 6.
    """

    def __init__(self, model):
        if model == "full-robot":
            self.arm, table = FullArm(), slice(0, 6)
            self.motion = Trapezoid(
                np.deg2rad([-60.0, 20.0, 90.0, 0.0, -110.0, 0.0]),
                np.deg2rad([60.0, -70.0, -35.0, 45.0, 110.0, 45.0]),
                (3.0, 1.5, 5.0, 3.1, 3.1, 4.1),
                (15.0, 15.0, 15.0, 60.0, 60.0, 60.0),
            )
        else:
            self.arm, table = LoadInertia(), slice(1, 2)  # the parameters of axis 2
            self.motion = Trapezoid([0.0], np.deg2rad([120.0]), (3.0,), (10.0,))
        self.t_end = self.motion.knots[-1] + 0.5
        self.r, self.k = GEAR_RATIO[table], TORQUE_PER_CURRENT[table]
        self.w, self.d = FREQUENCY[table], DAMPING_RATIO[table]
        self.c, self.damping = STIFFNESS[table], DAMPING[table]
        self.sliding_torque, self.slope = SLIDING_TORQUE[table], SLOPE[table]
        self.limit = STICKING_LIMIT[table]
        self.n, self.e = n, e = len(self.r), len(self.c)
        self.elastic_inertia = ROTOR_INERTIA[table][:e]
        self.rigid_inertia = np.where(np.arange(n) < e, 0.0, self.r**2 * ROTOR_INERTIA[table])
        self.segment = self.motion.segment(0.0)
        self.mode = np.zeros(n, int)
        self.armed = np.zeros(n, bool)

        sizes = [e if name in ("phi", "w_m") else n for name in STATES]
        ends = np.cumsum(sizes)
        self.n_states = int(ends[-1])
        self.slices = {
            name: slice(end - size, end)
            for name, size, end in zip(STATES, sizes, ends, strict=True)
        }

    def split(self, x):
        """Views of the states by their names in spec. M (`qd`: `q'`)."""
        return {name: x[where] for name, where in self.slices.items()}

    def start(self):
        """At rest on the reference, without friction (spec. M, "Start"); all axes stick."""
        x = np.zeros(self.n_states)
        z = self.split(x)
        z["q"][:] = self.motion.start
        h = self.arm.equations(z["q"], z["qd"])[1]
        z["phi"][:] = (-h / self.r)[: self.e] / self.c
        z["i"][:] = h / (self.r * self.k)
        z["v"][:] = -50.0 * z["i"]
        z["x"][:] = z["i"] / KS
        z["x"][: self.e] -= KP * z["phi"]
        return x

    # -- equations

    def rotor(self, z):
        """Angles and rates of all rotors."""
        angle, rate = self.r * z["q"], self.r * z["qd"]
        angle[: self.e] -= z["phi"]
        rate[: self.e] = z["w_m"]
        return angle, rate

    def drive(self, z):
        """`T` of the elastic gears, and `k i + T`: what turns their rotors but for friction."""
        e = self.e
        rate = self.r[:e] * z["qd"][:e] - z["w_m"]
        spring = self.c * z["phi"] + self.damping * rate
        return spring, self.k[:e] * z["i"][:e] + spring

    def mechanics(self, z):
        """Accelerations of joints and elastic rotors, and `R`, with the present modes.

        Sticking joints: the remaining accelerations are solved for with theirs zero (spec. 5.3).
        """
        e, r = self.e, self.r
        slides = self.mode != 0
        rate = np.concatenate((z["w_m"], z["qd"][e:]))  # where friction acts
        friction = np.where(slides, self.mode * self.sliding_torque + self.slope * rate, 0.0)
        spring, drive = self.drive(z)
        friction[:e] = np.where(slides[:e], friction[:e], drive)
        rotor_acceleration = np.where(slides[:e], drive - friction[:e], 0.0) / self.elastic_inertia

        mass, bias = self.arm.equations(z["q"], z["qd"])
        mass[np.diag_indices(self.n)] += self.rigid_inertia
        torque = r * self.k * z["i"] - friction
        torque[:e] = -r[:e] * spring
        free = slides.copy()
        free[:e] = True
        rows = mass if free.all() else np.where(np.outer(free, free), mass, np.eye(self.n))
        acceleration = np.linalg.solve(rows, np.where(free, torque - bias, 0.0))
        if not free.all():
            friction[~free] = (torque - bias - mass @ acceleration)[~free]
        return acceleration, rotor_acceleration, friction

    def derivatives(self, t, x):
        """Right-hand side, smooth while the modes and the segment of the motion are frozen."""
        z, out = self.split(x), np.empty_like(x)
        dz = self.split(out)
        angle, rate = self.rotor(z)
        dz["q"][:] = z["qd"]
        dz["phi"][:] = (self.r * z["qd"] - rate)[: self.e]
        dz["qd"][:], dz["w_m"][:], _ = self.mechanics(z)
        desired, desired_rate = self.motion.reference(t, self.segment)
        u = self.r * desired_rate + KP * (self.r * desired - angle) - rate
        dz["x"][:] = u / TS
        desired_current = KS * (z["x"] + u)
        v, i = z["v"], z["i"]
        dz["v"][:] = (i - desired_current) * self.w / (0.04 * self.d)
        dz["i"][:] = -2.0 * self.d * self.w / 250.0 * (5.0 * v + 250.0 * i + self.k * rate)
        return out

    # -- friction

    def indicators(self, x):
        """Positive while a mode may last: {(what happens at zero, axis index): value}."""
        z = self.split(x)
        rate = [*z["w_m"], *z["qd"][self.e :]]
        friction = self.mechanics(z)[2] if not self.mode.all() else None
        values = {}
        for i, s in enumerate(self.mode):
            if s == 0:
                values["slip", i] = self.limit[i] - abs(friction[i])
            else:
                values["rest", i] = s * rate[i]
                if self.armed[i]:
                    values["creep", i] = s * rate[i] - CREEP_RATE
        return values

    def arm_creep(self, x):
        """Axes 1 to 3 may creep to rest once they have turned faster than 1e-8 rad/s (spec. 8)."""
        self.armed[: self.e] |= np.abs(self.split(x)["w_m"]) > CREEP_ARMED

    def switch(self, x, fired):
        """Decide new modes where something happened; axes may come to rest in `x`."""
        z, before, e = self.split(x), self.mode.copy(), self.e
        slip = [i for what, i in fired if what == "slip"]
        rest = {i for what, i in fired if what == "rest"}
        for what, i in fired:
            if what == "creep":
                self.armed[i] = False
                if abs(self.drive(z)[1][i]) <= self.limit[i]:
                    rest.add(i)
        for i in rest:
            (z["w_m"] if i < e else z["qd"])[i] = 0.0

        # Axes 1 to 3 (spec. 5.2): each for itself
        _, drive = self.drive(z)
        for i in (*slip, *rest):
            if i < e:
                sticks = abs(drive[i]) <= self.limit[i] and i not in slip
                self.mode[i] = 0 if sticks else np.sign(drive[i])
                self.armed[i] = False
        if any(i >= e for i in (*slip, *rest)):
            self._switch_joints(z, slip, before)

    def _switch_joints(self, z, slip, before):
        """Axes 4 to 6 at zero rate (spec. 5.3): the best of all consistent combinations."""
        zero = [i for i in range(self.e, self.n) if z["qd"][i] == 0.0]
        consistent = []
        for modes in product((0, -1, 1), repeat=len(zero)):
            self.mode[zero] = modes
            acceleration, _, friction = self.mechanics(z)
            holds = [
                abs(friction[i]) <= self.limit[i] and i not in slip
                if s == 0
                else s * acceleration[i] > 0.0
                for i, s in zip(zero, modes, strict=True)
            ]
            if all(holds):
                kept = sum(s == 0 and before[i] == 0 for i, s in zip(zero, modes, strict=True))
                consistent.append(((modes.count(0), kept), modes))
        # The first of the best: combinations come in the order of the last tie-break.
        self.mode[zero] = max(consistent, key=lambda ranked: ranked[0])[1]

    def signals(self, t, x):
        """All signals of `SIGNALS` at one instant, in the package's terms."""
        z, e = self.split(x), self.e
        acceleration, _, friction = self.mechanics(z)
        rotor_angle, rotor_rate = self.rotor(z)
        motor = self.k * z["i"]
        friction[e:] /= self.r[e:]  # from the joint to the motor
        gear = np.concatenate((-self.drive(z)[0], (motor - friction)[e:]))
        return {
            "joint_angle": z["q"],
            "joint_rate": z["qd"],
            "joint_acceleration": acceleration,
            "rotor_angle": rotor_angle,
            "rotor_rate": rotor_rate,
            "motor_torque": motor,
            "gear_torque": gear,
            "joint_torque": self.r * gear,
            "friction_torque": friction,
            "voltage": z["v"],
            "control_error": self.motion.reference(t, self.segment)[0] - z["q"],
        }


# --- simulation -----------------------------------------------------------------------------------


def simulate(model, t_end=None, times=(), rtol=1e-13, max_step=5e-5):
    """Simulate a model from its start at rest.

    Parameters
    ----------
    model : {"full-robot", "one-axis"}
    t_end : float, optional
        End [s]; default: that of the published runs.
    times : array_like
        Instants to record, ascending in [0, t_end].
    rtol : float
        Tolerance of the integration, relative to each state and to its SI unit.
    max_step : float
        Longest step [s]; the indicators are looked at where a step ends.

    Returns
    -------
    Run
        `time`, `SIGNALS` (n, n_axes), `state` (n, n_states), and `events`: (time, axis, element,
        before, after).
    """
    robot = ModelicaRobot(model)
    t_end = robot.t_end if t_end is None else t_end
    options = {"rtol": rtol, "atol": rtol, "max_step": max_step}
    pending, rows, events = list(times), [], []

    def advance(t0, x0, t1):
        """State at `t1`, integrated afresh from the beginning of a step: no interpolant."""
        if t1 == t0:
            return x0.copy()
        solver = DOP853(robot.derivatives, t0, x0, t1, first_step=t1 - t0, **options)
        while solver.status == "running":
            solver.step()
        return solver.y.copy()

    def record(t0, x0, t1):
        """What is asked for in [t0, t1): at an event the modes after it count."""
        while pending and pending[0] < t1:
            t = pending.pop(0)
            x = advance(t0, x0, t)
            rows.append({**robot.signals(t, x), "state": x})

    t, x = 0.0, robot.start()
    for stop in (*[knot for knot in robot.motion.knots if 0.0 < knot < t_end], t_end):
        while t < stop:
            solver = DOP853(robot.derivatives, t, x, stop, **options)
            fired = []
            while not fired and solver.status == "running":
                t0, x0 = t, x
                solver.step()
                t, fired = first_event(robot, advance, t0, x0, solver.t, solver.y)
                record(t0, x0, t)
                x = advance(t0, x0, t) if fired else solver.y.copy()
                robot.arm_creep(x)
            before = robot.mode.copy()
            robot.switch(x, fired)
            events += [
                (float(t), int(i) + 1, "friction", int(before[i]), int(robot.mode[i]))
                for i in np.flatnonzero(robot.mode != before)
            ]
        if stop < t_end:
            events.append((float(stop), 0, "reference", 0, 0))
            robot.segment = robot.motion.segment(stop)
    record(t, x, np.nextafter(t_end, np.inf))

    run = Run()
    run.time, run.events = np.array(times), events
    for name in rows[0] if rows else ():
        setattr(run, name, np.array([row[name] for row in rows]))
    return run


def first_event(robot, advance, t0, x0, t1, x1):
    """End of the step, or the first instant in it at which modes end; and which do."""
    roots = []
    for label, value in robot.indicators(x1).items():
        if value <= 0.0:

            def indicator(t, label=label):
                return robot.indicators(advance(t0, x0, t))[label]

            # A rate that has just begun at zero grows first: its zero is not the one looked for.
            low = t0
            if indicator(low) <= 0.0:
                low += 1e-3 * (t1 - t0)
            roots.append((brentq(indicator, low, t1, xtol=1e-18, rtol=8.9e-16), label))
    if not roots:
        return t1, []
    t = min(root for root, _ in roots)
    return t, [label for root, label in roots if root - t <= 4.0 * np.spacing(t)]


# --- what is kept ---------------------------------------------------------------------------------


def instants(model):
    """About sixty instants of a run at which signals are kept, none of them special."""
    return np.linspace(0.0, ModelicaRobot(model).t_end, 62)[1:-1]


def stored(model):
    """What `python tests/modelica.py` found: `time`, `SIGNALS`, `events`."""
    run = Run()
    for name, value in json.loads(RUNS_FILE.read_text())[model].items():
        setattr(run, name, np.array(value))
    run.events = [tuple(event) for event in json.loads(RUNS_FILE.read_text())[model]["events"]]
    return run


def _store():
    """Compute both runs and keep them."""
    lines = []
    for model in ("full-robot", "one-axis"):
        began = perf_counter()
        times = instants(model)
        run = simulate(model, times=times)
        print(f"{model}: {len(run.events)} events, {perf_counter() - began:.0f} s", flush=True)
        entries = {"time": times, **{name: getattr(run, name) for name in SIGNALS}}
        lines.append(
            f'"{model}": {{\n"events": {json.dumps(run.events)},\n'
            + ",\n".join(f'"{name}": {json.dumps(v.tolist())}' for name, v in entries.items())
            + "\n}"
        )
    RUNS_FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    _store()
