"""Isomorphisms of curves: images of points and classes, composition, and all of them between two curves."""

from random import Random

import pytest

from jacobian import (
    GF,
    QQ,
    RR,
    ArgumentError,
    CurveMismatch,
    FieldError,
    HyperellipticCurve,
    JacobianError,
    NotRepresentable,
    poly,
)
from jacobian.models.isomorphic import automorphisms, is_isomorphic, isomorphisms
from jacobian.models.isomorphism import Isomorphism
from jacobian.models.standard import move_to_infinity, odd_degree_model, without_h


def random_curve(K, genus, rng):
    """A smooth curve over a finite field, with h half of the time and always in characteristic 2."""
    while True:
        f = poly.random(K, 2 * genus + rng.choice((2, 3)), rng)
        h = poly.random(K, rng.randint(0, genus + 2), rng) if K.characteristic == 2 or rng.random() < 0.5 else ()
        try:
            C = HyperellipticCurve(K, f, h)
        except JacobianError:
            continue
        if C.genus == genus:
            return C


def random_isomorphism(C, rng):
    """A random isomorphism, sometimes with c = 0, which fixes infinity."""
    K = C.field
    while True:
        matrix = [K.random(rng) if rng.random() < 0.7 else K.zero for _ in range(4)]
        try:
            return Isomorphism(C, matrix, K.random(rng), poly.random(K, rng.randint(0, C.genus + 1), rng))
        except ArgumentError:
            continue


def cases(count, seed):
    rng = Random(seed)
    for _ in range(count):
        K = rng.choice([GF(101), GF(7, 2), GF(2, 5), GF(3, 3), GF(2**61 - 1)])
        C = random_curve(K, rng.choice((1, 2, 3, 4)), rng)
        yield C, random_isomorphism(C, rng), rng


def test_points_and_classes_go_there_and_back():
    tried = set()
    for C, iso, rng in cases(40, 5):
        E, back = iso.target, iso.inverse()
        plus = C.infinity_plus if C.model == "split" else None
        assert back.target == C
        assert back * iso == Isomorphism(C, (1, 0, 0, 1), infinity_plus=plus)
        points = [C.random_point(rng) for _ in range(3)] + list(C.points_at_infinity())
        for P in points:
            assert E.check_point(iso(P)) == iso(P)
            assert back(iso(P)) == P
        if "inert" in (C.model, E.model) and C.genus % 2:
            # one of the two has no classes to compare
            continue
        tried.add((C.model, E.model))
        J, target = C.jacobian(), E.jacobian()
        D, F = J.random(rng), J.random(rng)
        assert back(iso(D)) == D
        assert iso(D + F) == iso(D) + iso(F)
        if "inert" not in (C.model, E.model):
            P, Q = points[0], points[-1]
            assert iso(J(P, Q)) == target(iso(P), iso(Q))
    assert {a for a, _ in tried} == {b for _, b in tried} == {"ramified", "split", "inert"}


def test_a_class_through_the_point_that_goes_to_infinity():
    C = HyperellipticCurve(GF(101), [3, 1, 4, 1, 5, 9, 4])
    P = C.lift_x(next(x for x in range(1, 101) if len(C.lift_x(x, all=True)) == 2))
    iso = move_to_infinity(C, P)
    J, target = C.jacobian(), iso.target.jacobian()
    plus, minus = iso.target.points_at_infinity()
    assert (iso(P), iso(C.involution(P))) == (plus, minus)
    assert iso(2 * J(P, C.involution(P))) == 2 * target(plus, minus)


def test_one_after_the_other():
    for C, first, rng in cases(20, 6):
        second = random_isomorphism(first.target, rng)
        P = C.random_point(rng)
        assert (second * first)(P) == second(first(P))
        assert (second * first).target == second.target
        assert (second * first).inverse() == first.inverse() * second.inverse()


@pytest.mark.parametrize(
    ("field", "f", "order"),
    [
        # groups over fields that hold them all (Cardona & Quer 2007)
        ((5, 2), [0, -1, 0, 0, 0, 1], 240),
        ((7, 2), [0, -1, 0, 0, 0, 1], 48),
        ((13, 1), [1, 0, 0, 0, 0, 0, 1], 24),
        ((11, 1), [1, 0, 0, 0, 0, 1], 10),
        # twice the order of PGL2(7)
        ((7, 2), [0, -1, 0, 0, 0, 0, 0, 1], 672),
    ],
)
def test_groups_of_automorphisms(field, f, order):
    K = GF(*field)
    found = automorphisms(HyperellipticCurve(K, [poly.integer(K, c) for c in f]))
    assert len(found) == len(set(found)) == order
    identity, involution = found[:2]
    P = identity.source.random_point(Random(1))
    assert (identity(P), involution(P)) == (P, identity.source.involution(P))
    assert {a * b for a in found[:5] for b in found[:30]} <= set(found)


