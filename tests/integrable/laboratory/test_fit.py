"""Bodies and starts recovered from orientations."""

from __future__ import annotations

import numpy as np
import pytest

from integrable import RigidBody, RollingBall
from integrable.laboratory.fit import _Problem
from jacobian.errors import ArgumentError

pytest.importorskip("scipy")
from scipy.spatial.transform import Rotation

TRUE = RigidBody((1.0, 1.7, 2.3))
START, OMEGA = Rotation.from_rotvec([0.3, -0.2, 0.9]), (0.9, 0.7, -0.5)
TIMES = np.linspace(0.5, 20, 40)


def guess():
    return RigidBody((1.03, 1.66, 2.3)).motion(Rotation.from_rotvec([0.32, -0.17, 0.88]), (0.91, 0.69, -0.51))


@pytest.mark.slow
def test_exact_orientations_give_the_body_back():
    found = guess().fitted(TIMES, TRUE.motion(START, OMEGA).at(TIMES).orientation)
    assert np.allclose(found.ratios, np.array([1.0, 1.7]) / 2.3, rtol=1e-12)
    assert np.allclose(found.omega, OMEGA, rtol=1e-12)
    assert found.rms < 1e-13


@pytest.mark.slow
def test_noise_leaves_what_the_covariance_says():
    rng = np.random.default_rng(1)
    noise = 1e-3
    exact = TRUE.motion(START, OMEGA).at(TIMES)
    measured = Rotation.from_rotvec(noise * rng.normal(size=(len(TIMES), 3))) * exact.orientation
    found = guess().fitted(TIMES, measured)
    assert found.rms == pytest.approx(noise * np.sqrt(3), rel=0.2)
    gap = np.log(found.ratios * 2.3 / np.array([1.0, 1.7]))
    spread = np.sqrt(np.diag(found.covariance))
    assert (abs(gap) < 4 * spread[6:]).all()
    assert (spread[6:] < 1e-3).all()


def test_a_tensor_keeps_its_axes():
    axes = Rotation.from_rotvec([0.4, 0.1, -0.7]).as_matrix()
    body = RigidBody(axes @ np.diag([1.0, 1.7, 2.3]) @ axes.T)
    near = RigidBody(axes @ np.diag([1.02, 1.68, 2.3]) @ axes.T)
    run = body.motion(START, OMEGA).at(TIMES)
    found = near.motion(START, OMEGA).fitted(TIMES, run.matrices)
    again = found.motion.at(TIMES)
    assert abs(again.matrices - run.matrices).max() < 1e-11
    ratios = np.array(body.moments) / body.moments[2]
    assert np.allclose(found.ratios, ratios[:2], rtol=1e-11)


def test_derivatives_beside_differences():
    motion = guess()
    problem = _Problem(motion, TIMES, motion.at(TIMES).matrices)
    at, step = np.zeros(8), 1e-5
    slopes = problem.slopes(at)
    for k in range(8):
        ahead, behind = (problem.residuals(at + s * np.eye(8)[k]) for s in (step, -step))
        assert np.allclose(slopes[:, k], (ahead - behind) / (2 * step), rtol=0, atol=1e-6)


def test_what_cannot_be_fitted():
    run = TRUE.motion(START, OMEGA).at(TIMES)
    ball = RollingBall((1, 1.7, 2.3), 9, 1).motion(START, OMEGA)
    with pytest.raises(ArgumentError, match="free body"):
        ball.fitted(TIMES, run.matrices)
    with pytest.raises(ArgumentError, match="a rotation for each of 40 times"):
        guess().fitted(TIMES, run.matrices[1:])
    with pytest.raises(ArgumentError, match="3 times or more"):
        guess().fitted([0, 1], run.matrices[:2])
    wrong = run.matrices.copy()
    for size, number in ((2, 7), (-1, 4), (np.nan, 0)):
        wrong[number] = size * run.matrices[number]
        with pytest.raises(ArgumentError, match=rf"^orientations\[{number}\] = .* is no rotation"):
            guess().fitted(TIMES, wrong)
    for times, orientations, message in (
        (TIMES, "x", "^orientations = 'x': give 3×3 matrices"),
        (TIMES, 10**400, "^orientations = an int of 1329 bits: give 3×3 matrices"),
        ([0, np.nan, 2], run.matrices[:3], r"^times\[1\] = .*nan"),
        ([1j, 1, 2], run.matrices[:3], r"^times\[0\] = 1j"),
        ("abc", run.matrices[:3], r"^times\[0\] = 'abc'"),
        ([1, 1, 1], run.matrices[:3], "^orientations: no body fits them best"),
    ):
        with pytest.raises(ArgumentError, match=message):
            guess().fitted(times, orientations)
    with pytest.raises(ArgumentError, match="ω is constant"):
        TRUE.motion(START, START.as_matrix()[:, 0]).fitted(TIMES, run.matrices)
