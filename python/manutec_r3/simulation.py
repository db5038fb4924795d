"""Simulating: a whole run, or step by step. Both are the same loop."""

from __future__ import annotations  # help() shows short names of types

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import get_args

import numpy as np

from . import _core
from .arguments import Floats, floats, number, numbers
from .build_info import build_info
from .errors import SimulationError, SimulationInterrupted
from .events import Event, Events
from .experiment import Experiment, Method, Setup
from .inputs import (
    Input,
    Inputs,
    braked,
    check_has_tip,
    force,
    gather,
    input_of,
    one_per_axis,
)
from .motion import Motion
from .result import Result, Run, Statistics
from .robot import Robot
from .signals import Signals

# Events later than this after the end of a motion lose digits: the integrating controllers hunt
# slowly for ever against friction and backlash (specification section 8) [s].
_SETTLING = 0.5

InputLike = Floats | Callable[[float], Floats] | Input


def simulate(
    robot: Robot,
    motion: Motion | None,
    t_end: float,
    *,
    rtol: float | None = None,
    method: Method | None = None,
    start: str | Floats | None = None,
    times: Floats | None = None,
    list_samples: bool = False,
    motor_torque: InputLike | None = None,
    command: InputLike | None = None,
    tip_force: InputLike | None = None,
    brakes: bool | Sequence[bool] = False,
    list_limits: bool = False,
    enforce_limits: bool = False,
    progress: Callable[[float, int], None] | None = None,
    _scenario: str = "",
) -> Result:
    """Simulate a robot that follows a motion.

    Parameters
    ----------
    robot : Robot
        What to simulate.
    motion : Motion or None
        Reference of its joint angles, with as many axes as the robot has; for three moving axes
        also six with axes 4 to 6 exactly zero. None only if no position controller follows it.
    t_end : float
        End of the run [s]; it begins at 0.
    rtol : float, optional
        Tolerance, relative to each state's nominal value as well as to its value. The default of
        each method is the loosest for which control errors and motor torques stay within 1e-6 of
        their range.
    method : {"exponential", "erk", "bdf"}, optional
        Exponential collocation, which propagates drives exactly; explicit Runge-Kutta, Verner's
        7(6), from ARKODE, which takes about six times the evaluations; or backward differentiation
        formulas from CVODE. Default: ``"erk"``, but ``"bdf"`` for a robot with stiff springs or
        dampers, which has no other.
    start : {"rotor", "arm"} or array_like (n_states,), optional
        At rest with the rotors, or with the arms, on the reference; or a state. Default: the
        rotors; in the Modelica variant the arms.
    times : array_like, optional
        Instants to record [s], besides the events; default: all steps of the integrator. They do
        not change its steps.
    list_samples : bool
        Whether the samples of a sampled controller stand in the table of events; they are always
        counted in the statistics.
    motor_torque : array_like (n_axes,), callable or Input, optional
        Torques [N m], motor side, of a robot without controller: held, or a function of time.
    command : array_like (n_axes,), callable or Input, optional
        What the rate controllers of a robot with ``controller="external"`` get [V].
    tip_force : array_like (3,), callable or Input, optional
        Force that acts on the load, in the world [N].
    brakes : bool or sequence of n_axes bools
        Axes 4 to 6 that are held by their brakes, from the start at rest; True: all of them.
    list_limits : bool
        Whether the excesses of ``result.limits`` are listed among the events, as events of the
        element ``limit``: from 0 to the side on which a limit is exceeded, and back.
    enforce_limits : bool
        Whether the result ends where a limit is exceeded first, at 0 s if the start does already;
        ``result.status`` says which limit, and ``result.limits`` are those that were reached there.
        Until then the run is the one without this option, bit by bit; the work beyond is done all
        the same, and counted in the statistics.
    progress : callable, optional
        Called now and then with the time reached [s] and the number of events so far.

    Returns
    -------
    Result

    Raises
    ------
    ValueError, TypeError
        What was wrong (argument, axis, unit), what was expected, what arrived.
    SimulationInterrupted
        If somebody presses Ctrl-C; it carries what was computed so far.
    SimulationError
        If the run cannot go on; it carries what was computed so far. With `enforce_limits`, only
        if no limit was exceeded before.

    Notes
    -----
    A result keeps every step, 1.6 kilobytes each and two thousand of them per second of robot;
    a `Simulator` keeps none.

    Examples
    --------
    >>> robot = r3.Robot(model=3, load=r3.Load(mass=15.0))
    >>> motion = r3.Quintic(start=[0] * 6, end=[1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
    >>> result = r3.simulate(robot, motion, t_end=1.5)
    >>> abs(result.motor_torque).max(axis=0).round(2)  # [N m], motor side
    array([2.81, 5.43, 7.04, 0.28, 1.2 , 0.17])
    >>> len(result.events)
    60

    Recorded at some instants, besides the events:

    >>> r3.simulate(robot, motion, t_end=1.5, times=[0.5, 1.0]).joint_angle.shape
    (122, 6)

    Without controllers motor torques are inputs, here a function of time:

    >>> free = r3.Robot(model=2, controller=None)
    >>> swinging = r3.simulate(free, None, t_end=0.1, motor_torque=lambda t: [np.sin(t), 0, 0])
    >>> swinging.motor_torque[-1].round(4)
    array([0.0998, 0.    , 0.    ])
    """
    t_end, instants = span(t_end, times)
    if progress is not None and not callable(progress):
        raise TypeError(
            f"progress: expected a function of time and number of events, got {progress!r}"
        )

    for name, value in (("list_limits", list_limits), ("enforce_limits", enforce_limits)):
        if not isinstance(value, bool):
            raise TypeError(f"{name}: expected True or False, got {value!r}")

    began = perf_counter()
    simulator = Simulator(
        robot,
        motion,
        rtol=rtol,
        method=method,
        start=start,
        list_samples=list_samples,
        motor_torque=motor_torque,
        command=command,
        tip_force=tip_force,
        brakes=brakes,
        _record=True,
    )
    core = simulator._compiled
    asked = Experiment(simulator._setup, t_end, instants, list_limits, enforce_limits, _scenario)

    def result(status: str = "completed") -> Result:
        free = result_of(asked, core, core.events(0), perf_counter() - began, status)
        told = free._listing_limits() if list_limits else free
        return told._until_limit() if enforce_limits else told

    def look_up(time: float) -> None:
        if progress is not None:
            progress(time, core.n_events)

    try:
        simulator._advance(t_end, include_end=False, look_up=look_up)
    except KeyboardInterrupt:
        raise SimulationInterrupted(
            core.time, result(f"interrupted at {core.time:.6g} s")
        ) from None
    except SimulationError as error:
        error.result = result(error.status)
        if enforce_limits and error.result.limits:
            return error.result
        raise
    return result()


