"""Motions in closed form in multiprecision, at any time: two or three equal moments, and rotations about an axis.

The formulas are those of :mod:`integrable.motion.symmetric` in bare reals. The number of working digits is a
sum: the digits requested, those of the whole part of the angle of rotation until the farthest time, and those that
:class:`integrable.motion.precise.ManyDigits` finds missing.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
from gmpy2 import log10

from integrable.motion.precise import Carrier, ManyDigits, farthest
from integrable.motion.symmetric import SymmetricFlow
from integrable.moving_point.arithmetic import Multiprecision
from integrable.moving_point.losses import NOTHING, digits_of
from jacobian import MP
from jacobian.element import Real
from jacobian.numbers.long_reals import BareReals

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

# digits of a computation in addition to those of its results
GUARD = 15


class ClosedCarrier(Carrier):
    """The closed form at one precision; its points are (γ, M)."""

    def __init__(self, system: PhaseSpace, state: State, digits: int) -> None:
        self.digits, self.field, self.rolls = digits, MP(digits + GUARD), system.body.rolls
        self._form = SymmetricFlow(system, state, Multiprecision(self.field.context.prec))
        self._element = partial(BareReals(self.field.context.prec).element, self.field)
        self._pace = self._element(self._form.paces[0])

    def most_tau(self, t: Real) -> Real:
        return t * self._pace

    def lost(self, tau: Real) -> int:
        with self._form.numbers.field as K:
            return ceil(log10(self._form.radians(K.coerce(tau))))

    def at(self, times: list[Real]) -> tuple[list[Real], list[Any]]:
        """τ and (γ, M) at physical times."""
        rows, tau = self._computed(self._form.at, times)
        return tau, [(row[:3], row[3:]) for row in rows]

    def points(self, tau: list[Real]) -> list[Any]:
        return [(row[:3], row[3:]) for row in self._computed(self._form.at_tau, tau)[0]]

    def times(self, tau: list[Real], digits: int) -> list[Real]:
        return self._computed(self._form.times, tau)[0]

    def clock_missing(self, tau: Real, digits: int) -> int:
        (again,), _ = self.at(self.times([tau], digits))
        return digits_of(abs(again - tau) / (abs(tau) or 1)) + digits

    def drift(self, points: list[Any]) -> int:
        # every point is computed from the start alone, so no drift accumulates
        return -NOTHING

    def _computed(self, compute: Callable[[np.ndarray], Any], times: list[Real]) -> list[list[Any]]:
        with self._form.numbers.field as K:
            found = compute(np.array([K.coerce(t) for t in times], dtype=object))
        arrays = found if isinstance(found, tuple) else (found,)
        return [np.frompyfunc(self._element, 1, 1)(values).tolist() for values in arrays]


class PreciseClosedForm(ManyDigits):
    """γ and M at any times to ``digits`` digits, by the closed form."""

    carrier: ClosedCarrier
    expected, step, most_lost = 0, 10, 2000

    def __init__(self, system: PhaseSpace, state: State, digits: int) -> None:
        self._motion = system, state
        super().__init__(digits, self.carrier_of(digits))

    def carrier_of(self, digits: int) -> ClosedCarrier:
        return ClosedCarrier(*self._motion, digits)

    def enough(self, tau: Real) -> int | None:
        # digits lost in many turns are cheap: the limit of lost digits grows with τ, so that no time is too far
        self.most_lost = max(self.most_lost, type(self).most_lost + self.carrier.lost(tau))
        return super().enough(tau)

    def _at(self, carrier: Any, times: list[Real]) -> tuple[tuple[list[Real], list[Any]], int] | None:
        if times and self.enough(carrier.most_tau(farthest(times))) is None:
            return None
        tau, points = carrier.at(times)
        return (tau, points), self._missing(carrier, tau, points)
