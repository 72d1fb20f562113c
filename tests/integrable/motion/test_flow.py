"""The exact flow compared with reference trajectories, with itself at higher precision, and on every kind of body."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.precise import PreciseFlow
from integrable.moving_point import addition
from integrable.oracles.reference import taylor
from jacobian import MP, QQ
from jacobian.errors import ArgumentError, FieldError
from tests.integrable.torus.translations import in_floats

SCENES = json.loads((Path(__file__).parents[2] / "data" / "trajectories.json").read_text())["scenes"]
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))


def reference(name: str, field=None):
    """(system, state, times, γ and M at these times) of a reference scene; floats unless a field is given."""
    scene = SCENES[name]
    convert = (lambda values: [float(x) for x in values]) if field is None else list
    options = {} if field is None else {"field": field}
    d = convert([str(scene["d"])])[0]
    system = (
        EulerTop(convert(scene["I"]), **options) if float(d) == 0 else ChaplyginBall(convert(scene["I"]), d, **options)
    )
    times = sorted(map(int, scene["states"]))
    states = [scene["states"][str(t)] for t in times]
    return system, system.state(convert(scene["gamma0"]), convert(scene["M0"])), times, states


@pytest.mark.parametrize("kernel", ["python", "compiled"])
@pytest.mark.parametrize("name", ["S1", "S2", "S4a"])
def test_floats_against_the_reference(name, kernel) -> None:
    """tests/data/trajectories.json, T = 1 … 10000: signs included, to the effect of rounding the inputs to floats."""
    system, state, times, states = reference(name)
    run = system.flow(state, kernel=kernel).at(times)
    for t, gamma, M, truth in zip(times, run.gamma, run.M, states, strict=True):
        assert np.abs(gamma - np.array(truth["gamma"], dtype=float)).max() <= 1e-14 + 5e-17 * t
        assert np.abs(M - np.array(truth["M"], dtype=float)).max() <= 4e-14 + 2e-16 * t


@pytest.mark.parametrize(
    ("name", "last"),
    [("S2", 10000), ("S1", 100), pytest.param("S1", 1000, marks=pytest.mark.slow)],
    ids=["S2", "S1", "S1 to 1000"],
)
def test_fifty_digits_against_the_reference(name, last) -> None:
    """To all digits of the reference: 1e-35."""
    field = MP(50)
    system, state, times, states = reference(name, field)
    chosen = [i for i, t in enumerate(times) if t <= last]
    run = system.flow(state).at([times[i] for i in chosen])
    for row, i in enumerate(chosen):
        for found, truth in ((run.gamma[row], states[i]["gamma"]), (run.M[row], states[i]["M"])):
            assert max(abs(x - field.coerce(y)) for x, y in zip(found, truth, strict=True)) <= 1e-35


def test_every_sign_change_of_gamma_is_right() -> None:
    """Dense output of S1 against a Taylor integration at 25 digits: γ_i passes through zero with the right sign
    throughout.
    """
    system, state, _, _ = reference("S1")
    times = [0.05 * i for i in range(401)]
    gamma = system.flow(state).at(times).gamma
    truth = taylor(system, state, times, digits=20).gamma
    assert np.abs(gamma - np.array(truth, dtype=float)).max() < 1e-12
    for i in range(3):
        assert sum(a * b < 0 for a, b in pairwise(gamma[:, i])) >= 3


def test_times_come_in_any_order_size_and_sign() -> None:
    system, state, _, _ = reference("S1")
    flow = system.flow(state, kernel="python")
    times = [3.0, -2.0, 0.0, 3.0, 1e-9, 40.0, -1e-200]
    together = flow.at(times).gamma
    for t, gamma in zip(times, together, strict=True):
        again = system.flow(state, kernel="python").at([t]).gamma[0]
        assert np.abs(gamma - again).max() < 5e-14
    assert together[2] == pytest.approx(state.gamma, abs=1e-15)
    assert (together[0] == together[3]).all()
    assert flow.at(1.5).gamma.shape == (1, 3)
    assert len(flow.at([])) == 0


def test_an_array_of_times_whose_squares_overflow_is_one_of_times() -> None:
    system = ChaplyginBall((1e80, 2e80, 3e80), 0.7e80)
    flow = system.flow(system.state((0.48, 0.6, 0.64), (0.384e-80, 1.28e-80, -1.488e-80)))
    times = [0.0, 1e160, -2e160]
    assert (flow.at(np.array(times)).gamma == flow.at(times).gamma).all()
    for wrong in (np.nan, np.inf):
        with pytest.raises(FieldError, match=r"times\[1\] = .* is not finite"):
            flow.at(np.array([1e200, wrong]))


def test_time_runs_back() -> None:
    system, state, _, _ = reference("S1")
    there = system.flow(state).at([7.0])
    back = system.flow(system.state(there.gamma[0], there.M[0])).at([-7.0])
    assert back.gamma[0] == pytest.approx(state.gamma, abs=1e-12)
    assert back.M[0] == pytest.approx(state.M, abs=1e-12)


def test_physical_time_and_the_time_of_the_flow_are_inverse_to_each_other() -> None:
    system, state, _, _ = reference("S1")
    flow = system.flow(state)
    run = flow.at([-3.0, 0.0, 2.0, 50.0])
    again = flow.at_tau(run.tau)
    assert again.gamma == pytest.approx(run.gamma, abs=1e-13)
    assert again.times == pytest.approx(run.times, abs=1e-12)


def test_the_compiled_loops_equal_the_readable_ones() -> None:
    for name in ("S1", "S2", "S4a"):
        system, state, _, _ = reference(name)
        times = np.linspace(-30, 60, 40)
        readable, compiled = (system.flow(state, kernel=kernel).at(times) for kernel in ("python", "compiled"))
        assert np.abs(readable.gamma - compiled.gamma).max() < 1e-12
        assert np.abs(readable.M - compiled.M).max() < 1e-12


def test_the_flow_in_multiprecision_is_its_own_witness() -> None:
    """Two precisions agree to the digits of the smaller one."""
    runs = []
    for digits in (30, 45):
        system, state, _, _ = reference("S1", MP(digits))
        runs.append(system.flow(state).at([2.5, -1]))
    assert max(abs(a - MP(30).coerce(b)) for a, b in zip(runs[0].gamma.flat, runs[1].gamma.flat, strict=True)) < 1e-28


def test_the_residual_stays_at_rounding_over_a_million_compiled_steps() -> None:
    for name in ("S1", "S2"):
        system, state, _, _ = reference(name)
        growth = system.flow(state, kernel="compiled").residual_growth([10**3, 10**6])
        assert [count for count, _ in growth] == [10**3, 10**6]
        assert max(residual for _, residual in growth) < 1e-9


def test_integrals_are_kept() -> None:
    for name in ("S1", "S2"):
        system, state, _, _ = reference(name)
        run = system.flow(state).at(np.linspace(0, 500, 101))
        start = system.integrals(state)
        for found, expected in zip(run.integrals, start, strict=True):
            assert np.abs(found - expected).max() < 2e-12


SPECIAL = {
    "two equal moments": (ChaplyginBall((1, 1, 2), 0.7), *START),
    "two equal moments, top": (EulerTop((2, 1, 1)), *START),
    "three equal moments": (ChaplyginBall((1, 1, 1), 0.7), *START),
    "nearly equal moments, 1e-6": (ChaplyginBall((1, 1 + 1e-6, 2), 0.7), *START),
    "nearly equal moments, 1e-12": (ChaplyginBall((1, 1 + 1e-12, 2), 0.7), *START),
    "relative equilibrium": (ChaplyginBall((1, 2, 3), 0.7), (0, 0, 1), (1, 0, 0)),
    "H1/H2 = a2, the separatrix": (ChaplyginBall((1, 2, 3), 0.7), (0, 0, 1), (0, 1, 0)),
    "gamma_1 = gamma_2 = 0": (ChaplyginBall((1, 2, 3), 0.7), (0, 0, 1), (1, 0.5, 0)),
    "gamma_2 = 0": (ChaplyginBall((1, 2, 3), 0.7), (0.6, 0, 0.8), (0.8, 0.5, -0.6)),
    "d = 1e-12": (ChaplyginBall((1, 2, 3), 1e-12), *START),
    "d = 0 as a ball": (ChaplyginBall((1, 2, 3), 0), *START),
    "heavy ball": (ChaplyginBall((1, 2, 3), 1000), *START),
    "fast spin": (ChaplyginBall((1, 2, 3), 0.7), START[0], (3840, 12800, -14880)),
    "slow spin": (ChaplyginBall((1, 2, 3), 0.7), START[0], (0.384e-8, 1.28e-8, -1.488e-8)),
    "thin ball": (ChaplyginBall((1e-2, 1, 1.5), 1), *START),
    "moments 1 : 10^4 : 10^8": (ChaplyginBall((1, 1e4, 1e8), 1), *START),
    "axes in another order": (ChaplyginBall((3, 1, 2), 0.7), *START),
}


@pytest.mark.parametrize("name", SPECIAL)
def test_special_bodies_and_starts_against_a_taylor_integration(name) -> None:
    system, gamma, M = SPECIAL[name]
    state = system.state(gamma, M)
    turn = 1 / np.linalg.norm(M)
    times = [0.0, turn, 3 * turn, -2 * turn]
    run = system.flow(state, kernel="python").at(times)
    truth, expected, _ = taylor(system, state, times, digits=20)
    assert np.abs(run.gamma - truth.astype(float)).max() < 2e-12
    assert np.abs(run.M - expected.astype(float)).max() < 4e-12 * np.linalg.norm(M)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["gamma_2 = 0", "gamma_1 = gamma_2 = 0", "thin ball", "axes in another order"])
def test_few_near_times_keep_what_is_promised(name) -> None:
    """|t||M| = 3 … 150 by "auto": additions in floats are used where they and their clock are accurate to 1e-13."""
    system, gamma, M = SPECIAL[name]
    state = system.state(gamma, M)
    flow, precise = system.flow(state), PreciseFlow(system.body, state, 17)
    times = [sign * t / float(np.linalg.norm(M)) for t in (3, 10, 30, 60, 100, 150) for sign in (1, -1)]
    truth = precise.vectors(precise.at(times)[1])
    for t, (expected, _) in zip(times, truth, strict=True):
        assert np.abs(flow.at([t]).gamma[0] - np.array(expected, dtype=float)).max() < 1e-13


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda flow: flow.at([np.nan]), ("times[0]", "nan", "finite")),
        (lambda flow: flow.at([0.0, np.inf]), ("times[1]", "inf", "finite")),
        (lambda flow: flow.at("now"), ("times[0]", "now")),
        (lambda flow: flow.at_tau(["x"]), ("tau[0]", "x")),
        (lambda flow: flow.system.flow(flow.state, kernel="fast"), ("kernel = 'fast'", "'auto'")),
        (lambda flow: flow.system.flow("start"), ("state = 'start'", "State")),
    ],
)
def test_bad_calls(make, words) -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state(*START), kernel="python")
    with pytest.raises(ArgumentError) as caught:
        make(flow)
    for word in words:
        assert word in str(caught.value)


def test_flows_are_for_the_reals() -> None:
    top = EulerTop((3, 5, 11), field=QQ)
    with pytest.raises(ArgumentError, match=r"field = QQ.*RR or MP"):
        top.flow(top.state(("3/5", "4/5", 0), (4, -3, 1)))
    ball = ChaplyginBall((1, 2, 3), "0.7", field=MP(20))
    start = ball.state(("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))
    with pytest.raises(ArgumentError, match=r"compiled.*MP"):
        ball.flow(start, kernel="compiled")


def test_the_small_translation_keeps_its_digits_down_to_nothing() -> None:
    """T(ε) added in doubles compared with 45 digits: no loss as ε → 0, although U' has an almost double root."""
    system, state, _, _ = reference("S1")
    setup = system.flow(state, kernel="python").setup
    for exponent in range(16):
        eps = setup.wide.coerce(10) ** -exponent * setup.problem.half_step
        step = setup.reals.elements(setup.wide, setup.translations.near(eps))
        exact = addition.shift(setup.problem.f, setup.problem.axes, setup.problem.start, step)
        found = addition.shift(setup.floats.f, setup.floats.axes, setup.floats.start, in_floats(setup, float(eps)))
        assert max(abs(float(a - b)) for a, b in zip(exact, found, strict=True)) < 2e-14


def test_a_flow_can_be_prepared_so_that_its_set_up_is_timed_by_itself() -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    for kernel, made in (("compiled", True), ("auto", False)):
        flow = ball.flow(ball.state(*START), kernel=kernel)
        assert "_torus" not in vars(flow)
        flow._prepare()
        # "auto" chooses by the times, in the evaluation
        assert ("_torus" in vars(flow)) is made
