"""Published discretizations of the Euler top, d = 0: Moser–Veselov and Hirota–Kimura.

* :func:`moser_veselov`: the discrete Euler top of Moser and Veselov (1991); the rotation of a step also turns γ. It
  preserves |M|², (γ, M), |γ| and the energy. Its order is 2, or 4 with the modified moments of Hairer and Vilmart
  (2006).
* :func:`hirota_kimura`: the explicit birational Euler top of Hirota and Kimura (2000), which is Kahan's rule on
  Ṁ = M × ω. It preserves the three ratios of :func:`hirota_kimura_integrals` (Petrera, Pfadler and Suris 2009), but
  not |M|²; γ follows by the same rule on γ̇ = γ × ω. The order is 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from integrable.oracles.body import cross
from integrable.oracles.stepping import Advance
from jacobian.errors import ArgumentError, PrecisionLoss

__all__ = [
    "hirota_kimura",
    "hirota_kimura_factors",
    "hirota_kimura_integrals",
    "hirota_kimura_step",
    "kahan_rotation",
    "modified_moments",
    "moser_veselov",
]

MOST_ITERATIONS = 200
Vector = list[Any]


def moser_veselov(moments: Sequence[Any], order: int = 2) -> Advance:
    """A function that makes one step of the discrete Euler top. Order 4 uses modified moments of inertia.

    A step is found by fixed-point iteration. Raises PrecisionLoss where the iteration does not converge; a smaller step
    helps.
    """
    if order not in (2, 4):
        raise ArgumentError(f"order = {order}: the discrete top is of order 2 or 4")

    def advance(y: Vector, h: Any, shape: Any) -> tuple[Vector, Any, int]:
        x, M = y[:3], y[3:]
        # the modified moments depend on the step and on integrals that the map preserves
        J = shape or (modified_moments(moments, M, h) if order == 4 else list(moments))
        e0, e, passes = _rotation(J, M, h)
        M = [m - 4 / h * e[i - 2] * e[i - 1] * (J[i - 1] - J[i - 2]) for i, m in enumerate(M)]
        turned = cross(e, x)
        again = cross(e, turned)
        x = [a - 2 * e0 * b + 2 * c for a, b, c in zip(x, turned, again, strict=True)]
        return x + M, J, passes

    return advance


def modified_moments(moments: Sequence[Any], M: Sequence[Any], h: Any) -> Vector:
    """The modified moments J, 1/J_i = (1 + h²s)/I_i + h²δ, for which the discrete top is of order 4 (Hairer and Vilmart
    2006). s and δ are functions of the energy and of |M|².
    """
    inverse, total, product = sum(1 / x for x in moments), sum(moments), moments[0] * moments[1] * moments[2]
    energy = sum(m * m / x for m, x in zip(M, moments, strict=True)) / 2
    casimir = sum(m * m for m in M) / 2
    s = -inverse * energy / 3 + total * casimir / (6 * product)
    delta = total * energy / (6 * product) - casimir / (3 * product)
    return [1 / ((1 + h * h * s) / x + h * h * delta) for x in moments]


def hirota_kimura(moments: Sequence[Any]) -> Advance:
    """A function that makes one step of the Hirota–Kimura top, and turns γ by :func:`kahan_rotation`."""

    def advance(y: Vector, h: Any, _memory: Any) -> tuple[Vector, Any, int]:
        x, M = y[:3], y[3:]
        new = hirota_kimura_step(moments, M, h)
        return kahan_rotation(moments, x, M, new, h) + new, None, 1

    return advance


def hirota_kimura_step(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """M after one step: the M̃ with M̃_1 − eα_1(M_3M̃_2 + M_2M̃_3) = M_1 and cyclic, e = step/2, α_1 = a_3 − a_2, a_i =
    1/I_i.

    The linear system is solved by Cramer's rule with + − × ÷ alone, so rational numbers stay rational. Raises
    ZeroDivisionError where the system is singular.
    """
    p, q, r = ([c * m for m in M] for c in _half_steps(moments, step))
    return _solve([[1, -p[2], -p[1]], [-q[2], 1, -q[0]], [-r[1], -r[0], 1]], list(M))


def kahan_rotation(moments: Sequence[Any], x: Sequence[Any], M: Sequence[Any], new: Sequence[Any], step: Any) -> Vector:
    """γ after one step of Kahan's rule (1993) on γ̇ = γ × ω.

    It is the γ̃ with γ̃ − γ = (step/2)(γ × ω̃ + γ̃ × ω), where ω = M/I and ω̃ = M̃/I.
    """
    w, after = ([step * m / (2 * moment) for m, moment in zip(v, moments, strict=True)] for v in (M, new))
    right = [a + b for a, b in zip(x, cross(x, after), strict=True)]
    # the matrix of γ̃ ↦ γ̃ − γ̃ × w
    return _solve([[1, -w[2], w[1]], [w[2], 1, -w[0]], [-w[1], w[0], 1]], right)


def hirota_kimura_integrals(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """The integrals of the Hirota–Kimura map: (q_2/q_3, q_3/q_1, q_1/q_2) with q_1 = 1 − e²α_2α_3M_1², cyclic; e and α
    are defined in :func:`hirota_kimura_step`.
    """
    q = hirota_kimura_factors(moments, M, step)
    return [q[1] / q[2], q[2] / q[0], q[0] / q[1]]


def hirota_kimura_factors(moments: Sequence[Any], M: Sequence[Any], step: Any) -> Vector:
    """q_1, q_2, q_3 of :func:`hirota_kimura_integrals`. They give det ∂M̃/∂M = (q_3(M̃)/q_3(M))²."""
    c = _half_steps(moments, step)
    return [1 - c[i - 2] * c[i - 1] * M[i] * M[i] for i in range(3)]


def _half_steps(moments: Sequence[Any], step: Any) -> Vector:
    """The three products eα_i = (step/2)(a_k − a_j), with i, j, k cyclic."""
    return [step * (1 / moments[i - 1] - 1 / moments[i - 2]) / 2 for i in range(3)]


def _solve(rows: list[Vector], right: Vector) -> Vector:
    """The solution of three linear equations, by Cramer's rule."""
    determinant = _determinant(rows)
    return [
        _determinant([[right[i] if j == k else row[j] for j in range(3)] for i, row in enumerate(rows)]) / determinant
        for k in range(3)
    ]


def _determinant(m: Sequence[Sequence[Any]]) -> Any:
    return sum(m[0][i] * (m[1][i - 2] * m[2][i - 1] - m[1][i - 1] * m[2][i - 2]) for i in range(3))


def _rotation(J: Vector, M: Vector, h: Any) -> tuple[Any, Vector, int]:
    """e0, e and the number of iterations. The quaternion (e0, e): h·M_1 = 2e0·J_1e_1 + 2e_2e_3(J_3 − J_2), cyclic."""
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
