"""The identities behind the deformations, residual 0 over finite fields."""

from __future__ import annotations

from random import Random

import pytest

from integrable import EulerTop
from integrable.deformations.isometric import Check, Hat
from integrable.deformations.tilde import Tilde
from integrable.phase.brackets import differential, pushed
from integrable.phase.isometry import lift
from integrable.phase.jets import JetField
from integrable.phase.recursion import eigenvalues
from jacobian import GF
from jacobian.errors import NotASquare, NotRepresentable
from tests.integrable.deformed_systems import SYSTEMS, OverJets
from tests.integrable.exact_points import attempt, over_fields, random_case
from tests.integrable.exact_states import random_state, until_defined
from tests.integrable.test_errata_deformations import FIELD, hat_eigenvalues, metric, sphere

FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(7^3)": lambda: GF(7, 3, [4, 0, 6, 1])}


def scalars(system, seed):
    state = random_state(system.rigid, Random(seed))
    wrap = system._constants()
    return state, system.scalars(wrap, map(wrap, state.gamma), map(wrap, state.M))


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
@pytest.mark.parametrize("seed", range(3))
def test_the_shorthand_of_section_7(name, field, seed) -> None:
    """ξ² + η² = m2·t², s·m1 − ξ² = (w, A^∨w), τm2 − m1 = (w, Aw), s − κ = dGt², u1 + u2 and u1u2 by κ, σ."""
    system = SYSTEMS[name](FIELDS[field]())
    state, q = scalars(system, seed)
    w = [q.gamma[i - 2] * q.M[i - 1] - q.gamma[i - 1] * q.M[i - 2] for i in range(3)]
    assert q.xi**2 + q.eta**2 == q.m2 * q.t2
    assert q.s * q.m1 - q.xi**2 == sum(a * x * x for a, x in zip(q.dual, w, strict=True))
    assert q.tau * q.m2 - q.m1 == sum(a * x * x for a, x in zip(q.a, w, strict=True))
    assert q.s - q.kappa == q.d * q.G * q.t2
    u = system.rigid.divisor(state).u
    assert (q.e1 - q.kappa).value == system.field.neg(u[1])
    assert (q.G * (q.sigma - q.d * q.e3)).value == u[0]


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("seed", range(3))
def test_the_forms_of_the_tilde_pair(field, seed) -> None:
    """H̃ = 2H1 − ((A + sE)M, M) = ((A − sE + 2dGB)M, M), K̃ = Gξ²((E − dA − d²GB)M, M), at d ≠ 0; (γ, AM)² = (BM, M)."""
    system = SYSTEMS["tilde, d"](FIELDS[field]())
    state, q = scalars(system, seed)
    B = sum((a - b) * (a - c) * x * m * m for (a, b, c, x), m in zip(q.axes, q.M, strict=True))
    _, _, H, K = system.integrals(state)
    assert q.xi**2 == B
    assert (2 * q.H1 - q.m1 - q.s * q.m2).value == H
    assert (q.m1 - q.s * q.m2 + 2 * q.d * q.G * B).value == H
    assert (q.G * q.xi**2 * (q.m2 - q.d * q.m1 - q.d * q.d * q.G * B)).value == K


@pytest.mark.parametrize("seed", range(3))
def test_the_hat_pair_in_the_coordinates_of_the_sphere(seed) -> None:
    """Ĥ = Σĝp p = ν1 + ν2 and K = −e3ν1ν2 at the (u, p) of a state; H1 = (M, M), H2 = −(M, AM) there."""
    top, hat, rng = EulerTop((1, 2, 4), field=FIELD), Hat((1, 2, 4), field=FIELD), Random(seed)

    def attempt():
        state = random_state(top, rng)
        try:
            return state, top.separated(state)
        except NotRepresentable:
            raise NotASquare("u1 = u2") from None

    state, (u, p) = until_defined(attempt)
    jets = JetField(FIELD, 0)
    point = [jets.constant(x) for x in (*u, *p)]
    _, h1, h2 = top.integrals(state)[1:]
    assert [x.value for x in sphere(jets, point)[2:]] == [h2, FIELD.neg(h1)]
    total, product = hat_eigenvalues(jets, point)
    e3 = FIELD.mul(hat.a[0], FIELD.mul(hat.a[1], hat.a[2]))
    assert total.value == metric(jets, point).value == hat.integrals(state).H
    assert FIELD.neg(FIELD.mul(e3, product.value)) == hat.integrals(state).K


@over_fields()
@pytest.mark.parametrize("kind", ["ball", "top"])
def test_the_eigenvalues_at_the_image_of_the_torsion_map(K, kind) -> None:
    """λ_k = φ(ũ_k)p̃_k² = H1 − ũ_kH2 at the (ũ, p̃) of the image, H̃ = λ1 + λ2, K̃ = −λ1λ2."""
    K, rng = K(), Random(21)

    def make():
        rigid, state = random_case(K, rng, kind, squares=True)
        return rigid, state, rigid.separated(rigid.keyless()(state))

    rigid, state, point = attempt(make)
    h1, h2 = rigid.integrals(state)[2:]
    first, second = eigenvalues(rigid.body, (*point.u, *point.p))
    assert [first, second] == [K.sub(h1, K.mul(u, h2)) for u in point.u]
    found = Tilde(rigid.inertia, rigid.d, field=K).integrals(state)
    assert (K.add(first, second), K.neg(K.mul(first, second))) == (found.H, found.K)


