"""Sums of pairs with their lifts in any genus, in the form of compiled loops (:mod:`integrable.mumford.pair_tables`).

The curve is y² = f(x) with leading coefficient ±1. f has odd degree 2g + 1, or even degree 2g + 2 with g even and no
lifts. A row is u_0 … u_{g−1}, v_0 … v_{g−1}, then σ, ν for each branch point in ``ends``. The lifts of added rows have
κ = ``kappa``, so that a sum has the κ of its first summand. The formulas are those of
:class:`jacobian.relatives.extended.ExtendedGroup`, except for the projection onto the curve. Its matrix is in floats;
this does not limit the accuracy, because the remaining error is of second order.
"""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple

Real = Any
Row = Any
Rows = Any


class TabledCurve(NamedTuple):
    """The curve of a table: f ascending, the roots of f that carry lifts, and the κ of added rows.

    ``affine`` are the A, B, h of x = A + Bξ, y = hη, which transform results to the original x and y.
    """

    f: Row
    ends: Row
    kappa: float
    affine: Row


class Space(NamedTuple):
    """Working memory: ``matrix`` is g × (g + 1); u, v, other and quotient are rows of 2g + 3 numbers.

    ``turned`` is g × (2g + 1) in floats, ``weights`` a row of 2g + 1 floats.
    """

    matrix: Rows
    u: Row
    v: Row
    other: Row
    quotient: Row
    turned: Rows
    weights: Row


