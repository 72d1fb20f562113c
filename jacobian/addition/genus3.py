"""The explicit formulas of genus 3 on y² = f, char ≠ 2: f monic of degree 7, or of degree 8 on split models.

Let D = (U, V) with U = x³ + a₂x² + a₁x + a₀, V = b₂x² + b₁x + b₀, and D' = (U', V') likewise. The quintic ℓ = V + U·s,
s of degree 2, passes through both. It meets the curve in four more points, over the roots of u' = (ℓ² − f)/(UU's₂²).
The cubic v' = −ℓ modulo u' passes through their opposites and, in degree 7, meets the curve in three more points. The
opposites of these three form the sum: u = (f − v'²)/u', v = −v' modulo u.

In degree 8 let c be the leading coefficient of y at ∞₊. The quartic c·u' − v' passes through the four points, and meets
the curve at ∞₊ and in three more points, which form the sum. This is the step at infinity of Galbraith, Harrison and
Mireles Morales (2008); it takes a second inversion.

Composition and reduction are those of Cantor (1987); Wollinger, Pelzl and Paar 2005 ("Cantor versus Harley") and Fan,
Wollinger and Gong 2007 order such steps so that one inversion is enough: that of the resultant times the leading
coefficient of s. The formulas fail exactly where the inverted number is 0; elsewhere all degrees are as stated.

A row is (a₂, a₁, a₀, b₂, b₁, b₀), a quotient (r, r·s₂, r·s₁, r·s₀). :mod:`jacobian.addition.straight` turns the steps
into code.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.straight import Formulas

Triple = tuple[Any, Any, Any]
Row = tuple[Any, Any, Any, Any, Any, Any]
Four = tuple[Any, Any, Any, Any]


def opposite(C: Any, first: Row) -> Row:
    """(U, −V)."""
    a2, a1, a0, b2, b1, b0 = first
    return a2, a1, a0, -b2, -b1, -b0


def quotient_by(m: Triple, w: Triple, u: Triple) -> Four:
    """(r, r·s₂, r·s₁, r·s₀) for s = w/m modulo the monic cubic u; r is the resultant of m and u."""
    (m2, m1, m0), (w2, w1, w0), (c2, c1, c0) = m, w, u
    # n = xm and p = x²m modulo u; m, n, p are the columns of the matrix of the multiplication by m; the cofactors
    # of its first row give i = r/m
    n2, n1, n0 = m1 - c2 * m2, m0 - c1 * m2, -(c0 * m2)
    p2, p1, p0 = n1 - c2 * n2, n0 - c1 * n2, -(c0 * n2)
    i0, i1, i2 = n1 * p2 - p1 * n2, p1 * m2 - m1 * p2, m1 * n2 - n1 * m2
    r = m0 * i0 + n0 * i1 + p0 * i2
    # (i₂x² + i₁x + i₀)·(w₂x² + w₁x + w₀) modulo u is r·s
    q4 = i2 * w2
    q3 = i2 * w1 + i1 * w2 - c2 * q4
    s2 = i2 * w0 + i1 * w1 + i0 * w2 - c1 * q4 - c2 * q3
    return r, s2, i1 * w0 + i0 * w1 - c0 * q4 - c1 * q3, i0 * w0 - c0 * q3


def chord(C: Any, first: Row, second: Row) -> Four:
    """(r, r·s₂, r·s₁, r·s₀) for s = (V' − V)/U modulo U'; r is the resultant of U' and U."""
    (a2, a1, a0, b2, b1, b0), (c2, c1, c0, d2, d1, d0) = first, second
    return quotient_by((a2 - c2, a1 - c1, a0 - c0), (d2 - b2, d1 - b1, d0 - b0), (c2, c1, c0))


def tangent(C: Any, first: Row) -> Four:
    """(r, r·s₂, r·s₁, r·s₀) for s = ((f − V²)/U)/2V modulo U."""
    a2, a1, a0, b2, b1, b0 = first
    twice_b2 = b2 + b2
    # (f − V²)/U = f₈x⁵ + k₄x⁴ + … + k₀
    k4 = C.f7 - a2 * C.f8
    k3 = C.f6 - a1 * C.f8 - a2 * k4
    k2 = C.f5 - a0 * C.f8 - a1 * k4 - a2 * k3
    k1 = C.f4 - a0 * k4 - b2 * b2 - a1 * k3 - a2 * k2
    k0 = C.f3 - twice_b2 * b1 - a0 * k3 - a1 * k2 - a2 * k1
    # the quotient is reduced modulo U
    k4 = k4 - a2 * C.f8
    k3 = k3 - a1 * C.f8 - a2 * k4
    w2 = k2 - a0 * C.f8 - a1 * k4 - a2 * k3
    return quotient_by((twice_b2, b1 + b1, b0 + b0), (w2, k1 - a0 * k4 - a1 * k3, k0 - a0 * k3), (a2, a1, a0))


def product(C: Any, quotient: Four) -> Any:
    """The number r·(r·s₂) that a sum inverts, from a quotient (r, r·s₂, r·s₁, r·s₀)."""
    r, s2, _, _ = quotient
    return r * s2


def quintic(C: Any, quotient: Four, inverse: Any) -> Four:
    """(s₂, s₁/s₂, s₀/s₂, 1/s₂), without the factor r of the quotient, from the inverse of :func:`product`."""
    r, s2, s1, s0 = quotient
    shrink = r * inverse
    return s2 * s2 * inverse, s1 * shrink, s0 * shrink, r * shrink


def without_v(bent: Four, first: Row) -> Four:
    """(l₃, l₂, l₁, l₀) of (ℓ − V)/s₂ = x⁵ + (a₂ + t₁)x⁴ + l₃x³ + … + l₀, t = s/s₂ = x² + t₁x + t₀."""
    (_, t1, t0, _), (a2, a1, a0, _, _, _) = bent, first
    return a1 + t0 + t1 * a2, a0 + (t1 * a1 + t0 * a2), t1 * a0 + t0 * a1, t0 * a0


def next_u(C: Any, bent: Four, first: Row, second: Row) -> Four:
    """(e₃, e₂, e₁, e₀) of u' = x⁴ + e₃x³ + …, whose roots are the x of the quintic's four other points on the curve."""
    (_, t1, t0, w4), (a2, a1, _, b2, b1, _), (c2, c1, c0, _, _, _) = bent, first, second
    # for the quintic V + U·s, with t = s/s₂ = x² + t₁x + t₀ and w₄ = 1/s₂: u' = (t(tU + 2w₄V) − w₄²(f − V²)/U)/U'
    l3, l2, l1, _ = without_v(bent, first)
    l4, twice, w5 = a2 + t1, w4 + w4, w4 * w4
    y2, y1 = l2 + twice * b2, l1 + twice * b1
    g4 = C.f7 - a2 * C.f8
    e3 = l4 + t1 - c2
    e2 = l3 + t0 - c1 - C.f8 * w5 + t1 * l4 - c2 * e3
    e1 = y2 - c0 - g4 * w5 + t1 * l3 + t0 * l4 - c2 * e2 - c1 * e3
    e0 = y1 + t1 * y2 + t0 * l3 - w5 * (C.f6 - a1 * C.f8 - a2 * g4) - c2 * e1 - c1 * e2 - c0 * e3
    return e3, e2, e1, e0


def next_v(C: Any, bent: Four, meeting: Four, first: Row, second: Row) -> Four:
    """(k₃, k₂, k₁, k₀), the coefficients of −v', which is the quintic ℓ = V + U·s modulo u'."""
    (lead, t1, _, _), (e3, e2, e1, e0), (_, _, _, b2, b1, b0) = bent, meeting, first
    l3, l2, l1, l0 = without_v(bent, first)
    # ``g`` is the leading coefficient of (ℓ − V)/s₂ − x·u'
    g = second[0] - t1
    k3 = lead * (l3 - e2 - g * e3)
    return k3, b2 + lead * (l2 - e1 - g * e2), b1 + lead * (l1 - e0 - g * e1), b0 + lead * (l0 - g * e0)


def sum_u(C: Any, meeting: Four, middle: Four) -> Triple:
    """(u₂, u₁, u₀) of the sum's u = (f − v'²)/u', from the coefficients of u' (``meeting``) and of −v' (``middle``)."""
    (e3, e2, e1, _), (k3, k2, k1, _) = meeting, middle
    twice = k3 + k3
    u2 = C.f6 - e3 - k3 * k3
    u1 = C.f5 - e2 - twice * k2 - e3 * u2
    return u2, u1, C.f4 - e1 - twice * k1 - k2 * k2 - e2 * u2 - e3 * u1


def sum_v(C: Any, u: Triple, middle: Four) -> Triple:
    """(v₂, v₁, v₀) of the sum's v = −v' modulo u; ``middle`` has the coefficients of −v' (:func:`next_v`)."""
    (u2, u1, u0), (k3, k2, k1, k0) = u, middle
    return k2 - k3 * u2, k1 - k3 * u1, k0 - k3 * u0


# --- degree 8


def quartic(C: Any, meeting: Four, middle: Four) -> Four:
    """The coefficients of c·u' − v' below c·x⁴, from u' = ``meeting`` and −v' = ``middle``, with y ~ c·x⁴ at ∞₊."""
    w3, w2, w1, w0 = (k + C.c * e for k, e in zip(middle, meeting, strict=True))
    return w3, w2, w1, w0


def sum_u_of_degree_8(C: Any, meeting: Four, curve: Four) -> Triple:
    """(u₂, u₁, u₀) of the sum's u, from the quartic ``curve``. For a sum of lower weight 0 is inverted."""
    (e3, e2, e1, _), (w3, w2, w1, w0) = meeting, curve
    twice = w3 + w3
    inverse = 1 / (C.f7 - C.c * twice)
    u2 = (C.f6 - C.c * (w2 + w2) - w3 * w3) * inverse - e3
    u1 = (C.f5 - C.c * (w1 + w1) - twice * w2) * inverse - e2 - e3 * u2
    return u2, u1, (C.f4 - C.c * (w0 + w0) - twice * w1 - w2 * w2) * inverse - e1 - e2 * u2 - e3 * u1


def sum_v_of_degree_8(C: Any, u: Triple, curve: Four) -> Triple:
    """(v₂, v₁, v₀) of the sum's v, which is the quartic ``curve`` modulo u."""
    (u2, u1, u0), (w3, w2, w1, w0) = u, curve
    g = w3 - C.c * u2
    return w2 - C.c * u1 - g * u2, w1 - C.c * u0 - g * u1, w0 - g * u0


def _formulas(coefficients: tuple[str, ...], *last: tuple[str, Any]) -> Formulas:
    steps = (("product", product), ("bent", quintic), ("meeting", next_u), ("middle", next_v), *last)
    return Formulas(3, coefficients, chord, tangent, opposite, steps)


OF_DEGREE_7 = _formulas(("f3", "f4", "f5", "f6", "f7", "f8"), ("u", sum_u), ("v", sum_v))
OF_DEGREE_8 = _formulas(
    ("f3", "f4", "f5", "f6", "f7", "f8", "c"), ("curve", quartic), ("u", sum_u_of_degree_8), ("v", sum_v_of_degree_8)
)
