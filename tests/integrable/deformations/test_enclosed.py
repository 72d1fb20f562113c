"""Enclosures of deformations contain states at many more digits, are small, and bound the truncation errors."""

from __future__ import annotations

import pytest

from integrable import Check, Tilde
from integrable.deformations import enclosed
from integrable.phase.state import State
from jacobian import MP, RR
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from jacobian.numbers.long_reals import BallReals
from tests.integrable.deformed_systems import SYSTEMS

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
TIMES = [0.0, 0.03125, -0.015625]
REALS = BallReals(400)


def truth(system, state, times):
    """The states at 50 digits; the floats of the start count as exact."""
    exact = system.over(MP(50))
    K = exact.field
    start = State(*(tuple(map(K.coerce, v)) for v in (state.gamma, state.M)))
    return exact.motion_through(start).at([K.coerce(t) for t in times])


def contained(balls, numbers) -> bool:
    return all(ball.contains(REALS.number(x)) for ball, x in zip(balls.ravel(), numbers.ravel(), strict=True))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["tilde, d", "tilde, d, potential", "check", "hat", "gyroscopic"])
def test_states_at_physical_times(name):
    system = SYSTEMS[name](RR)
    state = system.state(*START)
    found = system.motion_through(state).enclosure(TIMES, digits=12)
    assert (found.radius <= 1e-12).all()
    run = truth(system, state, TIMES)
    with REALS:
        assert contained(found.gamma, run.gamma)
        assert contained(found.M, run.M)
        assert contained(found.tau, run.tau)
        assert all(ball == t for ball, t in zip(found.times, TIMES, strict=True))


@pytest.mark.parametrize("name", ["tilde, d", "gyroscopic"])
def test_states_at_values_of_tau(name):
    system = SYSTEMS[name](RR)
    state = system.state(*START)
    found = system.motion_through(state).enclosure_at_tau(TIMES, digits=12)
    assert (found.radius <= 1e-12).all()
    exact = system.over(MP(50))
    K = exact.field
    start = State(*(tuple(map(K.coerce, v)) for v in (state.gamma, state.M)))
    run = exact.motion_through(start).at_tau([K.coerce(t) for t in TIMES])
    with REALS:
        assert contained(found.gamma, run.gamma)
        assert contained(found.M, run.M)
        assert all(ball == t for ball, t in zip(found.tau, TIMES, strict=True))
    assert (found.times is None) == (name == "tilde, d")


def test_what_begins_at_rest_is_moved_by_its_potential():
    system = SYSTEMS["tilde, potential"](RR)
    state = system.state(START[0], (0, 0, 0))
    found = system.motion_through(state).enclosure([0.03125], digits=12)
    with REALS:
        assert contained(found.M, truth(system, state, [0.03125]).M)
    assert found.radius[0] <= 1e-12


@pytest.mark.parametrize(("name", "size", "time"), [("tilde, d", 1e-9, 2.0**25), ("tilde, potential", 1e-8, 0.03125)])
def test_a_slow_start_takes_no_more_steps(name, size, time):
    """The unit of time in which τ̇ = g is not that of a slow motion, nor does |M| at the start give one if a potential
    acts.
    """
    system = SYSTEMS[name](RR)
    state = system.state(START[0], [size * x for x in START[1]])
    found = system.motion_through(state).enclosure([time], digits=12)
    assert found.radius[0] <= 1e-12
    run = truth(system, state, [time])
    with REALS:
        assert contained(found.gamma, run.gamma)
        assert contained(found.M, run.M)


@pytest.mark.parametrize("order", [2, 5])
def test_what_the_series_leave_out_is_in_the_balls(order):
    """If a series is truncated much too early, the balls are wide but still contain the motion."""
    system = SYSTEMS["check"](RR)
    state = system.state(*START)
    march = enclosed._March(system, state, 200)
    march._order = order
    with march.reals:
        (_, gamma, M, radius), *_ = march.rows([0.03125], 1)
    assert 1e-8 < radius < 0.1
    run = truth(system, state, [0.03125])
    with REALS:
        assert all(ball.contains(REALS.number(x)) for ball, x in zip(gamma, run.gamma[0], strict=True))
        assert all(ball.contains(REALS.number(x)) for ball, x in zip(M, run.M[0], strict=True))


def test_lost_bits_are_made_up_for(monkeypatch):
    """With only the bits of the requested digits the first attempt fails; the final balls are narrower."""
    monkeypatch.setattr(enclosed, "SPARE_BITS", 4)
    system = SYSTEMS["gyroscopic"](MP(25))
    found = system.motion_through(system.state(*START)).enclosure([0.25])
    assert found.radius[0] <= 1e-25


def test_a_motion_that_ends_is_not_followed_beyond(monkeypatch):
    # γ₂ is attracted to its pole; the place where the discs begin to shrink is near enough for a test
    monkeypatch.setattr(enclosed, "SMALLEST_DISC", 0.8)
    system = Check((1, 2, 4), potential=(0.0, 0.0, 0.0, 0.5, 0.0))
    with pytest.raises(PrecisionLoss, match="the motion ends, or cannot be followed, near t = "):
        system.motion_through(system.state(*START)).enclosure([1], digits=5)


def test_what_takes_too_many_steps_is_refused_with_what_does_not():
    system = SYSTEMS["check"](RR)
    with pytest.raises(Infeasible, match=r"takes about .* steps, more than 4000; about \|t\| = .* is within reach"):
        system.motion_through(system.state(*START)).enclosure([1e6], digits=5)


def test_digits_are_a_number_of_them():
    system = SYSTEMS["check"](RR)
    with pytest.raises(ArgumentError, match="digits = 0: the balls' digits are an int"):
        system.motion_through(system.state(*START)).enclosure([1], digits=0)


def test_bits_that_m_outgrows_its_unit_by_are_there_from_the_start(monkeypatch) -> None:
    """Poles raise |M| = 1e-100 to about 0.1 at once: the bits for this are no loss of digits, and the first attempt has
    them.
    """
    tried, made = [], enclosed._March.__init__

    def counted(march, system, state, bits, in_tau):
        tried.append(bits)
        made(march, system, state, bits, in_tau)

    monkeypatch.setattr(enclosed._March, "__init__", counted)
    pair = Tilde((1, 2, 4), potential=(0, 0, 0.02, 0.04, 0.06))
    motion = pair.motion_through(pair.state((0.48, 0.6, 0.64), (0.384e-100, 1.28e-100, -1.488e-100)))
    assert motion.enclosure([0.01], digits=15).radius[0] <= 1e-15
    assert len([bits for bits in tried if bits > enclosed.BOUND_BITS]) == 1