def tabled_pairs(
    problem: TabledCurve, terms: Rows, near: Row, table: Rows, which: Rows, space: Space, out: Rows
) -> None:
    """Writes to each row of ``out`` the sum of a power series at ``near`` and the rows ``which`` of a table."""
    for i in range(near.shape[0]):
        row = out[i]
        place(terms, near[i], row)
        for k in range(which.shape[1]):
            add(problem, row, table[which[i, k]], space)
            retract(problem, row, space)
        placed_back((problem.f.shape[0] - 2) // 2, problem.affine, row)


def place(terms: Rows, time: Real, row: Row) -> None:
    """Writes Σ terms_k·time^k to ``row``, by Horner's rule."""
    last = terms.shape[0] - 1
    for j in range(row.shape[0]):
        total = terms[last, j]
        for k in range(last - 1, -1, -1):
            total = total * time + terms[k, j]
        row[j] = total


def add(problem: TabledCurve, row: Row, other: Row, space: Space) -> None:
    """Replaces ``row`` by the reduced sum of ``row`` and ``other``."""
    f, ends, u, v = problem.f, problem.ends, space.u, space.v
    genus = (f.shape[0] - 2) // 2
    factor = space.quotient
    interpolate(genus, row, other, factor, space.matrix)
    for j in range(ends.shape[0]):
        sigma, nu = row[2 * genus + 2 * j], row[2 * genus + 2 * j + 1]
        far = other[2 * genus + 2 * j]
        row[2 * genus + 2 * j + 1] = (nu + sigma * value_of(factor, genus, ends[j])) / (problem.kappa * far)
        row[2 * genus + 2 * j] = sigma * far
    multiply(genus, row, other, factor, u, v)
    degree = 2 * genus
    while degree > genus:
        degree = reduce(problem, degree, row, space)
    for i in range(genus):
        row[i] = u[i]
        row[genus + i] = v[i]


def interpolate(genus: int, row: Row, other: Row, factor: Row, matrix: Rows) -> None:
    """Writes to ``factor`` the k, deg k < g, with k·u ≡ v' − v modulo u', for the pairs (u, v) and (u', v')."""
    for i in range(genus):
        matrix[i, 0] = row[i] - other[i]
        matrix[i, genus] = other[genus + i] - row[genus + i]
    for j in range(1, genus):
        top = matrix[genus - 1, j - 1]
        matrix[0, j] = -(top * other[0])
        for i in range(1, genus):
            matrix[i, j] = matrix[i - 1, j - 1] - top * other[i]
    for i in range(genus):
        exchange(matrix, genus, i)
        for k in range(i + 1, genus):
            ratio = matrix[k, i] / matrix[i, i]
            for j in range(i + 1, genus + 1):
                matrix[k, j] = matrix[k, j] - ratio * matrix[i, j]
    for i in range(genus - 1, -1, -1):
        total = matrix[i, genus]
        for j in range(i + 1, genus):
            total = total - matrix[i, j] * factor[j]
        factor[i] = total / matrix[i, i]


def exchange(matrix: Rows, genus: int, i: int) -> None:
    """Swaps row i with the row from i on that has the largest entry in column i (partial pivoting)."""
    best = i
    for k in range(i + 1, genus):
        if abs(matrix[k, i]) > abs(matrix[best, i]):
            best = k
    if best != i:
        for j in range(i, genus + 1):
            kept = matrix[i, j]
            matrix[i, j] = matrix[best, j]
            matrix[best, j] = kept


def multiply(genus: int, row: Row, other: Row, factor: Row, u: Row, v: Row) -> None:
    """Writes uu' and v + uk, for monic u, u' of degree g, without the leading coefficient of uu'."""
    for i in range(2 * genus):
        u[i] = 0.0
        v[i] = 0.0
    for i in range(genus):
        u[genus + i] = u[genus + i] + row[i] + other[i]
        v[i] = v[i] + row[genus + i]
        v[genus + i] = v[genus + i] + factor[i]
        for j in range(genus):
            u[i + j] = u[i + j] + row[i] * other[j]
            v[i + j] = v[i + j] + row[i] * factor[j]


def reduce(problem: TabledCurve, degree: int, row: Row, space: Space) -> int:
    """Reduces (u, v), deg u = ``degree``, by one step in place, with the lifts of ``row``; returns the new degree."""
    f, ends, u, v, w = problem.f, problem.ends, space.u, space.v, space.other
    genus = (f.shape[0] - 2) // 2
    low = 2 * degree - 2 < f.shape[0] - 1
    new = (f.shape[0] - 1 if low else 2 * degree - 2) - degree
    put_cofactor(f, u, v, degree, new, w)
    scale, lead = -w[new], v[degree - 1]
    for i in range(new):
        w[i] = w[i] / w[new]
    # divide v by the monic w: v = k·w + remainder
    k = space.quotient
    for i in range(degree - 1 - new, -1, -1):
        k[i] = v[i + new]
        for j in range(new):
            v[i + j] = v[i + j] - k[i] * w[j]
    for i in range(new):
        u[i] = w[i]
        v[i] = -v[i]
    for j in range(ends.shape[0]):
        sigma, nu = row[2 * genus + 2 * j], row[2 * genus + 2 * j + 1]
        slope = value_of(k, degree - new, ends[j])
        if low:
            if degree % 2 == 0:
                sigma, nu = -sigma, -nu
            row[2 * genus + 2 * j], row[2 * genus + 2 * j + 1] = nu, slope * nu - scale * sigma
        else:
            moved = nu / lead
            row[2 * genus + 2 * j], row[2 * genus + 2 * j + 1] = moved, slope * moved - lead * sigma
    return new


def put_cofactor(f: Row, u: Row, v: Row, degree: int, size: int, w: Row) -> None:
    """Writes to w the quotient (f − v²)/u of degree ``size``, for monic u of ``degree`` and v of lower degree."""
    for i in range(size, -1, -1):
        total = coefficient(f, v, degree, i + degree)
        for j in range(i + 1, min(size, i + degree) + 1):
            total = total - w[j] * u[i + degree - j]
        w[i] = total


def coefficient(f: Row, v: Row, count: int, i: int) -> Real:
    """The coefficient of x^i in f − v², where v has ``count`` coefficients."""
    total = f[0] * 0.0
    if i < f.shape[0]:
        total = f[i]
    for j in range(max(0, i - count + 1), min(count - 1, i) + 1):
        total = total - v[j] * v[i - j]
    return total


def value_of(a: Row, count: int, x: Real) -> Real:
    """a(x) for a polynomial a of ``count`` coefficients."""
    total = a[count - 1]
    for i in range(count - 2, -1, -1):
        total = total * x + a[i]
    return total


def retract(problem: TabledCurve, row: Row, space: Space) -> None:
    """Moves a row onto the curve by the shortest (δu, δv) with wδu + 2vδv ≡ f − v² modulo u.

    ``space`` must hold the pair of the row, as :func:`add` leaves it.
    """
    f, u, v, w = problem.f, space.u, space.v, space.other
    genus = (f.shape[0] - 2) // 2
    size = f.shape[0] - 1 - genus
    put_cofactor(f, u, v, genus, size, w)
    turned, weights = space.turned, space.weights
    for i in range(genus):
        total = coefficient(f, v, genus, i)
        for j in range(min(i, size) + 1):
            total = total - w[j] * u[i - j]
        turned[i, 2 * genus] = float(total)
    columns(genus, size, u, v, w, turned, weights)
    shortest(genus, turned, weights)
    for i in range(genus):
        row[genus + i] = row[genus + i] + weights[i]
        row[i] = row[i] + weights[genus + i]


def columns(genus: int, size: int, u: Row, v: Row, w: Row, turned: Rows, column: Row) -> None:
    """Fills the matrix of :func:`retract` in floats: column j is x^j·2v, column g + j is x^j·w, modulo u."""
    for i in range(genus):
        turned[i, 0] = 2.0 * float(v[i])
    for i in range(size + 1):
        column[i] = float(w[i])
    for i in range(size, genus - 1, -1):
        for j in range(genus):
            column[i - genus + j] = column[i - genus + j] - column[i] * float(u[j])
    for i in range(genus):
        turned[i, genus] = column[i]
    for part in range(2):
        first = part * genus
        for j in range(first + 1, first + genus):
            top = turned[genus - 1, j - 1]
            turned[0, j] = -(top * float(u[0]))
            for i in range(1, genus):
                turned[i, j] = turned[i - 1, j - 1] - top * float(u[i])


def shortest(genus: int, turned: Rows, weights: Row) -> None:
    """Writes to ``weights`` the shortest solution of g equations in 2g unknowns, by Gram–Schmidt on the rows.

    The last column of ``turned`` is the right-hand side.
    """
    count = 2 * genus
    for j in range(count):
        weights[j] = 0.0
    for i in range(genus):
        for k in range(i):
            ratio = 0.0
            for j in range(count):
                ratio = ratio + turned[i, j] * turned[k, j]
            for j in range(count + 1):
                turned[i, j] = turned[i, j] - ratio * turned[k, j]
        size = 0.0
        for j in range(count):
            size = size + turned[i, j] * turned[i, j]
        length = sqrt(size)
        for j in range(count + 1):
            turned[i, j] = turned[i, j] / length
        for j in range(count):
            weights[j] = weights[j] + turned[i, count] * turned[i, j]


def placed_back(genus: int, affine: Row, row: Row) -> None:
    """Transforms a row from ξ, η to x = A + Bξ, y = hη; ``affine`` is A, B, h."""
    a, b, height = affine[0], affine[1], affine[2]
    scale = b
    for i in range(genus - 1, -1, -1):
        row[i] = row[i] * scale
        scale = scale * b
    power = scale / b
    scale = height
    for i in range(genus, 2 * genus):
        row[i] = row[i] * scale
        scale = scale / b
    # Taylor's shift; the leading 1 of U is not in the row
    for part in range(2):
        first = part * genus
        for i in range(genus):
            if first == 0:
                row[genus - 1] = row[genus - 1] - a
            for j in range(genus - 2, i - 1, -1):
                row[first + j] = row[first + j] - a * row[first + j + 1]
    for j in range(2 * genus + 1, row.shape[0], 2):
        row[j] = row[j] * height / power
