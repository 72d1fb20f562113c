"""What the flows of the deformations share: how many digits a time takes, and what is asked of every state.

A flow asked for n digits runs over wider numbers: GUARD_DIGITS more, and as many more as there are periods in the time.
What it loses beyond that is measured on every call: from the integrals of each state, from the farthest state made
again with more digits, which tells the signs too, and from the state at τ = 0. Where digits are missing all is done
again with as many more, and PrecisionLoss ends it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from math import ceil
from typing import Any

import numpy as np

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.motion.precise import digits_of
from integrable.motion.trajectory import Motion, Way
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.state import State, onto_constraints
from jacobian import MP, RR
from jacobian.errors import ArgumentError, PrecisionLoss

GUARD_DIGITS = 18
SPARE = 2
"""Digits that a result keeps beyond those asked for."""
ROUNDING = 6
"""Digits that the additions of one period may cost."""
WIDER = 10
"""Digits by which the second computation of the farthest state is wider."""
DIGITS_STEP = 16
MOST_LOST = 400
"""What a motion may lose, beyond as many digits as are asked for."""


class Separated:
    """A motion at one precision, over ``field``: what a :class:`DeformedFlow` is made of.

    ``system`` and ``start`` are wide, ``sizes`` those of H and K that their changes are held against.
    """

    system: Any
    start: State
    sizes: tuple[Any, Any]

    @property
    def field(self) -> Any:
        """The wide numbers."""
        return self.system.field

    def turns(self, tau: Any) -> Any:
        """In how many periods |τ| is, the shorter of the two."""
        raise NotImplementedError

    def most_tau(self, t: Any) -> Any:
        """A bound of τ at a physical time."""
        return t

    def tau(self, times: list[Any], digits: int) -> list[Any]:
        """τ at physical times."""
        return times

    def times(self, tau: list[Any], digits: int) -> list[Any]:
        """Physical times at values of τ."""
        return tau

    def clock_missing(self, tau: Any, digits: int) -> int:
        """How many of so many digits the clock lacks at a τ that it gave."""
        return -digits

    def state(self, tau: Any) -> tuple[Any, Any]:
        """(γ, M) at τ."""
        raise NotImplementedError


class DeformedFlow(Motion):
    """The motion of a deformation through a state as additions on two elliptic curves, at any time, over RR or MP(n).

    Base of the flows that ``system.flow`` gives. The inputs count as exact: states come rounded once to the field,
    floats included. PrecisionLoss where more than MOST_LOST digits would be lost.
    """

    method = "elliptic curves"

    def __init__(self, system: Hamiltonian, state: State) -> None:
        super().__init__(system, state)
        # made here, so that what it refuses is refused at once
        _ = self._curves

    def _moving(self, system: Any, state: State) -> Separated:
        """The motion over the wide numbers of ``system``."""
        raise NotImplementedError

    @cached_property
    def _curves(self) -> CurveRows:
        return CurveRows(self.system, self.state, self._moving)

    def _way_to(self, times: np.ndarray, physical: bool) -> Way:
        return self._curves


class CurveRows:
    """The states of a DeformedFlow with all the digits asked for, rounded to the field of ``system``.

    ``moving``(system, state) is the motion over the wide numbers of that system.
    """

    way = DeformedFlow.method

    def __init__(self, system: Hamiltonian, state: State, moving: Callable[[Any, State], Separated]) -> None:
        self._system, self._state, self._moving = system, state, moving
        self._asked = digits_asked(system.field)
        self.motion = self._started(self._asked + GUARD_DIGITS)
        self._witness: Separated | None = None
        self._witnessed: Any = 0

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        tau, rows = self._good(times.tolist(), self._system.body.rolls)
        return rounded_rows(self._system.field, rows), rounded(self._system.field, tau)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        return rounded_rows(self._system.field, self._good(tau.tolist(), False)[1])

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        given = tau.tolist()
        while True:
            needed = self._enough(given, False)
            motion = self.motion
            wide = [motion.field.coerce(x) for x in given]
            times = motion.times(wide, needed - ROUNDING)
            missing = motion.clock_missing(max(wide, key=abs, default=motion.field.zero), self._asked + SPARE)
            if missing <= 0:
                return rounded(self._system.field, times)
            self.more_digits(motion.field.dps + min(missing, motion.field.dps) + WIDER)

    def _good(self, given: list[Any], clock: bool) -> tuple[list[Any], list[Any]]:
        """(τ, rows) with all the digits asked for; τ is the time given unless there is a ``clock``."""
        while True:
            needed = self._enough(given, clock)
            motion = self.motion
            tau = [motion.field.coerce(x) for x in given]
            if clock:
                tau = motion.tau(tau, needed - ROUNDING)
            rows = [motion.state(x) for x in tau]
            missing = self._missing(tau, rows)
            if clock and tau and missing <= 0:
                missing = motion.clock_missing(max(tau, key=abs), self._asked + SPARE)
            if missing <= 0:
                return tau, rows
            # where nothing is right it is not known how much is missing
            self.more_digits(motion.field.dps + min(missing, motion.field.dps) + WIDER)

    def _enough(self, given: list[Any], clock: bool) -> int:
        """The digits that the farthest of the times takes; now there are as many."""
        while True:
            motion = self.motion
            far = max((abs(motion.field.coerce(x)) for x in given), default=motion.field.zero)
            needed = self._needed(motion.turns(motion.most_tau(far) if clock else far))
            if needed <= motion.field.dps:
                return needed
            self.more_digits(needed)

    def _needed(self, turns: Any) -> int:
        """The digits that states so many periods away take."""
        context = self.motion.field.context
        return self._asked + SPARE + ROUNDING + ceil(float(context.log10(1 + turns)))

    def more_digits(self, digits: int) -> None:
        """Start again with that many, or a few more."""
        own = self._asked + GUARD_DIGITS
        digits = own + DIGITS_STEP * ceil((digits - own) / DIGITS_STEP)
        if digits > 2 * self._asked + MOST_LOST:
            raise PrecisionLoss(
                f"{self._system!r}: the motion loses more than {self._asked + MOST_LOST} digits on the way there; "
                "times nearer to 0 are within reach, and MP fields of more digits allow as many more"
            )
        self.motion, self._witness, self._witnessed = self._started(digits), None, 0

    def _started(self, digits: int) -> Separated:
        """The motion at that many digits, or at more where it does not start from the state."""
        for _ in range(3):
            motion = self._moving(*widened(self._system, self._state, digits))
            missing = self._difference(motion.state(motion.field.zero), (motion.start.gamma, motion.start.M), motion)
            if missing <= 0:
                return motion
            digits += min(missing, digits) + WIDER
        raise PrecisionLoss(f"{self._state!r}: it is not found again from its two points even with {digits} digits")

    def _missing(self, tau: list[Any], rows: list[Any]) -> int:
        """How many of the digits asked for the rows lack, 0 or less for none."""
        motion = self.motion
        missing = integrals_missing(motion.system, motion.start, motion.sizes, rows, self._asked + SPARE)
        far = max(range(len(tau)), key=lambda i: abs(tau[i]), default=None)
        if far is None or missing > 0 or abs(tau[far]) <= self._witnessed:
            return missing
        if self._witness is None:
            self._witness = self._moving(*widened(self._system, self._state, motion.field.dps + WIDER))
        again = self._witness.state(self._witness.field.coerce(tau[far]))
        missing = self._difference(rows[far], again, self._witness)
        if missing <= 0:
            self._witnessed = abs(tau[far])
        return missing

    def _difference(self, row: Any, truth: Any, motion: Separated) -> int:
        """How many of the digits asked for (γ, M) lacks beside another computation of it."""
        worst = -(10**9)
        for found, right in zip(row, truth, strict=True):
            size = max(map(abs, right))
            gap = max(abs(motion.field.coerce(x) - y) for x, y in zip(found, right, strict=True))
            worst = max(worst, digits_of(gap / size))
        return worst + self._asked + SPARE


def integrals_missing(system: Any, start: State, sizes: tuple[Any, Any], rows: Sequence[Any], digits: int) -> int:
    """How many of so many digits H and K of rows (γ, M) lack beside those of the start, relative to ``sizes``; over
    wide numbers, 0 or less for none.
    """
    before = system.integrals(start)[2:]
    worst = -(10**9)
    for gamma, M in rows:
        after = system.integrals(State(tuple(gamma), tuple(M)))[2:]
        worst = max(worst, *(digits_of(abs(x - y) / size) for x, y, size in zip(after, before, sizes, strict=True)))
    return worst + digits


def digits_asked(K: Any) -> int:
    """The digits that states over RR or MP(digits) are rounded to; ArgumentError for other fields."""
    if K.exact or getattr(K, "complex", False):
        raise ArgumentError(f"field = {K.name}: a motion runs over RR or MP(digits)")
    return ROUNDED_TO_FLOATS if K == RR else int(K.dps)


def widened(system: Hamiltonian, state: State, digits: int) -> tuple[Any, State]:
    """The same system and state with so many digits, the constraints made exact."""
    wide = system.over(MP(digits))
    return wide, onto_constraints(wide, state)


def rounded(K: Any, values: Any) -> np.ndarray:
    """Wide numbers as an array of elements of the field K."""
    if K == RR:
        return np.array(values, dtype=np.float64)
    result: np.ndarray = np.frompyfunc(K.coerce, 1, 1)(np.array(values, dtype=object))
    return result


def rounded_rows(K: Any, rows: Sequence[Any]) -> np.ndarray:
    """Pairs (γ, M) as an array of shape (N, 6)."""
    return rounded(K, [(*gamma, *M) for gamma, M in rows]).reshape(-1, 6)
