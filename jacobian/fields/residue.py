"""The residue field K[x]/(P) of an irreducible polynomial P over a finite field K; elements are trimmed polynomials."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from jacobian import poly
from jacobian.errors import NotASquare
from jacobian.fields.finite import FiniteField, FiniteFieldOf


class ResidueField(FiniteFieldOf[poly.Poly]):
    """K[x]/(P), the extension of K by a root of P. A point over a root of P has its abscissa in this field."""

    zero: poly.Poly = ()

    def __init__(self, K: FiniteField, P: poly.Poly) -> None:
        self.base = K
        self.modulus = P
        self.characteristic = K.characteristic
        self.order = K.order ** (len(P) - 1)
        self.one = (K.one,)
        self.name = f"{K.name}[x]/({poly.text(K, P)})"

    def __repr__(self) -> str:
        return self.name

    def coerce(self, value: object, argument: str = "value") -> poly.Poly:
        """``value`` as an element of K, a constant polynomial."""
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

    def sqrt(self, x: poly.Poly) -> poly.Poly:
        """One square root of x, or NotASquare. Square roots in K suffice if deg P = 1, or 2 in odd characteristic."""
        K = self.base
        if len(self.modulus) == 2 and x:
            return (K.sqrt(x[0]),)
        if len(self.modulus) == 3 and x and self.characteristic > 2:
            return quadratic_root(K, self.modulus, x)
        return super().sqrt(x)

    def element(self, index: int) -> poly.Poly:
        return polynomial_number(self.base, index)


def polynomial_number(K: FiniteField, index: int) -> poly.Poly:
    """The polynomial whose coefficients are the digits of ``index`` in base K.order: an enumeration of K[x]."""
    digits = []
    while index:
        index, digit = divmod(index, K.order)
        digits.append(K.element(digit))
    return tuple(digits)


def quadratic_root(K: Any, modulus: poly.Poly, value: poly.Poly) -> poly.Poly:
    """A square root of a non-zero element t + sX of K[X]/(X² + bX + c), char K ≠ 2, from its norm and its trace.

    NotASquare if there is none, or if K has no root of the norm.
    """
    (c, b, _), (t, s) = modulus, (*value, K.zero)[:2]
    half = K.inv(poly.integer(K, 2))
    if s == K.zero:
        with suppress(NotASquare):
            return (K.sqrt(t),)
        # a root of trace 0 is m(X + b/2)
        shift = K.mul(b, half)
        m = K.sqrt(K.div(t, K.sub(K.mul(shift, shift), c)))
        return poly.trim(K, (K.mul(m, shift), m))
    norm = K.sqrt(K.add(K.mul(t, K.sub(t, K.mul(b, s))), K.mul(c, K.mul(s, s))))
    trace = K.sub(K.add(t, t), K.mul(b, s))
    for n in (norm, K.neg(norm)):
        with suppress(NotASquare):
            # a root y of norm n has the trace r = √(trace + 2n), and y² = ry − n; r ≠ 0, as trace² − 4n² = s²(b² − 4c)
            inverse = K.inv(K.sqrt(K.add(trace, K.add(n, n))))
            return poly.trim(K, (K.mul(K.add(t, n), inverse), K.mul(s, inverse)))
    raise NotASquare(f"{poly.text(K, value)} is not a square modulo {poly.text(K, modulus)} over {K.name}")
