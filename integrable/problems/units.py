"""Starts off the unit sphere: the equations of each system for a state whose vector q is not of unit length.

A system of this package has |q| = 1, or Σq²/a = 1. Apart from the axes, no vector of doubles has exactly unit length.
The equations of motion, as the systems write them, hold for any length s: q = s^a·Q, p = s^b·P, t = T/s^c, where (Q, P)
moves in T with unit length. So a start in doubles needs no rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

__all__ = ["UNITS", "Unit"]


class Unit(NamedTuple):
    """``q``, ``p`` and ``time`` are the powers a, b and c of a length. ``weighted``: the length is √Σq²/a. ``normal``:
    p is orthogonal to q (if weighted, to q/a)."""

    q: float
    p: float
    time: float
    weighted: bool = False
    normal: bool = True

    def square(self, constants: Sequence[Any], q: Sequence[Any]) -> Any:
        """s², in the numbers given."""
        return sum(x * y for x, y in zip(self.dual(constants, q), q, strict=True))

    def along(self, constants: Sequence[Any], q: Sequence[Any], p: Sequence[Any]) -> Any:
        """The product that is 0 where ``normal``."""
        return sum(x * y for x, y in zip(self.dual(constants, q), p, strict=True))

    def dual(self, constants: Sequence[Any], q: Sequence[Any]) -> list[Any]:
        """q, or q/a."""
        return [x / a for x, a in zip(q, constants, strict=True)] if self.weighted else list(q)


BODY = Unit(1, 0, 0, normal=False)
UNITS = {
    "chaplygin_ball": BODY,
    "euler_top": BODY,
    "ellipsoid": Unit(1, 1, 0, weighted=True),
    "lagrange": Unit(1, 0.5, 0.5, normal=False),
    "neumann": Unit(1, 1, 0),
    "spherical_pendulum": Unit(1, 0.5, -0.5),
    "veselova": Unit(1, 0, 0),
}
"""By system; the others have no constraints."""
