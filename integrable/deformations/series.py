"""Marching along the Taylor series of a tape, and its values, for numbers of any kind; compiled for double-double
numbers in :mod:`integrable.deformations.series_compiled`.
"""

from __future__ import annotations

from math import exp, log
from typing import Any, NamedTuple

from integrable.series.recurrences import coefficients, values_at

__all__ = ["SeriesRoom", "evaluated", "march_along"]

# the number of steps after which the remaining ones are estimated from those done, and the factor by which they may
# differ
KNOWN_FROM = 4
UNEVEN = 4
# why a march ends before its last time: its steps shrink to nothing, or are too many
ENDS, FAR = 1, 2
# indices of a march's report: its steps, the lengths of the first and the current one, the times reached
STEPS, LONGEST, STEP, REACHED = range(4)


class SeriesRoom(NamedTuple):
    """The memory of a march: the value of every node at the centre of its series, that time, the series, and its
    report.
    """

    middles: Any
    now: Any
    series: Any
    told: Any


def march_along(
    tape: tuple[Any, Any, Any, Any], order: int, tolerance: float, most: float, strict: bool, room: SeriesRoom,
    times: Any, out: Any,
) -> int:  # fmt: skip
    """Writes the variables at ``times``, ascending from 0 or descending, into ``out``, row by row; 0, or why the last
    of them were not reached.

    ``tolerance`` is the logarithm of the error allowed in a step, ``most`` the largest number of steps until the last
    time if ``strict``, else until each.
    """
    count, told, now = len(tape[3]), room.told, room.now
    expand_about(tape, order, tolerance, room)
    for i in range(len(times)):
        told[REACHED] = i
        while abs(float(times[i] - now[0])) > told[STEP]:
            # as small relative to the time reached as the error allowed in a step
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


def evaluated(tape: tuple[Any, Any, Any, Any], rows: Any, middles: Any, series: Any, out: Any) -> None:
    """The results of a tape, as many as variables, for rows of variables; ``series`` has room for two of every node."""
    kinds, left, right, results = tape
    count = len(results)
    for row in range(len(rows) // count):
        i = row * count
        for n in range(count):
            middles[n] = rows[i + n]
        for n in range(len(middles)):
            series[2 * n] = middles[n]
        coefficients(kinds, left, right, results, 0, 1, 1, series)
        for n in range(count):
            out[i + n] = series[2 * n + 1]


def expand_about(tape: tuple[Any, Any, Any, Any], order: int, tolerance: float, room: SeriesRoom) -> None:
    """Expands the series about the state in ``room.middles``; the step that it allows."""
    kinds, left, right, rates = tape
    for n in range(len(room.middles)):
        room.series[n * (order + 1)] = room.middles[n]
    coefficients(kinds, left, right, rates, 0, order, 1, room.series)
    room.told[STEPS] += 1
    room.told[STEP] = step_within(order, tolerance, len(rates), room.series)
    if room.told[LONGEST] == 0:
        room.told[LONGEST] = room.told[STEP]


def step_within(order: int, tolerance: float, count: int, series: Any) -> float:
    """The step after which the last two coefficients are below the tolerance; 0 where they are not numbers."""
    width, found, most = order + 1, 1e300, abs(series[0])
    for n in range(1, count):
        most = max(most, abs(series[n * width]))
    for first in range(0, count, 3):
        last, size = min(first + 3, count), abs(series[first * width])
        for n in range(first + 1, last):
            size = max(size, abs(series[n * width]))
        # components at rest are measured by the others
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


def too_long(told: Any, most: float, now: float, end: float) -> bool:
    """Whether the steps done, or those expected until ``end``, are more than ``most``."""
    part = abs(now / end)
    expected = told[STEPS] / part if told[STEPS] >= KNOWN_FROM and part > 0 else 0.0
    return told[STEPS] > most or expected > UNEVEN * most
