"""The adapter and the Bäcklund maps: residual 0 over finite fields, rounding over the reals."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from integrable import ChaplyginBall, EulerTop
from integrable.phase.state import State
from jacobian import (
    GF,
    MP,
    CurveMismatch,
    HyperellipticCurve,
    NotASquare,
    NotRepresentable,
    PrecisionLoss,
    SingularCurve,
)
from jacobian.errors import ArgumentError
from tests.integrable.exact_states import random_state, systems, unit_vector, until_defined

RR_BALL = ChaplyginBall((1, 2, 3), 0.7)
RR_TOP = EulerTop((1, 2, 3))
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))


@systems()
def test_the_divisor_of_a_state_lies_on_its_curve_and_leads_back(system) -> None:
    system, rng = system(), Random(1)
    for _ in range(10):
        state = random_state(system, rng)
        D = system.divisor(state)  # from_mumford checks U | f − V²
        assert len(D.u) == 3
        assert system.from_divisor(D, like=state) == state


@systems()
def test_the_eight_lifts_share_a_divisor(system) -> None:
    system, rng = system(), Random(2)
    K, state = system.field, random_state(system, rng)
    D = system.divisor(state)
    for s in [(1, 1, -1), (1, -1, 1), (-1, 1, 1), (-1, -1, -1), (-1, -1, 1)]:
        gamma = tuple(x if sign > 0 else K.neg(x) for sign, x in zip(s, state.gamma, strict=True))
        M = tuple(x if s[(i + 1) % 3] * s[(i + 2) % 3] > 0 else K.neg(x) for i, x in enumerate(state.M))
        lift = State(gamma, M, state.g)
        assert system.divisor(lift) == D
        assert system.from_divisor(D, like=lift) == lift


@systems()
def test_without_a_model_the_roots_are_those_of_the_field(system) -> None:
    """from_divisor(D) is always the same one of the lifts of a state (with g of either sign)."""
    system, rng = system(), Random(11)
    K = system.field
    for _ in range(10):
        state = random_state(system, rng)
        found = system.from_divisor(system.divisor(state))
        assert system.divisor(found) == system.divisor(state)
        # (γ, M, g) and (−γ, −M, −g) have the same pairs up to signs
        other = replace(found, M=tuple(map(K.neg, found.M)), g=None if found.g is None else K.neg(found.g))
        assert found in system.lifts(state) or other in system.lifts(state)
        assert {system.from_divisor(system.divisor(x)) for x in system.lifts(state)} == {found}


@pytest.mark.parametrize("system", [RR_BALL, RR_TOP], ids=["ball", "top"])
def test_without_a_model_gamma_is_positive(system) -> None:
    lifts = system.lifts(system.state(*START))
    images = [system.from_divisor(system.divisor(x)) for x in lifts]
    for image in images:
        assert image.gamma == pytest.approx(START[0], abs=1e-13)
        assert pytest.approx(START[1], abs=1e-13) == image.M
    # where γ_i = 0, the sign is determined by (γ × M)_i
    for M in ((1, 0.8, -0.6), (-1, 0.8, -0.6)):
        image = system.from_divisor(system.divisor(system.state((0, 0.6, 0.8), M)))
        assert image.gamma == pytest.approx((0, 0.6, 0.8), abs=1e-13)
        assert image.gamma[1] * image.M[2] - image.gamma[2] * image.M[1] > 0


def test_a_divisor_of_another_system_is_refused() -> None:
    D = RR_BALL.divisor(RR_BALL.state(*START))
    for other in (ChaplyginBall((1, 2, 4), 0.7), ChaplyginBall((1, 2, 3), 0.8), RR_TOP):
        with pytest.raises(CurveMismatch, match="no curve of this system"):
            other.from_divisor(D)
    exact = ChaplyginBall((1, 2, 3), 1, field=GF(10007))
    with pytest.raises(CurveMismatch, match="no curve of this system"):
        exact.from_divisor(HyperellipticCurve(GF(10007), [1, 0, 0, 0, 0, 1]).jacobian().random(Random(1)))


def test_a_divisor_that_does_not_determine_its_state_is_refused() -> None:
    """The moments differ by 10⁻⁴ relative to d: (U, V) with half of the digits does not determine γ."""
    heavy = ChaplyginBall((1, 2, 3), 1e4)
    with pytest.raises(PrecisionLoss, match="does not determine"):
        heavy.from_divisor(heavy.divisor(heavy.state(*START)))
    wide = ChaplyginBall((1, 2, 3), 1e4, field=MP(40))
    found = wide.from_divisor(wide.divisor(wide.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))))
    assert [float(x) for x in found.gamma] == pytest.approx(START[0], abs=1e-15)


@systems()
def test_even_multiples_preserve_every_integral_and_add_the_divisor(system) -> None:
    system, rng = system(), Random(3)
    for _ in range(10):
        state = random_state(system, rng)
        step, image = until_defined(lambda state=state: _doubled_step(system, state, rng))
        assert system.integrals(image) == system.integrals(state)
        assert image == system.state(image.gamma, image.M, image.g)
        assert system.divisor(image) == system.divisor(state) + step.divisor(state)
        assert (-step)(image) == state


def _doubled_step(system, state, rng):
    step = system.translation([system.field.random(rng), system.field.random(rng)], multiple=2)
    return step, step(state)


@given(seed=st.integers(0, 10**9))
@settings(max_examples=25)
def test_a_step_preserves_the_integrals(seed) -> None:
    rng = Random(seed)
    ball = ChaplyginBall(
        (1 + rng.randrange(10**6), 10**7 + rng.randrange(10**6), 10**8), rng.randrange(1, 10**6), field=GF(2**61 - 1)
    )
    state = random_state(ball, rng)
    _, image = until_defined(lambda: _doubled_step(ball, state, rng))
    assert ball.integrals(image) == ball.integrals(state)


def test_steps_commute_and_compose() -> None:
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(10007)), Random(4)
    state = random_state(ball, rng)
    first, _ = until_defined(lambda: _doubled_step(ball, state, rng))
    second, _ = until_defined(lambda: _doubled_step(ball, state, rng))
    assert first(second(state)) == second(first(state))
    twice = first(first(state))
    assert _up_to_lift(ball, (2 * first)(state), twice)
    assert ball.divisor((2 * first)(state)) == ball.divisor(twice)


def _up_to_lift(system, state, other) -> bool:
    K = system.field
    return all(x == y or x == K.neg(y) for x, y in zip((*state.gamma, *state.M), (*other.gamma, *other.M), strict=True))


def test_n_steps_lead_back_to_the_start_for_n_the_order_of_the_divisor() -> None:
    """D' = [2m]E of small order n, on a curve large enough for the orbit to stay of weight two."""
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(499)), Random(5)
    found = 0
    while found < 3:
        state = _state_on_smooth_curve(ball, rng)
        size = ball.group(*ball.integrals(state)[2:]).order()
        points = [ball.field.random(rng), ball.field.random(rng)]
        try:
            order = _order(ball.translation(points, multiple=2).divisor(state), size)
            n = max(k for k in range(1, 100) if order % k == 0)
            step = ball.translation(points, multiple=2 * order // n)
            orbit = [state]
            for _ in range(n):
                orbit.append(step(orbit[-1]))
        except (NotASquare, NotRepresentable):
            # no such points on the curve, or one of the multiples has a weight below two
            continue
        if n < 3:
            continue
        assert len(set(map(ball.divisor, orbit))) == n
        assert ball.divisor(orbit[-1]) == ball.divisor(state)
        assert _up_to_lift(ball, orbit[-1], state)
        found += 1


def _order(D, size: int) -> int:
    """The order of D, found from the order of the group."""
    for prime in range(2, 499):
        while size % prime == 0 and not (size // prime) * D:
            size //= prime
    return size


def _state_on_smooth_curve(system, rng):
    """A random state; over a small field h1/h2 is sometimes one of the a_i, and such states are skipped."""
    while True:
        state = random_state(system, rng)
        try:
            system.curve(*system.integrals(state)[2:])
        except SingularCurve:
            continue
        return state


def test_one_point_and_infinity_over_a_finite_field() -> None:
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(2**61 - 1)), Random(6)
    K = ball.field

    def attempt():
        state = random_state(ball, rng)
        step = ball.translation([K.random(rng)])
        return state, step, step(state)

    for _ in range(3):
        state, step, image = until_defined(attempt, 2000)
        assert ball.integrals(image) == ball.integrals(state)
        assert ball.divisor(image) == ball.divisor(state) + step.divisor(state)
        assert (-step)(image) == state


def test_the_two_torsion_map_is_the_closed_form() -> None:
    """γ̃ = σ e/(g̃ r), e = w/|M|, M̃ = |M| γ̃ × (σ g r γ) (Tsiganov, Proposition 2)."""
    state = RR_BALL.state(*START)
    image = RR_BALL.torsion()(state)
    g = RR_BALL.body.conformal(state.gamma) ** -0.5
    w = _cross(state.gamma, state.M)
    size = sum(x * x for x in state.M) ** 0.5
    r = [c**0.5 for c in RR_BALL.body.contact]
    h1, h2 = RR_BALL.integrals(state)[2:]
    product = RR_BALL.body.contact[0] * RR_BALL.body.contact[1] * RR_BALL.body.contact[2]
    g_image = ((h2 - 0.7 * h1) / (g * g * h2 * product)) ** 0.5
    closed = [x / size / (g_image * ri) for x, ri in zip(w, r, strict=True)]
    sign = [1 if x * y > 0 else -1 for x, y in zip(closed, image.gamma, strict=True)]
    closed = [s * x for s, x in zip(sign, closed, strict=True)]
    assert image.gamma == pytest.approx(closed, abs=1e-14)
    turned = [s * g * ri * x for s, ri, x in zip(sign, r, state.gamma, strict=True)]
    momentum = [size * x for x in _cross(closed, turned)]
    assert pytest.approx(momentum, abs=1e-13) == image.M or pytest.approx([-x for x in momentum], abs=1e-13) == image.M


def _cross(x, y):
    return [x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3] for i in range(3)]


