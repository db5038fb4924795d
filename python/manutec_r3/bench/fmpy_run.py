"""The same run by FMPy: its CVODE on our exported robot, or the robot's own integrator there.

FMPy records at regular instants and, before and after, at events: the branches among its outputs
tell which.
"""

from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import Any, Literal, Self

import fmpy
import numpy as np
from fmpy import __version__ as version

from ..events import Event
from ..export import export_fmu
from ..scenario import Scenario

__all__ = ["ExportedRun", "FMPyRun", "columns", "switches", "version"]

Kind = Literal["ModelExchange", "CoSimulation"]
Rows = dict[str, np.ndarray]

_ELEMENTS = ("dead_zone", "torque_limit", "voltage_limit", "backlash", "friction")
_INTERVAL = 0.01  # between regular instants [s]


@dataclass(frozen=True)
class FMPyRun:
    """What came out.

    Attributes
    ----------
    time : ndarray (n,)
        Instants that were recorded [s].
    control_error, motor_torque : ndarray (n, n_axes)
        Signals there [rad, N m].
    events : list of Event
        What branches show: none of the reference, none of samples.
    """

    time: np.ndarray
    control_error: np.ndarray
    motor_torque: np.ndarray
    events: list[Event]


class ExportedRun:
    """A scenario as an FMU on disk, ready to be simulated; a context that cleans up.

    Parameters
    ----------
    scenario : Scenario
        Any that can be exported.
    """

    def __init__(self, scenario: Scenario) -> None:
        self._t_end = scenario.t_end
        self._folder = TemporaryDirectory()
        file = Path(self._folder.name) / "robot.fmu"
        export_fmu(scenario, file)
        self._unpacked = fmpy.extract(file, Path(self._folder.name) / "unpacked")
        self._description = fmpy.read_model_description(self._unpacked)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        self._folder.cleanup()

    def run(self, kind: Kind, rtol: float) -> FMPyRun:
        """Simulate, and record what tells how right it is.

        Parameters
        ----------
        kind : {"ModelExchange", "CoSimulation"}
            Who integrates: FMPy, or the FMU.
        rtol : float
            Tolerance, relative to nominal values as well as to values.
        """
        branches = [f"branch.{element}" for element in _ELEMENTS]
        rows = self._simulate(kind, rtol, ["control_error", "motor_torque", *branches])
        time = rows["time"][:, 0]
        return FMPyRun(time, rows["control_error"], rows["motor_torque"], switches(rows))

    def last_angles(self, kind: Kind, rtol: float) -> np.ndarray:
        """Simulate, and record as little as FMPy can: the joint angles (n_axes,) at the end."""
        return self._simulate(kind, rtol, ["joint_angle"], record_events=False)["joint_angle"][-1]

    def _simulate(self, kind: Kind, rtol: float, output: list[str], **more: Any) -> Rows:
        at_events = {"use_event_mode": True, "early_return_allowed": True}
        with redirect_stdout(StringIO()):  # FMPy warns of inputs that nobody sets
            recorded = fmpy.simulate_fmu(
                self._unpacked,
                validate=False,
                model_description=self._description,
                fmi_type=kind,
                relative_tolerance=rtol,
                stop_time=self._t_end,
                output_interval=_INTERVAL,
                output=output,
                **(at_events if kind == "CoSimulation" else {}),
                **more,
            )
        return columns(recorded)


def columns(recorded: np.ndarray) -> Rows:
    """Return what FMPy has recorded by names, each an array (n, n_axes) in both versions of FMI."""
    parts: dict[str, list[np.ndarray]] = {}
    for name in recorded.dtype.names or ():
        parts.setdefault(name.partition("[")[0], []).append(
            recorded[name].reshape(len(recorded), -1)
        )
    return {name: np.hstack(arrays) for name, arrays in parts.items()}


def switches(rows: Rows) -> list[Event]:
    """Return the events that recorded branches show."""
    time = rows["time"][:, 0]
    branches = zip(*(rows[f"branch.{element}"] for element in _ELEMENTS), strict=True)
    return [
        Event(float(time[k + 1]), axis + 1, element, int(before[axis]), int(after[axis]))
        for k, (earlier, later) in enumerate(pairwise(branches))
        for axis in range(len(earlier[0]))
        for element, before, after in zip(_ELEMENTS, earlier, later, strict=True)
        if before[axis] != after[axis]
    ]
