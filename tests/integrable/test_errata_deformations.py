"""Items 16–23 and 27–29 of the errata: the printed formula fails, the corrected one holds, over GF(2^61 − 1)."""

from __future__ import annotations

from random import Random

import pytest

from integrable.deformations.isometric import Hat
from integrable.deformations.tilde import Tilde
from integrable.phase.brackets import canonical_matrix, jacobian_matrix, weighted_matrix
from integrable.phase.isometry import lift, roots
from integrable.phase.jets import JetField
from jacobian import GF, poly
from tests.integrable.deformed_systems import SYSTEMS, OverJets
from tests.integrable.exact_states import random_state, until_defined

FIELD = GF(2**61 - 1)
A = tuple(FIELD.inv(i) for i in (1, 2, 4))


class Setting:
    """A state of the tilde pair at d = 1 as jets, with λ1 + λ2 and λ1λ2 from the abscissas of the 2-torsion map."""

    def __init__(self, name: str = "tilde, d", seed: int = 1) -> None:
        self.system = SYSTEMS[name](FIELD)
        self.state = random_state(self.system.rigid, Random(seed))
        self.jets = OverJets(self.system, self.state)
        self.q = q = self.jets.q
        w = [q.gamma[i - 2] * q.M[i - 1] - q.gamma[i - 1] * q.M[i - 2] for i in range(3)]
        total = sum(w[i] ** 2 * (q.a[i - 2] + q.a[i - 1]) for i in range(3))
        product = sum(w[i] ** 2 * q.a[i - 2] * q.a[i - 1] for i in range(3))
        # Σũ·H2 and ũ1ũ2·H2
        self.total = 2 * q.H1 - total
        self.product = q.H1 * q.H1 - q.H1 * total + q.m2 * product

    def B(self):
        """(BM, M)."""
        q = self.q
        return sum((a - b) * (a - c) * x * m * m for (a, b, c, x), m in zip(q.axes, q.M, strict=True))


@pytest.fixture(scope="module")
def setting():
    return Setting()


@pytest.fixture(scope="module")
def upright():
    return Setting("tilde")


def test_item_16_the_traces_of_the_powers_of_N() -> None:
    """J_m = tr N/(2m) does not satisfy the Lenard relations, J_m = tr N^m/(2m) does."""
    rng = Random(2)
    point = [FIELD.random(rng) for _ in range(4)]

    def eigenvalues(jets, x):
        def one(u, p):
            value = 4 * (u - 1) * p * p
            for a in A:
                value = value * (jets.constant(a) - u)
            return value

        return one(x[0], x[2]), one(x[1], x[3])

    def traces(jets, x):
        first, second = eigenvalues(jets, x)
        powers = [first**m + second**m for m in (1, 2)]
        return [powers[0], powers[1] / 2, powers[0] / 2]

    first, corrected, printed = jacobian_matrix(FIELD, traces, point)
    values = [x.value for x in eigenvalues(JetField(FIELD, 0), [JetField(FIELD, 0).constant(x) for x in point])]
    left = [FIELD.dot(row, first) for row in weighted_matrix(FIELD, values)]
    assert left == [FIELD.dot(row, corrected) for row in canonical_matrix(FIELD)]
    assert left != [FIELD.dot(row, printed) for row in canonical_matrix(FIELD)]


def test_item_17_the_quadratic_form_of_tH1_is_half_the_trace(setting) -> None:
    """(Ã'M, M), Ã' = ½(A − sE) + dg²B, is ½(λ1 + λ2)."""
    q = setting.q
    printed = (q.m1 - q.s * q.m2) / 2 + q.d * q.G * setting.B()
    assert printed.value != setting.total.value
    assert (2 * printed).value == setting.total.value
    assert setting.jets.pair()[0].value == setting.total.value


def test_item_18_tK1_is_minus_four_times_the_product(setting) -> None:
    """4g²ξ²((E − dA − d²g²B)M, M) is −4λ1λ2."""
    q = setting.q
    form = q.m2 - q.d * q.m1 - q.d * q.d * q.G * setting.B()
    printed = 4 * q.G * q.xi * q.xi * form
    assert printed.value != setting.product.value
    assert printed.value == (-4 * setting.product).value
    assert setting.jets.pair()[1].value == (-setting.product).value


