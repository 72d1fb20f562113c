"""Mumford's pairs of genus 2 on a real torus, by theta functions: loops over bare reals, compiled unchanged.

On y² = f(ξ), deg f = 5, with leading coefficient ℓ and D = (U, V), let ∂ be the derivative along (0, 1). At a branch
point e

    σ = √|U(e)| = |f'(e)/ℓ|^¼·|θ_e/θ_∞|,   V = −∂U,   V(e) = ±σν with ν = −2∂σ and the sign of U(e)

(Thomae; Mumford 1984). If all branch points are real and each bounded oval contains one point of D, the periods are
those of :mod:`integrable.torus.theta_setup`.
"""

from __future__ import annotations

from typing import NamedTuple

from integrable.moving_point.addition import Real, Row, cofactor_at
from integrable.moving_point.compiled import SPECIAL
from integrable.torus.compiled import TORUS
from integrable.torus.lifts import AROUND, CHECKED, Torus, lifts_at, most_strayed, put_around
from integrable.torus.theta_series import ThetaSums, circle
from integrable.torus.theta_setup import ALONG, FREQUENCIES, MEAN, rough_phases, torus_periods
from jacobian.native.kinds import FLOAT, FLOATS, INT, WIDES, record
from jacobian.native.library import Library
from jacobian.numbers.abreast import abreast


class PairTorus(NamedTuple):
    """A motion on its torus. The theta function θ_k belongs to the branch point ``ends[k]``, the last one to infinity.

    ``frequencies`` are the turns of both phases per unit of the flow's own time; ``sides[k]`` is the sign of U at
    ``ends[k]``. ``curve`` are the coefficients of f, ``direction`` is that of the motion. ``sizes`` has two numbers for
    each lift that is a result, by which its σ and ν are multiplied. ``units`` convert σ and ν from the abscissa ξ to x,
    in which the first two branch points are ``abscissae``. Results are pairs in x, or in E − 1/x if ``pole`` has an
    entry E.
    """

    torus: Torus
    frequencies: Row
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
    """Fills ``motion``, the argument of :func:`integrable.torus.theta_setup.torus_periods`, and ``found``, its result,
    and ``out``. Returns the basis of periods.

    ``given`` are the five branch points, ascending, the leading coefficient ℓ > 0 of f, π, the pair u₀, u₁, v₀, v₁ at
    the start, and the direction of the motion. ``out`` gets the phases at the start, to the accuracy of ``rule``, the
    frequencies, and the turns of both phases along (1, e₅).
    """
    zero, lead = 0 * given[0], given[5]
    for i in range(4):
        motion[i], motion[4 + i] = given[i], zero
    motion[8], motion[9], motion[10], motion[11] = lead, given[6], lead * given[4], zero
    basis = torus_periods(motion, near, room, found)
    first, second = rough_phases(motion, given[7:11], found, rule)
    out[0], out[1] = zero + first, zero + second
    for k in range(2):
        along, across = found[FREQUENCIES + k], found[ALONG + k]
        out[2 + k], out[4 + k] = given[11] * along + given[12] * across, along + given[4] * across
    found[MEAN] = lead * found[MEAN]
    return basis


def pair_between(ends: Row, sides: Row, lifts: Row, place: int) -> tuple[Real, Real, Real, Real]:
    """u₀, u₁, v₀, v₁ from the lifts at the first two of the ``ends``, by interpolation."""
    e, other, sigma, tau = ends[0], ends[1], lifts[place], lifts[place + 2]
    u, v = sides[0] * sigma * sigma, sides[0] * sigma * lifts[place + 1]
    over, rest, last = 1 / (e - other), sides[1] * tau * tau, sides[1] * tau * lifts[place + 3]
    rise, slope = (u - rest) * over - (e + other), (v - last) * over
    return u - e * (e + rise), rise, v - slope * e, slope


