"""Starts whose vector q does not have unit length, and how each system's equations scale with that length.

The systems of this package require |q| = 1, or Σq_i²/a_i = 1. In three dimensions only vectors along the axes have
exactly unit length in doubles. But the equations of motion hold for any length s: q = s^α·Q, p = s^β·P, t = T/s^δ,
where (Q, P) is the motion of unit length in the time T. So a start in doubles needs no rounding.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

__all__ = ["UNITS", "Unit"]


class Unit(NamedTuple):
    """How a system scales with the length s of q: q = s^``q``·Q, p = s^``p``·P and t = T/s^``time``, (Q, P) being the
    motion of length 1 in its time T. ``weighted``: the length is √Σq_i²/a_i with the constants a_i of the system.
    ``normal``: p is orthogonal to :meth:`dual`.
    """

    q: float
    p: float
    time: float
    weighted: bool = False
    normal: bool = True

    def square(self, constants: Sequence[Any], q: Sequence[Any]) -> Any:
        """The square of the length s, in the number type of ``q``."""
        return sum(x * y for x, y in zip(self.dual(constants, q), q, strict=True))

    def along(self, constants: Sequence[Any], q: Sequence[Any], p: Sequence[Any]) -> Any:
        """The scalar product of p with :meth:`dual`, which must be 0 if ``normal``."""
        return sum(x * y for x, y in zip(self.dual(constants, q), p, strict=True))

    def dual(self, constants: Sequence[Any], q: Sequence[Any]) -> list[Any]:
        """The vector q; if ``weighted``, the vector of the q_i/a_i, where the ``constants`` are the a_i."""
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
"""How each system with constraints scales; the other systems have no constraints."""
