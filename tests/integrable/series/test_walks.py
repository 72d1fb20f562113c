"""Compiled walks of kinds of systems: comparison with recurrences in long numbers, tolerances, and compilation."""

from __future__ import annotations

import math
from random import Random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.kuzmin_kutuzov import KuzminKutuzov
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import ROUNDED, Point
from integrable.mumford.system import MumfordSystem
from integrable.series import sums_text
from integrable.series.kinds import Formulas, Kind
from integrable.series.room import Orders
from integrable.series.steps import BRIEF, FINE, FINEST, ROUGH, WIDE, Steps, steps_for
from integrable.series.walk import WRONG, Codes, Compared, Given, Outputs, compared, goes_on
from integrable.series.walk import walked as by_the_readable_loop
from integrable.series.walk_compiled import LIBRARY
from jacobian import MP, RR, ArgumentError
from jacobian.native import kept, machine
from tests.integrable.classical.rows import REAL
from tests.integrable.series.readable import states_of
from tests.integrable.ways import constrained, inside

SOME = [("neumann", 2), ("toda", 3), ("pendulum", 3), ("lagrange", 3), ("garnier", 3), ("veselova", 3)]
over_some = pytest.mark.parametrize(("name", "n"), SOME)


def both(path):
    return np.stack([path.q, path.p], axis=1)


def off(found, true):
    """The largest difference of q relative to the largest q, or of p relative to the largest p."""
    return (np.abs(found - true).max(axis=-1) / np.abs(true).max(axis=-1)).max()


@pytest.mark.thinned(4)
@over_some
def test_the_compiled_walk_and_the_recurrences_differ_by_rounding_only(name, n) -> None:
    system, state = REAL[name](RR, n)
    times = np.array([7.0, -3.0, 0.0, 0.5, 21.0])
    near = system._kind.walked(system.flow(state)._walk_given, times, 3e4)
    assert sorted(near.places) == [0, 1, 2, 3, 4]
    found = near.states[np.argsort(near.places)]
    true = states_of(system._kind, *system.flow(state)._walk_given, times)
    assert off(found, np.reshape(true, found.shape)) <= 2.0**-52


def test_a_walk_is_the_same_for_times_in_any_order() -> None:
    system, state = REAL["neumann"](RR, 2)
    flow, times = system.flow(state), np.linspace(0, 9, 50)
    there = both(flow.at(times))
    mixed = np.random.default_rng(1).permutation(50)
    assert np.array_equal(both(flow.at(times[mixed])), there[mixed])
    # lists, integers, a single number; backwards in time
    assert np.array_equal(both(flow.at([0, 9])), there[[0, -1]])
    assert np.array_equal(both(flow.at(9.0)), there[-1:])
    back = system.flow(system.state(state.q, tuple(-y for y in state.p))).at(-times)
    assert np.array_equal(back.q, there[:, 0])
    assert np.array_equal(back.p, -there[:, 1])


def test_what_was_asked_before_decides_nothing() -> None:
    system, state = REAL["ellipsoid"](RR, 2)
    times = [0.5, 30.0, 150.0]
    fresh = both(system.flow(state).at(times))
    used = system.flow(state)
    used.at([1e5, 2e5])
    assert np.array_equal(both(used.at(times)), fresh)


@over_some
def test_a_tolerance_is_kept_and_its_estimate_is_one(name, n) -> None:
    system, state = REAL[name](RR, n)
    times = np.linspace(0, 40, 9)
    exact = both(system.flow(state).at(times))
    for tolerance in (1e-6, 1e-9, 1e-12):
        path = system.flow(state, tolerance=tolerance).at(times)
        assert path.way.startswith("series")
        error = off(both(path), exact)
        assert error <= tolerance
        assert error <= 3 * path.estimate
        assert ROUNDED <= path.estimate <= tolerance


