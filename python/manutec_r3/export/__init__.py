"""The robot in formats that other programs read.

Of the arm with ideal gears: `export_urdf`, `export_mjcf`; `arm_tree` is what both say.
"""

from .mjcf import export_mjcf
from .urdf import export_urdf

__all__ = ["export_mjcf", "export_urdf"]
