"""The bodies and states that floats accept: requests inside this domain are answered, others are refused at once by
name.
"""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.__main__ import main
from integrable.motion.precise import PreciseFlow
from integrable.motion.precise_clock import ClockLimits
from integrable.oracles import reference
from integrable.phase.state import State
from integrable.torus.access import TorusFlow
from integrable.torus.loops import CompiledLoops
from jacobian import MP
from jacobian.errors import ArgumentError, PrecisionLoss
from tests.integrable.ways import precise_of, torus_of

GAMMA, M = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
ULP = 2.0**-52


def flow_of(inertia, d, factor=1.0):
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    return system.flow(system.state(GAMMA, tuple(factor * x for x in M)))


def exact(inertia, d, times, digits=18):
    """The motion by Taylor series, from the start projected onto (γ, γ) = 1, (γ, M) = 0 to the last digit."""
    K = MP(40)
    g, m = [K.coerce(x) for x in GAMMA], [K.coerce(x) for x in M]
    length, lean = K.sqrt(K.dot(g, g)), K.dot(g, m)
    g, m = [x / length for x in g], [y - lean * x for x, y in zip(g, m, strict=True)]
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    run = reference.taylor(system.body, State(tuple(g), tuple(m)), times, digits=digits)
    return np.hstack([run.gamma, run.M]).astype(float)


OUTSIDE = {
    "heavy": ((1, 2, 3), 1e17, 1, r"d = 1e\+17 with inertia = .*1\.0e\+17 of the least moment.*1e\+16"),
    "beyond floats": ((1, 2, 3), 1e300, 1, r"d = 1e\+300: .*other units"),
    "light": ((1, 2, 3), 1e-60, 1, r"d = 1e-60 with inertia = .*use d = 0"),
    "lighter": ((1, 2, 3), 1e-200, 1, r"d = 1e-200: .*other units"),
    "fast": ((1, 2, 3), 0.7, 1e160, r"M\[0\] = 3\.84e\+159: .*other units"),
    "slow": ((1, 2, 3), 0.7, 1e-160, r"max\(\|M\|\) = 1\.488e-160: .*other units"),
    "slower": ((1, 2, 3), 0.7, 1e-300, r"max\(\|M\|\) = 1\.488e-300: .*other units"),
    "large": ((1e120, 2e120, 3e120), 0, 1, r"inertia\[0\] = 1e\+120: .*other units"),
    "small": ((1e-120, 2e-120, 3e-120), 0, 1, r"inertia\[0\] = 1e-120: .*other units"),
    "a rod": ((1e-12, 1, 1.5), 0.7, 1, r"inertia = .*ratio 1\.5e\+12, floats take up to 1e\+10"),
    "too near": ((1, 1 + ULP, 1 + 2 * ULP), 1e5, 1, r"inertia = .*differ by 4\.4e-21.*use equal moments"),
}


@pytest.mark.parametrize("name", OUTSIDE)
def test_outside_is_refused_by_name(name) -> None:
    inertia, d, factor, message = OUTSIDE[name]
    with pytest.raises(ArgumentError, match=message):
        flow_of(inertia, d, factor)


def test_squares_whose_sum_alone_is_beyond_floats_are_refused_by_name() -> None:
    ball, large = ChaplyginBall((1, 2, 3), 0.7), (8e153, -6e153, 1e154)
    with pytest.raises(ArgumentError, match=r"gamma = .* unit vector"):
        ball.state(large, (1.0, 0.0, 0.0))
    with pytest.raises(ArgumentError, match=r"M\[0\] = 8e\+153: floats take up to"):
        ball.flow(ball.state((0.6, 0.8, 0.0), large))


def test_many_digits_take_any_unit() -> None:
    K = MP(20)
    gamma, momentum = ("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488")
    large, plain = EulerTop(("1e120", "2e120", "3e120"), field=K), EulerTop((1, 2, 3), field=K)
    found = large.flow(large.state(gamma, momentum)).at([K.coerce("1e120")]).gamma[0]
    expected = plain.flow(plain.state(gamma, momentum)).at([1]).gamma[0]
    assert max(abs(x - y) for x, y in zip(found, expected, strict=True)) < K.coerce("1e-19")


