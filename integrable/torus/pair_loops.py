"""Pairs of genus 2 on a real torus by theta functions: loops over bare reals, compiled unchanged.

On y² = f(ξ), deg f = 5, with leading coefficient ℓ and D = (U, V), let ∂ be the derivative along (0, 1). At a branch
point e

    σ = √|U(e)| = |f'(e)/ℓ|^¼·|θ_e/θ_∞|,   V = −∂U,   V(e) = ±σν with ν = −2∂σ and the sign of U(e)

(Thomae; Mumford 1984). If all branch points are real and each bounded oval has one of the points, the periods are
those of :mod:`integrable.torus.theta_setup`.
"""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import Real, Row
from integrable.moving_point.compiled import SPECIAL
from integrable.torus.compiled import SUMS
from integrable.torus.states import CHECKED, STEP, TOGETHER, column_values, put_harmonics
from integrable.torus.theta_series import ThetaSums, circle, row_sums, theta
from integrable.torus.theta_setup import FARTHEST, MEAN, MOST_STEPS, newton_step, rough_phases, torus_periods
from jacobian.native.kinds import FLOAT, FLOATS, INT, WIDES, TupleKind, record
from jacobian.native.library import Library
from jacobian.numbers.abreast import abreast

# a lift at the start that is smaller than this part of the largest one belongs to an oval that was a point and has been
# opened
SMALLEST = 2.0**-40
# number of points between which Newton's method takes quotients of differences
POINTS = 3
# the phases of the points of a check are multiples of these parts of a turn, which no symmetry of a motion shares
ALONG_FIRST, ALONG_SECOND = 0.7548776662466927, 0.5698402909980532
# quotients of differences are inaccurate where a lift changes by more than this part in a step, as next to a pole
POLE = 1e-4


class PairTorus(NamedTuple):
    """A motion on its torus. Class k belongs to the branch point ``ends[k]``, the last class to infinity.

    ``places`` are the phases of the start in turns, ``frequencies`` their turns per unit of the flow's own time. σ of
    class k is ``factors[k]`` times θ_k/θ_∞; ``sides[k]`` is the sign of U there. ``curve`` are the coefficients of f,
    ``direction`` is that of the motion. ``sizes`` are the factors of σ and ν of the first classes, for which results
    are needed. ``units`` convert σ and ν from the abscissa ξ to x, in which the first two branch points are
    ``abscissae``. Results are pairs in x, or in E − 1/x if ``pole`` has an entry E.
    """

    sums: ThetaSums
    places: Row
    frequencies: Row
    factors: Row
    sides: Row
    ends: Row
    curve: Row
    direction: Row
    sizes: Row
    units: Row
    abscissae: Row
    pole: Row


def oval_data(
    given: Row, rule: Row, near: float, room: Row, motion: Row, found: Row, out: Row
) -> tuple[int, int, int, int]:
    """Fills a ``motion`` row and ``found`` as :func:`integrable.torus.theta_setup.torus_periods` does, and ``out``.
    Returns the basis of periods.

    ``given`` are the five branch points, ascending, ℓ > 0, π, u₀, u₁, v₀, v₁, and the direction. ``out`` gets the
    phases at the start, to the accuracy of ``rule``, the frequencies, and the turns of both phases along (1, e₅).
    """
    zero, lead = 0 * given[0], given[5]
    for i in range(4):
        motion[i], motion[4 + i] = given[i], zero
    motion[8], motion[9], motion[10], motion[11] = lead, given[6], lead * given[4], zero
    basis = torus_periods(motion, near, room, found)
    first, second = rough_phases(motion, given[7:11], found, rule)
    out[0], out[1] = zero + first, zero + second
    area = found[0] * found[3] - found[1] * found[2]
    for k in range(2):
        x, y = 1 + zero, given[4]
        if k == 0:
            x, y = given[11], given[12]
        out[2 + 2 * k], out[3 + 2 * k] = (x * found[3] - y * found[2]) / area, (y * found[0] - x * found[1]) / area
    found[MEAN] = lead * found[MEAN]
    return basis


def lifts_at(torus: PairTorus, first: Real, second: Real, count: int, out: Row, place: int) -> None:
    """Writes σ and ν of the first ``count`` classes, at phases in turns, to out[place …]."""
    sums = torus.sums
    one, two = circle(first / 2, sums.inverse), circle(second / 2, sums.inverse)
    last, slope = theta(sums, sums.sizes[0] - 1, one, two)
    over = 1 / last
    lean = slope * over
    for k in range(count):
        value, rate = theta(sums, k, one, two)
        sigma, factor = value * over, torus.factors[k]
        out[place + 2 * k] = factor * sigma
        out[place + 2 * k + 1] = factor * (2 * (sigma * lean - rate * over))


