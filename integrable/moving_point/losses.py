"""The number of digits that a motion may lose, estimated from its curve, and the number it has lost, from H1 and H2."""

from __future__ import annotations

from math import ceil, log, log10

from integrable.moving_point.addition import Row
from integrable.moving_point.setup import Setup
from integrable.phase.body import energy
from integrable.phase.coordinates import directions_of
from jacobian.element import Real

# stands for the decimal exponent of infinity; −NOTHING stands for that of 0
NOTHING = 10**9


def lost_digits(setup: Setup, tau: Real) -> int:
    """The number of digits by which an error may grow until τ (in the units of the setup), estimated from the curve.

    A double root e of f = (x − e)²h belongs to the unstable rotation. At that rotation τ = Σ∫dx/y is a logarithm
    divided by √h(e), so points and translations grow like exp(√h·τ). Each time a motion passes near it, points and
    translations grow to about 16·(distance to the other roots)/(distance of the two roots). All other errors grow like
    τ.
    """
    K = setup.wide
    roots = sorted(setup.problem.branch_points)
    lead, tau = abs(setup.problem.f[5] or setup.problem.f[4]), abs(K.coerce(tau))
    total = K.context.log(1 + tau)
    # the gaps lie between the ovals and, if d ≠ 0, between the second oval and 1/d; a gap of length 0 is a double root
    for k in range(1, len(roots) - 1, 2):
        middle, gap = (roots[k] + roots[k + 1]) / 2, roots[k + 1] - roots[k]
        others = [abs(middle - e) for e in (*roots[:k], *roots[k + 2 :])]
        square = lead
        for x in others:
            square *= x
        grown = K.sqrt(square) * tau
        near = min(others)
        # a gap up to this size is a double root with rounding errors
        if gap > K.eps * 10**8 * near:
            grown = min(grown, K.context.log(1 + 16 * near / gap))
        # the factor 2 is due to the translations, whose errors grow as much as those of the points
        total += 2 * grown
    return ceil(float(total) / log(10))


def drift(setup: Setup, point: Row) -> Real:
    """The larger of the relative changes of H1 and H2 at a moving point of bare reals."""
    reals = setup.reals
    with reals:
        # M is divided by |M| at the start, so the true h2 is 1 and the true h1 is ``ratio``
        _, M = directions_of(tuple(point))
        h2 = sum(m * m for m in M)
        # H1 = (M, AM) + d·g²·(γ, AM)² is computed from σ = gγ instead of γ, so the weight is d
        h1 = energy(setup.bare.axes[:3], reals.number(setup.problem.d), point[4:7], M)
        return max(abs(h2 - 1), abs(h1 / reals.number(setup.problem.ratio) - 1))


def digits_of(x: Real) -> int:
    """log10 of x ≥ 0, rounded up; −NOTHING for 0; NOTHING for NaN and for x ≥ 1e9."""
    if x == 0:
        return -NOTHING
    if not x < 1e9:
        return NOTHING
    scale = 0
    while x < 1e-290:
        x, scale = x * 1e280, scale - 280
    return scale + ceil(log10(float(x)))
