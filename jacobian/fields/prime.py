"""GF(p) on Python integers in [0, p)."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from operator import mul
from typing import Any

from jacobian.errors import ArgumentError, FieldError, NotASquare, shown, whole, written
from jacobian.fields.coercion import rational, residue
from jacobian.fields.finite import FiniteField
from jacobian.fields.primality import is_prime, prime_power


class PrimeField(FiniteField):
    """GF(p); elements are ints in [0, p). Get one from :func:`jacobian.GF`."""

    degree = 1

    def __init__(self, p: int) -> None:
        self.p = self.order = self.characteristic = p
        self.name = f"GF({p})"

    def __repr__(self) -> str:
        return self.name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, PrimeField) and other.p == self.p

    def __hash__(self) -> int:
        return hash(("GF", self.p))

    def __reduce__(self) -> tuple[object, ...]:
        return prime_field, (self.p,)

    def coerce(self, value: object, argument: str = "value") -> int:
        """The residue of a rational number, as in :meth:`Field.coerce`, or an element of this field from galois,
        python-flint or PARI.
        """
        if type(value) is int:
            return value % self.p
        kind: Any = type(value)
        order = getattr(kind, "order", None)
        if order is not None and hasattr(kind, "irreducible_poly") and order != self.p:
            raise FieldError(f"{argument} = {written(value)} lies in {kind.name}, not in {self.name}")
        found = residue(value)
        if found is not None and found[1] != self.p:
            raise FieldError(f"{argument} = {written(value)} lies in GF({found[1]}), not in {self.name}")
        x = rational(value, argument) if found is None else found[0]
        if x is None:
            hint = "give an int, a Fraction or a string like '3/4'"
            raise FieldError(f"{argument} = {shown(value)} is not an element of {self.name}: {hint}")
        if x.denominator % self.p == 0:
            raise FieldError(f"{argument} = {shown(value)} has a denominator that is zero in {self.name}")
        return int(x.numerator if x.denominator == 1 else x.numerator * pow(x.denominator, -1, self.p)) % self.p

    def add(self, x: int, y: int) -> int:
        return (x + y) % self.p

    def sub(self, x: int, y: int) -> int:
        return (x - y) % self.p

    def mul(self, x: int, y: int) -> int:
        return x * y % self.p

    def neg(self, x: int) -> int:
        return -x % self.p

    def inv(self, x: int) -> int:
        if x == 0:
            raise ZeroDivisionError(f"1/0 in {self.name}")
        return pow(x, -1, self.p)

    def dot(self, xs: Sequence[int], ys: Sequence[int]) -> int:
        """Σ x_i y_i, reduced once."""
        total: int = sum(map(mul, xs, ys))
        return total % self.p

    def power(self, x: int, exponent: int) -> int:
        return pow(x, exponent, self.p)

    def sqrt(self, x: int) -> int:
        """One square root of x, or NotASquare."""
        if self.p % 4 != 3:
            return int(super().sqrt(x))
        root = pow(x, (self.p + 1) // 4, self.p)
        if root * root % self.p != x:
            raise NotASquare(f"{written(x)} is not a square in {self.name}")
        return root

    @cached_property
    def galois(self) -> Any:
        """The :mod:`galois` class of this field (galois is imported here and not before)."""
        import galois

        return galois.GF(self.p)

    # Polynomials on tuples of ints: the same results as the plain versions in jacobian.poly, several times faster
    # because a coefficient is reduced once and no method is called for an element.

    def poly_add(self, a: Sequence[int], b: Sequence[int]) -> tuple[int, ...]:
        p = self.p
        if len(a) < len(b):
            a, b = b, a
        total = [(x + y) % p for x, y in zip(a, b, strict=False)]
        if len(a) > len(b):
            return (*total, *a[len(b) :])
        return _trim(total)

    def poly_sub(self, a: Sequence[int], b: Sequence[int]) -> tuple[int, ...]:
        p = self.p
        total = [(x - y) % p for x, y in zip(a, b, strict=False)]
        if len(a) > len(b):
            return (*total, *a[len(b) :])
        if len(a) < len(b):
            return (*total, *[-y % p for y in b[len(a) :]])
        return _trim(total)

    def poly_mul(self, a: Sequence[int], b: Sequence[int]) -> tuple[int, ...]:
        if not a or not b:
            return ()
        p = self.p
        product = [0] * (len(a) + len(b) - 1)
        for i, x in enumerate(a):
            if x:
                for j, y in enumerate(b, i):
                    product[j] += x * y
        return tuple([c % p for c in product])

    def poly_divmod(self, a: Sequence[int], b: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...]]:
        if not b:
            raise ZeroDivisionError(f"division by the zero polynomial over {self.name}")
        p = self.p
        size = len(b) - 1
        steps = len(a) - size
        if steps <= 0:
            return (), tuple(a)
        rest = list(a)
        lead = 1 if b[-1] == 1 else pow(b[-1], -1, p)
        tail = b[:-1]
        quotient = [0] * steps
        for i in range(steps - 1, -1, -1):
            c = rest[i + size] * lead % p
            quotient[i] = c
            if c:
                for j, y in enumerate(tail, i):
                    rest[j] -= c * y
        return tuple(quotient), _trim([c % p for c in rest[:size]])


def _trim(a: list[int]) -> tuple[int, ...]:
    while a and not a[-1]:
        a.pop()
    return tuple(a)


LONG = 512
"""The largest number of bits of a number for which the error message names the next prime."""


prime_fields: dict[int, PrimeField] = {}
"""The fields made so far, by p."""


def prime_field(p: int) -> PrimeField:
    """GF(p) for a prime p, the same object each time."""
    return prime_fields.get(p) or prime_fields.setdefault(p, PrimeField(p))


def check_prime(value: Any) -> int:
    """The prime ``value`` as an int, or an ArgumentError that says what is wrong with it."""
    p = whole(value, "p", "GF takes a prime, or a galois field class")
    if is_prime(p):
        return p
    if p.bit_length() > LONG:
        # the message suggests no other number: finding a root of p, or the next prime, takes minutes
        raise ArgumentError(f"p = {shown(p)} is not prime: GF(p) needs a prime p")
    power = prime_power(p) if p > 3 else None
    if power:
        raise ArgumentError(f"p = {shown(p)} is not prime but a prime power: write GF({power[0]}, {power[1]})")
    following = max(p, 1) + 1
    while not is_prime(following):
        following += 1
    raise ArgumentError(f"p = {shown(p)} is not prime: GF(p) needs a prime p (the next one is {following})")
