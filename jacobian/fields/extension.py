"""GF(p^k) on Python integers: Σ c_i p^i stands for Σ c_i a^i, as in :mod:`galois`.

The operations are in :mod:`jacobian.fields.table` up to 2^16 elements and in :mod:`jacobian.fields.digits` beyond.
Neither needs galois: it is imported for the default modulus (its Conway polynomials) and for
:attr:`ExtensionField.galois`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from itertools import count
from typing import Any

from jacobian import poly
from jacobian.errors import ArgumentError, FieldError, Infeasible, shown
from jacobian.fields.coercion import rational
from jacobian.fields.finite import FiniteField
from jacobian.fields.primality import prime_factors
from jacobian.fields.prime import PrimeField

# a search of minutes already
MOST_DEGREE = 1000


class ExtensionField(FiniteField):
    """GF(p^k) with k > 1; elements are ints in [0, p^k). Get one from :func:`jacobian.GF`."""

    zero = 0
    one = 1

    def __init__(self, base: PrimeField, modulus: tuple[int, ...]) -> None:
        self.base = base
        self.p = self.characteristic = base.p
        self.degree = len(modulus) - 1
        self.order = self.p**self.degree
        self.modulus = modulus
        self.name = f"GF({self.p}^{self.degree}, {poly.text(base, modulus, 'a')})"

    def __repr__(self) -> str:
        return self.name

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ExtensionField) and (other.p, other.modulus) == (self.p, self.modulus)

    def __hash__(self) -> int:
        return hash(("GF", self.p, self.modulus))

    def __reduce__(self) -> Any:
        return extension_field, (type(self), self.base, self.modulus)

    def coerce(self, value: Any, argument: str = "value") -> int:
        """A whole number in [0, p^k), ascending coefficients [c0, c1, …] of a, or a galois scalar of this field; else
        FieldError. Fractions are coefficients: [1/2] is the inverse of 2.
        """
        if hasattr(type(value), "irreducible_poly") and hasattr(type(value), "order"):
            return self._coerce_galois(value, argument)
        if isinstance(value, (list, tuple)):
            if len(value) > self.degree:
                raise FieldError(
                    f"{argument} = {shown(value)} has more than {self.degree} coefficients, those of {self.name}"
                )
            return self._pack([self.base.coerce(c, f"{argument}[{i}]") for i, c in enumerate(value)])
        x = rational(value, argument)
        if x is None or x.denominator != 1:
            hint = "give an int or a list of ascending coefficients"
            raise FieldError(f"{argument} = {shown(value)} is not an element of {self.name}: {hint}")
        if 0 <= x < self.order:
            return int(x)
        raise FieldError(
            f"{argument} = {shown(value)} is not an element of {self.name}: the ints 0 … {self.order - 1} are"
        )

    def _coerce_galois(self, value: Any, argument: str) -> int:
        kind = type(value)
        if value.ndim:
            return self.coerce(value.tolist(), argument)
        if kind.order != self.p and (kind.order != self.order or galois_modulus(kind) != self.modulus):
            raise FieldError(f"{argument} = {value} lies in {kind.name}, not in {self.name}")
        return int(value)

    def element(self, index: int) -> int:
        return index

    def coefficients(self, x: int) -> list[int]:
        """The k ascending coefficients of x as a polynomial in a."""
        digits = []
        for _ in range(self.degree):
            x, digit = divmod(x, self.p)
            digits.append(digit)
        return digits

    def _pack(self, digits: Sequence[int]) -> int:
        x = 0
        for digit in reversed(digits):
            x = x * self.p + digit
        return x

    @cached_property
    def galois(self) -> Any:
        """The :mod:`galois` class of this field (galois is imported here, and it may factor p^k − 1)."""
        import galois

        base = galois.GF(self.p)
        return galois.GF(self.p**self.degree, irreducible_poly=galois.Poly(self.modulus[::-1], field=base))

    def to_galois(self, elements: Sequence[int]) -> Any:
        """The galois array of raw elements."""
        return self.galois(list(elements))


def coerce_modulus(base: PrimeField, k: int, modulus: Any) -> tuple[int, ...]:
    """``modulus`` as a monic polynomial of degree k over GF(p), or an ArgumentError."""
    m = poly.coerce(base, modulus, "modulus")
    if len(m) != k + 1 or m[-1] != 1:
        raise ArgumentError(f"modulus = {list(m)}: a monic polynomial of degree k = {k} is needed, ascending")
    return m


def check_irreducible(base: PrimeField, modulus: tuple[int, ...]) -> tuple[int, ...]:
    """``modulus`` itself, or an ArgumentError when it is reducible."""
    if not is_irreducible(base, modulus):
        formula = poly.text(base, modulus, "a")
        raise ArgumentError(f"modulus = {formula} is reducible over {base.name}: give an irreducible polynomial")
    return modulus


def is_irreducible(K: Any, m: poly.Poly) -> bool:
    """Whether m is irreducible over the finite field K (Rabin 1980)."""
    degree = len(m) - 1
    x = poly.mod(K, (K.zero, K.one), m)
    needed = {degree // q for q in prime_factors(degree)}
    power = x
    for i in range(1, degree + 1):
        power = poly.power_mod(K, power, K.order, m)
        if i in needed and len(poly.gcd(K, poly.sub(K, power, x), m)) > 1:
            return False
    return power == x


extension_fields: dict[tuple[int, tuple[int, ...]], ExtensionField] = {}
"""The fields made so far, by p and modulus."""


def extension_field(kind: type[ExtensionField], base: PrimeField, modulus: tuple[int, ...]) -> ExtensionField:
    """The field of that modulus, irreducible over ``base``: the one that was made before, else one of this kind."""
    key = base.p, modulus
    return extension_fields.get(key) or extension_fields.setdefault(key, kind(base, modulus))


def default_modulus(base: PrimeField, k: int) -> tuple[int, ...]:
    """galois's Conway polynomial, or, where its table has none, the irreducible one that comes first; Infeasible for
    k > MOST_DEGREE.
    """
    if k > MOST_DEGREE:
        raise Infeasible(
            f"k = {k}: no irreducible polynomial is looked for beyond degree {MOST_DEGREE}; give a modulus"
        )
    # the table ends far below 64 bits, and cannot be asked for more
    if base.p.bit_length() < 64:
        import galois

        with suppress(LookupError):
            return tuple(int(c) for c in galois.conway_poly(base.p, k).coeffs[::-1])
    return next(m for m in _monic_polynomials(base, k) if is_irreducible(base, m))


def _monic_polynomials(base: PrimeField, k: int) -> Iterator[tuple[int, ...]]:
    # x^k + c is irreducible for some c only where each prime factor of k divides p − 1, and 4 too if it divides k
    # (Lidl and Niederreiter 1997, theorem 3.75): a long p is not searched for one in vain
    hopeful = all((base.p - 1) % q == 0 for q in prime_factors(k)) and (k % 4 != 0 or base.p % 4 == 1)
    for number in count(1 if hopeful else base.p):
        digits = []
        for _ in range(k):
            number, digit = divmod(number, base.p)
            digits.append(digit)
        yield (*digits, 1)


def galois_modulus(field: Any) -> tuple[int, ...]:
    """The ascending modulus of a galois field class."""
    return tuple(int(c) for c in field.irreducible_poly.coeffs[::-1])
