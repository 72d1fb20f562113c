"""Translations next to the identity, next to 2-torsion and by large multiples: right to rounding × their condition."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.backlund import Translation, moving_branch_point
from integrable.orbit import orbit
from integrable.state import State
from integrable.step import Composition
from integrable.widening import MOST_CONDITION, onto_constraints, widened
from jacobian import GF, MP, RR, NotASquare, PrecisionLoss
from tests.integrable.exact_states import random_state, until_defined

BALL, TOP = ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
WIDE = MP(60)
EPS = RR.eps

# the last number: by how much the map itself turns a change of the state, in units of its change
EXTREME = {
    "pair at 1e-12": (BALL, {"points": [1e-12j, -1e-12j]}, 10),
    "pair at 1e-12, top": (TOP, {"points": [1e-12j, -1e-12j]}, 10),
    "pair at 1e-200": (BALL, {"points": [1e-200j, -1e-200j]}, 10),
    "pair at 1e-3": (BALL, {"points": [1e-3j, -1e-3j]}, 10),
    "one far point": (BALL, {"points": [1e12]}, 10),
    "two far points": (BALL, {"points": [1e9, 3e9]}, 10),
    "next to 2-torsion": (BALL, {"points": [1 / 0.7 * (1 + 1e-10)]}, 10),
    "one ulp from 2-torsion": (BALL, {"points": [1 / 0.7 * (1 + 1e-15)]}, 10),
    "two abscissas close together": (BALL, {"points": [1.8, 1.8 + 1e-12]}, 10),
    "two close, opposite sheets": (BALL, {"points": [1.8, 1.8 + 1e-12], "sheets": [1, -1]}, 10),
    "next to 2-torsion, 3 times": (BALL, {"points": [1 / 0.7 * (1 + 1e-10)], "multiple": 3}, 100),
    "next to 2-torsion, 200 times": (BALL, {"points": [1 / 0.7 * (1 + 1e-10)], "multiple": 200}, 1e4),
    "one point, twice": (BALL, {"points": [1.7], "multiple": 2}, 100),
    "16 times": (BALL, {"points": [1.8, 2.5], "multiple": 16}, 16e2),
    "1000003 times": (BALL, {"points": [1.8, 2.5], "multiple": 1000003}, 1e8),
    "-1000000 times, top": (TOP, {"points": [0.4j, -0.4j], "multiple": -1000000}, 1e8),
}


def _truth(system, options, state, count=1):
    """The states in 60 digits and more, of the numbers that the floats are."""
    wide = widened(system, MP(320) if options["points"][0] == 1e-200j else WIDE)
    step, states = wide.translation(**options), [onto_constraints(wide, state)]
    for _ in range(count):
        states.append(step(states[-1]))
    return states


def _error(ours, true) -> float:
    return float(max(abs(x - y) for x, y in zip((*ours.gamma, *ours.M), (*true.gamma, *true.M), strict=True)))


@pytest.mark.parametrize("name", EXTREME)
def test_a_step_in_floats_is_right_to_rounding_times_its_condition(name) -> None:
    system, options, growth = EXTREME[name]
    state = system.state(*START)
    image = system.translation(**options)(state)
    assert all(isinstance(x, float) for x in (*image.gamma, *image.M))
    assert _error(image, _truth(system, options, state)[-1]) <= growth * EPS


@pytest.mark.parametrize(("name", "count"), [("pair at 1e-12", 50), ("next to 2-torsion", 50), ("16 times", 20)])
def test_an_orbit_in_floats_does_not_feed_its_rounding_back(name, count) -> None:
    system, options, growth = EXTREME[name]
    state = system.state(*START)
    found = orbit(system.translation(**options), state, count)
    assert found.gamma.dtype == float
    assert len(found.states) == count + 1
    assert found.states[0] is state
    for n, (ours, true) in enumerate(zip(found.states, _truth(system, options, state, count), strict=True)):
        assert _error(ours, true) <= growth * EPS * max(1, n if "times" in name else 1)


def test_an_orbit_of_a_composition_is_widened_by_its_worst_part() -> None:
    tiny, plain = BALL.translation([1e-12j, -1e-12j]), BALL.translation([1.8, 2.5])
    state = BALL.state(*START)
    assert plain.condition(state) < MOST_CONDITION < tiny.condition(state)
    both = BALL.torsion() @ plain @ tiny
    assert isinstance(both, Composition)
    assert both.condition(state) == tiny.condition(state)
    wide = widened(BALL, WIDE)
    step = wide.torsion() @ wide.translation([1.8, 2.5]) @ wide.translation([1e-12j, -1e-12j])
    true = [onto_constraints(wide, state)]
    for _ in range(10):
        true.append(step(true[-1]))
    assert _error(orbit(both, state, 10).states[-1], true[-1]) < 50 * EPS


def test_branch_points_given_in_floats_stay_branch_points_in_wider_numbers() -> None:
    state = BALL.state(*START)
    h1, h2 = BALL.integrals(state)[2:]
    torsion = BALL.torsion()
    wide = widened(BALL, WIDE)
    assert torsion.wider(wide).points == (1 / wide.d,)
    assert BALL.translation([BALL.a[0], 1.8]).wider(wide).points == (wide.a[0], 1.8)
    for branch in (h1 / h2, moving_branch_point):
        step = BALL.translation([branch, 1.8], multiple=6)
        true = wide.translation([moving_branch_point, 1.8], multiple=6)(onto_constraints(wide, state))
        assert _error(step(state), true) < 1e4 * EPS


def test_a_tilted_state_takes_a_tiny_step() -> None:
    state = BALL.state((0.48, 0.6, 0.64), (0.5, 1.2, -1.4), tilted=True)
    wide = widened(BALL, WIDE)
    true = wide.translation([1e-12j, -1e-12j])(onto_constraints(wide, state))
    image = BALL.translation([1e-12j, -1e-12j])(state)
    assert image.tilted
    assert _error(image, true) < 50 * EPS
    five = orbit(BALL.translation([1e-12j, -1e-12j]), state, 5).states[-1]
    for _ in range(4):
        true = wide.translation([1e-12j, -1e-12j])(true)
    assert _error(five, true) < 50 * EPS


def test_a_multiple_beyond_floats_is_taken_with_the_digits_it_needs() -> None:
    state, m = BALL.state(*START), 10**20
    wide = widened(BALL, MP(400))
    true = wide.translation([1.8, 2.5], multiple=m)(onto_constraints(wide, state))
    assert _error(BALL.translation([1.8, 2.5], multiple=m)(state), true) < 10 * EPS


def test_many_digits_take_guard_digits_of_their_own() -> None:
    K = MP(30)
    state = onto_constraints(widened(BALL, K), BALL.state(*START))
    options = {"points": [K.context.mpc(0, "1e-12"), K.context.mpc(0, "-1e-12")]}
    image = widened(BALL, K).translation(**options)(state)
    more = widened(widened(BALL, K), MP(70))
    assert _error(image, more.translation(**options)(onto_constraints(more, state))) < 10 * K.eps


@pytest.mark.parametrize("options", [{"points": [1.8, 2.5]}, {"points": [1e-12j, -1e-12j]}])
def test_a_state_off_the_constraints_is_refused_with_what_is_lost(options) -> None:
    leaning = State(START[0], tuple(m + 1e-4 * x for m, x in zip(START[1], START[0], strict=True)))
    with pytest.raises(PrecisionLoss, match=r"H1 and H2 of the image are off by \S+e-0\d .*\(γ, M\) = 1\.0e-04"):
        BALL.translation(**options)(leaning)


def test_an_image_whose_integrals_are_lost_is_refused(monkeypatch) -> None:
    right = Translation._image

    def wrong(self, state):
        image = right(self, state)
        return State(image.gamma, tuple(x * (1 + self.system.field.eps**0.05) for x in image.M))

    monkeypatch.setattr(Translation, "_image", wrong)
    with pytest.raises(PrecisionLoss, match=r"addition of 1·\(1\.8, 2\.5\).*H1 and H2"):
        BALL.translation([1.8, 2.5])(BALL.state(*START))


def test_a_point_just_beyond_a_branch_point_is_refused_in_the_users_numbers() -> None:
    state = BALL.state(*START)
    with pytest.raises(NotASquare, match=r"f\(1\.42857\d+\)"):
        BALL.translation([1 / 0.7 * (1 - 1e-15)])(state)


def test_the_double_of_one_point_is_two_steps_exactly() -> None:
    ball, rng = ChaplyginBall((1, 2, 4), 1, field=GF(2**61 - 1)), Random(11)

    def attempt():
        state, x = random_state(ball, rng), ball.field.random(rng)
        step = ball.translation([x])
        return state, step, step(step(state))

    state, step, twice = until_defined(attempt, 2000)
    image = (2 * step)(state)
    assert ball.divisor(image) == ball.divisor(twice)
    assert ball.integrals(image) == ball.integrals(state)
