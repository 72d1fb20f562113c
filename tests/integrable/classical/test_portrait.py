"""Frequencies and actions of every system, compared with derivatives of H, sums along motions, and special cases."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.two_gaps import TwoGaps
from integrable.mumford.flow import Point
from jacobian import MP, RR
from jacobian.errors import NotRepresentable, PrecisionLoss
from tests.integrable.classical.rows import REAL
from tests.integrable.ways import constrained

K, FINE = MP(20), MP(50)
CASES = [
    ("barriers", 2),
    ("ellipsoid", 1),
    ("ellipsoid", 2),
    ("ellipsoid", 3),
    ("galaxy", 3),
    ("garnier", 1),
    ("garnier", 3),
    ("henon_heiles", 1),
    ("lagrange", 3),
    ("neumann", 1),
    ("neumann", 2),
    ("neumann", 3),
    ("pendulum", 3),
    ("toda", 2),
    ("toda", 3),
    ("toda", 5),
]


def case(name, n, field):
    if name == "pendulum":
        # the state in the table is conical
        system = SphericalPendulum(field)
        return system, system.state(("12/25", "3/5", "-16/25"), ("2259/2500", "-51/125", "369/1250"))
    return REAL[name](field, n)


def energy(name, system, state):
    found = system.integrals(state)
    if name == "lagrange":
        return found["h"] + system.parameters[0] * found["c"] ** 2 / 2
    if name == "ellipsoid":
        return found["speed squared"] / 2
    return found[next(key for key in ("H", "h", "E") if key in found)]


def moved(name, system, state, step, rng):
    """The state moved in a random direction that keeps the constraints, Σp of Toda and L of a top."""
    q, p = ([x + step * rng.randint(-9, 9) for x in part] for part in state)
    if name == "toda":
        rest = sum(p) - sum(state.p)
        p = [x - rest / len(p) for x in p]
    found = constrained(system, Point(tuple(q), tuple(p)))
    if name == "lagrange":
        rest = system.field.dot(*state) - system.field.dot(*found)
        found = Point(found.q, tuple(y + rest * x for x, y in zip(found.q, found.p, strict=True)))
    return system.state(*found)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "n"), CASES)
def test_frequencies_are_derivatives_of_the_energy_by_the_actions(name, n) -> None:
    """dH = 2πΣf dJ, by central differences."""
    system, state = case(name, n, FINE)
    step = FINE.coerce(10) ** -15
    frequencies = system.flow(state).portrait.frequencies
    ends = [moved(name, system, state, sign * step, Random(1)) for sign in (1, -1)]
    rise = (energy(name, system, ends[0]) - energy(name, system, ends[1])) / (2 * step)
    actions = [system.flow(end).portrait.actions for end in ends]
    slopes = [(x - y) / (2 * step) for x, y in zip(*actions, strict=True)]
    wanted = 2 * FINE.context.pi * FINE.dot(frequencies, slopes)
    assert abs(rise - wanted) < 1e-24 * (1 + abs(rise))


def turns_of(system, state, path):
    """Turns of each point in its oval along a path, (N, g), by its position between the extremes of the path."""
    pairs = [system.spectral(Point(tuple(q), tuple(p))) for q, p in zip(path.q.tolist(), path.p.tolist(), strict=True)]
    points = np.array([np.sort(np.roots(pair.u[::-1]).real) for pair in pairs])
    heights = np.array([np.polyval(pair.v[::-1], xs) for pair, xs in zip(pairs, points, strict=True)])
    low, high = points.min(axis=0), points.max(axis=0)
    # the sign of y tells on which of both ways a point is
    part = np.arccos(np.clip((low + high - 2 * points) / (high - low), -1, 1))
    return np.unwrap(np.where(heights >= 0, part, -part), axis=0) / (2 * np.pi)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    ("name", "n"), [case for case in CASES if case[0] not in ("barriers", "galaxy", "lagrange", "pendulum")]
)
def test_points_turn_at_the_frequencies(name, n) -> None:
    """A turn is counted between the extremes of a run, so at both ends a little is missing."""
    system, state = case(name, n, RR)
    flow = system.flow(state)
    found = turns_of(system, state, flow.at(np.linspace(0, 100, 2001)))
    assert np.allclose(np.abs(found[-1] - found[0]), 100 * np.array(flow.portrait.frequencies), rtol=0, atol=0.6)


def test_the_pendulum_turns_about_the_vertical() -> None:
    system, state = case("pendulum", 3, RR)
    flow = system.flow(state)
    times = np.linspace(0, 1000, 20001)
    q = flow.at(times).q
    turned = np.unwrap(np.arctan2(q[:, 1], q[:, 0])) / (2 * np.pi)
    rises = np.flatnonzero((q[:-1, 2] < q[:-1, 2].mean()) & (q[1:, 2] >= q[:-1, 2].mean()))
    nod, turn = flow.portrait.frequencies
    assert abs(turned[-1] - turned[0] - 1000 * turn) < 1
    assert abs(len(rises) - 1000 * nod) < 1.1


def test_a_planar_swing_and_a_conical_one() -> None:
    """The plane pendulum's period is 4K(sin ½α); a conical pendulum has no action but that about the vertical."""
    from scipy.special import ellipk

    system = SphericalPendulum()
    flow = system.flow(system.state((np.sin(0.7), 0.0, -np.cos(0.7)), (0.0, 0.0, 0.0)))
    # z nods twice in a period
    assert abs(2 / flow.portrait.frequencies[0] / (4 * ellipk(np.sin(0.35) ** 2)) - 1) < 1e-14
    conical, state = REAL["pendulum"](RR, 3)
    found = conical.flow(state).portrait
    assert abs(found.actions[0]) < 1e-20
    assert found.actions[1] == -0.738
    # the rate of a conical pendulum is 1/√−z
    assert abs(2 * np.pi * found.frequencies[1] + 1 / 0.8) < 1e-15


