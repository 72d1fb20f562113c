"""Rotations about a principal axis: floats reach any time, also about the middle axis."""

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.flow import Flow
from integrable.motion.precise import PreciseFlow
from integrable.motion.symmetric import SymmetricFlow
from integrable.oracles.reference import taylor
from jacobian import MP
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
    assert flow.at([1.0]).way == SymmetricFlow.way
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
    """About the middle axis these used to be refused after seconds."""
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


@pytest.mark.parametrize("start", STATES.values(), ids=STATES)
@pytest.mark.parametrize("system", SYSTEMS.values(), ids=SYSTEMS)
def test_multiprecision_has_them_at_any_time(system, start):
    """About the middle axis 1000 units of time used to be refused: 415 digits are lost."""
    rows = {}
    for digits in (30, 50):
        K = MP(digits)
        wide = type(system)(system.inertia, *([system.d] if system.d else []), field=K)
        # the floats nearest to 0.6 and 0.8 do not make an exact unit vector
        length = K.sqrt(sum(K.coerce(x) ** 2 for x in start[0]))
        state = wide.state([K.coerce(x) / length for x in start[0]], start[1])
        flow = wide.flow(state)
        run = flow.at([3, -7, "1e6", "-1e12"])
        assert run.way == "closed form"
        assert max(abs(x - y) for x, y in zip(flow.at_tau(run.tau).gamma.flat, run.gamma.flat, strict=True)) < 1e-17
        back = flow.physical_time(run.tau[:2])
        assert max(abs(x - y) for x, y in zip(back, (3, -7), strict=True)) < 10.0 ** (2 - digits)
        near = PreciseFlow(wide.body, state, digits)
        for row, (gamma, _) in zip(run.gamma, near.vectors(near.at_tau(run.tau[:2].tolist())), strict=False):
            assert max(abs(x - y) for x, y in zip(row, gamma, strict=True)) < 10.0 ** (2 - digits)
        assert (np.array(state.M) == run.M).all()
        rows[digits] = run
    gaps = [abs(K.coerce(x) - y) for x, y in zip(rows[30].gamma.flat, rows[50].gamma.flat, strict=True)]
    assert max(gaps) < 1e-29
    assert max(abs(K.coerce(x) / y - 1) for x, y in zip(rows[30].tau, rows[50].tau, strict=True)) < 1e-28
