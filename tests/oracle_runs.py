"""Runs that both implementations know; what the independent one gives is stored in `data`.

It takes minutes, so it is kept: `python tests/oracle_runs.py` computes all of it again,
`python tests/oracle_runs.py <name> ...` some of it. The stored runs are accurate to about 1e-12 s
in event times: far below what they are to decide about.
"""

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import independent
import numpy as np

import manutec_r3 as r3

EVENTS_FILE = Path(__file__).parent / "data" / "oracle_events.json"
SIGNALS_FILE = Path(__file__).parent / "data" / "oracle_signals.npz"
SIGNALS = (
    "joint_angle",
    "joint_rate",
    "joint_acceleration",
    "rotor_angle",
    "rotor_rate",
    "motor_torque",
    "friction_torque",
    "voltage",
    "control_error",
)


@dataclass(frozen=True)
class OracleRun:
    """One run.

    Attributes
    ----------
    model : int
    motion : tuple or None
        Name of the motion and its arguments: the same in both implementations.
    t_end : float
        End [s].
    mass, position : float, tuple
        The load [kg, m].
    start : dict or str or None
        Arguments of `state_from`; "rotor" or "arm", or None for the default start at rest.
    options : dict
        Options of the robot.
    inputs : dict
        Inputs of `simulate`: constants, or functions of time.
    """

    model: int
    motion: tuple | None
    t_end: float
    mass: float = 0.0
    position: tuple = (0.0, 0.0, 0.25)
    start: dict | str | None = None
    options: dict = field(default_factory=dict)
    inputs: dict = field(default_factory=dict)

    @property
    def times(self):
        """Instants at which signals are compared, none of them special."""
        return np.linspace(0.0, self.t_end, 42)[1:-1]

    @property
    def robot(self):
        """The package's robot."""
        return r3.Robot(self.model, r3.Load(self.mass, self.position), **self.options)

    @property
    def independent_robot(self):
        """The independent implementation's robot."""
        return independent.IndependentRobot(self.model, self.mass, self.position, **self.options)

    def _motion(self, module):
        if self.motion is None:
            return None
        kind, *arguments = self.motion
        return getattr(module, kind)(*arguments)

    def _start(self, robot):
        return robot.state_from(**self.start) if isinstance(self.start, dict) else self.start

    def simulate(self, t_end=None, **options):
        """Simulate by the package; options as of `manutec_r3.simulate`."""
        robot = self.robot
        if self.start is not None:
            options["start"] = self._start(robot)
        return r3.simulate(robot, self._motion(r3), t_end or self.t_end, **self.inputs, **options)

    def simulator(self, **options):
        """Step by step by the package, without inputs; options as of `manutec_r3.Simulator`."""
        robot = self.robot
        if self.start is not None:
            options["start"] = self._start(robot)
        return r3.Simulator(robot, self._motion(r3), **options)

    def simulate_independently(self, t_end=None, rtol=1e-12):
        """Simulate by the independent implementation."""
        robot, motion = self.independent_robot, self._motion(independent)
        t_end = t_end or self.t_end
        times = self.times[self.times <= t_end]
        return independent.simulate(
            robot, motion, t_end, rtol, times, self._start(robot), **self.inputs
        )


def swinging_torques(t):
    """Torques of the six motors [N m] that break each axis away, and turn it back."""
    amplitude = np.array([1.0, 1.2, 1.5, 0.5, 0.8, 0.4])
    return amplitude * np.sin(2.0 * np.pi * np.array([4.0, 3.0, 3.5, 5.0, 4.5, 6.0]) * t)


def growing_push(t):
    """A force on the tip [N] that grows until axes give way."""
    return t * np.array([1500.0, 1000.0, -800.0])


AT_ZERO = (0.0,) * 6
BENT = (0.3, -0.5, 0.8, 0.4, -0.6, 0.2)
ECCENTRIC = (0.06, -0.05, 0.18)

