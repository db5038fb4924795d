"""The robot in formats that other programs read.

The whole of it: `export_fmu`; the binary is of `cpp/fmi`, `model_description` is what importers
read first.
"""

from .fmu import export_fmu

__all__ = ["export_fmu"]
