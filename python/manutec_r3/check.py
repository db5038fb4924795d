"""Published numbers, computed again on this machine, beside what is published.

What is expected lies in the folder `references`, with its sources.
"""

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.resources import files
from typing import Any, NamedTuple

import numpy as np

from .compare import curve_of
from .result import Result, Samples
from .robot import Load, Robot
from .scenario import Scenario

_FOLDER = files(__package__) / "references"


class Check(NamedTuple):
    """A published number, or several, beside what this machine computes.

    Attributes
    ----------
    what, source : str
        What is computed, and who says what comes out.
    expected, found : str
        Both in words, with units.
    deviation : float
        How far apart they are, in the unit of `tolerance`.
    tolerance : float
        How far apart they may be.
    """

    what: str
    source: str
    expected: str
    found: str
    deviation: float
    tolerance: float

    @property
    def passed(self) -> bool:
        """Whether what is found is as expected."""
        return bool(self.deviation <= self.tolerance)


def check() -> list[Check]:
    """Compute published numbers on this machine, and compare.

    Returns
    -------
    list of Check
        Accelerations and holding torques of the arm, peaks and events of the benchmark run, its
        balance of energy.
    """
    figure9 = _reference("figure9_quintic")
    run = Scenario.load(figure9["scenario"]).run()
    return [
        _accelerations(_reference("r3m2si")),
        _holding_torques(_reference("holding")),
        _peaks(run, figure9, "control_error", unit="mrad", per_si=1e3),
        _peaks(run, figure9, "motor_torque", unit="N m", per_si=1.0),
        _events(run, figure9),
        _energy(run, figure9),
    ]


def _reference(name: str) -> dict[str, Any]:
    return json.loads((_FOLDER / f"{name}.json").read_text(encoding="utf-8"))


# --- the arm ------------------------------------------------------------------------------------


def _accelerations(reference: Mapping[str, Any]) -> Check:
    """Accelerations of model 2, relative to the largest of each case (specification section 10)."""
    errors = []
    for case in reference["cases"]:
        robot = Robot(model=2, load=Load(case["load_mass"]))
        qdd = robot.forward_dynamics(case["q"], case["qd"], case["tau"])
        errors.append(np.abs(qdd - case["qdd"]).max() / np.abs(case["qdd"]).max())
    return Check(
        f"joint accelerations of model 2 in {len(errors)} cases",
        "routine R3M2SI, 1988",
        "the same",
        f"the same within {max(errors):.1g} of the largest",
        max(errors),
        1e-12,  # roundoff of a 3 by 3 solve, with room for the conditioning of M
    )


def _holding_torques(reference: Mapping[str, Any]) -> Check:
    """Torques against gravity alone, to the printed digits (specification section 3)."""
    at_rest = np.zeros(3)
    robot = Robot(model=2, load=Load(reference["load_mass"]))
    tau = robot.inverse_dynamics(reference["q"], at_rest, at_rest)
    return _printed(
        "torques that hold arm 2 of model 2 level with 15 kg [N m]",
        "data of R3M2SI",
        reference["tau"],
        tau,
        digits=1,
    )


def _printed(
    what: str,
    source: str,
    expected: Sequence[float],
    found: Sequence[float],
    digits: int,
) -> Check:
    """Compare values with printed ones: they may differ by half of the last digit."""
    return Check(
        what,
        source,
        _list(expected, digits),
        _list(found, digits),
        float(np.abs(np.subtract(found, expected)).max()),
        0.5 * 10.0**-digits * (1.0 + 1e-9),  # a printed value itself is rounded to binary
    )


def _list(values: Sequence[float], digits: int) -> str:
    # Adding zero makes a zero of either sign a positive one.
    return " ".join(f"{np.round(value, digits) + 0.0:.{digits}f}" for value in values)


# --- the benchmark run --------------------------------------------------------------------------


def _peaks(
    run: Result, reference: Mapping[str, Any], signal: str, unit: str, per_si: float
) -> Check:
    """Largest magnitudes of a signal, to the printed digits (specification section 10)."""
    return _printed(
        f"peak {signal.replace('_', ' ')}s of {reference['scenario']} [{unit}]",
        "two independent models",
        np.multiply(per_si, reference[signal]),
        per_si * np.abs(getattr(run, signal)).max(axis=0),
        digits=2,
    )


def _events(run: Result, reference: Mapping[str, Any]) -> Check:
    """Count events of each element (specification section 10)."""
    expected, found = Counter(reference["events"]), Counter(map(str, run.events.element))
    wrong = (expected - found) + (found - expected)
    return Check(
        f"events of {reference['scenario']}",
        "two independent models",
        _counts(expected),
        _counts(found),
        float(wrong.total()),
        0.0,
    )


def _counts(counts: Counter) -> str:
    kinds = ", ".join(f"{n} {element.replace('_', ' ')}" for element, n in counts.most_common())
    return f"{counts.total()}: {kinds}"


