"""Motions that are optimal for the arm: between least time and least effort.

They need CasADi, which brings IPOPT: ``pip install "manutec-r3[optimal]"``.
"""

from .motion import OptimalMotion, SolverStatistics, optimal_motion
from .pareto import ParetoMotions, pareto_motions

__all__ = [
    "OptimalMotion",
    "ParetoMotions",
    "SolverStatistics",
    "optimal_motion",
    "pareto_motions",
]
