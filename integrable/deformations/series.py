"""Loops that integrate the equations of a tape by Taylor series, interpreted for numbers of any kind or compiled for
double-doubles.
"""

from __future__ import annotations

from math import exp, log
from typing import NamedTuple

from integrable.moving_point.addition import Row
from integrable.series.recurrences import coefficients, values_at
from jacobian.native.kinds import BOOL, FLOAT, FLOATS, INT, INTS, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.native.special import SPECIAL

__all__ = ["LIBRARY", "SeriesRoom", "march_along"]

# the remaining steps are estimated after KNOWN_FROM steps; the estimate may be wrong by the factor UNEVEN
KNOWN_FROM = 4
UNEVEN = 4
# reasons why a march ends before its last time: its steps shrink to 0 (ENDS), or are too many (FAR)
ENDS, FAR = 1, 2
# indices in a march's report: number of steps, lengths of the first and of the current step, number of times reached
STEPS, LONGEST, STEP, REACHED = range(4)


class SeriesRoom(NamedTuple):
    """The memory of :func:`march_along`.

    ``middles`` are the values of all nodes at the expansion point, ``now`` is its time, ``series`` the coefficients and
    ``told`` the report.
    """

    middles: Row
    now: Row
    series: Row
    told: Row


def march_along(
    tape: tuple[Row, Row, Row, Row], order: int, tolerance: float, most: float, strict: bool, room: SeriesRoom,
    times: Row, out: Row,
) -> int:  # fmt: skip
    """Writes the variables at ``times``, which ascend or descend from 0, to ``out``, row by row.

    Returns 0 if all times are reached, otherwise the reason ENDS or FAR. ``tolerance`` is the logarithm of the error
    allowed per step. ``most`` is the largest number of steps: to the last time if ``strict``, otherwise to each time.
    """
    count, told, now = len(tape[3]), room.told, room.now
    expand_about(tape, order, tolerance, room)
    for i in range(len(times)):
        told[REACHED] = i
        while abs(float(times[i] - now[0])) > told[STEP]:
            # the motion ends if a step, relative to the time reached, is below the error allowed per step
            if not told[STEP] > exp(tolerance) * max(told[LONGEST], abs(float(now[0]))):
                return ENDS
            if too_long(told, most, float(now[0]), float(times[len(times) - 1 if strict else i])):
                return FAR
            step = told[STEP] if float(times[i]) > 0 else -told[STEP]
            values_at(0 * now[0] + step, order, room.series, count, room.middles, 0)
            now[0] = now[0] + step
            expand_about(tape, order, tolerance, room)
        values_at(times[i] - now[0], order, room.series, count, out, i * count)
    told[REACHED] = len(times)
    return 0


def expand_about(tape: tuple[Row, Row, Row, Row], order: int, tolerance: float, room: SeriesRoom) -> None:
    """Expands the series about the state in ``room.middles``, and stores the step that it allows."""
    kinds, left, right, rates = tape
    for n in range(len(room.middles)):
        room.series[n * (order + 1)] = room.middles[n]
    coefficients(kinds, left, right, rates, 0, order, 1, room.series)
    room.told[STEPS] += 1
    room.told[STEP] = step_within(order, tolerance, len(rates), room.series)
    if room.told[LONGEST] == 0:
        room.told[LONGEST] = room.told[STEP]


def step_within(order: int, tolerance: float, count: int, series: Row) -> float:
    """The largest step at which the last two terms are below the tolerance; 0 if they are NaN."""
    width, found, most = order + 1, 1e300, abs(series[0])
    for n in range(1, count):
        most = max(most, abs(series[n * width]))
    for first in range(0, count, 3):
        last, size = min(first + 3, count), abs(series[first * width])
        for n in range(first + 1, last):
            size = max(size, abs(series[n * width]))
        # a vector that is 0 is measured relative to the largest variable
        size = size if size > 0 else most
        for k in range(order - 1, order + 1):
            part = 0.0
            for n in range(first, last):
                x = float(abs(series[n * width + k]) / size)
                part = x if not x <= part else part
            if part != part:
                return 0.0
            if part > 0:
                found = min(found, exp((tolerance - log(part)) / k))
    return found


def too_long(told: Row, most: float, now: float, end: float) -> bool:
    """Whether the steps so far exceed ``most``, or those expected until ``end`` exceed UNEVEN times ``most``."""
    part = abs(now / end)
    expected = told[STEPS] / part if told[STEPS] >= KNOWN_FROM and part > 0 else 0.0
    return told[STEPS] > most or expected > UNEVEN * most


_TAPE, _ROOM = TupleKind((INTS, INTS, INTS, INTS)), record(SeriesRoom, WIDES, WIDES, WIDES, FLOATS)
LIBRARY = Library(
    "taylor_series",
    {"march": (march_along, (_TAPE, INT, FLOAT, FLOAT, BOOL, _ROOM, WIDES, WIDES))},
    SPECIAL,
)
