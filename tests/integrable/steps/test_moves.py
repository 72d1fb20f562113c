"""Time shifts, compositions and moves of tilted states, to the digits of the field."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.phase.brackets import image_brackets
from integrable.phase.state import State, onto_constraints
from jacobian import GF, MP
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from tests.integrable.exact_points import (
    cross,
    random_system,
)
from tests.integrable.exact_states import random_state
from tests.integrable.steps.equations_of_pairs import shifted


@pytest.mark.parametrize("factor", [10**400, -(10**5000)], ids=["10^400", "-10^5000"])
@pytest.mark.parametrize("K", [None, MP(30)], ids=["RR", "MP(30)"])
def test_multiples_without_end_are_refused_at_once_over_the_reals(factor, K) -> None:
    """A multiple of 10**400 raised an OverflowError, and a larger one never ended."""
    ball = ChaplyginBall((1, 2, 3), 1) if K is None else ChaplyginBall((1, 2, 3), 1, field=K)
    with pytest.raises(Infeasible, match="factor = "):
        ball.multiplication(factor)
    with pytest.raises(Infeasible, match="multiple = "):
        ball.translation([1.8, 2.5], multiple=factor)
    with pytest.raises(Infeasible, match="multiple = "):
        factor * ball.translation([1.8, 2.5])


def test_a_multiple_of_four_hundred_digits_over_a_finite_field() -> None:
    # in a field of 10⁴ elements so many doublings would meet special positions
    exact, factor = ChaplyginBall((1, 2, 3), 1, field=GF(2**61 - 1)), 10**400 + 1
    start = random_state(exact, Random(1))
    assert exact.divisor(exact.multiplication(factor)(start)) == factor * exact.divisor(start)


def test_time_shifts() -> None:
    """The shift by F = H1/2 is the flow; shifts by any F(h1, h2) commute and are undone by −F."""
    for system in (
        ChaplyginBall((1, 2, 3), "0.7", field=MP(20)),
        EulerTop((1, 2, 3), field=MP(20)),
    ):
        state = system.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
        motion, other = system.shift(lambda h1, h2: h1 / 2), system.shift(lambda h1, h2: h1 * h2 / 8)
        image = motion(state)
        assert _distance(image.gamma, system.flow(state).at_tau([1]).gamma[0]) < 1e-18
        assert _distance(system.integrals(image), system.integrals(state)) < 1e-18
        assert _distance(other(image).gamma, motion(other(state)).gamma) < 1e-17
        assert _distance((-other)(other(state)).gamma, state.gamma) < 1e-17


SHIFTED = {
    "ball": (ChaplyginBall((1, 2, 3), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "top": (EulerTop((1, 2, 3)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "thin": (ChaplyginBall((1e-4, 2, 3), 1.0), (0.6, 0.48, 0.64), (0.8, -0.36, -0.48)),
    "heavy": (ChaplyginBall((1, 2, 3), 100.0), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "two equal moments": (ChaplyginBall((1, 1, 3), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "equal moments": (EulerTop((2, 2, 2)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "γ2 = 0": (ChaplyginBall((1, 2, 3), 0.7), (0.6, 0, 0.8), (0.8, 0.5, -0.6)),
    "a rotation": (ChaplyginBall((1, 2, 3), 0.7), (0.6, 0, 0.8), (0, 1, 0)),
    "beside a rotation": (ChaplyginBall((1, 2, 3), 0.7), (0.6, 1e-9, 0.8), (1e-9, 1, 1e-9)),
}
HAMILTONIANS = {
    "H1/2": lambda h1, h2: h1 / 2,
    "H2/2": lambda h1, h2: h2 / 2,
    "-H2": lambda h1, h2: -h2,
    "H1H2/8": lambda h1, h2: h1 * h2 / 8,
    "H1/H2 + H2/3": lambda h1, h2: h1 / h2 + h2 / 3,
    "1e-9·H1": lambda h1, h2: 1e-9 * h1,
    "1": lambda h1, h2: 1.0,
}


@pytest.mark.thinned(8)
@pytest.mark.parametrize("F", HAMILTONIANS)
@pytest.mark.parametrize("kind", SHIFTED)
def test_a_shift_adds_what_the_equations_integrate_to(kind, F) -> None:
    """D + T(w) agrees with integrating the equations of motion of the pairs, and is the divisor of the image."""
    system, gamma, M = SHIFTED[kind]
    state, size = onto_constraints(system, State(gamma, M)), sum(m * m for m in M) ** 0.5
    step = system.shift(HAMILTONIANS[F])
    # the equations over MP(25), since in floats they lose digits for heavy bodies
    wide = type(system)(system.inertia, *([system.d] if system.d else []), field=MP(25))
    start = onto_constraints(wide, state)
    image, expected = step(state), shifted(wide, HAMILTONIANS[F], start)
    assert _distance(image.gamma, expected.gamma) < 1e-13
    assert _distance(image.M, expected.M) < 1e-13 * size
    assert _distance((-step)(image).gamma, state.gamma) < 1e-12
    if kind in ("ball", "top", "heavy") and F != "1":
        D, T, E = system.divisor(state), step.divisor(state), system.divisor(image)
        total = D + D.jacobian.from_mumford(T.u, T.v)
        assert _distance((*total.u, *total.v), (*E.u, *E.v)) < 1e-9 * max(map(abs, (*T.u, *T.v)))


def test_far_shifts_have_their_digits() -> None:
    """After 10⁶ and 10²⁰ turns: compared with the flow in more digits, and with the closed form of a top that turns
    about M.
    """
    ball, top = ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    for tau in (1e6, -1e6, 1e20):
        image = ball.shift(lambda h1, h2, t=tau: h1 * t / 2)(state)
        wide = ChaplyginBall((1, 2, 3), 0.7, field=MP(50))
        there = wide.flow(onto_constraints(wide, state))
        assert image.gamma == pytest.approx([float(x) for x in there.at_tau([tau]).gamma[0]], abs=1e-14)
        image = top.shift(lambda h1, h2, t=tau: h2 * t / 2)(state)
        wide = MP(60)
        unit = onto_constraints(EulerTop((1, 2, 3), field=wide), state)
        size = sum(m * m for m in unit.M) ** (wide.one / 2)
        cosine, sine = wide.context.cos(tau * size), wide.context.sin(tau * size)
        turned = [cosine * x + sine * y / size for x, y in zip(unit.gamma, cross(unit.gamma, unit.M), strict=True)]
        assert image.gamma == pytest.approx([float(x) for x in turned], abs=1e-14)
    for F in (lambda h1, h2: h1 * 1e200, lambda h1, h2: h1 / (h2 - h2)):
        with pytest.raises((Infeasible, PrecisionLoss, ZeroDivisionError)):
            ball.shift(F)(state)


@pytest.mark.slow
@pytest.mark.parametrize(
    "system", [ChaplyginBall((1, 2, 3), "0.7", field=MP(20)), EulerTop((1, 2, 3), field=MP(20))], ids=["ball", "top"]
)
def test_time_shifts_preserve_brackets(system) -> None:
    """By difference quotients; test_the_rates_of_the_pairs_are_hamiltonian does so exactly."""
    state = system.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    brackets, target = image_brackets(system, system.shift(lambda h1, h2: h1 * h2 / 8), state)
    assert max(_distance(x, y) for x, y in zip(brackets, target, strict=True)) < 1e-13


def _distance(x, y):
    return max(abs(a - b) for a, b in zip(x, y, strict=True))


def test_a_shift_adds_one_divisor_along_an_orbit_of_steps() -> None:
    """T depends on the integrals alone, and is the same at a state and at its image under a step."""
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(30))
    state = ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    shift, step = ball.shift(lambda h1, h2: h1 + h2 / 3), ball.translation(["1.8", "2.5"])
    here, there = shift.divisor(state), shift.divisor(step(state))
    assert _distance(here.u, there.u) < 1e-22
    assert _distance(shift(step(state)).gamma, step(shift(state)).gamma) < 1e-24


def test_a_shift_by_H2_turns_the_top_about_M() -> None:
    """d = 0: the flow of H2/2 is γ' = γ × M, M' = 0."""
    from math import cos, sin

    top = EulerTop((1, 2, 3))
    state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    image = top.shift(lambda h1, h2: h2 / 2)(state)
    size = sum(m * m for m in state.M) ** 0.5
    turned = [
        cos(size) * x + sin(size) * y / size for x, y in zip(state.gamma, cross(state.gamma, state.M), strict=True)
    ]
    assert image.gamma == pytest.approx(turned, abs=1e-12)
    assert pytest.approx(state.M, abs=1e-12) == image.M


def test_shifts_and_compositions_of_the_wrong_kind() -> None:
    K = GF(10007)
    with pytest.raises(ArgumentError, match="RR or MP"):
        ChaplyginBall((1, 2, 4), 1, field=K).shift(lambda h1, h2: h1)
    ball, other = ChaplyginBall((1, 2, 3), 0.7), ChaplyginBall((1, 2, 3), 0.8)
    with pytest.raises(ArgumentError, match="two systems"):
        ball.torsion() @ other.torsion()
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    both = ball.torsion() @ ball.translation([1.8, 2.5])
    assert (-both)(both(state)).gamma == pytest.approx(state.gamma, abs=1e-12)
    rng = Random(1)
    assert random_state(random_system(K, rng), rng)


def test_moves_of_tilted_states() -> None:
    """At (γ, M) ≠ 0 every move goes through Chaplygin's transformation: C1, C2, H1, H2 are kept."""
    ball, top = ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))
    for system, step in (
        (ball, ball.keyless()),
        (ball, ball.multiplication(3)),
        (ball, ball.shift(lambda h1, h2: h1 / 2)),
        (ball, ball.keyless() @ ball.translation([1.8, 2.5])),
        (top, top.keyless()),
        (top, top.conic(None, 1)),
    ):
        state = system.state((0.48, 0.6, 0.64), (0.3, 1.1, -1.2), tilted=True)
        image = step(state)
        assert image.tilted
        assert _distance(system.integrals(image), system.integrals(state)) < 1e-9
        assert _distance(image.gamma, state.gamma) > 0.01


@pytest.mark.parametrize("system", [ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))], ids=["ball", "top"])
def test_the_continuous_choice_of_signs(system) -> None:
    """The small step at x0 ± iη with s'_i → a_i − x0 is the flow with (Σdu/y : Σu du/y) = (1 : x0)."""
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    h1, h2 = system.integrals(state)[2:]
    # between the ovals, where f < 0
    x0 = (system.a[1] + h1 / h2) / 2
    signs = [1 if a > x0 else -1 for a in system.a]
    errors = []
    for eta in (4e-3, 2e-3):
        image = system.translation([x0 + eta * 1j, x0 - eta * 1j], signs=signs)(state)
        # ∫dx/y from x0 − iη to x0 + iη is 2η/√(−f(x0)) up to third order, on either sheet
        delta = 2 * eta / abs(_value(system, h1, h2, x0)) ** 0.5
        shifts = [system.shift(lambda a, b, t=t: t * (a - x0 * b) / 2)(state) for t in (delta, -delta)]
        errors.append(min(_distance(image.gamma, x.gamma) for x in shifts))
    assert errors[0] / errors[1] > 6


def _value(system, h1, h2, x):
    return sum(c * x**k for k, c in enumerate(system.body.polynomial(h1, h2)))
