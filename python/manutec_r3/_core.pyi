"""The compiled core. Private: the package wraps it, checks what users pass, and documents it.

Arrays are C-contiguous, of float64 unless something else is said. N: number of axes of the robot.
Arguments have no names there: those below say what they are.
"""

from collections.abc import Callable, Sequence
from enum import Enum
from typing import Any

from numpy import float64, int8, int32, int64
from numpy.typing import NDArray

_Floats = NDArray[float64]

# How this build was made.
processor: str
compiler: str
compiler_flags: str
eigen_version: str
sundials_version: str

def forget_propagators() -> None: ...

# Name, unit and description of each.
signals: tuple[tuple[str, str, str], ...]
energies: tuple[tuple[str, str, str], ...]
axis_elements: tuple[str, ...]

_Model = int | str
_Tables = dict[str, dict[str, Any]]

def default_tables(model: _Model, /) -> _Tables: ...
def table_units(model: _Model, /) -> dict[str, dict[str, str]]: ...
def default_load(model: _Model, /) -> Load: ...
def default_start(robot: Robot, /) -> str: ...

class Load:
    def __init__(self, mass: float, position: Sequence[float], bounds: bool, /) -> None: ...
    @property
    def mass(self) -> float: ...
    @property
    def position(self) -> list[float]: ...
    @property
    def bounds(self) -> bool: ...

class SimulationFailure(RuntimeError): ...

class Method(Enum):
    erk = ...
    bdf = ...
    exponential = ...

def default_tolerance(method: Method, /) -> float: ...

class Motion:
    @property
    def n_axes(self) -> int: ...
    @property
    def duration(self) -> float: ...
    @property
    def knots(self) -> _Floats: ...
    def reference(self, t: _Floats, /) -> tuple[_Floats, _Floats]:
        """Angle and rate (n, n_axes) at `t` (n,)."""

    def acceleration(self, t: _Floats, /) -> _Floats:
        """Acceleration (n, n_axes) at `t` (n,)."""

def quintic(start: Sequence[float], end: Sequence[float], duration: float, /) -> Motion: ...
def trapezoid(
    start: Sequence[float],
    end: Sequence[float],
    rate: Sequence[float],
    acceleration: Sequence[float],
    /,
) -> Motion: ...
def spline(times: Sequence[float], angles: Sequence[Sequence[float]], /) -> Motion: ...
def polynomials(times: Sequence[float], coefficients: _Floats, /) -> Motion:
    """From coefficients (n, n_powers, n_axes)."""

def hold(angle: Sequence[float], duration: float, /) -> Motion: ...
def sequence(motions: Sequence[Motion], /) -> Motion: ...
def functions(
    angle: Callable[[float], Sequence[float]],
    rate: Callable[[float], Sequence[float]],
    duration: float,
    knots: Sequence[float],
    acceleration: Callable[[float], Sequence[float]] | None,
    /,
) -> Motion: ...

class Input:
    """Gives `size` numbers at a time."""

    def __init__(
        self, size: int, function: Callable[[float], list[float]], knots: Sequence[float], /
    ) -> None: ...

class Inputs:
    def __init__(
        self, motion: Motion | None, of_axes: Input | None, tip_force: Input | None, /
    ) -> None: ...

class Robot:
    def __init__(
        self, model: _Model, load: Load, options: dict[str, Any], tables: _Tables, /
    ) -> None:
        """Options that are missing are the model's own; no row of the tables may be missing."""

    @property
    def options(self) -> dict[str, Any]: ...
    @property
    def tables(self) -> _Tables: ...
    @property
    def elements(self) -> list[str]: ...
    @property
    def n_axes(self) -> int: ...
    @property
    def has_real_gears(self) -> bool: ...
    @property
    def n_states(self) -> int: ...
    @property
    def n_indicators(self) -> int: ...
    @property
    def state_groups(self) -> list[tuple[str, str, list[float], int, int]]:
        """Name, unit, nominal values, first state, number of states."""

    @property
    def indicator_groups(self) -> list[tuple[str, int]]:
        """Name, number of indicators: two per axis."""

    def check_motion(self, motion: Motion, /) -> None: ...
    def check_state(self, x: _Floats, /) -> None: ...
    def rest_state(self, motion: Motion | None, start: str, /) -> _Floats: ...
    def state_from(
        self,
        joint_angle: _Floats,
        joint_rate: _Floats | None,
        rotor_angle: _Floats | None,
        rotor_rate: _Floats | None,
        motor_torque: _Floats | None,
        /,
    ) -> _Floats: ...

