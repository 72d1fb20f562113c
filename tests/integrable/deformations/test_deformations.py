"""Tilde, check, hat and gyroscopic pairs: involution and equations of motion exactly, conservation along the motion."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.deformations.gyroscopic import Gyroscopic
from integrable.deformations.isometric import Check, Hat
from integrable.deformations.tilde import Tilde
from integrable.phase.body import cross
from integrable.phase.brackets import ball_matrix, canonical_matrix, jacobi_defects, jacobian_matrix, pushed
from integrable.phase.isometry import lift, roots
from integrable.phase.recursion import (
    eigenvalues,
    nijenhuis_torsion,
    rank,
    recursion_operator,
    second_bracket,
    trace_hamiltonian,
)
from integrable.phase.state import State
from jacobian import GF, MP, QQ, HyperellipticCurve, NotASquare, NotRepresentable, PrecisionLoss, poly
from jacobian.errors import ArgumentError, FieldError
from tests.integrable.deformations.extrapolation import extrapolate
from tests.integrable.deformed_systems import SYSTEMS, OverJets
from tests.integrable.exact_states import random_state, until_defined

FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(7^3)": lambda: GF(7, 3)}
START = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))


def every_system():
    return pytest.mark.parametrize(
        ("make", "field"),
        [pytest.param(s, f, id=f"{name} over {field}") for name, s in SYSTEMS.items() for field, f in FIELDS.items()],
    )


def states(system, count, seed):
    """States where the Hamiltonian is finite."""
    rng, found = Random(seed), []
    while len(found) < count:
        try:
            state = random_state(system.rigid, rng)
            system.integrals(state)
        except (ZeroDivisionError, NotRepresentable):
            continue
        found.append(state)
    return found


@every_system()
def test_the_integrals_are_in_involution(make, field) -> None:
    system = make(field())
    for state in states(system, 5, 1):
        jets = OverJets(system, state)
        H, K = jets.pair()
        assert jets.bracket(H, K) == 0
        assert (H.value, K.value) == system.integrals(state)[2:]


@every_system()
def test_the_equations_of_motion_are_the_bracket_with_half_the_hamiltonian(make, field) -> None:
    """ẋ = g{x, H/2}, residual 0: the closed forms of Ω and Ṁ and the gradient of the potential."""
    system = make(field())
    K = system.field
    for state in states(system, 5, 2):
        jets = OverJets(system, state)
        g = K.one if state.g is None else state.g
        half = K.div(g, K.add(K.one, K.one))
        rate = system.vector_field(state)
        assert (*rate.gamma, *rate.M) == tuple(K.mul(half, x) for x in jets.field_of(jets.pair()[0]))


def test_without_the_condition_on_gamma_M_the_tilde_pair_is_not_in_involution() -> None:
    """{H̃, K̃} ≠ 0 at (γ, M) ≠ 0."""
    system = SYSTEMS["tilde, d"](GF(2**61 - 1))
    state = states(system, 1, 3)[0]
    tilted = system.rigid.state(state.gamma, (state.M[0], state.M[1], 12345), state.g, tilted=True)
    jets = OverJets(system, tilted)
    assert jets.bracket(*jets.pair()) != 0


# --- the tilde pair and the 2-torsion map


@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
def test_the_tilde_pair_is_made_of_the_eigenvalues(name) -> None:
    """H̃ = λ1 + λ2 and K̃ = −λ1λ2, λ_k = H1 − ũ_kH2, ũ_k the roots of Σ w_i²(x − a_j)(x − a_k)."""
    system = SYSTEMS[name](GF(2**61 - 1))
    K = system.field
    for state in states(system, 5, 4):
        h1, h2 = system.rigid.integrals(state)[2:]
        w = [
            K.sub(K.mul(state.gamma[i - 2], state.M[i - 1]), K.mul(state.gamma[i - 1], state.M[i - 2]))
            for i in range(3)
        ]
        squares = [K.mul(x, x) for x in w]
        total = K.dot(squares, [K.add(system.a[i - 2], system.a[i - 1]) for i in range(3)])
        product = K.dot(squares, [K.mul(system.a[i - 2], system.a[i - 1]) for i in range(3)])
        _, _, H, second = system.integrals(state)
        assert K.sub(K.mul(2, h1), total) == H  # ΣũH2 = Σw_i²(a_j + a_k)
        assert K.neg(second) == K.add(K.sub(K.mul(h1, h1), K.mul(h1, total)), K.mul(h2, product))


def test_the_image_of_a_state_has_these_abscissas() -> None:
    """The torsion map itself gives Ũ = Σ (w_i²/H2)(x − a_j)(x − a_k)."""
    K, rng = GF(10007), Random(5)

    def attempt():
        # √(a_i − 1/d) must be in the field
        ball = ChaplyginBall((1, 2, 4), rng.randrange(1, 10000), field=K)
        state = random_state(ball, rng)
        return ball, state, ball.torsion()(state)

    ball, state, image = until_defined(attempt, 2000)
    w = [K.sub(K.mul(state.gamma[i - 2], state.M[i - 1]), K.mul(state.gamma[i - 1], state.M[i - 2])) for i in range(3)]
    h2 = ball.integrals(state).H2
    total = K.dot([K.mul(x, x) for x in w], [K.add(ball.a[i - 2], ball.a[i - 1]) for i in range(3)])
    assert ball.divisor(image).u[1] == K.neg(K.div(total, h2))


# --- the recursion operator


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("d", [0, 1])
def test_the_second_bracket_the_lenard_chain_and_the_torsion(field, d) -> None:
    """Π' = {u_i, p_j} = λ_iδ_ij is Poisson; Π'dJ_m = ΠdJ_{m+1} for J_m = tr N^m/(2m); the torsion of N is 0."""
    K, rng = FIELDS[field](), Random(6)
    body = ChaplyginBall((1, 2, 4), d, field=K).body
    point = tuple(K.random(rng) for _ in range(4))

    def moved(over):
        return replace(body, field=over)

    assert set(jacobi_defects(K, lambda N, x: second_bracket(moved(N), x), point).values()) == {K.zero}
    second, first = second_bracket(body, point), canonical_matrix(K)
    rows = jacobian_matrix(K, lambda N, x: [trace_hamiltonian(moved(N), x, m) for m in (1, 2, 3)], point)
    for m in range(2):
        assert [K.dot(line, rows[m]) for line in second] == [K.dot(line, rows[m + 1]) for line in first]
    for matrix in (second, first):
        assert all(x == K.zero for line in pushed(K, rows, matrix) for x in line)
    # N = Π'Π⁻¹, its powers have the traces 2m·J_m, and it has no torsion
    N = recursion_operator(body, point)
    assert second == tuple(tuple(K.dot(row, column) for column in zip(*first, strict=True)) for row in N)
    power = N
    for m in (1, 2, 3):
        trace = K.dot([row[i] for i, row in enumerate(power)], [K.one] * 4)
        assert trace == K.mul(poly.integer(K, 2 * m), trace_hamiltonian(body, point, m))
        power = tuple(tuple(K.dot(row, column) for column in zip(*N, strict=True)) for row in power)
    assert set(nijenhuis_torsion(K, lambda L, x: recursion_operator(moved(L), x), point).values()) == {K.zero}
    assert rank(K, first) == rank(K, second) == 4


def test_an_operator_with_torsion_is_found() -> None:
    """N = diag(x2, x1): N = diag(λ_i) has no torsion only where λ_i does not depend on the others' coordinates."""
    K = GF(10007)
    found = nijenhuis_torsion(K, lambda N, x: ((x[1], N.zero), (N.zero, x[0])), (3, 5))
    assert set(found) == {(0, 0, 1), (1, 0, 1)}
    # T^1_12 = (λ1 − λ2)·∂_2λ1, T^2_12 = (λ1 − λ2)·∂_1λ2
    assert found[0, 0, 1] != 0
    assert found[1, 0, 1] != 0
    mixed = nijenhuis_torsion(K, lambda N, x: ((x[0], N.one), (N.zero, x[1])), (3, 5))
    assert set(mixed.values()) != {K.zero}


