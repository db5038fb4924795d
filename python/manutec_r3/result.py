"""What came out of a run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core, files, html
from . import plot as pictures
from .arguments import Floats, floats
from .build_info import BuildInfo
from .events import Events
from .experiment import Experiment
from .inputs import Inputs
from .limits import LimitExcess, limit_events, limit_excesses
from .signals import Signals, signal_names

if TYPE_CHECKING:
    from os import PathLike

    from xarray import Dataset

    from .animation import Animation


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


@dataclass(frozen=True, eq=False)
class Run:
    """A recorded run: what was simulated, with what, and the steps of the integrator."""

    experiment: Experiment
    build: BuildInfo
    trajectory: _core.Trajectory

    @property
    def inputs(self) -> Inputs:
        """What acts on the robot, and the robot."""
        return self.experiment.setup.inputs


class Samples(Signals):
    """Signals of a run at given instants.

    Attributes
    ----------
    time : ndarray (n,)
        The instants [s].
    signals : tuple of str
        Names of all signals, ``state`` included.
    robot : Robot
        What was simulated.
    motion : Motion or None
        Its reference; without one `reference_angle`, `reference_rate` and `control_error` are NaN.
    provenance : dict of str to str or float
        Where it comes from: ``scenario``, the TOML text of one if there was one; ``method`` and
        ``rtol``; and of `build_info` what was in use, such as ``version`` and ``processor``.

    All signals of `Signals` are attributes as well, as arrays (n, n_axes).
    """

    signals = (*signal_names, "state")

    def __init__(self, run: Run, time: np.ndarray, step: np.ndarray) -> None:
        self._run = run
        self._step = step  # the step of the integrator that each instant belongs to
        self.time = time
        self.robot = run.inputs.robot
        self.motion = run.inputs.motion

    @property
    def provenance(self) -> dict[str, str | float]:
        """Where it comes from."""
        experiment, build = self._run.experiment, self._run.build
        return {
            "version": build.version,
            "scenario": experiment.scenario,
            "method": experiment.setup.method,
            "rtol": experiment.setup.rtol,
            "processor": build.processor,
            "compiler": build.compiler,
            "flags": build.flags,
            "sundials": build.sundials,
            "eigen": build.eigen,
        }

    @cached_property
    def _solution(self) -> tuple[np.ndarray, np.ndarray]:
        """States (n, n_states) and branches (n_elements, n, n_axes)."""
        run = self._run
        return _core.evaluate(
            run.inputs.robot._compiled,
            run.inputs._compiled,
            _core.Method[run.experiment.setup.method],
            run.experiment.setup.rtol,
            run.trajectory,
            self.time,
            self._step,
        )

    @cached_property
    def _signals(self) -> np.ndarray:
        return _core.evaluate_signals(*self._of_run, self.state)

    @cached_property
    def _energies(self) -> np.ndarray:
        return _core.evaluate_energies(*self._of_run, self.state, self._signals)

    @property
    def _of_run(
        self,
    ) -> tuple[_core.Robot, _core.Inputs, _core.Trajectory, np.ndarray, np.ndarray]:
        """What was simulated, and where in its run these instants are."""
        run = self._run
        compiled = run.inputs.robot._compiled, run.inputs._compiled
        return *compiled, run.trajectory, self.time, self._step

    @property
    def state(self) -> np.ndarray:
        """States (n, n_states), see `Robot.state_names`."""
        return self._solution[0]

    @property
    def branches(self) -> dict[str, np.ndarray]:
        """Branches (n, n_axes) of each element: -1, 0, +1; 0 if an axis has no such element."""
        branches = dict(zip(_core.axis_elements, self._solution[1], strict=True))
        return {name: branches[name] for name in self.robot._compiled.elements}

    def to_xarray(self) -> "Dataset":
        """Return states, branches and all signals as a Dataset of xarray.

        Dimensions are ``time``, ``axis`` and ``state``; units and descriptions are attributes of
        each variable, and where a result comes from those of the Dataset. An event's instant stands
        twice in the times of a result: to select by time, take ``result.at(times).to_xarray()``.

        Raises
        ------
        ImportError
            Without the extra ``files``.
        """
        return files.netcdf.dataset(self)

    def to_csv(self, path: str | Path, signals: Sequence[str] | None = None) -> None:
        """Write signals as a table of comma-separated values.

        The first column is the time, ``time [s]``; then come all axes of each signal, such as
        ``joint_angle[1] [rad]``. Numbers are written to their last digit. An event's instant stands
        twice in a result, before and after. `compare` reads such a file.

        Parameters
        ----------
        path : str or Path
            Where to.
        signals : sequence of str, optional
            Which; ``state`` stands for all states. Default: all signals that the robot has.

        Raises
        ------
        ValueError, TypeError
            If there is no such signal.
        OSError
            If the file cannot be written.
        """
        files.csv.write_samples(path, self, signals)

    def __len__(self) -> int:
        return len(self.time)


class Result(Samples):
    """A run: signals at all steps of the integrator, or at the times asked for, and at all events.

    At an event both sides are recorded: its instant stands twice in `time`, before and after.

    Attributes
    ----------
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
    robot, motion, provenance
        As those of `Samples`.
    """

    # The pictures take a result first: they are methods as they are.
    plot = pictures.figure9
    plot_events = pictures.events
    plot_friction = pictures.friction
    plot_backlash = pictures.backlash
    plot_phase = pictures.phase
    plot_stroboscope = pictures.stroboscope

    def __init__(
        self, run: Run, events: Events, statistics: Statistics, t_end: float, status: str
    ) -> None:
        times = run.experiment.times
        if times is not None:
            times = times[times <= t_end]
        super().__init__(run, *run.trajectory.instants(np.unique(events.time), times))
        self.method = run.experiment.setup.method
        self.rtol = run.experiment.setup.rtol
        self.events = events
        self.statistics = statistics
        self.t_end = t_end
        self.status = status

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
        arguments: dict[str, Any] = {
            "run": self._run,
            "events": self.events,
            "statistics": self.statistics,
            "t_end": self.t_end,
            "status": self.status,
        }
        return Result(**arguments | changes)

    def at(self, times: float | Floats) -> Samples:
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

        Examples
        --------
        >>> result = r3.Scenario.load("figure9-quintic").run()
        >>> result.at(0.6).joint_angle.round(3)
        array([[ 0.496,  0.499,  0.302, -0.099, -0.073, -0.05 ]])
        """
        t = np.atleast_1d(floats("times", times, "s"))
        outside = (t < 0.0) | (t > self.t_end)
        if outside.any():
            raise ValueError(
                f"times: expected instants from 0 to {self.t_end:g} s, got {t[outside][0]:g} s"
            )
        return Samples(self._run, t, self._run.trajectory.steps_at(t))

    def rerun(self, **overrides: Any) -> "Result":
        """Simulate once more what led to this result.

        With the same build on the same machine it is the same result, bit by bit.

        Parameters
        ----------
        **overrides
            Arguments of `simulate` that take the place of those of this run; all others stay as
            they were, `rtol` and `method` included.

        Returns
        -------
        Result

        Raises
        ------
        ValueError, TypeError, SimulationError
            As `simulate`. `ValueError` as well if the result comes from a file that could not hold
            a motion or an input, which were functions; they can be given.
        """
        from .simulation import simulate  # which in turn needs what is here

        experiment = self._run.experiment
        return simulate(**experiment.arguments | overrides, _scenario=experiment.scenario)

    def save(self, path: str | Path) -> None:
        """Write everything to a file, from which `load` makes the same result.

        Parameters
        ----------
        path : str or Path
            Where to: ``.nc``, NetCDF4, which needs the extra ``files``; or ``.npz``, an archive of
            NumPy. Both hold the same arrays under the same names, without pickled objects; see
            `manutec_r3.files`.

        Raises
        ------
        ValueError
            If the path ends otherwise.
        ImportError
            Without the extra ``files``, for NetCDF4.
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> result = r3.Scenario.load("figure9-quintic").run()
        >>> result.save("run.npz")
        >>> same = r3.Result.load("run.npz")
        >>> np.array_equal(same.motor_torque, result.motor_torque), same.events == result.events
        (True, True)
        """
        files.save(path, self)

    @classmethod
    def load(cls, path: str | Path) -> "Result":
        """Read a result from a file that `save` has written.

        All arrays, events, limits and statistics are those that were written, bit by bit. `at` and
        `rerun` compute, with the build at hand: on another one what they give differs by roundoff.
        Functions of the user's own are in no file: without them neither works, and both say so.

        Parameters
        ----------
        path : str or Path
            The file, ``.nc`` or ``.npz``.

        Returns
        -------
        Result

        Raises
        ------
        ValueError
            If it is no such file, or one of a version that recorded runs otherwise.
        ImportError
            Without the extra ``files``, for NetCDF4.
        OSError
            If the file cannot be read.

        Examples
        --------
        >>> r3.Scenario.load("one-axis").run().save("axis.npz")
        >>> r3.Result.load("axis.npz").status
        'completed'
        """
        return files.load(path)

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

        Returns
        -------
        Animation
            Jupyter shows it; its method ``save`` writes the page.

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

    def _repr_html_(self) -> str:
        work = self.statistics
        about = html.facts(
            f"Result of model {self.robot.model}",
            {
                "time": f"0 to {self.t_end:g} s, {len(self)} instants",
                "status": self.status,
                "method": f"{self.method}, rtol {self.rtol:g}",
                "events": len(self.events),
                "limits exceeded": len(self.limits),
                "work": f"{work.steps} steps, {work.evaluations} evaluations, {work.seconds:.3g} s",
            },
        )
        angle = self.joint_angle
        columns = {
            "axis": range(1, self.robot.n_axes + 1),
            "joint angle from [rad]": _texts(angle.min(axis=0), 4),
            "to [rad]": _texts(angle.max(axis=0), 4),
            "peak control error [mrad]": _peaks(1e3 * self.control_error),
            "peak motor torque [N m]": _peaks(self.motor_torque),
            "peak motor power [W]": _peaks(self.motor_power),
        }
        return about + html.table("Each axis", [*columns], zip(*columns.values(), strict=True))


def _peaks(values: np.ndarray) -> list[str]:
    """Return the largest magnitude on each axis."""
    return _texts(np.abs(values).max(axis=0), 2)


def _texts(values: np.ndarray, decimals: int) -> list[str]:
    """Return numbers as texts; what there is not is a dash."""
    return ["-" if np.isnan(value) else f"{value:.{decimals}f}" for value in values]
