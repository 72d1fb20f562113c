"""Problems: their equations, integrals and derivatives agree with each other, their solution with another
integrator.
"""

import numpy as np
import pytest

from integrable.problems import Problem, problem, problem_names
from integrable.scene.file import load_scene, scene_names
from jacobian import MP, ArgumentError
from tests.fuzz.classical import EQUATIONS
from tests.integrable.problems.by_series import by_series

EPS = 2.0**-52
TWELVE = problem_names()
over_problems = pytest.mark.parametrize("name", TWELVE)


def starts(name, count=3):
    """A problem, and the same with random starts."""
    given, rng = problem(name), np.random.default_rng(TWELVE.index(name))
    return [given, *(given.another(rng) for _ in range(count))]


def distance_from_series(one: Problem, time: float, digits: int) -> float:
    """The distance of the solution from another integrator's, in units of its radii, at least of its last digits."""
    found = one.truth(time, digits)
    expected = by_series(one.rates, one.y0, time)
    scale = np.abs(found.y.astype(float)).max()
    number = MP(50).coerce
    off = [float(abs(number(x) - number(y))) for x, y in zip(found.y, expected, strict=True)]
    return max(x / max(r, scale * 10.0**-digits) for x, r in zip(off, found.radius, strict=True))


def test_there_are_twelve_problems() -> None:
    assert TWELVE == [
        "chaplygin", "ellipsoid", "henon_heiles_bounded", "kdv_two_gaps", "lagrange_vertical", "million_turns",
        "near_separatrix_top", "neumann", "spherical_pendulum", "t_handle", "tilted_ball", "toda_5",
    ]  # fmt: skip
    assert set(TWELVE) <= set(scene_names())


@over_problems
def test_a_problem_says_what_it_is(name) -> None:
    one = problem(name)
    assert one.name == name
    assert one.title
    assert one.description
    assert one.reference == load_scene(name).reference
    assert one.y0.dtype == np.float64
    assert not one.y0.flags.writeable
    assert one.time_scale > 0
    assert repr(one) == f"problem('{name}')"


@over_problems
def test_many_states_are_those_one_by_one(name) -> None:
    y = np.array([[one.y0 for one in starts(name)], [one.y0 for one in starts(name)][::-1]])
    given = problem(name)
    for function in (lambda y: given.rhs(0, y), lambda y: given.jacobian(0, y), given.invariants):
        table = function(y)
        assert table.shape[:2] == y.shape[:2]
        for place in np.ndindex(y.shape[:2]):
            one = function(y[place])
            assert np.abs(table[place] - one).max() <= 8 * EPS * np.abs(one).max()


@over_problems
def test_the_jacobian_beside_differences_of_fifty_digits(name) -> None:
    K = MP(50)
    for one in starts(name):
        y, size = list(map(K.coerce, one.y0.tolist())), len(one.y0)
        h = K.coerce(10) ** -25
        found = one.jacobian(0, one.y0)
        for j in range(size):
            ends = [one.rates(K, [x + s * h * (i == j) for i, x in enumerate(y)]) for s in (1, -1)]
            slopes = np.array([float((a - b) / (2 * h)) for a, b in zip(*ends, strict=True)])
            assert np.abs(found[:, j] - slopes).max() <= 16 * EPS * max(1, np.abs(found).max())


@pytest.mark.thinned(3)
@over_problems
def test_the_rates_move_no_integral(name) -> None:
    """For each integral, its slope along the right-hand side, by differences, and its drift along the true motion."""
    for one in starts(name):
        first = one.invariants(one.y0)
        assert first.shape == (len(one.invariant_names),)
        f, h = one.rhs(0, one.y0), 1e-4 * one.time_scale
        ends = [one.invariants(one.y0 + s * h * f) for s in (1, -1)]
        beside = np.abs(one.invariants(one.y0 * (1 + 1e-3)) - first) / 1e-3
        scale = np.maximum(beside, np.abs(first))
        assert (np.abs(ends[0] - ends[1]) / (2 * h) * one.time_scale <= 1e-6 * scale + 1e-9).all()
        later = one.invariants(one.truth([0.5 * one.time_scale, 3 * one.time_scale]).y)
        assert (np.abs(later - first) <= 200 * EPS * scale + 20 * EPS).all()


