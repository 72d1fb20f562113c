"""The ball and the top among the systems of any genus (:mod:`integrable.mumford.bodies`, l(x) = 1 − dx)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from integrable.motion.domain import check_domain
from integrable.mumford.bodies import BodySystem
from integrable.mumford.flow import Path, Point
from integrable.phase.enclosure import EnclosedPath
from jacobian import RR, Divisor
from jacobian.errors import ArgumentError, shown

if TYPE_CHECKING:
    from integrable.systems.system import System


class BodyOnLayer(BodySystem):
    """A ball (d ≠ 0) or a top of three different moments: a state has q = γ and p = M.

    ``flow`` is the body's own, compiled where it is over RR; ``by_additions`` that of any system of genus 2 (d ≠ 0).
    """

    def __init__(self, inertia: Any, d: Any = 0, field: Any = RR) -> None:
        self._set_up_moments(field, inertia)
        K, d = self.field, self.field.coerce(d, "d")
        self.parameters = (d,)
        if any(K.add(moment, d) == K.zero for moment in self.constants):
            raise ArgumentError(f"d = {d}: with inertia = {shown(inertia)} one of I_i + d is 0, and must not be")

    def __repr__(self) -> str:
        return f"BodyOnLayer({self.constants}, {self.parameters[0]}, {self.field.name})"

    @property
    def body(self) -> System:
        """The body."""
        from integrable.systems.chaplygin_ball import ChaplyginBall

        return ChaplyginBall(self.constants, self.parameters[0], field=self.field)

    def divisor(self, state: Point) -> Divisor:
        """The class of the state's pair, of a top in the generalized Jacobian."""
        body = self.body
        return body.divisor(body.state(*state))

    def flow(self, state: Point) -> Any:
        """The motion of a state as the body computes it; ``at(times)``."""
        self._check(state)
        body = self.body
        return _Flow(body.flow(body.state(*state)))

    def by_additions(self, state: Point) -> Any:
        """The motion of a state by additions in long numbers; ArgumentError at d = 0, and over RR where
        :mod:`integrable.motion.domain` refuses the body or the state.
        """
        (d,) = self.parameters
        if d == self.field.zero:
            raise ArgumentError("d = 0: the curve of a top has genus 1, and its pair is none of degree 1; give d ≠ 0")
        self._check(state)
        if self.field == RR and d > 0:
            check_domain(self.body, self.body.state(*state))
        return super().flow(state)

    # the body's own flow is the fast one near its start too
    _equations = None

    def _constants_in(self, N: Any) -> tuple[Any, ...]:
        (d,) = self._parameters_in(N)
        return tuple(N.one / (N.coerce(moment) + d) for moment in self.constants)

    def _light(self, N: Any) -> tuple[Any, Any]:
        return N.one, -self._parameters_in(N)[0]

    def _weights(self, N: Any) -> tuple[Any, ...]:
        return tuple(N.coerce(moment) * e for moment, e in zip(self.constants, self._constants_in(N), strict=True))


class _Flow:
    """A body's flow with q and p for γ and M."""

    def __init__(self, flow: Any) -> None:
        self._flow = flow

    def at(self, times: Any) -> Path:
        """The states at times."""
        run = self._flow.at(times)
        return Path(run.times, run.gamma, run.M, run.way)

    def enclosure(self, times: Any, digits: int | None = None) -> EnclosedPath:
        """Proven bounds of the states at times."""
        found = self._flow.enclosure(times, digits)
        return EnclosedPath(found.times, list(zip(found.tau, found.gamma, found.M, found.radius, strict=True)))
