"""Irreducible polynomials over GF(p): a test, and the default modulus of GF(p^k)."""

from __future__ import annotations

import ctypes
from contextlib import suppress
from functools import cache
from typing import Any

from jacobian import poly
from jacobian.errors import Infeasible, shown
from jacobian.fields.primality import prime_factors
from jacobian.fields.prime import PrimeField

MOST_DEGREE, LOW_DEGREE = 1000, 12
MOST_WORK = 10**10
"""The largest k³ log₂ p; beyond it the search for a polynomial takes minutes (25 s for k = 1000, p = 3)."""


def is_irreducible(K: PrimeField, m: poly.Poly) -> bool:
    """Whether m is irreducible over K, by flint, or, in low degree, by Rabin's test (1980) without loading flint."""
    degree = len(m) - 1
    if degree > LOW_DEGREE:
        return bool(prime_ring(K.p)(list(m)).is_irreducible())
    x = poly.mod(K, (K.zero, K.one), m)
    needed = {degree // q for q in prime_factors(degree)}
    power = x
    for i in range(1, degree + 1):
        power = poly.power_mod(K, power, K.order, m)
        if i in needed and len(poly.gcd(K, poly.sub(K, power, x), m)) > 1:
            return False
    return power == x


@cache
def default_modulus(base: PrimeField, k: int) -> tuple[int, ...]:
    """The default modulus: galois's Conway polynomial, or the first irreducible polynomial where its table has none.

    Raises Infeasible if k > MOST_DEGREE, or if the search would take minutes.
    """
    if k > MOST_DEGREE:
        raise Infeasible(
            f"k = {shown(k)}: no irreducible polynomial is looked for beyond degree {MOST_DEGREE}; give a modulus"
        )
    # galois's table has no p near 64 bits, and its look-up fails there
    if base.p.bit_length() < 64:
        with suppress(LookupError):
            return _conway(base.p, k)
    if k**3 * base.p.bit_length() > MOST_WORK:
        raise Infeasible(
            f"k = {k}: to look for an irreducible polynomial over GF(p), p of {base.p.bit_length()} bits, takes "
            "minutes or hours; give a modulus"
        )
    return first_irreducible(base, k)


def _conway(p: int, k: int) -> tuple[int, ...]:
    """The Conway polynomial of galois's table; LookupError where it has none."""
    import galois

    try:
        # galois.conway_poly compiles arithmetic of GF(p) before it returns, which takes a second for each p
        from galois._databases import ConwayPolyDatabase
    except ImportError:
        return tuple(int(c) for c in galois.conway_poly(p, k).coeffs[::-1])
    found = dict(zip(*ConwayPolyDatabase().fetch(p, k), strict=True))
    return tuple(found.get(i, 0) for i in range(k + 1))


def first_irreducible(base: PrimeField, k: int) -> tuple[int, ...]:
    """The irreducible polynomial x^k + Σ c_i x^i, i < k, with the least Σ c_i p^i > 0."""
    from jacobian.progress import Progress

    # x^k + c is irreducible for some c only if each prime factor of k divides p − 1, and 4 too if it divides k (Lidl
    # and Niederreiter 1997, theorem 3.75); otherwise the search would try all p values of c in vain
    hopeful = all((base.p - 1) % q == 0 for q in prime_factors(k)) and (k % 4 != 0 or base.p % 4 == 1)
    number = 1 if hopeful else base.p
    # about one polynomial in k is irreducible, so k trials are expected, however many were made before
    progress = Progress(f"an irreducible polynomial of degree {k} over {base.name}", k)
    while not is_irreducible(base, found := (*(number // base.p**i % base.p for i in range(k)), 1)):
        number += 1
        progress.work += 1
        progress.add(1)
    return found


@cache
def prime_ring(p: int) -> Any:
    """python-flint's ring of polynomials over GF(p)."""
    import flint

    return kept(flint.fmpz_mod_poly_ctx(p))


def kept(ring: Any) -> Any:
    """``ring``, which from now on is never freed. python-flint (0.9) crashes if a polynomial and its ring are collected
    together, in a cycle or when Python ends, and the ring is freed first.
    """
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(ring))
    return ring
