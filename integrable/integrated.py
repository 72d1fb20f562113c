"""The motion of any system by integration of its equations, in any precision: for where no flow is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.extrapolation import integrate
from integrable.separated_flow import Motion, numbers_of, widened
from integrable.state import State
from jacobian import RR
from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from integrable.systems.deformation import Deformation

FLOAT_DIGITS = 17


def rates(system: Any) -> Callable[[Sequence[Any]], list[Any]]:
    """The six equations of motion y ↦ ẏ, y = (γ1, γ2, γ3, M1, M2, M3), from ``system.vector_field``."""

    def right_hand_side(y: Sequence[Any]) -> list[Any]:
        rate = system.vector_field(State((y[0], y[1], y[2]), (y[3], y[4], y[5])))
        return [*rate.gamma, *rate.M]

    return right_hand_side


class IntegratedMotion:
    """The motion of a deformation through a state, by extrapolation of ``system.vector_field``, over RR or MP(digits).

    All is computed with guard digits, also for floats, each step to the last digit, and rounded once. The work grows
    with the time. PrecisionLoss where the motion ends in finite time, at a pole that attracts.
    """

    method = "extrapolation"

    def __init__(self, system: Deformation, state: State) -> None:
        self.system = system
        self._state = state
        if system.field.exact:
            raise ArgumentError(
                f"field = {system.field.name}: equations of motion are integrated over RR or MP(digits)"
            )

    def at(self, times: Any) -> Motion:
        """The states at physical times, in any order and of either sign."""
        K = self.system.field
        given = numbers_of(K, times, "times")
        system, state = widened(self.system, self._state)
        wide, digits = system.field, FLOAT_DIGITS if K == RR else K.dps
        rows = integrate(
            rates(system),
            [*state.gamma, *state.M],
            [wide.coerce(x) for x in given],
            wide.coerce(10) ** -digits,
            digits,
        )
        kind, back = (np.float64, float) if K == RR else (object, K.coerce)
        table = np.array([[back(x) for x in row] for row in rows], dtype=kind).reshape(-1, 6)
        return Motion(np.array(given, dtype=kind), None, table[:, :3], table[:, 3:])
