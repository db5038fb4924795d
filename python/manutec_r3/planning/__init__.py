"""Motions that somebody has thought about: optimal ones, along paths, with limited jerk.

Solvers of others find them, each in an extra of its own; the core's equations of the arm tell what
a motion takes of the motors.
"""

from .optimal import OptimalMotion, ParetoMotions, optimal_motion, pareto_motions
from .paths import fastest_along, jerk_limited_motion

__all__ = [
    "OptimalMotion",
    "ParetoMotions",
    "fastest_along",
    "jerk_limited_motion",
    "optimal_motion",
    "pareto_motions",
]
