"""The motion with |q| = 1 from which a problem follows by scaling, to any number of digits."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cached_property
from math import ceil, hypot, log10
from typing import Any, NamedTuple

import numpy as np

from integrable.phase.precisions import FLOAT_DIGITS
from integrable.phase.state import State
from integrable.problems.units import UNITS, Unit
from integrable.scene.data import Scene
from jacobian.errors import ArgumentError, PrecisionLoss, shown
from jacobian.fields.rational import primitive

__all__ = ["UnitMotion"]

Rows = list[list[Any]]

GUARD, FINER, LEAST = 8, 12, 25
"""The first of two runs has GUARD digits more than requested, and at least LEAST; the second has FINER more digits."""
MOST_ATTEMPTS = 6
EXACT = 20
"""Extra digits of midpoints of balls: they then hold a double exactly, and their rounding is added to the radius."""
SPREAD = 0.02
"""The relative change of a start without constraints: so small that bounded motions stay bounded."""
LARGEST = 64
"""With constraints the components of q are integers below this, times a power of two."""


class Scales(NamedTuple):
    """Three factors: the motion of a problem is (q·Q(t·time), p·P(t·time)), where (Q, P) is the motion with |Q| = 1."""

    q: Any
    p: Any
    time: Any


class UnitMotion:
    """A scene in doubles, with its system, start and states in any number type.

    |q| need not be 1 (:mod:`integrable.problems.units`): states are those of the motion with |q| = 1, scaled.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.unit: Unit | None = UNITS.get(scene.system)
        self.in_floats = self.scene.body(FLOAT_DIGITS)
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

    def scales(self, system: Any) -> Scales:
        if self.unit is None:
            return Scales(1, 1, 1)
        square = system.field.coerce(self.square)
        return Scales(*(square ** (power / 2) for power in self.unit[:3]))

    def start(self, digits: int) -> tuple[Any, State]:
        """The system and its start, scaled to unit length."""
        system = self.scene.body(digits)
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
        """The states of the second of two runs that agree to ``digits`` digits, and estimates of their errors.

        An estimate is twice the largest difference of the runs in q, or in p, plus the rounding of the first run, since
        two runs may agree by chance.
        """
        first = max(digits + GUARD, LEAST)
        for _ in range(MOST_ATTEMPTS):
            coarse, fine = self.rows(times, first), self.rows(times, first + FINER)
            found = [_gaps(*pair, 10.0**-first) for pair in zip(coarse, fine, strict=True)]
            worst = float(max((relative for _, relative in found), default=0))
            if worst < 10.0 ** -(digits + 1):
                return fine, [gaps for gaps, _ in found]
            first += FINER + ceil(max(0.0, log10(worst) + digits + 1))
        raise PrecisionLoss(
            f"{self.scene.name}: no {digits} digits were found at t = {shown(max(times, key=abs))} or before with "
            f"{first} digits; ask for fewer, or for nearer times"
        )

    def enclosed(self, times: Sequence[float], digits: int) -> tuple[Rows, Rows]:
        """Midpoints and proven radii by ball arithmetic; ``digits`` are relative to the sizes of q and p.

        Raises ArgumentError where |q| ≠ 1 and p or t scale with |q|, since the scaled start and times are then not
        exact.
        """
        from jacobian.numbers.long_reals import BallReals

        scene, square, unit, system = self.scene, self.square, self.unit, self.scene.body(digits + EXACT)
        if square != 1 and unit is not None and (unit.p or unit.time):
            raise ArgumentError(
                f"proven = True: the start of {scene.name} has a length 1 + {float(square - 1) / 2:.1e}, and balls "
                "take length 1 only there; ask for an estimated radius"
            )
        K = system.field
        q, p = (tuple(K.coerce(float(x)) for x in part) for part in (scene.gamma, scene.M))
        flow = system.motion_through(State(q, p, tilted=self.tilted))
        found = flow.enclosure([K.coerce(t) for t in times], digits + 1)
        halves = (found.q, found.p) if scene.classical else (found.gamma, found.M)
        rows, radii = [], []
        with BallReals(K.context.prec) as reals:
            size = (reals.number(square.numerator) / reals.number(square.denominator)).sqrt()
            for first, second in zip(*halves, strict=True):
                balls = [*(x * size for x in first), *second] if square != 1 else [*first, *second]
                rows.append([*reals.elements(K, balls)])
                # the midpoint is rounded, so a bound of its rounding error is added to the radius
                pairs = zip(balls, rows[-1], strict=True)
                radii.append([reals.element(K, x.rad()) + 4 * abs(y) * K.context.eps for x, y in pairs])
        return rows, radii

    def another(self, rng: np.random.Generator) -> list[float]:
        """A random start of about the same size in doubles, which satisfies the constraints exactly."""
        q, p = ([float(x) for x in part] for part in (self.scene.gamma, self.scene.M))
        unit = self.unit
        if unit is None:
            return [x * (1 + SPREAD * rng.uniform(-1, 1)) for x in (*q, *p)]
        raw, push = ([int(x) for x in rng.integers(1, LARGEST, len(q)) * rng.choice((-1, 1), len(q))] for _ in "qp")
        if unit.normal or not (self.scene.classical or self.along):
            n = primitive(unit.dual(self.weights, [Fraction(x) for x in raw]))
            push = [n[i - 2] * push[i - 1] - n[i - 1] * push[i - 2] for i in range(3)]
        length = (unit.square(self.weights, raw) / self.square) ** -0.5
        return [*_scaled(raw, float(length)), *_scaled(push, hypot(*p) / (hypot(*push) or 1.0))]


def _scaled(values: Sequence[int], factor: float) -> list[float]:
    """The integers ``values``, times the power of two closest to ``factor``."""
    return [x * 2.0 ** round(np.log2(factor)) for x in values]


def _gaps(coarse: list[Any], fine: list[Any], rounding: float) -> tuple[list[Any], Any]:
    """The estimated error of each component, and the largest one relative to the largest component of its half."""
    half, gaps, relative = len(fine) // 2, list[Any](), []
    for part in (slice(0, half), slice(half, None)):
        size = max(map(abs, fine[part]))
        gap = 2 * max(abs(y - type(y)(x)) for x, y in zip(coarse[part], fine[part], strict=True)) + rounding * size
        gaps += [gap] * half
        relative.append(gap / (size or 1))
    return gaps, max(relative)
