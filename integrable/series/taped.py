"""The steps of a walk (:mod:`integrable.series.walk`) interpreted from a tape, for kinds without compiled code.

Coefficients up to the order ``wide`` are double-doubles, higher ones floats. The coefficients of both walks form one
pair (:data:`jacobian.native.kinds.TWIN_WIDES`), so that one instruction computes both.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.series.recurrences import coefficients
from integrable.series.room import BENT, FIRST, STEP, UNITS
from integrable.series.walk import FARTHEST, LANES
from integrable.series.walk_text import TIMES
from jacobian.numbers.sums import plus_product

__all__ = ["Lines", "OnTape"]


class Lines(NamedTuple):
    """A tape (kinds, left, right, rates) with the memory for its Taylor series.

    ``begin`` are the start values of variable and constant nodes, ``middles`` their values at the expansion point.
    ``series`` are the coefficients in double-doubles, ``floats`` those in floats, ``values`` two more numbers. The
    ``rows_of_…`` are views of the same memory, through which the numbers of one walk are accessed. ``wide``, ``order``
    and ``highs`` are those of :class:`integrable.series.walk.Given`. The first ``shown`` variables are returned.
    """

    tape: Any
    begin: Any
    middles: Any
    series: Any
    floats: Any
    values: Any
    rows_of_floats: Any
    rows_of_values: Any
    wide: int
    order: int
    shown: int
    highs: int


class OnTape(NamedTuple):
    """The same lines four times, in the place of a walk's :class:`integrable.series.walk.Codes`."""

    start: Lines
    series: Lines
    advance: Lines
    dense: Lines


def start(lines: Lines) -> None:
    """Writes the start values into the lines."""
    for n in range(len(lines.begin)):
        lines.middles[n] = lines.begin[n]
    # the coefficients of constants beyond order 0 are 0
    for n in range(len(lines.begin) * (lines.wide + 1)):
        lines.series[n] = 0 * lines.begin[0]
    for n in range(LANES * len(lines.begin) * (lines.order + 1)):
        lines.rows_of_floats[n] = 0.0


def series(lines: Lines, room: Any) -> None:
    """Computes the coefficients about the expansion point, and the ratios in the room that determine the step."""
    (kinds, left, right, rates), wide, order = lines.tape, lines.wide, lines.order
    unit = room[LANES * UNITS]
    for n in range(len(kinds)):
        lines.series[n * (wide + 1)] = lines.middles[n]
    coefficients(kinds, left, right, rates, 0, wide, unit, lines.series)
    for n in range(len(kinds)):
        for k in range(wide + 1 if n < len(rates) else wide):
            lines.floats[n * (order + 1) + k] = float(lines.series[n * (wide + 1) + k])
    coefficients(kinds, left, right, rates, wide, order, unit, lines.floats)
    for lane in range(LANES):
        put_ratios(lines, room, lane)


def put_ratios(lines: Lines, room: Any, lane: int) -> None:
    """Stores the largest ratio of the last two, and of the first two float, coefficients to the variable's size."""
    order, rows, bent = lines.order, lines.rows_of_floats, 0.0
    for m in range(4):
        room[LANES * m + lane] = 0.0
    for i in range(lines.shown):
        first, size = LANES * i * (order + 1) + lane, 1e-300
        for k in range(FIRST + 2):
            x = rows[first + LANES * k]
            if lane == 0:
                room[LANES * (lines.highs + i + k * lines.shown)] = x
            if k < FIRST:
                size = max(size, abs(x))
                bent = max(bent, abs(x)) if k > 1 else bent
        for m in range(4):
            k = order - 1 + m if m < 2 else lines.wide - 1 + m
            x = abs(rows[first + LANES * k]) / size
            # a NaN becomes FARTHEST, at which reach() returns 0
            x = x if x < FARTHEST else FARTHEST
            room[LANES * m + lane] = max(x, room[LANES * m + lane])
    room[LANES * BENT + lane] = bent


def advance(lines: Lines, room: Any) -> None:
    """Advances the expansion points of both walks by their steps."""
    for lane in range(LANES):
        put_ahead(lines, lane, room[LANES * STEP + lane], 0.0)
    for i in range(len(lines.tape[3])):
        lines.middles[i] = value(lines, i)


def dense(lines: Lines, lane: int, ahead: Any, rows: Any, place: int) -> None:
    """Writes the variables of a walk at the distances ``ahead`` as pairs (hi, lo) to ``rows[place]`` onward."""
    count = lines.shown
    for row in range(TIMES):
        put_ahead(lines, lane, ahead[row], ahead[TIMES + row])
        for i in range(count):
            lines.values[1] = value(lines, i)
            there = place + 2 * (row * count + i)
            rows[there] = lines.rows_of_values[2 * LANES + lane]
            rows[there + 1] = lines.rows_of_values[3 * LANES + lane]


def put_ahead(lines: Lines, lane: int, high: float, low: float) -> None:
    """Stores a distance of one walk, high + low, in ``values[0]``."""
    lines.rows_of_values[lane] = high
    lines.rows_of_values[LANES + lane] = low


def value(lines: Lines, i: int) -> Any:
    """Variable i at the distance ``values[0]``."""
    ahead, begin = lines.values[0], i * (lines.order + 1)
    near = float(ahead)
    rest = lines.floats[begin + lines.order]
    for k in range(lines.order - 1, lines.wide, -1):
        rest = rest * near + lines.floats[begin + k]
    total = lines.series[i * (lines.wide + 1) + lines.wide] + rest * near
    for k in range(lines.wide - 1, -1, -1):
        total = plus_product(lines.series[i * (lines.wide + 1) + k], total, ahead)
    return total + 0
