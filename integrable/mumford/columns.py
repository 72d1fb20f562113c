"""Columns of double-doubles with Python's operators, over which one call of a formula serves many states."""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.element import Real
from jacobian.fields.inexact import InexactField
from jacobian.numbers.double_double import exact_product, split

Floats = Any

# precision in bits of the exponential of a single number
EXP_BITS = 140


class Column:
    """A double-double number hi + lo; both parts are floats, or arrays of one shape (Dekker 1971)."""

    # makes numpy leave operations of an array with a Column to this class
    __array_ufunc__ = None
    __slots__ = ("hi", "lo")

    def __init__(self, hi: Floats, lo: Floats = 0.0) -> None:
        self.hi, self.lo = hi, lo

    @staticmethod
    def of(x: Column | Real) -> Column:
        """Converts a number of any kind to a column; a column is returned unchanged."""
        return x if isinstance(x, Column) else Column(*split(x))

    def __eq__(self, other: Any) -> bool:
        other = Column.of(other)
        return bool(np.all(self.hi == other.hi) and np.all(self.lo == other.lo))

    __hash__ = None  # type: ignore[assignment]

    def __add__(self, other: Column) -> Column:
        other = Column.of(other)
        high, low = _sum(self.hi, other.hi)
        return _settled(high, low + (self.lo + other.lo))

    __radd__ = __add__

    def __neg__(self) -> Column:
        return Column(-self.hi, -self.lo)

    def __sub__(self, other: Column) -> Column:
        return self + -Column.of(other)

    def __rsub__(self, other: Real) -> Column:
        return Column.of(other) + -self

    def __mul__(self, other: Column | Real) -> Column:
        other = Column.of(other)
        high, low = exact_product(self.hi, other.hi)
        return _settled(high, low + (self.hi * other.lo + self.lo * other.hi))

    __rmul__ = __mul__

    def __truediv__(self, other: Column | Real) -> Column:
        other = Column.of(other)
        first = self.hi / other.hi
        rest = self - other * Column(first)
        return _settled(first, (rest.hi + rest.lo) / other.hi)

    def __rtruediv__(self, other: Real) -> Column:
        return Column.of(other) / self

    def sqrt(self) -> Column:
        first = np.sqrt(self.hi)
        rest = self - Column(first) * Column(first)
        # where the root is 0, the divisor 1 avoids 0/0
        return _settled(first, rest.hi / (2 * first + (first == 0)))


def _sum(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """The rounded sum and its rounding error (Knuth 1969)."""
    total = x + y
    part = total - x
    return total, (x - (total - part)) + (y - part)


def _settled(high: Floats, low: Floats) -> Column:
    total = high + low
    return Column(total, low - (total - high))


class _Elementary:
    """exp and log of columns with the digits of floats, and exp of a single double-double with all its digits."""

    @staticmethod
    def exp(x: Column) -> Column:
        if isinstance(x.hi, np.ndarray):
            high = np.exp(x.hi)
            return Column(high, high * x.lo)
        import gmpy2

        with gmpy2.context(precision=EXP_BITS):
            return Column.of(gmpy2.exp(gmpy2.mpfr(float(x.hi)) + float(x.lo)))

    @staticmethod
    def log(x: Column) -> Column:
        return Column(np.log(x.hi), x.lo / x.hi)


class Columns(InexactField):
    """The field of columns, over which a system's formulas are evaluated."""

    name, context = "columns of double-double numbers", _Elementary()
    zero, one = Column(0.0), Column(1.0)

    def coerce(self, value: Any, argument: str = "value") -> Column:
        return Column.of(value)

    def sqrt(self, x: Column) -> Column:
        return x.sqrt()
