"""Equations of motion in floats near their start: states by compiled Taylor series, where they are cheap and right."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.series.short import FINE, FINEST, Room, Way
from integrable.series.tape import PRODUCT, QUOTIENT, ROOT, Recorded, recorded
from jacobian.fields.inexact import InexactField
from jacobian.inexact.long_field import LongField
from jacobian.numbers.double_double import split

BITS = 128
"""Of the constants of equations and of starts."""
MOVED = 2.0**-104
"""By how much of themselves numbers differ in the second of two walks, some units of what double-doubles round to."""


# what a step takes beside its products, in these, and both for Neumann's point
FIXED, STANDARD = 3, 13
# steps up to which fine ones are tried, as of more the last bits are often lost, and how many fine ones a finest takes
FEW, DEARER = 1500, 1.35


class Recording(InexactField):
    """The numbers of a formula that is recorded: constants are those of ``field``."""

    name = "recorded numbers"

    def __init__(self, field: Any) -> None:
        self.field = field
        self.zero, self.one, self.eps = field.zero, field.one, field.eps

    def coerce(self, value: Any, argument: str = "value") -> Any:
        """A recorded number as it is, others as constants."""
        return value if isinstance(value, Recorded) else self.field.coerce(value)

    def dot(self, xs: Sequence[Any], ys: Sequence[Any]) -> Any:
        """Σ x_i y_i."""
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)

    def sqrt(self, x: Any) -> Any:
        """√x."""
        return x**0.5 if isinstance(x, Recorded) else self.field.sqrt(x)


class Equations:
    """y' = ``rates``(N, y) in numbers N with operators: ``half`` of y are q, as many p, then there may be others, until
    there are ``count``.
    """

    def __init__(self, rates: Callable[[Any, Sequence[Any]], Sequence[Any]], half: int, count: int) -> None:
        with LongField(BITS) as field:
            recording = Recording(field)
            kinds, left, right, constants, results = recorded(lambda y: rates(recording, y), count)
            self._middles = np.array([split(x) for x in constants])
        self._half = half
        self._tape = tuple(np.array(x, dtype=np.int64) for x in (kinds, left, right, results))
        sums = np.isin(self._tape[0], (PRODUCT, QUOTIENT, ROOT)).sum()
        self.weight = float(FIXED + sums) / STANDARD
        """About how long a step takes, beside one of Neumann's point on S²."""

    def around(self, start: Sequence[Any], times: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray]:
        """The places of ``times`` that are reached, and q and p there, shape (N, 2, half), right to the last bits of
        floats, from a start of long numbers. Where the last of the times takes more than about ``most`` steps, only
        those of the first steps are reached; none beyond a pole or where rounding has grown.
        """
        places, rows = [], []
        for ahead in (times >= 0, times < 0):
            order = np.flatnonzero(ahead)
            order = order[np.argsort(np.abs(times[order]))]
            if len(order):
                found, right = self._one_way(start, times[order], most)
                places.append(order[: len(found)][right])
                rows.append(found[right])
        return np.concatenate(places), np.concatenate(rows)

    def _one_way(self, start: Sequence[Any], times: np.ndarray, most: float) -> tuple[np.ndarray, np.ndarray]:
        """The rows at those of times, ascending or descending from 0, that are reached, and which of them are right."""
        from integrable.series.short_compiled import LIBRARY

        middles, count, half = self._middles.copy(), len(self._middles), self._half
        middles[: len(start)] = [split(x) for x in start]
        moved = middles.copy()
        # by different parts, as else it would be a change of units
        moved[:, 1] += MOVED * (np.arange(count) % 5 - 2.5) * middles[:, 0]
        begin, room = np.stack([middles, moved], axis=-1).reshape(count, 4), _room(count)
        out, again = np.empty((2, len(times) * 4 * half))
        few = float(min(most, FEW))
        for kind, steps in ((FINE, few), (FINEST, max(few, most / DEARER))):
            reached = LIBRARY.walked_twice(Way(self._tape, half, steps, begin), kind, room, times, out, again)
            rows, wrong = (x[::2].reshape(len(times), 2, half)[:reached] for x in (out, again))
            right = wrong[:, 0, 0] == 0
            if right.all() and (reached == len(times) or steps == most):
                break
        return rows, right


def _room(count: int) -> Room:
    """That of a tape of so many nodes."""
    floats, values = np.empty((count * (FINEST.order + 1), 2)), np.zeros((1, 4))
    wide, powers = np.empty((count * (FINEST.wide + 1), 4)), np.empty((FINEST.wide + 1, 4))
    rows = floats.reshape(-1), values.reshape(-1)
    return Room(np.empty((count, 4)), wide, floats, powers, values, *rows, np.empty((2, 2)), np.empty(2))
