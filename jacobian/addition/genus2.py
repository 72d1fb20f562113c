"""The explicit formulas of genus 2, for every field: sums and doublings of divisors of weight 2 in general position.

Let D = (U, V), U = x² + a₁x + a₀, V = b₁x + b₀, and D' = (U', V') likewise. The cubic ℓ = V + U·(s₁x + s₀) passes
through both, and D + D' = (u, −ℓ − h mod u) with u = (ℓ² + hℓ − f)/(U U') made monic. Lange 2005 ("Formulae for
arithmetic on genus 2 hyperelliptic curves", tables 2 and 3) orders the steps so that one inversion is enough. Products
by a coefficient 0 or 1 are left out. For h = 0 and a monic f an addition takes 1I + 22M + 3S, as published. A doubling
takes 1I + 22M + 5S if also f₄ = 0. On models of degree 6, split or inert, neither the two divisors nor their
sum carry weight at infinity, so the same cubic serves. There an addition takes 1I + 29M + 3S for any h, and a doubling
1I + 36M + 3S (f₆ = 1, h = 0).

The product that is inverted is 0 in three special cases, which are left to Cantor's algorithm. U and U' have a common
root, or in a doubling U and 2V + h: the resultant r is 0. On a ramified model the cubic may have a lower degree: s₁ =
0. On a model of degree 6 it may meet the curve at infinity: s₁² + h₃s₁ = f₆.

In code a ``Line`` is a divisor as (a₁, a₀, b₁, b₀), a ``Quotient`` is (r, r·s₁, r·s₀).
:mod:`jacobian.addition.straight` turns the steps into code.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.straight import Formulas, cross, square_of_twice

Line = tuple[Any, Any, Any, Any]
Quotient = tuple[Any, Any, Any]
Pair = tuple[Any, Any]


def chord(C: Any, first: Line, second: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = (V' − V)/U modulo U'; r is the resultant of U and U'. 8M + 1S."""
    (a1, a0, b1, b0), (c1, c0, d1, d0) = first, second
    # U modulo U' is z₁x − z₂, with the inverse −(z₁x + z₃)/r
    z1, z2, w1, w0 = a1 - c1, c0 - a0, b1 - d1, b0 - d0
    z3 = z1 * c1 + z2
    r = z2 * z3 + z1 * z1 * c0
    top = z1 * w1
    return r, cross(z1, z3, w1, w0) - top * c1, z3 * w0 - top * c0


def h_modulo(C: Any, first: Line) -> Pair:
    """h modulo the U of the divisor ``first``."""
    a1, a0, _, _ = first
    top = C.h2 - C.h3 * a1
    return C.h1 - a1 * top - C.h3 * a0, C.h0 - a0 * top


def over_tangent(C: Any, first: Line, numerator: Pair) -> Quotient:
    """(r, r·s₁, r·s₀) for s = s₁x + s₀ = (k₁x + k₀)/(2V + h) modulo U; r is the resultant of U and 2V + h."""
    (a1, a0, b1, b0), (k1, k0), (h1, h0) = first, numerator, h_modulo(C, first)
    t1, t0 = b1 + b1 + h1, b0 + b0 + h0
    square = t1 * t1 if C.h1 or C.h2 or C.h3 else square_of_twice(b1)
    t3 = t0 - a1 * t1
    top = t1 * k1
    return a0 * square + t0 * t3, cross(-t1, t3, k1, k0) + top * a1, t3 * k0 + top * a0


def opposite(C: Any, first: Line) -> Line:
    """(U, −V − h modulo U)."""
    (a1, a0, b1, b0), (h1, h0) = first, h_modulo(C, first)
    return a1, a0, -b1 - h1, -b0 - h0


# --- models of degree 5


def tangent_of_degree_5(C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − hV − V²)/U)/(2V + h) modulo U, as in :func:`over_tangent`. 9M + 2S, 3S if h ≠ 0."""
    a1, a0, b1, b0 = first
    top, double = C.f5 * a1, C.f5 * (a0 + a0)
    bent = a1 * (top - C.f4)
    q = C.f3 - C.h2 * b1 + bent - double
    k0 = C.f2 - C.h2 * b0 - C.h1 * b1 - b1 * b1 - a1 * (q - double) - C.f4 * (a0 + a0)
    return over_tangent(C, first, (q + bent + top * a1, k0))


def product_of_degree_5(C: Any, quotient: Quotient) -> Any:
    """r·(r·s₁) for the ``quotient`` (r, r·s₁, r·s₀): the number that a sum inverts."""
    r, s1, _ = quotient
    return r * s1


def cubic_of_degree_5(C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """(s₁, s₀/s₁, 1/s₁, 1/s₁²) from (r, r·s₁, r·s₀) = ``quotient`` and the inverse of :func:`product_of_degree_5`."""
    r, s1, s0 = quotient
    shrink = r * inverse
    w4 = r * shrink
    return s1 * s1 * inverse, s0 * shrink, w4, w4 * w4


def sum_u_of_degree_5(C: Any, cubic: Line, first: Line, second: Line) -> Pair:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    (_, s, w4, w5), (a1, a0, b1, _), (c1, c0, _, _) = cubic, first, second
    turned = s + (a1 - c1) + C.h2 * w4
    # in a doubling with h₂ = 0, turned = s, c₁ = a₁ and c₀ = a₀, so that only s² remains of the general formula
    bow = s * s if second is first and not C.h2 else (s - c1) * turned + s * a1 + (a0 - c0)
    return s + turned - C.f5 * w5, bow + (b1 + b1 + C.h1) * w4 + (C.f5 * (a1 + c1) - C.f4) * w5


def sum_v_of_degree_5(C: Any, cubic: Line, u: Pair, first: Line) -> Pair:
    """(v₁, v₀) of the sum's v = −ℓ − h modulo u, with the cubic ℓ = V + U·(s₁x + s₀)."""
    (lead, s, _, _), (e1, e0), (a1, a0, b1, b0) = cubic, u, first
    w = s + a1 - e1
    v1 = C.h2 * e1 - C.h1 - b1 - lead * (s * a1 - e1 * w + (a0 - e0))
    return v1, C.h2 * e0 - C.h0 - b0 - lead * (s * a0 - e0 * w)


