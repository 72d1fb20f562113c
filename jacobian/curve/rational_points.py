"""Rational points of small height on a curve over QQ, by a sieve over small primes.

Let F = h² + 4f. Then x = a/b is the abscissa of a rational point exactly if b^(2g+2)·F(a/b), times a square that makes
it integral, is a square. If so, it is a square modulo every p. For each b and each prime the admissible a are stored as
the bits of an int, and the common bits of these ints are tried (the sieve of Elkies 2000 and of Stoll's ratpoints, with
Python's ints as rows of bits).
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import gcd, lcm

from jacobian.poly import Poly

PRIMES = (3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61)
"""The primes of the sieve. About half of the a pass at each prime, and one in 10^5 passes at all of them."""


def abscissas(F: Poly, degree: int, bound: int) -> Iterator[Fraction]:
    """The x = a/b with |a|, b ≤ ``bound`` for which b^degree·F(a/b) is a square, sorted by b, then by a. The even
    ``degree`` is at least deg F.
    """
    from gmpy2 import is_square

    square = lcm(*(c.denominator for c in F)) ** 2
    form = [int(c * square) for c in F] + [0] * (degree + 1 - len(F))
    sieves = [_rows(form, p, bound) for p in PRIMES]
    for b in range(1, bound + 1):
        # bit a + bound of an int stands for the numerator a
        passing = (1 << 2 * bound + 1) - 1
        for p, rows in zip(PRIMES, sieves, strict=True):
            passing &= rows[b % p]
        powers = [b ** (degree - i) for i in range(degree + 1)]
        while passing:
            last = passing & -passing
            passing ^= last
            a = last.bit_length() - 1 - bound
            if gcd(a, b) == 1 and is_square(sum(c * a**i * powers[i] for i, c in enumerate(form))):
                yield Fraction(a, b)


def _rows(form: list[int], p: int, bound: int) -> list[int]:
    """For b = 0, …, p − 1 an int whose bits are the a in −bound … bound for which Σ c_i a^i b^(degree − i) is a square
    modulo p; ``form`` has the c_i.
    """
    squares = {x * x % p for x in range(p)}
    values = [sum(c * pow(x, i, p) for i, c in enumerate(form)) % p in squares for x in range(p)]
    # for b = 0 the sum is c_degree·a^degree, and the degree is even
    rows = [_repeated([form[-1] % p in squares] * p, bound)]
    for b in range(1, p):
        inverse = pow(b, -1, p)
        rows.append(_repeated([values[(a - bound) * inverse % p] for a in range(p)], bound))
    return rows


def _repeated(pattern: list[bool], bound: int) -> int:
    """The int of 2·bound + 1 bits whose bit i is ``pattern`` at i modulo its length."""
    size, count = len(pattern), 2 * bound // len(pattern) + 1
    once = sum(1 << i for i, bit in enumerate(pattern) if bit)
    every = ((1 << size * count) - 1) // ((1 << size) - 1)
    return once * every & ((1 << 2 * bound + 1) - 1)
