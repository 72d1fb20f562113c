"""One example of each addition that CONTRIBUTING describes, made in the way described: a field, a system, a scene, a
comparator.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, run
from integrable.oracles.methods import METHODS, Method
from integrable.oracles.reference import taylor
from integrable.oracles.stepping import follow
from integrable.phase.body import Body
from integrable.systems.system import System
from jacobian import RR, Field, HyperellipticCurve, NotASquare
from tests.integrable.scene_texts import BALL

# --- a field: a class that implements the protocol


class GaussianRationals:
    """QQ(i), elements (a, b) for a + bi."""

    name, exact, characteristic, order = "QQ(i)", True, 0, None
    zero, one = (Fraction(0), Fraction(0)), (Fraction(1), Fraction(0))

    def coerce(self, value, argument="value"):
        a, b = value if isinstance(value, tuple) else (value, 0)
        return Fraction(a), Fraction(b)

    def add(self, x, y):
        return x[0] + y[0], x[1] + y[1]

    def sub(self, x, y):
        return x[0] - y[0], x[1] - y[1]

    def mul(self, x, y):
        return x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]

    def neg(self, x):
        return -x[0], -x[1]

    def inv(self, x):
        size = x[0] * x[0] + x[1] * x[1]
        return x[0] / size, -x[1] / size

    def div(self, x, y):
        return self.mul(x, self.inv(y))

    def dot(self, xs, ys):
        total = self.zero
        for x, y in zip(xs, ys, strict=True):
            total = self.add(total, self.mul(x, y))
        return total

    def is_zero(self, x, scale=None):
        return x == self.zero

    def sqrt(self, x):
        raise NotASquare(f"{x}: roots are not sought here")

    def random(self, rng):
        return Fraction(rng.randrange(-9, 9)), Fraction(rng.randrange(-9, 9))

    def key(self, x):
        return x


def test_a_new_field():
    """Its curves have a group: the axioms, and a multiple computed in two ways."""
    K = GaussianRationals()
    assert isinstance(K, Field)
    x = [K.coerce(z) for z in ((1, 1), (0, 2), (2, -1), (-1, 3), (4, 0), (1, -2))]
    # y² = Π(x − x_i) + y₀² has the points (x_i, ±y₀)
    f = (K.one,)
    for z in x:
        f = tuple(K.sub(a, K.mul(z, b)) for a, b in zip((K.zero, *f), (*f, K.zero), strict=True))
    y = K.coerce((3, 1))
    C = HyperellipticCurve(K, (K.add(f[0], K.mul(y, y)), *f[1:]))
    J = C.jacobian()
    D, E, F = (J.from_points([(x[i], y), (x[i + 1], K.neg(y))]) for i in (0, 2, 4))
    assert (D + E) + F == D + (E + F)
    assert D + E == E + D
    assert not D - D
    assert 5 * D == D + D + D + D + D


# --- a system: its constants, on the common phase space


class Marble(System):
    """A ball of uniform density: all moments 2mr²/5, d = mr²."""

    def __init__(self, mass, radius, *, field=RR):
        self.radius = field.coerce(radius, "radius")
        d = field.mul(field.coerce(mass, "mass"), field.mul(self.radius, self.radius))
        moment = field.div(field.mul(field.coerce(2), d), field.coerce(5))
        self.body = Body.make((moment, moment, moment), d, field)


def test_a_new_system():
    """It has states, motions and points of contact, and moves as the oracle predicts."""
    marble = Marble(2, 0.5)
    state = marble.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    found = marble.flow(state).at([0.7, 3.0])
    true = taylor(marble, state, [0.7, 3.0], digits=20)
    assert np.abs(found.gamma - true.gamma.astype(float)).max() < 1e-14
    assert found.contact.shape == (2, 2)


def test_a_new_scene(tmp_path):
    """A file, without code."""
    path = tmp_path / "marble.toml"
    text = BALL.replace('["1", "2", "3"]', "[1, 1, 1]").replace('d = "0.7"', "d = 0.5")
    path.write_text(text.replace("[0, 1, 2.5]", "[0, 1, 2]"), encoding="utf-8")
    ball = ChaplyginBall((1, 1, 1), 0.5)
    true = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).at([0, 1, 2])
    assert (run(path).gamma == true.gamma).all()


# --- a comparator: a function that advances a state, and a row of METHODS


class Heun(Method):
    """Heun's method of order 2."""

    def build(self, kind, setting):
        def of_system(system):
            rates = kind.right_hand_side(kind.coefficients_of(system.constants))

            def advance(y, step, memory):
                first = rates(y)
                second = rates([a + step * k for a, k in zip(y, first, strict=True)])
                return [a + step / 2 * (k + m) for a, k, m in zip(y, first, second, strict=True)], None, 2

            return lambda start: lambda times: follow(advance, start, times, setting)

        return of_system


@pytest.mark.parametrize("seed", [1, 2])
def test_a_new_comparator(monkeypatch, seed):
    """It runs beside the others, and its error is quadratic in the step."""
    monkeypatch.setitem(METHODS, "Heun", Heun("Heun", "Heun (1900)", "step", (0.1, 0.05), order=2))
    rng = Random(seed)
    ball = ChaplyginBall((1, 2, 3), 0.3 + rng.random())
    state = ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    true = ball.flow(state).at([1.0]).gamma
    errors = [np.abs(METHODS["Heun"].solve(ball, state, [1.0], step).gamma - true).max() for step in (0.02, 0.01)]
    assert 3 < errors[0] / errors[1] < 5
