"""Bodies in the laboratory compared with Newton's and Euler's equations in the axes of their tensors."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from integrable import RigidBody, RollingBall
from jacobian import MP
from jacobian.errors import ArgumentError, NotRepresentable
from tests.integrable.laboratory.newton_euler import integrated

MASS, RADIUS = 1.3, 0.5
UP = np.eye(3)


def rotation(rng: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.linalg.det(q)


def tensor(moments: tuple[float, ...], axes: np.ndarray) -> np.ndarray:
    J = axes @ np.diag(moments) @ axes.T
    return (J + J.T) / 2


def tensors(rng: np.random.Generator, count: int) -> np.ndarray:
    """The tensors of six masses each inside a ball of RADIUS, with the total mass MASS."""
    found = []
    for _ in range(count):
        points = rng.normal(size=(6, 3))
        points *= 0.9 * RADIUS / np.linalg.norm(points, axis=1).max()
        masses = rng.uniform(0.1, 1, 6)
        masses *= MASS / masses.sum()
        J = sum(m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, points, strict=True))
        found.append((J + J.T) / 2)
    return np.array(found)


def beside(J, R, omega, time, ball=True, steps=20):
    """The largest differences of R, ω (relative to its size) and the contact at ``time``, and the methods used."""
    count = len(J)
    d = np.full(count, np.longdouble(MASS) * np.longdouble(RADIUS) ** 2 * ball)
    truth = integrated(*(x.astype(np.longdouble) for x in (J, d, R, omega, np.full(count, RADIUS))), time, steps)
    worst, ways = np.zeros(3), []
    for k in range(count):
        if ball:
            motion = RollingBall(J[k], MASS, RADIUS).motion(R[k], omega[k], (0.3, -0.2))
        else:
            motion = RigidBody(J[k]).motion(R[k], omega[k])
        run = motion.at([time, 0])
        gap = [abs(run.matrices[0] - truth[0][k]).max(), abs(run.omega[0] - truth[1][k]).max(), 0]
        gap[1] /= abs(omega[k]).max() + 1e-300
        if ball:
            gap[2] = abs(run.contact[0] - (truth[2][k] + [0.3, -0.2])).max()
            assert np.array_equal(run.contact[1], [0.3, -0.2])
        assert abs(run.matrices[1] - R[k]).max() < 1e-14
        worst = np.maximum(worst, np.array(gap, dtype=float))
        ways.append(type(motion._way).__name__)
    return worst.max(), ways


@pytest.mark.parametrize("ball", [True, False])
def test_random_bodies(ball):
    rng = np.random.default_rng(15)
    J = tensors(rng, 10)
    R = np.array([rotation(rng) for _ in J])
    gap, _ = beside(J, R, 3 * rng.normal(size=(10, 3)), 1.0, ball)
    assert gap < 1e-13


@pytest.mark.slow
@pytest.mark.parametrize("ball", [True, False])
def test_eighty_random_bodies(ball):
    rng = np.random.default_rng(150)
    J = tensors(rng, 80)
    R = np.array([rotation(rng) for _ in J])
    gap, _ = beside(J, R, 3 * rng.normal(size=(80, 3)), 3.0, ball, 100)
    assert gap < 1e-12


def lean(J, R, spin):
    """ω in the laboratory for which M about the point of contact is ``spin``."""
    return np.linalg.solve(R @ J @ R.T + MASS * RADIUS**2 * np.diag([1, 1, 0]), spin)


@pytest.mark.parametrize("ball", [True, False])
def test_special_bodies_and_motions(ball):
    rng = np.random.default_rng(4)
    R, Q = rotation(rng), rotation(rng)
    w = np.array([1.0, -2.0, 0.5])
    cases = [
        (tensor((0.1, 0.12, 0.15), UP), R, w, "Along"),
        (tensor((0.1, 0.1, 0.15), UP), R, w, "Along"),
        (tensor((0.1, 0.1, 0.15), Q), R, w, "Along"),
        (tensor((0.1, 0.15, 0.15), Q), R, w, "Along"),
        (tensor((0.1, 0.12, 0.22), Q), R, w, "Along"),
        (tensor((0.1, 0.1, 0.1), Q), R, w, "Uniform"),
        (tensor((0.1, 0.12, 0.15), Q), R, 0 * w, "Uniform"),
        (tensor((0.1, 0.12, 0.15), UP), UP, np.array([0, 2.0, 0]), "Uniform"),
        (tensor((0.1, 0.12, 0.15), UP), R, 2 * R[:, 1], "Along"),
        (tensor((0.1, 0.12, 0.15), UP), UP, np.array([0, 0, 3.0]), "Uniform"),
    ]
    J, R, omega, ways = (list(column) for column in zip(*cases, strict=True))
    gap, found = beside(np.array(J), np.array(R), np.array(omega), 1.0, ball)
    assert gap < 1e-13
    assert found == ways


def test_a_vertical_momentum_and_nearly_vertical_ones():
    rng = np.random.default_rng(5)
    R, Q = rotation(rng), rotation(rng)
    J = tensor((0.1, 0.12, 0.15), Q)
    symmetric = tensor((0.1, 0.1, 0.15), Q)
    cases = [(J, lean(J, R, [0, 0, sign * 0.7])) for sign in (1, -1)]
    cases += [(symmetric, lean(symmetric, R, [0, 0, 0.7])), (J, lean(J, R, [0.03, 0, 0.7]))]
    J, omega = (np.array(column) for column in zip(*cases, strict=True))
    gap, found = beside(J, np.array([R] * 4), omega, 1.0)
    assert gap < 1e-13
    assert found == ["Vertical"] * 3 + ["Along"]


def test_the_path_of_a_vertical_momentum_after_many_periods():
    """Compared with Simpson's rule along the path, over some periods forwards and backwards."""
    rng = np.random.default_rng(6)
    R = rotation(rng)
    J = tensor((0.05, 0.12, 0.15), rotation(rng))
    motion = RollingBall(J, MASS, RADIUS).motion(R, lean(J, R, [0, 0, 5.0]))
    assert type(motion._way).__name__ == "Vertical"
    end = 3.3 / float(motion._way._rates[0])
    for sign in (1, -1):
        times = np.linspace(0, sign * end, 20001)
        velocity = motion._way._velocity(times)
        weights = np.array([1, *[4, 2] * 9999, 4, 1]) * sign * end / 60000
        assert abs(motion.at([sign * end]).contact[0] - weights @ velocity).max() < 1e-10


