"""Which deformations separate into two curves, exactly over finite fields: the tilde pair, its poles at d = 0, the
gyroscopic, check and hat pairs. With λ_k the functions below, {ũ1, ũ2} = 0, {ũ_k, λ_l} = 0 for k ≠ l, and (dũ_k/dτ)²
is a polynomial in ũ_k whose coefficients are constants and λ_k: of genus 1 in each case.
"""

from __future__ import annotations

from random import Random

import pytest

from integrable import Check, Gyroscopic, Hat, Tilde
from integrable.phase.jets import JetField
from jacobian import NotASquare, NotRepresentable, poly
from tests.integrable.deformed_systems import OverJets
from tests.integrable.exact_points import over_fields
from tests.integrable.exact_states import random_state

POLES = (2, 4, 6)
C = 3


def phi(q, x):
    """4(dx − 1)Π(a_i − x)."""
    return 4 * (q.d * x - 1) * (q.a[0] - x) * (q.a[1] - x) * (q.a[2] - x)


def abscissas(jets, squares, total):
    """The roots of Σ s_i(x − a_j)(x − a_k)/Σs_i as jets; NotASquare where they are not in the field."""
    q = jets.q
    first = sum(x * (q.a[i - 2] + q.a[i - 1]) for i, x in enumerate(squares)) / total
    last = sum(x * q.a[i - 2] * q.a[i - 1] for i, x in enumerate(squares)) / total
    root = jets.jets.sqrt(first * first - 4 * last)
    return (first + root) / 2, (first - root) / 2


def normal(q):
    return [q.gamma[i - 2] * q.M[i - 1] - q.gamma[i - 1] * q.M[i - 2] for i in range(3)]


def of_tilde(jets):
    """λ_k = H1 − ũ_kH2, ũ from w = γ × M; H = λ1 + λ2, K = −λ1λ2; ũ'² = λφ(ũ)."""
    q = jets.q
    u = abscissas(jets, [x * x for x in normal(q)], q.m2)
    values = [q.H1 - x * q.m2 for x in u]
    return u, values, (values[0] + values[1], -values[0] * values[1]), lambda x, value: value * phi(q, x)


def of_poles(jets):
    """d = 0, poles b_i alone: on y² = φ(x)(h1 − xh2 − Σb_ic_i/(x − a_i)), h1 = m1 + Σb_i(a_j + a_k − s)/γ_i², h2 = m2 +
    Σb_i/γ_i², ũ are the other roots of f − V²; λ_k = h1 − ũ_kh2 and ũ'² = φ(ũ)λ − 4Σb_ic_iΠ_{j≠i}(a_j − ũ).
    """
    q, b = jets.q, POLES
    h1 = q.m1 + sum(x * (aj + ak - q.s) / y for x, (_, aj, ak, y) in zip(b, q.axes, strict=True))
    h2 = q.m2 + sum(x / y for x, y in zip(b, q.squares, strict=True))
    c = [(aj - ai) * (ak - ai) for ai, aj, ak, _ in q.axes]
    one = jets.jets.one
    lines = [(a, -one) for a in q.a]
    pairs = [poly.mul(jets.jets, lines[i - 2], lines[i - 1]) for i in range(3)]
    f = poly.mul(jets.jets, (-4 * h1, 4 * h2), poly.mul(jets.jets, lines[0], pairs[0]))
    for x, y, pair in zip(b, c, pairs, strict=True):
        f = poly.sub(jets.jets, f, tuple(4 * x * y * z for z in pair))
    U, V = [jets.jets.zero] * 3, [jets.jets.zero] * 3
    for x, w, pair in zip(q.gamma, normal(q), pairs, strict=True):
        U = [u + x * x * z for u, z in zip(U, pair, strict=True)]
        V = [v + 2 * x * w * z for v, z in zip(V, pair, strict=True)]
    assert V[2].value == jets.field.zero
    # the leading coefficient 2(γ, w) vanishes on the leaf; only directions off the leaf have a nonzero derivative
    square = poly.mul(jets.jets, (V[0], V[1]), (V[0], V[1]))
    rest = poly.sub(jets.jets, f, square)
    quotient, remainder = divided(rest, U)
    assert all(x.value == jets.field.zero for x in remainder)
    first, last = -quotient[1] / quotient[2], quotient[0] / quotient[2]
    root = jets.jets.sqrt(first * first - 4 * last)
    u = (first + root) / 2, (first - root) / 2
    values = [h1 - x * h2 for x in u]

    def square_of_rate(x, value):
        return phi(q, x) * value - 4 * sum(
            p * y * (q.a[i - 2] - x) * (q.a[i - 1] - x) for i, (p, y) in enumerate(zip(b, c, strict=True))
        )

    return u, values, (values[0] + values[1], -values[0] * values[1]), square_of_rate


