"""Projection onto the curve: exact division, quadratic convergence, shortest distance, stability over many steps."""

from __future__ import annotations

import numpy as np
import pytest

from jacobian import MP, QQ, poly
from jacobian.inexact import genus2_real, retraction
from jacobian.inexact.retraction import remainder, retracted
from jacobian.native.kinds import FLOAT, INT, WIDES, TupleKind
from jacobian.native.library import Library
from jacobian.numbers.double_double import pack, unpack

K = MP(50)
QUINTIC = (-0.31, 3.66, -16.5, 34.7, -33.4, 11.2)
QUARTIC = (-1.14, 9.49, -28.5, 36.2, -16.0, 0.0)


def rationals(rng, count):
    return [QQ.coerce(int(x)) / 7 for x in rng.integers(-30, 30, count)]


@pytest.mark.parametrize("seed", range(5))
def test_the_remainder_is_that_of_polynomial_division(seed):
    rng = np.random.default_rng(seed)
    f, (u0, u1, v0, v1) = rationals(rng, 6), rationals(rng, 4)
    square = poly.mul(QQ, (v0, v1), (v0, v1))
    difference = [a - b for a, b in zip(f, [*square, 0, 0, 0], strict=True)]
    quotient, rest = poly.divide(QQ, tuple(difference), (u0, u1, QQ.one))
    found = remainder(tuple(f), (u0, u1, v0, v1))
    padded = [*rest, *[QQ.zero] * (2 - len(rest)), *quotient, *[QQ.zero] * (4 - len(quotient))]
    assert list(found) == padded


def on_the_curve(f, x1, x2):
    """(U, V) through two points of positive f, as mpf."""
    f, x1, x2 = [K.coerce(c) for c in f], K.coerce(x1), K.coerce(x2)
    y1, y2 = (K.sqrt(sum(c * x**k for k, c in enumerate(f))) for x in (x1, x2))
    slope = (y2 - y1) / (x2 - x1)
    return tuple(f), (x1 * x2, -x1 - x2, y1 - slope * x1, slope)


def abscissas(f):
    """Two places where f is positive."""
    grid = np.linspace(-1, 2, 301)
    places = grid[np.polyval(f[::-1], grid) > 0]
    return float(places[len(places) // 4]), float(places[-len(places) // 4])


def norm(f, point):
    return max(abs(r) for r in remainder(f, point)[:2])


def distance(first, second):
    return K.sqrt(sum((x - y) ** 2 for x, y in zip(first, second, strict=True)))


@pytest.mark.parametrize("f", [QUINTIC, QUARTIC])
@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-9])
def test_the_residual_is_squared(f, off):
    f, point = on_the_curve(f, *abscissas(f))
    assert norm(f, point) < 1e-45
    near = tuple(x + off * k for x, k in zip(point, (1, -2, 1.5, 0.5), strict=True))
    back = retracted(f, near)
    assert norm(f, back) < 1e3 * norm(f, near) ** 2
    # as near as any point of the curve, to first order
    assert distance(back, near) < (1 + 100 * off) * distance(point, near)


def test_at_a_divisor_of_two_branch_points():
    """V = 0: there is nothing to divide by, and only U is changed."""
    f = (K.coerce(0), K.coerce(4), K.coerce(0), K.coerce(-5), K.coerce(0), K.coerce(1))  # x(x²−1)(x²−4)
    near = (K.coerce(2) + K.coerce("1e-9"), K.coerce(-3), K.coerce("1e-9"), K.coerce(0))  # (x − 1)(x − 2)
    assert norm(f, retracted(f, near)) < 1e-16
    assert abs(retracted(f, near)[0] - 2) < 1e-16


def _steps(f, point, step, count, every):
    for i in range(count):
        point = genus2_real.add(f, point, step)[0]
        if every > 0 and i % every == every - 1:
            point = retraction.retracted(f, point)
    return point


def _double_double(f, p, to):
    six = (f[0], f[1], f[2], f[3], f[4], f[5])
    to[0], to[1], to[2], to[3] = retraction.retracted(six, (p[0], p[1], p[2], p[3]))


SIX, FOUR = TupleKind((FLOAT,) * 6), TupleKind((FLOAT,) * 4)
LOOPS = Library(
    "test_retraction",
    {"double_double": (_double_double, (WIDES, WIDES, WIDES)), "steps": (_steps, (SIX, FOUR, FOUR, INT, INT))},
)


def test_compiled_in_floats_and_double_doubles():
    f, point = on_the_curve(QUINTIC, *abscissas(QUINTIC))
    near = tuple(x + K.coerce("1e-6") for x in point)
    wanted = retracted(f, near)
    out = np.empty((4, 2))
    LOOPS.double_double(pack(list(f)), pack(list(near)), out)
    assert max(abs(x - y) for x, y in zip(unpack(out, K.coerce), wanted, strict=True)) < 1e-29
    floats = retracted(tuple(map(float, f)), tuple(map(float, near)))
    assert np.allclose(floats, [float(x) for x in wanted], rtol=1e-14, atol=1e-14)


def test_many_additions_stay_on_the_curve():
    """The Euler top of scene S2 with the conjugate pair at ±0.3i, a step whose sums depart from the curve
    exponentially.
    """
    from integrable import EulerTop

    top = EulerTop((1, 2, 3))
    state = top.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
    D = top.divisor(state)
    _, _, h1, h2 = top.integrals(state)
    f = (*top.body.polynomial(h1, h2), 0.0)
    y = sum(c * 0.3j**k for k, c in enumerate(f)) ** 0.5
    start, step = (*D.u[:2], *D.v), (0.09, 0.0, y.real, y.imag / 0.3)
    assert norm(f, LOOPS.steps(f, start, step, 20_000, 16)) < 1e-14
    assert norm(f, LOOPS.steps(f, start, step, 20_000, 0)) > 1e-9