# c, z, v, w, last time, number of times and tolerance, for axes (2c, c), q = (1, 0, z) and p = (0, v, w). The estimate
# was 4 to 25 times too small: rows near the centre were not compared, or both walks had nearly the same error
ECCENTRIC = [
    (0.0636, 0.068, 0.027, -0.012, 3.22, 177, 1e-6),
    (0.0798, 0.222, 0.025, -0.026, 8.37, 896, 1e-9),
    (0.0698, 0.1, 0.066, 0.059, 8.28, 734, 1e-6),
    (0.0897, 0.234, 0.135, 0.009, 4.48, 973, 1e-9),
    (0.0985, 0.293, 0.03, 0.009, 4.76, 499, 1e-9),
    (0.0995, 0.033, 0.012, -0.066, 3.44, 294, 1e-12),
    (0.1122, 0.107, 0.069, -0.086, 3.26, 292, 1e-12),
    (0.1369, 0.107, 0.106, -0.013, 6.19, 457, 1e-9),
]


@pytest.mark.parametrize(("c", "z", "v", "w", "time", "count", "tolerance"), ECCENTRIC)
def test_the_estimate_holds_for_eccentric_orbits(c, z, v, w, time, count, tolerance) -> None:
    galaxy, times = KuzminKutuzov((2 * c, c)), np.linspace(0, time, count)
    state = galaxy.state((1.0, 0.0, z), (0.0, v, w))
    path = galaxy.flow(state, tolerance=tolerance).at(times)
    assert off(both(path), both(galaxy.flow(state).at(times))) <= min(tolerance, 2 * path.estimate)


def test_what_a_tolerance_does_not_hold_for_is_right_to_the_last_bits() -> None:
    """An instability magnifies the rounding of steps in floats from 1e-16 to 1e-3; steps in double-doubles are
    accurate.
    """
    system = SphericalPendulum()
    state = system.state((1e-5, 0.0, 1.0), (0.0, 1e-5, 0.0))
    times = np.array([1.0, 30.0])
    assert np.array_equal(both(system.flow(state, tolerance=1e-13).at(times))[1], both(system.flow(state).at(times))[1])


@pytest.mark.parametrize("bad", [0, 1, -1e-9, 1e-17, math.nan, math.inf, "1e-12", 1j])
def test_no_tolerances(bad) -> None:
    system, state = REAL["neumann"](RR, 2)
    with pytest.raises(ArgumentError, match=r"tolerance = .* 2\^-50 and 1"):
        system.flow(state, tolerance=bad)
    fine, same = REAL["neumann"](MP(30), 2)
    with pytest.raises(ArgumentError, match="of a flow over RR"):
        fine.flow(same, tolerance=1e-12)


def spiral() -> Formulas:
    """x' = −y/3, y' = x/3 with (x, y) = (q, p)."""
    return Formulas(lambda N, y: (-(y[1] / 3), y[0] / 3), lambda N, y: tuple(y), 2, 2, 1)


def test_a_walk_is_compiled_once_a_machine(monkeypatch) -> None:
    kind = Kind("spiral", spiral())
    kind.name += f"_{Random().random()}"
    walk = kind.walk(FINE.orders)
    assert walk is not None
    assert kind.walk(FINE.orders) is walk
    found = walk(np.zeros(1), (1.0, 0.0), np.array([0.0, 3.0, 60.0]), FINE, 1e3)
    assert found.wrong is None
    assert off(found.states.reshape(3, 2), np.array([[math.cos(t / 3), math.sin(t / 3)] for t in (0, 3, 60)])) < 3e-16
    # found on disk from now on
    monkeypatch.setattr(machine, "object_of", None)
    again = Kind("spiral", spiral())
    again.name = kind.name
    assert again.walk(FINE.orders) is not None


def test_times_that_are_not_in_order_are_not_walked_to() -> None:
    walk = Kind("spiral", spiral()).walk(FINE.orders)
    assert walk is not None
    for times in ([1.0, 0.5], [-1.0, 1.0], [1.0, -1.0], [math.nan], [0.0, math.inf]):
        assert walk(np.zeros(1), (1.0, 0.0), np.array(times), FINE, 1e3).reached == -1


def test_a_walk_does_not_depend_on_the_walk_before_it() -> None:
    """Walks share their working memory: one whose coefficients overflow changes no bit of the next."""
    system, state = REAL["toda"](RR, 2)
    walk, times = system._kind.walk(FINE.orders), np.arange(9.0)
    constants, start = system.flow(state)._walk_given
    first = walk(constants, start, times, FINE, 1e3)
    assert walk(constants, [1e200 * x for x in start], times, FINE, 1e3).reached == 0
    assert np.array_equal(walk(constants, start, times, FINE, 1e3).states, first.states)
    assert np.array_equal(walk(constants, start, np.arange(513) / 64, FINE, 1e3).states[::64], first.states)


