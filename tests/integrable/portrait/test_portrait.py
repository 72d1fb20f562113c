"""The global quantities of a motion compared with means over long runs and integrals by other rules."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.portrait.ovals import Level, Ovals
from jacobian import MP
from jacobian.errors import NotRepresentable, PrecisionLoss

GAMMA = (0.48, 0.6, 0.64)
BALL = ChaplyginBall((1, 2, 3), 0.7)
CASES = {
    "low": (BALL, (0.384, 1.28, -1.488)),
    "high": (ChaplyginBall((2, 3.1, 4.2), 9.72), (3, 2, -4)),
    "unsorted": (ChaplyginBall((3, 1, 2), 0.7), (0.1, 2, 0.3)),
    "two equal": (ChaplyginBall((2, 3, 2), 0.7), (0.1, 2, 0.3)),
    "top": (EulerTop((3, 1, 2)), (0.1, -2, 0.3)),
    "top, low": (EulerTop((1.5, 2, 3)), (0.3, 0.4, -2)),
}


def flow_of(name):
    system, M = CASES[name]
    return system.flow(system.state(GAMMA, M, tilted=True))


def mean_turning(angles, times):
    """Radians per unit time, by a mean whose weight vanishes at both ends with all derivatives."""
    x = np.linspace(0, 1, len(times))[1:-1]
    weight = np.exp(-1 / (x * (1 - x)))
    rates = np.gradient(np.unwrap(angles), times)[1:-1]
    return weight @ rates / weight.sum()


@pytest.mark.parametrize("name", CASES)
def test_means_of_a_long_run(name):
    flow = flow_of(name)
    p = flow.portrait
    run = flow.at(np.linspace(0, 2000, 16001))
    tilt = flow.setup.tilt
    k, lean = (float(tilt.k), float(tilt.shift)) if tilt else (0.0, 0.0)
    gamma, M = run.gamma + k * run.M, run.M - lean * run.gamma
    i, j, k = p.axis, (p.axis + 1) % 3, (p.axis + 2) % 3
    assert abs(mean_turning(np.arctan2(gamma[:, k], gamma[:, j]), run.times) - p.spin) < 1e-5
    assert abs(mean_turning(np.arctan2(M[:, k], M[:, j]), run.times) - p.polhode) < 1e-5
    # M̃ is constant in space; a second constant vector gives the azimuth of the axis about M̃
    unit = M[0] / np.linalg.norm(M[0])
    still = run.attitude
    z = still[0] @ unit
    x = np.cross(z, [0, 1, 0])
    x /= np.linalg.norm(x)
    axis = still[:, :, i]
    assert abs(mean_turning(np.arctan2(axis @ np.cross(z, x), axis @ x), run.times) - p.precession) < 1e-5
    spin = np.sum(run.gamma * run.omega, axis=1)
    x = np.linspace(0, 1, len(spin))[1:-1]
    weight = np.exp(-1 / (x * (1 - x)))
    assert abs(weight @ spin[1:-1] / weight.sum() - p.mean_spin) < 1e-6
    if flow.system.d:
        assert abs(weight @ np.gradient(run.tau, run.times)[1:-1] / weight.sum() - p.mean_g) < 1e-5
        assert abs(flow.at([1e9]).contact[0, 1] / 1e9 + p.drift) < 1e-8
    else:
        assert (p.drift, p.mean_g) == (None, 1)


@pytest.mark.parametrize("name", CASES)
def test_angles_go_on_with_the_frequencies(name):
    flow = flow_of(name)
    p, tau = flow.portrait, 2.7
    run = flow.at_tau([tau])
    there = flow.system.flow(flow.system.state(run.gamma[0], run.M[0], tilted=True)).portrait
    assert abs(np.array(there.actions) - p.actions).max() < 1e-13
    assert p.rotation_number == pytest.approx(p.frequencies[0] / p.frequencies[1], rel=1e-14)
    if p.region == "symmetric":
        with pytest.raises(NotRepresentable, match="does not know its angle"):
            _ = p.angles
        return
    gap = [(x - y - f * tau + 0.5) % 1 - 0.5 for x, y, f in zip(there.angles, p.angles, p.tau_frequencies, strict=True)]
    assert abs(np.array(gap)).max() < 1e-13


def test_actions_are_those_whose_derivatives_are_the_frequencies():
    """H1/2 generates τ: its derivatives with respect to J are 2πν, by differences at 40 digits."""
    K = MP(40)
    ball = ChaplyginBall((1, 2, 3), "0.7", field=K)

    def portrait(M):
        gamma = tuple(K.coerce(x) for x in ("0.48", "0.6", "0.64"))
        M = tuple(K.coerce(x) for x in M)
        c = K.dot(gamma, M)
        state = ball.state(gamma, tuple(m - c * x for m, x in zip(M, gamma, strict=True)))
        return ball.flow(state).portrait, ball.integrals(state).H1

    (p, h), step = portrait(("0.384", "1.28", "-1.488")), K.coerce("1e-12")
    for shift in ((1, 0, 0), (0, 1, 0)):
        moved = [K.coerce(x) + step * n for x, n in zip(("0.384", "1.28", "-1.488"), shift, strict=True)]
        q, other = portrait(moved)
        change = sum(
            2 * K.context.pi * abs(f) * (b - a) for f, a, b in zip(p.tau_frequencies, p.actions, q.actions, strict=True)
        )
        assert abs((other - h) / 2 - change) < 1e-22


def test_at_rest_on_the_axes_and_on_the_separatrix():
    state = BALL.state((0, 0.6, 0.8), (2, 0, 0))
    p = BALL.flow(state).portrait
    assert (p.region, p.axis) == ("rotation", 0)
    assert p.precession == pytest.approx(2 / 1.7, abs=1e-14) or p.spin == pytest.approx(-2 / 1.7, abs=1e-14)
    assert p.actions[1] == pytest.approx(0, abs=1e-30)
    p = BALL.flow(BALL.state((0.6, 0, 0.8), (0, 2, 0))).portrait
    assert (p.region, p.axis, p.precession, p.distance) == ("separatrix", None, None, 0)
    assert p.frequencies[0] == pytest.approx(2 / 2.7 / np.pi, abs=1e-15)
    with pytest.raises(NotRepresentable, match="its ovals have met"):
        _ = p.actions
    ball = ChaplyginBall((2, 2, 2), 0.7)
    p = ball.flow(ball.state(GAMMA, (0.1, 2, 0.3), tilted=True)).portrait
    assert p.region == "homogeneous"
    run = ball.flow(ball.state(GAMMA, (0.1, 2, 0.3), tilted=True)).at([10.0])
    assert p.mean_g == pytest.approx(run.tau[0] / 10, abs=1e-14)
    assert p.drift == pytest.approx(-run.contact[0, 1] / 10, abs=1e-14)


def test_the_mean_of_g_on_the_separatrix_is_that_of_the_rotation():
    flow = BALL.flow(BALL.state((0.6, 0, 0.8), (0, 2, 0)))
    assert flow.at([1e6]).tau[0] / 1e6 == pytest.approx(flow.portrait.mean_g, abs=1e-5)


@pytest.mark.parametrize("name", ["low", "high", "unsorted", "top"])
def test_levels_in_floats_are_those_of_a_motion(name):
    """Chaplygin's transformation follows from c²/H2 and ζ; its periods in floats are those of a set-up."""
    flow = flow_of(name)
    _, c, _, h2 = flow.system.integrals(flow.state)
    wide = Level.of(flow.setup)
    level = Level.at(flow.system.body, c * c / h2, float(wide.zeta))
    assert level.d == pytest.approx(float(wide.d), rel=1e-13)
    assert level.s == pytest.approx(float(wide.s), rel=1e-13)
    scale = h2**0.5
    assert level.momentum * scale == pytest.approx(float(wide.momentum), rel=1e-13)
    found, expected = Ovals.of(level), Ovals.of(wide)
    assert np.allclose(np.array(found[:4]) / scale, np.array(expected[:4], dtype=float), rtol=1e-11, atol=0)
    assert found.slowness == pytest.approx(float(expected.slowness), rel=1e-13)


def test_periods_on_the_separatrix_are_refused():
    level = Level.at(BALL.body, 0.25, BALL.a[1])
    with pytest.raises(PrecisionLoss, match="on the separatrix periods are infinite"):
        Ovals.of(level)