@pytest.mark.parametrize("field", FIELDS)
def test_ranks(field) -> None:
    """The bracket of (γ, M) has rank 4 at every state, 2 at γ = 0 and 0 at γ = M = 0; Π' has rank 2 where λ_2 = 0."""
    K, rng = FIELDS[field](), Random(7)
    for d in (0, 1):
        ball = ChaplyginBall((1, 2, 4), d, field=K)
        assert rank(K, ball.poisson(random_state(ball, rng))) == 4
    zero = (K.zero,) * 3
    body = ChaplyginBall((1, 2, 4), 0, field=K).body
    assert rank(K, ball_matrix(body, zero, (K.one, K.zero, K.zero))) == 2
    assert rank(K, ball_matrix(body, zero, zero)) == 0
    x, y = K.random(rng), K.random(rng)
    assert rank(K, second_bracket(body, (x, y, K.zero, K.one))) == 2
    assert rank(K, ((K.one, x, y), (x, K.mul(x, x), K.mul(x, y)))) == 1


def test_wrong_arguments_of_the_recursion() -> None:
    body = ChaplyginBall((1, 2, 4), 0, field=GF(7, 3)).body
    with pytest.raises(ArgumentError, match="m = 7 vanishes"):
        trace_hamiltonian(body, (1, 2, 3, 4), 7)
    with pytest.raises(ArgumentError, match="m = 0"):
        trace_hamiltonian(body, (1, 2, 3, 4), 0)
    with pytest.raises(ArgumentError, match="point = "):
        eigenvalues(body, (1, 2, 3))
    with pytest.raises(FieldError, match="inexact"):
        rank(MP(20), ((MP(20).one,),))


