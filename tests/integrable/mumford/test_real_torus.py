"""Motions of genus 2 on their real torus, compared with additions in long numbers, signs included."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import Point
from integrable.mumford.theta_torus import ThetaTorus
from jacobian.errors import PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.relatives.extended import SecondKind, ThirdKind
from tests.integrable.ways import constrained, forced, has_torus, inside

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
    return system, constrained(system, Point(tuple(map(float, q)), tuple(map(float, p))))


CASES += [geodesic(*case) for case in GEODESICS]
TIMES = [0, 0.5, 1, -3.7, 20, 1e3, 1e6 + 0.25, -2e6]


@pytest.mark.thinned(4)
@pytest.mark.parametrize("case", range(len(CASES)))
def test_many_times_are_those_of_additions(case):
    system, state = CASES[case]
    flow = system.flow(state)
    assert has_torus(flow)
    # the turns of a phase are proportional to speed over size
    unit = max(map(abs, state.q)) / max(map(abs, state.p)) if isinstance(system, Ellipsoid) else 1.0
    times = [unit * t for t in TIMES]
    found, true = forced(flow, "torus").at(times), forced(flow, "additions").at(times)
    for some, other in ((found.q, true.q), (found.p, true.p)):
        assert np.abs(some - other).max() < 1e-15 * np.abs(other).max()


@pytest.mark.parametrize("case", [CASES[0], geodesic(*GEODESICS[0])], ids=["Neumann", "geodesic"])
def test_floats_at_a_million_periods_are_right(case):
    system, state = case
    flow = system.flow(state)
    # periods are a few units of time
    times = [1e6, 3e6 + 0.5, -1e7]
    found = flow.at(times)
    assert found.way == "torus"
    assert np.abs(found.q - forced(flow, "additions").at(times).q).max() < 1e-15


def with_datum(system, state, kind, value):
    """The start of a motion that carries one more datum."""

    def place(N):
        start = system._start(N, constrained(system, inside(system, state, N), N))
        return start._replace(kinds=(*start.kinds, kind), data=(*start.data, N.coerce(value)))

    return place


def test_data_that_are_not_the_time_are_left_to_additions():
    toda, garnier = (next(case for case in CASES if isinstance(case[0], kind)) for kind in (TodaLattice, Garnier))
    with pytest.raises(PrecisionLoss, match="without lifts but at branch points"):
        ThetaTorus(with_datum(*toda, ThirdKind(1.0), 3))
    with pytest.raises(PrecisionLoss, match="second kind that is not the time"):
        ThetaTorus(with_datum(*garnier, SecondKind(), 0.25))


@pytest.mark.parametrize("case", range(len(GEODESICS)))
def test_the_clock_of_a_geodesic_is_right_after_many_turns(case):
    """The mean of dt/dτ is a determinant of integrals; the sum over a grid used before failed at 2^26 turns."""
    system, state = geodesic(*GEODESICS[case])
    flow = system.flow(state)
    # a period is about the time once around the ellipsoid at this speed
    around = float(max(system.constants)) ** 0.5 / max(map(abs, state.p))
    times = [2.0**40 * around, -(2.0**46) * around]
    found, true = flow.at(times), forced(flow, "additions").at(times)
    assert found.way == "torus"
    assert np.abs(found.q - true.q).max() < 1e-15 * np.abs(true.q).max()
    assert np.abs(found.p - true.p).max() < 1e-15 * np.abs(true.p).max()


def test_neighbours_on_the_torus_are_neighbours():
    """No jump at periods or sign changes."""
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
    """A separatrix, a closed gap, and times too far for double-doubles."""
    system = Neumann((1, 2, 4))
    for q, p in (((0, 1, 0), (0, 0, 0)), ((0, 0.6, 0.8), (0, 0.8, -0.6))):
        flow = system.flow(system.state(q, p))
        assert not has_torus(flow)
        assert flow.at([0, 1.5, 3]).q[0].tolist() == list(q)
    body = Veselova((1, 2, 4))
    assert not has_torus(body.flow(body.state((0.6, 0, 0.8), (0, 1, 0))))
    lattice = TodaLattice(3)
    assert not has_torus(lattice.flow(lattice.state((0, 0, 0), (1, 1, 1))))
    system, state = CASES[0]
    flow = system.flow(state)
    far = flow.at([1e17])
    assert far.way == "additions"
    with pytest.raises(PrecisionLoss, match="turns of a phase"):
        forced(flow, "torus").at([1e17])


def test_a_torus_says_what_it_does_not_take():
    system = Neumann((1, 2, 4, 7))
    state = system.state((0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1))
    with pytest.raises(PrecisionLoss, match="genus 2"):
        ThetaTorus(lambda N: system._start(N, inside(system, state, N)))


@pytest.mark.parametrize("case", [0, 7, 11, len(CASES) - 1])
def test_an_answer_does_not_depend_on_what_was_asked_before(case) -> None:
    system, state = CASES[case]
    times = [3.5, 70.0, 1e6]
    used = system.flow(state)
    used.at(np.linspace(-1e5, 1e5, 30))
    forced(used, "additions").at([1.0])
    one, other = system.flow(state).at(times), used.at(times)
    assert one.way == other.way
    assert np.array_equal(one.q, other.q)
    assert np.array_equal(one.p, other.p)