def test_the_two_torsion_map_has_order_four_on_states() -> None:
    step, state = RR_BALL.torsion(), RR_BALL.state(*START)
    twice = step(step(state))
    assert twice.gamma == pytest.approx([-x for x in state.gamma], abs=1e-12)
    assert pytest.approx(state.M, abs=1e-12) == twice.M
    again = step(step(twice))
    assert again.gamma == pytest.approx(state.gamma, abs=1e-12)


REAL_STEPS = {
    "two points beyond 1/d": (RR_BALL, {"points": [1.8, 2.5]}),
    "one point and infinity": (RR_BALL, {"points": [1.7]}),
    "conjugate pair": (RR_BALL, {"points": [0.5j, -0.5j]}),
    "double of a pair on one oval": (RR_BALL, {"points": [0.4, 0.5], "multiple": 2}),
    "triple of a conjugate pair": (RR_BALL, {"points": [0.3 + 0.2j, 0.3 - 0.2j], "multiple": 3}),
    "conjugate pair, top": (RR_TOP, {"points": [0.4j, -0.4j]}),
    "other sheet": (RR_BALL, {"points": [1.8, 2.5], "sheets": [1, -1]}),
    "signs": (RR_BALL, {"points": [1.8, 2.5], "signs": [1, -1, -1]}),
}


