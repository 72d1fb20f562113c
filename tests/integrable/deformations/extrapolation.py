"""An ordinary integrator of any precision: the extrapolated midpoint rule (Gragg, Bulirsch and Stoer 1966)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

COLUMNS = 15


def extrapolate(rates: Callable[[list[Any]], list[Any]], y: list[Any], time: Any, pieces: int) -> list[Any]:
    """y after ``time``, in ``pieces`` steps of order 2·COLUMNS."""
    step = time / pieces
    for _ in range(pieces):
        slope, table = rates(y), []
        for k in range(COLUMNS):
            n = 2 * (k + 1)
            row = [_midpoint(rates, y, slope, step, n)]
            for j in range(1, k + 1):
                ratio = (step * 0 + n) / (n - 2 * j)
                factor = 1 / (ratio * ratio - 1)
                row.append([a + (a - b) * factor for a, b in zip(row[j - 1], table[j - 1], strict=True)])
            table = row
        y = table[-1]
    return y


def _midpoint(rates: Any, y: list[Any], slope: list[Any], step: Any, n: int) -> list[Any]:
    h = step / n
    before, now = y, [a + h * b for a, b in zip(y, slope, strict=True)]
    for _ in range(n - 1):
        before, now = now, [a + 2 * h * b for a, b in zip(before, rates(now), strict=True)]
    return now
