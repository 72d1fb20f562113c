"""The g commuting vector fields on pairs (U, V) of y² = f(x), their Lax form and Poisson brackets (Mumford, Tata
Lectures on Theta II, ch. IIIa; Vanhaecke 1996).

U is monic of degree g, deg V < g, deg f = 2g + 1 or 2g + 2 with any leading coefficient, and W = (f − V²)/U is a
polynomial. Coefficients are in ascending order. U and V are given and returned with all their coefficients, leading
zeros included. The first argument of every function is the field, which may be finite, or of jets or balls. No function
takes a square root.

A *direction* c = (c_0 … c_{g−1}) is the motion with Σ_i x_i^k dx_i/y_i = c_k dτ for the points (x_i, y_i) of the pair.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.phase.jets import Jet
from jacobian import poly
from jacobian.element import Arithmetic, Real
from jacobian.poly import Poly


def padded(K: Arithmetic, a: Sequence[Real], size: int) -> Poly:
    """The first ``size`` coefficients of a polynomial, zeros included."""
    return (*a[:size], *[K.zero] * (size - len(a)))


def cofactor(K: Arithmetic, f: Poly, u: Poly, v: Poly) -> Poly:
    """The cofactor W = (f − V²)/U."""
    return poly.quotient(K, poly.sub(K, f, poly.mul(K, v, v)), u)


def multiplier(K: Arithmetic, u: Poly, direction: Sequence[Real]) -> Poly:
    """The multiplier n(x) = −Σ_j c_j (U div x^{j+1}) of a direction c."""
    size = len(u) - 1
    n = [K.zero] * size
    for j, c in enumerate(direction):
        for i in range(j + 1, size + 1):
            n[i - j - 1] = K.sub(n[i - j - 1], K.mul(c, u[i]))
    return tuple(n)


def rates(K: Arithmetic, f: Poly, u: Poly, v: Poly, direction: Sequence[Real]) -> tuple[Poly, Poly]:
    """(U', V') along a direction: U' = nV mod U, V' = −½nW mod U, n of :func:`multiplier`, W = (f − V²)/U."""
    size, n = len(u) - 1, multiplier(K, u, direction)
    of_u = poly.mod(K, poly.mul(K, n, v), u)
    twice = poly.mod(K, poly.mul(K, n, cofactor(K, f, u, v)), u)
    half = K.neg(K.inv(poly.integer(K, 2)))
    return (*padded(K, of_u, size), K.zero), padded(K, poly.scale(K, half, twice), size)


def generating_rates(K: Arithmetic, f: Poly, u: Poly, v: Poly, a: Real) -> tuple[Poly, Poly]:
    """(U', V') along the direction c_k = a^k: U' = [U(a)V − V(a)U]/(x − a), V' = [r(a)U − U(a)r]/(2(x − a)) with r = W
    mod U and the W of :func:`cofactor`.
    """
    size = len(u) - 1
    rest = poly.mod(K, cofactor(K, f, u, v), u)
    values = [poly.evaluate(K, b, a) for b in (u, v, rest)]
    factor = (K.neg(a), K.one)

    def alternating(x: Real, b: Poly, y: Real, d: Poly) -> Poly:
        pairs = zip(padded(K, b, size + 1), padded(K, d, size + 1), strict=True)
        top = tuple(K.sub(K.mul(x, p), K.mul(y, q)) for p, q in pairs)
        return padded(K, poly.quotient(K, top, factor), size)

    half = K.inv(poly.integer(K, 2))
    of_v = alternating(values[2], u, values[0], rest)
    return (*alternating(values[0], v, values[1], u), K.zero), poly.scale(K, half, of_v)


def lax_matrix(K: Arithmetic, f: Poly, u: Poly, v: Poly) -> tuple[tuple[Poly, Poly], tuple[Poly, Poly]]:
    """The Lax matrix L(x) = [[V, U], [W, −V]]; −det L = f."""
    return (v, u), (cofactor(K, f, u, v), poly.neg(K, v))


def lax_partner(K: Arithmetic, f: Poly, u: Poly, v: Poly, a: Real) -> tuple[tuple[Poly, Poly], tuple[Poly, Poly]]:
    """The matrix (x − a)M(x) = L(a) + U(a)(κ(x) − κ(a))E₂₁, κ = W div U, with the L of :func:`lax_matrix`.

    Along the direction c_k = a^k, 2L' = [L, M].
    """
    matrix = lax_matrix(K, f, u, v)
    at_a = [[poly.evaluate(K, entry, a) for entry in row] for row in matrix]
    slope = poly.quotient(K, matrix[1][0], u)
    correction = [K.mul(at_a[0][1], c) for c in slope]
    correction[0] = K.sub(correction[0], K.mul(at_a[0][1], poly.evaluate(K, slope, a)))
    corner = (K.add(at_a[1][0], correction[0]), *correction[1:])
    return ((at_a[0][0],), (at_a[0][1],)), (corner, (at_a[1][1],))


def brackets(K: Arithmetic, u: Poly, v: Poly, phi: Poly) -> tuple[tuple[Real, ...], ...]:
    """The brackets {u_i, v_j}, shape (g, g), for canonical x_i, p_j with y = φ(x)p; {u_i, u_j} = {v_i, v_j} = 0.

    {U(x), V(z)} = −[U(x)φ̂(z) − U(z)φ̂(x)]/(x − z), φ̂ = φ mod U.
    """
    size = len(u) - 1
    phi = padded(K, poly.mod(K, phi, u), size + 1)
    # the numerator of {U(x), V(z)} is Σ m_ij x^i z^j with m antisymmetric, and its quotient by x − z has the
    # coefficients q_ij = Σ_{k>i} m_{k, i+j+1−k}
    m = [[K.sub(K.mul(u[i], phi[j]), K.mul(u[j], phi[i])) for j in range(size + 1)] for i in range(size + 1)]
    table = []
    for i in range(size):
        row = []
        for j in range(size):
            total = K.zero
            for k in range(i + 1, min(size, i + j + 1) + 1):
                total = K.sub(total, m[k][i + j + 1 - k])
            row.append(total)
        table.append(tuple(row))
    return tuple(table)


def elementary(N: Arithmetic, name: str, x: Any) -> Any:
    """exp, expm1 or log of x over RR, MP, long numbers, balls, columns, or jets over one of these."""
    import math

    import gmpy2

    if isinstance(x, Jet):
        value = elementary(x.field.base, name, x.value)
        slope = {"exp": value, "expm1": value + 1}.get(name) or 1 / x.value
        return Jet(x.field, value, tuple([slope * s for s in x.slopes]))
    home = math if isinstance(x, float) else getattr(N, "context", gmpy2)
    return getattr(home, name)(x)
