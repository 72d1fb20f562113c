"""Published discretizations and integrators to stand beside the divisor flow: fixed step, (γ, M) after every step.

* :func:`implicit_midpoint` and :func:`gauss_legendre6`: Gauss collocation of order 2 and 6 on the six equations of
  motion; they keep C1, C2, H2 (quadratic), at d = 0 also H1.
* :func:`moser_veselov`: the discrete Euler top of Moser and Veselov (1991) with the attitude that turns γ; it keeps
  |M|², (γ, M), |γ| and the energy, second order, or fourth with the modified moments of Hairer and Vilmart (2006).
* :func:`hirota_kimura`: the explicit birational Euler top of Hirota and Kimura (2000); it moves M alone and keeps the
  three ratios of :func:`hirota_kimura_integrals` (Petrera, Pfadler and Suris 2009), but not |M|².

``number`` makes the numbers of a run: ``float``, or the ``mpf`` of an mpmath context. Nothing of :mod:`jacobian`'s
arithmetic is used.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.reference import Body, Solution, Start
from jacobian.errors import ArgumentError, PrecisionLoss

__all__ = [
    "gauss_legendre6",
    "hirota_kimura",
    "hirota_kimura_integrals",
    "hirota_kimura_step",
    "implicit_midpoint",
    "modified_moments",
    "moser_veselov",
]

MOST_ITERATIONS = 200
Vector = list[Any]


def implicit_midpoint(
    body: Body, start: Start, *, step: Any, count: int, number: Callable[..., Any] = float
) -> Solution:
    """``count`` steps of the implicit midpoint rule: γ and M of shape (count + 1, 3), the start first."""
    half = number(1) / 2
    return _collocation(body, start, step, count, number, [[half]], [number(1)])


def gauss_legendre6(body: Body, start: Start, *, step: Any, count: int, number: Callable[..., Any] = float) -> Solution:
    """``count`` steps of the three-stage Gauss method of order 6 (Kuntzmann, Butcher): shapes (count + 1, 3)."""
    r, n = number(15) ** (number(1) / 2), number
    matrix = [
        [n(5) / 36, n(2) / 9 - r / 15, n(5) / 36 - r / 30],
        [n(5) / 36 + r / 24, n(2) / 9, n(5) / 36 - r / 24],
        [n(5) / 36 + r / 30, n(2) / 9 + r / 15, n(5) / 36],
    ]
    return _collocation(body, start, step, count, number, matrix, [n(5) / 18, n(4) / 9, n(5) / 18])


def moser_veselov(
    body: Body, start: Start, *, step: Any, count: int, number: Callable[..., Any] = float, order: int = 2
) -> Solution:
    """``count`` steps of the discrete Euler top (d = 0): shapes (count + 1, 3).

    Order 4 takes the modified moments instead of the body's. The step is found by a fixed-point iteration;
    PrecisionLoss where it does not converge: take a smaller step.
    """
    if body.d or order not in (2, 4):
        raise ArgumentError(f"d = {body.d}, order = {order}: the discrete top is for d = 0, of order 2 or 4")
    h = number(step)
    x, M = [number(v) for v in start.gamma], [number(v) for v in start.M]
    moments = [number(v) for v in body.inertia]
    J = modified_moments(moments, M, h) if order == 4 else moments
    rows, work = [(x, M)], 0
    for _ in range(count):
        e0, e, passes = _rotation(J, M, h)
        M = [m - 4 / h * e[i - 2] * e[i - 1] * (J[i - 1] - J[i - 2]) for i, m in enumerate(M)]
        turned = _cross(e, x)
        again = _cross(e, turned)
        x = [a - 2 * e0 * b + 2 * c for a, b, c in zip(x, turned, again, strict=True)]
        rows.append((x, M))
        work += passes
    return _solution(rows, work)


def modified_moments(moments: Sequence[Any], M: Sequence[Any], h: Any) -> Vector:
    """J with 1/J_i = (1 + h²s)/I_i + h²δ, for which the discrete top is of order 4 (Hairer and Vilmart 2006)."""
    inverse, total, product = sum(1 / x for x in moments), sum(moments), moments[0] * moments[1] * moments[2]
    energy = sum(m * m / x for m, x in zip(M, moments, strict=True)) / 2
    casimir = sum(m * m for m in M) / 2
    s = -inverse * energy / 3 + total * casimir / (6 * product)
    delta = total * energy / (6 * product) - casimir / (3 * product)
    return [1 / ((1 + h * h * s) / x + h * h * delta) for x in moments]


def hirota_kimura(moments: Sequence[Any], M: Sequence[Any], *, step: Any, count: int) -> list[Vector]:
    """M after 0, 1, …, ``count`` steps, in the numbers that are given; γ does not take part."""
    rows = [list(M)]
    for _ in range(count):
        rows.append(hirota_kimura_step(moments, rows[-1], step))
    return rows


def hirota_kimura_step(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """The M̃ with M̃_1 − eα_1(M_3M̃_2 + M_2M̃_3) = M_1 and cyclic, e = step/2, α_1 = a_3 − a_2, by Cramer's rule.

    Only + − × ÷: rational numbers stay rational. ZeroDivisionError where the linear system is singular.
    """
    p, q, r = ([c * m for m in M] for c in _half_steps(moments, step))
    # rows (1, −p3, −p2), (−q3, 1, −q1), (−r2, −r1, 1)
    rows = [[1, -p[2], -p[1]], [-q[2], 1, -q[0]], [-r[1], -r[0], 1]]
    determinant = _determinant(rows)
    return [
        _determinant([[M[i] if j == k else row[j] for j in range(3)] for i, row in enumerate(rows)]) / determinant
        for k in range(3)
    ]


def hirota_kimura_integrals(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """(q_2/q_3, q_3/q_1, q_1/q_2) with q_1 = 1 − e²α_2α_3M_1², cyclic: the integrals of the map."""
    q = hirota_kimura_factors(moments, M, step)
    return [q[1] / q[2], q[2] / q[0], q[0] / q[1]]


def hirota_kimura_factors(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """q_1, q_2, q_3; det ∂M̃/∂M = (q_3(M̃)/q_3(M))²."""
    c = _half_steps(moments, step)
    return [1 - c[i - 2] * c[i - 1] * M[i] * M[i] for i in range(3)]


def _half_steps(moments: Sequence[Any], step: Any) -> Vector:
    """eα_i = (step/2)(a_k − a_j)."""
    return [step * (1 / moments[i - 1] - 1 / moments[i - 2]) / 2 for i in range(3)]


def _determinant(m: Sequence[Sequence[Any]]) -> Any:
    return sum(m[0][i] * (m[1][i - 2] * m[2][i - 1] - m[1][i - 1] * m[2][i - 2]) for i in range(3))


def _rotation(J: Vector, M: Vector, h: Any) -> tuple[Any, Vector, int]:
    """The quaternion (e0, e) of a step: h·M_1 = 2e0·J_1e_1 + 2e_2e_3(J_3 − J_2), cyclic."""
    e = [h * m / (2 * x) for m, x in zip(M, J, strict=True)]
    change = None
    for iteration in range(MOST_ITERATIONS):
        square = 1 - sum(x * x for x in e)
        if not square > 0:
            break
        e0 = square ** (square**0 / 2)
        new = [(h * M[i] / 2 - e[i - 2] * e[i - 1] * (J[i - 1] - J[i - 2])) / (e0 * J[i]) for i in range(3)]
        last, change = change, max(abs(a - b) for a, b in zip(new, e, strict=True))
        e = new
        if change == 0 or (last is not None and change >= last and change < 1e-8 * max(map(abs, e))):
            return (1 - sum(x * x for x in e)) ** (square**0 / 2), e, iteration + 1
    raise PrecisionLoss(f"step = {h}: the discrete top has found no rotation; take a smaller step")


def _collocation(
    body: Body, start: Start, step: Any, count: int, number: Any, matrix: list[Vector], weights: Vector
) -> Solution:
    rates = _rates([number(x) for x in body.inertia], number(body.d))
    h = number(step)
    y = [number(v) for v in (*start.gamma, *start.M)]
    slopes = [rates(y)] * len(weights)
    rows, work = [(y[:3], y[3:])], 1
    for _ in range(count):
        slopes, passes = _stages(rates, y, slopes, matrix, h)
        y = [v + h * sum(b * k[i] for b, k in zip(weights, slopes, strict=True)) for i, v in enumerate(y)]
        rows.append((y[:3], y[3:]))
        work += passes * len(weights)
    return _solution(rows, work)


def _stages(rates: Any, y: Vector, slopes: Any, matrix: list[Vector], h: Any) -> tuple[list[Vector], int]:
    """The slopes k_i = F(y + hΣa_ij k_j), by fixed-point iteration until it no longer improves."""
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
        if change == 0 or (last is not None and change >= last and change < 1e-8 * max(map(abs, slopes[0]))):
            return slopes, iteration + 1
    raise PrecisionLoss(f"step = {h}: the stages of the implicit step have not converged; take a smaller step")


def _rates(moments: Vector, d: Any) -> Callable[[Vector], Vector]:
    """(γ × ω, M × ω) with g⁻² = Σ I_k a_k γ_k² + 1 − |γ|², which holds off the sphere too."""
    a = [1 / (x + d) for x in moments]

    def rates(y: Vector) -> Vector:
        x, M = y[:3], y[3:]
        k = [c * m for c, m in zip(a, M, strict=True)]
        below = 1 - d * sum(c * v * v for c, v in zip(a, x, strict=True))
        spin = d * sum(u * v for u, v in zip(x, k, strict=True)) / below
        w = [u + spin * c * v for u, c, v in zip(k, a, x, strict=True)]
        return _cross(x, w) + _cross(M, w)

    return rates


def _cross(x: Vector, y: Vector) -> Vector:
    return [x[i - 2] * y[i - 1] - x[i - 1] * y[i - 2] for i in range(3)]


def _solution(rows: list[tuple[Vector, Vector]], work: int) -> Solution:
    kind = np.float64 if isinstance(rows[0][0][0], float) else object
    gamma, M = (np.array([list(row[k]) for row in rows], dtype=kind) for k in (0, 1))
    return Solution(gamma, M, work)
