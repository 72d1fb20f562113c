"""Near times in floats, by walks and short runs: accurate to 1e-13, or left to the next method."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.motion.conditioning import conditioning
from integrable.motion.short import ShortRuns
from integrable.phase.brackets import over
from integrable.phase.state import onto_constraints
from jacobian import MP, PrecisionLoss
from jacobian.numbers.compiler import interpreted
from tests.integrable.ways import precise_of, short_runs

compiled = pytest.mark.skipif(interpreted(), reason="walks and short runs of so many panels are compiled")
# moments, d, γ, M, tilted, t: in each case the first step or the intermediate steps lose digits
LOSING = {
    "heavy, M near γ": (
        (0.6596997269400164, 0.42163309175174, 0.997294361653126),
        1629.4141567500421,
        (0.3995964000663913, -0.5273651530827682, 0.7498057830985093),
        (-1.242795840628255e-13, 4.629645806579446e-16, 57.65836202786802),
        True,
        0.780360446580466,
    ),
    "top, next to the start": (
        (40.57915793298262, 0.012529811705841314, 4.407124763641136),
        0,
        (-0.0886647513792732, 0.9960608244970187, 0.0011814250593350133),
        (10.354247463022364, 0.9216878688511483, -0.0003398848057172561),
        False,
        0.0002885422401618393,
    ),
    "light, next to the start": (
        (0.07700685725365349, 12.802216202572605, 3.3949077037406434),
        8.77622020322936e-06,
        (-0.5752500148110542, 0.16002940903606408, 0.802170810179135),
        (-0.6924341980159288, 0.12678229587929388, -0.5218485554923906),
        False,
        0.0013009126951771634,
    ),
    "light and tilted": (
        (7.577598304479976, 0.03956965478301915, 2.219403104312069),
        4.2581249786398315e-06,
        (-0.37373838226776773, 0.9082794240923814, -0.18801092891181595),
        (15.31715168779252, 40.588650833991565, -23.404234988655688),
        True,
        3.651382580255462e-05,
    ),
    # u1 passes as close to the other branch points as they are to each other: 21 digits per passage, 160 panels away
    "four branch points within 3e-7": (
        (1612222.6318501914, 0.032057838671825524, 0.0004155290068605134),
        211390.91202183932,
        (0.6378101891630231, 0.7598932789159001, -0.1255403013309707),
        (0.0001543351450389932, -0.00014676347031636585, -0.00010425374555579425),
        False,
        3811032683.8065357,
    ),
}


def error(system, state, t):
    """The error of γ and M/|M| at t, of the flow and of a short run if there is one, relative to 40 digits from
    the same floats.
    """
    wide = over(system, MP(40))
    true = wide.flow(onto_constraints(wide, state)).at([t])
    run, short_run = system.flow(state).at([t]), ShortRuns(system, state).at(np.array([t]))
    rows = [np.hstack([run.gamma, run.M])[0], *([] if short_run is None else short_run[0])]
    gaps = [np.abs(row - np.hstack([true.gamma, true.M])[0]) for row in rows]
    size = float(np.linalg.norm(state.M))
    return max(float(max(gap[:3].max(), gap[3:].max() / size)) for gap in gaps)


@pytest.mark.parametrize("name", LOSING)
def test_what_floats_lose_near_the_start_is_left_to_the_next_way(name) -> None:
    inertia, d, gamma, M, tilted, t = LOSING[name]
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    assert error(system, system.state(gamma, M, tilted=tilted), t) < 1e-13


def test_near_times_of_all_kinds_of_bodies() -> None:
    """Heavy, light and tilted ones of wide distributions, where short runs answer."""
    rng, tried = Random(12), 0
    while tried < 20:
        system, state, t = random_motion(rng)
        if ShortRuns(system, state).at(np.array([t])) is None:
            continue
        tried += 1
        lost = error(system, state, t)
        assert lost < 1e-13 or lost < 10 * max(conditioning(system, state, [t]).floor()), (system, state, t)


@pytest.mark.parametrize("kernel", ["auto", "python"])
def test_an_ordinary_ball_does_not_wait_for_a_torus(kernel) -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)), kernel=kernel)
    flow.at([1.0, 2.0, -3.0]), flow.at_tau([1.0]), flow.physical_time([2.0])
    assert not {"_torus", "_precise", "setup"} & set(vars(flow))


@pytest.mark.parametrize("kernel", ["auto", "python"])
def test_no_time_has_gone_by_at_the_start(kernel) -> None:
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)), kernel=kernel)
    times = np.array([1.0, 0.0, -1.0, -0.0])
    assert flow.at(times).way == ("integrated" if kernel == "auto" and not interpreted() else "short run")
    for found in (flow.at(times).tau, flow.at_tau(times).times, flow.physical_time(times)):
        assert found[1] == found[3] == 0
        assert found[0] > 0 > found[2]


# H1/H2 = a₂, to a rounding or all digits
SEPARATRIX = {
    "ball": (ChaplyginBall((1, 2, 5), 1.0), (2 / 3, -1 / 3, 2 / 3), (1, -0.5, -1.25), 100.0),
    "both points at the node": (ChaplyginBall((1, 1.5, 3), 0.5), (0.5**0.5, 0.0, 0.5**0.5), (0.5, 1.0, -0.5), 60.0),
    "top": (EulerTop((2, 3, 6)), (0.5**0.5, 0.0, -(0.5**0.5)), (1.0, 0.7, 1.0), -90.0),
}


@pytest.mark.parametrize(
    "name",
    [pytest.param(x, marks=() if x == "both points at the node" else pytest.mark.slow) for x in SEPARATRIX],
)
def test_far_times_on_a_separatrix_are_computed_with_more_digits(name) -> None:
    system, gamma, M, t = SEPARATRIX[name]
    flow, wide = system.flow(system.state(gamma, M)), over(system, MP(30))
    true_flow = wide.flow(onto_constraints(wide, flow.state))
    times, tau = 4 * np.array([t, -0.3 * t]), 4 * np.array([0.5 * t])
    size = float(np.linalg.norm(flow.state.M))
    for run, true in ((flow.at(times), true_flow.at(times)), (flow.at_tau(tau), true_flow.at_tau(tau))):
        assert abs(run.gamma - true.gamma.astype(float)).max() < 3e-14
        assert abs(run.M - true.M.astype(float)).max() < 3e-14 * size
    assert flow.at(times).way == "multiprecision"
    if system.body.rolls:
        assert flow.physical_time(tau) == pytest.approx(true_flow.physical_time(tau).astype(float), rel=1e-14)


BALL, PLANE = ChaplyginBall((1, 2, 3), 0.6), (-8 / 17, 9 / 17, -12 / 17)
# H1/H2 off a₂ by 1.7e-9 and 1.7e-15
BESIDE = {
    "at 1e-8": (BALL, PLANE, (0.600000017, 26 / 15, 0.8999999886666667), 180.0),
    "at 1e-14": (BALL, PLANE, (0.600000000000017, 26 / 15, 0.8999999999999887), -120.0),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", [*SEPARATRIX, *BESIDE])
def test_beside_a_separatrix_panels_in_double_doubles_lose_no_more_than_inputs(name) -> None:
    """Input errors grow by up to 10^14; the errors of U and V would grow by the square of this."""
    system, gamma, M, t = (SEPARATRIX | BESIDE)[name]
    state = system.state(gamma, M)
    times, runs = np.array([t, 0.6 * t, -0.4 * t]), ShortRuns(system, state)
    true = precise_of(system.flow(state)).at(times)[0]
    found = runs.at(times)
    assert found is not None
    assert abs(found[0] - true)[:, :3].max() < 2e-14
    assert abs(found[0] - true)[:, 3:].max() < 2e-14 * float(np.linalg.norm(M))
    if name in SEPARATRIX:
        # at these times double-doubles have too few digits
        assert runs.at(4 * times) is None


# hundreds of panels beside the separatrix of a heavy ball, whose branch points are close together: the error was 6e-12
# where the second motion (the shadow of :mod:`integrable.moving_point.short_start`) was projected onto the level set of
# the first, and 1e-11 without a projection
HEAVY = {
    597: (
        (1.019281468602172, 1.4474190531258602, 2.928171698369475),
        (0.7891387631603531, -0.5960887368159199, 0.1481155978246352),
        (-0.7471221969215432, -0.8666806703299214, 0.4926186133006925),
        -3597.68001195,
    ),
    383: (
        (1.2062860423645125, 2.4405756750260856, 2.678700290105615),
        (0.8830511787156878, -0.1454814852485459, 0.44615664650289766),
        (-0.10061828825783639, 0.4098349749446531, 0.3327855811898607),
        13771.19759769,
    ),
}


@compiled
@pytest.mark.parametrize("name", HEAVY)
def test_translations_by_many_panels_lead_off_no_level(name) -> None:
    inertia, gamma, M, t = HEAVY[name]
    ball = ChaplyginBall(inertia, 30.0)
    state = ball.state(gamma, M)
    times = t * np.array([0.33, 0.7, 0.9, 1.0])
    true = precise_of(ball.flow(state)).at(times)[0]
    found = [short_runs(ball, state).at(time) for time in times[:, None]]
    assert found[2] is not None
    for row, pair in zip(true, found, strict=True):
        assert pair is None or abs(pair[0][0] - row).max() < 1e-13


@pytest.mark.parametrize("name", ["ball", "at 1e-14"])
def test_interpreted_panels_go_as_far_beside_a_separatrix(name) -> None:
    system, gamma, M, t = (SEPARATRIX | BESIDE)[name]
    state = system.state(gamma, M)
    one, other = (ShortRuns(system, state, kernel).at(np.array([t])) for kernel in ("auto", "python"))
    assert one is not None
    assert other is not None
    assert abs(other[0] - one[0]).max() < 2e-14


def test_times_on_a_separatrix_that_no_digits_lead_to_are_refused() -> None:
    system, gamma, M, _ = SEPARATRIX["ball"]
    flow = system.flow(system.state(gamma, M))
    for far in (1e5, -1e200, 1.7e308):
        with pytest.raises(PrecisionLoss):
            flow.at([1.0, far])
    assert len(flow.at([])) == 0


def random_motion(rng):
    inertia = [10 ** rng.uniform(-2, 2) if rng.random() < 0.5 else rng.uniform(0.3, 3) for _ in range(3)]
    d = rng.choice([0.0, 10 ** rng.uniform(-6, 0), 10 ** rng.uniform(0, 5)])
    gamma, M = unit(rng), unit(rng) * 10 ** rng.uniform(-1, 2)
    tilted = d > 0 and rng.random() < 0.6
    if tilted and rng.random() < 0.4:
        M = np.linalg.norm(M) * (gamma + 10 ** rng.uniform(-6, 0) * unit(rng))
    if not tilted:
        M = M - gamma * (gamma @ M)
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    state = system.state(gamma.tolist(), M.tolist(), tilted=tilted)
    turn = (system.integrals(state).H1 / min(inertia)) ** 0.5
    return system, state, rng.choice([-1, 1]) * 10 ** rng.uniform(-2, 1.5) / turn


def unit(rng):
    v = np.array([rng.gauss(0, 1) for _ in range(3)])
    if rng.random() < 0.3:
        v *= 10 ** np.array([rng.uniform(-6, 0) for _ in range(3)])
    return v / np.linalg.norm(v)


@compiled
def test_no_node_of_a_panel_loses_three_digits():
    """Found by fuzz: the error at one node of a thin body's panel was 2.7e-13, that of the panel's last coefficients
    1e-14.
    """
    top = EulerTop((4.117414606429112e-06, 0.001181372970212736, 0.00046549475323938737))
    gamma = (-0.7214901633968287, 0.25235123105979845, 0.6448029158620654)
    state = top.state(gamma, (-0.10953585313738312, 0.17045231282117532, 0.1676465563778494), tilted=True)
    times = np.linspace(2.9800152150610032e-05, 0.00013194348830929237, 600)
    found = ShortRuns(top, state).at(times)
    assert found is not None
    assert abs(found[0][:, :3] - top.flow(state, kernel="compiled").at(times).gamma).max() < 2e-14


WALKED = {
    "ball": (ChaplyginBall((1, 2, 3), 0.7), (0.384, 1.28, -1.488), False),
    "tilted": (ChaplyginBall((1, 2, 3), 0.7), (1.0, 0.3, -0.8), True),
    "equal moments": (ChaplyginBall((2, 2, 3), 0.7), (0.384, 1.28, -1.488), False),
    "top": (EulerTop((1, 2, 3)), (0.384, 1.28, -1.488), False),
    "heavy": (ChaplyginBall((1, 2, 3), 1e6), (0.384, 1.28, -1.488), False),
    "light": (ChaplyginBall((1, 2, 3), 1e-7), (0.384, 1.28, -1.488), False),
}


@compiled
@pytest.mark.parametrize("name", WALKED)
def test_a_walk_near_the_start_gives_the_nearest_floats(name) -> None:
    """In either direction and in any order; τ too."""
    system, M, tilted = WALKED[name]
    flow = system.flow(system.state((0.48, 0.6, 0.64), M, tilted=tilted))
    wide = over(system, MP(40))
    times = [1.0, -2.0, 0.25, 0.0]
    run, true = flow.at(times), wide.flow(onto_constraints(wide, flow.state)).at(times)
    assert run.way == "integrated"
    assert abs(run.gamma - true.gamma).max() < 2e-16
    assert abs(run.M - true.M).max() < 3e-16
    assert (abs(run.tau - true.tau) <= 2.0**-52 * abs(true.tau)).all()
    back = flow.at_tau(run.tau)
    assert abs(back.gamma - true.gamma).max() < 2e-15
    assert flow.physical_time(run.tau) == pytest.approx(times, rel=1e-15, abs=0)
