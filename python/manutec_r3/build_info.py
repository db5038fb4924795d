"""What the simulator at hand was built from, and for which processor."""

from dataclasses import dataclass
from functools import cache
from importlib.metadata import version

from . import _core
from .processor import builds


@dataclass(frozen=True)
class BuildInfo:
    """How the core in use was built.

    Attributes
    ----------
    version : str
        Of manutec-r3.
    processor : str
        What it was compiled for: ``baseline``, any processor of the machine's kind, or
        ``x86-64-v3``, one with AVX2 and FMA. The environment variable ``MANUTEC_R3_PROCESSOR``
        chooses when the package is imported; without it the fastest that runs is taken. Results
        of the two differ by roundoff; each repeats bit by bit.
    available : tuple of str
        What this machine could use, the fastest last.
    compiler, flags : str
        Name and version of the compiler, and its options.
    sundials, eigen : str
        Versions of the libraries for integration and for linear algebra.
    """

    version: str
    processor: str
    available: tuple[str, ...]
    compiler: str
    flags: str
    sundials: str
    eigen: str


@cache
def build_info() -> BuildInfo:
    """Return what is in use: version, processor, compiler and libraries."""
    return BuildInfo(
        version=version("manutec-r3"),
        processor=_core.processor,
        available=builds,
        compiler=_core.compiler,
        flags=_core.compiler_flags,
        sundials=_core.sundials_version,
        eigen=_core.eigen_version,
    )
