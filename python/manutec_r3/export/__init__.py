"""The robot in formats that other programs read.

The whole of it in `fmu`, for simulators; in `arm` the arm with ideal gears, for multibody programs.
"""

from .arm import export_mjcf, export_urdf
from .fmu import export_fmu

__all__ = ["export_fmu", "export_mjcf", "export_urdf"]
