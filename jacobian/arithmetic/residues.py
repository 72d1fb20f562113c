"""Hasse–Witt matrices of a curve over QQ at all primes of a list, and its L-polynomials modulo p.

Entry i, j of W_p is the coefficient of x^(ip−j) in F^((p−1)/2), 1 ≤ i, j ≤ g, F = h² + 4f, and L_p(T) ≡ det(1 − T·W_p)
modulo p (Manin 1961; Yui 1978). The first row, the coefficients of x^(p−1), …, x^(p−g), is computed for all primes
together (:mod:`jacobian.arithmetic.forest`, :mod:`jacobian.arithmetic.walk`). The first rows for g translates F(x + a)
give the other rows, because the matrix of F(x + a) is T(a)·W_p·T(−a) with T(a)_ij = C(j−1, i−1)·a^(j−i) (Harvey and
Sutherland 2016).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count, islice
from math import comb, lcm, prod
from typing import Any, NamedTuple

import numpy as np

from jacobian import poly
from jacobian.arithmetic.walk import Walks, last_coefficients
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields import QQ

PART = 4096
"""The largest number of primes whose walks are computed together."""


def integral_equation(C: HyperellipticCurve) -> list[int]:
    """The coefficients of F: h² + 4f times the square of the common denominator of f and h, divided by a power of 4.

    Modulo every odd p that does not divide the denominator, the curve y² = F(x) is isomorphic to the given one.
    """
    scale = lcm(*(c.denominator for c in (*C.f, *C.h)))
    F = [int(c * scale * scale) for c in C.discriminant]
    # factors 4 are squares and are removed; for h = 0 there is at least one, since F = 4f
    while all(c % 4 == 0 for c in F):
        F = [c // 4 for c in F]
    return F


def translations(F: Sequence[int], g: int) -> list[int]:
    """The g integers a of least size with F(a) ≠ 0."""
    candidates = (a for n in count() for a in {n, -n})
    return list(islice((a for a in candidates if sum(c * a**i for i, c in enumerate(F))), g))


def exceptions(F: Sequence[int], g: int) -> int:
    """The product of the values F(a) at the integers a of :func:`translations`, and of the differences of these a.

    :func:`hasse_witt` excludes 2 and the prime divisors of this product.
    """
    shifts = translations(F, g)
    values = (sum(c * a**i for i, c in enumerate(F)) for a in shifts)
    return prod(values) * prod(b - a for i, a in enumerate(shifts) for b in shifts[:i])


class Place(NamedTuple):
    """The progress of a run over all primes. The first ``done`` primes are finished.

    The first unfinished tree of :mod:`jacobian.arithmetic.forest` begins with block number ``block``. For each
    translate F(x + a) ``windows`` has the window, a row of coefficients, at the beginning of this tree.
    """

    done: int = 0
    block: int = 0
    windows: tuple[list[int], ...] = ()


class Part(NamedTuple):
    """The ``matrices`` W, (n, g, g), of the primes number ``first`` … ``last`` − 1, and the place to resume from."""

    first: int
    last: int
    matrices: Any
    place: Place


def hasse_witt(F: Sequence[int], g: int, primes: Any, block: int | None = None) -> Any:
    """W_p for an ascending int64 array of primes, none of which divides :func:`exceptions`: (N, g, g), entries 0 … p −
    1.

    ``block``: the number of integers in a block of the forest; the default takes the least time.
    """
    found = np.empty((len(primes), g, g), np.int64)
    for part in parts(F, g, primes, Place(), block):
        found[part.first : part.last] = part.matrices
    return found


def parts(F: Sequence[int], g: int, primes: Any, place: Place, block: int | None = None) -> Iterator[Part]:
    """Yields the matrices of :func:`hasse_witt` in parts of at most PART primes, from ``place`` on."""
    from jacobian.arithmetic import forest

    if not len(primes):
        return
    shifts = translations(F, g)
    moved = [[int(c) for c in poly.shift(QQ, tuple(map(QQ.coerce, F)), QQ.coerce(a))] for a in shifts]
    size = block or (forest.BLOCK if primes[-1] > forest.WALKED_TO else int(primes[-1]))
    numbers = primes.tolist()
    blocks = forest.blocks_of(numbers, size)[place.block :]
    behind = place.windows or (None,) * g
    ways = [forest.trees(f, numbers, blocks, window) for f, window in zip(moved, behind, strict=True)]
    for trees in zip(*ways, strict=True):
        for n, here in enumerate(blocks[: len(trees[0].windows)]):
            for first in range(max(here.first, place.done), here.last, PART):
                last = min(first + PART, here.last)
                p = primes[first:last]
                window = _reduced([tree.windows[n] for tree in trees], p)
                ends, product = last_coefficients(Walks(p, _ratios(moved, p), here.begin, window), g)
                rows = ends * _scale(moved, p, here.begin, product)[:, :, None] % p[:, None, None]
                place = place._replace(done=last)
                yield Part(first, last, _from_first_rows(rows, shifts, p), place)
        blocks = blocks[len(trees[0].windows) :]
        if blocks:
            place = Place(place.done, blocks[0].begin // size, tuple([int(c) for c in tree.behind] for tree in trees))


def _reduced(windows: list[list[Any]], p: Any) -> Any:
    """The windows, one for each of T translates, modulo each of N primes: (N, T, d)."""
    found = np.empty((len(p), len(windows), len(windows[0])), np.int64)
    for t, entries in enumerate(windows):
        for i, entry in enumerate(entries):
            found[:, t, i] = [int(entry % q) for q in p.tolist()]
    return found


def _ratios(moved: list[list[int]], p: Any) -> Any:
    """The ratios f_i/f_0 modulo p, i = d … 1, of each translate, (N, T, d)."""
    found = np.empty((len(p), len(moved), len(moved[0]) - 1), np.int64)
    for t, f in enumerate(moved):
        inverse = _inverses(modulo(f[0], p), p)
        for i, c in enumerate(f[:0:-1]):
            found[:, t, i] = modulo(c, p) * inverse % p
    return found


def _scale(moved: list[list[int]], p: Any, start: int, product: Any) -> Any:
    """c_0/((2f_0)^start·start!) modulo p, (N, T): the factors of the results of a walk that begins at ``start``.

    ``moved`` are the translates of F, f_0 is the constant coefficient of one, and c_0 = f_0^((p−1)/2). ``product`` is
    (p − 1)!/start! = −1/start! (Wilson).
    """
    found = np.empty((len(p), len(moved)), np.int64)
    for t, f in enumerate(moved):
        f0 = modulo(f[0], p)
        divisor = power(_inverses(2 * f0 % p, p), np.full_like(p, start), p)
        found[:, t] = power(f0, (p - 1) // 2, p) * divisor % p * (p - product) % p
    return found


def _from_first_rows(rows: Any, shifts: list[int], primes: Any) -> Any:
    """The matrices W from first rows r(a) for F(x + a), by interpolation: r(a)·T(a) = Σ a^(i−1)·(row i of W)."""
    g = len(shifts)
    moved = np.zeros_like(rows)
    p = primes[:, None]
    for t, a in enumerate(shifts):
        for j in range(g):
            for i in range(j + 1):
                moved[:, t, j] += rows[:, t, i] * modulo(comb(j, i) * a ** (j - i), primes) % primes
    found = np.zeros_like(rows)
    for t, a in enumerate(shifts):
        # Lagrange's interpolation: Π (x − b)/(a − b) over the other shifts b
        others = [b for b in shifts if b != a]
        scale = _inverses(modulo(prod(a - b for b in others), primes), primes)
        for i, c in enumerate(poly.from_roots(QQ, map(QQ.coerce, others))):
            found[:, i] += (modulo(int(c), primes) * scale % primes)[:, None] * (moved[:, t] % p) % p
    return found % p[:, None]


def modulo_p(matrices: Any, primes: Any) -> Any:
    """The coefficients a_1, …, a_g modulo p of det(1 − T·W), (N, g), 0 … p − 1 (Faddeev and Leverrier; p > g)."""
    g, p = matrices.shape[1], primes[:, None, None]
    one = np.eye(g, dtype=np.int64)
    found = np.empty((len(primes), g), np.int64)
    product = np.broadcast_to(one, matrices.shape)
    for k in range(1, g + 1):
        terms = matrices[:, :, :, None] * product[:, None] % p[..., None]
        product = terms.sum(axis=2) % p
        trace = np.trace(product, axis1=1, axis2=2) % primes
        found[:, k - 1] = -trace * _inverses(np.full_like(primes, k), primes) % primes
        product = (product + found[:, k - 1, None, None] * one) % p
    return found


# --- primes, and arrays of residues


def primes_up_to(bound: int) -> Any:
    """All primes p ≤ bound, int64 (Eratosthenes)."""
    sieve = np.ones(bound + 1, bool)
    sieve[:2] = False
    for n in range(2, int(bound**0.5) + 1):
        if sieve[n]:
            sieve[n * n :: n] = False
    return np.flatnonzero(sieve)


def modulo(c: int, p: Any) -> Any:
    """The integer c, of any size, modulo each p < 2^31."""
    if abs(c) < 1 << 62:
        return np.int64(c) % p
    total = np.zeros_like(p)
    for digit in range(abs(c).bit_length() // 30, -1, -1):
        total = ((total << 30) + (abs(c) >> 30 * digit & (1 << 30) - 1)) % p
    return total if c > 0 else -total % p


def power(a: Any, exponents: Any, p: Any) -> Any:
    """a^exponents modulo p < 2^31; all three are arrays."""
    result, a, exponents = np.ones_like(p), a % p, exponents.copy()
    while exponents.any():
        result = np.where(exponents & 1, result * a % p, result)
        a, exponents = a * a % p, exponents >> 1
    return result


def _inverses(a: Any, p: Any) -> Any:
    return power(a, p - 2, p)
