"""The common part of the flows of the deformations on two elliptic curves."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from typing import Any, ClassVar

from integrable.deformations.carrier import CurvesCarrier, OnCurves, widened
from integrable.deformations.hamiltonian import Hamiltonian
from integrable.deformations.hamiltonian_motion import HamiltonianMotion
from integrable.deformations.integrated import IntegratedMotion
from integrable.deformations.quick_states import QuickStates
from integrable.motion.near import NearWalk
from integrable.motion.precise import RoundedRows
from integrable.motion.trajectory import Trajectory
from integrable.mumford.motion import Vectors, settled_digits
from integrable.phase.precisions import long_digits
from integrable.phase.state import State
from integrable.phase.ways import Cost, Way
from integrable.portrait.sensitivity import Sensitivity
from integrable.series.steps import BEFORE_CLOCK, BEFORE_CURVES
from jacobian import RR
from jacobian.errors import Infeasible, PrecisionLoss
from jacobian.immutable import at_once
from jacobian.numbers.compiler import interpreted

__all__ = ["DeformedFlow"]

# the constants λ1 and λ2 are defined by H = λ1 + λ2 and K = −λ1λ2. In floats a λ_k has about ten correct digits if it
# exceeds this fraction of the terms of which it is the sum
ORDINARY = 1e-6
# microseconds for the set-up and for each state by theta functions, in the unit of integrable.series.steps.step_cost:
# without potential, and with a clock (python -m benchmarks near)
BY_THETA, BY_CLOCK = Cost(300, 1), Cost(600, 1)


class DeformedFlow(HamiltonianMotion):
    """The motion of a deformation through a state at any time, by additions on two elliptic curves, over RR or MP(n).

    It is the base class of the flows that ``system.flow`` returns. The inputs count as exact, and states are rounded
    once to the field, floats included. Repeated calls return the same bits, whatever was computed before. PrecisionLoss
    if more than MOST_LOST digits would be lost (:mod:`integrable.motion.precise`).
    """

    method = "elliptic curves"

    _carrier: ClassVar[type[CurvesCarrier]]
    """The class of the motion over wide numbers."""
    _cost = BY_THETA
    """The cost of states that are computed on the curves at d = 0."""

    @at_once
    def __init__(self, system: Hamiltonian, state: State) -> None:
        super().__init__(system, state)
        if not self._is_ordinary():
            if system.potential is not None:
                # this raises NotRepresentable where the potential is infinite
                system._pair_at(state)
            # the curves are made here, so that errors are raised at once
            _ = self._many

    @cached_property
    def _many(self) -> OnCurves:
        return OnCurves(self.system, self.state, self._carrier)

    @property
    def _curves(self) -> RoundedRows:
        return RoundedRows(self.system.field, self._many, self.method)

    def _is_ordinary(self) -> bool:
        """Whether a check in floats proves that the set-up will raise no error."""
        system = self.system
        if system.field is not RR or len({*system.body.inertia}) < 3 or min(system.body.contact) < ORDINARY:
            return False
        H, product = map(abs, system.eigenvalue_sums(*system._pair_at(self.state)))
        try:
            large, size = (H + (H * H + 4 * product) ** 0.5) / 2, self._terms()
        except OverflowError:
            return False
        return product > ORDINARY * large * large and large > ORDINARY * size and size < 1 / ORDINARY

    def _terms(self) -> float:
        """The size of the terms of which λ1 and λ2 are sums; H = λ1 + λ2, K = −λ1λ2."""
        _, M = self.state.vectors
        return float(self.system.field.dot(M, M)) * max(self.system.a) ** self.system.degree

    @cached_property
    def _compiled(self) -> QuickStates:
        return QuickStates(self._many)

    def _settled(self, read: Callable[[Any], Vectors], more: int = 0) -> Vectors:
        return settled_digits(
            lambda N: read(self._carrier(*widened(self.system, self.state, N))), long_digits(self.system.field) + more
        )

    def _by_variations(self, run: Trajectory) -> Sensitivity | None:
        # at d ≠ 0 the derivatives are integrated: a difference quotient needs the clocks of two other motions, which
        # take longer
        try:
            return IntegratedMotion(self.system, self.state)._by_variations(run) if self.system.body.rolls else None
        except (Infeasible, PrecisionLoss):
            return None

    def _ways(self) -> Iterator[Way]:
        if self.system.field is RR:
            walk = (BY_CLOCK, BEFORE_CLOCK) if self.system.body.rolls else (self._cost, BEFORE_CURVES)
            yield NearWalk(self, *walk)
            if not interpreted():
                yield self._compiled
        yield self._curves
