"""Sums on Kummer surfaces over GF(p) agree with the group, for every pair of small groups and every special point."""

import copy
import pickle
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jacobian import GF, QQ, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve
from jacobian.numbers.threads import set_threads
from jacobian.relatives.pseudo_group import PseudoGroup
from tests.jacobian.group_curves import random_curve

MODELS = ("ramified", "split", "inert")
LONG = [
    *((2**127 - 1, model) for model in MODELS),
    (2**61 - 1, "split"),
    (2**64 + 13, "ramified"),
    (2**128 - 159, "split"),
    (2**128 + 51, "split"),
]


def assert_that_sums_are_those_of_the_group(S, pairs):
    """Sums and differences, doubles, multiples; all as arrays."""
    first, second = ([S.point(D) for D in some] for some in zip(*pairs, strict=True))
    plus, minus = ([S.point(G) for G in some] for some in zip(*[(D + E, D - E) for D, E in pairs], strict=True))
    assert [tuple(x) for x in S.add(first, second, minus)] == plus
    assert [tuple(x) for x in S.add(first, second, plus)] == minus
    classes = list({D for D, _ in pairs})
    points = [S.point(D) for D in classes]
    assert [tuple(x) for x in S.double(points)] == [S.point(D + D) for D in classes]
    scalars = [11 * i - 90 for i in range(len(classes))]
    assert [tuple(x) for x in S.multiple(scalars, points)] == [
        S.point(m * D) for m, D in zip(scalars, classes, strict=True)
    ]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("with_h", [False, True])
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("p", [3, 5])
def test_every_pair_of_a_small_group(p, model, with_h):
    C = random_curve(GF(p), 2, "pseudo", model=model, with_h=with_h)
    S, every = PseudoGroup(C), list(C.jacobian().points())
    images = [S.point(D) for D in every]
    # D and −D have the same image, and no other classes
    assert len(set(images)) == len({frozenset((D, -D)) for D in every})
    some = every[:: max(1, len(every) // 16)]
    assert_that_sums_are_those_of_the_group(S, [(D, E) for D in some for E in some])
    for D in some[:4]:
        for m in range(-2, C.jacobian().order() + 2):
            assert S.multiple(m, S.point(D)) == S.point(m * D)


@pytest.mark.parametrize("model", MODELS)
def test_interpreted_loops_give_the_same(model, monkeypatch):
    monkeypatch.setattr(PseudoGroup, "_is_compiled", False)
    C = random_curve(GF(7), 2, "pseudo", model=model)
    some = list(C.jacobian().points())[::9]
    S = PseudoGroup(C)
    assert "in Python" in S.explain()
    assert_that_sums_are_those_of_the_group(S, [(D, E) for D in some for E in some])


def special_classes(J, rng):
    """0, order 2, points in common and opposite, weights below 2, both points at infinity."""
    C = J.curve
    P, Q, R = (C.random_point(rng) for _ in range(3))
    some = [(P, Q), (P, R), (P, P), (C.involution(P), Q)]
    if C.model != "inert":
        some += [(P,), (Q,)]
    if C.model == "split":
        some += [(point,) for point in C.points_at_infinity()] + [C.points_at_infinity()]
    classes = [J.zero(), *(J.from_points(points) for points in some)]
    return classes + [J.from_mumford([1], [], n) for n in (0, 2)] if C.model == "split" else classes


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("p", "model"), LONG)
def test_special_points_over_long_primes(p, model):
    rng = Random(p)
    J = random_curve(GF(p), 2, "pseudo", model=model, with_h=model == "inert").jacobian()
    classes = special_classes(J, rng)
    some = classes if p < 1 << 128 else classes[:4]
    assert_that_sums_are_those_of_the_group(PseudoGroup(J.curve), [(D, E) for D in some for E in some])


@pytest.mark.parametrize("degree", [5, 6])
def test_classes_of_order_two(degree):
    # y² = x(x − 1)(x − 2)(x − 3)(x − 4)(…)
    K = GF(2**127 - 1)
    f = [0, 24, -50, 35, -10, 1] if degree == 5 else [0, -120, 274, -225, 85, -15, 1]
    J = HyperellipticCurve(K, f).jacobian()
    torsion = [J.from_points([(i, 0), (j, 0)]) for i, j in ((0, 1), (1, 2), (2, 3), (0, 4))]
    S, D = PseudoGroup(J.curve), J.random(Random(1))
    assert S.double(S.point(torsion[0])) == S.zero == S.point(J.zero())
    classes = [*torsion, J.zero(), D, D + torsion[0]]
    assert_that_sums_are_those_of_the_group(S, [(E, F) for E in classes for F in classes])


GROUPS = {model: random_curve(GF(2**127 - 1), 2, "ladder", model=model).jacobian() for model in MODELS}


@pytest.mark.parametrize("model", MODELS)
@settings(max_examples=6)
@given(seed=st.integers(0, 2**32), m=st.integers(-(2**260), 2**260), n=st.integers(0, 2**130))
def test_ladders(model, seed, m, n):
    J = GROUPS[model]
    S, D = PseudoGroup(J.curve), J.random(Random(seed))
    x = S.point(D)
    assert S.multiple(m, x) == S.point(m * D)
    first, second, difference = S.multiple(m, x), S.multiple(n, x), S.multiple(m - n, x)
    assert S.add(first, second, difference) == S.multiple(m + n, x)
    assert S.double(first) == S.multiple(2 * m, x)


def test_arrays_on_any_number_of_threads():
    J = GROUPS["split"]
    S, D = PseudoGroup(J.curve), J.random(Random(2))
    x = np.array([S.point(D)] * 700, object)
    try:
        set_threads(1)
        one = S.multiple(range(700), x)
    finally:
        set_threads(None)
    assert (S.multiple(np.arange(700), x) == one).all()
    assert (S.add(one[1:-1], x[1:-1], one[:-2]) == one[2:]).all()
    assert tuple(one[699]) == S.point(699 * D)
    assert S.multiple(5, x[:0]).shape == (0, 4)


def test_the_group_as_a_value():
    J = GROUPS["ramified"]
    S = PseudoGroup(J.curve)
    assert S == PseudoGroup(J.curve) == pickle.loads(pickle.dumps(S)) == copy.deepcopy(S)
    assert S.explain().startswith("compiled code on two words")
    assert "in Python" in PseudoGroup(random_curve(GF(2**128 + 51), 2, "pseudo")).explain()


def test_what_is_refused():
    J = GROUPS["ramified"]
    S, D = PseudoGroup(J.curve), J.random(Random(3))
    x = S.point(D)
    for wrong in ((1, 2, 3, 4), (0, 0, 0, 0), tuple(2 * c % J.field.p for c in x)):
        with pytest.raises(ArgumentError, match=r"x: .* is no point of the surface"):
            S.double(wrong)
        with pytest.raises(ArgumentError, match=r"difference: .* is no point of the surface"):
            S.add([x, x], [x, x], [S.zero, wrong])
    for wrong in (3, "abcd", [1, 2, 3], [[1, 2], [3]], None, [np.zeros((2, 2)), np.zeros((2, 3))]):
        with pytest.raises(ArgumentError, match=r"x = .*a point, four residues"):
            S.double(wrong)
    with pytest.raises(FieldError):
        S.double((1, 0.5, 0, 0))
    with pytest.raises(ArgumentError, match="as many of each"):
        S.add(x, [x], [x])
    for wrong in (0.5, "7", [1], [[1, 2], [3]]):
        with pytest.raises(ArgumentError):
            S.multiple(wrong, x)
    with pytest.raises(ArgumentError, match="one for each row"):
        S.multiple([1, 2], [x])
    with pytest.raises(CurveMismatch):
        S.point(GROUPS["split"].zero())
    for C in (HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]), HyperellipticCurve(GF(2), [1, 0, 0, 0, 0, 1], [1])):
        with pytest.raises(FieldError, match="GF\\(p\\), p odd"):
            PseudoGroup(C)
    for C in (HyperellipticCurve(GF(7), [1, 1, 0, 1]), HyperellipticCurve(GF(3, 2, (2, 2, 1)), [0, 1, 0, 0, 0, 1])):
        with pytest.raises(FieldError, match="genus 2"):
            PseudoGroup(C)
    with pytest.raises(ArgumentError, match="curve = "):
        PseudoGroup(J)
