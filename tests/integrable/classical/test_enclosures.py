"""Enclosures of motions of any genus contain states at many more digits, are small, and bound the truncation errors."""

from __future__ import annotations

import flint
import numpy as np
import pytest

from integrable.classical.axial import branches
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kdv import KdV
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.veselova import Veselova
from integrable.moving_point import balls
from integrable.mumford import enclosure, series, translations
from integrable.mumford.flow import MumfordFlow, Point
from integrable.mumford.translations import through
from integrable.systems.on_layer import BodyOnLayer
from jacobian import MP, RR
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.numbers.long_reals import BallReals
from jacobian.relatives.extended import PointLift
from tests.integrable.classical.rows import CASES, REAL
from tests.integrable.mumford.picard import taylor
from tests.integrable.ways import inside

REALS = BallReals(300)
# digits of the numbers that balls are compared with
DIGITS = 60
LAYER = [case for case in CASES if case[0] not in ("ball", "galaxy", "top", "veselova")]

LONGER = [("ellipsoid", 3), ("toda", 5), ("barriers", 2)]


def truth(system, state, times):
    """The states at 60 digits; the inputs count as exact."""
    fine = system.over(MP(DIGITS))
    # not checked: floats meet the constraints to their own digits only
    return MumfordFlow(fine, inside(fine, state)).at([fine.field.coerce(t) for t in times])


def contained(found, path) -> bool:
    """Whether every ball has a number within 1e-55 of the one with many digits, which is itself rounded."""
    with REALS:
        pairs = [(x, y) for a, b in ((found.q, path.q), (found.p, path.p)) for x, y in zip(a.flat, b.flat, strict=True)]
        return all((x - REALS.number(y)).overlaps(flint.arb(0, 1e-55) * (1 + abs(x))) for x, y in pairs)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("name", "n"),
    [pytest.param(*case, marks=pytest.mark.slow) if case in LONGER else case for case in LAYER],
)
def test_states_near_and_far(name, n) -> None:
    system, state = REAL[name](MP(25), n)
    times = [system.field.coerce(t) for t in (0, "0.75", -1000)]
    found = system.flow(state).enclosure(times)
    assert (found.radius <= 1e-25).all()
    assert contained(found, truth(system, state, times))
    assert all(x == t for x, t in zip(found.times, times, strict=True))
    assert found.q.shape == (3, system.size)


@pytest.mark.parametrize(
    ("name", "n"), [("neumann", 2), ("toda", 4), pytest.param("neumann", 5, marks=pytest.mark.slow)]
)
def test_a_far_time_costs_bits(name, n) -> None:
    system, state = REAL[name](RR, n)
    found = system.flow(state).enclosure([1e9])
    assert found.radius[0] <= 1e-15
    assert contained(found, truth(system, state, [1e9]))


@pytest.mark.parametrize("genus", [3, pytest.param(5, marks=pytest.mark.slow)])
@pytest.mark.parametrize("make", [lambda g: REAL["ellipsoid"](RR, g), lambda g: REAL["toda"](RR, g + 1)])
def test_higher_genus(genus, make) -> None:
    system, state = make(genus)
    flow = system.flow(state)
    found = flow.enclosure([1.5])
    assert len(system.spectral(state).v) == genus
    assert contained(found, truth(system, state, [1.5]))


