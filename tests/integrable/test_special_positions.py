"""γ_i = 0, u1 = u2, equal moments, H1/H2 at its extremes and at a2, thin and heavy bodies: right, or a named error."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.oracles.reference import taylor
from integrable.phase import coordinates
from integrable.phase.body import cross
from integrable.phase.brackets import image_brackets
from jacobian import GF, RR, NotASquare, NotRepresentable
from jacobian.errors import ArgumentError, SingularCurve
from tests.integrable.deformed_systems import SYSTEMS, OverJets
from tests.integrable.exact_points import attempt, over_fields, random_system
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
    """Steps, the bracket and the divisor are regular at γ_i = 0; (u, p) is refused: u_k = a_i is a branch point."""
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
    """u1 = u2: the divisor is twice a point; steps agree with sums of divisors, and (u, p) is refused by name."""
    # a field in which −1 is a square: over the reals only u1 = u2 = a2 is possible
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
    """H1/H2 = a_i, M along an axis: exact steps report that the curve is singular; the keyless map still exists."""
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
    """Real steps of states exist; γ cannot be computed from a divisor, and the error says why."""
    system = ChaplyginBall(moments, 0.7) if kind == "ball" else EulerTop(moments)
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    steps = [system.translation([0.3j, -0.3j]), system.keyless(), system.shift(lambda h1, h2: h1 * h2 / 8)]
    for step in steps:
        image = step(state)
        assert max(abs(x - y) for x, y in zip(system.integrals(image), system.integrals(state), strict=True)) < 1e-12
    for use in (lambda _: system.multiplication(3), lambda x: system.from_divisor(system.divisor(x), like=x)):
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


def test_the_separatrix_of_a_real_ball() -> None:
    """H1/H2 = a2 at d ≠ 0: steps keep the integrals, and the flow agrees with the equations of motion."""
    ball, gamma = ChaplyginBall((1, 2, 3), 0.7), (0.48, 0.6, 0.64)
    e, f = (0.8, 0.0, -0.6), (-0.36, 0.8, -0.48)

    def height(M):
        h1, h2 = ball.body.integrals(gamma, M)[2:]
        return h1 - ball.a[1] * h2

    A, B, both = height(e), height(f), height([x + y for x, y in zip(e, f, strict=True)])
    mixed = (both - A - B) / 2
    # the zeros of the quadratic form on the plane orthogonal to γ
    slope = -(mixed + (mixed * mixed - A * B) ** 0.5) / B
    state = ball.state(gamma, [x + slope * y for x, y in zip(e, f, strict=True)])
    h1, h2 = ball.integrals(state)[2:]
    assert abs(h1 - ball.a[1] * h2) < 1e-15
    for step in (
        ball.translation([0.3j, -0.3j]),
        ball.translation([1.8, 2.5]),
        ball.keyless(),
        ball.torsion(),
        ball.shift(lambda h1, h2: h1 / 2),
    ):
        image = step(state)
        assert max(abs(x - y) for x, y in zip(ball.integrals(image), ball.integrals(state), strict=True)) < 1e-12
        assert max(abs(x - y) for x, y in zip(image.gamma, gamma, strict=True)) > 1e-3
    times = [2.0, -1.0, 0.0]
    run, truth = ball.flow(state).at(times), taylor(ball, state, times, digits=20)
    assert np.abs(run.gamma - truth.gamma.astype(float)).max() < 1e-12
    assert np.abs(run.M - truth.M.astype(float)).max() < 1e-12


@pytest.mark.parametrize("small", [1e-3, 1e-8, 1e-12])
def test_the_limit_of_d(small) -> None:
    """As d → 1/max a_i, a moment goes to 0 and 1/d to a branch point; steps keep the integrals, and in the limit there
    is no body.

    The addition of (1/d, 0) loses the digits of 1 − da_i; its closed form, :meth:`System.keyless`, does not.
    """
    ball = ChaplyginBall((small, 1, 2), 0.7)
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    steps = [ball.translation([0.3j, -0.3j]), ball.translation([1.8, 2.5]), ball.keyless()]
    for step in (*steps, ball.shift(lambda h1, h2: h1 / 2)):
        image = step(state)
        assert max(abs(x - y) for x, y in zip(ball.integrals(image), ball.integrals(state), strict=True)) < 1e-11
        assert max(abs(x - y) for x, y in zip(image.gamma, state.gamma, strict=True)) > 1e-3
    image = ball.torsion()(state)
    loss = RR.eps / min(ball.body.contact)
    assert max(abs(x - y) for x, y in zip(ball.integrals(image), ball.integrals(state), strict=True)) < 10 * loss
    for moment, field in ((0, RR), (-small, RR), (0, GF(2**61 - 1))):
        with pytest.raises(ArgumentError, match=r"inertia\[0\]"):
            ChaplyginBall((moment, 1, 2), 1 if field.exact else 0.7, field=field)


@pytest.mark.parametrize("field", [RR, GF(2**61 - 1), GF(7, 3, [4, 0, 6, 1])], ids=str)
def test_d_zero_is_the_top(field) -> None:
    """A ball with d = 0 has the top's states, divisors, brackets, steps and flow."""
    ball, top = ChaplyginBall((1, 2, 4), 0, field=field), EulerTop((1, 2, 4), field=field)
    if field.exact:
        rng = Random(6)
        state = random_state(top, rng)
        steps = [lambda s: s.translation([3, 5], multiple=2), lambda s: s.multiplication(3)]
    else:
        state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
        steps = [lambda s: s.translation([0.3j, -0.3j]), lambda s: s.keyless(), lambda s: s.conic(0, 0)]
        assert (ball.flow(state).at([2.0]).gamma == top.flow(state).at([2.0]).gamma).all()
    assert ball.state(state.gamma, state.M) == state
    assert ball.divisor(state) == top.divisor(state)
    assert ball.poisson(state) == top.poisson(state)
    assert ball.vector_field(state) == top.vector_field(state)
    for make in steps:
        assert _outcome(make(ball), state) == _outcome(make(top), state)


