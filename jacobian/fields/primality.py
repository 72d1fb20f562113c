"""Primality of machine integers and beyond: Miller–Rabin, deterministic below 3.3e24.

Sources: Miller 1976, Rabin 1980; the bases are those of Sorenson and Webster, "Strong pseudoprimes to twelve prime
bases" (2017): the first 13 primes decide every n < 3317044064679887385961981. Above this bound gmpy2 runs the test of
Baillie and Wagstaff, "Lucas pseudoprimes" (1980): a strong test to the base 2 and a strong Lucas test. It is not
proven, but no composite is known to pass it.
"""

from __future__ import annotations

from math import isqrt

_PRIMES = (
    2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89, 97, 101, 103, 107, 109,
    113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173,
)  # fmt: skip
_PROVEN_BELOW = 3317044064679887385961981


def is_prime(n: int) -> bool:
    """Whether n is prime (proven below 3.3e24, by Baillie and Wagstaff's test beyond)."""
    if n < 2:
        return False
    for prime in _PRIMES:
        if n % prime == 0:
            return n == prime
    from gmpy2 import is_strong_bpsw_prp, is_strong_prp

    if n < _PROVEN_BELOW:
        return all(is_strong_prp(n, base) for base in _PRIMES[:13])
    return bool(is_strong_bpsw_prp(n))


def prime_factors(n: int) -> list[int]:
    """The distinct primes that divide n, by trial division: for n below about 1e12."""
    factors = []
    candidate = 2
    while candidate <= isqrt(n):
        if n % candidate == 0:
            factors.append(candidate)
            while n % candidate == 0:
                n //= candidate
        candidate += 1 if candidate == 2 else 2
    return [*factors, n] if n > 1 else factors


def prime_power(n: int) -> tuple[int, int] | None:
    """(p, k) with n = p^k and p prime, or None."""
    from gmpy2 import iroot

    for k in range(n.bit_length(), 0, -1):
        root, exact = iroot(n, k)
        if exact and is_prime(int(root)):
            return int(root), k
    return None
