"""The equations of motion of a deformation as a formula, and walks: their compiled integration near the start.

A walk by Taylor series is compiled once for all systems whose equations have the same terms
(:mod:`integrable.series.kinds`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.scalars import dot
from integrable.motion.trajectory import Motion
from integrable.phase.state import onto_constraints, state_of_row
from integrable.phase.ways import Cost
from integrable.series.kinds import Formulas, Kind
from integrable.series.steps import BEFORE_CLOCK, BEFORE_CURVES, INTEGRATED
from integrable.series.symbols import Symbol
from jacobian import RR
from jacobian.element import Real
from jacobian.immutable import made_once

# microseconds for the set-up and for each state, in the unit of integrable.series.steps.step_cost. By theta functions:
# without potential, with repelling poles b_i/γ_i² in it, and with a clock; then by integration (python -m benchmarks
# near)
BY_THETA, BY_THETA_IN_POLES, BY_CLOCK, BY_STEPS = Cost(300, 1), Cost(450, 1), Cost(600, 1), Cost(150_000, 0)
# the steps of a walk that is tried before the next way, by the cost of this way; BEFORE_CURVES are those for all others
STEPS = {BY_CLOCK: BEFORE_CLOCK, BY_STEPS: INTEGRATED}


def right_hand_sides(system: Any, physical: bool = True) -> Callable[[Sequence[Real]], list[Real]]:
    """The equations of motion y ↦ ẏ from ``system.vector_field``, y = (γ1, γ2, γ3, M1, M2, M3, and τ if d ≠ 0).

    Here τ̇ = g. Unless ``physical``, derivatives are with respect to τ, and t replaces τ in y.
    """
    rolls = system.body.rolls

    def right_hand_side(y: Sequence[Real]) -> list[Real]:
        moved = [*system.vector_field(state_of_row(y[:6])).row]
        if not rolls:
            return moved
        slow = dot(system.body.contact, [x * x for x in y[:3]]) ** (system.field.one / 2)
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

    ``cost`` is the cost of the way that is tried next.
    """

    def __init__(self, motion: Motion, cost: Cost) -> None:
        self._motion, self._cost = motion, cost

    def run(self, times: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray] | None:
        system, state = self._motion.system, self._motion.state
        if system.field is not RR:
            return None
        kind, rolls = kind_in(system, physical), system.body.rolls
        # at d ≠ 0 a third vector follows γ and M: (τ, 0, 0), or (t, 0, 0) if the walk is in τ
        given = system.constants, (*state.row, 0.0, 0.0, 0.0) if rolls else state.row
        near = kind.reached(given, times, self._cost.of(len(times)), STEPS.get(self._cost, BEFORE_CURVES))
        if near.lacks(len(times)):
            return None
        states = near.states if near.places is None else near.states[np.argsort(near.places)]
        flat = states.reshape(len(times), 9 if rolls else 6)
        return (flat[:, :6].copy(), flat[:, 6].copy()) if rolls else (flat, times)


def kind_in(system: Hamiltonian, physical: bool) -> Kind:
    """The compiled walks, in t if ``physical``, otherwise in τ, of all systems with the equations of ``system``."""
    physical = physical or not system.body.rolls
    # a term whose constant is 0 is left out, because it may divide by a quantity that vanishes
    there = tuple(map(bool, system.constants))
    return made_once(("walks", type(system), physical, there), lambda: _made_kind(system, physical, there))


def _made_kind(system: Hamiltonian, physical: bool, there: Sequence[bool]) -> Kind:
    symbols = [Symbol(("constant", i)) if is_there else 0.0 for i, is_there in enumerate(there)]
    count = 9 if system.body.rolls else 6

    def start(N: Any, y: Sequence[Real]) -> list[Real]:
        inner = onto_constraints(system._of_constants(N, symbols), state_of_row(y[:6]))
        return [*inner.row, *y[6:]]

    def moved(N: Any, y: Sequence[Real]) -> list[Real]:
        found = right_hand_sides(system._of_constants(N, symbols), physical)(y[:6])
        return [*found, *([N.zero] * (count - len(found)))]

    return Kind(f"{type(system).__name__}_{'t' if physical else 'tau'}", Formulas(moved, start, count, count, 3))