def span(t_end: float, times: Floats | None) -> tuple[float, np.ndarray | None]:
    """Return the end of a run [s] and the instants to record, which lie before it."""
    t_end = number("t_end", t_end, "s")
    if t_end <= 0.0:
        raise ValueError(f"t_end: expected a time after the start at 0 s, got {t_end:g} s")
    if times is None:
        return t_end, None
    instants = np.atleast_1d(floats("times", times, "s")).ravel()
    outside = (instants < 0.0) | (instants > t_end)
    if outside.any():
        raise ValueError(
            f"times: expected instants from 0 to {t_end:g} s, got {instants[outside][0]:g} s"
        )
    return t_end, instants


def set_up(
    robot: Robot,
    motion: Motion | None,
    *,
    rtol: float | None = None,
    method: Method | None = None,
    start: str | Floats | None = None,
    list_samples: bool = False,
    brakes: bool | Sequence[bool] = False,
    **given: InputLike | None,
) -> Setup:
    """Check the arguments of a `Simulator`; what is not given becomes the default."""
    inputs, held = gather(robot, motion, given)
    _ = inputs._compiled  # refuses a motion that the robot cannot follow
    if not isinstance(list_samples, bool):
        raise TypeError(f"list_samples: expected True or False, got {list_samples!r}")
    method = _method(robot, method)
    if rtol is None:
        rtol = _core.default_tolerance(_core.Method[method])
    rtol = number("rtol", rtol, "1")
    if not 1e-14 <= rtol <= 1e-2:
        raise ValueError(f"rtol: expected a tolerance from 1e-14 to 1e-2, got {rtol:g}")
    begin = _start(robot, start)
    return Setup(inputs, held, braked(brakes, robot.n_axes), begin, method, rtol, list_samples)


