"""Systems that have the same motions with different clocks."""

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.neumann import Neumann
from integrable.classical.veselova import Veselova
from integrable.moving_point.legendre import integral
from integrable.mumford.flow import Point
from integrable.systems.on_layer import BodyOnLayer
from jacobian import MP, QQ


def cross(x, y):
    return [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]


@pytest.mark.parametrize("size", [3, pytest.param(4, marks=pytest.mark.slow)])
def test_normals_of_geodesics_move_as_points_of_neumann(size) -> None:
    """Knörrer 1982: q = A⁻¹x/|A⁻¹x| with dσ = √ν ds is Neumann's motion with the constants 1/a_i."""
    a = np.array([1, 2, 3.5, 5])[:size]
    geodesics, neumann = Ellipsoid(a), Neumann(1 / a)
    x = np.sqrt(a / size)
    v = np.array([0.3, -0.7, 0.4, 0.25])[:size]
    v -= (x / a) @ v / ((x / a) @ (x / a)) * x / a
    start = geodesics.state(x, v / np.sqrt(v @ v))
    flow, length = geodesics.flow(start), 2.0
    joachimsthal = geodesics.integrals(start)["Joachimsthal"]

    def rate(x):
        return np.sqrt(joachimsthal) / ((x / a) @ (x / a))

    def normal(x, v):
        n, moved = x / a, v / a
        size = np.sqrt(n @ n)
        q = n / size
        return q, (moved - q * (q @ moved)) / size / rate(x)

    # σ by Gauss's rule
    nodes, weights = np.polynomial.legendre.leggauss(32)
    path = flow.at([*(length / 2 * (nodes + 1)), length])
    sigma = length / 2 * sum(w * rate(x) for w, x in zip(weights, path.q, strict=False))
    found = neumann.flow(neumann.state(*normal(np.array(start.q), np.array(start.p)))).at(sigma)
    q, p = normal(path.q[-1], path.p[-1])
    assert np.abs(found.q[0] - q).max() < 1e-13
    assert np.abs(found.p[0] - p).max() < 1e-13


def compared(other_clock):
    """Veselova's body at t = 0 and 1, and ∫dt of a function of γ and M between: (body, a, states, integral)."""
    body = Veselova((2, 1, "4/7"), MP(28))
    K = body.field
    flow = body.flow(body.state(("0.48", "0.6", "0.64"), ("0.4", "-1.2", "0.825")))

    def rates(times):
        path = flow.at(times)
        return np.array([[other_clock(K, body, q, p)] for q, p in zip(path.q, path.p, strict=True)])

    path = flow.at([0, 1])
    return body, list(zip(path.q, path.p, strict=True)), integral(K, rates, K.zero, K.one, 1e4)[0]


def turned_by(body, gamma, M):
    """(γ, Aγ), γ' and the a_i."""
    a = np.array(body._constants_in(body.field))
    return gamma @ (a * gamma), np.array(body.vector_field(Point(tuple(gamma), tuple(M))).q), a


def test_veselova_moves_along_geodesics() -> None:
    """Veselov & Veselova 1986: with A = I⁻¹, s = (γ, Aγ) the point Aγ/√s runs along a geodesic of Σx_i²/a_i = 1, its
    length at the rate |M| det A/s^{3/2}.
    """

    def speed(K, body, gamma, M):
        s, _, a = turned_by(body, gamma, M)
        return K.sqrt(M @ M) * a.prod() / (s * K.sqrt(s))

    body, states, length = compared(speed)
    K = body.field

    def on_ellipsoid(gamma, M):
        s, moved, a = turned_by(body, gamma, M)
        x = a * gamma / K.sqrt(s)
        return x, (a * moved / K.sqrt(s) - x * (moved @ (a * gamma)) / s) / speed(K, body, gamma, M)

    system = Ellipsoid(body._constants_in(K), K)
    path = system.flow(system.state(*on_ellipsoid(*states[0]))).at([length])
    for found, expected in zip((path.q[0], path.p[0]), on_ellipsoid(*states[1]), strict=True):
        assert np.abs(found - expected).max() < 1e-22


def test_veselova_moves_as_a_point_of_neumann() -> None:
    """γ in √(H1 det A)·τ, dt = √(γ, Aγ) dτ, is Neumann's point with the moments for constants."""

    def rate(K, body, gamma, M):
        s, _, a = turned_by(body, gamma, M)
        return K.sqrt(body.integrals(Point(tuple(gamma), tuple(M)))["H1"] * a.prod() / s)

    body, states, sigma = compared(rate)
    K = body.field

    def on_sphere(gamma, M):
        return gamma, turned_by(body, gamma, M)[1] / rate(K, body, gamma, M)

    system = Neumann(body.constants, K)
    path = system.flow(system.state(*on_sphere(*states[0]))).at([sigma])
    for found, expected in zip((path.q[0], path.p[0]), on_sphere(*states[1]), strict=True):
        assert np.abs(found - expected).max() < 1e-22


def ball_of(a, d, K):
    """The ball with 1/(I_i + d) = a_i, on the layer: of negative moments, or of negative d."""
    return BodyOnLayer([K.sub(K.inv(K.coerce(x)), K.coerce(d)) for x in a], d, K)


@pytest.mark.parametrize("d", [10**6, 10**9, -(10**6)])
def test_veselova_is_the_limit_of_the_ball_of_large_d(d) -> None:
    """At fixed a_i the equations of motion differ by exactly (γ, AM)Aγ/(s(1 − ds)), and H1 by (γ, AM)²/(s(1 − ds))."""
    a = (QQ.coerce("1/2"), QQ.coerce(1), QQ.coerce("7/4"))
    veselova, ball = Veselova([1 / x for x in a], QQ), ball_of(a, d, QQ)
    gamma, M = map(
        tuple, ([QQ.coerce(x) for x in row] for row in (("12/25", "3/5", "16/25"), ("2/5", "-6/5", "33/40")))
    )
    states = veselova.state(gamma, M), ball.state(gamma, M)
    s = sum(e * x * x for e, x in zip(a, gamma, strict=True))
    along = sum(e * x * m for e, x, m in zip(a, gamma, M, strict=True))
    missing = along / (s * (1 - d * s))
    turned = cross(gamma, [missing * e * x for e, x in zip(a, gamma, strict=True)])
    fields = [system.vector_field(state).q for system, state in zip((veselova, ball), states, strict=True)]
    assert [y - x for x, y in zip(*fields, strict=True)] == turned
    energies = [system.integrals(state)["H1"] for system, state in zip((veselova, ball), states, strict=True)]
    assert energies[1] - energies[0] == missing * along


def test_motions_of_balls_tend_to_that_of_veselova() -> None:
    """The difference is proportional to 1/d; for d < 0 the moments 1/a_i − d are positive."""
    K, a = MP(30), ("1/2", 1, "7/4")
    veselova = Veselova([K.inv(K.coerce(x)) for x in a], K)
    gamma, M = ("12/25", "3/5", "16/25"), ("2/5", "-6/5", "33/40")
    expected = veselova.flow(veselova.state(gamma, M)).at([3])
    gaps = []
    for d in (-(10**7), -(10**8)):
        ball = ball_of(a, d, K)
        found = ball.by_additions(ball.state(gamma, M)).at([3])
        gaps.append(float(np.abs(found.q - expected.q).max()))
    assert gaps[1] < 1e-7
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=1e-5)