@pytest.mark.parametrize(("name", "n"), [("neumann", 2), ("garnier", 3), ("toda", 4), ("lagrange", 3)])
def test_few_bits_make_wide_balls_that_contain_the_motion(name, n, monkeypatch) -> None:
    """Rounding and truncation are the only errors, and both are of the size of the balls."""
    monkeypatch.setattr(enclosure, "OF_GENUS", 0)
    brief = lambda field, *given: series.PointMotion(field, *given[:-1], field.bits // 6 + 4)  # noqa: E731
    monkeypatch.setattr(translations, "PointMotion", brief)
    system, state = REAL[name](RR, n)
    # one time each, because several share the bits that the farthest needs
    near, far = (system.flow(state).enclosure([t], digits=4) for t in (0.75, 3))
    assert max(near.radius[0], far.radius[0]) > 1e-40
    assert contained(near, truth(system, state, [0.75]))
    assert contained(far, truth(system, state, [3]))


@pytest.mark.thinned(3)
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("complex", [False, True])
def test_translations_are_those_of_the_taylor_series(sign, complex) -> None:
    """The points found from integrals, with their data, are those of the motion."""
    system, state = REAL["lagrange" if complex else "ellipsoid"](MP(40), 3)
    place = system.flow(state)._place
    with balls.Balls(300, complex) as K:
        translations = enclosure.EnclosedPlace(K, place).translations()
        group, near, direction = translations.group, translations._series, system._direction(K, 1 if complex else 3)
        points = [kind.x for kind in group.kinds if isinstance(kind, PointLift)]
        start = through(K, *zip(*(point.reached(K.zero) for point in near._points), strict=True))
        expected = taylor(K, group.f, start, direction, 60, points)
        time = K.coerce(sign * near.reach / 2**12)
        for a, b in zip(expected.at(time), near.at(time), strict=True):
            assert all(abs(x - y) < 1e-60 * (1 + abs(y)) for x, y in zip(np.ravel(a), np.ravel(b), strict=True))


def test_balls_of_times() -> None:
    """E of a ball of times contains E of every time in it."""
    system, state = REAL["neumann"](MP(40), 3)
    with balls.Balls(300) as K:
        near = enclosure.EnclosedPlace(K, system.flow(state)._place).translations()._series
        middle, part = near.reach / 8, near.reach / 2**20
        wide = near.at(flint.arb(middle, part))
        for offset in (-part, 0.3 * part, part):
            inner = near.at(flint.arb(middle) + flint.arb(offset))
            assert all(
                x.contains(y) for a, b in zip(wide[:2], inner[:2], strict=True) for x, y in zip(a, b, strict=True)
            )
            assert wide[2].contains(inner[2])


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (Neumann((1, 2, 4, 7)), ("0.6", "0.8", 0, 0), (0, 0, 1, "0.5")),  # on two coordinate planes
        (Neumann((1, 2, 4)), (1, 0, 0), (0, 0, 0)),  # an equilibrium
        (HenonHeiles((1,), "-1/2", "-1/4", 0, ("1/8",)), (0, 0.5), (0, 0)),  # a barrier, from rest
        (LagrangeTop("7/10"), (0, 0, 1), (0.25, 0.5, 1.5)),  # through the vertical
        (Ellipsoid((1, 2, 4)), (1, 0, 0), (0, 0.6, 0.8)),
    ],
)
def test_special_positions(system, q, p) -> None:
    state = system.state(q, p)
    found = system.flow(state).enclosure([1.5])
    assert found.radius[0] <= 1e-15
    assert contained(found, truth(system, state, [1.5]))


def test_lost_bits_are_made_up_for(monkeypatch) -> None:
    monkeypatch.setattr(enclosure, "OF_GENUS", 0)
    system, state = REAL["neumann"](MP(25), 3)
    assert system.flow(state).enclosure([2]).radius[0] <= 1e-25


def test_values_of_tau() -> None:
    """Where t is linear in τ, they are times; for Veselova's body, whose clock has no bounds, only values of τ are
    accepted.
    """
    system, state = REAL["neumann"](RR, 2)
    flow = system.flow(state)
    assert flow.enclosure_at_tau([2.5]) == flow.enclosure([2.5])
    body = Veselova((1, 2, 3))
    start = body.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    motion = body.flow(start)
    (tau,) = motion._places([0.75])
    found = motion.enclosure_at_tau([float(tau)])
    assert found.times is None
    assert np.abs(found.q.astype(float) - motion.at([0.75]).q).max() < 1e-14
    with pytest.raises(ArgumentError, match=r"the clock of Veselova.* has no proven bounds; enclosure_at_tau has them"):
        motion.enclosure([1])


