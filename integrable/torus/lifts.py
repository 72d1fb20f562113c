"""Square roots of |U| at branch points on a real torus of genus 2, by theta functions; on bare reals, compiled or
interpreted. Further functions find the phases of the start, check a torus, and compute dt/dτ on a grid. All serve
bodies and Mumford's pairs on other curves.

Let σ = √|U(e)| at a branch point e, and ν = −2∂σ with the derivative ∂ along (0, 1). Then σ ∝ θ_e/θ_∞ (Thomae; Mumford
1984). A body has three such points, and its lifts (γ̃_i, w̃_i) are normalized by γ̃² = w̃² = 1 instead, without θ_∞.
"""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.torus.theta_series import ThetaSums, circle, is_odd, row_sums, theta
from jacobian.numbers.abreast import abreast
from jacobian.numbers.roots import root
from jacobian.numbers.sums import joined, plus_product

# Newton's method uses difference quotients of the lifts at POINTS points. It ends after MOST_STEPS steps, or at a step
# of more than FARTHEST turns
POINTS, MOST_STEPS, FARTHEST = 3, 100, 1e3
# a torus is accepted if no lift at the start, a pair (σ, ν), differs from the given one by more than CLOSED of its size
CLOSED = 1e-18
# where an oval is a double root, the two roots are moved slightly apart. The move adds to the lifts of the start; lifts
# below this fraction of the largest may consist of this addition alone
SMALLEST = 2.0**-40
# the equations of motion are checked at CHECKED points, by difference quotients between AROUND points that are STEP
# turns of the faster phase apart. Their error is about (2π·STEP·(the highest harmonic))⁴
CHECKED, AROUND, STEP = 8, 5, 2.0**-24
# the checked points have the phases (n·ALONG_FIRST, n·ALONG_SECOND): these numbers are irrational, so that no symmetry
# of a motion maps one point to another
ALONG_FIRST, ALONG_SECOND = 0.7548776662466927, 0.5698402909980532
# difference quotients are inaccurate where all lifts change by more than this fraction in a step, as next to a pole
POLE = 1e-4
# number of columns of a grid whose sums are computed together, so that they stay in a cache
TOGETHER = 64


class Torus(NamedTuple):
    """The theta functions of a motion. Series k of ``sums``, θ_k, belongs to branch point k. If ``sums`` has one series
    more than there are ``factors``, its last is θ_∞.

    ``places`` are the phases of the start in turns. σ at branch point k is ``factors[k]``·θ_k, times a factor that is
    the same for all k.
    """

    sums: ThetaSums
    places: Row
    factors: Row


def frame_at(torus: Torus, first: Real, second: Real) -> Row:
    """(γ̃, w̃) of :mod:`integrable.torus.states` at the phases ``first`` and ``second``, in turns since the start. They
    must be below 2, because larger ones would lose digits.
    """
    sums, places = torus.sums, torus.places
    one, two = circle((first + places[0]) / 2, sums.inverse), circle((second + places[1]) / 2, sums.inverse)
    x, p = theta(sums, 0, one, two)
    y, q = theta(sums, 1, one, two)
    z, s = theta(sums, 2, one, two)
    return frame_from(torus.factors, (x, y, z), (p, q, s))


def frame_from(factors: Row, values: Row, slopes: Row) -> Row:
    """(γ̃, w̃) of :mod:`integrable.torus.states`, from the theta functions and their derivatives."""
    a, b, c = factors[0], factors[1], factors[2]
    x, y, z = a * values[0], b * values[1], c * values[2]
    p, q, s = a * slopes[0], b * slopes[1], c * slopes[2]
    size = 1 / root(x * x + y * y + z * z)
    x, y, z = x * size, y * size, z * size
    lean = x * p + y * q + z * s
    p, q, s = lean * x - p, lean * y - q, lean * z - s
    size = 1 / root(p * p + q * q + s * s)
    return x, y, z, p * size, q * size, s * size


def lifts_at(torus: Torus, first: Real, second: Real, count: int, out: Row, place: int) -> None:
    """Writes σ and ν of the first ``count`` branch points to out[place …]. ``first`` and ``second`` are the phases, in
    turns since the start.
    """
    sums, factors = torus.sums, torus.factors
    if sums.sizes[0] == len(factors):
        x, y, z, p, q, s = frame_at(torus, first, second)
        out[place], out[place + 2], out[place + 4] = x, y, z
        out[place + 1], out[place + 3], out[place + 5] = p, q, s
        return
    one = circle((first + torus.places[0]) / 2, sums.inverse)
    two = circle((second + torus.places[1]) / 2, sums.inverse)
    last, slope = theta(sums, sums.sizes[0] - 1, one, two)
    over = 1 / last
    lean = slope * over
    for k in range(count):
        value, rate = theta(sums, k, one, two)
        sigma, factor = value * over, factors[k]
        out[place + 2 * k] = factor * sigma
        out[place + 2 * k + 1] = factor * (2 * (sigma * lean - rate * over))


