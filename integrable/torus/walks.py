"""Walks over the corners of a torus, on bare reals, compiled or interpreted like all loops of random access
(:mod:`integrable.torus.tables`, :mod:`integrable.torus.states`, :mod:`integrable.torus.clock_loops`).

Arrays are flat and moving points are those of :mod:`integrable.moving_point.addition`. Numbers are floats in lists, or
double-doubles when compiled (:mod:`integrable.torus.compiled`).
"""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import (
    Real,
    Row,
    carried,
    moving_point,
    opposite,
    put,
    rate_after,
    rate_at,
    shift,
    trust_of,
)
from integrable.torus.tables import SmallSteps, eight, six, small_in_tuples, small_translation
from jacobian.inexact.genus2_real import chord, chord_apart
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root

# a translation below this fraction of the reach is taken as the identity
IDENTITY = 1e-30
# a translation whose reciprocal condition (:func:`trust_of`) is below this is split into two
LEAST_CONDITION = 0.02
# a step is accepted without further search if its reciprocal condition is within this factor of the best possible
NEARLY = 0.5
# the count of a grid point whose value is known from a coarser grid
KNOWN = -1


class Curve(NamedTuple):
    """``f`` and ``axes`` of :mod:`integrable.moving_point.addition`, and ``axes`` with κ_i = 1, for translations."""

    f: Row
    axes: Row
    unit_axes: Row


def in_tuples(curve: Curve) -> Curve:
    """The same curve with tuples for rows: compiled loops then hold its numbers in registers."""
    return Curve(six(curve.f), eight(curve.axes), eight(curve.unit_axes))


class Walk(NamedTuple):
    """The data of a walk over the corners. ``cells`` is (rows, columns); ``forward`` columns are walked forward, the
    others backward. ``most`` is the largest number of cells in a step (:func:`corners`). ``turns`` are the factors ±1
    of σ1, σ2, σ3 over each period. ``halves`` are those of :func:`integrable.torus.tables.directions`, and ``steps``
    is memory for forty numbers.
    """

    cells: tuple[int, int]
    forward: int
    most: int
    turns: Row
    halves: Row
    steps: Row


class Stride(NamedTuple):
    """The numbers of cells that a step spans: down, across, and down in a step across."""

    down: int
    across: int
    lower: int


class Fine(NamedTuple):
    """A grid of ``finer[0]`` × ``finer[1]`` points to a cell. ``odd`` says whether a period reverses an odd number of
    γ_i. :func:`offsets` writes 20 numbers for each point to ``steps`` and one to ``counts``, KNOWN for points of a
    coarser grid, which are ``coarser`` apart (0: there is none). ``rest`` is (d, r) of the factor r − dx of f if its
    values determine 1/g, for an upright body, else (0, 0) (:func:`integrable.torus.corners.rest_of`).
    """

    cells: tuple[int, int]
    finer: tuple[int, int]
    odd: tuple[bool, bool]
    steps: Row
    counts: Row
    coarser: tuple[int, int]
    rest: Row


def corners(curve: Curve, start: Row, walk: Walk, states: Row, ends: Row, known: Row) -> float:
    """Writes the moving points at the corners of the cells to ``states``, row by row of ten numbers; returns
    :func:`closure`.

    A step in the first direction spans an odd number of cells, at most ``most``; such steps reach all rows in as many
    rounds. A step in the second direction may also lead down by one cell. If columns are walked backward, ``most`` is
    1. ``ends`` receives the end of every walk and ``known`` its goal, signs included: that of the first direction, then
    those of the second from all rows.
    """
    (rows, columns), near = walk.cells, in_tuples(curve)
    down, _, parts0 = step_over(near, walk, 0)
    across, lower, parts1 = step_over(near, walk, 1)
    stride = Stride(down, across, lower)
    left = moving_point(start)
    for k in range(rows):
        put(left, states, place_at(walk, stride, k, 0))
        left = moved(near, left, walk.steps, 0, parts0, False)
    put(left, ends, 0)
    for i in abreast(0, rows):
        # ``0 * i`` makes the place a number of each SIMD lane, as in other loops, so that the sum is compiled only once
        step = 20 + 0 * i
        point = moving_point(states, place_at(walk, stride, i, 0))
        for j in range(walk.forward):
            put(point, states, place_at(walk, stride, i, j))
            point = moved(near, point, walk.steps, step, parts1, False)
        put(point, ends, 10 * (i + 1))
        point = moving_point(states, place_at(walk, stride, i, 0))
        for j in range(-1, walk.forward - columns - 1, -1):
            point = moved(near, point, walk.steps, step, parts1, True)
            put(point, states, place_at(walk, stride, i, j))
    put(moving_point(start), known, 0)
    turn(known, 0, walk.turns, 0)
    with_signs(walk, stride, states, ends, known)
    return closure(start, ends, known)


