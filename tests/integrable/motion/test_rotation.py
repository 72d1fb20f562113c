"""Rotations about a principal axis: floats have them at any time, also about the middle one."""

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.flow import Flow
from integrable.motion.rotation import PrincipalRotation
from integrable.oracles.reference import taylor
from jacobian.errors import PrecisionLoss

SYSTEMS = {"ball": ChaplyginBall((1, 2, 3), 0.7), "heavy": ChaplyginBall((3, 1, 2), 50.0), "top": EulerTop((3, 1, 2))}
STATES = {
    "first": ((0, 0.6, 0.8), (1.25, 0, 0)),
    "second": ((0.6, 0, -0.8), (0, -1.25, 0)),
    "third": ((0.28, -0.96, 0), (0, 0, 2)),
}


@pytest.mark.parametrize("start", STATES.values(), ids=STATES)
@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_near_the_start_it_is_what_a_taylor_series_gives(system, start):
    state = system.state(*start)
    flow = system.flow(state)
    assert isinstance(flow._way_to(np.array([1.0]), True), PrincipalRotation)
    run, true = flow.at([3.0, -7.0]), taylor(system, state, [3.0, -7.0], digits=25)
    assert abs(run.gamma - true.gamma.astype(float)).max() < 1e-15
    assert abs(run.M - true.M.astype(float)).max() < 1e-14
    # τ and back
    assert abs(flow.at_tau(run.tau).gamma - run.gamma).max() < 1e-14
    assert abs(flow.physical_time(run.tau) - run.times).max() < 1e-14
    if system.d:
        tau, step = np.array([2.0]), 1e-4
        later, sooner = (flow.physical_time(tau + s) for s in (step, -step))
        gamma = flow.at_tau(tau).gamma[0]
        slowness = gamma**2 @ np.array(system.body.contact)
        assert abs((later - sooner)[0] / (2 * step) - slowness**0.5) < 1e-7


def test_far_away_and_beyond_the_digits():
    """These were refused after seconds, about the middle axis."""
    system = ChaplyginBall((36.25874119771842, 8.372158690428956, 17.11369844447391), 2.324797238800649)
    state = system.state((-1.0, 0.0, 0.0), (0.0, 0.0, 823.8684484500192))
    flow: Flow = system.flow(state)
    run = flow.at([1e6, -1e10])
    rate = 823.8684484500192 / (17.11369844447391 + 2.324797238800649)
    angle = np.array([1e6, -1e10]) * rate
    # γ̇ = γ×ω; the rounding of the rate is an angle
    assert abs(run.gamma[0] - [-np.cos(angle[0]), np.sin(angle[0]), 0]).max() < 1e-7
    assert (abs(np.linalg.norm(run.gamma, axis=1) - 1) < 1e-15).all()
    assert (run.M == state.M).all()
    with pytest.raises(PrecisionLoss, match="turns of a phase"):
        flow.at([1e17])
