"""Elliptic integrals. Functions for incomplete integrals take arrays of the numbers that their argument N defines
(:mod:`integrable.moving_point.arithmetic`). Functions for complete integrals and for periods of two ovals take bare
reals and are compiled unchanged.

The incomplete integral of the third kind uses duplication (Carlson 1995, *Numerical computation of real or complex
elliptic integrals*). The integral of the first kind and the amplitude use descending Landen transformations (Abramowitz
& Stegun 16.4, 17.6). Errors are a few units in the last place. Complete integrals and periods use arithmetic-geometric
means.
"""

from __future__ import annotations

from math import ceil, log
from typing import Any

import numpy as np

from integrable.moving_point.addition import Real, Row
from integrable.moving_point.arithmetic import LongDoubles, Multiprecision
from jacobian.numbers.roots import root

Array = np.ndarray
# below this e, arctan(√e)/√e is summed as a series
SMALL = 1e-3


def carlson_j(N: LongDoubles | Multiprecision, x: Array, y: Array, z: Array, p: Array, product: Array) -> Array:
    """R_J(x, y, z, p) = (3/2)∫dt/((t+p)√((t+x)(t+y)(t+z))), p > 0; ``product`` = (p − x)(p − y)(p − z) ≥ 0."""
    mean = start = (x + y + z + 2 * p) / 5
    farthest = np.maximum(np.maximum(abs(start - x), abs(start - y)), np.maximum(abs(start - z), abs(start - p)))
    bound, scale = (N.eps / 4) ** (-1 / 8) * farthest, 1 + 0 * N.eps
    dx, dy, dz, total = start - x, start - y, start - z, 0 * start
    while np.any(bound * scale > mean):
        root_x, root_y, root_z, root_p = N.sqrt(x), N.sqrt(y), N.sqrt(z), N.sqrt(p)
        step = root_x * root_y + root_x * root_z + root_y * root_z
        d = (root_p + root_x) * (root_p + root_y) * (root_p + root_z)
        total += scale / d * arctan_over(N, scale**3 * product / d / d)
        x, y, z, p = (x + step) / 4, (y + step) / 4, (z + step) / 4, (p + step) / 4
        mean, scale = (mean + step) / 4, scale / 4
    dx, dy, dz = dx * scale / mean, dy * scale / mean, dz * scale / mean
    dp, e = (-dx - dy - dz) / 2, dx * dy * dz
    e2 = dx * dy + dx * dz + dy * dz - 3 * dp * dp
    e3, e4, e5 = e + (2 * e2 + 4 * dp * dp) * dp, (2 * e + (e2 + 3 * dp * dp) * dp) * dp, e * dp * dp
    series = 1 - 3 * e2 / 14 + e3 / 6 + 9 * e2 * e2 / 88 - 3 * e4 / 22 - 9 * e2 * e3 / 52 + 3 * e5 / 26
    series += 3 * e3 * e3 / 40 - e2 * e2 * e2 / 16 + 3 * e2 * e4 / 20
    series += 45 * e2 * e2 * e3 / 272 - 9 * (e3 * e4 + e2 * e5) / 68
    return scale * series / (mean * N.sqrt(mean)) + 6 * total


def arctan_over(N: LongDoubles | Multiprecision, e: Array) -> Array:
    """arctan(√e)/√e for e ≥ 0."""
    # fmax ignores a NaN, which therefore does not affect the other entries
    most, series = float(np.fmax.reduce(e, axis=None, initial=0)), 0 * e
    if np.fmin.reduce(e, axis=None, initial=SMALL) < SMALL:
        # number of terms for the largest argument below SMALL
        least = max(min(most, SMALL), 1e-300)
        for n in range(ceil((N.bits + 2) * log(2) / -log(least)), -1, -1):
            series = 1 / (2 * n + 1 + 0 * N.eps) - e * series
    if most < SMALL:
        return series
    far = N.sqrt(np.maximum(e, SMALL))
    return np.where(e < SMALL, series, N.arctan(far) / far)


def amplitude(N: LongDoubles | Multiprecision, v: Array, k: Real) -> Array:
    """x with ∫_0^x dy/√(cos²y + k²sin²y) = v, |x| ≤ π/2, for 0 < k ≤ 1."""
    a, b, levels = 1 + 0 * k, k, []
    while True:
        levels.append((a - b) / (a + b))
        a, b = (a + b) / 2, N.sqrt(a * b)
        if abs(a - b) <= N.eps * a:
            break
    x = v * a * 2 ** len(levels)
    for ratio in levels[::-1]:
        # x is replaced by the x' with sin(2x' − x) = ratio·sin x
        x = (x + N.arcsin(np.clip(ratio * N.sin(x), -1, 1))) / 2
    return x


