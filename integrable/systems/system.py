"""The base class of the ball and the top, with their steps and their flow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from integrable.phase.space import PhaseSpace
from integrable.phase.state import State, check_state
from jacobian.element import Element, Real
from jacobian.errors import ArgumentError

if TYPE_CHECKING:
    from integrable.motion.flow import Flow
    from integrable.portrait.diagram import Diagram
    from integrable.steps.hat_map import HatMap
    from integrable.steps.moves import ConicStep, Keyless, Multiplication
    from integrable.steps.step import Abscissa
    from integrable.steps.time_shift import Shift
    from integrable.steps.translation import Translation


class System(PhaseSpace[Element]):
    """A rigid body and its maps. Base of :class:`ChaplyginBall` and :class:`EulerTop`."""

    def poisson(self, state: State[Element]) -> tuple[tuple[Element, ...], ...]:
        """The 6×6 matrix of the brackets of (γ, M), for which (γ̇, Ṁ) = g{(γ, M), H1/2}; at d = 0 they are those of
        e*(3) with the opposite sign.

        The brackets are defined for (γ, M) ≠ 0 too. NotASquare where g² has no root in the field.
        """
        from integrable.phase.brackets import ball_matrix

        state = self._checked(state)
        return ball_matrix(self.body, *state.vectors, state.g)

    def translation(
        self,
        points: Iterable[Abscissa],
        sheets: Sequence[int] | None = None,
        signs: Sequence[int] | None = None,
        multiple: int = 1,
    ) -> Translation:
        """The Bäcklund map D ↦ D + [multiple]Σ((x_k, ±√f(x_k)) − ∞), for two abscissas x_k, or for one if d ≠ 0.

        Abscissas are numbers, or functions of (h1, h2) as in :class:`integrable.steps.translation.Translation`, which
        also defines ``sheets``, the signs ±, and ``signs``.

        The image is real for two points on one oval, one or two points beyond 1/d, a complex-conjugate pair, the branch
        point 1/d, or an even multiple of any points.
        """
        from integrable.steps.translation import Translation

        return Translation(self, points, sheets, signs, multiple)

    def torsion(self, signs: Sequence[int] | None = None) -> Translation:
        """The 2-torsion map D ↦ D + (1/d, 0) − ∞ (d ≠ 0), Tsiganov's Proposition 2. Its square is (γ, M) ↦ (−γ, M)."""
        if not self.body.rolls:
            raise ArgumentError("d = 0: the branch point 1/d is at infinity; the 2-torsion map needs d ≠ 0")
        middle: Any = self.field.inv(self.d)
        return self.translation([middle], signs=signs)

    def keyless(self, signs: Sequence[int] | None = None) -> Keyless:
        """A 2-torsion map that is real for every body, also at d = 0 (:class:`integrable.steps.moves.Keyless`)."""
        from integrable.steps.moves import Keyless

        return Keyless(self, signs)

    def multiplication(self, factor: int) -> Multiplication:
        """The map D ↦ [factor]D (:class:`integrable.steps.moves.Multiplication`)."""
        from integrable.steps.moves import Multiplication

        return Multiplication(self, factor)

    def conic(self, x0: Abscissa | None, y0: Abscissa, sign: int = 1) -> ConicStep:
        """The step by the parabola through (x0, y0) in the pencil of parabolas of a state, at d = 0
        (:class:`integrable.steps.moves.ConicStep`).
        """
        from integrable.steps.moves import ConicStep

        return ConicStep(self, x0, y0, sign)

    def hat_map(self, signs: Sequence[int] | None = None) -> HatMap:
        """The canonical change to the hat variables, at d = 0 (:class:`integrable.steps.hat_map.HatMap`)."""
        from integrable.steps.hat_map import HatMap

        return HatMap(self, signs)

    def shift(self, F: Callable[..., Real]) -> Shift:
        """The time-1 map of the Hamiltonian F(H1, H2) (:class:`integrable.steps.time_shift.Shift`); RR and
        MP(digits) only."""
        from integrable.steps.time_shift import Shift

        return Shift(self, F)

    def flow(self, state: State[Element], kernel: str = "auto") -> Flow:
        """The exact motion through a state, set up once (:class:`integrable.motion.flow.Flow`); RR and MP(digits)
        only."""
        from integrable.motion.flow import Flow

        return Flow(self, check_state(self, state), kernel)

    def diagram(self) -> Diagram:
        """All motions of the body by energy and momentum (:class:`integrable.portrait.diagram.Diagram`); RR only."""
        from integrable.portrait.diagram import Diagram

        return Diagram(self)

    def motion_through(self, state: State[Element]) -> Flow:
        """The motion through a state, with ``.at(times)``: the same as :meth:`flow`, under a name that every system
        has.
        """
        return self.flow(state)
