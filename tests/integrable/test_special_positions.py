"""γ_i = 0, u1 = u2, equal moments, H1/H2 at its ends and at a2, thin and heavy bodies: right, or a named error."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop, coordinates
from integrable.brackets import image_brackets
from jacobian import GF, NotASquare, NotRepresentable
from jacobian.errors import ArgumentError, SingularCurve
from tests.integrable.exact_points import attempt, random_system
from tests.integrable.exact_states import random_state, unit_vector

KINDS = pytest.mark.parametrize("kind", ["ball", "top"])


def state_without(system, axis, rng):
    """A state with γ_axis = 0."""
    K = system.field

    def make():
        t = K.random(rng)
        scale = K.inv(K.add(K.one, K.mul(t, t)))
        pair = K.mul(K.add(t, t), scale), K.mul(K.sub(K.one, K.mul(t, t)), scale)
        gamma = [K.zero] * 3
        gamma[(axis + 1) % 3], gamma[(axis + 2) % 3] = pair
        m = K.random(rng)
        M = [K.random(rng)] * 3
        M[(axis + 1) % 3], M[(axis + 2) % 3] = K.neg(K.mul(m, pair[1])), K.mul(m, pair[0])
        return system.state(gamma, M)

    return attempt(make)


@KINDS
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_vanishing_gamma(kind, axis) -> None:
    """Steps, the bracket and the divisor are regular at γ_i = 0; (u, p) is refused, u_k = a_i being a branch point."""
    K, rng = GF(2**61 - 1), Random(axis)

    def make():
        system = random_system(K, rng, kind)
        state = state_without(system, axis, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        return system, state, step, *image_brackets(system, step, state)

    system, state, step, brackets, target = attempt(make)
    image = step(state)
    assert brackets == target
    assert system.integrals(image) == system.integrals(state)
    assert system.divisor(image) == system.divisor(state) + step.divisor(state)
    assert system.from_divisor(system.divisor(state), like=state) == state
    with pytest.raises(NotRepresentable, match="branch point"):
        system.separated(state)


@KINDS
def test_equal_roots_of_U(kind) -> None:
    """u1 = u2: the divisor is twice a point; steps and the divisor sum hold, (u, p) is refused by name."""
    # −1 must be a square: over the reals u1 = u2 = a2 only
    K, rng = GF(509), Random(1)
    found = 0
    while found < 3:
        system = random_system(K, rng, kind)
        state = attempt(lambda system=system: random_state(system, rng))
        u, _ = coordinates.to_mumford(system.body, coordinates.to_pairs(system.body, state))
        if K.sub(K.mul(u[1], u[1]), K.mul(4, u[0])) != K.zero:
            continue
        with pytest.raises(NotRepresentable, match="u1 = u2"):
            system.separated(state)
        try:
            step = system.translation([K.random(rng), K.random(rng)], multiple=2)
            image = step(state)
        except (NotASquare, NotRepresentable, SingularCurve):
            continue
        assert system.integrals(image) == system.integrals(state)
        assert system.divisor(image) == system.divisor(state) + step.divisor(state)
        found += 1


@pytest.mark.parametrize("axis", [0, 1, 2])
@KINDS
def test_permanent_rotations(kind, axis) -> None:
    """H1/H2 = a_i, M along an axis: the curve is singular, and exact steps say so; the keyless map holds."""
    K, rng = GF(2**61 - 1), Random(2)

    def make():
        system = random_system(K, rng, kind, squares=True)
        t = K.random(rng)
        gamma, M = [K.zero] * 3, [K.zero] * 3
        scale = K.inv(K.add(K.one, K.mul(t, t)))
        gamma[(axis + 1) % 3] = K.mul(K.add(t, t), scale)
        gamma[(axis + 2) % 3] = K.mul(K.sub(K.one, K.mul(t, t)), scale)
        M[axis] = K.one
        state = system.state(gamma, M)
        return system, state, system.keyless()(state)

    system, state, image = attempt(make)
    h1, h2 = system.integrals(state)[2:]
    assert h1 == K.mul(system.a[axis], h2)
    assert system.integrals(image) == system.integrals(state)
    with pytest.raises(SingularCurve):
        system.translation([K.one, K.zero], multiple=2)(state)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("system", [ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))], ids=["ball", "top"])
def test_real_permanent_rotations_step_or_say_why_not(system, axis) -> None:
    gamma, M = [0.6, 0.6, 0.6], [0.0] * 3
    gamma[axis], gamma[(axis + 1) % 3], M[axis] = 0.0, 0.8, 1.3
    state = system.state(gamma, M)
    image = system.keyless()(state)
    assert max(abs(x - y) for x, y in zip(system.integrals(image), system.integrals(state), strict=True)) < 1e-14
    try:
        image = system.translation([0.3j, -0.3j])(state)
    except (NotASquare, NotRepresentable):
        return
    assert max(abs(x - y) for x, y in zip(system.integrals(image), system.integrals(state), strict=True)) < 1e-12


@pytest.mark.parametrize("moments", [(1, 1, 2), (2, 1, 1), (1, 2, 1), (2, 2, 2)])
@KINDS
def test_equal_moments(kind, moments) -> None:
    """Real steps work on states; what needs γ from a divisor says why it cannot."""
    system = ChaplyginBall(moments, 0.7) if kind == "ball" else EulerTop(moments)
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    steps = [system.translation([0.3j, -0.3j]), system.keyless(), system.shift(lambda h1, h2: h1 * h2 / 8)]
    for step in steps:
        image = step(state)
        assert max(abs(x - y) for x, y in zip(system.integrals(image), system.integrals(state), strict=True)) < 1e-12
    for use in (system.multiplication(3), lambda x: system.from_divisor(system.divisor(x), like=x)):
        with pytest.raises(NotRepresentable, match="equal"):
            use(state)


def test_a_body_at_rest_has_no_steps() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    state = ball.state((0.48, 0.6, 0.64), (0, 0, 0))
    for step in (ball.translation([0.3j, -0.3j]), ball.multiplication(3), ball.keyless(), ball.torsion()):
        with pytest.raises(ArgumentError, match="at rest"):
            step(state)
    top = EulerTop((1, 2, 3))
    rest = top.state((0.48, 0.6, 0.64), (0, 0, 0))
    with pytest.raises(ArgumentError, match="at rest"):
        top.conic(0, 0)(rest)
    # the flow of a body at rest is the identity
    assert ball.shift(lambda h1, h2: h1)(state).gamma == pytest.approx(state.gamma, abs=1e-15)


def test_random_unit_vectors_are_unit() -> None:
    K, rng = GF(499), Random(3)
    for _ in range(20):
        gamma = unit_vector(K, rng)
        assert K.dot(gamma, gamma) == K.one


@KINDS
def test_the_separatrix(kind) -> None:
    """H1/H2 = a2 off the permanent rotation: exact steps name the singular curve, real ones keep the integrals."""
    if kind == "top":
        # Σ(a_i − a2)M_i² = 0 for M = (√(a2 − a3), m, √(a1 − a2))
        system = EulerTop((1, 2, 3))
        a1, a2, a3 = system.a
        M = ((a2 - a3) ** 0.5, 0.7, (a1 - a2) ** 0.5)
        size = (M[0] ** 2 + M[2] ** 2) ** 0.5
        state = system.state((M[2] / size, 0, -M[0] / size), M)
        h1, h2 = system.integrals(state)[2:]
        assert abs(h1 - a2 * h2) < 1e-15
        for step in (system.translation([0.3j, -0.3j]), system.keyless(), system.shift(lambda h1, h2: h1 / 2)):
            image = step(state)
            kept = zip(system.integrals(image), system.integrals(state), strict=True)
            assert max(abs(x - y) for x, y in kept) < 1e-12
    K, rng = GF(499), Random(4)
    while True:
        exact = random_system(K, rng, kind)
        start = attempt(lambda exact=exact: random_state(exact, rng))
        h1, h2 = exact.integrals(start)[2:]
        if h1 == K.mul(exact.a[1], h2) and start.M[0] != K.zero:
            break
    with pytest.raises(SingularCurve):
        exact.translation([K.one, K.zero], multiple=2)(start)
    with pytest.raises(SingularCurve):
        exact.divisor(start)


@KINDS
def test_characteristic_three(kind) -> None:
    """In GF(3^5) the int 4 stands for another element than 1 + 1 + 1 + 1: divisors and steps are right there too."""
    K, rng = GF(3, 5, [1, 2, 0, 0, 0, 1]), Random(5)

    def make():
        system = random_system(K, rng, kind)
        state = random_state(system, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        return system, state, step, *image_brackets(system, step, state)

    system, state, step, brackets, target = attempt(make)
    assert brackets == target
    assert system.divisor(step(state)) == system.divisor(state) + step.divisor(state)
