"""Panels of Chebyshev series, and the times at which a function of the state vanishes."""

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.torus.panels import Panels, panel_integrals, zeros
from jacobian import MP
from jacobian.errors import ArgumentError, PrecisionLoss

BALL = ChaplyginBall(inertia=(1, 2, 3), d=0.5)
TOP = EulerTop(inertia=(1, 2, 3))
GAMMA, M = (0.6, 0.0, 0.8), (0.8, 1.0, -0.6)


def test_panels_hold_a_function_its_integral_and_its_zeros():
    panels = Panels(lambda t: (np.exp(-t / 5) * np.cos(3 * t))[:, None], 0.0, 10.0, 4.0)
    times = np.linspace(0, 10, 57)
    exact = (np.exp((3j - 0.2) * times) - 1) / (3j - 0.2)
    assert np.abs(panel_integrals(panels, times)[:, 0] - exact.real).max() < 1e-14
    found, slopes, _ = zeros(panels)
    assert np.abs(found - (np.arange(len(found)) + 0.5) * np.pi / 3).max() < 1e-12
    assert len(found) == 10
    assert (np.sign(slopes) == [-1, 1] * 5).all()


def test_a_narrow_peak_is_resolved_by_halving():
    panels = Panels(lambda t: 1 / ((t[:, None] - 0.3) ** 2 + 1e-4), -1.0, 1.0, 2.0)
    assert abs(panel_integrals(panels, np.array([1.0]))[0, 0] - 100 * (np.arctan(70) + np.arctan(130))) < 1e-10


def test_a_jump_is_refused():
    with pytest.raises(PrecisionLoss, match="no Chebyshev series"):
        Panels(lambda t: np.sign(t[:, None] - 0.3), 0.0, 1.0, 1.0)


def test_rounding_is_refused_before_it_is_halved_away():
    """Panels whose convergence only rounding prevented were halved twelve times, into 4095 panels."""
    rng, asked = np.random.default_rng(3), 0

    def noisy(t):
        nonlocal asked
        asked += len(t)
        return (np.cos(t) + 1e-11 * rng.standard_normal(len(t)))[:, None]

    with pytest.raises(PrecisionLoss, match="rounding is more than"):
        Panels(noisy, 0.0, 2.0, 2.0)
    assert asked <= 28 * (2**6 - 1)


@pytest.mark.parametrize("system", [BALL, TOP], ids=["ball", "top"])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_vertical_in_a_coordinate_plane(system, axis):
    flow = system.flow(system.state(GAMMA, M))
    found = flow.events(lambda gamma, M: gamma[:, axis], 0, 30)
    assert np.abs(found.gamma[:, axis]).max() < 1e-13
    # every sign change of a dense sample, and the start where γ₂ = 0 there
    sample = flow.at(np.linspace(0, 30, 4001))
    changes = np.flatnonzero(np.diff(np.sign(sample.gamma[1:, axis]))) + 1
    times = found.times[found.times > 1e-9]
    assert len(times) == len(changes) > 3
    assert ((sample.times[changes] <= times) & (times <= sample.times[changes + 1])).all()
    assert (len(found) - len(times)) == (axis == 1)


def test_rising_and_falling_zeros_are_all_zeros():
    flow = BALL.flow(BALL.state(GAMMA, M))
    level = lambda gamma, M: M[:, 2] - 0.1  # noqa: E731
    up, down, both = (flow.events(level, 5, 90, direction=k).times for k in (1, -1, 0))
    assert min(len(up), len(down)) > 2
    assert np.allclose(np.sort(np.concatenate([up, down])), both, rtol=0, atol=1e-12)
    later = flow.at(up + 1e-5)
    assert (level(later.gamma, later.M) > 0).all()


@pytest.mark.parametrize("speed", [1e-100, 1e-13, 1e13, 1e20])
def test_the_zeros_of_a_motion_are_those_of_a_slower_one(speed):
    """Times scale inversely with momenta: zeros are separated on the time scale of the motion."""
    count = len(BALL.flow(BALL.state(GAMMA, M)).events(lambda gamma, M: gamma[:, 2], 0, 30))
    flow = BALL.flow(BALL.state(GAMMA, tuple(speed * x for x in M)))
    found = flow.events(lambda gamma, M: gamma[:, 2], 0, 30 / speed)
    assert len(found) == count > 5
    assert np.abs(found.gamma[:, 2]).max() < 1e-13


