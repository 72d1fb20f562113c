"""The residue field K[x]/(P) of an irreducible polynomial P over a finite field K; elements are trimmed polynomials."""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.fields.finite import FiniteFieldOf


class ResidueField(FiniteFieldOf[poly.Poly]):
    """K[x]/(P): where the points of a place of degree deg P have their coordinates."""

    zero: poly.Poly = ()

    def __init__(self, K: Any, P: poly.Poly) -> None:
        self.base = K
        self.modulus = P
        self.characteristic = K.characteristic
        self.order = K.order ** (len(P) - 1)
        self.one = (K.one,)
        self.name = f"{K.name}[x]/({poly.text(K, P)})"

    def coerce(self, value: Any, argument: str = "value") -> poly.Poly:
        """The constant that ``value`` is in K."""
        return poly.trim(self.base, (self.base.coerce(value, argument),))

    def add(self, x: poly.Poly, y: poly.Poly) -> poly.Poly:
        return poly.add(self.base, x, y)

    def neg(self, x: poly.Poly) -> poly.Poly:
        return poly.neg(self.base, x)

    def mul(self, x: poly.Poly, y: poly.Poly) -> poly.Poly:
        return poly.mod(self.base, poly.mul(self.base, x, y), self.modulus)

    def inv(self, x: poly.Poly) -> poly.Poly:
        if not x:
            raise ZeroDivisionError(f"1/0 in {self.name}")
        return poly.half_xgcd(self.base, self.modulus, x)[1]

    def element(self, index: int) -> poly.Poly:
        return polynomial_number(self.base, index)


def polynomial_number(K: Any, index: int) -> poly.Poly:
    """The polynomial whose coefficients are the digits of ``index`` in base K.order: an enumeration of K[x]."""
    digits = []
    while index:
        index, digit = divmod(index, K.order)
        digits.append(K.element(digit))
    return tuple(digits)
