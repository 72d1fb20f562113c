"""Primality of machine integers and beyond: Miller–Rabin, deterministic below 3.3e24.

Sources: Miller 1976, Rabin 1980; the bases are those of Sorenson and Webster, "Strong pseudoprimes to twelve prime
bases" (2017): the first 13 primes decide every n < 3317044064679887385961981. Above it the test is that of Baillie and
Wagstaff, "Lucas pseudoprimes" (1980), strong to the base 2 and strong Lucas: not proven, but no composite is known to
pass it. gmpy2 multiplies long numbers where it is installed.
"""

from __future__ import annotations

from math import isqrt
from typing import Any

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
    if n < _PROVEN_BELOW:
        return all(_is_strong_probable_prime(n, base) for base in _PRIMES[:13])
    n = _long(n)
    return _is_strong_probable_prime(n, 2) and _is_strong_lucas_prime(n)


def _long(n: int) -> Any:
    """n as a number of gmpy2, where that is installed."""
    try:
        from gmpy2 import mpz
    except ImportError:
        return n
    return mpz(n)


def _is_strong_lucas_prime(n: Any) -> bool:
    """Whether n, odd, is a strong Lucas probable prime for Selfridge's parameters: the first D of 5, −7, 9, … with
    (D/n) = −1, P = 1, Q = (1 − D)/4. With n + 1 = d·2^s: U_d = 0 or V_(d·2^r) = 0 for some r < s.
    """
    if isqrt(n) ** 2 == n:
        return False
    D = 5
    while (symbol := _jacobi(D, n)) != -1:
        if symbol == 0 and abs(D) % n:
            return False
        D = -D - 2 if D > 0 else -D + 2
    Q = (1 - D) // 4
    twos = ((n + 1) & -(n + 1)).bit_length() - 1
    U, V, power = 0, 2, 1
    for bit in bin((n + 1) >> twos)[2:]:
        U, V, power = U * V % n, (V * V - 2 * power) % n, power * power % n
        if bit == "1":
            U, V, power = U + V, V + D * U, power * Q % n
            U, V = (U if U % 2 == 0 else U + n) // 2 % n, (V if V % 2 == 0 else V + n) // 2 % n
    if U == 0:
        return True
    for _ in range(twos):
        if V == 0:
            return True
        V, power = (V * V - 2 * power) % n, power * power % n
    return False


def _jacobi(a: int, n: Any) -> int:
    """The Jacobi symbol (a/n) of an odd n > 0."""
    a, sign = a % n, 1
    while a:
        while a % 2 == 0:
            a //= 2
            if n % 8 in (3, 5):
                sign = -sign
        a, n = n, a
        if a % 4 == 3 and n % 4 == 3:
            sign = -sign
        a %= n
    return sign if n == 1 else 0


def _is_strong_probable_prime(n: Any, base: int) -> bool:
    twos = ((n - 1) & (1 - n)).bit_length() - 1
    x = pow(base, (n - 1) >> twos, n)
    if x in (1, n - 1):
        return True
    for _ in range(twos - 1):
        x = x * x % n
        if x == n - 1:
            return True
    return False


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
    for k in range(n.bit_length(), 0, -1):
        root = _integer_root(n, k)
        if root**k == n and is_prime(root):
            return root, k
    return None


def _integer_root(n: int, k: int) -> int:
    low, high = 1, 1 << (n.bit_length() // k + 1)
    while low < high:
        middle = (low + high + 1) // 2
        if middle**k <= n:
            low = middle
        else:
            high = middle - 1
    return low
