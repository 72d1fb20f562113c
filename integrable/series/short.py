"""Short runs in floats along the Taylor series of a tape, right to their last bits; compiled in
:mod:`integrable.series.short_compiled`.

Of the terms of a step the first count most: the first few coefficients are double-double numbers, those beyond are
floats, and so a step costs little more than one in floats and is good to twenty digits. What rounding and what is left
out have grown to is found out by walking a second time, in other steps that are good to a digit less, from a start that
is moved by what it was rounded by.
"""

from __future__ import annotations

from math import exp, log
from typing import Any, NamedTuple

from integrable.series.recurrences import coefficients
from jacobian.numbers.sums import plus_product

__all__ = ["COARSE", "FINE", "FINEST", "Room", "Steps", "Way", "walked_twice"]

# what the two walks may differ by, beside the largest number of q, or of p; the errors of the finer one are far smaller
AGREED = 2.0**-53
# coefficients that the unit of time is read off
FIRST = 4
# how many times as long as the first one steps may become
UNEVEN = 4
FARTHEST = 1e300


class Steps(NamedTuple):
    """A kind of steps: coefficients up to ``wide`` are wide, those up to ``order``, an even number of them, floats;
    what is left out is the part ``left_out`` of each q and p.
    """

    wide: int
    order: int
    left_out: float


COARSE, FINE, FINEST = Steps(10, 30, 1e-22), Steps(12, 36, 1e-25), Steps(18, 44, 1e-29)


class Room(NamedTuple):
    """What a walk works in: the values of all nodes where its series are, the series, wide and in floats, and powers of
    how far from there they are taken.
    """

    middles: Any
    wide: Any
    floats: Any
    powers: Any


class Way(NamedTuple):
    """What is walked: the variables are q and p, ``half`` of each, and further ones, with the rates of ``tape``; not
    many more steps than ``most``. ``start`` has the values of all nodes that are variables or constants, ``moved`` the
    same but for their last bits.
    """

    tape: Any
    half: int
    most: float
    start: Any
    moved: Any


def walked_twice(way: Way, fine: Steps, coarse: Steps, room: Room, times: Any, out: Any, again: Any) -> int:
    """q and p at ``times``, ascending from 0 or descending, into ``out``, row by row: how many were reached. Where
    ``again`` begins a row with a number that is not 0, the row is not right to the last bits of floats.
    """
    reached = walk(way, fine, way.start, room, times, out)
    reached = walk(way, coarse, way.moved, room, times[:reached], again)
    for row in range(reached):
        wrong = 0
        for part in range(2):
            begin = (2 * row + part) * way.half
            size, gap = 0.0, 0.0
            for i in range(begin, begin + way.half):
                size = max(size, abs(float(out[i])))
                rest = abs(float(out[i] - again[i]))
                gap = rest if not rest <= gap else gap
            if not gap <= AGREED * size:
                wrong = 1
        again[2 * row * way.half] = wrong + 0 * way.start[0]
    return reached


def walk(way: Way, kind: Steps, start: Any, room: Room, times: Any, out: Any) -> int:
    """The same once, in one kind of steps: how many times were reached."""
    moved, count = len(way.tape[3]), 2 * way.half
    for n in range(len(start)):
        room.middles[n] = start[n]
    # constants have no further coefficients
    for n in range(len(room.wide)):
        room.wide[n] = 0 * start[0]
    for n in range(len(room.floats)):
        room.floats[n] = 0.0
    unit = unit_of_time(way, kind, room)
    now, steps, step = 0 * start[0], 0, expanded(way, kind, room, unit)
    last = times[len(times) - 1] / unit
    for row in range(len(times)):
        target = times[row] / unit
        while abs(float(target - now)) > step:
            # of coefficients that are no numbers a step is 0
            if not abs(float(last - now)) < UNEVEN * (way.most - steps) * step:
                return row
            steps += 1
            ahead = step if target > 0 else -step
            put_powers(kind, room.powers, ahead + 0 * now)
            for i in range(moved):
                room.middles[i] = value(kind, room, i)
            now = now + ahead
            step = expanded(way, kind, room, unit)
        if not step > 0:
            return row
        put_powers(kind, room.powers, target - now)
        for i in range(count):
            out[row * count + i] = value(kind, room, i)
    return len(times)


def expanded(way: Way, kind: Steps, room: Room, unit: float) -> float:
    """The series about the state that is in ``room.middles``, in a unit of time; how far they reach, 0 where they are
    no numbers.
    """
    kinds, left, right, rates = way.tape
    wide, order = kind.wide, kind.order
    for n in range(len(kinds)):
        room.wide[n * (wide + 1)] = room.middles[n]
    coefficients(kinds, left, right, rates, 0, wide, unit, room.wide)
    for n in range(len(kinds)):
        for k in range(wide + 1 if n < len(rates) else wide):
            room.floats[n * (order + 1) + k] = float(room.wide[n * (wide + 1) + k])
    coefficients(kinds, left, right, rates, wide, order, unit, room.floats)
    found, bent = FARTHEST, False
    for i in range(2 * way.half):
        # each beside itself: what is small now may grow; what is 0 now, beside how it moves
        first = i * (order + 1)
        size = 0.0
        for k in range(FIRST):
            size = max(size, abs(room.floats[first + k]))
            bent = bent or (k > 1 and room.floats[first + k] != 0)
        for k in range(order - 1, order + 1):
            ratio = abs(room.floats[first + k]) / size if size > 0 else 0.0
            if not ratio < FARTHEST:
                return 0.0
            if ratio > 0:
                found = min(found, exp((log(kind.left_out) - log(ratio)) / k))
    # where all is straight there is no end; else the last coefficients are below the range of floats
    return 0.0 if bent and found == FARTHEST else found


def value(kind: Steps, room: Room, i: int) -> Any:
    """Variable i at the distance from the middle of its series whose powers are in the room."""
    first, last, powers = i * (kind.wide + 1), kind.wide, room.powers
    rest = tail(room.floats, i * (kind.order + 1), last, kind.order, float(powers[1]))
    total = plus_product(0 * powers[0], room.wide[first + last] + rest, powers[last])
    for k in range(last - 1, -1, -1):
        total = plus_product(total, room.wide[first + k], powers[k])
    return total + 0


def put_powers(kind: Steps, powers: Any, ahead: Any) -> None:
    """Those of ``ahead``, from 0 to the last that has a wide coefficient; 0 for what is no float: only where all is
    straight steps are so long.
    """
    powers[0], powers[1] = 0 * ahead + 1, ahead
    for k in range(2, kind.wide + 1):
        power = powers[k // 2] * powers[k - k // 2]
        powers[k] = power if abs(float(power)) < FARTHEST else 0 * ahead


def tail(floats: Any, first: int, wide: int, order: int, ahead: float) -> float:
    """The terms beyond the wide ones, over that power of ``ahead``."""
    # in two sums, which do not wait for each other
    even, odd, square = 0.0, 0.0, ahead * ahead
    for k in range(order, wide + 1, -2):
        even = even * square + floats[first + k]
        odd = odd * square + floats[first + k - 1]
    return (even * ahead + odd) * ahead


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
        found = max(found, abs(room.floats[i * (kind.order + 1) + k]))
    return found
