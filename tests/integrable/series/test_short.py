"""Short runs in floats along Taylor series compared with additions in 40 digits, and cases in which they must be
refused.
"""

from __future__ import annotations

import math
from fractions import Fraction
from random import Random

import numpy as np
import pytest
from mpmath import cos, fdot, mpf, sin, sqrt, workdps

from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import Path, Point
from integrable.mumford.system import MumfordSystem
from integrable.series.kinds import Formulas, Kind
from integrable.series.recurrences import coefficients, convolved, squared
from integrable.series.steps import BRIEF, FINE, ROUGH, WIDE, Steps
from integrable.series.tape import CONSTANT, PRODUCT, VARIABLE, recorded, with_multiples
from jacobian import MP, RR, ArgumentError
from tests.integrable.classical.rows import CASES, REAL
from tests.integrable.ways import constrained, inside

SERIES = [case for case in CASES if case[0] not in ("ball", "top")]
# unsorted, of both signs, one of them twice
TIMES = [12.0, -3.5, 0.0, 0.25, 40.0, -25.0, 12.0]


def by_additions(system: MumfordSystem, state: Point, times):
    """States from the same floats in 40 digits, rounded."""
    K = MP(40)
    fine = system.over(K)
    path = fine.flow(constrained(fine, inside(fine, state))).at(times)
    return path.q.astype(float), path.p.astype(float)


def runs_short(path) -> bool:
    """Whether no additions in long numbers were needed."""
    return "additions" not in path.way


def assert_rounded(path, expected) -> None:
    """Every row is right to the last bits of its largest number."""
    for found, true in zip((path.q, path.p), expected, strict=True):
        assert (np.abs(found - true).max(axis=1) <= 2e-16 * np.abs(true).max(axis=1)).all()


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "n"), SERIES)
def test_near_times_are_those_of_forty_digits(name, n) -> None:
    system, state = REAL[name](RR, n)
    flow = system.flow(state)
    path = flow.at(TIMES)
    assert runs_short(path)
    assert_rounded(path, by_additions(system, state, TIMES))
    # near times one by one; then together with far ones
    assert np.array_equal(np.concatenate([flow.at(t).q for t in TIMES[:3]]), path.q[:3])


SPECIAL = {
    "on a coordinate sphere": (Neumann((1, 2, 4)), (0.6, 0.8, 0), (0.4, -0.3, 0)),
    "at a branch point": (Neumann((1, 2, 4)), (0.6, 0, 0.8), (0.4, 0.5, -0.3)),
    "through the vertical": (LagrangeTop(0.7), (0, 0, 1), (0.1, 0, 1.5)),
    "a plane pendulum": (SphericalPendulum(), (0.6, 0, -0.8), (0.8, 0, 0.6)),
    "a pendulum near its separatrix": (SphericalPendulum(), (0.6, 0, 0.8), (0.4, 0.3, -0.3)),
    "from the centre": (Garnier((-1, -4)), (0, 0), (1, 0.5)),
    "from a turning point": (Garnier((-1, -4)), (1, 0.5), (0, 0)),
    "closed gaps": (TodaLattice(4), (0, 0.5, 0, 0.5), (0.1, -0.1, 0.1, -0.1)),
    "a body about nearly its middle axis": (Veselova((1, 2, 3)), (0.6, 0.8, 0), (-0.8, 0.6, 1e-8)),
}


@pytest.mark.parametrize("name", SPECIAL)
def test_special_positions(name) -> None:
    system, q, p = SPECIAL[name]
    state = system.state(q, p)
    flow, times = system.flow(state), np.linspace(-60, 90, 7)
    path = flow.at(times)
    assert runs_short(path)
    assert_rounded(path, by_additions(system, state, times))


def test_what_rests_rests() -> None:
    flow = TodaLattice(3).flow(TodaLattice(3).state((0.5, 0.5, 0.5), (0, 0, 0)))
    path = flow.at([-1e9, 0, 1e100])
    assert runs_short(path)
    assert (path.q == 0.5).all()
    assert (path.p == 0).all()


