"""A walk along Taylor series whose straight lines are compiled for the kind of system (:mod:`integrable.series.kinds`).

The loop is compiled once for all kinds (:mod:`integrable.series.walk_compiled`). Two walks go together, in the lanes of
each number. The second takes coarser steps of its own, the first of them a short one backwards, from a start changed by
about a rounding unit. The difference of the walks estimates the error of a row.
"""

from __future__ import annotations

import ctypes
from math import exp, floor, log, log2
from typing import Any, NamedTuple

from integrable.series.room import BENT, FIRST, STEP, UNITS
from integrable.series.walk_text import TIMES

__all__ = ["Bounds", "Codes", "Given", "walked"]

LANES = 2
FARTHEST = 1e300
# the part of its first step that the second walk goes back: about the same start both would have the same terms in
# floats, with the same errors
BACK = 0.25
# steps are multiples of this, in the unit of time, so that sums of steps below 2^53 times this are exact
GRAIN = 2.0**-36
MOST_UNITS = 2.0**16
# a walk goes on if ``most`` steps, UNEVEN times as long as the present one, would reach the last time; after KNOWN
# steps, if EVEN times ``most`` steps of the mean length would
UNEVEN, KNOWN, EVEN = 4, 64, 1.25
# a walk ends after more than MOST_LOST rows that are wrong or predict that the last row is. Predictions count from
# 1/KNOWN_FROM of the last time on, if the difference predicted exceeds HOPELESS times the allowed one
MOST_LOST, KNOWN_FROM, HOPELESS = 2, 16, 4.0


class Codes(NamedTuple):
    """Where the straight lines of a kind are (:mod:`integrable.series.walk_text`)."""

    start: int
    series: int
    advance: int
    dense: int


class Bounds(NamedTuple):
    """Logarithms to base 2 of what a step may leave out: of the last two terms, and of the first two in floats; by how
    much more in the second walk. Then 1 over the orders of the four terms and the difference up to which rows agree;
    the largest number of steps, judged by those taken, and the farthest time, in first steps.
    """

    left_out: float
    rounded: float
    coarser: float
    rougher: float
    last_but_one: float
    last: float
    first_float: float
    second_float: float
    agreed: float
    most: float
    farthest: float


class Given(NamedTuple):
    """Constants, a state in floats, and the layout of the room. Its variables are ``parts`` (q, p and any others) of
    ``half`` numbers each. Coefficients begin at ``highs``, those of the next order ``apart`` further on. A spare row of
    eight floats is at ``spare``.
    """

    constants: Any
    state: Any
    half: int
    parts: int
    order: int
    highs: int
    wide: int
    spare: int
    apart: int


class Compared(NamedTuple):
    """The comparison of the first ``rows`` rows of both walks: how many are ``wrong``, how many are wrong or predict
    that the last one is (``lost``), and the largest difference.
    """

    rows: int
    wrong: int
    lost: int
    gap: float


class Place(NamedTuple):
    """The number of a walk, its time, how far its series reach, and its next row."""

    lane: int
    now: float
    step: float
    row: int


def walked(codes: Codes, bounds: Bounds, given: Given, room: Any, units: Any, times: Any, rows: Any, found: Any) -> Any:
    """(How many of ``times`` were reached, how many of these are wrong, the largest difference of the walks relative to
    the largest q, or p, the number of steps). q and p go into ``found``.

    ``times`` must be of one sign and ascend in size; otherwise the first number is −1. The row of a wrong one in
    ``rows`` begins with a nonzero number.
    """
    if not in_order(times):
        return -1, 0, 0.0, 0
    start(codes.start, given.constants, given.state, room)
    unit = begun(codes, given, room, units)
    limit, done, behind, steps, seen = len(times), 0, 0, 0, Compared(0, 0, 0, 0.0)
    now, later = 0.0, 0.0
    ahead = -1.0 if times[limit - 1] < 0 else 1.0
    first, second = reach(bounds, room, 0), reach(bounds, room, 1)
    if not abs(times[limit - 1]) <= bounds.farthest * first * unit:
        return 0, 0, 0.0, 0
    if second < FARTHEST:
        second = BACK * second
    while True:
        done = put_rows(codes, given, room, Place(0, now, first, done), times, limit, unit, rows)
        if done < limit and not goes_on(first, now, times[limit - 1] / unit, steps, bounds.most):
            limit = done
        behind = put_rows(codes, given, room, Place(1, later, second, behind), times, limit, unit, rows)
        if behind < limit and not goes_on(second, later, times[limit - 1] / unit, steps, bounds.most):
            limit = behind
        seen = compared(given, bounds.agreed, seen, min(done, behind, limit), times, rows, found)
        if seen.lost > MOST_LOST:
            limit = seen.rows
        if done >= limit and behind >= limit:
            break
        room[LANES * STEP] = ahead * first if done < limit else 0.0
        room[LANES * STEP + 1] = (-ahead if steps == 0 else ahead) * second if behind < limit else 0.0
        now += room[LANES * STEP]
        later += room[LANES * STEP + 1]
        advance(codes.advance, room)
        series(codes.series, room)
        first, second = reach(bounds, room, 0), reach(bounds, room, 1)
        steps += 1
    return limit, seen.wrong, seen.gap, steps