def test_two_zeros_at_the_edge_of_two_panels_are_two():
    edge = 2.0**-30

    def level(t):
        return ((t - 1) ** 2 - edge**2)[:, None]

    found, slopes, halves = zeros(Panels(level, 0.0, 2.0, 1.0))
    assert np.allclose(found - 1, [-edge, edge], rtol=1e-3)
    assert (np.sign(slopes) == [-1, 1]).all()
    assert (halves == 0.5).all()


def test_a_heavy_body_spins_faster_than_its_momentum_says():
    heavy = ChaplyginBall((1, 2, 3), 1e6)
    flow = heavy.flow(heavy.state(GAMMA, (0.9, 1.0, 0.3), tilted=True))
    # with a length chosen by |M| alone, 10⁶, the series of panels do not converge
    found = flow.events(lambda gamma, M: M[:, 0], 0, 1e3)
    sample = flow.at(np.linspace(0, 1e3, 20001)).M[:, 0]
    assert len(found) == (np.diff(np.sign(sample)) != 0).sum() > 3


def test_times_whose_neighbours_are_too_far_apart_are_refused_by_name():
    flow = BALL.flow(BALL.state(GAMMA, M))
    with pytest.raises(PrecisionLoss, match=r"start = 10+\.0, end = .* floats near these times are 1\.2e-01 apart"):
        flow.events(lambda gamma, M: gamma[:, 2], 1e15, 1e15 + 10)


def test_no_zero_gives_an_empty_run():
    flow = BALL.flow(BALL.state(GAMMA, M))
    assert len(flow.events(lambda gamma, M: gamma[:, 0] + 2, 0, 20)) == 0


def test_zeros_far_away_and_before_the_start():
    flow = BALL.flow(BALL.state(GAMMA, M))
    found = flow.events(lambda gamma, M: gamma[:, 2], 1e6, 1e6 + 20)
    # a time near 1e6 is rounded to 1e-10
    assert len(found) > 3
    assert np.abs(found.gamma[:, 2]).max() < 1e-9
    before = flow.events(lambda gamma, M: gamma[:, 2], -20, 0)
    assert len(before) > 3
    assert np.abs(before.gamma[:, 2]).max() < 1e-13


def test_zeros_in_multiprecision():
    K = MP(40)
    ball = ChaplyginBall(inertia=(1, 2, 3), d="0.5", field=K)
    flow = ball.flow(ball.state(("0.6", 0, "0.8"), ("0.8", 1, "-0.6")))
    found = flow.events(lambda gamma, M: gamma[:, 2], 0, 6)
    floats = BALL.flow(BALL.state(GAMMA, M))
    same = floats.events(lambda gamma, M: gamma[:, 2], 0, 6)
    assert max(abs(x) for x in found.gamma[:, 2]) < 1e-38
    assert np.abs(found.times.astype(float) - same.times).max() < 1e-12


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((5, 5), r"start = 5, end = 5: a time after start"),
        ((0, 5, 2), r"direction = 2: 1 for rising zeros"),
    ],
)
def test_bad_arguments(arguments, message):
    flow = BALL.flow(BALL.state(GAMMA, M))
    with pytest.raises(ArgumentError, match=message):
        flow.events(lambda gamma, M: gamma[:, 0], *arguments)


def test_a_condition_gives_one_number_a_state():
    flow = BALL.flow(BALL.state(GAMMA, M))
    with pytest.raises(ArgumentError, match=r"condition: values of shape \(\d+, 3\) for \d+ states"):
        flow.events(lambda gamma, M: gamma, 0, 5)


def test_a_condition_is_a_function():
    flow = BALL.flow(BALL.state(GAMMA, M))
    with pytest.raises(ArgumentError, match="condition = 3: give a function"):
        flow.events(3, 0, 5)
