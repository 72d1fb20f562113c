"""The field QQ, on fractions.Fraction."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import gcd, isqrt, lcm

from jacobian.element import Rng
from jacobian.errors import FieldError, NotASquare, shown, written
from jacobian.fields.coercion import rational
from jacobian.fields.protocol import OperatorField
from jacobian.fields.randomness import random_below


class RationalField(OperatorField[Fraction]):
    """The rational numbers; elements are :class:`fractions.Fraction`. The instance is :data:`jacobian.QQ`."""

    name = "QQ"
    exact = True
    zero = Fraction(0)
    one = Fraction(1)

    def __hash__(self) -> int:
        return hash("QQ")

    def coerce(self, value: object, argument: str = "value") -> Fraction:
        """The Fraction of a rational number, as in :meth:`Field.coerce`; FieldError otherwise.

        A float is refused: 0.1 is not 1/10, so the caller must choose.
        """
        if isinstance(value, Fraction):
            return value
        x = rational(value, argument)
        if x is None:
            hint = "an int, a Fraction or a string like '3/4'"
            raise FieldError(f"{argument} = {shown(value)} is not an element of QQ: give {hint}")
        return Fraction(x)

    def is_zero(self, x: Fraction, scale: object = None) -> bool:
        """Whether x is zero; ``scale`` is not used."""
        return x == 0

    def sqrt(self, x: Fraction) -> Fraction:
        """The non-negative rational square root of x, or NotASquare."""
        if x >= 0:
            root = Fraction(isqrt(x.numerator), isqrt(x.denominator))
            if root * root == x:
                return root
        raise NotASquare(f"{written(x)} is not the square of a rational number")

    def random(self, rng: Rng) -> Fraction:
        """A fraction of small height: numerator in −20 … 20, denominator in 1 … 6."""
        return Fraction(random_below(rng, 41) - 20, random_below(rng, 6) + 1)


def primitive(numbers: Sequence[Fraction]) -> list[int]:
    """The integers without a common divisor that are the given rational numbers times one positive factor."""
    factor = lcm(*(x.denominator for x in numbers))
    found = [int(x * factor) for x in numbers]
    return [x // gcd(*found) for x in found]
