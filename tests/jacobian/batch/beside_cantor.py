"""Rows of arrays of any kind compared with Cantor's algorithm in Python."""

from functools import cache, partial
from random import Random

import numpy as np

from jacobian.addition import cantor
from jacobian.batch import DivisorArray
from tests.jacobian.group_curves import inside, outside


def sums(J, A, B):
    """A + B by Cantor in Python, on the arithmetic model."""
    C = J.curve.arithmetic_model
    return [outside(J, cantor.sum_of(C, inside(D), inside(E))) for D, E in zip(A, B, strict=True)]


def assert_equal_to_cantor(J, classes):
    """Checks sums and differences of every pair, and doubles and opposites of every class."""
    C, each = DivisorArray.stack(classes, J), np.arange(len(classes))
    A, B = C[np.repeat(each, len(each))], C[np.tile(each, len(each))]
    model, triples, found = J.curve.arithmetic_model, [inside(D) for D in classes], cache(partial(outside, J))
    expected = [found(cantor.sum_of(model, a, b)) for a in triples for b in triples]
    assert (A + B).to_list() == expected
    assert ((A + B) - B == A).all()
    assert C.double().to_list() == expected[:: len(classes) + 1]
    assert (-C).to_list() == [found(cantor.negate(model, a)) for a in triples]
    assert not any(C - C)


def random_rows(J, count, seed, base=40):
    """Sums of two random classes out of ``base``: general rows, including equal, opposite and zero ones."""
    rng = Random(seed)
    points = [] if J.curve.model == "inert" else [J.from_points([J.curve.random_point(rng)])]
    classes = [J.random(rng) for _ in range(base)] + [J.zero(), *points]
    pool = DivisorArray.stack(classes)
    draw = np.random.default_rng(rng.randrange(2**32))
    first, second = draw.integers(len(pool), size=(2, count))
    return pool[first] + pool[second]


def cantor_of(A, B):
    """A + B by the compiled Cantor, in every row."""
    out = A._engine.empty(len(A))
    A._engine._cantor("cantor_add", (A._rows, B._rows), out, np.arange(len(A)))
    return DivisorArray(A.jacobian, out)


def assert_rows_equal_cantor(J, count, sample):
    """Compares special and general rows with the compiled Cantor, and a sample with Cantor in Python."""
    A, B = random_rows(J, count, 1), random_rows(J, count, 2)
    B = DivisorArray.stack([B[: count // 2], A[count // 2 : count // 2 + 50], -A[count // 2 + 50 : count // 2 + 100]])
    A = A[: len(B)]
    total = A + B
    assert (total == cantor_of(A, B)).all()
    assert (A.double() == cantor_of(A, A)).all()
    assert (total - B == A).all()
    rows = [*range(sample), *range(count // 2, count // 2 + 100)]
    assert total[rows].to_list() == sums(J, A[rows], B[rows])
