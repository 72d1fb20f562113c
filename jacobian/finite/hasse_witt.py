"""The characteristic polynomial of Frobenius modulo p, from the Cartier–Manin matrix (odd characteristic).

For y² = F(x) the matrix has the coefficients of x^(ip−j) in F^((p−1)/2), 1 ≤ i, j ≤ g (Manin 1961; Yui 1978). Over
extension fields and for small p python-flint raises F to that power. For larger p the coefficients of the power
follow from each other by a linear recurrence (Bostan, Gaudry and Schost 2007). The recurrence divides by the exponent
of x, and so ends before x^p. It gives the coefficients with i = 1 in O(g·p) operations, or, over GF(p) with p > 2^20,
in Õ(√p) by :mod:`jacobian.finite.matrix_products`. The coefficients with i = 1 of g translates F(x + a) determine the
matrix (Harvey and Sutherland 2016).
"""

from __future__ import annotations

from functools import cache
from itertools import islice
from math import comb
from typing import Any

from jacobian import poly
from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import FieldError, Infeasible
from jacobian.fields.factor import roots
from jacobian.fields.flint_polynomials import conversions
from jacobian.linear import echelon
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.words import inverse_modulo

COMPILED_FROM = 20_000
"""Above this p the compiled recurrence is used over GF(p). At this p it takes as long as the power of F, a few
milliseconds in genus 2.
"""
WORD_SAFE = 1 << 29
"""Below this p the recurrence runs on machine integers."""
PRODUCTS_FROM, PRODUCTS_TO, PRODUCTS_DEGREE = 1 << 20, 1 << 49, 20
"""The range of p, and the largest degree of F, for products of matrices. Products are cheaper than the recurrence from
about p = 3·10^5 on, but their first use compiles for half a second.
"""
PLAIN_TO = 10**7
"""The largest p for which F is raised to the power (p − 1)/2, in ten seconds and hundreds of megabytes."""


def frobenius_modulo_p(C: HyperellipticCurve) -> list[int] | None:
    """The coefficients a_1 … a_g modulo p of χ(T) = T^2g + a_1 T^(2g−1) + …, or None in characteristic 2.

    χ(T) ≡ T^g · det(T − A·A^(p)·…·A^(q/p)) for the Cartier–Manin matrix A.
    """
    K: Any = C.field
    if K.characteristic == 2:
        return None
    matrix = cartier_manin(_of_odd_degree(C) if K.characteristic > PRODUCTS_FROM else C)
    norm = factor = matrix
    power = K.characteristic
    while power < K.order:
        factor = [[K.power(entry, K.characteristic) for entry in row] for row in factor]
        columns = list(zip(*factor, strict=True))
        norm = [[K.dot(row, column) for column in columns] for row in norm]
        power *= K.characteristic
    return [int(c) for c in _characteristic_polynomial(K, norm)]


def _of_odd_degree(C: HyperellipticCurve) -> HyperellipticCurve:
    """A curve isomorphic to C whose F has a root at infinity, if F has a rational root, else C.

    With a root at infinity F has the degree 2g + 1 in place of 2g + 2. This degree is the size of the matrices of
    :mod:`jacobian.finite.matrix_products`.
    """
    K, F = C.field, C.discriminant
    zeros = roots(K, F) if len(F) == 2 * C.genus + 3 else []
    return HyperellipticCurve(K, poly.shift(K, F, zeros[0])[::-1]) if zeros else C


