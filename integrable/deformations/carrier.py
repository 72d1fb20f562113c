"""The motion of a deformation on two elliptic curves at one precision, and the choice of the precision for a time.

For n requested digits a motion is computed with GUARD_DIGITS more, plus the digits of the number of periods in the
time. Further loss is measured on every call: by the integrals of each state, by the farthest state computed again with
more digits, which also checks the signs, and by the state at τ = 0. If k digits are missing, everything is repeated
with k more; PrecisionLoss if this does not help.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import TYPE_CHECKING, Any

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.oval import Pace, SeparatedOval
from integrable.deformations.oval_loops import Frame, Track, lifted_state, tilde_state
from integrable.motion.precise import SPARE, WIDER, Carrier, ManyDigits
from integrable.moving_point.losses import NOTHING, digits_of
from integrable.phase.body import Vector
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.state import State, onto_constraints
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import ArgumentError, PrecisionLoss, shown, written
from jacobian.inexact.long_numbers import LongNumbers

if TYPE_CHECKING:
    from integrable.motion.precise import Compute, Found

__all__ = ["GUARD_DIGITS", "CurvesCarrier", "OnCurves", "digits_asked", "widened"]

GUARD_DIGITS = 18
ROUNDING = 6
"""Number of digits that the computation may lose for a τ within one period."""

GammaM = tuple[Vector, Vector]
"""γ and M in wide numbers."""


class CurvesCarrier(Carrier):
    """The motion of a deformation at one precision, used by a :class:`DeformedFlow`. Its points are (γ, M). Its methods
    are called inside ``with field``, which :class:`OnCurves` enters.

    ``system`` and ``start`` are over wide numbers: MP(digits), or LongNumbers in whose context it is created.
    Changes of H and K are relative to ``sizes``, the error of M relative to ``momentum`` if M = 0. A point moves on
    each of ``curves`` for the time ``speed``·τ; ``tracks`` and ``frame`` give the state, with the axes in ``order``.
    ``pace`` is dt/dτ if d ≠ 0.
    """

    system: Any
    start: State
    sizes: tuple[Real, Real]
    momentum: Real = 1
    curves: Sequence[SeparatedOval]
    tracks: Sequence[Track]
    frame: Frame
    order: Sequence[int] = (0, 1, 2)
    speed: Real = 1
    pace: Pace | None = None

    def __init__(self, system: Any, state: State) -> None:
        self.system, self.start = system, state

    @property
    def field(self) -> LongNumbers:
        """The field of the wide numbers."""
        return self.system.field

    @property
    def digits(self) -> int:  # type: ignore[override]
        return int(self.field.dps) - GUARD_DIGITS

    @property
    def rolls(self) -> bool:  # type: ignore[override]
        return self.system.body.rolls

    @property
    def period(self) -> Real:
        """The shorter of the periods of the two curves."""
        return min(curve.period for curve in self.curves)

    def turns(self, tau: Real) -> Real:
        """|τ| in periods of the curve with the shorter period."""
        return abs(self.speed * tau) / self.period

    def point(self, tau: Real) -> GammaM:
        return self.moved([self.speed * tau] * 2)

    def moved(self, times: Sequence[Real]) -> GammaM:
        """(γ, M) after the point of each curve has moved for its time in ``times``."""
        return self._state(*(curve.moved(time) for curve, time in zip(self.curves, times, strict=True)))

    def _state(self, *roots: Sequence[Real]) -> GammaM:
        """(γ, M) from the roots R_i on both curves."""
        first, second = (curve.ordered(r) for curve, r in zip(self.curves, roots, strict=True))
        found = lifted_state(self.frame, *tilde_state(self.frame, first, second, *self.tracks))
        i, j, k = (self.order.index(n) for n in range(3))
        gamma, M = ((vector[i], vector[j], vector[k]) for vector in found)
        return gamma, M

    def scaled(self, t: Real) -> Real:
        return self.field.coerce(t)

    def lost(self, tau: Real) -> int:
        return ceil(float(self.field.context.log10(1 + self.turns(tau))))

    def vectors(self, point: GammaM) -> GammaM:
        gamma, M = point
        return gamma, M

    def drift(self, points: list[GammaM]) -> int:
        before, worst = self.system.integrals(self.start)[2:], -NOTHING
        for gamma, M in points:
            rows = zip(self.system.integrals(State(tuple(gamma), tuple(M)))[2:], before, self.sizes, strict=True)
            worst = max(worst, *(digits_of(abs(x - y) / size) for x, y, size in rows))
        return worst

    def gap(self, point: GammaM, truth: CurvesCarrier, tau: Real) -> int:
        with truth.field:
            return truth.difference(point, truth.point(truth.field.coerce(tau)))

    def difference(self, row: GammaM, truth: GammaM) -> int:
        """The decimal exponent of the relative difference of (γ, M) from a more accurate computation, ``truth``."""
        worst = -NOTHING
        for found, right, unit in zip(row, truth, (1, self.momentum), strict=True):
            size = max(map(abs, right)) or unit
            gap = max(abs(self.field.coerce(x) - y) for x, y in zip(found, right, strict=True))
            worst = max(worst, digits_of(gap / size))
        return worst


class OnCurves(ManyDigits):
    """The states of a motion on curves; ``made``(system, state) is the motion over the field of ``system``."""

    carrier: CurvesCarrier
    expected = GUARD_DIGITS - SPARE - ROUNDING
    step = 16

    def __init__(self, system: Hamiltonian, state: State, made: type[CurvesCarrier]) -> None:
        self._system, self._state, self._made = system, state, made
        asked = digits_asked(system.field)
        self.digits = asked
        super().__init__(asked, self.carrier_of(asked))

    def settled(self, times: list[Real], compute: Compute[Found]) -> Found:
        def inside(carrier: Carrier, scaled: list[Real]) -> tuple[Found, int] | None:
            with self.carrier.field:
                return compute(carrier, scaled)

        return super().settled(times, inside)

    def carrier_of(self, digits: int) -> CurvesCarrier:
        """The motion with that many digits, or more if its point at τ = 0 does not reproduce the state."""
        for _ in range(3):
            with LongNumbers(digits + GUARD_DIGITS) as numbers:
                carrier = self._made(*widened(self._system, self._state, numbers))
                gap = carrier.difference(carrier.point(carrier.field.zero), carrier.start.vectors)
            missing = gap + self.digits + SPARE
            if missing <= 0:
                return carrier
            digits += min(missing, digits) + WIDER
        raise PrecisionLoss(
            f"{shown(self._state)}: it is not found again from its two points even with {written(digits)} digits"
        )


def digits_asked(K: Any) -> int:
    """The digits to which states over RR or MP(digits) are rounded; ArgumentError for other fields."""
    if K.exact or K.complex:
        raise ArgumentError(f"field = {K.name}: a motion runs over RR or MP(digits)")
    return ROUNDED_TO_FLOATS if K == RR else int(K.dps)


def widened(system: Hamiltonian, state: State, numbers: Any) -> tuple[Any, State]:
    """The same system and state over a field of more digits, with the state projected onto its constraints."""
    wide = system.over(numbers)
    return wide, onto_constraints(wide, state)