def _start(robot: Robot, start: str | Floats | None) -> str | np.ndarray:
    """Return what rests on the reference, or a state vector that the robot can have."""
    if start is None:
        return _core.default_start(robot._compiled)
    if isinstance(start, str):
        return start
    state = numbers("start", start, "'rotor', 'arm' or a state vector")
    if state.ndim != 1:
        raise ValueError(
            f"start: expected a state vector of {robot.n_states} values, got shape {state.shape}"
        )
    robot._compiled.check_state(state)
    return state


def result_of(
    experiment: Experiment,
    core: _core.Simulator | _core.Outcome,
    events: list[tuple],
    seconds: float,
    status: str,
) -> Result:
    """Return the result of a run that the core has recorded."""
    return Result(
        Run(experiment, build_info(), core.trajectory),
        Events(Event(*event) for event in events),
        Statistics(**core.statistics, seconds=seconds),
        core.time,
        status,
    )


@dataclass(frozen=True)
class SavedState:
    """Where a `Simulator` was; see `Simulator.save`.

    Attributes
    ----------
    time : float
        When it was saved [s].
    """

    time: float
    of: tuple[Inputs, Method, float] = field(repr=False)
    core: _core.Snapshot = field(repr=False)
    untold: tuple[Event, ...] = field(repr=False)


