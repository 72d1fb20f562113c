"""How values show themselves in notebooks: a title and a table of two columns, or of more, in plain HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Any

__all__ = ["named", "table"]

# letters of a number or a polynomial that a cell shows
MOST = 120
# rows of a long table that are shown, of the beginning and of the end each
ENDS = 5


def named(title: str, facts: Iterable[tuple[str, Any]]) -> str:
    """A title and below it what it has, name by name."""
    return _page(title, "".join(_row([name, value]) for name, value in facts))


def table(title: str, heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> str:
    """A title and a table with a head; of a long one both ends."""
    head = "<tr>" + "".join(f"<th>{escape(x)}</th>" for x in heads) + "</tr>"
    if len(rows) <= 2 * ENDS:
        return _page(title, head + "".join(map(_row, rows)))
    gap = f'<tr><td colspan="{len(heads)}">… {len(rows) - 2 * ENDS} more …</td></tr>'
    return _page(title, head + "".join(map(_row, rows[:ENDS])) + gap + "".join(map(_row, rows[-ENDS:])))


def _page(title: str, rows: str) -> str:
    return f"<div><b>{escape(title)}</b><table>{rows}</table></div>"


def _row(cells: Sequence[Any]) -> str:
    return "<tr>" + "".join(f"<td>{escape(_text(x))}</td>" for x in cells) + "</tr>"


def _text(value: Any) -> str:
    if isinstance(value, (tuple, list)):
        return "(" + ", ".join(map(_text, value)) + ")"
    if isinstance(value, float):
        return f"{value:.10g}"
    text = str(value)
    return text if len(text) <= MOST else f"{text[:MOST]}…"
