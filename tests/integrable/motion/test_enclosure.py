"""Enclosures contain states at many more digits, are small, and every truncation bound in them holds."""

from __future__ import annotations

import flint
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.enclosure import BallMotion
from integrable.motion.precise import PreciseFlow
from integrable.moving_point.addition import rate_at
from integrable.moving_point.balls import Balls, BallTranslations, majorant
from integrable.moving_point.translations import Expansion
from jacobian import MP
from jacobian.errors import ArgumentError
from jacobian.numbers.long_reals import BallReals
from tests.integrable.moving_point.test_translations import BODIES

START = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
REALS = BallReals(900)


def motion_of(system, start=START, tilt=0):
    K = system.field
    gamma, M = ([K.coerce(x) for x in v] for v in start)
    M = [m + tilt * x for m, x in zip(M, gamma, strict=True)]
    return system, system.state(gamma, M, tilted=bool(tilt))


CASES = {
    "ball": (ChaplyginBall((1, 2, 3), "0.7", field=MP(25)), START, 0),
    "tilted": (ChaplyginBall((1, 2, 3), "0.7", field=MP(25)), START, 1.5),
    "other order of axes": (ChaplyginBall((3, 1, 2), "0.7", field=MP(25)), START, 0),
    "equal moments": (ChaplyginBall((1, 1, 2), "0.7", field=MP(25)), START, 0),
    "gamma_2 = 0": (ChaplyginBall((1, 2, 3), "0.7", field=MP(25)), ((0.6, 0, 0.8), (0.8, 0.5, -0.6)), 0),
    "top": (EulerTop((1, 2, 3), field=MP(25)), START, 0),
    "tilted top": (EulerTop((1, 2, 3), field=MP(25)), START, 1.5),
}


def contained(found, vectors) -> bool:
    """Whether every ball contains the number of many more digits."""
    pairs = [(found.gamma[i], gamma) for i, (gamma, _) in enumerate(vectors)]
    pairs += [(found.M[i], M) for i, (_, M) in enumerate(vectors)]
    return all(ball.contains(REALS.number(x)) for balls, xs in pairs for ball, x in zip(balls, xs, strict=True))


@pytest.mark.parametrize("name", CASES)
def test_states_at_tau(name) -> None:
    system, state = motion_of(*CASES[name])
    tau = [system.field.coerce(x) for x in (0, "0.3", -2, 40)]
    found = system.flow(state).enclosure_at_tau(tau)
    assert (found.radius <= 1e-25).all()
    truth = PreciseFlow(system.body, state, 160)
    assert contained(found, truth.vectors(truth.at_tau(tau)))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", CASES)
def test_states_at_physical_times(name) -> None:
    system, state = motion_of(*CASES[name])
    times = [system.field.coerce(x) for x in (0, "0.5", -1)]
    found = system.flow(state).enclosure(times, digits=12)
    assert (found.radius <= 1e-12).all()
    truth = PreciseFlow(system.body, state, 160)
    tau, points = truth.at(times)
    assert contained(found, truth.vectors(points))
    assert all(ball.contains(REALS.number(t)) for ball, t in zip(found.tau, tau, strict=True))
    assert all(ball == REALS.number(t) for ball, t in zip(found.times, times, strict=True))


def test_floats_are_exact_inputs() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    found = ball.flow(state).enclosure([0.25])
    run = ball.flow(state).at([0.25])
    assert found.radius[0] <= 1e-15
    for ball_, x in zip((*found.gamma[0], *found.M[0]), (*run.gamma[0], *run.M[0]), strict=True):
        assert abs(float(ball_) - x) < 4e-14


def test_far_away_a_state_costs_digits_only() -> None:
    system, state = motion_of(*CASES["ball"])
    found = system.flow(state).enclosure_at_tau([system.field.coerce(10**6)])
    truth = PreciseFlow(system.body, state, 300)
    assert found.radius[0] <= 1e-25
    assert contained(found, truth.vectors(truth.at_tau([system.field.coerce(10**6)])))


def test_more_digits_than_a_float_has_exponents() -> None:
    system, state = motion_of(*CASES["ball"])
    found = system.flow(state).enclosure_at_tau([system.field.one], digits=400)
    assert 0 < found.radius[0] < 1e-307
    with BallReals(2000).at(2000):
        assert all(x.rad() * flint.arb(10) ** 399 < 1 for x in (*found.gamma[0], *found.M[0]))


@pytest.fixture(scope="module")
def balls():
    system, state = motion_of(*CASES["tilted"])
    return BallMotion(system.body, state, 25, 400)


def test_the_differential_equation_is_that_of_the_flow(balls) -> None:
    """A difference quotient of the moving point lies in the enclosure of the velocity."""
    with balls.reals:
        h = balls.reals.number(2.0**-100)
        before, after = (balls.point(balls.reals.number(1) + k * h) for k in (-1, 1))
        velocity = balls._velocity(balls.point(balls.reals.number(1)))
        for x, y, v in zip(before, after, velocity, strict=True):
            assert abs((y - x) / (2 * h) - v) < 1e-55


def test_the_bound_of_the_clock_holds_on_the_real_part_of_its_disc(balls) -> None:
    with balls.reals:
        centre = balls.point(balls.reals.number(1))
        radius, bound = balls._bounded_disc(centre, 1.0, 0)
        assert 0.02 < radius < 1
        for k in range(-4, 5):
            point = balls.point(balls.reals.number(1 + 0.24 * k * radius))
            assert abs(rate_at(balls.problem.axes, point)) < bound


