"""Every addition, by compiled kernels and in Python, compared with a second Cantor on python-flint's polynomials."""

from random import Random

import pytest

from jacobian import QQ
from jacobian.addition.choice import python_kernel
from tests.jacobian.addition.flint_cantor import FlintCantor
from tests.jacobian.group_curves import inside
from tests.jacobian.jacobian_rows import ROWS

TABLE = [pytest.param(row, id=str(row)) for row in ROWS]
ADDITIONS = 20_000


def compare(row, additions, rng):
    """A walk through the group, whose steps are sums with the predecessor or with a class of the pool, opposites and
    doubles.
    """
    other_cantor = FlintCantor(row.curve.arithmetic_model)
    add, double, _ = python_kernel(row.curve.arithmetic_model)
    A, B = row.pool[0], row.pool[1]
    for count in range(additions):
        if row.K == QQ and count % 4 == 0:
            # a doubling multiplies heights by four: start again
            A, B = rng.choice(row.pool), rng.choice(row.pool)
        other = rng.choice([B, A, -A, rng.choice(row.pool)])
        total = A + other
        expected = other_cantor.add(other_cantor.convert(inside(A)), other_cantor.convert(inside(other)))
        expected = other_cantor.convert_back(expected)
        assert inside(total) == expected, (A, other)
        assert add(inside(A), inside(other)) == expected, (A, other)
        if other is A:
            assert A.double() == total
            assert double(inside(A)) == expected
        A, B = (total if total else B), A


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", TABLE)
def test_additions(row):
    compare(row, 12 if row.K != QQ else 8, Random(f"flint {row}"))


@pytest.mark.slow
@pytest.mark.parametrize("row", [row for row in TABLE if row.values[0].K != QQ])
def test_many_additions(row):
    finite = sum(1 for row in ROWS if row.K != QQ)
    compare(row, ADDITIONS // finite + 1, Random(f"many {row}"))
