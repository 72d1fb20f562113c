"""The set-up of a torus of the ball or the top: periods, theta functions of the α_i and the phases of the start; on
bare reals, compiled or interpreted.

Let e₁ ≤ e₂ < e₃ ≤ e₄ be the ends of both ovals, α₁, α₂, α₃ the roots of f that belong to the axes, and A the periods
of (dx/y, x dx/y) around the ovals. Let iY = A⁻¹B with the periods B around the gap between the ovals and the gap behind
the second oval. The phases are the integrals from e₁ and e₃ to the points of the divisor. If d = 0, the root 1/d of f
is at infinity, and Y₁₁ is infinite.
"""

from __future__ import annotations

from functools import cache
from math import floor

import numpy as np

from integrable.moving_point.addition import Real, Row
from integrable.moving_point.elliptic_integrals import complete, mean_slowness, oval_periods, quadratic_periods
from integrable.moving_point.problem import MATRIX, MOMENTUM, SLOWNESS, TIME_SCALE
from integrable.phase.coordinates import gamma_and_w
from integrable.torus.lifts import Limits, Torus, met
from jacobian.numbers.roots import root

# positions in the row of FOUND numbers that :func:`torus_periods` fills: two periods (four numbers), the turns of both
# phases per unit of τ, the shape of the theta functions (Y and the turns of both phases along (0, 1)), the mean of 1/g
FREQUENCIES, IMAGINARY, ALONG, MEAN, FOUND = 4, 6, 9, 11, 12
# the characteristics (ε₁, ε₂, δ₁, δ₂) of e₁, e₂, e₃, e₄, the fifth branch point and infinity, in the basis a₁, a₂ − a₁,
# where a₁ and a₂ are the ovals
CLASSES = ((1, 1, 0, 1), (1, 1, 1, 1), (0, 1, 1, 1), (0, 1, 0, 0), (0, 0, 0, 0), (0, 0, 0, 1))
# the size of the working memory of :func:`placed`, in numbers
PLACING = 27
# the phases in floats are integrals along a path, by the trapezoidal rule in log(v/(1 − v)) for the fraction v of the
# path: BEFORE and AFTER nodes before and after its middle, SPACING apart. The error is 1e-11, even if the next branch
# point is only e^−80 of the path beyond an end
BEFORE, AFTER, SPACING = 160, 110, 0.75


def gap_periods(motion: Row, pi: Real, near: float, out: Row) -> None:
    """Writes to ``out`` 2∫dx/|y| and 2∫x dx/|y| over the gap between the ovals, then over the gap after the second
    oval.

    For d = 0 the latter is infinite, and 0 is written. In the variable X = (e₂ − c)/(c − x), with c in the first oval,
    all six branch points are finite.
    """
    e1, e2, e3, e4, d, r = motion[0], motion[1], motion[2], motion[3], motion[8], motion[10]
    if d == 0:
        ratio = (e4 - e2) / (e4 - e3)
        k = root(ratio * (e3 - e1) / (e2 - e1))
        scale = 4 / root((e4 - e3) * (e2 - e1) * r)
        middle = (e2 + e3) / 2
        out[0] = scale * complete(k, ratio, 1 + 0 * k, ratio, pi, near)
        rest = scale * complete(k, ratio, e2 - middle, ratio * (e3 - middle), pi, near)
        out[1] = rest + middle * out[0]
        out[2], out[3] = 0 * k, 0 * k
        return
    # ``after`` is e₂ − c: half the first oval, or e₄ − e₂ if that is less
    after = (e2 - e1) / 2
    if float(e4 - e2) < float(after):
        after = e4 - e2
    before, d3, d4, c = (e2 - e1) - after, (e3 - e2) + after, (e4 - e2) + after, e2 - after
    last, one = r - d * c, 1 + 0 * d
    x1, x2, x3, x4, x5 = after / before, -one, -(after / d3), -(after / d4), -(d * after / last)
    # x1 … x5 are X(x) = after/(c − x) at e₁, …, e₄ and at the root of r − dx; at2 … at5 are x1 − x2, …, x1 − x5
    at2, at3, at4 = (e2 - e1) / before, after * (e3 - e1) / (before * d3), after * (e4 - e1) / (before * d4)
    at5 = after * (r - d * e1) / (before * last)
    values = -(x2 * at2), -(x3 * at3), -(x4 * at4), -(x5 * at5)
    third = (0 * one, -x1, one), values
    quadratic_periods((x2, x3, x4, x5), after * (e4 - e3) / (d3 * d4), third, pi, near, out)
    scale = root(after / (before * d3 * d4 * last))
    for n in range(2):
        zeroth, first = out[2 * n], out[2 * n + 1]
        out[2 * n], out[2 * n + 1] = -(scale * first), scale * (after * zeroth - c * first)


