"""Moore's recurrences (1966) for the Taylor coefficients of a tape, for numbers of any kind.

A tape is a :class:`integrable.series.tape.Tape`.
"""

from __future__ import annotations

from collections.abc import MutableSequence, Sequence

from integrable.series.tape import CONSTANT, DIFFERENCE, MULTIPLE, PRODUCT, QUOTIENT, ROOT, SUM
from jacobian.element import Real
from jacobian.numbers.roots import root
from jacobian.numbers.sums import joined, plus_product

Indices = Sequence[int]
Reals = MutableSequence[Real]


def convolved(series: Reals, p: int, q: int, begin: int, end: int, k: int) -> Real:
    """Σ p_j q_{k−j}, begin ≤ j < end, for the series that begin at p and q; the terms are added to two sums in turn."""
    nothing = 0 * series[p]
    a, b = nothing, nothing
    for j in range(begin, end - 1, 2):
        a = plus_product(a, series[p + j], series[q + k - j])
        b = plus_product(b, series[p + j + 1], series[q + k - j - 1])
    if (end - begin) % 2 == 1:
        a = plus_product(a, series[p + end - 1], series[q + k - end + 1])
    return joined(a, b)


def squared(series: Reals, p: int, begin: int, k: int) -> Real:
    """Σ p_j p_{k−j}, begin ≤ j ≤ k − begin, where the equal terms j and k − j are computed once."""
    half = convolved(series, p, p, begin, (k + 1) // 2, k)
    if k % 2 == 1:
        return half + half
    middle = series[p + k // 2]
    return joined(half, plus_product(half, middle, middle))


def coefficients(
    kinds: Indices, left: Indices, right: Indices, rates: Indices, first: int, order: int, unit: Real, series: Reals
) -> None:
    """Writes the Taylor coefficients of all nodes into ``series``; those of node n begin at ``series[n·(order + 1)]``.

    The orders written are ``first`` to ``order`` − 1, for variables ``first`` + 1 to ``order``. Lower orders must be
    there already, and so must the order 0 of constants. ``unit`` is the unit of time.
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


def values_at(x: Real, order: int, series: Reals, count: int, out: Reals, place: int) -> None:
    """Writes the first ``count`` variables at distance ``x`` from the expansion point to ``out``, from index ``place``
    on.
    """
    for i in range(count):
        start = i * (order + 1)
        total = series[start + order]
        for k in range(order - 1, -1, -1):
            total = total * x + series[start + k]
        out[place + i] = total
