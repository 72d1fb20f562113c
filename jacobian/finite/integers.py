"""Factoring integers: by trial division, then by python-flint. Its quadratic sieve splits numbers of up to
MOST_COMPOSITE bits, elliptic curves split longer ones. Infeasible names the cofactor that was not split. Every function
that needs a factorization accepts the prime factors from the caller.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import prod
from typing import Any

from jacobian.errors import ArgumentError, Infeasible, entries, shown, whole, written
from jacobian.fields.primality import is_prime

TRIAL_LIMIT = 2000
MOST_COMPOSITE = 176
"""The largest number of bits of a number that the quadratic sieve factors, in a second."""
SMOOTH, SMOOTH_IF_SHORT, SHORT = (16, 24, 32), (40,), 600
"""The sizes in bits of the factors that successive calls look for; those of SMOOTH_IF_SHORT only in numbers of at most
SHORT bits. A call cannot be interrupted, so these limits keep it within a second.
"""
LONGEST = 4096
"""The largest number of bits of a number to factor."""


def factorization(n: int, primes: Iterable[int] | None = None) -> dict[int, int]:
    """The factorization {prime: exponent} of n > 0, primes ascending. ``primes``: the prime factors, if known."""
    if n < 1:
        raise ArgumentError(f"n = {shown(n)}: a positive integer is factored")
    found: dict[int, int] = {}
    if primes is not None:
        wanted = f"the prime factors of {shown(n)}, all of them,"
        given = entries(primes, "primes", wanted)
        chosen = {whole(p, f"primes = {shown(given)}: entry", f"{wanted} are needed") for p in given}
        rest = _divide_out(n, sorted(chosen), found)
        if rest != 1 or not all(map(is_prime, found)):
            raise ArgumentError(f"primes = {shown(sorted(chosen))}: {wanted} are needed")
        return found
    rest = _divide_out(n, range(2, TRIAL_LIMIT), found)
    for prime in _prime_factors(rest):
        found[prime] = found.get(prime, 0) + 1
    return dict(sorted(found.items()))


def _divide_out(n: int, candidates: Iterable[int], found: dict[int, int]) -> int:
    for candidate in candidates:
        while candidate > 1 and n % candidate == 0:
            found[candidate] = found.get(candidate, 0) + 1
            n //= candidate
    return n


def _prime_factors(n: int) -> list[int]:
    """The prime factors of n with repetitions."""
    if n == 1:
        return []
    from flint import fmpz

    if n.bit_length() <= MOST_COMPOSITE:
        return _of_flint(fmpz(n).factor())
    if n.bit_length() > LONGEST:
        raise Infeasible(f"{shown(n)}: numbers of more than {LONGEST} bits are not factored; give its prime factors")
    if is_prime(n):
        return [n]
    for bits in SMOOTH if n.bit_length() > SHORT else (*SMOOTH, *SMOOTH_IF_SHORT):
        found = _of_flint(fmpz(n).factor_smooth(bits))
        if len(found) > 1:
            return [q for p in found for q in ([p] if is_prime(p) else _prime_factors(p))]
    raise Infeasible(
        f"{written(n)} is composite, of {n.bit_length()} bits, and has no factor that elliptic curves find soon (about "
        "12 digits): give its prime factors, if they are known"
    )


def _of_flint(factors: list[tuple[Any, int]]) -> list[int]:
    return [int(p) for p, e in factors for _ in range(e)]


def value(factors: dict[int, int]) -> int:
    """The number Π prime^exponent with this factorization."""
    return prod(prime**exponent for prime, exponent in factors.items())