def divided(above, below):
    """(quotient, remainder) of jets, without a decision on zero."""
    rest, quotient = list(above), []
    while len(rest) >= len(below):
        factor = rest[-1] / below[-1]
        quotient.insert(0, factor)
        for k, x in enumerate(below):
            rest[len(rest) - len(below) + k] = rest[len(rest) - len(below) + k] - factor * x
        rest.pop()
    return quotient, rest


def of_gyroscopic(jets):
    """γ̃ = (2w − cγ)/√(c² + 4m2), λ_k = m1 − (m2 + c²/4)ũ_k; H = λ1 + λ2 + (c²/4)tr A, K = λ1λ2; ũ'² = φ(ũ)(λ +
    c²ũ/4).
    """
    q = jets.q
    quarter = jets.jets.integer(C * C) / 4
    turned = [2 * x - C * y for x, y in zip(normal(q), q.gamma, strict=True)]
    u = abscissas(jets, [x * x for x in turned], 4 * (q.m2 + quarter))
    values = [q.m1 - (q.m2 + quarter) * x for x in u]
    pair = values[0] + values[1] + quarter * q.e1, values[0] * values[1]
    return u, values, pair, lambda x, value: phi(q, x) * (value + quarter * x)


def of_hat(jets):
    """û are the other roots of x²ℓ² − φ(x)(h1x + h2), φ = 4Π(a_i − x), ℓ² = V², h1x + h2 ≡ x²(m2x − m1) mod U; ν_k =
    h1 + h2/û_k; H = ν1 + ν2, K = −e3ν1ν2; û'² = 4νûΠ(a_i − û).
    """
    q, field, one = jets.q, jets.jets, jets.jets.one
    lines = [(a, -one) for a in q.a]
    pairs = [poly.mul(field, lines[i - 2], lines[i - 1]) for i in range(3)]
    U, V = [field.zero] * 3, [field.zero] * 3
    for x, w, pair in zip(q.gamma, normal(q), pairs, strict=True):
        U = [u + x * x * z for u, z in zip(U, pair, strict=True)]
        V = [v + 2 * x * w * z for v, z in zip(V, pair, strict=True)]
    h1, h2 = (q.tau * q.tau - q.sigma) * q.m2 - q.tau * q.m1, q.sigma * (q.m1 - q.tau * q.m2)
    f = poly.mul(field, (4 * h2, 4 * h1), poly.mul(field, lines[0], pairs[0]))
    line = (field.zero, V[0], V[1])
    quotient, remainder = divided(poly.sub(field, f, poly.mul(field, line, line)), U)
    assert all(x.value == jets.field.zero for x in remainder)
    first, last = -quotient[1] / quotient[2], quotient[0] / quotient[2]
    root = field.sqrt(first * first - 4 * last)
    u = (first + root) / 2, (first - root) / 2
    values = [h1 + h2 / x for x in u]

    def square_of_rate(x, value):
        return 4 * value * x * (q.a[0] - x) * (q.a[1] - x) * (q.a[2] - x)

    return u, values, (values[0] + values[1], -q.e3 * values[0] * values[1]), square_of_rate


def of_check(jets):
    """On the tilde pair of A⁻¹, w' = −|Bγ|B⁻¹w at the lift of B = √A: ũ are the roots of Σ(w_i²/a_i)(x − 1/a_j)(x −
    1/a_k), h1 = |Aγ × w|²/e3, h2 = sΣw_i²/a_i, λ_k = −e3(h1 − ũ_kh2); H = λ1 + λ2, K = −λ1λ2; ũ'² = 4e3λΠ(1/a_i − ũ).
    """
    q, w = jets.q, normal(jets.q)
    inverse, squares = [1 / a for a in q.a], [x * x / a for x, a in zip(w, q.a, strict=True)]
    size = sum(squares)
    first = sum(x * (inverse[i - 2] + inverse[i - 1]) for i, x in enumerate(squares)) / size
    last = sum(x * inverse[i - 2] * inverse[i - 1] for i, x in enumerate(squares)) / size
    root = jets.jets.sqrt(first * first - 4 * last)
    u = (first + root) / 2, (first - root) / 2
    h1 = sum((q.Ag[i - 2] * w[i - 1] - q.Ag[i - 1] * w[i - 2]) ** 2 for i in range(3)) / q.e3
    values = [q.e3 * (x * q.s * size - h1) for x in u]

    def square_of_rate(x, value):
        return 4 * q.e3 * value * (inverse[0] - x) * (inverse[1] - x) * (inverse[2] - x)

    return u, values, (values[0] + values[1], -values[0] * values[1]), square_of_rate


