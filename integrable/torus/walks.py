"""Walks over the corners of a torus, on bare reals: written so that numba can compile them as they stand, as all
loops of random access (:mod:`integrable.torus.tables`, :mod:`integrable.torus.states`,
:mod:`integrable.torus.clock_loops`).

Arrays are flat and moving points are those of :mod:`integrable.moving_point.addition`. Numbers are floats in lists, or
double-doubles when compiled (:mod:`integrable.torus.compiled`). An argument ``torus`` is the tuple that
:class:`integrable.torus.access.TorusFlow` makes: (f, axes, matrix, states, tables, parts, centres, turns, sizes), where

* ``states`` holds the moving points at the corners of the cells, row by row of ten numbers;
* ``tables`` two tables of ``sizes[2]`` terms of :func:`direction`, one for either centre;
* ``parts`` (p, q, r, s): the translation by (a, b) in periods takes the parts pa + qb and ra + sb of both reaches;
* ``turns`` the signs that σ1, σ2, σ3 change by in either period, ``sizes`` (rows, columns, terms);
* ``matrix`` (p, q, r, s): γ = pγ̃ + q·w̃×γ̃, M = rγ̃ + s·w̃×γ̃ from the upright γ̃ and w̃ = γ̃×M̃/|M̃|.
"""

from __future__ import annotations

from typing import Any

from integrable.moving_point.addition import carried, conditioning, moving_point, opposite, rate_after, rate_at, shift
from integrable.torus.tables import point_in, put, small_translation
from jacobian.numbers.roots import root

Real = Any
Row = Any

# a part of a reach this small is none
IDENTITY = 1e-30
# translations that are conditioned worse than this are made in two parts
LEAST_CONDITION = 0.02


def corners(
    f: Row,
    axes: Row,
    unit_axes: Row,
    start: Row,
    cells: Any,
    forward: int,
    most: int,
    halves: Row,
    steps: Row,
    states: Row,
    ends: Row,
    known: Row,
    turns: Row,
) -> None:
    """The moving points at the corners of the cells into ``states``.

    The first direction is walked in steps of an odd number of cells, up to ``most``, round and round, the second in
    such steps that may lead down by one cell as well; where ``forward`` is less than the number of columns, so many
    columns forward and the others backward, which takes ``most`` = 1. Into ``ends`` where every walk ends and into
    ``known`` where it should, signs included: that of the first direction, then those of the second from all rows.
    ``turns`` are the signs of the periods, ``unit_axes`` the axes of translations, κ = 1; ``halves`` are those of
    :func:`directions`, ``steps`` is room for forty numbers.
    """
    rows, columns = cells
    down, _, parts0 = step_over(f, unit_axes, halves, 0, min(rows, most), steps)
    across, lower, parts1 = step_over(f, unit_axes, halves, 1, min(columns, most), steps)
    left = moving_point(start)
    for i in range(rows):
        point = left
        for j in range(forward):
            put(point, states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns))
            for k in range(parts1):
                point = shift(f, axes, point, point_in(steps, 20 + 10 * k))
        put(point, ends, 10 * (i + 1))
        point = left
        for j in range(-1, forward - columns - 1, -1):
            for k in range(parts1):
                point = shift(f, axes, point, opposite(point_in(steps, 20 + 10 * k)))
            put(point, states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns))
        for k in range(parts0):
            left = shift(f, axes, left, point_in(steps, 10 * k))
    put(left, ends, 0)
    put(moving_point(start), known, 0)
    turn(known, 0, turns, 0)
    for i in range(rows):
        for j in range(forward - columns, forward):
            if (down * i + lower * j) // rows % 2 != 0:
                turn(states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns), turns, 0)
    for i in range(rows):
        # a whole period away, times an odd number of cells: the walk that began, or went back, there
        place, below = 10 * (i + 1), down * i + lower * forward
        if below // rows % 2 != 0:
            turn(ends, place, turns, 0)
        put(point_in(states, 10 * (below % rows * columns + across * forward % columns)), known, place)
        turn(known, place, turns, 3)
    for i in range(rows):
        for j in range(forward - columns, forward):
            if across * j // columns % 2 != 0:
                turn(states, 10 * ((down * i + lower * j) % rows * columns + across * j % columns), turns, 3)


def turn(points: Row, place: int, turns: Row, first: int) -> None:
    """The pairs of the moving point at ``place`` with the signs turns[first … first + 2]."""
    for c in range(3):
        points[place + 4 + c] = turns[first + c] * points[place + 4 + c]
        points[place + 7 + c] = turns[first + c] * points[place + 7 + c]


