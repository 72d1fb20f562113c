"""Explicit formulas of genus 2 in two halves, before and after the inversion.

In odd characteristic they need h = 0. In characteristic 2 they take any h; there signs vanish and 2V + h = h. The
formulas are those of :mod:`jacobian.addition.genus2` (Lange 2005; our own on models of degree 6) in the arithmetic
of :mod:`jacobian.numbers.words`: sums of products are reduced once, and ``fit`` appears where a wide context needs it.
Between the halves a batch inverts the products of many rows together (:mod:`jacobian.batch.block_loops`).

A line is (a₁, a₀, b₁, b₀) for U = x² + a₁x + a₀, V = b₁x + b₀. The first half gives (r, r·s₁, r·s₀), where ℓ = V +
U·(s₁x + s₀) is the cubic through both divisors and r a resultant, and the product to be inverted, which is 0 in every
special case. The second half, in three steps, gives the sum in canonical form. Tests run all formulas on intervals to
show that no word overflows.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.numbers.words import add, canonical, dot2, dot3, dot4, fit, mul, neg, settled, sub

Line = tuple[Any, Any, Any, Any]
Quotient = tuple[Any, Any, Any]

Quintic = namedtuple("Quintic", "f2 f3 f4")
Quintic.__doc__ = "y² = x⁵ + f₄x⁴ + … + f₀, as far as the formulas use it."
Sextic = namedtuple("Sextic", "f2 f3 f4 f5 f6")
Sextic.__doc__ = "y² = f₆x⁶ + … + f₀ with f₆ ≠ 0, as far as the formulas use it."
BinaryQuintic = namedtuple("BinaryQuintic", "h0 h1 h2 f2 f3 f4")
BinaryQuintic.__doc__ = "y² + (h₂x² + h₁x + h₀)y = x⁵ + f₄x⁴ + … + f₀ in characteristic 2, likewise."
BinarySextic = namedtuple("BinarySextic", "h0 h1 h2 h3 f2 f3 f4 f5 f6")
BinarySextic.__doc__ = "y² + (h₃x³ + … + h₀)y = f₆x⁶ + … + f₀ with h₃ ≠ 0 in characteristic 2, likewise."
Short = Quintic | Sextic | BinaryQuintic | BinarySextic


def short_equation(C: HyperellipticCurve, to_word: Any) -> Short | None:
    """The coefficients of C for the explicit formulas of genus 2; None if the formulas do not apply."""
    K: Any = C.field
    ramified, binary = C.model == "ramified", K.characteristic == 2
    if C.genus != 2 or (C.h and not binary) or (ramified and C.f[-1] != K.one):
        return None
    f = [to_word(coefficient(K, C.f, i)) for i in range(2, 7)]
    if not binary:
        return Quintic(*f[:3]) if ramified else Sextic(*f)
    h = [to_word(coefficient(K, C.h, i)) for i in range(4)]
    return BinaryQuintic(*h[:3], *f[:3]) if ramified else BinarySextic(*h, *f)


def chord(K: Any, first: Line, second: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = (V' − V)/U modulo U'."""
    a1, a0, b1, b0 = first
    c1, c0, d1, d0 = second
    z1, z2, w1, w0 = sub(K, a1, c1), sub(K, c0, a0), sub(K, b1, d1), sub(K, b0, d0)
    z3 = add(K, fit(K, mul(K, z1, c1)), z2)
    r = dot2(K, z2, z3, mul(K, z1, z1), c0)
    top = neg(K, mul(K, z1, w1))
    return r, dot3(K, z1, w0, z3, w1, top, c1), dot2(K, z3, w0, top, c0)


def twice_v(K: Any, first: Line) -> tuple[Any, Any]:
    """2V."""
    _, _, b1, b0 = first
    return add(K, b1, b1), add(K, b0, b0)


