"""The Poisson–Nijenhuis structure of the separated variables: a second bracket and a recursion operator.

On (u1, u2, p1, p2) let Π be the canonical bracket {u_i, p_j} = δ_ij, and λ_k = φ(u_k)p_k² = H1 − u_kH2 with φ of
:mod:`integrable.phase.separation`. The second bracket Π' is {u_i, p_j}' = λ_iδ_ij. Π' is compatible with Π, and the
recursion operator N = Π'Π⁻¹ = diag(λ1, λ2, λ1, λ2) has the eigenvalues λ_k. The torsion of N is 0, and the traces J_m =
tr N^m/(2m) obey Lenard's relations Π'dJ_m = ΠdJ_(m+1). At the image of a state under the 2-torsion map, J_1 and −λ1λ2
are the integrals of the tilde pair (:mod:`integrable.deformations.tilde`). (Tsiganov, section 4; Magri and Morosi
1984.)

Points are tuples (u1, u2, p1, p2); ``body`` may be over jets.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

from integrable.phase.body import Body, elements
from integrable.phase.brackets import Matrix, Variables, entry_slopes, weighted_matrix
from integrable.phase.separation import phi
from jacobian import linear, poly
from jacobian.element import Real
from jacobian.errors import ArgumentError, FieldError, PrecisionLoss, entries, shown, whole, written
from jacobian.fields.protocol import Field, check_field

MOST_INDEX = 10**6


def eigenvalues(body: Body, point: tuple[Real, Real, Real, Real]) -> tuple[Real, Real]:
    """The eigenvalues (λ1, λ2) of the recursion operator at (u1, u2, p1, p2): λ_k = φ(u_k)p_k²."""
    if not isinstance(body, Body):
        raise ArgumentError(f"body = {shown(body)}: a Body is needed, such as system.body")
    K = body.field
    u1, u2, p1, p2 = elements(K, point, "point", 4, "a sequence (u1, u2, p1, p2)")
    return K.mul(phi(body, u1), K.mul(p1, p1)), K.mul(phi(body, u2), K.mul(p2, p2))


def second_bracket(body: Body, point: tuple[Real, Real, Real, Real]) -> Matrix:
    """The 4×4 matrix of the second bracket Π': {u_i, p_j}' = λ_iδ_ij with the :func:`eigenvalues` λ_i."""
    values = eigenvalues(body, point)
    return weighted_matrix(body.field, values)


def recursion_operator(body: Body, point: tuple[Real, Real, Real, Real]) -> Matrix:
    """The recursion operator Π'Π⁻¹ = diag(λ1, λ2, λ1, λ2) of the brackets Π, Π', with the :func:`eigenvalues` λ_k."""
    values = eigenvalues(body, point) * 2
    zero = body.field.zero
    return tuple(tuple(value if i == j else zero for j in range(4)) for i, value in enumerate(values))


def trace_hamiltonian(body: Body, point: tuple[Real, Real, Real, Real], m: int) -> Real | None:
    """J_m = tr N^m/(2m) = (λ1^m + λ2^m)/m, m ≥ 1, of the recursion operator N. ArgumentError if m is 0 in the field."""
    values, K = eigenvalues(body, point), body.field
    m = whole(m, "m", "the index of a J_m is an int from 1 to a million", 1, MOST_INDEX)
    below = poly.integer(K, m)
    if K.is_zero(below):
        raise ArgumentError(f"m = {written(m)} vanishes in {K.name}: J_m does not exist there")
    total = K.div(K.add(*(poly.power(K, value, m) for value in values)), below)
    if not K.exact and not abs(total) < inf:
        raise PrecisionLoss(f"m = {written(m)}: J_m is beyond the numbers of {K.name}")
    return total


def nijenhuis_torsion(
    K: Field, operator: Callable[[Any, Variables], Matrix], point: Variables
) -> dict[tuple[int, int, int], Real]:
    """The components T^i_jk, j < k, of the torsion of a field of operators N(field, point) at a point.

    T(X, Y) = [NX, NY] − N[NX, Y] − N[X, NY] + N²[X, Y]; all are zero for a recursion operator. Derivatives are computed
    as in :func:`integrable.phase.brackets.jacobian_matrix`. (Nijenhuis 1951.)
    """
    size, dot = len(point), K.dot
    N, slopes = entry_slopes(K, operator, point)
    columns = list(zip(*N, strict=True))

    def component(i: int, j: int, k: int) -> Real:
        along = K.sub(dot(columns[j], slopes[i, k]), dot(columns[k], slopes[i, j]))
        turned = [K.sub(slopes[n, k][j], slopes[n, j][k]) for n in range(size)]
        return K.sub(along, dot(N[i], turned))

    return {(i, j, k): component(i, j, k) for i, j in slopes for k in range(j + 1, size)}


def rank(K: Field, matrix: tuple[tuple[Real, ...], ...]) -> int:
    """The rank of a matrix over an exact field, by elimination: 4 for the bracket of (γ, M) at every state, 2 for
    :func:`second_bracket` where one of its λ_i is 0. FieldError over an inexact field: rounding hides the rank there.
    """
    if not check_field(K, "K").exact:
        raise FieldError(f"K = {K.name}: a rank is not decided over an inexact field")
    wanted = "a sequence of rows of one length"
    given = [entries(row, f"matrix[{i}]", wanted) for i, row in enumerate(entries(matrix, "matrix", wanted))]
    if len({len(row) for row in given}) > 1:
        raise ArgumentError(f"matrix = {shown(matrix)}: {wanted} is needed")
    rows = [[K.coerce(x, f"matrix[{i}]") for x in row] for i, row in enumerate(given)]
    return len(linear.echelon(K, rows, len(rows[0]) if rows else 0))
