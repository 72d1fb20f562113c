"""Composition and reduction of divisors over exact fields.

A triple (u, v, n) of a split model stands for the class of

    div(u, v) + n·∞₊ + (g − deg u − n)·∞₋ − D∞,    D∞ = ⌈g/2⌉∞₊ + ⌊g/2⌋∞₋,

where div(u, v) is the divisor of common affine zeros of u(x) and y − v(x). Intermediate n may be any integer; at the
end 0 ≤ n ≤ g − deg u. On ramified and inert models n is None and the class is div(u, v) minus (deg u)·∞, or minus deg
u/2 times each of the two points at infinity. Every function takes and returns n with (u, v), so that it is never
recomputed.

Sources: Cantor 1987 and Koblitz 1989 (h ≠ 0, characteristic 2) for composition and reduction; Galbraith, Harrison and
Mireles Morales 2008 for the balanced divisors and the steps at infinity.
"""

from __future__ import annotations

from collections.abc import Iterator

from jacobian.curve.curve import HyperellipticCurve, coefficient
from jacobian.poly import Poly, add, half_xgcd, mod, monic, mul, neg, quotient, sub

Triple = tuple[Poly, Poly, int | None]


def weight_of_zero(C: HyperellipticCurve) -> int | None:
    """The weight n of the identity at ∞₊: ⌈g/2⌉ on a split model, None on other models."""
    return (C.genus + 1) // 2 if C.model == "split" else None


def sum_of(C: HyperellipticCurve, a: Triple, b: Triple) -> Triple:
    """The reduced triple of a + b."""
    return reduce(C, compose(C, a, b))


def compose(C: HyperellipticCurve, a: Triple, b: Triple) -> Triple:
    """An unreduced triple of a + b, with deg u up to deg u₁ + deg u₂."""
    return multiplied(C, *factors(C, a, b))


def factors(C: HyperellipticCurve, a: Triple, b: Triple) -> tuple[Poly, Poly, Poly, Poly, int | None]:
    """(A, B, v₂, k, n): the triple (AB, v₂ + Bk, n) is in the class a + b, and deg k < deg A.

    Let e = gcd(u₁, u₂) ≡ s·u₂ modulo u₁, and d = gcd(e, v₁+v₂+h) = r·e + t·(v₁+v₂+h), whose roots are the x of points
    of a whose opposites are in b. Then A = u₁/d, B = u₂/d and k = r·s(v₁−v₂) + t·(f−hv₂−v₂²)/u₂ modulo A.
    """
    K = C.field
    (u1, v1, n1), (u2, v2, n2) = a, b
    d, s = half_xgcd(K, u1, u2)
    k = mul(K, s, sub(K, v1, v2))
    if len(d) > 1:
        d, k = _common_part(C, d, add(K, add(K, v1, v2), C.h), k, u2, v2)
        u1, u2 = quotient(K, u1, d), quotient(K, u2, d)
    n = None if n1 is None or n2 is None else n1 + n2 + len(d) - 1 - (C.genus + 1) // 2
    return u1, u2, v2, mod(K, k, u1), n


def factors_of_double(C: HyperellipticCurve, a: Triple) -> tuple[Poly, Poly, Poly, Poly, int | None]:
    """The result of :func:`factors` for a + a."""
    K = C.field
    u, v, n = a
    d, t = half_xgcd(K, u, add(K, add(K, v, v), C.h))
    k = mul(K, t, cofactor(C, u, v))
    if len(d) > 1:
        u = quotient(K, u, d)
    return u, u, v, mod(K, k, u), None if n is None else 2 * n + len(d) - 1 - (C.genus + 1) // 2


def multiplied(C: HyperellipticCurve, A: Poly, B: Poly, v: Poly, k: Poly, n: int | None) -> Triple:
    """The triple (AB, v + Bk, n), with v + Bk modulo AB."""
    K = C.field
    u, v = mul(K, A, B), add(K, v, mul(K, B, k))
    return u, v if len(v) < len(u) else mod(K, v, u), n


