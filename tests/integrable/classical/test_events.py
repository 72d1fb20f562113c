"""Events of systems of any genus against closed forms, an integrator with event location, and dense samples."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from jacobian import MP, RR
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss
from tests.integrable.classical.rows import REAL

CASES = [
    ("neumann", 1), ("neumann", 3), ("ellipsoid", 2), ("garnier", 2), ("henon_heiles", 1), ("toda", 3), ("toda", 4),
    ("lagrange", 3), ("pendulum", 3), ("galaxy", 3), ("veselova", 3), ("two_gaps", 2), ("ball", 3),
]  # fmt: skip


def pendulum(speed, K=RR):
    system = SphericalPendulum(K)
    return system.flow(system.state((0, 0, -1), (speed, 0, 0)))


def at_bottom_or_top(speed):
    """The time between two passages of a plane pendulum through the vertical, θ'' = −sin θ with 2k = ``speed``."""
    k = mpmath.mpf(speed) / 2
    return 2 * mpmath.ellipk(k**2) if k < 1 else mpmath.ellipk(1 / k**2) / k


@pytest.mark.parametrize("speed", ["1/2", "3/2", "1.9999", "5/2"])
@pytest.mark.parametrize("first", [0, -30, 10**7])
def test_a_plane_pendulum_passes_the_vertical_as_its_elliptic_integral_says(speed, first) -> None:
    K = MP(30)
    flow = pendulum(float(K.coerce(speed)))
    with mpmath.workdps(30):
        step = at_bottom_or_top(flow.start.p[0])
        begin = int(mpmath.ceil(first / step))
        wanted = [n * step for n in range(begin, begin + 60) if first <= n * step <= first + 25]
    found = flow.events(lambda q, p: q[:, 0], first, first + 25)
    assert len(found) == len(wanted) > 1
    assert max(abs(t - x) for t, x in zip(found.times, wanted, strict=True)) < 4e-15 * (1 + abs(first) + 25)
    # to the right it is at the bottom, and a pendulum that turns over is at the top every second time
    rising = flow.events(lambda q, p: q[:, 0], first, first + 25, direction=1)
    places = (np.flatnonzero(np.isin(found.times, rising.times)) + begin) % 2
    assert (places == 0).all()
    assert len(rising) in (len(found) // 2, (len(found) + 1) // 2)


def test_events_in_many_digits() -> None:
    K = MP(40)
    flow = pendulum("3/2", K)
    found = flow.events(lambda q, p: q[:, 0], 0, 10)
    with mpmath.workdps(45):
        step = at_bottom_or_top(1.5)
        assert max(abs(t - n * step) for n, t in enumerate(found.times)) < mpmath.mpf("1e-38")
    assert len(found) == 3


def test_events_of_toda_are_those_of_an_integrator() -> None:
    from scipy.integrate import solve_ivp

    def rates(t, y):
        q, p = np.split(y, 2)
        links = np.exp(np.roll(q, -1) - q)
        return np.concatenate([p, links - np.roll(links, 1)])

    def level(t, y):
        return y[4] * y[5] - 0.1

    start = [0.5, 0, -0.25, 0, 0.7, 0.5, 0, -1.2]
    truth = solve_ivp(rates, (0, 40), start, "DOP853", events=level, rtol=1e-13, atol=1e-13, max_step=0.1)
    system = TodaLattice(4)
    found = system.flow(system.state(start[:4], start[4:])).events(lambda q, p: p[:, 0] * p[:, 1] - 0.1, 0, 40)
    assert len(found) == len(truth.t_events[0]) > 20
    assert abs(found.times - truth.t_events[0]).max() < 1e-9


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("name", "n"), CASES)
@pytest.mark.parametrize("first", [-20, 3e6])
def test_no_crossing_of_a_dense_sample_is_missed(name, n, first) -> None:
    system, state = REAL[name](RR, n)
    flow, last = system.flow(state), first + 60
    level = float(np.mean(flow.at(np.linspace(0, 60, 12)).p[:, 0]))
    found = flow.events(lambda q, p: p[:, 0] - level, first, last)
    times = np.linspace(first, last, 5001)
    change = np.flatnonzero(np.diff(np.sign(flow.at(times).p[:, 0] - level)))
    assert len(found) == len(change) > 0
    assert ((times[change] <= found.times) & (found.times <= times[change + 1])).all()
    # a time is a float: the value is that of its rounding
    rates = [abs(system.vector_field(system.state(q, p)).p[0]) for q, p in zip(found.q, found.p, strict=True)]
    assert (abs(found.p[:, 0] - level) <= 4e-14 + 2 * np.spacing(abs(found.times)) * rates).all()


def test_the_reversed_motion_has_the_reversed_events() -> None:
    system, state = REAL["neumann"](RR, 2)
    ahead = system.flow(state).events(lambda q, p: q[:, 0] - 0.2, -20, 0)
    back = system.flow(system.state(state.q, [-x for x in state.p])).events(lambda q, p: q[:, 0] - 0.2, 0, 20)
    assert len(ahead) == len(back) > 3
    assert abs(ahead.times + back.times[::-1]).max() < 1e-13


def test_events_at_both_ends_count() -> None:
    flow = pendulum(1.0)
    period = 2 * float(at_bottom_or_top(1))
    found = flow.events(lambda q, p: q[:, 0], 0, period)
    assert np.allclose(found.times, [0, period / 2, period], rtol=0, atol=1e-14)
    assert found.times[0] == 0


@pytest.mark.parametrize("level", [-1.0, -0.5])
def test_where_a_condition_only_touches_zero_nothing_else_is_found(level) -> None:
    """q_3 touches −1 at the bottom and −1/2 where the pendulum turns."""
    flow = pendulum(1.0)
    found = flow.events(lambda q, p: q[:, 2] - level, 0, 40)
    assert abs(found.q[:, 2] - level).max(initial=0) < 1e-13


def test_a_motion_without_events_and_one_at_rest() -> None:
    assert len(pendulum(1.0).events(lambda q, p: q[:, 2] - 2, 0, 30)) == 0
    assert len(pendulum(0.0).events(lambda q, p: q[:, 2] - 2, 0, 30)) == 0


def test_a_pulse_beside_the_separatrix_is_not_passed_over() -> None:
    """The pendulum stands near the top for most of its period, and passes the bottom in a short time."""
    flow = pendulum(2 * (1 - 1e-12))
    step = float(at_bottom_or_top(flow.start.p[0]))
    found = flow.events(lambda q, p: q[:, 2] + 0.9, 0.5 * step, 5.5 * step)
    assert len(found) == 10
    assert np.allclose(found.times[::2] + found.times[1::2], 2 * step * np.arange(1, 6), rtol=1e-9)


def test_a_condition_and_times_that_are_refused() -> None:
    flow = pendulum(1.0)
    with pytest.raises(ArgumentError, match=r"condition = 3: give a function of q and p, arrays of shape \(N, n\)"):
        flow.events(3, 0, 5)
    with pytest.raises(ArgumentError, match=r"start = 5, end = 5: a time after start"):
        flow.events(lambda q, p: q[:, 0], 5, 5)
    with pytest.raises(ArgumentError, match=r"condition: values of shape \(\d+, 3\)"):
        flow.events(lambda q, p: q, 0, 5)
    with pytest.raises(ArgumentError, match="direction = 2"):
        flow.events(lambda q, p: q[:, 0], 0, 5, 2)
    with pytest.raises(PrecisionLoss, match="floats near these times are"):
        flow.events(lambda q, p: q[:, 0], 1e12, 1e12 + 5)
    with pytest.raises(Infeasible, match="10000000 parts"):
        flow.events(lambda q, p: q[:, 0], 0, 1e8)


def test_a_condition_that_jumps_and_a_motion_that_ends_are_refused() -> None:
    with pytest.raises(PrecisionLoss, match="no Chebyshev series"):
        pendulum(1.0).events(lambda q, p: np.sign(q[:, 0] - 0.1) + 0.5, 0, 5)
    star = HenonHeiles((1,), "-1/2", "-1/4")
    escaping = star.flow(star.state((-0.6, 0.1), (-0.5, 0)))
    with pytest.raises(PrecisionLoss):
        escaping.events(lambda q, p: q[:, 1], 0, 100)


def test_a_free_rotation_has_one_panel_to_begin_with() -> None:
    """With equal constants of the potential left out, a point on the circle turns uniformly: q_0 = cos t."""
    system = Neumann((1, 1 + 2.0**-52))
    found = system.flow(system.state((1, 0), (0, 1))).events(lambda q, p: q[:, 0], 0, 100)
    assert np.allclose(found.times, (np.arange(len(found)) + 0.5) * np.pi, rtol=1e-13)
    assert len(found) == 32


@pytest.mark.parametrize(("name", "n"), CASES)
def test_the_linearized_motion_is_the_limit_of_differences(name, n) -> None:
    K = MP(40)
    system, state = REAL[name](K, n)
    found, h = system.linearized(state), K.coerce("1e-14")
    row = np.array([*state.q, *state.p])
    for k, column in enumerate(found.T):
        sides = []
        for sign in (1, -1):
            moved = row.copy()
            moved[k] += sign * h
            q, p = np.split(moved, 2)
            rates = system._vector_field(K, type(state)(tuple(q), tuple(p)))
            sides.append(np.array([*rates.q, *rates.p]))
        assert max(abs((sides[0] - sides[1]) / (2 * h) - column)) < 1e-24 * (1 + max(abs(found.ravel())))
