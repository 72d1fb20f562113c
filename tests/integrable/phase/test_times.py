"""Times that flows accept: sequences of real numbers of any type, in the shortest way if these are Python's own."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from integrable.phase.ways import times_in
from jacobian import RR
from jacobian.errors import JacobianError

ACCEPTED = [
    [0.5, 2, True],
    ["0.5", "1/3"],
    [0.5, "1/3"],
    [Fraction(1, 3), 0.5],
    [Decimal("0.1")],
    [np.float64(0.5), np.float32(0.25), np.int64(3)],
    [2**60 + 1, 0.5],
    [1e308, 1e308, -1e308],
    np.linspace(0, 1, 5)[::2],
    np.arange(3),
    (0.5, 1.5),
    [],
    2.5,
]


@pytest.mark.parametrize("values", ACCEPTED, ids=repr)
def test_times_are_the_numbers_that_the_field_reads_one_by_one(values) -> None:
    found = times_in(RR, values, "times")
    one_by_one = [RR.coerce(x) for x in np.atleast_1d(np.array(values, dtype=object)).tolist()]
    assert (found.dtype, found.tolist()) == (np.dtype(float), one_by_one)
    assert found.flags.writeable
    assert found is not values


REFUSED = [
    [1.0, float("nan")],
    [float("inf"), 1.0],
    [float("inf"), float("-inf")],
    [0.5, 1j],
    [np.complex128(1 + 2j)],
    [0.5, np.complex128(1 + 2j)],
    [b"1.5"],
    [0.5, None],
    [0.5, [1.0]],
    [Decimal("sNaN")],
    [np.array([1.0]), 0.5],
    [10**400, 0.5],
    np.array([0.5, np.nan]),
    np.ones((2, 2)),
]


@pytest.mark.parametrize("values", REFUSED, ids=repr)
def test_a_value_that_is_no_time_is_named(values) -> None:
    with pytest.raises(JacobianError, match=r"times"):
        times_in(RR, values, "times")
