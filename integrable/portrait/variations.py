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

from typing import NamedTuple

import numpy as np

from integrable.phase.body import Body

Array = np.ndarray


class Variation(NamedTuple):
    """The quantities of this module at N states: E (N, 6, 2), the right inverse (N, 6, 4), ∂H1/∂(I, d) (N, 4), J (N, 6,
    6), P (N, 6, 4), 1/g and Y(1/g), both (N,).
    """

    fields: Array
    inverse: Array
    energy: Array
    J: Array
    P: Array
    slowness: Array
    lean: Array

    @staticmethod
    def at(body: Body, rows: Array) -> Variation:
        """The Variation at states (γ, M), given as rows of six numbers, (N, 6)."""
        inertia, a, d = np.array(body.inertia), np.array(body.a), float(body.d)
        gamma, M = rows[:, :3], rows[:, 3:]
        thin = inertia * a
        q = np.sum(thin * gamma**2, axis=1)[:, None]
        n = np.sum(gamma * a * M, axis=1)[:, None] / q
        omega = a * (M + d * n * gamma)
        g = q**-0.5
        fields = np.stack([moved(rows, omega), moved(rows, commuting_spin(body, gamma, M))], axis=2)
        n_gamma, n_M = (a * M - 2 * n * thin * gamma) / q, a * gamma / q
        one = np.eye(3)
        by_gamma = d * a[:, None] * (n[:, :, None] * one + gamma[:, :, None] * n_gamma[:, None, :])
        by_M = a[:, None] * (one + d * gamma[:, :, None] * n_M[:, None, :])
        cross = [_skew(v) for v in (omega, gamma, M)]
        J = np.block(
            [[-cross[0] + cross[1] @ by_gamma, cross[1] @ by_M], [cross[2] @ by_gamma, -cross[0] + cross[2] @ by_M]]
        )
        n_I = -a * gamma * omega / q
        n_d = (-np.sum(a * a * gamma * M, axis=1) + n[:, 0] * np.sum(thin * a * gamma**2, axis=1)) / q[:, 0]
        by_I = -(a * omega)[:, :, None] * one + d * (a * gamma)[:, :, None] * n_I[:, None, :]
        by_d = -a * omega + a * n * gamma + d * a * gamma * n_d[:, None]
        by_p = np.concatenate([by_I, by_d[:, :, None]], axis=2)
        P = np.concatenate([cross[1] @ by_p, cross[2] @ by_p], axis=1)
        gradients = np.zeros((len(rows), 4, 6))
        gradients[:, 0, :3] = 2 * gamma
        gradients[:, 1, :3], gradients[:, 1, 3:] = M, gamma
        gradients[:, 2, :3], gradients[:, 2, 3:] = 2 * d * n * (a * M - n * thin * gamma), 2 * omega
        gradients[:, 3, 3:] = 2 * M
        energy = -np.concatenate([omega**2, np.sum(np.cross(omega, gamma) ** 2, axis=1)[:, None]], axis=1)
        lean = np.sum(thin * gamma * fields[:, :3, 1], axis=1) * g[:, 0]
        return Variation(
            fields, _left_inverse(gradients.transpose(0, 2, 1)).transpose(0, 2, 1), energy, J, P, 1 / g[:, 0], lean
        )

    def rates(self) -> tuple[Array, Array]:
        """The coefficients of ȧ + ρb and ḃ, as at the top of this file: (N, 2, 4) for changes of the four integrals,
        and (N, 2, 4) for changes of I and d at fixed integrals.
        """
        left = _left_inverse(self.fields)
        turning = left @ (self.J + self.J.transpose(0, 2, 1)) @ self.inverse
        return turning, left @ self.P - turning[:, :, 2:3] * self.energy[:, None, :]


def gradient(body: Body, row: Array) -> Array:
    """The derivatives ∂(C1, C2, H1, H2)/∂(γ, M, I, d) at one state, shape (4, 10)."""
    found = Variation.at(body, row[None])
    result = np.zeros((4, 10))
    result[:, :6] = np.linalg.pinv(found.inverse[0])
    result[2, 6:] = found.energy[0]
    return result


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


def _skew(v: Array) -> Array:
    """The matrices [v]× with [v]×x = v × x, shape (N, 3, 3)."""
    return np.cross(v[:, :, None], np.eye(3), axis=1)
