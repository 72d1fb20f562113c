"""The equations of variation of a body, as functions of its states.

x = (γ, M), ẋ = (γ × ω, M × ω), ω = A(M + dnγ), n = (γ, AM)/q, q = g⁻² = ΣI_i a_i γ_i². The derivatives S of a state
with respect to (x(0), I, d) obey Ṡ = JS + P, J = ∂ẋ/∂x and P = (0, ∂ẋ/∂(I, d)). The field Y of H2/2 is γ' = γ × Ω, M' =
M × Ω with Ω = M/g + dg(γ, AM)γ; it commutes with g⁻¹ẋ, the motion in τ.

Let F have the gradients of (C1, C2, H1, H2) as rows, N be the right inverse of F with columns orthogonal to E = (ẋ, Y),
and G = F·S, which is known from the start and the parameters. Then

    S = N·G + ẋ ⊗ a + Y ⊗ b,   (ȧ + ρb, ḃ) = (EᵀE)⁻¹Eᵀ[(J + Jᵀ)NG + P],   ρ = g·Y(1/g),

so only integrals of functions of the state remain. Numbers are floats; the first axis of arrays numbers the states.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from integrable.phase.body import Body, cross
from integrable.phase.jets import Jet, JetField
from jacobian import RR

Array = np.ndarray
# jets with a slope for each of γ, M, I and d; their values and slopes are numbers or arrays of N numbers
JETS = JetField(RR, 10)


class Variation(NamedTuple):
    """The quantities of this module at N states: E (N, 6, 2), the right inverse (N, 6, 4), ∂(C1, C2, H1, H2)/∂(γ, M, I,
    d) (N, 4, 10), J (N, 6, 6), P (N, 6, 4), 1/g and Y(1/g), both (N,).
    """

    fields: Array
    inverse: Array
    gradients: Array
    J: Array
    P: Array
    slowness: Array
    lean: Array

    @staticmethod
    def at(body: Body, rows: Array) -> Variation:
        """The Variation at states (γ, M), given as rows of six numbers, (N, 6)."""
        y: Any = JETS.variables([*rows.T, *body.inertia, body.d])
        gamma, M, wide = y[:3], y[3:6], Body(y[6:9], y[9], JETS)
        omega = wide.omega(gamma, M)
        rates = (*cross(JETS, gamma, omega), *cross(JETS, M, omega))
        slopes, gradients = (_slopes(x, len(rows)) for x in (rates, wide.integrals(gamma, M)))
        Y = moved(rows, commuting_spin(body, rows[:, :3], rows[:, 3:]))
        fields = np.stack([np.stack([x.value for x in rates], axis=1), Y], axis=2)
        square = wide.conformal(gamma)
        slowness = square.value**0.5
        lean = np.sum(_slopes((square,), len(rows))[:, 0, :6] * Y, axis=1) / (2 * slowness)
        inverse = _left_inverse(gradients[:, :, :6].transpose(0, 2, 1)).transpose(0, 2, 1)
        return Variation(fields, inverse, gradients, slopes[:, :, :6], slopes[:, :, 6:], slowness, lean)

    def rates(self) -> tuple[Array, Array]:
        """The coefficients of ȧ + ρb and ḃ, as at the top of this file: (N, 2, 4) for changes of the four integrals,
        and (N, 2, 4) for changes of I and d at fixed integrals.
        """
        left = _left_inverse(self.fields)
        turning = left @ (self.J + self.J.transpose(0, 2, 1)) @ self.inverse
        return turning, left @ self.P - turning[:, :, 2:3] * self.gradients[:, None, 2, 6:]


def _slopes(jets: tuple[Jet, ...], count: int) -> Array:
    """The slopes of m jets at ``count`` states, shape (N, m, 10)."""
    return np.stack([np.stack([x + np.zeros(count) for x in jet.slopes], axis=1) for jet in jets], axis=1)


def commuting_spin(body: Body, gamma: Array, M: Array) -> Array:
    """The vectors Ω = M/g + dg(γ, AM)γ of the Hamiltonian field Y of H2/2, shape (N, 3), in floats or mpf."""
    slowness = (np.sum(np.array(body.contact) * gamma**2, axis=1) ** 0.5)[:, None]
    along = np.sum(gamma * np.array(body.a) * M, axis=1)[:, None]
    return slowness * M + body.d * along / slowness * gamma


def _left_inverse(columns: Array) -> Array:
    """The pseudo-inverses, shape (N, m, 6), of N matrices of independent columns, shape (N, 6, m)."""
    q, r = np.linalg.qr(columns)
    return np.linalg.solve(r, q.transpose(0, 2, 1))


def moved(rows: Array, spin: Array) -> Array:
    """The derivatives (γ × Ω, M × Ω) of states (γ, M), (N, 6), for Ω = ``spin``, (N, 3), in floats or mpf."""
    return np.concatenate([np.cross(rows[:, :3], spin), np.cross(rows[:, 3:], spin)], axis=1)
