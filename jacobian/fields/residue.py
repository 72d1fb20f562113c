"""The residue field K[x]/(P) of an irreducible polynomial P over a finite field K; elements are trimmed polynomials."""

from __future__ import annotations

from typing import Any

from jacobian import poly
from jacobian.fields.finite import FiniteField, FiniteFieldOf


class ResidueField(FiniteFieldOf[poly.Poly]):
    """K[x]/(P): the field of the abscissas x with P(x) = 0."""

    zero: poly.Poly = ()

    def __init__(self, K: FiniteField, P: poly.Poly) -> None:
        self.base = K
        self.modulus = P
        self.characteristic = K.characteristic
        self.order = K.order ** (len(P) - 1)
        self.one = (K.one,)
        self.name = f"{K.name}[x]/({poly.text(K, P)})"

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
        """One square root of x, or NotASquare; if deg P = 1, or 2 in odd characteristic, from square roots in K."""
        K = self.base
        if len(self.modulus) == 2 and x:
            return (K.sqrt(x[0]),)
        if len(self.modulus) == 3 and x and self.characteristic > 2:
            return self._quadratic_sqrt(*x, *[K.zero] * (2 - len(x)))
        return super().sqrt(x)

    def _quadratic_sqrt(self, t: Any, s: Any) -> poly.Poly:
        """The square root y of t + sX, where X² = −bX − c, from its norm n and its trace r: y² = ry − n."""
        K, (c, b, _) = self.base, self.modulus
        half = K.inv(poly.integer(K, 2))
        if s == K.zero:
            if K.is_square(t):
                return (K.sqrt(t),)
            # neither t nor b²/4 − c is a square, so their quotient is a square
            shift = K.mul(b, half)
            m = K.sqrt(K.div(t, K.sub(K.mul(shift, shift), c)))
            return poly.trim(K, (K.mul(m, shift), m))
        n = K.sqrt(K.add(K.mul(t, K.sub(t, K.mul(b, s))), K.mul(c, K.mul(s, s))))
        trace = K.sub(K.add(t, t), K.mul(b, s))
        # trace² − 4n² = s²(b² − 4c) is not a square, so exactly one of trace ± 2n is a square
        if not K.is_square(K.add(trace, K.add(n, n))):
            n = K.neg(n)
        inverse = K.inv(K.sqrt(K.add(trace, K.add(n, n))))
        return poly.trim(K, (K.mul(K.add(t, n), inverse), K.mul(s, inverse)))

    def element(self, index: int) -> poly.Poly:
        return polynomial_number(self.base, index)


def polynomial_number(K: FiniteField, index: int) -> poly.Poly:
    """The polynomial whose coefficients are the digits of ``index`` in base K.order: an enumeration of K[x]."""
    digits = []
    while index:
        index, digit = divmod(index, K.order)
        digits.append(K.element(digit))
    return tuple(digits)