# --- one family


@pytest.mark.parametrize("kind", [Check, Hat])
def test_check_and_hat_are_the_tilde_pair_of_the_inverse_matrix(kind) -> None:
    """Ĥ_A = e3H̃, K̂_A = −e3³K̃ (B² = A^∨; our K is −K̂) and Ȟ_A = −e3H̃, Ǩ_A = e3²K̃ (B² = A), at A⁻¹ and the lift."""
    K, rng = GF(2**61 - 1), Random(7)
    system = kind((1, 4, 9), field=K)
    a1, a2, a3 = system.a
    e3 = K.mul(a1, K.mul(a2, a3))
    squares = system.a if kind is Check else (K.mul(a2, a3), K.mul(a3, a1), K.mul(a1, a2))
    tilde = Tilde(system.a, field=K)
    B = roots(K, squares)

    def attempt():
        state = random_state(system.rigid, rng)
        return state, lift(K, B, state.gamma, state.M)

    for _ in range(5):
        state, (gamma, M) = until_defined(attempt)
        image = tilde.state(gamma, M)
        here, there = system.integrals(state), tilde.integrals(image)
        if kind is Check:
            assert (K.neg(K.mul(e3, there.H)), K.mul(K.mul(e3, e3), there.K)) == (here.H, here.K)
        else:
            assert (K.mul(e3, there.H), K.mul(K.mul(e3, K.mul(e3, e3)), there.K)) == (here.H, here.K)
        back = lift(K, [K.inv(x) for x in B], gamma, M)
        assert back in ((state.gamma, state.M), (tuple(map(K.neg, state.gamma)), state.M))


def test_the_gyroscopic_pair_without_the_gyroscope() -> None:
    K = GF(2**61 - 1)
    tilde, free = Tilde((1, 2, 4), field=K), Gyroscopic((1, 2, 4), 0, field=K)
    state = states(tilde, 1, 8)[0]
    assert free.integrals(state).H == tilde.integrals(state).H
    assert K.neg(tilde.integrals(state).K) == free.integrals(state).K


