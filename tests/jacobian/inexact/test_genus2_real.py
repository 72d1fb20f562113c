"""The kernel on bare reals, interpreted and compiled, compared with its oracle jacobian.inexact.composition in every
special case.
"""

from collections import Counter
from itertools import product
from random import Random

import numpy as np
import pytest

from integrable import ChaplyginBall
from jacobian import MP, QQ, RR, NotRepresentable, PrecisionLoss, poly
from jacobian.inexact import composition, genus2_real
from jacobian.native.kinds import FLOAT, ArrayKind
from jacobian.native.library import Library
from tests.integrable.torus.translations import in_floats
from tests.jacobian.inexact.real_rows import CELLS, assert_accurate, rows
from tests.jacobian.rational_curves import QUARTIC, QUINTIC, known_points, pairs_of


def kernel(row):
    total = genus2_real.add(*(tuple(map(float, part)) for part in (row.f, row.first, row.second)))[0]
    return total[:2], total[2:]


@pytest.mark.thinned(5)
@pytest.mark.parametrize(("variant", "k"), CELLS)
def test_floats_at_every_distance(variant, k):
    assert_accurate(kernel, rows(variant, k))


@pytest.mark.parametrize("k", range(0, 13, 2))
def test_translations_near_the_identity(k):
    ball = ChaplyginBall(inertia=(1, 2, 3), d=0.7)
    setup = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).setup
    wide, eps = setup.wide, setup.floats.half_step * 10.0**-k
    exact = setup.reals.elements(wide, setup.translations.near(wide.coerce(eps)))
    found = genus2_real.add(setup.floats.f, setup.floats.start[:4], in_floats(setup, eps)[:4])[0]
    true = genus2_real.add(setup.problem.f, setup.problem.start[:4], exact[:4])[0]
    assert max(abs(wide.coerce(x) - y) for x, y in zip(found, true, strict=True)) < 1e-14


def test_a_newton_step_along_which_nothing_changes_is_not_made():
    """For (lean, 1) = (b0, 1) and c0 = c1 the derivative modulo U'' is 0 if b1 = b0 + 1."""
    f = (0.0, 0.0, 1.0, 2.0, 3.0, 1.0)
    assert genus2_real.newton_step(f, 0.5, 1.5, 0.25, 0.25, 0.5, 1e-32) == (0.25, 0.25)


# --- special cases on rational points -------------------------------------------------------------------------------


def rounded(K, numbers):
    return [K.coerce(c) for c in numbers]


def oracle(K, f, first, second):
    return composition.compose(K, 2, rounded(K, f), *([rounded(K, c) for c in pair] for pair in (first, second)))


@pytest.mark.parametrize(
    ("curve", "K", "every"),
    [
        pytest.param(QUINTIC, RR, 3, id="float-quintic"),
        pytest.param(QUARTIC, RR, 3, id="float-quartic"),
        pytest.param(QUINTIC, RR, 1, id="float-quintic-all", marks=pytest.mark.slow),
        pytest.param(QUARTIC, RR, 1, id="float-quartic-all", marks=pytest.mark.slow),
        pytest.param(QUINTIC, MP(30), 1, id="mpf-quintic", marks=pytest.mark.slow),
        pytest.param(QUARTIC, MP(30), 1, id="mpf-quartic", marks=pytest.mark.slow),
    ],
)
def test_kernel_equals_the_general_formula(curve, K, every):
    f = rounded(K, (*curve.f, *[0] * (6 - len(curve.f))))
    pairs = pairs_of(curve, known_points(curve))
    branch = [
        not poly.evaluate(QQ, curve.f, -u[0] / (u[1] or 1)) or not poly.evaluate(QQ, u, QQ.zero) for u, _ in pairs
    ]
    compared = Counter()
    marked = list(zip(pairs, branch, strict=True))
    for (first, here), (second, there) in product(marked[::every], marked):
        try:
            expected = oracle(K, curve.f, first, second)
        except (NotRepresentable, PrecisionLoss):
            continue
        if len(expected.u) != 3:
            continue
        total = genus2_real.add(f, *(rounded(K, (*u[:2], *v)) for u, v in (first, second)))[0]
        numbers = (*expected.u[:2], *expected.v)
        size = max(1, *map(abs, numbers))
        assert max(abs(x - y) for x, y in zip(total, numbers, strict=True)) < 1e5 * K.eps * size**2
        compared["all"] += 1
        compared["branch point in both"] += here and there
        compared["double"] += first == second
        compared["common part"] += first != second and len(poly.gcd(QQ, first[0], second[0])) > 1
    assert compared["all"] > 100
    assert min(compared.values()) > 5


def test_transfer_polynomials_carry_the_sum():
    """L·U = p − qV, L'·U' = p − qV', L''·U'' = p + qV'', and N·U'' = L(V'' − V) + qW for either summand."""

    def times(a, b):
        return np.polynomial.polynomial.polymul(a, b)

    def minus(a, b):
        return np.polynomial.polynomial.polysub(a, b)

    for row in rows("near D", 0) + rows("near P, other generic", 3):
        f, first, second = (tuple(map(float, part)) for part in (row.f, row.first, row.second))
        total, (q, l1, l0, k0, m0, n1, n0, j0) = genus2_real.add(f, first, second)
        u, u2, u3 = ([*pair[:2], 1.0] for pair in (first, second, total))
        v, v2, v3 = (np.array(pair[2:]) for pair in (first, second, total))
        p = times([l0, l1], u) + np.array([*(q * v), 0, 0])
        scale = max(1, *np.abs(total), *np.abs(first), *np.abs(second)) ** 2
        sides = [
            (times([k0, l1], u2), minus(p, q * v2)),
            (times([m0, l1], u3), minus(p, -q * v3)),
        ]
        for (slope, lower), w, x in ((([l0, l1], [n0, n1]), v, u), (([k0, l1], [j0, n1]), v2, u2)):
            cofactor = np.polynomial.polynomial.polydiv(minus(f, times(w, w)), x)[0]
            sides.append((times(lower, u3), minus(times(slope, v3 - w), -q * cofactor)))
        for left, right in sides:
            assert np.abs(minus(left, right)).max() < 1e-10 * scale


def add_all(f, first, second, out):
    for i in range(len(f)):
        total, _ = genus2_real.add(
            (f[i, 0], f[i, 1], f[i, 2], f[i, 3], f[i, 4], f[i, 5]),
            (first[i, 0], first[i, 1], first[i, 2], first[i, 3]),
            (second[i, 0], second[i, 1], second[i, 2], second[i, 3]),
        )
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = total


COMPILED = Library("test_genus2_real", {"add_all": (add_all, (ArrayKind(FLOAT, 2),) * 4)})


def test_compiled_kernel_equals_the_interpreted_one():
    """Up to the rounding that fused multiplications change."""
    table = [row for variant, k in Random(5).sample(CELLS, 25) for row in rows(variant, k)[:20]]
    f, first, second = (
        np.array([[float(c) for c in getattr(row, name)] for row in table]) for name in ("f", "first", "second")
    )
    compiled = np.empty((len(table), 4))
    COMPILED.add_all(f, first, second, compiled)
    differences = []
    for i, row in enumerate(table):
        (u0, u1), (v0, v1) = kernel(row)
        interpreted = np.array([u0, u1, v0, v1])
        size = max(1, *np.abs(interpreted)) * max(1, *np.abs(first[i]), *np.abs(second[i]))
        differences.append(np.abs(compiled[i] - interpreted).max() / size)
    assert max(differences) < 1e-11
    assert np.median(differences) < 20 * RR.eps
