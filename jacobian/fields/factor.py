"""Factoring polynomials over finite fields: square-free, distinct-degree and equal-degree parts (Cantor and Zassenhaus
1981).
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import lcm
from random import Random
from typing import Any

from jacobian import poly
from jacobian.fields import GF, QQ
from jacobian.fields.primality import is_prime
from jacobian.poly import Poly


def factor(K: Any, a: Poly) -> list[tuple[Poly, int]]:
    """The monic irreducible factors of a monic polynomial over the finite field K with their multiplicities, sorted.

    The random choices inside are seeded by the polynomial: the result and the time are reproducible.
    """
    factors = []
    for part, multiplicity in _square_free(K, a):
        for degree, product in distinct_degrees(K, part):
            factors += [(P, multiplicity) for P in _equal_degrees(K, product, degree, Random(f"{part}"))]
    return sorted(factors, key=lambda item: (len(item[0]), item[0][::-1]))


def roots(K: Any, a: Poly) -> list[Any]:
    """The distinct roots in K of a non-zero polynomial, sorted."""
    a = poly.monic(K, a)
    return sorted(K.neg(P[0]) for P in _equal_degrees(K, linear_part(K, a), 1, Random(f"{a}")))


def rational_roots(a: Poly) -> list[Fraction]:
    """The distinct rational roots of a non-zero polynomial over QQ, sorted.

    With integral coefficients of size up to H and leading one c, c·root is an integer below 2H in size: it is found
    modulo a prime above 4H, and tried.
    """
    integral = [int(c * lcm(*(c.denominator for c in a))) for c in a]
    lead, height = integral[-1], max(map(abs, integral))
    p = 4 * height + 1
    while not is_prime(p):
        p += 2
    K = GF(p)
    candidates = [lead * x % p for x in roots(K, tuple(c % p for c in integral))]
    found = [Fraction(m if 2 * m < p else m - p, lead) for m in candidates]
    return sorted(x for x in found if poly.evaluate(QQ, a, x) == 0)


def roots_in(K: Any, a: Poly) -> list[Any]:
    """The distinct roots in K, a finite field or QQ, of a non-zero polynomial, sorted."""
    if len(a) == 1:
        return []
    return rational_roots(a) if K.order is None else roots(K, a)


def without_root(K: Any, a: Poly, x: Any) -> tuple[int, Poly]:
    """How often x is a root of a non-zero polynomial, and what is left of that without it."""
    line, multiplicity = (K.neg(x), K.one), 0
    while poly.evaluate(K, a, x) == K.zero:
        a, multiplicity = poly.quotient(K, a, line), multiplicity + 1
    return multiplicity, a


def linear_part(K: Any, a: Poly) -> Poly:
    """gcd(x^q − x, a): the product of the distinct linear factors of a."""
    x = (K.zero, K.one)
    return poly.gcd(K, poly.sub(K, poly.power_mod(K, x, K.order, a), x), a)


def _square_free(K: Any, a: Poly) -> list[tuple[Poly, int]]:
    """(part, multiplicity) with square-free coprime parts whose powers multiply to a (Yun's scheme in characteristic
    p).
    """
    parts = []
    common = poly.gcd(K, a, poly.derivative(K, a))
    rest = poly.quotient(K, a, common)
    multiplicity = 1
    while len(rest) > 1:
        shared = poly.gcd(K, rest, common)
        part = poly.quotient(K, rest, shared)
        if len(part) > 1:
            parts.append((part, multiplicity))
        rest, common = shared, poly.quotient(K, common, shared)
        multiplicity += 1
    if len(common) > 1:
        # what is left is a polynomial in x^p: its p-th root has the p-th roots of the coefficients
        p = K.characteristic
        root = tuple(K.power(c, K.order // p) for c in common[::p])
        parts += [(part, p * e) for part, e in _square_free(K, root)]
    return parts


def distinct_degrees(K: Any, a: Poly) -> Iterator[tuple[int, Poly]]:
    """(d, product of the irreducible factors of degree d) of a square-free monic a, d ascending."""
    x = (K.zero, K.one)
    power, degree = x, 0
    while len(a) > 1:
        degree += 1
        if 2 * degree > len(a) - 1:
            yield len(a) - 1, a
            return
        power = poly.power_mod(K, power, K.order, a)
        product = poly.gcd(K, poly.sub(K, power, x), a)
        if len(product) > 1:
            yield degree, product
            a = poly.quotient(K, a, product)
            power = poly.mod(K, power, a)


def _equal_degrees(K: Any, a: Poly, degree: int, rng: Random) -> list[Poly]:
    """The irreducible factors of a, all of them of this degree."""
    if len(a) - 1 <= degree:
        return [a] if len(a) > 1 else []
    while True:
        trial = poly.random(K, len(a) - 1, rng)
        part = poly.gcd(K, _splitting_power(K, trial, degree, a), a)
        if 1 < len(part) < len(a):
            other = poly.quotient(K, a, part)
            return _equal_degrees(K, part, degree, rng) + _equal_degrees(K, other, degree, rng)


def _splitting_power(K: Any, trial: Poly, degree: int, a: Poly) -> Poly:
    """A function of ``trial`` that vanishes on about half of the factors: t^((q^d−1)/2) − 1, or the trace to GF(2)."""
    if K.characteristic != 2:
        return poly.sub(K, poly.power_mod(K, trial, (K.order**degree - 1) // 2, a), (K.one,))
    total = power = poly.mod(K, trial, a)
    for _ in range((K.order.bit_length() - 1) * degree - 1):
        power = poly.mod(K, poly.mul(K, power, power), a)
        total = poly.add(K, total, power)
    return total
