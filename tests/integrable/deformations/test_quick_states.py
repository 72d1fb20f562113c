"""States of the pairs in compiled double-doubles compared with the readable additions; the two share no code."""

from copy import copy

import numpy as np
import pytest

from integrable import Check, Hat, Tilde
from integrable.deformations import quick_states
from integrable.deformations.carrier import CurvesCarrier
from integrable.motion.precise import RoundedRows
from integrable.mumford.elliptic_torus import EllipticOval
from tests.integrable.deformations import additions

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
PAIRS = {
    "tilde": Tilde((1, 2, 4)),
    "tilde, rolling": Tilde((3, 1, 2), 0.7),
    "tilde, heavy": Tilde((2, 1, 3), 40),
    "check": Check((2, 3, 1)),
    "hat": Hat((3, 2, 1)),
    "hat, moments nearly equal": Hat((1, 3, 1.0001)),
}
STARTS = {
    "generic": START,
    "another": ((0.6, 0, -0.8), (0.8, 0.5, 0.6)),
    "turning point": (START[0], (-1.1544, 0.4320000064, 0.460799994)),
}
TAU = np.array([0, -0.37, 1e-9, 3.25, -41.5, 1234.5678, 9e4])


def by_additions(flow, tau, monkeypatch):
    """γ and M at values of τ in many digits, by additions on both curves."""
    with monkeypatch.context() as changed:
        changed.setattr(EllipticOval, "moved", additions.moved)
        changed.setattr(CurvesCarrier, "_state", additions.state)
        return flow._curves.at_tau(tau)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("start", STARTS.values(), ids=STARTS.keys())
@pytest.mark.parametrize("system", PAIRS.values(), ids=PAIRS.keys())
def test_compiled_states_are_those_of_the_readable_additions(system, start, monkeypatch) -> None:
    flow = system.flow(system.state(*start))
    readable = by_additions(flow, TAU, monkeypatch)

    def unwanted(*_):
        raise AssertionError("the compiled additions have been given up")

    monkeypatch.setattr(RoundedRows, "at_tau", unwanted)
    found = flow.at_tau(TAU)
    # both have been rounded once
    assert np.abs(np.hstack([found.gamma, found.M]) - readable).max() <= 2.3e-16 * np.abs(readable).max()


@pytest.mark.thinned(3)
@pytest.mark.parametrize("size", [1e-60, 1e-6, 5e5, 1e60])
@pytest.mark.parametrize("system", PAIRS.values(), ids=PAIRS.keys())
def test_the_unit_of_time_does_not_matter(system, size, monkeypatch) -> None:
    """For |M| = 5e5 the coefficients of ℘ in powers of v² would already leave the range of floats."""
    flow = system.flow(system.state(START[0], [size * x for x in START[1]]))
    tau = TAU / size
    readable = by_additions(flow, tau, monkeypatch)

    def unwanted(*_):
        raise AssertionError("the compiled additions have been given up")

    monkeypatch.setattr(RoundedRows, "at_tau", unwanted)
    found = flow.at_tau(tau)
    for rows, true in ((found.gamma, readable[:, :3]), (found.M, readable[:, 3:])):
        assert np.abs(rows - true).max() <= 2.3e-16 * np.abs(true).max()


@pytest.mark.parametrize("system", PAIRS.values(), ids=PAIRS.keys())
def test_what_leaves_the_range_of_floats_goes_the_readable_way(system) -> None:
    flow = system.flow(system.state(START[0], [1e155 * x for x in START[1]]))
    tau = np.array([0, 3.25e-155])
    found = flow.at_tau(tau)
    assert np.array_equal(np.hstack([found.gamma, found.M]), flow._curves.at_tau(tau))


def test_far_times_and_what_is_off_go_the_readable_way(monkeypatch) -> None:
    system = Hat((3, 2, 1))
    flow = system.flow(system.state(*START))
    tau = np.array([2.0, 1e12])
    assert np.array_equal(np.hstack([flow.at_tau(tau).gamma, flow.at_tau(tau).M]), flow._curves.at_tau(tau))
    # the farthest state detects a sign on which H and K do not depend; H and K of all states detect a changed size
    truth = flow._curves.at_tau(TAU)
    for axis, factor in ((1, -1), (2, 1 + 1e-15)):
        flow = system.flow(system.state(*START))

        def changed(carrier, axis=axis, factor=factor, right=quick_states.packed):
            other, weights = copy(carrier), [*carrier.frame.weights]
            weights[axis] *= factor
            other.frame = carrier.frame._replace(weights=tuple(weights))
            return right(other)

        with monkeypatch.context() as spoiled:
            spoiled.setattr(quick_states, "packed", changed)
            found = flow.at_tau(TAU)
        assert np.array_equal(np.hstack([found.gamma, found.M]), truth)


