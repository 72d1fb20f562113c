"""Arrays of genus 3 by explicit formulas equal Cantor's sums row by row, in small groups and special cases."""

from random import Random

import numpy as np
import pytest

from jacobian import GF
from jacobian.addition.short import Septic
from jacobian.batch import DivisorArray, array, compiled_rows
from jacobian.numbers.words import Lazy32, Lazy64, Wide32, Wide64, word_context
from tests.jacobian.batch.beside_cantor import (
    assert_equal_to_cantor,
    assert_rows_equal_cantor,
    cantor_of,
    random_rows,
    sums,
)
from tests.jacobian.group_curves import random_curve

CONTEXTS = {Lazy32: 2**29 - 3, Wide32: 2**31 - 1, Lazy64: 2**61 - 1, Wide64: 2**63 - 25}


def group(p, with_h=False):
    """The Jacobian of a curve whose f has any leading coefficient."""
    J = random_curve(GF(p), 3, "rows", model="ramified", with_h=with_h).jacobian()
    assert type(array.engine(J).formulas) is Septic
    return J


@pytest.mark.thinned(3)
@pytest.mark.parametrize("with_h", [False, True])
@pytest.mark.parametrize("kind", CONTEXTS)
def test_every_pair_on_every_context(kind, with_h, monkeypatch):
    monkeypatch.setattr(compiled_rows, "word_context", lambda p: kind(*word_context(p, kind.bits)))
    J = group(3, with_h)
    assert type(array.engine(J).K) is kind
    classes = list(J.points())
    assert len(classes) == J.order()
    assert_equal_to_cantor(J, classes)


@pytest.mark.parametrize("p", [7, *(pytest.param(p, marks=pytest.mark.slow) for p in (11, 13))])
def test_every_pair_of_a_small_group(p):
    J = group(p)
    A = DivisorArray.stack(list(J.points()), J)
    assert len(A) == J.order()
    assert (A.double() == cantor_of(A, A)).all()
    for shift in range(len(A)):
        B = A[(np.arange(len(A)) + shift) % len(A)]
        total = A + B
        assert (total == cantor_of(A, B)).all()


@pytest.mark.thinned(2)
@pytest.mark.parametrize("p", CONTEXTS.values())
def test_rows_over_large_primes(p):
    assert_rows_equal_cantor(group(p), 2000, 30)


@pytest.mark.slow
@pytest.mark.parametrize("p", CONTEXTS.values())
def test_many_rows(p):
    """All rows are compared with the compiled Cantor, a sample with Cantor in Python: residual 0."""
    assert_rows_equal_cantor(group(p, with_h=True), 200_000, 1000)


@pytest.mark.parametrize("count", [1, 255, 256, 257, 513])
def test_ends_of_blocks(count):
    J = group(2**61 - 1)
    A, B = random_rows(J, count, 3, base=8), random_rows(J, count, 4, base=8)
    assert (A + B).to_list() == sums(J, A, B)


def test_multiples():
    J = group(2**61 - 1, with_h=True)
    A = DivisorArray.stack([*random_rows(J, 5, 5, base=8), J.zero()])
    rng = Random(6)
    for m in (0, 1, -1, 2, 3, -7, 8, rng.getrandbits(122)):
        assert (m * A).to_list() == [m * D for D in A]
    scalars = [0, -1, 6, rng.getrandbits(122), -rng.getrandbits(200), 1]
    assert (scalars * A).to_list() == [m * D for m, D in zip(scalars, A, strict=True)]