def pair_between(ends: Row, sides: Row, lifts: Row, place: int) -> tuple[Real, Real, Real, Real]:
    """u₀, u₁, v₀, v₁ from the lifts at the first two of the ``ends``, by interpolation."""
    e, other, sigma, tau = ends[0], ends[1], lifts[place], lifts[place + 2]
    u, v = sides[0] * sigma * sigma, sides[0] * sigma * lifts[place + 1]
    over, rest, last = 1 / (e - other), sides[1] * tau * tau, sides[1] * tau * lifts[place + 3]
    rise, slope = (u - rest) * over - (e + other), (v - last) * over
    return u - e * (e + rise), rise, v - slope * e, slope


def pairs_at(torus: PairTorus, phases: Row, room: Row, out: Row) -> None:
    """Writes the lifts of the first classes, then u₀, u₁, v₀ and v₁, for each pair of phases in turns from the start.

    ``out`` has a row of all points for each of these numbers. ``room`` is memory for the lifts.
    """
    points, count = len(phases) // 2, len(torus.sizes) // 2
    wide = max(count, 2)
    for i in abreast(0, points):
        place = 2 * wide * i
        lifts_at(torus, phases[2 * i] + torus.places[0], phases[2 * i + 1] + torus.places[1], wide, room, place)
        for k in range(2 * count):
            out[points * k + i] = torus.sizes[k] * room[place + k]
        for k in range(4):
            room[place + k] = torus.units[k % 2] * room[place + k]
        u0, u1, v0, v1 = pair_between(torus.abscissae, torus.sides, room, place)
        if len(torus.pole) > 0:
            u0, u1, v0, v1 = with_root(torus.pole[0], u0, u1, v0, v1)
        k = 2 * count
        out[points * k + i], out[points * (k + 1) + i] = u0, u1
        out[points * (k + 2) + i], out[points * (k + 3) + i] = v0, v1


def with_root(pole: Real, p: Real, s: Real, y: Real, slope: Real) -> tuple[Real, Real, Real, Real]:
    """The pair in x = E − 1/X from the pair (p, s), (y, slope) in X; E is ``pole``."""
    for _ in range(3):
        # V is divided by X: on the pair, 1/X = −(X + s)/p
        y, slope = slope - s * y / p, -y / p
    a, b = -s / p, 1 / p
    # on the pair, X = p(x − E) − s
    slope, y = slope * p, y - slope * s
    return pole * pole - a * pole + b, a - 2 * pole, y - slope * pole, slope


def phases_at(torus: PairTorus, tau: Row, out: Row) -> None:
    """Writes the phases from the start at times τ of the flow."""
    for i in abreast(0, len(tau)):
        out[2 * i], out[2 * i + 1] = torus.frequencies[0] * tau[i], torus.frequencies[1] * tau[i]


# --- the start


def met(torus: PairTorus, tops: Row, target: Row, nudge: float, enough: float, room: Row) -> float:
    """Completes the factors, of which |f'(e)/ℓ|^¼ are given, with the numbers by which theta functions are divided.
    Then corrects the phases of the start to those at which the lifts are ``target``, by Newton's method, and gives the
    factors the signs of the target. Returns the largest remaining difference relative to the largest of the target.
    """
    count, places, wide = len(torus.factors), torus.places, 2 * len(torus.factors)
    weights, closure = room[POINTS * wide : POINTS * wide + count], 0.0
    size = weigh(torus, tops, target, weights)
    gap = before = 4.0
    for n in range(MOST_STEPS):
        for point in abreast(0, POINTS):
            first, second = places[0], places[1]
            if point == 1:
                first = first + nudge
            if point == 2:
                second = second + nudge
            lifts_at(torus, first, second, count, room, wide * point)
        sign_factors(torus, target, room)
        gap, move1, move2 = newton_step(target, nudge, room)
        # NaN ends the loop too
        if not gap > enough or not abs(float(move1)) + abs(float(move2)) < FARTHEST:
            break
        if n > 2 and gap > before / 2:
            break
        before = gap
        places[0], places[1] = places[0] + move1, places[1] + move2
    for k in range(count):
        for n in range(2):
            off = float((room[2 * k + n] - target[2 * k + n]) * weights[k]) / size
            closure = max(closure, abs(off)) + 0 * off
        torus.factors[k] = torus.factors[k] * weights[k]
    return closure


