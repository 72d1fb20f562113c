"""A torus with one wrong sign is rejected: of a period, a lift, the direction, a sheet or the clock."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford import theta_torus
from integrable.mumford.theta_torus import ThetaBasis
from integrable.torus import access
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


@pytest.mark.parametrize("place", [(i, j) for i in range(4) for j in range(3)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_wrong_characteristic_is_noticed(name, place, monkeypatch) -> None:
    """Also the wrong sign that a lift has after a period: two of the four numbers are these signs."""
    right, (number, which) = ThetaBasis.sums, place

    def wrong(self, Z, places):
        chars, k = list(self.chars), places[which % len(places)]
        changed = list(chars[k])
        changed[number] ^= 1
        chars[k] = tuple(changed)
        return right(self._replace(chars=chars), Z, places)

    monkeypatch.setattr(ThetaBasis, "sums", wrong)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize("name", ["Neumann", "Garnier", "Toda", "Veselova", "Veselova, other oval"])
def test_the_other_sheet_is_noticed(name, monkeypatch) -> None:
    """The other motions begin at branch points, where there is one sheet."""
    right = theta_torus.image
    monkeypatch.setattr(theta_torus, "image", lambda *args: tuple(-x for x in right(*args)))
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize(("name", "which"), LIFTS)
def test_a_lift_that_is_read_with_the_wrong_sign_is_noticed(name, which) -> None:
    flow = flow_of(name)
    torus = made_torus(flow)
    assert confirmed(flow, torus)
    kappa, size = torus._sizes[which]
    torus._sizes[which] = kappa, -size
    assert not confirmed(flow, torus)


@pytest.mark.parametrize("phases", [(-1, 1), (1, -1), (-1, -1)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_phase_that_runs_back_is_noticed(name, phases, monkeypatch) -> None:
    """One phase runs backwards, or both do, which reverses the motion."""
    right = theta_torus.theta_basis

    def wrong(Z, model):
        basis = right(Z, model)
        return basis._replace(frequencies=tuple(s * nu for s, nu in zip(phases, basis.frequencies, strict=True)))

    monkeypatch.setattr(theta_torus, "theta_basis", wrong)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize("name", ["ellipsoid", "Veselova"])
def test_a_wrong_mean_of_the_clock_is_noticed(name, monkeypatch) -> None:
    right = access.TorusClock.__init__

    def wrong(self, loops, spectrum, rates, *others):
        rates[[0, 1, 4]] *= 1 + 1e-9
        right(self, loops, spectrum, rates, *others)

    monkeypatch.setattr(access.TorusClock, "__init__", wrong)
    assert not has_torus(flow_of(name))