def in_order(times: Any) -> bool:
    """Whether times are finite, of one sign, and ascend in size."""
    before = 0.0
    down = times[len(times) - 1] < 0
    for i in range(len(times)):
        time = -times[i] if down else times[i]
        if not before <= time < FARTHEST:
            return False
        before = time
    return True


def begun(codes: Codes, given: Given, room: Any, units: Any) -> float:
    """The series at the start, and the unit of their time: a power of two near the shortest time in which q or p
    change, so that coefficients stay among the floats, and a motion in other units has the same steps.
    """
    put_unit(given, room, units, 1.0)
    series(codes.series, room)
    unit, shortest = 1.0, shortest_time(given, room)
    while unit < shortest < FARTHEST:
        unit *= 2.0
    while unit > shortest:
        unit /= 2.0
    if unit != 1:
        put_unit(given, room, units, unit)
        series(codes.series, room)
    return unit


def put_unit(given: Given, room: Any, units: Any, unit: float) -> None:
    """``unit``/(k + 1) into the room."""
    high, low = LANES * UNITS, LANES * (UNITS + given.order)
    for k in range(given.order):
        for lane in range(LANES):
            room[high + LANES * k + lane] = unit * units[2 * k]
            if k <= given.wide:
                room[low + LANES * k + lane] = unit * units[2 * k + 1]


def shortest_time(given: Given, room: Any) -> float:
    """The shortest time in which q or p change, by their first coefficients, 1 being the unit."""
    shortest = FARTHEST
    for begin in (0, given.half):
        for j in range(FIRST):
            # coefficients two orders apart: from rest, or nearly, every other one is small
            before, after = largest(given, room, begin, j), largest(given, room, begin, j + 2)
            if 0 < before < FARTHEST and 0 < after < FARTHEST:
                shortest = min(shortest, exp((log(before) - log(after)) / 2))
    return shortest


def largest(given: Given, room: Any, begin: int, k: int) -> float:
    """The largest coefficient k of q, or of p, which begin at ``begin``."""
    found = 0.0
    for i in range(begin, begin + given.half):
        found = max(found, abs(room[LANES * (given.highs + i + k * given.apart)]))
    return found


def reach(bounds: Bounds, room: Any, lane: int) -> float:
    """How far the series of a walk reach; 0 where they are no numbers, or where the last are below the range."""
    left_out, rounded = bounds.left_out, bounds.rounded
    if lane > 0:
        left_out, rounded = left_out + bounds.coarser, rounded + bounds.rougher
    before, last, odd, even = room[lane], room[LANES + lane], room[2 * LANES + lane], room[3 * LANES + lane]
    if not (before < FARTHEST and last < FARTHEST and odd < FARTHEST and even < FARTHEST):
        return 0.0
    if before == 0 and last == 0 and odd == 0 and even == 0:
        return FARTHEST if room[LANES * BENT + lane] == 0 else 0.0
    found = min((left_out - logarithm(before)) * bounds.last_but_one, (left_out - logarithm(last)) * bounds.last)
    found = min(found, (rounded - logarithm(odd)) * bounds.first_float)
    found = min(found, (rounded - logarithm(even)) * bounds.second_float)
    return float(floor(power(min(found, 25.0)) / GRAIN)) * GRAIN if found > -1000 else 0.0


