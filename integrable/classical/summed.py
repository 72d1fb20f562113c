"""Flows without additions: states at far times by sums over the ovals (:mod:`integrable.portrait.separated`)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

from integrable.mumford.flow import ON_TORUS, TORUS, MumfordFlow, Point
from integrable.mumford.motion import Vectors, settled_digits
from integrable.mumford.phase_torus import PhaseTorus
from integrable.phase.enclosure import Enclosure
from integrable.portrait.separated import SeparatedTorus
from jacobian.element import Number, Real
from jacobian.errors import ArgumentError, shown
from jacobian.inexact.long_field import LongField


class SummedFlow(MumfordFlow):
    """The motion, at any times, of a state whose pair has one point in each of g ovals."""

    # states in long numbers are computed by sums over the ovals, as those in floats are, so their ``way`` is TORUS too
    _long_way = TORUS

    def _budget(self, count: int) -> float:
        return ON_TORUS[3].of(count)

    def _made_torus(self) -> PhaseTorus:
        return self._made_phase_torus()

    def _row(self, time: Number) -> Vectors:
        return settled_digits(lambda N: self._state(N, time), self.digits)

    @cached_property
    def _tori(self) -> dict[int, tuple[SeparatedTorus, Callable[..., Point]]]:
        """For each number of bits in use, the torus and the function that computes states on it."""
        return {}

    def _state(self, N: LongField, time: Number) -> Point:
        import gmpy2

        if N.bits not in self._tori:
            separated = self._separated(N)
            self._tori[N.bits] = separated, self._states_on(N, separated)
        torus, read = self._tori[N.bits]
        angles, turned = torus.angles_at(N.coerce(time))
        sine, cosine = gmpy2.sin_cos(turned[0])
        return read(N, [gmpy2.sin_cos(phi / 2) for phi in angles], [(cosine, sine)])

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        raise ArgumentError(f"times = {shown(times)}: the sums of {self.system!r} over ovals have no proven bounds")
