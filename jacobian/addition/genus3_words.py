"""Explicit formulas of genus 3 on y² = x⁷ + f₆x⁶ + … + f₀, in two halves: before the inversion, and after it.

Let D = (U, V) with U = x³ + a₂x² + a₁x + a₀, V = b₂x² + b₁x + b₀, and D' = (U', V') likewise. The quintic ℓ = V + U·s,
s of degree 2, passes through both. It meets the curve in four more points, the roots of u' = (ℓ² − f)/(UU's₂²). The
cubic v' = −ℓ modulo u' passes through these and meets the curve in three more points. Their divisor is the sum: u =
(f − v'²)/u', v = −v' modulo u.

Composition and reduction are those of Cantor (1987); Wollinger, Pelzl and Paar 2005 ("Cantor versus Harley") and Fan,
Wollinger and Gong 2007 order such steps so that one inversion is enough, of the resultant times the leading coefficient
of s. The formulas fail exactly where that product is 0; elsewhere all degrees are as stated.

The arithmetic is that of :mod:`jacobian.numbers.words`, as in :mod:`jacobian.addition.genus2_words`. A row is
(a₂, a₁, a₀, b₂, b₁, b₀). A quotient is (r, r·s₂, r·s₁, r·s₀) with the resultant r. Tests run all formulas on intervals
to show that no word overflows.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.prime import PrimeField
from jacobian.numbers.words import add, dot2, dot3, dot4, fit, mul, neg, settled, sub

Triple = tuple[Any, Any, Any]
Row = tuple[Any, Any, Any, Any, Any, Any]
Quotient = tuple[Any, Any, Any, Any]

Septic = namedtuple("Septic", "f3 f4 f5 f6")
Septic.__doc__ = "y² = x⁷ + f₆x⁶ + … + f₀, as far as the formulas use it."


def is_short_septic(C: HyperellipticCurve) -> bool:
    """Whether C is y² = f over GF(p), f monic of degree 7: the formulas apply."""
    return type(C.field) is PrimeField and C.genus == 3 and C.model == "ramified" and not C.h and C.f[-1] == 1


def short_equation(C: HyperellipticCurve, to_word: Any) -> Septic | None:
    """The coefficients of C for the formulas; None if the formulas do not apply."""
    return Septic(*map(to_word, C.f[3:7])) if is_short_septic(C) else None


def quotient_by(K: Any, m: Triple, w: Triple, u: Triple) -> Quotient:
    """(r, r·s₂, r·s₁, r·s₀) for s = w/m modulo the monic cubic u; r is the resultant of m and u."""
    (m2, m1, m0), (w2, w1, w0), (c2, c1, c0) = m, w, u
    # xm and x²m modulo u: with m the columns of the multiplication by m, and i = r/m its first cofactors
    n2 = sub(K, m1, fit(K, mul(K, c2, m2)))
    n1 = sub(K, m0, fit(K, mul(K, c1, m2)))
    n0 = neg(K, fit(K, mul(K, c0, m2)))
    p2 = sub(K, n1, fit(K, mul(K, c2, n2)))
    p1 = sub(K, n0, fit(K, mul(K, c1, n2)))
    p0 = neg(K, fit(K, mul(K, c0, n2)))
    i0 = fit(K, dot2(K, n1, p2, neg(K, p1), n2))
    i1 = fit(K, dot2(K, p1, m2, neg(K, m1), p2))
    i2 = fit(K, dot2(K, m1, n2, neg(K, n1), m2))
    r = dot3(K, m0, i0, n0, i1, p0, i2)
    # iw modulo u
    q4 = neg(K, fit(K, mul(K, i2, w2)))
    q3 = neg(K, fit(K, dot3(K, i2, w1, i1, w2, c2, q4)))
    s2 = add(K, fit(K, dot3(K, i2, w0, i1, w1, i0, w2)), fit(K, dot2(K, c1, q4, c2, q3)))
    return r, s2, fit(K, dot4(K, i1, w0, i0, w1, c0, q4, c1, q3)), fit(K, dot2(K, i0, w0, c0, q3))


def chord(K: Any, first: Row, second: Row) -> Quotient:
    """The quotient of s = (V' − V)/U modulo U'."""
    a2, a1, a0, b2, b1, b0 = first
    c2, c1, c0, d2, d1, d0 = second
    m = sub(K, a2, c2), sub(K, a1, c1), sub(K, a0, c0)
    w = sub(K, d2, b2), sub(K, d1, b1), sub(K, d0, b0)
    return quotient_by(K, m, w, (c2, c1, c0))


def tangent(K: Any, C: Any, first: Row) -> Quotient:
    """The quotient of s = ((f − V²)/U)/2V modulo U."""
    a2, a1, a0, b2, b1, b0 = first
    twice_b2 = add(K, b2, b2)
    # (f − V²)/U = x⁴ + k₃x³ + … + k₀
    k3 = sub(K, C.f6, a2)
    k2 = sub(K, sub(K, C.f5, a1), fit(K, mul(K, a2, k3)))
    k1 = sub(K, sub(K, C.f4, a0), fit(K, dot3(K, b2, b2, a1, k3, a2, k2)))
    k0 = sub(K, C.f3, fit(K, dot4(K, twice_b2, b1, a0, k3, a1, k2, a2, k1)))
    # modulo U
    k3 = sub(K, k3, a2)
    w2 = sub(K, sub(K, k2, a1), fit(K, mul(K, a2, k3)))
    w1 = sub(K, sub(K, k1, a0), fit(K, mul(K, a1, k3)))
    w0 = sub(K, k0, fit(K, mul(K, a0, k3)))
    return quotient_by(K, (twice_b2, add(K, b1, b1), add(K, b0, b0)), (w2, w1, w0), (a2, a1, a0))


def product(K: Any, quotient: Quotient) -> Any:
    """r·(r·s₂), which is inverted; 0 in every special case."""
    return mul(K, quotient[0], quotient[1])


def quintic(K: Any, quotient: Quotient, inverse: Any) -> Quotient:
    """(s₂, s₁/s₂, s₀/s₂, 1/s₂), without the factor r, from the inverse of the product."""
    r, s2, s1, s0 = quotient
    shrink = fit(K, mul(K, r, inverse))
    lead = fit(K, mul(K, fit(K, mul(K, s2, s2)), inverse))
    return lead, fit(K, mul(K, s1, shrink)), fit(K, mul(K, s0, shrink)), fit(K, mul(K, r, shrink))


def next_u(K: Any, C: Any, bent: Quotient, first: Row, second: Row) -> Quotient:
    """(e₃, e₂, e₁, e₀) of u' = x⁴ + e₃x³ + …, whose roots are the other intersections of the quintic with the curve."""
    _, t1, t0, w4 = bent
    a2, a1, a0, b2, b1, _ = first
    c2, c1, c0, _, _, _ = second
    # ℓ/s₂ = t·U + w₄·V, t = x² + t₁x + t₀; u' = (t·(t·U + 2w₄V) − w₄²·(f − V²)/U)/U'
    l4 = add(K, a2, t1)
    l3 = add(K, add(K, a1, t0), fit(K, mul(K, t1, a2)))
    twice = add(K, w4, w4)
    y2 = add(K, a0, fit(K, dot3(K, t1, a1, t0, a2, twice, b2)))
    y1 = fit(K, dot3(K, t1, a0, t0, a1, twice, b1))
    w5 = fit(K, mul(K, w4, w4))
    e3 = sub(K, add(K, l4, t1), c2)
    e2 = sub(K, add(K, l3, t0), c1)
    e2 = settled(K, add(K, e2, fit(K, dot2(K, t1, l4, neg(K, c2), e3))))
    e1 = sub(K, sub(K, y2, c0), w5)
    e1 = settled(K, add(K, e1, fit(K, dot4(K, t1, l3, t0, l4, neg(K, c2), e2, neg(K, c1), e3))))
    e0 = add(K, y1, fit(K, dot3(K, t1, y2, t0, l3, w5, sub(K, a2, C.f6))))
    e0 = settled(K, sub(K, e0, fit(K, dot3(K, c2, e1, c1, e2, c0, e3))))
    return e3, e2, e1, e0


def next_v(K: Any, bent: Quotient, u: Quotient, first: Row, second: Row) -> Quotient:
    """(k₃, k₂, k₁, k₀), the coefficients of −v' = ℓ modulo u'."""
    lead, t1, t0, _ = bent
    e3, e2, e1, e0 = u
    a2, a1, a0, b2, b1, b0 = first
    # ℓ without V is s₂·(x⁵ + l₄x⁴ + …), and g = l₄ − e₃
    g = sub(K, second[0], t1)
    k3 = sub(K, add(K, a1, t0), e2)
    k3 = add(K, k3, fit(K, dot2(K, t1, a2, neg(K, g), e3)))
    k2 = sub(K, add(K, a0, fit(K, dot3(K, t1, a1, t0, a2, neg(K, g), e2))), e1)
    k1 = sub(K, fit(K, dot3(K, t1, a0, t0, a1, neg(K, g), e1)), e0)
    k0 = fit(K, dot2(K, t0, a0, neg(K, g), e0))
    return (
        fit(K, mul(K, lead, k3)),
        add(K, b2, fit(K, mul(K, lead, k2))),
        add(K, b1, fit(K, mul(K, lead, k1))),
        add(K, b0, fit(K, mul(K, lead, k0))),
    )


def sum_u(K: Any, C: Any, u: Quotient, v: Quotient) -> Triple:
    """(u₂, u₁, u₀) of the sum's u = (f − v'²)/u'."""
    (e3, e2, e1, _), (k3, k2, k1, _) = u, v
    twice = add(K, k3, k3)
    u2 = settled(K, sub(K, sub(K, C.f6, e3), fit(K, mul(K, k3, k3))))
    u1 = settled(K, sub(K, sub(K, C.f5, e2), fit(K, dot2(K, twice, k2, e3, u2))))
    u0 = sub(K, sub(K, C.f4, e1), fit(K, dot4(K, twice, k1, k2, k2, e2, u2, e3, u1)))
    return u2, u1, settled(K, u0)


def sum_v(K: Any, u: Triple, v: Quotient) -> Triple:
    """(v₂, v₁, v₀) of the sum's v = −v' modulo u."""
    (u2, u1, u0), (k3, k2, k1, k0) = u, v
    return (
        settled(K, sub(K, k2, fit(K, mul(K, k3, u2)))),
        settled(K, sub(K, k1, fit(K, mul(K, k3, u1)))),
        settled(K, sub(K, k0, fit(K, mul(K, k3, u0)))),
    )


def closed(K: Any, C: Any, quotient: Quotient, inverse: Any, first: Row, second: Row) -> Row:
    """The sum, from the inverse of the product: all steps of the second half."""
    bent = quintic(K, quotient, inverse)
    meeting = next_u(K, C, bent, first, second)
    middle = next_v(K, bent, meeting, first, second)
    u = sum_u(K, C, meeting, middle)
    return (*u, *sum_v(K, u, middle))


STEPS = (quotient_by, chord, tangent, product, quintic, next_u, next_v, sum_u, sum_v, closed)
"""All functions that the compilers must translate."""
