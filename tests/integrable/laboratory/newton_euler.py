"""Newton's and Euler's equations in the laboratory, for many bodies at once; no formula is shared with the package.

The centre obeys mv̇ = F, the spin Jω̇ + ω × Jω = (−rz) × F, and rolling v = rω × z gives F: with d = mr²,
(J + d(1 − zzᵀ))ω̇ = −ω × Jω, where J turns with the body; d = 0 is a free body. Extrapolated midpoint steps (Gragg
1965, Bulirsch and Stoer 1966) in numbers of any kind.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def integrated(J: Any, d: Any, R: Any, omega: Any, radius: Any, time: Any, steps: int, columns: int = 9) -> Any:
    """(R, ω, path of the contact) at ``time``, for tensors (K, 3, 3), d (K,), rotations, ω (K, 3) and radii (K,)."""
    kind = np.asarray(J).dtype
    table = np.concatenate([np.asarray(R).reshape(len(J), 9), omega, np.zeros((len(J), 2), dtype=kind)], axis=1)
    step = time / steps
    for _ in range(steps):
        rows: list[Any] = []
        for k in range(1, columns + 1):
            row = [_midpoint(J, d, radius, table, step, 2 * k)]
            for j in range(1, k):
                factor = k * k / (step * 0 + (k - j) ** 2) - 1
                row.append(row[j - 1] + (row[j - 1] - rows[-1][j - 1]) / factor)
            rows.append(row)
        table = rows[-1][-1]
    return table[:, :9].reshape(-1, 3, 3), table[:, 9:12], table[:, 12:]


def _midpoint(J: Any, d: Any, radius: Any, table: Any, step: Any, count: int) -> Any:
    h = step / count
    before, here = table, table + h * rates(J, d, radius, table)
    for _ in range(count - 1):
        before, here = here, before + 2 * h * rates(J, d, radius, here)
    return (before + here + h * rates(J, d, radius, here)) / 2


def rates(J: Any, d: Any, radius: Any, table: Any) -> Any:
    """The rates of tables (K, 14): R row by row, ω, path of the contact."""
    R, w = table[:, :9].reshape(-1, 3, 3), table[:, 9:12]
    turned = R @ J @ R.transpose(0, 2, 1)
    rolling = turned + d[:, None, None] * np.diag([1, 1, 0])
    force = -np.cross(w, (turned @ w[:, :, None])[:, :, 0])
    a, b, c = rolling[:, 0], rolling[:, 1], rolling[:, 2]
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=2)
    accelerated = (cofactors @ force[:, :, None])[:, :, 0] / np.sum(a * np.cross(b, c), axis=1)[:, None]
    turning = np.cross(w[:, None, :], R.transpose(0, 2, 1)).transpose(0, 2, 1)
    moved = radius[:, None] * np.stack([w[:, 1], -w[:, 0]], axis=1)
    return np.concatenate([turning.reshape(-1, 9), accelerated, moved], axis=1)