def over_tangent(K: Any, first: Line, t: tuple[Any, Any], k: tuple[Any, Any]) -> Quotient:
    """(r, r·s₁, r·s₀) for s = (k₁x + k₀)/(t₁x + t₀) modulo U."""
    (a1, a0, _, _), (t1, t0), (k1, k0) = first, t, k
    t3 = sub(K, t0, fit(K, mul(K, a1, t1)))
    r = dot2(K, a0, mul(K, t1, t1), t0, t3)
    top = mul(K, t1, k1)
    return r, dot3(K, t3, k1, neg(K, t1), k0, top, a1), dot2(K, t3, k0, top, a0)


def tangent_quintic(K: Any, C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − V²)/U)/2V modulo U."""
    a1, a0, b1, _ = first
    bent = sub(K, a1, C.f4)
    twice, double = add(K, bent, a1), add(K, a0, a0)
    k1 = sub(K, add(K, fit(K, mul(K, a1, add(K, bent, twice))), C.f3), double)
    rest = add(K, fit(K, mul(K, a1, bent)), C.f3)
    k0 = sub(K, C.f2, fit(K, dot3(K, b1, b1, a1, rest, neg(K, double), twice)))
    return over_tangent(K, first, twice_v(K, first), (k1, k0))


def product_quintic(K: Any, C: Any, quotient: Quotient) -> Any:
    """r·(r·s₁), which is inverted."""
    r, s1, _ = quotient
    return mul(K, r, s1)


def cubic_quintic(K: Any, C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """(s₁, s₀/s₁, 1/s₁, 1/s₁²), without the factor r, from the inverse of the product."""
    r, s1, s0 = quotient
    shrink = mul(K, r, inverse)
    lead = mul(K, mul(K, s1, s1), inverse)
    w4 = fit(K, mul(K, r, shrink))
    return lead, fit(K, mul(K, s0, shrink)), w4, fit(K, mul(K, w4, w4))


def sum_u_quintic(K: Any, C: Any, cubic: Line, first: Line, second: Line) -> tuple[Any, Any]:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    _, s, w4, w5 = cubic
    a1, a0, b1, _ = first
    c1, c0, _, _ = second
    turned = add(K, s, sub(K, a1, c1))
    e1 = settled(K, sub(K, add(K, s, turned), w5))
    bow = dot4(K, sub(K, s, c1), turned, s, a1, add(K, b1, b1), w4, sub(K, add(K, a1, c1), C.f4), w5)
    return e1, settled(K, add(K, fit(K, bow), sub(K, a0, c0)))


def sum_v_quintic(K: Any, C: Any, cubic: Line, u: tuple[Any, Any], first: Line) -> tuple[Any, Any]:
    """(v₁, v₀) of the sum's v = −ℓ modulo u."""
    lead, s, _, _ = cubic
    e1, e0 = u
    a1, a0, b1, b0 = first
    w = sub(K, add(K, s, a1), e1)
    inner = add(K, fit(K, dot2(K, s, a1, neg(K, e1), w)), sub(K, a0, e0))
    v1 = add(K, fit(K, mul(K, lead, inner)), b1)
    v0 = add(K, fit(K, mul(K, lead, dot2(K, s, a0, neg(K, e0), w))), b0)
    return canonical(K, neg(K, v1)), canonical(K, neg(K, v0))


