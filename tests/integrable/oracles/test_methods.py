"""The comparators: one interface, what each conserves, and its order as the slope of the error over its setting."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.deformations.gyroscopic import Gyroscopic
from integrable.deformations.isometric import Check, Hat
from integrable.deformations.tilde import Tilde
from integrable.mumford.system import Point
from integrable.oracles.discrete_tops import (
    hirota_kimura_factors,
    hirota_kimura_integrals,
    hirota_kimura_step,
    kahan_rotation,
    modified_moments,
    moser_veselov,
)
from integrable.oracles.method import problem_of, timed_run
from integrable.oracles.methods import METHODS, time_scale
from integrable.oracles.reference import body_equations, equations, is_body, taylor
from integrable.oracles.stepping import divided, follow
from integrable.phase.jets import JetField
from integrable.scene.file import load_scene, scene_names
from jacobian import MP, QQ, PrecisionLoss
from jacobian.errors import ArgumentError

SCENES = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text(encoding="utf-8"))["scenes"]
BALL, TOP = ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3))
GAMMA = (0.48, 0.6, 0.64)
UPRIGHT, TILTED = (0.384, 1.28, -1.488), (1.104, 2.18, -0.528)
PROBLEMS = {
    "ball": (BALL, BALL.state(GAMMA, UPRIGHT)),
    "ball, tilted": (BALL, BALL.state(GAMMA, TILTED, tilted=True)),
    "top": (TOP, TOP.state(GAMMA, UPRIGHT)),
    "top, tilted": (TOP, TOP.state(GAMMA, TILTED, tilted=True)),
}
DEFORMED = [Tilde((1, 2, 3), 0.7), Check((1, 2, 3)), Hat((1, 2, 4)), Gyroscopic((1, 2, 3), 0.4)]
# floats cannot show order 16: tests/integrable/oracles/test_gauss16.py does
STEPPING = [name for name, method in METHODS.items() if method.parameter == "step" and method.order != 16]


def named(names):
    """Parameters for these methods, without methods that need a package that is not installed."""
    missing = pytest.mark.skipif
    return [pytest.param(n, marks=missing(not METHODS[n].installed, reason=METHODS[n].module)) for n in names]


def fitting(names, problems, top=None):
    """(method, problem) pairs for which the method applies: the problem is a top if possible."""
    tops = {problem: "top" in problem if top is None else top for problem in problems}
    pairs = [(n, p) for n in names for p in problems if METHODS[n].kinds != ("top",) or tops[p]]
    return [pytest.param(*named([n])[0].values, p, marks=named([n])[0].marks) for n, p in pairs]


def row(solution, k=-1):
    return np.concatenate([solution.gamma[k], solution.M[k]]).astype(float)


def order(errors: list[tuple[float, float]]) -> float:
    """The slope of log error against log step, fitted to the steps before the errors level off at round-off.

    The plateau is the smallest error, where the errors stop falling; points within a factor 100 of it are left out.
    """
    smallest = min(e for _, e in errors)
    levels = any(after > before / 1.3 for (_, before), (_, after) in pairwise(errors))
    kept = [(s, e) for s, e in errors[1:] if not levels or e > 100 * smallest]
    assert len(kept) >= 3, f"no slope above round-off: {errors}"
    log_step, log_error = np.log([s for s, _ in kept]), np.log([e for _, e in kept])
    return float(np.polyfit(log_step, log_error, 1)[0])


def test_the_plateau_filter() -> None:
    steps = [2.0**-k for k in range(12)]
    assert order([(h, 0.1 * h**4 + 1e-9) for h in steps]) == pytest.approx(4, abs=0.1)
    with pytest.raises(AssertionError, match="no slope"):
        order([(h, 1e-15) for h in steps])


# --- order and agreement


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("name", "problem"), fitting(STEPPING, PROBLEMS))
def test_order_of_convergence(name, problem) -> None:
    system, state = PROBLEMS[problem]
    method = METHODS[name]
    truth = row(taylor(system, state, [2], digits=18))
    errors = []
    for count in (8, 12, 16, 24, 32, 48, 64, 96, 128):
        found = method.solve(system, state, [2.0], 2 / count)
        errors.append((2 / count, np.abs(row(found) - truth).max()))
    assert order(errors) == pytest.approx(method.order, abs=0.35)


TOLERANT = [name for name, method in METHODS.items() if method.parameter == "tolerance" and "double" not in name]


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", named(TOLERANT))
def test_the_error_follows_the_tolerance(name) -> None:
    system, state = PROBLEMS["ball"]
    truth = row(taylor(system, state, [20], digits=18))
    tolerances = [10.0**-k for k in (5, 6, 7, 8, 9)]
    errors = [np.abs(row(METHODS[name].solve(system, state, [20.0], tol)) - truth).max() for tol in tolerances]
    slope = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.5 < slope < 1.4, errors
    assert errors[-1] < 1e-5


FINEST = {
    "SciPy DOP853": (3e-14, 1e-12),
    "SciPy DOP853, compiled": (3e-14, 1e-12),
    "SciPy LSODA": (1e-12, 1e-9),
    "SciPy Radau": (1e-10, 1e-9),
    "implicit midpoint": (0.02, 1e-3),
    "Gauss-Legendre 6": (0.05, 1e-11),
    "Moser-Veselov": (0.02, 1e-2),
    "Moser-Veselov, order 4": (0.02, 1e-6),
    "Hirota-Kimura": (0.02, 1e-2),
    "Gauss-Legendre 16": (0.7, 2e-13),
    "Gauss-Legendre 16, adaptive": (1e-16, 2e-13),
    "Taylor, compiled": (1e-16, 2e-13),
    "heyoka": (1e-16, 2e-13),
    "heyoka, long double": (1e-19, 2e-13),
    "closed elliptic form": (15, 2e-13),
    "Taylor, multiprecision": (15, 2e-13),
    "mpmath odefun": (12, 1e-9),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("name", "scene"), [p for s in ("S1", "S2", "S6") for p in fitting(METHODS, [s], top=s == "S2")]
)
def test_agreement_with_the_shipped_trajectories(name, scene) -> None:
    content = SCENES[scene]
    inertia, d = [float(x) for x in content["I"]], float(content["d"])
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    gamma, M = ([float(x) for x in content[key]] for key in ("gamma0", "M0"))
    state = system.state(gamma, M, tilted=True)
    method = METHODS[name]
    setting, bound = FINEST[name]
    times = ("1",) if name == "mpmath odefun" else ("10", "1")
    found = method.solve(system, state, [float(t) for t in times], setting)
    for k, t in enumerate(times):
        wanted = np.array([*content["states"][t]["gamma"], *content["states"][t]["M"]], dtype=float)
        assert np.abs(row(found, k) - wanted).max() < bound, t


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", named(METHODS))
def test_times_in_any_order_and_of_either_sign(name) -> None:
    system, state = PROBLEMS["top" if METHODS[name].kinds == ("top",) else "ball, tilted"]
    times = [0.5, -0.3, 0.0, 0.5, 0.2]
    setting, bound = FINEST[name]
    found = METHODS[name].solve(system, state, times, setting)
    truth = taylor(system, state, times, digits=16)
    assert found.gamma.shape == found.M.shape == (5, 3)
    for k in range(5):
        assert np.abs(row(found, k) - row(truth, k)).max() < bound
    assert row(found, 2) == pytest.approx([*state.gamma, *state.M], abs=1e-15 if setting != 12 else 1e-12)
    assert row(found, 0).tolist() == row(found, 3).tolist()
    assert found.evaluations > 0


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", named(n for n, m in METHODS.items() if not m.kinds))
@pytest.mark.parametrize(
    "system",
    [pytest.param(s, marks=() if isinstance(s, Tilde) else pytest.mark.slow) for s in DEFORMED],
    ids=[type(system).__name__ for system in DEFORMED],
)
def test_systems_with_equations_of_their_own(name, system) -> None:
    state = system.state(GAMMA, UPRIGHT)
    assert not is_body(system)
    setting, bound = FINEST[name]
    found = METHODS[name].solve(system, state, [0.5], setting)
    assert np.abs(row(found) - exact_row(type(system))).max() < bound
    before, after = (
        system.integrals(state),
        system.integrals(replace(state, gamma=tuple(row(found)[:3]), M=tuple(row(found)[3:]))),
    )
    assert max(abs(x - y) for x, y in zip(before, after, strict=True)) < 20 * bound


@cache
def exact_row(kind):
    """γ and M of a deformed body at t = 1/2, from 25 digits: the same for every method."""
    precise = next(system for system in DEFORMED if type(system) is kind).over(MP(25))
    start = precise.state(*exact_start(MP(25)))
    return row(METHODS["Gauss-Legendre 6"].solve(precise, start, [Fraction(1, 2)], 1 / 128))


def exact_start(K):
    return [[K.coerce(Fraction(str(x))) for x in v] for v in (GAMMA, UPRIGHT)]


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_equations_are_the_vector_field(problem) -> None:
    system, state = PROBLEMS[problem]
    rate = system.vector_field(state)
    found = equations(system, state)([*state.gamma, *state.M])
    assert np.allclose(found, [*rate.gamma, *rate.M], rtol=0, atol=1e-15)


# --- what is kept


def integrals(system, run):
    """C1, C2, H1, H2 along a run."""
    a = np.array(list(system.a))
    x, m = run.gamma, run.M
    dot = lambda p, q: np.sum(p * q, axis=1)  # noqa: E731
    g2 = 1 / (1 - system.d * dot(a * x, x))
    h1 = dot(a * m, m) + system.d * g2 * dot(a * x, m) ** 2
    return {"C1": dot(x, x), "C2": dot(x, m), "H1": h1, "H2": dot(m, m)}


KEPT = {
    "implicit midpoint": ({"C1", "C2", "H2"}, 0.2),
    "Gauss-Legendre 6": ({"C1", "C2", "H2"}, 0.2),
    "Gauss-Legendre 16": ({"C1", "C2", "H2"}, 2.5),
    "Moser-Veselov": ({"C1", "C2", "H1", "H2"}, 0.2),
    "Moser-Veselov, order 4": ({"C1", "C2", "H1", "H2"}, 0.2),
    "Hirota-Kimura": (set(), 0.2),
}


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("name", "problem"), fitting(KEPT, PROBLEMS))
def test_what_is_kept_and_what_is_not(name, problem) -> None:
    system, state = PROBLEMS[problem]
    method = METHODS[name]
    kept, step = KEPT[name]
    if kept and not system.d:
        kept = {*kept, "H1"}
    if method.order == 16 and "tilted" in problem:
        step = 1.8
    run = method.solve(system, state, [step * k for k in range(300)], step)
    for key, values in integrals(system, run).items():
        drift = np.abs(values - values[0]).max()
        if key in kept:
            assert drift < 1e-12, key
        else:
            assert drift > 3e-11, key


@pytest.mark.parametrize("name", ["implicit midpoint", "Moser-Veselov"])
def test_in_multiprecision_the_integrals_are_kept_to_its_digits(name) -> None:
    K = MP(40)
    system = EulerTop((1, 2, 3), field=K)
    state = system.state(*exact_start(K))
    run = METHODS[name].solve(system, state, [Fraction(k, 10) for k in range(21)], Fraction(1, 10))
    for key, values in integrals(system, run).items():
        assert max(abs(v - values[0]) for v in values) < 1e-36, key


def test_the_modified_moments_are_the_moments_at_step_zero() -> None:
    assert modified_moments((1.0, 2.0, 3.0), UPRIGHT, 0.0) == pytest.approx([1, 2, 3])


# --- Hirota–Kimura, exactly

MOMENTS, STEP = (Fraction(2), Fraction(3), Fraction(7)), Fraction(1, 5)


def rational_vector(seed):
    rng = np.random.default_rng(seed)
    return [Fraction(int(x), 11) for x in rng.integers(-20, 20, 3)]


@pytest.mark.parametrize("seed", range(5))
def test_hirota_kimura_solves_its_equations_and_keeps_its_integrals_exactly(seed) -> None:
    M = rational_vector(seed)
    a = [1 / x for x in MOMENTS]
    new = hirota_kimura_step(MOMENTS, M, STEP)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        assert new[i] - STEP / 2 * (a[k] - a[j]) * (M[k] * new[j] + M[j] * new[k]) == M[i]
    assert hirota_kimura_integrals(MOMENTS, new, STEP) == hirota_kimura_integrals(MOMENTS, M, STEP)
    # birational: the inverse is the map of −step
    assert hirota_kimura_step(MOMENTS, new, -STEP) == M


@pytest.mark.parametrize("seed", range(5))
def test_kahans_rule_on_gamma_exactly(seed) -> None:
    M, x = rational_vector(seed), rational_vector(seed + 100)
    new = hirota_kimura_step(MOMENTS, M, STEP)
    y = kahan_rotation(MOMENTS, x, M, new, STEP)
    w, after = ([m / moment for m, moment in zip(v, MOMENTS, strict=True)] for v in (M, new))
    for i in range(3):
        turn = x[i - 2] * after[i - 1] - x[i - 1] * after[i - 2] + y[i - 2] * w[i - 1] - y[i - 1] * w[i - 2]
        assert y[i] - x[i] == STEP / 2 * turn
    assert kahan_rotation(MOMENTS, y, new, M, -STEP) == x


@pytest.mark.parametrize("seed", range(3))
def test_hirota_kimura_has_an_invariant_measure_exactly(seed) -> None:
    M = rational_vector(seed)
    K = JetField(QQ, 3)
    image = hirota_kimura_step([K.constant(x) for x in MOMENTS], K.variables(M), K.constant(STEP))
    rows = [x.slopes for x in image]
    determinant = sum(
        rows[0][i] * (rows[1][i - 2] * rows[2][i - 1] - rows[1][i - 1] * rows[2][i - 2]) for i in range(3)
    )
    after = hirota_kimura_factors(MOMENTS, [x.value for x in image], STEP)
    before = hirota_kimura_factors(MOMENTS, M, STEP)
    assert determinant == (after[2] / before[2]) ** 2


def test_hirota_kimura_does_not_keep_the_length_of_M() -> None:
    run = METHODS["Hirota-Kimura"].solve(*PROBLEMS["top"], [0.1 * k for k in range(2001)], 0.1)
    size = np.sum(run.M**2, axis=1)
    assert np.abs(size - size[0]).max() == pytest.approx(1.4e-3, rel=0.1)
    found = np.array([hirota_kimura_integrals((1, 2, 3), r, 0.1) for r in run.M])
    # times that are no multiples of the float 0.1 are reached by a shorter step, whose integrals are others
    assert np.median(np.abs(found - found[0]).max(axis=1)) < 1e-12


# --- the interface


def test_every_method_is_described() -> None:
    for name, method in METHODS.items():
        assert method.name == name
        assert method.parameter in ("step", "tolerance", "digits")
        assert set(method.kinds) <= {"ball", "top"}
        assert (method.order is not None) == (method.parameter == "step")
        assert (method.module == "") == (method.extra == "")
        assert method.source
        assert name in FINEST


def test_a_ladder_of_steps_is_in_the_time_of_the_motion() -> None:
    system, state = PROBLEMS["ball"]
    method = METHODS["Gauss-Legendre 6"]
    fast = BALL.state(GAMMA, tuple(1e4 * m for m in UPRIGHT))
    assert method.ladder(BALL, fast) == pytest.approx([1e-4 * h for h in method.ladder(system, state)])
    assert time_scale(BALL, BALL.state((1.0, 0, 0), (0, 0, 0))) == 1
    assert METHODS["SciPy DOP853"].ladder(system, state) == list(METHODS["SciPy DOP853"].settings)


def test_a_time_does_not_depend_on_the_other_times() -> None:
    for name in ("Gauss-Legendre 6", "Moser-Veselov", "Gauss-Legendre 16", "Gauss-Legendre 16, adaptive"):
        setting = FINEST[name][0]
        one = METHODS[name].solve(*PROBLEMS["top"], [0.9], setting)
        many = METHODS[name].solve(*PROBLEMS["top"], [0.4, 0.9, 0.7, -0.3, 1.1], setting)
        assert row(one).tolist() == row(many, 1).tolist(), name


def test_whole_steps_are_counted_without_rounding() -> None:
    assert divided(0.3, 0.1) == (2, float(Fraction(0.3) - 2 * Fraction(0.1)))
    assert divided(1.0, 0.1) == (9, float(1 - 9 * Fraction(0.1)))
    assert divided(1.0, 0.25) == (4, 0.0)
    with pytest.raises(ArgumentError, match=r"step = 0\.0"):
        follow(lambda y, h, memory: (y, memory, 1), [1.0, 0.0], [1.0], 0.0)


def test_refusals() -> None:
    ball, tilde = PROBLEMS["ball"], DEFORMED[0]
    with pytest.raises(ArgumentError, match=r"d = 0\.7: Moser-Veselov is for the Euler top"):
        METHODS["Moser-Veselov"].solve(*ball, [1.0], 0.1)
    with pytest.raises(ArgumentError, match="mpmath odefun is for the ball and the top: Tilde"):
        METHODS["mpmath odefun"].solve(tilde, tilde.state(GAMMA, UPRIGHT), [1.0], 15)
    with pytest.raises(ArgumentError, match=r"needs nosuchmodule: pip install 'jacobian-integrable\[peers\]'"):
        replace(METHODS["heyoka"], module="nosuchmodule").solve(*ball, [1.0], 1e-9)
    with pytest.raises(ArgumentError, match=r"step = -0\.1: give a positive step"):
        METHODS["implicit midpoint"].solve(*ball, [1.0], -0.1)
    with pytest.raises(ArgumentError, match=r"step = 'a': give a positive step"):
        METHODS["implicit midpoint"].prepare(*ball, setting="a")
    with pytest.raises(ArgumentError, match="order = 3"):
        moser_veselov((1, 2, 3), 3)
    for wrong in (1, 2):
        with pytest.raises(ArgumentError, match=rf"tolerance = {wrong}\.0: give a number between 0 and 1"):
            METHODS["Taylor, compiled"].solve(*ball, [1.0], wrong)
    for name, problem in (("Moser-Veselov", "top"), ("implicit midpoint", "ball"), ("Gauss-Legendre 16", "ball")):
        with pytest.raises(PrecisionLoss, match=r"step = .*50.*smaller"):
            METHODS[name].solve(*PROBLEMS[problem], [100.0], 50.0)


# --- equations as expressions, and what is built once

MOVING = [name for name in scene_names() if load_scene(name).steps is None]


@pytest.mark.parametrize("scene", MOVING)
def test_the_recorded_equations_are_those_of_the_system(scene) -> None:
    """In 30 digits, at other states than the recorded one; all systems of a class are of one kind, whatever their
    constants.
    """
    K = MP(30)
    system, state = load_scene(scene).start(30)
    moved = [x * (1 + K.coerce(Fraction(1 + i, 1000))) for i, x in enumerate((*state.gamma, *state.M))]
    found = equations(system, state)(moved)
    half = len(moved) // 2
    if is_body(system):
        wanted = body_equations(system.inertia, system.d)(moved)
    elif hasattr(system, "system"):
        rate = system.system._vector_field(K, Point(tuple(moved[:half]), tuple(moved[half:])))
        wanted = [*rate.q, *rate.p]
    else:
        rate = system._rates(replace(state, gamma=tuple(moved[:3]), M=tuple(moved[3:])))
        wanted = [*rate.gamma, *rate.M]
    assert max(abs(x - y) for x, y in zip(found, wanted, strict=True)) < 1e-25


def test_all_balls_are_of_one_kind_and_all_tops() -> None:
    bodies = [ChaplyginBall(inertia, 0.7) for inertia in ((1, 2, 3), (0.7, 1, 1), (2, 2, 2))]
    kinds = {problem_of(body, body.state(GAMMA, UPRIGHT)).kind for body in [*bodies, ChaplyginBall((1, 2, 4), 1)]}
    assert len(kinds) == 1
    assert problem_of(TOP, TOP.state(GAMMA, UPRIGHT)).kind not in kinds
    gyroscopes = [Gyroscopic(inertia, c) for inertia, c in (((1, 2, 3), 0.4), ((1, 2, 4), 2), ((2, 3, 9), 1.0))]
    assert len({problem_of(g, g.state(GAMMA, UPRIGHT)).kind for g in gyroscopes}) == 1


def test_an_integrator_is_built_once_for_all_bodies(monkeypatch) -> None:
    """Compilation happens once per machine, not at every start."""

    class Slow(type(METHODS["SciPy DOP853"])):
        def build(self, kind, setting):
            built.append(kind)
            return super().build(kind, setting)

    built, looks = [], iter(range(100))
    # a second passes at each reading of the clock, and a thousand while the method is built
    monkeypatch.setattr("integrable.oracles.method.perf_counter", lambda: float(next(looks) + 1000 * len(built)))
    slow = Slow("slow to build", "a test", "tolerance", (1e-6,), module="scipy", extra="app")
    for inertia in ((1, 2, 3), (1, 2, 5)):
        body = ChaplyginBall(inertia, 0.7)
        spent, _ = timed_run(slow, problem_of(body, body.state(GAMMA, UPRIGHT)), [0.1], 1e-6)
        assert spent.machine == 1001
        assert spent.counted == spent.start + spent.evaluation
        assert spent.counted == 2
        assert spent.first == pytest.approx(sum(spent))
    assert len(built) == 1


@pytest.mark.parametrize("name", ["heyoka", "heyoka, long double"])
def test_heyoka_takes_times_of_any_sort(name):
    """A list of floats is passed as it is; other inputs are converted, with the same states."""
    pytest.importorskip("heyoka")
    system, state = PROBLEMS["top"]
    solve = partial(METHODS[name].solve, system, state, setting=1e-15)
    usual = solve([0.0, 0.5, 1.0])
    assert np.array_equal(usual.gamma[0], [float(x) for x in state.gamma])
    for times, rows in (
        ([0, 0.5, 0.5, 1.0], [0, 1, 1, 2]),
        ([Fraction(0), Fraction(1, 2), Fraction(1)], [0, 1, 2]),
        (iter([1.0]), [2]),
        (np.array([1.0, 0.0, 0.5]), [2, 0, 1]),
        ([0, 1], [0, 2]),
        ([0.0], [0]),
        ([0.5, 0.5], [1, 1]),
    ):
        found = solve(times)
        assert found.gamma.dtype == found.M.dtype == float
        assert np.allclose(found.M, usual.M[rows], rtol=0, atol=1e-15)
    assert solve([]).gamma.shape == (0, 3)
    back = METHODS[name].solve(system, type(state)(tuple(usual.gamma[1]), tuple(usual.M[1])), [-0.5], 1e-15)
    assert np.allclose(back.gamma[0], usual.gamma[0], rtol=0, atol=1e-15)