def test_the_ball_has_its_own() -> None:
    """The ball's own enclosure and the layer's, which uses the formulas of genus 2, overlap."""
    system = BodyOnLayer((1, 2, 3), 0.7)
    state = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    own = system.flow(state).enclosure([0.5], digits=12)
    other = system.by_additions(Point(*state)).enclosure_at_tau([-0.25], digits=20)
    again = system.body.flow(system.body.state(*state)).enclosure_at_tau([-0.25], digits=20)
    assert own.q.shape == (1, 3)
    assert own.radius[0] <= 1e-12
    assert all(x.overlaps(y) for x, y in zip(other.q[0], again.gamma[0], strict=True))
    assert all(x.overlaps(y) for x, y in zip(other.p[0], again.M[0], strict=True))


@pytest.mark.parametrize("edges", [(0, 1, 2), (0, 1, 2, 3, 4.5), (0, 0.5, 1, 2, 3, 4, 5.5), (-1, -1, 0)])
def test_waves(edges) -> None:
    gaps = [(low + high) / 2 for low, high in zip(edges[1::2], edges[2::2], strict=True)]
    wave, fine = ((kdv := KdV(edges, K)).wave(kdv.state(gaps, [1, -1, 1][: len(gaps)])) for K in (RR, MP(DIGITS)))
    x, t = np.array([0, 1.5, 50.0]), np.array([[0], [-2.25]])
    x, t = (x[:2], t / 8) if edges[0] == -1 else (x, t)
    found, expected = wave.enclosure(x, t), fine.at(x, t)
    assert found.shape == expected.shape
    with REALS:
        for ball, number in zip(found.flat, expected.flat, strict=True):
            assert ball.rad() < 1e-15 * (edges[-1] - edges[0])
            assert (ball - REALS.number(number)).overlaps(flint.arb(0, 1e-55))


@pytest.mark.parametrize(
    ("system", "q", "p", "time"),
    [
        (LagrangeTop(0.7), (1e-100, 0, 1), (0, 0, 0.5), 250.0),  # a sleeping top but for 1e-100
        (Neumann((1, 2, 4)), (0, 0, 1), (1e-100, 0, 0), 140.0),  # at rest but for 1e-100
    ],
)
def test_what_leaves_an_unstable_rest(system, q, p, time) -> None:
    """Additions in long numbers, balls and floats agree on a start that rounding would put at rest."""
    flow = system.flow(system.state(q, p))
    path, found = flow.at([time]), flow.enclosure([time], digits=18)
    assert np.abs(path.q[0, :2]).max() > 1e-6
    for row, balls_of in ((path.q[0], found.q[0]), (path.p[0], found.p[0])):
        assert np.abs(row - balls_of.astype(float)).max() <= 1e-15 * np.abs(row).max()


def test_whether_a_ball_is_zero_is_not_guessed() -> None:
    assert branches(flint.arb(0))
    assert not branches(flint.arb(1, 0.5))
    with pytest.raises(PrecisionLoss, match="through the vertical"):
        branches(flint.arb(0, 1e-30))
    with balls.Balls(100) as K, pytest.raises(PrecisionLoss, match="apart from the branch points"):
        series.PointIntegrals(K, (K.zero, K.one, K.zero, K.one), (flint.arb(1e-40), flint.arb(0, 1e-20)), (), 20)


def test_refusals_are_in_words(monkeypatch) -> None:
    system, state = REAL["neumann"](RR, 2)
    flow = system.flow(state)
    with pytest.raises(ArgumentError, match="digits = 0: the balls' digits are an int"):
        flow.enclosure([1], digits=0)
    with pytest.raises(PrecisionLoss, match=r"no balls of radius 1e-15 were found with .* bits"):
        flow.enclosure([1e300])
    assert flow.enclosure([]).q.shape == (0, 3)