NEAR = {
    "ulps": ((1, 1 + 4 * ULP, 1 + 9 * ULP), 0.7),
    "ulps, top": ((1, 1 + 4 * ULP, 1 + 9 * ULP), 0),
    "1e-13": ((1, 1 + 4e-14, 1 + 9e-14), 0.7),
    "1e-10": ((1, 1 + 4e-11, 1 + 9e-11), 0.7),
    "1e-10, top": ((1, 1 + 4e-11, 1 + 9e-11), 0),
    "1e-7": ((1, 1 + 4e-8, 1 + 9e-8), 0.7),
    "1e-4": ((1, 1 + 4e-5, 1 + 9e-5), 0.7),
    "two and a third": ((1, 1 + 4 * ULP, 2), 0.7),
    "two and a third, top": ((2, 1, 1 + 1e-14), 0),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", NEAR)
def test_nearly_equal_moments_keep_all_digits(name) -> None:
    inertia, d = NEAR[name]
    flow, times = flow_of(inertia, d), [3.0, -2.0]
    torus = TorusFlow(flow.setup, CompiledLoops())
    rows, _ = torus.at(np.array(times))
    assert np.abs(rows - exact(inertia, d, times)).max() < 2e-15
    # a long time: forwards and back from another start
    (far,), _ = torus.at(np.array([1e6]))
    start = flow.system.state(tuple(far[:3]), tuple(far[3:]))
    back = flow.system.flow(start, kernel="compiled").at([-1e6, -1e6 + 3.0])
    assert back.gamma == pytest.approx(np.array([GAMMA, rows[0, :3]]), abs=1e-8)


@pytest.mark.thinned(5)
@pytest.mark.parametrize("d", [1e14, 1e4, 1e8, 1e11, 1e16])
def test_heavy_balls_are_told_the_time(d) -> None:
    flow, times = flow_of((1, 2, 3), d), [3.0 * d, -0.5 * d]
    torus = TorusFlow(flow.setup, CompiledLoops())
    rows, tau = torus.at(np.array(times))
    assert np.abs(rows - exact((1, 2, 3), d, times, digits=36)).max() < 3e-15
    assert torus.times(tau) == pytest.approx(times, rel=1e-15)


@pytest.mark.parametrize("unit", [1e-90, 1e90])
def test_units_change_no_state(unit) -> None:
    times = np.array([3.0, 40.0])
    expected = flow_of((1, 2, 3), 0.7).at(times)
    for run in (
        flow_of((unit, 2 * unit, 3 * unit), 0.7 * unit, unit).at(times),
        flow_of((unit, 2 * unit, 3 * unit), 0.7 * unit).at(times * unit),
        flow_of((1, 2, 3), 0.7, unit).at(times / unit),
    ):
        assert run.gamma == pytest.approx(expected.gamma, abs=2e-13)


def test_the_largest_ratio_and_the_lightest_ball_are_answered() -> None:
    for inertia, d in (((1, 1e4, 1e8), 0), ((1, 1.5, 1e8), 0.7), ((1, 2, 3), 4e-50)):
        flow, times = flow_of(inertia, d), [0.5, 1.0]
        run = flow.at(times)
        right = exact(inertia, d, times)
        assert np.abs(run.gamma - right[:, :3]).max() < 1e-13


def exact_motion(system, gamma, M, tilted, times):
    """The motion from any start by Taylor series, as in :func:`exact`."""
    K = MP(60)
    g, m = [K.coerce(x) for x in gamma], [K.coerce(x) for x in M]
    length, lean = K.sqrt(K.dot(g, g)), 0 if tilted else K.dot(g, m)
    g, m = [x / length for x in g], [y - lean * x for x, y in zip(g, m, strict=True)]
    run = reference.taylor(system.body, State(tuple(g), tuple(m), tilted), times, digits=18)
    return np.hstack([run.gamma, run.M / float(np.linalg.norm(M))]).astype(float)


def random_motion(rng, moments, weights):
    """A system and the γ, M and tilt of a random state; moments and d log-uniform from 10^±moments and 10^±weights."""
    inertia = 10 ** rng.uniform(-moments, moments, 3)
    system = ChaplyginBall(tuple(inertia.tolist()), float(10 ** rng.uniform(-weights, weights)))
    gamma, M = rng.normal(size=3), rng.normal(size=3)
    gamma /= np.linalg.norm(gamma)
    tilted = bool(rng.random() < 0.25)
    return system, gamma.tolist(), (M if tilted else M - gamma * (gamma @ M)).tolist(), tilted


@pytest.mark.thinned(2)
@pytest.mark.parametrize("seed", range(10))
def test_moments_and_d_of_any_scales_keep_all_digits(seed) -> None:
    rng = np.random.default_rng(seed)
    system, gamma, M, tilted = random_motion(rng, 4, 4)
    flow = system.flow(system.state(gamma, M, tilted=tilted), kernel="compiled")
    times = rng.uniform(-30, 30, 2) * flow.setup.step_time
    torus = TorusFlow(flow.setup, CompiledLoops())
    rows, _ = torus.at(times)
    rows[:, 3:] /= np.linalg.norm(M)
    assert np.abs(rows - exact_motion(system, gamma, M, tilted, times)).max() < 5e-15
    # forwards and back from another start, to the accuracy of that start in floats
    (far,), _ = torus.at(np.array([1e5 * times[0]]))
    start = system.state(far[:3].tolist(), far[3:].tolist(), tilted=tilted)
    back = system.flow(start, kernel="compiled").at([-1e5 * times[0]])
    assert back.gamma[0] == pytest.approx(np.array(gamma), abs=1e-8)


HEAVY = {
    "one large moment": ((1, 1.7, 2e4), 3e3),
    "one small moment": ((1e4, 1.7e4, 1), 3e4),
    "three scales": ((1e-4, 1e2, 1e4), 1e6),
}


@pytest.mark.parametrize("name", HEAVY)
def test_series_are_short_where_some_branch_points_are_close(name) -> None:
    inertia, d = HEAVY[name]
    torus = TorusFlow(flow_of(inertia, d).setup, CompiledLoops())
    _, rows, columns = torus.torus[0][0].sizes
    assert rows * columns < 200
    assert torus.closure < 1e-27


@pytest.mark.parametrize("seed", range(6))
def test_moments_of_the_largest_ratio_are_answered_or_refused(seed) -> None:
    rng = np.random.default_rng(seed)
    inertia = rng.permutation([1e-5, 10 ** rng.uniform(-5, 5), 0.99e5])
    system = ChaplyginBall(tuple(inertia.tolist()), float(10 ** rng.uniform(-6, 8)))
    _, gamma, M, tilted = random_motion(rng, 4, 4)
    flow = system.flow(system.state(gamma, M, tilted=tilted))
    times = rng.uniform(-10, 10, 2) * flow.setup.step_time
    run = flow.at(times)
    exact = exact_motion(system, gamma, M, tilted, times)
    found = np.hstack([run.gamma, run.M / np.linalg.norm(M)])
    assert np.abs(found - exact).max() < 2e-13
    flow_of((1, 2, 3), 0.7).at(np.linspace(0, 1e3, 600))
    with suppress(PrecisionLoss):
        again = system.flow(system.state(gamma, M, tilted=tilted)).at([*times, *rng.uniform(-1e5, 1e5, 20)])
        assert np.abs(again.gamma[:2] - exact[:, :3]).max() < 2e-13


def test_branch_points_within_a_ten_millionth_and_a_ten_billionth_have_a_torus() -> None:
    """1/d and two a_i are within 2e-7 of each other, two of them within 1e-10: far times used to be refused."""

    def flow_from(d, gamma, M):
        system, gamma = ChaplyginBall((9.8e4, 1e-5, 0.021), d), np.array(gamma) / np.linalg.norm(gamma)
        return system.flow(system.state(gamma.tolist(), (M - gamma * (gamma @ M)).tolist()))

    flow = flow_from(160_000, (0.469, 0.717, 0.551), np.array([-0.457, -1.695, -0.799]))
    assert flow.at([10.0, 1e9, -1e5]).way == "torus"
    tau = np.array([1.0, -1e5, 1e9])
    truth = np.array(precise_of(flow).at_tau(tau), dtype=float)
    assert np.abs(torus_of(flow).at_tau(tau) - truth).max() < 1e-15
    # a clock of many digits has no bound of its own
    flow = flow_from(890, (-0.304, 0.947, 0.107), np.array([-0.609, -0.138, -0.507]))
    with pytest.raises(PrecisionLoss, match=r"floats take 100"):
        PreciseFlow(flow.system.body, flow.state, 17, limits=ClockLimits(100)).at([1000.0])
    tau, _ = PreciseFlow(flow.system.body, flow.state, 17).at([10.0])
    assert float(tau[0]) == pytest.approx(flow.at([10.0]).tau[0], rel=1e-14)


def test_the_torus_of_a_very_heavy_ball_is_that_of_more_digits() -> None:
    """1/d is within 2e-6 of two a_i: far times used to be refused, and near ones needed multiprecision."""
    system, gamma = ChaplyginBall((9.8e4, 1e-5, 0.21), 160_000), np.array((0.469, 0.717, 0.551))
    gamma, M = gamma / np.linalg.norm(gamma), np.array([-0.457, -1.695, -0.799])
    flow = system.flow(system.state(gamma.tolist(), (M - gamma * (gamma @ M)).tolist()))
    assert len(flow.at([1e9, -1e5]).gamma) == 2
    assert torus_of(flow) is not None
    assert torus_of(flow).compiled
    tau = np.array([1.0, 1e6, -1e9, 3e12])
    assert np.abs(torus_of(flow).at_tau(tau) - precise_of(flow).at_tau(tau)).max() < 1e-15
    times = np.array([10.0, 1000.0])
    assert np.abs(torus_of(flow).at(times)[0] - precise_of(flow).at(times)[0]).max() < 1e-15


def test_the_command_says_it_in_one_line(tmp_path, capsys) -> None:
    scene = tmp_path / "heavy.toml"
    scene.write_text(
        'title = "heavy"\nsystem = "chaplygin_ball"\n[body]\ninertia = ["1", "2", "3"]\nd = "1e17"\n'
        '[start]\ngamma = ["0.48", "0.6", "0.64"]\nM = ["0.384", "1.28", "-1.488"]\n[run]\ntimes = [0, 10]\n',
        encoding="utf-8",
    )
    assert main(["run", str(scene), "--out", str(tmp_path / "out")]) != 0
    output = capsys.readouterr().err
    assert "d = 1e+17 with inertia" in output
    assert "Traceback" not in output


def test_nearly_equal_moments_of_a_rotation_have_a_basis() -> None:
    """In floats, the translations of all centres are parallel there: the search used to divide by zero."""
    top = EulerTop((0.0057145586283730175, 0.005711781037631545, 0.005711781068494241))
    gamma = (0.8576226493448597, 0.5142794875655687, 0.0)
    momentum = (3.0759214329919927e-13, -3.725592069384504e-13, 10.618810453629719)
    times = [-1.0851903957073762e-05, 0.0012159009622757385, -0.01953864377087347]
    run = top.flow(top.state(gamma, momentum, tilted=True)).at(times)
    K = MP(40)
    start = State(tuple(map(K.coerce, gamma)), tuple(map(K.coerce, momentum)))
    size = K.sqrt(K.dot(start.gamma, start.gamma))
    start = State(tuple(x / size for x in start.gamma), start.M)
    right = reference.taylor(top.body, start, times, digits=20)
    assert np.abs(run.gamma - right.gamma.astype(float)).max() < 3e-14
    assert np.abs(run.M - right.M.astype(float)).max() < 3e-14 * momentum[2]
