"""The motion, its integrals, bracket and measure, exactly over finite fields."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from integrable.phase.brackets import (
    ball_matrix,
    bracket,
    conformal_field,
    differential,
    image_brackets,
    jacobi_defects,
    jacobian_matrix,
    measure_divergence,
    on_leaf,
    over,
)
from integrable.phase.jets import JetField
from integrable.phase.state import State
from jacobian import MP
from tests.integrable.exact_points import (
    CYCLIC,
    attempt,
    dot,
    over_fields,
    phase,
    random_case,
    tilted_phase,
)

KINDS = pytest.mark.parametrize("kind", ["ball", "top"])


def raw(point):
    """(γ, M, g) as bare elements."""
    bare = [tuple(x.value for x in v) for v in (point.gamma, point.M)]
    return bare[0], bare[1], point.g.value


def tilted_state(K, seed, kind):
    system, point = attempt(lambda: tilted_phase(K, Random(seed), kind))
    gamma, M, g = raw(point)
    return system, State(gamma, M, g if kind == "ball" else None), point


@over_fields()
@KINDS
def test_constants(K, kind) -> None:
    """1 − da_i = I_i/(I_i + d), g⁻² = 1 − d(γ, Aγ) = Σ(1 − da_i)γ_i², n = (γ, ω) = g²(γ, AM)."""
    system, _, x = tilted_state(K(), 1, kind)
    N = x.g.field
    for moment, a in zip(system.inertia, x.a, strict=True):
        assert 1 - x.d * a == N.coerce(moment) / (N.coerce(moment) + x.d)
    assert x.G * (1 - x.d * dot(x.gamma, x.A_gamma)) == N.one
    assert x.G * dot(x.A, [y * y for y in x.gamma]) == N.one
    assert dot(x.gamma, x.omega) == x.G * dot(x.gamma, x.AM)


@over_fields()
@KINDS
def test_integrals_are_conserved(K, kind) -> None:
    """C1, C2, H1, H2 along γ̇ = γ×ω, Ṁ = M×ω, for every (γ, M)."""
    K = K()
    system, state, _ = tilted_state(K, 2, kind)
    rate = system.vector_field(state)
    rows = jacobian_matrix(
        K, lambda N, x: replace(system.body, field=N).integrals(x[:3], x[3:]), (*state.gamma, *state.M)
    )
    assert [K.dot(row, (*rate.gamma, *rate.M)) for row in rows] == [K.zero] * 4


@over_fields()
@KINDS
def test_the_motion_is_conformally_hamiltonian(K, kind) -> None:
    """ḟ = g{f, H1/2}, for every (γ, M)."""
    system, state, _ = tilted_state(K(), 3, kind)
    rate = system.vector_field(state)
    assert conformal_field(system, state) == (*rate.gamma, *rate.M)


@over_fields()
@KINDS
def test_casimirs_and_involution(K, kind) -> None:
    """C1 and C2 are Casimirs, {H1, H2} = 0 for every (γ, M)."""
    K = K()
    system, state, _ = tilted_state(K, 4, kind)
    matrix = system.poisson(state)
    two, zero = K.add(K.one, K.one), K.zero
    for slope in ([K.mul(two, x) for x in state.gamma] + [zero] * 3, [*state.M, *state.gamma]):
        assert [K.dot(row, slope) for row in matrix] == [zero] * 6
    assert bracket(system, lambda s, x: s.integrals(x).H1, lambda s, x: s.integrals(x).H2, state) == zero


@over_fields()
@KINDS
def test_jacobi_identity(K, kind) -> None:
    """The structure is Poisson on every leaf, and antisymmetric."""
    K = K()
    system, state, _ = tilted_state(K, 5, kind)

    def matrix(N, x):
        moved = over(system, N)
        return moved.poisson(on_leaf(moved, state, x[:3], x[3:]))

    assert set(jacobi_defects(K, matrix, (*state.gamma, *state.M)).values()) == {K.zero}
    values = system.poisson(state)
    assert all(K.add(values[i][j], values[j][i]) == K.zero for i in range(6) for j in range(6))


@over_fields()
def test_a_wrong_structure_fails_the_jacobi_identity(K) -> None:
    """The check can fail: without the term d·g(M, Aγ)γ_k the ball's bracket is not Poisson."""
    K = K()
    system, state, _ = tilted_state(K, 5, "ball")

    def matrix(N, x):
        moved = over(system, N)
        y = on_leaf(moved, state, x[:3], x[3:])
        top = ball_matrix(replace(moved.body, d=K.zero), y.gamma, y.M)
        return tuple(tuple(N.div(z, y.g) for z in row) for row in top)

    assert set(jacobi_defects(K, matrix, (*state.gamma, *state.M)).values()) != {K.zero}


