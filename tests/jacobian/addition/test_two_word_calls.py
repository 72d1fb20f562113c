"""The compiled formulas of two words: equal to Cantor in Python on every pair, special case and ladder."""

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, HyperellipticCurve, poly
from jacobian.addition import cantor
from jacobian.addition.choice import python_kernel
from jacobian.addition.genus2_two_words import add_lines, double_line, multiple_line
from jacobian.addition.genus2_words import short_equation
from jacobian.addition.ladder import signed_digits
from jacobian.addition.two_word_calls import TwoWordKernel
from jacobian.batch.equation import Equation
from jacobian.numbers.two_words import two_words
from tests.jacobian.group_curves import random_curve, triple
from tests.jacobian.two_words import MODELS, PRIMES, special_classes


def short_curve(p, model, seed):
    """A curve with h = 0, and a monic f in degree 5."""
    return Equation(random_curve(GF(p), 2, seed, model=model)).curve


def of(C):
    return TwoWordKernel(C, python_kernel(C))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("p", [3, 5])
def test_every_pair_and_ladder_of_a_small_group(p, model):
    C = short_curve(p, model, "pairs")
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


def with_a_two_torsion_class(p, model):
    """y² = (x − 2)(x − 3)·g: (2, 0) and (3, 0) are branch points."""
    rng = Random(p)
    while True:
        g = [rng.randrange(1, p) for _ in range(4 if model == "ramified" else 5)]
        if model == "ramified":
            g[-1] = 1
        C = HyperellipticCurve(GF(p), poly.mul(GF(p), (6, p - 5, 1), tuple(g)))
        if C.genus == 2 and C.model == model:
            return C


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("p", PRIMES)
def test_special_classes_of_long_primes(p, model):
    C, rng = with_a_two_torsion_class(p, model), Random(p + 1)
    kernel, J = of(C), C.jacobian()
    torsion = J.from_points([(2, 0), (3, 0)])
    classes = [torsion, *special_classes(C, rng)]
    if model != "inert":
        classes.append(J.from_points([(2, 0)]))
    triples = [J._in(D) for D in classes]
    for a, b in product(triples, repeat=2):
        assert kernel.sum_of(a, b) == cantor.sum_of(C, a, b), (a, b)
    for a in triples:
        assert kernel.double(a) == cantor.double(C, a)
        for m in (1, 2, 3, 8, rng.getrandbits(70) + 1):
            assert kernel.multiple(m, a) == python_kernel(C).multiple(m, a), (m, a)
    assert kernel.double(triple(torsion)) == cantor.zero(C)


CURVES = {f"{p.bit_length()} bits, {model}": short_curve(p, model, "walk") for p in PRIMES for model in MODELS}


@pytest.mark.parametrize("name", CURVES)
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32), m=st.integers(1, 2**260), n=st.integers(1, 2**260))
def test_sums_and_multiples(name, seed, m, n):
    C = CURVES[name]
    kernel, rng, J = of(C), Random(seed), C.jacobian()
    # few points, so that classes share some
    points = [C.random_point(rng) for _ in range(3)]
    count = (0, 2) if C.model == "inert" else (0, 1, 2)
    a, b = (J._in(J.from_points(rng.choices(points, k=rng.choice(count)))) for _ in range(2))
    for _ in range(4):
        total = kernel.sum_of(a, b)
        assert total == cantor.sum_of(C, a, b)
        assert kernel.double(a) == cantor.double(C, a)
        assert all(type(c) is int and 0 <= c < C.field.p for c in (*total[0], *total[1]))
        a, b = b, total
    first, second = kernel.multiple(m, a), kernel.multiple(n, a)
    assert kernel.multiple(m + n, a) == cantor.sum_of(C, first, second)
    assert kernel.multiple(m, cantor.sum_of(C, a, b)) == cantor.sum_of(C, first, kernel.multiple(m, b))


@pytest.mark.parametrize("model", MODELS)
def test_the_loops_interpreted_are_the_loops_compiled(model):
    p = 2**89 - 1
    C = CURVES[f"89 bits, {model}"]
    J, K, rng = C.jacobian(), two_words(p), Random(7)
    equation = short_equation(C, K.to_word)
    D, E = ((D.u[1], D.u[0], D.v[1], D.v[0]) for D in (J.random(rng), J.random(rng)))
    kernel, digits = of(C), signed_digits(12345, 5)

    class Odd(dict):
        """An array of Python ints."""

        shape = 4, 8

    def flat(found):
        return [int(found[0]), *(c % p for c in found[1])]

    assert flat(add_lines(K, equation, D, E)) == list(kernel._sum(*D, *E))
    assert flat(double_line(K, equation, D)) == list(kernel._twice(*D))
    found = flat(multiple_line(K, equation, D, digits, Odd()))
    e1, e0, v1, v0 = found[1:]
    assert found[0]
    assert kernel.multiple(12345, ((D[1], D[0], 1), (D[3], D[2]), None))[:2] == ((e0, e1, 1), (v0, v1))