def cartier_manin(C: HyperellipticCurve) -> list[list[Any]]:
    """The matrix A_ji = coefficient of x^(ip−j) in F^((p−1)/2), F = h² + 4f."""
    K: Any = C.field
    if K.order is None or K.characteristic == 2:
        raise FieldError(f"field = {K.name}: the Cartier–Manin matrix is that of a finite field of odd characteristic")
    g, p = C.genus, C.field.characteristic
    # in the coordinates x and 2y + h the curve is y² = F; Frobenius has the same characteristic polynomial
    F = C.discriminant
    limit = PRODUCTS_TO if len(F) <= PRODUCTS_DEGREE + 1 else WORD_SAFE
    if COMPILED_FROM < K.order == p < limit and not interpreted():
        return _by_translations(K, F, g)
    if p > PLAIN_TO:
        raise Infeasible(
            f"field = {K.name}: the Cartier–Manin matrix is computed up to p = 2^{PRODUCTS_TO.bit_length() - 1} "
            f"over GF(p), deg F ≤ {PRODUCTS_DEGREE}, where functions are compiled, and up to p = {PLAIN_TO} elsewhere"
        )
    into, back = conversions(K)
    power = into(F) ** ((p - 1) // 2)
    # over GF(p) the few coefficients that are needed are converted one by one
    extended = None if K.order == p else back(power)
    return [
        [
            int(power[k]) if extended is None else extended[k] if k < len(extended) else K.zero
            for k in range(p - j, g * p, p)
        ]
        for j in range(1, g + 1)
    ]


def _by_translations(K: Any, F: poly.Poly, g: int) -> list[list[Any]]:
    """The Cartier–Manin matrix A over GF(p) from the first columns of the matrices of g translates F(x + a).

    A translation x → x + a maps A to B⁻¹·A·B^(p) with the binomial matrix B_jk = C(j−1, k−1)a^(j−k), so that
    A·(a^(p(j−1)))_j = B·(first column of the translate's matrix).
    """
    # F has at most 2g + 2 roots, fewer than p, and the first column needs F(a) ≠ 0
    shifts = islice((a for a in range(K.order) if poly.evaluate(K, F, a)), g)
    rows = []
    for i, a in enumerate(shifts):
        column = _first_column(K, poly.shift(K, F, a), g, i)
        binomial = ([comb(j, k) * a ** (j - k) % K.order for k in range(j + 1)] for j in range(g))
        powers = [K.power(a, K.order * j) for j in range(g)]
        rows.append(powers + [K.dot(row, column[: len(row)]) for row in binomial])
    # the rows are [V | W] with V·Aᵀ = W, where V, the matrix of powers, is invertible for g distinct a
    transposed = (row[g:] for _, row in sorted(echelon(K, rows, g)))
    return [list(row) for row in zip(*transposed, strict=True)]


def _first_column(K: Any, F: poly.Poly, g: int, index: int) -> list[Any]:
    """The coefficients of x^(p−1), …, x^(p−g) in F^((p−1)/2), F(0) ≠ 0, for number ``index`` of g polynomials F."""
    p = K.characteristic
    start = K.power(F[0], (p - 1) // 2)
    ratios = [K.div(c, F[0]) for c in F[1:]]
    if PRODUCTS_FROM < p < PRODUCTS_TO and len(ratios) <= PRODUCTS_DEGREE:
        from jacobian.finite.matrix_products import Products, compiled

        compiled()
        return Products(p, ratios, (index, g)).last(start, g)
    import numpy as np

    window = np.zeros(max(len(ratios), g), np.int64)
    window[0] = start
    weights = [i * (p + 1) // 2 * c % p for i, c in enumerate(ratios, 1)]
    library().recurrence_on_words(
        np.array(ratios, np.int64), p, np.array(weights, np.int64), np.empty(256, np.int64), window
    )
    return [int(c) for c in window[:g]]


def recurrence_on_words(ratios: Any, p: int, weights: Any, inverses: Any, window: Any) -> None:
    """Writes the coefficients G_(p−1), G_(p−2), … of G = F^n, n = (p−1)/2, into ``window``; ``ratios``: f_i/f_0, i ≥ 1.

    F·G' = n·F'·G implies k·f_0·G_k = Σ ((n+1)i − k) f_i G_(k−i). The sum is kept below 8p², and with one more product
    below 9p² < 2^63 for p < 2^29. On entry ``window`` is (G_0, 0, …), and ``weights`` are ((n+1)i − k)·f_i/f_0 for
    k = 0; each step in k subtracts f_i/f_0. ``inverses`` is scratch for a block of 1/k, computed by one inversion
    (Montgomery 1987).
    """
    start, room = 1, 8 * p * p
    while start < p:
        size = min(len(inverses), p - start)
        invert_range(start, size, p, inverses)
        for j in range(size):
            total = 0
            for i in range(len(ratios)):
                weights[i] += p - ratios[i] if weights[i] < ratios[i] else -ratios[i]
                total += weights[i] * window[i]
                if total >= room:
                    total -= room
            for i in range(len(window) - 1, 0, -1):
                window[i] = window[i - 1]
            window[0] = total % p * inverses[j] % p
        start += size


def invert_range(start: int, size: int, p: int, inverses: Any) -> None:
    """Writes 1/start, 1/(start + 1), … modulo p into ``inverses``, ``size`` numbers."""
    total = 1
    for j in range(size):
        inverses[j] = total
        total = total * (start + j) % p
    back = inverse_modulo(total, p) % p
    for j in range(size - 1, -1, -1):
        inverses[j] = back * inverses[j] % p
        back = back * (start + j) % p


@cache
def library() -> Any:
    """The loops of this module, compiled."""
    from jacobian.native.kinds import INT, INTS
    from jacobian.native.library import Library

    entries = {"recurrence_on_words": (recurrence_on_words, (INTS, INT, INTS, INTS, INTS))}
    return Library("Cartier-Manin", entries)


def _characteristic_polynomial(K: Any, matrix: list[list[Any]]) -> list[Any]:
    """c_1 … c_g of det(T − M) = T^g + c_1 T^(g−1) + …, without divisions (Berkowitz 1984)."""
    coefficients = [K.one]
    for size in range(1, len(matrix) + 1):
        corner, row = matrix[size - 1][size - 1], matrix[size - 1][: size - 1]
        column = [matrix[i][size - 1] for i in range(size - 1)]
        block = [r[: size - 1] for r in matrix[: size - 1]]
        toeplitz = [K.one, K.neg(corner)]
        for _ in range(size - 1):
            toeplitz.append(K.neg(K.dot(row, column)))
            column = [K.dot(r, column) for r in block]
        coefficients = [
            K.dot(toeplitz[max(0, i - size + 1) : i + 1], coefficients[: min(i, size - 1) + 1][::-1])
            for i in range(size + 1)
        ]
    return coefficients[1:]
