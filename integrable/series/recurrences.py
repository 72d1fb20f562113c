"""The recurrences of the Taylor coefficients of what a :class:`integrable.series.tape.Tape` does (Moore 1966), for
numbers of any kind.
"""

from __future__ import annotations

from typing import Any

from integrable.series.tape import CONSTANT, DIFFERENCE, MULTIPLE, PRODUCT, QUOTIENT, ROOT, SUM
from jacobian.numbers.roots import root
from jacobian.numbers.sums import joined, plus_product


def convolved(series: Any, p: int, q: int, begin: int, end: int, k: int) -> Any:
    """Σ of products p_j q_{k−j}, begin ≤ j < end, of the series that begin at p and q: two sums, neither waits."""
    nothing = 0 * series[p]
    a, b = nothing, nothing
    for j in range(begin, end - 1, 2):
        a = plus_product(a, series[p + j], series[q + k - j])
        b = plus_product(b, series[p + j + 1], series[q + k - j - 1])
    if (end - begin) % 2 == 1:
        a = plus_product(a, series[p + end - 1], series[q + k - end + 1])
    return joined(a, b)


def squared(series: Any, p: int, begin: int, k: int) -> Any:
    """The same with p = q from j = ``begin`` to k − ``begin``, which are equal from both ends."""
    half = convolved(series, p, p, begin, (k + 1) // 2, k)
    if k % 2 == 1:
        return half + half
    middle = series[p + k // 2]
    return joined(half, plus_product(half, middle, middle))


def coefficients(kinds: Any, left: Any, right: Any, rates: Any, first: int, order: int, unit: Any, series: Any) -> None:
    """The Taylor coefficients of all nodes, those of node n from ``series[n·(order + 1)]`` on: from the order ``first``
    to ``order`` − 1, of the variables to ``order``; those before are there already, of the variables that of ``first``
    too, and those of the order 0 of constants. Time is counted in ``unit``.
    """
    width, begin = order + 1, len(rates)
    while begin < len(kinds) and kinds[begin] == CONSTANT:
        begin += 1
    for k in range(first, order):
        for n in range(begin, len(kinds)):
            kind, own, p, q = kinds[n], n * width + k, left[n] * width, right[n] * width
            if kind == SUM:
                series[own] = series[p + k] + series[q + k]
            elif kind == DIFFERENCE:
                series[own] = series[p + k] - series[q + k]
            elif kind == MULTIPLE:
                series[own] = series[p] * series[q + k]
            elif kind == PRODUCT:
                series[own] = squared(series, p, 0, k) if p == q else convolved(series, p, q, 0, k + 1, k)
            elif kind == ROOT and k > 0:
                total = series[p + k] - squared(series, n * width, 1, k) if k > 1 else series[p + k]
                series[own] = total / (2 * series[n * width])
            elif kind == ROOT:
                series[own] = root(series[p])
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
