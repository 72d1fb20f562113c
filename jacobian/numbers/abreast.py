"""The range of a loop whose rounds are independent, so that compiled code can run them in SIMD lanes."""

from __future__ import annotations


def abreast(begin: int, end: int) -> range:
    """``range(begin, end)``, for a loop whose rounds may run in any order, and more than once.

    Compiled code (:mod:`jacobian.native`) runs eight rounds at once in SIMD lanes. If fewer than eight are left, the
    last one is repeated.
    """
    return range(begin, end)
