"""Bäcklund maps of pairs as additions of points: D + P − ∞, D + P − ∞±, D + P − Q, in any genus and over any field.

P = (λ, μ) is a point of y² = f(x), and ℓ the leading coefficient of f. The maps commute with each other and with all
vector fields of :mod:`integrable.mumford.fields`. For a fixed λ they are canonical for the brackets of that module
(Kuznetsov & Vanhaecke 2002). The maps divide by U(λ) and take no root. A pair with a point at λ raises
ZeroDivisionError over exact fields and jets.
"""

from __future__ import annotations

from integrable.mumford.fields import padded
from jacobian import poly
from jacobian.element import Arithmetic, Real
from jacobian.poly import Poly

Pair = tuple[Poly, Poly]


def plus_point(K: Arithmetic, f: Poly, pair: Pair, point: tuple[Real, Real]) -> Pair:
    """D + P − ∞ for D = ``pair`` = (U, V) and P = ``point`` = (λ, μ), on a model of odd degree.

    R = V + cU with R(λ) = μ, Ũ = (f − R²)/(ℓU(x − λ)) with the leading coefficient ℓ of f, and Ṽ = −R mod Ũ.
    """
    (u, v), (x, y) = pair, point
    c = K.div(K.sub(y, poly.evaluate(K, v, x)), poly.evaluate(K, u, x))
    r = poly.add(K, v, tuple([K.mul(c, a) for a in u]))
    return _residual(K, f, u, r, (K.neg(x), K.one))


def plus_point_minus_infinity(K: Arithmetic, f: Poly, pair: Pair, point: tuple[Real, Real], root: Real) -> Pair:
    """D + P − ∞ for D = ``pair`` = (U, V) and P = ``point`` = (λ, μ), on a model of even degree. At the subtracted
    point ∞, y ~ root·x^{g+1}.

    The result is (Ũ, −R mod Ũ) with R = V + (−root·x + c)U and R(λ) = μ, as in :func:`plus_point`.
    """
    (u, v), (x, y) = pair, point
    c = K.add(K.div(K.sub(y, poly.evaluate(K, v, x)), poly.evaluate(K, u, x)), K.mul(root, x))
    r = poly.add(K, v, poly.mul(K, u, (c, K.neg(root))))
    return _residual(K, f, u, r, (K.neg(x), K.one))


def shifted(K: Arithmetic, f: Poly, pair: Pair, root: Real) -> Pair:
    """D + ∞₋ − ∞₊ on a model of even degree, where y ~ root·x^{g+1} at ∞₊.

    The result for D = (U, V) is (Ũ, −R mod Ũ). Here R = V + (−root·x + c)U, with c such that f − R² has no term
    x^{2g+1}, and Ũ has the zeros of f − R² other than those of U.
    """
    u, v = pair
    g = len(u) - 1
    # deg V < g, so x^{2g+1} cancels in f − R² if the coefficient of x^g in R is f_{2g+1}/(−2·root)
    half = K.inv(K.add(root, root))
    c = K.sub(K.mul(root, u[g - 1]), K.mul(half, f[2 * g + 1]))
    r = poly.add(K, v, poly.mul(K, u, (c, K.neg(root))))
    return _residual(K, f, u, r, (K.one,))


def plus_difference(K: Arithmetic, f: Poly, pair: Pair, point: tuple[Real, Real], other: tuple[Real, Real]) -> Pair:
    """D + P − Q for D = ``pair`` = (U, V), P = ``point`` = (λ, μ) and Q = ``other`` = (λ', μ') with λ ≠ λ'.

    The result is (Ũ, −R mod Ũ). Here R = V + LU with L linear, R(λ) = μ and R(λ') = −μ', and Ũ has the zeros of f − R²
    other than λ, λ' and those of U.
    """
    u, v = pair
    (x, y), (z, w) = point, other
    slopes = [
        K.div(K.sub(value, poly.evaluate(K, v, at)), poly.evaluate(K, u, at)) for at, value in ((x, y), (z, K.neg(w)))
    ]
    b = K.div(K.sub(slopes[0], slopes[1]), K.sub(x, z))
    line = (K.sub(slopes[0], K.mul(b, x)), b)
    r = poly.add(K, v, poly.mul(K, u, line))
    return _residual(K, f, u, r, poly.from_roots(K, (x, z)))


def _residual(K: Arithmetic, f: Poly, u: Poly, r: Poly, known: Poly) -> Pair:
    """(Ũ, −R mod Ũ), where Ũ has the zeros of f − R² other than those of U and ``known``."""
    g = len(u) - 1
    difference = poly.sub(K, f, poly.mul(K, r, r))[: 2 * g + len(known)]
    new = poly.monic(K, poly.quotient(K, difference, poly.mul(K, u, known))[: g + 1])
    return new, padded(K, poly.mod(K, poly.neg(K, r), new), g)


def generating_function(K: Arithmetic, f_fixed: Poly, x: Real, u: Poly, new: Poly, c: Real) -> Real:
    """The generating function F of the map D ↦ D + P − ∞ on a model of odd degree: dF = Σp_i dx_i − Σp̃_i dx̃_i, where
    (x_i, p_i) are the points of D and (x̃_i, p̃_i) those of its image.

    f = f_fixed + Σh_j x^j with integrals of motion h_j.

    F = 2[x⁻¹]Σ_{m=1}^{g+1} Q^{m+1/2}/((2m + 1)f_fixed^m), Q = f_fixed − ℓ(x − λ)UŨ, expanded at ∞ with √Q = c·x^g + …;
    ``x`` is λ, ``u`` and ``new`` are U and Ũ, and c is that of :func:`plus_point`. Q has degree 2g and leading
    coefficient c².
    """
    g, lead = len(u) - 1, f_fixed[-1]
    product = poly.mul(K, poly.mul(K, u, new), (K.neg(K.mul(lead, x)), lead))
    q = poly.sub(K, f_fixed, product)[: 2 * g + 1]
    # let t = 1/x, Q = x^{2g}·q(t) and f_fixed = x^{2g+1}·b(t). Then Q^{m+1/2}/f_fixed^m = x^{g−m}·q^{m+1/2}/b^m, whose
    # coefficient of x⁻¹ is that of t^{g−m+1} in q^{m+1/2}/b^m
    size = g + 1
    q_series = padded(K, q[::-1], size)
    inverse = _inverse(K, padded(K, f_fixed[::-1], size))
    total, term = K.zero, _square_root(K, q_series, c)
    for m in range(1, g + 2):
        term = poly.mul(K, poly.mul(K, term, q_series)[:size], inverse)[:size]
        total = K.add(total, K.div(term[g + 1 - m], poly.integer(K, 2 * m + 1)))
    return K.add(total, total)


def _square_root(K: Arithmetic, a: Poly, first: Real) -> Poly:
    found, half = [first], K.inv(K.add(first, first))
    for k in range(1, len(a)):
        inner = K.dot(found[1:], found[:0:-1]) if k > 1 else K.zero
        found.append(K.mul(half, K.sub(a[k], inner)))
    return tuple(found)


def _inverse(K: Arithmetic, a: Poly) -> Poly:
    first = K.inv(a[0])
    found = [first]
    for k in range(1, len(a)):
        found.append(K.neg(K.mul(first, K.dot(a[1 : k + 1], found[::-1]))))
    return tuple(found)
