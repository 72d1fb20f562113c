"""GF(p^k) of at most 2^16 elements: tables of exponents and logarithms, addition by Zech logarithms."""

from __future__ import annotations

from jacobian.fields.digits import DigitField
from jacobian.fields.extension import ExtensionField
from jacobian.fields.primality import prime_factors
from jacobian.fields.prime import PrimeField

TABLE_LIMIT = 1 << 16


class TableField(ExtensionField):
    """GF(p^k) of at most 2^16 elements by tables of exponents, logarithms and Zech logarithms."""

    def __init__(self, base: PrimeField, modulus: tuple[int, ...]) -> None:
        super().__init__(base, modulus)
        powers = self._powers_of_generator()
        size = self.order - 1
        log = [0] * self.order
        for exponent, x in enumerate(powers):
            log[x] = exponent
        self._size = size
        self._exp = powers + powers
        self._log = log
        self._half = size // 2
        successors = [x - x % self.p + (x + 1) % self.p for x in powers]
        self._zech = [log[x] if x else -1 for x in successors]

    def _powers_of_generator(self) -> list[int]:
        """1, g, g², … for the first generator g among a, a + 1, …; for a Conway modulus it is a itself."""
        slow = DigitField(self.base, self.modulus)
        size = self.order - 1
        factors = prime_factors(size)
        g = next(g for g in range(2, self.order) if all(slow.power(g, size // q) != 1 for q in factors))
        powers = [1]
        if self.p == 2:
            # g·x is linear in x, hence the sum of the products of g with the lower and with the upper bits of x
            half = self.degree // 2
            lower = [slow.mul(g, x) for x in range(1 << half)]
            upper = [slow.mul(g, x << half) for x in range(1 << self.degree - half)]
            for _ in range(size - 1):
                x = powers[-1]
                powers.append(lower[x & (1 << half) - 1] ^ upper[x >> half])
            return powers
        for _ in range(size - 1):
            powers.append(slow.mul(powers[-1], g))
        return powers

    def add(self, x: int, y: int) -> int:
        if self.p == 2:
            return x ^ y
        if not x:
            return y
        if not y:
            return x
        exponent = self._log[x]
        # a negative difference of logarithms counts from the end of the table, whose length is the period
        zech = self._zech[self._log[y] - exponent]
        return self._exp[exponent + zech] if zech >= 0 else 0

    def neg(self, x: int) -> int:
        return x if self.p == 2 or not x else self._exp[self._log[x] + self._half]

    def mul(self, x: int, y: int) -> int:
        return self._exp[self._log[x] + self._log[y]] if x and y else 0

    def inv(self, x: int) -> int:
        if not x:
            raise ZeroDivisionError(f"1/0 in {self.name}")
        return self._exp[self._size - self._log[x]]

    def power(self, x: int, exponent: int) -> int:
        if not x:
            return 0 if exponent else 1
        return self._exp[self._log[x] * exponent % self._size]
