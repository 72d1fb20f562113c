"""The equations of motion of a deformation as a formula, and their integration near the start.

A walk is such an integration by Taylor series, compiled for a kind of systems (:mod:`integrable.series.kinds`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.scalars import Potential, dot
from integrable.motion.trajectory import Motion
from integrable.phase.body import Body
from integrable.phase.state import State, onto_constraints
from integrable.phase.ways import Cost
from integrable.series.kinds import Formulas, Kind, kind_of
from integrable.series.symbols import Symbol
from jacobian.element import Real
from jacobian.immutable import replaced

__all__ = ["NearWalk", "right_hand_sides"]

# costs of states in microseconds: by theta functions, without and with repelling poles, and by integration (python -m
# benchmarks near)
BY_THETA, BY_THETA_IN_POLES, BY_STEPS = Cost(300, 3), Cost(900, 3), Cost(150_000, 0)


def right_hand_sides(system: Any, physical: bool = True) -> Callable[[Sequence[Real]], list[Real]]:
    """The equations of motion y ↦ ẏ from ``system.vector_field``, y = (γ1, γ2, γ3, M1, M2, M3, and τ if d ≠ 0).

    Here τ̇ = g. Unless ``physical``, derivatives are with respect to τ, and t replaces τ in y.
    """
    rolls = system.body.rolls

    def right_hand_side(y: Sequence[Real]) -> list[Real]:
        rate = system.vector_field(State((y[0], y[1], y[2]), (y[3], y[4], y[5])))
        moved = [*rate.row]
        if not rolls:
            return moved
        slow = dot(system.body.contact, [x * x for x in y[:3]]) ** (system.field.one / 2)
        return [*moved, 1 / slow] if physical else [*(slow * x for x in moved), slow]

    return right_hand_side


class NearWalk:
    """The :class:`integrable.phase.ways.Way` to states near the start; it takes no longer than ``cost``."""

    way = "integrated"

    def __init__(self, motion: Motion, cost: Cost) -> None:
        self._motion, self._cost = motion, cost

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""
        return self.walked(times, True)

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        """γ and M side by side at values of τ: shape (N, 6)."""
        found = self.walked(tau, False)
        return None if found is None else found[0]

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        """The physical times t(τ) at values of τ: shape (N,)."""
        found = self.walked(tau, False)
        return None if found is None else found[1]

    def walked(self, times: np.ndarray, physical: bool) -> tuple[np.ndarray, np.ndarray] | None:
        """The rows (γ, M) with τ if ``physical``, with t otherwise; None if the walk does not reach all times."""
        system, state = self._motion.system, self._motion.state
        # the variable after γ and M is τ, or t if the walk is in τ
        kind, given = kind_in(system, physical), (constants_of(system), (*state.row, 0.0, 0.0, 0.0))
        most = self._cost.of(len(times))
        near = kind.walked(*given, times, most)
        if self._cost == BY_STEPS and near.begun:
            near = kind.finished(near, *given, times, most)
        if near.lacks(len(times)):
            return None
        states = near.states
        if near.places is not None:
            states = np.empty_like(near.states)
            states[near.places] = near.states
        flat = states.reshape(len(times), 9)
        return np.ascontiguousarray(flat[:, :6]), flat[:, 6].copy() if system.body.rolls else times


def constants_of(system: Hamiltonian) -> tuple[float, ...]:
    """The numbers that distinguish systems of one kind."""
    terms = () if system.potential is None else (system.potential.a, system.potential.b, *system.potential.poles)
    return (*system.body.inertia, system.d, *terms, *(getattr(system, name) for name in system.further))


def of_constants(system: Hamiltonian, field: Any, values: Sequence[Any]) -> Hamiltonian:
    """The system of the same kind over ``field`` whose :func:`constants_of` are ``values``."""
    moments, rest = (values[0], values[1], values[2]), list(values[4:])
    changes: dict[str, Any] = {"rigid": replaced(system.rigid, body=Body(moments, values[3], field))}
    if system.potential is not None:
        a, b, *poles = rest[:5]
        changes["potential"], rest = Potential(a, b, (poles[0], poles[1], poles[2])), rest[5:]
    return replaced(system, **changes, **dict(zip(system.further, rest, strict=True)))


def kind_in(system: Hamiltonian, physical: bool) -> Kind:
    """The compiled walks of systems of the kind of ``system``, in t if ``physical``, otherwise in τ."""
    # terms with constant 0 must be omitted, because they may divide by quantities that vanish
    there = tuple(x != 0 for x in constants_of(system))
    symbols = [Symbol(("constant", i)) if is_there else 0.0 for i, is_there in enumerate(there)]

    def start(N: Any, y: Sequence[Real]) -> list[Real]:
        inner = onto_constraints(of_constants(system, N, symbols), State((y[0], y[1], y[2]), (y[3], y[4], y[5])))
        return [*inner.row, *y[6:]]

    def moved(N: Any, y: Sequence[Real]) -> list[Real]:
        found = right_hand_sides(of_constants(system, N, symbols), physical)(y[:6])
        return [*found, *([N.zero] * (9 - len(found)))]

    def made() -> Kind:
        name = f"{type(system).__name__}_{'t' if physical else 'tau'}"
        return Kind(name, Formulas(moved, start, 9, 9, 3))

    found = kind_of((type(system), system.potential is None, physical or not system.body.rolls, there), made)
    assert found is not None
    return found
