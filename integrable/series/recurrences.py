"""The recurrences of the Taylor coefficients of what a :class:`integrable.series.tape.Tape` does (Moore 1966), for
numbers of any kind.
"""

from __future__ import annotations

from typing import Any

from integrable.series.tape import DIFFERENCE, MULTIPLE, PRODUCT, QUOTIENT, ROOT, SUM
from jacobian.numbers.roots import root


def convolved(series: Any, p: int, q: int, begin: int, end: int, k: int) -> Any:
    """Σ of products p_j q_{k−j}, begin ≤ j < end, of the series that begin at p and q; in four sums, which do not wait
    for each other.
    """
    nothing = 0 * series[p]
    a, b, c, d = nothing, nothing, nothing, nothing
    for j in range(begin, end - 3, 4):
        a = a + series[p + j] * series[q + k - j]
        b = b + series[p + j + 1] * series[q + k - j - 1]
        c = c + series[p + j + 2] * series[q + k - j - 2]
        d = d + series[p + j + 3] * series[q + k - j - 3]
    for j in range(end - (end - begin) % 4, end):
        a = a + series[p + j] * series[q + k - j]
    return (a + b) + (c + d)


def coefficients(kinds: Any, left: Any, right: Any, rates: Any, first: int, order: int, unit: Any, series: Any) -> None:
    """The Taylor coefficients of all nodes, those of node n from ``series[n·(order + 1)]`` on: from the order ``first``
    to ``order`` − 1, of the variables to ``order``; those before are there already, of the variables that of ``first``
    too, and those of the order 0 of constants. Time is counted in ``unit``.
    """
    width = order + 1
    for k in range(first, order):
        for n in range(len(rates), len(kinds)):
            kind, own, p, q = kinds[n], n * width + k, left[n] * width, right[n] * width
            if kind == SUM:
                series[own] = series[p + k] + series[q + k]
            elif kind == DIFFERENCE:
                series[own] = series[p + k] - series[q + k]
            elif kind == MULTIPLE:
                series[own] = series[p] * series[q + k]
            elif kind == PRODUCT:
                series[own] = convolved(series, p, q, 0, k + 1, k)
            elif kind == ROOT:
                total = series[p + k]
                for j in range(1, k):
                    total = total - series[n * width + j] * series[own - j]
                series[own] = total / (2 * series[n * width]) if k > 0 else root(total)
            elif kind == QUOTIENT:
                total = series[p + k] - convolved(series, n * width, q, 0, k, k) if k > 0 else series[p]
                series[own] = total / series[q]
        for i in range(len(rates)):
            series[i * width + k + 1] = unit * series[rates[i] * width + k] / (k + 1)


def values_at(x: Any, order: int, series: Any, count: int, out: Any, place: int) -> None:
    """The first ``count`` variables at a distance ``x`` from the middle of their series, from ``out[place]`` on."""
    for i in range(count):
        start = i * (order + 1)
        total = series[start + order]
        for k in range(order - 1, -1, -1):
            total = total * x + series[start + k]
        out[place + i] = total