@pytest.mark.parametrize("name", REAL_STEPS)
def test_real_steps_keep_the_integrals_to_rounding_and_agree_with_multiprecision(name) -> None:
    system, options = REAL_STEPS[name]
    state = system.state(*START)
    image = system.translation(**options)(state)
    for before, after in zip(system.integrals(state), system.integrals(image), strict=True):
        assert after == pytest.approx(before, abs=2e-11)
    K = MP(40)
    precise = type(system)(*([system.inertia, system.d] if system.d else [system.inertia]), field=K)
    start = precise.state(*_constrained(K, START))
    truth = precise.translation(**options)(start)
    assert [float(x) for x in truth.gamma] == pytest.approx(image.gamma, abs=1e-11)
    assert [float(x) for x in truth.M] == pytest.approx(image.M, abs=1e-11)
    drift = [abs(a - b) for a, b in zip(precise.integrals(start), precise.integrals(truth), strict=True)]
    assert max(drift) < 1e-33


def _constrained(K, start):
    gamma, M = ([K.coerce(x) for x in v] for v in start)
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    return gamma, [m - tilt * x for m, x in zip(M, gamma, strict=True)]


def test_a_real_orbit_turns_through_every_sign_of_gamma() -> None:
    """1000 steps by twice a conjugate pair: every γ_i changes sign repeatedly, and the divisors are always the sums."""
    step, state = RR_BALL.translation([0.3j, -0.3j]), RR_BALL.state(*START)
    orbit = [state]
    for _ in range(300):
        orbit.append(step(orbit[-1]))
    for i in range(3):
        assert sum(a.gamma[i] * b.gamma[i] < 0 for a, b in pairwise(orbit)) > 5
    drift = [abs(a - b) for a, b in zip(RR_BALL.integrals(orbit[-1]), RR_BALL.integrals(state), strict=True)]
    assert max(drift) < 1e-10


