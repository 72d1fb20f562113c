"""The real periods of a motion's curve, and translations in any direction, in the wide precision of a flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.flow_kernel import near_identity
from jacobian import poly
from jacobian.errors import PrecisionLoss
from jacobian.periods import Oval

if TYPE_CHECKING:
    from integrable.flow_setup import Setup

# conjugate points of a translation at this part of the distance from its centre to the next branch point
REACH = 0.3


def ovals(setup: Setup) -> list[Oval]:
    """The ovals over [α_min, min(ζ, α_mid)] and [max(ζ, α_mid), α_max] that u1 and u2 run through, ζ = h1/(h2·max a),
    each with its periods 2∫dx/y and 2∫x dx/y.

    An oval may be a point, an isolated double point of the curve: its periods are then residues. At d = 0 the periods
    of x dx/y differ by the residue at infinity. PrecisionLoss where the two ovals meet (the separatrix) or both are one
    point: there the motion is not a line on a compact torus of dimension two.
    """
    K = setup.wide
    low, middle, high = sorted(setup.wide_axes)
    first, second = (low, min(setup.ratio, middle)), (max(setup.ratio, middle), high)
    if second[0] - first[1] <= K.eps**0.75:
        raise PrecisionLoss("the ovals of the curve have met: the torus of this motion is not compact")
    third = (K.one, -setup.wide_d, K.zero)
    return [
        Oval(*oval, tuple(row))
        for oval, row in zip((first, second), _oval_periods(K, first, second, third), strict=True)
    ]


def _oval_periods(K: Any, first: Any, second: Any, third: Any) -> tuple[Any, Any]:
    """2∫dx/√|PQR| and 2∫x dx/√|PQR| from root to root of P and of Q, monic with the given roots; R = ``third``, whose
    roots are beyond those.

    The arithmetic-geometric mean of genus 2 (Richelot 1837; Bost & Mestre 1988): with U = Q'R − QR' and so on,
    ∫dx/√|PQR| = 2√Δ∫dx/√|UVW| between roots of V and W, of W and U, which are closer. It converges quadratically,
    however near branch points are.
    """
    sqrt, scale = K.sqrt, 2 * K.one
    near = K.eps**0.5 / 16
    while max(first[1] - first[0], second[1] - second[0]) > near:
        p, q = ((pair[0] * pair[1], -pair[0] - pair[1], K.one) for pair in (first, second))
        u, v, w = _bracket(q, third), _bracket(third, p), _bracket(p, q)
        # Δ is the determinant of the coefficients; W and the roots of R complete it
        determinant = third[0] * w[2] - third[1] * w[1] / 2 + third[2] * w[0]
        gaps = [x - y for x in first for y in second]
        spread = sqrt(gaps[0] * gaps[1] * gaps[2] * gaps[3])
        (w1, w2), (u1, u2), (v1, v2) = _between(K, w, spread), _roots(K, u), _roots(K, v)
        scale *= 2 * sqrt(abs(determinant) / abs(w[2] * (u[2] or u[1]) * (v[2] or v[1])))
        first, second = (v1, w1), (w2, u1)
        third = (K.one, K.zero, K.zero) if u2 is None else (u2 * v2, -u2 - v2, K.one)
    result = []
    for pair, other in ((first, second), (second, first)):
        x = (pair[0] + pair[1]) / 2
        rest = abs((x - other[0]) * (x - other[1]) * (third[0] + x * (third[1] + x * third[2])))
        weight = scale * K.context.pi / sqrt(rest)
        result.append((weight, weight * x))
    return result[0], result[1]


def _bracket(p: Any, q: Any) -> tuple[Any, Any, Any]:
    """p'q − pq' of two quadratics, ascending."""
    return p[1] * q[0] - p[0] * q[1], 2 * (p[2] * q[0] - p[0] * q[2]), p[2] * q[1] - p[1] * q[2]


def _between(K: Any, w: Any, spread: Any) -> tuple[Any, Any]:
    """The roots of w, ascending, from the root of its discriminant."""
    middle = -w[1] / 2
    far = middle + spread if middle >= 0 else middle - spread
    roots = sorted((far / w[2], w[0] / far))
    return roots[0], roots[1]


def _roots(K: Any, p: Any) -> tuple[Any, Any]:
    """The roots of p, ascending; the second None where p is of degree 1."""
    if p[2] == 0:
        return -p[0] / p[1], None
    return _between(K, p, K.sqrt(p[1] * p[1] / 4 - p[0] * p[2]))


def translation(setup: Setup, period: Any) -> tuple[Any, ...]:
    """T(w) for w = (Σ∫dx/y, Σ∫x dx/y), as a moving point with κ = 1.

    The sum of two in the directions (1, c), c = 0 and −1 in units of max a: there f < 0, and the branch points are on
    one side.
    """
    parts = [(centre, eps) for centre, eps in ((setup.wide.zero, period[0] + period[1]), (-1, -period[1])) if eps != 0]
    first, *rest = (directed(setup, centre, eps) for centre, eps in parts)
    for step in rest:
        first = setup.combine(first, step)
    return first


def directed(setup: Setup, centre: Any, eps: Any) -> tuple[Any, ...]:
    """T(eps, centre·eps), doubled from inside the radius of the series about ``centre`` < α_min."""
    K = setup.wide
    x0 = K.coerce(centre)
    f = poly.shift(K, setup.wide_f, x0)
    axes = [a - x0 for a in setup.wide_axes]
    doublings, reach = 0, 2 * REACH * min(e - x0 for e in setup.wide_branch_points) / K.sqrt(abs(f[0]))
    while abs(eps) > reach:
        eps, doublings = eps / 2, doublings + 1
    series, roots = (setup.wide_series(f, power) for power in (-1, 1))
    step = centred(near_identity(series, roots, f[0], axes, eps, setup.wide_passes), x0)
    for _ in range(doublings):
        step = setup.combine(step, step)
    return step


def centred(step: Any, x0: Any) -> tuple[Any, ...]:
    """A translation in the abscissa x, from the same one in x − x0."""
    u0, u1, v0, v1, *pairs = step
    return (u0 - u1 * x0 + x0 * x0, u1 - 2 * x0, v0 - v1 * x0, v1, *pairs)
