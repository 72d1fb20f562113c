"""What the flows of the deformations share: how many digits a time takes, and what is asked of every state.

A flow asked for n digits runs over wider numbers: GUARD_DIGITS more, and as many more as there are periods in the time.
What it loses beyond that is measured on every call: from the integrals of each state, from the farthest state made
again with more digits, which tells the signs too, and from the state at τ = 0. Where digits are missing all is done
again with as many more, and PrecisionLoss ends it.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any

import numpy as np

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.motion.precise import digits_of
from integrable.phase.precisions import ROUNDED_TO_FLOATS
from integrable.phase.state import State
from jacobian import MP, RR
from jacobian.errors import ArgumentError, PrecisionLoss, one_or_more
from jacobian.immutable import Immutable, Record

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


class DeformedTrajectory(Record):
    """γ and M of shape (N, 3) at physical times ``times`` and times ``tau`` of the flow, shape (N,), dτ = g dt.

    ``times`` is None where only τ was asked for at d ≠ 0. ``report`` is the report of a scene's run, or None.
    """

    def __init__(
        self, times: np.ndarray | None, tau: np.ndarray | None, gamma: np.ndarray, M: np.ndarray, report: Any = None
    ) -> None:
        self.times = times
        self.tau = tau
        self.gamma = gamma
        self.M = M
        self.report = report

    def __len__(self) -> int:
        return len(self.gamma)


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

    def clock_missing(self, tau: Any, digits: int) -> int:
        """How many of so many digits the clock lacks at a τ that it gave."""
        return -digits

    def state(self, tau: Any) -> tuple[Any, Any]:
        """(γ, M) at τ."""
        raise NotImplementedError


class DeformedFlow(Immutable):
    """The motion of a deformation through a state as additions on two elliptic curves, at any time, over RR or MP(n).

    Base of the flows that ``system.flow`` gives. The inputs count as exact: states come rounded once to the field,
    floats included. PrecisionLoss where more than MOST_LOST digits would be lost.
    """

    method = "elliptic curves"
    _caches = ("_motion", "_witness", "_witnessed")

    def __init__(self, system: Hamiltonian, state: State) -> None:
        self.system, self.state = system, state
        self._asked = digits_asked(system.field)
        self._motion = self._started(self._asked + GUARD_DIGITS)
        self._witness: Separated | None = None
        self._witnessed: Any = 0

    def __reduce__(self) -> Any:
        return type(self), (self.system, self.state)

    def at(self, times: Any) -> DeformedTrajectory:
        """The states at physical times t, of any order, size and sign."""
        return self._at(times, "times", physical=True)

    def at_tau(self, tau: Any) -> DeformedTrajectory:
        """The states at values of the flow's own time τ, dτ = g dt (τ = t at d = 0), of any order, size and sign."""
        return self._at(tau, "tau", physical=not self.system.body.rolls)

    # --- inside

    def _moving(self, system: Any, state: State) -> Separated:
        """The motion over the wide numbers of ``system``."""
        raise NotImplementedError

    def _at(self, values: Any, argument: str, physical: bool) -> DeformedTrajectory:
        K = self.system.field
        given = numbers_of(K, values, argument)
        tau, rows = self._good(given, physical)
        if not physical:
            return motion_of(K, None, given, rows)
        return motion_of(K, given, given if tau is None else tau, rows)

    def _good(self, given: list[Any], physical: bool) -> tuple[list[Any] | None, list[Any]]:
        """(τ, rows) with all the digits asked for; τ is None where it is the time given."""
        clock = physical and self.system.body.rolls
        while True:
            motion = self._motion
            tau = [motion.field.coerce(x) for x in given]
            far = max(map(abs, tau), default=motion.field.zero)
            needed = self._needed(motion.turns(motion.most_tau(far) if clock else far))
            if needed > motion.field.dps:
                self._more_digits(needed)
                continue
            if clock:
                tau = motion.tau(tau, needed - ROUNDING)
            rows = [motion.state(x) for x in tau]
            missing = self._missing(tau, rows)
            if clock and tau and missing <= 0:
                missing = motion.clock_missing(max(tau, key=abs), self._asked + SPARE)
            if missing <= 0:
                return tau if clock else None, rows
            # where nothing is right it is not known how much is missing
            self._more_digits(motion.field.dps + min(missing, motion.field.dps) + WIDER)

    def _needed(self, turns: Any) -> int:
        """The digits that states so many periods away take."""
        context = self._motion.field.context
        return self._asked + SPARE + ROUNDING + ceil(float(context.log10(1 + turns)))

    def _more_digits(self, digits: int) -> None:
        """Start again with that many, or a few more."""
        own = self._asked + GUARD_DIGITS
        digits = own + DIGITS_STEP * ceil((digits - own) / DIGITS_STEP)
        if digits > 2 * self._asked + MOST_LOST:
            raise PrecisionLoss(
                f"{self.system!r}: the motion loses more than {self._asked + MOST_LOST} digits on the way there; times "
                "nearer to 0 are within reach, and MP fields of more digits allow as many more"
            )
        vars(self).update(_motion=self._started(digits), _witness=None, _witnessed=0)

    def _started(self, digits: int) -> Separated:
        """The motion at that many digits, or at more where it does not start from the state."""
        for _ in range(3):
            motion = self._moving(*widened(self.system, self.state, digits))
            missing = self._difference(motion.state(motion.field.zero), (motion.start.gamma, motion.start.M), motion)
            if missing <= 0:
                return motion
            digits += min(missing, digits) + WIDER
        raise PrecisionLoss(f"{self.state!r}: it is not found again from its two points even with {digits} digits")

    def _missing(self, tau: list[Any], rows: list[Any]) -> int:
        """How many of the digits asked for the rows lack, 0 or less for none."""
        motion = self._motion
        missing = integrals_missing(motion.system, motion.start, motion.sizes, rows, self._asked + SPARE)
        far = max(range(len(tau)), key=lambda i: abs(tau[i]), default=None)
        if far is None or missing > 0 or abs(tau[far]) <= self._witnessed:
            return missing
        if self._witness is None:
            vars(self)["_witness"] = self._moving(*widened(self.system, self.state, motion.field.dps + WIDER))
        assert self._witness is not None
        again = self._witness.state(self._witness.field.coerce(tau[far]))
        missing = self._difference(rows[far], again, self._witness)
        if missing <= 0:
            vars(self)["_witnessed"] = abs(tau[far])
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
    wide = MP(digits)
    gamma, M = ([wide.coerce(x) for x in v] for v in (state.gamma, state.M))
    length = wide.sqrt(wide.dot(gamma, gamma))
    gamma = [x / length for x in gamma]
    tilt = wide.dot(gamma, M)
    M = [m - tilt * x for x, m in zip(gamma, M, strict=True)]
    return system.over(wide), State(tuple(gamma), tuple(M))


def numbers_of(K: Any, values: Any, argument: str) -> list[Any]:
    """The values, or one, as elements of K; FieldError that names ``argument``."""
    return [K.coerce(x, f"{argument}[{i}]") for i, x in enumerate(one_or_more(values, argument))]


def motion_of(K: Any, times: Any, tau: Any, rows: Sequence[Any]) -> DeformedTrajectory:
    """Times and rows (γ, M) rounded to the field K."""
    kind = np.float64 if K == RR else object
    number = float if K == RR else K.coerce

    def table(values: Any) -> np.ndarray:
        return np.array([[number(x) for x in row] for row in values], dtype=kind).reshape(-1, 3)

    t, s = (None if x is None else np.array([number(y) for y in x], dtype=kind) for x in (times, tau))
    return DeformedTrajectory(t, s, table([row[0] for row in rows]), table([row[1] for row in rows]))
