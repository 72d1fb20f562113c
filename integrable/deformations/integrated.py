"""The motion of any system by integration of its equations, in any precision: for where no flow is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from integrable.deformations.deformed_flow import (
    GUARD_DIGITS,
    DeformedTrajectory,
    digits_asked,
    integrals_missing,
    motion_of,
    numbers_of,
    widened,
)
from integrable.deformations.hamiltonian import Hamiltonian
from integrable.phase.state import State
from integrable.steps.extrapolation import integrate
from jacobian.errors import PrecisionLoss
from jacobian.immutable import Immutable

# digits of a step beyond those asked for, and what all steps together may lose of H and K
STEP_DIGITS = 2
LOST_DIGITS = 3
# not so small that a K with a double zero, as at K = 0, does not change
PART = 1.2345e-4


def rates(system: Any) -> Callable[[Sequence[Any]], list[Any]]:
    """The six equations of motion y ↦ ẏ, y = (γ1, γ2, γ3, M1, M2, M3), from ``system.vector_field``."""

    def right_hand_side(y: Sequence[Any]) -> list[Any]:
        rate = system.vector_field(State((y[0], y[1], y[2]), (y[3], y[4], y[5])))
        return [*rate.gamma, *rate.M]

    return right_hand_side


class IntegratedMotion(Immutable):
    """The motion of a deformation through a state, by extrapolation of ``system.vector_field``, over RR or MP(digits).

    All is computed with guard digits, also for floats, each step to the last digit, and rounded once. The work grows
    with the time: Infeasible where it would take minutes. PrecisionLoss where the motion ends in finite time, at a pole
    that attracts, and where H and K are lost.
    """

    method = "extrapolation"

    def __init__(self, system: Hamiltonian, state: State) -> None:
        self.system, self.state = system, state
        self._asked = digits_asked(system.field)

    def at(self, times: Any) -> DeformedTrajectory:
        """The states at physical times, in any order and of either sign."""
        K = self.system.field
        given = numbers_of(K, times, "times")
        system, state = widened(self.system, self.state, self._asked + GUARD_DIGITS)
        wide = system.field
        step_digits = self._asked + STEP_DIGITS
        found = integrate(
            rates(system),
            [*state.gamma, *state.M],
            [wide.coerce(x) for x in given],
            wide.coerce(10) ** -step_digits,
            step_digits,
        )
        rows = [(row[:3], row[3:]) for row in found]
        missing = integrals_missing(system, state, _sizes(system, state), rows, self._asked - LOST_DIGITS)
        if missing > 0:
            raise PrecisionLoss(
                f"times: H and K of the motion as integrated are {missing} digits short; times nearer to 0 are within "
                "reach, or an MP field of more digits"
            )
        return motion_of(K, given, None, rows)


def _sizes(system: Any, state: State) -> tuple[Any, Any]:
    """|F| + Σ|ΔF/part| of F = H and K, where one coordinate is moved by a part of |γ| or |M|."""
    values, part = [*state.gamma, *state.M], system.field.coerce(PART)
    units = [part * max(map(abs, v)) for v in (state.gamma, state.M)]
    before = system.integrals(state)[2:]
    sizes = [abs(F) for F in before]
    for i in range(6):
        x = [*values[:i], values[i] + units[i // 3], *values[i + 1 :]]
        after = system.integrals(State((x[0], x[1], x[2]), (x[3], x[4], x[5])))[2:]
        sizes = [size + abs(new - old) / part for size, new, old in zip(sizes, after, before, strict=True)]
    return sizes[0], sizes[1]
