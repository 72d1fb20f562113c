"""The page of a race: for each problem a work–precision diagram and a table, in one HTML file that loads no other."""

from __future__ import annotations

from html import escape
from math import ceil, floor, log10
from typing import TYPE_CHECKING, NamedTuple

from integrable.scene.looks import LOOKS, look
from integrable.scene.tables import duration, figure

if TYPE_CHECKING:
    from collections.abc import Iterable

    from integrable.races.records import Course, Run

__all__ = ["diagram", "page"]

WIDTH, HEIGHT = 680, 440
LEFT, RIGHT, TOP, BOTTOM = 88, 14, 14, 50
"""The sizes in pixels of a diagram's margins, which hold the labels of its axes."""
LEAST = 1e-17
"""Smaller errors are drawn at this value, since they are below the resolution of a double."""
SIZE = 5.0
"""Pixels from the middle of a mark to its edge."""
_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
body { color: #222; background: #fff; }
h2 { margin-top: 2.5rem; } svg { width: 100%; height: auto; } svg text { font: 13px system-ui, sans-serif; fill: #222; }
.legend { display: flex; flex-wrap: wrap; gap: .2rem 1.2rem; list-style: none; padding: 0; }
.legend svg { width: 34px; height: 14px; vertical-align: middle; } .wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; } tr { border-bottom: 1px solid #ddd; }
td, th { padding: .15rem .7rem; text-align: right; }
td:first-child, th:first-child, td:nth-child(2), th:nth-child(2), td.note { text-align: left; }
.note { color: #666; }
"""
OWN = ("#CC0077", "#117733", "#4477AA", "#882255")
"""Colours of a user's own methods."""
_WORDS = """\
Each mark is one method at one setting. Across: the largest error of a component at any of the times, against a
solution that is known to more digits. Up: the run time of a start with its evaluation, the median of some runs. Down
and to the left is better. What a method imports, compiles or sets up once, before its first run, is in the table."""


class Axis(NamedTuple):
    """A logarithmic axis: decades ``low`` to ``high``, at pixels ``start`` to ``end``."""

    low: int
    high: int
    start: float
    end: float

    def at(self, value: float) -> float:
        """The pixel of a value; values outside the axis are drawn at its ends."""
        part = (log10(max(value, 1e-300)) - self.low) / (self.high - self.low)
        return self.start + min(max(part, 0.0), 1.0) * (self.end - self.start)

    def ticks(self, most: int) -> list[int]:
        """The decades of the axis that get a label, at most ``most`` + 1."""
        stride = next(n for n in (1, 2, 3, 5, 10, 20) if (self.high - self.low) / n <= most)
        return list(range(self.low, self.high + 1, stride))


def page(courses: Iterable[Course], note: str) -> str:
    """The HTML of the page that shows a race, with a note below its courses."""
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Error against run time</title>\n<style>{_STYLE}</style>\n</head>\n<body>\n"
        "<h1>Error against run time</h1>\n"
        f"<p>{_WORDS}</p>\n"
        + "\n".join(map(_section, courses))
        + f'\n<p class="note">{escape(note)}</p>\n</body>\n</html>\n'
    )


def _section(course: Course) -> str:
    q, p = course.letters
    source = f" ({escape(course.reference)})" if course.reference else ""
    head = (
        f'<h2 id="{escape(course.name)}">{escape(course.title)}</h2>\n<p>{escape(course.description)}{source} '
        f"{len(course.times)} times, the last is {max(course.times):g}. Errors are those of {q} and {p}, "
        "each beside its size.</p>"
    )
    return "\n".join([head, diagram(course), _legend(course), _table(course)])


def diagram(course: Course) -> str:
    """An SVG element that shows run time against error with a line for each method, and bands for the truth's radius
    and the floor.
    """
    drawn = [run for run in course.runs if run.error is not None and run.seconds is not None]
    errors = [max(run.error or 0.0, LEAST) for run in drawn] + [course.floor, max(course.radius, LEAST)]
    times = [run.seconds or 1e-9 for run in drawn] or [1.0]
    across = Axis(floor(log10(min(errors))), max(ceil(log10(max(errors))), 0), LEFT, WIDTH - RIGHT)
    low, high = floor(log10(min(times))), ceil(log10(max(times)))
    up = Axis(low, max(high, low + 1), HEIGHT - BOTTOM, TOP)
    bands, words = _bands(course, across)
    parts = [*bands, *_grid(across, up), *words]
    for name in dict.fromkeys(run.method for run in drawn):
        points = [
            (across.at(max(r.error or 0.0, LEAST)), up.at(r.seconds or 0.0), r) for r in drawn if r.method == name
        ]
        colour, marker, filled = _look(course, name)
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y, _ in points)
        parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.6"/>')
        parts += [f"<g>{_mark(x, y, colour, marker, filled)}<title>{_words(run)}</title></g>" for x, y, run in points]
    label = f"Error against run time on {course.title}"
    return f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label)}">' + "".join(parts) + "</svg>"


def _look(course: Course, name: str) -> tuple[str, str, bool]:
    """Colour and marker of a method. A user's methods have the colours of OWN, in the order of the race."""
    own = [method for method in dict.fromkeys(run.method for run in course.runs) if method not in LOOKS]
    return (OWN[own.index(name) % len(OWN)], "p", True) if name in own else look(name)


