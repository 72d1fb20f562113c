"""Bodies with two equal moments, exactly or nearly: signs at far times, rolling and free, upright and tilted.

The top's closed form is computed here with mpmath: with moments (I1, I, I), γ(t) = Rot(e1, −λt)·Rot(M0, −|M|t/I)γ0 and
λ = M1(1/I1 − 1/I).
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.symmetric import SymmetricFlow
from integrable.oracles import reference
from integrable.phase.state import State
from integrable.torus.access import TorusFlow
from integrable.torus.loops import CompiledLoops, ReadableLoops
from jacobian import MP
from jacobian.errors import PrecisionLoss
from tests.integrable.ways import torus_of

DIGITS = 50


def rotated(axis, angles, vectors):
    """Rows of vectors after turns about a unit vector."""
    c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
    return c * vectors + s * np.cross(axis, vectors) + (1 - c) * (vectors @ axis)[:, None] * axis


def closed_form(inertia, axis, gamma, M, times, tilted):
    """γ and M of a top with two equal moments, whose third is that of ``axis``: floats of shape (N, 6)."""
    with mpmath.workdps(DIGITS):
        own, other = mpmath.mpf(inertia[axis]), mpmath.mpf(inertia[axis - 1])
        gamma, M = [mpmath.mpf(x) for x in gamma], [mpmath.mpf(x) for x in M]
        length = mpmath.sqrt(mpmath.fsum(x * x for x in gamma))
        gamma = [x / length for x in gamma]
        if not tilted:
            lean = mpmath.fsum(x * y for x, y in zip(gamma, M, strict=True))
            M = [x - lean * y for x, y in zip(M, gamma, strict=True)]
        momentum = mpmath.sqrt(mpmath.fsum(x * x for x in M))
        rates = -momentum / other, -M[axis] * (1 / own - 1 / other)
        # the angles are large: after reduction here floats suffice
        first, second = (np.array([float((rate * t) % (2 * mpmath.pi)) for t in times]) for rate in rates)
        direction = np.array([float(x / momentum) for x in M])
        gamma, M = (np.tile(np.array(v, dtype=float), (len(times), 1)) for v in (gamma, M))
    symmetry = np.eye(3)[axis]
    return np.hstack([rotated(symmetry, second, rotated(direction, first, gamma)), rotated(symmetry, second, M)])


def random_top(rng):
    """(inertia, axis, γ, M, tilted) of a top with two equal moments, from a wide distribution."""
    axis, tilted = int(rng.integers(3)), bool(rng.integers(2))
    inertia = [10 ** rng.uniform(-2, 2)] * 3
    inertia[axis] *= 10 ** rng.uniform(-1.5, 1.5)
    gamma, M = rng.normal(size=3), rng.normal(size=3) * 10 ** rng.uniform(-1, 1)
    if rng.integers(4) == 0:
        M[axis] *= 10 ** rng.uniform(-8, 0)
    gamma /= np.linalg.norm(gamma)
    if not tilted:
        M -= (M @ gamma) * gamma
    return tuple(inertia), axis, tuple(gamma), tuple(M), tilted


def errors_of(rng):
    """The errors of γ and M/|M| of a random top at 20 times between −1e5 and 1e5, in roundings of 1e-16."""
    inertia, axis, gamma, M, tilted = random_top(rng)
    system = EulerTop(inertia)
    times = 10 ** rng.uniform(1, 5, 20) * rng.choice([-1, 1], 20)
    run = system.flow(system.state(gamma, M, tilted=tilted)).at(times)
    exact = closed_form(inertia, axis, gamma, M, times, tilted)
    return np.abs(run.gamma - exact[:, :3]).max(), np.abs(run.M - exact[:, 3:]).max() / np.linalg.norm(M)


def test_signs_of_a_prolate_top_at_far_times() -> None:
    gamma, M, times = (2 / 3, -1 / 3, 2 / 3), (-2.0, -2.0, 1.0), [500.0, 100.0, -500.0, -100.0, 1e4, 12345.0]
    top = EulerTop((1, 3, 3))
    run = top.flow(top.state(gamma, M)).at(times)
    exact = closed_form((1, 3, 3), 0, gamma, M, times, tilted=False)
    assert exact[0, :3] == pytest.approx([-0.74515678, 0.65080839, 0.14556721], abs=1e-8)
    assert np.abs(run.gamma - exact[:, :3]).max() < 2e-15
    assert np.abs(run.M - exact[:, 3:]).max() < 6e-15


def test_random_tops_with_two_equal_moments() -> None:
    rng = np.random.default_rng(12)
    assert np.max([errors_of(rng) for _ in range(100)]) < 1e-13


@pytest.mark.slow
def test_many_random_tops_with_two_equal_moments() -> None:
    rng = np.random.default_rng(112)
    assert np.max([errors_of(rng) for _ in range(2000)]) < 1e-13


def test_tops_whose_moments_differ_by_many_orders() -> None:
    # γ turns about the symmetry axis so much faster than θ that its mean must be taken from the start
    rng = np.random.default_rng(113)
    for _ in range(60):
        inertia, axis, gamma, M, tilted = random_top(rng)
        inertia = list(inertia)
        inertia[axis] *= 10 ** rng.uniform(-13, 13)
        system = EulerTop(inertia)
        unit = min(inertia) / np.linalg.norm(M)
        times = unit * 10 ** rng.uniform(-2, 4, 12) * rng.choice([-1, 1], 12)
        run = system.flow(system.state(gamma, M, tilted=tilted)).at(times)
        exact = closed_form(inertia, axis, gamma, M, times, tilted)
        assert np.abs(run.gamma - exact[:, :3]).max() < 1e-14, (inertia, gamma, M, tilted)
        assert np.abs(run.M - exact[:, 3:]).max() < 1e-14 * np.linalg.norm(M), (inertia, gamma, M, tilted)


FAR_APART = {
    "a light axis": (
        (8858.515288319888, 8858.515288319888, 1.5438000080144306e-05),
        1.1637380477865348e-05,
        (-0.993208322839655, -0.10488019857118955, -0.050372327618523186),
        (-146.88270715199064, -15.510429321363672, 2928.4305710241188),
        3.4930784818864346e-09,
    ),
    "a heavy ball": (
        (9.984371227793845e-10, 0.053887477924286734, 9.984371227793845e-10),
        11.250546545900582,
        (0.8161054002400386, 0.0, -0.5779030850402567),
        (-3.066552142729015, 69.43499177978656, -4.330535393533118),
        0.0003018181119889511,
    ),
    # found by fuzz: φ turns 1e8 times as fast as θ, and is needed at times at which neither has turned far
    "a needle that does not spin": (
        (0.016926823621980943, 6340922685.460267, 6340922685.460267),
        147838.9033062529,
        (-0.8783928635381395, -0.2671137586081132, 0.3963284209434318),
        (0.39543985051415276, -0.4061813687668125, 0.6026691449322555),
        2311.9612592181975,
    ),
    "a start in a coordinate plane": (
        (0.007031856148452353, 1152658999.004352, 1152658999.004352),
        24.894488303291162,
        (0.9721298811050487, 0.0, 0.23444294457859857),
        (-1.0178559463824582e-05, 0.0, 4.2205926986517325e-05),
        19605.246758594512,
    ),
    "backwards": (
        (1.0110051893059586e-07, 186.5647549213122, 186.5647549213122),
        9.162632271185149e-07,
        (-0.33522028984348484, 0.712035216741967, 0.616954785536566),
        (5.863562952890564, 12.111052737620941, -10.791570054248687),
        -4.108854590420174e-10,
    ),
}


@pytest.mark.parametrize("name", FAR_APART)
def test_balls_whose_moments_differ_by_many_orders(name) -> None:
    inertia, d, gamma, M, time = FAR_APART[name]
    ball = ChaplyginBall(inertia, d)
    run = ball.flow(ball.state(gamma, M), kernel="compiled").at([time, 1e9 * time])
    right = reference.taylor(ball.body, restored(MP(50), gamma, M, tilted=False), [time], digits=30)
    # long doubles, for a swing of θ during which φ turns 4e5 times as fast
    assert np.abs(run.gamma[0] - right.gamma[0].astype(float)).max() < 1e-13
    assert np.abs(run.M[0] - right.M[0].astype(float)).max() < 1e-13 * np.linalg.norm(M)
    alone = ball.flow(ball.state(gamma, M), kernel="compiled").at([time])
    assert np.array_equal(alone.gamma[0], run.gamma[0])


def restored(K, gamma, M, tilted):
    """The doubles of a state with |γ| = 1 and, if it is upright, (γ, M) = 0 to the last digit."""
    g, m = [K.coerce(x) for x in gamma], [K.coerce(x) for x in M]
    length = K.sqrt(K.dot(g, g))
    g = [x / length for x in g]
    lean = 0 if tilted else K.dot(g, m)
    return State(tuple(g), tuple(x - lean * y for x, y in zip(m, g, strict=True)))


BALLS = {
    "prolate": ((3, 3, 2), 1.0, (2 / 3, 2 / 3, 1 / 3), (-1, -2 / 3, 10 / 3), False),
    "prolate, first axis": ((0.7, 1.9, 1.9), 2.5, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "oblate": ((1, 2, 1), 0.7, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "prolate, tilted": ((3, 3, 2), 1.0, (2 / 3, 2 / 3, 1 / 3), (1, -2, 0.5), True),
    "oblate, tilted": ((1, 1, 2), 0.7, (0.48, 0.6, 0.64), (-0.3, 1.5, 0.4), True),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", BALLS)
def test_a_ball_with_two_equal_moments_agrees_with_taylor_series(name) -> None:
    inertia, d, gamma, M, tilted = BALLS[name]
    ball = ChaplyginBall(inertia, d)
    flow, times = ball.flow(ball.state(gamma, M, tilted=tilted), kernel="compiled"), [5.0, -3.0]
    right = reference.taylor(ball.body, restored(MP(40), gamma, M, tilted), times, digits=18)
    run = flow.at(times)
    assert np.abs(run.gamma - right.gamma.astype(float)).max() < 1e-14
    assert np.abs(run.M - right.M.astype(float)).max() < 3e-14


@pytest.mark.parametrize("name", BALLS)
def test_the_closed_form_of_a_ball_is_the_motion_on_its_torus(name) -> None:
    inertia, d, gamma, M, tilted = BALLS[name]
    ball = ChaplyginBall(inertia, d)
    flow = ball.flow(ball.state(gamma, M, tilted=tilted), kernel="compiled")
    times = np.array([0.0, 1.3, -7, 50, 1e4, -3e5])
    run = flow.at(times)
    assert run.way == SymmetricFlow.way
    (rows, tau), (expected, expected_tau) = (np.hstack([run.gamma, run.M]), run.tau), torus_of(flow).at(times)
    assert np.abs(rows - expected).max() < 4e-15
    assert tau == pytest.approx(expected_tau, rel=1e-15, abs=1e-16)
    assert flow.at_tau(tau).gamma == pytest.approx(torus_of(flow).at_tau(tau)[:, :3], abs=4e-15)
    assert flow.physical_time(tau) == pytest.approx(times, rel=4e-16, abs=1e-15)


SPECIAL = {
    "about the axis": ((1, 3, 3), 0.5, (0, 0.6, 0.8), (1, 0, 0), False),
    "the axis vertical": ((1, 3, 3), 0.5, (1, 0, 0), (0, 0.6, 0.8), False),
    "across the axis": ((3, 1, 1), 0.5, (0.6, 0, 0.8), (0, 1, 0), False),
    "nearly across the axis": ((2, 2, 1), 0.5, (0.6, 0, 0.8), (0.8, 1e-9, -0.6), False),
    "a passage of the pole": ((2, 2, 1), 0.5, (0.6, 0, 0.8), (0.8, 1e-200, -0.6), False),
    "tilted, about the axis": ((2, 2, 1), 0.5, (0, 0.8, 0.6), (0, 0, 0.8), True),
    "tilted, the axis vertical": ((2, 2, 1), 0.5, (0, 0, 1.0), (1e-9, 0, 0.8), True),
    "three equal": ((1, 1, 1), 0.5, (0, 0.8, 0.6), (0.3, -0.6, 0.8), False),
    "three equal, tilted": ((1, 1, 1), 0.5, (0, 0.8, 0.6), (0.3, -0.5, 0.8), True),
    "a thin rod": ((2, 2, 1e-3), 1.0, (0.48, 0.6, 0.64), (0.384, 1.28, 1e-7), True),
    "heavy": ((2, 2, 3), 1e12, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "light": ((2, 2, 3), 1e-90, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488), False),
    "a disc": ((2, 2, 1e3), 1.0, (0.48, 0.6, 0.64), (0.384, 1.28, 1), True),
}


@pytest.mark.parametrize("name", SPECIAL)
def test_special_motions_with_two_equal_moments(name) -> None:
    inertia, d, gamma, M, tilted = SPECIAL[name]
    ball = ChaplyginBall(inertia, d)
    state = ball.state(gamma, M, tilted=tilted)
    times = [0.0, 0.1, -0.2, 1.5]
    K = MP(40)
    g, m = [K.coerce(x) for x in gamma], [K.coerce(x) for x in M]
    length, lean = K.sqrt(K.dot(g, g)), K.zero if tilted else K.dot(g, m)
    g, m = [x / length for x in g], [x - lean * y for x, y in zip(m, g, strict=True)]
    right = reference.taylor(ball.body, State(tuple(g), tuple(m)), times, digits=18)
    run = ball.flow(state, kernel="compiled").at(times)
    assert np.abs(run.gamma - right.gamma.astype(float)).max() < 3e-16
    assert np.abs(run.M - right.M.astype(float)).max() < 1e-15
    # the default is a short run, or the same closed form if M is along an axis or all moments are equal
    near = ball.flow(state).at(times)
    assert np.abs(near.gamma - run.gamma).max() < 4e-15
    assert np.abs(near.M - run.M).max() < 4e-15


@pytest.mark.parametrize("tilted", [False, True])
def test_near_times_do_not_wait_for_the_closed_form(tilted) -> None:
    rng, quick = np.random.default_rng(31), 0
    for _ in range(40):
        inertia, _, gamma, M, _ = random_top(rng)
        M = np.array(M) if tilted else np.array(M) - np.dot(M, gamma) * np.array(gamma)
        ball = ChaplyginBall(inertia, 10 ** rng.uniform(-2, 1))
        state = ball.state(gamma, M.tolist(), tilted=tilted)
        times = rng.uniform(-20, 20, 5) / np.linalg.norm(ball.omega(state))
        near, right = ball.flow(state).at(times), ball.flow(state, kernel="compiled").at(times)
        assert right.way == "closed form"
        quick += near.way == "short run"
        assert np.abs(near.gamma - right.gamma).max() < 3e-14
        assert np.abs(near.M - right.M).max() < 3e-14 * np.linalg.norm(M)
        assert near.tau == pytest.approx(right.tau, rel=1e-14)
    assert quick > 25


def test_a_symmetric_body_too_far_away_is_refused() -> None:
    top = EulerTop((1, 3, 3))
    flow = top.flow(top.state((2 / 3, -1 / 3, 2 / 3), (-2.0, -2.0, 1.0)))
    with pytest.raises(PrecisionLoss, match=r"time 1e\+300: .* turns of a phase"):
        flow.at([1.0, 1e300])


@pytest.mark.parametrize("d", [0, 0.6])
def test_few_turns_of_a_tiny_momentum_are_not_too_far_away(d) -> None:
    """M is orthogonal to the axis: φ only jumps, so that its mean rate is 0 and no time is far."""
    rows = []
    for unit in (1, 1e-30):
        ball = ChaplyginBall((1, 30, 1), d) if d else EulerTop((1, 30, 1))
        flow = ball.flow(ball.state((0, 1, 0), (-0.125 * unit, 0, 0.75 * unit)), kernel="compiled")
        run = flow.at(np.array([-90, 0.5, 30]) / unit)
        rows.append(np.hstack([run.gamma, run.M / unit, run.tau[:, None] * unit]))
    assert rows[1] == pytest.approx(rows[0], rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("loops", [lambda setup: CompiledLoops(), ReadableLoops])
def test_the_start_of_every_region_is_met_by_its_torus(loops) -> None:
    # ζ below and above the middle axis, for every order of the moments
    for inertia in ((1, 2, 3), (3, 1, 2), (2, 3, 1)):
        ball = ChaplyginBall(inertia, 0.7)
        for gamma, M in (
            ((0.6, 0.0, 0.8), (0.8, 0.5, -0.6)),
            ((0.0, 0.6, 0.8), (2, 0.8, -0.6)),
            ((0.6, 0.8, 0), (0.08, -0.06, 2)),
        ):
            setup = ball.flow(ball.state(gamma, M)).setup
            assert TorusFlow(setup, loops(setup)).closure < 1e-28


def test_a_start_at_the_end_of_the_swing_of_a_body_that_hardly_spins() -> None:
    # found by fuzz: rounding took θ beyond π/2, which changed φ by 7e-12
    inertia, d = (53053.053061136634, 53053.053061136634, 46219.24961653579), 0.002017929182472763
    gamma, M = (0.0, -0.19033512337582564, 0.9817191761443337), (0.0, 104198.09836584321, 0.0)
    ball, times = ChaplyginBall(inertia, d), [-0.004174995157132701, 0.07, 19.0]
    run = ball.flow(ball.state(gamma, M, tilted=True)).at(times)
    right = reference.taylor(ball.body, restored(MP(40), gamma, M, tilted=True), times, digits=20)
    assert np.abs(run.gamma - right.gamma.astype(float)).max() < 1e-14
    assert np.abs(run.M - right.M.astype(float)).max() < 1e-14 * M[1]


def test_a_tilted_needle_whose_clock_swings_widely() -> None:
    # found by fuzz: the clock of θ may deviate from its mean by more than θ − θ₀
    inertia, d = (0.05786006517951956, 569825497814.925, 569825497814.925), 12862.788305941547
    gamma = (-0.4462505273466137, 0.8948980184244874, 0.0042430487618258135)
    M = (-0.005203122456366258, -0.007587598710789265, -0.002102423055535908)
    ball, times = ChaplyginBall(inertia, d), [-1405.2014433516497, 4424344.386216561]
    run = ball.flow(ball.state(gamma, M, tilted=True)).at(times)
    right = reference.taylor(ball.body, restored(MP(50), gamma, M, tilted=True), times, digits=25)
    assert np.abs(run.gamma - right.gamma.astype(float)).max() < 1e-14
    assert np.abs(run.M - right.M.astype(float)).max() < 1e-16
