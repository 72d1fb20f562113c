"""Loops whose rounds are independent."""

from __future__ import annotations


def abreast(begin: int, end: int) -> range:
    """``range(begin, end)`` for a loop whose rounds may be done in any order, and more than once.

    Compiled code (:mod:`jacobian.native`) does eight rounds at once, in the lanes of the processor's vectors; if fewer
    are left, the last one is repeated.
    """
    return range(begin, end)
