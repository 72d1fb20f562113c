"""The axioms, over one table of fields, models, genera and h; every result is validated as a reduced divisor."""

from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import QQ
from tests.jacobian.jacobian_rows import ROWS, Row


def valid(D):
    """D itself, after the checks of from_mumford: monic, on the curve, degree and weight in range, v reduced."""
    again = D.jacobian.from_mumford(D.u, D.v, D.n)
    assert again == D
    assert hash(again) == hash(D)
    assert len(D.u) - 1 <= D.jacobian.curve.genus
    assert len(D.v) < len(D.u)
    return D


def every(row):
    return pytest.param(row, id=str(row))


# a row of every model and genus, with h and without, is among each fifth row: a field has 36 rows
table = pytest.mark.parametrize("row", [every(row) for row in ROWS])


def test_the_table_covers_every_field_model_and_genus():
    assert len(ROWS) == len(set(ROWS)) >= 150
    for name in ("GF(7)", "GF(101)", "GF(2^61-1)", "GF(2^8)", "GF(3^5)", "QQ"):
        assert {row.genus for row in ROWS if row.field == name} >= {1, 2, 3, 4}


@pytest.mark.thinned(5)
@table
def test_identity_and_inverse(row):
    J = row.curve.jacobian()
    for D in row.pool:
        assert D + J.zero() == D == J.zero() + D
        assert valid(-D) + D == J.zero()
        assert not D - D
        negative = -D
        assert -negative == D
        assert bool(D) == (J.zero() != D)


@pytest.mark.thinned(5)
@table
def test_commutativity_and_doubling(row):
    for D in row.pool:
        assert valid(D.double()) == D + D == 2 * D
        for E in row.pool:
            assert valid(D + E) == E + D


@pytest.mark.thinned(5)
@table
def test_associativity(row):
    rng = Random(f"associativity {row}")
    for _ in range(12 if row.K != QQ else 4):
        A, B, C = rng.choices(row.pool, k=3)
        assert (A + B) + C == A + (B + C)
        assert A - (B + C) == (A - B) - C


@pytest.mark.thinned(5)
@table
def test_scalar_multiples(row):
    J = row.curve.jacobian()
    largest = 9 if row.K == QQ else 40
    for D in row.pool[:4] if row.K != QQ else row.pool[2:4]:
        multiples = [J.zero()]
        for _ in range(largest):
            multiples.append(multiples[-1] + D)
        assert all(m * D == multiple for m, multiple in enumerate(multiples))
        assert -largest * D == -multiples[largest]


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", [every(row) for row in ROWS if row.K != QQ])
def test_large_scalars(row, rng):
    D = row.pool[0]
    m, n = (int.from_bytes(rng.bytes(16), "little") for _ in range(2))
    assert m * D + n * D == (m + n) * D
    assert valid(m * (n % 1000 * D)) == (m * (n % 1000)) * D


@pytest.mark.parametrize("row", [every(row) for row in ROWS if row.field == "GF(7)" and row.genus <= 4])
def test_order_annihilates(row):
    J = row.curve.jacobian()
    order = J.order()
    assert all(not order * D for D in row.pool)


@pytest.mark.thinned(3)
@pytest.mark.parametrize(
    "row", [every(row) for row in ROWS if row.field in ("GF(101)", "GF(3^5)", "GF(2^8)") and row.genus <= 2]
)
def test_order_annihilates_over_larger_fields(row, rng):
    J = row.curve.jacobian()
    order = J.order()
    q = row.K.order
    assert abs(order - q**row.genus) < (q**0.5 + 1) ** (2 * row.genus) - q**row.genus + 1
    assert all(not order * D for D in row.pool)
    assert all(not order * J.random(rng) for _ in range(5))


coefficients = st.lists(st.tuples(st.integers(0, 5), st.integers(-9, 9)), max_size=4)


@settings(max_examples=60)
@given(row=st.sampled_from([row for row in ROWS if row.K != QQ]), terms=coefficients, others=coefficients)
def test_linear_combinations_do_not_depend_on_the_order(row: Row, terms, others):
    J = row.curve.jacobian()

    def total(items):
        result = J.zero()
        for index, m in items:
            result = result + m * row.pool[index % len(row.pool)]
        return valid(result)

    assert total(terms) + total(others) == total(others[::-1] + terms[::-1])
    assert total(terms) - total(others) == total(terms + [(index, -m) for index, m in others])


@settings(max_examples=30)
@given(
    row=st.sampled_from([row for row in ROWS if row.K != QQ]),
    ms=st.lists(st.integers(-(10**12), 10**12), min_size=2, max_size=4),
)
def test_scalars_are_distributive(row: Row, ms):
    D, E = row.pool[0], row.pool[1]
    assert sum(ms) * D == sum((m * D for m in ms[1:]), ms[0] * D)
    for m, n in pairwise(ms):
        assert m * (n * E) == (m * n) * E
        assert m * (D + E) == m * D + m * E
