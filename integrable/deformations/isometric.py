"""The check and hat pairs on the sphere at d = 0: isometric to tilde pairs, with five-parameter potentials."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from integrable.deformations.deformation import Deformation
from integrable.deformations.hamiltonian import Isometry
from integrable.deformations.scalars import Potential, RateTerms, Scalars, poles
from jacobian import RR
from jacobian.element import Real, Value
from jacobian.fields.protocol import Field
from jacobian.immutable import at_once


class IsometricDeformation(Deformation):
    """A pair on e*(3) at d = 0, isometric to the tilde pair of A⁻¹: the base class of :class:`Check`, :class:`Hat`."""

    @at_once
    def __init__(
        self, inertia: Iterable[Value], *, potential: Sequence[Value] | None = None, field: Field = RR
    ) -> None:
        self._build(inertia, 0, potential, field)

    degree = 2
    has_curves = True


class Check(IsometricDeformation):
    """H = s·m1 − s²m2 − 2ξ², K = ξ²(s·m1 − ξ²) on e*(3), (γ, M) = 0, with a_i = 1/I_i.

    ``potential`` = (a, b, β_1, β_2, β_3) adds a/s + b(s⁻³ − tr A⁻¹·s⁻²) + Σβ_i(1/a_j + 1/a_k − 2/s)s/(a_iγ_i²). The
    pair is isometric to the tilde pair of A⁻¹ (:func:`integrable.phase.isometry.lift`). (Tsiganov, the check
    Hamiltonian as corrected in docs/errata.md, item 22.) The kinetic energy is indefinite, so a pole may attract, and
    γ_i may reach 0 in finite time. The letters s, m1, m2 and ξ are those of :class:`Scalars`.
    """

    def isometry(self) -> Isometry:
        """The :class:`Isometry` to the tilde pair of A⁻¹: B² = A and ``factor`` = −e3, with e3 = a1·a2·a3."""
        from integrable.deformations.tilde import Tilde

        K, (a1, a2, a3) = self.field, self.a
        return Isometry(self.a, K.neg(K.mul(a1, K.mul(a2, a3))), Tilde(self.a, field=K))

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Real, Real]:
        square = q.xi * q.xi
        energy, first, second = q.s * (q.m1 - q.s * q.m2) - 2 * square, q.s * q.m1 - square, square
        if potential is not None:
            a, b, *_ = potential
            trace = q.e2 / q.e3
            energy = energy + self.potential_energy(q, potential)
            first = first + (a + b * (1 / (q.s * q.s) - trace / q.s - q.q2 / (q.e3 * q.s))) / q.s
            first = first - poles(q, potential, lambda a1, *_: 1 / a1)
            terms = poles(q, potential, lambda a1, a2, a3: (1 / q.s - 1 / a2) * (1 / q.s - 1 / a3) / a1)
            second = second + q.s * q.s * terms
        return energy, first * second

    def potential_energy(self, q: Scalars, potential: Potential) -> Real:
        a, b, *_ = potential
        inverse = 1 / q.s
        terms = poles(q, potential, lambda a1, a2, a3: (1 / a2 + 1 / a3 - 2 * inverse) * q.s / a1)
        energy: Real = a * inverse + b * (inverse - q.e2 / q.e3) * inverse * inverse + terms
        return energy

    def motion(self, q: Scalars) -> RateTerms:
        """Ω = sAM − s²M − 2ξAγ, Ṁ = M × Ω + γ × [(m1 − 2s·m2)Aγ − 2ξAM], with the letters of :class:`Scalars`."""
        return RateTerms(q.s, -(q.s * q.s), -2 * q.xi, q.m1 - 2 * (q.s * q.m2))


class Hat(IsometricDeformation):
    """H = α·m1 − (σ + ατ)m2 = λ1 + λ2, K = (σξ + τζ)²(w, Aw) = −e3·λ1λ2 on e*(3), (γ, M) = 0, with a_i = 1/I_i.

    α = σ·tr A⁻¹ − 2τ, τ = tr A − s, w = γ × M, A^∨ = e3·A⁻¹; the other letters are those of :class:`Scalars`.
    ``potential`` = (a, b, β_1, β_2, β_3) adds aS + b(S³ − tr A⁻¹·S²) + Σβ_i(1/a_j + 1/a_k − 2S)σ/(a_ja_kγ_i²), S =
    e2/e3 − τ/σ. The pair is isometric to the tilde pair of A⁻¹ (:func:`integrable.phase.isometry.lift`).
    """

    def eigenvalue_sums(self, H: Real, K: Real) -> tuple[Real, Real]:
        field, (a1, a2, a3) = self.field, self.a
        return H, field.div(K, field.mul(a1, field.mul(a2, a3)))

    def isometry(self) -> Isometry:
        """The :class:`Isometry` to the tilde pair of A⁻¹: B² = e3·A⁻¹ and ``factor`` = e3, with e3 = a1·a2·a3."""
        from integrable.deformations.tilde import Tilde

        K, (a1, a2, a3) = self.field, self.a
        squares = (K.mul(a2, a3), K.mul(a3, a1), K.mul(a1, a2))
        return Isometry(squares, K.mul(a1, squares[0]), Tilde(self.a, field=K))

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Real, Real]:
        alpha, root = _alpha(q), q.sigma * q.xi + q.tau * q.zeta
        energy = alpha * q.m1 - (q.sigma + alpha * q.tau) * q.m2
        first, second = q.tau * q.m2 - q.m1, root * root
        if potential is not None:
            (a, b, *_), S, trace = potential, _slope(q), q.e2 / q.e3
            energy = energy + self.potential_energy(q, potential)
            first = first - (a + b * (S * S - trace * S - 1 / q.sigma)) / q.sigma
            first = first + poles(q, potential, lambda _, a2, a3: 1 / (a2 * a3))
            terms = poles(q, potential, lambda _, a2, a3: (S - 1 / a2) * (S - 1 / a3) / (a2 * a3))
            second = second - q.e3 * q.sigma * q.sigma * terms
        return energy, first * second

    def potential_energy(self, q: Scalars, potential: Potential) -> Real:
        (a, b, *_), S = potential, _slope(q)
        terms = poles(q, potential, lambda _, a2, a3: (1 / a2 + 1 / a3 - 2 * S) * q.sigma / (a2 * a3))
        energy: Real = a * S + b * (S - q.e2 / q.e3) * S * S + terms
        return energy

    def motion(self, q: Scalars) -> RateTerms:
        """Ω = αAM − (σ + ατ)M, Ṁ = M × Ω + γ × {[tr A⁻¹·A^∨γ + 2Aγ](m1 − τm2) + αm2·Aγ − m2·A^∨γ}, with the σ, τ, m1
        and m2 of :class:`Scalars`, A^∨ = e3·A⁻¹ and α = tr A⁻¹·σ − 2τ.
        """
        alpha, height = _alpha(q), q.m1 - q.tau * q.m2
        return RateTerms(alpha, -q.sigma - alpha * q.tau, 0, 2 * height + alpha * q.m2, q.e2 / q.e3 * height - q.m2)


def _alpha(q: Scalars) -> Any:
    return q.sigma * (q.e2 / q.e3) - 2 * q.tau


def _slope(q: Scalars) -> Any:
    return q.e2 / q.e3 - q.tau / q.sigma
