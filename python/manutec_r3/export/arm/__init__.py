"""The arm with ideal gears, as URDF and MJCF; `tree` is what both say."""

from .mjcf import export_mjcf
from .urdf import export_urdf

__all__ = ["export_mjcf", "export_urdf"]
