"""What came out of a run."""

from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _core
from .arguments import floats
from .events import Events
from .inputs import Inputs
from .limits import LimitExcess, limit_events, limit_excesses
from .signals import Signals, signal_names

if TYPE_CHECKING:
    from os import PathLike

    from .animation import Animation

Method = Literal["exponential", "erk", "bdf"]


@dataclass(frozen=True)
class Statistics:
    """The work of a run, summed over all restarts.

    Attributes
    ----------
    evaluations : int
        Of the right-hand side, for steps and for the location of events.
    steps, rejected_steps : int
        Accepted; rejected by the error control.
    events : int
        Branches that switched, knots of the reference, and samples if they are listed.
    restarts : int
        Of the integration: one for all events of an instant, listed or not, one for each kink of
        the friction characteristic, for each knot and each setting of an input, and one when a
        rotor 1 to 3 has clearly broken away (its creep is watched then).
    samples : int
        Of a sampled controller, after the one at the start.
    sample_evaluations : int
        Evaluations that restarting after samples took, where nothing else happened; the next step
        begins with them.
    seconds : float
        Wall-clock time [s].
    """

    evaluations: int
    steps: int
    rejected_steps: int
    events: int
    restarts: int
    samples: int
    sample_evaluations: int
    seconds: float

    @property
    def evaluations_per_sample(self) -> float:
        """What a sample costs, in evaluations of the right-hand side; NaN without samples."""
        return self.sample_evaluations / self.samples if self.samples else float("nan")


@dataclass(frozen=True)
class Run:
    """A recorded run: the steps of the integrator, and what they are steps of."""

    inputs: Inputs
    method: Method
    trajectory: _core.Trajectory


