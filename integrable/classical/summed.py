"""Flows without additions: states at far times by sums over the ovals (:mod:`integrable.portrait.separated`)."""

from __future__ import annotations

from integrable.mumford.flow import ON_TORUS, TORUS, MumfordFlow
from integrable.mumford.motion import Vectors
from integrable.mumford.phase_torus import PhaseTorus
from integrable.phase.enclosure import Enclosure
from jacobian.element import Real
from jacobian.errors import ArgumentError, shown


class SummedFlow(MumfordFlow):
    """The motion, at any times, of a state whose pair has one point in each of g ovals."""

    # states in long numbers are computed by sums over the ovals, as those in floats are, so their ``way`` is TORUS too
    _long_way = TORUS

    def _budget(self, count: int) -> float:
        return ON_TORUS[3].of(count)

    def _made_torus(self) -> PhaseTorus:
        return self._made_phase_torus()

    def _row(self, time: Real) -> Vectors:
        return self._summed(time)

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        raise ArgumentError(f"times = {shown(times)}: the sums of {self.system!r} over ovals have no proven bounds")
