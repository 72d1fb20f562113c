"""The free motion on the sphere, conics through plane points, the hat variables; exactly."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.deformations.isometric import Hat
from integrable.phase import sphere
from integrable.phase.brackets import canonical_matrix, image_brackets, jacobian_matrix, pushed, weighted_matrix
from integrable.phase.isometry import lift
from integrable.phase.jets import JetField, apply
from integrable.phase.separation import Separated, of_roots
from jacobian import HyperellipticCurve, NotRepresentable, poly
from jacobian.errors import ArgumentError
from tests.integrable.exact_points import (
    CYCLIC,
    attempt,
    cross,
    dot,
    over_fields,
    phase,
    random_case,
    wrapped,
)


def flat(point):
    return (*point.u, *point.p)


def pair(x):
    return Separated((x[0], x[1]), (x[2], x[3]))


def point_of(K, rng):
    """(a, (u1, u2, p1, p2)), all different."""
    values = [K.random(rng) for _ in range(7)]
    if len(set(values)) < 7 or K.zero in values:
        raise ZeroDivisionError
    return tuple(values[:3]), tuple(values[3:])


def map_case(K, seed, function):
    """(a, x, image, jacobian matrix) of function(N, a, x) on (u, p)."""
    rng = Random(seed)

    def make():
        a, x = point_of(K, rng)
        return a, x, function(K, a, x), jacobian_matrix(K, lambda N, y: function(N, a, y), x)

    return attempt(make)


def slopes(K, function, x):
    (row,) = jacobian_matrix(K, lambda N, y: (function(N, y),), x)
    return row


# --- the motion and the bracket W


@over_fields()
def test_integrals_of_the_sphere(K) -> None:
    """H1 = (M, M), H2 = −(M, AM) in (u, p) at d = 0, and y = φp on y² = φ(x)(H1x + H2)."""
    K = K()
    rng = Random(1)

    def make():
        system, state = random_case(K, rng, "top")
        return system, state, system.separated(state)

    system, state, point = attempt(make)
    h1, h2 = sphere.sphere_integrals(K, system.a, point)
    x = phase(system, state)
    assert (h1, h2) == (dot(x.M, x.M), -dot(x.M, x.AM))
    for u, p in zip(*point, strict=True):
        scale = poly.evaluate(K, sphere.phi_poly(K, system.a), u)
        y = K.mul(scale, p)
        assert K.mul(y, y) == K.mul(scale, K.add(K.mul(h1, u), h2))


@over_fields()
def test_the_flow_on_the_sphere_and_the_bracket_W(K) -> None:
    """Canonical: Σdu/y = 0, Σu du/y = 2dt; W: Σdu/y = 2dτ, X^W_H1 = X_H2 + (u1 + u2)X_H1, not g·X_H1."""
    K = K()
    a, x, _, _ = map_case(K, 2, lambda N, a, y: y)
    N = JetField(K, 0)
    first, second = (
        [N.constant(s) for s in slopes(K, lambda J, y, i=i: sphere.sphere_integrals(J, a, pair(y))[i], x)]
        for i in (0, 1)
    )
    u, p = [N.constant(y) for y in x[:2]], [N.constant(y) for y in x[2:]]
    y = [N.constant(poly.evaluate(K, sphere.phi_poly(K, a), e.value)) * q for e, q in zip(u, p, strict=True)]
    du = first[2:]
    assert du[0] / y[0] + du[1] / y[1] == 0
    assert u[0] * du[0] / y[0] + u[1] * du[1] / y[1] == 2
    assert u[0] * (du[0] / y[0]) + u[1] * (du[1] / y[1]) == 2
    in_w = [u[0] * first[2], u[1] * first[3], -u[0] * first[0], -u[1] * first[1]]
    assert in_w[0] / y[0] + in_w[1] / y[1] == 2
    canonical = [[h[2], h[3], -h[0], -h[1]] for h in (first, second)]
    assert in_w == [s + (u[0] + u[1]) * f for f, s in zip(*canonical, strict=True)]
    assert in_w[0] * canonical[0][1] != in_w[1] * canonical[0][0]


# --- conics


@over_fields()
@pytest.mark.parametrize("name", ["(0, 0)", "(x0, 0)", "(x0, y0)", "(x0, F(f/φ))", "∞"])
def test_conic_steps_preserve_their_brackets(K, name) -> None:
    """{u_i, p_j} = (u_i − x0)δ_ij for y0 = 0, constant, or F(f(x0)/φ(x0)); x0 = ∞: the canonical bracket."""
    K = K()
    x0 = {"(0, 0)": K.zero, "∞": None}.get(name, K.one)
    constant = K.zero if name in ("(0, 0)", "(x0, 0)") else poly.integer(K, 2)

    def function(N, a, x):
        y0 = constant
        if "F" in name:
            # f(x0)/φ(x0) = h1x0 + h2
            h1, h2 = sphere.sphere_integrals(N, a, pair(x))
            y0 = N.add(N.mul(h1, x0), h2)
        return flat(sphere.conic(N, a, pair(x), x0, y0))

    a, x, image, rows = map_case(K, 3, function)

    def matrix(y):
        return canonical_matrix(K) if x0 is None else weighted_matrix(K, [K.sub(e, x0) for e in y[:2]])

    assert pushed(K, rows, matrix(x)) == matrix(image)
    assert sphere.sphere_integrals(K, a, pair(image)) == sphere.sphere_integrals(K, a, pair(x))
    if constant == K.zero and "F" not in name:
        # y0 = 0 is the element of order two
        assert _same(flat(sphere.conic(K, a, pair(image), x0, K.zero)), x)


@over_fields()
@pytest.mark.parametrize("infinite", [False, True], ids=["(x0, y0)", "∞"])
def test_the_parabola_written_out(K, infinite) -> None:
    """P = V + cU, c = (y0 − V(x0))/U(x0) or a constant, Ũ = (P² − f)/(lead·U), p̃ = −P(ũ)/φ(ũ)."""
    K = K()
    rng = Random(21)

    def make():
        a, x = point_of(K, rng)
        x0, y0 = None if infinite else K.random(rng), K.random(rng)
        return a, x, x0, y0, sphere.conic(K, a, pair(x), x0, y0)

    a, x, x0, y0, image = attempt(make)
    N = JetField(K, 0)
    wrap = lambda values: tuple(map(N.constant, values))  # noqa: E731
    phi, (h1, h2) = wrap(sphere.phi_poly(K, a)), wrap(sphere.sphere_integrals(K, a, pair(x)))
    f, U, V = poly.mul(N, phi, (h2, h1)), poly.from_roots(N, wrap(x[:2])), wrap(sphere.momentum_line(K, a, pair(x)))
    c = N.constant(y0) if infinite else (N.constant(y0) - poly.evaluate(N, V, x0)) / poly.evaluate(N, U, x0)
    P = poly.add(N, V, poly.scale(N, c, U))
    if not infinite:
        assert poly.evaluate(N, P, x0) == N.constant(y0)
    square = poly.sub(N, poly.mul(N, P, P), f)
    assert len(square) == 5
    quotient, rest = poly.divide(N, square, poly.scale(N, square[4], U))
    assert rest == ()
    assert quotient == poly.from_roots(N, wrap(image.u))
    for u, p in zip(wrap(image.u), wrap(image.p), strict=True):
        assert p == -poly.evaluate(N, P, u) / poly.evaluate(N, phi, u)


@over_fields()
def test_the_walk_along_the_pencil_is_multiplicative(K) -> None:
    """The steps through (x0, y0) are the fibre G_m of modulus (x0, s) + (x0, −s), s² = f(x0): with t = (y0 −
    s)/(y0 + s) they compose by multiplication, so y0 after y0' is (y0y0' + s²)/(y0 + y0'), and y0 = 0, t = −1, is of
    order two.
    """
    K = K()
    rng = Random(22)

    def make():
        a, x = point_of(K, rng)
        h1, h2 = sphere.sphere_integrals(K, a, pair(x))
        f = poly.mul(K, sphere.phi_poly(K, a), (h2, h1))
        D = poly.from_roots(K, x[:2]), sphere.momentum_line(K, a, pair(x))
        x0, y0, y1 = (K.random(rng) for _ in range(3))
        both = K.div(K.add(K.mul(y0, y1), poly.evaluate(K, f, x0)), K.add(y0, y1))
        once = sphere.conic_sum(K, f, D, x0, y0)
        half = sphere.conic_sum(K, f, D, x0, K.zero)
        back = sphere.conic_sum(K, f, once, x0, K.neg(y0)) if y0 else None
        return D, sphere.conic_sum(K, f, once, x0, y1), sphere.conic_sum(K, f, D, x0, both), half, back, (f, x0)

    D, twice, at_once, half, back, (f, x0) = attempt(make)
    assert twice == at_once != D
    assert back == D
    assert sphere.conic_sum(K, f, half, x0, K.zero) == D


@over_fields()
def test_a_conic_step_leaves_the_class_of_the_divisor(K) -> None:
    """The class in Pic X does not move."""
    K = K()
    rng = Random(13)

    def make():
        a, x = point_of(K, rng)
        h1, h2 = sphere.sphere_integrals(K, a, pair(x))
        C = HyperellipticCurve(K, poly.mul(K, sphere.phi_poly(K, a), (h2, h1)))
        D = poly.from_roots(K, x[:2]), sphere.momentum_line(K, a, pair(x))
        # over an inert model of genus 1 the classes have no unique pair
        J = C.jacobian()
        return D, J.from_mumford(*D), J.from_mumford(*sphere.conic_sum(K, C.f, D, K.random(rng), K.random(rng)))

    _, before, after = attempt(make)
    assert before == after


def _same(x, y):
    """Equal up to the order of the two points."""
    return tuple(x) in (tuple(y), (y[1], y[0], y[3], y[2]))


@over_fields()
def test_a_conic_through_a_point_that_moves_with_another_integral_is_not_canonical(K) -> None:
    """The negative control: y0 = h1 at x0 = 1, where only functions of h1 + h2 are allowed."""
    K = K()
    one = K.one
    _, x, image, rows = map_case(
        K, 4, lambda N, a, y: flat(sphere.conic(N, a, pair(y), one, sphere.sphere_integrals(N, a, pair(y))[0]))
    )
    before, after = (weighted_matrix(K, [K.sub(e, one) for e in y[:2]]) for y in (x, image))
    assert pushed(K, rows, before) != after


@over_fields()
@pytest.mark.parametrize(
    ("size", "name"),
    [(3, name) for name in ("(x0, 0)", "(x0, y0)", "(x0, F(f/φ))", "∞", "not canonical")] + [(4, "(x0, y0)")],
)
def test_conic_steps_of_more_points(K, size, name) -> None:
    """N = 3, 4 points on y² = φ(x)(x^(N−1)h_1 + … + h_N), deg φ = N + 1: the h_j are kept, and so is the bracket except
    for y0 = h_N at x0 ≠ 0.
    """
    from jacobian.fields.factor import roots

    K = K()
    rng = Random(5)

    def image_of(N, a, x, x0, y0, values=None):
        u, p = x[:size], x[size:]
        scale = poly.scale(N, N.one, poly.from_roots(N, a))
        y = [N.mul(poly.evaluate(N, scale, e), q) for e, q in zip(u, p, strict=True)]
        h = _interpolated(N, u, [N.mul(poly.evaluate(N, scale, e), N.mul(q, q)) for e, q in zip(u, p, strict=True)])
        f = poly.mul(N, scale, h)
        if "F" in name:
            # F(z) = z² + 1 of z = f(x0)/φ(x0)
            z = poly.evaluate(N, h, x0)
            y0 = N.add(N.mul(z, z), N.one)
        elif name == "not canonical":
            y0 = h[0]
        U, V = sphere.conic_sum(N, f, (poly.from_roots(N, u), _interpolated(N, u, y)), x0, y0)
        if values is None:
            values = roots(N, U)
            if len(values) < size:
                raise NotRepresentable
        if isinstance(N, JetField):
            # one Newton step makes the roots exact to first order
            slope, values = poly.derivative(N, U), tuple(map(N.constant, values))
            values = [N.sub(e, N.div(poly.evaluate(N, U, e), poly.evaluate(N, slope, e))) for e in values]
        return (*values, *[N.div(poly.evaluate(N, V, e), poly.evaluate(N, scale, e)) for e in values]), h

    def make():
        numbers = [K.random(rng) for _ in range(3 * size + 3)]
        a, x, (x0, y0) = numbers[: size + 1], numbers[size + 1 : 3 * size + 1], numbers[-2:]
        if K.zero in (x0, y0):
            raise ZeroDivisionError
        x0, y0 = None if name == "∞" else x0, K.zero if name == "(x0, 0)" else y0
        image, h = image_of(K, a, x, x0, y0)
        rows = jacobian_matrix(K, lambda N, y: image_of(N, a, y, x0, y0, image[:size])[0], x)
        return x0, x, image, h, rows, image_of(K, a, image, x0, y0)[1]

    x0, x, image, h, rows, h_after = attempt(make)
    assert h == h_after

    def matrix(y):
        weights = [K.one if x0 is None else K.sub(e, x0) for e in y[:size]]
        zero = [K.zero] * size
        upper = [[*zero, *zero[:i], w, *zero[i + 1 :]] for i, w in enumerate(weights)]
        lower = [[*zero[:i], K.neg(w), *zero[i + 1 :], *zero] for i, w in enumerate(weights)]
        return tuple(map(tuple, upper + lower))

    assert (pushed(K, rows, matrix(x)) == matrix(image)) == (name != "not canonical")


def _interpolated(N, nodes, values):
    """The polynomial of lowest degree through (nodes, values)."""
    total = ()
    for i, (e, y) in enumerate(zip(nodes, values, strict=True)):
        part = poly.from_roots(N, [z for k, z in enumerate(nodes) if k != i])
        scale = N.div(y, poly.evaluate(N, part, e))
        total = poly.add(N, total, tuple(N.mul(scale, c) for c in part))
    return total


@over_fields()
def test_conic_steps_of_states(K) -> None:
    """On (γ, M): γ turns about M, the divisor is that of the pencil, c constant preserves the bracket of (γ, M)."""
    K = K()
    rng = Random(6)

    def make(x0):
        system, state = random_case(K, rng, "top")
        y0 = K.random(rng)
        step = system.conic(x0, y0)
        return system, state, step, y0, *image_brackets(system, step, state)

    for x0 in (None, K.zero, K.one):
        system, state, step, y0, brackets, target = attempt(lambda x0=x0: make(x0))
        image = step(state)
        assert image.M == state.M
        assert system.integrals(image) == system.integrals(state)
        assert (brackets == target) == (x0 is None)
        D, E = system.divisor(state), system.divisor(image)
        u, v = sphere.conic_sum(K, D.jacobian.curve.f, (D.u, D.v), x0, y0)
        assert (E.u, E.v) == (u, v)
    with pytest.raises(ArgumentError, match="d = 0"):
        ChaplyginBall((1, 2, 3), 0.7).conic(0, 0)
    with pytest.raises(ArgumentError, match="sign = 2"):
        EulerTop((1, 2, 3)).conic(0, 0, sign=2)


def test_a_real_conic_step_turns_gamma_about_M() -> None:
    top = EulerTop((1, 2, 3))
    state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    image = top.conic(0, 0)(state)
    assert (image.M == state.M).all()
    assert max(abs(x - y) for x, y in zip(top.integrals(image), top.integrals(state), strict=True)) < 1e-14
    # y0 = 0 is of order two on divisors
    again = top.conic(0, 0)(image)
    assert [abs(x) for x in again.gamma] == pytest.approx([abs(x) for x in state.gamma], abs=1e-14)
    other = top.conic(0, 0, sign=-1)(state)
    assert other.gamma == pytest.approx([-x for x in image.gamma], abs=1e-15)
    moving = top.conic(1, lambda h1, h2: h2 - h1)(state)
    assert max(abs(x - y) for x, y in zip(top.integrals(moving), top.integrals(state), strict=True)) < 1e-14


# --- ρ, the hat variables, the metric


@over_fields()
def test_rho(K) -> None:
    """ρ takes the canonical bracket to W, and has an inverse where u_k ≠ 0."""
    K = K()
    _, x, image, rows = map_case(K, 7, lambda N, a, y: flat(sphere.rho(N, pair(y))))
    assert pushed(K, rows, canonical_matrix(K)) == weighted_matrix(K, image[:2])
    assert flat(sphere.rho_inverse(K, pair(image))) == x
    with pytest.raises(NotRepresentable, match="u_k = 0"):
        sphere.rho_inverse(K, Separated((K.zero, K.one), (K.one, K.one)))


@over_fields()
def test_the_hat_variables(K) -> None:
    """{û_i, p̂_j} = δ_ij, p̂ = −ℓ(û)/φ(û)."""
    K = K()
    a, x, image, rows = map_case(K, 8, lambda N, a, y: flat(sphere.hat(N, a, pair(y))))
    assert pushed(K, rows, canonical_matrix(K)) == canonical_matrix(K)
    line = sphere.momentum_line(K, a, pair(x))
    for u, p in zip(image[:2], image[2:], strict=True):
        assert K.mul(p, poly.evaluate(K, sphere.phi_poly(K, a), u)) == K.neg(poly.evaluate(K, line, u))


@over_fields()
def test_the_hat_map_on_states(K) -> None:
    """γ̂ = Aw/|Aw|, M̂ = Aw × A⁻¹γ: canonical, (û, p̂) in the coordinates, the lift of A after the keyless map."""
    K = K()
    rng = Random(31)

    def make():
        system, state = random_case(K, rng, "top")
        step = system.hat_map([rng.choice((1, -1)) for _ in range(3)])
        image = step(state)
        keyless = system.keyless(step.signs)(state)
        lifted = lift(K, system.a, keyless.gamma, keyless.M)
        points = flat(system.separated(image)), flat(sphere.hat(K, system.a, system.separated(state)))
        return system, state, step, image, lifted, *image_brackets(system, step, state), points

    system, state, step, image, lifted, brackets, target, points = attempt(make)
    assert brackets == target
    assert image == system.state(image.gamma, image.M)
    assert _same(*points)
    opposite = tuple(map(K.neg, lifted[0]))
    assert (image.gamma, image.M) in (lifted, (opposite, lifted[1]))
    x = phase(system, state)
    turned = [s * a * w for s, a, w in zip(step.signs, x.a, x.w, strict=True)]
    size = x.g.field.sqrt(dot(turned, turned))
    y = phase(system, image)
    assert [size * e for e in y.gamma] == turned
    other = [s * e / a for s, e, a in zip(step.signs, x.gamma, x.a, strict=True)]
    assert cross(turned, other) == y.M


def test_the_hat_map_over_the_reals() -> None:
    top = EulerTop((1, 2, 3))
    state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    image = top.hat_map()(state)
    again = top.state(image.gamma, image.M)
    assert again == image
    # λ_k of the hat variables are ν_k
    nu = sphere.hat_eigenvalues(top.field, top.a, top.separated(state))
    hat = Hat((1, 2, 3)).integrals(state)
    assert sum(nu) == pytest.approx(hat.H, abs=1e-12)
    with pytest.raises(ArgumentError, match="d = 0"):
        ChaplyginBall((1, 2, 3), 0.7).hat_map()
    with pytest.raises(NotRepresentable, match="no image"):
        top.hat_map()(top.state((1, 0, 0), (0, 0, 0)))


def through_line(N, a, x, q):
    """(ũ, p̃): ũ the other roots of z²q − φ(x)(xh1 + h2), z = ℓ(x) the line through (u_k, φ_kp_k), p̃ = −ℓ(ũ)/φ(ũ)."""
    point = pair(x)
    line, phi = sphere.momentum_line(N, a, point), sphere.phi_poly(N, a)
    (u1, u2), (p1, p2) = point
    values = [
        N.mul(N.mul(poly.evaluate(N, phi, u), poly.evaluate(N, q, u)), N.mul(p, p)) for u, p in ((u1, p1), (u2, p2))
    ]
    h1 = N.div(N.sub(*values), N.sub(u1, u2))
    h = (N.sub(values[0], N.mul(h1, u1)), h1)
    psi = poly.sub(N, poly.mul(N, poly.mul(N, line, line), q), poly.mul(N, phi, h))
    u = poly.monic(N, poly.quotient(N, psi, poly.from_roots(N, (u1, u2))))
    return flat(of_roots(N, u, poly.neg(N, line), lambda e: poly.evaluate(N, phi, e)))


@over_fields()
@pytest.mark.parametrize("seed", [9, 10])
def test_every_quadratic_q_gives_a_canonical_map(K, seed) -> None:
    """z²q(x) = φ(x)(xh1 + h2), z = ℓ(x), is canonical for every quadratic q; q = x² is the hat map."""
    K = K()
    rng = Random(seed)

    def make():
        a, x = point_of(K, rng)
        q = tuple(K.random(rng) for _ in range(3))
        rows = jacobian_matrix(K, lambda N, y: through_line(N, a, y, tuple(map(N.constant, q))), x)
        return rows, through_line(K, a, x, (K.zero, K.zero, K.one)), flat(sphere.hat(K, a, pair(x)))

    rows, special, hat = attempt(make)
    assert pushed(K, rows, canonical_matrix(K)) == canonical_matrix(K)
    assert _same(special, hat)


@over_fields()
@pytest.mark.parametrize("kind", ["ball", "top"])
def test_q_of_degree_one_is_the_keyless_map(K, kind) -> None:
    """q = 1 − dx is Chaplygin's 2-torsion map, q = 1 its d = 0 limit."""
    K = K()
    rng = Random(14)

    def make():
        system, state = random_case(K, rng, kind, squares=True)
        point, image = system.separated(state), system.separated(system.keyless()(state))
        q = (K.one,) if kind == "top" else (K.one, K.neg(system.d))
        return flat(image), *(through_line(K, system.a, flat(point), part) for part in (q, (K.zero, *q)))

    image, found, other = attempt(make)
    assert _same(image, found)
    assert not _same(image, other)


@over_fields()
def test_the_metric_of_the_hat_flow(K) -> None:
    """Ĥ = ν1 + ν2 = Σĝ_kk p_k², and the product ν1ν2 in (u, p)."""
    K = K()
    rng = Random(11)

    def make():
        a, x = point_of(K, rng)
        return a, x, sphere.hat_eigenvalues(K, a, pair(x))

    a, x, nu = attempt(make)
    N = JetField(K, 0)
    wrap = lambda values: [N.constant(y) for y in values]  # noqa: E731
    (u1, u2, p1, p2), (n1, n2), (g1, g2) = wrap(x), wrap(nu), wrap(sphere.metric(K, a, x[:2]))
    f1, f2 = (N.constant(poly.evaluate(K, sphere.phi_poly(K, a), e)) for e in x[:2])
    e1, e2, e3 = wrap(a)
    assert n1 + n2 == g1 * p1**2 + g2 * p2**2
    linear = (u1**2 * p1 - u2**2 * p2) / (u1 - u2)
    assert n1 * n2 == f1 * f2 / (4 * e1 * e2 * e3) * linear**2 * (f1 * u1 * p1**2 - f2 * u2 * p2**2) / (u1 - u2)
    with pytest.raises(ArgumentError, match="a_i ≠ 0"):
        sphere.metric(K, (K.zero, K.one, a[2]), x[:2])


@over_fields()
def test_the_hat_pair_on_the_phase_space(K) -> None:
    """Ĥ = αm1 − (σ + ατ)m2 = −α(w, Aw) − σm2, K̂ = e3ν1ν2 = −(σξ + τζ)²(w, Aw)."""
    K = K()
    rng = Random(12)

    def make():
        system, state = random_case(K, rng, "top")
        return system, state, sphere.hat_eigenvalues(K, system.a, system.separated(state))

    system, state, nu = attempt(make)
    x = phase(system, state)
    n1, n2 = wrapped(system, nu)
    adjugate = [x.a[j] * x.a[k] for _, j, k in CYCLIC]
    det, trace = x.a[0] * adjugate[0], x.a[0] + x.a[1] + x.a[2]
    squares = [y * y for y in x.gamma]
    s, sigma = dot(x.gamma, x.A_gamma), dot(adjugate, squares)
    tau = trace - s
    alpha = sigma * sum(1 / y for y in x.a) - 2 * tau
    m1, m2 = dot(x.M, x.AM), dot(x.M, x.M)
    w = cross(x.gamma, x.M)
    wAw = dot(x.a, [y * y for y in w])
    assert n1 + n2 == alpha * m1 - (sigma + alpha * tau) * m2 == -alpha * wAw - sigma * m2
    xi = dot(x.gamma, x.AM)
    zeta = dot(x.gamma, [y * m for y, m in zip(adjugate, x.M, strict=True)])
    assert det * n1 * n2 == -((sigma * xi + tau * zeta) ** 2) * wAw


def test_functions_of_elements_with_operators() -> None:
    """``apply`` passes jets to a function that is written with operators."""
    from jacobian import GF

    K = GF(10007)
    assert apply(K, lambda x, y: x / y + 1, 6, 3) == 3
    N = JetField(K, 1)
    assert apply(N, lambda x: x * x, *N.variables([5])).slopes == (10,)
