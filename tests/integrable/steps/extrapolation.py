"""An integrator of any precision: the modified midpoint rule, extrapolated (Gragg 1965; Bulirsch and Stoer 1966).

For numbers with operators, floats or mpf. Only the right-hand side of the equations is used.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

__all__ = ["extrapolated"]

Rates = Callable[[list[Any]], Sequence[Any]]


def extrapolated(
    rate: Rates, y: Sequence[Any], step: Any, tolerance: Any, columns: int = 60
) -> tuple[list[Any], int] | None:
    """(y after ``step``, columns of the table used): 2, 4, 6, … parts until the result changes by at most
    ``tolerance``; None where this takes more than the given columns.
    """
    rows: list[list[list[Any]]] = []
    start = rate(list(y))
    for k in range(1, columns):
        parts = 2 * k
        h = step / parts
        old, new = list(y), [a + h * b for a, b in zip(y, start, strict=True)]
        for _ in range(parts - 1):
            old, new = new, [a + 2 * h * b for a, b in zip(old, rate(new), strict=True)]
        row = [[(a + b + h * c) / 2 for a, b, c in zip(old, new, rate(new), strict=True)]]
        for j, last in enumerate(rows[-1] if rows else []):
            ratio = (parts / (h * 0 + parts - 2 * j - 2)) ** 2 - 1
            row.append([a + (a - b) / ratio for a, b in zip(row[-1], last, strict=True)])
        if rows and max(abs(a - b) for a, b in zip(row[-1], rows[-1][-1], strict=True)) <= tolerance:
            return row[-1], k
        rows.append(row)
    return None
