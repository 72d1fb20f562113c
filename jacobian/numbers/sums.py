"""Sums of many products of bare numbers of any kind.

Compiled code has its own version of this function: :mod:`jacobian.native.special`.
"""

from __future__ import annotations

from typing import Any

Real = Any  # float, a long real, a double-double


def plus_product(total: Real, x: Real, y: Real) -> Real:
    """total + x·y, one term of a sum of many; the sum is to be added to a number before it is used.

    Compiled for double-doubles, the two parts of ``total`` may overlap until then: n terms have a rounding error of at
    most about n² units of 2⁻¹⁰⁶ of Σ|x·y| (Ogita, Rump & Oishi 2005, algorithm 5.3, of which this is a step).
    """
    return total + x * y
