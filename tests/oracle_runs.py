"""Runs that both implementations know; what the independent one gives is stored in `data`.

It takes minutes, so it is kept: `python tests/oracle_runs.py` computes all of it again,
`python tests/oracle_runs.py <name> ...` some of it. The stored runs are accurate to about 1e-12 s
in event times: far below what they are to decide about.
"""

import json
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
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
    motion : tuple
        Name of the motion and its arguments: the same in both implementations.
    t_end : float
        End [s].
    mass, position : float, tuple
        The load [kg, m].
    start : dict or None
        Arguments of `state_from`; None for the default start at rest.
    """

    model: int
    motion: tuple
    t_end: float
    mass: float = 0.0
    position: tuple = (0.0, 0.0, 0.25)
    start: dict | None = None

    @property
    def times(self):
        """Instants at which signals are compared, none of them special."""
        return np.linspace(0.0, self.t_end, 42)[1:-1]

    @property
    def robot(self):
        """The package's robot."""
        return r3.Robot(model=self.model, load=r3.Load(self.mass, self.position))

    @property
    def independent_robot(self):
        """The independent implementation's robot."""
        return independent.IndependentRobot(self.model, self.mass, self.position)

    def _motion(self, module):
        kind, *arguments = self.motion
        return getattr(module, kind)(*arguments)

    def simulate(self, t_end=None, **options):
        """Simulate by the package; options as of `manutec_r3.simulate`."""
        robot = self.robot
        if self.start is not None:
            options["start"] = robot.state_from(**self.start)
        return r3.simulate(robot, self._motion(r3), t_end or self.t_end, **options)

    def simulator(self, **options):
        """Step by step by the package; options as of `manutec_r3.Simulator`."""
        robot = self.robot
        if self.start is not None:
            options["start"] = robot.state_from(**self.start)
        return r3.Simulator(robot, self._motion(r3), **options)

    def simulate_independently(self, t_end=None, rtol=1e-12):
        """Simulate by the independent implementation."""
        robot = self.independent_robot
        start = None if self.start is None else robot.state_from(**self.start)
        t_end = t_end or self.t_end
        times = self.times[self.times <= t_end]
        return independent.simulate(robot, self._motion(independent), t_end, rtol, times, start)


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


def sequence(events):
    """Events without their times: (axis, element, before, after)."""
    return [tuple(event)[1:] for event in events]


def times_of(events):
    """Times of events [s]."""
    return np.array([event[0] for event in events])


def ranges(values):
    """Range of each axis, at least 1e-3 of the largest axis': what errors are relative to."""
    extent = np.ptp(values, axis=0)
    return np.maximum(extent, 1e-3 * extent.max())


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