RUNS = {
    "section-10": OracleRun(
        model=3,
        motion=("Quintic", AT_ZERO, (1.0, 1.0, 0.6, -0.2, -0.15, -0.1), 1.2),
        t_end=1.5,
        mass=15.0,
    ),
    "1-quintic": OracleRun(
        model=1,
        motion=("Quintic", BENT, (-0.2, 0.3, -0.4, 1.0, 0.5, -1.2), 0.45),
        t_end=0.8,
        mass=8.0,
        position=ECCENTRIC,
    ),
    "1-trapezoid": OracleRun(
        model=1,
        motion=(
            "Trapezoid",
            AT_ZERO,
            (0.3, -0.2, 0.4, -0.5, 0.6, -0.7),
            (2.0,) * 6,
            (12.0,) * 6,
        ),
        t_end=0.7,
        mass=15.0,
    ),
    "1-hold-disturbed": OracleRun(
        model=1,
        motion=("Hold", BENT),
        t_end=0.4,
        mass=3.0,
        position=ECCENTRIC,
        start={
            "joint_angle": (0.31, -0.49, 0.79, 0.42, -0.63, 0.2),
            "joint_rate": (0.5, -0.3, 0.4, 1.0, -2.0, 1.5),
        },
    ),
    "2-quintic": OracleRun(
        model=2,
        motion=("Quintic", (0.0, -1.5, 0.0), (1.0, -1.95, 1.0), 0.6),
        t_end=1.0,
        mass=4.0,
        position=ECCENTRIC,
    ),
    "2-trapezoid-saturated": OracleRun(
        model=2,
        motion=(
            "Trapezoid",
            (0.5, 0.2, -0.3),
            (-0.1, 0.6, 0.7),
            (3.0, 2.0, 5.0),
            (25.0, 15.0, 40.0),
        ),
        t_end=0.8,
        mass=15.0,
    ),
    "3-quintic": OracleRun(
        model=3,
        motion=("Quintic", BENT, (0.0, -0.2, 0.5, 1.0, -0.2, -0.3), 0.4),
        t_end=0.7,
        mass=9.0,
        position=ECCENTRIC,
    ),
    # Rotors 1 and 2 turn alike (-105 * 0.2 = -210 * 0.1): their dead zones open simultaneously.
    "3-trapezoid": OracleRun(
        model=3,
        motion=(
            "Trapezoid",
            AT_ZERO,
            (0.2, 0.1, -0.15, 0.3, 0.25, -0.4),
            (2.0,) * 6,
            (10.0,) * 6,
        ),
        t_end=0.6,
        mass=15.0,
        position=(-0.1, 0.0, 0.15),
    ),
    "3-hold": OracleRun(model=3, motion=("Hold", BENT), t_end=0.2, mass=12.0, position=ECCENTRIC),
    "3-hold-disturbed": OracleRun(
        model=3,
        motion=("Hold", BENT),
        t_end=0.6,
        mass=5.0,
        position=(0.0, 0.1, 0.25),
        start={
            "joint_angle": (0.302, -0.501, 0.803, 0.41, -0.61, 0.18),
            "joint_rate": (0.3, -0.2, 0.4, 0.0, 1.5, -2.0),
            "motor_torque": (1.0, -2.0, 3.0, 0.1, 0.0, -0.1),
        },
    ),
    "3-saturated": OracleRun(
        model=3,
        motion=("Quintic", AT_ZERO, (0.5, 0.3, -0.9, 1.5, 1.2, 2.0), 0.35),
        t_end=0.6,
        mass=15.0,
    ),
    "4-quintic": OracleRun(
        model=4,
        motion=("Quintic", (-0.4, 0.7, 0.2), (0.2, 0.3, -0.5), 0.5),
        t_end=0.9,
        mass=15.0,
        position=ECCENTRIC,
    ),
    "4-trapezoid": OracleRun(
        model=4,
        motion=(
            "Trapezoid",
            (0.0, 0.1, 0.2),
            (0.4, -0.3, 0.9),
            (1.5, 1.0, 2.5),
            (8.0, 6.0, 15.0),
        ),
        t_end=0.8,
        mass=2.0,
    ),
    # The knots of this motion do not fall on samples; those of the next one do, its end included.
    "1-sampled": OracleRun(
        model=1,
        motion=("Trapezoid", BENT, (0.0, -0.3, 0.5, 0.6, -0.8, 0.5), (2.1,) * 6, (17.0,) * 6),
        t_end=0.35,
        mass=6.0,
        position=ECCENTRIC,
        options={"controller": "sampled"},
    ),
    "3-sampled": OracleRun(
        model=3,
        motion=(
            "Trapezoid",
            AT_ZERO,
            (0.2, -0.15, 0.3, -0.25, 0.3, 0.1),
            (1.5,) * 6,
            (12.5,) * 6,
        ),
        t_end=0.4,
        mass=10.0,
        options={"controller": "sampled"},
    ),
    "4-sampled": OracleRun(
        model=4,
        motion=("Quintic", (0.2, 0.4, -0.3), (0.0, 0.6, 0.1), 0.25),
        t_end=0.35,
        mass=12.0,
        options={"controller": "sampled", "table_1": {"T": 0.003, "K_V": (0.25,) * 6}},
    ),
    "4-external": OracleRun(
        model=4,
        motion=("Hold", (0.1, 0.5, -0.4)),
        t_end=0.2,
        mass=5.0,
        options={"controller": "external"},
        inputs={"command": (0.6, -0.9, 0.7)},
    ),
    "3-torques": OracleRun(
        model=3,
        motion=None,
        t_end=0.25,
        mass=4.0,
        position=ECCENTRIC,
        options={"controller": None},
        inputs={"motor_torque": swinging_torques},
    ),
    "1-mixed-coupling": OracleRun(
        model=1,
        motion=("Quintic", BENT, (-0.1, -0.2, 0.4, 1.2, -0.1, -0.9), 0.25),
        t_end=0.3,
        mass=8.0,
        options={
            "rotor_coupling": ("full", "simplified", "full", "simplified", "full", "simplified")
        },
    ),
    "3-full-coupling": OracleRun(
        model=3,
        motion=("Quintic", BENT, (0.1, -0.4, 0.9, 0.7, -0.4, -0.1), 0.3),
        t_end=0.45,
        mass=9.0,
        position=ECCENTRIC,
        options={"rotor_coupling": "full"},
    ),
    "3-full-coupling-disturbed": OracleRun(
        model=3,
        motion=("Hold", BENT),
        t_end=0.2,
        mass=5.0,
        position=(0.0, 0.1, 0.25),
        start={
            "joint_angle": (0.302, -0.501, 0.803, 0.41, -0.61, 0.18),
            "joint_rate": (0.3, -0.2, 0.4, 0.0, 1.5, -2.0),
            "motor_torque": (1.0, -2.0, 3.0, 0.1, 0.0, -0.1),
        },
        options={"rotor_coupling": "full"},
    ),
    "4-full-coupling": OracleRun(
        model=4,
        motion=("Hold", (0.1, 0.3, -0.2)),
        t_end=0.3,
        mass=7.0,
        start={
            "joint_angle": (0.11, 0.29, -0.19),
            "joint_rate": (-0.4, 0.3, 0.5),
            "motor_torque": (0.5, -1.0, 0.2),
        },
        options={"rotor_coupling": "full"},
    ),
    "3-mixed-coupling": OracleRun(
        model=3,
        motion=("Quintic", AT_ZERO, (0.15, 0.1, -0.3, 0.4, 0.3, -0.5), 0.25),
        t_end=0.35,
        mass=12.0,
        position=ECCENTRIC,
        options={
            "rotor_coupling": (
                "simplified",
                "simplified",
                "full",
                "simplified",
                "full",
                "simplified",
            )
        },
    ),
    "3-contact": OracleRun(
        model=3,
        motion=("Hold", BENT),
        t_end=0.25,
        mass=8.0,
        start={
            "joint_angle": (0.301, -0.4995, 0.802, 0.4, -0.6, 0.2),
            "joint_rate": (-0.3, 0.25, -0.3, 0.5, 0.0, 0.8),
        },
        options={"gear_damping": "contact"},
    ),
    "4-contact-coupled": OracleRun(
        model=4,
        motion=("Quintic", (0.0, 0.0, 0.1), (0.1, -0.06, -0.05), 0.2),
        t_end=0.3,
        mass=15.0,
        # With these rotor axes the gyroscopic terms do not cancel.
        options={
            "gear_damping": "contact",
            "rotor_coupling": "full",
            "table_3": {"rn": ("z", "x", "z", "z", "x", "z")},
        },
    ),
    # Rotors stick until the teeth of their moving arms land, and dampers begin to take torque.
    "4-contact-landing": OracleRun(
        model=4,
        motion=None,
        t_end=0.1,
        start={
            "joint_angle": (0.0, 0.0, 0.0),
            "joint_rate": (-1.0, 0.3, 0.2),
            "rotor_rate": (0.0, 0.0, 0.0),
        },
        options={"gear_damping": "contact", "controller": None},
    ),
    "2-six-arm": OracleRun(
        model=2,
        motion=("Quintic", (0.5, -0.4, 0.25), (0.0, -0.1, 0.8), 0.25),
        t_end=0.3,
        mass=10.0,
        position=ECCENTRIC,
        options={"arm": "six-arm"},
    ),
    "4-six-arm": OracleRun(
        model=4,
        motion=("Trapezoid", (0.3, 0.5, -0.6), (0.1, 0.7, -0.2), (2.0,) * 3, (15.0,) * 3),
        t_end=0.35,
        mass=6.0,
        options={"arm": "six-arm", "creep_rate": 0.0},
    ),
    "3-start-arm": OracleRun(
        model=3, motion=("Hold", BENT), t_end=0.2, mass=12.0, position=ECCENTRIC, start="arm"
    ),
    "3-parameters": OracleRun(
        model=3,
        motion=("Quintic", BENT, (0.1, -0.3, 0.6, 0.6, -0.4, 0.0), 0.2),
        t_end=0.35,
        mass=9.0,
        options={
            "table_1": {
                "p": (-90.0, 180.0, 70.0, -99.0, 75.0, -110.0),
                "K_S": (300.0,) * 6,
                "a": (0.05, 0.12, 0.2, 0.03, 0.05, 0.06),
                "b": (4.0,) * 6,
            },
            "table_2": {
                "b": (0.02, 0.03, 0.01),
                "c": (50.0, 12.0, 40.0),
                "d": (0.01, 0.02, 0.03),
                "rM_h": (0.5, 0.6, 0.8, 0.3, 0.45, 0.15),
                "friction": (
                    ((0.0, 0.4), (40.0, 0.45), (120.0, 0.6)),
                    ((0.0, 0.5), (130.0, 0.6), (360.0, 0.7)),
                    ((0.0, 0.7), (20.0, 0.72), (60.0, 0.85), (130.0, 0.9)),
                    ((0.0, 0.2), (300.0, 0.5)),
                    ((0.0, 0.35), (30.0, 0.4), (300.0, 0.5)),
                    ((0.0, 0.1), (360.0, 0.15)),
                ),
            },
            "table_3": {
                "arms": {1: {"I33": 2.0}, 4: {"mass": 25.0, "I13": 0.02}, 6: {"I33": 0.01}},
                "rJ": (1.5e-3, 1.0e-3, 2.0e-3, 2.0e-4, 1.5e-4, 5.0e-5),
                "gravity": 3.73,
            },
        },
    ),
    "3-pushed": OracleRun(
        model=3,
        motion=("Hold", BENT),
        t_end=0.3,
        mass=3.0,
        position=ECCENTRIC,
        inputs={"tip_force": growing_push},
    ),
    # The motion of section-10, too fast for the motors.
    "3-voltage-limit": OracleRun(
        model=3,
        motion=("Quintic", AT_ZERO, (1.0, 1.0, 0.6, -0.2, -0.15, -0.1), 0.8),
        t_end=0.4,
        mass=15.0,
        options={"voltage_limit": 10.0},
    ),
    "2-voltage-limit-sampled": OracleRun(
        model=2,
        motion=(
            "Trapezoid",
            (0.5, 0.2, -0.3),
            (-0.1, 0.6, 0.7),
            (3.0, 2.0, 5.0),
            (25.0, 15.0, 40.0),
        ),
        t_end=0.3,
        mass=15.0,
        options={"voltage_limit": 8.5, "controller": "sampled"},
    ),
}


