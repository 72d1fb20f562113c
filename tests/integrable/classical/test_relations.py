"""Systems that are each other with another clock."""

import numpy as np
import pytest

from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.neumann import Neumann
from jacobian import MP
from tests.integrable.classical.rows import extrapolated


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


def test_veselova_moves_along_geodesics() -> None:
    """Veselov & Veselova 1986: a body with (γ, ω) = 0, Iω' + ω×Iω = μγ, γ' = γ×ω. With A = I⁻¹, s = (γ, Aγ) the point
    Aγ/√s runs along a geodesic of Σx_i²/a_i = 1, its length at the rate |K| det A/s^{3/2}, K the part of Iω across γ.
    """
    K = MP(36)
    a = [K.coerce(x) for x in ("0.5", 1, "1.75")]

    def rates(z):
        gamma, momentum = z[:3], z[3:6]
        weighted = [e * x for e, x in zip(a, gamma, strict=True)]
        s = K.dot(gamma, weighted)
        nu = -K.dot(weighted, momentum) / s
        omega = [e * (x + nu * y) for e, x, y in zip(a, momentum, gamma, strict=True)]
        speed = K.sqrt(K.dot(momentum, momentum)) * a[0] * a[1] * a[2] / (s * K.sqrt(s))
        return [*cross(gamma, omega), *cross(momentum, omega), speed]

    def on_ellipsoid(z):
        rate = rates(z)
        weighted, moved = ([e * x for e, x in zip(a, part, strict=True)] for part in (z[:3], rate[:3]))
        s, of_s = K.dot(z[:3], weighted), 2 * K.dot(rate[:3], weighted)
        root = K.sqrt(s)
        x = [c / root for c in weighted]
        return x, [(m / root - c * of_s / (2 * s)) / rate[6] for m, c in zip(moved, x, strict=True)]

    start = [K.coerce(x) for x in ("0.48", "0.6", "0.64", "0.4", "-1.2", "0.825", 0)]
    assert abs(K.dot(start[:3], start[3:6])) < 1e-30
    end = extrapolated(K, rates, start, K.coerce(1), 16, 16)
    system = Ellipsoid(a, K)
    path = system.flow(system.state(*on_ellipsoid(start))).at(end[6])
    for found, expected in zip((path.q[0], path.p[0]), on_ellipsoid(end), strict=True):
        assert max(abs(x - y) for x, y in zip(found, expected, strict=True)) < 1e-26
