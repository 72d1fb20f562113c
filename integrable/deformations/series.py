"""The recurrences of the Taylor coefficients of what a :class:`integrable.deformations.tape.Tape` does (Moore 1966),
for numbers of any kind; compiled for double-double numbers in :mod:`integrable.deformations.series_compiled`.
"""

from __future__ import annotations

from typing import Any

from integrable.deformations.tape import DIFFERENCE, MULTIPLE, PRODUCT, QUOTIENT, ROOT, SUM
from jacobian.numbers.roots import root

__all__ = ["coefficients", "values_at"]


def coefficients(kinds: Any, left: Any, right: Any, rates: Any, order: int, series: Any) -> None:
    """The Taylor coefficients of all nodes, those of node n from ``series[n·(order + 1)]`` on: of the order 0 to
    ``order`` − 1, of the variables to ``order``; those of the order 0 of variables and constants are there already.
    """
    width = order + 1
    for k in range(order):
        for n in range(len(rates), len(kinds)):
            kind, own, p, q = kinds[n], n * width + k, left[n] * width, right[n] * width
            if kind == SUM:
                series[own] = series[p + k] + series[q + k]
            elif kind == DIFFERENCE:
                series[own] = series[p + k] - series[q + k]
            elif kind == MULTIPLE:
                series[own] = series[p] * series[q + k]
            elif kind == PRODUCT:
                total = series[p] * series[q + k]
                for j in range(1, k + 1):
                    total = total + series[p + j] * series[q + k - j]
                series[own] = total
            elif kind == ROOT:
                total = series[p + k]
                for j in range(1, k):
                    total = total - series[n * width + j] * series[own - j]
                series[own] = total / (2 * series[n * width]) if k > 0 else root(total)
            elif kind == QUOTIENT:
                total = series[p + k]
                for j in range(k):
                    total = total - series[n * width + j] * series[q + k - j]
                series[own] = total / series[q]
        for i in range(len(rates)):
            series[i * width + k + 1] = series[rates[i] * width + k] / (k + 1)


def values_at(x: Any, order: int, series: Any, out: Any) -> None:
    """The variables at a distance ``x[0]`` from the middle of their series, as many as ``out`` has room for."""
    for i in range(len(out)):
        start = i * (order + 1)
        total = series[start + order]
        for k in range(order - 1, -1, -1):
            total = total * x[0] + series[start + k]
        out[i] = total
