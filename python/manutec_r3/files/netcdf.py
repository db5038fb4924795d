"""Results as Datasets of xarray, and as NetCDF4 files by xarray and h5netcdf."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from . import contents
from .missing import missing

if TYPE_CHECKING:
    from xarray import Dataset

    from ..result import Result, Samples

_ENGINE: Final = "h5netcdf"
_COORDINATES = ("time", "axis", "state", "state_unit")


def dataset(samples: "Samples") -> "Dataset":
    """Return signals, states and branches; see `Samples.to_xarray`."""
    return _dataset("to_xarray", contents.of_samples(samples), samples.provenance)


def write(path: str | Path, result: "Result") -> None:
    """Write a result; see `Result.save`."""
    everything = _dataset("save", *contents.of_result(result))
    # Not compressed: digits of an accurate run are hardly any smaller, but take twice the time.
    everything.to_netcdf(path, engine=_ENGINE)


def read(path: str | Path) -> "Result":
    """Read a result; see `Result.load`."""
    xarray = _xarray("load")
    everything = xarray.load_dataset(path, engine=_ENGINE, decode_cf=False)
    variables = {name: variable.values for name, variable in everything.variables.items()}
    try:
        return contents.result_from(variables, everything.attrs)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _dataset(
    what: str, variables: dict[str, contents.Variable], attributes: dict[str, Any]
) -> "Dataset":
    entries = {
        name: (dimensions, _storable(values), of)
        for name, (dimensions, values, of) in variables.items()
    }
    coordinates = {name: entries.pop(name) for name in _COORDINATES}
    return _xarray(what).Dataset(entries, coordinates, attributes)


def _storable(values: np.ndarray) -> np.ndarray:
    """Texts of any length."""
    return values.astype(object) if values.dtype.kind == "U" else values


def _xarray(what: str) -> Any:
    try:
        import h5netcdf  # noqa: F401
        import h5py  # noqa: F401
        import xarray
    except ImportError:
        raise missing("xarray, h5netcdf and h5py", what) from None
    return xarray