def test_the_compiled_loop_is_the_readable_one() -> None:
    system, state = REAL["toda"](RR, 2)
    walk = system._kind.walk(FINE.orders)
    times = np.array([0.25, 0.5, 2.0, 2.0, 7.0])
    found = []
    for loop in (by_the_readable_loop, LIBRARY.walked):
        tiers = np.array(FINE.tiers[0])
        asked = Outputs(np.empty(4 * 5 * 4), np.zeros(5), times, np.empty(5 * 4))
        given = Given(np.zeros(1), np.array([*state.q, *state.p]))
        said = loop(Codes(*walk.codes), tiers, walk.layout, given, np.zeros(walk.size), asked, 0, 1e3)
        found.append(asked.found)
        assert said[0] == 5
        assert said[1] == 0
    # up to logarithms, which the compiled walk computes from the bits
    assert np.abs(found[0] - found[1]).max() <= 4.5e-16


def test_rows_that_are_not_compared_are_right_and_wrong_beside_wrong_ones() -> None:
    system, state = REAL["neumann"](RR, 2)
    walk, times = system._kind.walk(WIDE), np.linspace(0, -1, 61)
    given = system.flow(state)._walk_given
    found = walk(*given, times, Steps(WIDE, (ROUGH,)), 1e3)
    assert (found.reached, found.wrong) == (61, None)
    true = np.reshape(states_of(system._kind, *given, times), (61, 2, 3))
    assert off(found.states, true) <= 2.0**-52
    # without a row on which the walks agree, each is wrong, but the walks must be far from any common error
    found = walk(*given, times, Steps(WIDE, (ROUGH._replace(agreed=1e-30),)), 1e3)
    assert found.reached == 0
    # rows 2, 5 and 6 are compared, and 5 is wrong: so are its neighbours from row 3 on
    asked = Outputs(np.ones(56), np.array([0.0, 0, 1, 0, 0, 1, 1]), np.arange(1.0, 8.0), np.zeros(14))
    asked.both[20] = 1 + 1e-9
    seen = compared(walk.layout._replace(half=1), 1e-12, Compared(0, 0, 0, 0, 0.0), 7, asked)
    assert (seen.rows, seen.wrong, seen.lost, seen.first) == (7, 1, 1, 3)
    assert asked.marks.tolist() == [0, 0, 1, WRONG, WRONG, WRONG, 1]


def in_double_doubles(system, state, times: np.ndarray, steps: Steps) -> tuple[np.ndarray, np.ndarray]:
    """The states of both walks, shape (2, N, parts, n, 2), and the marks of rows; wrong where a row is not reached."""
    walk, count = system._kind.walk(steps.orders), len(times)
    asked = Outputs(np.empty(4 * count * walk._count), np.zeros(count), times, np.empty(count * walk._count))
    constants, start = system.flow(state)._walk_given
    given, room = Given(np.array(constants), np.array(start)), np.zeros(walk.size)
    said = LIBRARY.walked(Codes(*walk.codes), np.array(steps.tiers).ravel(), walk.layout, given, room, asked, 0, 1e4)
    asked.marks[max(said[0], 0) :] = WRONG
    return asked.both.reshape(2, count, *walk._shape, 2), asked.marks


@pytest.mark.parametrize(("bounds", "longest"), [(BRIEF, 8.0), (ROUGH, 60.0)])
@pytest.mark.parametrize("name", ["neumann", "toda", "garnier", "lagrange", "henon"])
def test_rows_on_which_both_walks_agree_are_right_to_a_tenth_of_the_rounding_unit(name, bounds, longest) -> None:
    """Slow and fast motions, some of them eccentric; the walks agree on nearly all rows."""
    rng, agreed, rows = np.random.default_rng(3), 0, 0
    for _ in range(8):
        system, state = _at_random(name, rng)
        times = np.linspace(0, longest * rng.uniform(0.2, 1), 21)
        (found, _), marks = in_double_doubles(system, state, times, Steps(WIDE, (bounds,)))
        (true, _), right = in_double_doubles(system, state, times, FINEST)
        which = (marks == 1) & (right == 1)
        size = np.abs(true[which, ..., 0]).max(axis=-1)
        off = np.abs((found[which] - true[which]).sum(axis=-1)).max(axis=-1)
        assert (off <= 0.1 * 2.0**-53 * size).all()
        agreed, rows = agreed + which.sum(), rows + (marks != 0).sum()
    assert agreed > 0.5 * rows


