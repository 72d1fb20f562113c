"""Sums of many products of bare numbers of any kind.

Compiled code has its own versions of these functions: :mod:`jacobian.native.special`.
"""

from __future__ import annotations

from typing import Any

Real = Any  # float, a long real, a double-double


def plus_product(total: Real, x: Real, y: Real) -> Real:
    """total + x·y, one step of a long sum, which :func:`joined` ends.

    In compiled double-double code the two parts of ``total`` may overlap, so it may be used only as a summand. The
    rounding error of n terms is at most about n²·2⁻¹⁰⁶·Σ|x·y|. This is one step of algorithm 5.3 of Ogita, Rump &
    Oishi 2005.
    """
    return total + x * y


def joined(first: Real, second: Real) -> Real:
    """first + second, for sums built by :func:`plus_product`. The parts of the result do not overlap. Its error is at
    most 2⁻¹⁰⁴ times the larger summand."""
    return first + second
