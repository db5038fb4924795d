"""Which build of the core runs: there is one for each processor that it was compiled for."""

from os import environ

from ._processor import builds as builds

# Forces a build, say to compare results of two machines bit by bit.
_VARIABLE = "MANUTEC_R3_PROCESSOR"


def chosen() -> str:
    """Return the build for this process: the last of `builds`, which come from slow to fast.

    Raises
    ------
    ImportError
        If the environment asks for a build that this processor cannot run or that was not made.
    """
    build = environ.get(_VARIABLE) or builds[-1]
    if build not in builds:
        raise ImportError(
            f"{_VARIABLE}: expected one of {', '.join(builds)} on this processor, got {build!r}"
        )
    return build