class FirstKind:
    """F(x | m), |x| ≤ π/2, and its inverse for one k = √(1 − m) > 0. F is (2K/π)x plus a periodic part, the swing.

    ``missing`` = 1 − k and ``quarter`` = K are numbers of the same kind as x.
    """

    def __init__(self, N: LongDoubles | Multiprecision, k: Real, missing: Real, quarter: Real) -> None:
        self.k, self.missing, self.quarter, self._numbers = k, missing, quarter, N

    def swing(self, x: Array) -> Array:
        """F(x | m) − (2K/π)x. The relative error is of rounding size, although the value is only of the order of m.

        The value is a weighted sum of the changes of x in descending Landen transformations (Abramowitz & Stegun 17.6).
        """
        N: Any = self._numbers
        a, b, difference = 1 + 0 * self.k, self.k, self.missing
        total, weight = 0 * x, a
        while True:
            s, c = N.sin(x), N.cos(x)
            change = -N.arctan2(difference * s * c, a * c * c + b * s * s)
            weight = weight / 2
            total = total + weight * change
            x = 2 * x + change
            roots = N.sqrt(a) + N.sqrt(b)
            a, b, difference = (a + b) / 2, N.sqrt(a * b), (difference / roots) ** 2 / 2
            if abs(difference) <= N.eps**2 * a:
                return total / a

    def at(self, x: Array) -> Array:
        return 2 * self.quarter / self._numbers.pi * x + self.swing(x)

    def inverse(self, v: Array) -> Array:
        """x with F(x | m) = v."""
        k, N = self.k, self._numbers
        x = amplitude(N, v, k) if k <= 1 else N.pi / 2 - amplitude(N, k * (self.quarter - v), 1 / k)
        # one Newton step removes the rounding error of the transformations
        return x - (self.at(x) - v) * N.sqrt(N.cos(x) ** 2 + (k * N.sin(x)) ** 2)


# --- complete integrals, on bare reals


def oval_periods(ends: Row, d: Real, r: Real, pi: Real, near: Real, out: Row) -> None:
    """Writes 2∫dx/√|PQR| and 2∫x dx/√|PQR| between the roots of P, then both integrals between the roots of Q, to
    ``out``. P and Q are monic with the roots ends[0] ≤ ends[1] and ends[2] ≤ ends[3]. The root of R = r − dx lies
    beyond these four roots.

    The method is the arithmetic-geometric mean of genus 2 (Richelot 1837; Bost & Mestre 1988). With U = Q'R − QR', V
    and W by cyclic permutation, and Δ the determinant of the coefficients of P, Q and R, ∫dx/√|PQR| = 2√Δ∫dx/√|UVW|.
    The new limits of integration are a root of V and a root of W, or a root of W and a root of U. They are closer
    together than the old limits. The method converges quadratically, however close the branch points are. It ends when
    each oval is shorter than ``near``, of the order of √eps, times the distance to the other branch points.
    """
    one = 1 + 0 * ends[0]
    # the coefficients of R, ascending, and its values at the ends
    rest = r * one, -d * one, 0 * one
    values = r - d * ends[0], r - d * ends[1], r - d * ends[2], r - d * ends[3]
    points = ends[0], ends[1], ends[2], ends[3]
    quadratic_periods(points, ends[2] - ends[1], (rest, values), pi, near, out)


def quadratic_periods(points: Row, gap: Real, third: tuple[Row, Row], pi: Real, near: Real, out: Row) -> None:
    """:func:`oval_periods` with the four ``points`` as ends, for any R whose roots lie beyond them.

    ``gap`` is points[2] − points[1], ``third`` are the coefficients of R, ascending, and its values at the points.
    """
    rest, values = third
    scale = 2 + 0 * points[0]
    # the method ends when both ovals are short compared with their distance, and R hardly varies over either of them
    while (
        max(points[1] - points[0], points[3] - points[2]) > near * gap
        or abs(values[0] - values[1]) > near * abs(values[0])
        or abs(values[2] - values[3]) > near * abs(values[2])
    ):
        points, gap, rest, values, factor = richelot(points, gap, rest, values)
        scale *= factor
    p1, p2, q1, q2 = points
    r0, r1, r2 = rest
    x = (p1 + p2) / 2
    out[0] = scale * pi / root(abs((x - q1) * (x - q2) * (r0 + x * (r1 + x * r2))))
    out[1] = out[0] * x
    x = (q1 + q2) / 2
    out[2] = scale * pi / root(abs((x - p1) * (x - p2) * (r0 + x * (r1 + x * r2))))
    out[3] = out[2] * x


