"""The check pair, d = 0, with its five-parameter potentials."""

from __future__ import annotations

from typing import Any

from integrable.deformations.deformation import IsometricDeformation
from integrable.deformations.hamiltonian import Potential, Scalars, combination, poles, product


class Check(IsometricDeformation):
    """H = s·m1 − s²m2 − 2ξ², K = ξ²(s·m1 − ξ²) on e*(3), (γ, M) = 0, with a_i = 1/I_i.

    ``potential`` = (a, b, β_1, β_2, β_3) adds a/s + b(s⁻³ − tr A⁻¹·s⁻²) + Σβ_i(1/a_j + 1/a_k − 2/s)s/(a_iγ_i²).
    Isometric to the tilde pair of A⁻¹ (:func:`integrable.phase.isometry.lift`). (Tsiganov, the check Hamiltonian as
    corrected in docs/errata.md, item 22.) The kinetic energy is indefinite: a pole may attract, and γ_i reach 0 in
    finite time.
    """

    def isometry(self) -> tuple[Any, Any, Any]:
        """(B², m, system): B² = A, m = −e3 and the tilde pair of A⁻¹, with H = m·H̃ at the lift of B."""
        from integrable.deformations.tilde import Tilde

        K, (a1, a2, a3) = self.field, self.a
        return self.a, K.neg(K.mul(a1, K.mul(a2, a3))), Tilde(self.a, field=K)

    def pair(self, q: Scalars, potential: Potential | None) -> tuple[Any, Any]:
        """(H, K)."""
        square = q.xi * q.xi
        energy, first, second = q.s * (q.m1 - q.s * q.m2) - 2 * square, q.s * q.m1 - square, square
        if potential is not None:
            a, b, _ = potential
            trace = q.e2 / q.e3
            energy = energy + self.potential_energy(q, potential)
            first = first + (a + b * (1 / (q.s * q.s) - trace / q.s - q.q2 / (q.e3 * q.s))) / q.s
            first = first - poles(q, potential, lambda a1, *_: 1 / a1)
            terms = poles(q, potential, lambda a1, a2, a3: (1 / q.s - 1 / a2) * (1 / q.s - 1 / a3) / a1)
            second = second + q.s * q.s * terms
        return energy, first * second

    def potential_energy(self, q: Scalars, potential: Potential) -> Any:
        """V(γ)."""
        a, b, _ = potential
        inverse = 1 / q.s
        terms = poles(q, potential, lambda a1, a2, a3: (1 / a2 + 1 / a3 - 2 * inverse) * q.s / a1)
        return a * inverse + b * (inverse - q.e2 / q.e3) * inverse * inverse + terms

    def motion(self, q: Scalars) -> tuple[Any, Any]:
        """Ω = sAM − s²M − 2ξAγ, Ṁ = M × Ω + γ × [(m1 − 2s·m2)Aγ − 2ξAM]."""
        omega = combination((q.s, q.AM), (-q.s * q.s, q.M), (-2 * q.xi, q.Ag))
        pull = combination((q.m1 - 2 * q.s * q.m2, q.Ag), (-2 * q.xi, q.AM))
        return omega, combination((1, product(q.M, omega)), (1, product(q.gamma, pull)))
