"""Random access on the torus, for every kind of body, compared with the table of counts and with quadrature in more
digits.
"""

from __future__ import annotations

from math import inf

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop, load_scene
from integrable.motion.precise import PreciseFlow
from integrable.moving_point.problem import TIME_SCALE
from integrable.oracles.reference import taylor
from integrable.phase.body import unwarned
from integrable.phase.state import onto_constraints
from integrable.torus.access import BodyTorus, TorusFlow
from integrable.torus.clock import RateSpectrum, series_between
from integrable.torus.clock_loops import swing_and_rate
from integrable.torus.clock_modes import Cutoffs
from integrable.torus.lattice import Units, beginning
from integrable.torus.loops import CompiledLoops, ReadableLoops
from integrable.torus.series import TorusSeries, needed_sizes, spectrum
from integrable.torus.theta_series import float_circle, half_turn
from integrable.torus.theta_setup import FOUND, torus_periods
from jacobian import MP
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.long_reals import BareReals
from tests.integrable.ways import torus_of

START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
BALL = ChaplyginBall((1, 2, 3), 0.7)
# in cells of a torus with the two periods 2700 and 83000
CELLS = [700.0, 1500.0, 3300.0, -475.0]


def beside_the_separatrix(size: float):
    """M turned away from the middle axis by ``size``: H1/H2 is within size² of a2."""
    return BALL, (0, 0, 1), (size, (1 - size * size) ** 0.5, 0)


# name: system, γ, M, allowed error of a component of γ in floats
SCENES = {
    "S1": (BALL, *START, 4e-16),
    "S2": (EulerTop((1, 2, 3)), *START, 4e-16),
    "S4a, thin": (ChaplyginBall((1e-4, 1, 1.5), 1), *START, 4e-16),
    "thinner": (ChaplyginBall((1e-8, 1, 1.5), 1), *START, 4e-16),
    "1e-4 beside the separatrix": (*beside_the_separatrix(1e-2), 4e-16),
    "1e-8 beside the separatrix": (*beside_the_separatrix(1e-4), 4e-16),
    "1e-12 beside the separatrix": (*beside_the_separatrix(1e-6), 4e-15),
    "1e-14 beside the separatrix": (*beside_the_separatrix(1e-7), 1e-12),
    "two equal moments": (ChaplyginBall((1, 1, 2), 0.7), *START, 4e-16),
    "two equal moments, top": (EulerTop((2, 1, 1)), *START, 4e-16),
    "nearly equal moments, 1e-6": (ChaplyginBall((1, 1 + 1e-6, 2), 0.7), *START, 4e-16),
    "nearly equal moments, 1e-12": (ChaplyginBall((1, 1 + 1e-12, 2), 0.7), *START, 4e-16),
    "moments 1 : 10^4 : 10^8": (ChaplyginBall((1, 1e4, 1e8), 1), *START, 4e-16),
    "moments 10^-4 : 1 : 10^4": (ChaplyginBall((1e-4, 1, 1e4), 1), *START, 4e-16),
    "d = 1e-12": (ChaplyginBall((1, 2, 3), 1e-12), *START, 4e-16),
    "heavy ball, d·max a → 1": (ChaplyginBall((1, 2, 3), 1000), *START, 4e-16),
    "fast spin": (BALL, START[0], (3840, 12800, -14880), 4e-16),
    "slow spin": (BALL, START[0], (0.384e-8, 1.28e-8, -1.488e-8), 4e-16),
    "gamma_1 = gamma_2 = 0": (BALL, (0, 0, 1), (1, 0.5, 0), 4e-16),
    "gamma_2 = 0": (BALL, (0.6, 0, 0.8), (0.8, 0.5, -0.6), 4e-16),
    "relative equilibrium": (BALL, (0, 0, 1), (1, 0, 0), 4e-16),
    "(γ, M) = 1.5": (BALL, START[0], (1.104, 2.18, -0.528), 4e-16),
    "(γ, M) ≠ 0, top": (EulerTop((1, 2, 3)), START[0], (1.104, 2.18, -0.528), 4e-16),
}


