"""Motions of genus 2 on their real torus: the states that additions in long numbers give, signs included."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import MANY, Point
from integrable.mumford.motion import MumfordMotion
from integrable.mumford.real_torus import RealTorus
from integrable.torus.corners import Corners
from jacobian import RR
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import SecondKind, ThirdKind

pytestmark = pytest.mark.skipif(interpreted(), reason="the loops of the torus are compiled")


def on_sphere(a, q, p):
    q = np.array(q) / np.linalg.norm(q)
    system = Neumann(a)
    return system, system.state(q, p - q * (q @ p))


NEUMANN = [
    ((1, 2, 4), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    ((1, 2, 4), (0.8, 0.1, 0.2), (0.1, 0.05, -0.02)),  # both b above a_1: q_1 keeps its sign
    ((1, 2, 4), (-0.8, 0.3, 0.2), (0.1, 0.7, -0.02)),
    ((5, -2, 1), (0.1, 0.9, 0.4), (3.0, 0.3, 0.1)),
    ((1, 2, 4), (0.0, 0.6, 0.8), (1.0, 0.5, 0.0)),  # on a coordinate plane
    ((100, 101, 103), (0.5, 0.5, 0.7), (0.3, 0.9, -0.2)),
    ((1e-3, 2e-3, 5e-3), (0.5, 0.5, 0.7), (0.01, 0.02, -0.03)),
]
TODA = [
    ((0, 0.5, -0.25), (1, -0.75, -0.25)),
    ((0, 1, -1), (0, 0, 0)),
    ((2, 0, -3), (5, 1, -6)),
    ((0, 0, 0.3), (0.1, 0.2, 0.3)),
]
VESELOVA = [
    ((1, 2, 3), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    ((4, 2, 1), (0.48, -0.6, 0.64), (0.384, 1.28, 0.912)),
    ((100, 101, 103), (-0.6, 0.8, 0.0), (0.8, 0.6, -0.3)),
    ((1, 2, 3), (0.6, 0.8, 0.0), (0.0, 0.0, 1.0)),  # about an axis for ever: an oval is a point
]
CASES = [on_sphere(a, q, np.array(p)) for a, q, p in NEUMANN]
CASES += [(TodaLattice(3), TodaLattice(3).state(q, p)) for q, p in TODA]
CASES += [(Veselova(moments), Veselova(moments).state(*row)) for moments, *row in VESELOVA]
CASES += [(Garnier((0, 1)), Garnier((0, 1)).state((0.3, 0.5), (0.2, -0.4)))]
GEODESICS = [
    ((1, 2, 4), (0.5, 0.6, 0.9), (0.3, -0.8, 0.2)),
    ((1, 2, 4), (0.3, 0.4, 0), (0.6, 0.8, 0.3)),  # on a coordinate plane
    ((4, 1, 2), (1, 0, 0), (0, 3, 4)),  # a vertex, with another speed
    ((0.03, 4, 10), (0.1, 0.5, 0.2), (0.1, 0.3, -0.6)),  # thin
    ((40681077.7, 40680197.6, 40408308.7), (0, 0, 1), (0.6, 0.8, 0)),  # the earth, in km
]


def geodesic(a, q, p):
    system = Ellipsoid(a)
    return system, system._constrained(RR, Point(tuple(map(float, q)), tuple(map(float, p))))


CASES += [geodesic(*case) for case in GEODESICS]
TIMES = [0, 0.5, 1, -3.7, 20, 1e3, 1e6 + 0.25, -2e6]


@pytest.mark.parametrize("case", range(len(CASES)))
def test_many_times_are_those_of_additions(case):
    system, state = CASES[case]
    flow = system.flow(state)
    assert flow._torus is not None
    # turns of a phase grow with the speed over the size
    unit = max(map(abs, state.q)) / max(map(abs, state.p)) if isinstance(system, Ellipsoid) else 1.0
    times = [unit * t for t in TIMES]
    few, many = flow.at(times), flow.at(times * (MANY // len(TIMES) + 1))
    for found, true in ((many.q, few.q), (many.p, few.p)):
        assert np.abs(found[: len(TIMES)] - true).max() < 1e-15 * np.abs(true).max()


@pytest.mark.parametrize("case", [CASES[0], geodesic(*GEODESICS[0])], ids=["Neumann", "geodesic"])
def test_floats_at_a_million_periods_are_right(case):
    system, state = case
    flow = system.flow(state)
    torus = flow._torus
    period = (1.0 if torus.clock is None else float(torus.mean)) / torus._fastest
    times = np.linspace(0, 1e6 * period, MANY)
    true = [flow._motion.row(t, flow._reader(t), 40, flow._clock) for t in times[-3:].tolist()]
    q = np.array([[float(x) for x in row[0]] for row in true])
    assert np.abs(flow.at(times).q[-3:] - q).max() < 1e-15


def with_datum(system, state, kind, value):
    """The start of a motion that carries one datum more."""

    def place(N):
        start = system._start(N, system._constrained(N, system._inside(N, state)))
        return start._replace(kinds=(*start.kinds, kind), data=(*start.data, N.coerce(value)))

    return place


def test_data_of_the_second_and_third_kind_are_those_of_additions():
    times = np.array([0, 0.5, -3.7, 20, 1e3])
    toda, garnier = (next(case for case in CASES if isinstance(case[0], kind)) for kind in (TodaLattice, Garnier))
    for (system, state), kind, value in ((toda, ThirdKind(1.0), 3), (garnier, SecondKind(), 0.25)):
        place = with_datum(system, state, kind, value)
        found, motion = RealTorus(place).at(times), MumfordMotion(place, 2)
        true = [float(motion.row(t, lambda N, D: [D.data[-1:]], 16)[0][0]) for t in times.tolist()]
        assert np.abs(found.data[-1].hi / true - 1).max() < 1e-14
        if isinstance(kind, ThirdKind):
            # the first particle: q_1 = q_1(0) + tΣp − ∫Σx²dx/y
            q = system.flow(state).at(times).q[:, 0]
            assert np.abs(state.q[0] + times * sum(state.p) - np.log(found.data[-1].hi / value) - q).max() < 1e-12


def test_neighbours_on_the_torus_are_neighbours():
    """No corner of a cell, no period and no sign shows."""
    system, state = CASES[0]
    times = np.linspace(0, 40, 4001)
    path = system.flow(state).at(times)
    rates = np.array(
        [np.ravel(system.vector_field(system.state(q, p))) for q, p in zip(path.q[::50], path.p[::50], strict=True)]
    )
    rows = np.hstack([path.q, path.p])
    slopes = (rows[2:] - rows[:-2]) / 0.02
    assert np.abs(slopes[49::50] - rates[1:-1][: len(slopes[49::50])]).max() < 1e-3
    assert max(np.abs(b - a).max() for a, b in pairwise(rows)) < 0.05


def test_what_has_no_torus_takes_additions():
    """A separatrix, a closed gap, and times that are too far for double-doubles."""
    system = Neumann((1, 2, 4))
    for q, p in (((0, 1, 0), (0, 0, 0)), ((0, 0.6, 0.8), (0, 0.8, -0.6))):
        flow = system.flow(system.state(q, p))
        assert flow._torus is None
        assert flow.at(np.linspace(0, 3, MANY)).q[0].tolist() == list(q)
    body = Veselova((1, 2, 4))
    assert body.flow(body.state((0.6, 0, 0.8), (0, 1, 0)))._torus is None
    lattice = TodaLattice(3)
    assert lattice.flow(lattice.state((0, 0, 0), (1, 1, 1)))._torus is None
    system, state = CASES[0]
    flow = system.flow(state)
    far = [1e17] * MANY
    assert flow.at(far).q[0].tolist() == flow.at(far[:1]).q[0].tolist()
    with pytest.raises(PrecisionLoss, match="turns of a phase"):
        flow._torus.at(np.array([1e17]))


def test_a_torus_says_what_it_does_not_take():
    system = Neumann((1, 2, 4, 7))
    state = system.state((0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1))
    with pytest.raises(PrecisionLoss, match="genus 2"):
        RealTorus(lambda N: system._start(N, system._inside(N, state)))


def test_cells_that_do_not_fit_are_left_to_additions(monkeypatch):
    system, state = CASES[0]
    walk = Corners._walk

    def rough(self, forward, most):
        walk(self, forward, most)
        # of every other corner
        self.states[::20, 0] += 1e-10

    monkeypatch.setattr(Corners, "_walk", rough)
    flow = system.flow(state)
    with pytest.raises(PrecisionLoss, match="cells of this motion's torus do not fit"):
        RealTorus(flow._place)
    assert flow._torus is None
