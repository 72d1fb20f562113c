"""Bodies and states: constants, and one line for every invalid input."""

from __future__ import annotations

import math

import pytest

from integrable import ChaplyginBall, EulerTop
from jacobian import GF, MP, QQ
from jacobian.errors import ArgumentError, FieldError

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)


def test_constants_of_a_body() -> None:
    ball = ChaplyginBall((1, 2, 3), "7/10", field=QQ)
    assert ball.a == tuple(1 / (i + ball.d) for i in ball.inertia)
    assert ball.body.contact == tuple(1 - ball.d * a for a in ball.a)
    assert ball.body.differences[0] == (ball.a[0] - ball.a[1]) * (ball.a[0] - ball.a[2])


def test_mass_and_radius_give_d() -> None:
    assert ChaplyginBall((1, 2, 3), mass=2, radius=0.5).d == 0.5


def test_decimal_strings_are_exact_in_multiprecision() -> None:
    ball = ChaplyginBall((1, 2, 3), "0.1", field=MP(50))
    assert abs(10 * ball.d - 1) < MP(50).eps
    assert abs(10 * ChaplyginBall((1, 2, 3), 0.1, field=MP(50)).d - 1) > 1e-18


def test_integrals_and_vector_field_of_the_ball_against_their_definition() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    state = ball.state(GAMMA, M)
    g2 = 1 / (1 - ball.d * sum(a * x * x for a, x in zip(ball.a, GAMMA, strict=True)))
    spin = g2 * sum(a * x * y for a, x, y in zip(ball.a, GAMMA, M, strict=True))
    omega = [a * y + ball.d * spin * a * x for a, x, y in zip(ball.a, GAMMA, M, strict=True)]
    assert ball.omega(state) == pytest.approx(omega, rel=1e-15)
    integrals = ball.integrals(state)
    assert pytest.approx(sum(x * y for x, y in zip(omega, M, strict=True)), rel=1e-15) == integrals.H1
    assert pytest.approx(4.0, rel=1e-15) == integrals.H2
    field = ball.vector_field(state)
    assert field.gamma[0] == pytest.approx(GAMMA[1] * omega[2] - GAMMA[2] * omega[1], rel=1e-14)
    assert field.M[2] == pytest.approx(M[0] * omega[1] - M[1] * omega[0], rel=1e-14)


def test_the_vector_field_is_tangent_to_the_integrals_exactly() -> None:
    """Every integral of the top has derivative 0 along its vector field, over GF(p)."""
    K = GF(2**61 - 1)
    ball = EulerTop((3, 5, 11), field=K)
    # |γ|² = 1: (2, 3, 6)/7
    gamma = tuple(K.div(K.coerce(x), K.coerce(7)) for x in (2, 3, 6))
    state = ball.state(gamma, (3, -2, 0))
    rate = ball.vector_field(state)
    two = K.coerce(2)
    assert K.mul(two, K.dot(state.gamma, rate.gamma)) == 0
    assert K.add(K.dot(state.gamma, rate.M), K.dot(rate.gamma, state.M)) == 0
    assert K.mul(two, K.dot(ball.omega(state), rate.M)) == 0
    assert K.mul(two, K.dot(state.M, rate.M)) == 0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ChaplyginBall((1, -2, 3), 0.7), ("inertia[1]", "-2", "> 0")),
        (lambda: ChaplyginBall((1, 0, 3), 0.7), ("inertia[1]", "0", "> 0")),
        (lambda: ChaplyginBall((1, 2), 0.7), ("inertia", "(1, 2)", "three")),
        (lambda: ChaplyginBall(7, 0.7), ("inertia", "7", "three")),
        (lambda: ChaplyginBall((1, 2, 3), -0.1), ("d", "-0.1", "≥ 0")),
        (lambda: ChaplyginBall((1, 2, 3)), ("d", "mass", "radius")),
        (lambda: ChaplyginBall((1, 2, 3), 1, mass=1, radius=1), ("d = 1", "mass = 1", "either")),
        (lambda: ChaplyginBall((1, 2, 3), mass=1), ("radius", "both")),
        (lambda: ChaplyginBall((1, 2, 3), mass=-1, radius=1), ("mass", "-1", "≥ 0")),
        (lambda: ChaplyginBall((1, math.nan, 3), 0.7), ("inertia[1]", "nan", "finite")),
        (lambda: ChaplyginBall((1, 2, 3), math.inf), ("d", "inf", "finite")),
        (lambda: EulerTop((1, 2, 0)), ("inertia[2]", "0", "> 0")),
        (lambda: ChaplyginBall((1, 2, 7), 1, field=GF(7)), ("inertia[2]", "0", "GF(7)")),
        (lambda: ChaplyginBall((1, 2, 6), 1, field=GF(7)), ("inertia[2]", "6", "inertia[2] + d")),
    ],
)
def test_bad_bodies(make, words) -> None:
    with pytest.raises((ArgumentError, FieldError)) as caught:
        make()
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    ("gamma", "momentum", "words"),
    [
        ((1, 1, 0), (0, 0, 1), ("gamma", "(γ, γ) = 2.0", "unit")),
        ((0.6, 0.8, 1e-4), (0, 0, 0), ("gamma", "(γ, γ)", "unit")),
        ((1, 0, 0), (0.5, 0, 1), ("M", "(γ, M) = 0.5", "needs (γ, M) = 0")),
        ((math.nan, 0, 0), (0, 0, 1), ("gamma[0]", "nan", "finite")),
        ((1, 0, 0), (0, math.inf, 0), ("M[1]", "inf", "finite")),
        ((1, 0), (0, 1, 0), ("gamma", "(1, 0)", "three")),
        ("100", (0, 1, 0), ("gamma", "100", "three")),
        ((1, 0, 0), None, ("M", "None", "three")),
        ((1, 0, "a"), (0, 1, 0), ("gamma[2]", "a")),
    ],
)
def test_bad_states(gamma, momentum, words) -> None:
    with pytest.raises((ArgumentError, FieldError)) as caught:
        ChaplyginBall((1, 2, 3), 0.7).state(gamma, momentum)
    assert "\n" not in str(caught.value)
    for word in words:
        assert word in str(caught.value)


def test_a_rounded_start_is_told_from_an_exact_one_in_multiprecision() -> None:
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(50))
    with pytest.raises(ArgumentError, match="decimal strings"):
        ball.state(GAMMA, M)
    ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))


def test_a_body_at_rest_has_no_curve_and_no_flow() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    state = ball.state((1, 0, 0), (0, 0, 0))
    for use in (ball.flow, ball.divisor):
        with pytest.raises(ArgumentError, match="at rest"):
            use(state)


def test_systems_are_values() -> None:
    assert ChaplyginBall((1, 2, 3), 0.7) == ChaplyginBall((1, 2, 3), 0.7)
    assert ChaplyginBall((1, 2, 3), 0.7) != ChaplyginBall((1, 2, 3), 0.8)
    assert len({EulerTop((1, 2, 3)), EulerTop((1, 2, 3)), ChaplyginBall((1, 2, 3), 0)}) == 2
    assert repr(ChaplyginBall((1, 2, 3), 0.7)) == "ChaplyginBall(inertia=(1.0, 2.0, 3.0), d=0.7)"


def test_only_states_are_taken_as_states() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    with pytest.raises(ArgumentError, match=r"state = \(1, 2\)"):
        ball.divisor((1, 2))