def tangent_sextic(K: Any, C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − V²)/U)/2V modulo U."""
    a1, a0, b1, _ = first
    # the quotient k₄x⁴ + … + k₀ of f − V² by U, k₄ = f₆, and its remainder by two more steps of the same division
    top = fit(K, mul(K, C.f6, a1))
    k3 = sub(K, C.f5, top)
    k2 = sub(K, C.f4, fit(K, dot2(K, a1, k3, C.f6, a0)))
    k1 = sub(K, C.f3, fit(K, dot2(K, a1, k2, a0, k3)))
    k0 = sub(K, C.f2, fit(K, dot2(K, b1, b1, a1, k1)))
    k3 = sub(K, k3, top)
    rest = sub(K, k2, fit(K, dot2(K, a1, k3, C.f6, a0)))
    k1 = sub(K, k1, fit(K, dot2(K, a1, rest, a0, k3)))
    k0 = sub(K, k0, fit(K, mul(K, a0, add(K, k2, rest))))
    return over_tangent(K, first, twice_v(K, first), (k1, k0))


def product_sextic(K: Any, C: Any, quotient: Quotient) -> Any:
    """r³·(s₁² − f₆), which is inverted."""
    r, s1, _ = quotient
    s1 = fit(K, s1)
    return mul(K, r, dot2(K, s1, s1, neg(K, mul(K, r, C.f6)), r))


def cubic_sextic(K: Any, C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """(s₁, s₀, 1/(s₁² − f₆), a₁s₁) from the inverse of the product."""
    r, s1, s0 = quotient
    square = mul(K, r, r)
    scale = mul(K, square, mul(K, r, inverse))
    s1 = fit(K, s1)
    # 1/r = (s₁² − f₆r²)/product
    shrink = mul(K, dot2(K, s1, s1, neg(K, C.f6), square), inverse)
    s1, s0 = fit(K, mul(K, s1, shrink)), fit(K, mul(K, s0, shrink))
    return s1, s0, scale, fit(K, mul(K, first[0], s1))


def sum_u_sextic(K: Any, C: Any, cubic: Line, first: Line, second: Line) -> tuple[Any, Any]:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    s1, s0, scale, high = cubic
    a1, a0, b1, _ = first
    c1, c0, _, _ = second
    k3 = sub(K, C.f5, fit(K, mul(K, C.f6, a1)))
    p2 = add(K, s0, high)
    t3 = sub(K, fit(K, mul(K, s1, add(K, s0, p2))), k3)
    bend = add(K, fit(K, mul(K, a0, s1)), add(K, b1, b1))
    t2 = sub(K, fit(K, dot4(K, s0, add(K, p2, high), s1, bend, a1, k3, C.f6, a0)), C.f4)
    e1 = canonical(K, sub(K, fit(K, mul(K, t3, scale)), c1))
    return e1, canonical(K, sub(K, fit(K, dot2(K, t2, scale, neg(K, c1), e1)), c0))


def sum_v_sextic(K: Any, C: Any, cubic: Line, u: tuple[Any, Any], first: Line) -> tuple[Any, Any]:
    """(v₁, v₀) of the sum's v = −ℓ modulo u."""
    s1, s0, _, high = cubic
    e1, e0 = u
    a1, a0, b1, b0 = first
    q = sub(K, add(K, s0, high), fit(K, mul(K, e1, s1)))
    v1 = sub(K, fit(K, dot3(K, sub(K, e0, a0), s1, e1, q, neg(K, a1), s0)), b1)
    v0 = sub(K, fit(K, dot2(K, e0, q, neg(K, a0), s0)), b0)
    return canonical(K, v1), canonical(K, v0)


def opposite_odd(K: Any, C: Any, first: Line) -> Line:
    """(U, −V)."""
    a1, a0, b1, b0 = first
    return a1, a0, neg(K, b1), neg(K, b0)


# --- characteristic 2: a sum is a difference


def add3(K: Any, x: Any, y: Any, z: Any) -> Any:
    """x + y + z."""
    return add(K, add(K, x, y), z)


def h_binary_quintic(K: Any, C: Any, first: Line) -> tuple[Any, Any]:
    """h modulo U."""
    a1, a0, _, _ = first
    return add(K, C.h1, mul(K, C.h2, a1)), add(K, C.h0, mul(K, C.h2, a0))


