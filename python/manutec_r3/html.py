"""Tables for readers of notebooks."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table with a line of headings; texts are escaped, numbers have six digits."""
    head = "".join(f"<th>{escape(column)}</th>" for column in columns)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return (
        f"<table><caption>{escape(title)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def facts(title: str, of: Mapping[str, Any]) -> str:
    """Return a table of names and what they stand for."""
    body = "".join(f"<tr><th>{escape(name)}</th>{_cell(value)}</tr>" for name, value in of.items())
    return f"<table><caption>{escape(title)}</caption><tbody>{body}</tbody></table>"


def _cell(value: Any) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f"<td>{escape(text)}</td>"
