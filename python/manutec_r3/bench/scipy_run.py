"""The same run by SciPy: `solve_ivp` from Python, on our right-hand side, with its own events.

Between events branches are frozen. One event function, the least of all indicators, ends a part of
the run; the robot decides the new branches, and the next part begins. What it has just decided
counts as positive: an indicator that begins at zero is lifted a little, or its root were found for
ever.
"""

from dataclasses import dataclass

import numpy as np
from scipy import __version__ as version
from scipy.integrate import solve_ivp

from .. import _core
from ..events import Event
from ..inputs import gather
from ..scenario import Scenario
from ..signals import signal_names

__all__ = ["METHOD", "SciPyRun", "run", "version"]


METHOD = "DOP853"  # explicit Runge-Kutta, of order 8
_LIFTED = 1e-12  # in the units of indicators, V, N m, rad and rad/s


@dataclass(frozen=True)
class SciPyRun:
    """What came out.

    Attributes
    ----------
    time : ndarray (n,)
        Steps of the integrator [s].
    control_error, motor_torque : ndarray (n, n_axes)
        Signals there [rad, N m].
    events : list of Event
        Samples are left out.
    evaluations, steps : int
        Of the right-hand side; accepted.
    """

    time: np.ndarray
    control_error: np.ndarray
    motor_torque: np.ndarray
    events: list[Event]
    evaluations: int
    steps: int


def run(scenario: Scenario, rtol: float) -> SciPyRun:
    """Simulate a scenario.

    Parameters
    ----------
    scenario : Scenario
        With a start at rest and without inputs.
    rtol : float
        Tolerance, relative to each state's nominal value as well as to its value.
    """
    robot, motion, t_end = scenario.robot, scenario.motion, scenario.t_end
    inputs, _ = gather(robot, motion, {})
    system = _core.System(robot._compiled, inputs._compiled)

    def rates(t: float, x: np.ndarray) -> np.ndarray:
        return system.derivatives(t, x)[0]

    def indicators(t: float, x: np.ndarray) -> np.ndarray:
        return system.indicators(t, x)[0]

    def leaves_domain(t: float, x: np.ndarray) -> float:
        return (indicators(t, x) + lift).min()

    leaves_domain.terminal = True  # type: ignore[attr-defined] # as SciPy wants it
    leaves_domain.direction = -1  # type: ignore[attr-defined]

    at_rest = robot.rest_state(motion, scenario.start)  # type: ignore[arg-type]
    t, x = 0.0, system.initialise(0.0, at_rest)
    times, signals, events, evaluations = [], [], [], 0
    while True:
        lift = np.maximum(0.0, _LIFTED - indicators(t, x))
        stop = min(system.next_time_event(t), t_end)
        part = solve_ivp(
            rates,
            (t, stop),
            x,
            method=METHOD,
            rtol=rtol,
            atol=rtol * robot.state_nominals,
            events=leaves_domain,
        )
        t, x = part.t[-1], part.y[:, -1]
        evaluations += part.nfev
        times.append(part.t)
        signals.append(system.signals(part.t, part.y.T.copy()))
        is_due = part.status == 0  # `stop` has come
        if is_due and stop == t_end:
            break
        fired = [] if is_due else [int((indicators(t, x) + lift).argmin())]
        x, switched = system.handle_event(t, x, fired, is_due)
        events += [Event(t, *change) for change in switched if change[1] != "sample"]

    time = np.concatenate(times)
    values = np.concatenate(signals).reshape(len(time), -1, robot.n_axes)
    error, torque = (
        values[:, signal_names.index(name)] for name in ("control_error", "motor_torque")
    )
    steps = len(time) - len(times)
    return SciPyRun(time, error, torque, events, evaluations, steps)
