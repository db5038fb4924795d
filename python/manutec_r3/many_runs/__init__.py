"""One experiment many times, on all cores or on a cluster, and what is kept of each run."""

from .many import Results, simulate_many
from .records import EventRecord, FinalRecord, PeakRecord

__all__ = ["EventRecord", "FinalRecord", "PeakRecord", "Results", "simulate_many"]
