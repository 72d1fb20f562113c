"""Every system, exactly over finite fields: its vector field is the Mumford field, its integrals are constant."""

from random import Random

import pytest

from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.mumford.bodies import BodySystem
from integrable.mumford.fields import rates
from integrable.mumford.flow import Point
from integrable.phase.jets import Jet, JetField
from jacobian import poly
from jacobian.relatives.extended import Extended
from tests.integrable.classical.rows import EXACT, over_formulas
from tests.integrable.exact_points import over_fields
from tests.integrable.ways import inside


def moving(K, state, rate):
    """The state plus ε times its rate."""
    N = JetField(K, 1)
    return N, Point(
        *(tuple(Jet(N, x, (y,)) for x, y in zip(a, b, strict=True)) for a, b in zip(state, rate, strict=True))
    )


def slope(x):
    return x.slopes[0]


def time_rate(system, u):
    """dt/dτ at a pair with this U."""
    N = system.numbers
    u = tuple(map(N.coerce, u))
    if not system.clocked:
        return N.one
    if isinstance(system, BodySystem):
        (p, q), (first, second, third) = system._light(N), system._weights(N)
        return N.sqrt(first * second * third / (p * p - p * q * u[1] + q * q * u[0]))
    if isinstance(system, KuzminKutuzov):
        return u[0] * u[1]
    return system._clock(N, Extended(u, (), (N.zero,)))[1]


@over_fields()
@over_formulas
def test_the_vector_field_is_a_mumford_field(K, name, n) -> None:
    """dU/dt and dV/dt, by jets, are the field of the stated direction; df/dt = 0; every integral is constant."""
    K = K()
    system, state = EXACT[name](K, Random(n), n)
    N, jets = moving(K, state, system.vector_field(state))
    f, u, v = system.over(N).spectral(jets)
    bare = [tuple(x.value for x in a) for a in (f, u, v)]
    assert all(slope(c) == K.zero for c in f)
    expected = rates(K, *bare, system.direction(len(v)))
    rate = system._bare(time_rate(system, bare[1]))
    assert tuple(tuple(K.mul(rate, slope(x)) for x in a) for a in (u, v)) == expected
    for value in system.over(N).integrals(jets).values():
        assert all(slope(x) == K.zero for x in (value if isinstance(value, tuple) else (value,)))


@over_fields()
@over_formulas
def test_the_pair_is_on_the_curve(K, name, n) -> None:
    K = K()
    system, state = EXACT[name](K, Random(n), n)
    f, u, v = system.spectral(state)
    assert u[-1] == K.one
    assert poly.mod(K, poly.sub(K, f, poly.mul(K, v, v)), u) == ()
    if len(u) > 2:
        D = system.divisor(state)
        assert D.u == poly.trim(K, u)
        assert D + D - D == D


@over_fields()
@pytest.mark.parametrize(
    ("name", "n", "sheet"),
    [
        ("ellipsoid", 2, 1),
        ("ellipsoid", 3, 1),
        ("garnier", 2, 1),
        ("henon_heiles", 1, 1),
        ("henon_heiles", 2, 1),
        ("neumann", 2, 1),
        ("neumann", 3, 1),
        ("toda", 3, 1),
        ("toda", 4, -1),
    ],
)
def test_a_step_keeps_the_integrals_and_adds_a_point(K, name, n, sheet) -> None:
    """The discretization stays on the curve; on the Jacobian it is D + P − ∞ (and the sheet's ∞ for Toda)."""
    K = K()
    rng = Random(7 * n)
    for _ in range(400):
        system, state = EXACT[name](K, rng, n)
        try:
            P = system.curve_point(state, K.random(rng), rng.choice((1, -1)))
            new = system.step(state, P, *([sheet] if name == "toda" else []))
            D, E = system.divisor(state), system.divisor(new)
        except (ValueError, ZeroDivisionError):
            continue
        break
    else:
        raise AssertionError("no step is defined over this field")
    assert system.spectral(new).f == system.spectral(state).f
    assert system.integrals(new) == system.integrals(state)
    J = D.jacobian
    if name == "ellipsoid":
        assert J(P, (K.zero, K.zero)) == E - D
        return
    if name != "toda":
        assert D + J.from_points([P]) == E
        return
    # D + P − ∞ for the point at infinity of the sheet
    plus, minus = J.curve.points_at_infinity()
    if J.curve.infinity_plus != K.one:
        plus, minus = minus, plus
    assert J(P, plus if sheet == 1 else minus) == E - D


@over_fields()
@pytest.mark.parametrize("n", [3, 4, 5])
def test_a_chain_comes_back_from_its_pair(K, n) -> None:
    """Euclid's algorithm on (A, U) gives p and the ratios of e^q without a root."""
    K = K()
    system, state = EXACT["toda"](K, Random(n), n)
    N = system.numbers
    inner = inside(system, state, N)
    _, u, v = system._spectral(N, inner)
    p, links = system._chain(N, inner, (u, v))
    assert [x.value for x in p] == list(state.p)
    assert [x.value for x in links] == [K.div(state.q[k + 1], state.q[k]) for k in range(n - 1)]
