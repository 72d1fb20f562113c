"""Small fields: lists of all classes, their number compared with the zeta function, closure, and uniform sampling."""

from collections import Counter
from math import prod
from random import Random

import numpy as np
import pytest

from jacobian import GF, ArgumentError, HyperellipticCurve, NotRepresentable, poly
from jacobian.fields.factor import factor
from jacobian.finite.counting import count_points
from tests.jacobian.group_curves import small_fields

SMALL = small_fields("GF(8)")
CASES = [
    (name, genus, model)
    for name, K in SMALL.items()
    for genus in range(1, 6)
    for model in ("ramified", "split", "inert")
    if K.order**genus <= 260 and not (model == "inert" and genus % 2)
]


def random_curve(K, genus, model, rng):
    while True:
        size = 2 * genus + rng.choice((2, 3) if model == "ramified" else (3,))
        h_size = rng.choice((genus + 1, genus + 2)) if K.characteristic == 2 else rng.choice((0, genus + 2))
        try:
            C = HyperellipticCurve(K, poly.random(K, size, rng), poly.random(K, h_size, rng))
        except ArgumentError:
            continue
        if (C.genus, C.model) == (genus, model):
            return C


@pytest.mark.thinned(5)
@pytest.mark.parametrize(("name", "genus", "model"), CASES)
def test_the_reduced_divisors_are_the_group(name, genus, model):
    rng = Random(f"{name} {genus} {model}")
    C = random_curve(SMALL[name], genus, model, rng)
    J = C.jacobian()
    elements = list(J.points())
    group = set(elements)
    assert len(elements) == len(group) == J.order()
    assert J.zero() in group
    for _ in range(25):
        A, B = rng.choice(elements), rng.choice(elements)
        assert {A + B, A - B, -A, A.double()} <= group
        assert not J.order() * A
        assert J.from_mumford(A.u, A.v, A.n) == A


@pytest.mark.parametrize(("name", "genus", "model"), [case for case in CASES if case[1] <= 2])
def test_points_against_the_count(name, genus, model):
    C = random_curve(SMALL[name], genus, model, Random(f"points {name} {genus} {model}"))
    points = list(C.points())
    assert len(points) == len(set(points)) == count_points(C)
    assert all(C.is_on(point) and C.involution(C.involution(point)) == point for point in points)


@pytest.mark.parametrize("model", ["ramified", "split", "inert"])
@pytest.mark.parametrize("name", ["GF(2)", "GF(4)", "GF(5)", "GF(9)"])
def test_the_functional_equation_predicts_the_next_count(name, model):
    """χ_J is computed from the first g counts; #C(GF(q^(g+1))) checks all of it."""
    C = random_curve(SMALL[name], 2, model, Random(f"zeta {name} {model}"))
    q = C.field.order
    chi = C.jacobian().frobenius_polynomial()
    companion = np.zeros((4, 4), dtype=object)
    for i in range(3):
        companion[i + 1, i] = 1
    companion[:, 3] = [-c for c in chi[:4]]
    cube = companion.dot(companion).dot(companion)
    assert count_points(C, 3) == q**3 + 1 - sum(cube[i, i] for i in range(4))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_counting_by_norms_agrees_with_counting_by_tables(degree, monkeypatch):
    from jacobian.finite import counting

    C = random_curve(GF(19), 2, "split", Random(degree))
    assert counting._count_by_norms(C, degree) == counting._count_by_tables(C, degree)


UNIFORM = [
    ("GF(5)", 2, "ramified"),
    ("GF(3)", 3, "split"),
    ("GF(4)", 2, "split"),
    ("GF(2)", 4, "inert"),
    ("GF(2)", 4, "ramified"),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("name", "genus", "model"), UNIFORM)
def test_random_is_uniform(name, genus, model, rng):
    C = random_curve(SMALL[name], genus, model, Random(f"uniform {name}"))
    assert_uniform(C.jacobian(), rng)


def test_random_is_uniform_where_points_generate_a_subgroup(rng):
    # the case sage-gf5-order16: its rational points generate 8 of 16 classes
    assert_uniform(HyperellipticCurve(GF(5), [3, 4, 1, 4, 2, 1]).jacobian(), rng)


def assert_uniform(J, rng):
    elements = list(J.points())
    draws = 10 * len(elements)
    counts = Counter(J.random(rng) for _ in range(draws))
    assert set(counts) <= set(elements)
    chi_square = sum((counts[D] - 10) ** 2 / 10 for D in elements)
    freedom = len(elements) - 1
    # five standard deviations of the χ² distribution
    assert abs(chi_square - freedom) < 5 * (2 * freedom) ** 0.5


def test_random_reaches_both_halves_of_a_large_group():
    """Over a large field, classes that are not twice another class have the expected frequency."""
    p = 2**61 - 1
    C = HyperellipticCurve(GF(p), [0, -4, 0, 5, 0, -1])
    J = C.jacobian()
    rng = np.random.default_rng(3)
    degrees = Counter(tuple(len(P) - 1 for P, _ in factor(C.field, J.random(rng).u)) for _ in range(120))
    # u is irreducible for about half of the classes; a sum of rational points never is
    assert 35 < degrees[(2,)] < 85
    assert set(degrees) == {(2,), (1, 1)}


@pytest.mark.parametrize("maker", [Random, np.random.default_rng])
def test_random_is_reproducible(maker):
    for K in (GF(2**127 - 1), GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1))):
        C = random_curve(K, 2, "split", Random(7))
        J = C.jacobian()
        first, second = ([J.random(rng) for _ in range(4)] for rng in (maker(11), maker(11)))
        assert first == second
        assert len(set(first)) == 4


def test_factor_multiplies_back():
    rng = Random(5)
    for K in SMALL.values():
        for _ in range(30):
            a = poly.random(K, rng.randrange(1, 9), rng, monic=True)
            product = (K.one,)
            for P, e in factor(K, a):
                for _ in range(e):
                    product = poly.mul(K, product, P)
                assert factor(K, P) == [(P, 1)]
            assert product == a
            assert prod(e for _, e in factor(K, a)) >= 1


def test_inert_odd_genus_has_an_order_and_no_divisors(rng):
    J = HyperellipticCurve(GF(3), [1, 2, 0, 0, 0, 0, 0, 0, 2]).jacobian()
    assert J.order() == 29
    for attempt in (
        J.zero,
        J.points,
        lambda: J.random(rng),
        lambda: J.from_mumford([1], []),
        lambda: J.from_points([]),
    ):
        with pytest.raises(NotRepresentable, match=r"inert of odd genus 3"):
            attempt()