def tangent_binary_quintic(K: Any, C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − hV − V²)/U)/h modulo U."""
    a1, _, b1, b0 = first
    k1 = add3(K, C.f3, mul(K, C.h2, b1), mul(K, a1, a1))
    rest = add(K, k1, mul(K, a1, C.f4))
    k0 = add(K, C.f2, dot3(K, C.h2, b0, add(K, C.h1, b1), b1, a1, rest))
    return over_tangent(K, first, h_binary_quintic(K, C, first), (k1, k0))


def sum_u_binary_quintic(K: Any, C: Any, cubic: Line, first: Line, second: Line) -> tuple[Any, Any]:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    _, s, w4, w5 = cubic
    a1, a0, _, _ = first
    c1, c0, _, _ = second
    both = add(K, a1, c1)
    bent = add(K, both, mul(K, C.h2, w4))
    bow = dot4(K, add(K, s, c1), add(K, s, bent), s, a1, C.h1, w4, add(K, both, C.f4), w5)
    return add(K, bent, w5), add3(K, bow, a0, c0)


def sum_v_binary_quintic(K: Any, C: Any, cubic: Line, u: tuple[Any, Any], first: Line) -> tuple[Any, Any]:
    """(v₁, v₀) of the sum's v = −ℓ − h modulo u."""
    lead, s, _, _ = cubic
    e1, e0 = u
    a1, a0, b1, b0 = first
    w = add3(K, s, a1, e1)
    inner = add3(K, dot2(K, s, a1, e1, w), a0, e0)
    v1 = add3(K, dot2(K, lead, inner, C.h2, e1), C.h1, b1)
    return v1, add3(K, dot2(K, lead, dot2(K, s, a0, e0, w), C.h2, e0), C.h0, b0)


def h_binary_sextic(K: Any, C: Any, first: Line) -> tuple[Any, Any]:
    """h modulo U."""
    a1, a0, _, _ = first
    top = add(K, C.h2, mul(K, C.h3, a1))
    return add(K, C.h1, dot2(K, a1, top, C.h3, a0)), add(K, C.h0, mul(K, a0, top))


def tangent_binary_sextic(K: Any, C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) for s = ((f − hV − V²)/U)/h modulo U."""
    a1, a0, b1, b0 = first
    k3 = add(K, C.f5, mul(K, C.f6, a1))
    k2 = add(K, C.f4, dot3(K, C.h3, b1, a1, k3, C.f6, a0))
    k1 = add(K, C.f3, dot4(K, C.h3, b0, C.h2, b1, a1, k2, a0, k3))
    k0 = add(K, C.f2, dot3(K, C.h2, b0, add(K, C.h1, b1), b1, a1, k1))
    rest = add(K, k2, dot2(K, a1, C.f5, C.f6, a0))
    k1 = add(K, k1, dot2(K, a1, rest, a0, C.f5))
    k0 = add(K, k0, mul(K, a0, add(K, k2, rest)))
    return over_tangent(K, first, h_binary_sextic(K, C, first), (k1, k0))


def lead_binary_sextic(K: Any, C: Any, quotient: Quotient) -> Any:
    """r²·(s₁² + h₃s₁ − f₆)."""
    r, s1, _ = quotient
    return dot2(K, s1, add(K, s1, mul(K, C.h3, r)), mul(K, r, C.f6), r)


def product_binary_sextic(K: Any, C: Any, quotient: Quotient) -> Any:
    """r³·(s₁² + h₃s₁ − f₆), which is inverted."""
    return mul(K, quotient[0], lead_binary_sextic(K, C, quotient))


def cubic_binary_sextic(K: Any, C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """(s₁, s₀, 1/(s₁² + h₃s₁ − f₆), a₁s₁) from the inverse of the product."""
    r, s1, s0 = quotient
    shrink = mul(K, lead_binary_sextic(K, C, quotient), inverse)
    s1 = mul(K, s1, shrink)
    return s1, mul(K, s0, shrink), mul(K, mul(K, r, r), mul(K, r, inverse)), mul(K, first[0], s1)


def sum_u_binary_sextic(K: Any, C: Any, cubic: Line, first: Line, second: Line) -> tuple[Any, Any]:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    s1, s0, scale, high = cubic
    a1, a0, b1, _ = first
    c1, c0, _, _ = second
    k3 = add(K, C.f5, mul(K, C.f6, a1))
    t3 = add(K, dot2(K, s1, add(K, high, C.h2), C.h3, s0), k3)
    bend = add(K, mul(K, a0, s1), C.h1)
    t2 = add3(K, dot4(K, s0, add(K, s0, C.h2), s1, bend, C.h3, b1, a1, k3), mul(K, C.f6, a0), C.f4)
    e1 = add(K, mul(K, t3, scale), c1)
    return e1, add(K, dot2(K, t2, scale, c1, e1), c0)


def sum_v_binary_sextic(K: Any, C: Any, cubic: Line, u: tuple[Any, Any], first: Line) -> tuple[Any, Any]:
    """(v₁, v₀) of the sum's v = −ℓ − h modulo u."""
    s1, s0, _, high = cubic
    e1, e0 = u
    a1, a0, b1, b0 = first
    top = add(K, s1, C.h3)
    q = add(K, add3(K, s0, high, C.h2), mul(K, e1, top))
    v1 = add3(K, dot4(K, e0, top, e1, q, a0, s1, a1, s0), C.h1, b1)
    return v1, add3(K, dot2(K, e0, q, a0, s0), C.h0, b0)