# The arm alone; arrays (n, N), for `mass_matrix` the result is (n, N, N).
def forward_dynamics(robot: Robot, q: _Floats, qd: _Floats, tau: _Floats, /) -> _Floats: ...
def articulated_forward_dynamics(
    robot: Robot, q: _Floats, qd: _Floats, tau: _Floats, /
) -> _Floats: ...
def inverse_dynamics(robot: Robot, q: _Floats, qd: _Floats, qdd: _Floats, /) -> _Floats: ...
def inverse_dynamics_tape(robot: Robot, /) -> tuple[list[tuple[str, int, int, float]], list[int]]:
    """Lines (operation, first operand, second operand, constant); where the torques are."""

def mass_matrix(robot: Robot, q: _Floats, /) -> _Floats: ...
def link_poses(robot: Robot, q: _Floats, /) -> _Floats:
    """Poses (n, 7, 4, 4) for angles (n, 6)."""

class System:
    """A robot as a hybrid system; states (n, n_states) at times (n,)."""

    def __init__(self, robot: Robot, inputs: Inputs, /) -> None: ...
    def initialise(self, t: float, x: _Floats, /) -> _Floats: ...
    def derivatives(self, t: float | _Floats, x: _Floats, /) -> _Floats:
        """Return rates (n, n_states)."""

    def indicators(self, t: float | _Floats, x: _Floats, /) -> _Floats:
        """Return what is watched (n, n_watched): positive inside the present branches."""

    def signals(self, t: _Floats, x: _Floats, /) -> _Floats:
        """Return signals (n, n_signals * N)."""

    def next_time_event(self, t: float, /) -> float: ...
    def handle_event(
        self, t: float, x: _Floats, fired: Sequence[int], time_event: bool, /
    ) -> tuple[_Floats, list[tuple[int, str, int, int]]]:
        """Return the state after the event, and (axis, element, before, after) of each switch."""

class Snapshot: ...

class Trajectory:
    def __init__(
        self,
        begin: _Floats,
        end: _Floats,
        mode: NDArray[int32],
        dense: _Floats,
        branches: NDArray[int32],
        held: _Floats,
        /,
    ) -> None: ...
    @property
    def parts(self) -> tuple[NDArray[Any], ...]:
        """The arguments of the constructor.

        Of each step its begin, end and mode (n_steps,) and its dense output (n_steps, size); of
        each mode its branches and held values (n_modes, ...).
        """

    @property
    def begin(self) -> _Floats: ...
    @property
    def end(self) -> _Floats: ...
    def steps_at(self, t: _Floats, /) -> NDArray[int64]:
        """Index of the step that each instant falls into, the later one where two meet."""

    def until(self, t: float, /) -> Trajectory:
        """Return what lies before `t`, and `t` itself: at least the first instant."""

    def instants(
        self, event_times: _Floats, times: _Floats | None, /
    ) -> tuple[_Floats, NDArray[int64]]:
        """Instants to record (n,) and their steps: all steps or `times`, events on both sides."""

