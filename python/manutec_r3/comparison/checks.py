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

from ..arguments import Floats
from ..result import Result, Samples
from ..robot import Load, Robot
from ..scenario import Scenario
from .results import curve_of

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
        Accelerations and holding torques of the arm; peaks and events of the benchmark run, its
        balance of energy; signals and modes of friction of the Modelica variant.

    Examples
    --------
    >>> checks = r3.check()
    >>> checks[1].what
    'torques that hold arm 2 of model 2 level with 15 kg [N m]'
    >>> checks[1].source, checks[1].expected, checks[1].found
    ('data of R3M2SI', '0.0 -746.7 -263.7', '0.0 -746.7 -263.7')
    >>> all(one.passed for one in checks)
    True
    """
    figure9 = _reference("figure9_quintic")
    one_axis = _reference("one_axis")
    full_robot = _reference("full_robot")
    run, run_of_axis, run_of_robot = (
        Scenario.load(reference["scenario"]).run() for reference in (figure9, one_axis, full_robot)
    )
    return [
        _accelerations(_reference("r3m2si")),
        _holding_torques(_reference("holding")),
        _peaks(run, figure9, "control_error", unit="mrad", per_si=1e3),
        _peaks(run, figure9, "motor_torque", unit="N m", per_si=1.0),
        _events(run, figure9),
        _energy(run, figure9),
        _one_axis(run_of_axis, one_axis),
        _friction_changes(run_of_axis, one_axis),
        _friction_counts(run_of_robot, full_robot),
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
    expected: Floats,
    found: Floats,
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


def _list(values: Floats, digits: int) -> str:
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


def _one_axis(run: Result, reference: Mapping[str, Any]) -> Check:
    """Signals and states of the one axis at some instants, relative to their ranges.

    What is published of it stands by the name of a signal, or of a state's quantity.
    """
    published = reference["at_instants"]
    now = run.at(published["time"])
    errors = {}
    for name, (lowest, highest) in reference["range"].items():
        found = _quantity(now, run.robot, name)
        errors[name] = float(np.abs(found - published[name]).max() / (highest - lowest))
    worst = max(errors, key=errors.__getitem__)
    return Check(
        f"{len(errors)} signals of {reference['scenario']} at {len(now)} instants",
        "Modelica Association, OneAxis",
        "the same",
        f"{worst.replace('_', ' ')} within {errors[worst]:.1g} of its range, others closer",
        errors[worst],
        1e-5,  # the published run was made with a tolerance of 1e-6
    )


def _quantity(now: Samples, robot: Robot, name: str) -> np.ndarray:
    """Return a signal or state of axis 1, or how fast its gear is deflected."""
    if name == "deflection_rate":
        return (now.rotor_rate - _ratio(robot) * now.joint_rate)[:, 0]
    return curve_of(now, robot, name, 1)


def _friction_changes(run: Result, reference: Mapping[str, Any]) -> Check:
    """Modes of friction of the one axis, and when they change."""
    published = reference["friction_changes"]
    expected = list(zip(*(published[key] for key in ("time", "before", "after")), strict=True))
    found = [(e.time, e.before, e.after) for e in run.events if e.element == "friction"]
    same = [modes for _, *modes in found] == [modes for _, *modes in expected]
    apart = [abs(ours[0] - theirs[0]) for ours, theirs in zip(found, expected, strict=same)]
    return Check(
        f"friction modes of {reference['scenario']}, from [s] on",
        "Modelica Association, OneAxis",
        _modes(expected),
        _modes(found),
        max(apart, default=0.0) if same else np.inf,
        1e-6,  # of a second, the tolerance of the published run
    )


def _modes(changes: Sequence[tuple[float, int, int]]) -> str:
    """Each mode with the instant at which it begins, on a line of its own."""
    modes = {-1: "backward", 0: "sticking", 1: "forward"}
    return "\n".join(f"{time:.6f} {modes[after]}" for time, _, after in changes)


def _friction_counts(run: Result, reference: Mapping[str, Any]) -> Check:
    """How often the friction of each axis of the whole robot changes its mode."""
    expected = reference["friction_changes"]
    axes = run.events.axis[run.events.element == "friction"]
    found = [int(np.sum(axes == axis)) for axis in range(1, run.robot.n_axes + 1)]
    return Check(
        f"changes of friction modes of {reference['scenario']}, on axes 1 to 6",
        "an independent model",
        f"{sum(expected)}: {_list(expected, 0)}",
        f"{sum(found)}: {_list(found, 0)}",
        float(np.abs(np.subtract(found, expected)).sum()),
        0.0,
    )
