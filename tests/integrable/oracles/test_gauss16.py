"""The compiled Gauss–Legendre method of order 16 compared with the readable one, its order, and its round-off."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from integrable import ChaplyginBall, EulerTop
from integrable.oracles import exact_floats
from integrable.oracles.collocation import collocation, gauss_rule
from integrable.oracles.generated import compiled
from integrable.oracles.method import problem_of
from integrable.oracles.methods import METHODS
from integrable.oracles.reference import body_equations, taylor
from integrable.oracles.stepping import follow
from jacobian import MP
from jacobian.errors import PrecisionLoss

GAMMA, UPRIGHT, TILTED = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), (1.104, 2.18, -0.528)
BODIES = {"ball": (0.7, UPRIGHT), "tilted": (0.7, TILTED), "top": (0, UPRIGHT)}


EVERY_BODY = [pytest.param(name, marks=() if name == "tilted" else pytest.mark.slow) for name in BODIES]


def problem(name, field=None):
    d, M = BODIES[name]
    options = {} if field is None else {"field": field}
    number = float if field is None else (lambda x: field.coerce(Fraction(x)))
    system = ChaplyginBall((1, 2, 3), number(d), **options) if d else EulerTop((1, 2, 3), **options)
    # the same floats at every precision
    state = system.state(GAMMA, M, tilted=True) if field is None else None
    return system, state


def gauss16(system, state, times, step=None, tolerance=None):
    name = "Gauss-Legendre 16" if step else "Gauss-Legendre 16, adaptive"
    return METHODS[name].solve(system, state, times, step or tolerance)


def compiled_taylor(system, state, times, tolerance):
    return METHODS["Taylor, compiled"].solve(system, state, times, tolerance)


def start(name):
    return [*map(float, GAMMA), *map(float, BODIES[name][1])]


def steps_of(name, K, stages, times, h):
    """The readable method in multiprecision, from the same floats."""
    system, _ = problem(name, K)
    advance = collocation(body_equations(system.inertia, system.d), K.coerce, K.dps, stages)
    return follow(advance, [K.coerce(Fraction(x)) for x in start(name)], [K.coerce(t) for t in times], K.coerce(h))


@pytest.mark.parametrize("stages", [1, 2, 3, 8])
def test_the_rule_integrates_polynomials_of_twice_its_stages(stages):
    rule = gauss_rule(stages, 40)
    for k in range(2 * stages):
        assert abs(sum(b * c**k for b, c in zip(rule.weights, rule.nodes, strict=True)) * (k + 1) - 1) < 1e-38
    for k in range(stages):
        for row, c in zip(rule.matrix, rule.nodes, strict=True):
            assert abs(sum(a * x**k for a, x in zip(row, rule.nodes, strict=True)) * (k + 1) - c ** (k + 1)) < 1e-38


@pytest.mark.parametrize("name", EVERY_BODY)
def test_the_compiled_steps_are_the_readable_ones(name):
    """With a step so long that the method's own error is visible, the two have the same error."""
    system, state = problem(name)
    times = [1.75, 3.5, 4.0, -3.0]
    found = gauss16(system, state, times, step=1.75)
    wanted = steps_of(name, MP(30), 8, times, 1.75)
    exact = taylor(system, state, times, digits=18)
    assert np.abs(found.gamma - wanted.gamma.astype(float)).max() < 3e-15
    assert np.abs(found.M - wanted.M.astype(float)).max() < 6e-15
    assert np.abs(wanted.gamma - exact.gamma).max() > 1e-13


@pytest.mark.parametrize("name", EVERY_BODY)
def test_it_is_of_order_sixteen(name):
    system, state = problem(name)
    K = MP(45)
    exact = taylor(system, state, [2], digits=40)
    errors = [np.abs(steps_of(name, K, 8, [2], Fraction(2, n)).gamma - exact.gamma).max() for n in (8, 12)]
    slope = float(K.context.log(errors[0] / errors[1]) / K.context.log(1.5))
    assert slope == pytest.approx(16, abs=1)
    # the method with a tolerance is the same method
    adapted = gauss16(system, state, [2.0], tolerance=1e-18)
    assert np.abs(adapted.gamma - exact.gamma.astype(float)).max() < 2e-15