class Simulator:
    def __init__(
        self,
        robot: Robot,
        inputs: Inputs,
        start: _Floats,
        rtol: float,
        method: Method,
        record: bool,
        list_samples: bool,
        /,
    ) -> None: ...
    def advance(
        self,
        target: float,
        stop_at_event: bool,
        include_target: bool,
        progress: Callable[[float], None] | None,
        /,
    ) -> None: ...
    def set_input(self, values: _Floats, /) -> None: ...
    def set_tip_force(self, force: Sequence[float], /) -> None: ...
    def set_brakes(self, on: Sequence[bool], /) -> None: ...
    @property
    def input(self) -> _Floats: ...
    @property
    def tip_force(self) -> _Floats: ...
    @property
    def brakes(self) -> list[bool]: ...
    @property
    def time(self) -> float: ...
    @property
    def state(self) -> _Floats: ...
    @property
    def signals(self) -> _Floats:
        """(n_signals, N)."""

    @property
    def energies(self) -> _Floats:
        """(n_energies, N)."""

    @property
    def branches(self) -> dict[str, NDArray[int8]]: ...
    @property
    def n_events(self) -> int: ...
    def events(self, first: int, /) -> list[tuple[float, int, str, int, int]]: ...
    @property
    def statistics(self) -> dict[str, int]: ...
    def save(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot, /) -> None: ...
    @property
    def trajectory(self) -> Trajectory: ...

def evaluate(
    robot: Robot,
    inputs: Inputs,
    method: Method,
    rtol: float,
    trajectory: Trajectory,
    t: _Floats,
    step: NDArray[int64],
    /,
) -> tuple[_Floats, NDArray[int8]]:
    """States (n, n_states), branches (n_elements, n, N)."""

def evaluate_signals(
    robot: Robot,
    inputs: Inputs,
    trajectory: Trajectory,
    t: _Floats,
    step: NDArray[int64],
    states: _Floats,
    /,
) -> _Floats:
    """Signals (n_signals, n, N) in given states (n, n_states)."""

def evaluate_energies(
    robot: Robot,
    inputs: Inputs,
    trajectory: Trajectory,
    t: _Floats,
    step: NDArray[int64],
    states: _Floats,
    signals: _Floats,
    /,
) -> _Floats:
    """Energies (n_energies, n, N) in given states (n, n_states) with signals (n_signals, n, N)."""

# Export.

class FmuRecipe:
    def __init__(
        self,
        robot: Robot,
        motion: Motion | None,
        reference_is_input: bool,
        start: str | _Floats,
        input: _Floats,
        tip_force: Sequence[float],
        brakes: Sequence[bool],
        method: Method,
        relative_tolerance: float,
        /,
    ) -> None: ...
    @property
    def text(self) -> str:
        """The resources of the FMU."""

    @property
    def variables(
        self,
    ) -> list[
        tuple[str, str, str, str, tuple[int, ...], int, list[float], list[float], int | None]
    ]:
        """Name, unit, text, group, shape, value reference, start, nominal values, its state."""

# Many runs.

class Run:
    def __init__(
        self,
        robot: Robot,
        inputs: Inputs,
        start: str | _Floats,
        t_end: float,
        times: _Floats | None,
        rtol: float,
        method: Method,
        list_samples: bool,
        input: _Floats | None,
        tip_force: _Floats | None,
        brakes: Sequence[bool],
        /,
    ) -> None: ...

class Record(Enum):
    all = ...
    events = ...
    final = ...
    peaks = ...

class Outcome:
    """Of a run that has ended; what is not to be recorded is empty or None."""

    @property
    def failed(self) -> bool: ...
    @property
    def began(self) -> bool: ...
    @property
    def time(self) -> float: ...
    @property
    def state(self) -> _Floats: ...
    @property
    def branches(self) -> dict[str, NDArray[int8]]: ...
    def events(self) -> list[tuple[float, int, str, int, int]]: ...
    @property
    def statistics(self) -> dict[str, int]: ...
    @property
    def seconds(self) -> float: ...
    @property
    def trajectory(self) -> Trajectory: ...
    @property
    def final_state(self) -> _Floats: ...
    @property
    def signals(self) -> _Floats:
        """(n_signals + n_energies, N): these after those."""

    def raise_failure(self) -> None:
        """Raise what has ended the run, if it failed."""

class Batch:
    def __init__(self, runs: Sequence[Run], record: Record, /) -> None: ...
    def run(self, n_workers: int, progress: Callable[[int], None] | None, /) -> None: ...
    @property
    def outcomes(self) -> list[Outcome | None]:
        """In the order of the runs; None where one is not finished."""
