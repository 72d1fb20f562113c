"""Motions, divisors and steps of the deformations of the ball and the top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from integrable.deformations.hamiltonian import Hamiltonian
from integrable.phase.state import State
from jacobian.element import Value
from jacobian.errors import ArgumentError, NotRepresentable

if TYPE_CHECKING:
    from integrable.deformations.deformed_flow import DeformedFlow
    from integrable.deformations.two_curves import CurveTranslation, TwoPoints
    from integrable.motion.trajectory import Motion


class Deformation(Hamiltonian):
    """A :class:`Hamiltonian` with motions, divisors and steps: base of :class:`Tilde`, :class:`Check`, :class:`Hat` and
    :class:`Gyroscopic`.
    """

    def flow(self, state: State) -> DeformedFlow:
        """The motion through a state, by additions on two elliptic curves.

        For the tilde, check and hat pairs without potential it is a
        :class:`integrable.deformations.separated_flow.SeparatedFlow`. For the tilde pair at d = 0 whose potential has
        only repelling poles, b_i > 0, it is a :class:`integrable.deformations.pole_flow.PoleFlow`. ArgumentError for
        all other pairs and potentials.
        """
        if self.separates:
            from integrable.deformations.separated_flow import SeparatedFlow

            return SeparatedFlow(self, self._checked(state))
        if self.repels:
            from integrable.deformations.pole_flow import PoleFlow

            return PoleFlow(self, self._checked(state))
        raise ArgumentError(
            f"{self!r}: no separated curves are used with this potential or gyroscopic terms; take "
            "motion_through(state)"
        )

    def motion_through(self, state: State) -> Motion:
        """The motion of a state over RR or MP(digits); ``.at(times)`` evaluates it at physical times.

        The method is :meth:`flow` if available, otherwise integration of the equations of motion
        (:class:`integrable.deformations.integrated.IntegratedMotion`). ``.method`` names the method.
        """
        if self.separates or self.repels:
            try:
                return self.flow(state)
            except NotRepresentable:
                # for equal moments or K = 0 the equations of motion are regular, and are integrated
                pass
        from integrable.deformations.integrated import IntegratedMotion

        return IntegratedMotion(self, self._checked(state))

    def divisor(self, state: State) -> TwoPoints:
        """The divisor of a state: two points, one on each elliptic curve (:mod:`integrable.deformations.two_curves`).

        ArgumentError except for tilde, check and hat pairs without potential. The curves of a check or hat pair are
        those of the tilde pair of A⁻¹; NotASquare if the isometry to this pair is not defined over the field.
        """
        from integrable.deformations import two_curves

        self._check_curves()
        return two_curves.divisors(self, self._checked(state))

    def from_divisor(self, D: TwoPoints, like: State | None = None) -> State:
        """The state that belongs to two points. Eight states share them; the result has the signs of ``like``.

        Without ``like`` the signs are those of the field's square roots of w_i², w = γ × M, and of g².
        """
        from integrable.deformations import two_curves

        self._check_curves()
        return two_curves.from_divisors(self, D, None if like is None else self._checked(like))

    def translation(
        self, points: Sequence[Value | None], sheets: Sequence[int] | None = None, multiple: int = 1
    ) -> CurveTranslation:
        """The map that adds a point of fixed abscissa on each curve; it is a Poisson map and preserves H and K.

        (:class:`integrable.deformations.two_curves.CurveTranslation`)
        """
        from integrable.deformations.two_curves import CurveTranslation

        self._check_curves()
        return CurveTranslation(self, points, sheets, multiple)

    def _check_curves(self) -> None:
        if not self.separates:
            raise ArgumentError(
                f"{self!r}: divisors and steps are those of the two curves of a tilde, check or hat pair without "
                "potential"
            )