def scene(name: str):
    system, gamma, M, tolerance = SCENES[name]
    return system, system.state(gamma, M, tilted="(γ, M)" in name), np.linalg.norm(M), tolerance


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", SCENES)
def test_any_tau_against_the_table_of_counts_at_25_digits(name) -> None:
    """τ|M| up to 10^6, forwards and backwards, compared with different additions in different numbers."""
    system, state, spin, tolerance = scene(name)
    tau = np.array([0.0, 1.0, -30.0, 1e3, 1e6]) / spin
    rows = system.flow(state, kernel="compiled").at_tau(tau)
    precise = PreciseFlow(system.body, state, 25)
    truth = precise.vectors(precise.at_tau(tau.tolist()))
    for gamma, M, (true_gamma, true_M) in zip(rows.gamma, rows.M, truth, strict=True):
        assert max(abs(float(x - y)) for x, y in zip(gamma.tolist(), true_gamma, strict=True)) < tolerance
        assert max(abs(float(x - y)) for x, y in zip(M.tolist(), true_M, strict=True)) < 2 * tolerance * spin


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    "name",
    ["S1", "two equal moments", "gamma_2 = 0", "slow spin", "(γ, M) = 1.5", "S4a, thin", "moments 1 : 10^4 : 10^8"],
)
def test_any_time_against_quadrature_at_25_digits(name) -> None:
    system, state, spin, _ = scene(name)
    times = np.array([2.0, -14.0, 60.0]) / spin
    rows = system.flow(state, kernel="compiled").at(times)
    precise = PreciseFlow(system.body, state, 25)
    tau, points = precise.at(times.tolist())
    for found, (gamma, _) in zip(rows.gamma.tolist(), precise.vectors(points), strict=True):
        assert max(abs(float(x - y)) for x, y in zip(found, gamma, strict=True)) < 2e-15
    for found, true in zip(rows.tau.tolist(), tau, strict=True):
        assert abs(float(found - true)) < 4e-15 * float(abs(true))


def test_branch_points_within_a_millionth_of_each_other() -> None:
    """m r² = 10⁶ times the moments: series about such close centres leave the range of floats, the torus does not."""
    system = ChaplyginBall((1, 2, 3), 1e6)
    state = system.state(*START)
    times = np.array([1e5, -3e5])
    run = system.flow(state, kernel="compiled").at(times)
    precise = PreciseFlow(system.body, state, 17)
    for gamma, (truth, _) in zip(run.gamma.tolist(), precise.vectors(precise.at(times.tolist())[1]), strict=True):
        assert max(abs(float(x - y)) for x, y in zip(gamma, truth, strict=True)) < 1e-14


@pytest.mark.parametrize("name", ["S1", "S2", "(γ, M) = 1.5", "gamma_2 = 0", "moments 1 : 10^4 : 10^8"])
def test_the_error_does_not_grow_with_the_time(name) -> None:
    """T = 10^6 … 10^12 compared with 48 digits, by the same series in the readable loops."""
    system, state, _, _ = scene(name)
    times = [1e12, -1e9, 1e6]
    compiled, readable = (system.flow(state, kernel=kernel).at(times) for kernel in ("compiled", "python"))
    assert np.abs(compiled.gamma - readable.gamma).max() < 1e-12
    assert np.abs(compiled.M - readable.M).max() < 2e-12


@pytest.mark.parametrize("name", ["S1", "S4a, thin", "1e-4 beside the separatrix", "(γ, M) = 1.5"])
def test_times_of_both_kinds_are_inverse_to_each_other(name) -> None:
    system, state, spin, _ = scene(name)
    flow = system.flow(state, kernel="compiled")
    times = np.random.default_rng(3).uniform(-1e4, 1e4, 2000) / spin
    run = flow.at(times)
    assert flow.physical_time(run.tau) == pytest.approx(times, rel=1e-14, abs=1e-13 / spin)
    # 0 < dt/dτ = 1/g ≤ 1 for an upright body
    order = np.argsort(times)
    assert (np.diff(run.tau[order]) > 0).all()


def test_times_where_the_rate_is_small_are_found() -> None:
    """dt/dτ is between 0.005 and 0.8: Newton's steps for t(τ) lead far outside the interval that contains τ."""
    inertia = (0.012610148496156943, 0.000317709828175106, 3.066569934542356e-08)
    system = ChaplyginBall(inertia, 0.007079772687684559)
    M = (9.482780840851529e-05, 9.132973933864779e-05, -0.0004312515144772873)
    flow = system.flow(system.state((-0.6936971430060478, 0.7202668073604718, 0.0), M))
    times = np.linspace(2019.31, 2019.32, 40)
    torus = TorusFlow(flow.setup, CompiledLoops())
    assert np.abs(torus.times(torus.at(times)[1]) - times).max() < 1e-11


