"""Sums of many products of bare numbers of any kind.

Compiled code has its own versions of these functions: :mod:`jacobian.native.special`.
"""

from __future__ import annotations

from typing import Any

Real = Any  # float, a long real, a double-double


def plus_product(total: Real, x: Real, y: Real) -> Real:
    """total + x·y, one step of a long sum; the sum must be added to a number before it is used.

    Compiled for double-doubles, the two parts of ``total`` may overlap until then: n terms have a rounding error of at
    most about n² units of 2⁻¹⁰⁶ of Σ|x·y| (Ogita, Rump & Oishi 2005, algorithm 5.3, of which this is a step).
    """
    return total + x * y


def joined(first: Real, second: Real) -> Real:
    """The sum of two such sums, a number whose parts do not overlap: with an error of 2⁻¹⁰⁴ of the larger one."""
    return first + second
