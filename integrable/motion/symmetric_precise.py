"""Motions in closed form in multiprecision, at any time: two or three equal moments, and rotations about an axis.

The form is that of :mod:`integrable.motion.symmetric` in bare reals. The working digits are those requested, plus the
digits that the turns until the farthest time take, plus the digits found missing when the state at this time is
computed again with more digits.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import ceil
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from gmpy2 import log10

from integrable.motion.symmetric import SymmetricFlow
from integrable.moving_point.arithmetic import Multiprecision
from integrable.moving_point.losses import digits_of
from jacobian import MP
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.numbers.long_reals import BareReals

if TYPE_CHECKING:
    Compute: TypeAlias = Callable[[SymmetricFlow, np.ndarray], tuple[np.ndarray, ...]]
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

# a computation has the field's digits, as many more as the angles have before the decimal point, and GUARD more. A
# second one, at the farthest time, has WIDER more, and both must agree to SPARE digits beyond the field's
GUARD = 15
WIDER = 15
SPARE = 2
# largest number of missing digits that are added
MOST_LOST = 2000


class PreciseClosedForm:
    """Computes γ and M at any times over MP(digits), correct to all digits, by the closed form in wider fields."""

    way = "closed form"

    def __init__(self, system: PhaseSpace, state: State) -> None:
        self._system, self._state = system, state
        self._field: Any = system.field
        self._forms: dict[int, SymmetricFlow] = {}

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""
        rows, tau = self._computed(self._digits(times, of_flow=False), times, lambda form, t: form.at(t))
        return rows, tau

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M side by side at values of τ: shape (N, 6)."""
        return self._computed(self._digits(tau, of_flow=True), tau, lambda form, t: (form.at_tau(t),))[0]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """The physical times t(τ) at values of τ: shape (N,)."""
        return self._computed(self._digits(tau, of_flow=True), tau, lambda form, t: (form.times(t),))[0]

    def _form(self, digits: int) -> SymmetricFlow:
        if digits not in self._forms:
            self._forms[digits] = SymmetricFlow(self._system, self._state, Multiprecision(MP(digits).context.prec))
        return self._forms[digits]

    def _computed(self, digits: int, times: np.ndarray, compute: Compute, field: Any = None) -> tuple[np.ndarray, ...]:
        """Evaluates the closed form with ``digits`` digits; the results are elements of ``field``, by default the
        system's.
        """
        form = self._form(digits)
        with form.numbers.field as K:
            found = compute(form, np.frompyfunc(K.coerce, 1, 1)(times))
        element = partial(BareReals(K.bits).element, field or self._field)
        return tuple(np.frompyfunc(element, 1, 1)(values) for values in found)

    def _digits(self, times: np.ndarray, of_flow: bool) -> int:
        """The working digits at which the state at the farthest time agrees with a computation in WIDER more digits."""
        own = int(self._field.dps)
        rough = self._form(own + GUARD)
        farthest = np.array([max(times, key=abs)] if len(times) else [], dtype=object)
        if not len(farthest):
            return own + GUARD
        with rough.numbers.field as K:
            turned = float(log10(rough.radians(K.coerce(farthest[0]), of_flow)))
        # digits are added in steps of ten, so that few set-ups serve many calls
        digits = own + GUARD + 10 * ceil(max(0.0, turned) / 10)
        while digits <= own + MOST_LOST + 2 * int(turned):
            row, wide = (self._row(digits + more, farthest, of_flow) for more in (0, WIDER))
            size = max(map(abs, wide[3:]))
            gaps = [abs(x - y) / scale for x, y, scale in zip(row, wide, [1] * 3 + [size] * 3, strict=True)]
            missing = digits_of(max(gaps)) + own + SPARE
            if missing <= 0:
                return digits
            digits += max(10, 10 * ceil(missing / 10))
        raise PrecisionLoss(
            f"time {farthest[0]}: {digits} digits do not make {own} of the state there; give other units"
        )

    def _row(self, digits: int, times: np.ndarray, of_flow: bool) -> list[Real]:
        """γ and M at one time, to that many digits."""
        rows = self._computed(
            digits, times, lambda form, t: (form.at_tau(t) if of_flow else form.at(t)[0],), MP(digits)
        )[0]
        row: list[Real] = rows[0].tolist()
        return row
