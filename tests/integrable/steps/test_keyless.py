"""The 2-torsion map in closed form and as a divisor, exactly."""

from __future__ import annotations

import pytest

from integrable import ChaplyginBall
from integrable.phase.jets import JetField
from jacobian import poly
from jacobian.errors import ArgumentError
from tests.integrable.exact_points import (
    CYCLIC,
    cross,
    dot,
    over_fields,
    phase,
    step_case,
    wrapped,
)


@over_fields()
def test_the_keyless_map(K) -> None:
    """Closed form, Poisson, D + (1/d, 0), P = V − λU and Ũ = (f − P²)/(4dh2U(x − 1/d)), B² = (−γ, M)."""
    K = K()
    system, state, step, brackets, target = step_case(K, 11, "ball", lambda s, _: s.keyless(), squares=True)
    image = step(state)
    assert brackets == target
    assert system.integrals(image) == system.integrals(state)
    torsion = system.torsion().divisor(state)
    assert system.divisor(image) == system.divisor(state) + torsion
    assert image == system.state(image.gamma, image.M, image.g)
    twice = step(image)
    assert (twice.gamma, twice.M) == (tuple(map(K.neg, state.gamma)), state.M)
    N, x = JetField(K, 0), phase(system, state)
    h1, h2 = x.H
    y = phase(system, image)
    assert (h2 - x.d * h1) / (x.G * h2 * x.A[0] * x.A[1] * x.A[2]) == y.G
    # e² = γ̃²g̃²A: Γ̃ = e
    for i in range(3):
        assert y.G * x.A[i] * y.gamma[i] ** 2 == x.w[i] ** 2 / h2
    assert y.G * h2 * sum(w * w / A for w, A in zip(x.w, x.A, strict=True)) == y.G * y.G * h2 * h2
    D, E = system.divisor(state), system.divisor(image)
    lean = 2 * x.g * x.d * dot(x.A_gamma, x.w)
    u, v = wrapped(system, D.u), wrapped(system, D.v)
    P = poly.sub(N, v, poly.scale(N, lean, u))
    f = wrapped(system, system.body.polynomial(h1.value, h2.value))
    below = poly.scale(N, 4 * x.d * h2, poly.mul(N, u, (-1 / x.d, N.one)))
    quotient, rest = poly.divide(N, poly.sub(N, f, poly.mul(N, P, P)), below)
    assert rest == ()
    assert quotient == wrapped(system, E.u)
    assert poly.neg(N, poly.mod(N, P, quotient)) == wrapped(system, E.v)


@over_fields()
def test_the_keyless_map_is_the_printed_one(K) -> None:
    """γ̃_i² and M̃_i as printed in chap-keyless, for some choice of the σ."""
    K = K()
    system, state, _, _, _ = step_case(K, 12, "ball", lambda s, _: s.keyless(), squares=True)
    x = phase(system, state)
    _, h2 = x.H
    found = 0
    for signs in [(i, j, k) for i in (1, -1) for j in (1, -1) for k in (1, -1)]:
        y = phase(system, system.keyless(signs)(state))
        for i, j, k in CYCLIC:
            printed = (x.gamma[i] ** 2 - (x.M[j] ** 2 + x.M[k] ** 2) / h2) / ((x.a[i] * x.d - 1) * y.G)
            assert y.gamma[i] ** 2 == printed
        found += all(_printed_momentum(x, y, *axes) == y.M[axes[0]] for axes in CYCLIC)
    assert found > 0


def _printed_momentum(x, y, i, j, k):
    own = (y.gamma[j] ** 2 + y.gamma[k] ** 2) * x.gamma[j] * x.gamma[k] * x.M[i] / (y.gamma[j] * y.gamma[k])
    other = x.gamma[i] * y.gamma[j] * x.gamma[k] * x.M[j] / y.gamma[k]
    third = x.gamma[i] * x.gamma[j] * y.gamma[k] * x.M[k] / y.gamma[j]
    return x.g / y.g * (-own + other + third)


@over_fields()
def test_the_keyless_map_of_the_top(K) -> None:
    """d = 0: γ̃ = γ × M/|M|, M̃ = M; Poisson."""
    K = K()
    system, state, step, brackets, target = step_case(K, 13, "top", lambda s, _: s.keyless())
    assert brackets == target
    x, y = phase(system, state), phase(system, step(state))
    size = x.g.field.sqrt(x.H[1])
    assert y.gamma == tuple(e / size for e in cross(x.gamma, x.M))
    assert y.M == x.M


def test_the_keyless_map_is_real_for_every_body() -> None:
    """Images are real for bodies from thin to heavy, and for equal moments."""
    for moments, d in (((1, 2, 3), 0.7), ((1, 1, 2), 0.3), ((2, 2, 2), 5), ((1, 2, 3), 1e-6), ((1, 2, 3), 1e4)):
        ball = ChaplyginBall(moments, d)
        state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
        image = ball.keyless()(state)
        assert max(abs(x - y) for x, y in zip(ball.integrals(image), ball.integrals(state), strict=True)) < 1e-11
        back = ball.keyless()(image)
        assert back.gamma == pytest.approx([-x for x in state.gamma], abs=1e-10)
    with pytest.raises(ArgumentError, match="3 signs"):
        ball.keyless((1, 2, 3))


@pytest.mark.parametrize("moment", [1e-4, 1e-8, 1e-12])
def test_thin_balls_lose_no_digits(moment):
    ball = ChaplyginBall(inertia=(moment, 1, 1.5), d=1.0)
    state = ball.state((0.6, 0.48, 0.64), (0.8, -0.36, -0.48))
    image = ball.keyless()(state)
    before, after = ball.integrals(state), ball.integrals(image)
    assert abs(after.C1 - 1) < 1e-15
    assert abs(after.H1 / before.H1 - 1) < 2e-15
    assert abs(after.H2 / before.H2 - 1) < 2e-15