def _outcome(step, state):
    try:
        return step(state)
    except (NotASquare, NotRepresentable, SingularCurve) as error:
        return type(error)


# --- deformations


GEODESIC = [name for name in SYSTEMS if "potential" not in name]


@over_fields()
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("name", GEODESIC)
def test_deformations_at_a_vanishing_gamma(K, name, axis) -> None:
    """γ_i = 0: H and K commute and the equations of motion are g{x, H/2} there too."""
    system, rng = SYSTEMS[name](K()), Random(axis)
    K = system.field
    state = state_without(system.rigid, axis, rng)
    jets = OverJets(system, state)
    H, second = jets.pair()
    assert (H.value, second.value) == system.integrals(state)[2:]
    assert jets.bracket(H, second) == K.zero
    half = K.div(K.one if state.g is None else state.g, K.add(K.one, K.one))
    rate = system.vector_field(state)
    assert (*rate.gamma, *rate.M) == tuple(K.mul(half, x) for x in jets.field_of(H))


@over_fields()
@pytest.mark.parametrize("name", [name for name in SYSTEMS if "potential" in name])
def test_poles_at_a_vanishing_gamma_are_refused_by_name(K, name) -> None:
    system = SYSTEMS[name](K())
    state = state_without(system.rigid, 1, Random(7))
    for use in (system.integrals, system.vector_field):
        with pytest.raises(NotRepresentable, match="infinite"):
            use(state)


@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
def test_equal_abscissas_of_a_deformation(name) -> None:
    """ũ1 = ũ2: the integrals commute, and the two points are refused by name."""
    system, rng, found = SYSTEMS[name](GF(61)), Random(8), 0
    K = system.field
    while found < 2:
        state = random_state(system.rigid, rng)
        w = cross(K, state.gamma, state.M)
        squares = [K.mul(x, x) for x in w]
        h2, total = (
            K.dot(squares, (1, 1, 1)),
            K.dot(squares, [K.add(system.a[i - 2], system.a[i - 1]) for i in range(3)]),
        )
        product = K.dot(squares, [K.mul(system.a[i - 2], system.a[i - 1]) for i in range(3)])
        if K.mul(total, total) != K.mul(4, K.mul(h2, product)):
            continue
        with pytest.raises(NotRepresentable, match="ũ1 = ũ2"):
            system.divisor(state)
        jets = OverJets(system, state)
        assert jets.bracket(*jets.pair()) == K.zero
        found += 1


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("name", ["tilde", "tilde, d", "check", "hat"])
def test_permanent_rotations_of_a_deformation(name, axis) -> None:
    """M along an axis, H1/H2 = a_i: K = 0 and a curve degenerates: points and steps report it; the bracket holds."""
    system = SYSTEMS[name](GF(2**61 - 1))
    K, rng = system.field, Random(axis)
    gamma = state_without(system.rigid, axis, rng)
    M = [K.zero] * 3
    M[axis] = 3
    state = system.state(gamma.gamma, M, gamma.g)
    assert K.zero == system.integrals(state).K
    jets = OverJets(system, state)
    assert jets.bracket(*jets.pair()) == K.zero
    for use in (system.divisor, system.translation((3, 5))):
        with pytest.raises((NotRepresentable, NotASquare), match=r"λ = 0|conjugate|no square root"):
            use(state)


@KINDS
def test_characteristic_three(kind) -> None:
    """In GF(3^5) the int 4 is not the element 1 + 1 + 1 + 1; divisors and steps are right there too."""
    K, rng = GF(3, 5, [1, 2, 0, 0, 0, 1]), Random(5)

    def make():
        system = random_system(K, rng, kind)
        state = random_state(system, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        return system, state, step, *image_brackets(system, step, state)

    system, state, step, brackets, target = attempt(make)
    assert brackets == target
    assert system.divisor(step(state)) == system.divisor(state) + step.divisor(state)