def _at_random(name: str, rng: np.random.Generator) -> tuple[MumfordSystem, Point]:
    """A system and a state, with a speed of 0.1 to 5 or so."""
    unit = rng.normal(size=3)
    q, speed = unit / np.linalg.norm(unit), 10 ** rng.uniform(-1, 0.7)
    p, few = speed * rng.normal(size=3), speed * rng.normal(size=4)
    if name == "neumann":
        system, given = Neumann(tuple(rng.uniform(0, 8, 3).tolist())), (q, p - q * (q @ p))
    elif name == "toda":
        system, given = TodaLattice(3), (unit * speed, p)
    elif name == "garnier":
        system, given = Garnier(tuple(rng.uniform(0, 5, 2).tolist())), (few[:2], few[2:])
    elif name == "lagrange":
        system, given = LagrangeTop(float(rng.uniform(0.2, 2))), (q, p)
    else:
        system, given = HenonHeiles.with_frequencies(1, 1.25), (0.04 * unit[:2], 0.04 * p[:2] / speed)
    return system, system.state(*(tuple(x.tolist()) for x in given))


@pytest.mark.parametrize("name", ["neumann", "ellipsoid", "lagrange", "pendulum", "veselova"])
def test_sizes_of_constraints_are_those_of_their_slopes(name) -> None:
    system, state = REAL[name](RR, 3)
    found, slopes = system._constraint_sizes(state), MumfordSystem._constraint_sizes(system, state)
    assert [float(x) for x in found] == pytest.approx(slopes, rel=1e-14)


EDGES = {
    "great circle": (Neumann((1e-30, 2e-30, 4e-30)), (0.6, 0.0, 0.8), (0.0, 1.0, 0.0), 5.0),
    "slow": (Neumann((1.0, 2.0, 4.0)), (1.0, 0.0, 0.0), (0.0, 1e-200, 0.0), 5.0),
    "at rest in equilibrium": (Neumann((1.0, 2.0, 4.0)), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 1e6),
    "at rest on the long axis": (Garnier((-1.0, -4.0)), (0.0, 0.0), (0.0, 0.0), 1e6),
    "plane": (Ellipsoid((1.0, 2.0, 4.0)), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), 11.0),
    "round": (Ellipsoid((1e10, 2e10, 4e10)), (1e5, 0.0, 0.0), (0.0, 0.6, 0.8), 1e5),
    "far apart": (TodaLattice(2), (0.0, -30.0), (0.0, 1.0), 2.0),
    "heavy": (HenonHeiles((1.0,), -0.5, -0.25), (1e-9, 1e-9), (0.0, 1e-9), 30.0),
    "barrier": (HenonHeiles((1.0,), -0.5, -0.25, 0, (1e-3,)), (0.01, 0.02), (0.0, 0.01), 30.0),
}


@pytest.mark.parametrize("name", EDGES)
def test_the_edges_of_a_walk(name) -> None:
    """Compared with additions in 40 digits, forwards and backwards in time; times beyond a walk are computed by other
    methods.
    """
    system, q, p, time = EDGES[name]
    state, K, times = system.state(q, p), MP(40), [time, -time / 3, 0.0]
    path = system.flow(state).at(times)
    fine = system.over(K)
    true = both(fine.flow(constrained(fine, inside(fine, state))).at(times)).astype(float)
    size = np.abs(true).max(axis=-1)
    assert (np.abs(both(path) - true).max(axis=-1) <= 2.3e-16 * size).all()