@pytest.mark.parametrize("size", [1e-8, 1e-25, 1e-125])
def test_small_motions_of_a_lattice(size) -> None:
    """In double-doubles e^(q_2 − q_1) is 1 there; the motion is in digits beyond those."""
    system = TodaLattice(3)
    state = system.state([size * x for x in (0.3, -0.5, 0.1)], [size * x for x in (0.2, 0.1, -0.7)])
    times = np.array([0.5, -3.0, 20.0])
    near = system.flow(state)._near(times)
    places, rows = np.arange(len(times)) if near.places is None else near.places, near.states
    expected = by_additions(system, state, times[places])
    assert sorted(places) == [0, 1, 2]
    for found, true in zip((rows[:, 0], rows[:, 1]), expected, strict=True):
        assert (np.abs(found - true).max(axis=1) <= 2e-16 * np.abs(true).max(axis=1)).all()


def test_what_is_left_of_forces_that_cancel() -> None:
    """From rest, where the forces cancel but for one rounding: p grows from about 1e-17."""
    rng = Random(3)
    for _ in range(6):
        beta = -rng.uniform(0.5, 3)
        star = HenonHeiles((rng.uniform(-1, 1),), -0.5, beta)
        state = star.state((beta / 1.5, 0), (0, 0))
        times = [0.5, 1.7, 5.0]
        assert_rounded(star.flow(state).at(times), by_additions(star, state, times))


@pytest.mark.parametrize("size", [2.0**150, 2.0**-150])
def test_units_of_time_do_not_matter(size) -> None:
    body = Veselova((1, 2, 3))
    state = body.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    times = np.linspace(1, 30, 9)
    flow = body.flow(body.state(state.q, [size * x for x in state.p]))
    assert np.array_equal(flow.at(times / size).q, body.flow(state).at(times).q)
    assert runs_short(flow.at(times / size))


def test_beyond_a_pole_it_is_no_series() -> None:
    """Of a star beyond the saddle, q_0 = ∞ near t = 6.6: times before that are found by series, later ones are not."""
    star = HenonHeiles.with_frequencies(1, 1.25)
    state = star.state((0.1, 0.05), (0, 0.1))
    flow, times = star.flow(state), [3.0, 8.0, -2.0, 1e2]
    path = flow.at(times)
    assert path.way != "series"
    assert_rounded(path, by_additions(star, state, times))
    places = flow._near(np.array(times)).places
    assert sorted(places) == [0, 2]


@pytest.mark.parametrize("count", [1, 101])
def test_far_times_cost_no_walk(count) -> None:
    """If the last of the times is far, a single series is enough to notice."""
    system, state = REAL["neumann"](RR, 2)
    flow = system.flow(state)
    places = flow._near(np.linspace(1e5, 1e6, count)).places
    assert len(places) == 0


def test_steps_are_short_enough_for_terms_in_floats() -> None:
    """The terms of this pendulum's series decrease late, but then fast: one walk is enough, whose terms in floats are
    small.
    """
    system = SphericalPendulum()
    state = system.state((0.48, 0.6, -0.64), (0.75, -0.6, 0))
    times = np.array([100.0, 400.0])
    kind, given = system._kind, system.flow(state)._walk_given
    near = kind.finished(kind.walked(given, times, 3e4), given, times, 3e4)
    assert not near.lacks(2)
    expected = by_additions(system, state, times)
    assert_rounded(Path(times, near.states.reshape(2, -1)), expected)


def test_what_an_instability_has_blown_up_is_not_handed_out() -> None:
    """The pendulum leaves the vertical like 1e-25 e^t: numbers of 20 or 30 digits are all wrong at t = 80."""
    system = SphericalPendulum()
    flow = system.flow(system.state((1e-25, 0, 1), (0, 1e-25, 0)))
    times = [10.0, 150.0]
    assert_rounded(flow.at(times), by_additions(system, flow.start, times))


