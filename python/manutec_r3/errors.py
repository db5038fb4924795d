"""What can end a run; wrong arguments are `ValueError` and `TypeError`."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .result import Result


class SimulationError(RuntimeError):
    """A run could not go on.

    Attributes
    ----------
    time : float
        How far it came [s].
    state : ndarray (n_states,)
        The state there.
    branches : dict of str to ndarray (n_axes,)
        The branch of each element there; empty if it could not begin.
    reason : str
        What went wrong, in the words of the solver if it was the solver.
    result : Result or None
        Everything computed so far; None if it could not begin, or was stepped by a `Simulator`,
        which stays where it came to.
    """

    def __init__(
        self,
        time: float,
        state: np.ndarray,
        branches: dict[str, np.ndarray],
        reason: str,
        result: "Result | None" = None,
    ) -> None:
        super().__init__(f"the simulation ended at t = {time:.9g} s: {reason}")
        self.time = time
        self.state = state
        self.branches = branches
        self.reason = reason
        self.result = result

    @property
    def status(self) -> str:
        """What a result says of a run that ended so."""
        return f"failed at {self.time:.6g} s: {self.reason}"

    def __reduce__(self) -> tuple:
        arguments = (self.time, self.state, self.branches, self.reason, self.result)
        return type(self), arguments


class OptimisationError(RuntimeError):
    """No optimal motion was found, or what was found does not keep what it should."""


class SimulationInterrupted(KeyboardInterrupt):
    """Somebody has interrupted a run.

    Attributes
    ----------
    time : float
        How far it came [s].
    result : Result
        Everything computed so far.
    """

    def __init__(self, time: float, result: "Result") -> None:
        super().__init__(f"the simulation was interrupted at t = {time:.9g} s")
        self.time = time
        self.result = result

    def __reduce__(self) -> tuple:
        return type(self), (self.time, self.result)
