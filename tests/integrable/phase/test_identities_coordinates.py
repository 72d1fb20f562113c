"""(γ, M) ↔ (Γ, n) ↔ (U, V) ↔ (u, p) ↔ q, exactly over finite fields."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase import coordinates, separation
from integrable.phase.brackets import bracket, canonical_matrix, differential, pushed
from integrable.phase.jets import JetField
from integrable.phase.separation import Separated
from integrable.phase.state import State
from jacobian import GF, MP, RR, NotASquare, NotRepresentable, poly
from jacobian.errors import ArgumentError
from tests.integrable.exact_points import (
    CYCLIC,
    attempt,
    dot,
    evaluate,
    over_fields,
    phase,
    random_case,
    random_system,
    wrapped,
)
from tests.integrable.exact_states import random_state
from tests.integrable.steps.equations_of_pairs import pair_rates

KINDS = pytest.mark.parametrize("kind", ["ball", "top"])
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))


def separated_case(K, seed, kind="ball"):
    """(system, state, (u, p)) with u1, u2 in the field."""
    rng = Random(seed)

    def make():
        system, state = random_case(K, rng, kind)
        return system, state, system.separated(state)

    return attempt(make)


def mumford(system, state):
    """(U, V, point) with operators, U and V as sums over the axes."""
    x = phase(system, state)
    lean = 2 * x.g * x.d * dot(x.A_gamma, x.w)
    u, v = [0, 0, 0], [0, 0, 0]
    for i, j, k in CYCLIC:
        for n, coefficient in enumerate((x.a[j] * x.a[k], -x.a[j] - x.a[k], 1)):
            u[n] += x.G * x.A[i] * x.gamma[i] ** 2 * coefficient
            v[n] += 2 * x.g * x.A[i] * x.gamma[i] * x.w[i] * coefficient
    return u, [b + lean * a for a, b in zip(u, v, strict=True)], x


# --- the coordinates (u, p) and q


@over_fields()
@KINDS
def test_the_three_coordinate_systems_lead_back(K, kind) -> None:
    """(γ, M) → (u, p) → (q, p_q) and back, for each of the eight lifts."""
    system, state, point = separated_case(K(), 1, kind)
    for lift in system.lifts(state):
        assert system.separated(lift) == point
        assert system.from_separated(*point, like=lift) == lift
    assert len(set(system.lifts(state))) == 8
    assert system.integrals(system.from_separated(*point))[2:] == system.integrals(state)[2:]
    assert separation.integrals(system.body, point) == system.integrals(state)[2:]
    if kind == "ball":
        q = separation.to_chaplygin(system.body, point)
        assert separation.from_chaplygin(system.body, q) == point


@over_fields()
def test_chaplygins_q(K) -> None:
    """q are the roots of Σγ_i²/(x − e_i), e_i = d/I_i; u = q/(d(q + 1)); (q, p_q) is canonical."""
    K = K()
    system, state, point = separated_case(K, 2)
    x = phase(system, state)
    q, u = (wrapped(system, v.u) for v in (separation.to_chaplygin(system.body, point), point))
    e = [x.d / moment for moment in wrapped(system, system.inertia)]
    for value, root in zip(q, u, strict=True):
        assert sum(y * y / (value - z) for y, z in zip(x.gamma, e, strict=True)) == 0
        assert root == value / (x.d * (value + 1))
    rows = differential(system, lambda s, y: _flat(separation.to_chaplygin(s.body, s.separated(y))), state)
    assert pushed(K, rows, system.poisson(state)) == canonical_matrix(K)


def _flat(point):
    return (*point.u, *point.p)


@over_fields()
@KINDS
def test_u_and_the_formulas_for_gamma_and_M(K, kind) -> None:
    """u are the roots of Σγ_i²(1 − da_i)/(x − a_i); g², γ_i² and M_i in terms of (u, p)."""
    system, state, point = separated_case(K(), 3, kind)
    x = phase(system, state)
    (u1, u2), (p1, p2) = wrapped(system, point.u), wrapped(system, point.p)
    for u in (u1, u2):
        assert sum(x.gamma[i] ** 2 * x.A[i] / (u - x.a[i]) for i in range(3)) == 0
    below = (1 - x.d * u1) * (1 - x.d * u2)
    assert below / (x.A[0] * x.A[1] * x.A[2]) == x.G
    for i, j, k in CYCLIC:
        assert x.gamma[i] ** 2 == x.A[j] * x.A[k] / below * (u1 - x.a[i]) * (u2 - x.a[i]) / x.c[i]
        bulk = (x.a[i] - u1) * (1 - x.d * u1) * p1 - (x.a[i] - u2) * (1 - x.d * u2) * p2
        assert x.M[i] == 2 * x.gamma[j] * x.gamma[k] * (x.a[j] - x.a[k]) * x.g / (u1 - u2) * bulk


@over_fields()
@KINDS
def test_u_and_p_are_canonical(K, kind) -> None:
    """{u_i, p_j} = δ_ij, {u1, u2} = {p1, p2} = 0."""
    K = K()
    system, state, _ = separated_case(K, 4, kind)
    rows = differential(system, lambda s, y: _flat(s.separated(y)), state)
    assert pushed(K, rows, system.poisson(state)) == canonical_matrix(K)


@over_fields()
@KINDS
def test_the_curve(K, kind) -> None:
    """y_k = φ(u_k)p_k on y² = 4(1 − dx)Π(a_i − x)(x h2 − h1): degree 5, leading 4dh2; d = 0: 4 and −4h2."""
    system, state, point = separated_case(K(), 5, kind)
    x = phase(system, state)
    h1, h2 = x.H
    f = wrapped(system, system.body.polynomial(h1.value, h2.value))
    assert (len(f), f[-1]) == ((6, 4 * x.d * h2) if kind == "ball" else (5, -4 * h2))
    for u, p in zip(wrapped(system, point.u), wrapped(system, point.p), strict=True):
        product = (x.a[0] - u) * (x.a[1] - u) * (x.a[2] - u)
        y = 4 * (x.d * u - 1) * product * p
        assert y * y == evaluate(f, u) == 4 * (1 - x.d * u) * product * (u * h2 - h1)
    curve = system.curve(h1.value, h2.value)
    assert curve.genus == (2 if kind == "ball" else 1)
    assert (curve.model == "ramified") == (kind == "ball")


@over_fields()
@KINDS
def test_momenta_as_functions_of_the_integrals(K, kind) -> None:
    """∂p/∂h1 = 1/(2y), ∂p/∂h2 = −u/(2y) at fixed u."""
    K = K()
    system, state, point = separated_case(K, 6, kind)
    h = system.integrals(state)[2:]
    for u, p in zip(*point, strict=True):
        scale = separation.phi(system.body, u)
        y = K.mul(scale, p)
        N = JetField(K, 2)
        f = poly.evaluate(N, _over(system, N).polynomial(*N.variables(h)), u)
        slopes = N.div(N.sqrt(f, y), scale).slopes
        half = K.inv(K.add(y, y))
        assert slopes == (half, K.neg(K.mul(u, half)))


def _over(system, N):
    from integrable.phase.brackets import over

    return over(system, N).body


@over_fields()
@KINDS
def test_quadratures(K, kind) -> None:
    """du1/dτ = −u2y1/(u1 − u2), du2/dτ = −u1y2/(u2 − u1); Σdu/y = dτ, Σu du/y = 0."""
    K = K()
    system, state, point = separated_case(K, 7, kind)
    x = phase(system, state)
    rate = system.vector_field(state)
    rows = differential(system, lambda s, y: s.separated(y).u, state)
    du1, du2 = (y / x.g for y in wrapped(system, [K.dot(row, (*rate.gamma, *rate.M)) for row in rows]))
    u1, u2 = wrapped(system, point.u)
    y1, y2 = wrapped(system, [K.mul(separation.phi(system.body, u), p) for u, p in zip(*point, strict=True)])
    assert du1 == -u2 * y1 / (u1 - u2)
    assert du2 == -u1 * y2 / (u2 - u1)
    assert du1 / y1 + du2 / y2 == 1
    assert u1 * du1 / y1 + u2 * du2 / y2 == 0


@over_fields()
@KINDS
def test_the_flow_of_H2_moves_U_by_V(K, kind) -> None:
    """dU/ds = V for the flow of H2/2."""
    K = K()
    system, state = attempt(lambda: random_case(K, Random(8), kind))
    _, v = coordinates.to_mumford(system.body, coordinates.to_pairs(system.body, state))
    for k in (0, 1):
        speed = bracket(system, lambda s, y, k=k: _mumford(s, y)[0][k], lambda s, y: s.integrals(y).H2, state)
        assert K.mul(K.inv(poly.integer(K, 2)), speed) == (v[k] if k < len(v) else K.zero)


def _mumford(system, state):
    return coordinates.to_mumford(system.body, coordinates.to_pairs(system.body, state))


@over_fields()
def test_the_q_form_of_the_quadratures(K) -> None:
    """q̇_k² = 4q_l²Π(e_i − q_k)(h2q_k − dh1(1 + q_k))/(d²(1 + q_l)(q_k − q_l)²), in the time t."""
    K = K()
    system, state, point = separated_case(K, 9)
    x = phase(system, state)
    h1, h2 = x.H
    rate = system.vector_field(state)
    rows = differential(system, lambda s, y: separation.to_chaplygin(s.body, s.separated(y)).u, state)
    speed = wrapped(system, [K.dot(row, (*rate.gamma, *rate.M)) for row in rows])
    q = wrapped(system, separation.to_chaplygin(system.body, point).u)
    e = [x.d / moment for moment in wrapped(system, system.inertia)]
    for k, m in ((0, 1), (1, 0)):
        product = (e[0] - q[k]) * (e[1] - q[k]) * (e[2] - q[k]) * (h2 * q[k] - x.d * h1 * (1 + q[k]))
        assert speed[k] ** 2 == 4 * q[m] ** 2 * product / (x.d**2 * (1 + q[m]) * (q[k] - q[m]) ** 2)


def test_ovals() -> None:
    """A real u1 lies in [a1, min(ζ, a2)], u2 in [max(ζ, a2), a3], and f > 0 beyond 1/d."""
    ball, rng = ChaplyginBall((3, 2, 1), 0.7), Random(10)
    a1, a2, a3 = ball.a
    for _ in range(50):
        gamma = [rng.gauss(0, 1) for _ in range(3)]
        size = sum(x * x for x in gamma) ** 0.5
        gamma = [x / size for x in gamma]
        M = [rng.gauss(0, 1) for _ in range(3)]
        tilt = sum(x * m for x, m in zip(gamma, M, strict=True))
        state = ball.state(gamma, [m - tilt * x for x, m in zip(gamma, M, strict=True)])
        h1, h2 = ball.integrals(state)[2:]
        u1, u2 = ball.separated(state).u
        assert a1 <= u1 <= min(h1 / h2, a2)
        assert max(h1 / h2, a2) <= u2 <= a3
        assert poly.evaluate(RR, ball.body.polynomial(h1, h2), 1 / 0.7 + rng.random()) > 0


# --- the pair (U, V)


@over_fields()
@KINDS
def test_mumford_coordinates(K, kind) -> None:
    """U monic with roots u_k, V of degree 1 with V(u_k) = y_k, U | f − V²."""
    system, state, point = separated_case(K(), 11, kind)
    u, v, x = mumford(system, state)
    assert (u[2], v[2]) == (1, 0)
    assert _mumford(system, state) == (
        tuple(y.value for y in u),
        poly.trim(system.field, [y.value for y in v[:2]]),
    )
    h1, h2 = x.H
    for root, p in zip(wrapped(system, point.u), wrapped(system, point.p), strict=True):
        assert evaluate(u, root) == 0
        assert evaluate(v, root) == 4 * (x.d * root - 1) * _product(x, root) * p
        y = evaluate(v, root)
        assert y * y == 4 * (1 - x.d * root) * _product(x, root) * (root * h2 - h1)


def _product(x, root):
    return (x.a[0] - root) * (x.a[1] - root) * (x.a[2] - root)


@over_fields()
@KINDS
def test_the_adapter_inverted(K, kind) -> None:
    """g², γ_i² and M_i from (U, V)."""
    system, state = attempt(lambda: random_case(K(), Random(12), kind))
    u, v, x = mumford(system, state)
    if kind == "ball":
        assert x.d**2 * evaluate(u, 1 / x.d) / (x.A[0] * x.A[1] * x.A[2]) == x.G
    assert sum(evaluate(u, x.a[i]) / (x.c[i] * x.A[i]) for i in range(3)) == x.G
    for i, j, k in CYCLIC:
        assert x.gamma[i] ** 2 == evaluate(u, x.a[i]) / (x.G * x.A[i] * x.c[i])
        ratio = [evaluate(v, x.a[m]) / evaluate(u, x.a[m]) for m in (j, k)]
        assert 2 * x.M[i] == x.g * x.gamma[j] * x.gamma[k] * (ratio[0] - ratio[1])


@over_fields()
def test_eight_lifts(K) -> None:
    """(s_iγ_i, s_js_kM_i) have one (U, V), and (−γ, M) is among them."""
    system, state = attempt(lambda: random_case(K(), Random(13)))
    lifts = system.lifts(state)
    assert len({_mumford(system, lift) for lift in lifts}) == 1
    assert State(tuple(map(system.field.neg, state.gamma)), state.M, state.g) in lifts


@over_fields()
@KINDS
def test_regular_coordinates(K, kind) -> None:
    """Γ_i = g r_i γ_i, n_i = 2r_iw_i + λΓ_i: |Γ| = 1, (Γ, n) = 0, U and V as sums, and the way back."""
    K = K()
    rng = Random(14)
    system = random_system(K, rng, kind, squares=True)
    state = random_state(system, rng)
    u, v, x = mumford(system, state)
    r = wrapped(system, [K.sqrt(c) for c in system.body.contact])
    lean = 2 * x.g * x.d * dot(x.A_gamma, x.w)
    Gamma = [x.g * s * y for s, y in zip(r, x.gamma, strict=True)]
    n = [2 * s * y + lean * z for s, y, z in zip(r, x.w, Gamma, strict=True)]
    assert (dot(Gamma, Gamma), dot(Gamma, n)) == (1, 0)
    z = x.g.field.random(rng)
    parts = [(z - x.a[j]) * (z - x.a[k]) for _, j, k in CYCLIC]
    assert evaluate(u, z) == sum(y * y * q for y, q in zip(Gamma, parts, strict=True))
    assert evaluate(v, z) == sum(y * m * q for y, m, q in zip(Gamma, n, parts, strict=True))
    assert sum(y * y / (s * s) for y, s in zip(Gamma, r, strict=True)) == x.G
    assert lean == sum(y * m / (s * s) for y, m, s in zip(Gamma, n, r, strict=True)) / x.G
    w = [(m - lean * y) / (2 * s) for y, m, s in zip(Gamma, n, r, strict=True)]
    assert tuple(w[j] * x.gamma[k] - w[k] * x.gamma[j] for _, j, k in CYCLIC) == x.M
    pairs = coordinates.to_pairs(system.body, state)
    assert [(y / s, m / s) for y, m, s in zip(Gamma, n, r, strict=True)] == [wrapped(system, q) for q in pairs[:3]]
    assert coordinates.from_pairs(system.body, pairs) == state


@over_fields()
@KINDS
def test_the_rates_of_the_pairs_are_hamiltonian(K, kind) -> None:
    """The rates with which time shifts are compared: d(σ, ν)/ds = {(σ, ν), F} for (2F_1, −2F_2) = (first, −second)."""
    K = K()
    system, state = attempt(lambda: random_case(K, Random(15), kind))
    N = JetField(K, 0)
    pairs = coordinates.to_pairs(system.body, state)
    h1, h2 = system.integrals(state)[2:]
    f = tuple(map(N.constant, system.body.polynomial(h1, h2)))
    y = [N.constant(z) for pair in pairs[:3] for z in pair]
    first, second = N.integer(3), N.integer(5)
    rates = [r.value for r in pair_rates(_over(system, N), f, y, first, second)]
    rows = differential(
        system,
        lambda s, q: (*_flat_pairs(s, q), *s.integrals(q)[2:]),
        state,
    )
    brackets = pushed(K, rows, system.poisson(state))
    half = K.inv(poly.integer(K, 2))
    weights = [K.mul(half, poly.integer(K, m)) for m in (3, 5)]
    assert rates == [K.dot(weights, row[6:]) for row in brackets[:6]]


def _flat_pairs(system, state):
    return [z for pair in coordinates.to_pairs(system.body, state)[:3] for z in pair]


# --- special positions and wrong arguments


def test_special_positions_of_the_separated_coordinates() -> None:
    """In (u, p), γ_i = 0 and u1 = u2 raise errors that name them, as do conjugate u; for divisors they are regular."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    K = GF(10007)
    exact = EulerTop((1, 2, 3), field=K)
    state = exact.state((0, K.div(3, 5), K.div(4, 5)), (1, 4, K.neg(3)))
    with pytest.raises(NotRepresentable, match="branch point"):
        exact.separated(state)
    assert len(ball.divisor(ball.state((0, 0.6, 0.8), (1, 0.8, -0.6))).u) == 3
    with pytest.raises(NotRepresentable, match="u1 = u2"):
        ball.from_separated((0.5, 0.5), (1, 2))
    with pytest.raises(NotASquare, match="no square root in RR"):
        ball.from_separated((0.1, 0.2), (1, 2))
    with pytest.raises(ArgumentError, match="d = 0"):
        separation.to_chaplygin(EulerTop((1, 2, 3)).body, Separated((0.1, 0.2), (1.0, 2.0)))