@pytest.mark.slow
def test_so_nearly_vertical_that_floats_have_no_digits_left():
    rng = np.random.default_rng(7)
    R = rotation(rng)
    J = tensor((0.1, 0.12, 0.15), rotation(rng))
    omega = np.array([lean(J, R, [0.7 * gap, 0, 0.7]) for gap in (1e-4, 1e-8, 1e-12)])
    gap, _ = beside(np.array([J] * 3), np.array([R] * 3), omega, 1.0)
    assert gap < 1e-13


def off_in_digits(ball, seed):
    """The largest difference of R, ω and the contact of a random body over MP(30) after 0.2 s."""
    K = MP(30)
    mpf = np.frompyfunc(K.coerce, 1, 1)
    rng = np.random.default_rng(seed)
    J, R, omega = tensors(rng, 1)[0], orthogonal(K, rotation(rng)), 3 * rng.normal(size=3)
    body = RollingBall(J, "1.3", "0.5", field=K) if ball else RigidBody(J, field=K)
    motion = body.motion(R, omega, ("0.3", "-0.2")) if ball else body.motion(R, omega)
    time = K.coerce("0.2")
    run = motion.at([time])
    d = mpf(np.array(["1.3"], dtype=object)) * K.coerce("0.25") * ball
    truth = integrated(mpf(J)[None], d, R[None], mpf(omega)[None], mpf(np.array([0.5])), time, 8, columns=11)
    gaps = [abs(run.matrices - truth[0]).max(), abs(run.omega - truth[1]).max()]
    if ball:
        gaps.append(abs(run.contact[0] - truth[2][0] - mpf(np.array(["0.3", "-0.2"], dtype=object))).max())
    return max(gaps)


