"""The real periods of a motion's curve, and translations in any direction, in the wide precision of a flow, without
:mod:`integrable.torus`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.moving_point.addition import centre, conjugate_points, shift
from integrable.moving_point.elliptic_integrals import oval_periods
from integrable.moving_point.translations import series_of
from integrable.torus.lattice import oval_ends
from jacobian import poly
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
        series, roots = (reals.elements(K, series_of(reals.row(f), power, setup.terms)) for power in (-1, 1))
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