@over_fields()
@KINDS
def test_invariant_measure(K, kind) -> None:
    """g dγ dM is invariant; without g it is not (d ≠ 0)."""
    K = K()
    system, state, _ = tilted_state(K, 6, kind)
    assert measure_divergence(system.body, state.gamma, state.M) == K.zero
    assert measure_divergence(system.body, state.M, state.gamma) == K.zero
    if kind == "ball":
        rate = system.vector_field(state)
        # div ω-field alone is −ġ/g = −½g²·d(g⁻²)/dt·(−1) ≠ 0
        (slope,) = jacobian_matrix(K, lambda N, x: (N.dot(system.a, [N.mul(y, y) for y in x]),), state.gamma)
        assert K.dot(slope, rate.gamma) != K.zero


@over_fields()
def test_the_top_has_the_bracket_of_e3_reversed(K) -> None:
    """d = 0: {M_i, M_j} = −ε_ijk M_k, {M_i, γ_j} = −ε_ijk γ_k."""
    K = K()
    system, state, _ = tilted_state(K, 7, "top")
    matrix = system.poisson(state)
    for i, j, k in CYCLIC:
        assert matrix[3 + i][3 + j] == K.neg(state.M[k])
        assert matrix[3 + i][j] == K.neg(state.gamma[k])
        assert matrix[i][3 + j] == K.neg(state.gamma[k])
        assert matrix[i][j] == K.zero


@over_fields()
def test_decomposition_of_H1(K) -> None:
    """H1 = (A'M, M) + d g² c (γ, A''M), and at c = 0 (γ, AM)² = (BM, M)."""
    K = K()
    _, _, x = tilted_state(K, 8, "ball")
    diagonal = [a + x.d * x.G * b for a, b in zip(x.a, x.B, strict=True)]
    second = [x.a[i] * (x.a[j] + x.a[k]) - x.a[j] * x.a[k] for i, j, k in CYCLIC]
    c = dot(x.gamma, x.M)
    tail = x.d * x.G * c * dot(x.gamma, [s * m for s, m in zip(second, x.M, strict=True)])
    assert x.H[0] == dot(diagonal, [m * m for m in x.M]) + tail
    plain = phase(*random_case(K, Random(9)))
    assert dot(plain.gamma, plain.AM) ** 2 == dot(plain.B, [m * m for m in plain.M])


def test_differences_agree_with_jets_and_converge_with_the_digits() -> None:
    """Over inexact fields brackets are made of difference quotients of order six: {H1, H2} = 0 and {u1, p1} = 1."""
    from integrable import ChaplyginBall

    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(40))
    state = ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    size = bracket(ball, lambda s, x: s.integrals(x).H1, lambda s, x: s.integrals(x).H2, state)
    assert abs(size) < 1e-30
    pair = bracket(ball, lambda s, x: s.separated(x).u[0], lambda s, x: s.separated(x).p[0], state)
    assert abs(pair - 1) < 1e-30
    for left, right in zip(*image_brackets(ball, ball.translation([0.5, 0.4], multiple=2), state), strict=True):
        assert all(abs(a - b) < 1e-25 for a, b in zip(left, right, strict=True))


def test_jets_are_derivatives() -> None:
    """Jets of x²/(1 + y) and of a root agree with the rules of differentiation."""
    from jacobian import QQ

    N = JetField(QQ, 2)
    x, y = N.variables((QQ.coerce(3), QQ.coerce(2)))
    z = x * x / (1 + y)
    assert (z.value, *z.slopes) == (3, 2, -1)
    root = N.sqrt(x * 12)
    assert (root.value, *root.slopes) == (6, 1, 0)
    assert x**-1 * x == 1
    assert 2 - x == -(x - 2)
    with pytest.raises(ZeroDivisionError):
        N.inv(x - 3)


@over_fields()
def test_the_differential_of_the_identity_is_the_projector_on_the_leaf(K) -> None:
    K = K()
    system, state = attempt(lambda: random_case(K, Random(11)))
    rows = differential(system, lambda s, x: (*x.gamma, *x.M), state)
    assert K.dot(state.gamma, [K.dot(row, (*state.gamma, *[K.zero] * 3)) for row in rows[:3]]) == K.zero
