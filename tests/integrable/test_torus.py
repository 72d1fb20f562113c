"""Physical time on the torus: against the clock that counts steps, against more digits, and at any distance."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall
from integrable.periods import ovals, translation
from integrable.torus import TorusClock
from jacobian import MP
from jacobian.errors import ArgumentError, PrecisionLoss

BALL = ChaplyginBall((1, 2, 3), 0.7)
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
# γ2 = 0: u1 is at a branch point, like the half periods
AT_A_BRANCH_POINT = ((0.6, 0.0, 0.8), (0.8, 0.5, -0.6))


def exact(digits: int, start):
    """The same motion from the floats of a start, at more digits."""
    K = MP(digits)
    ball = ChaplyginBall((1, 2, 3), 0.7, field=K)
    gamma, M = ([K.coerce(x) for x in v] for v in start)
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    return ball.flow(ball.state(gamma, [m - tilt * x for m, x in zip(M, gamma, strict=True)]))


@pytest.mark.parametrize("start", [START, AT_A_BRANCH_POINT], ids=["generic", "branch point"])
def test_the_torus_agrees_with_counting_steps(start) -> None:
    flow = BALL.flow(BALL.state(*start))
    times = [-900.0, -1.0, 0.0, 3.0, 1000.0]
    run = flow.at(times)
    assert isinstance(flow._torus_clock, TorusClock)
    counting = BALL.flow(BALL.state(*start))
    counting._torus_clock = False
    steps = counting.at(times)
    assert np.abs(run.gamma - steps.gamma).max() < 2e-10
    assert np.abs(run.tau - steps.tau).max() < 2e-10


@pytest.mark.slow
def test_far_times_in_floats_against_45_digits() -> None:
    """T up to 10^12: the error does not grow with T."""
    times = [1e4, 1e6, 1e9, 1e12]
    found = BALL.flow(BALL.state(*AT_A_BRANCH_POINT)).at(times).gamma
    truth = exact(45, AT_A_BRANCH_POINT).at(times).gamma
    assert np.abs(found - truth.astype(float)).max() < 1e-12


def test_times_and_the_times_of_the_flow_are_inverse_far_away() -> None:
    flow = BALL.flow(BALL.state(*START))
    times = np.array([-1e5, 2e3, 1e5])
    tau = flow.at(times).tau
    assert flow.physical_time(tau) == pytest.approx(times, rel=1e-15, abs=1e-10)


def test_half_periods_are_differences_of_branch_points() -> None:
    """T(Λ_k/2) has order two: its V' vanishes, and U' has branch points as roots (formulas.md, section 3)."""
    setup = BALL.flow(BALL.state(*START)).setup
    for low, high, period in ovals(setup):
        u0, u1, v0, v1 = translation(setup, [c / 2 for c in period])[:4]
        for e in (low, high):
            assert abs(u0 + u1 * e + e * e) < 1e-30
        assert max(abs(v0), abs(v1)) < 1e-30


def test_a_period_leads_back_up_to_signs() -> None:
    setup = BALL.flow(BALL.state(*START)).setup
    for oval in ovals(setup):
        third = translation(setup, [c / 3 for c in oval.periods])
        point = setup.wide_start
        for _ in range(3):
            point = setup.moved(third, point)
        for i in range(4):
            assert abs(point[i] - setup.wide_start[i]) < 1e-30
        for i in range(4, 10):
            assert abs(abs(point[i]) - abs(setup.wide_start[i])) < 1e-30


@pytest.mark.parametrize(
    ("inertia", "gamma", "M"),
    [((1, 1, 2), *START), ((1, 2, 3), (0, 0, 1), (1, 0, 0)), ((1, 2, 3), (0, 0, 1), (0, 1, 0))],
    ids=["equal moments", "relative equilibrium", "separatrix"],
)
def test_a_degenerate_torus_is_left_to_the_clock_that_counts_steps(inertia, gamma, M) -> None:
    ball = ChaplyginBall(inertia, 0.7)
    flow = ball.flow(ball.state(gamma, M))
    with pytest.raises(PrecisionLoss, match="shrunk to a point"):
        TorusClock(flow.setup)
    run = flow.at([40.0])
    assert run.integrals.H1[0] == pytest.approx(ball.integrals(ball.state(gamma, M)).H1, rel=1e-8)
    with pytest.raises(ArgumentError, match=r"times.*basic steps.*50000000"):
        flow.at([1e12])


def test_a_motion_beyond_floats_is_refused_and_not_made_up() -> None:
    """On the separatrix e^(λt) outgrows every digit: by t = 400 an addition would leave the level set."""
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0, 0, 1), (0, 1, 0)))
    with pytest.raises(PrecisionLoss, match="row 1: H1 and H2 are off"):
        flow.at([1.0, 400.0])
