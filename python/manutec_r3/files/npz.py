"""Results as archives of NumPy, which need nothing else."""

from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

import numpy as np

from . import contents

if TYPE_CHECKING:
    from ..result import Result


def write(path: str | Path, result: "Result") -> None:
    """Write a result; see `Result.save`."""
    variables, attributes = contents.of_result(result)
    arrays: dict[str, Any] = {name: variable.values for name, variable in variables.items()}
    np.savez(path, **arrays, **attributes)


def read(path: str | Path) -> "Result":
    """Read a result; see `Result.load`."""
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as archive:
            everything = dict(archive)
        # Texts and numbers have no dimension.
        attributes = {name: value.item() for name, value in everything.items() if value.ndim == 0}
        return contents.result_from(everything, attributes)
    except (BadZipFile, EOFError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from error