def torus_periods(motion: Row, near: float, room: Row, out: Row) -> tuple[int, int, int, int]:
    """Fills ``out``; returns the basis Λ₁, Λ₂ as integer rows (m₁, n₁), (m₂, n₂) in the periods of the two ovals.

    ``out`` gets Λ₁, Λ₂ (four numbers), the turns ν₁, ν₂ of both phases per unit of the flow's time, the entries Y₁₁,
    Y₁₂, Y₂₂ of Y, the turns of both phases over a path with (Σ∫dx/y, Σ∫x dx/y) = (0, 1), and
    :func:`integrable.moving_point.elliptic_integrals.mean_slowness`. If d = 0, Y₁₁ is infinite and 0 is written.
    """
    ends, d, pi, r = (motion[0], motion[1], motion[2], motion[3]), motion[8], motion[9], motion[10]
    oval_periods(ends, d, r, pi, near, out)
    gap_periods(motion, pi, near, room)
    a1, b1, a2, b2 = out[0], out[1], out[2] - out[0], out[3] - out[1]
    m1, n1, m2, n2, flat = 1, 0, -1, 1, d == 0
    if flat:
        a2 = 0 * a2
    area = a1 * b2 - a2 * b1
    y11 = (room[0] * b2 - room[1] * a2) / area
    y12 = (a1 * room[1] - b1 * room[0]) / area
    y22 = (a1 * room[3] - b1 * room[2]) / area
    for _ in range(200):
        if not flat and float(y22) < float(y11) * (1 - 1e-9):
            a1, b1, a2, b2, y11, y22 = a2, b2, a1, b1, y22, y11
            m1, n1, m2, n2 = m2, n2, m1, n1
            area = -area
        turns = floor(float(y12) / float(y11) + 0.5)
        if turns == 0:
            break
        a1, b1, m1, n1 = a1 + turns * a2, b1 + turns * b2, m1 + turns * m2, n1 + turns * n2
        y12, y22 = y12 - turns * y11, y22 - turns * (2 * y12 - turns * y11)
    # the second phase gets more harmonics, since a series with few long rows is summed faster
    out[0], out[1], out[2], out[3] = a2, b2, a1, b1
    # the flow has the direction (1, −motion[11])
    out[4], out[5] = -((b1 + motion[11] * a1) / area), (b2 + motion[11] * a2) / area
    out[6], out[7], out[8] = 0 * y22 if flat else y22, y12, y11
    out[9], out[10] = a1 / area, -(a2 / area)
    out[11] = mean_slowness(ends, d, r, pi, near, area)
    return m2, n2, m1, n1


@cache
def rule_of_phases() -> np.ndarray:
    """v, 1 − v and the weight of each node of the trapezoidal rule in log(v/(1 − v)) for ∫dv/√v from 0 to 1."""
    t = SPACING * np.arange(-BEFORE, AFTER + 1)
    v, rest = 1 / (1 + np.exp(-t)), 1 / (1 + np.exp(t))
    return np.ascontiguousarray(np.stack([v, rest, SPACING * np.sqrt(v) * rest], axis=1).ravel())


