"""Numbers of about 32 digits as unevaluated sums hi + lo of two floats (Dekker 1971): conversions, exact products.

An array of such numbers is a float array with a last axis (hi, lo), |lo| at most half a unit in the last place of hi.
The arithmetic is compiled: :mod:`jacobian.native`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from functools import lru_cache
from math import inf, isfinite, ldexp
from numbers import Integral
from typing import Any

import numpy as np

from jacobian.errors import ArgumentError

# if a number has fewer than MOST_BITS bits, and a binary exponent below MOST_BITS in size, then the number and its
# difference from the nearest float are well inside the range of floats
MOST_BITS = 440
# integers of smaller size are exact as floats
EXACT = 1 << 53
EPS = 2.0**-104
"""A bound of the relative rounding error of one sum, product or square root (quotients: 2.5 times as much)."""
# Veltkamp's factor, which splits a float into two floats of half as many digits
HALVER = 2.0**27 + 1


def split(x: Any) -> tuple[float, float]:
    """(hi, lo): the float nearest to x and the float nearest to x − hi. x is an int, float, Fraction, mpf or mpfr.

    hi + lo is exactly x if x has few enough binary digits. ArgumentError is raised unless x is finite and in the range
    of floats.
    """
    if type(x) is float and isfinite(x):
        return x, 0.0
    if type(x) is int and abs(x) < EXACT:
        return float(x), 0.0
    # mpfr is tested first: it may have an attribute _mpf_ too, but computes this attribute at each access
    if type(x).__name__ == "mpfr":
        return _split_mpfr(x)
    if hasattr(x, "_mpf_"):
        return _split_mpf(x)
    if isinstance(x, Integral):
        x = Fraction(int(x))
    if not isinstance(x, (float, np.floating, Fraction)):
        raise ArgumentError(f"x = {x!r}: an int, float, Fraction or mpf is needed")
    high = _finite(x, float)
    low = float(x - Fraction(high)) if isinstance(x, Fraction) else float(x - high)
    total = high + low
    return total, low - (total - high)


def double_double_row(values: Iterable[Any]) -> np.ndarray:
    """An array of double-doubles, shape (n, 2), from n numbers of the types that :func:`split` accepts."""
    return np.array([split(x) for x in values])


def _split_mpf(x: Any) -> tuple[float, float]:
    sign, mantissa, exponent, bits = x._mpf_
    if 0 < bits < MOST_BITS and abs(exponent) < MOST_BITS:
        # float() of an int is the nearest float
        whole = -int(mantissa) if sign else int(mantissa)
        high = float(whole)
        low = float(whole - int(high))
        total = high + low
        return ldexp(total, exponent), ldexp(low - (total - high), exponent)
    return _split_any_mpf(x)


def _finite(x: Any, convert: Callable[[Any], float]) -> float:
    """The float nearest to x, by ``convert``; ArgumentError beyond the range of floats."""
    try:
        high = convert(x)
    except OverflowError:
        high = inf
    if isfinite(high):
        return high
    raise ArgumentError(f"x = {x!r}: a finite number in the range of floats is needed")


def _split_mpfr(x: Any) -> tuple[float, float]:
    high = _finite(x, float)
    return high, float(_context(x.precision).sub(x, high))


@lru_cache(16)
def _context(precision: int) -> Any:
    """A gmpy2 context in which the difference of a number of this precision and a float near it is exact."""
    import gmpy2

    return gmpy2.context(precision=max(precision, 53) + 1)


def _split_any_mpf(x: Any) -> tuple[float, float]:
    from mpmath.libmp import from_float, mpf_sub, to_float

    high = _finite(x, lambda x: to_float(x._mpf_))
    # mpf_sub without a precision is exact
    low = to_float(mpf_sub(x._mpf_, from_float(high)))
    total = high + low
    return total, low - (total - high)


def pack(numbers: Any) -> np.ndarray:
    """Nested sequences of numbers, or an array, as a float array of the same shape and a last axis (hi, lo).

    Numbers and exceptions are as in :func:`split`.
    """
    table = np.asarray(numbers)
    if table.dtype == np.float64 and np.isfinite(table).all():
        return np.stack([table, np.zeros_like(table)], axis=-1)
    out = np.empty((*table.shape, 2))
    for index, x in np.ndenumerate(table):
        out[index] = split(x)
    return out


def unpack(array: np.ndarray, convert: Any = Fraction) -> Any:
    """The numbers ``convert(hi) + convert(lo)`` of an array (…, 2), as nested lists; for shape (2,) one number.

    The result is exact with Fraction. With the mpf of a context of 33 digits or more it is exact unless lo is far below
    hi.
    """
    rows = np.asarray(array)
    if rows.shape[-1:] != (2,):
        raise ArgumentError(f"array of shape {rows.shape}: the last axis must be (hi, lo)")
    if rows.ndim == 1:
        return convert(float(rows[0])) + convert(float(rows[1]))
    return [unpack(row, convert) for row in rows]


def exact_product(x: Any, y: Any) -> tuple[Any, Any]:
    """(product, error) with x·y = product + error exactly, unless floats over- or underflow; x, y floats or arrays."""
    product = x * y
    (a, b), (c, d) = _halves(x), _halves(y)
    return product, ((a * c - product) + a * d + b * c) + b * d


def _halves(x: Any) -> tuple[Any, Any]:
    """x as a sum of two floats of half its digits."""
    high = HALVER * x - (HALVER * x - x)
    return high, x - high
