"""The common part of the flows of the deformations: how many digits a time needs, and the checks of every state.

For n requested digits a flow uses wider numbers: GUARD_DIGITS more, plus the digits of the number of periods in the
time. Any further loss is measured on every call: from the integrals of each state, from the farthest state computed
again with more digits, which also checks the signs, and from the state at τ = 0. If digits are missing, everything is
repeated with that many more; PrecisionLoss if this does not help.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import cached_property, wraps
from math import ceil
from typing import Any

import numpy as np

from integrable.deformations.enclosed import EnclosedMotion
from integrable.deformations.equations import STEPS_TO_DIGITS, WalkFirst
from integrable.deformations.hamiltonian import Hamiltonian
from integrable.motion.precise import SPARE, WIDER, Carrier, ManyDigits, RoundedRows
from integrable.motion.trajectory import Way
from integrable.moving_point.losses import NOTHING, digits_of
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.state import State, onto_constraints
from jacobian import RR
from jacobian.errors import ArgumentError, PrecisionLoss, shown, written
from jacobian.inexact.long_numbers import LongNumbers
from jacobian.numbers.compiler import interpreted

__all__ = ["DeformedFlow"]

GUARD_DIGITS = 18
ROUNDING = 6
"""Digits that the additions of one period may cost."""


def at_its_precision(method: Any) -> Any:
    """The method of a carrier, computed with its ``precision``."""

    @wraps(method)
    def inside(self: Any, *arguments: Any) -> Any:
        with self.precision:
            return method(self, *arguments)

    return inside


class CurvesCarrier(Carrier):
    """The motion of a deformation at one precision, used by a :class:`DeformedFlow`. Its points are (γ, M).

    ``system`` and ``start`` are wide, of LongNumbers that were entered when it was made or of MP(digits); ``sizes``
    those of H and K that their changes are held against, ``momentum`` what an M = 0 is.
    """

    system: Any
    start: State
    sizes: tuple[Any, Any]
    momentum: Any = 1

    @property
    def field(self) -> Any:
        """The wide numbers."""
        return self.system.field

    @property
    def precision(self) -> Any:
        """The context of its numbers."""
        return self.field if isinstance(self.field, LongNumbers) else nullcontext()

    @property
    def digits(self) -> int:  # type: ignore[override]
        return int(self.field.dps) - GUARD_DIGITS

    @property
    def rolls(self) -> bool:  # type: ignore[override]
        return self.system.body.rolls

    def turns(self, tau: Any) -> Any:
        """The number of shorter periods in |τ|."""
        raise NotImplementedError

    def scaled(self, t: Any) -> Any:
        return self.field.coerce(t)

    @at_its_precision
    def lost(self, tau: Any) -> int:
        return ceil(float(self.field.context.log10(1 + self.turns(tau))))

    def vectors(self, point: Any) -> tuple[Any, Any]:
        gamma, M = point
        return gamma, M

    @at_its_precision
    def drift(self, points: list[Any]) -> int:
        return integrals_missing(self.system, self.system.integrals(self.start)[2:], self.sizes, points, 0)

    def gap(self, point: Any, truth: CurvesCarrier, tau: Any) -> int:
        return truth.difference(point, truth.point(truth.field.coerce(tau)))

    @at_its_precision
    def difference(self, row: Any, truth: Any) -> int:
        """The decimal exponent of the relative difference of (γ, M) and another computation of it."""
        worst = -NOTHING
        for found, right, unit in zip(row, truth, (1, self.momentum), strict=True):
            size = max(map(abs, right)) or unit
            gap = max(abs(self.field.coerce(x) - y) for x, y in zip(found, right, strict=True))
            worst = max(worst, digits_of(gap / size))
        return worst


class DeformedFlow(EnclosedMotion):
    """The motion of a deformation through a state as additions on two elliptic curves, at any time, over RR or MP(n).

    Base of the flows that ``system.flow`` gives. The inputs count as exact: states come rounded once to the field,
    floats included. The same times give the same states, to the last bit, whatever was computed before. Only when the
    walk of a kind of systems is compiled, once on a machine, may last bits change
    (:class:`integrable.series.kinds.Kind`). PrecisionLoss where more than MOST_LOST digits would be lost.
    """

    method = "elliptic curves"

    def __init__(self, system: Hamiltonian, state: State) -> None:
        super().__init__(system, state)
        if not self._is_ordinary():
            # computed here so that refusals are raised at once
            _ = self._curves

    def _moving(self, system: Any, state: State) -> CurvesCarrier:
        """The motion over the wide numbers of ``system``."""
        raise NotImplementedError

    @cached_property
    def _curves(self) -> RoundedRows:
        return RoundedRows(self.system.field, OnCurves(self.system, self.state, self._moving), self.method)

    def _is_ordinary(self) -> bool:
        """Whether floats already show that nothing will be refused."""
        return False

    _steps = STEPS_TO_DIGITS
    """Steps along series that take as long as :attr:`_any_time` does to begin."""

    @property
    def _any_time(self) -> Way:
        """The method for states at any time."""
        return self._curves

    def _way_to(self, times: np.ndarray, physical: bool) -> Way:
        if self.system.field != RR or interpreted():
            return self._any_time
        return WalkFirst(self.system, self.state, lambda: self._any_time, self._steps)


class OnCurves(ManyDigits):
    """The states of a DeformedFlow; ``moving``(system, state) is the motion over the wide numbers of that system."""

    expected = GUARD_DIGITS - SPARE - ROUNDING
    step = 16

    def __init__(self, system: Hamiltonian, state: State, moving: Callable[[Any, State], CurvesCarrier]) -> None:
        self._system, self._state, self._moving = system, state, moving
        asked = digits_asked(system.field)
        self.digits = asked
        super().__init__(asked, self.carrier_of(asked))

    def carrier_of(self, digits: int) -> CurvesCarrier:
        """The motion at that many digits, or at more where it does not start from the state."""
        for _ in range(3):
            with LongNumbers(digits + GUARD_DIGITS) as numbers:
                carrier = self._moving(*widened(self._system, self._state, numbers))
            start = carrier.start.gamma, carrier.start.M
            missing = carrier.difference(carrier.point(carrier.field.zero), start) + self.digits + SPARE
            if missing <= 0:
                return carrier
            digits += min(missing, digits) + WIDER
        raise PrecisionLoss(
            f"{shown(self._state)}: it is not found again from its two points even with {written(digits)} digits"
        )


def integrals_missing(
    system: Any, before: tuple[Any, Any], sizes: tuple[Any, Any], rows: Sequence[Any], digits: int
) -> int:
    """How many of these digits H and K of rows (γ, M) lack compared with ``before``, relative to ``sizes``; over wide
    numbers, 0 or less if none.
    """
    worst = -NOTHING
    for gamma, M in rows:
        after = system.integrals(State(tuple(gamma), tuple(M)))[2:]
        worst = max(worst, *(digits_of(abs(x - y) / size) for x, y, size in zip(after, before, sizes, strict=True)))
    return worst + digits


def digits_asked(K: Any) -> int:
    """The digits to which states over RR or MP(digits) are rounded; ArgumentError for other fields."""
    if K.exact or K.complex:
        raise ArgumentError(f"field = {K.name}: a motion runs over RR or MP(digits)")
    return ROUNDED_TO_FLOATS if K == RR else int(K.dps)


def widened(system: Hamiltonian, state: State, numbers: Any) -> tuple[Any, State]:
    """The same system and state over a field of more digits, the constraints made exact."""
    wide = system.over(numbers)
    return wide, onto_constraints(wide, state)
