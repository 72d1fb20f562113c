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
from integrable.torus import clock
from jacobian.errors import PrecisionLoss
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


def changed(monkeypatch, **changes):
    """Changes fields of the basis of every torus in two bounded ovals; tori in long numbers are not tried."""
    right = theta_torus.oval_basis

    def wrong(model):
        basis = right(model)
        return basis._replace(**{name: change(getattr(basis, name)) for name, change in changes.items()})

    def refused(*args):
        raise PrecisionLoss("not tried")

    monkeypatch.setattr(theta_torus, "oval_basis", wrong)
    monkeypatch.setattr(theta_torus, "theta_basis", refused)


@pytest.mark.thinned(5)
@pytest.mark.parametrize("place", [(i, j) for i in range(4) for j in range(6)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_wrong_characteristic_is_noticed(name, place, monkeypatch) -> None:
    """Also the wrong sign that a lift has after a period: two of the four numbers are these signs."""
    number, which = place
    used = []

    def wrong(chars):
        found = [list(char) for char in chars]
        found[which][number] ^= 1
        return [tuple(char) for char in found]

    right = theta_torus.theta_sums

    def sums(loops, shape, real, chars, *rest):
        used.append(len(chars))
        return right(loops, shape, real, chars, *rest)

    changed(monkeypatch, chars=wrong)
    monkeypatch.setattr(theta_torus, "theta_sums", sums)
    flow = flow_of(name)
    places = []
    ends = theta_torus.ends_of
    monkeypatch.setattr(theta_torus, "ends_of", lambda *args: places.extend(found := ends(*args)) or found)
    taken = has_torus(flow)
    # the characteristics of branch points at which no lift is read are not used, except that of a clock
    assert taken == (which not in {*places, 5} and not (which == 4 and used[-1] > len(places) + 1))


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", MOTIONS)
@pytest.mark.parametrize("change", [-1, 1 + 1e-8])
@pytest.mark.parametrize("which", [0, 1, 2, 3, 4])
def test_a_wrong_shape_is_noticed(name, change, which, monkeypatch) -> None:
    """An entry of Im τ, or the turns of a phase along the direction of the derivative."""

    def wrong(shape):
        if change < 0 and which < 3:
            # with another sign of Y₁₁ or Y₂₂ the series would not converge
            shape[1] *= -1
        else:
            shape[which] *= change
        return shape

    changed(monkeypatch, shape=wrong)
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize(("name", "which"), LIFTS)
def test_a_lift_that_is_read_with_the_wrong_sign_is_noticed(name, which) -> None:
    flow = flow_of(name)
    torus = made_torus(flow)
    assert confirmed(flow, torus)
    torus._torus.sizes[2 * which : 2 * which + 2] *= -1
    assert not confirmed(flow, torus)


@pytest.mark.parametrize("phases", [(-1, 1), (1, -1), (-1, -1), (1 + 1e-8, 1), (1, 1 + 1e-8)])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_phase_that_runs_back_is_noticed(name, phases, monkeypatch) -> None:
    """One phase runs backwards, or both do, which reverses the motion; or one runs at a slightly wrong rate."""
    changed(monkeypatch, frequencies=lambda nu: nu * np.array(phases)[:, None])
    assert not has_torus(flow_of(name))


@pytest.mark.parametrize("name", MOTIONS)
def test_wrong_phases_of_the_start_are_corrected(name, monkeypatch) -> None:
    """Newton's method leads from phases in floats to those of the start, also from those of the other sheet."""
    flow, times = flow_of(name), [-3.5, 1e3]
    right = forced(flow, "torus").at(times)
    changed(monkeypatch, places=lambda x: -x)
    other = flow_of(name)
    if has_torus(other):
        assert np.abs(forced(other, "torus").at(times).q - right.q).max() < 1e-15 * np.abs(right.q).max()


@pytest.mark.parametrize("name", ["ellipsoid", "Veselova"])
def test_a_wrong_mean_of_the_clock_is_noticed(name, monkeypatch) -> None:
    right = clock.TorusClock.__init__

    def wrong(self, loops, spectrum, rates, *others):
        rates[2] *= 1 + 1e-9
        right(self, loops, spectrum, rates, *others)

    monkeypatch.setattr(clock.TorusClock, "__init__", wrong)
    assert not has_torus(flow_of(name))