@pytest.mark.parametrize("system", [RR_BALL, RR_TOP], ids=["ball", "top"])
def test_the_conjugate_pair_is_the_flow_to_second_order(system) -> None:
    """The step by {±iη} is the flow of H1 with δ = η/√(a1a2a3h1) + O(η³): the slope in η is 3."""
    state = system.state(*START)
    flow = system.flow(state, kernel="python")
    h1 = system.integrals(state).H1
    errors = []
    etas = (0.04, 0.02, 0.01)
    for eta in etas:
        image = system.translation([eta * 1j, -eta * 1j])(state)
        delta = eta / (system.a[0] * system.a[1] * system.a[2] * h1) ** 0.5
        truth = flow.at_tau([delta]).gamma[0]
        errors.append(max(abs(a - b) for a, b in zip(truth, image.gamma, strict=True)))
    for larger, smaller in pairwise(errors):
        assert 6 < larger / smaller < 10


@pytest.mark.parametrize(
    ("make", "error", "words"),
    [
        (
            lambda: RR_BALL.translation([0.3, 0.45])(RR_BALL.state(*START)),
            NotASquare,
            ("points = (0.3, 0.45)", "one oval"),
        ),
        (lambda: RR_BALL.translation([0.1, 0.2])(RR_BALL.state(*START)), NotASquare, ("points", "f(0.1)", "RR")),
        (lambda: RR_BALL.translation([0.1, 0.2, 0.3]), ArgumentError, ("points = [0.1, 0.2, 0.3]", "one or two")),
        (lambda: RR_BALL.translation(0.1), ArgumentError, ("points = 0.1", "one or two")),
        (lambda: RR_BALL.translation([0.1j, 0.1j]), ArgumentError, ("points", "conjugate")),
        (lambda: RR_TOP.translation([0.4]), ArgumentError, ("points = [0.4]", "d > 0")),
        (lambda: RR_TOP.torsion(), ArgumentError, ("d = 0", "d ≠ 0")),
        (lambda: RR_BALL.translation([1.8, 2.5], sheets=[1, 2]), ArgumentError, ("sheets = [1, 2]", "1 or -1")),
        (lambda: RR_BALL.translation([1.8, 2.5], signs=[1]), ArgumentError, ("signs = [1]", "3 signs")),
        (lambda: RR_BALL.translation([1.8, 2.5], multiple=0), ArgumentError, ("multiple = 0", "identity")),
        (lambda: 1.5 * RR_BALL.translation([1.8, 2.5]), ArgumentError, ("multiple = 1.5", "int")),
        (
            lambda: RR_BALL.translation([1.8, 1.8], sheets=[1, -1])(RR_BALL.state(*START)),
            ArgumentError,
            ("points", "opposite"),
        ),
    ],
)
def test_bad_steps(make, error, words) -> None:
    with pytest.raises(error) as caught:
        make()
    for word in words:
        assert word in str(caught.value)


def test_a_state_of_equal_moments_steps_although_its_divisor_forgets_gamma() -> None:
    ball = ChaplyginBall((1, 1, 2), 0.7)
    state = ball.state(*START)
    with pytest.raises(NotRepresentable, match="moments of inertia are equal"):
        ball.from_divisor(ball.divisor(state), like=state)


def test_g_belongs_to_a_state_over_an_exact_field() -> None:
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(10007)), Random(8)
    state = random_state(ball, rng)
    other = ball.state(state.gamma, state.M, g=ball.field.neg(state.g))
    assert ball.divisor(other) == -ball.divisor(state)
    with pytest.raises(ArgumentError, match=r"g = 5.*g² must be"):
        ball.state(state.gamma, state.M, g=5)
    with pytest.raises(ArgumentError, match="leave g out"):
        RR_BALL.state(*START, g=1)


def test_a_state_without_g_in_the_field_is_refused_by_name() -> None:
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(10007)), Random(10)
    K = ball.field
    while True:
        gamma = unit_vector(K, rng)
        if pow(ball.body.conformal(gamma), 5003, 10007) == 10006:  # a non-residue
            break
    with pytest.raises(NotASquare, match=r"g².*no square root"):
        ball.state(gamma, (0, 0, 0))
