"""GF(p^k) on Python integers: Σ c_i p^i stands for Σ c_i a^i, as in :mod:`galois`.

The operations are in :mod:`jacobian.fields.table` up to 2^16 elements and in :mod:`jacobian.fields.digits` beyond.
Neither needs galois, which is imported only for the default modulus (its Conway polynomials) and for
:attr:`ExtensionField.galois`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from jacobian import poly
from jacobian.errors import ArgumentError, FieldError, shown, written
from jacobian.fields.coercion import rational
from jacobian.fields.finite import FiniteField
from jacobian.fields.prime import PrimeField


class ExtensionField(FiniteField):
    """GF(p^k) with k > 1; elements are ints in [0, p^k). Get one from :func:`jacobian.GF`."""

    def __init__(self, base: PrimeField, modulus: tuple[int, ...]) -> None:
        self.base = base
        self.p = self.characteristic = base.p
        self.degree = len(modulus) - 1
        self.order = self.p**self.degree
        self.modulus = modulus
        self.name = f"GF({self.p}^{self.degree}, {poly.text(base, modulus, 'a')})"

    def __repr__(self) -> str:
        return f"GF({self.p}, {self.degree}, {self.modulus})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ExtensionField) and (other.p, other.modulus) == (self.p, self.modulus)

    def __hash__(self) -> int:
        return hash(("GF", self.p, self.modulus))

    def __reduce__(self) -> tuple[object, ...]:
        return extension_field, (type(self), self.base, self.modulus)

    def coerce(self, value: object, argument: str = "value") -> int:
        """The element given by a whole number in [0, p^k), ascending coefficients [c0, c1, …], or a galois scalar; else
        FieldError. Fractions are read only as coefficients: ["1/2"] is the inverse of 2.
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
            raise FieldError(f"{argument} = {written(value)} lies in {kind.name}, not in {self.name}")
        return int(value)

    def coefficients(self, x: int) -> list[int]:
        """The k ascending coefficients of x as a polynomial in the generator ``a``."""
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


def coerce_modulus(base: PrimeField, k: int, modulus: Any) -> tuple[int, ...]:
    """``modulus`` as a monic polynomial of degree k over GF(p), or an ArgumentError."""
    m = poly.coerce(base, modulus, "modulus")
    if len(m) != k + 1 or m[-1] != 1:
        raise ArgumentError(
            f"modulus = {shown(list(m))}: a monic polynomial of degree k = {shown(k)} is needed, ascending"
        )
    return m


extension_fields: dict[tuple[int, tuple[int, ...]], ExtensionField] = {}
"""The fields made so far, by p and modulus."""


def extension_field(kind: type[ExtensionField], base: PrimeField, modulus: tuple[int, ...]) -> ExtensionField:
    """The field with this modulus, irreducible over ``base``: the existing object if there is one, else a new one."""
    key = base.p, modulus
    return extension_fields.get(key) or extension_fields.setdefault(key, kind(base, modulus))


def galois_modulus(field: Any) -> tuple[int, ...]:
    """The ascending modulus of a galois field class."""
    return tuple(int(c) for c in field.irreducible_poly.coeffs[::-1])
