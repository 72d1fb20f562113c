"""Rounds of a loop that know nothing of each other."""

from __future__ import annotations


def abreast(begin: int, end: int) -> range:
    """``range(begin, end)`` for a loop whose rounds may be done in any order, and more than once.

    Compiled (:mod:`jacobian.native`) eight of them are done at once, in the lanes of a processor's vectors; where fewer
    are left, the last one is done again.
    """
    return range(begin, end)