def test_item_19_the_angular_velocity_loses_half_of_A_plus_sE(setting) -> None:
    """(ω̃, M) = ½(λ1 + λ2) for ω̃ = ω − ½(A + sE)M, not with the plus sign printed."""
    q = setting.q
    change = (q.m1 + q.s * q.m2) / 2
    assert (q.H1 + change).value != (setting.total / 2).value
    assert (q.H1 - change).value == (setting.total / 2).value


def test_item_20_the_pair_at_d_zero_is_two_times_and_a_quarter(upright) -> None:
    """At d = 0 the displayed (m1 − s·m2, ξ²m2) is twice (tH1) and a quarter of (tK1)."""
    q = upright.q
    first, second = q.m1 - q.s * q.m2, q.xi * q.xi * q.m2
    general = (q.m1 - q.s * q.m2) / 2, 4 * q.xi * q.xi * q.m2
    assert (first, second) != general
    assert (first, second) == (2 * general[0], general[1] / 4)
    assert (first.value, second.value) == (upright.total.value, (-upright.product).value)


def test_item_21_the_cubic_potential_needs_its_square(upright) -> None:
    """as + b(s³ − tr A·s²) commutes with the K' of the page; as + b·s³ commutes with neither of the two functions named
    there.
    """
    q, jets = upright.q, upright.jets
    a, b = jets.constant(3), jets.constant(5)
    energy = q.m1 - q.s * q.m2 + a * q.s
    second = (q.m2 - a - b * (q.s * q.s - q.e1 * q.s - q.sigma)) * q.xi * q.xi
    assert jets.bracket(energy + b * q.s**3, second) != 0
    assert jets.bracket(energy + b * (q.s**3 - q.e1 * q.s**2), second) == 0
    # the printed potential without the other terms of K
    assert jets.bracket(energy + b * q.s**3, (q.m2 - a - b * q.s * q.s) * q.xi * q.xi) != 0


def test_item_22_the_check_hamiltonian_subtracts_twice(upright) -> None:
    """Neither sH̃ − ξ² nor sĤ − ξ² commutes with Ǩ; sH̃ − 2ξ² does."""
    q, jets = upright.q, upright.jets
    square = q.xi * q.xi
    second = square * (q.s * q.m1 - square)
    tilde = q.m1 - q.s * q.m2
    hat = Hat((1, 2, 4), field=FIELD).pair(q, None)[0]
    assert jets.bracket(q.s * tilde - square, second) != 0
    assert jets.bracket(q.s * hat - square, second) != 0
    assert jets.bracket(q.s * tilde - 2 * square, second) == 0


# --- the sphere in (u, p), d = 0


def sphere(jets, point):
    """φ1, φ2, H1 = (M, M), H2 = −(M, AM) at (u1, u2, p1, p2)."""
    u1, u2, p1, p2 = point

    def phi(x):
        value = jets.integer(4)
        for a in A:
            value = value * (jets.constant(a) - x)
        return value

    first, second = phi(u1) * p1 * p1, phi(u2) * p2 * p2
    return phi(u1), phi(u2), (first - second) / (u1 - u2), (u1 * second - u2 * first) / (u1 - u2)


def test_item_23_the_bracket_W_does_not_only_change_the_time() -> None:
    """X^W_{H1} = X_{H2} + (u1 + u2)X_{H1}; it is no multiple of X_{H1} or of X_{H2}."""
    rng = Random(3)
    point = [FIELD.random(rng) for _ in range(4)]
    first, second = jacobian_matrix(FIELD, lambda jets, x: sphere(jets, x)[2:], point)
    plain = canonical_matrix(FIELD)
    of_first, of_second = ([FIELD.dot(row, d) for row in plain] for d in (first, second))
    weighted = [FIELD.dot(row, first) for row in weighted_matrix(FIELD, point[:2])]
    total = FIELD.add(point[0], point[1])
    assert weighted == [FIELD.add(y, FIELD.mul(total, x)) for x, y in zip(of_first, of_second, strict=True)]
    for field in (of_first, of_second):
        assert any(FIELD.mul(weighted[0], field[i]) != FIELD.mul(weighted[i], field[0]) for i in range(1, 4))