def step_over(f: Row, axes: Row, halves: Row, direction: int, most: int, out: Row) -> tuple[int, int, int]:
    """The step over an odd number of cells in a direction into out[20·direction …], and (that number, 1 or 0 for one
    cell more in the first direction, where the second is asked for, number of translations): of the odd numbers up to
    ``most`` the one that is best conditioned. ``axes`` are those of κ = 1.

    One translation, or both parts of one cell where every sum is badly conditioned: a direction in which an oval runs
    through no more than a point, that of a body with two equal moments, has both points of its translations there.
    """
    first, second = point_in(halves, 20 * direction), point_in(halves, 20 * direction + 10)
    down1, down2 = point_in(halves, 0), point_in(halves, 10)
    down1, down2 = carried(f, axes, down1, down1), carried(f, axes, down2, down2)
    # multiples of either part, and one sum of both: sums lie anywhere, and at d = 0 those by one of the periods, the
    # residue of x dx/y, at infinity
    first, second = carried(f, axes, first, first), carried(f, axes, second, second)
    put(first, out, 20 * direction)
    put(second, out, 20 * direction + 10)
    double1, double2 = carried(f, axes, first, first), carried(f, axes, second, second)
    trust, later = min(conditioning(first), conditioning(second)), min(conditioning(double1), conditioning(double2))
    best, chosen, lower, parts = LEAST_CONDITION * trust, 1, 0, 2
    for count in range(1, most + 1, 2):
        total = carried(f, axes, first, second)
        found = min(trust, conditioning(total))
        if found > best:
            best, chosen, lower, parts = found, count, 0, 1
            put(total, out, 20 * direction)
        if direction == 1:
            more1, more2 = carried(f, axes, first, down1), carried(f, axes, second, down2)
            total = carried(f, axes, more1, more2)
            found = min(trust, conditioning(more1), conditioning(more2), conditioning(total))
            if found > best:
                best, chosen, lower, parts = found, count, 1, 1
                put(total, out, 20)
        first, second = carried(f, axes, first, double1), carried(f, axes, second, double2)
        trust = min(trust, later, conditioning(first), conditioning(second))
    return chosen, lower, parts


def offsets(
    f: Row,
    axes: Row,
    centres: Any,
    tables: Row,
    terms: int,
    parts: Row,
    cells: Any,
    finer: Any,
    steps: Row,
    counts: Row,
) -> None:
    """The translations from a corner to the finer[0] × finer[1] points around it, row by row: two in ``steps`` for
    each, of which ``counts`` says how many to take, 1 where their sum is well conditioned and none for the corner
    itself.
    """
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    zero, n = 0 * parts[0], 0
    for i in range(-above, finer[0] - above):
        for j in range(-left, finer[1] - left):
            a, b = zero + i / (finer[0] * cells[0]), zero + j / (finer[1] * cells[1])
            x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
            place = 20 * n
            counts[n] = 0
            if abs(x) > IDENTITY:
                put(small_translation(axes, centres[0], tables, 0, terms, x), steps, place)
                counts[n] += 1
            if abs(y) > IDENTITY:
                put(small_translation(axes, centres[1], tables, 4 * terms, terms, y), steps, place + 10 * counts[n])
                counts[n] += 1
            if counts[n] == 2:
                both = carried(f, axes, point_in(steps, place), point_in(steps, place + 10))
                if conditioning(both) > LEAST_CONDITION:
                    put(both, steps, place)
                    counts[n] = 1
            n += 1


def sampled(
    f: Row,
    axes: Row,
    states: Row,
    cells: Any,
    finer: Any,
    odd: Any,
    steps: Row,
    counts: Row,
    rates: Row,
    others: Row,
) -> None:
    """1/g on a grid that has finer[0] × finer[1] points to a cell, from the corners in ``states`` by the translations
    of :func:`offsets`, into ``rates``; for a tilted body, with an odd number of γ_i turned, into ``others``.

    ``odd``: whether a period turns an odd number of γ_i.
    """
    rows, columns = cells
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    height, width = rows * finer[0], columns * finer[1]
    for i in range(rows):
        for j in range(columns):
            corner = point_in(states, (i * columns + j) * 10)
            n = 0
            for a in range(-above, finer[0] - above):
                row, over = i * finer[0] + a, False
                if row < 0:
                    row, over = row + height, odd[0]
                for b in range(-left, finer[1] - left):
                    column, flipped = j * finer[1] + b, over
                    if column < 0:
                        column, flipped = column + width, over != odd[1]
                    point, last = corner, counts[n] - 1
                    for k in range(last):
                        point = carried(f, axes, point, point_in(steps, 20 * n + 10 * k))
                    if last >= 0 and axes[7] == 0:
                        rate = rate_after(f, axes, point, point_in(steps, 20 * n + 10 * last))
                    elif last >= 0:
                        point = carried(f, axes, point, point_in(steps, 20 * n + 10 * last))
                        rate = rate_at(axes, point)
                    else:
                        rate = rate_at(axes, point)
                    n += 1
                    if axes[7] != 0:
                        square = point[4] * point[4] + point[5] * point[5] + point[6] * point[6]
                        other = 2 * axes[6] / root(square) - rate
                        if flipped:
                            rate, other = other, rate
                        others[row * width + column] = other
                    rates[row * width + column] = rate
