"""Arrays over primes of two words equal Cantor's sums row by row, in small groups and every special case."""

import pickle
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, ArgumentError, NotOnCurve
from jacobian.batch import DivisorArray, array, set_threads
from jacobian.batch.object_rows import ObjectRows
from jacobian.batch.two_word_rows import TwoWordRows
from tests.jacobian import septics
from tests.jacobian.batch.beside_cantor import assert_equal_to_cantor, random_rows, sums
from tests.jacobian.group_curves import random_curve
from tests.jacobian.two_words import LONG, MODELS, PRIMES, SMALL, special_classes


def with_and_without_h(fields):
    """(name, with_h) for every field; without h only where h may be 0."""
    return [(name, h) for name, K in fields.items() for h in ([True] if K.characteristic == 2 else [False, True])]


def group(K, model, with_h=False, genus=2):
    """The Jacobian of a curve whose rows are stored in two words even over a small field."""
    J = random_curve(K, genus, "two words", model=model, with_h=with_h).jacobian()
    J.__dict__["_rows"] = TwoWordRows(J)
    return J


def assert_right(J, classes):
    """Sums, multiples, and conversions to arrays and back agree with Cantor's algorithm and the group."""
    assert_equal_to_cantor(J, classes)
    C = DivisorArray.stack(classes, J)
    scalars = [7 * i - 60 for i in range(len(C))]
    assert (scalars * C).to_list() == [m * D for m, D in zip(scalars, C, strict=True)]
    assert (DivisorArray.from_arrays(J, C.u, C.v, C.n) == C).all()


@pytest.mark.thinned(4)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("name", "with_h"), with_and_without_h(SMALL))
def test_every_pair_of_a_small_group(name, model, with_h):
    J = group(SMALL[name], model, with_h)
    classes = list(J.points())
    assert len(classes) == J.order()
    assert_right(J, classes[:: max(1, len(classes) // 40)])


@pytest.mark.thinned(4)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("name", "with_h"), with_and_without_h(LONG))
def test_special_rows_over_long_fields(name, model, with_h):
    J = random_curve(LONG[name], 2, "long", model=model, with_h=with_h).jacobian()
    assert type(array.engine(J)) is TwoWordRows
    assert_right(J, special_classes(J.curve, Random(name)))


@pytest.mark.parametrize(("p", "with_h"), [(3, False), (3, True), (5, False)])
def test_pairs_of_a_small_group_of_genus_3(p, with_h):
    J = group(GF(p), "ramified", with_h, genus=3)
    classes = list(J.points())
    assert len(classes) == J.order()
    assert_right(J, classes[:: max(1, len(classes) // 24)])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("p", PRIMES)
def test_special_rows_of_genus_3(p):
    J = septics.with_branch_points(p).jacobian()
    assert type(array.engine(J)) is TwoWordRows
    assert_right(J, septics.special_classes(J.curve, Random(p)))


@pytest.mark.thinned(4)
@pytest.mark.parametrize("p", PRIMES)
def test_mixes_of_rows_of_genus_3(p):
    """Sums compared with Cantor's, for any leading coefficient of f and h ≠ 0."""
    J = random_curve(GF(p), 3, "long", model="ramified", with_h=True).jacobian()
    assert type(array.engine(J)) is TwoWordRows
    A, B = random_rows(J, 300, 1, base=8), random_rows(J, 300, 2, base=8)
    B = DivisorArray.stack([B[:270], A[270:285], -A[285:]])
    rows = [*range(12), *range(254, 258), *range(268, 273), 284, 285, 299]
    total = A + B
    assert total[rows].to_list() == sums(J, A[rows], B[rows])
    assert A.double()[rows].to_list() == sums(J, A[rows], A[rows])
    assert (total - B == A).all()
    m = Random(p).getrandbits(130) - (1 << 129)
    assert (m * A[:3]).to_list() == [m * D for D in A[:3]]


GROUPS = {f"{name}, {model}": group(K, model) for name, K in list(LONG.items())[1::2] for model in MODELS}


@pytest.mark.thinned(4)
@pytest.mark.parametrize("name", GROUPS)
@settings(max_examples=5)
@given(seed=st.integers(0, 2**32), count=st.integers(1, 530), m=st.integers(-(2**130), 2**130))
def test_mixes_of_special_rows(name, seed, count, m):
    J, rng = GROUPS[name], Random(seed)
    classes = DivisorArray.stack(special_classes(J.curve, rng))
    draw = np.random.default_rng(seed)
    A, B = (classes[draw.integers(len(classes), size=count)] for _ in range(2))
    A = A + B
    rows = draw.integers(count, size=20)
    assert (A + B)[rows].to_list() == sums(J, A[rows], B[rows])
    assert A.double()[rows].to_list() == sums(J, A[rows], A[rows])
    assert (A + B - A == B).all()
    assert (m * A)[rows[:2]].to_list() == [m * D for D in A[rows[:2]]]


def test_reading_and_wrong_rows():
    J = group(GF(2**127 - 1), "ramified")
    A = DivisorArray.stack(special_classes(J.curve, Random(1)))
    assert A.u.dtype == A.v.dtype == object
    assert [tuple(row) for row in A.v[1:2].tolist()] == [A[1].v]
    assert (pickle.loads(pickle.dumps(A)) == A).all()
    assert A.sum() == sum(A.to_list(), J.zero())
    assert (A + A[1]).to_list() == [D + A[1] for D in A]
    wrong = A.v.copy()
    wrong[1, 0] = (wrong[1, 0] + 1) % J.field.p
    with pytest.raises(NotOnCurve, match="row 1"):
        DivisorArray.from_arrays(J, A.u, wrong)
    with pytest.raises(ArgumentError, match="lower degree"):
        DivisorArray.from_arrays(J, [[1, 0, 0]], [[1, 0]])
    none = A[:0]
    assert len(none + none) == len(3 * none) == 0
    assert none.u.shape == (0, 3)


def test_threads_make_no_difference():
    J = group(GF(2**89 - 1), "split")
    classes = DivisorArray.stack([J.random(Random(i)) for i in range(20)])
    draw = np.random.default_rng(1)
    A, B = (classes[draw.integers(20, size=9000)] for _ in range(2))
    total = A + B
    try:
        set_threads(1)
        again = A + B
        assert (again == total).all()
    finally:
        set_threads(None)
    assert (total - B == A).all()


def test_longer_primes_and_other_genera_are_rows_of_divisors():
    binary = GF(2, 128, [1, 1, 1, 0, 0, 0, 0, 1, *[0] * 120, 1])
    longer = [random_curve(K, 2, "longer") for K in (GF(2**128 + 51), binary)]
    others = [random_curve(GF(2**89 - 1), 3, "genus 3", model="split"), random_curve(GF(2, 20), 3, "genus 3")]
    for C in (*longer, *others, random_curve(GF(2**128 + 51), 3, "genus 3", model="ramified")):
        assert type(array.engine(C.jacobian())) is ObjectRows