@over_fields()
@pytest.mark.parametrize("name", SYSTEMS)
def test_the_angular_velocity_is_half_the_gradient(K, name) -> None:
    """Ω = ½∂H/∂M at free M, in the closed form of every pair."""
    system, rng = SYSTEMS[name](K()), Random(22)

    def make():
        state = random_state(system.rigid, rng)
        return state, OverJets(system, state).pair()[0]

    wrap = system._constants()
    for _ in range(3):
        state, H = attempt(make)
        omega = system.omega_at(system.scalars(wrap, map(wrap, state.gamma), map(wrap, state.M)))
        assert [(2 * x).value for x in omega] == list(H.slopes[3:])


@over_fields()
@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
def test_at_c_not_zero_the_tilde_pair_does_not_commute(K, name) -> None:
    """The negative control: {H̃, K̃} = 0 fails at (γ, M) ≠ 0."""
    system, rng = SYSTEMS[name](K()), Random(23)
    base = system.field
    state = random_state(system.rigid, rng)
    tilted = system.rigid.state(
        state.gamma, [base.add(m, x) for m, x in zip(state.M, state.gamma, strict=True)], state.g, tilted=True
    )
    jets = OverJets(system, tilted)
    assert jets.bracket(*jets.pair()) != base.zero


@over_fields()
def test_the_rolling_potential_without_poles(K) -> None:
    """b_i = 0: K' = Gξ²{H2 − dH1 − dG[a + b(G² − TG − (1 − dκ)/Pr)]}, H' = H̃ + aG + b(G³ − TG²)."""
    base, rng = K(), Random(24)

    def make():
        rigid, state = random_case(base, rng)
        a, b = base.random(rng), base.random(rng)
        system = Tilde(rigid.inertia, rigid.d, potential=(a, b, 0, 0, 0), field=base)
        return system, state, a, b

    system, state, *strengths = attempt(make)
    wrap = system._constants()
    q, (a, b) = system.scalars(wrap, map(wrap, state.gamma), map(wrap, state.M)), map(wrap, strengths)
    inverse = [1 / (1 - q.d * x) for x in q.a]
    trace, whole = sum(inverse), inverse[0] * inverse[1] * inverse[2]
    depth = a + b * (q.G * q.G - trace * q.G - (1 - q.d * q.kappa) * whole)
    second = q.G * q.xi * q.xi * (q.m2 - q.d * q.H1 - q.d * q.G * depth)
    first = q.m1 - q.s * q.m2 + 2 * q.d * q.G * q.xi * q.xi + a * q.G + b * (q.G**3 - trace * q.G**2)
    found = system.integrals(state)
    assert (first.value, second.value) == (found.H, found.K)


@over_fields()
@pytest.mark.parametrize("kind", [Check, Hat])
def test_check_and_hat_are_isometric_to_the_tilde_pair_of_the_inverse(K, kind) -> None:
    """γ' = Bγ/|Bγ|, M' = Bγ × B⁻¹(M × γ): Ĥ_A = e3H̃, K̂_A = −e3³K̃ for B² = A^∨, Ȟ_A = −e3H̃, Ǩ_A = e3²K̃ for B² = A, at
    A⁻¹; the lift is canonical, and with the other B neither holds.
    """
    base, rng = K(), Random(25)

    def make():
        roots_of_a = [base.random(rng) for _ in range(3)]
        a = [base.mul(x, x) for x in roots_of_a]
        if len(set(a)) < 3:
            raise ZeroDivisionError
        system = kind([base.inv(x) for x in a], field=base)
        x, y, z = roots_of_a
        B = (x, y, z) if kind is Check else (base.mul(y, z), base.mul(z, x), base.mul(x, y))
        state = random_state(system.rigid, rng)
        tilde = Tilde(a, field=base)
        image = tilde.state(*lift(base, B, state.gamma, state.M))
        top = EulerTop(system.rigid.inertia, field=base)

        def lifted(s, v):
            N = s.field
            return lift(N, [N.coerce(e) for e in B], v.gamma, v.M)

        rows = differential(top, lambda s, v: [e for part in lifted(s, v) for e in part], state)
        other = (base.mul(y, z), base.mul(z, x), base.mul(x, y)) if kind is Check else (x, y, z)
        return system, state, tilde, image, rows, tilde.state(*lift(base, other, state.gamma, state.M))

    system, state, tilde, image, rows, wrong = attempt(make)
    e3 = base.mul(system.a[0], base.mul(system.a[1], system.a[2]))
    cube = base.mul(e3, base.mul(e3, e3))
    factors = (base.neg(e3), base.mul(e3, e3)) if kind is Check else (e3, cube)
    # our K of the hat pair is −K̂
    here = system.integrals(state)[2:]
    there, wrong = (
        [base.mul(f, y) for f, y in zip(factors, tilde.integrals(x)[2:], strict=True)] for x in (image, wrong)
    )
    assert tuple(there) == here != tuple(wrong)
    assert pushed(base, rows, system.poisson(state)) == tilde.poisson(image)


def test_over_the_rationals_the_values_are_the_same() -> None:
    from jacobian import QQ

    system = Tilde((1, 2, 4), field=QQ)
    state = system.state(("3/5", "4/5", 0), (4, -3, 1))
    floats = Tilde((1, 2, 4))
    found = floats.integrals(floats.state((0.6, 0.8, 0.0), (4, -3, 1)))
    assert [float(x) for x in system.integrals(state)] == pytest.approx(list(found))
