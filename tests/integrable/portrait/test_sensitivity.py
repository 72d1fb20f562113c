"""Derivatives of states compared with the variational equations, and identities that hold for them at any time."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from jacobian import MP
from jacobian.errors import NotRepresentable
from tests.integrable.portrait.variational import sensitivities

LONG = np.longdouble


def beside(I, d, gamma, M, time, steps, columns=9):  # noqa: E741
    """The largest relative differences of derivatives at ``time``, of many balls, and their sizes."""
    I, d, gamma, M = (np.array(x, dtype=LONG) for x in (I, d, gamma, M))  # noqa: E741
    gamma = gamma / np.sqrt(np.sum(gamma**2, axis=1))[:, None]
    gamma = gamma.astype(float).astype(LONG)
    _, truth = sensitivities(I, d, gamma, M, LONG(time), steps, columns)
    gaps, sizes, ways = [], [], []
    for k in range(len(I)):
        ball = ChaplyginBall(I[k].astype(float), float(d[k])) if d[k] else EulerTop(I[k].astype(float))
        flow = ball.flow(ball.state(gamma[k].astype(float), M[k].astype(float), tilted=True))
        found = flow.sensitivity([time])
        sizes.append(float(abs(truth[k]).max()))
        gaps.append(float(abs(found.matrix[0] - truth[k]).max()) / sizes[-1])
        ways.append(found.way)
    return np.array(gaps), np.array(sizes), ways


def test_beside_the_equations_of_variation():
    bodies, M = [(2, 3.1, 4.2), (1, 2, 3.5)], [(3, 2, -4), (0.4, 1.2, 0.3)]
    gaps, _, ways = beside(bodies, (9.72, 0), [(0.48, 0.6, 0.64)] * 2, M, 5.0, 20)
    assert gaps.max() < 1e-13
    assert ways == ["torus"] * 2


@pytest.mark.slow
def test_fifty_bodies():
    rng = np.random.default_rng(51)
    I = np.sort(rng.uniform(1, 3, (50, 3)), axis=1)  # noqa: E741
    gamma = rng.normal(size=(50, 3))
    gaps, _, ways = beside(I, rng.uniform(0.2, 3, 50), gamma, 2 * rng.normal(size=(50, 3)), 10.0, 50)
    assert ways.count("torus") >= 35
    assert np.median(gaps) < 1e-13
    assert gaps.max() < 2e-12


@pytest.mark.slow
@pytest.mark.parametrize("near", [1e-1, 1e-3, 1e-5])
def test_beside_the_separatrix(near):
    """On the torus, large integrals nearly cancel near the separatrix; this loss is detected."""
    gaps, sizes, ways = beside([(1, 2, 3)], (0.7,), [(0.6, 0, 0.8)], [(0, 2, 0.3 * near)], 15.0, 80)
    assert sizes[0] > 100
    assert gaps[0] < 2e-12
    assert ways == ["torus" if near == 1e-1 else "differences"]


@pytest.mark.parametrize("ball", [ChaplyginBall((1, 2, 3), 0.7), EulerTop((1, 2, 3.5))])
def test_what_holds_at_any_time(ball):
    """S carries ẋ(0) to ẋ(t); scaling the moments with the momentum leaves γ unchanged, scaling the momentum rescales
    time.
    """
    gamma, M = np.array((0.48, 0.6, 0.64)), np.array((0.4, 1.2, 0.3))
    flow = ball.flow(ball.state(gamma, M, tilted=True))
    times = np.array([10.0, 1e3, 1e6])
    run, found = flow.at(times), flow.sensitivity(times)
    size = abs(found.matrix).max(axis=(1, 2))

    def rates(gamma, M, omega):
        return np.concatenate([np.cross(gamma, omega), np.cross(M, omega)], axis=-1)

    moved = rates(run.gamma, run.M, run.omega)
    start = rates(gamma, M, flow.at([0]).omega[0])
    assert (abs(found.matrix[:, :, :6] @ start - moved).max(axis=1) / size).max() < 1e-13
    heavier = np.concatenate([np.zeros(3), M, ball.inertia, [ball.d]])
    scaled = np.hstack([0 * run.gamma, run.M])
    assert (abs(found.matrix @ heavier - scaled).max(axis=1) / size).max() < 1e-13
    faster = np.concatenate([np.zeros(3), M, np.zeros(4)])
    assert (abs(found.matrix @ faster - scaled - times[:, None] * moved).max(axis=1) / size).max() < 1e-13


def test_the_secular_part_is_what_grows():
    ball = ChaplyginBall((1, 2, 3), 0.7)
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.4, 1.2, 0.3), tilted=True))
    found = flow.sensitivity(np.concatenate([np.linspace(0, 100, 50), np.linspace(1e5, 1e5 + 100, 50)]))
    assert abs(found.matrix[50:]).max() > 1e4
    assert abs(found.periodic[50:]).max() < 1.5 * abs(found.periodic[:50]).max()
    assert np.linalg.matrix_rank(found.secular[70] / 1e5, tol=1e-9) == 2


@pytest.mark.slow
def test_many_digits_at_any_time():
    K = MP(20)
    top, exact = EulerTop((1, 2, 3.5)), EulerTop((1, 2, "3.5"), field=K)
    gamma, M = (0.0, 0.6, 0.8), (0.5, 1.25, 0.25)
    exact_gamma = ("0", "0.6", "0.8")
    times = [1.0, 1e6]
    found = top.flow(top.state(gamma, M, tilted=True)).sensitivity(times)
    more = exact.flow(exact.state(exact_gamma, M, tilted=True)).sensitivity(times)
    assert more.way == "differences"
    size = abs(found.matrix).max(axis=(1, 2))[:, None, None]
    # the rounding of γ, 1e-17, times the second derivatives
    assert (abs(found.matrix - more.matrix.astype(float)) / size).max() < 1e-9
    assert (abs(found.matrix - more.matrix.astype(float)) / size)[0].max() < 1e-14
    assert (abs(found.secular - more.secular.astype(float)) / size)[0].max() < 1e-13
    # a start that meets the constraints to the digits of the field
    omega = exact.flow(exact.state(exact_gamma, M, tilted=True)).at(times)
    moved = np.hstack([np.cross(omega.gamma, omega.omega), np.cross(omega.M, omega.omega)])
    start = exact.flow(exact.state(exact_gamma, M, tilted=True)).at([0])
    begun = np.hstack([np.cross(start.gamma, start.omega), np.cross(start.M, start.omega)])[0]
    assert float((abs(more.matrix[:, :, :6] @ begun - moved).max(axis=1) / size[:, 0, 0]).max()) < 1e-18


@pytest.mark.slow
def test_the_parts_of_a_ball_in_many_digits():
    """For a ball, σ is computed there from the modes of 1/g, which come from a grid in floats."""
    gamma, M = (0.0, 0.6, 0.8), (0.5, 1.25, 0.25)
    ball, exact = ChaplyginBall((1, 2, 3), 0.75), ChaplyginBall((1, 2, 3), "0.75", field=MP(18))
    found = ball.flow(ball.state(gamma, M, tilted=True)).sensitivity([1e3])
    more = exact.flow(exact.state(("0", "0.6", "0.8"), M, tilted=True)).sensitivity([1e3])
    assert (found.way, more.way) == ("torus", "differences")
    size = abs(found.matrix).max()
    assert abs(found.matrix - more.matrix.astype(float)).max() < 1e-13 * size
    assert abs(found.secular - more.secular.astype(float)).max() < 1e-13 * size
    assert abs(found.periodic - more.periodic.astype(float)).max() < 1e-13 * size
    assert abs(found.periodic).max() < 5 < 200 < size


@pytest.mark.slow
def test_two_equal_moments_by_differences():
    ball = ChaplyginBall((1, 2, 2), 0.7)
    gaps, _, ways = beside([(1, 2, 2)], (0.7,), [(0.48, 0.6, 0.64)], [(0.4, 1.2, 0.3)], 5.0, 40)
    assert ways == ["differences"]
    assert gaps.max() < 1e-14
    flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.4, 1.2, 0.3), tilted=True))
    with pytest.raises(NotRepresentable, match="motions that lie on no torus"):
        _ = flow.sensitivity([1.0]).secular
