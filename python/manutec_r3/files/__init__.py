"""Results on disk.

==========  =========================================================================
`netcdf`    NetCDF4, which xarray opens, and any other program that knows the format
`npz`       an archive of NumPy
`csv`       tables of comma-separated values: signals, events
`parquet`   records of many runs
==========  =========================================================================

NetCDF4 and archives of NumPy hold a result with everything that belongs to it, under the names that
`contents` gives; neither contains pickled objects.
"""

from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

from . import csv, netcdf, npz
from .missing import missing

if TYPE_CHECKING:
    from ..result import Result

__all__ = ["csv", "load", "missing", "netcdf", "npz", "save"]

_FORMATS = {".nc": netcdf, ".npz": npz}


def save(path: str | Path, result: "Result") -> None:
    """Write a result; see `Result.save`."""
    _format(path).write(path, result)


def load(path: str | Path) -> "Result":
    """Read a result; see `Result.load`."""
    return _format(path).read(path)


def _format(path: str | Path) -> ModuleType:
    if not isinstance(path, str | Path):
        raise TypeError(f"path: expected the path of a file, got {path!r}")
    suffix = Path(path).suffix
    if suffix not in _FORMATS:
        raise ValueError(
            f"path: expected a file that ends in {' or '.join(_FORMATS)}, got {str(path)!r}"
        )
    return _FORMATS[suffix]
