"""Stars in the galaxy of Kuzmin and Kutuzov: special orbits, refusals, and comparison with galpy."""

from __future__ import annotations

import warnings
from fractions import Fraction
from random import Random

import numpy as np
import pytest

from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.mumford.flow import Point
from jacobian import MP, RR, ArgumentError, NotRepresentable, PrecisionLoss
from tests.integrable.classical.rows import distance, integrated

FLAT, LONG = (("3/2", 1), (1, "3/2"))


def error(axes, q, p, time=6, steps=12):
    """The error of a state, relative to an integration in 30 digits."""
    K = MP(30)
    system = KuzminKutuzov(axes, 1, K)
    state = system.state(q, p)
    path = system.flow(state).at([time])
    return distance(K, (path.q[0], path.p[0]), integrated(system, state, time, steps))


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("axes", "q", "p"),
    [
        (FLAT, (1, "1/2", 0), ("-1/4", "1/2", 0)),  # in the plane z = 0 for ever
        pytest.param(LONG, (2, "1/2", 0), ("-1/4", "1/2", 0), marks=pytest.mark.slow),
        (FLAT, (1, "1/2", 0), ("-1/4", "1/2", "1/4")),  # through z = 0 at the start
        pytest.param(LONG, (2, "1/2", 0), ("-1/4", "1/2", "1/4"), marks=pytest.mark.slow),
        pytest.param(FLAT, (1, 0, "1/4"), ("1/4", 0, "3/8"), marks=pytest.mark.slow),  # L = 0
        (LONG, (1, 0, "1/4"), ("1/4", 0, "3/8")),
        (FLAT, (0, 0, "1/4"), ("1/4", "1/8", "3/8")),  # from the axis
        (LONG, (0, 0, "1/4"), (0, 0, "3/8")),  # along the axis
        pytest.param(FLAT, (0, 0, 0), (0, "1/2", 0), marks=pytest.mark.slow),
        (FLAT, (1, 0, "1/2"), (0, 0, 0)),  # from rest
        (FLAT, (1, 0, "1/4"), ("1/4", "1e-9", "3/8")),  # past the axis
    ],
)
def test_stars_in_planes_and_on_the_axis(axes, q, p) -> None:
    assert error(axes, q, p) < 1e-24


@pytest.mark.parametrize("axes", [FLAT, LONG])
def test_circles_and_rest(axes) -> None:
    """A circle in the plane z = 0, as near as floats come to one, and the centre."""
    system = KuzminKutuzov([float(Fraction(x)) for x in axes])
    radius = 1.25
    pull = -system.vector_field(system.state((radius, 0, 0), (0, 0, 0))).p[0]
    speed = float(np.sqrt(radius * pull))
    flow = system.flow(system.state((radius, 0.0, 0.0), (0.0, speed, 0.0)))
    times = np.array([3.0, 1e5])
    path = flow.at(times)
    angles = times * speed / radius
    assert np.allclose(path.q, radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1), atol=1e-10)
    assert max(map(abs, flow.portrait.actions[:2])) < 1e-15
    still = system.flow(system.state((0, 0, 0), (0, 0, 0))).at([1.0, 1e9])
    assert not np.abs(still.q).max()


def test_a_star_at_a_focus() -> None:
    """λ = ν: with L = 0 the motion is on the separatrix between boxes and tubes, and near states remain."""
    system = KuzminKutuzov((1.25, 1.0))
    flow = system.flow(system.state((0, 0, 0.75), (0.25, 0, 0.125)))
    path = flow.at([2.0])
    moved = system.flow(system.state(tuple(path.q[0].tolist()), tuple((-path.p[0]).tolist()))).at([2.0])
    assert np.allclose(moved.q[0], (0, 0, 0.75), atol=1e-13)
    with pytest.raises((PrecisionLoss, NotRepresentable)):
        flow.at([1e9])
    # with L ≠ 0 no star reaches a focus; this one turns about the axis close to it
    assert error(("5/4", 1), ("1/50", 0, "3/4"), ("1/4", "1/8", "1/8")) < 1e-24


def test_what_is_refused() -> None:
    for axes, mass in (((1, 1), 1), ((1, -2), 1), ((1, 2, 3), 1), ((1, 2), 0)):
        with pytest.raises(ArgumentError, match=r"axes = "):
            KuzminKutuzov(axes, mass)
    system = KuzminKutuzov((1.5, 1.0))
    flow = system.flow(system.state((1, 0, 0), (0, 3, 0)))
    assert flow.at([1.0]).q[0, 1] > 2
    with pytest.raises(NotRepresentable, match="unbound"):
        flow.at([1e6])
    with pytest.raises(NotRepresentable, match="unbound"):
        flow.portrait  # noqa: B018
    with pytest.raises(ArgumentError, match="no proven bounds"):
        flow.enclosure([1.0])


