"""Benchmarks: work, error, time and ratio of each program beside its peers.

What is measured is as right as promised, or the row says that it is wrong. Peers that are not
installed are left out, with the reason: ``pip install "manutec-r3[bench]"`` brings them.
"""

from collections.abc import Callable

from .arm import forward_dynamics, right_hand_sides
from .report import Row, Table, for_markdown, for_terminal, machine
from .runs import exported, figure9, full_robot, many_runs, recording, sampled

# Each part is a function of the number of repeats.
PARTS: dict[str, Callable[[int], Table]] = {
    "right-hand-side": right_hand_sides,
    "forward-dynamics": forward_dynamics,
    "figure9": figure9,
    "sampled": sampled,
    "full-robot": full_robot,
    "fmu": exported,
    "recording": recording,
    "many-runs": many_runs,
}

__all__ = ["PARTS", "Row", "Table", "for_markdown", "for_terminal", "machine"]