def closure(start: Row, ends: Row, known: Row) -> float:
    """The largest relative distance between ends of walks and their goals, in divisor, σ and ν; NaN if any of these is
    NaN.
    """
    worst, rest = 0.0, 0.0
    # the pairs are compared too: the divisor has neither their signs nor, for two equal moments, their angle
    for first, last in ((0, 4), (4, 7), (7, 10)):
        size, gap = 0.0, 0.0
        for c in range(first, last):
            size = max(size, abs(float(start[c])))
            for i in range(len(ends) // 10):
                off = abs(float(ends[10 * i + c] - known[10 * i + c]))
                gap = max(gap, off)
                rest += 0 * off
        worst = max(worst, gap / size) if size > 0 else max(worst, 1.0)
    return worst + rest


def place_at(walk: Walk, stride: Stride, i: int, j: int) -> int:
    """The position in ``states`` of the corner after i steps down and j steps across."""
    rows, columns = walk.cells
    return 10 * ((stride.down * i + stride.lower * j) % rows * columns + stride.across * j % columns)


def moved(curve: Curve, point: Row, steps: Row, first: int, count: int, back: bool) -> Row:
    """The point after ``count`` translations of ``steps``, from ``first`` on, or after their inverses if ``back``."""
    for k in range(count):
        step = moving_point(steps, first + 10 * k)
        point = shift(curve.f, curve.axes, point, opposite(step) if back else step)
    return point


def with_signs(walk: Walk, stride: Stride, states: Row, ends: Row, known: Row) -> None:
    """Removes the signs of whole periods from the corners, and from the goals of the walks across."""
    rows, columns = walk.cells
    first = walk.forward - columns
    for i in range(rows):
        for j in range(first, walk.forward):
            if (stride.down * i + stride.lower * j) // rows % 2 != 0:
                turn(states, place_at(walk, stride, i, j), walk.turns, 0)
    for i in range(rows):
        # the goal is a corner an odd number of periods away: the first of its row, or the last of the walk backward
        place = 10 * (i + 1)
        if (stride.down * i + stride.lower * walk.forward) // rows % 2 != 0:
            turn(ends, place, walk.turns, 0)
        put(moving_point(states, place_at(walk, stride, i, walk.forward)), known, place)
        turn(known, place, walk.turns, 3)
    for i in range(rows):
        for j in range(first, walk.forward):
            if stride.across * j // columns % 2 != 0:
                turn(states, place_at(walk, stride, i, j), walk.turns, 3)


def turn(points: Row, place: int, turns: Row, first: int) -> None:
    """Multiplies the pairs of the moving point at ``place`` by the signs turns[first … first + 2]."""
    for c in range(3):
        points[place + 4 + c] = turns[first + c] * points[place + 4 + c]
        points[place + 7 + c] = turns[first + c] * points[place + 7 + c]


def step_over(curve: Curve, walk: Walk, direction: int) -> tuple[int, int, int]:
    """Returns the numbers (cells, additional cells in the first direction, translations) of the best conditioned step
    in a direction.

    The step is over an odd number of cells, up to ``most``; it is written into steps[20·direction …]. Only a step in
    the second direction may lead over a cell of the first as well, 1 or 0. The step is one translation, or both parts
    of one cell where every sum is badly conditioned. That happens in a direction in which an oval is a point, as for
    two equal moments: both points of its translations then lie there.
    """
    f, axes, out = curve.f, curve.unit_axes, walk.steps
    first, second = moving_point(walk.halves, 20 * direction), moving_point(walk.halves, 20 * direction + 10)
    down1, down2 = moving_point(walk.halves), moving_point(walk.halves, 10)
    down1, down2 = carried(f, axes, down1, down1), carried(f, axes, down2, down2)
    # multiples of either part are formed, and the two are added last: intermediate sums may be badly conditioned. At
    # d = 0 the residue of x dx/y is a period, and a translation by a fraction of it has its points at infinity
    first, second = carried(f, axes, first, first), carried(f, axes, second, second)
    put(first, out, 20 * direction)
    put(second, out, 20 * direction + 10)
    double1, double2 = carried(f, axes, first, first), carried(f, axes, second, second)
    trust, later = min(trust_of(first), trust_of(second)), min(trust_of(double1), trust_of(double2))
    best, chosen, lower, parts = LEAST_CONDITION * trust, 1, 0, 2
    for count in range(1, min(walk.cells[direction], walk.most) + 1, 2):
        total = carried(f, axes, first, second)
        found = min(trust, trust_of(total))
        if found > best:
            best, chosen, lower, parts = found, count, 0, 1
            put(total, out, 20 * direction)
        if direction == 1:
            more1, more2 = carried(f, axes, first, down1), carried(f, axes, second, down2)
            total = carried(f, axes, more1, more2)
            found = min(trust, trust_of(more1), trust_of(more2), trust_of(total))
            if found > best:
                best, chosen, lower, parts = found, count, 1, 1
                put(total, out, 20)
        # a sum is at most as well conditioned as its parts, so that further search gains little
        if best >= NEARLY * trust:
            break
        first, second = carried(f, axes, first, double1), carried(f, axes, second, double2)
        trust = min(trust, later, trust_of(first), trust_of(second))
    return chosen, lower, parts


def offsets(curve: Curve, small: SmallSteps, fine: Fine) -> None:
    """Writes the translations from a corner to the grid points around it, row by row, two in ``steps`` for each point.
    ``counts`` is the number of them to use: 1 if their sum is well conditioned, 0 for the corner itself.
    """
    parts, cells, finer, counts, coarser = small.parts, fine.cells, fine.finer, fine.counts, fine.coarser
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    zero, n, least = 0 * parts[0], 0, LEAST_CONDITION
    if fine.rest[1] != 0:
        # a worse condition is allowed, since 1/g is then computed from the divisor alone
        least *= LEAST_CONDITION
    for i in range(-above, finer[0] - above):
        for j in range(-left, finer[1] - left):
            a, b = zero + i / (finer[0] * cells[0]), zero + j / (finer[1] * cells[1])
            x, y = parts[0] * a + parts[1] * b, parts[2] * a + parts[3] * b
            place = 20 * n
            counts[n] = 0
            if coarser[0] > 0 and i % coarser[0] == 0 and j % coarser[1] == 0:
                counts[n] = KNOWN
                n += 1
                continue
            if abs(x) > IDENTITY:
                put(small_translation(small, 0, x), fine.steps, place)
                counts[n] += 1
            if abs(y) > IDENTITY:
                put(small_translation(small, 1, y), fine.steps, place + 10 * counts[n])
                counts[n] += 1
            if counts[n] == 2:
                both = carried(
                    curve.f, curve.unit_axes, moving_point(fine.steps, place), moving_point(fine.steps, place + 10)
                )
                if trust_of(both) > least:
                    put(both, fine.steps, place)
                    counts[n] = 1
            n += 1


def gridded(curve: Curve, small: SmallSteps, states: Row, fine: Fine, rates: Row, others: Row) -> None:
    """Calls :func:`offsets`, then :func:`sampled`."""
    near = in_tuples(curve)
    offsets(near, small_in_tuples(small), fine)
    sampled(near, states, fine, rates, others)


def sampled(curve: Curve, states: Row, fine: Fine, rates: Row, others: Row) -> None:
    """Writes 1/g on the grid to ``rates``, from the corners in ``states`` by the translations of :func:`offsets`.
    ``others`` receives 1/g with the signs of an odd number of γ_i changed, which differs for a tilted body. Points
    whose count is KNOWN are skipped.
    """
    (rows, columns), finer, near = fine.cells, fine.finer, in_tuples(curve)
    above, left = (finer[0] - 1) // 2, (finer[1] - 1) // 2
    height, width, d, r = rows * finer[0], columns * finer[1], fine.rest[0], fine.rest[1]
    for i in range(rows):
        for j in abreast(0, columns):
            corner = moving_point(states, (i * columns + j) * 10)
            own, n = rate_at(near.axes, corner), -1
            scale = own * height_of(d, r, corner)
            for a in range(-above, finer[0] - above):
                row, over = i * finer[0] + a, False
                if row < 0:
                    row, over = row + height, fine.odd[0]
                for b in range(-left, finer[1] - left):
                    n += 1
                    if fine.counts[n] == KNOWN:
                        continue
                    place = 20 * n + 0 * j
                    if r != 0 and fine.counts[n] == 1:
                        rate = rate_by_height(near.f, (d, r, scale), corner, moving_point(fine.steps, place))
                        other = rate
                    else:
                        rate, other = rates_beside(near, corner, fine.steps, place, fine.counts[n])
                    column, flipped = j * finer[1] + b, over
                    if column < 0:
                        column, flipped = column + width, over != fine.odd[1]
                    if flipped:
                        rate, other = other, rate
                    rates[row * width + column] = rate
                    others[row * width + column] = other


def height_of(d: Real, r: Real, point: Row) -> Real:
    """d²U(r/d), which vanishes where a point of the divisor is at the root of r − dx."""
    return r * r + d * (r * point[1] + d * point[0])


def rate_by_height(f: Row, scale: tuple[Real, Real, Real], point: Row, step: Row) -> Real:
    """:func:`integrable.moving_point.addition.rate_after` of an upright body, from the root r/d of f: ``scale`` is d, r
    and 1/g times :func:`height_of` at the point.

    g² is a multiple of U(r/d), and f vanishes there, so the sum's U'' is P²/(l1²·U·U') with P = qV + LU.
    """
    d, r, size = scale
    first, second = (point[0], point[1], point[2], point[3]), (step[0], step[1], step[2], step[3])
    q, l1, l0, good = chord_apart(first, second)
    if not good:
        q, l1, l0 = chord((f[0], f[1], f[2], f[3], f[4], f[5]), first, second)
    across = q * (d * d) * (d * point[2] + r * point[3]) + (d * l0 + r * l1) * height_of(d, r, point)
    return abs(size * l1 * root(height_of(d, r, step)) / across)


def rates_beside(curve: Curve, corner: Row, steps: Row, place: int, count: int) -> tuple[Real, Real]:
    """1/g at the point that ``count`` translations reach from ``corner``, and 1/g there with the signs of an odd number
    of γ_i changed. The translations are in ``steps``, from index ``place`` on.
    """
    f, axes, point, last = curve.f, curve.axes, corner, count - 1
    for k in range(last):
        point = carried(f, axes, point, moving_point(steps, place + 10 * k))
    if last >= 0 and axes[7] == 0:
        rate = rate_after(f, axes, point, moving_point(steps, place + 10 * last))
        return rate, rate
    if last >= 0:
        point = carried(f, axes, point, moving_point(steps, place + 10 * last))
    rate = rate_at(axes, point)
    return rate, 2 * axes[6] / root(point[4] * point[4] + point[5] * point[5] + point[6] * point[6]) - rate