def weigh(torus: PairTorus, tops: Row, target: Row, weights: Row) -> float:
    """Divides each factor and the lift of its class in ``target`` by a weight; returns the largest size in the target.

    A weight is the size of the lift, so that lifts at an end of a short oval, which are small, count as much as others.
    Those of an oval that was a point do not.
    """
    size, count = 0.0, len(torus.factors)
    for n in range(2 * count):
        size = max(size, abs(float(target[n])))
    for k in range(count):
        most = max(abs(float(target[2 * k])), abs(float(target[2 * k + 1])))
        if most < SMALLEST * size:
            most = size
        weights[k] = most + 0 * tops[k]
        torus.factors[k] = torus.factors[k] * tops[k] / tops[count] / most
        target[2 * k], target[2 * k + 1] = target[2 * k] / most, target[2 * k + 1] / most
    return size


def sign_factors(torus: PairTorus, target: Row, room: Row) -> None:
    """Gives the factors, and the lifts at all points in ``room``, the signs of the target."""
    count = len(torus.factors)
    for k in range(count):
        if float(room[2 * k] * target[2 * k] + room[2 * k + 1] * target[2 * k + 1]) < 0:
            torus.factors[k] = -torus.factors[k]
            for n in range(POINTS):
                at = 2 * (count * n + k)
                room[at], room[at + 1] = -room[at], -room[at + 1]


# --- a check


def lifts_strayed(torus: PairTorus, room: Row, out: Row) -> None:
    """Writes, for each of CHECKED points, the largest difference between rates of σ, or of ν, on the torus and by the
    equations of motion, to ``out``. It is relative to the largest such rate at the same point, or to σ, or ν, times the
    frequency of the faster phase if that is more. It is NaN if a rate is NaN, and 0 next to a pole.

    The check covers signs, periods and frequencies, for all times, because theta functions are analytic. ``room`` is
    memory for the lifts of five points.
    """
    count, nu1, nu2 = len(torus.factors), torus.frequencies[0], torus.frequencies[1]
    fastest, wide = max(abs(float(nu1)), abs(float(nu2))), 2 * len(torus.factors)
    step = STEP / fastest
    for n in abreast(0, CHECKED):
        here, worst, rest, pole = 5 * wide * n, 0.0, 0.0, 0.0
        for k in range(5):
            first, second = ALONG_FIRST * n + torus.places[0], ALONG_SECOND * n + torus.places[1]
            ahead = step * (k if k < 3 else 2 - k)
            lifts_at(torus, first + ahead * nu1, second + ahead * nu2, count, room, here + wide * k)
        for c in range(2):
            gap, size, change = 0.0, 0.0, 1.0
            for k in range(count):
                own, at = rates_of(torus, room, here, k), here + 2 * k + c
                near, far = room[at + wide] - room[at + 3 * wide], room[at + 2 * wide] - room[at + 4 * wide]
                right = own[1]
                if c == 0:
                    right = own[0]
                off = abs(float((8 * near - far) / 12 / step - right))
                rate, large = abs(float(right)), fastest * abs(float(room[at]))
                gap, size, rest = max(gap, off), max(size, rate, large), rest + 0 * off
                change = min(change, STEP * rate / large)
            worst, pole = max(worst, gap / size), max(pole, change)
        if pole > POLE:
            worst = 0.0
        out[n] = worst + rest


def rates_of(torus: PairTorus, lifts: Row, place: int, k: int) -> tuple[Real, Real]:
    """The derivatives of σ and ν of class k along the direction (c₀, c₁).

    2σ' = −nν + c₀v₁σ and 2ν' = −qσ − c₀v₁ν at e, with n = c₁ + c₀(u₁ + ξ), W = (f − V²)/U and q = ⌊nW/U⌋.
    """
    u0, u1, _, v1 = pair_between(torus.ends, torus.sides, lifts, place)
    curve, (c0, c1), e = torus.curve, (torus.direction[0], torus.direction[1]), torus.ends[k]
    sigma, nu = lifts[place + 2 * k], lifts[place + 2 * k + 1]
    w3 = curve[5]
    w2 = curve[4] - u1 * w3
    w1 = curve[3] - u1 * w2 - u0 * w3
    high = c1 + c0 * u1
    # q is a quotient of the terms of nW of degrees 4, 3 and 2
    q2 = c0 * w3
    q1 = c0 * w2 + high * w3 - u1 * q2
    q0 = c0 * w1 + high * w2 - u1 * q1 - u0 * q2
    n, q, lean = high + c0 * e, q0 + e * (q1 + e * q2), c0 * v1
    return (lean * sigma - n * nu) / 2, -((q * sigma + lean * nu) / 2)


# --- dt/dτ


