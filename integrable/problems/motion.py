"""The motion with |q| = 1 from which a problem follows by scaling, to any number of digits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from math import ceil, log10
from typing import Any, NamedTuple

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.problems.units import UNITS, Unit
from integrable.scene.data import Scene
from jacobian.errors import ArgumentError, PrecisionLoss, shown

__all__ = ["Rows", "UnitMotion"]

Rows = list[list[Any]]

GUARD, FINER, LEAST = 8, 12, 25
"""The first of two runs has GUARD digits more than requested, and at least LEAST; the second has FINER more digits."""
MOST_ATTEMPTS = 6


class Scales(NamedTuple):
    """The factors of q and p, and the divisor of times, that scale a motion of unit length to that of a problem."""

    q: Any
    p: Any
    time: Any


class UnitMotion:
    """A scene in doubles, with its system, start and states in any number type.

    In the states |q| is that of the start in doubles (:mod:`integrable.problems.units`).
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.unit: Unit | None = UNITS.get(scene.system)
        self.in_floats = self.system(FLOAT_DIGITS)
        weighted = self.unit is not None and self.unit.weighted
        self.weights = [Fraction(float(x)) for x in self.in_floats.system.constants] if weighted else []
        self.start(FLOAT_DIGITS)
        if self.unit is not None and self.unit.normal and (off := self.along):
            raise ArgumentError(
                f"{scene.place}: [start] q and p in doubles are {float(off):.1e} from being orthogonal; a problem is "
                "exact: give doubles that meet the constraint, such as q = (1/3, 2/3, 2/3), p = (1/2, 5/4, -3/2)"
            )

    @cached_property
    def square(self) -> Fraction:
        """The exact square of the length of q."""
        return Fraction(self.unit.square(self.weights, self.scene.gamma)) if self.unit is not None else Fraction(1)

    @cached_property
    def along(self) -> Fraction:
        """The exact value of (γ, M), or of the scalar product :meth:`Unit.along` of q and p."""
        unit = self.unit
        return Fraction(unit.along(self.weights, self.scene.gamma, self.scene.M)) if unit is not None else Fraction(0)

    @property
    def tilted(self) -> bool:
        """Whether the system is a body and (γ, M) ≠ 0."""
        return not self.scene.classical and self.along != 0

    def system(self, digits: int) -> Any:
        """The system in floats up to 15 digits, else over MP(digits)."""
        return self.scene.body(digits)

    def scales(self, system: Any) -> Scales:
        """The scales in the number type of a system."""
        if self.unit is None:
            return Scales(1, 1, 1)
        context = getattr(system.field, "context", None)
        if context is None:
            return Scales(*(float(self.square) ** (power / 2) for power in self.unit[:3]))
        square = context.mpf(self.square.numerator) / self.square.denominator
        return Scales(*(square ** (context.mpf(power) / 2) for power in self.unit[:3]))

    def start(self, digits: int) -> tuple[Any, State]:
        """The system and its start, scaled to unit length."""
        system = self.system(digits)
        number, scales = system.field.coerce, self.scales(system)
        q = tuple(number(float(x)) / scales.q for x in self.scene.gamma)
        p = tuple(number(float(x)) / scales.p for x in self.scene.M)
        if self.scene.classical:
            return system, system.onto_constraints(State(q, p))
        return system, system.state(q, p, **({"tilted": True} if self.tilted else {}))

    def rows(self, times: Sequence[float], digits: int) -> Rows:
        """The states at times as mpmath numbers, computed by this package at ``digits`` digits."""
        system, state = self.start(digits)
        scales = self.scales(system)
        found = system.motion_through(state).at([system.field.coerce(t) * scales.time for t in times])
        pairs = zip(found.gamma, found.M, strict=True)
        return [[*(x * scales.q for x in q), *(x * scales.p for x in p)] for q, p in pairs]

    def settled(self, times: Sequence[float], digits: int) -> tuple[Rows, Rows]:
        """The rows of the second of two runs that agree to ``digits`` digits, and their radii.

        A radius is twice the largest difference in q, or in p, plus the rounding of the first run. The rounding is
        added because two runs may agree by chance.
        """
        first = max(digits + GUARD, LEAST)
        for _ in range(MOST_ATTEMPTS):
            coarse, fine = self.rows(times, first), self.rows(times, first + FINER)
            gaps = [_gaps(*pair, 10.0**-first) for pair in zip(coarse, fine, strict=True)]
            parts = (gap / size for one, row in zip(gaps, fine, strict=True) for gap, size in _by_half(one, row))
            worst = float(max(parts, default=0))
            if worst < 10.0 ** -(digits + 1):
                return fine, gaps
            first += FINER + ceil(max(0.0, log10(worst) + digits + 1))
        raise PrecisionLoss(
            f"{self.scene.name}: no {digits} digits were found at t = {shown(max(times, key=abs))} or before with "
            f"{first} digits; ask for fewer, or for nearer times"
        )


def _gaps(coarse: list[Any], fine: list[Any], rounding: float) -> list[Any]:
    half, found = len(fine) // 2, []
    differences = [abs(y - type(y)(x)) for x, y in zip(coarse, fine, strict=True)]
    for i in (0, half):
        found += [2 * max(differences[i : i + half]) + rounding * max(map(abs, fine[i : i + half]))] * half
    return found


def _by_half(gaps: list[Any], row: list[Any]) -> list[tuple[Any, Any]]:
    """For q and for p: the pair of a gap and the size of that half of ``row`` (its largest component, or 1 if 0)."""
    half = len(row) // 2
    return [(gaps[i], max(map(abs, row[i : i + half])) or 1) for i in (0, half)]
