"""The identities of sections 7 and 8 that the deformations are made of, residual 0 over finite fields."""

from __future__ import annotations

from random import Random

import pytest

from integrable import EulerTop
from integrable.jets import JetField
from integrable.systems.deformed import Tilde
from integrable.systems.hat import Hat
from jacobian import GF
from jacobian.errors import NotASquare, NotRepresentable
from tests.integrable.deformed_systems import SYSTEMS
from tests.integrable.exact_states import random_state, until_defined
from tests.integrable.test_errata_deformations import FIELD, hat_eigenvalues, metric, sphere

FIELDS = {"GF(2^61-1)": lambda: GF(2**61 - 1), "GF(7^3)": lambda: GF(7, 3)}


def scalars(system, seed):
    state = random_state(system.rigid, Random(seed))
    wrap = system._constants(0)
    return state, system.scalars(wrap, map(wrap, state.gamma), map(wrap, state.M))


@pytest.mark.parametrize("field", FIELDS)
@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
@pytest.mark.parametrize("seed", range(3))
def test_the_shorthand_of_section_7(name, field, seed) -> None:
    """Section 7: ξ² + η² = m2·t², s·m1 − ξ² = (w, A^∨w), τm2 − m1 = (w, Aw), s − κ = dGt², u1 + u2 and u1u2 by κ, σ."""
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
    B = sum((a - b) * (a - c) * x * m * m for (a, b, c, x), m in zip(q.axes(), q.M, strict=True))
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


def test_over_the_rationals_the_values_are_the_same() -> None:
    from jacobian import QQ

    system = Tilde((1, 2, 4), field=QQ)
    state = system.state(("3/5", "4/5", 0), (4, -3, 1))
    floats = Tilde((1, 2, 4))
    found = floats.integrals(floats.state((0.6, 0.8, 0.0), (4, -3, 1)))
    assert [float(x) for x in system.integrals(state)] == pytest.approx(list(found))