def test_floats_of_a_state_are_taken_as_they_are_and_all_others_are_looked_at() -> None:
    system = Neumann((1.0, 2.0, 4.0))
    assert system.state((0.6, 0.8, 0.0), (0.4, -0.3, 1.0)) == Point((0.6, 0.8, 0.0), (0.4, -0.3, 1.0))
    assert type(system.state(("0.6", "4/5", 0), (0, 0, 1)).q[1]) is float
    for q, p in (((math.nan, 1.0, 0.0), (0.0, 0.0, 0.0)), ((1.0, 0.0), (0.0, 0.0)), ((1.0, 1.0, 0.0), (0.0, 0.0, 0.0))):
        with pytest.raises(ArgumentError):
            system.state(q, p)
    # two tuples are no state
    with pytest.raises(ArgumentError):
        system.flow(((0.6, 0.8, 0.0), (0.4, -0.3, 1.0)))


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e4, 1e9])
def test_long_units_of_time_are_walked_as_far(size) -> None:
    """A geodesic of the earth in kilometres: the walk used to stop at 65,536 units of time, after wrong rows."""
    system = Ellipsoid((size * size, 2 * size * size, 4 * size * size))
    state = system.state((size, 0.0, 0.0), (0.0, 0.6, 0.8))
    one = Ellipsoid((1.0, 2.0, 4.0))
    times = np.linspace(0, 100, 11)
    near = system._kind.walked(system.flow(state)._walk_given, size * times, 3e4)
    assert near.places is None
    true = both(one.flow(one.state((1.0, 0.0, 0.0), (0.0, 0.6, 0.8))).at(times))
    assert off(near.states, true * np.array([[size], [1.0]])) < 1e-14


def test_parts_of_sums_that_cancel_are_made_apart() -> None:
    """Higher orders in floats were computed from high parts that were wrong by a hundred roundings: 7e-16 after 400
    radians.
    """
    system = SphericalPendulum()
    state = system.state((0.48, 0.6, -0.64), (0.75, -0.6, 0.0))
    walk = system._kind.walk(FINEST.orders)
    found = walk(*system.flow(state)._walk_given, np.array([100.0, 400.0]), FINEST, 1e5)
    assert found.reached == 2
    assert found.wrong is None


def test_a_walk_ends_where_its_rows_say_that_the_last_is_lost() -> None:
    """Steps in floats lose 5e-11 of Neumann's point up to t = 100: with a tolerance of 1e-12 the whole walk used to be
    made in vain. Such steps are not even tried for so many.
    """
    system, state = REAL["neumann"](RR, 2)
    orders, (bounds,) = steps_for(1e-13)[0]
    walk, times = system._kind.walk(orders), np.linspace(0, 300, 301)
    given = *system.flow(state)._walk_given, times
    bounds = bounds._replace(farthest=1e9)
    found, whole = (walk(*given, Steps(orders, (x,)), 1e6) for x in (bounds, bounds._replace(agreed=1.0)))
    assert whole.reached == 301
    assert whole.gap > 4 * bounds.agreed
    assert found.reached < 301
    assert found.steps < whole.steps / 4
    right = slice(0, found.reached) if found.wrong is None else np.flatnonzero(~found.wrong)
    exact = both(system.flow(state).at(times))
    assert off(found.states[right], exact[right]) < 1e-13


def test_a_walk_is_given_up_by_what_remains_of_it() -> None:
    """The tilde pair was walked to the end of T = 65, and given up there because it had taken too many steps."""
    assert goes_on(0.1, 9.0, 10.0, 180, 40)
    assert not goes_on(0.1, 1.0, 10.0, 100, 40)


def test_no_torus_is_made_for_times_that_several_walks_reach() -> None:
    """Steps in floats reached a quarter of these times, others the rest; a torus of genus 3, of 62 ms, was made too."""
    system, state = Neumann((1, 2, 4, 7)), Point((0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1))
    flow = system.flow(state, tolerance=1e-12)
    near = flow._near(np.linspace(0, 100, 101))
    assert not near.lacks(101)
    assert "_torus" not in vars(flow)


