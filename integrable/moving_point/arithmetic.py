"""Arithmetic on arrays for closed forms: long doubles for results in floats, bare reals for results of many digits.

Constants are computed in numbers of a wide field and converted once.
"""

from __future__ import annotations

from math import frexp, ldexp

import gmpy2
import numpy as np

from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.inexact.long_field import LongField
from jacobian.numbers.double_double import exact_product, split

# bits of the constants of closed forms in long doubles
WIDE_BITS = 160
# at a time of this many turns, neighbouring floats of the time are a quarter of a turn apart
MOST_TURNS = 2.0**50
# largest number of Newton steps to a zero in long doubles, including a bisection for each bit
PASSES = 80


def too_many_turns(time: float, turns: float, most: float = MOST_TURNS) -> PrecisionLoss:
    """The error for a time in which a phase makes more than ``most`` turns."""
    return PrecisionLoss(
        f"time {time}: {turns:.1e} turns of a phase are more than the {most:.1e} whose fractions double-double numbers "
        "hold; use more digits"
    )


class LongDoubles:
    """Long doubles. ``field`` has the wide numbers, ``eps`` is the rounding unit, ``bits`` the number of bits, ``tiny``
    a number far below ``eps``, and ``passes`` the largest number of steps of Newton's method.
    """

    sin, cos, sqrt, arctan, arcsin, arcsinh = np.sin, np.cos, np.sqrt, np.arctan, np.arcsin, np.arcsinh
    arctan2, nearest = np.arctan2, np.rint
    passes = PASSES

    def __init__(self, kind: type[np.floating] = np.longdouble) -> None:
        self._kind, self.field = kind, LongField(WIDE_BITS)
        self.eps, self.tiny, self.bits = np.finfo(kind).eps, np.finfo(kind).tiny, np.finfo(kind).nmant
        with self.field:
            self.pi = self.number(gmpy2.const_pi())

    def number(self, x: Real) -> Real:
        """A wide number as a number of this kind."""
        high, low = split(x)
        return self._kind(high) + self._kind(low)

    def wide(self, x: Real) -> Real:
        """A number of this kind as a wide number."""
        high = float(x)
        return self.field.coerce(high) + float(x - high)

    def result(self, x: np.ndarray) -> np.ndarray:
        """The array x rounded to floats."""
        return x.astype(float)

    def turns_of(self, values: np.ndarray, rate: Real, start: Real) -> tuple[np.ndarray, np.ndarray]:
        """(whole turns, the rest in [−½, ½]) of values·rate + start; rate and start are wide or mpf. PrecisionLoss
        beyond 2^50 turns.
        """
        # in a unit of time in which the rate is about 1, the two parts of the rate and of the products are in the range
        # of floats
        high, low = split(rate)
        high, exponent = frexp(high)
        low = ldexp(low, -exponent)
        with np.errstate(over="ignore"):
            scaled = np.ldexp(values if rate else 0 * values, exponent)
        if not np.abs(scaled).max(initial=0) < MOST_TURNS:
            farthest = float(np.abs(values).max())
            raise too_many_turns(farthest, abs(farthest * float(rate)))
        product, error = exact_product(scaled, high)
        whole = np.rint(product)
        rest = (product - whole).astype(self._kind) + error + scaled.astype(self._kind) * low + self.number(start)
        more = np.rint(rest)
        return whole + more.astype(float), rest - more


class Multiprecision:
    """Long numbers of ``bits`` bits, in object arrays. They are also the wide numbers. The attributes are those of
    :class:`LongDoubles`. Compute with them inside a ``with numbers.field`` block.
    """

    def __init__(self, bits: int) -> None:
        self.field, self.bits, self.passes = LongField(bits), bits, PASSES + bits
        with self.field as K:
            self.eps, self.tiny, self.pi = K.eps, gmpy2.exp2(-(10**6)), gmpy2.const_pi()
        self.sin, self.cos, self.sqrt, self.arctan, self.arcsin, self.arcsinh, self.nearest = (
            np.frompyfunc(f, 1, 1)
            for f in (gmpy2.sin, gmpy2.cos, gmpy2.sqrt, gmpy2.atan, gmpy2.asin, gmpy2.asinh, gmpy2.rint)
        )
        self.arctan2 = np.frompyfunc(gmpy2.atan2, 2, 1)

    def number(self, x: Real) -> Real:
        """The wide number x itself."""
        return x

    wide = number

    def result(self, x: np.ndarray) -> np.ndarray:
        """The array x, unchanged."""
        return x

    def turns_of(self, values: np.ndarray, rate: Real, start: Real) -> tuple[np.ndarray, np.ndarray]:
        """(whole turns, the rest in [−½, ½]) of values·rate + start; rate and start are wide."""
        turns = values * rate + start
        whole = self.nearest(turns)
        return whole, turns - whole


LONG = LongDoubles()


def step_inside(
    x: np.ndarray, value: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(improved x, low, high) for the zeros of increasing functions that have this ``value`` and ``slope`` at x. A
    Newton step that leaves the bracket [low, high] is replaced by bisection. All arguments are arrays of one shape.
    """
    low, high = np.where(value > 0, low, x), np.where(value > 0, x, high)
    better = x - value / slope
    return np.where((better < low) | (better > high), (low + high) / 2, better), low, high
