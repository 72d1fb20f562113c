"""Short runs in floats along the Taylor series of a tape, right to their last bits; compiled in
:mod:`integrable.series.short_compiled`.

Of the terms of a step the first count most: the first few coefficients are double-double numbers, those beyond are
floats, and so a step costs little more than one in floats and is good to twenty digits. What rounding and what is left
out have grown to is found out by walking twice: the second walk has other steps, good to two digits less, the first of
them a short one back, and a start that is moved by what it was rounded by. Both go together, as the numbers of an item
of two (:data:`jacobian.native.kinds.TWIN_WIDES`), on which one instruction does the same.
"""

from __future__ import annotations

from math import exp, log
from typing import Any, NamedTuple

from integrable.series.recurrences import coefficients
from jacobian.numbers.sums import plus_product

__all__ = ["FINE", "FINEST", "Room", "Steps", "Way", "walked_twice"]

# what the two walks may differ by, beside the largest number of q, or of p: an eighth of what rounding to floats is, as
# terms in floats may be off by nearly as much in the finer one
AGREED = 2.0**-56
# coefficients that the unit of time is read off
FIRST = 4
# how many times as long as the present one steps may become, and after so many of them as their mean
UNEVEN, KNOWN, EVEN = 4, 64, 1.25
# what part of its first step the second walk goes back: about the start both have the same terms in floats, which count
# for nothing nearer than that
BACK = 0.25
FARTHEST = 1e300


class Steps(NamedTuple):
    """A kind of steps: coefficients up to ``wide`` are wide, those up to ``order``, an even number of them, floats;
    what is left out is the part ``left_out`` of each q and p, the first terms in floats are at most ``rounded`` times
    these; in the second walk ``coarser`` times that.
    """

    wide: int
    order: int
    left_out: float
    coarser: float
    rounded: float


FINE, FINEST = Steps(12, 36, 1e-24, 1e2, 1e-7), Steps(18, 44, 1e-29, 1e3, 1e-11)


class Room(NamedTuple):
    """What two walks work in, in items of two numbers: the values of all nodes where their series are, the series, wide
    and in floats, powers of how far from there they are taken, and values there.

    Numbers of one walk are read and written in the same memory as rows of floats: those of the series in floats and of
    the values, which have four to an item, the high parts first. ``now``: where their series are; ``steps``: how far
    these reach.
    """

    middles: Any
    wide: Any
    floats: Any
    powers: Any
    values: Any
    rows_of_floats: Any
    rows_of_values: Any
    now: Any
    steps: Any


class Way(NamedTuple):
    """What is walked: the variables are q and p, ``half`` of each, and further ones, with the rates of ``tape``; not
    many more steps than ``most``. ``start`` has the values of all nodes that are variables or constants, and the same
    but for their last bits.
    """

    tape: Any
    half: int
    most: float
    start: Any


def walked_twice(way: Way, kind: Steps, room: Room, times: Any, out: Any, again: Any) -> int:
    """q and p at ``times``, ascending from 0 or descending, into ``out``, row by row, (hi, lo) each: how many were
    reached. Where ``again`` begins a row with a number that is not 0, the row is not right to the last bits of floats.
    """
    unit, steps = begun(way, kind, room), 0
    done, limit = 0, len(times)
    behind = gone_back(way, kind, room, times, unit, again)
    while True:
        done = put_rows(way, kind, room, 0, times[:limit], unit, done, out)
        if done < limit and not goes_on(way, room, 0, times[limit - 1] / unit, steps):
            limit = done
        behind = put_rows(way, kind, room, 1, times[:limit], unit, behind, again)
        if behind < limit and not goes_on(way, room, 1, times[limit - 1] / unit, steps):
            limit = behind
        if behind >= limit and done >= limit:
            break
        steps += 1
        ahead = 1.0 if times[limit - 1] > 0 else -1.0
        step_by(way, kind, room, unit, ahead if done < limit else 0.0, ahead if behind < limit else 0.0)
    for row in range(limit):
        compare(way, row, out, again)
    return limit


