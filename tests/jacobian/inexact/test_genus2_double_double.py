"""The kernel on bare reals in double-double arithmetic, at every distance and on every special case."""

from collections import Counter
from fractions import Fraction
from itertools import product
from statistics import median

import numba
import numpy as np
import pytest

from jacobian import MP, QQ, NotRepresentable, PrecisionLoss
from jacobian.inexact import composition, genus2_real
from jacobian.inexact.compiled import JIT as FLOAT_JIT
from jacobian.numbers import double_double
from jacobian.numbers.double_double_compiled import JIT, numbers
from tests.jacobian.inexact.real_rows import CELLS, WIDE, rows
from tests.jacobian.rational_curves import QUARTIC, QUINTIC, known_points, pairs_of

WORST, TYPICAL = 1e-26, 1e-29


@numba.njit(**{**JIT, "cache": False})
def add_all(f, first, second, out):
    for i in range(len(f)):
        g, x, y, row = numbers(f[i]), numbers(first[i]), numbers(second[i]), numbers(out[i])
        total, _ = genus2_real.add(
            (g[0], g[1], g[2], g[3], g[4], g[5]), (x[0], x[1], x[2], x[3]), (y[0], y[1], y[2], y[3])
        )
        row[0], row[1], row[2], row[3] = total


def sums(f, first, second):
    """The sums of rows of numbers, as arrays (…, 2)."""
    table = [np.array([[double_double.split(x) for x in row] for row in part]) for part in (f, first, second)]
    out = np.empty((len(f), 4, 2))
    add_all(*table, out)
    return out


@pytest.mark.parametrize("variant", dict.fromkeys(variant for variant, _ in CELLS))
def test_at_every_distance(variant):
    table = [row for name, k in CELLS if name == variant for row in rows(name, k)[:15]]
    found = sums(*([getattr(row, part) for row in table] for part in ("f", "first", "second")))
    errors = [
        row.error(*(lambda total: (total[:2], total[2:]))(double_double.unpack(total, WIDE.mpf)))
        for row, total in zip(table, found, strict=True)
    ]
    assert max(errors) < WORST
    assert median(errors) < TYPICAL


@pytest.mark.parametrize("curve", [QUINTIC, QUARTIC], ids=["quintic", "quartic"])
def test_special_cases_on_rational_points(curve):
    """Branch points, doubles, common and opposite points: against the general formula with 60 digits."""
    K = MP(60)
    f = (*curve.f, *[QQ.zero] * (6 - len(curve.f)))
    pairs = pairs_of(curve, known_points(curve))
    expected, wanted, kinds = [], [], Counter()
    for (u, v), (s, t) in product(pairs[::2], pairs):
        numbers_of = [[K.coerce(c) for c in part] for part in (curve.f, u, v, s, t)]
        try:
            total = composition.compose(K, 2, numbers_of[0], tuple(numbers_of[1:3]), tuple(numbers_of[3:]))
        except (NotRepresentable, PrecisionLoss):
            continue
        if len(total.u) == 3:
            expected.append([*total.u[:2], *total.v])
            wanted.append((f, (*u[:2], *v), (*s[:2], *t)))
            kinds["double"] += (u, v) == (s, t)
            kinds["all"] += 1
    assert min(kinds.values()) > 5
    found = sums(*zip(*wanted, strict=True))
    for total, true in zip(found, expected, strict=True):
        size = max(1, *map(abs, true))
        assert (
            max(abs(x - y) for x, y in zip(double_double.unpack(total, K.coerce), true, strict=True)) < 1e-26 * size**2
        )


def test_the_options_of_the_caller_reach_the_functions_it_calls():
    """The float kernel may contract products and sums; in double-double code that would destroy the error terms."""

    def add(f, first, second):
        return genus2_real.add(f, first, second)[0]

    four = numba.types.UniTuple(numba.float64, 4)
    compiled = numba.njit(**{**FLOAT_JIT, "cache": False})(add)
    compiled.compile((numba.types.UniTuple(numba.float64, 6), four, four))
    assert "fmul contract" in "".join(compiled.inspect_llvm().values())
    assert " contract " not in "".join(add_all.inspect_llvm().values())


@pytest.mark.parametrize(
    ("small", "large", "expected"), [(2.0**-110, 1.0, True), (2.0**-90, 1.0, False), (2.0**-110, -3.0, True)]
)
def test_negligible(small, large, expected):
    """The low part may hold digits far below those of the number: a sum may differ where nothing is added."""

    @numba.njit(**{**JIT, "cache": False})
    def negligible(pair):
        return genus2_real.negligible(numbers(pair)[0], numbers(pair)[1])

    assert negligible(double_double.pack([Fraction(small), Fraction(large)])) is expected
    assert genus2_real.negligible(small, large) is True
    assert genus2_real.negligible(MP(32).coerce(small), MP(32).coerce(large)) is expected
