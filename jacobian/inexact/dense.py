"""Polynomials of fixed length, never trimmed, and orthogonal linear algebra on a few rows.

Inexact composition uses both on any numbers with ``+ − · /``, ``abs``, ``** 0.5`` and ``conjugate``. Polynomials are
lists of coefficients, ascending.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import add, mul
from typing import Any

from jacobian.errors import PrecisionLoss
from jacobian.numbers.roots import root

Number = Any
Coefficients = list[Number]


def added(a: Sequence[Number], b: Sequence[Number]) -> Coefficients:
    """The sum a + b of two polynomials."""
    short, long = (a, b) if len(a) < len(b) else (b, a)
    return [*map(add, short, long), *long[len(short) :]]


def product(a: Sequence[Number], b: Sequence[Number]) -> Coefficients:
    """The product a·b of two polynomials."""
    if not a or not b:
        return []
    result = [0 * a[0]] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b, i):
            result[j] += x * y
    return result


def divided(a: Sequence[Number], monic: Sequence[Number]) -> tuple[Coefficients, Coefficients]:
    """(quotient, remainder) of the division of ``a`` by a monic polynomial."""
    rest, m = list(a), len(monic) - 1
    lower = monic[:m]
    for i in range(len(rest) - m - 1, -1, -1):
        lead = rest[i + m]
        for j, c in enumerate(lower, i):
            rest[j] -= lead * c
    return rest[m:], rest[:m]


def remainder(a: Sequence[Number], monic: Sequence[Number]) -> Coefficients:
    """The remainder of ``a`` modulo a monic polynomial u, a list of exactly deg u coefficients."""
    rest, lower = list(a), monic[:-1]
    m = len(lower)
    for i in range(len(rest) - m - 1, -1, -1):
        lead = rest.pop()
        for j, c in enumerate(lower, i):
            rest[j] -= lead * c
    return rest if len(rest) == m else rest + [0 * monic[0]] * (m - len(rest))


def residue(f: Sequence[Number], u: Sequence[Number], v: Sequence[Number]) -> tuple[Coefficients, Coefficients]:
    """(quotient, remainder) of the division of f − v² by u."""
    return divided(added(f, [-c for c in product(v, v)]), u)


def value_at(a: Sequence[Number], x: Number) -> Number:
    """a(x)."""
    total = 0 * x
    for c in reversed(a):
        total = total * x + c
    return total


def size(a: Sequence[Number]) -> Number:
    """The absolute value of the largest coefficient."""
    return max(map(abs, a), default=0)


def absolute(a: Sequence[Number]) -> Coefficients:
    """The absolute values of the coefficients."""
    return list(map(abs, a))


def bound(monic: Sequence[Number]) -> Coefficients:
    """The polynomial b = x^m − Σ |u_i|x^i for a monic u of degree m.

    For a polynomial a, the coefficients of Σ |a_i|x^i mod b are bounds for those of a mod u: division by b adds only
    terms ≥ 0.
    """
    return [-abs(c) for c in monic[:-1]] + [abs(monic[-1])]


def multiplication(factor: Sequence[Number], monic: Sequence[Number]) -> list[Coefficients]:
    """The matrix, as rows, of the multiplication c ↦ factor·c modulo a monic polynomial, on coefficients."""
    column = remainder(factor, monic)
    columns = []
    for _ in column:
        columns.append(column)
        column = remainder([0 * monic[0], *column], monic)
    return [list(row) for row in zip(*columns, strict=True)]


def norm(values: Any) -> Number:
    """The Euclidean norm of a vector."""
    return root(sum([abs(x) ** 2 for x in values]))


def index_of_largest(sizes: Sequence[Number]) -> int:
    """The index of the largest size; of equal ones, the first."""
    return max(range(len(sizes)), key=sizes.__getitem__)


def pivoted_qr(
    columns: list[Coefficients], largest: Callable[[Sequence[Number]], int]
) -> tuple[list[int], list[Coefficients]]:
    """The order of the columns, and R by columns, of a QR factorisation with pivoting.

    Each step takes the largest remaining column, chosen by ``largest``.
    """
    columns = [list(column) for column in columns]
    order = list(range(len(columns)))
    for k in range(min(len(columns), len(columns[0]))):
        best = k + largest([sum([abs(x) ** 2 for x in column[k:]]) for column in columns[k:]])
        columns[k], columns[best] = columns[best], columns[k]
        order[k], order[best] = order[best], order[k]
        _reflect(columns, k)
    return order, columns


def null_vector(order: list[int], triangle: list[Coefficients]) -> Coefficients:
    """The null vector, in the original column order, of R = ``triangle``, whose last column depends on the others."""
    n = len(order)
    solution = _back_substitute(triangle[:-1], [-x for x in triangle[-1][: n - 1]])
    result = [*solution, 1 + 0 * triangle[-1][0]]
    return [result[order.index(j)] for j in range(n)]


def least_squares(rows: list[Coefficients], right: Coefficients) -> Coefficients:
    """The solution of an overdetermined system with the least sum of squares."""
    columns = [list(column) for column in zip(*rows, strict=True)] + [list(right)]
    for k in range(len(columns) - 1):
        _reflect(columns, k)
    return _back_substitute(columns[:-1], columns[-1])


def _reflect(columns: list[Coefficients], k: int) -> None:
    """Applies to columns k, k+1, … the Householder reflection that clears column k below its diagonal.

    Then row k is multiplied by the phase that makes the diagonal positive, so that R is a continuous function of the
    columns.
    """
    head = columns[k][k:]
    length = norm(head)
    if not length:
        return
    turn = phase(head[0])
    head[0] += length * turn
    factor = 2 / sum([abs(x) ** 2 for x in head])
    back = -turn.conjugate()
    conjugates = [x.conjugate() for x in head]
    for column in columns[k:]:
        overlap = factor * sum(map(mul, conjugates, column[k:]))
        for i, x in enumerate(head, k):
            column[i] -= overlap * x
        column[k] *= back


def phase(x: Number) -> Number:
    """x/|x|, or 1 for 0."""
    if isinstance(x, float):
        return -1.0 if x < 0 else 1.0
    return 1 + x if x == 0 else x / abs(x)


def _back_substitute(triangle: list[Coefficients], right: Coefficients) -> Coefficients:
    n = len(triangle)
    solution = list(right[:n])
    for k in range(n - 1, -1, -1):
        if abs(triangle[k][k]) == 0:
            raise PrecisionLoss("the divisors are too close to a special position for this precision; use more digits")
        solution[k] = (solution[k] - sum(triangle[j][k] * solution[j] for j in range(k + 1, n))) / triangle[k][k]
    return solution