def compare(way: Way, row: int, out: Any, again: Any) -> None:
    """A number that is not 0 at the beginning of a row of ``again`` that is not that of ``out``, else 0."""
    wrong = 0.0
    for part in range(2):
        begin = (2 * row + part) * way.half
        size, gap = 0.0, 0.0
        for i in range(begin, begin + way.half):
            size = max(size, abs(out[2 * i]))
            rest = abs((out[2 * i] - again[2 * i]) + (out[2 * i + 1] - again[2 * i + 1]))
            gap = rest if not rest <= gap else gap
        if not gap <= AGREED * size:
            wrong = 1.0
    again[4 * row * way.half] = wrong


def begun(way: Way, kind: Steps, room: Room) -> float:
    """The series at the start, and the unit of their time."""
    for n in range(len(way.start)):
        room.middles[n] = way.start[n]
    # constants have no further coefficients
    for n in range(len(way.start) * (kind.wide + 1)):
        room.wide[n] = 0 * way.start[0]
    for n in range(2 * len(way.start) * (kind.order + 1)):
        room.rows_of_floats[n] = 0.0
    for lane in range(2):
        room.now[lane] = 0
    unit = unit_of_time(way, kind, room)
    expanded(way, kind, room, unit)
    return unit


def gone_back(way: Way, kind: Steps, room: Room, times: Any, unit: float, again: Any) -> int:
    """The first row of the second walk that is not near the start; if there is one, this walk is put back."""
    if room.steps[1] == FARTHEST:
        return 0
    room.steps[1] = BACK * room.steps[1]
    row = put_rows(way, kind, room, 1, times, unit, 0, again)
    if row < len(times):
        step_by(way, kind, room, unit, 0.0, -1.0 if times[row] > 0 else 1.0)
    return row


def put_rows(way: Way, kind: Steps, room: Room, lane: int, times: Any, unit: float, row: int, out: Any) -> int:
    """The rows of one walk from ``row`` on that its series reach: the first that they do not reach."""
    count, step = 2 * way.half, room.steps[lane]
    while row < len(times):
        ahead = times[row] / unit - room.now[lane]
        if not (step > 0 and abs(float(ahead)) <= step):
            return row
        put_ahead(room, lane, ahead)
        put_powers(kind, room.powers, room.values[0], step == FARTHEST)
        for i in range(count):
            room.values[0] = value(kind, room, i)
            out[2 * (row * count + i)] = room.rows_of_values[lane]
            out[2 * (row * count + i) + 1] = room.rows_of_values[2 + lane]
        row += 1
    return row


def goes_on(way: Way, room: Room, lane: int, last: float, steps: int) -> bool:
    """Whether the last time is near enough to go there."""
    left, gone = abs(float(last - room.now[lane])), abs(float(room.now[lane]))
    if steps < KNOWN:
        return left < UNEVEN * way.most * room.steps[lane]
    # of coefficients that are no numbers a step is 0
    return room.steps[lane] > 0 and steps * (gone + left) < EVEN * way.most * gone


def step_by(way: Way, kind: Steps, room: Room, unit: float, first: float, second: float) -> None:
    """The walks have gone their steps times these, and have their series there."""
    for lane in range(2):
        ahead = (second if lane > 0 else first) * room.steps[lane] + 0 * room.now[lane]
        put_ahead(room, lane, ahead)
        room.now[lane] = room.now[lane] + ahead
    put_powers(kind, room.powers, room.values[0], False)
    for i in range(len(way.tape[3])):
        room.middles[i] = value(kind, room, i)
    expanded(way, kind, room, unit)


def put_ahead(room: Room, lane: int, ahead: Any) -> None:
    """A distance of one walk into the first of the values."""
    room.rows_of_values[lane] = float(ahead)
    room.rows_of_values[2 + lane] = float(ahead - float(ahead))


