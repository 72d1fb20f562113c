"""Composition with built-in reduction for large genus. Its cost grows like g², the cost of step-by-step reduction
like g³.

Let A, B and k be those of :func:`jacobian.addition.cantor.factors`. A composition is (A·B, v₂ + B·k), of degree up to
2g. Cantor's reduction lowers this degree by two a step. Here the Euclidean algorithm on A and k is stopped half-way
instead, at a remainder r = ck − qA. The function cy − w with w = cv₂ + Br vanishes on the composition. Its norm divided
by A·B is N = rM₁ + cM₂, of degree about g, where M₁ = (Br − c(v₁ − v₂))/A and M₂ = (r(v₁ + v₂ + h) − c(f − hv₂ −
v₂²)/B)/A. The sum, up to one or two reduction steps, is

    u = N,    v = −h − (w + εc'N)/c modulo N,

where c' and w' are c and w one step earlier, ε = ±1 and εAB = cw' − c'w. The division by c is exact. Shanks found the
method for quadratic forms (NUCOMP 1989); for curves see Jacobson and van der Poorten 2002, and Jacobson, Scheidler and
Stein 2007.

The weight at infinity follows from the pole of w − cy at ∞₊ as in :func:`jacobian.addition.cantor.reflect`.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition import cantor
from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.poly import Poly, add, divide, mod, monic, mul, neg, quotient, sub

Triple = cantor.Triple


def sum_of(C: HyperellipticCurve, a: Triple, b: Triple) -> Triple:
    """The reduced triple of a + b."""
    if len(a[0]) < len(b[0]):
        a, b = b, a
    return cantor.reduce(C, _shortened(C, a[1], *cantor.factors(C, a, b)))


def double(C: HyperellipticCurve, a: Triple) -> Triple:
    """The reduced triple of a + a; for quadratic forms this is Shanks' NUDUPL."""
    return cantor.reduce(C, _shortened(C, a[1], *cantor.factors_of_double(C, a)))


def _shortened(C: HyperellipticCurve, v1: Poly, A: Poly, B: Poly, v: Poly, k: Poly, weight: int | None) -> Triple:
    """A triple of the class of (A·B, v + B·k, weight), where v is v₂."""
    K, g = C.field, C.genus
    if len(A) + len(B) - 2 <= g:
        return cantor.multiplied(C, A, B, v, k, weight)
    difference, trace = sub(K, v1, v), add(K, add(K, v1, v), C.h)
    r, c, last, sign = _half_euclid(K, A, k, (g + len(A) - len(B)) // 2)
    stretched = mul(K, B, r)
    m1 = quotient(K, sub(K, stretched, mul(K, c, difference)), A)
    m2 = quotient(K, sub(K, mul(K, r, trace), mul(K, c, cantor.cofactor(C, B, v))), A)
    norm = add(K, mul(K, r, m1), mul(K, c, m2))
    w = add(K, stretched, mul(K, c, v))
    shift = mul(K, last, norm)
    y = quotient(K, add(K, w, shift) if sign > 0 else sub(K, w, shift), c)
    u = monic(K, norm)
    if weight is not None:
        weight += _pole_at_plus(C, w, c, len(A) + len(B) - 2 + len(u) - 1) - (len(u) - 1)
    return u, mod(K, neg(K, add(K, y, C.h)), u), weight


def _half_euclid(K: Any, A: Poly, k: Poly, bound: int) -> tuple[Poly, Poly, Poly, int]:
    """Runs the Euclidean algorithm on A and k until the remainder r = ck − qA has degree ≤ bound; returns (r, c, c',
    ε). c' and r' are the multiplier and remainder one step earlier, and cr' − c'r = εA.
    """
    r0, r1 = A, k
    c0: Poly = ()
    c1: Poly = (K.one,)
    sign = 1
    while len(r1) - 1 > bound:
        q, r = divide(K, r0, r1)
        r0, r1 = r1, r
        c0, c1 = c1, sub(K, c0, mul(K, q, c1))
        sign = -sign
    return r1, c1, c0, sign


def _pole_at_plus(C: HyperellipticCurve, w: Poly, c: Poly, both: int) -> int:
    """The order of the pole of w − cy at ∞₊. ``both`` is the sum of the orders at ∞₊ and ∞₋."""
    K, size = C.field, C.genus + len(c)
    if len(w) - 1 > size:
        return len(w) - 1
    lead = coefficient(K, w, size)
    return both - size if lead == K.mul(c[-1], C.infinity_plus) else size