def test_many_times_keep_the_integrals() -> None:
    for name in SCENES:
        system, state, spin, tolerance = scene(name)
        times = np.random.default_rng(5).uniform(-1e5, 1e5, 600) / spin
        run = system.flow(state, kernel="compiled").at(times)
        for found, expected in zip(run.integrals[2:], system.integrals(state)[2:], strict=True):
            assert np.abs(found / expected - 1).max() < max(10 * tolerance, 1e-14)


@pytest.mark.parametrize("name", ["near_separatrix_8", pytest.param("near_separatrix_14", marks=pytest.mark.slow)])
def test_beside_the_separatrix_states_are_those_of_twenty_digits(name) -> None:
    scene = load_scene(name)
    system, state = scene.start(15)
    flow = system.flow(state, kernel="compiled")
    times = np.array([50.0, 1000.0])
    run = flow.at(times)
    assert torus_of(flow) is not None
    precise = PreciseFlow(system.body, state, 20)
    truth = precise.vectors(precise.at(times.tolist())[1])
    for gamma, (true, _) in zip(run.gamma.tolist(), truth, strict=True):
        assert max(abs(float(x - y)) for x, y in zip(gamma, true, strict=True)) < 2e-13


def test_turns_beyond_double_double_numbers_are_refused() -> None:
    system, state, _, _ = scene("S1")
    flow = system.flow(state, kernel="compiled")
    for move in (flow.at, flow.at_tau, flow.physical_time):
        with pytest.raises(PrecisionLoss, match=r"time 1e\+20.*turns of a phase.*more digits"):
            move([1e20])


# --- the series of a clock


def test_a_trigonometric_polynomial_is_integrated_exactly() -> None:
    nu = (MP(40).coerce("0.3"), MP(40).coerce("-0.71"))
    first, second = np.meshgrid(np.arange(16) / 16, np.arange(8) / 8, indexing="ij")

    def rate(a, b):
        return 2 + np.cos(2 * np.pi * (3 * a - b)) - 0.5 * np.sin(2 * np.pi * 2 * b)

    series = TorusSeries(spectrum(rate(first, second)), nu)
    assert series.mean == pytest.approx(2)
    tau = np.linspace(-5, 7, 50)
    w1, w2 = 2 * np.pi * (0.9 + 0.71), -4 * np.pi * 0.71
    swing = np.sin(w1 * tau) / w1 - 0.5 * (1 - np.cos(w2 * tau)) / w2
    assert series.at(0.3 * tau, -0.71 * tau) == pytest.approx(swing, abs=1e-14)
    for setup in (None, BALL.flow(BALL.state(*START)).setup):
        loops = ReadableLoops(setup) if setup else CompiledLoops()
        samples = loops.samples(loops.row(rate(first, second).ravel().tolist()), first.shape)
        values, _ = loops.spectrum(samples, (1e-15, 1e-15))
        rates = loops.row((*nu, 2, 2 * MP(40).context.pi))
        limits = Cutoffs(1e-15, 1e-15, inf, 0.3, inf)
        (rough, packed, quiet, modes, _), _ = series_between(
            loops, RateSpectrum(values, first.shape, 1.0), (rates, (1, 1)), limits
        )
        assert quiet is packed
        assert not len(modes)
        assert (len(packed.parts), len(rough.parts)) == (8, 4)
        for t, expected in zip(tau, swing, strict=True):
            found, slope = swing_and_rate(packed, 0.3 * t, -0.71 * t, float_circle())
            assert 2 * found == pytest.approx(expected, abs=1e-14)
            assert 2 * slope == pytest.approx(rate(0.3 * t, -0.71 * t), abs=1e-13)


def test_a_mode_in_resonance_is_refused() -> None:
    first, second = np.meshgrid(np.arange(8) / 8, np.arange(8) / 8, indexing="ij")
    with pytest.raises(PrecisionLoss, match=r"mode \(1, 2\)"):
        TorusSeries(spectrum(np.cos(2 * np.pi * (first + 2 * second))), (MP(20).coerce(2), MP(20).coerce(-1)))


