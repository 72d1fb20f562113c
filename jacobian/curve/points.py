"""Points of a hyperelliptic curve: affine ones are pairs of raw elements, those at infinity are named ∞, ∞₊ or ∞₋."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeAlias

from jacobian.element import Element, Value
from jacobian.errors import shown


class AffinePoint(NamedTuple, Generic[Element]):
    """The affine point (x, y). It equals the plain tuple (x, y)."""

    x: Element
    y: Element

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

Point: TypeAlias = AffinePoint[Element] | PointAtInfinity
Given: TypeAlias = Iterable[Element | Value] | PointAtInfinity
"""The arguments that are read as points: a pair (x, y), or a point at infinity."""
