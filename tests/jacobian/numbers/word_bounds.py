"""A context of :mod:`jacobian.numbers.words` that computes with bounds: the size of each number, in units of p.

A formula that runs without error on the bounds of its inputs overflows no word, for any prime and any numbers.
"""

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True)
class Bounds:
    """Wide: p < 2^(w−1); lazy: p < 2^(w−3). The size of a number may carry a sign, which is ignored."""

    wide: bool

    @property
    def word(self):
        return 1 if self.wide else 4

    def checked(self, x, limit):
        assert abs(x) <= limit, f"{float(abs(x))} p exceeds {limit} p"
        return Fraction(abs(x))

    def dot(self, *terms):
        for x in terms:
            self.checked(x, self.word)
        total = sum(abs(a * b) for a, b in zip(terms[::2], terms[1::2], strict=True))
        # |T| ≤ 2^(2w−1), and T/2^w + p/2 is a word
        self.checked(total, 2 if self.wide else 32)
        return self.checked(total / (2 if self.wide else 8) + Fraction(1, 2), self.word)

    def fit(self, x):
        x = self.checked(x, self.word)
        return min(x, Fraction(1, 2)) if self.wide else x

    def add(self, x, y):
        return self.fit(abs(x) + abs(y))

    sub = add

    def neg(self, x):
        return x

    def settled(self, x):
        return min(self.checked(x, self.word), Fraction(1, 2))

    def canonical(self, x):
        return min(self.checked(x, 1 if self.wide else Fraction(3, 2)), Fraction(1, 2))


@dataclass(frozen=True)
class DoubleBounds:
    """Floats with p < 2^49: every sum is an integer below 2^53, and so is the quotient of every product.

    The rounded quotient ab/p is wrong by three roundings, each of one part in 2^53, and by a half.
    """

    def checked(self, x, limit):
        assert abs(x) < limit, f"{float(abs(x))} p exceeds {limit} p"
        return Fraction(abs(x))

    def dot(self, *terms):
        total = Fraction(0)
        for a, b in zip(terms[::2], terms[1::2], strict=True):
            product = self.checked(a * b, 16)
            total += Fraction(1, 2) + product * Fraction(301, 100 * 16)
        return self.checked(total, 16)

    def fit(self, x):
        return abs(x)

    def add(self, x, y):
        return self.checked(abs(x) + abs(y), 16)

    sub = add

    def neg(self, x):
        return x

    def settled(self, x):
        return min(self.checked(x, Fraction(9, 2)), Fraction(1, 2))

    canonical = settled
