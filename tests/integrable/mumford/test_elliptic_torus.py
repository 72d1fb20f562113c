"""Motions of genus 1 in closed form, compared with additions in long numbers, signs included."""

from __future__ import annotations

import numpy as np
import pytest

from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford.elliptic_torus import LIBRARY, EllipticTorus, OvalThetas, oval_points
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from tests.integrable.ways import forced, has_torus

pytestmark = pytest.mark.skipif(interpreted(), reason="the closed form is compiled")

MOTIONS = {
    "Neumann, swinging": (Neumann((1, 4)), (0.8, 0.6), (-0.3, 0.4)),
    "Neumann, going round": (Neumann((1, 4)), (0.8, 0.6), (-1.8, 2.4)),
    "Neumann, going back": (Neumann((1, 4)), (0.8, 0.6), (1.8, -2.4)),
    "Neumann, other axes": (Neumann((4, -1)), (0.6, -0.8), (0.8, 0.6)),
    "Neumann, from an axis": (Neumann((1, 4)), (1, 0), (0, 0.5)),
    "Neumann, from the other axis": (Neumann((1, 4)), (0, 1), (0.5, 0)),
    "Neumann, from rest": (Neumann((1, 4)), (0.8, 0.6), (0, 0)),
    "Neumann, all but on a separatrix": (Neumann((1, 4)), (1, 0), (0, 3**0.5)),
    "Neumann, close": (Neumann((100, 101)), (0.8, 0.6), (0.3, -0.4)),
    "Toda": (TodaLattice(2), (0, 0.5), (1, -0.75)),
    "Toda, back": (TodaLattice(2), (0, 0.5), (-1, 0.75)),
    "Toda, small": (TodaLattice(2), (0, 1e-6), (0.5, 0.5)),
    "Toda, violent": (TodaLattice(2), (3, -3), (5, -7)),
    "Garnier": (Garnier((-1,)), (0.5,), (0.3,)),
    "Garnier, from the middle": (Garnier((-1,)), (0,), (-0.3,)),
    "Garnier, from rest": (Garnier((-1,)), (-0.5,), (0,)),
}


def flow_of(name):
    system, q, p = MOTIONS[name]
    return system.flow(system.state(q, p))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", MOTIONS)
def test_the_closed_form_has_the_states_of_additions(name) -> None:
    """In both directions, after 2^40 rounds, and with lifts at each of the branch points."""
    flow, times = flow_of(name), [0.5, -1.25, 7.5, -40, 1e3, 2.0**20, -(2.0**40) - 0.5]
    assert has_torus(flow)
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    for one, other in ((found.q, true.q), (found.p, true.p)):
        assert (np.abs(one - other) <= 4e-16 * np.abs(other).max(axis=1, keepdims=True)).all()
    assert flow.at([1e6]).way == "torus"


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (Neumann((1, 4)), (0, 1), (0, 0)),
        (Neumann((1, 4)), (1, 0), (0, 0)),
        (TodaLattice(2), (0, 0), (1, 1)),
        (Garnier((1,)), (2,), (5,)),
        (Garnier((0,)), (0,), (0,)),
    ],
)
def test_rest_and_separatrices_are_left_to_additions(system, q, p) -> None:
    flow = system.flow(system.state(q, p))
    if not has_torus(flow):
        with pytest.raises(PrecisionLoss):
            EllipticTorus(flow._place)
    path = flow.at([0, 3.0])
    assert path.q[0].tolist() == list(map(float, q))


@pytest.mark.thinned(3)
@pytest.mark.parametrize("sign", ["direction", "start", "sn", "cn", "dn", "slope", "lift 0", "lift 1"])
@pytest.mark.parametrize("name", ["Neumann, swinging", "Neumann, going back", "Toda", "Garnier"])
def test_a_wrong_sign_is_noticed(name, sign, monkeypatch) -> None:
    right = EllipticTorus.__init__
    place = {"direction": 0, "start": 1, "sn": 2, "cn": 3, "dn": 4}
    noticed = []

    def wrong(self, given):
        right(self, given)
        if sign in place:
            self._oval.numbers[place[sign]] *= -1
            noticed.append(True)
        elif sign == "slope" and not self._lifts:
            self._slope = -self._slope
            noticed.append(True)
        elif "lift" in sign and int(sign[-1]) < len(self._lifts):
            kappa, size, slope, which = self._lifts[int(sign[-1])]
            self._lifts[int(sign[-1])] = kappa, -size, slope, which
            noticed.append(True)

    assert has_torus(flow_of(name))
    monkeypatch.setattr(EllipticTorus, "__init__", wrong)
    # a motion that does not use it cannot notice
    assert has_torus(flow_of(name)) != bool(noticed)


def test_the_source_interpreted_in_long_numbers_is_what_is_compiled() -> None:
    flow, reals = flow_of("Neumann, swinging"), BareReals(200)
    torus = EllipticTorus(flow._place)
    times = [0.5, -3.25, 100.0]
    with reals:
        oval = OvalThetas(*([reals.number(x) + reals.number(y) for x, y in row.tolist()] for row in torus._oval))
        out = [reals.number(0)] * 9
        oval_points(oval, times, (0, 1), out)
    compiled = np.empty((9, 2))
    LIBRARY.oval_points(torus._oval, np.stack([times, np.zeros(3)], axis=1), (0, 1), compiled)
    assert np.abs([float(x) for x in out] - compiled[:, 0]).max() < 1e-15


def test_energy_and_the_circle_are_kept() -> None:
    flow = flow_of("Neumann, swinging")
    times = np.linspace(1e4, 1e4 + 10, 50)
    path = flow.at(times)
    energy = (path.p**2).sum(axis=1) + path.q**2 @ np.array([1.0, 4.0])
    assert np.abs(energy - energy[0]).max() < 1e-14
    assert np.abs((path.q**2).sum(axis=1) - 1).max() < 1e-15
