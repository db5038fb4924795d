"""The whole robot as an FMU.

An archive of the binary, which `cpp/fmi` is, of resources, which the core writes, and of what
importers read first: the model description.
"""

from .archive import export_fmu

__all__ = ["export_fmu"]