class Simulator(Signals):
    """A robot that is simulated step by step.

    Every signal of a result is an attribute here, at the present instant, as an array (n_axes,).
    How often and where one stops to look does not change the steps of the integrator.

    Parameters
    ----------
    robot : Robot
        What to simulate.
    motion : Motion, optional
        Reference of its joint angles; may be missing only if no
        position controller follows it.
    rtol, method, start, list_samples, motor_torque, command, tip_force, brakes
        As in `simulate`. Branches are decided from the start by physics. Samples that are not
        listed do not end `step_to_event`.

    Examples
    --------
    >>> motion = r3.Quintic(start=[0] * 6, end=[0.5] * 6, duration=1.0)
    >>> simulator = r3.Simulator(r3.Robot(model=3), motion)
    >>> event = simulator.step_to_event()
    >>> event.element, event.axis, event.time == simulator.time
    ('dead_zone', 4, True)
    >>> simulator.branches["friction"]
    array([0, 0, 0, 0, 0, 0], dtype=int8)
    >>> events = simulator.step(0.1)
    >>> simulator.joint_angle.shape
    (6,)

    A controller of one's own, every 8 ms:

    >>> robot = r3.Robot(model=3, controller="external")
    >>> simulator = r3.Simulator(robot, motion)
    >>> while simulator.time < 0.08:
    ...     simulator.command = 30.0 * simulator.control_error  # [V]
    ...     events = simulator.step(8e-3)
    """

    __slots__ = ("_compiled", "_setup", "_untold", "inputs", "method", "rtol")

    def __init__(
        self,
        robot: Robot,
        motion: Motion | None = None,
        *,
        rtol: float | None = None,
        method: Method | None = None,
        start: str | Floats | None = None,
        list_samples: bool = False,
        motor_torque: InputLike | None = None,
        command: InputLike | None = None,
        tip_force: InputLike | None = None,
        brakes: bool | Sequence[bool] = False,
        _record: bool = False,
    ) -> None:
        setup = set_up(
            robot,
            motion,
            rtol=rtol,
            method=method,
            start=start,
            list_samples=list_samples,
            motor_torque=motor_torque,
            command=command,
            tip_force=tip_force,
            brakes=brakes,
        )
        self._setup = setup
        self.inputs, self.method, self.rtol = setup.inputs, setup.method, setup.rtol
        state = setup.start
        if isinstance(state, str):
            state = robot.rest_state(motion, state)
        self._untold: list[Event] = []  # events that have happened and nobody has been told of
        try:
            self._compiled = _core.Simulator(
                robot._compiled,
                self.inputs._compiled,
                state,
                self.rtol,
                _core.Method[self.method],
                _record,
                setup.list_samples,
            )
        except _core.SimulationFailure as failure:
            raise SimulationError(0.0, state, {}, str(failure)) from None
        if setup.held.of_axes is not None:
            self._set(self._compiled.set_input, setup.held.of_axes)
        if setup.held.tip_force is not None:
            self._set(self._compiled.set_tip_force, setup.held.tip_force)
        if any(setup.brakes):
            self.brakes = brakes

    @property
    def robot(self) -> Robot:
        """What is simulated."""
        return self.inputs.robot

    @property
    def motion(self) -> Motion | None:
        """Reference of its joint angles."""
        return self.inputs.motion

    # --- the present instant --------------------------------------------------------------------

    @property
    def time(self) -> float:
        """The present instant [s]."""
        return self._compiled.time

    @property
    def state(self) -> np.ndarray:
        """State (n_states,), after the events of this instant."""
        return self._compiled.state

    @property
    def branches(self) -> dict[str, np.ndarray]:
        """Branches (n_axes,) of each element, such as ``friction``: -1, 0, +1."""
        branches = self._compiled.branches
        return {name: branches[name] for name in self.robot._compiled.elements}

    @property
    def statistics(self) -> dict[str, int]:
        """Evaluations, steps, rejected steps, events, restarts and samples so far."""
        return self._compiled.statistics

    @property
    def _signals(self) -> np.ndarray:
        return self._compiled.signals

    @property
    def _energies(self) -> np.ndarray:
        return self._compiled.energies

    @property
    def motor_torque(self) -> np.ndarray:
        """Motor torques `rF` (n_axes,) [N m], motor side.

        Without a controller they are inputs: held until they are set again, zero at first. Setting
        them is an event at the present instant; branches are decided again at once.
        """
        return self._signal("motor_torque")

    @motor_torque.setter
    def motor_torque(self, torque: Floats) -> None:
        self._set_input_of_axes("motor_torque", torque)

    @property
    def command(self) -> np.ndarray:
        """Commands `u_c` to the rate controllers (n_axes,) [V].

        With ``controller="external"`` they are inputs: held until they are set again, zero at
        first. With ``"sampled"`` they are what was made of the latest sample.
        """
        return self._signal("command")

    @command.setter
    def command(self, command: Floats) -> None:
        self._set_input_of_axes("command", command)

    @property
    def tip_force(self) -> np.ndarray:
        """Force on the load (3,), in the world [N]: held until it is set again, zero at first."""
        function = self.inputs.tip_force
        return np.array(function(self.time)) if function else self._compiled.tip_force

    @tip_force.setter
    def tip_force(self, value: Floats) -> None:
        if self.inputs.tip_force is not None:
            raise AttributeError("tip_force: it is a function of time and cannot be set")
        check_has_tip(self.robot)
        self._set(self._compiled.set_tip_force, force(value))

    @property
    def brakes(self) -> np.ndarray:
        """Which axes are held by their brakes (n_axes,): axes 4 to 6 have some.

        They can be put on axes at rest only. All of them put on at zero angles turn model 3 into
        model 4, and model 1 into model 2, with the data of six arms.
        """
        return np.array(self._compiled.brakes)

    @brakes.setter
    def brakes(self, brakes: bool | Sequence[bool]) -> None:
        self._set(self._compiled.set_brakes, braked(brakes, self.robot.n_axes))

    def _set_input_of_axes(self, name: str, values: Floats) -> None:
        expected, unit = input_of(self.robot) or ("", "")
        if name != expected:
            needed = {"motor_torque": "None", "command": "'external'"}[name]
            raise AttributeError(
                f"{name}: expected a robot with controller={needed} to set it, "
                f"got controller={self.robot.controller!r}"
            )
        if self.inputs.of_axes is not None:
            raise AttributeError(f"{name}: it is a function of time and cannot be set")
        self._set(self._compiled.set_input, one_per_axis(name, values, unit, self.robot.n_axes))

    def _set(self, setter: Callable, value: object) -> None:
        told = self._compiled.n_events
        setter(value)
        self._untold += [Event(*event) for event in self._compiled.events(told)]

    # --- advancing ------------------------------------------------------------------------------

    def step(self, dt: float) -> list[Event]:
        """Advance by `dt` [s], through every event on the way.

        Returns
        -------
        list of Event
            The events it met, up to and including the new instant.

        Raises
        ------
        ValueError
            If `dt` is negative or not finite.
        SimulationError
            If the run cannot go on; the simulator stays where it came to.
        """
        dt = number("dt", dt, "s")
        if dt < 0.0:
            raise ValueError(f"dt: expected a time that is not negative, got {dt:g} s")
        self._advance(self.time + dt, include_end=True)
        events, self._untold = self._untold, []
        return events

    def step_to_event(self, t_end: float | None = None) -> Event | None:
        """Advance to the next event, or to `t_end` if there is none before.

        Of several events at one instant the first is returned; the others follow one by one,
        without advance.

        Parameters
        ----------
        t_end : float, optional
            Where to stop looking [s]. Default: 0.5 s after the end of the motion; later the robot
            hunts slowly for ever.

        Returns
        -------
        Event or None
            None if `t_end` was reached.

        Raises
        ------
        ValueError
            If `t_end` lies before the present instant, or is missing without a motion.
        SimulationError
            If the run cannot go on.
        """
        if t_end is None:
            if self.motion is None:
                raise ValueError("t_end: expected a time [s] to stop at, as there is no motion")
            t_end = max(self.time, self.motion.duration + _SETTLING)
        t_end = number("t_end", t_end, "s")
        if t_end < self.time:
            raise ValueError(
                f"t_end: expected a time not before the present {self.time:g} s, got {t_end:g} s"
            )
        if not self._untold:
            self._advance(t_end, include_end=False, stop_at_event=True)
        return self._untold.pop(0) if self._untold else None

    def _advance(
        self,
        target: float,
        *,
        include_end: bool,
        stop_at_event: bool = False,
        look_up: Callable[[float], None] | None = None,
    ) -> None:
        core = self._compiled
        met = core.n_events
        try:
            core.advance(target, stop_at_event, include_end, look_up)
        except _core.SimulationFailure as failure:
            raise SimulationError(core.time, core.state, self.branches, str(failure)) from None
        finally:
            self._untold += [Event(*event) for event in core.events(met)]

    # --- saving ---------------------------------------------------------------------------------

    def save(self) -> SavedState:
        """Return everything that the future depends on; give it to `restore`."""
        return SavedState(
            self.time,
            (self.inputs, self.method, self.rtol),
            self._compiled.save(),
            tuple(self._untold),
        )

    def restore(self, saved: SavedState) -> None:
        """Go back to where `save` was called, on this simulator or one like it.

        What follows is bit-identical to what followed then, but for ``"bdf"``, which restarts at
        order 1.

        Raises
        ------
        TypeError, ValueError
            If this is no saved state, or one of another robot, motion, method or rtol.
        """
        if not isinstance(saved, SavedState):
            raise TypeError(f"saved: expected what save() returned, got {saved!r}")
        expected, got = _identity(self.inputs, self.method, self.rtol), _identity(*saved.of)
        for name, value in expected.items():
            if got[name] != value:
                raise ValueError(
                    f"saved: expected a state of a simulator with {name} {value!r}; "
                    f"got one with {name} {got[name]!r}"
                )
        self._compiled.restore(saved.core)
        self._untold = list(saved.untold)

    def __repr__(self) -> str:
        return f"<Simulator of model {self.robot.model} at {self.time:g} s>"


def _identity(inputs: Inputs, method: Method, rtol: float) -> dict[str, object]:
    """Return what simulators have in common if one can restore what another has saved."""
    of_axes, _ = input_of(inputs.robot) or ("", "")
    return {
        "robot": inputs.robot,
        "motion": inputs.motion,
        of_axes: inputs.of_axes,
        "tip_force": inputs.tip_force,
        "method": method,
        "rtol": rtol,
    }


def _method(robot: Robot, method: Method | None) -> Method:
    """Return the method asked for, or the robot's own."""
    is_stiff = robot.stiction != "exact"
    if method is None:
        return "bdf" if is_stiff else "erk"
    if method not in get_args(Method):
        names = ", ".join(map(repr, get_args(Method)))
        raise ValueError(f"method: expected one of {names}, got {method!r}")
    if is_stiff and method != "bdf":
        raise ValueError(
            f"method: expected 'bdf' for stiction={robot.stiction!r}, which is stiff, "
            f"got {method!r}"
        )
    return method