def put_rows(codes: Codes, given: Given, room: Any, at: Place, times: Any, limit: int, unit: float, rows: Any) -> int:
    """The first row that the series of one walk do not reach; the rows from its next one up to there are written."""
    width, ahead = 2 * given.parts * given.half, room[given.spare : given.spare + 2 * TIMES]
    lane, now, step, row = at
    fitting = TIMES
    while fitting == TIMES:
        fitting = 0
        while fitting < TIMES and row + fitting < limit:
            time = times[row + fitting] / unit
            left = time - now
            if not (step > 0 and abs(left) <= step):
                break
            # the rounding error of the difference
            back = left - time
            ahead[fitting] = left
            ahead[TIMES + fitting] = (time - (left - back)) - (now + back)
            fitting += 1
        if fitting > 0:
            for i in range(fitting, TIMES):
                ahead[i] = ahead[0]
                ahead[TIMES + i] = ahead[TIMES]
            dense(codes.dense, room, lane, ahead, rows, (lane * (len(times) + TIMES) + row) * width)
            row += fitting
    return row


def goes_on(step: float, now: float, last: float, steps: int, most: float) -> bool:
    """Whether the last time can be reached in about ``most`` steps, judged by the present or by the mean step."""
    left, gone = abs(last - now), abs(now)
    if not (step > 0 and gone < MOST_UNITS):
        return False
    return left < UNEVEN * most * step if steps < KNOWN else steps * (gone + left) < EVEN * most * gone


def compared(given: Given, agreed: float, seen: Compared, limit: int, times: Any, rows: Any, found: Any) -> Compared:
    """The comparison of both walks up to row ``limit``; the rows of the first, rounded, go into ``found``."""
    half, width, count = given.half, given.parts * given.half, len(times)
    wrong, lost, worst = seen.wrong, seen.lost, seen.gap
    for row in range(seen.rows, limit):
        off, widest = 0.0, 0.0
        for part in range(given.parts):
            size, gap = 0.0, 0.0
            for i in range(part * half, (part + 1) * half):
                first, second = 2 * (row * width + i), 2 * ((row + count + TIMES) * width + i)
                found[row * width + i] = rows[first]
                size = max(size, abs(rows[first]))
                rest = abs((rows[first] - rows[second]) + (rows[first + 1] - rows[second + 1]))
                gap = rest if not rest <= gap else gap
            if not gap <= agreed * size:
                off = 1.0
            gap = gap / size if size > 0 else gap
            widest = gap if not gap <= widest else widest
        if off > 0:
            wrong += 1
        worst = widest if not widest <= worst else worst
        # the difference of the walks grows at least linearly in time
        way, last = abs(times[row]), abs(times[count - 1])
        if off > 0 or (way * KNOWN_FROM > last and not widest * last <= HOPELESS * agreed * way):
            lost += 1
        rows[2 * row * width] = off
    return Compared(limit, wrong, lost, worst)


# --- the straight lines of a kind, and logarithms off the bits: instructions where it is compiled


def start(code: int, constants: Any, state: Any, room: Any) -> None:
    """The constants and the state into a room."""
    _called(code, constants, state, room)


def series(code: int, room: Any) -> None:
    """The coefficients about the state in a room."""
    _called(code, room)


def advance(code: int, room: Any) -> None:
    """The state a step further."""
    _called(code, room)


def dense(code: int, room: Any, lane: int, ahead: Any, rows: Any, place: int) -> None:
    """States of a walk at some distances, from ``rows[place]`` on."""
    _called(code, room[lane:], ahead, rows[place:])


def _called(code: int, *arrays: Any) -> None:
    ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * len(arrays))(code)(*(x.ctypes.data for x in arrays))


def logarithm(x: float) -> float:
    """About log₂ x, to 0.1; some −1000 of 0."""
    return log2(x) if x > 0 else -1023.0


def power(x: float) -> float:
    """About 2^x, to 1 %."""
    return float(2.0**x)
