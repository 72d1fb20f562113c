"""Square roots and comparisons of bare numbers: floats, mpf, and the long reals and double-doubles that register here.

Compiled code has its own versions of these functions: :mod:`jacobian.inexact.compiled`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

Real = Any  # float, or the mpf of one context


# for types that have something quicker than x ** 0.5; long_reals adds its own
ROOTS: dict[type, Callable[[Any], Any]] = {float: sqrt}


def root(x: Real) -> Real:
    """√x."""
    special = ROOTS.get(type(x))
    return special(x) if special else x**0.5


def negligible(small: Real, large: Real) -> bool:
    """Whether ``small`` adds nothing to ``large``, to rounding."""
    return bool(large + small == large)
