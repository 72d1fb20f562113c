"""Gauss collocation (Kuntzmann 1961, Butcher 1964) of any order on any system, in floats or mpf.

The methods preserve every quadratic integral: for the ball and the top C1, C2, H2, and at d = 0 also H1. Nothing is
compiled here; :mod:`integrable.oracles.gauss16` is the eight-stage method in compiled floats.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from integrable.oracles.stepping import Advance
from jacobian.errors import PrecisionLoss

__all__ = ["GaussRule", "collocation", "gauss_rule"]

MOST_ITERATIONS = 200
Vector = list[Any]


class GaussRule(NamedTuple):
    """Gauss's rule with s stages on [0, 1]: nodes c, weights b and matrix a, all mpf."""

    nodes: Vector
    weights: Vector
    matrix: list[Vector]


@cache
def gauss_rule(stages: int, digits: int) -> GaussRule:
    """Gauss's rule of order 2·``stages``, to ``digits`` digits.

    The nodes are zeros of a Legendre polynomial; weights and matrix are integrals of Lagrange polynomials.
    """
    import mpmath

    context = mpmath.MPContext()
    context.dps = digits + 10 + stages
    polynomial, near = partial(context.legendre, stages), np.polynomial.legendre.leggauss(stages)[0].tolist()
    nodes = [(1 + context.findroot(polynomial, context.mpf(x))) / 2 for x in near]
    # Lagrange polynomials are integrated as sums of monomials
    vandermonde = context.matrix([[x**k for x in nodes] for k in range(stages)])
    inverse = vandermonde**-1  # row j: coefficients of the j-th Lagrange polynomial

    def integral(j: int, end: Any) -> Any:
        return sum(inverse[j, k] * end ** (k + 1) / (k + 1) for k in range(stages))

    weights = [integral(j, context.one) for j in range(stages)]
    return GaussRule(nodes, weights, [[integral(j, c) for j in range(stages)] for c in nodes])


def collocation(rates: Callable[[Vector], Vector], number: Callable[[Any], Any], digits: int, stages: int) -> Advance:
    """A function that makes one step of Gauss's method on ẏ = ``rates``(y).

    The equations of the stages are solved by fixed-point iteration, which ends when it no longer improves. ``number``
    converts a value to ``digits`` digits.
    """
    rule = gauss_rule(stages, max(30, digits))
    matrix, weights = [list(map(number, row)) for row in rule.matrix], list(map(number, rule.weights))

    def advance(y: Vector, h: Any, slopes: Any) -> tuple[Vector, Any, int]:
        slopes, passes = _stages(rates, y, slopes or [rates(y)] * stages, matrix, h)
        y = [v + h * sum(b * k[i] for b, k in zip(weights, slopes, strict=True)) for i, v in enumerate(y)]
        return y, slopes, passes * stages

    return advance


def _stages(
    rates: Callable[[Vector], Vector], y: Vector, slopes: Any, matrix: list[Vector], h: Any
) -> tuple[list[Vector], int]:
    """The slopes k_i = ``rates``(y + hΣa_ij k_j), and the number of iterations that were needed."""
    change = None
    for iteration in range(MOST_ITERATIONS):
        points = [
            [v + h * sum(a * k[i] for a, k in zip(row, slopes, strict=True)) for i, v in enumerate(y)] for row in matrix
        ]
        new = [rates(point) for point in points]
        last, change = (
            change,
            max(abs(a - b) for p, q in zip(new, slopes, strict=True) for a, b in zip(p, q, strict=True)),
        )
        slopes = new
        size = max(abs(x) for k in slopes for x in k)
        if change == 0 or (last is not None and change >= last and change < 1e-8 * size):
            return slopes, iteration + 1
        if not change < 1e100:
            break
    raise PrecisionLoss(f"step = {h}: the stages of the implicit step have not converged; take a smaller step")
