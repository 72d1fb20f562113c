"""The tables for compiled code: every operation on every pair of elements is the field's."""

import numpy as np
import pytest

from jacobian import GF
from jacobian.native.kinds import INT, ArrayKind
from jacobian.native.library import Library
from jacobian.native.words import CONTEXTS
from jacobian.numbers.tables import BinaryTable, OddTable, table_context
from jacobian.numbers.words import (
    inverse,
)

FIELDS = {
    "GF(4)": GF(2, 2, (1, 1, 1)),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
    "GF(9)": GF(3, 2, (2, 2, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
    "GF(7^2)": GF(7, 2),
    "GF(13^2)": GF(13, 2),
}


def tabulate(K, q, pairs, singles):
    for x in range(q):
        singles[0, x] = K.neg(x)
        singles[1, x] = inverse(K, x) if x else 0
        singles[2, x] = K.fit(x)
        singles[3, x] = K.settled(K.canonical(x))
        singles[4, x] = K.from_word(K.to_word(x))
        for y in range(q):
            pairs[0, q * x + y] = K.add(x, y)
            pairs[1, q * x + y] = K.sub(x, y)
            pairs[2, q * x + y] = K.dot(x, y)


def dots(K, rows, out):
    for i in range(rows.shape[0]):
        a, b, c, d = rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3]
        e, f, g, h = rows[i, 4], rows[i, 5], rows[i, 6], rows[i, 7]
        out[0, i], out[1, i] = K.dot(a, b, c, d), K.dot(a, b, c, d, e, f)
        out[2, i] = K.dot(a, b, c, d, e, f, g, h)


TABLE = ArrayKind(INT, 2)
COMPILED = {
    kind: Library(
        f"test_tables_{kind.__name__}",
        {"tabulate": (tabulate, (CONTEXTS[kind], INT, TABLE, TABLE)), "dots": (dots, (CONTEXTS[kind], TABLE, TABLE))},
    )
    for kind in (BinaryTable, OddTable)
}
"""The compiled functions above, for each kind of context."""


@pytest.mark.parametrize("name", FIELDS)
def test_every_pair(name):
    K = FIELDS[name]
    tables, q = table_context(K), K.order
    assert type(tables) is (BinaryTable if K.p == 2 else OddTable)
    pairs, singles = np.empty((3, q * q), np.int64), np.empty((5, q), np.int64)
    COMPILED[type(tables)].tabulate(tables, q, pairs, singles)
    sums, differences, products = pairs.reshape(3, q, q)
    for x in range(q):
        assert [K.add(x, y) for y in range(q)] == sums[x].tolist()
        assert [K.sub(x, y) for y in range(q)] == differences[x].tolist()
        assert [K.mul(x, y) for y in range(q)] == products[x].tolist()
    everything = list(range(q))
    negatives, inverses, *same = singles.tolist()
    assert negatives == [K.neg(x) for x in everything]
    assert inverses == [0] + [K.inv(x) for x in everything[1:]]
    assert same == [everything] * 3
    assert [tables.to_word(x) for x in everything] == [tables.from_word(x) for x in everything] == everything


@pytest.mark.parametrize("name", ["GF(2^8)", "GF(3^5)"])
def test_sums_of_products(name, rng):
    K = FIELDS[name]
    rows = rng.integers(0, K.order, (500, 8))
    rows[:50, ::3] = 0
    tables, found = table_context(K), np.empty((3, len(rows)), np.int64)
    COMPILED[type(tables)].dots(tables, rows, found)
    found = found.T.tolist()
    for row, values in zip(rows.tolist(), found, strict=True):
        assert values == [K.dot(row[:size:2], row[1:size:2]) for size in (4, 6, 8)]
