"""Poisson structures of the ball and the top, and how to test them.

The signs are those of the motion: ẋ = g{x, H1/2}. Borisov and Mamaev (2001) and Tsiganov use the opposite signs
(docs/errata.md, item 1). On (γ, M), with cyclic (i, j, k),

    {M_i, M_j} = −(M_k/g − d·g(M, Aγ)γ_k),   {M_i, γ_j} = {γ_i, M_j} = −γ_k/g,   {γ_i, γ_j} = 0,

which at d = 0 is the Lie–Poisson bracket of e*(3) with the opposite sign. On the coordinates (u1, u2, p1, p2) of
:mod:`integrable.phase.separation` a bracket has the form {u_i, p_j} = w_iδ_ij. It is canonical for w_i = 1, called W
for w_i = u_i, and the second bracket Π' of :mod:`integrable.phase.recursion` for the eigenvalues w_i = λ_i there.

Derivatives are exact over exact fields, by :mod:`integrable.phase.jets`, and difference quotients elsewhere. A function
of a state is f(system, state), a function of a tuple of coordinates f(field, point). Either must compute with the
system or field that is its first argument.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations, product
from typing import Any, TypeVar

from integrable.phase import coordinates
from integrable.phase.body import Body, Vector, cross
from integrable.phase.jets import JetField
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State
from jacobian.element import Arithmetic, Real
from jacobian.errors import ArgumentError, NotRepresentable, shown
from jacobian.fields.protocol import Field

Space = TypeVar("Space", bound=PhaseSpace)
Variables = tuple[Any, ...]
"""A point, in numbers of a field or in jets over it."""
Matrix = tuple[Variables, ...]
OfVariables = Callable[[Any, Variables], Sequence[Real]]
# (n, weight) of the central difference quotient Σ weight·(f(x + nh) − f(x − nh))/(60h) of order six
STENCIL = ((1, 45), (2, -9), (3, 1))


def ball_matrix(body: Body, gamma: Vector, M: Vector, g: object = None) -> Matrix:
    """The 6×6 matrix of brackets of (γ1, γ2, γ3, M1, M2, M3) at any γ and M, also if their product (γ, M) ≠ 0.

    ``g`` is the root of g² (by default the field's own; NotASquare where there is none).
    """
    K, zero = body.field, body.field.zero
    turn, spin = gamma, M
    if body.rolls:
        g = coordinates.root_of_g(body, gamma) if g is None else g
        tilt = K.dot([K.mul(a, x) for a, x in zip(body.a, gamma, strict=True)], M)
        lean = K.mul(K.mul(body.d, g), tilt)
        turn = tuple(K.div(x, g) for x in gamma)
        spin = tuple(K.sub(K.div(m, g), K.mul(lean, x)) for m, x in zip(M, gamma, strict=True))
    upper, lower = _skew(K, turn), _skew(K, spin)
    return (*((zero, zero, zero, *row) for row in upper), *((*a, *b) for a, b in zip(upper, lower, strict=True)))


def weighted_matrix(K: Field, weights: Sequence[Real]) -> Matrix:
    """The 4×4 matrix of the bracket {u_i, p_j} = w_iδ_ij on (u1, u2, p1, p2)."""
    (first, second), zero = weights, K.zero
    return (
        (zero, zero, first, zero),
        (zero, zero, zero, second),
        (K.neg(first), zero, zero, zero),
        (zero, K.neg(second), zero, zero),
    )


def canonical_matrix(K: Field) -> Matrix:
    """The 4×4 matrix of the canonical bracket {u_i, p_j} = δ_ij on (u1, u2, p1, p2)."""
    return weighted_matrix(K, (K.one, K.one))


def _skew(K: Field, x: Vector) -> Matrix:
    zero, (x1, x2, x3) = K.zero, x
    return ((zero, K.neg(x3), x2), (x3, zero, K.neg(x1)), (K.neg(x2), x1, zero))


# --- derivatives


def jacobian_matrix(K: Any, function: OfVariables, point: Sequence[Real]) -> Matrix:
    """The matrix ∂f_i/∂x_k of f(field, x) at ``point``: exact over an exact field, else by differences of order six."""
    if K.exact:
        jets = JetField(K, len(point))
        try:
            return tuple(jets.coerce(y).slopes for y in function(jets, jets.variables(point)))
        except ZeroDivisionError:
            raise NotRepresentable(
                f"the function passes a special position over {K.name}: no derivative there"
            ) from None
    step = K.coerce(K.eps) ** K.div(K.one, K.coerce(7))
    columns = [_difference(lambda x: function(K, x), tuple(point), k, step) for k in range(len(point))]
    return tuple(zip(*columns, strict=True))


def _difference(function: Callable[[Variables], Sequence[Real]], point: Variables, k: int, step: Real) -> list[Real]:
    h, terms = step * max(1, abs(point[k])), []
    for n, weight in STENCIL:
        ahead, behind = (function((*point[:k], point[k] + s, *point[k + 1 :])) for s in (n * h, -n * h))
        terms.append([weight * (a - b) for a, b in zip(ahead, behind, strict=True)])
    return [sum(column) / (60 * h) for column in zip(*terms, strict=True)]


def over(system: Space, field: Any) -> Space:
    """The same system over another field, such as jets over its own field, to which its numbers are converted."""
    if hasattr(system, "over"):
        return system.over(field)
    return system._of_constants(field, [*map(field.coerce, system.constants)])


def on_leaf(system: PhaseSpace, like: State, gamma: Vector, M: Vector) -> State:
    """The state (γ, M) moved, to first order, onto the symplectic leaf of ``like``: it takes C1, C2 and the sign of g
    from ``like``.

    A function composed with this map has the same brackets on the leaf, because C1 and C2 are Casimir functions.
    """
    K = system.field
    base = K.base if isinstance(K, JetField) else K
    one, tilt = (base.dot(like.vectors[0], v) for v in like.vectors)
    square = K.dot(gamma, gamma)
    nearby = K.add(K.one, K.div(K.sub(one, square), K.add(one, one)))
    scale = nearby if K.exact else K.sqrt(K.div(one, square))
    x1, x2, x3 = (K.mul(scale, x) for x in gamma)
    gamma = (x1, x2, x3)
    rest = K.div(K.sub(tilt, K.dot(gamma, M)), one)
    m1, m2, m3 = (K.add(m, K.mul(rest, x)) for m, x in zip(M, gamma, strict=True))
    g = like.g
    if g is not None and isinstance(K, JetField):
        g = K.sqrt(K.inv(system.body.conformal(gamma)), g)
    return State(gamma, (m1, m2, m3), g, like.tilted)


def differential(system: Space, function: Callable[[Space, State], Sequence[Real]], state: State) -> Matrix:
    """The matrix ∂f_i/∂(γ, M) of f(system, state) at ``state``, along the symplectic leaf of the state."""

    def of_point(field: Arithmetic, point: Variables) -> Sequence[Real]:
        moved = over(system, field)
        gamma, M = point[:3], point[3:]
        return function(moved, on_leaf(moved, state, gamma, M))

    return jacobian_matrix(system.field, of_point, state.row)


def bracket(system: Space, F: Callable[[Space, State], Real], G: Callable[[Space, State], Real], state: State) -> Real:
    """The value of {F, G} at ``state``, for the bracket of :meth:`System.poisson`."""
    rows = differential(system, lambda s, x: (F(s, x), G(s, x)), state)
    return pushed(system.field, rows, system.poisson(state))[0][1]


def pushed(K: Field, rows: Matrix, matrix: Matrix) -> Matrix:
    """J Π Jᵀ, the brackets of functions whose differentials are the rows of J = ``rows``, with Π = ``matrix``."""
    left = [[K.dot(row, column) for column in zip(*matrix, strict=True)] for row in rows]
    return tuple(tuple(K.dot(first, second) for second in rows) for first in left)


def image_brackets(system: PhaseSpace, step: Callable[..., State], state: State) -> tuple[Matrix, Matrix]:
    """Two 6×6 matrices: the brackets of the image of (γ, M) under a step, and :meth:`System.poisson` at the image.

    They are equal if the step is a Poisson map. ``step`` is a function of (system, state), or a Step with
    ``.over(system)`` as in :mod:`integrable.steps.translation`.
    """
    state = system._checked(state)
    if not (hasattr(step, "over") or callable(step)):
        raise ArgumentError(f"step = {shown(step)}: give a Step or a function of (system, state)")

    def image(moved: PhaseSpace, x: State) -> State:
        return step.over(moved)(x) if hasattr(step, "over") else step(moved, x)

    rows = differential(system, lambda moved, x: image(moved, x).row, state)
    return pushed(system.field, rows, system.poisson(state)), system.poisson(image(system, state))


# --- identities of a structure


def entry_slopes(
    K: Field, matrix: Callable[[Any, Variables], Matrix], point: Variables
) -> tuple[Matrix, dict[tuple[int, int], Variables]]:
    """A matrix that depends on the point, at ``point``, and the derivatives of its entries (i, j)."""
    places = list(product(range(len(point)), range(len(point))))
    rows = jacobian_matrix(K, lambda field, x: [matrix(field, x)[i][j] for i, j in places], point)
    return matrix(K, tuple(point)), dict(zip(places, rows, strict=True))


def jacobi_defects(
    K: Field, matrix: Callable[[Any, Variables], Matrix], point: Variables
) -> dict[tuple[int, int, int], Real]:
    """The sums {x_i, {x_j, x_k}} + {x_j, {x_k, x_i}} + {x_k, {x_i, x_j}} at ``point``, by (i, j, k), i < j < k. All are
    zero for a Poisson structure.
    """
    values, slopes = entry_slopes(K, matrix, point)
    return {
        (i, j, k): K.add(
            K.add(K.dot(values[i], slopes[j, k]), K.dot(values[j], slopes[k, i])), K.dot(values[k], slopes[i, j])
        )
        for i, j, k in combinations(range(len(point)), 3)
    }


def conformal_field(system: PhaseSpace, state: State) -> tuple[Real, ...]:
    """The vector field g{x, H1/2} of x = (γ, M): the motion in its conformally Hamiltonian form."""
    K = system.field
    (row,) = differential(system, lambda s, x: (s.integrals(x).H1,), state)
    g = coordinates.g_of(system.body, state) if system.body.rolls else K.one
    scale = K.div(g, K.add(K.one, K.one))
    return tuple(K.mul(scale, K.dot(line, row)) for line in system.poisson(state))


def measure_divergence(body: Body, gamma: Vector, M: Vector) -> Real:
    """The divergence div(g·(γ × ω, M × ω))/g at any (γ, M): 0, as g dγ dM is an invariant measure (Chaplygin 1903).

    It is rational in (γ, M), because ∂g/g = −½g²·∂(g⁻²) with g⁻² = (γ, γ) − d(γ, Aγ), as in :meth:`Body.conformal`.
    """
    K = body.field

    def motion(field: Field, point: Variables) -> Sequence[Real]:
        x, m = (point[0], point[1], point[2]), (point[3], point[4], point[5])
        omega = replace(body, field=field).omega(x, m)
        return (*cross(field, x, omega), *cross(field, m, omega))

    point = (*gamma, *M)
    rows = jacobian_matrix(K, motion, point)
    trace = K.dot([row[i] for i, row in enumerate(rows)], (K.one,) * 6)
    (slope,) = jacobian_matrix(K, lambda field, x: (replace(body, field=field).conformal((x[0], x[1], x[2])),), point)
    change = K.dot(slope, motion(K, point))
    return K.sub(trace, K.div(change, K.mul(K.add(K.one, K.one), body.conformal(gamma))))
