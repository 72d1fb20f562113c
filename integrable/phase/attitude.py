"""The orientation of a body in space, from the two vectors fixed in space, and its angular velocity.

γ̇ = γ×ω and Ṁ = M×ω mean that the vertical γ and the angular momentum M about the contact point are fixed in space.
These two vectors give the orientation without any integration: z is the vertical, x the direction of the horizontal
part of M, y = z × x.
"""

from __future__ import annotations

import numpy as np

from integrable.phase.body import Body


def angular_velocities(body: Body, gamma: np.ndarray, M: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """ω = A M + d·n·A γ, shape (N, 3), and n = (γ, ω) = g²(γ, A M), shape (N,), from γ and M of shape (N, 3).

    A = diag 1/(I_i + d). Each row of ω is the result of :meth:`integrable.phase.body.Body.omega`.
    """
    a = np.array(body.a)
    moved = a * M
    spin = np.sum(gamma * moved, axis=1) / np.sum(np.array(body.contact) * gamma**2, axis=1)
    return (moved + body.d * spin[:, None] * a * gamma if body.rolls else moved), spin


def matrices(gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
    """The rotations R that take body coordinates to space coordinates, shape (N, 3, 3), from γ and M of shape (N, 3).

    The rows are the axes x, y, z of space in the body frame: R γ = (0, 0, 1), R M = (√(|M|² − (γ, M)²), 0, (γ, M)).
    """
    horizontal = M
    # one projection of a vector nearly along γ leaves a rounding error along γ, which a second removes (Parlett 1980)
    for _ in range(2):
        horizontal = horizontal - np.sum(gamma * horizontal, axis=1)[:, None] * gamma
    x = horizontal / (np.sum(horizontal * horizontal, axis=1) ** 0.5)[:, None]
    return np.stack([x, np.cross(gamma, x), gamma], axis=1)


def quaternions(rotations: np.ndarray) -> np.ndarray:
    """Unit quaternions q = (w, x, y, z), w ≥ 0, shape (N, 4), of rotation matrices R, shape (N, 3, 3).

    R v is the vector part of q v q⁻¹. SciPy's order is (x, y, z, w). No digits are lost at half turns: the largest
    component is computed first (Shepperd 1978).
    """
    r = rotations
    # ``products`` is 4 q qᵀ, whose rows are multiples of q
    products = np.empty((len(r), 4, 4), dtype=r.dtype)
    trace = r[:, 0, 0] + r[:, 1, 1] + r[:, 2, 2]
    products[:, 0, 0] = 1 + trace
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        products[:, i + 1, i + 1] = 1 + 2 * r[:, i, i] - trace
        products[:, 0, i + 1] = products[:, i + 1, 0] = r[:, k, j] - r[:, j, k]
        products[:, j + 1, k + 1] = products[:, k + 1, j + 1] = r[:, j, k] + r[:, k, j]
    rows = np.arange(len(r))
    largest = np.argmax(np.diagonal(products, axis1=1, axis2=2).astype(float), axis=1)
    chosen = products[rows, largest]
    quaternion: np.ndarray = chosen / (2 * chosen[rows, largest] ** 0.5)[:, None]
    quaternion[quaternion[:, 0] < 0] *= -1
    return quaternion
