"""Taylor series of any equations in flint's power series: an integrator that shares no code with the package's motions.

Coefficient k + 1 of the solution is coefficient k of the rates of the series so far, divided by k + 1.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import flint

ORDER, BITS, DIGITS = 40, 192, 45
TERM = 1e-38
"""What a step neglects, about."""


class SeriesNumbers:
    """flint's power series as the numbers of a system's formulas."""

    exact = False

    class context:
        """The functions of series by their names in formulas."""

        @staticmethod
        def exp(x):
            return x.exp()

    def __init__(self) -> None:
        self.zero, self.one = flint.arb_series([0]), flint.arb_series([1])

    def coerce(self, x: Any) -> Any:
        return x if isinstance(x, flint.arb_series) else flint.arb_series([flint.arb(float(x))])

    def add(self, x, y):
        return x + y

    def sub(self, x, y):
        return x - y

    def mul(self, x, y):
        return x * y

    def dot(self, xs, ys):
        return sum((x * y for x, y in zip(xs, ys, strict=True)), self.zero)


def by_series(rates: Callable[[Any, Sequence[Any]], list[Any]], y0: Sequence[float], time: float) -> list[str]:
    """The state at a time, right to about 32 digits over a few time scales."""
    before = flint.ctx.prec, flint.ctx.cap
    flint.ctx.prec = BITS
    try:
        y, left = [flint.arb(x) for x in y0], flint.arb(time)
        while left != 0:
            series = [[x] for x in y]
            for k in range(ORDER):
                flint.ctx.cap = k + 1
                found = rates(SeriesNumbers(), [flint.arb_series(c) for c in series])
                for c, rate in zip(series, found, strict=True):
                    c.append((flint.arb_series(rate)[k] / (k + 1)).mid())
            size = max(float(abs(c[0])) for c in series)
            reach = min((TERM * size / last) ** (1 / ORDER) for c in series if (last := float(abs(c[-1]))) > 0)
            step = left if abs(float(left)) <= reach else flint.arb(reach if left > 0 else -reach)
            y = [flint.arb_poly(c)(step).mid() for c in series]
            left = (left - step).mid()
        return [x.str(DIGITS, radius=False) for x in y]
    finally:
        flint.ctx.prec, flint.ctx.cap = before
