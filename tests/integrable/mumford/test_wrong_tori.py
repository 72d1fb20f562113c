"""A torus with one wrong sign is rejected: of a period, a corner, a lift, the direction, a sheet or the clock."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.torus import access, lattice
from integrable.torus.corners import Corners
from jacobian.numbers.compiler import interpreted
from tests.integrable.ways import confirmed, forced, has_torus, made_torus

pytestmark = pytest.mark.skipif(interpreted(), reason="the loops of the torus are compiled")

MOTIONS = {
    "Neumann": (Neumann((1, 2, 4)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Neumann, slow": (Neumann((1, 2, 4)), (0.8, 0.0, 0.6), (0.0, 0.05, 0.0)),
    "ellipsoid": (Ellipsoid((1, 2, 4)), (1, 0, 0), (0, 0.6, 0.8)),
    "ellipsoid, other caustic": (Ellipsoid((1, 2, 4)), (0, 0, 2), (0.1, 0.9, 0)),
    "earth": (Ellipsoid((40681077.7, 40680197.6, 40408308.7)), (0, 0, 40408308.7**0.5), (0.6, 0.8, 0)),
    "Garnier": (Garnier((0, 1)), (0.3, 0.5), (0.2, -0.4)),
    "Toda": (TodaLattice(3), (0, 0.5, -0.25), (1, -0.75, -0.25)),
    "Veselova": (Veselova((1, 2, 3)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Veselova, other oval": (Veselova((4, 2, 1)), (0.48, -0.6, 0.64), (0.384, 1.28, 0.912)),
}
# (motion, index of a lift that it carries)
LIFTS = [(name, k) for name in MOTIONS for k in range({"Toda": 0, "Garnier": 2}.get(name, 3))]


def flow_of(name):
    system, q, p = MOTIONS[name]
    return system.flow(system.state(q, p))


@pytest.mark.parametrize("name", MOTIONS)
def test_the_right_torus_is_taken_and_right_in_both_directions(name) -> None:
    flow = flow_of(name)
    assert has_torus(flow)
    times = [-1e5, -3.5, 0, 3.5, 1e5]
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    assert np.abs(found.q - true.q).max() < 1e-15 * np.abs(true.q).max()
    assert np.abs(found.p - true.p).max() < 1e-15 * np.abs(true.p).max()


@pytest.mark.parametrize("place", [(i, j) for i in range(2) for j in range(3)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_wrong_sign_of_a_period_is_noticed(name, place, monkeypatch) -> None:
    right = lattice.signs_of_periods

    def wrong(points, basis):
        signs = right(points, basis)
        signs[place] *= -1
        return signs

    monkeypatch.setattr(lattice, "signs_of_periods", wrong)
    assert not has_torus(flow_of(name))


def with_corners(monkeypatch, change) -> None:
    """Changes all corners of a torus but the start, after its walks have closed."""
    walk = Corners._walk

    def changed(self, forward, most):
        walk(self, forward, most)
        change(self.states.reshape(-1, 10, 2)[1:])

    monkeypatch.setattr(Corners, "_walk", changed)


@pytest.mark.parametrize(("name", "axis"), [each for each in LIFTS if each[0] != "Garnier"])
def test_a_wrong_sign_of_a_corner_is_noticed(name, axis, monkeypatch) -> None:
    def change(states) -> None:
        states[:, [4 + axis, 7 + axis]] *= -1

    with_corners(monkeypatch, change)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize("name", MOTIONS)
def test_the_other_sheet_at_the_corners_is_noticed(name, monkeypatch) -> None:
    def change(states) -> None:
        states[:, [2, 3, 7, 8, 9]] *= -1

    with_corners(monkeypatch, change)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize(("name", "which"), [each for each in LIFTS if "Veselova" not in each[0]])
def test_a_lift_that_is_read_with_the_wrong_sign_is_noticed(name, which) -> None:
    flow = flow_of(name)
    torus = made_torus(flow)
    assert confirmed(flow, torus)
    kappa, size, place = torus._read[which]
    torus._read[which] = kappa, -size, place
    assert not confirmed(flow, torus)


@pytest.mark.parametrize("phases", [(-1, 1), (1, -1), (-1, -1)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_phase_that_runs_back_is_noticed(name, phases, monkeypatch) -> None:
    """One phase runs backwards, or both do, which reverses the motion."""
    right = Corners.turns_along

    def wrong(self, first, second):
        return tuple(sign * nu for sign, nu in zip(phases, right(self, first, second), strict=True))

    monkeypatch.setattr(Corners, "turns_along", wrong)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize("name", ["ellipsoid", "Veselova"])
def test_a_wrong_mean_of_the_clock_is_noticed(name, monkeypatch) -> None:
    right = access.TorusClock.__init__

    def wrong(self, loops, spectrum, rates, *others):
        rates[[0, 1, 4]] *= 1 + 1e-9
        right(self, loops, spectrum, rates, *others)

    monkeypatch.setattr(access.TorusClock, "__init__", wrong)
    assert not has_torus(flow_of(name))