@pytest.mark.parametrize("name", EVERY_BODY)
def test_round_off_does_not_drift(name):
    """Quadratic integrals after 20000 steps of a length without a short binary fraction: no steady change."""
    system, state = problem(name)
    run = gauss16(system, state, [0.4999 * k for k in (0, 10_000, 20_000)], step=0.4999)
    for x, y in ((run.gamma, run.gamma), (run.gamma, run.M), (run.M, run.M)):
        values = np.sum(x * y, axis=1)
        # rounding the states for output alone gives about 1e-15
        assert np.abs(values - values[0]).max() < 1e-14


def test_a_long_run_is_near_the_truth():
    system, state = problem("ball")
    data = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text(encoding="utf-8"))
    exact = np.array(data["scenes"]["S1"]["states"]["1000"]["gamma"], dtype=float)
    for found in (
        gauss16(system, state, [1000.0], step=0.7),
        gauss16(system, state, [1000.0], tolerance=1e-16),
        compiled_taylor(system, state, [1000.0], tolerance=1e-17),
    ):
        assert np.abs(found.gamma - exact).max() < 1e-12


@pytest.mark.slow
def test_a_thin_ball_needs_steps_of_many_lengths():
    ball = ChaplyginBall((1e-4, 2, 3), 0.7)
    state = ball.state(GAMMA, UPRIGHT)
    exact = taylor(ball, state, [20], digits=18)
    for found in (
        gauss16(ball, state, [20.0], tolerance=1e-16),
        compiled_taylor(ball, state, [20.0], tolerance=1e-17),
    ):
        assert np.abs(found.gamma - exact.gamma.astype(float)).max() < 1e-10
    with pytest.raises(PrecisionLoss, match=r"step = 2\.0: the stages .* have not converged"):
        gauss16(ball, state, [200.0], step=2.0)


def test_a_body_at_rest_stays():
    ball, _ = problem("ball")
    state = ball.state((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for found in (
        gauss16(ball, state, [1000.0, -3.0], tolerance=1e-12),
        gauss16(ball, state, [3.0, -3.0], step=0.5),
        compiled_taylor(ball, state, [1000.0, -3.0], tolerance=1e-12),
    ):
        assert found.gamma.tolist() == [[1, 0, 0]] * 2
        assert found.M.tolist() == [[0, 0, 0]] * 2


# --- the compiled pieces


@njit(cache=True)
def _exact(a, b):
    return exact_floats.two_sum(a, b), exact_floats.two_product(a, b)


@njit(cache=True)
def _whole(time, step):
    return exact_floats.whole_steps(time, step)


@pytest.mark.parametrize("name", EVERY_BODY)
def test_the_compiled_equations_are_the_written_ones(name):
    system, state = problem(name)
    kind, given, _ = problem_of(system, state)
    coefficients = np.array(kind.coefficients_of(given.constants))
    rates = body_equations([float(x) for x in system.inertia], float(system.d))
    for y in np.random.default_rng(3).normal(size=(8, 6)):
        found = compiled(kind).right_hand_side(0.0, y, coefficients)
        assert np.allclose(found, rates(y.tolist()), rtol=1e-14, atol=1e-14)


moderate = st.floats(-1e6, 1e6).filter(lambda x: x == 0 or abs(x) > 1e-6)


# the first call compiles
@given(moderate, moderate)
def test_sums_and_products_are_exact(a, b):
    (s, e), (p, r) = _exact(a, b)
    assert (s, p) == (a + b, a * b)
    assert Fraction(s) + Fraction(e) == Fraction(a) + Fraction(b)
    assert Fraction(p) + Fraction(r) == Fraction(a) * Fraction(b)


@given(st.floats(1e-3, 1e7), st.floats(1e-3, 10))
def test_whole_steps(time, step):
    count, rest = _whole(time, step)
    exact, remainder = divmod(Fraction(time), Fraction(step))
    # a remainder that rounds to the whole step may be counted either way
    assert count == exact or abs(remainder - step * (count - exact)) < 1e-15 * step
    assert abs(Fraction(count) * Fraction(step) + Fraction(rest) - Fraction(time)) < 1e-16 * step