# --- the start


class Limits(NamedTuple):
    """Limits of Newton's method in :func:`met`. It ends if no lift differs from that of the start by more than the
    fraction ``enough``. ``nudge`` is the step of its difference quotients, in turns. If an oval is a double root, its
    two roots are moved slightly apart, which adds to the lifts of the start. Lifts below the fraction ``smallest`` of
    the largest may consist of this addition alone; ``smallest`` is 0 if no oval is a double root.
    """

    enough: float
    nudge: float
    smallest: float


def met(torus: Torus, tops: Row, target: Row, limits: Limits, room: Row) -> float:
    """Finds the phases of the start, at which the lifts are ``target``, by Newton's method from phases in floats.

    First it multiplies the factors by ``tops``, by which :func:`~integrable.torus.theta_series.theta_weights` has
    divided the theta functions; it also changes the signs of the factors to those of the target. Returns the largest
    remaining difference, relative to the size of each lift, or NaN if a phase is NaN. ``room`` is memory
    for 7 numbers per factor.
    """
    places, factors, nudge = torus.places, torus.factors, limits.nudge
    count, zero, wide = len(factors), 0 * places[0], 2 * len(factors)
    weights, last, gap, before = room[POINTS * wide : POINTS * wide + count], 1 + zero, 4.0, 4.0
    if len(tops) > count:
        last = tops[count]
    for k in range(count):
        factors[k] = factors[k] * tops[k] / last
    weigh(target, weights, limits.smallest)
    for n in range(MOST_STEPS):
        for point in abreast(0, POINTS):
            first, second = zero, zero
            if point == 1:
                first = first + nudge
            if point == 2:
                second = second + nudge
            lifts_at(torus, first, second, count, room, wide * point)
        # this is repeated in each step: near a separatrix, phases in floats may give a small lift the wrong sign
        give_signs(factors, target, room)
        gap, move1, move2 = newton_step(target, weights, nudge, room)
        # NaN ends the loop too
        if not gap > limits.enough or not abs(float(move1)) + abs(float(move2)) < FARTHEST:
            break
        if n > 2 and gap > before / 2:
            break
        before = gap
        places[0], places[1] = places[0] + move1, places[1] + move2
    closure = 0.0
    for n in range(wide):
        off = float((room[n] - target[n]) * weights[n // 2])
        closure = max(closure, abs(off)) + 0 * off
    return closure


def weigh(target: Row, weights: Row, smallest: float) -> None:
    """Writes the weight 1/max(|σ|, |ν|) of each lift, so that a small lift, as at an end of a short oval or near an
    unstable rotation, counts as much as the others. A lift below ``smallest`` times the largest, or a lift 0, gets the
    weight of the largest.
    """
    size = 0.0
    for n in range(len(target)):
        size = max(size, abs(float(target[n])))
    for k in range(len(weights)):
        most = max(abs(float(target[2 * k])), abs(float(target[2 * k + 1])))
        if most < smallest * size or most == 0:
            most = size
        weights[k] = 1 / (most + 0 * target[0])


def give_signs(factors: Row, target: Row, room: Row) -> None:
    """Gives the factors, and the lifts at all points in ``room``, the signs of the target."""
    count = len(factors)
    for k in range(count):
        if float(room[2 * k] * target[2 * k] + room[2 * k + 1] * target[2 * k + 1]) < 0:
            factors[k] = -factors[k]
            for n in range(POINTS):
                at = 2 * (count * n + k)
                room[at], room[at + 1] = -room[at], -room[at + 1]


def newton_step(target: Row, weights: Row, nudge: float, room: Row) -> tuple[float, Real, Real]:
    """(the largest weighted difference from the target, the changes of both phases), by least squares.

    ``room`` has the lifts at the present phases, then at a first phase larger by ``nudge``, then at a second phase
    larger by ``nudge``.
    """
    zero, gap, wide = 0 * target[0], 0.0, len(target)
    aa, ab, bb, ar, br, rest = zero, zero, zero, zero, zero, 0.0
    for i in range(wide):
        weight = weights[i // 2]
        a, b = (room[wide + i] - room[i]) * weight, (room[2 * wide + i] - room[i]) * weight
        off = (target[i] - room[i]) * weight
        aa, ab, bb, ar, br = aa + a * a, ab + a * b, bb + b * b, ar + a * off, br + b * off
        gap, rest = max(gap, abs(float(off))), rest + 0 * float(off)
    area = aa * bb - ab * ab
    return gap + rest, nudge * (ar * bb - br * ab) / area, nudge * (aa * br - ab * ar) / area


# --- a check of the torus by the equations of motion


def put_around(torus: Torus, frequencies: Row, room: Row) -> None:
    """Writes the lifts at CHECKED points of the torus. After the lifts at a point come the lifts one and two steps
    ahead and behind on the motion.
    """
    nu1, nu2, wide = frequencies[0], frequencies[1], 2 * len(torus.factors)
    step = STEP / max(abs(float(nu1)), abs(float(nu2)))
    for n in abreast(0, CHECKED):
        for k in range(AROUND):
            ahead = step * (k if k < 3 else 2 - k)
            first, second = ALONG_FIRST * n + ahead * nu1, ALONG_SECOND * n + ahead * nu2
            lifts_at(torus, first, second, len(torus.factors), room, wide * (AROUND * n + k))


def most_strayed(frequencies: Row, wide: int, lifts: Row, right: Row, out: Row) -> None:
    """Writes to ``out``, for each point of :func:`put_around`, the relative error of the rates of σ and ν on the torus.
    ``right`` are the rates by the equations of motion; ``wide`` is the number of σ and ν at a point.

    The largest error of a rate of σ is divided by the largest rate of σ, or by the largest σ times the frequency of the
    faster phase if that is more; likewise for ν. The result is NaN if a rate is NaN, and 0 next to a pole. The check
    covers signs, periods and frequencies, for all times, because theta functions are analytic.
    """
    fastest = max(abs(float(frequencies[0])), abs(float(frequencies[1])))
    step = STEP / fastest
    for n in abreast(0, CHECKED):
        worst, rest, pole = 0.0, 0.0, 0.0
        for c in range(2):
            gap, size, change = 0.0, 0.0, 1.0
            for k in range(wide // 2):
                at, own = AROUND * wide * n + 2 * k + c, right[wide * n + 2 * k + c]
                near, far = lifts[at + wide] - lifts[at + 3 * wide], lifts[at + 2 * wide] - lifts[at + 4 * wide]
                off = abs(float((8 * near - far) / 12 / step - own))
                rate, large = abs(float(own)), fastest * abs(float(lifts[at]))
                gap, size, rest = max(gap, off), max(size, rate, large), rest + 0 * off
                change = min(change, STEP * rate / large)
            worst, pole = max(worst, gap / size), max(pole, change)
        if pole > POLE:
            worst = 0.0
        out[n] = worst + rest


# --- dt/dτ on a grid


class RateSums(NamedTuple):
    """dt/dτ = s√q, or sq if not ``rooted``, with q = Σ a_n(f_nθ_n)²/Σ b_n(f_nθ_n)². Both sums are over two or three
    ``classes`` of theta functions, from the class ``first`` on. f_n are the factors of the torus, 1 for θ_∞.
    ``numbers`` are a_n and b_n of three classes, then s.

    If the body is ``tilted``, the tilt term Σ c_i·w̃_iγ̃_jγ̃_k/√q for cyclic (i, j, k) is added, and ``numbers`` ends
    with the c_i.
    """

    first: int
    classes: int
    rooted: bool
    tilted: bool
    numbers: Row


def gridded(
    torus: Torus, rate: RateSums, sizes: tuple[int, int], coarser: tuple[int, int], room: Row, rates: Row, others: Row
) -> None:
    """Writes dt/dτ to ``rates``, and dt/dτ with the opposite tilt to ``others``, on a grid that begins at the start and
    covers one turn of each phase. ``sizes`` are the rows and columns of the grid.

    Points of a coarser grid, whose rows and columns are ``coarser`` apart (0: there is none), are left out. ``room`` is
    memory for 4·TOGETHER + 2·rows numbers per harmonic of φ₁ in each theta series.
    """
    sums, classes, height = torus.sums, rate.classes, torus.sums.sizes[1]
    rows, columns = sizes
    zero, circles = 0 * torus.places[0], 4 * classes * height * TOGETHER
    for r in abreast(0, rows):
        angle = circle((zero + r / rows + torus.places[0]) / 2, sums.inverse)
        put_harmonics(sums, (rate.first, classes), angle, room, circles + 2 * r, rows)
    for begin in range(0, columns, TOGETHER):
        count = min(TOGETHER, columns - begin)
        for j in abreast(0, count):
            angle = circle(((begin + j) / columns + torus.places[1]) / 2, sums.inverse)
            for k in range(classes):
                for i in range(height):
                    p, q, dp, dq = row_sums(sums, rate.first + k, i, angle)
                    place = 4 * (k * height + i) * TOGETHER + j
                    room[place], room[place + TOGETHER] = p, q
                    room[place + 2 * TOGETHER], room[place + 3 * TOGETHER] = dp, dq
        for row in range(rows):
            apart = coarser[1] if coarser[0] > 0 and row % coarser[0] == 0 else 0
            # apart − 1 new columns lie between two known ones
            new = count if apart == 0 else count // apart * (apart - 1)
            for n in abreast(0, new):
                j = n if apart == 0 else n + n // (apart - 1) + 1
                own, other = rates_in(torus, rate, room, (circles + 2 * row, 2 * rows), j)
                rates[row * columns + begin + j] = own
                others[row * columns + begin + j] = other


def put_harmonics(
    sums: ThetaSums, classes: tuple[int, int], angle: tuple[Real, Real], room: Row, place: int, rows: int
) -> None:
    """Writes a pair (cosine, sine) for each harmonic of φ₁ in each theta series to room[place …], one pair every
    2·``rows`` numbers. ``classes`` are the first class and their number; ``angle`` is (cosine, sine) of πφ₁.
    """
    height, (c, s) = sums.sizes[1], angle
    twice, sine = c * c - s * s, 2 * c * s
    for n in range(classes[1]):
        a, b = 1 + 0 * c, 0 * c
        if sums.chars[4 * (classes[0] + n)] > 0:
            a, b = c, s
        for i in range(height):
            there = place + 2 * rows * (n * height + i)
            room[there], room[there + 1] = a, b
            a, b = a * twice - b * sine, a * sine + b * twice


def rates_in(torus: Torus, rate: RateSums, room: Row, circles: tuple[int, int], j: int) -> tuple[Real, Real]:
    """(dt/dτ, dt/dτ with the opposite tilt) in column j, from the sums that :func:`gridded` has put into ``room``.
    ``circles`` are the position of the first harmonic and the distance from each harmonic to the next.
    """
    sums, factors, numbers = torus.sums, torus.factors, rate.numbers
    scale = numbers[6]
    if rate.tilted:
        x, p = column_values(sums, (0, 0), room, circles, j, True)
        y, q = column_values(sums, (1, 1), room, circles, j, True)
        z, s = column_values(sums, (2, 2), room, circles, j, True)
        x, y, z, p, q, s = frame_from(factors, (x, y, z), (p, q, s))
        own = root(numbers[0] * x * x + numbers[2] * y * y + numbers[4] * z * z)
        turn = (numbers[7] * p * y * z + numbers[8] * q * z * x + numbers[9] * s * x * y) / own
        return scale * own + turn, scale * own - turn
    x, z = column_values(sums, (rate.first, 0), room, circles, j, False)
    y, _ = column_values(sums, (rate.first + 1, 1), room, circles, j, False)
    x = factors[rate.first] * x
    if rate.classes > 2:
        z, _ = column_values(sums, (rate.first + 2, 2), room, circles, j, False)
        y, z = factors[rate.first + 1] * y, factors[rate.first + 2] * z
    x, y, z = x * x, y * y, z * z
    own = (numbers[0] * x + numbers[2] * y + numbers[4] * z) / (numbers[1] * x + numbers[3] * y + numbers[5] * z)
    if rate.rooted:
        own = root(own)
    return scale * own, scale * own


def column_values(
    sums: ThetaSums, place: tuple[int, int], room: Row, circles: tuple[int, int], j: int, tilted: bool
) -> tuple[Real, Real]:
    """θ_k in column j, and its derivative for a ``tilted`` body, else 0. ``place`` is (k, n) if θ_k is the n-th
    function in ``room``.
    """
    (k, own), height = place, sums.sizes[1]
    odd, zero = is_odd(sums.chars, k), 0 * room[j]
    value, slope = zero, zero
    for i in range(height):
        at = 4 * (own * height + i) * TOGETHER + j
        there = circles[0] + circles[1] * (own * height + i)
        a, b = room[there], room[there + 1]
        p, q = room[at], room[at + TOGETHER]
        x, y, u, v = a, -b, b, a
        if odd:
            x, y, u, v = u, v, x, y
        value = plus_product(plus_product(value, x, p), y, q)
        if tilted:
            p, q = room[at + 2 * TOGETHER], room[at + 3 * TOGETHER]
            slope = plus_product(plus_product(slope, u, p), v, q)
    return joined(value, zero), joined(slope, zero)