def test_conjugate_u_are_refused_by_name() -> None:
    K, rng = GF(10007), Random(16)
    ball = ChaplyginBall((1, 2, 4), 1, field=K)
    refused = 0
    for _ in range(20):
        state = random_state(ball, rng)
        u, _ = _mumford(ball, state)
        if not K.is_square(K.sub(K.mul(u[1], u[1]), K.mul(4, u[0]))):
            refused += 1
            with pytest.raises(NotASquare, match="conjugate; use the divisor"):
                ball.separated(state)
    assert 3 < refused < 17


@pytest.mark.parametrize("moments", [(1, 1, 2), (2, 2, 2)])
def test_equal_moments_have_pairs_but_no_way_back_from_u(moments) -> None:
    ball = ChaplyginBall(moments, 0.7)
    state = ball.state(*START)
    image = ball.translation([0.3j, -0.3j])(state)
    assert max(abs(x - y) for x, y in zip(ball.integrals(image), ball.integrals(state), strict=True)) < 1e-12
    with pytest.raises(NotRepresentable):
        ball.from_separated(*ball.separated(state))


def test_real_round_trips_from_thin_to_heavy_bodies() -> None:
    """d = 0, and d → large, where 1 − da_i = I_i/(I_i + d) → 0."""
    K = MP(40)
    for d in ("0", "1e-9", "0.7", "1e3", "1e6"):
        ball = ChaplyginBall((1, 2, 3), d, field=K)
        state = ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
        back = ball.from_separated(*ball.separated(state), like=state)
        for x, y in zip((*back.gamma, *back.M), (*state.gamma, *state.M), strict=True):
            # u_k − a_i is as small as 1 − da_i, and loses digits by cancellation
            assert abs(x - y) < 1e-38 * max(1, float(d)) ** 3