def test_bad_and_no_times() -> None:
    system, state = REAL["garnier"](RR, 3)
    flow = system.flow(state)
    assert flow.at([]).q.shape == (0, 3)
    for bad in ([math.nan], [1, math.inf], ["x"], [1 + 1j]):
        with pytest.raises(ArgumentError, match=r"times\["):
            flow.at(bad)


class Foreign(Garnier):
    """A system whose equations of motion use a function of floats only."""

    def _vector_field(self, N, state):
        return Point(state.p, tuple(math.copysign(1.0, x) for x in state.q))


def test_equations_that_are_no_formula_are_left_to_additions() -> None:
    system, state = REAL["garnier"](RR, 2)
    foreign = Foreign(system.constants, *system.parameters)
    assert foreign._kind is None
    assert np.array_equal(foreign.flow(state).at([1.5]).q, system.flow(state).at([1.5]).q)


@pytest.mark.parametrize(("bounds", "last"), [(BRIEF, 10), (ROUGH, 100)])
def test_steps_for_few_of_them_are_right_to_the_last_bits_and_go_no_further(bounds, last) -> None:
    system = Neumann((1, 2, 4))
    state, times = system.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)), np.linspace(0, last, 40)
    walk, given = system._kind.walk(WIDE), system.flow(state)._walk_given
    steps = Steps(WIDE, (bounds,))
    found = walk(*given, times, steps, 1e4)
    assert found.reached == 40
    assert found.wrong is None
    true = walk(*given, times, FINE, 1e4)
    assert np.abs(found.states - true.states).max() <= 2.0**-52
    assert walk(*given, 10 * times, steps, 1e4).reached == 0


def test_walks_that_share_an_error_are_not_taken_for_right() -> None:
    """The errors of terms in floats had the same sign in both walks: 3e-16 in one, 4.4e-16 in the other."""
    system, time = SphericalPendulum(), 57.64737010567073
    q = (0.9073889848172207, -0.3362041320318375, -0.25221421815015194)
    start = Point(q, (1.4631451189757265, 5.1490700211285905, -1.5998180278513123))
    path, (_, true) = system.flow(start).at(time), by_additions(system, start, [time])
    assert np.abs(path.p - true).max() <= 4.5e-16 < np.spacing(np.abs(true).max())


def test_walks_share_no_terms_in_floats_about_the_start() -> None:
    """Within the first step both walks used the same terms: rows were off by a few last bits where the forces of large
    constants cancel, and where all of p is near zero.
    """
    large = Neumann((2e12 + 1, 2e12 + 2, 2e12 + 4))
    times = np.linspace(0.2, 0.2375, 16)
    state = large.state((0.48, 0.6, 0.64), (0.4, 0.32, -0.6))
    assert_rounded(large.flow(state).at(times), by_additions(large, state, times))
    # the motion comes to rest after these times
    fine, system = Garnier((-1,), 1, -3, MP(40)), Garnier((-1,), 1, -3)
    for turn in np.linspace(0.1, 0.25, 25):
        before = fine.flow(fine.state((0.7,), (0,))).at([-turn])
        start = Point((float(before.q[0, 0]),), (float(before.p[0, 0]),))
        times = turn * (1 + 10.0 ** -np.arange(11, 15))
        assert_rounded(system.flow(start).at(times), by_additions(system, start, times))


def test_a_tape_has_its_constants_first_and_operations_by_kind() -> None:
    """Every node comes after its operands, in whatever order the formula produced them."""
    tape = recorded(lambda y: [y[0] * 3 + y[1] * y[1] / (y[0] - 7), (y[0] + y[1]) * y[0], y[1] * y[1] - 3], 2)
    count = tape.kinds.count(CONSTANT)
    assert tape.kinds[: 2 + count] == [VARIABLE] * 2 + [CONSTANT] * count
    assert all(max(tape.left[n], tape.right[n]) < n for n in range(2 + count, len(tape.kinds)))
    assert sorted(map(float, tape.constants[2 : 2 + count])) == [3, 7]
    series = [Fraction(x) for x in (5, 11, *tape.constants[2:]) for _ in range(2)]
    coefficients(tape.kinds, tape.left, tape.right, tape.results, 0, 1, 1, series)
    assert series[1] == 15 + Fraction(121, -2)
    assert series[2 * tape.results[1]] == 80
    assert series[2 * tape.results[2]] == 118


