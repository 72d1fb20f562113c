"""Rows of arrays beside Cantor's algorithm in Python, whatever the rows are made of."""

from jacobian.addition import cantor
from jacobian.batch import DivisorArray


def sums(J, A, B):
    """A + B by Cantor in Python, on the arithmetic model."""
    return [J._out(cantor.sum_of(J._model, J._in(D), J._in(E))) for D, E in zip(A, B, strict=True)]


def assert_equal_to_cantor(J, classes):
    """Sums and differences of every pair, doubles and opposites of every class."""
    A = DivisorArray.stack([D for D in classes for _ in classes], J)
    B = DivisorArray.stack([E for _ in classes for E in classes], J)
    expected = sums(J, A, B)
    assert (A + B).to_list() == expected
    assert ((A + B) - B).to_list() == A.to_list()
    C = DivisorArray.stack(classes, J)
    assert C.double().to_list() == expected[:: len(classes) + 1]
    assert (-C).to_list() == [J._out(cantor.negate(J._model, J._in(D))) for D in classes]
    assert not any(C - C)
