"""An integrator of any precision: the modified midpoint rule, extrapolated (Gragg 1965; Bulirsch and Stoer 1966).

For numbers with operators: floats, mpf. Nothing is known of the equations but their right-hand side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from jacobian.errors import PrecisionLoss

__all__ = ["extrapolated", "integrate"]

Rates = Callable[[list[Any]], Sequence[Any]]
SMALLEST_STEP = 1e-6


def extrapolated(
    rate: Rates, y: Sequence[Any], step: Any, tolerance: Any, columns: int = 60
) -> tuple[list[Any], int] | None:
    """(y after ``step``, columns of the table used): 2, 4, 6, … parts until the result changes by ``tolerance`` at
    most; None where that many columns do not do.
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


def integrate(rate: Rates, start: Sequence[Any], times: Sequence[Any], eps: Any, digits: int) -> list[list[Any]]:
    """y at ``times``, in any order and of either sign, from y = ``start`` at time 0.

    ``eps`` is the change, relative to the largest |y_i| at the start, below which a step is done; ``digits`` that it
    stands for sets the number of columns aimed at. PrecisionLoss where the steps shrink to a millionth of the first, as
    at a singularity of the equations.
    """
    tolerance = eps * max(map(abs, start))
    rows: list[list[Any]] = [list(start)] * len(times)
    size = max(map(abs, start)) / max(max(map(abs, rate(list(start)))), max(map(abs, start)) / 10)
    for sign in (1, -1):
        order = sorted((i for i in range(len(times)) if sign * times[i] > 0), key=lambda i: abs(times[i]))
        y, now, step = list(start), 0 * size, size
        for i in order:
            try:
                y, step = _advance(rate, y, times[i] - now, step, tolerance, digits, SMALLEST_STEP * size)
            except PrecisionLoss as error:
                raise PrecisionLoss(f"times: {error} t = {float(now):g}, before {float(times[i]):g}") from None
            now, rows[i] = times[i], y
    return rows


def _advance(
    rate: Rates, y: list[Any], span: Any, step: Any, tolerance: Any, digits: int, least: Any
) -> tuple[list[Any], Any]:
    """(y after ``span``, the step to try next)."""
    columns = 6 + digits // 2
    done = 0 * span
    while done != span:
        rest = span - done
        whole = abs(rest) <= step
        found = extrapolated(rate, y, rest if whole else (step if rest > 0 else -step), tolerance, columns)
        if found is None:
            step = min(abs(rest), step) / 2
            if step < least:
                raise PrecisionLoss(f"the motion ends, or cannot be followed, {float(done):g} after")
            continue
        y, used = found
        if whole:
            return y, step
        done = done + (step if rest > 0 else -step)
        step = step * 3 / 2 if used < columns * 2 // 3 else step
    return y, step
