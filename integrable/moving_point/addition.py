"""The inner steps of the exact flow, on bare reals; the compiler takes them unchanged.

A *moving point* is (u0, u1, v0, v1, σ1, σ2, σ3, ν1, ν2, ν3): the divisor U = x² + u1·x + u0, V = v1·x + v0, and for
every axis the pair (σ_i, ν_i), a lift. σ_i carries the sign of γ_i = σ_i/|σ|; κ_iσ_i² = U(α_i), κ_iσ_iν_i = V(α_i). A
*translation* is such a tuple with κ_i = 1. All numbers are in the units of
:class:`integrable.moving_point.problem.Problem`. They are ``float`` or ``mpf``, in lists, tuples or numpy rows.
``axes`` is (α1, α2, α3, κ1, κ2, κ3, α, β). α and β give the rate of a tilted body's clock (:func:`rate_at`); for an
upright body they are (1, 0).
"""

from __future__ import annotations

from typing import Any

from jacobian.element import Real as Real
from jacobian.inexact.genus2_real import add, chord
from jacobian.inexact.retraction import retracted
from jacobian.numbers.roots import root

Row = Any


def shift(f: Row, axes: Row, point: Row, step: Row) -> Row:
    """The moving point after the addition of a translation; its pairs are corrected to fit the divisor."""
    return settled(f, axes, carried(f, axes, point, step), noise(step))


def noise(step: Row) -> Real:
    """The argument ``trust`` of :func:`settle` after a translation. It grows with the translation's coefficients, as
    the rounding errors of the sum do.
    """
    return 0.003 * max(1, step[0] * step[0], step[1] * step[1])


def carried(f: Row, axes: Row, point: Row, step: Row) -> Row:
    """The moving point after the addition of a translation, uncorrected: the sum of the divisors, and
    every pair by the addition law of lifts (:func:`pair`).
    """
    divisor, transfer = add(curve_of(f), divisor_of(point), divisor_of(step))
    x1, y1 = pair(axes[0], axes[3], point[4], point[7], step[4], step[7], transfer)
    x2, y2 = pair(axes[1], axes[4], point[5], point[8], step[5], step[8], transfer)
    x3, y3 = pair(axes[2], axes[5], point[6], point[9], step[6], step[9], transfer)
    return divisor[0], divisor[1], divisor[2], divisor[3], x1, x2, x3, y1, y2, y3


def settled(f: Row, axes: Row, point: Row, trust: Real) -> Row:
    """The point with every pair corrected towards κσ² = U, κσν = V and κν² = −W at its branch point,
    where W = (f − V²)/U.
    """
    divisor = divisor_of(point)
    rest = cofactor_at(f, divisor)
    x1, y1 = settled_pair(divisor, rest, axes[0], axes[3], point[4], point[7], trust)
    x2, y2 = settled_pair(divisor, rest, axes[1], axes[4], point[5], point[8], trust)
    x3, y3 = settled_pair(divisor, rest, axes[2], axes[5], point[6], point[9], trust)
    return divisor[0], divisor[1], divisor[2], divisor[3], x1, x2, x3, y1, y2, y3


def cofactor_at(f: Row, divisor: Row) -> Row:
    """The coefficients of W = (f − V²)/U, ascending."""
    b0, b1, c1 = divisor[0], divisor[1], divisor[3]
    w2 = f[4] - b1 * f[5]
    w1 = f[3] - b1 * w2 - b0 * f[5]
    return f[2] - c1 * c1 - b1 * w1 - b0 * w2, w1, w2, f[5]


def settled_pair(
    divisor: Row, rest: Row, a: Real, kappa: Real, sigma: Real, nu: Real, trust: Real
) -> tuple[Real, Real]:
    """The pair at the branch point a, corrected as in :func:`settled`, whose W is ``rest``."""
    b0, b1, c0, c1 = divisor
    w0, w1, w2, w3 = rest
    return settle(sigma, nu, kappa, (a + b1) * a + b0, c1 * a + c0, ((w3 * a + w2) * a + w1) * a + w0, trust)