def stored(name):
    """What the independent implementation gave: `events`, and signals at the run's `times`."""
    run = independent.Run()
    run.time = RUNS[name].times
    run.events = [tuple(event) for event in json.loads(EVENTS_FILE.read_text())[name]]
    with np.load(SIGNALS_FILE) as file:
        for signal in SIGNALS:
            setattr(run, signal, file[f"{name}/{signal}"])
    return run


def times_of(events):
    """Times of events [s]."""
    return np.array([event[0] for event in events])


def _compute(name):
    began = perf_counter()
    run = RUNS[name].simulate_independently()
    print(f"{name}: {len(run.events)} events, {perf_counter() - began:.0f} s", flush=True)
    return name, run


def _store(names):
    """Compute runs, and put them in the place of what is stored of them."""
    signals, events = {}, {}
    if set(names) != set(RUNS):
        events = json.loads(EVENTS_FILE.read_text())
        with np.load(SIGNALS_FILE) as file:
            signals = {key: file[key] for key in file}
    with ProcessPoolExecutor() as pool:
        for name, run in pool.map(_compute, names):
            events[name] = run.events
            signals.update({f"{name}/{signal}": getattr(run, signal) for signal in SIGNALS})
    lists = [
        f'"{name}": [\n' + ",\n".join(json.dumps(event) for event in events[name]) + "\n]"
        for name in RUNS
    ]
    EVENTS_FILE.write_text("{\n" + ",\n".join(lists) + "\n}\n")
    np.savez_compressed(SIGNALS_FILE, **signals)


if __name__ == "__main__":
    _store(sys.argv[1:] or list(RUNS))