def richelot(points: Row, gap: Real, rest: Row, values: Row) -> tuple[Row, Real, Row, Row, Real]:
    """One step of :func:`oval_periods`: the ends of the new ovals, the gap between the ovals, the new R, its values at
    the ends, and 2√|Δ/leads|, where leads is the product of the leading coefficients of U, V and W.
    """
    (p1, p2, q1, q2), (r0, r1, r2) = points, rest
    one = 1 + 0 * p1
    a0, a1, b0, b1 = p1 * p2, -p1 - p2, q1 * q2, -q1 - q2
    u0, u1, u2 = bracket_of_quadratics(b0, b1, one, r0, r1, r2)
    v0, v1, v2 = bracket_of_quadratics(r0, r1, r2, a0, a1, one)
    w0, w1, w2 = bracket_of_quadratics(a0, a1, one, b0, b1, one)
    # Δ is the determinant of the coefficients of P, Q and R, expanded by those of R
    determinant = r0 * w2 - r1 * w1 / 2 + r2 * w0
    # the discriminant of W is the resultant of P and Q, a product of differences of the ends; those of U and V are
    # resultants with R, products of values of R at the ends
    spread = root((q1 - p1) * (q2 - p1) * gap * (q2 - p2))
    x1, x2 = roots_between(w0, w1, w2, spread)
    gap = 2 * spread / abs(w2)
    if u2 == 0:
        # the new R is constant, and ∞ is a root of U and V
        y1, z1 = -u0 / u1, -v0 / v1
        factor = 2 * root(abs(determinant / (w2 * u1 * v1)))
        return (z1, x1, x2, y1), gap, (one, 0 * one, 0 * one), (one, one, one, one), factor
    y1, y2 = roots_between(u0, u1, u2, root(abs(values[2] * values[3])))
    z1, z2 = roots_between(v0, v1, v2, root(abs(values[0] * values[1])))
    ends = (z1, x1, x2, y1)
    at_ends = (
        (y2 - z1) * (z2 - z1),
        (y2 - x1) * (z2 - x1),
        (y2 - x2) * (z2 - x2),
        (y2 - y1) * (z2 - y1),
    )
    return ends, gap, (y2 * z2, -y2 - z2, one), at_ends, 2 * root(abs(determinant / (w2 * u2 * v2)))


def complete(k: Array, p: Real, a: Real, b: Real, pi: Real, near: float) -> Real:
    """The general complete elliptic integral ∫ (a cos²φ + b sin²φ)/((cos²φ + p sin²φ)√(cos²φ + k² sin²φ)) dφ from 0 to
    π/2, for positive k and p, to a relative error of ``near``² (Bulirsch 1969, algorithm cel).
    """
    k, p = 1 * k, root(p)
    b, e, m = b / p, k, 1 + 0 * k
    for _ in range(100):
        f, g = a, e / p
        a, b, p, last, m = a + b / p, 2 * (b + f * g), g + p, m, k + m
        if abs(last - k) <= near * last:
            break
        k = 2 * root(e)
        e = k * m
    return pi * (b + a * m) / (2 * m * (m + p))


def mean_slowness(ends: Row, d: Real, r: Real, pi: Real, near: float, area: Real) -> Real:
    """The mean over the torus of 1/√((r − du₁)(r − du₂)). u₁ and u₂ run over the two ovals; ``area`` is the determinant
    of their periods.

    The invariant measure is (u₂ − u₁)du₁du₂/(y₁y₂). The mean is therefore a determinant of complete elliptic integrals
    ∫x^k dx/((r − dx)√((x − e₁)(x − e₂)(x − e₃)(x − e₄))), where e_i are the ends. They are computed with powers
    of x − ``middle`` instead of x, where ``middle`` is midway between the ovals, so that nothing cancels.
    """
    middle = (ends[1] + ends[2]) / 2
    low0, low1 = slowed((ends[0], ends[1], ends[2], ends[3]), middle, d, r, pi, near)
    high0, high1 = slowed((ends[2], ends[3], ends[1], ends[0]), middle, d, r, pi, near)
    return 4 * (high1 * low0 - low1 * high0) / abs(area)


def slowed(ends: Row, middle: Real, d: Real, r: Real, pi: Real, near: float) -> tuple[Real, Real]:
    """∫_a^b (x − middle)^k dx/((r − d·x)√|(x − a)(x − b)(x − c)(x − e)|) for k = 0 and 1, where a, b, c, e are the
    ``ends``. c and e lie on the same side of a and b.
    """
    a, b, c, e = ends
    # the substitution is x = (a cos²φ + b·ratio·sin²φ)/(cos²φ + ratio·sin²φ)
    ratio = (c - a) / (c - b)
    k = root(ratio * (e - b) / (e - a))
    p = ratio * (r - d * b) / (r - d * a)
    scale = 2 / (root((c - b) * (e - a)) * (r - d * a))
    return (
        scale * complete(k, p, 1 + 0 * p, ratio, pi, near),
        scale * complete(k, p, a - middle, ratio * (b - middle), pi, near),
    )


def bracket_of_quadratics(p0: Real, p1: Real, p2: Real, q0: Real, q1: Real, q2: Real) -> tuple[Real, Real, Real]:
    """The coefficients of p'q − pq' for two quadratics, ascending."""
    return p1 * q0 - p0 * q1, 2 * (p2 * q0 - p0 * q2), p2 * q1 - p1 * q2


def roots_between(w0: Real, w1: Real, w2: Real, spread: Real) -> tuple[Real, Real]:
    """The roots of w0 + w1·x + w2·x², ascending. ``spread`` is half the square root of the discriminant."""
    far = -w1 / 2
    far = far + spread if far >= 0 else far - spread
    first, second = far / w2, w0 / far
    return (first, second) if first <= second else (second, first)