def _energy(run: Result, reference: Mapping[str, Any]) -> Check:
    """Balance of energy at all steps, relative to what went through the motors.

    Work of the motors = friction + damping + change of kinetic, potential and elastic energy.
    """
    steps = np.unique(run.time)
    work = work_until(run, steps, partial(_powers, run.robot))
    stored = _stored(run.robot, run.at(steps))
    taken = work["friction"] + work["damping"] + work["gravity"] + (stored - stored[0])
    gap = np.abs(work["motors"] - taken).max()
    return Check(
        f"work of the motors in {reference['scenario']}",
        "conservation of energy",
        f"{taken[-1]:.6f} J lost and stored",
        f"{work['motors'][-1]:.6f} J",
        float(gap / work["turned_over"][-1]),
        2e-10,  # ten times what the integrator's default tolerance leaves
    )


def work_until(
    run: Result, steps: np.ndarray, powers: Callable[[Samples], Mapping[str, np.ndarray]]
) -> dict[str, np.ndarray]:
    """Integrate powers (n, n_axes) [W] up to each step of a run: works (n_steps,) [J].

    Inside the steps all signals are smooth: five points of Gauss in each integrate polynomials of
    degree 9, and eight change nothing.
    """
    points, weights = np.polynomial.legendre.leggauss(5)
    half = np.diff(steps)[:, None] / 2.0
    inside = steps[:-1, None] + half * (1.0 + points)
    works = {}
    for name, power in powers(run.at(inside.ravel())).items():
        in_steps = (half * weights * power.sum(axis=1).reshape(inside.shape)).sum(axis=1)
        works[name] = np.concatenate(([0.0], np.cumsum(in_steps)))
    return works


def _powers(robot: Robot, now: Samples) -> dict[str, np.ndarray]:
    """Powers of the motors, and what friction, damping and gravity take."""
    damping = np.array(robot.parameters["table_2"]["d"])
    deflection_rate = now.rotor_rate - _ratio(robot) * now.joint_rate
    at_rest = np.zeros_like(now.joint_angle)
    holding = robot.inverse_dynamics(now.joint_angle, at_rest, at_rest)
    motors = now.motor_torque * now.rotor_rate
    return {
        "motors": motors,
        "turned_over": np.abs(motors),
        "friction": now.friction_torque * now.rotor_rate,
        "damping": damping * deflection_rate[:, : len(damping)] ** 2,
        "gravity": holding * now.joint_rate,
    }


def _stored(robot: Robot, now: Samples) -> np.ndarray:
    """Kinetic and elastic energy (n,) [J]; that against gravity is the work done against it."""
    gears = robot.parameters["table_2"]
    stiffness, backlash = np.array(gears["c"]), np.array(gears["b"])
    elastic = slice(len(stiffness))  # axes with elastic gears
    inertia = np.array(robot.parameters["table_3"]["rJ"])[elastic]
    # In the mass matrix gears are ideal; rotors behind elastic ones turn at rates of their own.
    lumped = np.zeros(robot.n_axes)
    lumped[elastic] = _ratio(robot)[elastic] ** 2 * inertia
    matrix = robot.mass_matrix(now.joint_angle) - np.diag(lumped)
    arm = np.einsum("ki,kij,kj->k", now.joint_rate, matrix, now.joint_rate) / 2.0
    rotors = now.rotor_rate[:, elastic] ** 2 @ inertia / 2.0
    deflection = (now.rotor_angle - _ratio(robot) * now.joint_angle)[:, elastic]
    springs = np.maximum(np.abs(deflection) - backlash, 0.0) ** 2 @ stiffness / 2.0
    return arm + rotors + springs


def _ratio(robot: Robot) -> np.ndarray:
    return np.array(robot.parameters["table_1"]["p"])[: robot.n_axes]


# --- the Modelica variant -----------------------------------------------------------------------


def _one_axis(run: Result, figures: Mapping[str, Sequence[float]]) -> Check:
    """Signals and states of axis 1 at some instants, relative to their ranges.

    `figures` has lists of equal length: ``time`` [s], and by the name of a signal, or of a state's
    quantity, its values there in SI units.
    """
    now = run.at(figures["time"])
    errors = {}
    for signal, expected in figures.items():
        if signal != "time":
            found = curve_of(now, run.robot, signal, 1)
            errors[signal] = float(np.abs(found - expected).max() / np.ptp(expected))
    worst = max(errors, key=errors.get)
    return Check(
        f"{len(errors)} signals of OneAxis at {len(now)} instants",
        "Modelica Association, 2020",
        "the same",
        f"{worst.replace('_', ' ')} within {errors[worst]:.1g} of its range, others closer",
        errors[worst],
        5e-5,  # ten times what an independent implementation leaves: the reference's tolerance
    )
