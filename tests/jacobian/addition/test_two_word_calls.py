"""The compiled formulas of two words: equal to Cantor in Python on every pair, special case and ladder."""

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import ArgumentError, HyperellipticCurve, poly
from jacobian.addition import cantor
from jacobian.addition.calls import TwoWordKernel, two_word_context
from jacobian.addition.choice import python_kernel
from jacobian.addition.class_loops import add_classes, double_class, multiple_of_class
from jacobian.addition.short import short_equation
from jacobian.batch.equation import Equation
from tests.jacobian.group_curves import inside, random_curve, triple
from tests.jacobian.two_words import LONG, MODELS, SMALL, special_classes


def short_curve(K, model, seed):
    """A curve with h = 0 in odd characteristic, and a monic f in degree 5."""
    return Equation(random_curve(K, 2, seed, model=model)).curve


def of(C):
    return TwoWordKernel(C, python_kernel(C))


@pytest.mark.thinned(4)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", SMALL)
def test_every_pair_and_ladder_of_a_small_group(name, model):
    C = short_curve(SMALL[name], model, "pairs")
    kernel, J = of(C), C.jacobian()
    triples = [triple(D) for D in J.points()]
    assert len(triples) == J.order()
    for a in triples:
        assert kernel.double(a) == cantor.double(C, a)
    for a, b in product(triples, repeat=2):
        assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)
    for a in triples[:: max(1, len(triples) // 4)]:
        total = a
        for m in range(1, 2 * J.order() + 2):
            assert kernel.multiple(m, a) == total, (m, a)
            total = cantor.sum_of(C, total, a)


def with_two_torsion_points(K, model):
    """A curve on which the points at x = 2 and x = 3 are their own opposites, and these points."""
    rng, degree = Random(K.order), 5 if model == "ramified" else 6
    branches = poly.mul(K, (K.neg(2), 1), (K.neg(3), 1))
    while True:
        f, h = (*poly.random(K, degree, rng), 1 if degree == 5 else K.random(rng)), ()
        if K.characteristic == 2:
            h = branches if degree == 5 else poly.mul(K, branches, (K.random(rng), 1))
        else:
            f = poly.mul(K, branches, f[2:])
        try:
            C = HyperellipticCurve(K, f, h)
        except ArgumentError:
            continue
        if C.genus == 2 and C.model == model:
            return C, [(x, K.sqrt(poly.evaluate(K, C.f, x))) for x in (2, 3)]


@pytest.mark.thinned(4)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", LONG)
def test_special_classes_of_long_fields(name, model):
    (given, points), rng = with_two_torsion_points(LONG[name], model), Random(name)
    C, J = given.arithmetic_model, given.jacobian()
    # Python takes a millisecond for a sum over GF(2^n)
    kernel, bits = of(C), 20 if C.field.characteristic == 2 else 70
    torsion = J.from_points(points)
    assert 2 * torsion == J.zero() != torsion
    classes = [torsion, *special_classes(given, rng)]
    if model != "inert":
        classes.append(J.from_points(points[:1]))
    triples = [inside(D) for D in classes]
    for a, b in product(triples, repeat=2):
        assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)
    for a in triples:
        assert kernel.double(a) == cantor.double(C, a)
        for m in (1, 2, 3, 8, rng.getrandbits(bits) + 1):
            assert kernel.multiple(m, a) == python_kernel(C).multiple(m, a), (m, a)
    assert kernel.double(triples[0]) == triple(C.jacobian().zero())


CURVES = {f"{name}, {model}": short_curve(K, model, "walk") for name, K in LONG.items() for model in MODELS}


@pytest.mark.thinned(3)
@pytest.mark.parametrize("name", CURVES)
@settings(max_examples=6)
@given(seed=st.integers(0, 2**32), m=st.integers(1, 2**260), n=st.integers(1, 2**260))
def test_sums_and_multiples(name, seed, m, n):
    C = CURVES[name]
    kernel, rng, J = of(C), Random(seed), C.jacobian()
    # few points, so that classes have points in common
    points = [C.random_point(rng) for _ in range(3)]
    count = (0, 2) if C.model == "inert" else (0, 1, 2)
    a, b = (inside(J.from_points(rng.choices(points, k=rng.choice(count)))) for _ in range(2))
    for _ in range(4):
        total = kernel.sum_of(a, b)
        assert total == cantor.sum_of(C, a, b)
        assert kernel.double(a) == cantor.double(C, a)
        assert all(type(c) is int and 0 <= c < C.field.order for c in (*total[0], *total[1]))
        a, b = b, total
    first, second = kernel.multiple(m, a), kernel.multiple(n, a)
    assert kernel.multiple(m + n, a) == cantor.sum_of(C, first, second)
    assert kernel.multiple(m, cantor.sum_of(C, a, b)) == cantor.sum_of(C, first, kernel.multiple(m, b))


@pytest.mark.parametrize("name", [name for name in CURVES if "89" in name or "61" in name])
def test_the_loops_interpreted_are_the_loops_compiled(name):
    C = CURVES[name]
    J, K, rng = C.jacobian(), two_word_context(C.field), Random(7)
    equation = short_equation(C, K.to_word)
    a, b = (triple(D) for D in (J.random(rng), J.random(rng)))
    kernel = of(C)

    class Odd(dict):
        """An array of Python ints."""

        shape = 4, 8

    assert (*kernel.sum_of(a, b)[:2], True) == add_classes(K, equation, *a[:2], *b[:2])
    assert (*kernel.double(a)[:2], True) == double_class(K, equation, *a[:2])
    found = multiple_of_class(K, equation, *a[:2], (12345).to_bytes(2, "little"), [0] * 17, Odd())
    assert (*kernel.multiple(12345, a)[:2], True) == found