def hat_eigenvalues(jets, point):
    """ν1 + ν2 and ν1ν2: with ℓ(x) the line through (u_k, φ_kp_k), x²ℓ² − φ(x)(h1x + h2) ∝ UÛ and ν_k = h1 + h2/û_k."""
    u1, u2, p1, p2 = point
    f1, f2, _, _ = sphere(jets, point)
    slope = (f1 * p1 - f2 * p2) / (u1 - u2)
    line = (f1 * p1 - slope * u1, slope)
    left, right = f1 * p1 * p1 * u1 * u1, f2 * p2 * p2 * u2 * u2
    h1 = (left - right) / (u1 - u2)
    h2 = left - h1 * u1
    curve = (h2, h1)
    for a in A:
        curve = poly.mul(jets, curve, (jets.constant(a), jets.integer(-1)))
    square = poly.mul(jets, (jets.zero, line[0], line[1]), (jets.zero, line[0], line[1]))
    whole = poly.sub(jets, square, [4 * c for c in curve])
    image = poly.quotient(jets, whole, (u1 * u2, -(u1 + u2), jets.one))
    inverse_sum, inverse_product = -image[1] / image[0], image[2] / image[0]
    return 2 * h1 + h2 * inverse_sum, h1 * h1 + h1 * h2 * inverse_sum + h2 * h2 * inverse_product


def metric(jets, point):
    """Σ ĝ_ij p_ip_j as printed."""
    u1, u2, p1, p2 = point
    f1, f2, _, _ = sphere(jets, point)
    trace = sum(jets.constant(FIELD.inv(a)) for a in A)
    first = f1 * u1 * (2 * u1 + u2 - u1 * u2 * trace) / (u1 - u2) * p1 * p1
    return first + f2 * u2 * (u1 + 2 * u2 - u1 * u2 * trace) / (u2 - u1) * p2 * p2


@pytest.mark.parametrize("seed", range(3))
def test_item_27_the_metric_is_the_sum_not_half_of_it(seed) -> None:
    rng, jets = Random(seed), JetField(FIELD, 0)
    point = [jets.constant(FIELD.random(rng)) for _ in range(4)]
    total, _ = hat_eigenvalues(jets, point)
    assert metric(jets, point) != total / 2
    assert metric(jets, point) == total


@pytest.mark.parametrize("seed", range(3))
def test_item_28_the_second_hat_integral_is_four_times_the_product(seed) -> None:
    rng, jets = Random(seed), JetField(FIELD, 0)
    point = [jets.constant(FIELD.random(rng)) for _ in range(4)]
    u1, u2, p1, p2 = point
    f1, f2, _, _ = sphere(jets, point)
    e3 = jets.constant(A[0]) * jets.constant(A[1]) * jets.constant(A[2])
    slope = (u1 * u1 * p1 - u2 * u2 * p2) / (u1 - u2)
    printed = f1 * f2 / e3 * slope * slope * (f1 * u1 * p1 * p1 - f2 * u2 * p2 * p2) / (u1 - u2)
    _, product = hat_eigenvalues(jets, point)
    assert printed != product
    assert printed == 4 * product


def test_item_29_the_hat_flow_is_the_tilde_flow_of_the_inverse_matrix() -> None:
    """The hat flow is not new: γ' = Bγ/|Bγ|, B² = A^∨, takes Ĥ_A to e3·H̃ of A⁻¹; without this map the two differ."""
    hat = Hat((1, 4, 9), field=FIELD)
    a1, a2, a3 = hat.a
    tilde, rng = Tilde(hat.a, field=FIELD), Random(4)
    B = roots(FIELD, [FIELD.mul(a2, a3), FIELD.mul(a3, a1), FIELD.mul(a1, a2)])

    def attempt():
        state = random_state(hat.rigid, rng)
        return state, tilde.state(*lift(FIELD, B, state.gamma, state.M))

    state, image = until_defined(attempt)
    e3 = FIELD.mul(a1, FIELD.mul(a2, a3))
    assert FIELD.mul(e3, tilde.integrals(image).H) == hat.integrals(state).H
    assert FIELD.mul(e3, tilde.integrals(state).H) != hat.integrals(state).H
