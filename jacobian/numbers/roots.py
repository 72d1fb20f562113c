"""Square roots and comparisons of bare numbers: floats, mpf, long reals and double-doubles.

Compiled code has its own versions of these functions: :mod:`jacobian.native.special`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import sqrt
from typing import Any

Real = Any  # float, mpf, long real or double-double


def root(x: Real) -> Real:
    """√x."""
    numbers: Any = type(x)
    return sqrt(x) if numbers is float else _root_of(numbers)(x)


@lru_cache(16)
def _root_of(numbers: Any) -> Callable[[Any], Any]:
    if numbers.__module__ == "gmpy2":
        import gmpy2

        return gmpy2.sqrt
    # the classes of python-flint's and mpmath's numbers have a ``sqrt``; the class of double-doubles has none
    return getattr(numbers, "sqrt", lambda x: x**0.5)


def negligible(small: Real, large: Real) -> bool:
    """Whether ``large`` + ``small`` rounds to ``large``."""
    return bool(large + small == large)