def test_small_oscillations_of_a_chain() -> None:
    """Near rest Toda's frequencies are 2 sin(πk/n)/2π."""
    system = TodaLattice(4)
    flow = system.flow(system.state((1e-5, 0, -2e-5, 1e-5), (0, 1e-5, 0, -1e-5)))
    wanted = sorted(2 * np.sin(np.pi * k / 4) / (2 * np.pi) for k in (1, 2, 3))
    assert np.allclose(sorted(flow.portrait.frequencies), wanted, rtol=1e-8)


def test_the_angles_of_a_start_lead_to_the_next_one() -> None:
    system, state = REAL["neumann"](RR, 2)
    flow = system.flow(state)
    path = flow.at([0, 7.3])
    then = system.flow(system.state(*(tuple(x[1].tolist()) for x in (path.q, path.p)))).portrait
    here = flow.portrait
    moved = [x + 7.3 * f - y for x, f, y in zip(here.angles, here.frequencies, then.angles, strict=True)]
    assert all(abs(x - round(x)) < 1e-13 for x in moved)


def test_motions_without_turns_are_refused() -> None:
    escaping = HenonHeiles.with_frequencies(1, 1)
    with pytest.raises(NotRepresentable, match=r"oval|complex"):
        escaping.flow(escaping.state((3, 1), (2, 1))).portrait  # noqa: B018


def test_a_motion_to_a_separatrix_has_no_frequencies() -> None:
    system = SphericalPendulum()
    falling = system.flow(system.state((0.6, 0, 0.8), (0.8 * 0.4**0.5, 0, -0.6 * 0.4**0.5)))
    with pytest.raises((NotRepresentable, PrecisionLoss)):
        falling.portrait  # noqa: B018


@pytest.mark.parametrize("state", [((1, 0, "Z"), (0.2, 0.3, 0)), (("Z", 0, 1), (0, 0, 0.1))])
def test_a_point_that_rests_has_the_frequency_of_small_oscillations(state) -> None:
    """A star in the plane of its galaxy and one on the axis, beside stars nearby."""
    galaxy = REAL["galaxy"](RR, 3)[0]

    def portrait(z):
        q, p = state
        return galaxy.flow(galaxy.state([z if x == "Z" else x for x in q], p)).portrait

    found, near = portrait(0.0), portrait(1e-7)
    assert np.allclose(found.frequencies, near.frequencies, rtol=1e-12, atol=0)
    assert np.allclose(found.actions, near.actions, rtol=1e-12, atol=1e-13)
    assert min(near.angles) >= 0
    with pytest.raises(NotRepresentable, match=r"^angles: .* a point of the pair rests"):
        _ = found.angles


def test_a_point_beyond_all_bounded_ovals_is_in_none_of_them() -> None:
    """The gap becomes infinite within a time of order 1; no oval is its oval, though one is next to it."""
    system = TwoGaps((0, -5, 0))
    flow = system.flow(system.state((1, 2), (0.5, 0.3)))
    for ask in (lambda: flow.portrait, lambda: flow.section(1), flow.spectrum):
        with pytest.raises(NotRepresentable, match="unbounded"):
            ask()


@pytest.mark.parametrize("K", [RR, MP(30)], ids=["RR", "MP(30)"])
def test_a_lattice_at_rest_has_frequencies_and_no_turns(K) -> None:
    """At the first precision the double branch points are found with all digits: no precision has to be raised."""
    n = 4
    system = TodaLattice(n, K)
    flow = system.flow(system.state([3] * n, [0] * n))
    portrait = flow.portrait
    waves = [2 * np.sin(np.pi * k / n) / (2 * np.pi) for k in (1, 2, 1)]
    assert np.array(portrait.frequencies, dtype=float) == pytest.approx(waves, rel=1e-15)
    assert portrait.actions[:3] == (0, 0, 0)
    assert flow._digits_of_ovals == 0
    with pytest.raises(NotRepresentable, match="rests"):
        _ = portrait.angles
    if K is RR:
        with pytest.raises(NotRepresentable, match="the point in oval 1 of this motion rests"):
            flow.section(2, 1)
        found = flow.spectrum()
        assert (len(found), found.q[0]) == (1, pytest.approx([3] * n, rel=1e-15))


@pytest.mark.parametrize("size", ["1e-12", "1e-40", "1e-150"])
def test_a_tiny_oscillation_is_no_rest(size) -> None:
    """Two particles with q = ±½size, whose distance has the angular frequency 2 and the action ½size²."""
    K = MP(30)
    system = TodaLattice(2, K)
    x = K.coerce(size)
    flow = system.flow(system.state([x / 2, -x / 2], [0, 0]))
    # the relative motion with r = q1 − q2 has the reduced mass ½ and the energy r²: ω = 2, J = r²/2
    assert abs(flow.portrait.frequencies[0] * K.context.pi - 1) < K.coerce("1e-23")
    assert abs(2 * flow.portrait.actions[0] / x**2 - 1) < K.coerce("1e-20")
    assert len(flow.portrait.angles) == 1
