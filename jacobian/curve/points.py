"""Points of a hyperelliptic curve: affine ones are pairs of raw elements, those at infinity are named."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from jacobian.errors import shown


class AffinePoint(NamedTuple):
    """The point (x, y); equal to the plain pair."""

    x: Any
    y: Any

    def __repr__(self) -> str:
        return f"AffinePoint(x={shown(self.x)}, y={shown(self.y)})"


@dataclass(frozen=True)
class PointAtInfinity:
    """A rational point at infinity: sign +1 or −1 for ∞₊ and ∞₋ of a split model, 0 for the only one of a ramified
    model.
    """

    sign: int

    def __repr__(self) -> str:
        return {1: "∞₊", -1: "∞₋", 0: "∞"}[self.sign]


INFINITY = PointAtInfinity(0)
INFINITY_PLUS = PointAtInfinity(1)
INFINITY_MINUS = PointAtInfinity(-1)

Point = AffinePoint | PointAtInfinity
