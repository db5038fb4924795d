"""The robot in three dimensions: as a page of its own, and live.

The page needs trimesh and SciPy: ``pip install "manutec-r3[animation]"``; the live view also viser:
``pip install "manutec-r3[live]"``.
"""

try:
    from .live import LiveView
    from .page import Animation
except ImportError as error:
    raise ImportError(
        'an animation needs trimesh and SciPy: pip install "manutec-r3[animation]"'
    ) from error

__all__ = ["Animation", "LiveView"]
