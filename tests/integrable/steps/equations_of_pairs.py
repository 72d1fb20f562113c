"""A time shift without divisors: the rational equations of motion of the pairs, integrated by extrapolation."""

from __future__ import annotations

from integrable.phase import coordinates
from integrable.phase.body import Body
from integrable.phase.jets import JetField
from jacobian import MP, RR, poly
from tests.integrable.steps.extrapolation import extrapolated


def shifted(system, F, state):
    """The time-1 map of F(H1, H2) (Gragg 1965; Bulirsch and Stoer 1966), computed with guard digits."""
    K = system.field
    h1, h2 = system.integrals(state)[2:]
    jets = JetField(K, 2)
    slopes = jets.coerce(F(*jets.variables((h1, h2)))).slopes
    wide = MP(30 if K == RR else K.dps + 15)
    body = Body.make(system.inertia, system.d, wide)
    f = body.polynomial(wide.coerce(h1), wide.coerce(h2))
    first, second = (2 * wide.coerce(x) for x in slopes)

    def rate(y):
        return pair_rates(body, f, y, first, second)

    y = [wide.coerce(x) for pair in coordinates.to_pairs(system.body, state) for x in pair]
    scale = max(map(abs, y))
    count = 1 + int(2 * max(map(abs, rate(y))) / scale)
    for _ in range(count):
        y, _ = extrapolated(rate, y, wide.one / count, K.eps * scale / 64)
    rounded = [K.coerce(x) for x in y]
    return coordinates.from_pairs(system.body, tuple((rounded[2 * i], rounded[2 * i + 1]) for i in range(3)))


def pair_rates(body, f, y, first, second):
    """d/ds of (σ1, ν1, …, ν3) along (Σdu/y, Σu du/y) = (first, −second)·ds, as rational functions of the pairs and f.

    From U' = (V(x)U(0) − V(0)U(x))/x for (1, 0) and U' = V for (0, −1), each with V² + UW = f kept.
    """
    K = body.field
    pairs = tuple((y[2 * i], y[2 * i + 1]) for i in range(3))
    u, v = coordinates.to_mumford(body, pairs)
    w = poly.quotient(K, poly.sub(K, f, poly.mul(K, v, v)), u)
    lead = w[3] if len(w) == 4 else K.zero
    # the quotient of W by U
    line = (w[2] - lead * u[1], lead)
    rates = []
    for a, (sigma, nu) in zip(body.a, pairs, strict=True):
        turn = first * (nu * u[0] - sigma * v[0]) / a + second * nu
        back = first * ((w[0] * sigma + v[0] * nu) / a + u[0] * lead * sigma) + second * (line[0] + line[1] * a) * sigma
        rates += [turn / 2, back / 2]
    return rates
