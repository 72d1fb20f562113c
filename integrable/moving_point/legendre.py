"""Gauss–Legendre quadrature and Legendre series on [−1, 1], to any precision."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from math import ceil, inf
from operator import mul

import numpy as np

from integrable.moving_point.addition import integrate_series
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals, BareReals

# a function that needs more nodes per digit than this is taken as not smooth on the interval
MOST_NODES = 20
# Newton's method in floats ends with a step below NEAR. If its last step is below ROUGH, NEAR_BITS bits of the result
# are right, otherwise ROUGH_BITS
NEAR, ROUGH, NEAR_BITS, ROUGH_BITS = 1e-14, 1e-10, 40, 16


@lru_cache(maxsize=32)
def legendre_rule(K: MultiprecisionField, count: int) -> tuple[list[Real], list[list[Real]]]:
    """(nodes, matrix) in K = MP(digits); the matrix maps values at the nodes to coefficients of a Legendre series."""
    reals = BareReals(K.context.prec + 16)
    series = LegendreSeries(reals, count)
    with reals:
        rows = []
        for k, half in enumerate(series._rows):
            row = [(2 * k + 1) * w * c / 2 for w, c in zip(series.weights, half, strict=False)]
            rows.append(row + [-c if k % 2 else c for c in row[: count // 2][::-1]])
    return list(reals.elements(K, series.nodes)), [list(reals.elements(K, row)) for row in rows]


def integral(
    K: MultiprecisionField, function: Callable[[np.ndarray], np.ndarray], first: Real, last: Real, loss: float
) -> np.ndarray:
    """The integral from ``first`` to ``last`` of a ``function`` that maps an array of N times to one of shape (N, m).
    The number of nodes is raised until the last Legendre coefficients are below ``loss`` times the rounding of K.
    PrecisionLoss if too many nodes are needed.
    """
    half, middle, count = (last - first) / 2, (last + first) / 2, K.dps + 16
    while True:
        nodes, rows = legendre_rule(K, count)
        series = np.array(rows, dtype=object) @ function(np.array([middle + half * x for x in nodes]))
        if np.abs(series[-2:]).max() * abs(half) <= K.eps * loss * max(1, np.abs(series).max() * abs(half)):
            return 2 * half * series[0]
        count = 3 * count // 2
        if count > MOST_NODES * K.dps:
            raise PrecisionLoss(f"between τ = {first} and {last}: {count} nodes do not resolve the velocity")


class LegendreSeries:
    """Legendre series on [−1, 1] from values at ``nodes``, the nodes of a Gauss–Legendre rule, in bare reals."""

    def __init__(self, reals: BareReals, count: int) -> None:
        self.nodes, self.weights = gauss_legendre(reals, count)
        with reals:
            half, one = count // 2 + count % 2, reals.number(1)
            columns = [legendre_polynomials(one, node, count) for node in self.nodes[:half]]
            # ``_rows[k]`` has the values of P_k at the lower half of the nodes
            self._rows = list(zip(*columns, strict=True))

    def coefficients(self, values: list[Real]) -> list[Real]:
        """The coefficients of the series that has these values at the nodes."""
        count, weighted = len(values), list(map(mul, self.weights, values))
        # the lower half suffices, since P_k(−x) = (−1)^k·P_k(x)
        low, high = weighted[: len(self._rows[0])], weighted[::-1][: count // 2]
        pairs = [[x + y for x, y in zip(low, high, strict=False)], [x - y for x, y in zip(low, high, strict=False)]]
        if count % 2:
            for row in pairs:
                row.append(low[-1])
        return [sum(map(mul, row, pairs[k % 2])) * (2 * k + 1) / 2 for k, row in enumerate(self._rows)]


def gauss_legendre(reals: BareReals, count: int) -> tuple[list[Real], list[Real]]:
    """Nodes (ascending) and weights of Gauss–Legendre quadrature on [−1, 1], in bare reals, by python-flint (Johansson
    and Mezzarobba 2018).
    """
    from flint import arb

    balls = BallReals(reals.bits)
    with balls:
        # the pairs go from the largest node to the middle; the other nodes are their opposites
        pairs = [arb.legendre_p_root(count, k, weight=True) for k in range(count - count // 2)]
        nodes, weights = (balls.rounded(column, reals) for column in zip(*pairs, strict=True))
    with reals:
        return [-x for x in nodes[: count // 2]] + nodes[::-1], weights[: count // 2] + weights[::-1]


def place_on(series: list[Real], target: Real, reals: BareReals, digits: float) -> Real:
    """The x in [−1, 1] at which the integral from 0 of a positive Legendre series equals ``target``, in bare reals."""
    floats, goal = [float(c) for c in series[:40]], float(target)
    x, last = goal / floats[0], inf
    while last > NEAR:
        x = max(-1.0, min(1.0, x))
        angle, rate = integrate_series(floats, x)
        step = (angle - goal) / rate
        # steps that no longer decrease are rounding errors of floats
        if not abs(step) < last:
            break
        x, last = x - step, abs(step)
    place = reals.number(max(-1.0, min(1.0, x)))
    # a series of more than 40 coefficients is truncated in ``floats``, and gives fewer correct bits
    known = NEAR_BITS if len(series) <= len(floats) and last < ROUGH else ROUGH_BITS
    wanted = min(reals.bits, ceil(3.33 * digits) + NEAR_BITS)
    for _ in range(len(doubling_precisions(wanted, known))):
        angle, rate = integrate_series(series, place)
        place -= (angle - target) / rate
    return place


def doubling_precisions(bits: int, known: int) -> list[int]:
    """The precisions, ascending, of the Newton steps that lead from ``known`` correct bits to ``bits``."""
    schedule = []
    while bits > known:
        schedule.append(bits)
        bits = bits // 2 + 8
    return schedule[::-1]


def legendre_polynomials(one: Real, x: Real, count: int) -> list[Real]:
    """P_0(x), …, P_{count−1}(x)."""
    values = [one, x]
    for k in range(1, count - 1):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return values[:count]