def test_the_clock_next_to_a_resonance_is_that_of_thirty_digits() -> None:
    """Frequencies 3 : 2 to 1e-16: τ oscillates by millions of turns; it had a relative error of 4e-7."""
    gamma, M, times = (0.48, 0.6, 0.64), (-1.7270156468929283, 0.38886810920445863, 0.9306978827905161), (10, 1e3, 1e6)
    system = ChaplyginBall((2, 3, 4), 0.7)
    flow = system.flow(system.state(gamma, M))
    first, second = flow.portrait.frequencies
    assert abs(first / second) == pytest.approx(1.5, abs=1e-15)
    fine = ChaplyginBall((2, 3, 4), MP(30).coerce(0.7), field=MP(30))
    exact = fine.flow(onto_constraints(fine, flow.state))
    found, true = flow.at(times), exact.at(times)
    assert found.way == "torus"
    assert np.abs(found.tau / true.tau.astype(float) - 1).max() < 3e-16
    found, true = flow.at_tau(times), exact.at_tau(times)
    assert found.way == "torus"
    assert np.abs(found.times / true.times.astype(float) - 1).max() < 3e-16


def test_dense_times_give_the_same_bits_whatever_was_asked_before() -> None:
    """The length of panels was that of the shortest interval so far, so that bits changed with it."""
    times = 1e4 + np.linspace(0, 1000, 20_000)
    first, flow = BALL.flow(BALL.state(*START)).at(times), BALL.flow(BALL.state(*START))
    for length in (3, 1):
        flow.at(1e4 + np.linspace(0, length, 6000))
    again = flow.at(times)
    assert first.way == "torus"
    assert np.array_equal(first.gamma, again.gamma)
    assert np.array_equal(first.M, again.M)
    some = slice(None, None, 4000)
    assert np.abs(first.gamma[some] - flow.at(times[some]).gamma).max() < 8e-15
    assert np.abs(flow.at_tau(times).gamma[some] - flow.at_tau(times[some]).gamma).max() < 8e-15


def test_a_grid_that_is_too_coarse_is_noticed() -> None:
    def samples(size: int) -> np.ndarray:
        angles = 2 * np.pi * np.arange(size) / size
        return 1 / (1.3 + np.cos(angles)[:, None] + 0 * angles)

    rows, columns = needed_sizes(spectrum(samples(32)), (1e-15, 1e-15))
    assert rows > 32
    assert columns == 32
    # the coefficients fall like 0.47^k: to 1e-15 at 46
    assert needed_sizes(spectrum(samples(128)), (1e-15, 1e-15)) == (128, 128)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("d", "tilted"), [(0.7, False), (0.7, True), (1e-9, True)])
def test_a_finer_grid_takes_what_the_coarser_one_knows(d, tilted) -> None:
    ball = ChaplyginBall((1, 2, 3), d)
    state = ball.state((0.48, 0.6, 0.64), (1.104, 2.18, -0.528) if tilted else (0.384, 1.28, -1.488), tilted=tilted)
    setup = ball.flow(state).setup
    for loops in (CompiledLoops(), ReadableLoops(setup)):
        torus = BodyTorus(setup, loops)
        coarse = torus.samples((8, 128))
        for k, m in ((2, 1), (1, 4), (2, 2)):
            known, anew = torus.samples((8 * k, 128 * m), coarse + 1), torus.samples((8 * k, 128 * m))
            assert (known[::k, ::m] == coarse + 1).all()
            new = np.ones(known.shape[:2], dtype=bool)
            new[::k, ::m] = False
            assert (known[new] == anew[new]).all()
            assert np.abs((anew[::k, ::m] - coarse).reshape(-1)).max() < 1e-17


def test_a_tilted_state_without_a_tilt_has_the_clock_of_an_upright_one() -> None:
    """A state made as a tilted one may have (γ, M) = 0: half of the grid was empty, and multiprecision was used."""
    ball = ChaplyginBall((0.013839669882170155, 0.002377476045841977, 0.016785435607574308), 1.0475366205208094e-09)
    gamma, momentum = (-1.0, 0.0, 0.0), (0.0, -1.3580771168322964e-06, -4.319558273040246e-06)
    times = [402449.2727409653, -2e6]
    states = [ball.state(gamma, momentum, tilted=tilted) for tilted in (True, False)]
    runs = [ball.flow(state, kernel="compiled").at(times) for state in states]
    assert [run.way for run in runs] == ["torus", "torus"]
    assert np.abs(runs[0].gamma - runs[1].gamma).max() < 1e-15


