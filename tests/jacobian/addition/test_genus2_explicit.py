"""The explicit formulas of genus 2 agree with Cantor on every pair, and cost what their source states."""

from itertools import product
from random import Random

import pytest

from jacobian import GF, QQ, HyperellipticCurve
from jacobian.addition import cantor
from jacobian.addition.choice import Counted, kernel, python_kernel
from jacobian.addition.explicit import ExplicitFormulas, GmpFormulas, PrimeFormulas
from jacobian.fields.prime import PrimeField
from tests.jacobian.group_curves import SMALL, genus_two_rows, next_curve, triple
from tests.jacobian.jacobian_rows import ROWS

MODELS = ("ramified", "split", "inert")
PRIME = GF(2**61 - 1)


class CountingField:
    """A field that counts its inversions, multiplications and squarings; mul(x, x) of one object is a squaring."""

    def __init__(self, base):
        self.base = base
        self.counts = {"I": 0, "M": 0, "S": 0}

    def __getattr__(self, name):
        if name.startswith("poly_"):
            raise AttributeError(name)
        return getattr(self.base, name)

    def mul(self, x, y):
        self.counts["S" if x is y else "M"] += 1
        return self.base.mul(x, y)

    def inv(self, x):
        self.counts["I"] += 1
        return self.base.inv(x)

    def count(self, operation, *arguments):
        self.counts.update(I=0, M=0, S=0)
        operation(*arguments)
        return "{I}I + {M}M + {S}S".format(**self.counts)


def random_curve(K, model, with_h, rng):
    """A curve of genus 2 with any leading coefficient of f and, if ``with_h``, any h ≠ 0."""
    while True:
        C = next_curve(K, 2, rng, model=model, with_h=with_h)
        if bool(C.h) == with_h:
            return C.arithmetic_model


def kernels(C):
    """Every implementation for C."""
    found = [ExplicitFormulas(C)]
    if isinstance(C.field, PrimeField):
        found += [PrimeFormulas(C), GmpFormulas(C)]
    return found


def assert_equal_to_cantor(C, triples):
    every = kernels(C)
    for a in triples:
        double = cantor.double(C, a)
        assert all(formulas.double(a) == double for formulas in every)
    for a, b in product(triples, repeat=2):
        total = cantor.sum_of(C, a, b)
        assert all(formulas.sum_of(a, b) == total for formulas in every), (a, b)


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("name", "model", "with_h"), genus_two_rows(SMALL))
def test_every_pair_of_a_small_group(name, model, with_h):
    rng = Random(f"{name} {model} {with_h}")
    K = SMALL[name]
    for _ in range(3 if K.order < 5 else 1):
        C = random_curve(K, model, with_h, rng)
        triples = [triple(D) for D in C.jacobian().points()]
        assert len(triples) == C.jacobian().order()
        assert_equal_to_cantor(C, triples)


