"""Equations of motion as formulas of the numbers of a state, for Taylor series."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from integrable.deformations.hamiltonian import dot
from integrable.phase.state import State


def rates(system: Any, physical: bool = True) -> Callable[[Sequence[Any]], list[Any]]:
    """The equations of motion y ↦ ẏ from ``system.vector_field``, y = (γ1, γ2, γ3, M1, M2, M3) and at d ≠ 0 τ̇ = g; or,
    unless ``physical``, the derivatives by τ, and of t.
    """
    rolls = system.body.rolls

    def right_hand_side(y: Sequence[Any]) -> list[Any]:
        rate = system.vector_field(State((y[0], y[1], y[2]), (y[3], y[4], y[5])))
        moved = [*rate.gamma, *rate.M]
        if not rolls:
            return moved
        slow = dot(system.body.contact, [x * x for x in y[:3]]) ** (system.field.one / 2)
        return [*moved, 1 / slow] if physical else [*(slow * x for x in moved), slow]

    return right_hand_side
