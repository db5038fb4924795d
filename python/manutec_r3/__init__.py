"""The reference simulator of the Manutec r3 robot: arm, drives and controllers.

A `Robot` that follows a motion is simulated by `simulate`, or step by step by a `Simulator`; a
`Scenario` is both in one file.

    import manutec_r3 as r3

    robot = r3.Robot(model=3, load=r3.Load(mass=15.0))
    motion = r3.Quintic(start=[0] * 6, end=[1.0, 1.0, 0.6, -0.2, -0.15, -0.1], duration=1.2)
    result = r3.simulate(robot, motion, t_end=1.5)

All quantities are in SI units; axes are counted from 1. Examples in docstrings take for granted
`import numpy as np` and `import manutec_r3 as r3`.
"""

from . import plot
from .build_info import BuildInfo, build_info
from .comparison import (
    Check,
    Comparison,
    CurveComparison,
    EventComparison,
    check,
    compare,
    compare_events,
)
from .errors import OptimisationError, SimulationError, SimulationInterrupted
from .events import Event, Events
from .export import export_fmu, export_mjcf, export_urdf
from .inputs import Input
from .limits import LimitExcess
from .many_runs import EventRecord, FinalRecord, PeakRecord, Results, simulate_many
from .motion import (
    FunctionMotion,
    Hold,
    Motion,
    PiecewisePolynomial,
    Quintic,
    Sequence,
    Spline,
    Trapezoid,
)
from .planning import (
    OptimalMotion,
    ParetoMotions,
    fastest_along,
    jerk_limited_motion,
    optimal_motion,
    pareto_motions,
)
from .result import Result, Samples, Statistics
from .robot import Load, Robot
from .scenario import Scenario, scenarios
from .simulation import Simulator, simulate

__all__ = [
    "BuildInfo",
    "Check",
    "Comparison",
    "CurveComparison",
    "Event",
    "EventComparison",
    "EventRecord",
    "Events",
    "FinalRecord",
    "FunctionMotion",
    "Hold",
    "Input",
    "LimitExcess",
    "Load",
    "Motion",
    "OptimalMotion",
    "OptimisationError",
    "ParetoMotions",
    "PeakRecord",
    "PiecewisePolynomial",
    "Quintic",
    "Result",
    "Results",
    "Robot",
    "Samples",
    "Scenario",
    "Sequence",
    "SimulationError",
    "SimulationInterrupted",
    "Simulator",
    "Spline",
    "Statistics",
    "Trapezoid",
    "build_info",
    "check",
    "compare",
    "compare_events",
    "export_fmu",
    "export_mjcf",
    "export_urdf",
    "fastest_along",
    "jerk_limited_motion",
    "optimal_motion",
    "pareto_motions",
    "plot",
    "scenarios",
    "simulate",
    "simulate_many",
]