def rough_phases(motion: Row, start: Row, found: Row, rule: Row) -> tuple[float, float]:
    """The phases of the start in floats, in turns: the integrals of (dx/y, x dx/y) from e₁ and e₃ to the points of the
    divisor, in units of the periods ``found``. ``rule`` is the result of :func:`rule_of_phases`.
    """
    u0, u1, v0, v1 = start[0], start[1], start[2], start[3]
    square = u1 * u1 / 4 - u0
    half = root(square) if square > 0 else 0 * u1
    zeroth, first = 0.0, 0.0
    for k in range(2):
        begin, end = motion[2 * k], motion[2 * k + 1]
        x = -u1 / 2 - half if k == 0 else half - u1 / 2
        x = max(begin, min(end, x))
        length, rest = float(x - begin), float(end - x)
        low, high = float(motion[2] - x), float(motion[3] - x)
        if k == 1:
            low, high = float(begin - motion[1]), float(begin - motion[0])
        d, last, origin = float(motion[8]), float(motion[10] - motion[8] * x), float(begin)
        total, slope = 0.0, 0.0
        for n in range(len(rule) // 3):
            v, other, weight = rule[3 * n], rule[3 * n + 1], rule[3 * n + 2]
            # distances from the other three branch points of the ovals, and the last factor of f
            if k == 0:
                product = (low + length * other) * (high + length * other)
            else:
                product = (low + length * v) * (high + length * v)
            product *= (rest + length * other) * (last + d * length * other)
            part = weight / float(root(product))
            total += part
            slope += part * v
        scale = float(root(length))
        if float(v0 + v1 * x) < 0:
            scale = -scale
        zeroth += scale * total
        first += scale * (origin * total + length * slope)
    a1, b1, a2, b2 = float(found[0]), float(found[1]), float(found[2]), float(found[3])
    area = float(found[0] * found[3] - found[1] * found[2])
    return (zeroth * b2 - first * a2) / area, (a1 * first - b1 * zeroth) / area


def placed(
    torus: Torus, motion: Row, point: Row, found: Row, scales: Row, rule: Row, limits: Limits, room: Row
) -> float:
    """Sets the factors to the C_i of :mod:`integrable.torus.states`, and the phases to those of the moving ``point`` by
    :func:`integrable.torus.lifts.met`. Returns the result of ``met``.

    ``motion`` is a :func:`integrable.torus.lattice.motion_row`, ``found`` the result of :func:`torus_periods`;
    ``scales`` are the numbers by which theta functions are divided; ``rule`` is for :func:`rough_phases`.
    """
    start, d, r, zeta = room[:6], motion[8], motion[10], motion[7]
    for i in range(3):
        x, y, z = motion[4 + i], motion[4 + (i + 1) % 3], motion[4 + (i + 2) % 3]
        torus.factors[i] = root(root(abs(x - zeta) / ((r - d * x) * abs(x - y) * abs(x - z))))
    start_frame(point, start)
    first, second = rough_phases(motion, point, found, rule)
    torus.places[0], torus.places[1] = 0 * d + first, 0 * d + second
    return met(torus, scales, start, limits, room[6:])


def start_frame(point: Row, out: Row) -> None:
    """Writes γ̃_1, w̃_1, γ̃_2, … (:mod:`integrable.torus.states`) of a moving point."""
    gamma, w = gamma_and_w(point)
    size = 1 / root(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    for i in range(3):
        out[2 * i], out[2 * i + 1] = gamma[i], size * w[i]


def surveyed_rates(
    problem: Row, found: Row, motion: Row, tilt: Row, units: tuple[float, float], matrix: Row, rates: Row, out: Row
) -> None:
    """Writes the ``matrix`` of :class:`~integrable.torus.states.BodyStates`; the ``rates`` of
    :class:`~integrable.torus.clock.TorusClock`, in the user's units; and to ``out`` the numbers of the
    :class:`~integrable.torus.lifts.RateSums`: a_i = r − d'α_i, b_i = 1, s = α·lift, and c_i = β(α_k − α_j)/lift².

    ``problem`` is a :func:`~integrable.moving_point.problem.problem_row`, ``found`` the result of
    :func:`torus_periods`, ``motion`` a :func:`integrable.torus.lattice.motion_row`; ``tilt`` are α and β of
    :func:`integrable.moving_point.addition.rate_at`, ``units`` the length and the lift of
    :class:`integrable.torus.lattice.Units`, which defines r and d'.
    """
    (length, lift), d = units, motion[8]
    scale = problem[TIME_SCALE] * (length * lift)
    matrix[0], matrix[1] = problem[MATRIX], problem[MATRIX + 1] * problem[MOMENTUM]
    matrix[2], matrix[3] = problem[MATRIX + 2], problem[MATRIX + 3] * problem[MOMENTUM]
    rates[0], rates[1] = found[FREQUENCIES] * scale, found[FREQUENCIES + 1] * scale
    rates[2], rates[3] = problem[SLOWNESS] * found[MEAN] / (lift * lift), 2 * motion[9]
    out[6], lean = tilt[0] * lift, tilt[1] / (lift * lift)
    for i in range(3):
        out[2 * i], out[2 * i + 1] = motion[10] - d * motion[4 + i], 1 + 0 * d
        out[7 + i] = lean * (motion[4 + (i + 2) % 3] - motion[4 + (i + 1) % 3])
