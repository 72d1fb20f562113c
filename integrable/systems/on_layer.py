"""The ball and the top as members of the family of :mod:`integrable.mumford.bodies`: those with l(x) = 1 − dx."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from integrable.motion.domain import check_domain
from integrable.mumford.bodies import BodySystem
from integrable.mumford.flow import MumfordFlow, Point
from integrable.phase.body import unwarned
from jacobian import RR, Divisor, Field
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, shown, written

if TYPE_CHECKING:
    from integrable.motion.flow import Flow
    from integrable.systems.system import System


class BodyOnLayer(BodySystem):
    """A ball (d ≠ 0) or a top with three different moments. In a state q is γ and p is M.

    ``flow`` is the body's own flow, compiled over RR. For d ≠ 0, ``by_additions`` uses the method for systems of any
    genus.
    """

    def __init__(self, inertia: Iterable[Value], d: Value = 0, field: Field = RR) -> None:
        self._set_up_moments(field, inertia)
        K, offset = self.field, self.field.coerce(d, "d")
        self.parameters = (offset,)
        if any(K.add(moment, offset) == K.zero for moment in self.constants):
            raise ArgumentError(
                f"d = {written(offset)}: with inertia = {shown(inertia)} one of I_i + d is 0, and must not be"
            )

    @property
    def body(self) -> System:
        """The ball or the top itself, as a System."""
        from integrable.systems.chaplygin_ball import ChaplyginBall

        with unwarned():
            return ChaplyginBall(self.constants, self.parameters[0], field=self.field)

    def divisor(self, state: Point) -> Divisor:
        """The divisor class of a state; for a top it lies in the generalized Jacobian."""
        body = self.body
        return body.divisor(body.state(*state))

    def flow(self, state: Point, tolerance: float | None = None) -> Flow:  # type: ignore[override]
        """The motion through a state by the body's own flow, q = γ and p = M. ArgumentError if a tolerance is given."""
        if tolerance is not None:
            raise ArgumentError(
                f"tolerance = {shown(tolerance)}: the flow of a body is right to its last bits; give none"
            )
        self._check(state)
        body = self.body
        return body.flow(body.state(*state))

    def by_additions(self, state: Point) -> MumfordFlow:
        """The motion through a state by additions in long numbers; ArgumentError at d = 0, and over RR where
        :mod:`integrable.motion.domain` refuses the body or the state.
        """
        (d,) = self.parameters
        if d == self.field.zero:
            raise ArgumentError("d = 0: the curve of a top has genus 1, and its pair has degree 2; give d ≠ 0")
        self._check(state)
        if self.field is RR and d > 0:
            check_domain(self.body, self.body.state(*state))
        return super().flow(state)

    # this system has no compiled walk: the body's own flow is faster even near the start
    _kind = None

    def _constants_in(self, N: FormulaField) -> tuple[Real, ...]:
        (d,) = self._parameters_in(N)
        return tuple(N.one / (N.coerce(moment) + d) for moment in self.constants)

    def _light(self, N: FormulaField) -> tuple[Real, Real]:
        return N.one, -self._parameters_in(N)[0]

    def _weights(self, N: FormulaField) -> tuple[Real, ...]:
        return tuple(N.coerce(moment) * e for moment, e in zip(self.constants, self._constants_in(N), strict=True))