def rates_on(torus: PairTorus, k: int, power: int, scale: Row, sizes: tuple[int, int], room: Row, out: Row) -> None:
    """Writes ``scale[0]``·|σ|^``power`` of class k, on a grid of one turn of either phase from the start. ``power`` is
    2 or −1, ``sizes`` are the rows and columns of the grid.

    ``room`` is memory for 4·TOGETHER + 2·rows numbers per harmonic of φ₁ in each theta series.
    """
    sums, places, factor = torus.sums, torus.places, torus.factors[k]
    classes, height, _ = sums.sizes
    rows, columns = sizes
    zero, circles = 0 * factor, 4 * classes * height * TOGETHER
    for r in abreast(0, rows):
        put_harmonics(sums, circle((zero + r / rows + places[0]) / 2, sums.inverse), room, circles + 2 * r, rows)
    for begin in range(0, columns, TOGETHER):
        count = min(TOGETHER, columns - begin)
        for j in abreast(0, count):
            angle = circle(((begin + j) / columns + places[1]) / 2, sums.inverse)
            for c in range(2):
                n = k if c == 0 else classes - 1
                for i in range(height):
                    p, q, _, _ = row_sums(sums, n, i, angle)
                    place = 4 * (n * height + i) * TOGETHER + j
                    room[place], room[place + TOGETHER] = p, q
        for row in range(rows):
            for j in abreast(0, count):
                value, _ = column_values(sums, k, room, (circles + 2 * row, 2 * rows), j, False)
                last, _ = column_values(sums, classes - 1, room, (circles + 2 * row, 2 * rows), j, False)
                sigma = factor * value / last
                rate = scale[0] * sigma * sigma
                if power < 0:
                    rate = scale[0] / abs(sigma)
                out[row * columns + begin + j] = rate


def mean_square(torus: PairTorus, k: int, along: Row, beyond: Row, out: Row) -> None:
    """Writes the mean over the torus of σ² of class k, at a branch point e beyond both ovals, to out[0].

    ℓσ²/4 − ∂∂'log θ_∞ is constant, ∂' along (1, e), and ∂∂'log θ_∞ has mean 0. ``along`` are the turns of both phases
    along (0, 1), ``beyond`` those along (1, e).
    """
    lifts_at(torus, torus.places[0], torus.places[1], k + 1, out, 0)
    bend = curvature(torus.sums, torus.places, along, beyond)
    out[0] = out[2 * k] * out[2 * k] - 4 * bend / torus.curve[5]


def curvature(sums: ThetaSums, phases: Row, one: Row, two: Row) -> Real:
    """The second derivative of log θ_∞ along two directions, given as turns of both phases."""
    k, (_, rows, columns) = sums.sizes[0] - 1, sums.sizes
    half, zero = sums.inverse[0] / 2, 0 * phases[0]
    value, d_one, d_two, bend = zero, zero, zero, zero
    for i in range(rows):
        for j in range(sums.lengths[k * rows + i]):
            a, m = sums.chars[4 * k] + 2 * i, sums.chars[4 * k + 1] + 2 * j
            p, q = sums.table[4 * ((k * rows + i) * columns + j)], sums.table[4 * ((k * rows + i) * columns + j) + 1]
            (c1, s1), (c2, s2) = circle(a * phases[0] / 2, sums.inverse), circle(m * phases[1] / 2, sums.inverse)
            even, turned = p * c1 * c2 - q * s1 * s2, q * c1 * c2 - p * s1 * s2
            by_first, by_second = p * s1 * c2 + q * c1 * s2, p * c1 * s2 + q * s1 * c2
            value = value + even
            d_one = d_one - half * (a * one[0] * by_first + m * one[1] * by_second)
            d_two = d_two - half * (a * two[0] * by_first + m * two[1] * by_second)
            both = a * a * one[0] * two[0] + m * m * one[1] * two[1]
            bend = bend - half * half * (both * even + a * m * (one[0] * two[1] + one[1] * two[0]) * turned)
    return bend / value - d_one * d_two / (value * value)


TORUS = record(PairTorus, SUMS, *(WIDES,) * 11)
LIBRARY = Library(
    "pairs",
    {
        "oval_data": (oval_data, (WIDES, FLOATS, FLOAT, WIDES, WIDES, WIDES, WIDES)),
        "met": (met, (TORUS, WIDES, WIDES, FLOAT, FLOAT, WIDES)),
        "strayed": (lifts_strayed, (TORUS, WIDES, FLOATS)),
        "pairs_at": (pairs_at, (TORUS, WIDES, WIDES, WIDES)),
        "phases_at": (phases_at, (TORUS, FLOATS, WIDES)),
        "rates_on": (rates_on, (TORUS, INT, INT, WIDES, TupleKind((INT, INT)), WIDES, WIDES)),
        "mean_square": (mean_square, (TORUS, INT, WIDES, WIDES, WIDES)),
    },
    SPECIAL,
)