def test_the_bound_of_the_clock_holds_at_complex_points_of_a_box(balls) -> None:
    with balls.reals:
        point, size = balls.point(balls.reals.number(1)), 0.02
        bound = balls._rate_bound([flint.acb(x + flint.arb(0, size), flint.arb(0, size)) for x in point])
        corners = ([flint.acb(x + s * size, size * (-1) ** k) for k, x in enumerate(point)] for s in (-1, 0, 1))
        rates = [abs(rate_at(balls.problem.axes, corner)) for corner in corners]
        assert all(rate < bound for rate in rates)
        assert bound < 2 * max(rates)
        # 1/g has a pole in this box
        assert balls._rate_bound([flint.acb(flint.arb(0, 1), flint.arb(0, 1)) for _ in point]) is None


def test_a_ball_of_times_holds_the_states_of_all_of_them(balls) -> None:
    with balls.reals:
        wide = balls.point(flint.arb(1, 1e-3))
        for offset in (-1e-3, 0, 3e-4, 1e-3):
            inner = balls.point(balls.reals.number(1) + balls.reals.number(offset))
            assert all(x.contains(y) for x, y in zip(wide, inner, strict=True))
        assert max(x.rad() for x in wide) < 0.01


@pytest.mark.parametrize("size", [1e-30, 1e-3, 0.5, 3.0])
def test_translations_are_enclosed_at_every_precision(size) -> None:
    """Balls with few bits contain the midpoints of balls with many: the bounds of series and of Newton's iteration
    hold.
    """
    system, state = motion_of(*CASES["ball"])
    few, many = (BallMotion(system.body, state, 10, bits) for bits in (120, 400))
    for eps in (size, -size):
        with few.reals:
            step = few._translations.near(few.reals.number(eps))
        with many.reals:
            truth = many._translations.near(many.reals.number(eps))
        for x, y in zip(step, truth, strict=True):
            assert x.contains(y)
            assert x.rad() < 1e-15 * (1 + abs(y))


def test_the_rest_of_the_series_is_bounded(monkeypatch) -> None:
    """With few orders the tail is large, and the balls still contain the truth."""
    system, state = motion_of(*CASES["ball"])
    motion, short = (BallMotion(system.body, state, 10, 600) for _ in range(2))
    with motion.reals:
        eps = motion.reals.number(0.3)
        exact = motion._translations.near(eps)
        monkeypatch.setattr(BallTranslations, "_terms", lambda *given: 20)
        rough = short._translations.near(eps)
        assert len(short._translations._expansion(short._translations._halvings)[0].u0) == 20
        for x, y in zip(rough, exact, strict=True):
            assert x.contains(y)
            assert x.rad() > 1e3 * y.rad()


@pytest.mark.parametrize("name", BODIES)
def test_all_coefficients_are_below_the_majorant(name) -> None:
    """The bounds that the first orders prove hold for three times as many; they fail for a wrong recurrence."""
    ball = BODIES[name]
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    motion = BallMotion(ball.body, state, 10, 600)
    translations = motion._translations
    with motion.reals:
        rows, _ = translations._expansion(translations._halvings)
        few = Expansion(*(row[:32] for row in rows))
        tails = majorant(translations.f, few, translations._ratio)
        assert tails
        for row, tail in zip(rows[:4], tails, strict=True):
            sizes = [abs(x) * (k + 1) ** 2 / translations._ratio**k for k, x in enumerate(row)]
            assert not any(size > tail for size in sizes[16:])
            # nor is the bound huge
            assert max(map(float, sizes[16:])) > 1e-9 * float(tail)
        # orders that grow faster than the bound are not proven
        assert not majorant(translations.f, few, translations._ratio / 10**9)


def test_the_field_of_balls() -> None:
    with Balls(100) as K:
        assert K.sqrt(K.coerce(2)).contains(flint.arb(2).sqrt().mid())
        assert K.dot([K.one, K.coerce(0.5)], [K.coerce(3), K.coerce(4)]) == 5
        assert K.coerce(K.one) is K.one


@pytest.mark.parametrize("digits", [0, -3, 2.5, True])
def test_digits_are_checked(digits) -> None:
    system, state = motion_of(*CASES["ball"])
    with pytest.raises(ArgumentError, match=r"digits = .* int ≥ 1"):
        system.flow(state).enclosure([1], digits=digits)


def test_times_too_far_for_panels_are_refused() -> None:
    system, state = motion_of(*CASES["ball"])
    with pytest.raises(ArgumentError, match=r"panels, more than 100000; enclosure_at_tau has no such limit"):
        system.flow(state).enclosure([10**6], digits=5)


def test_times_share_the_panels_that_they_pass(monkeypatch):
    """The cost of several times is the panels up to the farthest and one more for each, not all panels anew for each;
    the balls overlap.
    """
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)))
    panels = []
    panel = BallMotion._panel
    monkeypatch.setattr(BallMotion, "_panel", lambda *given: panels.append(1) or panel(*given))
    times = [1.5, -0.2, *(0.3 * k for k in range(1, 5))]
    together = flow.enclosure(times, 12)
    shared, single = len(panels), 0
    for k, time in enumerate(times):
        panels.clear()
        alone = flow.enclosure([time], 12)
        single += len(panels)
        assert all(x.overlaps(y) for x, y in zip(together.gamma[k], alone.gamma[0], strict=True))
        assert all(x.overlaps(y) for x, y in zip(together.M[k], alone.M[0], strict=True))
    assert shared <= 0.6 * single
    assert max(together.radius) <= 1e-12
