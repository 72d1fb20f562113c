"""Lagrange's top and the spherical pendulum in closed form, compared with additions in long numbers."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from integrable.classical import axial_torus
from integrable.classical.axial_loops import AxialThetas, axial_states
from integrable.classical.axial_torus import AxialTorus
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.mumford.flow import Point
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from tests.integrable.ways import constrained, forced, has_torus

pytestmark = pytest.mark.skipif(interpreted(), reason="the closed form is compiled")

PENDULUM, TOP, FLAT = SphericalPendulum(), LagrangeTop(0.7), LagrangeTop(1)
Z = -0.6
MOTIONS = {
    "pendulum": (PENDULUM, (0.6, 0, -0.8), (0.1, 0.9, 0.075)),
    "pendulum, the other way round": (PENDULUM, (0.6, 0, -0.8), (0.1, -0.9, 0.075)),
    "pendulum at its highest": (PENDULUM, (0.8, 0.0, 0.6), (0.0, 0.5, 0.0)),
    "pendulum at its lowest": (PENDULUM, (0.6, 0.0, -0.8), (0.0, 1.5, 0.0)),
    "planar": (PENDULUM, (0.6, 0, -0.8), (0.8, 0, 0.6)),
    "planar from rest": (PENDULUM, (0.6, 0.8, 0.0), (0, 0, 0)),
    "planar from below": (PENDULUM, (0, 0, -1), (0.6, -0.8, 0)),
    "planar over the top": (PENDULUM, (0.6, 0, -0.8), (2.4, 0, 1.8)),
    "planar from above": (PENDULUM, (0, 0, 1), (0.3, 0.4, 0)),
    "nearly planar": (PENDULUM, (0.6, 0, -0.8), (0.8, 1e-9, 0.6)),
    "conical": (PENDULUM, (0.8, 0, Z), (0, 0.8 / 0.6**0.5, 0)),
    "nearly conical": (PENDULUM, (0.8, 0, Z), (0, 0.8 / 0.6**0.5 * (1 + 1e-7), 0)),
    "all but on a separatrix": (PENDULUM, (1, 0, 0), (0, 0, 2**0.5)),
    "small": (PENDULUM, (1e-6, 2e-6, -1), (3e-6, -1e-6, 0)),
    "top": (TOP, (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "top, turning back": (TOP, (0.48, 0.6, 0.64), (-0.384, -1.28, 1.488)),
    "top from rest on its tip": (TOP, (0.6, 0, 0.8), (0, 0, 3)),
    "fast top": (TOP, (0.6, 0, 0.8), (0.1, 0, 300.0)),
    "top through the upper vertical": (TOP, (0, 0, 1), (0.3, -0.4, 1.0)),
    "top through the lower vertical": (FLAT, (0, 0, -1), (0.3, -0.4, 1.0)),
    "top beside the upper vertical": (TOP, (1e-9, 0, 1), (0.3, -0.4, 1.0)),
    "top hardly asleep": (TOP, (1e-6, 0, 1), (0, 1e-6, 2.001)),
    "top without spin": (FLAT, (0.6, 0, 0.8), (0.3, 0.5, 0)),
    "steady top": (FLAT, (0.6, 0, 0.8), (-0.6 * 0.5, 0, 0.8 * 0.5 + 2.0)),
}


def started(name):
    system, q, p = MOTIONS[name]
    return system, constrained(system, Point(tuple(map(float, q)), tuple(map(float, p))))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", MOTIONS)
def test_the_closed_form_has_the_states_of_additions(name) -> None:
    """Every branch of the signs: in both directions, at the start itself, and after 2^40 periods."""
    flow = (lambda system, state: system.flow(state))(*started(name))
    times = [0, 0.5, -1.25, 7.5, -40, 1e3, 2.0**20, -(2.0**40) - 0.5]
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    size = np.abs(true.p).max(axis=1, keepdims=True)
    assert np.abs(found.q - true.q).max() < 3e-16
    assert (np.abs(found.p - true.p) <= 3e-16 * size).all()


@pytest.mark.parametrize("name", ["pendulum", "top", "planar from below", "top through the upper vertical"])
def test_few_far_times_are_in_closed_form(name) -> None:
    system, state = started(name)
    path = system.flow(state).at([1e6])
    assert path.way == "torus"
    assert path.q[0].tolist() == system.flow(state).at([3, 1e6, 2e6]).q[1].tolist()


@pytest.mark.parametrize(
    ("system", "q", "p"),
    [
        (TOP, (0, 0, 1), (0, 0, 3)),  # a sleeping top
        (TOP, (0, 0, 1), (0, 0, 1.5)),  # an unstable sleeping top
        (TOP, (0, 0, 1), (0, 0, 2)),  # the fastest spin that is not stable
        (PENDULUM, (0, 0, 1), (0, 0, 0)),
        (PENDULUM, (0, 0, -1), (0, 0, 0)),
        (PENDULUM, (1e-30, 0, -1), (0, 0, 0)),
    ],
)
def test_separatrices_and_rest_are_left_to_additions(system, q, p) -> None:
    flow = system.flow(system.state(q, p))
    with pytest.raises(PrecisionLoss):
        AxialTorus(system, flow.start)
    assert not has_torus(flow)
    with suppress(PrecisionLoss):
        assert "torus" not in flow.at([500.0]).way


SIGNS = [*range(10), "alpha", "beta"]


@pytest.mark.thinned(5)
@pytest.mark.parametrize("sign", SIGNS)
@pytest.mark.parametrize("name", ["pendulum", "top", "top, turning back", "top beside the upper vertical"])
def test_a_wrong_sign_is_noticed(name, sign, monkeypatch) -> None:
    """One of the following has a wrong sign: a rate, the start, a part of the constant, the zeros of g, or the source
    of z.
    """
    right = axial_torus._turning

    def wrong(*given):
        numbers, table = right(*given)
        numbers, table = [*numbers], [*table]
        if sign == "alpha":
            table[1::8] = [-x for x in table[1::8]]
        elif sign == "beta":
            table[3::8] = [-x for x in table[3::8]]
        else:
            numbers[sign] = -numbers[sign]
        return numbers, table

    system, state = started(name)
    assert has_torus(system.flow(state))
    monkeypatch.setattr(axial_torus, "_turning", wrong)
    flow = system.flow(state)
    assert not has_torus(flow)
    assert flow.at([1e4]).way == "additions"


@pytest.mark.parametrize("name", ["pendulum", "top through the upper vertical", "planar over the top"])
def test_the_source_interpreted_in_long_numbers_is_what_is_compiled(name) -> None:
    system, state = started(name)
    torus, reals = AxialTorus(system, state), BareReals(200)
    times = [0.5, -3.25, 100.0]
    with reals:
        rows = [[reals.number(x) + reals.number(y) for x, y in row.tolist()] for row in torus._motion[:3]]
        out = [0.0] * 18
        axial_states(AxialThetas(*rows, torus._motion.top), times, out)
    assert np.abs(np.reshape(out, (3, 6)) - torus.at(np.array(times))).max() < 1e-15