# --- conservation and flows

GEODESIC = ["tilde", "tilde, d", "check", "hat"]


def in_digits(make, digits):
    K = MP(digits)
    system = make(K)
    return system, system.state(*START)


def motion(system):
    def rates(y):
        rate = system.vector_field(State(tuple(y[:3]), tuple(y[3:])))
        return [*rate.gamma, *rate.M]

    return rates


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if "potential" in n else ()) for n in SYSTEMS if n not in GEODESIC]
)
def test_the_integrals_are_conserved_to_thirty_digits(name) -> None:
    """An extrapolation integrator drifts by 1e-25 at most up to T = 1; the geodesic flows are in the next test."""
    system, start = in_digits(SYSTEMS[name], 34)
    if "potential" in name:
        # the kinetic energies are indefinite: with the other sign the poles attract, and γ_i reaches 0 in finite time
        poles = {"check, potential": ("-0.02", "-0.04", "-0.06")}.get(name, ("0.02", "0.04", "0.06"))
        system = type(system)(*_arguments(system), potential=("0.1", "0.05", *poles), field=system.field)
    if name == "hat, potential":
        start = system.state(start.gamma, [x / 4 for x in start.M])
    pieces = 14 if name == "hat, potential" else 7
    y = extrapolate(motion(system), [*start.gamma, *start.M], system.field.coerce(1), pieces)
    after = system.integrals(State(tuple(y[:3]), tuple(y[3:])))
    before = system.integrals(start)
    assert max(abs(x - z) / max(1, abs(z)) for x, z in zip(after, before, strict=True)) <= 1e-25


def _arguments(system):
    return (system.rigid.inertia, system.d) if isinstance(system, Tilde) else (system.rigid.inertia,)


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow if n in ("check", "hat") else ()) for n in GEODESIC]
)
def test_the_flow_on_elliptic_curves_against_an_integration_at_thirty_digits(name) -> None:
    """γ and M, signs included, agree to 1e-25 at τ = 3/2, and both keep the integrals."""
    system, start = in_digits(SYSTEMS[name], 34)
    K = system.field
    rates = motion(system)

    def in_tau(y):
        slow = K.sqrt(system.body.conformal(y[:3]))
        return [slow * x for x in rates(y)]

    run = system.flow(start).at_tau([1.5, 0])
    for row, tau in enumerate((1.5, None)):
        y = [*start.gamma, *start.M]
        if tau is not None:
            y = extrapolate(in_tau if system.d else rates, y, K.coerce(tau), pieces=12 if name == "hat" else 8)
        assert max(abs(a - b) for a, b in zip((*run.gamma[row], *run.M[row]), y, strict=True)) <= 1e-25
        before = system.integrals(start)
        for gamma, M in ((y[:3], y[3:]), (run.gamma[row], run.M[row])):
            after = system.integrals(State(tuple(gamma), tuple(M)))
            assert max(abs(a - b) for a, b in zip(after, before, strict=True)) <= 1e-25


def test_physical_time_of_the_tilde_flow_against_an_integration_at_thirty_digits() -> None:
    """γ and M at t = 1 and t = −1/2 for d ≠ 0 agree to 1e-25, which checks the clock t = ∫dτ/g and the curves."""
    system, start = in_digits(SYSTEMS["tilde, d"], 34)
    K = system.field
    times = (1, 0, -0.5)
    run = system.flow(start).at(times)
    assert tuple(map(float, run.times)) == times
    for row, t in enumerate(times):
        y = [*start.gamma, *start.M]
        if t:
            y = extrapolate(motion(system), y, K.coerce(t), pieces=6)
        assert max(abs(a - b) for a, b in zip((*run.gamma[row], *run.M[row]), y, strict=True)) <= 1e-25
    again = system.flow(start).at_tau(run.tau)
    assert max(abs(a - b) for a, b in zip(again.gamma.ravel(), run.gamma.ravel(), strict=True)) <= 1e-32
    assert max(abs(a - b) for a, b in zip(again.times, run.times, strict=True)) <= 1e-32