def _words(run: Run) -> str:
    return escape(f"{run.method}, {run.at}: error {figure(run.error)}, {duration(run.seconds)}")


def _bands(course: Course, across: Axis) -> tuple[list[str], list[str]]:
    """The bands of errors that are not significant, and their labels.

    One band has the errors below the truth's radius, the other those below the effect of rounding the inputs.
    """
    boxes, names = [], []
    for end, colour, words, height in (
        (course.floor, "#f0f0f0", "rounding of the inputs", 14),
        (max(course.radius, LEAST), "#dcdcdc", "the truth's radius", 30),
    ):
        x = across.at(end)
        box = f'x="{across.start:.1f}" y="{TOP}" width="{x - across.start:.1f}" height="{HEIGHT - TOP - BOTTOM}"'
        boxes.append(f'<rect {box} fill="{colour}"/>')
        names.append(f'<text x="{x + 5:.1f}" y="{TOP + height}" style="fill:#666">← {words}, {figure(end)}</text>')
    return boxes, names


def _grid(across: Axis, up: Axis) -> list[str]:
    bottom, left = up.start, across.start
    parts = []
    for n in across.ticks(9):
        x = across.at(10.0**n)
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{up.end}" y2="{bottom}" stroke="#e3e3e3"/>')
        parts.append(f'<text x="{x:.1f}" y="{bottom + 18}" text-anchor="middle">{_power(n)}</text>')
    for n in up.ticks(8):
        y = up.at(10.0**n)
        parts.append(f'<line x1="{left}" x2="{across.end}" y1="{y:.1f}" y2="{y:.1f}" stroke="#e3e3e3"/>')
        parts.append(f'<text x="{left - 7}" y="{y + 4:.1f}" text-anchor="end">{duration(10.0**n)}</text>')
    middle = (across.start + across.end) / 2
    parts.append(f'<text x="{middle}" y="{HEIGHT - 8}" text-anchor="middle">error (relative)</text>')
    height = (up.start + up.end) / 2
    parts.append(f'<text transform="translate(15 {height}) rotate(-90)" text-anchor="middle">run time</text>')
    parts.append(f'<path d="M{left} {up.end}V{bottom}H{across.end}" fill="none" stroke="#222"/>')
    return parts


def _power(n: int) -> str:
    return "1" if n == 0 else "10" + str(n).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


_SHAPES = {
    "s": ((-0.8, -0.8), (0.8, -0.8), (0.8, 0.8), (-0.8, 0.8)),
    "D": ((0, -1.1), (1.1, 0), (0, 1.1), (-1.1, 0)),
    "d": ((0, -1.2), (0.7, 0), (0, 1.2), (-0.7, 0)),
    "^": ((0, -1.1), (1, 0.8), (-1, 0.8)),
    "v": ((0, 1.1), (1, -0.8), (-1, -0.8)),
    "<": ((-1.1, 0), (0.8, -1), (0.8, 1)),
    ">": ((1.1, 0), (-0.8, -1), (-0.8, 1)),
    "p": ((0, -1.1), (1, -0.3), (0.65, 0.9), (-0.65, 0.9), (-1, -0.3)),
    "*": (
        (0, -1.4), (0.33, -0.45), (1.33, -0.43), (0.53, 0.17), (0.82, 1.13), (0, 0.56), (-0.82, 1.13), (-0.53, 0.17),
        (-1.33, -0.43), (-0.33, -0.45),
    ),
}  # fmt: skip
"""Markers by matplotlib's names, in units of SIZE; markers that are missing here are drawn as circles."""


def _mark(x: float, y: float, colour: str, marker: str, filled: bool) -> str:
    paint = f'fill="{colour if filled else "#fff"}" stroke="{colour}" stroke-width="1.4"'
    if marker not in _SHAPES:
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{SIZE}" {paint}/>'
    points = " ".join(f"{x + SIZE * a:.1f},{y + SIZE * b:.1f}" for a, b in _SHAPES[marker])
    return f'<polygon points="{points}" {paint}/>'


def _legend(course: Course) -> str:
    items = []
    for name in dict.fromkeys(run.method for run in course.runs):
        colour, marker, filled = _look(course, name)
        line = f'<line x1="0" x2="34" y1="7" y2="7" stroke="{colour}" stroke-width="1.6"/>'
        drawn = f'<svg viewBox="0 0 34 14" aria-hidden="true">{line}{_mark(17, 7, colour, marker, filled)}</svg>'
        items.append(f"<li>{drawn} {escape(name)}</li>")
    return f'<ul class="legend">{"".join(items)}</ul>'


def _table(course: Course) -> str:
    head = "".join(f"<th>{word}</th>" for word in ("method", "setting", "error", "run time", "once before", "runs"))
    rows = []
    for run in course.runs:
        first = duration(run.first) if run.first else "–"
        figures = [figure(run.error), duration(run.seconds), first, str(run.runs)]
        note = f'<td colspan="4" class="note">{escape(run.note)}</td>'
        cells = note if run.note else "".join(f"<td>{cell}</td>" for cell in figures)
        rows.append(f"<tr><td>{escape(run.method)}</td><td>{escape(run.at)}</td>{cells}</tr>")
    return f'<div class="wide"><table><tr>{head}</tr>{"".join(rows)}</table></div>'