def test_rounding_of_samples_is_no_decay_to_wait_for() -> None:
    # found by fuzz: grids were doubled up to the limit, because samples with errors of 1e-15 should have shown 1e-17
    def needed(size: int, rounding: float, noise: float) -> int:
        smooth = 1 / (1.2 + np.cos(2 * np.pi * np.arange(size) / size))
        dust = rounding * np.random.default_rng(1).standard_normal((size, 16))
        return needed_sizes(spectrum(smooth[:, None] + dust), (noise, 1e-9))[0]

    # grids are still doubled while modes decay, and while another doubling averages rounding away
    assert needed(64, 1e-15, 1e-17) == 128
    assert needed(1024, 1e-12, 1e-14) == 2048
    # a hundredth of the rounding takes ten thousand times as many samples
    assert needed(1024, 1e-12, 1e-16) >= 1024 * 1024


# --- dense output


@pytest.mark.parametrize("name", ["S1", "S2", "S4a, thin", "(γ, M) = 1.5"])
def test_dense_output_is_the_scattered_one(name) -> None:
    system, state, _, tolerance = scene(name)
    flow = system.flow(state, kernel="compiled")
    times = np.linspace(-3, 17, 40_001)
    run = flow.at(times)
    chosen = np.random.default_rng(1).integers(0, len(times), 500)
    scattered = flow.at(times[chosen])
    assert np.abs(run.gamma[chosen] - scattered.gamma).max() < 2e-14 + 10 * tolerance
    assert np.abs(run.M[chosen] - scattered.M).max() < 4e-14 + 10 * tolerance
    assert np.abs(run.tau[chosen] - scattered.tau).max() < 1e-13
    dense = flow.at_tau(times)
    assert np.abs(dense.gamma[chosen] - flow.at_tau(times[chosen]).gamma).max() < 2e-14 + 10 * tolerance


