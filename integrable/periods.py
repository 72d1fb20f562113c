"""The ovals of a motion's curve, and translations in any direction, in the wide precision of a flow."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.flow_kernel import near_identity
from jacobian import HyperellipticCurve, poly
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.flow_setup import Setup
    from jacobian.periods import Oval

# conjugate points of a translation at this part of the distance from its centre to the next branch point
REACH = 0.3
# the least oval, and gap between the two, in units of max a
SHORTEST = 1e-6


def ovals(setup: Setup) -> list[Oval]:
    """The ovals over [α_min, min(ζ, α_mid)] and [max(ζ, α_mid), α_max] that u1 and u2 run through, with their periods.

    ζ = h1/(h2·max a). PrecisionLoss where one of them has shrunk to a point, or both have met: there the motion is
    not a line on a torus of dimension two.
    """
    first, middle, last = sorted(setup.wide_axes)
    inner = sorted((setup.ratio, middle))
    if min(inner[0] - first, inner[1] - inner[0], last - inner[1]) < SHORTEST:
        raise PrecisionLoss("an oval of the curve has shrunk to a point, or both have met: the torus degenerates")
    from jacobian.periods import real_periods

    return real_periods(HyperellipticCurve(setup.wide, setup.wide_f), setup.wide_branch_points)


def translation(setup: Setup, period: Any) -> tuple[Any, ...]:
    """T(w) for w = (Σ∫dx/y, Σ∫x dx/y), w[0] ≠ 0, as a moving point with κ = 1: doubled from inside the radius of the
    series.

    Near the identity the two points are close to the abscissa x0 = w[1]/w[0]; the series are taken about it.
    """
    K = setup.wide
    x0 = period[1] / period[0]
    f = poly.shift(K, setup.wide_f, x0)
    nearest = min(abs(e - x0) for e in setup.wide_branch_points)
    eps, doublings = period[0], 0
    while K.context.sqrt(abs(f[0])) * abs(eps) > 2 * REACH * nearest:
        eps, doublings = eps / 2, doublings + 1
    series, roots = (setup.wide_series(f, power) for power in (-1, 1))
    axes = [a - x0 for a in setup.wide_axes]
    u0, u1, v0, v1, *pairs = near_identity(series, roots, f[0], axes, eps, setup.wide_passes)
    # s → a − x0 as w → 0
    signs = [1 if a > 0 else -1 for a in axes] * 2
    step = (u0 - u1 * x0 + x0 * x0, u1 - 2 * x0, v0 - v1 * x0, v1, *(s * x for s, x in zip(signs, pairs, strict=True)))
    for _ in range(doublings):
        step = setup.combine(step, step)
    return step