@pytest.mark.parametrize("ball", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_many_digits(ball):
    assert off_in_digits(ball, 8) < 1e-24


@pytest.mark.slow
@pytest.mark.parametrize("ball", [True, False])
def test_many_digits_of_other_bodies(ball):
    """A few bodies; ``python -m benchmarks laboratory`` takes 200 of each kind."""
    assert max(off_in_digits(ball, seed) for seed in (81, 82, 83)) < 1e-24


def orthogonal(K, table):
    """The rotation to all digits of K near one in floats, as an array of mpf (Björck and Bowie 1971)."""
    table = np.frompyfunc(K.coerce, 1, 1)(table)
    for _ in range(3):
        table = (table + inverse(table).T) / 2
    return table


def inverse(table):
    columns = [np.cross(table[(i + 1) % 3], table[(i + 2) % 3]) for i in range(3)]
    return np.stack(columns, axis=1) / (table[0] @ columns[0])


def test_rotations_of_scipy_in_and_out():
    rotations = pytest.importorskip("scipy.spatial.transform")
    start = rotations.Rotation.from_rotvec([0.3, -0.2, 0.9])
    motion = RigidBody((1, 2, 3)).motion(start, (0.1, 0.2, 0.3))
    run = motion.at([0, 5.0])
    assert (run.orientation[0] * start.inv()).magnitude() < 1e-15
    assert np.allclose(run.orientation[1].as_quat(scalar_first=True) @ run.quaternion[1], 1, atol=1e-15) or np.allclose(
        run.orientation[1].as_quat(scalar_first=True) @ run.quaternion[1], -1, atol=1e-15
    )
    assert np.allclose(run.omega_body, np.einsum("nji,nj->ni", run.matrices, run.omega), atol=1e-15)


def test_quaternions_go_on_without_a_jump():
    motion = RigidBody((1, 2, 3)).motion(UP, (1.0, 0.2, 0.3))
    q = motion.at(np.linspace(0, 40, 400)).quaternion
    assert np.sum(q[1:] * q[:-1], axis=1).min() > 0.9
    assert q[0, 0] == 1


def test_what_a_run_has():
    ball = RollingBall((0.1, 0.12, 0.15), mass=2, radius=0.5)
    run = ball.motion(UP, (1.0, 0.2, 0.3), (1, 2)).at([0, 1, 2])
    assert run.centre.shape == (3, 3)
    assert run.centre[:, 2].tolist() == [0.5] * 3
    with pytest.raises(ValueError, match="read-only"):
        run.contact[0, 0] = 1.0
    free = RigidBody((1, 2, 3)).motion(UP, (1.0, 0.2, 0.3)).at([1])
    with pytest.raises(NotRepresentable, match="does not roll"):
        _ = free.contact
    with pytest.raises(NotRepresentable, match="ω is constant"):
        _ = RigidBody((1, 1, 1)).motion(UP, (1.0, 0.2, 0.3)).portrait


def test_momentum_stays_where_it_is_at_any_epoch():
    body = RigidBody(tensor((1, 2, 3), rotation(np.random.default_rng(2))))
    run = body.motion(UP, (0.384, 0.64, -0.496)).at([0, 1e3, 1e9])
    momentum = np.einsum(
        "nij,jk,nk->ni", run.matrices, np.array(tensor((1, 2, 3), rotation(np.random.default_rng(2)))), run.omega_body
    )
    assert abs(momentum - momentum[0]).max() < 5e-15


def test_phases_do_not_keep_the_rounding_of_the_momentum():
    """Compared with the same floats at 30 digits: M = Iω is not rounded, so all digits are right after 10⁹ s."""
    start = (0.384, 0.64, -0.496)
    exact = RigidBody((1, 2, 3), field=MP(30)).motion(UP, start).at([1e9])
    assert abs(RigidBody((1, 2, 3)).motion(UP, start).at([1e9]).omega_body - exact.omega_body).max() < 1e-15


class Unmade:
    """Stands for a class like SciPy's Rotation that is given instead of an instance."""

    def as_matrix(self):
        return UP


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: RigidBody([[1, 0.1, 0], [0.2, 2, 0], [0, 0, 2]]),
            r"inertia\[0\]\[1\] = 0.1 and inertia\[1\]\[0\] = 0.2",
        ),
        (lambda: RigidBody((1, 2, -1)), "principal moment -1.0: a moment of inertia is positive"),
        (lambda: RigidBody((1, 2)), "give three moments or a 3×3 tensor"),
        (lambda: RigidBody([[1, 0], [0, 1]]), "give three moments or a 3×3 tensor"),
        (lambda: RigidBody("abc"), "inertia"),
        (lambda: RigidBody(1 / x for x in (1, 2, 0)), "inertia = .*: give three moments"),
        (lambda: RigidBody((1, 2, float("nan"))), r"inertia\[2\] = nan is not finite"),
        (lambda: RollingBall((1, 1, 1), 0, 1), "mass = 0 is not positive"),
        (lambda: RollingBall((1, 1, 1), 1, -1), "radius = -1 is not positive"),
        (lambda: RigidBody((1, 2, 3)).motion(2 * UP, (1, 2, 3)), "R Rᵀ differs from 1 by 3.0e"),
        (lambda: RigidBody((1, 2, 3)).motion(-UP, (1, 2, 3)), "determinant −1"),
        (lambda: RigidBody((1, 2, 3)).motion([1, 2, 3], (1, 2, 3)), "orientation = .*give one rotation"),
        (lambda: RigidBody((1, 2, 3)).motion(Unmade, (1, 2, 3)), "orientation = .*Unmade.*give one rotation"),
        (lambda: RigidBody((1, 2, 3)).motion(UP, (1, 2)), "omega = .* a sequence of three numbers is needed"),
        (
            lambda: RollingBall((1, 1, 1), 9, 1).motion(UP, (1, 2, 3), (1,)),
            "contact = .*: a sequence of two numbers",
        ),
        (lambda: RigidBody((1, 2, 3)).motion(UP, (1, 2, 3)).at(["x"]), r"times\[0\]"),
        (lambda: RigidBody((1, 2, 3), field=object()), "field"),
    ],
)
def test_bad_input_is_named_in_one_line(call, message):
    with pytest.raises(ArgumentError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_mass_outside_the_ball_is_said():
    with pytest.warns(UserWarning, match="some of the mass is outside the ball"):
        RollingBall((1, 1, 1), 1, 1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # a shell
        RollingBall((2 / 3, 2 / 3, 2 / 3), 1, 1)
