"""The equations of motion and the variational equations written out, with extrapolated midpoint steps (Gragg 1965).

They share no formula with the package: δq, δn and δω are computed in turn, for numbers of any kind. A table has the
rows (γ, M) and, for each of the ten inputs γ(0), M(0), I and d, (δγ, δM).
"""

from __future__ import annotations

from typing import Any

import numpy as np


def rates(I: Any, d: Any, table: Any) -> Any:  # noqa: E741
    """The rates of tables (K, 11, 6) for moments (K, 3) and d (K,)."""
    gamma, M = table[:, 0, :3], table[:, 0, 3:]
    d = d[:, None]
    a = 1 / (I + d)
    q = np.sum(I * a * gamma * gamma, axis=1)[:, None]
    n = np.sum(gamma * a * M, axis=1)[:, None] / q
    omega = a * M + d * n * a * gamma
    out = np.empty_like(table)
    out[:, 0, :3], out[:, 0, 3:] = np.cross(gamma, omega), np.cross(M, omega)
    dg, dm = table[:, 1:, :3], table[:, 1:, 3:]
    dI, dd = np.zeros((1, 10, 3), dtype=int), np.zeros((1, 10, 1), dtype=int)
    dI[0, 6:9], dd[0, 9] = np.eye(3, dtype=int), 1
    I, d, a, gamma, M, n, q, omega = (x[:, None] for x in (I, d, a, gamma, M, n, q, omega))  # noqa: E741
    da = -a * a * (dI + dd)
    dq = np.sum(2 * I * a * gamma * dg + (a * dI + I * da) * gamma * gamma, axis=2)[:, :, None]
    dn = (np.sum(dg * a * M + gamma * a * dm + gamma * da * M, axis=2)[:, :, None] - n * dq) / q
    dw = a * dm + da * M + (n * dd + d * dn) * a * gamma + d * n * (da * gamma + a * dg)
    out[:, 1:, :3] = np.cross(dg, omega) + np.cross(gamma, dw)
    out[:, 1:, 3:] = np.cross(dm, omega) + np.cross(M, dw)
    return out


def sensitivities(I: Any, d: Any, gamma: Any, M: Any, time: Any, steps: int, columns: int = 9) -> tuple[Any, Any]:  # noqa: E741
    """(states (K, 6), ∂ (K, 6, 10)) at ``time``; the columns of γ(0) are for tangents of the sphere."""
    count = len(I)
    zero = 0 * (I[:, 0] + time)
    table = np.zeros((count, 11, 6), dtype=I.dtype) + zero[:, None, None]
    table[:, 0] = np.hstack([gamma, M])
    for k in range(6):
        table[:, k + 1, k] += 1
    table[:, 1:4, :3] -= gamma[:, :, None] * gamma[:, None, :]
    step = time / steps
    for _ in range(steps):
        rows: list[Any] = []
        for k in range(1, columns + 1):
            row = [_midpoint(I, d, table, step, 2 * k)]
            for j in range(1, k):
                row.append(row[j - 1] + (row[j - 1] - rows[-1][j - 1]) / (k * k / (step * 0 + (k - j) ** 2) - 1))
            rows.append(row)
        table = rows[-1][-1]
    return table[:, 0], table[:, 1:].transpose(0, 2, 1)


def _midpoint(I: Any, d: Any, table: Any, step: Any, count: int) -> Any:  # noqa: E741
    h = step / count
    before, here = table, table + h * rates(I, d, table)
    for _ in range(count - 1):
        before, here = here, before + 2 * h * rates(I, d, here)
    return (before + here + h * rates(I, d, here)) / 2