@pytest.mark.parametrize(
    ("name", "written", "constants"),
    [
        ("neumann", "Neumann", (1, 2, 4)),
        ("ellipsoid", "Ellipsoid", (2.25, 5.0625, 9)),
        ("henon_heiles_bounded", "HenonHeiles", (2.625, -0.5, -0.25, 0)),
        ("lagrange_vertical", "LagrangeTop", (0.75,)),
        ("spherical_pendulum", "SphericalPendulum", ()),
        ("toda_5", "TodaLattice", ()),
    ],
)
def test_right_hand_sides_are_the_equations_written_once_more(name, written, constants) -> None:
    for one in starts(name):
        q, p = np.split(one.y0, 2)
        expected = np.concatenate(EQUATIONS[written](constants, q, p, np.exp))
        assert np.abs(one.rhs(0, one.y0) - expected).max() <= 16 * EPS * np.abs(expected).max()


@pytest.mark.thinned(7)
@over_problems
def test_truth_beside_series_that_share_no_code(name) -> None:
    one = starts(name, 1)[-1]
    assert distance_from_series(one, -1.5 * one.time_scale, 30) <= 1
    assert distance_from_series(one, 2.5 * one.time_scale, 16) <= 1


@pytest.mark.slow
@over_problems
def test_truth_of_random_starts_beside_series(name) -> None:
    """Ten starts of each of the twelve problems, to 30 digits."""
    rng = np.random.default_rng(100 + TWELVE.index(name))
    given = problem(name)
    for _ in range(10):
        one = given.another(rng)
        assert distance_from_series(one, rng.uniform(-4, 4) * one.time_scale, 30) <= 1, one.y0


@pytest.mark.thinned(3)
@over_problems
def test_truth_in_any_order_shape_and_number_of_digits(name) -> None:
    one = problem(name)
    times = np.array([[2.0, -1.0], [0.0, 0.5]]) * one.time_scale
    found = one.truth(times)
    assert found.y.shape == found.radius.shape == (2, 2, len(one.y0))
    assert not found.proven
    assert (np.abs(found.y[1, 0] - one.y0) <= found.radius[1, 0]).all()
    single = one.truth(times[0, 1], digits=25)
    assert (np.abs(found.y[0, 1] - single.y.astype(float)) <= 1.01 * found.radius[0, 1]).all()
    assert (single.radius < 1e-24 * np.abs(single.y.astype(float)).max()).all()
    assert one.error(found.y, found).max() < 2 * EPS
    assert one.error(np.full(found.y.shape, np.nan), found).min() == np.inf


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["t_handle", "henon_heiles_bounded", "lagrange_vertical", "ellipsoid"])
def test_proven_truth_contains_the_estimated_one(name) -> None:
    one = problem(name)
    proven, estimated = (one.truth([one.time_scale], 22, proven=p) for p in (True, False))
    assert proven.proven
    gap = np.abs((proven.y - estimated.y).astype(float))
    assert (gap <= proven.radius + estimated.radius).all()
    assert (proven.radius <= 1e-21 * np.abs(proven.y.astype(float)).max()).all()


def test_proof_of_a_start_of_another_length_is_refused() -> None:
    with pytest.raises(ArgumentError, match=r"proven = True: the start of neumann has a length 1"):
        problem("neumann").truth(1.0, proven=True)


def test_the_condition_grows_in_proportion_to_time() -> None:
    found = problem("chaplygin").condition([[1.0], [100.0], [1000.0]])
    assert found.shape == (3, 1)
    assert 5 < found[2, 0] / found[1, 0] < 20


def test_doubles_that_are_off_a_constraint_are_refused_and_not_moved() -> None:
    one = problem("neumann")
    with pytest.raises(ArgumentError, match=r"scene neumann.toml: \[start\] q and p in doubles are .* orthogonal"):
        one.starting([0.48, 0.6, 0.64, 0.384, 1.28, -1.488])
    # bodies take them as they are
    ball = problem("chaplygin")
    assert ball.motion.along != 0
    assert distance_from_series(ball, 1.0, 30) <= 1


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: problem("t_handel"), "no such scene"),
        (lambda: problem("beyond"), "an orbit of a map"),
        (lambda: problem("tilde"), "known for"),
        (lambda: problem("neumann").truth(np.nan), "t = nan"),
        (lambda: problem("neumann").truth(1, 0), "digits"),
        (lambda: problem("neumann").starting([1, 2]), "y0"),
        (lambda: problem("neumann").starting([np.inf] * 6), "y0"),
    ],
)
def test_bad_calls_name_the_argument(call, words) -> None:
    with pytest.raises(ArgumentError, match=words):
        call()


def test_any_other_scene_of_a_motion_is_a_problem() -> None:
    one = problem("euler_top")
    assert one.reference == ""
    assert distance_from_series(one, 1.0, 25) <= 1
