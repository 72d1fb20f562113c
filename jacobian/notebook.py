"""HTML for notebooks: a title and a table of values."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

from jacobian.errors import written

__all__ = ["named", "table"]

# the largest number of characters of a value in the table
MOST = 120
# rows shown at the beginning and at the end of a long table
ENDS = 5


def named(title: str, facts: Iterable[tuple[str, Any]]) -> str:
    """The HTML of a title and a table with a row for each (name, value)."""
    return _page(title, "".join(_row([name, value]) for name, value in facts))


def table(title: str, heads: Sequence[str], rows: Sequence[Sequence[Any]], ends: int = ENDS) -> str:
    """The HTML of a title and a table with a head; a table of more than 2·``ends`` rows shows both ends."""
    head = "<tr>" + "".join(f"<th>{escape(x)}</th>" for x in heads) + "</tr>"
    if len(rows) <= 2 * ends:
        return _page(title, head + "".join(map(_row, rows)))
    gap = f'<tr><td colspan="{len(heads)}">… {len(rows) - 2 * ends} more …</td></tr>'
    return _page(title, head + "".join(map(_row, rows[:ends])) + gap + "".join(map(_row, rows[-ends:])))


def _page(title: str, rows: str) -> str:
    return f"<div><b>{escape(title)}</b><table>{rows}</table></div>"


def _row(cells: Sequence[Any]) -> str:
    return "<tr>" + "".join(f"<td>{escape(_text(x))}</td>" for x in cells) + "</tr>"


def _text(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return "(" + ", ".join(map(_text, value)) + ")"
    if isinstance(value, float):
        return f"{value:.10g}"
    text = written(value)
    return text if len(text) <= MOST else f"{text[:MOST]}…"
