"""The loops of the flow in double-double arithmetic compared with the same loops on mpf, on easy and hard bodies.

Both have the same inputs, which fit into two floats. The growth of errors along a motion is measured by a second run of
the loop on mpf, from inputs with relative changes of 1e-31.
"""

from functools import cache, reduce
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall, EulerTop
from integrable.moving_point import addition
from integrable.moving_point.compiled import SPECIAL
from jacobian import MP
from jacobian.native.kinds import WIDE, WIDES, ArrayKind
from jacobian.native.library import Library
from jacobian.numbers import double_double

K = MP(60)
GAMMA, MOMENTUM = (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)
# inertia, d, γ, M, made to satisfy |γ| = 1 and (γ, M) = 0
CASES = {
    "easy": ((1, 2, 3), 0.7, GAMMA, MOMENTUM),
    "Euler top": ((1, 2, 3), 0, GAMMA, MOMENTUM),
    "thin ball": ((1e-4, 1, 1.5), 1, GAMMA, MOMENTUM),
    "thinner ball": ((1e-8, 1, 1.5), 1, GAMMA, MOMENTUM),
    "moments 1:1e4:1e8": ((1, 1e4, 1e8), 0.7, GAMMA, MOMENTUM),
    "heavy moments and d": ((1, 1e4, 1e8), 1e8, GAMMA, MOMENTUM),
    "nearly equal moments": ((1, 1 + 1e-12, 3), 0.7, GAMMA, MOMENTUM),
    "tiny d": ((1, 2, 3), 1e-12, GAMMA, MOMENTUM),
    "separatrix 1e-4": ((1, 2, 3), 0.7, (0.6, 1e-4, 0.8), (1e-4, 1, 1e-4)),
    "separatrix 1e-8": ((1, 2, 3), 0.7, (0.6, 1e-8, 0.8), (1e-8, 1, 1e-8)),
    "γ2 = 0": ((1, 2, 3), 0.7, (0.6, 0, 0.8), (0.8, 0.5, -0.6)),
}


def shifted(f, axes, start, steps, out):
    """The moving point after the translations ``steps`` (N, 10, 2), into ``out`` of shape (10, 2)."""
    point = addition.moving_point(start)
    for i in range(len(steps)):
        point = addition.shift(f, axes, point, steps[i])
    addition.put(point, out, 0)


TABLE = ArrayKind(WIDE, 2, 2)
LOOPS = Library(
    "test_addition",
    {
        "shifted": (shifted, (WIDES, WIDES, WIDES, TABLE, WIDES)),
    },
    SPECIAL,
)


@cache
def setup_of(name):
    inertia, d, gamma, M = CASES[name]
    gamma, M = ([K.coerce(x) for x in v] for v in (gamma, M))
    size = K.sqrt(K.dot(gamma, gamma))
    gamma = [x / size for x in gamma]
    tilt = K.dot(gamma, M)
    M = [m - tilt * x for m, x in zip(M, gamma, strict=True)]
    ball = ChaplyginBall(inertia, d, field=K) if d else EulerTop(inertia, field=K)
    return ball.flow(ball.state(gamma, M)).setup


def exact(array):
    """The values of pairs of floats, as numbers of the field."""
    return double_double.unpack(array, K.coerce)


def changed(value, rng):
    if isinstance(value, list):
        return [changed(x, rng) for x in value]
    return value * (1 + K.coerce(rng.uniform(-1, 1)) * K.coerce("1e-31"))


def flat(value):
    return [x for part in value for x in flat(part)] if isinstance(value, (list, tuple)) else [value]


def assert_as_exact_as_possible(found, loop, inputs, seed, factor=300):
    """``found`` compared with ``loop`` of the exact inputs, to ``factor`` times the effect of 1e-31 in the inputs."""
    rng, values = Random(seed), [exact(x) for x in inputs]
    true = flat(loop(*values))
    floor = [0] * len(true)
    for _ in range(3):
        other = flat(loop(*[changed(x, rng) for x in values]))
        floor = [max(old, abs(x - y)) for old, x, y in zip(floor, other, true, strict=True)]
    scale, floor = max(map(abs, true)), max(floor)
    error = max(abs(x - y) for x, y in zip(flat(found), true, strict=True))
    assert error <= factor * (floor + scale * K.coerce("1e-31")), (error / scale, floor / scale)
    return float(error / scale)


@pytest.mark.parametrize("name", CASES)
def test_additions(name):
    """Translations by about 2^k basic steps, the largest first."""
    setup = setup_of(name)
    table = [setup.reals.elements(setup.wide, setup.translations.level(k)[1]) for k in range(8)]
    for levels in (slice(1, None, -1), slice(None, None, -2)):
        steps = table[levels]
        inputs = [double_double.pack(x) for x in (setup.problem.f, setup.problem.axes, setup.problem.start, steps)]
        out = np.empty((10, 2))
        LOOPS.shifted(*inputs, out)

        def loop(f, axes, start, steps):
            return reduce(lambda point, step: addition.shift(f, axes, point, step), steps, start)

        error = assert_as_exact_as_possible(exact(out), loop, inputs, f"{name} {levels}")
        if name in ("easy", "Euler top", "γ2 = 0"):
            assert error < 1e-28