def test_products_with_constants_of_motion_are_multiples() -> None:
    """x' = (z − 3z)x + xy, y' = (x − x)z, z' = 0: y and z are constant."""
    tape = recorded(lambda y: [(y[2] - 3 * y[2]) * y[0] + y[0] * y[1], (y[0] - y[0]) * y[2], 0], 3)
    assert tape.kinds.count(PRODUCT) == 2
    assert tape.constants[tape.results[1]] == tape.constants[tape.results[2]] == 0
    new = with_multiples(tape)
    assert new.kinds.count(PRODUCT) == 0
    assert all(new.left[n] != 0 for n, kind in enumerate(tape.kinds) if kind == PRODUCT)
    walk = Kind("constants", Formulas(lambda N, y: (y[2] * y[0] + y[0] * y[1], N.zero, N.zero), _itself, 3, 3, 3))
    rows = walk.walk(WIDE)(np.zeros(1), (0.5, 1.0, -3.0), np.array([0.5, 2.0]), FINE, 200.0).states
    assert rows[:, 0].tolist() == [[0.5 * math.exp(-2 * t), 1.0, -3.0] for t in (0.5, 2.0)]


def _itself(N, y):
    return y


def test_roots_and_constants_that_are_no_floats() -> None:
    """y' = √(1 + y²)/3, y = sinh(t/3), where 1/3 is no float."""
    formulas = Formulas(lambda N, y: (N.sqrt(1 + y[0] * y[0]) / N.coerce(3), N.zero), lambda N, y: y, 2, 2, 1)
    walk = Kind("growing", formulas).walk(WIDE)
    for times in (np.array([0.5, 11.0]), np.array([-7.0])):
        rows = walk(np.zeros(1), (0.0, 1.0), times, FINE, 200.0).states
        expected = [float(MP(30).context.sinh(MP(30).coerce(t) / 3)) for t in times]
        assert rows[:, 0, 0].tolist() == expected


@pytest.mark.parametrize("k", range(12))
def test_a_convolution_is_its_sum(k) -> None:
    rng = Random(k)
    series = [Fraction(rng.randint(-9, 9), 7) for _ in range(40)]
    for begin in (0, 1):
        expected = sum(series[3 + j] * series[20 + k - j] for j in range(begin, k + 1))
        assert convolved(series, 3, 20, begin, k + 1, k) == expected
        if k >= 2 * begin:
            assert squared(series, 3, begin, k) == convolved(series, 3, 3, begin, k + 1 - begin, k)


@pytest.mark.parametrize("speed", [1e28, 1e55])
def test_walks_with_the_same_steps_do_not_agree_in_what_is_wrong(speed) -> None:
    """A great circle, since all forces are negligible compared with q·|p|²: both walks were off by 4e-12 after 3000
    radians.
    """
    system = Neumann((1, 2.5, 3))
    state = system.state((0.6, 0, 0.8), (0.4 * speed, 0.7 * speed, -0.3 * speed))
    found = system.flow(state).at([1000 / speed, 3000 / speed])
    with workdps(100):
        q, p = ([mpf(x) for x in v] for v in (state.q, state.p))
        q = [x / sqrt(fdot(q, q)) for x in q]
        p = [y - fdot(q, p) * x for x, y in zip(q, p, strict=True)]
        rate = sqrt(fdot(p, p))
        for time, row in zip(found.times, found.q, strict=True):
            turned = [x * cos(rate * time) + y / rate * sin(rate * time) for x, y in zip(q, p, strict=True)]
            assert max(abs(x - y) for x, y in zip(turned, row, strict=True)) < 2e-16
