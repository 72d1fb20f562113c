"""An integrator of any precision: the modified midpoint rule, extrapolated (Gragg 1965; Bulirsch and Stoer 1966).

For numbers with operators: floats, mpf. Nothing is known of the equations but their right-hand side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from jacobian.errors import Infeasible, PrecisionLoss

__all__ = ["extrapolated", "integrate"]

Rates = Callable[[list[Any]], Sequence[Any]]
SMALLEST_STEP = 1e-6
MOST_RATES = 20_000
"""Evaluations of the right-hand side: half a minute to a minute of those of a deformation."""
# steps from which on what is left is judged from what is done, and the factor by which they may differ
KNOWN_FROM = 4
# so many of the first step are beyond reach, whatever the later ones are like
FARTHEST = 100 * MOST_RATES
UNEVEN = 4


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


def integrate(
    rate: Rates,
    start: Sequence[Any],
    times: Sequence[Any],
    eps: Any,
    digits: int,
    refused: dict[int, str] | None = None,
) -> list[list[Any]]:
    """y at ``times``, in any order and of either sign, from y = ``start`` at time 0.

    ``eps`` is the change, relative to the largest |y_i| at the start, below which a step is done; ``digits`` that it
    stands for sets the number of columns aimed at. PrecisionLoss where the steps shrink to a millionth of the first, as
    at a singularity of the equations; Infeasible, after a few steps, where MOST_RATES evaluations will not do.
    """
    rows: list[list[Any]] = [list(start)] * len(times)
    for sign in (1, -1):
        order = sorted((i for i in range(len(times)) if sign * times[i] > 0), key=lambda i: abs(times[i]))
        run = _Run(rate, start, eps, digits) if order else None
        for k, i in enumerate(order):
            assert run is not None
            try:
                rows[i] = run.advanced(times[i], times[order[-1] if refused is None else i])
            except (PrecisionLoss, Infeasible) as error:
                if refused is None:
                    raise
                refused.update(dict.fromkeys(order[k:], str(error)))
                break
    return rows


class _Run:
    """One integration from time 0 in one direction."""

    def __init__(self, rate: Rates, start: Sequence[Any], eps: Any, digits: int) -> None:
        self._y, self._digits = list(start), digits
        size = max(map(abs, start))
        self._tolerance = eps * size
        self._step = size / max(max(map(abs, rate(list(start)))), size / 10)
        self._first, self._least = self._step, SMALLEST_STEP * self._step
        self._now = 0 * size
        self._rates = self._steps = 0
        self._rate = rate

    def advanced(self, time: Any, end: Any) -> list[Any]:
        """y at ``time``, farther from 0 than any before, on the way to ``end``."""
        self._end = end
        columns = 6 + self._digits // 2
        begin, done, span = self._now, 0 * time, time - self._now
        while done != span:
            rest = span - done
            whole = abs(rest) <= self._step
            length = rest if whole else (self._step if rest > 0 else -self._step)
            self._check_work(begin + done)
            found = extrapolated(self._counted, self._y, length, self._tolerance, columns)
            if found is None:
                self._step = abs(length) / 2
                if self._step < self._least:
                    raise PrecisionLoss(
                        f"times: the motion ends, or cannot be followed, {float(done):g} after t = {float(begin):g}, "
                        f"before {float(time):g}"
                    )
                continue
            self._y, used = found
            self._steps += 1
            done = span if whole else done + length
            if not whole and used < columns * 2 // 3:
                self._step = self._step * 3 / 2
        self._now = time
        return self._y

    def _counted(self, y: list[Any]) -> Sequence[Any]:
        self._rates += 1
        return self._rate(y)

    def _check_work(self, now: Any) -> None:
        """Infeasible where the work done, or what the steps so far lead to expect, is too much."""
        part = abs(now / self._end)
        if abs(self._end) > FARTHEST * self._first:
            raise Infeasible(
                f"times: the equations of motion are integrated, and t = {float(self._end):g} takes more than "
                f"{MOST_RATES} evaluations of them"
            )
        expected = self._rates / part if self._steps >= KNOWN_FROM else 0
        if self._rates > MOST_RATES or expected > UNEVEN * MOST_RATES:
            reach = abs(now) * MOST_RATES / self._rates
            raise Infeasible(
                f"times: the equations of motion are integrated, and t = {float(self._end):g} takes more than "
                f"{MOST_RATES} evaluations of them; about |t| = {float(reach):.2g} is within reach"
            )
