"""T(eps) by Newton's method on the integrals in x, and its expansion in eps² by sums of products: readable oracles."""

from __future__ import annotations

from math import ceil, log
from operator import mul
from typing import Any

from integrable.moving_point.balls import abel_slopes, abel_sums, conjugate_points
from integrable.moving_point.setup import Setup
from integrable.moving_point.translations import REACH

Real = Any
Row = Any
# number of terms that give a float all its digits, within the reach of a series
FLOAT_TERMS = 48
# number of terms per digit of a series within REACH
TERMS_A_DIGIT = log(10) / -log(1.4 * REACH)


def terms_of(setup: Setup) -> int:
    """The number of terms with which a series reaches the wide precision of a set-up within REACH."""
    return ceil(setup.digits * TERMS_A_DIGIT) + 4 + ceil(1.3 * (setup.wide.dps - setup.digits))


def near_identity(series: Row, roots: Row, f0: Real, axes: Row, eps: Real, passes: int) -> Row:
    """T(eps), the translation with Σ∫dx/y = eps and Σ∫x dx/y = 0. eps must lie inside the radius of convergence.

    ``series`` and ``roots`` are the power series of 1/√(f/f0) and √(f/f0) about x = 0. Every quantity is computed
    relative to eps, so no digit is lost as eps → 0. eps must not be 0.
    """
    m, r = estimate(series, f0, eps)
    m, r = centre(series, f0, eps, m, r, passes)
    return conjugate_points(roots, f0, axes, eps, m, r)


def estimate(series: Row, f0: Real, eps: Real) -> tuple[Real, Real]:
    """The start value of Newton's method for (m, r) of T(eps): its leading order in eps; for mpf, accurate to a
    float.
    """
    r = f0 * eps * eps / 4
    m = -series[1] * r / 3
    if isinstance(eps, float) or abs(eps) < 1e-100:
        return m, r
    # choose a unit in which the terms of the series stay in the range of floats
    unit = 1 / abs(series[1])
    floats, scale = [], 1
    for coefficient in series[:FLOAT_TERMS]:
        floats.append(float(coefficient * scale))
        scale *= unit
    rough, square = centre(floats, float(f0), float(eps / unit), float(m / unit), float(r / unit**2), 6)
    return rough * unit, square * unit * unit


def centre(series: Row, f0: Real, eps: Real, m: Real, r: Real, passes: int) -> tuple[Real, Real]:
    """(m, r) of T(eps), whose two points are at m ± √r, by ``passes`` Newton steps from an estimate."""
    target = f0 * eps * eps / 4
    for _ in range(passes):
        # solve r·phi² = target and psi = 0; the slopes need no more correct digits than the iterate has
        phi, psi = abel_sums(series, m, r)
        phi_m, phi_r, psi_m, psi_r = abel_slopes(series, m, r)
        first = r * phi * phi - target
        first_m, first_r = 2 * r * phi * phi_m, phi * phi + 2 * r * phi * phi_r
        det = first_m * psi_r - first_r * psi_m
        m, r = m - (first * psi_r - first_r * psi) / det, r - (first_m * psi - first * psi_m) / det
    return m, r


def expansion(f: Row, count: int) -> tuple[list[Any], list[Any], list[Any], list[Any]]:
    """u0, u1, v0/eps and v1·eps of T(eps) as power series in z = eps², ``count`` coefficients each.

    They follow from u0' = v1u0 − u1v0, u1' = −v0, 2v0' = u1w0 − s0u0, 2v1' = w0 + u1w1 − s0u1 − w2u0, where
    W = (f − V²)/U and s0 = w1 − f5u0 (:meth:`integrable.motion.enclosure.BallMotion.velocity`). These equations leave
    two coefficients undetermined (resonance), so u0 = −f0z/4 + … and u1 = −f1z/12 + … are prescribed.
    """
    f0, f1, f2, f3, f4, f5 = f
    zero, one = 0 * f0, f0 / f0
    u0, u1, v0, v1 = [zero, -f0 / 4], [zero, -f1 / 12], [f1 / 6], [2 * one]
    # the series of s0, of w0 + v1²/z + u1w1, and of (v1·eps)²
    s0, rest, squares = [], [], [4 * one]
    for k in range(1, count):
        if k > 1:
            u1.append(-v0[k - 1] / (2 * k))
            u0.append((_product(v1, u0, k, k - 1) - _product(u1, v0, k - 1, k - 1)) / (2 * k - 2))
        s0.append(f5 * (_product(u1, u1, k - 1, k - 2) - 2 * u0[k - 1]) - f4 * u1[k - 1])
        rest.append(-_product(u1, s0, k - 1, k - 1) - f4 * u0[k - 1])
        if k == 1:
            s0[0], rest[0] = s0[0] + f3, rest[0] + f2
        own = _product(v1, v1, k, k - 1)
        mixed = 2 * f5 * _product(u0, u1, k - 1, k - 2)
        v1.append((rest[k - 1] - f4 * u0[k - 1] + mixed - own) / (4 * k + 2))
        squares.append(4 * v1[k] + own)
        total = _product(u1, rest, k, k) - _product(u1, squares, k + 1, k) - _product(u0, s0, k, k)
        v0.append(total / (2 * (2 * k + 1 - one / (k + 1))))
    return u0, u1, v0, v1


def _product(a: list[Any], b: list[Any], order: int, last: int) -> Any:
    """Σ a_i·b_(order − i) for i from 1 to ``last``."""
    if last < 1:
        return 0 * a[0]
    stop = order - last - 1
    return sum(map(mul, a[1 : last + 1], b[order - 1 : stop if stop >= 0 else None : -1]), 0 * a[0])