def test_physical_time_far_out_and_over_floats() -> None:
    """Floats against 30 digits at |t| = 100: the error grows no faster than the rounding of t."""
    times, runs = [100.0, -100.0, 1e-9, 0.5], []
    for K in (None, MP(30)):
        system = Tilde((1, 2, 4), 0.7) if K is None else Tilde((1, 2, 4), "0.7", field=K)
        start = system.state(*START) if K else _generic(system)
        runs.append(system.flow(start).at(times))
    assert np.abs(runs[0].gamma - runs[1].gamma.astype(float)).max() < 2e-14
    assert np.abs(runs[0].M - runs[1].M.astype(float)).max() < 2e-13


@pytest.mark.parametrize("name", [pytest.param("tilde, potential", marks=pytest.mark.slow), "gyroscopic"])
def test_what_has_no_curves_is_integrated(name) -> None:
    """By motion_through: floats and 25 digits agree with each other and keep the integrals of the start."""
    from jacobian import RR

    runs = []
    for K in (RR, MP(25)):
        system = SYSTEMS[name](K)
        if system.potential is not None:
            system = (
                Tilde((1, 2, 4), potential=("0.1", "0.05", "0.02", "0.04", "0.06"), field=K)
                if K is not RR
                else (Tilde((1, 2, 4), potential=(0.1, 0.05, 0.02, 0.04, 0.06)))
            )
        start = system.state(*START) if K is not RR else _generic(system)
        assert not system.separates
        run = system.motion_through(start).at([1, -1, 0])
        again = system.motion_through(start).at_tau(run.tau)
        assert np.abs((again.gamma - run.gamma).astype(float)).max() < (1e-15 if K is RR else 1e-22)
        assert np.abs((again.times - run.times).astype(float)).max() < (1e-15 if K is RR else 1e-22)
        before = system.integrals(start)
        for x, m in zip(run.gamma, run.M, strict=True):
            after = system.integrals(State(tuple(x), tuple(m)))
            assert max(abs(a - b) for a, b in zip(after, before, strict=True)) < (1e-13 if K is RR else 1e-22)
        runs.append(run)
    assert np.abs(runs[0].gamma - runs[1].gamma.astype(float)).max() < 1e-15


@pytest.mark.slow
def test_a_pole_that_attracts_ends_the_motion_with_a_named_error() -> None:
    system = Check((1, 2, 4), potential=(0.0, 0.0, 0.0, 0.5, 0.0))
    with pytest.raises(PrecisionLoss, match=r"times: the motion ends, or cannot be followed, .* before 1"):
        system.motion_through(_generic(system)).at([1.0])


def test_fast_motions_turn_back_before_a_pole() -> None:
    """Fast motions were refused with "the motion ends" since coefficients of their series exceeded the range of
    floats. In another unit of time, M, V and t are multiplied by a number, its square and its inverse.
    """
    inertia, terms = (0.9, 15.5, 3.6), (-0.004, 0.7, 0.7, 0.02, 0.05)
    gamma, unit = (0.48, 0.05, -0.87), 2.0**24
    fast = Tilde(inertia, potential=terms)
    slow = Tilde(inertia, potential=[x / unit**2 for x in terms])
    for w in ((0.1, -0.1, 0.6), (-0.7, -0.2, -0.7)):
        x = np.array(gamma) / np.linalg.norm(gamma)
        M = np.cross(x, w)
        start = slow.state(tuple(x), tuple(M))
        found = fast.motion_through(State(start.gamma, tuple(m * unit for m in start.M))).at(np.array([3, -3.0]) / unit)
        expected = slow.motion_through(start).at([3, -3])
        assert np.abs(found.gamma - expected.gamma).max() < 1e-13
        assert np.abs(found.M / unit - expected.M).max() < 1e-13


