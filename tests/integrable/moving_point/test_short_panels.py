"""Panels of short runs: their nodes, and compiled loops in lanes compared with the same loops interpreted."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.short import ShortRuns, lagrange, rule
from integrable.moving_point.addition import moving_point, rate_at
from integrable.moving_point.compiled import SPECIAL
from integrable.moving_point.problem import START
from integrable.moving_point.short import LENGTH, first_half, panel_half
from integrable.moving_point.short_reading import passed
from integrable.moving_point.short_rows import FINEST, FLOATS, GIVEN, HALF, LOT, MADE, SUMS, WIDES, axes_of, new_room
from integrable.moving_point.short_start import set_up
from integrable.moving_point.short_steps import contact_of, framed, levelled, on_pairs, panel_steps
from integrable.moving_point.translations import Translations
from jacobian.native.code import LANES
from jacobian.native.kinds import BOOL, FLOAT, INTS, ArrayKind
from jacobian.native.kinds import FLOATS as FLOAT_ROW
from jacobian.native.kinds import WIDES as WIDE_ROW
from jacobian.native.library import Library
from jacobian.numbers.long_reals import BareReals
from tests.integrable.ways import precise_of


def test_nodes_are_sums_that_are_done_abreast_and_interpolate_like_chebyshevs() -> None:
    """No node depends on another node of its group, and jumps between panels are measured at ±1."""
    nodes = rule().nodes
    assert max(LOT, len(SUMS) - LOT) <= LANES
    assert all(0 <= first < LOT for first, _ in SUMS[LOT:])
    assert (nodes[LOT], nodes[-1 - LOT]) == (-1, 1)
    assert (nodes == -nodes[::-1]).all()
    assert len(set(nodes)) == len(nodes)
    between = np.setdiff1d(np.linspace(-1, 1, 20_001), nodes)
    values = lagrange(nodes, 1 / np.prod(nodes[:, None] - nodes + np.eye(len(nodes)), axis=1), between)
    assert values.sum(axis=1) == pytest.approx(1, abs=1e-12)
    assert abs(values).sum(axis=1).max() < 3.6


def test_the_time_at_the_end_of_a_panel_is_a_double_double(rng) -> None:
    """Its error is some rounding units of the small parts of the products, 2^−26 of the whole."""
    sums, exact = [0.0, 0.0], Fraction(0)
    for _ in range(50):
        half, full, rest = float(rng.integers(1, 2**20)) * 2.0**-18, rng.uniform(1, 2), rng.uniform(-1, 1) * 2.0**-53
        passed(sums, half, full, rest)
        exact += Fraction(half) * (Fraction(full) + Fraction(rest))
    assert abs(sum(map(Fraction, sums)) - exact) < exact / 2**72


MOTIONS = {
    "ball": (ChaplyginBall((1, 2, 3), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "tilted": (ChaplyginBall((1, 2, 3), 0.7), (0.48, 0.6, 0.64), (1.0, 0.3, -0.8), True),
    "thin, panels are halved": (
        ChaplyginBall((0.01, 0.02, 0.025), 1.0),
        (0.48, 0.6, 0.64),
        (0.384, 1.28, -1.488),
        True,
    ),
    "very different moments": (ChaplyginBall((1, 1e4, 1e8), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "top": (EulerTop((1, 2, 3)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), True),
}
# cases of an axis with κ = 0, where translations are projected back onto their divisors
EQUAL = {
    "the least equal": (ChaplyginBall((1, 1, 3), 0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "the largest equal": (ChaplyginBall((3, 1, 3), 0.7), (0.48, 0.6, 0.64), (1.0, 0.3, -0.8), True),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_compiled_runs_are_interpreted_ones(name) -> None:
    """As many times as lanes, fewer and more, in either direction, and at the ends and nodes of panels."""
    system, gamma, M, tilted = MOTIONS[name]
    state = system.state(gamma, M, tilted=tilted)
    setup = system.flow(state).setup
    half = panel_half(float(setup.problem.half_step)) / float(setup.time_scale)
    places = np.concatenate([half * (rule().nodes + 1), 2 * half * np.arange(-3, 4)])
    for tau in (places, places[:3], np.linspace(-2, 1, LANES), np.linspace(0, 2, LANES + 1), np.array([])):
        runs = [ShortRuns(system, state, kernel) for kernel in ("auto", "python")]
        (rows, times), (expected, expected_times) = (x._run(tau, False, True) for x in runs)
        assert abs(rows - expected).max(initial=0) < 2e-14
        assert abs(times - expected_times).max(initial=0) < 2e-14 * max(1, abs(times).max(initial=0))
        (rows, back), (expected, _) = (x.at(times) for x in runs)
        assert abs(rows - expected).max(initial=0) < 4e-14
        assert abs(back - tau).max(initial=0) < 4e-14


@pytest.mark.parametrize("name", EQUAL)
def test_two_equal_moments_are_gone_through_too(name) -> None:
    system, gamma, M, tilted = EQUAL[name]
    state = system.state(gamma, M, tilted=tilted)
    times = np.array([-60.0, 20.0, 100.0])
    found, wanted = ShortRuns(system, state).at(times), system.flow(state, "compiled").at(times)
    assert found is not None
    assert wanted.way == "closed form"
    assert abs(found[0] - np.hstack([wanted.gamma, wanted.M])).max() < 3e-14


@pytest.mark.thinned(2)
@pytest.mark.parametrize("apart", [2.0**-52, 1e-12, 1e-10, 1e-8])
def test_all_but_equal_moments_are_gone_through_too(apart) -> None:
    """Sums over axes of quotients by a small κ would cost translations their digits."""
    ball = ChaplyginBall((1, 1 + apart, 3), 0.7)
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    times = np.array([-60.0, 20.0, 100.0])
    found = ShortRuns(ball, state).at(times)
    assert found is not None
    assert abs(found[0] - precise_of(ball.flow(state)).at(times)[0]).max() < 5e-14


@pytest.mark.parametrize("name", MOTIONS)
def test_translations_of_panels_are_wide(name) -> None:
    """By half a panel, and by the smallest step between nodes."""
    system, gamma, M, tilted = MOTIONS[name]
    state = system.state(gamma, M, tilted=tilted)
    wide, floats, made = np.zeros((GIVEN + WIDES, 2)), np.zeros(FLOATS), np.zeros(MADE, dtype=np.intp)
    found, given = np.zeros((35, 2)), np.array([[*system.inertia, system.d, *state.gamma, *state.M]])
    STEPS.steps(given, tilted, wide, floats, made, found)
    reals = BareReals(200)
    with reals:
        row = [reals.number(high) + reals.number(low) for high, low in found.tolist()]
        f, axes, half = row[20:26], row[26:34], row[34]
        translations = Translations(reals, f, axes, abs(half) / LENGTH / 2 ** made[4])
        for begin, level in ((0, 0), (10, FINEST)):
            for x, y in zip(row[begin : begin + 10], translations.near(half / 2**level), strict=True):
                assert abs(x - y) < 1e-28 * max(1, abs(y))


def first_steps(given, tilted, wide, floats, made, found):
    """The translations by half a panel and by the smallest step, f, the axes and half a panel, compiled."""
    for i in range(GIVEN):
        wide[i] = given[0, i]
    room = new_room(set_up(wide[:GIVEN], tilted, wide[GIVEN:], floats), wide[GIVEN:], floats, made)
    h = first_half(room)
    panel_steps(room, h)
    for i in range(10):
        found[i], found[10 + i] = room.steps[10 * HALF + i], room.steps[10 * (HALF - FINEST) + i]
    for i in range(14):
        found[20 + i] = room.wide[i]
    found[34] = 0 * found[0] + h


STEPS = Library(
    "first_steps", {"steps": (first_steps, (ArrayKind(FLOAT, 2), BOOL, WIDE_ROW, FLOAT_ROW, INTS, WIDE_ROW))}, SPECIAL
)


@pytest.mark.parametrize("name", MOTIONS)
def test_a_point_off_its_level_is_put_back_on_it(name) -> None:
    """U, V and the pairs agree to all digits, and with the curve a hundred times better."""
    system, gamma, M, tilted = MOTIONS[name]
    state = system.state(gamma, M, tilted=tilted)
    reals = BareReals(200)
    with reals:
        wide = [reals.number(0)] * WIDES
        set_up(reals.row([*system.inertia, system.d, *state.gamma, *state.M]), tilted, wide, [0.0] * FLOATS)
        r, off = contact_of(wide), 1e-12
        start = [*wide[14:18], *(x * (1 + k * k * off) for k, x in enumerate(wide[18:24]))]
        x, y, by = framed(wide, r, start)
        assert 0 < by < 1e3 * off
        left = []
        for rows in (y, levelled(wide, r, x, y, 0.0)):
            u0, u1, v0, v1, *pairs = on_pairs(wide, r, x, rows)
            left.append(0.0)
            for a, kappa, sigma, nu in zip(wide[6:9], wide[9:12], pairs[:3], pairs[3:], strict=True):
                assert abs(kappa * sigma * sigma - (a * a + u1 * a + u0)) < 1e-50
                assert abs(kappa * sigma * nu - (v1 * a + v0)) < 1e-50
                left[-1] += abs(float(remainder(wide[:6], (u0, u1, v0, v1), a) + kappa * nu * nu))
        assert left[1] < 0.01 * left[0]


@pytest.mark.parametrize("seed", range(8))
def test_the_fastest_clock_is_bounded_from_the_start(seed) -> None:
    """1/g is proportional to the root of 1/((1 − du₁)(1 − du₂)); the bound was the largest root itself."""
    rng = np.random.default_rng(seed)
    system = ChaplyginBall(tuple(rng.uniform(1, 2, 3)), rng.uniform(0.1, 1))
    gamma = rng.normal(size=3)
    state = system.state(gamma / np.linalg.norm(gamma), np.cross(gamma, rng.normal(size=3)))
    reals = BareReals(200)
    with reals:
        wide = [reals.number(0)] * WIDES
        start = [*system.inertia, system.d, *state.vectors[0], *state.vectors[1]]
        bound = set_up(reals.row(start), False, wide, [0.0] * FLOATS).fastest
        rate = abs(float(rate_at(axes_of(wide), moving_point(wide, START))))
    run = system.flow(state).at(np.linspace(0, 300, 3000))
    slowness = np.sqrt(1 - system.d * (run.gamma**2 @ (1 / (np.array(system.inertia) + system.d))))
    assert max(slowness) / slowness[0] <= bound / rate * (1 + 1e-12)


def remainder(f, point, a):
    """W(a) of the quotient W of f − V² by U."""
    u0, u1, _, v1 = point
    w2 = f[4] - u1 * f[5]
    w1 = f[3] - u1 * w2 - u0 * f[5]
    return ((f[5] * a + w2) * a + w1) * a + f[2] - v1 * v1 - u1 * w1 - u0 * w2


@pytest.mark.parametrize(("inertia", "most"), [((1.0, 1e4, 1e8), 100), ((1e8, 1e4, 1.0), 200)])
def test_small_branch_points_do_not_shorten_panels(inertia, most) -> None:
    """They limit only the series of translations; the body turns little during so short a panel."""
    system = ChaplyginBall(inertia, 0.7)
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    times = np.linspace(-10, 10 / np.linalg.norm(system.omega(state)), 21)
    runs, wanted = ShortRuns(system, state), system.flow(state, "compiled").at(times)
    rows, tau = runs.at(times)
    assert runs.panels < most
    assert abs(rows - np.hstack([wanted.gamma, wanted.M])).max() < 2e-14
    assert abs(tau - wanted.tau).max() < 1e-14 * abs(tau).max()