@pytest.mark.parametrize(
    ("f", "order"), [([1, 0, 0, 0, 0, 0, 1], 8), ([0, -1, 0, 0, 0, 1], 4), ([1, 3, 4, 5, 2, 1], 2)]
)
def test_automorphisms_over_the_rational_numbers(f, order):
    assert len(automorphisms(HyperellipticCurve(QQ, f))) == order


def test_an_isomorphism_is_found_whatever_its_height():
    C = HyperellipticCurve(QQ, ["1/2", 3, 0, -4, 5, 7, 2], [1, 2])
    iso = Isomorphism(C, ["2/3", 5, "-7/2", 11], "3/5", [1, "1/2"])
    found = isomorphisms(C, iso.target)
    assert iso in found
    assert len(found) == 2
    assert not is_isomorphic(C, iso.target.quadratic_twist(2))


@pytest.mark.parametrize("K", [GF(101), GF(5, 2), GF(7)], ids=lambda K: K.name)
def test_there_are_as_many_isomorphisms_as_automorphisms(K):
    rng = Random(7)
    for genus in (2, 3):
        C = random_curve(K, genus, rng)
        iso = random_isomorphism(C, rng)
        found = isomorphisms(C, iso.target)
        assert iso in found
        assert len(set(found)) == len(found) == len(automorphisms(C))
        P = C.random_point(rng)
        for other in found:
            assert other.target == iso.target
            assert iso.target.is_on(other(P))


def test_a_twist_is_another_curve_over_the_field_and_the_same_above():
    K, L = GF(101), GF(101, 2)
    C = HyperellipticCurve(K, [3, 1, 4, 1, 5, 9, 4], [1, 1])
    E = C.quadratic_twist()
    assert not is_isomorphic(C, E)
    assert is_isomorphic(C.change_ring(L), E.change_ring(L))


def test_standard_equations():
    rng, kinds = Random(11), set()
    for C, _, _ in cases(40, 8):
        K, g = C.field, C.genus
        P = C.random_point(rng)
        iso = move_to_infinity(C, P)
        assert iso(P) == iso.target.points_at_infinity()[0]
        assert (iso.target.model == "ramified") == (C.involution(P) == P)
        branches = roots_of_branches(C)
        kinds.add(bool(branches) or C.model == "ramified")
        if branches or C.model == "ramified":
            odd = odd_degree_model(C).target
            assert (odd.model, len(odd.f), len(odd.h) <= g + 1) == ("ramified", 2 * g + 2, True)
        else:
            with pytest.raises(NotRepresentable, match="no rational Weierstrass point"):
                odd_degree_model(C)
        if K.characteristic == 2:
            with pytest.raises(FieldError, match="characteristic 2"):
                without_h(C)
        else:
            assert (without_h(C).target.h, without_h(C).target.f) == ((), C.discriminant)
    assert kinds == {True, False}


def roots_of_branches(C):
    """Whether an affine point with P = ιP is rational: by a search through a small field, by a gcd over a large one."""
    K = C.field
    if K.order > 200:
        branches = C.discriminant
        x = (K.zero, K.one)
        return len(poly.gcd(K, branches, poly.sub(K, poly.power_mod(K, x, K.order, branches), x))) > 1
    return any(len(C.lift_x(x, all=True)) == 1 for x in range(K.order))


def test_what_is_no_isomorphism_is_refused():
    C = HyperellipticCurve(GF(101), [3, 1, 4, 1, 5, 1])
    with pytest.raises(ArgumentError, match="ad − bc"):
        Isomorphism(C, (1, 2, 2, 4))
    with pytest.raises(ArgumentError, match="scale = 0"):
        Isomorphism(C, (1, 0, 0, 1), 0)
    with pytest.raises(ArgumentError, match="four numbers"):
        Isomorphism(C, (1, 0, 0))
    with pytest.raises(ArgumentError, match="matrix = 3: the four numbers"):
        Isomorphism(C, 3)
    with pytest.raises(ArgumentError, match=r"move = .*at most g \+ 1 = 3"):
        Isomorphism(C, (1, 0, 0, 1), 1, [0, 0, 0, 0, 1])
    with pytest.raises(FieldError, match="exact fields"):
        Isomorphism(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]), (1, 0, 0, 1))
    with pytest.raises(CurveMismatch, match="the isomorphism begins at"):
        Isomorphism(C, (1, 1, 0, 1))(C.quadratic_twist().jacobian().zero())
    with pytest.raises(CurveMismatch, match="over two fields"):
        isomorphisms(C, C.change_ring(GF(101, 2)))
    with pytest.raises(ArgumentError, match="genus = 1"):
        automorphisms(HyperellipticCurve(GF(101), [3, 1, 0, 1]))
    with pytest.raises(FieldError, match="odd characteristic"):
        automorphisms(HyperellipticCurve(GF(2, 3), [1, 0, 0, 0, 0, 1], [1]))
    with pytest.raises(NotRepresentable, match="no rational Weierstrass point"):
        odd_degree_model(HyperellipticCurve(QQ, [2, 0, 0, 0, 0, 0, 1]))
