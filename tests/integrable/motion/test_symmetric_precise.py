"""Two or three equal moments over MP(digits): the closed form compared with additions, more digits, and rotations."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.flow import Flow
from integrable.motion.symmetric import SymmetricFlow
from integrable.motion.symmetric_precise import PreciseClosedForm
from integrable.phase.brackets import over
from jacobian import MP, RR
from jacobian.errors import PrecisionLoss
from tests.fuzz.closed_forms import EqualMoments, SymmetricTop
from tests.fuzz.distributions import equal_moments, motion, symmetric_moments
from tests.integrable.ways import precise_of

K = MP(30)
UPRIGHT, TILTED = ("0.384", "1.28", "-1.488"), ("1", "1.28", "-1.488")
# inertia, d, γ, M
BODIES = {
    "top": ((1, 3, 3), 0, ("0.48", "0.6", "0.64"), UPRIGHT),
    "tilted top": ((3, 1, 3), 0, ("0.48", "0.6", "0.64"), TILTED),
    "prolate ball": ((1, 3, 3), "0.7", ("0.48", "0.6", "0.64"), UPRIGHT),
    "tilted ball": ((3, 1, 3), "0.7", ("0.48", "0.6", "0.64"), TILTED),
    "heavy oblate ball": ((3, 3, 7), "50", ("0.48", "0.6", "0.64"), TILTED),
    "heavy prolate ball": ((3, 3, "0.07"), "50", ("0.48", "0.6", "0.64"), TILTED),
    "three equal": ((3, 3, 3), "50", ("0.48", "0.6", "0.64"), TILTED),
    "over the pole": ((2, 2, 3), "0.7", ("0", "0", "1"), ("1", "1.28", "0")),
    "about the axis": ((2, 2, 3), "0.7", ("0.6", "0.8", "0"), ("0", "0", "1")),
    "about the axis, prolate": ((2, 2, 1), "0.7", ("0.6", "0.8", "0"), ("0", "0", "1")),
    "just off the axis": ((2, 2, 1), "0.7", ("0.6", "0.8", "0"), ("-8e-25", "6e-25", "1")),
}


def _flow(name, field=K):
    inertia, d, gamma, M = BODIES[name]
    numbers = [field.coerce(x) for x in inertia]
    system = ChaplyginBall(numbers, field.coerce(d), field=field) if d else EulerTop(numbers, field=field)
    return system.flow(system.state(gamma, M, tilted=M is TILTED))


def _gap(run, other) -> float:
    size = max(map(abs, run.M.ravel()))
    return float(max(abs(run.gamma - other.gamma).max(), abs(run.M - other.M).max() / size))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", BODIES)
def test_near_the_start_it_is_what_additions_give(name) -> None:
    """The additions of :mod:`integrable.motion.precise` do not treat equal moments specially."""
    flow, times = _flow(name), [K.coerce(x) for x in ("0.5", "-3.25", "7")]
    run = flow.at(times)
    rows, tau = precise_of(flow).at(np.array(times, dtype=object))
    assert abs(np.hstack([run.gamma, run.M]) - rows).max() <= 1e-29
    assert abs(run.tau - tau).max() <= 1e-28
    # from τ back to the states and to t
    assert _gap(flow.at_tau(run.tau), run) <= 1e-28
    assert abs(flow.physical_time(run.tau) - run.times).max() <= 1e-28


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", BODIES)
def test_far_away_two_precisions_agree(name) -> None:
    flow = _flow(name)
    # the same numbers: projected onto the constraints again they would differ by 1e-51
    wider = Flow(over(flow.system, MP(50)), flow.state)
    times = [K.coerce("1e40"), K.coerce("-3e7")]
    assert _gap(flow.at(times), wider.at(times)) <= 1e-29
    assert _gap(flow.at_tau(times), wider.at_tau(times)) <= 1e-29


@pytest.mark.parametrize(("moments", "oracle", "rolls"), [
    (symmetric_moments, SymmetricTop, False), (equal_moments, EqualMoments, True)
])  # fmt: skip
def test_far_away_it_is_a_product_of_rotations(moments, oracle, rolls) -> None:
    """Three equal moments at t = 5700 used to take 14.5 s. At 10^30 turns the oracle has 100 digits."""
    rng = Random(5)
    for _ in range(6):
        start = motion(rng, moments(rng), rolls=rolls, tilted=True)
        system = ChaplyginBall(start.inertia, start.d, field=K) if rolls else EulerTop(start.inertia, field=K)
        gamma = [K.coerce(x) for x in start.gamma]
        size = K.sqrt(K.dot(gamma, gamma))
        state = system.state([x / size for x in gamma], start.M, tilted=True)
        times = [K.coerce(x) / start.speed for x in (5700, -1e30)]
        run, exact = system.flow(state).at(times), oracle(replace(start, gamma=state.gamma), 100)
        for row, true in zip(np.hstack([run.gamma, run.M / exact.length]), exact.wide_rows(times), strict=True):
            assert max(abs(x - y) for x, y in zip(row, true, strict=True)) <= 1e-28


@pytest.mark.parametrize("name", ["prolate ball", "tilted ball", "heavy prolate ball", "just off the axis"])
def test_floats_are_its_first_digits(name) -> None:
    wide = _flow(name)
    system = ChaplyginBall(*(tuple(map(float, BODIES[name][0])), float(BODIES[name][1])))
    floats = system.flow(system.state(*(list(map(float, v)) for v in BODIES[name][2:]), tilted=wide.state.tilted))
    assert floats.system.field == RR
    times = [1e3, -12345.0]
    assert abs(floats.at(times).gamma - wide.at(times).gamma.astype(float)).max() <= 1e-11


def test_a_clock_that_contradicts_the_states_is_refused(monkeypatch) -> None:
    """t(τ) is compared with τ(t); digits that do not help end in a refusal, and a time of 10^300 turns does not."""
    true = SymmetricFlow.times
    monkeypatch.setattr(PreciseClosedForm, "most_lost", 50)
    assert np.isfinite(float(_flow("tilted ball").at([K.coerce("1e300")]).gamma[0, 0]))
    monkeypatch.setattr(SymmetricFlow, "times", lambda form, tau: true(form, tau) * (1 + form.numbers.eps**0 / 10**20))
    with pytest.raises(PrecisionLoss, match="loses more than"):
        _flow("tilted ball").physical_time([1])
