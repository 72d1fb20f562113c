"""Factoring integers: trial division, then Pollard's rho (Pollard 1975; Brent 1980 for the cycle).

Written out here rather than taken from python-flint, so that orders come out alike with and without it. A prime factor
of up to 12 digits takes about a second; what is not found within the limit is an Infeasible with the cofactor, and
every function that needs a factorisation lets the caller hand it in.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import gcd, prod

from jacobian.errors import ArgumentError, Infeasible, entries, shown, whole
from jacobian.fields.primality import is_prime

TRIAL_LIMIT = 2000
RHO_STEPS = 1 << 22
_BATCH = 128


def factorization(n: int, primes: Iterable[int] | None = None) -> dict[int, int]:
    """{prime: exponent} of n > 0, ascending. ``primes``: the prime factors, where they are known."""
    if n < 1:
        raise ArgumentError(f"n = {n}: a positive integer is factored")
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
    if is_prime(n):
        return [n]
    for seed in range(1, 20):
        divisor = _rho(n, seed)
        if 1 < divisor < n:
            return _prime_factors(divisor) + _prime_factors(n // divisor)
    raise AssertionError(f"no factor of the composite {n} in 20 walks")


def _rho(n: int, c: int) -> int:
    """A divisor of n met by x → x² + c, possibly n itself; Infeasible after RHO_STEPS steps."""
    x = y = saved = 2
    length, divisor, steps = 1, 1, 0
    while divisor == 1:
        x = y
        for _ in range(length):
            y = (y * y + c) % n
        done = 0
        while done < length and divisor == 1:
            saved, product = y, 1
            for _ in range(min(_BATCH, length - done)):
                y = (y * y + c) % n
                product = product * (x - y) % n
            divisor = gcd(product, n)
            done += _BATCH
        steps += length
        length *= 2
        if steps > RHO_STEPS and divisor == 1:
            raise Infeasible(
                f"{n} is composite and has no factor that {RHO_STEPS} steps of Pollard's rho find (about 12 digits): "
                "give its prime factors, if they are known"
            )
    return divisor if divisor < n else _slowly(n, c, x, saved)


def _slowly(n: int, c: int, x: int, y: int) -> int:
    """The last batch again, one step at a time: it ran over the end of the cycle."""
    divisor = 1
    while divisor == 1:
        y = (y * y + c) % n
        divisor = gcd(x - y, n)
    return divisor


def value(factors: dict[int, int]) -> int:
    """Π prime^exponent."""
    return prod(prime**exponent for prime, exponent in factors.items())