def test_where_a_curve_degenerates_the_equations_are_integrated() -> None:
    """K = 0 and equal moments: flow refuses them by name, motion_through continues."""
    for system in (Tilde((1, 2, 3), 0.7), Tilde((1, 1, 3), 0.7)):
        start = system.state((1, 0, 0), (0, 1, 1)) if system.rigid.inertia[1] == 2 else _generic(system)
        with pytest.raises(NotRepresentable):
            system.flow(start)
        found = system.motion_through(start)
        assert found.method == "integrated"
        run = found.at([2.0])
        after = system.integrals(State(tuple(run.gamma[0]), tuple(run.M[0])))
        assert after == pytest.approx(system.integrals(start), rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
def test_each_variable_moves_by_a_translation_on_its_own_elliptic_curve(name) -> None:
    """P_k(0) + P_k(2δ) = 2P_k(δ) in the group of Y² = 4Π(Z − μ_k/I_i), by the chord construction of `jacobian`."""
    system, start = in_digits(SYSTEMS[name], 30)
    K, body = system.field, system.body
    run = system.flow(start).at_tau(["0", "0.7", "1.4"])
    rows = [_separated(system, State(tuple(x), tuple(m))) for x, m in zip(run.gamma, run.M, strict=True)]
    for k in range(2):
        eigenvalues = [row[k][0] for row in rows]
        assert max(abs(x - eigenvalues[0]) for x in eigenvalues) < 1e-27
        mu = eigenvalues[0] * body.contact[0] * body.contact[1] * body.contact[2]
        f = (K.coerce(4),)
        for moment in body.inertia:
            f = poly.mul(K, f, (-mu / moment, K.one))
        group = HyperellipticCurve(K, f).jacobian()
        slow = [1 / (1 - system.d * u) for _, u, _ in (row[k] for row in rows)]
        points = [(mu * u * s, mu * du * s * s) for (_, u, du), s in zip((row[k] for row in rows), slow, strict=True)]
        assert max(abs(y * y - poly.evaluate(K, f, x)) for x, y in points) < 1e-26
        first, middle, last = (group.from_points([point]) for point in points)
        total, double = first + last, 2 * middle
        assert max(abs(x - y) for x, y in zip((*total.u, *total.v), (*double.u, *double.v), strict=True)) < 1e-24


def _separated(system, state):
    """(λ_k, ũ_k, dũ_k/dτ) for both k."""
    K, a = system.field, system.a
    rate = system.vector_field(state)
    slow = K.sqrt(system.body.conformal(state.gamma))
    w = cross(K, state.gamma, state.M)
    moved = [slow * (x + y) for x, y in zip(cross(K, rate.gamma, state.M), cross(K, state.gamma, rate.M), strict=True)]
    h1, h2 = system.rigid.integrals(state)[2:]
    dh2 = 2 * slow * K.dot(state.M, rate.M)
    total = sum(x * x * (a[i - 2] + a[i - 1]) for i, x in enumerate(w)) / h2
    product = sum(x * x * a[i - 2] * a[i - 1] for i, x in enumerate(w)) / h2
    d_total = (
        2 * sum(x * y * (a[i - 2] + a[i - 1]) for i, (x, y) in enumerate(zip(w, moved, strict=True))) - total * dh2
    ) / h2
    d_product = (
        2 * sum(x * y * a[i - 2] * a[i - 1] for i, (x, y) in enumerate(zip(w, moved, strict=True))) - product * dh2
    ) / h2
    gap = K.sqrt(total * total / 4 - product)
    # u² − total·u + product = 0
    return [(h1 - u * h2, u, (d_total * u - d_product) / (2 * u - total)) for u in (total / 2 - gap, total / 2 + gap)]


@pytest.mark.thinned(5)
@pytest.mark.parametrize("inertia", [(1, 2, 4), (4, 1, 2), (2, 4, 1)], ids=str)
@pytest.mark.parametrize("name", GEODESIC)
def test_floats_against_multiprecision_far_out(name, inertia) -> None:
    from jacobian import RR

    d = {"tilde, d": (0.7,)}.get(name, ())
    make = {"check": Check, "hat": Hat}.get(name, Tilde)
    gamma, M = (0.6, 0.0, 0.8), (1.2, 0.5, -0.9)
    exact = MP(40)
    runs = []
    times = [0.0, 1.0, 30.0, 1000.0, -1000.0]
    for K in (RR, exact):
        system = make(inertia, *d, field=K)
        x = [K.coerce(v) for v in gamma]
        m = [K.coerce(v) for v in M]
        size = K.sqrt(K.dot(x, x))
        x = [v / size for v in x]
        tilt = K.dot(x, m)
        runs.append(system.flow(system.state(x, [v - tilt * w for v, w in zip(m, x, strict=True)])).at_tau(times))
    for row, t in enumerate(times):
        for found, truth in ((runs[0].gamma, runs[1].gamma), (runs[0].M, runs[1].M)):
            assert np.abs(found[row] - truth[row].astype(float)).max() < 5e-14 * (1 + abs(t))
    assert runs[0].gamma[0] == pytest.approx(gamma, abs=1e-14)


# --- refusals


RATIONAL = Tilde((1, 2, 3), field=QQ)


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (lambda: Tilde((1, 2, 3), 0.7, potential=(1, 2)), ArgumentError, "five numbers"),
        (lambda: Tilde((1, 2, 3), -1), ArgumentError, "d = -1"),
        (lambda: Check((1, 0, 3)), ArgumentError, "inertia"),
        (lambda: Tilde((1, 2, 3)).state((0.6, 0.8, 0), (0, 1, 1)), ArgumentError, r"\(γ, M\) = 0"),
        (lambda: _at_axis(Tilde((1, 2, 3), potential=(1, 1, 1, 1, 1)), "integrals"), NotRepresentable, "infinite"),
        (lambda: _at_axis(Hat((1, 2, 3), potential=(1, 1, 1, 1, 1)), "vector_field"), NotRepresentable, "infinite"),
        (lambda: _at_axis(Tilde((1, 2, 3), potential=(1, 1, 0, 0, 0)), "flow"), ArgumentError, "separated"),
        (lambda: _at_axis(Gyroscopic((1, 2, 3), 1.0), "flow"), ArgumentError, "separated"),
        (lambda: _at_axis(Tilde((1, 1, 3)), "flow"), NotRepresentable, "equal"),
        (lambda: _at_axis(Tilde((1, 2, 3)), "flow"), NotRepresentable, "degenerates"),
        (lambda: Tilde((1, 2, 3), 0.7).flow(_generic(Tilde((1, 2, 3), 0.7))).at(["x"]), ArgumentError, "times"),
        (lambda: RATIONAL.flow(RATIONAL.state(("3/5", "4/5", 0), (4, -3, 1))), ArgumentError, "field = QQ"),
    ],
)
def test_refusals(make, error, words) -> None:
    with pytest.raises(error, match=words):
        make()


def _at_axis(system, use):
    return getattr(system, use)(system.state((1, 0, 0), (0, 1, 1)))


def _generic(system):
    return system.state(*(tuple(map(float, v)) for v in START))


def test_poles_of_zero_strength_do_not_divide() -> None:
    system = Tilde((1, 2, 3), potential=(1, 1, 2, 0, 0))
    assert system.integrals(system.state((1, 0, 0), (0, 1, 1))).H != 0


def test_a_root_that_is_not_in_the_field_is_refused() -> None:
    with pytest.raises(NotASquare):
        roots(QQ, (2, 3, 5))