@pytest.mark.parametrize("count", [4, pytest.param(12, marks=pytest.mark.slow)])
def test_far_floats_beside_many_digits(count) -> None:
    """Stars of all kinds, of galaxies of both shapes."""
    rng = Random(8)
    for n in range(count):
        axes = rng.uniform(0.2, 3), rng.uniform(0.2, 3)
        system = KuzminKutuzov(axes)
        q, p = ([rng.gauss(0, 1) for _ in range(3)] for _ in range(2))
        bound = system.integrals(system.state(q, (0, 0, 0)))["E"]
        speed = rng.uniform(0.05, 0.95) * np.sqrt(-2 * bound / sum(x * x for x in p))
        state = system.state(q, [speed * x for x in p])
        time = 10 ** rng.uniform(3, 12)
        path = system.flow(state).at([time])
        fine = system.over(MP(40))
        exact = fine.flow(Point(*(tuple(map(fine.field.coerce, part)) for part in state))).at([time])
        for a, b in ((path.q, exact.q), (path.p, exact.p)):
            assert np.abs(a - b.astype(float)).max() <= 4e-16 * np.abs(a).max(), n


@pytest.fixture(scope="module")
def galpy():
    # without its compiled parts it warns
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        pytest.importorskip("galpy")
        import galpy.actionAngle
        import galpy.orbit  # noqa: F401


def beside_galpy(rng):
    """A star, its galaxy, and the same for galpy."""
    from galpy.orbit import Orbit
    from galpy.potential import KuzminKutuzovStaeckelPotential

    ratio, focus = rng.uniform(1.2, 3), rng.uniform(0.4, 1.5)
    short = focus / np.sqrt(ratio**2 - 1)
    potential = KuzminKutuzovStaeckelPotential(amp=1.0, ac=ratio, Delta=focus)
    system = KuzminKutuzov((ratio * short, short))
    R, z, azimuth = rng.uniform(0.5, 2), rng.uniform(-0.5, 0.5), rng.uniform(0, 6)
    out, about, up = (rng.uniform(-0.3, 0.3), rng.uniform(0.2, 0.5), rng.uniform(-0.3, 0.3))
    x, y = np.cos(azimuth), np.sin(azimuth)
    state = system.state((R * x, R * y, z), (out * x - about * y, out * y + about * x, up))
    return system, state, Orbit([R, out, about, z, up, azimuth]), potential, focus


@pytest.mark.parametrize("count", [2, pytest.param(5, marks=pytest.mark.slow)])
def test_galpy_integrates_the_same_orbits(galpy, count) -> None:
    rng = Random(1)
    for _ in range(count):
        system, state, orbit, potential, _ = beside_galpy(rng)
        times = np.linspace(0, 50, 11)
        orbit.integrate(times, potential, method="dop853")
        path = system.flow(state).at(times)
        assert abs(orbit.E(pot=potential) - system.integrals(state)["E"]) < 1e-13
        assert np.allclose(np.stack([orbit.x(times), orbit.y(times), orbit.z(times)], axis=1), path.q, atol=1e-8)


def test_galpy_has_the_same_actions_and_frequencies(galpy) -> None:
    """z covers the oval of ν twice in a period."""
    from galpy.actionAngle import actionAngleStaeckel

    rng = Random(2)
    for _ in range(5):
        system, state, orbit, potential, focus = beside_galpy(rng)
        exact = actionAngleStaeckel(pot=potential, delta=focus, c=False, order=60)
        given = orbit.R(), orbit.vR(), orbit.vT(), orbit.z(), orbit.vz()
        radial, about, vertical, *rates = (float(np.ravel(x)[0]) for x in exact.actionsFreqs(*given, 0.0))
        portrait = system.flow(state).portrait
        ups, outs, turn = portrait.actions
        assert np.allclose((radial, about, vertical), (outs, turn, 2 * ups), rtol=2e-5)
        f_up, f_out, f_turn = portrait.frequencies
        assert np.allclose(np.array(rates) / (2 * np.pi), (f_out, f_turn, f_up / 2), rtol=2e-4)


def test_a_flow_is_the_same_over_all_fields() -> None:
    system = KuzminKutuzov((1.5, 1.0), 2.0, RR)
    assert system.over(MP(20)).constants == (1.5, 1.0)


def test_an_angular_momentum_of_rounding_alone() -> None:
    """L is 0 in floats and 1e-18 exactly: the star passes the axis at that distance, and turns by half a round."""
    system = KuzminKutuzov((1.5, 1.0))
    state = system.state((1.1, 0.3, 0.2), (-0.11, -0.03, 0.35))
    assert system.integrals(state)["L"] == 0
    path, fine = system.flow(state).at([1e6, 1e6 + 1]), system.over(MP(40))
    exact = fine.flow(Point(*(tuple(map(fine.field.coerce, part)) for part in state))).at([1e6, 1e6 + 1])
    assert np.abs(path.q - exact.q.astype(float)).max() < 1e-15