# --- models of degree 6


def tangent_of_degree_6(C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − hV − V²)/U)/(2V + h) modulo U."""
    a1, a0, b1, b0 = first
    # f₆x⁴ + k₃x³ + … + k₀ is the quotient of f − hV − V² by U; two more steps reduce it modulo U
    k3 = C.f5 - C.f6 * a1
    k2 = C.f4 - C.h3 * b1 - a1 * k3 - C.f6 * a0
    k1 = C.f3 - C.h3 * b0 - C.h2 * b1 - a1 * k2 - a0 * k3
    k0 = C.f2 - C.h2 * b0 - C.h1 * b1 - b1 * b1 - a1 * k1
    k3 = k3 - C.f6 * a1
    rest = k2 - a1 * k3 - C.f6 * a0
    return over_tangent(C, first, (k1 - a1 * rest - a0 * k3, k0 - a0 * (k2 + rest)))


def lead_of_degree_6(C: Any, quotient: Quotient) -> Any:
    """r²·(s₁² + h₃s₁ − f₆), from the quotient (r, r·s₁, r·s₀)."""
    r, s1, _ = quotient
    return s1 * s1 - C.f6 * (r * r) + C.h3 * (r * s1)


def product_of_degree_6(C: Any, quotient: Quotient) -> Any:
    """r³·(s₁² + h₃s₁ − f₆), the number that a sum inverts."""
    return quotient[0] * lead_of_degree_6(C, quotient)


def cubic_of_degree_6(C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """(s₁, s₀, 1/(s₁² + h₃s₁ − f₆), a₁s₁), from the inverse of :func:`product_of_degree_6`."""
    r, s1, s0 = quotient
    shrink = lead_of_degree_6(C, quotient) * inverse
    s1 = s1 * shrink
    return s1, s0 * shrink, r * r * (r * inverse), first[0] * s1


def sum_u_of_degree_6(C: Any, cubic: Line, first: Line, second: Line) -> Pair:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    (s1, s0, scale, high), (a1, a0, b1, _), (c1, c0, _, _) = cubic, first, second
    k3 = C.f5 - C.f6 * a1
    p2 = s0 + high + C.h2
    t3 = s1 * (s0 + p2) + C.h3 * s0 - k3
    t2 = s0 * (p2 + high) + s1 * (a0 * s1 + (b1 + b1 + C.h1)) + C.h3 * b1 + a1 * k3 + C.f6 * a0 - C.f4
    e1 = t3 * scale - c1
    return e1, t2 * scale - c1 * e1 - c0


def sum_v_of_degree_6(C: Any, cubic: Line, u: Pair, first: Line) -> Pair:
    """(v₁, v₀) of the sum's v = −ℓ − h modulo u, with the cubic ℓ = V + U·(s₁x + s₀)."""
    (s1, s0, _, high), (e1, e0), (a1, a0, b1, b0) = cubic, u, first
    q = s0 + high + C.h2 - e1 * (s1 + C.h3)
    v1 = (e0 - a0) * s1 + C.h3 * e0 + e1 * q - a1 * s0 - b1 - C.h1
    return v1, e0 * q - a0 * s0 - b0 - C.h0


def _formulas(tangent: Any, product: Any, cubic: Any, sum_u: Any, sum_v: Any) -> Formulas:
    steps = (("product", product), ("cubic", cubic), ("u", sum_u), ("v", sum_v))
    return Formulas(2, ("h0", "h1", "h2", "h3", "f2", "f3", "f4", "f5", "f6"), chord, tangent, opposite, steps)


OF_DEGREE_5 = _formulas(
    tangent_of_degree_5, product_of_degree_5, cubic_of_degree_5, sum_u_of_degree_5, sum_v_of_degree_5
)
OF_DEGREE_6 = _formulas(
    tangent_of_degree_6, product_of_degree_6, cubic_of_degree_6, sum_u_of_degree_6, sum_v_of_degree_6
)