LARGE = ("GF(2^61-1)", "GF(2^8)", "GF(3^5)", "QQ", "GF(101)")
LARGE_ROWS = [
    pytest.param(row, id=str(row)) for row in ROWS if row.genus == 2 and row.field in LARGE and row.model != "moved"
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", LARGE_ROWS)
def test_pool_and_random_pairs(row, rng):
    C, J = row.curve.arithmetic_model, row.curve.jacobian()
    classes = list(row.pool)
    if row.K != QQ:
        classes += [J.random(rng) for _ in range(6)]
    assert_equal_to_cantor(C, [triple(D) for D in classes])


@pytest.mark.slow
@pytest.mark.parametrize("row", LARGE_ROWS)
def test_many_random_pairs(row):
    rng = Random(f"many {row}")
    C, J = row.curve.arithmetic_model, row.curve.jacobian()
    A, B = row.pool[:2]
    for count in range(400 if row.K != QQ else 5):
        for formulas in kernels(C):
            assert formulas.sum_of(triple(A), triple(B)) == cantor.sum_of(C, triple(A), triple(B))
            assert formulas.double(triple(A)) == cantor.double(C, triple(A))
        # a walk with occasional fresh starts: over a large field a random class costs a hundred additions
        A, B = (A + B, A) if row.K == QQ or count % 30 else (J.random(rng), A + B)


def test_heights_that_grow():
    C = HyperellipticCurve(QQ, [1, 2, -3, 1, 0, 1])
    formulas, P = ExplicitFormulas(C), 3 * C.jacobian().from_points([(0, 1)])
    a = triple(P)
    for _ in range(5):
        assert formulas.sum_of(a, triple(P)) == cantor.sum_of(C, a, triple(P))
        a = formulas.double(a)
    assert a == triple(32 * P)
    assert max(c.denominator.bit_length() for c in a[0]) > 1000


def generic_pair(C, rng):
    """Two classes of weight 2 whose sum has weight 2 and no special case on the way."""
    return [triple(C.jacobian().random(rng)) for _ in range(2)]


def counted(f, h=()):
    K = CountingField(PRIME)
    return K, HyperellipticCurve(K, f, h)


def operation_counts(f, h=()):
    """(addition, doubling) of two random classes of y² + hy = f over GF(2^61 − 1)."""
    K, C = counted(f, h)
    plain = HyperellipticCurve(PRIME, f, h)
    rng = Random("counts")
    a, b = generic_pair(plain, rng)
    while not (len(a[0]) == len(b[0]) == 3):
        a, b = generic_pair(plain, rng)
    formulas = ExplicitFormulas(C)
    assert formulas.sum_of(a, b) == cantor.sum_of(plain, a, b)
    return K.count(formulas.sum_of, a, b), K.count(formulas.double, a)


def test_counts_of_lange_for_degree_five():
    # tables 2 and 3 of Lange 2005, odd characteristic: h = 0, f monic, f4 = 0
    assert operation_counts([7, 5, 11, 13, 0, 1]) == ("1I + 22M + 3S", "1I + 22M + 5S")


def test_counts_beyond_the_tables():
    # a doubling takes two more products with a coefficient f4, and one more with h = x² + x + 1
    assert operation_counts([7, 5, 11, 13, 17, 1]) == ("1I + 22M + 3S", "1I + 24M + 5S")
    assert operation_counts([7, 5, 11, 13, 0, 1], [1, 1, 1]) == ("1I + 22M + 3S", "1I + 23M + 5S")


def test_counts_for_degree_six():
    assert operation_counts([7, 5, 11, 13, 17, 19, 1]) == ("1I + 29M + 3S", "1I + 36M + 3S")


def test_counting_catches_a_wasted_multiplication():
    K, C = counted([7, 5, 11, 13, 0, 1])
    a, b = generic_pair(HyperellipticCurve(PRIME, [7, 5, 11, 13, 0, 1]), Random("counts"))
    formulas = ExplicitFormulas(C)

    def wasteful(a, b):
        K.mul(a[0][0], b[0][0])
        return formulas.sum_of(a, b)

    assert K.count(wasteful, a, b) == "1I + 23M + 3S"


def test_the_group_runs_the_formulas():
    for f, model in (([1, 3, 0, 2, 0, 1], "ramified"), ([1, 3, 0, 2, 0, 1, 4], "split")):
        C = HyperellipticCurve(GF(101), f)
        assert C.model == model
        assert type(kernel(C).sum_of.__self__) is PrimeFormulas
        assert type(C.jacobian()._double.__self__) is Counted
        assert type(C.jacobian()._double.__self__._double.__self__) is PrimeFormulas
    over_QQ = HyperellipticCurve(QQ, [1, 2, -3, 1, 0, 1])
    assert type(python_kernel(over_QQ).sum_of.__self__) is ExplicitFormulas


def test_special_cases_go_to_cantor(monkeypatch, rng):
    """Opposite and common points, tangents at branch points, weights below two: Cantor handles each correctly."""
    C = HyperellipticCurve(GF(101), [0, 24, 0, 1, 0, 1])
    J = C.jacobian()
    # the Python kernel, even if others have been compiled in this session
    J._adopt(python_kernel(C))
    P, Q, R = (C.random_point(rng) for _ in range(3))
    branch = C.point(0, 0)
    asked = []
    original = cantor.sum_of
    monkeypatch.setattr(cantor, "sum_of", lambda *arguments: asked.append(1) or original(*arguments))
    monkeypatch.setattr(cantor, "double", lambda C, a: asked.append(2) or original(C, a, a))
    D, E = J.from_points([P, Q]), J.from_points([P, R])
    assert J.from_points([P, P, Q, R]) == D + E
    assert asked.pop() == 1
    assert not D + (-D)
    assert asked.pop() == 1
    assert J(P) + J(Q) == D
    assert asked.pop() == 1
    assert D + J(R) == J.from_points([P, Q, R])
    assert asked.pop() == 1
    with_branch = J.from_points([P, branch])
    assert with_branch.double() == J.from_points([P, P])
    assert asked.pop() == 2
    assert J(P).double() == J.from_points([P, P])
    assert asked.pop() == 2
    assert D.double() == J.from_points([P, P, Q, Q])
    assert not asked
