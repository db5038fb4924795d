"""XML files: numbers, and a comment of remarks at the top."""

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from xml.etree import ElementTree

from ... import __name__ as package


def numbers(*values: float) -> str:
    """Return numbers as XML has them, to the last digit."""
    return " ".join(repr(float(value) + 0.0) for value in values)  # no -0.0


def short(*values: float) -> str:
    """Return numbers of what is only to be seen, to six digits."""
    return " ".join(f"{float(value) + 0.0:.6g}" for value in values)


def with_remarks(root: ElementTree.Element, title: str, remarks: Iterable[str]) -> None:
    """Put a comment in front of what an element contains."""
    lines = [f"{title}, written by {package}.", *(f"* {remark}" for remark in remarks)]
    root.insert(0, ElementTree.Comment("\n  ".join(["", *lines]) + "\n  "))


def write(root: ElementTree.Element, path: str | PathLike[str]) -> None:
    """Write a document."""
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path: expected a name of a file, got {path!r}")
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    Path(path).write_text(f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n', encoding="utf-8")
