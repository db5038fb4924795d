"""Tables for readers of notebooks."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import Any

# Titles may be longer than their tables are wide.
_CAPTION = "text-align: left; white-space: nowrap; font-weight: bold"
_LEFT, _RIGHT = "text-align: left", "text-align: right"


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return a table with a line of headings; texts are escaped, numbers have six digits."""
    head = "".join(_cell("th", column, _RIGHT) for column in columns)
    body = "".join(f"<tr>{''.join(_cell('td', v, _RIGHT) for v in row)}</tr>" for row in rows)
    return _table(title, f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>")


def facts(title: str, of: Mapping[str, Any]) -> str:
    """Return a table of names and what they stand for."""
    rows = (_cell("th", name, _LEFT) + _cell("td", value, _LEFT) for name, value in of.items())
    return _table(title, f"<tbody>{''.join(f'<tr>{row}</tr>' for row in rows)}</tbody>")


def _table(title: str, inside: str) -> str:
    return f'<table><caption style="{_CAPTION}">{escape(title)}</caption>{inside}</table>'


def _cell(tag: str, value: Any, style: str) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f'<{tag} style="{style}">{escape(text)}</{tag}>'
