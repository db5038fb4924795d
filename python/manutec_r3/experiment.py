"""What a run is made of, all of it checked: enough to repeat it."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from .inputs import Held, Inputs, input_of

Method = Literal["exponential", "erk", "bdf"]


class Setup(NamedTuple):
    """What a run begins with."""

    inputs: Inputs
    held: Held
    brakes: list[bool]
    start: str | np.ndarray
    method: Method
    rtol: float
    list_samples: bool


@dataclass(frozen=True, eq=False)
class Experiment:
    """A whole run that is set up.

    Attributes
    ----------
    setup : Setup
        What it begins with.
    t_end : float
        Where it is to end [s].
    times : ndarray (n,) or None
        The instants to record [s]; None: all steps of the integrator.
    list_limits, enforce_limits : bool
        As in `simulate`.
    scenario : str
        The TOML text of the scenario that it comes from, if it does.
    """

    setup: Setup
    t_end: float
    times: np.ndarray | None
    list_limits: bool = False
    enforce_limits: bool = False
    scenario: str = ""

    @property
    def arguments(self) -> dict[str, Any]:
        """Those of `simulate` that make this run."""
        setup = self.setup
        inputs, held = setup.inputs, setup.held
        of_axes, _ = input_of(inputs.robot) or ("", "")
        given = {
            of_axes: inputs.of_axes or held.of_axes,
            "tip_force": inputs.tip_force or held.tip_force,
        }
        return {
            "robot": inputs.robot,
            "motion": inputs.motion,
            "t_end": self.t_end,
            "times": self.times,
            "rtol": setup.rtol,
            "method": setup.method,
            "start": setup.start,
            "list_samples": setup.list_samples,
            "brakes": setup.brakes,
            "list_limits": self.list_limits,
            "enforce_limits": self.enforce_limits,
        } | {name: value for name, value in given.items() if value is not None}