def opposite_binary_quintic(K: Any, C: Any, first: Line) -> Line:
    """(U, −V − h modulo U)."""
    (a1, a0, b1, b0), (t1, t0) = first, h_binary_quintic(K, C, first)
    return a1, a0, add(K, b1, t1), add(K, b0, t0)


def opposite_binary_sextic(K: Any, C: Any, first: Line) -> Line:
    """(U, −V − h modulo U)."""
    (a1, a0, b1, b0), (t1, t0) = first, h_binary_sextic(K, C, first)
    return a1, a0, add(K, b1, t1), add(K, b0, t0)


# --- one name for the steps of all models; compiled code chooses at compile time


def tangent(K: Any, C: Any, first: Line) -> Quotient:
    """(r, r·s₁, r·s₀) of the cubic that touches the curve in a divisor."""
    return STEPS[tangent][type(C)](K, C, first)


def product(K: Any, C: Any, quotient: Quotient) -> Any:
    """The product to be inverted; 0 in every special case."""
    return STEPS[product][type(C)](K, C, quotient)


def cubic(K: Any, C: Any, quotient: Quotient, inverse: Any, first: Line) -> Line:
    """The coefficients of the cubic through both divisors, from the inverse of the product."""
    return STEPS[cubic][type(C)](K, C, quotient, inverse, first)


def sum_u(K: Any, C: Any, cubic: Line, first: Line, second: Line) -> tuple[Any, Any]:
    """(e₁, e₀) of the sum's u = x² + e₁x + e₀."""
    return STEPS[sum_u][type(C)](K, C, cubic, first, second)


def sum_v(K: Any, C: Any, cubic: Line, u: tuple[Any, Any], first: Line) -> tuple[Any, Any]:
    """(v₁, v₀) of the sum's v = −ℓ modulo u."""
    return STEPS[sum_v][type(C)](K, C, cubic, u, first)


def opposite(K: Any, C: Any, first: Line) -> Line:
    """The negative of a divisor."""
    return STEPS[opposite][type(C)](K, C, first)


def _of_models(*functions: Any) -> dict[type, Any]:
    return dict(zip((Quintic, Sextic, BinaryQuintic, BinarySextic), functions, strict=True))


STEPS: dict[Any, dict[type, Any]] = {
    tangent: _of_models(tangent_quintic, tangent_sextic, tangent_binary_quintic, tangent_binary_sextic),
    product: _of_models(product_quintic, product_sextic, product_quintic, product_binary_sextic),
    cubic: _of_models(cubic_quintic, cubic_sextic, cubic_quintic, cubic_binary_sextic),
    sum_u: _of_models(sum_u_quintic, sum_u_sextic, sum_u_binary_quintic, sum_u_binary_sextic),
    sum_v: _of_models(sum_v_quintic, sum_v_sextic, sum_v_binary_quintic, sum_v_binary_sextic),
    opposite: _of_models(opposite_odd, opposite_odd, opposite_binary_quintic, opposite_binary_sextic),
}
"""For each step, the function of each model."""
PARTS = (chord, twice_v, over_tangent, add3, h_binary_quintic, h_binary_sextic, lead_binary_sextic)
"""The functions that the steps call."""
