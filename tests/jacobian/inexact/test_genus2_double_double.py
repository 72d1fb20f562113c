"""The kernel on bare reals in double-double arithmetic, at every distance and in every special case."""

from collections import Counter
from fractions import Fraction
from itertools import product
from statistics import median

import numpy as np
import pytest

from jacobian import MP, QQ, NotRepresentable, PrecisionLoss
from jacobian.inexact import composition, genus2_real
from jacobian.native import kinds
from jacobian.native.kinds import FLOAT, INTS, WIDES, ArrayKind, TupleKind
from jacobian.native.library import Library
from jacobian.native.program import Program
from jacobian.native.special import SPECIAL
from jacobian.numbers import double_double
from tests.jacobian.inexact.real_rows import CELLS, WIDE, rows
from tests.jacobian.rational_curves import QUARTIC, QUINTIC, known_points, pairs_of

WORST, TYPICAL = 1e-26, 1e-29


def add_all(f, first, second, out):
    for i in range(len(f)):
        g, x, y, row = f[i], first[i], second[i], out[i]
        total, _ = genus2_real.add(
            (g[0], g[1], g[2], g[3], g[4], g[5]), (x[0], x[1], x[2], x[3]), (y[0], y[1], y[2], y[3])
        )
        row[0], row[1], row[2], row[3] = total


def adds_nothing(pairs, out):
    out[0] = genus2_real.negligible(pairs[0], pairs[1])


TABLE = ArrayKind(kinds.WIDE, 2, 2)
LOOPS = Library(
    "test_genus2", {"add_all": (add_all, (TABLE,) * 4), "adds_nothing": (adds_nothing, (WIDES, INTS))}, SPECIAL
)


def sums(f, first, second):
    """The sums of rows of numbers, as arrays (…, 2)."""
    table = [np.array([[double_double.split(x) for x in row] for row in part]) for part in (f, first, second)]
    out = np.empty((len(f), 4, 2))
    LOOPS.add_all(*table, out)
    return out


@pytest.mark.thinned(3)
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


@pytest.mark.parametrize(
    ("curve", "every"),
    [
        pytest.param(QUINTIC, 7, id="quintic"),
        pytest.param(QUINTIC, 4, id="quintic-more", marks=pytest.mark.slow),
        pytest.param(QUARTIC, 4, id="quartic", marks=pytest.mark.slow),
    ],
)
def test_special_cases_on_rational_points(curve, every):
    """Branch points, doubles, common and opposite points, compared with the general formula in 60 digits."""
    K = MP(60)
    f = (*curve.f, *[QQ.zero] * (6 - len(curve.f)))
    pairs = pairs_of(curve, known_points(curve))
    expected, wanted, kinds = [], [], Counter()
    for (u, v), (s, t) in product(pairs[::every], pairs):
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


def test_only_sums_of_floats_are_contracted():
    """The float kernel may contract products and sums; in double-double code that would destroy the error terms."""

    def text(function, given):
        program = Program(SPECIAL)
        program.entry("entry", function, given)
        return program.text()

    four = TupleKind((FLOAT,) * 4)
    assert "fmul contract" in text(genus2_real.add, (TupleKind((FLOAT,) * 6), four, four))
    assert "contract" not in text(add_all, (TABLE,) * 4)


@pytest.mark.parametrize(
    ("small", "large", "expected"), [(2.0**-110, 1.0, True), (2.0**-90, 1.0, False), (2.0**-110, -3.0, True)]
)
def test_negligible(small, large, expected):
    """The low part may contain digits far below the number's last: a sum with a negligible number may then differ."""
    found = np.zeros(1, dtype=np.int64)
    LOOPS.adds_nothing(double_double.pack([Fraction(small), Fraction(large)]), found)
    assert bool(found[0]) is expected
    assert genus2_real.negligible(small, large) is True
    assert genus2_real.negligible(MP(32).coerce(small), MP(32).coerce(large)) is expected
