"""The orientation of the body: a rotation, fixed axes in space, Ṙ = R [ω]×, and quaternions of the same rotation."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from integrable import ChaplyginBall, EulerTop
from integrable.phase.attitude import quaternions
from jacobian import MP

BALL = ChaplyginBall(inertia=(1, 2, 3), d=0.5)
TOP = EulerTop(inertia=(1, 2, 3))
GAMMA, M, LEANING = (0.6, 0.0, 0.8), (0.8, 1.0, -0.6), (0.9, 1.0, 0.3)
MOTIONS = {
    "ball": (BALL, M, False),
    "tilted ball": (BALL, LEANING, True),
    "top": (TOP, M, False),
    "tilted top": (TOP, LEANING, True),
}


@pytest.fixture(params=MOTIONS, scope="module")
def flow(request):
    system, momentum, tilted = MOTIONS[request.param]
    return system.flow(system.state(GAMMA, momentum, tilted=tilted))


def test_rotations_that_hold_gamma_and_the_momentum_still(flow):
    run = flow.at(np.linspace(-5, 20, 41))
    R = run.attitude
    assert R.shape == (41, 3, 3)
    assert np.allclose(R @ R.transpose(0, 2, 1), np.eye(3), atol=1e-13)
    assert np.allclose(np.linalg.det(R), 1, atol=1e-13)
    assert np.allclose(np.einsum("nij,nj->ni", R, run.gamma), [0, 0, 1], atol=1e-13)
    momentum = np.einsum("nij,nj->ni", R, run.M)
    assert np.allclose(momentum, momentum[0], atol=1e-12)
    assert abs(momentum[0, 1]) < 1e-13 < momentum[0, 0]


def test_the_rotation_turns_with_the_angular_velocity(flow):
    h, t = 1e-3, np.linspace(0, 10, 21)
    before, now, after = flow.at(t - h).attitude, flow.at(t), flow.at(t + h).attitude
    w1, w2, w3 = now.omega.T
    zero = 0 * w1
    turning = np.array([[zero, -w3, w2], [w3, zero, -w1], [-w2, w1, zero]]).transpose(2, 0, 1)
    assert np.allclose((after - before) / (2 * h), now.attitude @ turning, atol=5e-6)


def test_quaternions_of_the_same_rotations(flow):
    run = flow.at(np.linspace(0, 20, 201))
    q = run.quaternion
    assert np.allclose(np.sum(q * q, axis=1), 1, atol=1e-14)
    assert (q[:, 0] >= 0).all()
    assert np.allclose(Rotation.from_quat(q[:, [1, 2, 3, 0]]).as_matrix(), run.attitude, atol=1e-13)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0, -0.8), (1e-9, 1, 0)])
@pytest.mark.parametrize("angle", [0, 1e-9, 1.0, np.pi - 1e-9, np.pi])
def test_quaternions_at_half_turns(axis, angle):
    wanted = Rotation.from_rotvec(np.array(axis) / np.linalg.norm(axis) * angle)
    q = quaternions(wanted.as_matrix()[None])
    assert (Rotation.from_quat(q[0, [1, 2, 3, 0]]).inv() * wanted).magnitude() < 1e-15


def test_a_rotation_where_the_momentum_is_almost_vertical():
    """Found by fuzz: x had a component of 3e-13 along γ where the horizontal part of M was 4e-4 of it."""
    ball = ChaplyginBall((42.275297297021154, 59.00030949561692, 94.55369296661846), 7.106769750752151e-05)
    M = (-1.3291845487028283e-06, 1.692269492780872e-07, 0.003051815342714443)
    run = ball.flow(ball.state((0.0, 0.0, 1.0), M, tilted=True)).at([-386.68632197844244, 7448.0665147098825, 617.4])
    assert abs(run.attitude @ run.attitude.transpose(0, 2, 1) - np.eye(3)).max() < 1e-15
    assert abs(Rotation.from_quat(run.quaternion[:, [1, 2, 3, 0]]).as_matrix() - run.attitude).max() < 1e-15


def test_multiprecision_attitude():
    K = MP(40)
    ball = ChaplyginBall(inertia=(1, 2, 3), d="0.5", field=K)
    run = ball.flow(ball.state(("0.6", 0, "0.8"), ("0.8", 1, "-0.6"))).at([0, "2.5"])
    R, q = run.attitude[1], run.quaternion[1]
    assert R.dtype == object
    assert max(abs(x) for x in (R @ R.T - np.eye(3, dtype=int)).ravel()) < 1e-38
    w, x, y, z = q
    assert abs(R[0, 0] - (1 - 2 * (y * y + z * z))) < 1e-38
    assert abs(R[2, 1] - 2 * (y * z + w * x)) < 1e-38
