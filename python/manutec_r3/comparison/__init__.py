"""What came out beside what should have: other runs, curves of others, published figures."""

from .checks import Check, check
from .events import EventComparison, compare_events
from .results import Comparison, CurveComparison, compare

__all__ = [
    "Check",
    "Comparison",
    "CurveComparison",
    "EventComparison",
    "check",
    "compare",
    "compare_events",
]