def _common_part(C: HyperellipticCurve, d: Poly, trace: Poly, k: Poly, u: Poly, v: Poly) -> tuple[Poly, Poly]:
    """The d and k of :func:`factors`, if gcd(u₁, u₂) is not 1.

    The arguments are gcd(u₁, u₂) as ``d``, v₁+v₂+h as ``trace``, s(v₁−v₂) with su₂ ≡ d mod u₁ as ``k``, and (u₂, v₂).
    """
    K = C.field
    common, t = half_xgcd(K, d, trace)
    if not t:
        return common, k
    r = quotient(K, sub(K, common, mul(K, t, trace)), d)
    return common, add(K, mul(K, r, k), mul(K, t, cofactor(C, u, v)))


def cofactor(C: HyperellipticCurve, u: Poly, v: Poly) -> Poly:
    """(f − hv − v²)/u."""
    K = C.field
    return quotient(K, sub(K, C.f, mul(K, v, add(K, v, C.h))), u)


def double(C: HyperellipticCurve, a: Triple) -> Triple:
    """The reduced triple of a + a."""
    return reduce(C, multiplied(C, *factors_of_double(C, a)))


def opposite(C: HyperellipticCurve, a: Triple) -> Triple:
    """(u, −v − h mod u, n') in the class −a. On a split model of odd genus n' may be g − deg u + 1; then the triple is
    not reduced.
    """
    K = C.field
    u, v, n = a
    v = mod(K, neg(K, add(K, v, C.h)), u) if C.h else neg(K, v)
    return u, v, None if n is None else 2 * ((C.genus + 1) // 2) - (len(u) - 1) - n


def negate(C: HyperellipticCurve, a: Triple) -> Triple:
    """The reduced triple of −a."""
    u, _, n = a = opposite(C, a)
    return a if n is None or 0 <= n <= C.genus - (len(u) - 1) else reduce(C, a)


def reduce(C: HyperellipticCurve, a: Triple) -> Triple:
    """The reduced triple of the class of a: deg u ≤ g, deg v < deg u and, on a split model, 0 ≤ n ≤ g − deg u. It is
    unique.
    """
    for _, below in reductions(C, a):
        a = below
    return a


def reductions(C: HyperellipticCurve, a: Triple) -> Iterator[tuple[Poly, Triple]]:
    """Yields (v, the triple after it) for each step of :func:`reduce`, a reflection at y − v.

    On a split model the last steps begin with deg u ≤ g+1. Each adds a multiple of u to v, so that v has the leading
    terms of V₋ or V₊ (``C.principal_parts``), and applies :func:`reflect`, which gives u'. If n < 0, the step with V₋
    raises n by g+1−deg u' ≥ 1. If n > g − deg u, the step with V₊ lowers n by g+1−deg u ≥ 0. The weight at the other
    point at infinity stays non-negative.
    """
    K, (u, v, n) = C.field, a
    limit = C.genus + (1 if C.model == "split" else 0)
    while len(u) - 1 > limit:
        line = v
        u, v, n = reflect(C, u, v, n)
        yield line, (u, v, n)
    while n is not None and not 0 <= n <= C.genus - (len(u) - 1):
        part = C.principal_parts[1 if n < 0 else 0]
        line = add(K, part, mod(K, sub(K, v, part), u))
        u, v, n = reflect(C, u, line, n)
        yield line, (u, v, n)


def reflect(C: HyperellipticCurve, u: Poly, v: Poly, n: int | None) -> Triple:
    """Another triple of the class of (u, v, n): u' = (f − hv − v²)/u, v' = −v − h modulo u'.

    The points of div(u', v') are the opposites of the zeros of y − v outside div(u, v). Let a₊ and a₋ be the orders of
    the poles of y − v at ∞₊ and ∞₋. Then div(u, v) ~ div(u', v') + (a₊ − deg u')∞₊ + (a₋ − deg u')∞₋. An order is
    max(deg v, g+1) unless v and y have the same leading term there; then it follows from a₊ + a₋ = deg u + deg u'.
    """
    K = C.field
    sum_ = add(K, v, C.h)
    other = monic(K, quotient(K, sub(K, C.f, mul(K, v, sum_)), u))
    opposite = mod(K, neg(K, sum_), other)
    if n is None:
        return other, opposite, None
    size = C.genus + 1
    if len(v) - 1 > size:
        n += len(v) - len(other)
    elif coefficient(K, v, size) == C.infinity_plus:
        n += len(u) - 1 - size
    else:
        n += size - (len(other) - 1)
    return other, opposite, n
