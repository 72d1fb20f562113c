"""GF(p^k) of any size: an element's base-p digits are a polynomial, and products are reduced by the modulus."""

from __future__ import annotations

from collections.abc import Sequence

from jacobian import poly
from jacobian.fields.extension import ExtensionField
from jacobian.fields.prime import PrimeField
from jacobian.numbers.binary import carryless_product


class DigitField(ExtensionField):
    """GF(p^k) of any size, computed on the base-p digits of elements, in characteristic 2 on bit masks."""

    def __init__(self, base: PrimeField, modulus: tuple[int, ...]) -> None:
        super().__init__(base, modulus)
        # (i, −m_i) for the terms of a^k = −Σ m_i a^i
        self._tail = [(i, base.p - c) for i, c in enumerate(modulus[:-1]) if c]

    def add(self, x: int, y: int) -> int:
        if self.p == 2:
            return x ^ y
        pairs = zip(self.coefficients(x), self.coefficients(y), strict=True)
        return self._pack([(a + b) % self.p for a, b in pairs])

    def neg(self, x: int) -> int:
        return x if self.p == 2 else self._pack([-c % self.p for c in self.coefficients(x)])

    def mul(self, x: int, y: int) -> int:
        return self.dot((x,), (y,))

    def dot(self, xs: Sequence[int], ys: Sequence[int]) -> int:
        """Σ x_i y_i: the products are summed first and reduced by the modulus once."""
        if self.p == 2:
            return self._dot_of_bits(xs, ys)
        k, p = self.degree, self.p
        total = [0] * (2 * k - 1)
        for x, y in zip(xs, ys, strict=True):
            digits = self.coefficients(y)
            i = 0
            while x:
                x, c = divmod(x, p)
                if c:
                    for j, d in enumerate(digits, i):
                        total[j] += c * d
                i += 1
        for top in range(2 * k - 2, k - 1, -1):
            c = total[top] % p
            if c:
                for i, m in self._tail:
                    total[top - k + i] += c * m
        return self._pack([c % p for c in total[:k]])

    def _dot_of_bits(self, xs: Sequence[int], ys: Sequence[int]) -> int:
        total = 0
        for x, y in zip(xs, ys, strict=True):
            total ^= carryless_product(x, y)
        k = self.degree
        while total >> k:
            high = total >> k
            total &= (1 << k) - 1
            for i, _ in self._tail:
                total ^= high << i
        return total

    def inv(self, x: int) -> int:
        if not x:
            raise ZeroDivisionError(f"1/0 in {self.name}")
        if self.p == 2:
            return _inverse_bits(x, self._pack(self.modulus))
        digits = poly.trim(self.base, self.coefficients(x))
        return self._pack(poly.half_xgcd(self.base, self.modulus, digits)[1])


class QuadraticField(DigitField):
    """GF(p²) for odd p: elements x₀ + x₁a with a² = −m₀ − m₁a, multiplied by explicit formulas."""

    def __init__(self, base: PrimeField, modulus: tuple[int, ...]) -> None:
        super().__init__(base, modulus)
        self._m0, self._m1 = modulus[:2]

    def add(self, x: int, y: int) -> int:
        p = self.p
        x1, x0 = divmod(x, p)
        y1, y0 = divmod(y, p)
        return (x0 + y0) % p + (x1 + y1) % p * p

    def sub(self, x: int, y: int) -> int:
        p = self.p
        x1, x0 = divmod(x, p)
        y1, y0 = divmod(y, p)
        return (x0 - y0) % p + (x1 - y1) % p * p

    def neg(self, x: int) -> int:
        p = self.p
        x1, x0 = divmod(x, p)
        return -x0 % p + -x1 % p * p

    def mul(self, x: int, y: int) -> int:
        p = self.p
        x1, x0 = divmod(x, p)
        y1, y0 = divmod(y, p)
        top = x1 * y1
        return (x0 * y0 - self._m0 * top) % p + (x0 * y1 + x1 * y0 - self._m1 * top) % p * p

    def dot(self, xs: Sequence[int], ys: Sequence[int]) -> int:
        """Σ x_i y_i, reduced once."""
        p = self.p
        low = middle = top = 0
        for x, y in zip(xs, ys, strict=True):
            x1, x0 = divmod(x, p)
            y1, y0 = divmod(y, p)
            low += x0 * y0
            middle += x0 * y1 + x1 * y0
            top += x1 * y1
        return (low - self._m0 * top) % p + (middle - self._m1 * top) % p * p

    def inv(self, x: int) -> int:
        if not x:
            raise ZeroDivisionError(f"1/0 in {self.name}")
        p = self.p
        x1, x0 = divmod(x, p)
        conjugate = x0 - self._m1 * x1
        norm = pow(x0 * conjugate + self._m0 * x1 * x1, -1, p)
        return conjugate * norm % p + -x1 * norm % p * p


def _inverse_bits(x: int, modulus: int) -> int:
    """The inverse of x modulo an irreducible polynomial over GF(2), both bit masks, by shifts and additions."""
    a, b, s, t = x, modulus, 1, 0
    while a != 1:
        shift = a.bit_length() - b.bit_length()
        if shift < 0:
            a, b, s, t, shift = b, a, t, s, -shift
        a ^= b << shift
        s ^= t << shift
    return s