CASES = {
    "tilde": (lambda K: Tilde((1, 2, 4), field=K), of_tilde),
    "tilde, d": (lambda K: Tilde((1, 2, 4), 1, field=K), of_tilde),
    "tilde, poles": (lambda K: Tilde((1, 2, 4), potential=(0, 0, *POLES), field=K), of_poles),
    "gyroscopic": (lambda K: Gyroscopic((1, 2, 4), C, field=K), of_gyroscopic),
    "check": (lambda K: Check((1, 2, 4), field=K), of_check),
    "hat": (lambda K: Hat((1, 2, 4), field=K), of_hat),
}


@over_fields()
@pytest.mark.parametrize("name", CASES)
def test_the_pair_separates_into_two_curves_of_genus_one(K, name) -> None:
    make, separate = CASES[name]
    K = K()
    system, rng, found = make(K), Random(11), 0
    while found < 3:
        state = random_state(system.rigid, rng)
        try:
            jets = OverJets(system, state)
            u, values, pair, square = separate(jets)
        except (NotASquare, NotRepresentable, ZeroDivisionError):
            continue
        found += 1
        H, second = jets.pair()
        assert (H.value, second.value) == (pair[0].value, pair[1].value)
        assert jets.bracket(u[0], u[1]) == K.zero
        assert jets.bracket(u[0], values[1]) == jets.bracket(u[1], values[0]) == K.zero
        for x, value in zip(u, values, strict=True):
            # ẋ = g{x, H/2} in t, so dx/dτ = {x, H/2}
            rate = K.div(jets.bracket(x, H), 2)
            assert K.mul(rate, rate) == square(x, value).value != K.zero
            assert jets.bracket(value, H) == K.zero


@over_fields()
@pytest.mark.parametrize("name", ["tilde", "tilde, d"])
def test_the_points_of_a_state_carry_the_rates(K, name) -> None:
    """The ordinate of `system.divisor` is dZ/dτ, sign included."""
    make, separate = CASES[name]
    K = K()
    system, rng, found = make(K), Random(12), 0
    product = K.mul(system.body.contact[0], K.mul(system.body.contact[1], system.body.contact[2]))
    while found < 3:
        state = random_state(system.rigid, rng)
        try:
            jets = OverJets(system, state)
            u, values, _, _ = separate(jets)
            points = system.divisor(state)
        except (NotASquare, NotRepresentable):
            continue
        found += 1
        H, _ = jets.pair()
        expected = set()
        for x, value in zip(u, values, strict=True):
            mu = K.mul(value.value, product)
            z = jets.constant(mu) * x / (1 - jets.q.d * x)
            expected.add((z.value, K.div(jets.bracket(z, H), 2)))
        assert {(K.neg(D.u[0]), poly.evaluate(K, D.v, K.zero)) for D in points} == expected


@over_fields()
def test_the_hat_integrals_as_printed_in_section_8_commute(K) -> None:
    """{Ĥ, K̂} = 0 with Ĥ = −α(w, Aw) − σm2 and K̂ = −(σξ + τζ)²(w, Aw), written out."""
    hat, rng = Hat((1, 2, 4), field=K()), Random(13)
    for _ in range(5):
        jets = OverJets(hat, random_state(hat.rigid, rng))
        q = jets.q
        heavy = sum(a * x * x for a, x in zip(q.a, normal(q), strict=True))
        alpha = q.sigma * (q.e2 / q.e3) - 2 * q.tau
        first = -alpha * heavy - q.sigma * q.m2
        second = -((q.sigma * q.xi + q.tau * q.zeta) ** 2) * heavy
        assert jets.bracket(first, second) == hat.field.zero
        assert first.value == jets.pair()[0].value
        assert jets.bracket(first, q.xi * q.xi) != hat.field.zero
        assert isinstance(jets.jets, JetField)
