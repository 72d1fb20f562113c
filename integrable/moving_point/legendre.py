"""Gauss–Legendre quadrature and Legendre series on [−1, 1], to any precision."""

from __future__ import annotations

from functools import lru_cache
from math import cos, pi
from typing import Any

from jacobian.numbers.long_reals import BareReals

Rule = tuple[list[Any], list[list[Any]], list[Any]]


@lru_cache(maxsize=32)
def legendre_rule(K: Any, count: int) -> Rule:
    """(nodes, matrix from values at the nodes to a Legendre series, weights of ∫_0^1) on [−1, 1], of K = MP(digits).

    The matrix is n × n, the nodes ascend.
    """
    reals = BareReals(K.context.prec + 16)
    with reals:
        nodes, rows = legendre_transform(reals, count)
        ends = _half_integrals(reals, count)
        right = [sum(end * row[i] for end, row in zip(ends, rows, strict=True)) for i in range(count)]
    return (
        list(reals.elements(K, nodes)),
        [list(reals.elements(K, row)) for row in rows],
        list(reals.elements(K, right)),
    )


def legendre_transform(reals: BareReals, count: int) -> tuple[list[Any], list[list[Any]]]:
    """(nodes, matrix from values at the nodes to a Legendre series), in bare reals."""
    x, w = gauss_legendre(reals, count)
    with reals:
        half = count // 2 + count % 2
        one = reals.number(1)
        columns = [
            [c * weight / 2 for c in legendre_polynomials(one, node, count)]
            for node, weight in zip(x[:half], w, strict=False)
        ]
        rows = []
        for k in range(count):
            row = [(2 * k + 1) * column[k] for column in columns]
            # P_k(−x) = (−1)^k·P_k(x)
            rows.append(row + [-c if k % 2 else c for c in row[: count // 2][::-1]])
    return x, rows


def gauss_legendre(reals: BareReals, count: int) -> tuple[list[Any], list[Any]]:
    """Nodes (ascending) and weights of Gauss–Legendre quadrature on [−1, 1], in bare reals.

    By python-flint where the numbers are its own (balls would not survive the recurrence at few digits), else by Newton
    from the cosine estimate, each pass in twice the digits of the last.
    """
    if reals.kind == "python-flint":
        return _flint_rule(reals, count)
    nodes, weights = [], []
    for i in range((count + 1) // 2):
        if 2 * i + 1 == count:
            x = reals.number(0)
        else:
            x = reals.number(_float_node(i, count))
            for bits in doubling_precisions(reals.bits, 44):
                with reals.at(bits + 16):
                    x = reals.plain(x - _value_and_slope(x, count)[2])
        with reals:
            # the slope at a node: Newton's change would need the value, which is rounding there
            slope = _value_and_slope(x, count)[1]
            nodes.append(x)
            weights.append(2 / ((1 - x * x) * slope * slope))
    mirrored = nodes[: count // 2][::-1]
    with reals:
        return nodes + [-x for x in mirrored], weights + weights[: count // 2][::-1]


def _flint_rule(reals: BareReals, count: int) -> tuple[list[Any], list[Any]]:
    from flint import arb

    with reals:
        pairs = [arb.legendre_p_root(count, k, weight=True) for k in reversed(range(count))]
        return [reals.plain(x) for x, _ in pairs], [reals.plain(w) for _, w in pairs]


def _float_node(i: int, count: int) -> float:
    x = -cos(pi * (i + 0.75) / (count + 0.5))
    for _ in range(8):
        change = _value_and_slope(x, count)[2]
        x -= change
        if abs(change) < 1e-15:
            break
    return float(x)


def _value_and_slope(x: Any, count: int) -> tuple[Any, Any, Any]:
    """P_n(x), P_n'(x) and their quotient."""
    before, value = 1, x
    for k in range(1, count):
        before, value = value, ((2 * k + 1) * x * value - k * before) / (k + 1)
    slope = count * (x * value - before) / (x * x - 1)
    return value, slope, value / slope


def doubling_precisions(bits: int, known: int) -> list[int]:
    """The precisions of Newton's passes from ``known`` right bits to ``bits``, ascending."""
    schedule = []
    while bits > known:
        schedule.append(bits)
        bits = bits // 2 + 8
    return schedule[::-1]


def legendre_polynomials(one: Any, x: Any, count: int) -> list[Any]:
    """P_0(x), …, P_{count−1}(x)."""
    values = [one, x]
    for k in range(1, count - 1):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return values[:count]


def _half_integrals(reals: BareReals, count: int) -> list[Any]:
    """∫_0^1 P_k for k < count."""
    one = reals.number(1)
    values = legendre_polynomials(one, 0 * one, count + 1)
    return [one, *((values[k - 1] - values[k + 1]) / (2 * k + 1) for k in range(1, count))]
