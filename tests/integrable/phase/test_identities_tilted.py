"""Chaplygin's transformation at (γ, M) = c, written out, exactly over finite fields."""

from __future__ import annotations

from random import Random

import pytest

from integrable import ChaplyginBall
from integrable.phase.brackets import image_brackets
from integrable.phase.jets import JetField
from integrable.systems.system import System
from jacobian import NotASquare, SingularCurve
from tests.integrable.exact_points import cross, dot, over_fields, phase, random_system
from tests.integrable.exact_states import until_defined
from tests.integrable.systems.test_tilted import tilted_state

KINDS = pytest.mark.parametrize("kind", ["ball", "top"])


class Pair:
    """A tilted state and its transform as numbers with operators, with the constants k, s, p."""

    def __init__(self, system: System, rng: Random) -> None:
        self.system, self.state = system, tilted_state(system, rng)
        self.upright, self.image, change = system.upright(self.state)
        self.x, self.y = phase(system, self.state), phase(self.upright, self.image)
        N = JetField(system.field, 0)
        self.k, self.s, self.p = (N.coerce(v) for v in (change.k, change.s, change.p))
        self.c = dot(self.x.gamma, self.x.M)
        self.h1, self.h2 = self.x.H
        self.n = dot(self.x.gamma, self.x.omega)
        self.N = N


def cases(K, seed, kind, count=3):
    rng = Random(seed)
    return [Pair(random_system(K, rng, kind), rng) for _ in range(count)]


@over_fields()
@KINDS
def test_the_constants_and_the_map(K, kind) -> None:
    """k, s, p; γ̃ = p(γ + kM), M̃ = s(M − dkH1γ), d̃ = d(1 + kc), the same a_i, Ĩ_i = I_i − dkc."""
    for v in cases(K(), 1, kind):
        x, y, k, s, p, c = v.x, v.y, v.k, v.s, v.p, v.c
        assert c * x.d * v.h1 * k * k - (v.h2 - x.d * v.h1) * k - c == 0
        stretch = 1 + x.d * k * k * v.h1
        assert s * s * stretch == 1 == p * p * (1 + k * c) * stretch
        assert y.gamma == tuple(p * (a + k * b) for a, b in zip(x.gamma, x.M, strict=True))
        assert tuple(s * (b - x.d * k * v.h1 * a) for a, b in zip(x.gamma, x.M, strict=True)) == y.M
        assert y.d == x.d * (1 + k * c)
        assert y.a == x.a
        moments = [[v.N.coerce(m) for m in system.inertia] for system in (v.system, v.upright)]
        assert moments[1] == [m - x.d * k * c for m in moments[0]]


@over_fields()
@KINDS
def test_what_it_makes_of_the_motion(K, kind) -> None:
    """|γ̃| = 1, (γ̃, M̃) = 0, ω̃ ∥ ω, dt̃/dt = s(1 − dkn), dτ̃ = dτ, g̃ = g/(s(1 − dkn)), H̃1 = H1, H̃2 = dH1 − c/k."""
    for v in cases(K(), 2, kind):
        x, y = v.x, v.y
        assert (dot(y.gamma, y.gamma), dot(y.gamma, y.M)) == (1, 0)
        rate = v.s * (1 - x.d * v.k * v.n)
        assert x.omega == tuple(rate * e for e in y.omega)
        assert set(cross(x.omega, y.omega)) == {v.N.zero}
        assert y.g * rate == x.g
        assert y.g * y.g * (1 - y.d * dot(y.gamma, y.A_gamma)) == 1
        assert (v.h1, x.d * v.h1 - v.c / v.k) == y.H


@over_fields()
@KINDS
def test_the_inverse(K, kind) -> None:
    """γ = s²(γ̃/p − kM̃/s), M = s²(M̃/s + dkH1γ̃/p)."""
    for v in cases(K(), 3, kind):
        y, scale = v.y, v.s * v.s
        assert v.x.gamma == tuple(scale * (a / v.p - v.k * b / v.s) for a, b in zip(y.gamma, y.M, strict=True))
        lean = v.x.d * v.k * v.h1
        assert tuple(scale * (b / v.s + lean * a / v.p) for a, b in zip(y.gamma, y.M, strict=True)) == v.x.M


