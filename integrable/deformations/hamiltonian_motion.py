"""Certificates, enclosures, events and sensitivities of the motions of deformations."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Self

from integrable.motion.trajectory import Motion, Trajectory
from integrable.phase.state import onto_constraints, state_of_row
from integrable.portrait.state_flow import StateFlow, largest_rate
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import NotRepresentable

if TYPE_CHECKING:
    import numpy as np

    from integrable.phase.enclosure import Enclosure
    from integrable.portrait.differences import Inputs


class HamiltonianMotion(Motion, StateFlow[Trajectory]):
    """The base class of the motions of deformations, on elliptic curves or by integration."""

    _vectors, _unit = ("γ", "M"), 1

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        from integrable.deformations.enclosed import enclosed_states

        return enclosed_states(self.system, self.state, times, digits, in_tau)

    @property
    def _numbers(self) -> tuple[Real, ...]:
        return *self.state.row, *self.system.constants

    def _through(self, numbers: Iterable[Real], field: Any) -> Self:
        values = [*map(field.coerce, numbers)]
        system = self.system._of_constants(field, values[6:])
        return type(self)(system, onto_constraints(system, state_of_row(values[:6])))

    def _inputs(self) -> tuple[Inputs, tuple[str, ...]]:
        from integrable.portrait.differences import Inputs
        from integrable.portrait.sensitivity import COLUMNS

        system, M = self.system, float(max(map(abs, self.state.vectors[1])))
        # a body at rest gives no unit of M; the fastest rate that the potential causes gives one
        M = M or (self._fastest or 1.0) / float(max(system.a)) ** system.degree
        terms = () if system.potential is None else ("a", "b", "b1", "b2", "b3")
        # a constant that is 0 is no input: other values would add a term to the equations
        sizes = (1, 1, 1, M, M, M, *map(abs, system.constants))
        names = zip((*COLUMNS, *terms, *system.further), sizes, strict=True)
        return Inputs(self._numbers, sizes), tuple(name for name, size in names if size)

    def _secular(self, times: np.ndarray) -> np.ndarray:
        raise NotRepresentable(f"secular: the actions and phases of {self.system!r} are not computed; take matrix")

    @property
    def _fastest(self) -> float:
        floats = self._through(self._numbers, RR)
        return largest_rate([floats.system.linearized(floats.state)])