def test_a_stream_is_the_run_and_appears_when_complete(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("integrable.motion.stream.CHUNK", 700)
    flow = BALL.flow(BALL.state(*START), kernel="compiled")
    flow.stream(tmp_path / "run.npy", -1.0, 5.0, 1501)
    rows = np.load(tmp_path / "run.npy")
    assert rows.shape == (1501, 7)
    assert rows[:, 0] == pytest.approx(np.linspace(-1, 5, 1501), abs=1e-15)
    run = flow.at(rows[:, 0])
    assert np.abs(rows[:, 1:4] - run.gamma).max() < 1e-13
    assert np.abs(rows[:, 4:] - run.M).max() < 1e-13
    with pytest.raises(PrecisionLoss):
        flow.stream(tmp_path / "never.npy", 0, 1e20, 10)
    assert [path.name for path in tmp_path.iterdir()] == ["run.npy"]
    for arguments, words in (((0, 1, 1), "count = 1"), ((0, 1, 2.5), "count = 2.5"), (("x", 1, 5), "start")):
        with pytest.raises(ArgumentError, match=words):
            flow.stream(tmp_path / "bad.npy", *arguments)


# --- three equal moments


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("system", [ChaplyginBall((2, 2, 2), 0.7), EulerTop((2, 2, 2))], ids=["ball", "top"])
def test_a_sphere_turns_uniformly(system, tilted) -> None:
    state = system.state(START[0], (1.104, 2.18, -0.528) if tilted else START[1], tilted=tilted)
    flow = system.flow(state, kernel="compiled")
    times = [0.0, 1.5, -4.0]
    truth = taylor(system, state, times, digits=20)
    run = flow.at(times)
    assert np.abs(run.gamma - truth.gamma.astype(float)).max() < 1e-15
    assert np.abs(run.M - truth.M.astype(float)).max() < 2e-15
    assert flow.at_tau(run.tau).gamma == pytest.approx(run.gamma, abs=1e-15)
    assert flow.physical_time(run.tau) == pytest.approx(times, rel=1e-15)
    # whole turns in 10^12 units of time
    assert pytest.approx(1, abs=1e-15) == flow.at([1e12]).integrals.C1


def test_beside_an_unstable_rotation_that_leans():
    """Found by fuzz: with a centre 1e-12 from two branch points γ was off by 1e-9, although H1 and H2 were right."""
    gamma = (0.665817876407031, -0.46571762171010955, -0.5829182209242656)
    M = (0.0001928783849990436, -1.3474401459314787e-10, 3.2074637229059564e-10)
    top = EulerTop((0.16064541664973253, 0.1465348903800803, 0.7130523785399245))
    found = top.flow(top.state(gamma, M, tilted=True)).at([1e7, *CELLS])
    digits = EulerTop(top.inertia, field=MP(30))
    # with the length that the doubles have
    length = digits.field.sqrt(sum(digits.field.coerce(x) ** 2 for x in gamma))
    start = digits.state([x / length for x in gamma], M, tilted=True)
    truth = digits.flow(start).at([1e7, *CELLS])
    assert abs(found.gamma - truth.gamma.astype(float)).max() < 1e-14


def test_a_torus_of_close_moments_is_right_where_a_coordinate_plane_is_passed():
    """With relative differences of moments of 1e-9, M₂ was wrong by 1e-10 of |M| near γ₂ = 0 if far times were
    requested too. In floats the cells fitted, and H1 and H2 hardly depend on a small M₂.
    """
    system = EulerTop((1996.3869996547544, 1996.666046398925, 1996.3869984863165))
    state = system.state(
        (-0.8434497955794591, 0.0, 0.537208006583082), (0.0004549265492743406, 0.0, 0.0007142628186606689)
    )
    times = [11512057981.064451, 1.0, 100.0, -3542.3098443591402]
    found = system.flow(state).at(times)
    # Taylor series of order 45 in 50 digits
    assert found.M[3].tolist() == pytest.approx(
        [0.00045492654927434056, 3.3744424226481698e-16, 0.00071426281866066889], abs=1e-18
    )
    assert found.M[1:3, 1].tolist() == pytest.approx([-9.526107457882922e-20, -9.526107457882922e-18], rel=1e-9)


def test_a_start_next_to_an_unstable_rotation_keeps_the_digits_of_its_small_lifts() -> None:
    """Components of M across the middle axis, 5e-14 at the start, were off by 1e-4 of their size. So M was off by
    1.3e-7 of |M| after the top had turned over. H1 and H2 did not notice.
    """
    inertia = (0.005975936980332287, 2.038040771032971e-06, 4.4376488900685207e-07)
    gamma = (0.018685811584041048, -0.05876514490185873, 0.9980969382730864)
    M, times = (5.124327007839741e-14, 69.38688402208396, 3.01450696032894e-14), [-2.2435576733930232e-4, 1e-4, 1e-3]
    with unwarned():
        top, fine = EulerTop(inertia), EulerTop(inertia, field=MP(40))
    found = top.flow(top.state(gamma, M, tilted=True)).at(times)
    size = sum(MP(40).coerce(x) ** 2 for x in gamma) ** MP(40).coerce("0.5")
    true = fine.flow(fine.state(tuple(x / size for x in gamma), M, tilted=True)).at(times)
    assert found.way == "torus"
    assert np.abs(found.gamma - true.gamma).max() < 1.2e-16
    assert np.abs(found.M - true.M).max() < 1.2e-16 * 69


class FromMoreDigits(CompiledLoops):
    """Loops that always begin a torus in more digits."""

    def begun(self, setup):
        return beginning(setup, self)


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("system", [BALL, EulerTop((3, 1, 2)), ChaplyginBall((2, 0.5, 1.3), 4.0)])
def test_what_loops_begin_with_is_what_more_digits_begin_with(system, tilted) -> None:
    state = system.state(START[0], (1.104, 2.18, -0.528) if tilted else START[1], tilted=tilted)
    setup = system.flow(state).setup
    quick, exact = CompiledLoops().begun(setup), FromMoreDigits().begun(setup)
    assert quick.units == Units()
    assert np.abs(quick.tilt - exact.tilt).max() < 1e-16
    assert np.abs(quick.problem - exact.problem)[TIME_SCALE:].max() < 1e-16
    with setup.reals:
        gaps = [
            float(setup.reals.number(high) + setup.reals.number(low) - x) / max(1e-2, abs(float(x)))
            for (high, low), x in zip(quick.problem.tolist(), setup.bare.row, strict=True)
        ]
    assert max(map(abs, gaps)) < 1e-29
    torus, other = TorusFlow(setup, CompiledLoops()), TorusFlow(setup, FromMoreDigits())
    times = np.array([-1e12, 1e3, 1e9])
    assert np.abs(torus.at(times)[0] - other.at(times)[0]).max() < 2e-16


@pytest.mark.parametrize(
    ("moments", "d", "start"),
    [((1, 1 + 1e-9, 2), 0.7, START), ((1, 2, 3), 1e3, START), ((1, 2, 3), 0.7, ((0, 0, 1), (1e-4, 1, 0)))],
)
def test_branch_points_that_are_close_take_more_digits_to_begin_with(moments, d, start) -> None:
    ball = ChaplyginBall(moments, d)
    setup = ball.flow(ball.state(*start)).setup
    quick, exact = CompiledLoops().begun(setup), FromMoreDigits().begun(setup)
    assert all(np.array_equal(x, y) for x, y in zip(quick[1:], exact[1:], strict=True))


@pytest.mark.parametrize(
    ("moments", "d", "gamma", "M", "times"),
    [
        (
            (8.348987793597134, 2948.2275645476843, 0.0011565366275455393),
            25.204524950615557,
            (-0.04343108567321849, -0.9990463771450145, -0.004480748895755675),
            (-0.09366368012320649, 0.004076907284676683, -0.0011391258316842546),
            (338.4, -41864.80337313851),
        ),
        pytest.param(
            (63, 0.21, 860), 1.4e4, (-5e-5, -0.99, -0.017), (0.3, -8e-5, 0.0038), (7e4, -8.5e6), marks=pytest.mark.slow
        ),
    ],
)
def test_moments_of_different_orders_give_the_nearest_floats(moments, d, gamma, M, times) -> None:
    """dt/dτ is far below its mean at most phases, where rounding of t changes τ most. Errors were 2e-15 to 1e-14."""
    system, gamma = ChaplyginBall(moments, d), np.array(gamma) / np.linalg.norm(gamma)
    state = system.state(gamma, M - gamma * (gamma @ M))
    rows, precise = system.flow(state, kernel="compiled").at(times), PreciseFlow(system.body, state, 20)
    spin = np.linalg.norm(state.M)
    for found, truth in zip(zip(rows.gamma, rows.M, strict=True), precise.vectors(precise.at(times)[1]), strict=True):
        for vector, true, size in zip(found, truth, (1, spin), strict=True):
            assert max(abs(float(x - y)) for x, y in zip(vector.tolist(), true, strict=True)) < 2.3e-16 * size


@pytest.mark.skipif(interpreted(), reason="these are the compiled double-doubles")
@pytest.mark.parametrize(
    "ends",
    [
        (-0.8, -1.4e-13, 0.0, 3.7e-16, 3.8e-16),
        (-0.8, -0.5, 0.0, 1e-9, 2e-9),
        (-1e-12, 0.0, 3e-12, 0.5, 0.9),
        (-0.5, 0.0, 1e-10, 0.7, 3.0),
        (-1.0, -0.6, -0.4, 0.3, 2.0),
    ],
)
def test_periods_over_gaps_have_all_digits_however_close_branch_points_are(ends) -> None:
    """Im τ had lost up to 17 digits of 32 where four branch points are close to each other."""
    reals, loops = BareReals(500), CompiledLoops()
    given = [*ends[:4], *ends[:3], 0.0, 1.0, 0.0, ends[4], 0.0]
    found, room = loops.room(FOUND), loops.room(4)
    with reals:
        exact = [reals.number(x) for x in given]
        exact[9] = half_turn()
        motion, right, memory = loops.row(exact), [reals.number(0)] * FOUND, [reals.number(0)] * 4
        loops.periods(motion, loops.short, room, found)
        torus_periods(exact, 1e-60, memory, right)
        for (high, low), x in zip(found.tolist(), right, strict=True):
            assert abs(reals.number(high) + reals.number(low) - x) <= 1e-24 * abs(x)
