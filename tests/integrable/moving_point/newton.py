"""T(eps) by Newton's method on the integrals in x: a readable oracle for its expansion in eps²."""

from __future__ import annotations

from math import ceil, log
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