def pairs_at(torus: PairTorus, phases: Row, room: Row, out: Row) -> None:
    """Writes, for each pair of phases in turns from the start, σ and ν of the first lifts, as many as ``torus.sizes``
    has factors for, then u₀, u₁, v₀ and v₁.

    ``out`` has a row of all points for each of these numbers. ``room`` is memory for the lifts.
    """
    points, count = len(phases) // 2, len(torus.sizes) // 2
    wide = max(count, 2)
    for i in abreast(0, points):
        place = 2 * wide * i
        lifts_at(torus.torus, phases[2 * i], phases[2 * i + 1], wide, room, place)
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
    """Mumford's pair in the coordinate x = E − 1/X from the pair U = X² + sX + p, V = slope·X + y; E is ``pole``."""
    for _ in range(3):
        # V is divided by X: modulo U = X² + sX + p, 1/X = −(X + s)/p
        y, slope = slope - s * y / p, -y / p
    a, b = -s / p, 1 / p
    # modulo U, X = p(x − E) − s
    slope, y = slope * p, y - slope * s
    return pole * pole - a * pole + b, a - 2 * pole, y - slope * pole, slope


def lifts_strayed(torus: PairTorus, room: Row, out: Row) -> None:
    """Compares derivatives of the lifts with the equations of motion by :func:`integrable.torus.lifts.most_strayed`."""
    count = len(torus.ends)
    wide, right = 2 * count, room[2 * count * AROUND * CHECKED :]
    put_around(torus.torus, torus.frequencies, room)
    for n in abreast(0, CHECKED):
        for k in range(count):
            sigma, nu = rates_of(torus, room, AROUND * wide * n, k)
            right[wide * n + 2 * k], right[wide * n + 2 * k + 1] = sigma, nu
    most_strayed(torus.frequencies, wide, room, right, out)


def rates_of(torus: PairTorus, lifts: Row, place: int, k: int) -> tuple[Real, Real]:
    """The derivatives of σ and ν at branch point k along the direction (c₀, c₁).

    2σ' = −nν + c₀v₁σ and 2ν' = −qσ − c₀v₁ν at e, with n = c₁ + c₀(u₁ + ξ), W = (f − V²)/U and q = ⌊nW/U⌋.
    """
    u0, u1, v0, v1 = pair_between(torus.ends, torus.sides, lifts, place)
    curve, (c0, c1), e = torus.curve, (torus.direction[0], torus.direction[1]), torus.ends[k]
    sigma, nu = lifts[place + 2 * k], lifts[place + 2 * k + 1]
    _, w1, w2, w3 = cofactor_at(curve, (u0, u1, v0, v1))
    high = c1 + c0 * u1
    # q is the quotient of nW by U; it depends only on the terms of nW of degrees 4, 3 and 2
    q2 = c0 * w3
    q1 = c0 * w2 + high * w3 - u1 * q2
    q0 = c0 * w1 + high * w2 - u1 * q1 - u0 * q2
    n, q, lean = high + c0 * e, q0 + e * (q1 + e * q2), c0 * v1
    return (lean * sigma - n * nu) / 2, -((q * sigma + lean * nu) / 2)


def mean_square(torus: PairTorus, k: int, along: Row, beyond: Row, out: Row) -> None:
    """Writes to out[0] the mean over the torus of σ² at branch point k, where e = ``ends[k]`` is beyond both ovals.

    With the derivatives ∂ along (0, 1) and ∂' along (1, e), ℓσ²/4 − ∂∂'log θ_∞ is constant, and ∂∂'log θ_∞ has mean 0.
    ``along`` are the turns of both phases along (0, 1), ``beyond`` those along (1, e).
    """
    lifts_at(torus.torus, 0 * along[0], 0 * along[0], k + 1, out, 0)
    bend = curvature(torus.torus.sums, torus.torus.places, along, beyond)
    out[0] = out[2 * k] * out[2 * k] - 4 * bend / torus.curve[5]


def curvature(sums: ThetaSums, phases: Row, one: Row, two: Row) -> Real:
    """The second derivative of log θ_∞ (:mod:`integrable.torus.lifts`) along two directions, in turns of the phases."""
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


PAIRS = record(PairTorus, TORUS, *(WIDES,) * 9)
LIBRARY = Library(
    "pairs",
    {
        "oval_data": (oval_data, (WIDES, FLOATS, FLOAT, WIDES, WIDES, WIDES, WIDES)),
        "strayed": (lifts_strayed, (PAIRS, WIDES, FLOATS)),
        "pairs_at": (pairs_at, (PAIRS, WIDES, WIDES, WIDES)),
        "mean_square": (mean_square, (PAIRS, INT, WIDES, WIDES, WIDES)),
    },
    SPECIAL,
)
