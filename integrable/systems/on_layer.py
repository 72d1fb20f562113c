"""The ball and the top as systems of any genus (:mod:`integrable.mumford.bodies` with l(x) = 1 − dx)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from integrable.motion.domain import check_domain
from integrable.mumford.bodies import BodySystem
from integrable.mumford.flow import MumfordFlow, Path, Point, long_digits
from integrable.phase.body import unwarned
from integrable.phase.enclosure import EnclosedPath, Enclosure, ball_digits
from integrable.phase.state import State, onto_constraints
from jacobian import MP, RR, Divisor, Field
from jacobian.element import FormulaField, Number, Numbers, Real, Value
from jacobian.errors import ArgumentError, shown, written
from jacobian.immutable import Immutable, replaced

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory
    from integrable.portrait.events import Condition
    from integrable.portrait.portrait import Portrait
    from integrable.portrait.section import Section
    from integrable.portrait.sensitivity import Sensitivity
    from integrable.portrait.spectrum import Spectrum
    from integrable.systems.system import System


class BodyOnLayer(BodySystem):
    """A ball (d ≠ 0) or a top of three different moments: a state has q = γ and p = M.

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

    def flow(self, state: Point, tolerance: float | None = None) -> Any:
        """The motion through a state by the body's own flow. ArgumentError if a tolerance is given."""
        if tolerance is not None:
            raise ArgumentError(
                f"tolerance = {shown(tolerance)}: the flow of a body is right to its last bits; give none"
            )
        self._check(state)
        return BodyPath(self, state)

    def by_additions(self, state: Point) -> MumfordFlow:
        """The motion through a state by additions in long numbers; ArgumentError at d = 0, and over RR where
        :mod:`integrable.motion.domain` refuses the body or the state.
        """
        (d,) = self.parameters
        if d == self.field.zero:
            raise ArgumentError("d = 0: the curve of a top has genus 1, and its pair has degree 2; give d ≠ 0")
        self._check(state)
        if self.field == RR and d > 0:
            check_domain(self.body, self.body.state(*state))
        return super().flow(state)

    # this system has no compiled walk: the body's own flow is faster near its start too
    _kind = None

    def _constants_in(self, N: FormulaField) -> tuple[Real, ...]:
        (d,) = self._parameters_in(N)
        return tuple(N.one / (N.coerce(moment) + d) for moment in self.constants)

    def _light(self, N: FormulaField) -> tuple[Real, Real]:
        return N.one, -self._parameters_in(N)[0]

    def _weights(self, N: FormulaField) -> tuple[Real, ...]:
        return tuple(N.coerce(moment) * e for moment, e in zip(self.constants, self._constants_in(N), strict=True))


class BodyPath(Immutable):
    """A body's flow with q and p for γ and M, and the methods of :class:`integrable.mumford.flow.MumfordFlow`."""

    def __init__(self, system: BodyOnLayer, state: Point) -> None:
        self.digits, self.system, self.start = long_digits(system.field), system, state
        body = system.body
        self._flow = body.flow(body.state(*state))

    def _value(self) -> tuple[object, ...]:
        return self.system, self.start

    def at(self, times: Numbers) -> Path:
        """The states at physical times, as a Path with q = γ and p = M."""
        return self._path(self._flow.at(times))

    @staticmethod
    def _path(run: Trajectory) -> Path:
        return replaced(Path(run.times, run.gamma, run.M, run.way), error=run.error, digits=run.digits)

    def sensitivity(self, times: Numbers) -> Sensitivity:
        """The derivatives of γ and M with respect to γ(0), M(0), I and d, as given by the body's own flow."""
        return self._flow.sensitivity(times)

    def certify(self, times: Numbers, digits: int | None = None) -> Path:
        """The states at physical times, with ``error`` and ``digits`` as the body's own flow certifies them."""
        return self._path(self._flow.certify(times, digits))

    def events(self, condition: Condition, start: Number, end: Number, direction: int = 0) -> Path:
        """The states between two physical times at which ``condition``, a function of γ and M, changes sign."""
        return self._path(self._flow.events(condition, start, end, direction))

    def enclosure(self, times: Numbers, digits: int | None = None) -> EnclosedPath:
        """Proven bounds of the states at physical times."""
        return _enclosed(self._flow.enclosure(times, digits))

    def enclosure_at_tau(self, tau: Numbers, digits: int | None = None) -> EnclosedPath:
        """:meth:`enclosure` at values of τ."""
        return _enclosed(self._flow.enclosure_at_tau(tau, digits))

    @property
    def portrait(self) -> Portrait:
        """The portrait of the motion that the body's own flow gives."""
        return self._flow.portrait

    def spectrum(self) -> Spectrum:
        """The spectral lines of γ, M and ω that the body's own flow gives."""
        return self._flow.spectrum()

    def section(self, count: int, axis: str = "largest") -> Section:
        """The next ``count`` crossings of a Poincaré section that the body's own flow gives."""
        return self._flow.section(count, axis)

    def tau_near(self, time: Number, digits: int) -> Real:
        """τ at a physical time, as a long number of about ``digits`` digits."""
        wide = MP(max(ball_digits(self.system.field, digits), self.digits))
        body = BodyOnLayer(self.system.constants, self.system.parameters[0], wide).body
        gamma, M = (list(map(wide.coerce, part)) for part in self.start)
        exact = onto_constraints(body, State((gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2])))
        tau: Real = body.flow(exact).at([wide.coerce(time, "time")]).tau[0]
        return tau


def _enclosed(found: Enclosure) -> EnclosedPath:
    return EnclosedPath(found.times, list(zip(found.tau, found.gamma, found.M, found.radius, strict=True)))
