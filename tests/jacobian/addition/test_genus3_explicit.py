"""The explicit formulas of genus 3, in Python and compiled: equal to Cantor on every pair, special case and ladder."""

from itertools import product
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, HyperellipticCurve, poly
from jacobian.addition import cantor
from jacobian.addition.calls import WordKernel
from jacobian.addition.genus2_prime import GmpFormulas
from jacobian.addition.genus3_calls import CubicKernel
from jacobian.addition.genus3_prime import SepticFormulas
from jacobian.batch.equation import Equation
from tests.jacobian.group_curves import random_curve, triple

PRIMES = (11, 10007, 2**31 - 1, 2**61 - 1, 2**63 - 25, 2**127 - 1, 2**255 - 19)


def septic(p, seed):
    """y² = f, f monic of degree 7."""
    return Equation(random_curve(GF(p), 3, seed, model="ramified")).curve


def with_branch_points(p):
    """y² = (x − 2)(x − 3)(x − 4)·g: (2, 0), (3, 0), (4, 0) are branch points."""
    rng, K = Random(p), GF(p)
    roots = poly.mul(K, poly.mul(K, (p - 2, 1), (p - 3, 1)), (p - 4, 1))
    while True:
        g = (*[rng.randrange(p) for _ in range(4)], 1)
        f = poly.mul(K, roots, g)
        if len(poly.gcd(K, f, poly.derivative(K, f))) == 1:
            return HyperellipticCurve(K, f)


def kernels(C):
    found = [SepticFormulas(C), GmpFormulas(C, SepticFormulas)]
    return [*found, CubicKernel(C)] if C.field.p < 1 << 63 else found


def special_classes(C, rng):
    """0, points in common, opposite and twice, every weight, classes of order 2."""
    J = C.jacobian()
    P, Q, R, S, T = (C.random_point(rng) for _ in range(5))
    i = C.involution
    A, B = (2, 0), (3, 0)
    full = [(P, Q, R), (P, Q, S), (P, S, T), (P, P, Q), (P, P, P), (i(P), Q, R), (i(P), i(Q), R), (i(P), i(Q), i(R))]
    torsion = [(A, B, (4, 0)), (A, B, P), (A, P, Q), (A, B), (A,), (A, P)]
    lower = [(P, Q), (i(P), Q), (R, S), (P, P), (P,), (i(P),), (T,)]
    return [J.zero(), *(J.from_points(list(some)) for some in full + torsion + lower)]


@pytest.mark.parametrize("p", [3, 5])
def test_every_pair_of_a_small_group(p):
    C = septic(p, "pairs")
    triples = [triple(D) for D in C.jacobian().points()]
    assert len(triples) == C.jacobian().order()
    every = kernels(C)
    for a in triples:
        assert all(kernel.double(a) == cantor.double(C, a) for kernel in every)
    for a, b in product(triples, repeat=2):
        total = cantor.sum_of(C, a, b)
        assert all(kernel.sum_of(a, b) == total for kernel in every), (a, b)


@pytest.mark.parametrize("p", PRIMES)
def test_special_classes(p):
    C, rng = with_branch_points(p), Random(p)
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
            assert others in ([], [first]), (m, a)
    # the class of three branch points is its own opposite
    assert every[-1].double(classes[9]) == cantor.zero(C)


def test_which_classes_are_special(monkeypatch):
    """General ones never reach Cantor; a quintic of lower degree, s₂ = 0, does."""
    C, rng, asked = septic(2**61 - 1, "special"), Random(5), []
    for name in ("sum_of", "double"):
        original = getattr(cantor, name)
        monkeypatch.setattr(cantor, name, lambda *given, of=original: asked.append(1) or of(*given))
    formulas, J = SepticFormulas(C), C.jacobian()
    a, b = (triple(J.from_points([C.random_point(rng) for _ in range(3)])) for _ in range(2))
    total = formulas.sum_of(a, b)
    assert formulas.double(total)
    assert not asked
    # a sum of weight 2: the quintic through a and b meets the curve in fewer points
    lower = triple(J.from_points([C.random_point(rng), C.random_point(rng)]))
    other = formulas.sum_of(lower, cantor.negate(C, a))
    asked.clear()
    assert len(other[1]) == 3
    assert formulas.sum_of(a, other) == lower
    assert asked == [1]


@pytest.mark.parametrize("p", [7, 13])
def test_ladders_through_every_multiple_of_a_class(p):
    """All m up to beyond the order: every ladder meets 0, equal and opposite classes on its way."""
    C = septic(p, "ladder")
    kernel, J = CubicKernel(C), C.jacobian()
    a = total = triple(J.random(Random(p)))
    for m in range(1, J.order() + 20):
        assert kernel.multiple(m, a) == total, (m, a)
        total = kernel.sum_of(total, a)
    assert kernel.multiple(J.order(), a) == cantor.zero(C)


CURVES = {p: septic(p, "walk") for p in PRIMES}


@pytest.mark.parametrize("p", PRIMES)
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 2**32), m=st.integers(1, 2**260), n=st.integers(1, 2**260))
def test_sums_and_multiples(p, seed, m, n):
    C = CURVES[p]
    rng, J, every = Random(seed), C.jacobian(), kernels(C)
    # few points, so that classes share some
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
    kernel = every[-1]
    first, second = kernel.multiple(m, a), kernel.multiple(n, a)
    assert kernel.multiple(m + n, a) == cantor.sum_of(C, first, second)
    assert kernel.multiple(m, cantor.sum_of(C, a, b)) == cantor.sum_of(C, first, kernel.multiple(m, b))


def test_a_class_of_low_degree_is_left_to_the_general_path(monkeypatch):
    """v₂ = 0 in the sum of two general classes: the short call cannot tell it from a special case."""
    C = septic(13, "flat")
    kernel, J, rng, asked = CubicKernel(C), C.jacobian(), Random(0), []
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