@over_fields()
def test_at_d_zero_gamma_is_projected_and_M_stays(K) -> None:
    """d = 0: γ̃ = unit vector of γ − (c/H2)M, M̃ = M."""
    for v in cases(K(), 4, "top"):
        flat = tuple(a - v.c / v.h2 * b for a, b in zip(v.x.gamma, v.x.M, strict=True))
        assert v.y.M == v.x.M
        assert set(cross(flat, v.y.gamma)) == {v.N.zero}
        assert [a * a * dot(flat, flat) for a in v.y.gamma] == [a * a for a in flat]


@over_fields()
@KINDS
def test_the_vector_field_goes_over(K, kind) -> None:
    """d(γ̃, M̃)/dt is s(1 − dkn) times the upright body's own rate, with constant k, s, p."""
    for v in cases(K(), 5, kind):
        x, y, rate = v.x, v.y, v.s * (1 - v.x.d * v.k * v.n)
        gamma, M = cross(x.gamma, x.omega), cross(x.M, x.omega)
        moved = tuple(v.p * (a + v.k * b) for a, b in zip(gamma, M, strict=True))
        assert moved == tuple(rate * e for e in cross(y.gamma, y.omega))
        moved = tuple(v.s * (b - x.d * v.k * v.h1 * a) for a, b in zip(gamma, M, strict=True))
        assert moved == tuple(rate * e for e in cross(y.M, y.omega))


@over_fields()
def test_the_clock(K) -> None:
    """1/g = s/g̃ + (dks²/p)ñ/g̃, ñ = (γ̃, ω̃)."""
    for v in cases(K(), 6, "ball"):
        spin = dot(v.y.gamma, v.y.omega)
        assert 1 / v.x.g == (v.s + v.x.d * v.k * v.s * v.s / v.p * spin) / v.y.g


@over_fields()
@KINDS
def test_steps_of_tilted_states_are_poisson(K, kind) -> None:
    """Chaplygin's transformation, an addition, and back: the bracket of (γ, M) at (γ, M) = c is kept."""
    K, rng = K(), Random(7)

    def attempt():
        system = random_system(K, rng, kind)
        state = tilted_state(system, rng)
        step = system.translation([K.random(rng), K.random(rng)], multiple=2)
        try:
            return system, state, step(state), image_brackets(system, step, state)
        except (ZeroDivisionError, SingularCurve):
            raise NotASquare("no image") from None

    system, state, image, (found, wanted) = until_defined(attempt, 500)
    assert found == wanted
    assert system.integrals(image) == system.integrals(state)
    assert image != state


def test_the_real_root() -> None:
    """kc ∈ (−1, 0], Ĩ_i ≥ I_i, dt̃/dt > 0, and k = −2c/((H2 − dH1) + √((H2 − dH1)² + 4c²dH1)) solves its equation."""
    rng = Random(8)
    for _ in range(200):
        ball = ChaplyginBall(sorted(rng.uniform(0.7, 2) for _ in range(3)), rng.uniform(0.01, 3))
        gamma = [rng.gauss(0, 1) for _ in range(3)]
        size = dot(gamma, gamma) ** 0.5
        state = ball.state([x / size for x in gamma], [rng.gauss(0, 1) for _ in range(3)], tilted=True)
        upright, image, change = ball.upright(state)
        _, c, h1, h2 = ball.integrals(state)
        rest, rolling = h2 - ball.d * h1, ball.d * h1
        assert change.k == pytest.approx(-2 * c / (rest + (rest * rest + 4 * c * c * rolling) ** 0.5), rel=1e-9)
        assert -1 < change.k * c <= 0
        assert all(after >= before for after, before in zip(upright.inertia, ball.inertia, strict=True))
        n = dot(state.gamma, ball.omega(state))
        assert 1 - ball.d * change.k * n > 0
        assert abs(dot(image.gamma, image.M)) < 1e-12 * h2**0.5
