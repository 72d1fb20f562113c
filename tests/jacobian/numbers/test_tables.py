"""The tables for compiled code: every operation on every pair of elements is the field's."""

import numpy as np
import pytest
from numba import njit

from jacobian import GF
from jacobian.numbers import tables_compiled  # noqa: F401  # registers the operations
from jacobian.numbers.tables import BinaryTable, OddTable, table_context
from jacobian.numbers.words import (
    add,
    canonical,
    decode,
    dot2,
    dot3,
    dot4,
    encode,
    fit,
    inverse,
    mul,
    neg,
    settled,
    sub,
)

FIELDS = {
    "GF(4)": GF(2, 2, (1, 1, 1)),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
    "GF(9)": GF(3, 2, (2, 2, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
    "GF(7^2)": GF(7, 2),
    "GF(13^2)": GF(13, 2),
}


@njit(error_model="numpy")
def tabulate(K, q):
    pairs = np.empty((3, q, q), np.int64)
    singles = np.empty((5, q), np.int64)
    for x in range(q):
        singles[0, x] = neg(K, x)
        singles[1, x] = inverse(K, x) if x else 0
        singles[2, x] = fit(K, x)
        singles[3, x] = settled(K, canonical(K, x))
        singles[4, x] = decode(K, encode(K, x))
        for y in range(q):
            pairs[0, x, y] = add(K, x, y)
            pairs[1, x, y] = sub(K, x, y)
            pairs[2, x, y] = mul(K, x, y)
    return pairs, singles


@njit(error_model="numpy")
def dots(K, rows):
    out = np.empty((3, len(rows)), np.int64)
    for i in range(len(rows)):
        a, b, c, d, e, f, g, h = rows[i]
        out[0, i], out[1, i] = dot2(K, a, b, c, d), dot3(K, a, b, c, d, e, f)
        out[2, i] = dot4(K, a, b, c, d, e, f, g, h)
    return out


@pytest.mark.parametrize("name", FIELDS)
def test_every_pair(name):
    K = FIELDS[name]
    tables, q = table_context(K), K.order
    assert type(tables) is (BinaryTable if K.p == 2 else OddTable)
    (sums, differences, products), singles = tabulate(tables, q)
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
    found = dots(table_context(K), rows).T.tolist()
    for row, values in zip(rows.tolist(), found, strict=True):
        assert values == [K.dot(row[:size:2], row[1:size:2]) for size in (4, 6, 8)]
