"""The equations of motion of a body or a deformation as a formula, and their compiled integration near the start.

A walk by Taylor series is compiled once for all systems whose equations have the same terms
(:mod:`integrable.series.kinds`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.motion.trajectory import Motion
from integrable.phase.state import onto_constraints, state_of_row
from integrable.phase.ways import Cost
from jacobian import RR
from jacobian.element import Real
from jacobian.immutable import made_once

if TYPE_CHECKING:
    # these modules load LLVM, which motions over MP(digits) and interpreted ones do not need
    from integrable.series.kinds import Kind
    from integrable.series.steps import Steps


def right_hand_sides(system: Any, physical: bool = True) -> Callable[[Sequence[Real]], list[Real]]:
    """The equations of motion y ↦ ẏ from ``system.vector_field``, y = (γ1, γ2, γ3, M1, M2, M3, and τ if d ≠ 0).

    Here τ̇ = g. Unless ``physical``, derivatives are with respect to τ, and t replaces τ in y.
    """
    rolls = system.body.rolls

    def right_hand_side(y: Sequence[Real]) -> list[Real]:
        moved = [*system.vector_field(state_of_row(y[:6])).row]
        if not rolls:
            return moved
        first, second, third = (e * (x * x) for e, x in zip(system.body.contact, y[:3], strict=True))
        slow = (first + second + third) ** (system.field.one / 2)
        return [*moved, 1 / slow] if physical else [*(slow * x for x in moved), slow]

    return right_hand_side


class Integration:
    """A :class:`integrable.phase.ways.Way` that integrates the equations of motion, in t or in τ; :meth:`run` is
    defined by subclasses.
    """

    way = "integrated"

    def run(self, given: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray] | None:
        """γ and M side by side, shape (N, 6), at the times ``given``, and τ there. Unless ``physical``, ``given`` are
        values of τ, and t is returned instead of τ.
        """
        raise NotImplementedError

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        return self.run(times, True)

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        found = self.run(tau, False)
        return None if found is None else found[0]

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        found = self.run(tau, False)
        return None if found is None else found[1]


class NearWalk(Integration):
    """The states near the start by a compiled walk, if the walk costs at most ``cost``.

    Its steps are those of ``plan``, by default those for states that are right to the last bits. If the first or the
    last time is beyond ``farthest``, no walk is tried.
    """

    def __init__(self, motion: Motion, cost: Cost, plan: Sequence[Steps] | None = None, farthest: float = inf) -> None:
        self._motion, self._cost, self._plan, self._farthest = motion, cost, plan, farthest

    def compile(self) -> None:
        """Compiles the walks of :meth:`at`, or loads them from disk, before they are needed."""
        from integrable.series.steps import steps_for

        kind = kind_in(self._motion.system, True, self._motion.state.tilted)
        for steps in self._plan or steps_for(None):
            kind.walk(steps.orders)

    def run(self, times: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray] | None:
        system, state = self._motion.system, self._motion.state
        if system.field is not RR or (len(times) and max(abs(times[0]), abs(times[-1])) > self._farthest):
            return None
        kind, rolls = kind_in(system, physical, state.tilted), system.body.rolls
        # at d ≠ 0 a third vector follows γ and M: (τ, 0, 0), or (t, 0, 0) if the walk is in τ
        given = system.constants, (*state.row, 0.0, 0.0, 0.0) if rolls else state.row
        most = self._cost.of(len(times))
        near = kind.reached(given, times, most, self._plan) if self._plan else kind.walked(given, times, most)
        if near.lacks(len(times)):
            return None
        states = near.states if near.places is None else near.states[np.argsort(near.places)]
        flat = states.reshape(len(times), 9 if rolls else 6)
        return (flat[:, :6].copy(), flat[:, 6].copy()) if rolls else (flat, times)


def kind_in(system: Any, physical: bool, tilted: bool = False) -> Kind:
    """The compiled walks, in t if ``physical``, otherwise in τ, of all systems with the equations of ``system``."""
    physical = physical or not system.body.rolls
    # a term whose constant is 0 is left out, because it may divide by a quantity that vanishes
    there = tuple(map(bool, system.constants))
    key = "walks", type(system), physical, tilted, there
    return made_once(key, lambda: _made_kind(system, physical, tilted, there))


def _made_kind(system: Any, physical: bool, tilted: bool, there: Sequence[bool]) -> Kind:
    from integrable.series.kinds import Formulas, Kind
    from integrable.series.symbols import Symbol

    symbols = [Symbol(("constant", i)) if is_there else 0.0 for i, is_there in enumerate(there)]
    count = 9 if system.body.rolls else 6

    def start(N: Any, y: Sequence[Real]) -> list[Real]:
        inner = onto_constraints(system._of_constants(N, symbols), state_of_row(y[:6], tilted))
        return [*inner.row, *y[6:]]

    def moved(N: Any, y: Sequence[Real]) -> list[Real]:
        found = right_hand_sides(system._of_constants(N, symbols), physical)(y[:6])
        return [*found, *([N.zero] * (count - len(found)))]

    return Kind(f"{type(system).__name__}_{'t' if physical else 'tau'}", Formulas(moved, start, count, count, 3))