def put_powers(kind: Steps, powers: Any, ahead: Any, straight: bool) -> None:
    """Those of ``ahead``, from 0 to the last that has a wide coefficient; 0 instead of all that count for nothing where
    all is ``straight``, as the distance may be as large as a float.
    """
    powers[0], powers[1] = 0 * ahead + 1, ahead
    for k in range(2, kind.wide + 1):
        powers[k] = 0 * ahead if straight else powers[k // 2] * powers[k - k // 2]


def value(kind: Steps, room: Room, i: int) -> Any:
    """Variable i at the distance from the middle of its series whose powers are in the room."""
    first, last, powers = i * (kind.wide + 1), kind.wide, room.powers
    rest = tail(room.floats, i * (kind.order + 1), last, kind.order, float(powers[1]), float(powers[2]))
    total = plus_product(0 * powers[0], room.wide[first + last] + rest, powers[last])
    for k in range(last - 1, -1, -1):
        total = plus_product(total, room.wide[first + k], powers[k])
    return total + 0


def tail(floats: Any, first: int, wide: int, order: int, ahead: Any, square: Any) -> Any:
    """The terms beyond the wide ones, over that power of ``ahead``."""
    # in two sums, which do not wait for each other
    even, odd = 0 * ahead, 0 * ahead
    for k in range(order, wide + 1, -2):
        even = even * square + floats[first + k]
        odd = odd * square + floats[first + k - 1]
    return (even * ahead + odd) * ahead


def expanded(way: Way, kind: Steps, room: Room, unit: float) -> None:
    """The series about the states that are in ``room.middles``, in a unit of time, and how far they reach."""
    kinds, left, right, rates = way.tape
    wide, order = kind.wide, kind.order
    for n in range(len(kinds)):
        room.wide[n * (wide + 1)] = room.middles[n]
    coefficients(kinds, left, right, rates, 0, wide, unit, room.wide)
    for n in range(len(kinds)):
        for k in range(wide + 1 if n < len(rates) else wide):
            room.floats[n * (order + 1) + k] = float(room.wide[n * (wide + 1) + k])
    coefficients(kinds, left, right, rates, wide, order, unit, room.floats)
    for lane in range(2):
        room.steps[lane] = reach(way, kind, room.rows_of_floats, lane)


def reach(way: Way, kind: Steps, floats: Any, lane: int) -> float:
    """How far the series of a walk reach, 0 where they are no numbers."""
    order, wide = kind.order, kind.wide
    bent, before, last, odd, even = False, 0.0, 0.0, 0.0, 0.0
    for i in range(2 * way.half):
        # each beside itself: what is small now may grow; what is 0 now, beside how it moves
        first = 2 * i * (order + 1) + lane
        size = 0.0
        for k in range(FIRST):
            size = max(size, abs(floats[first + 2 * k]))
            bent = bent or (k > 1 and floats[first + 2 * k] != 0)
        if size > 0:
            x, y = abs(floats[first + 2 * order - 2]) / size, abs(floats[first + 2 * order]) / size
            if not (x < FARTHEST and y < FARTHEST):
                return 0.0
            before, last = max(before, x), max(last, y)
            odd = max(odd, abs(floats[first + 2 * wide + 2]) / size)
            even = max(even, abs(floats[first + 2 * wide + 4]) / size)
    # both: where one limit is that of either walk, they have the same steps, and agree in what is wrong
    coarser = kind.coarser if lane > 0 else 1.0
    left_out, rounded = kind.left_out * coarser, kind.rounded * coarser
    found = min(distance(left_out, before, order - 1), distance(left_out, last, order))
    found = min(found, distance(rounded, odd, wide + 1), distance(rounded, even, wide + 2))
    # where all is straight there is no end; else the last coefficients are below the range of floats
    return 0.0 if bent and found == FARTHEST else found


def distance(part: float, coefficient: float, k: int) -> float:
    """Where a term of order k is so large."""
    return exp((log(part) - log(coefficient)) / k) if coefficient > 0 else FARTHEST


def unit_of_time(way: Way, kind: Steps, room: Room) -> float:
    """A power of two near the shortest time in which q or p change, so that coefficients stay among the floats."""
    expanded(way, kind, room, 1.0)
    shortest = FARTHEST
    for begin in (0, way.half):
        for j in range(FIRST):
            # of the next but one: from rest, or nearly, every other one is small
            before, after = largest(way, kind, room, begin, j), largest(way, kind, room, begin, j + 2)
            if before > 0 and after > 0:
                shortest = min(shortest, exp((log(before) - log(after)) / 2))
    unit = 1.0
    while unit < shortest < FARTHEST:
        unit *= 2.0
    while unit > shortest:
        unit /= 2.0
    return unit


def largest(way: Way, kind: Steps, room: Room, begin: int, k: int) -> float:
    """The largest coefficient k of q, or of p, which begin at ``begin``."""
    found = 0.0
    for i in range(begin, begin + way.half):
        found = max(found, abs(room.rows_of_floats[2 * (i * (kind.order + 1) + k)]))
    return found