@pytest.mark.parametrize("name", ["tilde, rolling", "tilde, heavy"])
def test_compiled_times_are_those_of_the_readable_clock(name, monkeypatch) -> None:
    system = PAIRS[name]
    flow = system.flow(system.state(*START))
    readable, tau = flow._curves.at(TAU)

    def unwanted(*_):
        raise AssertionError("the compiled clock has been given up")

    monkeypatch.setattr(RoundedRows, "at", unwanted)
    found = flow.at(TAU)
    assert np.abs(np.hstack([found.gamma, found.M]) - readable).max() <= 2.3e-16 * np.abs(readable).max()
    assert np.abs(found.tau - tau).max() <= 2.3e-16 * np.abs(tau).max()
    # this is no accident of a single time
    assert np.array_equal(flow.at(TAU[4:5]).gamma[0], found.gamma[4])


def test_a_clock_that_is_off_goes_the_readable_way(monkeypatch) -> None:
    system = PAIRS["tilde, rolling"]
    flow = system.flow(system.state(*START))
    truth = flow._curves.at(TAU)[0]
    right = quick_states.TorusClock.phases
    monkeypatch.setattr(quick_states.TorusClock, "phases", lambda clock, times: right(clock, times * (1 + 1e-13)))
    found = flow.at(TAU)
    assert np.array_equal(np.hstack([found.gamma, found.M]), truth)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("seed", range(12))
def test_compiled_times_of_bodies_at_random(seed, monkeypatch) -> None:
    """For some of them the modes of 1/g hardly contribute."""
    rng = np.random.default_rng(seed)
    inertia, d, size = 10 ** rng.uniform(-1, 1, 3), 10 ** rng.uniform(-4, 4), 10 ** rng.uniform(-3, 3)
    gamma, M = rng.normal(size=(2, 3))
    gamma /= np.linalg.norm(gamma)
    M = size * (M - gamma * (gamma @ M))
    system = Tilde(tuple(inertia.tolist()), float(d))
    flow = system.flow(system.state(gamma.tolist(), M.tolist()))
    times = np.array([0.3, -41.5, 9e4]) / size * inertia.min()
    readable, tau = flow._curves.at(times)

    def unwanted(*_):
        raise AssertionError("the compiled clock has been given up")

    monkeypatch.setattr(RoundedRows, "at", unwanted)
    found = flow.at(times)
    for rows, true in ((found.gamma, readable[:, :3]), (found.M, readable[:, 3:])):
        assert np.abs(rows - true).max() <= 2.3e-16 * np.abs(true).max()
    # τ is known to about 1e-18 of a turn
    period = float(max(curve.period for curve in flow._curves.many.carrier.curves))
    assert np.abs(found.tau - tau).max() <= 2.3e-16 * np.abs(tau).max() + 4e-18 * period


@pytest.mark.parametrize("place", [0, 2, 5])
def test_a_rate_that_is_off_goes_the_readable_way(place, monkeypatch) -> None:
    """An error in a mode of 1/g, or in its mean, leads to the readable computation."""
    system = PAIRS["tilde, rolling"]
    truth = system.flow(system.state(*START))._curves.at(TAU)[0]
    right = quick_states.resolved_spectrum

    def changed(*arguments):
        spectrum = right(*arguments)
        spectrum.values[place, 0] += 1e-12
        return spectrum

    monkeypatch.setattr(quick_states, "resolved_spectrum", changed)
    flow = system.flow(system.state(*START))
    found = flow.at(TAU)
    assert np.array_equal(np.hstack([found.gamma, found.M]), truth)


def test_the_quick_clock_holds_and_another_rate_is_noticed(monkeypatch) -> None:
    said, holds = [], quick_states.QuickClock.holds

    def asked(clock, turns, rate, *where):
        said.extend(holds(clock, turns, x, *where) for x in (rate, (1 + 1e-12) * rate))
        return said[0]

    monkeypatch.setattr(quick_states.QuickClock, "holds", asked)
    system = PAIRS["tilde, rolling"]
    system.flow(system.state(*START)).at([1e4, 1e5])
    assert said == [True, False]