def test_the_rounding_error_of_a_zero_is_no_time_scale() -> None:
    """The axis and the momentum stay in a plane but for a rate of 2e-22: the unit of time was 1e-26 in place of 1e-10,
    and no step was taken.
    """
    system = Veselova((5.817028519568047e-06, 3.0164792866732826e-06, 1.5707723532407446e-06))
    state = system.state(
        (-0.999999444807108, -0.001053748298065717, 0.0), (13.229814643537456, -12554.99754801343, 0.0)
    )
    given, times = system.flow(state)._walk_given, np.array([1e-11, 2e-10])
    found = system._kind.walk(FINE.orders)(*given, times, FINE, 1e3)
    assert (found.reached, found.wrong) == (2, None)
    true = states_of(system._kind, *given, times)
    assert off(found.states, np.reshape(true, found.states.shape)) <= 2.0**-52


def test_barriers_of_nothing_are_none() -> None:
    """They used to be terms 0/q_1², so that a walk from q_1 = 0 could not begin."""
    system = HenonHeiles((1.0,), -0.5, -0.25)
    state = system.state((0.05, 0.0), (0.01, 0.02))
    walk, times = system._kind.walk(FINE.orders), np.linspace(0, 10, 11)
    found = walk(*system.flow(state)._walk_given, times, FINE, 1e4)
    assert (found.reached, found.wrong) == (11, None)
    K = MP(30)
    fine = system.over(K)
    true = both(fine.flow(constrained(fine, inside(fine, state))).at(times)).astype(float)
    assert off(found.states, true) <= 2.3e-16


def test_sums_that_cancel_in_the_finest_steps_are_renormalized() -> None:
    """A moment of 5e-10 makes terms of 2e9 cancel: coefficients of order 9 were wrong by 18 digits, and no method was
    left.
    """
    system = Veselova((1.2621757818305703, 4.961471554761398e-10, 18.29136693104874))
    q = (0.35583940977738115, 0.23069684990156253, 0.9056253518397004)
    state = system.state(q, (-1.5388736411804946, 17.74826280998231, -3.9164941949594954))
    walk = system._kind.walk(FINEST.orders)
    given = system.flow(state)._walk_given
    found = walk(*given, np.array([0.001, 0.024]), FINEST, 1e3)
    assert (found.reached, found.wrong) == (2, None)
    true = states_of(system._kind, *given, [0.001, 0.024])
    assert off(found.states, np.reshape(true, found.states.shape)) <= 2.0**-52


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "n"), [("neumann", 2), ("toda", 3), ("garnier", 3), ("lagrange", 3)])
@pytest.mark.parametrize("orders", [WIDE, Orders(5, 30)])
def test_orders_in_a_loop_are_those_of_straight_line_code(name, n, orders, monkeypatch) -> None:
    system, state = REAL[name](RR, n)
    given, times, found = system.flow(state)._walk_given, np.array([0.5, 3.0]), []
    monkeypatch.setattr(kept, "place", lambda: None)
    for longest in (0, 10**6):
        monkeypatch.setattr(sums_text, "LONGEST", longest)
        walk = system._made_kind().walk(orders)
        steps = Steps(orders, (FINE.tiers[0]._replace(left_out=1e-24, rounded=1e-8),))
        reached = walk(*given, times, steps, 1e3)
        assert reached.gap < 2.0**-56
        found.append((reached.states, walk.codes.ratios - walk.codes.series))
    (looped, short), (straight, long) = found
    assert short < long
    assert off(looped, straight) <= 2.0**-52


def test_a_pulse_reaches_particles_at_rest_one_after_the_other() -> None:
    """The displacement of a particle k places from a displaced one begins with t^2k: a series whose first coefficients
    vanish left the walk without a step, and additions lost 4,000 bits.
    """
    system = TodaLattice(16)
    state = system.state((0.5, *(0.0,) * 14, -0.5), (0.0,) * 16)
    flow = system.flow(state)
    path = flow.at([0.5, 2.0])
    assert path.way == "series"
    # a torus of genus 15 would take 14 s, the walk takes milliseconds
    assert flow.at(np.linspace(0, 100, 11)).way == "series"
    run = solve_ivp(
        lambda t, y: np.concatenate(tuple(map(np.array, system.vector_field(Point(tuple(y[:16]), tuple(y[16:])))))),
        (0, 2.0), [*state.q, *state.p], "DOP853", [0.5, 2.0], rtol=1e-13, atol=1e-15,
    )  # fmt: skip
    assert abs(np.hstack([path.q, path.p]) - run.y.T).max() < 1e-12