def settle(sigma: Real, nu: Real, kappa: Real, u: Real, v: Real, w: Real, trust: Real) -> tuple[Real, Real]:
    """The correction of :func:`settled` for one pair: one Gauss–Newton step.

    ``u``, ``v``, ``w`` are U, V, W at the branch point. ``trust`` is the squared ratio of their noise to the noise of
    the uncorrected pair. Where κ is small (nearly equal moments) the pair hardly changes.
    """
    x, y = kappa * sigma, kappa * nu
    e1, e2, e3 = leading(u - x * sigma), leading(v - x * nu), leading(-w - y * nu)
    # the correction has the size of rounding errors, so floats have enough digits for it
    kappa, s, n = leading(kappa), leading(sigma), leading(nu)
    k2, s2, n2 = 2 * kappa * kappa, s * s, n * n
    m11, m12, m22 = k2 * (2 * s2 + n2) + leading(trust), k2 * s * n, k2 * (s2 + 2 * n2) + leading(trust)
    r1, r2 = 2 * kappa * (s * e1 + n * e2), 2 * kappa * (s * e2 + n * e3)
    scale = 1 / (m11 * m22 - m12 * m12)
    return sigma + (m22 * r1 - m12 * r2) * scale, nu + (m11 * r2 - m12 * r1) * scale


def pair(a: Real, kappa: Real, sigma: Real, nu: Real, sigma2: Real, nu2: Real, transfer: Row) -> tuple[Real, Real]:
    """The pair (σ'', ν'') of the sum of two points at the branch point a, from the pairs (σ, ν) and (σ', ν') of the two
    points and the ``transfer`` polynomials of their sum.

    Two formulas give the pair: one divides by σ', the other by κσ. Their least-squares combination divides by a small
    number only if both points are at the same branch point.
    """
    q, l1, l0, k0, m0, n1, n0, j0 = transfer
    # rounding errors of the formula that divides by κσ grow with ν', which is large near the identity
    weight = 1 / max(1, leading(nu2) * leading(nu2))
    x, y = sigma2, kappa * sigma
    scale = 1 / (l1 * (x * x + weight * y * y))
    y *= weight
    slope, n, m = l1 * a, n1 * a, l1 * a + m0
    new_sigma = x * (q * nu + (l0 + slope) * sigma) + y * (q * nu2 + (k0 + slope) * sigma2)
    new_nu = x * ((n0 + n) * sigma + m * nu) + y * ((j0 + n) * sigma2 + m * nu2)
    return new_sigma * scale, new_nu * scale


def rate_at(axes: Row, point: Row) -> Real:
    """1/g at a moving point, with (α1, α2, α3, κ1, κ2, κ3, α, β) = ``axes``: 1/√Σσ² for an upright body, and
    (α + βΣ(α_k − α_j)ν_iσ_jσ_k)/√Σσ² for a tilted one. The second sum is over cyclic (i, j, k).
    """
    x1, x2, x3 = point[4], point[5], point[6]
    rate = 1 / root(x1 * x1 + x2 * x2 + x3 * x3)
    if axes[7] == 0:
        return rate
    lean = (axes[2] - axes[1]) * point[7] * x2 * x3
    lean += (axes[0] - axes[2]) * point[8] * x3 * x1
    lean += (axes[1] - axes[0]) * point[9] * x1 * x2
    return (axes[6] + axes[7] * lean) * rate


def rate_after(f: Row, axes: Row, point: Row, step: Row) -> Real:
    """1/g after the addition of a translation. For an upright body U and V of the sum are not computed."""
    if axes[7] != 0:
        return rate_at(axes, carried(f, axes, point, step))
    q, l1, l0 = chord(curve_of(f), divisor_of(point), divisor_of(step))
    k0 = l0 + (point[1] - step[1]) * l1
    total = 0 * l1
    for i in range(3):
        x, y = step[4 + i], axes[3 + i] * point[4 + i]
        slope = l1 * axes[i]
        weight = 1 / max(1, step[7 + i] * step[7 + i])
        sigma = x * (q * point[7 + i] + (l0 + slope) * point[4 + i]) + weight * y * (q * step[7 + i] + (k0 + slope) * x)
        sigma /= x * x + weight * y * y
        total += sigma * sigma
    return abs(l1) / root(total)


