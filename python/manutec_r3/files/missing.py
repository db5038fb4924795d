"""What to install when a library is missing."""


def missing(library: str, what: str, extra: str = "files") -> ImportError:
    """Return the error for `what` needs a `library` that comes with an extra of the package."""
    return ImportError(f"{what}: expected {library}; pip install 'manutec-r3[{extra}]'")
