"""Arithmetic on arrays for closed forms: long doubles for results in floats, bare reals for those of many digits.

Constants are computed in numbers of a wide field and converted once.
"""

from __future__ import annotations

import numpy as np

from integrable.phase.precisions import SET_UP_DIGITS
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import Mpf, MultiprecisionField
from jacobian.numbers.double_double import exact_product, split
from jacobian.numbers.long_reals import BareReals

# beyond this many turns a float holds no digits of the phase
MOST_TURNS = 2.0**50
# largest number of Newton steps to a zero in long doubles, including a bisection for each bit
PASSES = 80


class LongDoubles:
    """Long doubles. ``field`` is the wide field, ``eps`` the rounding unit, ``bits`` the number of bits, ``tiny`` a
    number far below ``eps``, and ``passes`` the largest number of steps of Newton's method.
    """

    sin, cos, sqrt, arctan, arcsin, arcsinh = np.sin, np.cos, np.sqrt, np.arctan, np.arcsin, np.arcsinh
    arctan2, nearest = np.arctan2, np.rint
    passes = PASSES

    def __init__(self, kind: type[np.floating] = np.longdouble) -> None:
        self._kind, self.field = kind, MP(SET_UP_DIGITS)
        self.eps, self.tiny, self.bits = np.finfo(kind).eps, np.finfo(kind).tiny, np.finfo(kind).nmant
        self.pi = self.number(self.field.context.pi)

    def number(self, x: Real) -> Real:
        """A wide number as a number of this kind."""
        high, low = split(x)
        return self._kind(high) + self._kind(low)

    def wide(self, x: Real) -> Real:
        """A number of this kind as a wide number."""
        high = float(x)
        return self.field.coerce(high) + self.field.coerce(float(x - high))

    def result(self, x: np.ndarray) -> np.ndarray:
        """The array x rounded to floats."""
        return x.astype(float)

    def turns_of(self, values: np.ndarray, rate: Mpf, start: Mpf) -> tuple[np.ndarray, np.ndarray]:
        """(whole turns, the rest in [−½, ½]) of values·rate + start; rate and start are wide. PrecisionLoss beyond
        2^50 turns.
        """
        # in a unit of time in which the rate is about 1, the two parts of the rate and of the products are in the range
        # of floats
        exponent = int(rate.context.frexp(rate)[1])
        high, low = split(rate * rate.context.mpf(2) ** -exponent)
        with np.errstate(over="ignore"):
            scaled = np.ldexp(values if rate else 0 * values, exponent)
        if not np.abs(scaled).max(initial=0) < MOST_TURNS:
            farthest = float(np.abs(values).max())
            raise PrecisionLoss(
                f"time {farthest}: {farthest * float(rate):.1e} turns of a phase are more than the {MOST_TURNS:.1e} "
                "whose fractions double-double numbers hold; use more digits"
            )
        product, error = exact_product(scaled, high)
        whole = np.rint(product)
        rest = (product - whole).astype(self._kind) + error + scaled.astype(self._kind) * low + self.number(start)
        more = np.rint(rest)
        return whole + more.astype(float), rest - more


class Multiprecision:
    """Bare reals for results in an MP ``field``, in object arrays; the attributes are those of :class:`LongDoubles`.
    Compute with them inside a ``with numbers.reals`` block.
    """

    def __init__(self, field: MultiprecisionField) -> None:
        import gmpy2 as g

        self.field, self.bits = field, field.context.prec
        self.reals = BareReals(self.bits)
        self.number, self.passes = self.reals.number, PASSES + self.bits
        self.eps, self.tiny, self.pi = map(
            self.number, (field.eps, field.context.ldexp(1, -(10**6)), +field.context.pi)
        )
        self.sin, self.cos, self.sqrt, self.arctan, self.arcsin, self.arcsinh, self.nearest = (
            np.frompyfunc(f, 1, 1) for f in (g.sin, g.cos, g.sqrt, g.atan, g.asin, g.asinh, g.rint)
        )
        self.arctan2 = np.frompyfunc(g.atan2, 2, 1)

    def wide(self, x: Real) -> Real:
        """A number of this kind as a wide number."""
        return self.reals.element(self.field, x)

    def result(self, x: np.ndarray) -> np.ndarray:
        """The array x, unchanged."""
        return x

    def turns_of(self, values: np.ndarray, rate: Real, start: Real) -> tuple[np.ndarray, np.ndarray]:
        """(whole turns, the rest in [−½, ½]) of values·rate + start; rate and start are wide."""
        turns = values * self.number(rate) + self.number(start)
        whole = self.nearest(turns)
        return whole, turns - whole


LONG = LongDoubles()