def upright_rates(f: Row, axes: Row, d: Real, point: Row, steps: Row, roots: Row) -> list[Real]:
    """:func:`rate_after` of an upright body for many translations, fast in interpreted code. ``roots`` holds
    √(1 + d(u1 + du0)) of each translation.

    Let (U, V) be the divisor of the point, U' the U of a translation and U'' that of the sum. Let P = qV + LU,
    L = l1·x + l0, with the q, l1 and l0 of :func:`chord`. At 1/d, where f = 0, U'' is P²/(l1²·U·U'), and g² is
    proportional to U. P loses digits if a 1 − dα_i is small.
    """
    curve, first = curve_of(f), divisor_of(point)
    height = 1 + d * (point[1] + d * point[0])
    slope, scale = d * d * (d * point[2] + point[3]), rate_at(axes, point) * height
    found = []
    for step, size in zip(steps, roots, strict=True):
        q, l1, l0 = chord(curve, first, (step[0], step[1], step[2], step[3]))
        found.append(abs(scale * l1 * size / (q * slope + (d * l0 + l1) * height)))
    return found


def leading(x: Row) -> Row:
    """x, a number or a row, unchanged. In compiled code this function gives the high parts of double-doubles."""
    return x


def integrate_series(coefficients: Row, x: Real) -> tuple[Real, Real]:
    """(integral from 0 to x, value at x) of a Legendre series on [−1, 1]."""
    value, total = coefficients[0] + 0 * x, coefficients[0] * x
    p0, p1 = 1 + 0 * x, x
    # z0 and z1 are values P_k(0), which make the integral vanish at 0
    z0, z1 = 1 + 0 * x, 0 * x
    for k in range(1, len(coefficients)):
        p2 = ((2 * k + 1) * x * p1 - k * p0) / (k + 1)
        z2 = -k * z0 / (k + 1)
        value += coefficients[k] * p1
        total += coefficients[k] * ((p2 - p0) - (z2 - z0)) / (2 * k + 1)
        p0, p1, z0, z1 = p1, p2, z1, z2
    return total, value


def moving_point(row: Row, place: int = 0) -> Row:
    """The moving point, or translation, in row[place … place + 9], as the tuple that :func:`shift` returns."""
    return (
        row[place], row[place + 1], row[place + 2], row[place + 3], row[place + 4],
        row[place + 5], row[place + 6], row[place + 7], row[place + 8], row[place + 9],
    )  # fmt: skip


def put(point: Row, row: Row, place: int) -> None:
    """Writes a moving point, or translation, to row[place … place + 9]."""
    row[place], row[place + 1], row[place + 2], row[place + 3] = point[0], point[1], point[2], point[3]
    row[place + 4], row[place + 5], row[place + 6] = point[4], point[5], point[6]
    row[place + 7], row[place + 8], row[place + 9] = point[7], point[8], point[9]


def curve_of(row: Row) -> Row:
    """The coefficients of f as a tuple; ``row`` begins with them."""
    return row[0], row[1], row[2], row[3], row[4], row[5]


def divisor_of(point: Row) -> Row:
    """(u0, u1, v0, v1) of a moving point or translation."""
    return point[0], point[1], point[2], point[3]


def opposite(step: Row) -> Row:
    """The inverse of a translation."""
    return step[0], step[1], -step[2], -step[3], step[4], step[5], step[6], -step[7], -step[8], -step[9]


def trust_of(step: Row) -> float:
    """A measure of the accuracy of additions of a translation; larger is better. It is large if the translation's
    points are far from the branch points and from infinity.
    """
    near = min(abs(float(step[4])), abs(float(step[5])), abs(float(step[6])))
    far = max(abs(float(step[0])), abs(float(step[1])), abs(float(step[2])), abs(float(step[3])))
    return near / (1 + far)


def march(f: Row, axes: Row, point: Row, step: Row, count: int) -> Row:
    """The moving point after ``count`` additions of the same translation.

    Every 16 additions the divisor is projected onto the curve and the pairs onto the divisor. Otherwise rounding errors
    would grow, for some translations exponentially (:mod:`jacobian.inexact.retraction`).
    """
    moved = moving_point(point)
    for i in range(count):
        moved = carried(f, axes, moved, step)
        if i % 16 == 15:
            u0, u1, v0, v1 = retracted(curve_of(f), divisor_of(moved))
            moved = (u0, u1, v0, v1, moved[4], moved[5], moved[6], moved[7], moved[8], moved[9])
            moved = settled(f, axes, moved, 0.003)
    return moved
