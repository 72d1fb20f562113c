"""The page of a curve: lines with a name, a value, its certainty and its source."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import ArgumentError, shown
from jacobian.notebook import table

PROVEN, CONJECTURAL, NOT_KNOWN = "proven", "conjectural", "not known"


def to_digits(digits: int) -> str:
    """The ``mark`` of a :class:`Line` whose value is computed to this many digits."""
    return f"computed to {digits} digits"


class Line(NamedTuple):
    """A line of the page: ``text`` to read, and ``value`` in ints, strings, lists and dictionaries of them.

    ``mark``: PROVEN, CONJECTURAL, :func:`to_digits`, or NOT_KNOWN where the text says why; ``source``: the call that
    computes the value.
    """

    name: str
    text: str
    value: Any
    mark: str
    source: str


@dataclass(frozen=True)
class Page:
    """A page about ``curve``; ``page["torsion"]`` is a line of it. It prints as text; notebooks show a table."""

    curve: HyperellipticCurve
    lines: tuple[Line, ...]

    def __getitem__(self, name: str) -> Line:
        for line in self.lines:
            if line.name == name:
                return line
        raise ArgumentError(f"name = {shown(name)}: one of {[line.name for line in self.lines]} is needed")

    def __iter__(self) -> Iterator[Line]:
        return iter(self.lines)

    def __str__(self) -> str:
        width = max(len(line.name) for line in self.lines)
        return "\n".join(f"{line.name:{width}}  {line.text}  [{line.mark}]" for line in self.lines)

    def to_json(self) -> str:
        """All lines as JSON: {"curve": {"f": …, "h": …}, "lines": [{"name": …, "value": …, …}, …]}."""
        equation = {name: [str(c) for c in getattr(self.curve, name)] for name in ("f", "h")}
        lines = [line._asdict() for line in self.lines]
        return json.dumps({"curve": equation, "lines": lines}, ensure_ascii=False, indent=1)

    def _repr_html_(self) -> str:
        rows = [(line.name, line.text, line.mark) for line in self.lines]
        return table(repr(self.curve), ("", "value", "mark"), rows, len(rows))
