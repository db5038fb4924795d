"""Compromises between time and effort: the curve of motions that cannot be better in both."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...arguments import Floats, floats
from ...robot import Robot
from .motion import OptimalMotion, optimal_motion

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# From nearly the fastest motion to one that takes about twice as long as that, for loads and ways
# like those of the report's experiment, and torques as effort [s / (N^2 m^2 s)].
_WEIGHTS = (1e-5, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1)


@dataclass(frozen=True)
class ParetoMotions(Sequence):
    """Optimal motions of growing weight of the effort.

    Attributes
    ----------
    effort_weights : tuple of float
        Seconds that a unit of the effort is worth, ascending.
    motions : tuple of OptimalMotion
        One for each; this object is a sequence of them.
    """

    effort_weights: tuple[float, ...]
    motions: tuple[OptimalMotion, ...]

    def __post_init__(self) -> None:
        if not self.motions or not all(isinstance(m, OptimalMotion) for m in self.motions):
            raise TypeError(f"motions: expected one OptimalMotion or more, got {self.motions!r}")
        if len(self.effort_weights) != len(self.motions):
            raise ValueError(
                f"effort_weights: expected one for each of {len(self.motions)} motions, got "
                f"{len(self.effort_weights)}"
            )

    def __len__(self) -> int:
        return len(self.motions)

    def __getitem__(self, index: Any) -> Any:
        return self.motions[index]

    def __iter__(self) -> Iterator[OptimalMotion]:
        return iter(self.motions)

    @property
    def duration(self) -> np.ndarray:
        """Of each motion [s], ascending if each is the best one: (n,)."""
        return np.array([motion.duration for motion in self.motions])

    @property
    def effort(self) -> np.ndarray:
        """Of each motion, in its `effort_unit`, descending if each is the best one: (n,)."""
        return np.array([motion.effort for motion in self.motions])

    def plot(self, axes: "np.ndarray | Figure | None" = None) -> np.ndarray:
        """Draw the curve of time and effort, and the arm along three of the motions.

        Parameters
        ----------
        axes : ndarray of Axes (1, 4) or Figure, optional
            Where to draw; default: a new figure. See `plot.pareto`.

        Returns
        -------
        ndarray of Axes (1, 4)

        Raises
        ------
        ValueError, TypeError
            What was expected, what arrived.
        ImportError
            If Matplotlib is not installed.
        """
        from ... import plot

        return plot.pareto(self, axes=axes)


def pareto_motions(
    robot: Robot,
    start: Floats,
    end: Floats,
    effort_weights: Floats = _WEIGHTS,
    **options: Any,
) -> ParetoMotions:
    """Sweep the compromise between time and effort, as the report's Figure 8 shows several.

    Parameters
    ----------
    robot, start, end
        See `optimal_motion`.
    effort_weights : sequence of float
        Seconds that a unit of the effort is worth, ascending: from nearly the fastest motion to
        smooth and slow ones.
    **options
        Further arguments of `optimal_motion`, the same for all; not the duration, which is free.

    Returns
    -------
    ParetoMotions
        A sequence of motions, with the curve of time and effort and its picture.

    Raises
    ------
    ValueError, TypeError, OptimisationError, ImportError
        As `optimal_motion`.

    Examples
    --------
    >>> robot = r3.Robot(model=2, load=r3.Load(15.0))
    >>> motions = r3.pareto_motions(robot, [0] * 3, [1.0, 1.0, 0.6], [1e-4, 1e-2], n_pieces=10)
    >>> bool(motions.duration[0] < motions.duration[1]), bool(motions.effort[0] > motions.effort[1])
    (True, True)
    """
    if "duration" in options:
        raise TypeError("duration: expected none, it is free in a compromise of time and effort")
    weights = floats("effort_weights", effort_weights, "s per unit of the effort")
    if weights.ndim != 1 or len(weights) == 0 or (np.diff(weights, prepend=-1e-300) <= 0.0).any():
        raise ValueError(
            f"effort_weights: expected weights that ascend, none below 0, got {effort_weights!r}"
        )
    motions = [
        optimal_motion(robot, start, end, effort_weight=weight, **options)
        for weight in weights.tolist()
    ]
    return ParetoMotions(tuple(weights.tolist()), tuple(motions))
