"""The fields RR, on Python's float, and CC, on Python's complex."""

from __future__ import annotations

import cmath
import math
import sys
from collections.abc import Sequence
from operator import mul
from typing import Any, ClassVar

from jacobian.element import Rng
from jacobian.errors import NotASquare, written
from jacobian.fields.coercion import is_complex, number
from jacobian.fields.inexact import InexactField
from jacobian.fields.randomness import random_float

# a power of 2 by which terms are multiplied if their sum exceeds the range of floats
DOWN = 2.0**-64


class RealField(InexactField[float]):
    """The real numbers in double precision; elements are float. The only instance is :data:`jacobian.RR`."""

    name = "RR"
    _only: ClassVar[RealField | None] = None
    _is_finite = staticmethod(math.isfinite)
    zero = 0.0
    one = 1.0
    eps = sys.float_info.epsilon

    def __new__(cls) -> RealField:
        # pickles give the same instance too, so that fields are compared by ``is``, a tenth of the time of ==
        if cls._only is None:
            cls._only = super().__new__(cls)
        return cls._only

    def __hash__(self) -> int:
        return hash("RR")

    def coerce(self, value: object, argument: str = "value") -> float:
        """The nearest float of a real number, as in :meth:`Field.coerce`; FieldError for anything else."""
        return value if type(value) is float and math.isfinite(value) else super().coerce(value, argument)

    def _convert(self, value: Any, argument: str) -> float:
        x = value if type(value) is int else number(value, argument)
        if is_complex(x):
            raise TypeError
        return float(x)

    def dot(self, xs: Sequence[float], ys: Sequence[float]) -> float:
        """Σ x_i y_i: rounded products, summed exactly and rounded once; an infinity beyond the range of floats."""
        try:
            return math.fsum(map(mul, xs, ys))
        except OverflowError:
            # a partial sum, or the result, exceeds the range of floats
            return math.fsum(x * y * DOWN for x, y in zip(xs, ys, strict=True)) / DOWN

    def sqrt(self, x: float) -> float:
        """The non-negative square root, or NotASquare for x < 0."""
        if x < 0:
            raise NotASquare(f"{written(x)} is negative: no square root in RR")
        return math.sqrt(x)

    def exponent(self, x: float) -> int:
        """The e with 2^(e−1) ≤ |x| < 2^e, for x ≠ 0."""
        return math.frexp(x)[1]

    def shift(self, x: float, bits: int) -> float:
        """x·2^bits; OverflowError beyond the range."""
        return math.ldexp(x, bits)

    def random(self, rng: Rng) -> float:
        """A random float, uniform in [−2, 2)."""
        return random_float(rng)


class ComplexField(InexactField[complex]):
    """The complex numbers in double precision; elements are complex. The instance is :data:`jacobian.CC`."""

    name = "CC"
    _is_finite = staticmethod(cmath.isfinite)
    zero = 0j
    one = 1 + 0j
    eps = sys.float_info.epsilon

    def __init__(self) -> None:
        self.complex = True

    def __hash__(self) -> int:
        return hash("CC")

    def _convert(self, value: Any, argument: str) -> complex:
        return complex(number(value, argument))

    def dot(self, xs: Sequence[complex], ys: Sequence[complex]) -> complex:
        """Σ x_i y_i: rounded products, summed exactly and rounded once."""
        products = list(map(mul, xs, ys))
        return complex(math.fsum(z.real for z in products), math.fsum(z.imag for z in products))

    def sqrt(self, x: complex) -> complex:
        """The principal square root."""
        return cmath.sqrt(x)

    def exponent(self, x: complex) -> int:
        """The e with 2^(e−1) ≤ max(|re x|, |im x|) < 2^e, for x ≠ 0."""
        return math.frexp(max(abs(x.real), abs(x.imag)))[1]

    def shift(self, x: complex, bits: int) -> complex:
        """x·2^bits; OverflowError beyond the range."""
        return complex(math.ldexp(x.real, bits), math.ldexp(x.imag, bits))

    def random(self, rng: Rng) -> complex:
        """A random complex number, uniform in the square [−2, 2)²."""
        return complex(random_float(rng), random_float(rng))
