"""Events, certificates and sensitivities of deformations, compared with dense samples, many digits and differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from integrable import Gyroscopic, Tilde
from integrable.deformations.integrated import IntegratedMotion
from integrable.portrait.sensitivity import by_differences
from jacobian import MP, RR
from jacobian.errors import ArgumentError, Infeasible, NotRepresentable, PrecisionLoss
from jacobian.immutable import replaced
from tests.integrable.deformed_systems import SYSTEMS

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
POLES = (0, 0, 0.25, 0.5, 0.125)
BOTH = {**SYSTEMS, "poles": lambda K: Tilde((1, 2, 4), potential=POLES, field=K)}
CURVES, INTEGRATED = ("tilde", "tilde, d", "check", "hat", "poles"), ("gyroscopic", "tilde, d, potential")


def motion(name, K=RR):
    system = BOTH[name](K)
    return system.motion_through(system.state(*START)) if K == RR else over(motion(name), K)


def over(flow, K):
    """The motion with the same numbers over a field of more digits; floats count as exact."""
    system = flow.system.over(K)
    return system.motion_through(replaced(flow.state, vectors=tuple(tuple(map(K.coerce, v)) for v in START)))


def rows(run):
    return np.hstack([run.gamma, run.M])


def level(gamma, M):
    return gamma[:, 1] * M[:, 0] - gamma[:, 0] / 4


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", [*CURVES, *INTEGRATED])
def test_events_are_the_zeros_of_a_dense_sample(name) -> None:
    flow, end = motion(name), 60 if name in CURVES else 20
    times = np.linspace(0, end, 400 * end + 1)
    run = flow.at(times)
    values = level(run.gamma, run.M)

    def at(time):
        run = flow.at([time])
        return float(level(run.gamma, run.M)[0])

    places = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))
    true = [brentq(at, times[i], times[i + 1], xtol=1e-14) for i in places]
    found = flow.events(level, 0, end)
    assert len(found) == len(true) > 2
    assert np.abs(found.times - true).max() < 1e-12
    rising = flow.events(level, 0, end, direction=1)
    assert np.array_equal(rising.times, found.times[values[places] < 0])


@pytest.mark.parametrize("name", ["tilde", "poles"])
def test_events_far_away(name) -> None:
    flow, far = motion(name), 1e6
    sample = flow.at(np.linspace(far, far + 40, 20001))
    found = flow.events(lambda gamma, M: M[:, 2], far, far + 40)
    assert len(found) == (np.diff(np.sign(sample.M[:, 2])) != 0).sum() > 3
    assert np.abs(found.M[:, 2]).max() < 1e-8


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["check", "gyroscopic"])
def test_events_in_many_digits(name) -> None:
    found = motion(name, MP(30)).events(level, 0, 5)
    assert np.abs(found.times.astype(float) - motion(name).events(level, 0, 5).times).max() < 1e-13
    assert len(found) > 0
    assert max(abs(level(found.gamma, found.M))) < 1e-28


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", [*CURVES, *INTEGRATED])
def test_a_certificate_has_the_errors_of_the_states(name) -> None:
    flow, times = motion(name), [0.5, -0.25] if name in INTEGRATED else [0.5, -1.25, 1e3 if name == "tilde, d" else 1e6]
    found = flow.certify(times)
    assert found == replaced(flow.at(times), error=found.error, digits=found.digits)
    assert (found.digits >= 15).all()
    apart = np.abs(rows(found) - rows(motion(name, MP(40)).at(times))).astype(float)
    errors = np.maximum(apart[:, :3].max(axis=1), apart[:, 3:].max(axis=1) / np.abs(found.M).max(axis=1))
    assert np.allclose(found.error, errors, rtol=1e-6, atol=0)


def test_a_certificate_of_many_digits() -> None:
    for name in ("tilde", "gyroscopic"):
        assert (motion(name, MP(25)).certify([0.5, 1]).digits >= 25).all()


@pytest.mark.parametrize("name", ["hat", "gyroscopic"])
def test_a_wrong_state_has_no_certificate(name, monkeypatch) -> None:
    """A run with −M in place of M has the same H and K, but differs from the second computation."""
    kind, at = type(motion(name)), type(motion(name)).at

    def reversed_at(flow, times, **options):
        run = at(flow, times, **options)
        return replaced(run, _rows=run._rows * [1, 1, 1, -1, -1, -1]) if flow.system.field == RR else run

    monkeypatch.setattr(kind, "at", reversed_at)
    with pytest.raises(PrecisionLoss, match="the states agree to"):
        motion(name).certify([1.0])


def moved(flow, columns, column, step, K):
    """The motion over K with one input changed by ``step``, made by its public constructors."""
    numbers = [*map(K.coerce, (*START[0], *START[1], *flow.system.constants))]
    potential, further = flow.system.potential is not None, flow.system.further
    names = [*"xyzuvw", "I1", "I2", "I3", "d", *(["a", "b", "b1", "b2", "b3"] if potential else []), *further]
    numbers[column if column < 6 else names.index(columns[column])] += step
    gamma, M, inertia, d, rest = numbers[:3], numbers[3:6], numbers[6:9], numbers[9], numbers[10:]
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    M = [y - tilt * x for x, y in zip(gamma, M, strict=True)]
    kind = type(flow.system)
    if kind is Gyroscopic:
        system = kind(inertia, rest[0], field=K)
    else:
        terms = {"potential": tuple(rest)} if rest else {}
        system = kind(inertia, *([d] if kind is Tilde else []), **terms, field=K)
    return system.motion_through(system.state(gamma, M))


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=pytest.mark.slow if x.startswith("tilde, d") else ()) for x in (*CURVES, *INTEGRATED)],
)
def test_sensitivities_are_differences_of_other_motions(name) -> None:
    flow, times, K = motion(name), [0.25, -0.125], MP(34)
    found = flow.sensitivity(times)
    count = 9 + {"tilde, d": 1, "poles": 3, "gyroscopic": 1, "tilde, d, potential": 6}.get(name, 0)
    assert found.matrix.shape == (2, 6, count)
    assert found.way == ("differences" if name in CURVES and name != "tilde, d" else "integrated")
    h = K.coerce(10) ** -11
    for k in range(count):
        ahead, behind = (rows(moved(flow, found.columns, k, sign * h, K).at(times)) for sign in (1, -1))
        gap = np.abs(((ahead - behind) / (2 * h)).astype(float) - found.matrix[:, :, k])
        assert gap.max() < 1e-15 * np.abs(found.matrix).max()


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["tilde, d", "poles"])
def test_curves_and_equations_of_variation_agree(name) -> None:
    flow = motion(name)
    times = np.array([2.0, -1.0])
    one, two = by_differences(flow, times), IntegratedMotion(flow.system, flow.state).sensitivity(times)
    assert one.columns == two.columns
    assert (one.way, two.way) == ("differences", "integrated")
    assert np.abs(one.matrix - two.matrix).max() < 2e-16 * np.abs(one.matrix).max()


@pytest.mark.parametrize(("name", "time"), [("tilde", 1e6), ("check", 1e6), ("poles", 1e6), ("gyroscopic", 3.0)])
def test_the_motion_is_canonical(name, time) -> None:
    """S takes the brackets of the start to those of the state, and ẋ(0) to ẋ(t)."""
    flow = motion(name)
    S, run = flow.sensitivity([time]).matrix[0], flow.at([time])
    start, end = (np.array(flow.system.poisson(state)) for state in (flow.state, run[0]))
    size = np.abs(S).max()
    assert np.abs(S[:, :6] @ start @ S[:, :6].T - end).max() < 1e-14 * size**2
    begin, rate = (np.array(flow.system.vector_field(state).row) for state in (flow.state, run[0]))
    assert np.abs(S[:, :6] @ begin - rate).max() < 1e-14 * size


@pytest.mark.slow
def test_far_sensitivities_of_what_rolls_are_differences() -> None:
    flow, far = motion("tilde, d"), 1e5
    found, run = flow.sensitivity([far]), flow.at([far])
    begin, rate = (np.array(flow.system.vector_field(state).row) for state in (flow.state, run[0]))
    assert found.way == "differences"
    assert np.abs(found.matrix[0, :, :6] @ begin - rate).max() < 1e-14 * np.abs(found.matrix).max()


def test_sensitivities_in_many_digits() -> None:
    decimals = (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    found, more = (
        system.motion_through(system.state(*decimals)).sensitivity(["0.125"]).matrix
        for system in map(SYSTEMS["gyroscopic"], (MP(20), MP(30)))
    )
    assert max(abs(more - found).ravel()) < 1e-19
    floats = motion("gyroscopic").sensitivity([0.125]).matrix
    assert np.abs(found.astype(float) - floats).max() < 2e-16 * np.abs(floats).max()


def test_a_body_at_rest_has_all_columns() -> None:
    system = SYSTEMS["tilde, potential"](RR)
    found = system.motion_through(system.state(START[0], (0, 0, 0))).sensitivity([0.0, 0.05])
    assert found.columns[3:6] == ("M1", "M2", "M3")
    assert found.matrix.shape == (2, 6, 14)
    gamma = np.array(START[0])
    assert np.abs(found.matrix[0, 3:, 3:6] - (np.eye(3) - np.outer(gamma, gamma))).max() < 1e-15


@pytest.mark.parametrize("name", ["tilde, d", "hat, potential", "gyroscopic"])
def test_the_linearized_motion_is_the_limit_of_differences(name) -> None:
    K = MP(40)
    flow, h = motion(name, K), K.coerce("1e-14")
    system, row = flow.system, np.array(flow.state.row)
    found = system.linearized(flow.state)
    for k, column in enumerate(found.T):
        sides = []
        for sign in (1, -1):
            y = row.copy()
            y[k] += sign * h
            sides.append(np.array(system.vector_field(replaced(flow.state, vectors=(tuple(y[:3]), tuple(y[3:])))).row))
        assert max(abs((sides[0] - sides[1]) / (2 * h) - column)) < 1e-22


def test_what_cannot_be_had_is_refused_by_name() -> None:
    with pytest.raises(NotRepresentable, match=r"secular: .* not linear in t"):
        _ = motion("tilde, d").sensitivity([1.0]).secular
    with pytest.raises(NotRepresentable, match=r"secular: .* is integrated"):
        _ = motion("gyroscopic").sensitivity([1.0]).secular
    with pytest.raises(Infeasible, match=r"the equations of motion are integrated, .* is within reach"):
        motion("gyroscopic").events(level, 0, 1e7)
    with pytest.raises(ArgumentError, match="condition = 3: give a function of γ and M"):
        motion("tilde").events(3, 0, 1)
    # γ₁ reaches its pole near t = 0.4
    attracted = Tilde((1, 2, 4), potential=(0, 0, -0.5, 0, 0))
    flow = attracted.motion_through(attracted.state(*START))
    with pytest.raises(PrecisionLoss, match="the motion ends, or cannot be followed, near t = "):
        flow.events(level, 0, 10)
