"""The hat pair on the sphere, d = 0, with its five-parameter potentials."""

from __future__ import annotations

from typing import Any

from integrable.deformations.deformation import IsometricDeformation
from integrable.deformations.hamiltonian import Potential, Scalars, combination, poles, product


class Hat(IsometricDeformation):
    """H = α·m1 − (σ + ατ)m2 = ν1 + ν2, K = (σξ + τζ)²(w, Aw) = −e3·ν1ν2 on e*(3), (γ, M) = 0, with a_i = 1/I_i.

    α = σ·tr A⁻¹ − 2τ, τ = tr A − s, w = γ × M. K is minus e3·ν1ν2, so that it extends to the
    ``potential`` = (a, b, β_1, β_2, β_3), which adds aS + b(S³ − tr A⁻¹·S²) + Σβ_i(1/a_j + 1/a_k − 2S)σ/(a_ja_kγ_i²),
    S = e2/e3 − τ/σ. Isometric to the tilde pair of A⁻¹ (:func:`integrable.phase.isometry.lift`).
    """

    def isometry(self) -> tuple[Any, Any, Any]:
        """(B², m, system): B² = A^∨, m = e3 and the tilde pair of A⁻¹, with H = m·H̃ at the lift of B."""
        from integrable.deformations.tilde import Tilde

        K, (a1, a2, a3) = self.field, self.a
        squares = (K.mul(a2, a3), K.mul(a3, a1), K.mul(a1, a2))
        return squares, K.mul(a1, squares[0]), Tilde(self.a, field=K)

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Any, Any]:
        """(H, K)."""
        alpha, root = _alpha(q), q.sigma * q.xi + q.tau * q.zeta
        energy = alpha * q.m1 - (q.sigma + alpha * q.tau) * q.m2
        first, second = q.tau * q.m2 - q.m1, root * root
        if potential is not None:
            (a, b, _), S, trace = potential, _slope(q), q.e2 / q.e3
            energy = energy + self.potential_energy(q, potential)
            first = first - (a + b * (S * S - trace * S - 1 / q.sigma)) / q.sigma
            first = first + poles(q, potential, lambda _, a2, a3: 1 / (a2 * a3))
            terms = poles(q, potential, lambda _, a2, a3: (S - 1 / a2) * (S - 1 / a3) / (a2 * a3))
            second = second - q.e3 * q.sigma * q.sigma * terms
        return energy, first * second

    def potential_energy(self, q: Scalars, potential: Potential) -> Any:
        """V(γ)."""
        (a, b, _), S = potential, _slope(q)
        terms = poles(q, potential, lambda _, a2, a3: (1 / a2 + 1 / a3 - 2 * S) * q.sigma / (a2 * a3))
        return a * S + b * (S - q.e2 / q.e3) * S * S + terms

    def motion(self, q: Scalars) -> tuple[Any, Any]:
        """Ω = αAM − (σ + ατ)M, Ṁ = M × Ω + γ × {[tr A⁻¹·A^∨γ + 2Aγ](m1 − τm2) + αm2·Aγ − m2·A^∨γ}."""
        alpha, dual = _alpha(q), [a * x for a, x in zip(q.dual, q.gamma, strict=True)]
        omega = combination((alpha, q.AM), (-q.sigma - alpha * q.tau, q.M))
        height = q.m1 - q.tau * q.m2
        pull = combination((q.e2 / q.e3 * height - q.m2, dual), (2 * height + alpha * q.m2, q.Ag))
        return omega, combination((1, product(q.M, omega)), (1, product(q.gamma, pull)))


def _alpha(q: Scalars) -> Any:
    return q.sigma * (q.e2 / q.e3) - 2 * q.tau


def _slope(q: Scalars) -> Any:
    """S = e2/e3 − τ/σ."""
    return q.e2 / q.e3 - q.tau / q.sigma