@pytest.mark.parametrize("field", [RR, MP(40)], ids=["floats", "40 digits"])
@pytest.mark.parametrize("kind", ["ball", "top"])
def test_the_map_back_on_bare_reals_is_that_over_fields(kind, field) -> None:
    """γ and M/|M| from σ = γ̂ and ν = n̂/(2|M|), the arguments of compiled loops, compared with ``from_pairs``."""
    system = ChaplyginBall((1, 2, 3), 0.7, field=field) if kind == "ball" else EulerTop((1, 2, 3), field=field)
    gamma, M = ([field.coerce(x) for x in v] for v in (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")))
    pairs = coordinates.to_pairs(system.body, State(tuple(gamma), tuple(M)))
    spin = field.sqrt(field.dot(M, M))
    sigma, nu = zip(*pairs, strict=True)
    found = coordinates.directions_of((0, 0, 0, 0, *sigma, *(y / (2 * spin) for y in nu)))
    back = coordinates.from_pairs(system.body, pairs)
    for here, there, given in zip(
        found, (back.gamma, [m / spin for m in back.M]), (gamma, [m / spin for m in M]), strict=True
    ):
        for x, y, z in zip(here, there, given, strict=True):
            assert abs(x - y) < 4 * field.eps
            assert abs(x - z) < 8 * field.eps
