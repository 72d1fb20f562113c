"""The explicit formulas of genus 3, in Python and compiled: equal to Cantor on every pair, special case and ladder."""

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian.addition import cantor
from jacobian.addition.calls import TwoWordKernel, WordKernel, two_word_context, word_kernel
from jacobian.addition.choice import python_kernel
from jacobian.addition.class_loops import add_classes, double_class, multiple_of_class
from jacobian.addition.explicit import GmpFormulas, PrimeFormulas
from jacobian.addition.short import short_equation
from tests.jacobian.group_curves import triple
from tests.jacobian.septics import octic, septic, special_classes, with_branch_points
from tests.jacobian.two_words import PRIMES as OF_TWO_WORDS

PRIMES = (11, 10007, 2**31 - 1, 2**61 - 1, 2**63 - 25, *OF_TWO_WORDS, 2**128 + 51, 2**255 - 19)


def kernels(C):
    if C.model == "split":
        return [PrimeFormulas(C), GmpFormulas(C)]
    p, found = C.field.p, [PrimeFormulas(C), GmpFormulas(C)]
    if p < 1 << 63:
        found.append(word_kernel(C))
    return [*found, TwoWordKernel(C, python_kernel(C))] if p < 1 << 128 else found


@pytest.mark.parametrize(
    ("p", "curve"),
    [(3, septic), (3, octic), *(pytest.param(5, curve, marks=pytest.mark.slow) for curve in (septic, octic))],
)
def test_every_pair_of_a_small_group(p, curve):
    C = curve(p, "pairs")
    triples = [triple(D) for D in C.jacobian().points()]
    assert len(triples) == C.jacobian().order()
    every = kernels(C)
    for a in triples:
        assert all(kernel.double(a) == cantor.double(C, a) for kernel in every)
    for a, b in product(triples, repeat=2):
        total = cantor.sum_of(C, a, b)
        assert all(kernel.sum_of(a, b) == total for kernel in every), (a, b)


@pytest.mark.thinned(7)
@pytest.mark.parametrize("model", ["ramified", "split"])
@pytest.mark.parametrize("p", PRIMES)
def test_special_classes(p, model):
    C, rng = with_branch_points(p, model), Random(p)
    classes = [triple(D) for D in special_classes(C, rng)]
    every = kernels(C)
    for a, b in product(classes, repeat=2):
        total = cantor.sum_of(C, a, b)
        assert all(kernel.sum_of(a, b) == total for kernel in every), (a, b)
    for a in classes:
        double = cantor.double(C, a)
        assert all(kernel.double(a) == double for kernel in every), a
        for m in (1, 2, 3, 8, rng.getrandbits(70) + 1):
            first, *others = (kernel.multiple(m, a) for kernel in every[1:])
            assert all(other == first for other in others), (m, a)
    if model == "ramified":
        # the class of three branch points is its own opposite
        assert every[-1].double(classes[9]) == triple(C.jacobian().zero())


@pytest.mark.parametrize("curve", [septic, octic])
def test_which_classes_are_special(curve, monkeypatch):
    """General ones never reach Cantor; a sum of lower weight does."""
    C, rng, asked = curve(2**61 - 1, "special"), Random(5), []
    for name in ("sum_of", "double"):
        original = getattr(cantor, name)
        monkeypatch.setattr(cantor, name, lambda *given, of=original: asked.append(1) or of(*given))
    formulas, J = PrimeFormulas(C), C.jacobian()
    a, b = (triple(J.from_points([C.random_point(rng) for _ in range(3)])) for _ in range(2))
    total = formulas.sum_of(a, b)
    assert formulas.double(total)
    assert not asked
    # a sum of weight 2: the quintic through a and b, or the quartic after it, meets the curve in fewer points
    lower = triple(J.from_points([C.random_point(rng), C.random_point(rng)]))
    other = formulas.sum_of(lower, cantor.negate(C, a))
    asked.clear()
    assert len(other[1]) == 3
    assert formulas.sum_of(a, other) == lower
    assert asked == [1]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("p", [7, 13])
def test_ladders_through_every_multiple_of_a_class(p):
    """All m up to beyond the order: every ladder meets 0, equal and opposite classes on its way."""
    C = septic(p, "ladder")
    compiled, J = kernels(C)[2:], C.jacobian()
    a = total = triple(J.random(Random(p)))
    for m in range(1, J.order() + 20):
        assert all(kernel.multiple(m, a) == total for kernel in compiled), (m, a)
        total = compiled[0].sum_of(total, a)
    assert all(kernel.multiple(J.order(), a) == triple(C.jacobian().zero()) for kernel in compiled)


CURVES = {(p, curve): curve(p, "walk") for p in PRIMES for curve in (septic, octic)}


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("p", "curve"), CURVES)
@settings(max_examples=6)
@given(seed=st.integers(0, 2**32), m=st.integers(1, 2**260), n=st.integers(1, 2**260))
def test_sums_and_multiples(p, curve, seed, m, n):
    C = CURVES[p, curve]
    rng, J, every = Random(seed), C.jacobian(), kernels(C)
    # few points, so that classes have points in common
    points = [C.random_point(rng) for _ in range(4)]
    a, b = (triple(J.from_points(rng.choices(points, k=rng.randrange(4)))) for _ in range(2))
    for _ in range(4):
        total = cantor.sum_of(C, a, b)
        for kernel in every:
            found = kernel.sum_of(a, b)
            assert found == total
            assert kernel.double(a) == cantor.double(C, a)
            assert all(type(c) is int and 0 <= c < p for c in (*found[0], *found[1]))
        a, b = b, total
    for kernel in every[2:] or every[1:]:
        first, second = kernel.multiple(m, a), kernel.multiple(n, a)
        assert kernel.multiple(m + n, a) == cantor.sum_of(C, first, second)
        assert kernel.multiple(m, cantor.sum_of(C, a, b)) == cantor.sum_of(C, first, kernel.multiple(m, b))


def test_the_loops_interpreted_are_the_loops_compiled():
    C = septic(2**89 - 1, "walk")
    J, K, rng = C.jacobian(), two_word_context(C.field), Random(7)
    equation, kernel = short_equation(C, K.to_word), TwoWordKernel(C, python_kernel(C))
    a, b = (triple(D) for D in (J.random(rng), J.random(rng)))
    odd = type("Odd", (dict,), {"shape": (6, 8)})()
    assert (*kernel.sum_of(a, b)[:2], True) == add_classes(K, equation, *a[:2], *b[:2])
    assert (*kernel.double(a)[:2], True) == double_class(K, equation, *a[:2])
    found = multiple_of_class(K, equation, *a[:2], (12345).to_bytes(2, "little"), [0] * 17, odd)
    assert (*kernel.multiple(12345, a)[:2], True) == found


def test_a_class_of_low_degree_is_left_to_the_general_path(monkeypatch):
    """v₂ = 0 in the sum of two general classes: the short call cannot tell it from a special case."""
    C = septic(13, "flat")
    kernel, J, rng, asked = word_kernel(C), C.jacobian(), Random(0), []
    original = WordKernel.sum_of
    monkeypatch.setattr(WordKernel, "sum_of", lambda self, a, b: asked.append(1) or original(self, a, b))
    flat = next(D for D in J.points() if D.degree == 3 and len(D.v) == 2)
    while True:
        b = triple(J.random(rng))
        a = cantor.sum_of(C, triple(flat), cantor.negate(C, b))
        if len(a[1]) == len(b[1]) == 3:
            break
    assert kernel.sum_of(a, b) == triple(flat)
    assert asked == [1]
