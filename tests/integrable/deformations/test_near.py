"""Motions of deformations near their start by compiled walks, compared with many digits, in t and in τ, and where they
end.
"""

from __future__ import annotations

import numpy as np
import pytest

from integrable import Check, Gyroscopic, Hat, Tilde
from integrable.deformations.carrier import widened
from integrable.motion.near import NearWalk, kind_in
from integrable.phase.ways import Cost, InOrder
from integrable.series.kinds import Compiled, Kind
from integrable.series.steps import FINE, INTEGRATED
from jacobian import MP, NotRepresentable

SYSTEMS = {
    "tilde": Tilde((1, 2, 4)),
    "rolling": Tilde((1, 2, 4), 0.7),
    "two poles": Tilde((1, 2, 4), potential=(0, 0.2, 0.3, 0, 0.5)),
    "one pole": Tilde((1, 2, 4), potential=(0.7, 0, 0, 0, 0.5)),
    "repelling": Tilde((1, 2, 4), potential=(0, 0, 0.3, 0.4, 0.5)),
    "check": Check((1, 2, 4)),
    "hat": Hat((1, 2, 4)),
    "gyroscopic": Gyroscopic((1, 2, 4), 0.7),
}
START = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
TIMES = np.array([3.0, -1.25, 0.0, 0.5, 3.0, 7.5])


def walks(system) -> None:
    """The walks of the system's kind in t and in τ, compiled if necessary."""
    for physical in (True, False):
        assert kind_in(system, physical).walk(FINE.orders) is not None


def rows(run):
    return np.hstack([run.gamma, run.M]).astype(float)


def assert_rounded(found, true) -> None:
    """γ and M are right to the last bits of the largest component of each."""
    for part in (slice(0, 3), slice(3, 6)):
        sizes = np.abs(true[:, part]).max(axis=1)
        assert (np.abs(found[:, part] - true[:, part]).max(axis=1) <= 2.3e-16 * sizes).all()


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if name in ("one pole", "two poles") else ()) for name in SYSTEMS],
)
def test_near_times_are_those_of_thirty_digits(name) -> None:
    system = SYSTEMS[name]
    walks(system)
    motion = system.motion_through(system.state(*START))
    fine, state = widened(system, motion.state, MP(30))
    many = fine.motion_through(state)
    run, true = motion.at(TIMES), many.at(TIMES)
    assert run.way == "integrated"
    assert_rounded(rows(run), rows(true))
    assert np.abs(run.tau - true.tau.astype(float)).max() <= 1e-15 * np.abs(run.tau).max()
    by_tau, truly = motion.at_tau(TIMES), many.at_tau(TIMES)
    assert_rounded(rows(by_tau), rows(truly))
    assert np.abs(by_tau.times - truly.times.astype(float)).max() <= 1e-15 * np.abs(by_tau.times).max()
    # a run with refused rows has the same other rows
    assert np.array_equal(rows(motion.at(TIMES, strict=False)), rows(run))


def test_far_times_are_those_of_the_curves() -> None:
    system = SYSTEMS["rolling"]
    walks(system)
    motion = system.flow(system.state(*START))
    assert motion.at([1.0, 2.0]).way == "integrated"
    assert motion.at([1.0, 1e6]).way == "elliptic curves"


@pytest.mark.parametrize(("system", "steps"), [(SYSTEMS["rolling"], 0), (Gyroscopic((1, 2, 4), 1), 600)])
def test_no_walk_is_made_in_vain(system, steps, monkeypatch) -> None:
    """Before the curves the walk took 64 steps up to T = 100. The gyroscopic motion was walked with three kinds of
    steps.
    """
    walks(system)
    taken, walked = [], Compiled.__call__

    def counted(*given):
        found = walked(*given)
        taken.append(found.steps)
        return found

    monkeypatch.setattr(Compiled, "__call__", counted)
    run = system.motion_through(system.state(*START)).at(np.linspace(0, 100, 101))
    assert run.way == ("integrated" if steps else "elliptic curves")
    assert len(taken) == 1
    assert abs(taken[0] - steps) <= 0.1 * steps


@pytest.mark.slow
def test_steps_past_peaks_are_those_of_thirty_digits() -> None:
    """Before T = 60 M has a peak, where differences grow ten thousandfold."""
    system = Gyroscopic((1, 2, 4), 1)
    state, last = system.state(*START), np.array([60.0])
    fine, start = widened(system, state, MP(30))
    true = rows(fine.motion_through(start).at(last))
    for steps in INTEGRATED:
        walk = kind_in(system, True).walk(steps.orders)
        found = walk(system.constants, state.row, last, steps, 1e4, len(steps.tiers) - 1)
        assert found.reached == 1
        assert found.wrong is None
        assert_rounded(found.states.reshape(1, 6), true)


@pytest.mark.slow
def test_a_pole_that_attracts_is_refused_as_ever() -> None:
    """γ_1 reaches 0 near t = 0.4: no walk continues beyond, and the message comes from the integrated equations."""
    system = Tilde((1, 2, 4), potential=(0, 0, -1.5, 0, 0))
    walks(system)
    motion = system.motion_through(system.state(*START))
    found = motion.at([0.01, 50.0], strict=False)
    assert found.status.tolist()[0] == 0
    assert found.status.tolist()[1] != 0
    assert "ends" in found.reasons[1]


@pytest.mark.parametrize("name", ["tilde", "check", "hat"])
def test_curves_that_degenerate_are_refused_before_a_walk(name) -> None:
    """ξ = (γ, AM) = 0 where M is along an axis and γ across it: K = 0."""
    system = SYSTEMS[name]
    walks(system)
    with pytest.raises(NotRepresentable):
        system.flow(system.state((0.6, 0.8, 0), (0, 0, 1.5)))


def test_what_was_asked_before_decides_nothing() -> None:
    system = SYSTEMS["rolling"]
    walks(system)
    state = system.state(*START)
    used = system.flow(state)
    used.at([1e5])
    assert np.array_equal(rows(used.at(TIMES)), rows(system.flow(state).at(TIMES)))


def test_a_walk_that_is_not_compiled_is_left_to_others() -> None:
    system = Gyroscopic((1, 2, 4), 0.7)
    state = system.state(*START)
    asked = []

    class Other:
        way = "other"

        def at(self, times):
            asked.append(len(times))
            return np.zeros((len(times), 6)), times

    def ways():
        yield NearWalk(system.motion_through(state), Cost(0, 0), INTEGRATED)
        yield Other()

    first = InOrder(ways)
    assert first.first(lambda way: way.at(np.array([1e9])))[0].shape == (1, 6)
    assert first.way == "other"
    assert asked == [1]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", SYSTEMS)
def test_states_are_the_same_without_a_walk(name, monkeypatch) -> None:
    system = SYSTEMS[name]
    walks(system)
    state = system.state(*START)
    run = system.motion_through(state).at(TIMES)
    monkeypatch.setattr(Kind, "walk", lambda *_, **__: None)
    again = system.motion_through(state).at(TIMES)
    assert run.way == "integrated"
    assert_rounded(rows(again), rows(run))