class Samples(Signals):
    """Signals of a run at given instants.

    Attributes
    ----------
    time : ndarray (n,)
        The instants [s].
    signals : tuple of str
        Names of all signals, ``state`` included.

    All signals of `Signals` are attributes as well, as arrays (n, n_axes).
    """

    signals = (*signal_names, "state")

    def __init__(self, run: Run, time: np.ndarray, step: np.ndarray) -> None:
        self._run = run
        self._step = step  # the step of the integrator that each instant belongs to
        self.time = time

    @cached_property
    def _values(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        run = self._run
        return _core.evaluate(
            run.inputs.robot._compiled,
            run.inputs._compiled,
            _core.Method[run.method],
            run.trajectory,
            self.time,
            self._step,
        )

    @property
    def state(self) -> np.ndarray:
        """States (n, n_states), see `Robot.state_names`."""
        return self._values[0]

    @property
    def branches(self) -> dict[str, np.ndarray]:
        """Branches (n, n_axes) of each element: -1, 0, +1; 0 if an axis has no such element."""
        branches = dict(zip(_core.axis_elements, self._values[2], strict=True))
        return {name: branches[name] for name in self._run.inputs.robot._compiled.elements}

    def _signal(self, name: str) -> np.ndarray:
        return self._values[1][signal_names.index(name)]

    def __len__(self) -> int:
        return len(self.time)


class Result(Samples):
    """A run: signals at all steps of the integrator, or at the times asked for, and at all events.

    At an event both sides are recorded: its instant stands twice in `time`, before and after.

    Attributes
    ----------
    robot : Robot
        What was simulated.
    motion : Motion or None
        Its reference; without one `reference_angle`, `reference_rate` and `control_error` are NaN.
    t_end : float
        Where the run ended [s].
    method : {"exponential", "erk", "bdf"}
        Integration method.
    rtol : float
        Its tolerance, relative to the states' nominal values as well as to their values.
    events : Events
        Every switch of every branch and every knot of the reference; if asked for, the samples of a
        sampled controller, and when limits are exceeded and kept again.
    statistics : Statistics
        What it took.
    status : str
        ``completed``, or why it ended before its time.
    """

    def __init__(
        self,
        run: Run,
        rtol: float,
        events: Events,
        statistics: Statistics,
        t_end: float,
        times: np.ndarray | None = None,
        status: str = "completed",
    ) -> None:
        if times is not None:
            times = times[times <= t_end]
        super().__init__(run, *run.trajectory.instants(np.unique(events.time), times))
        self.robot = run.inputs.robot
        self.motion = run.inputs.motion
        self.method = run.method
        self.rtol = rtol
        self.events = events
        self.statistics = statistics
        self.t_end = t_end
        self.status = status
        self._times = times

    @cached_property
    def limits(self) -> tuple[LimitExcess, ...]:
        """When which axis was beyond a limit, and by how much; in the order of the beginnings.

        Watched are joint angles, rotor rates, the root mean square of motor torques and sustained
        saturation; see `LimitExcess`. It is computed when it is asked for first.
        """
        run = self._run
        return limit_excesses(run.inputs.robot, run.trajectory, partial(Samples, run))

    def _listing_limits(self) -> "Result":
        """Return the same result with the beginnings and ends of its excesses among its events."""
        told = sorted([*self.events, *limit_events(self.limits, self.t_end)], key=lambda e: e.time)
        listing = self._with(events=Events(told))
        listing.limits = self.limits
        return listing

    def _until_limit(self) -> "Result":
        """Return the part of the run before the first instant at which a limit is exceeded."""
        if not self.limits:
            return self
        t_end = self.limits[0].begin
        reached = [excess for excess in self.limits if excess.begin == t_end]
        until = self._with(
            run=replace(self._run, trajectory=self._run.trajectory.until(t_end)),
            events=Events(event for event in self.events if event.time < t_end),
            t_end=t_end,
            status=f"ended at {t_end:.6g} s: {', '.join(map(str, reached))}",
        )
        if t_end > 0.0:  # roundoff decides whether what is left exceeds a limit or just reaches it
            until.limits = tuple(
                excess._replace(end=t_end, peak=excess.limit) for excess in reached
            )
        return until

    def _with(self, **changes: Any) -> "Result":
        """Return a result that was constructed with some other arguments."""
        arguments = {
            "run": self._run,
            "rtol": self.rtol,
            "events": self.events,
            "statistics": self.statistics,
            "t_end": self.t_end,
            "times": self._times,
            "status": self.status,
        }
        return Result(**arguments | changes)

    def at(self, times: float | np.ndarray) -> Samples:
        """Signals at any instants of the run, as accurate as at the steps.

        Parameters
        ----------
        times : array_like (n,) or float
            Instants [s] from 0 to `t_end`, in any order. At an event the values are those after it.

        Returns
        -------
        Samples

        Raises
        ------
        ValueError
            If an instant lies outside the run.
        """
        t = np.atleast_1d(floats("times", times, "s"))
        outside = (t < 0.0) | (t > self.t_end)
        if outside.any():
            raise ValueError(
                f"times: expected instants from 0 to {self.t_end:g} s, got {t[outside][0]:g} s"
            )
        return Samples(self._run, t, self._run.trajectory.steps_at(t))

    def animate(
        self,
        path: "str | PathLike[str] | None" = None,
        *,
        rate: float | None = None,
        magnify: float = 1.0,
    ) -> "Animation":
        """Show the run in three dimensions, beside it its axes; in a notebook without a path.

        Parameters
        ----------
        path : str or path, optional
            Where to write the page: one file that any browser opens, without a network.
        rate, magnify
            Frames per second, and how many times the control error is shown; see
            `manutec_r3.animation.Animation`.

        Raises
        ------
        ValueError, TypeError
            What was wrong, what was expected, what arrived.
        ImportError
            If trimesh or SciPy is not installed.
        """
        from .animation import Animation

        animation = Animation(self, rate=rate, magnify=magnify)
        if path is not None:
            animation.save(path)
        return animation

    def __repr__(self) -> str:
        return (
            f"<Result of model {self.robot.model}: 0 to {self.t_end:g} s, {len(self)} instants, "
            f"{len(self.events)} events>"
        )
