"""A result as named arrays and texts: what is in a file, whatever its format.

Along the time, in SI units; an event's instant stands twice, before and after:

* ``time`` [s]; each signal under its own name, ``(time, axis)``; ``states`` ``(time, state)``;
* ``branches_<element>`` ``(time, axis)``: -1, 0, +1;
* ``axis``: 1 to n_axes; ``state``, ``state_unit``: names and units of the states.

Beside it:

* ``event_time``, ``event_axis``, ``event_element``, ``event_before``, ``event_after``;
* ``excess_what`` to ``excess_peak``: the limits that were exceeded, see `LimitExcess`;
* ``step_begin``, ``step_end``, ``step_mode``, ``step_dense`` ``(step, ...)``: the steps of the
  integrator, with their dense output; ``mode_branches``, ``mode_held`` ``(mode, ...)``: what was
  frozen in each of the modes that they were taken in.

Texts and numbers tell where it comes from: ``version``, ``scenario``, ``method``, ``rtol`` and what
else `Result.provenance` has; ``status``, ``t_end``, the statistics; ``experiment``, all arguments
of `simulate` as JSON; and what of them is ``not_in_file``, because functions cannot be written.
"""

from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import _core
from ..signals import descriptions
from . import recipe

if TYPE_CHECKING:
    from ..result import Result, Samples

# Another one when the dense output of a method, or what a mode holds, is laid out otherwise.
LAYOUT = 2

_STEPS = ("step_begin", "step_end", "step_mode", "step_dense", "mode_branches", "mode_held")
_DIMENSIONS = {
    "step_dense": ("step", "dense"),
    "mode_branches": ("mode", "branch"),
    "mode_held": ("mode", "held"),
}
_MEANINGS = {"friction": "sliding_backward sticking sliding_forward"}


class Variable(NamedTuple):
    """An array with the names of its dimensions, and what its numbers are."""

    dimensions: tuple[str, ...]
    values: np.ndarray
    attributes: Mapping[str, Any] = {}


def of_samples(samples: "Samples") -> dict[str, Variable]:
    """Return what signals there are along the time."""
    robot = samples.robot
    variables = {
        "time": Variable(("time",), samples.time, {"units": "s", "long_name": "Time"}),
        "axis": Variable(("axis",), np.arange(1, robot.n_axes + 1), {"long_name": "Axis"}),
        "state": Variable(("state",), np.array(robot.state_names), {"long_name": "State"}),
        "state_unit": Variable(("state",), np.array(robot.state_units), {"long_name": "Unit"}),
    }
    for name, (unit, text) in descriptions.items():
        attributes: dict[str, Any] = {"units": unit, "long_name": text}
        variables[name] = Variable(("time", "axis"), getattr(samples, name), attributes)
    variables["states"] = Variable(("time", "state"), samples.state, {"long_name": "States"})
    for element, branches in samples.branches.items():
        attributes = {
            "long_name": f"Branches of the element {element}",
            "flag_values": np.array([-1, 0, 1], np.int8),
            "flag_meanings": _MEANINGS.get(element, "below inside above"),
        }
        variables[f"branches_{element}"] = Variable(("time", "axis"), branches, attributes)
    return variables


def of_result(result: "Result") -> tuple[dict[str, Variable], dict[str, Any]]:
    """Return all that a result consists of: arrays; texts and numbers."""
    variables = of_samples(result)
    variables |= _columns("event", result.events)
    variables |= _columns("excess", result.limits)
    for name, values in zip(_STEPS, result._run.trajectory.parts, strict=True):
        dimensions = _DIMENSIONS.get(name, ("step",))
        variables[name] = Variable(dimensions, values)
    text, not_in_file = recipe.write(result._run.experiment)
    build = asdict(result._run.build)
    return variables, {
        **result.provenance,
        **build,
        "available": " ".join(build["available"]),
        "status": result.status,
        "t_end": result.t_end,
        **asdict(result.statistics),
        "experiment": text,
        "not_in_file": " ".join(not_in_file),
        "layout": LAYOUT,
    }


def _columns(prefix: str, rows: Any) -> dict[str, Variable]:
    """Columns of a table whose rows are named tuples."""
    kind = _row_types()[prefix]
    columns = zip(*rows, strict=True) if len(rows) else [()] * len(kind._fields)
    return {
        f"{prefix}_{name}": Variable((prefix,), np.array(column, kind.__annotations__[name]))
        for name, column in zip(kind._fields, columns, strict=True)
    }


def _rows(prefix: str, variables: Mapping[str, np.ndarray]) -> list:
    """Rows of such a table."""
    kind = _row_types()[prefix]
    columns = [
        variables[f"{prefix}_{name}"].astype(kind.__annotations__[name]).tolist()
        for name in kind._fields
    ]
    return [kind(*row) for row in zip(*columns, strict=True)]


def _row_types() -> dict[str, Any]:
    from ..events import Event
    from ..limits import LimitExcess

    return {"event": Event, "excess": LimitExcess}


def result_from(variables: Mapping[str, np.ndarray], attributes: Mapping[str, Any]) -> "Result":
    """Return the result that consists of these.

    Raises
    ------
    ValueError
        If something is missing or does not fit.
    """
    from ..build_info import BuildInfo
    from ..events import Events
    from ..result import Result, Run, Statistics

    try:
        if int(attributes["layout"]) != LAYOUT:
            raise ValueError(
                f"expected a run that was recorded in layout {LAYOUT}, got {attributes['layout']}, "
                f"of version {attributes['version']}"
            )
        build: dict[str, Any] = {of.name: str(attributes[of.name]) for of in fields(BuildInfo)}
        build["available"] = tuple(build["available"].split())
        run = Run(
            recipe.read(str(attributes["experiment"]), str(attributes["scenario"])),
            BuildInfo(**build),
            _core.Trajectory(*(variables[name] for name in _STEPS)),
        )
        counts = Statistics.__annotations__.items()
        work = {name: kind(attributes[name]) for name, kind in counts}
        result = Result(
            run,
            Events(_rows("event", variables)),
            Statistics(**work),
            float(attributes["t_end"]),
            str(attributes["status"]),
        )
        if not np.array_equal(result.time, variables["time"]):
            raise ValueError("expected the instants of its steps and events")
        # What was computed is as it was, on whatever build.
        no_element = np.zeros(variables["joint_angle"].shape, np.int8)
        branches = [variables.get(f"branches_{name}", no_element) for name in _core.axis_elements]
        vars(result)["_solution"] = (variables["states"], np.array(branches))
        for group, rows in (("_signals", _core.signals), ("_energies", _core.energies)):
            vars(result)[group] = np.array([variables[name] for name, *_ in rows])
        vars(result)["limits"] = tuple(_rows("excess", variables))
    except KeyError as error:
        raise ValueError(f"expected what Result.save writes, {error} is missing") from None
    except TypeError as error:
        raise ValueError(f"expected what Result.save writes: {error}") from error
    return result
