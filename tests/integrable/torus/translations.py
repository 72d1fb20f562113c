"""The real periods of a motion's curve, and translations in any direction, in the wide precision of a flow, without
:mod:`integrable.torus`.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

from integrable.moving_point.addition import Row, shift
from integrable.moving_point.elliptic_integrals import oval_periods
from integrable.torus.lattice import oval_ends
from jacobian import poly
from jacobian.element import Real
from jacobian.numbers.roots import root
from jacobian.periods.matrix import Oval

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# conjugate points of a translation stay within this fraction of the distance from its centre to the next branch point
REACH = 0.4
# number of terms that give a float all its digits, within the reach of a series
FLOAT_TERMS = 48
# steps of Newton's method from the leading order to a float, or from a float to a few hundred digits
PASSES = 6


def ovals(setup: Setup) -> list[Oval]:
    """The ovals of u1 and u2 (:func:`integrable.torus.lattice.oval_ends`), each with its periods 2∫dx/y and 2∫x dx/y.

    An oval may be a point, an isolated double point of the curve: its periods are then residues. At d = 0 the periods
    of x dx/y differ by the residue at infinity.
    """
    K = setup.wide
    first, second = oval_ends(setup.problem, K.eps**0.75)
    periods = [K.zero] * 4
    oval_periods((*first, *second), setup.problem.d, K.one, +K.context.pi, K.eps**0.5 / 16, periods)
    return [Oval(*first, (periods[0], periods[1])), Oval(*second, (periods[2], periods[3]))]


def translation(setup: Setup, period: Any) -> tuple[Any, ...]:
    """T(w) for w = (Σ∫dx/y, Σ∫x dx/y), as a moving point with κ = 1.

    It is the sum of two translations in the directions (1, c) with c = 0 and c = −max a, where f < 0 and all branch
    points are on one side.
    """
    parts = [(centre, eps) for centre, eps in ((setup.wide.zero, period[0] + period[1]), (-1, -period[1])) if eps != 0]
    first, *rest = (directed(setup, centre, eps) for centre, eps in parts)
    for step in rest:
        first = combine(setup, first, step)
    return first


def directed(setup: Setup, centre: Any, eps: Any) -> tuple[Any, ...]:
    """T(eps, centre·eps), doubled from inside the radius of the series about ``centre`` < α_min."""
    K = setup.wide
    x0 = K.coerce(centre)
    f = poly.shift(K, setup.problem.f, x0)
    axes = [a - x0 for a in setup.problem.axes[:3]]
    doublings, reach = 0, 2 * REACH * min(e - x0 for e in setup.problem.branch_points) / K.sqrt(abs(f[0]))
    while abs(eps) > reach:
        eps, doublings = eps / 2, doublings + 1
    with setup.reals as reals:
        series, roots = (reals.elements(K, series_of(reals.row(f), power, terms_of(setup))) for power in (-1, 1))
    step = centred(near_identity(series, roots, f[0], axes, eps, PASSES), x0)
    for _ in range(doublings):
        step = combine(setup, step, step)
    return step


def near_identity(series: Any, roots: Any, f0: Any, axes: Any, eps: Any, passes: int) -> tuple[Any, ...]:
    """T(eps), the translation with Σ∫dx/y = eps and Σ∫x dx/y = 0, for eps ≠ 0 inside the radius of convergence.

    ``series`` and ``roots`` are the power series of 1/√(f/f0) and √(f/f0) about x = 0.
    """
    r = f0 * eps * eps / 4
    m, r = centre(series, f0, eps, -series[1] * r / 3, r, passes)
    return conjugate_points(roots, f0, axes, eps, m, r)


def in_floats(setup: Setup, eps: float) -> tuple[Any, ...]:
    """T(eps) computed in floats, |eps| up to half a basic step."""
    f, axes = setup.floats.f, setup.floats.axes
    series, roots = (series_of(f, power, FLOAT_TERMS) for power in (-1, 1))
    return near_identity(series, roots, f[0], axes, eps, PASSES)


def centred(step: Any, x0: Any) -> tuple[Any, ...]:
    """The translation in the abscissa x, given in x − x0."""
    u0, u1, v0, v1, *pairs = step
    return (u0 - u1 * x0 + x0 * x0, u1 - 2 * x0, v0 - v1 * x0, v1, *pairs)


def combine(setup: Setup, first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
    """The sum of two translations, as a moving point with κ = 1."""
    row = setup.reals.row
    return setup.reals.elements(setup.wide, setup.translations.sum(row(first), row(second)))


def moved(setup: Setup, step: tuple[Any, ...], point: tuple[Any, ...]) -> tuple[Any, ...]:
    """A moving point after a translation, both wide."""
    reals, bare = setup.reals, setup.bare
    with reals:
        return reals.elements(setup.wide, shift(bare.f, bare.axes, reals.row(point), reals.row(step)))


def terms_of(setup: Setup) -> int:
    """The number of terms of a power series in x for the wide precision of a set-up, at REACH of its radius."""
    return ceil(2.7 * setup.wide.dps)


def centre(series: Row, f0: Real, eps: Real, m: Real, r: Real, passes: int) -> tuple[Real, Real]:
    """(m, r) of T(eps), whose two points are at m ± √r, by ``passes`` Newton steps from an estimate."""
    target = f0 * eps * eps / 4
    for _ in range(passes):
        # the equations are r·phi² = target and psi = 0; their slopes need only the digits that the iterate has
        phi, psi = abel_sums(series, m, r)
        phi_m, phi_r, psi_m, psi_r = abel_slopes(series, m, r)
        first = r * phi * phi - target
        first_m, first_r = 2 * r * phi * phi_m, phi * phi + 2 * r * phi * phi_r
        det = first_m * psi_r - first_r * psi_m
        m, r = m - (first * psi_r - first_r * psi) / det, r - (first_m * psi - first * psi_m) / det
    return m, r


def abel_sums(series: Row, m: Real, r: Real) -> tuple[Real, Real]:
    """phi, psi with 2√r·phi = y0·Σ∫dx/y and 2√r·psi = y0·Σ∫x dx/y for the points at m ± √r, where y0 = √f0."""
    phi, psi = 0 * r, 0 * r
    c = m * m - r
    # S_j = ((m+√r)^j − (m−√r)^j)/(2√r), by S_{j+1} = 2m·S_j − c·S_{j−1}
    s0, s1 = 0 * r, 1 + 0 * r
    for k in range(len(series)):
        s2 = 2 * m * s1 - c * s0
        phi += series[k] / (k + 1) * s1
        psi += series[k] / (k + 2) * s2
        s0, s1 = s1, s2
    return phi, psi


def abel_slopes(series: Row, m: Real, r: Real) -> tuple[Real, Real, Real, Real]:
    """The derivatives of :func:`abel_sums`: of phi with respect to m and r, then of psi."""
    phi_m, phi_r, psi_m, psi_r = 0 * r, 0 * r, 0 * r, 0 * r
    c = m * m - r
    # s0 and s1 are the S_j of :func:`abel_sums`, d0 and d1 their derivatives with respect to m, e0 and e1 with respect
    # to r
    s0, s1, d0, d1, e0, e1 = 0 * r, 1 + 0 * r, 0 * r, 0 * r, 0 * r, 0 * r
    for k in range(len(series)):
        s2 = 2 * m * s1 - c * s0
        d2 = 2 * s1 + 2 * m * d1 - 2 * m * s0 - c * d0
        e2 = 2 * m * e1 + s0 - c * e0
        weight = series[k] / (k + 1)
        phi_m += weight * d1
        phi_r += weight * e1
        weight = series[k] / (k + 2)
        psi_m += weight * d2
        psi_r += weight * e2
        s0, s1, d0, d1, e0, e1 = s1, s2, d1, d2, e1, e2
    return phi_m, phi_r, psi_m, psi_r


def conjugate_points(roots: Row, f0: Real, axes: Row, eps: Real, m: Real, r: Real) -> Row:
    """The translation whose divisor has points at m ± √r, as a moving point with κ = 1."""
    # ``even`` is the sum of the values of √(f/f0) at the two points, ``odd`` their difference divided by 2√r
    c = m * m - r
    s0, s1, c0, c1 = 0 * r, 1 + 0 * r, 2 + 0 * r, 2 * m
    even, odd = 0 * r, 0 * r
    for k in range(len(roots)):
        even += roots[k] * c0
        odd += roots[k] * s0
        s0, s1, c0, c1 = s1, 2 * m * s1 - c * s0, c1, 2 * m * c1 - c * c0
    phi = root(f0 * eps * eps / (4 * r))
    t1 = phi / eps * even
    t0 = 2 * r * phi / eps * odd - t1 * m
    x1, x2, x3 = axes[0] - m, axes[1] - m, axes[2] - m
    r1, r2, r3 = root(x1 * x1 - r), root(x2 * x2 - r), root(x3 * x3 - r)
    return (c, -2 * m, t0, t1, r1, r2, r3, (t0 + t1 * axes[0]) / r1, (t0 + t1 * axes[1]) / r2, (t0 + t1 * axes[2]) / r3)


def series_of(f: tuple[Real, ...], power: int, size: int) -> tuple[Real, ...]:
    """The first coefficients of (f/f0)^(power/2) about 0."""
    out = [f[0]] * size
    power_series(f, power, out)
    return tuple(out)


def power_series(f: Row, power: int, out: Row) -> None:
    """Writes the coefficients of (f/f0)^(power/2) about 0 to ``out``, by the recurrence from its logarithmic
    derivative. f has six coefficients, ascending.
    """
    one = f[0] / f[0]
    out[0] = one
    r1, r2, r3, r4, r5 = f[1] / f[0], f[2] / f[0], f[3] / f[0], f[4] / f[0], f[5] / f[0]
    for k in range(1, len(out)):
        total = (power + 2 - 2 * k) * r1 * out[k - 1]
        if k > 1:
            total += (2 * (power + 2) - 2 * k) * r2 * out[k - 2]
        if k > 2:
            total += (3 * (power + 2) - 2 * k) * r3 * out[k - 3]
        if k > 3:
            total += (4 * (power + 2) - 2 * k) * r4 * out[k - 4]
        if k > 4:
            total += (5 * (power + 2) - 2 * k) * r5 * out[k - 5]
        out[k] = total / (2 * k)
