"""Invariant factors, generators, torsion and divisibility, compared with complete lists of small groups."""

from collections import Counter
from math import gcd, prod
from random import Random

import pytest

from jacobian import (
    GF,
    QQ,
    ArgumentError,
    CurveMismatch,
    HyperellipticCurve,
    Infeasible,
    NotAMultiple,
    NotRepresentable,
)
from jacobian.fields.factor import factor
from jacobian.finite.structure import LARGEST_TABLE, PrimaryGroup
from tests.jacobian.group_curves import random_curve
from tests.jacobian.jacobian_rows import ROWS
from tests.jacobian.law.test_reference_cases import curve_of, of_kind

SMALL = [pytest.param(row.curve, id=str(row)) for row in ROWS if row.field == "GF(7)" and row.genus <= 2]
# Jacobians whose group is far from cyclic
SMALL += [
    pytest.param(HyperellipticCurve(GF(p), f), id=f"GF({p}) {f}")
    for p, f in [
        (7, [0, 6, 0, 0, 0, 1]),
        (7, [1, 0, 0, 0, 0, 0, 1]),
        (5, [0, 1, 0, 0, 0, 0, 0, 1]),
        (11, [1, 0, 0, 0, 0, 0, 1]),
        (13, [0, 1, 0, 0, 0, 12]),
        (5, [0, 4, 0, 0, 0, 0, 0, 0, 1]),
    ]
]
SMALL += [
    pytest.param(random_curve(GF(*q), g, "structure", model=model), id=f"GF{q} {g} {model}")
    for q, g, model in [((2, 3), 2, "ramified"), ((2, 3), 2, "split"), ((3, 2), 2, "inert"), ((5,), 3, "split")]
]


def is_structure(S, J):
    """Whether S describes J: divisibility, orders, and as many elements as the order says."""
    assert all(b % a == 0 for a, b in zip(S.invariants, S.invariants[1:], strict=False))
    assert all(d > 1 for d in S.invariants)
    assert [D.order() for D in S.generators] == list(S.invariants)
    assert S.order == prod(S.invariants) == J.order()
    return True


@pytest.mark.thinned(3)
@pytest.mark.parametrize("C", SMALL)
def test_the_generators_generate_the_listed_group(C):
    J = C.jacobian()
    S = J.structure()
    assert is_structure(S, J)
    listed = list(J.points())
    elements = list(S.elements()) or [J.zero()]
    assert len(elements) == len(set(elements)) == len(listed)
    assert set(elements) == set(listed)
    assert len(S.invariants) <= 2 * C.genus
    assert J.exponent() == S.exponent


@pytest.mark.thinned(3)
@pytest.mark.parametrize("C", SMALL)
def test_log_has_the_coordinates_of_all_classes(C):
    J = C.jacobian()
    S = J.structure()
    for D in list(J.points())[:300]:
        c = S.log(D)
        assert all(0 <= x < d for x, d in zip(c, S.invariants, strict=True))
        assert J.combination(c, S.generators) == D


def test_log_in_subgroups():
    """In torsion subgroups, which do not contain all classes, and over QQ."""
    J = HyperellipticCurve(GF(31), [1, 0, 0, 0, 0, 0, 1]).jacobian()
    whole, halves = J.structure(), J.torsion(2)
    assert whole.invariants == (3, 3, 12, 12)
    assert {halves.log(D) for D in halves.elements()} == {(a, b) for a in (0, 1) for b in (0, 1)}
    with pytest.raises(NotAMultiple, match="is not 0"):
        halves.log(whole.generators[-1])
    one = type(whole)(whole.invariants[-1:], whole.generators[-1:])
    with pytest.raises(NotAMultiple, match="no sum of multiples"):
        one.log(whole.generators[-2])
    with pytest.raises(CurveMismatch):
        whole.log(HyperellipticCurve(GF(31), [1, 0, 0, 0, 0, 1]).jacobian().zero())
    with pytest.raises(ArgumentError):
        whole.log((0, 1))
    found = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().rational_torsion().found
    assert [found.log(m * found.generators[0]) for m in range(3)] == [(0,), (1,), (2,)]


@pytest.mark.thinned(3)
@pytest.mark.parametrize("C", SMALL)
def test_torsion_is_what_m_annihilates(C):
    J = C.jacobian()
    listed = list(J.points())
    orders = Counter(D.order() for D in listed)
    for m in (1, 2, 3, 4, 12, J.order()):
        T = J.torsion(m)
        expected = sum(count for order, count in orders.items() if m % order == 0)
        assert T.order == expected == prod(gcd(m, d) for d in J.structure().invariants)
        elements = list(T.elements())
        assert len(set(elements)) == len(elements)
        assert all(not m * D for D in elements)


@pytest.mark.thinned(2)
@pytest.mark.parametrize("C", SMALL[::3])
def test_divisibility_is_being_a_multiple(C):
    J = C.jacobian()
    listed = list(J.points())[:400]
    whole = set(J.points())
    for m in (2, 3, 4, 6, 25):
        multiples = {m * D for D in whole}
        assert all(J.is_divisible(D, m) == (D in multiples) for D in listed[::9])


@pytest.mark.parametrize("case", [p for p in of_kind("count") if "group_structure" in p.values[0]["expected"]])
def test_published_structures(case):
    J = curve_of(case).jacobian()
    S = J.structure()
    assert sorted(S.invariants) == sorted(case["expected"]["group_structure"])
    assert is_structure(S, J)


@pytest.mark.parametrize("p", [1009, 10007, 999_983])
def test_rational_two_torsion_is_read_off_the_factors_of_f(p):
    # y² = f(x), deg f odd: the rank of J[2](K) is the number of irreducible factors less one (Gross 2012)
    for genus in (2, 3):
        for seed in range(3):
            C = random_curve(GF(p), genus, f"factors {seed}", model="ramified")
            J = C.jacobian()
            monic = tuple(C.field.div(c, C.f[-1]) for c in C.f)
            assert len(J.torsion(2).invariants) == len(factor(C.field, monic)) - 1


def test_structure_of_medium_groups():
    for q, g, model in [
        ((10007,), 2, "split"),
        ((10007,), 3, "ramified"),
        ((3, 4), 2, "ramified"),
        ((2, 8), 2, "split"),
    ]:
        J = random_curve(GF(*q), g, "medium", model=model).jacobian()
        assert is_structure(J.structure(), J)


def test_a_full_torsion_group():
    # 19 ≡ 4 modulo 5: Frobenius over GF(19²) is −19, and J(GF(19²)) = (Z/20)⁴
    J = HyperellipticCurve(GF(19, 2), [1, 0, 0, 0, 0, 1]).jacobian()
    assert J.structure().invariants == (20, 20, 20, 20)
    assert J.torsion(5).invariants == (5, 5, 5, 5)
    assert len(set(J.torsion(4).elements())) == 256


def test_the_same_generators_every_time():
    C = random_curve(GF(101), 2, "seeded")
    assert C.jacobian().structure() == C.jacobian().structure()


def test_primary_groups_grow_to_what_their_elements_generate():
    J = HyperellipticCurve(GF(19, 2), [1, 0, 0, 0, 0, 1]).jacobian()
    for prime, top in ((2, 2), (5, 1)):
        group, rng = PrimaryGroup(J.zero(), prime), Random(prime)
        known = {J.zero()}
        for _ in range(12):
            x = 20 // prime**top * J.random(rng)
            grew = group.insert(x)
            assert grew == (x not in known)
            if grew:
                known = {D + i * x for D in known for i in range(prime**top)}
            assert group.order == len(known)
            assert prod(prime**e for e in group.exponents) == len(known)
        D = 20 // prime**top * J.random(rng)
        assert group.combination(group.coordinates(D)) == D
        assert group.coordinates((prime + 1) * D + group.generators[0]) is not None


def test_errors_of_structures():
    J = random_curve(GF(101), 2, "errors").jacobian()
    with pytest.raises(ArgumentError, match=r"m = 0: a positive integer"):
        J.torsion(0)
    with pytest.raises(ArgumentError, match=r"m = -2"):
        J.is_divisible(J.zero(), -2)
    with pytest.raises(ArgumentError, match=r"m = 1\.5"):
        J.torsion(1.5)
    with pytest.raises(ArgumentError, match="the prime factors of"):
        J.structure(primes=[2, 3])
    with pytest.raises(NotRepresentable, match="inert of odd genus"):
        HyperellipticCurve(GF(3), [1, 2, 0, 0, 0, 0, 0, 0, 2]).jacobian().structure()


def test_tables_have_a_limit():
    group = PrimaryGroup(HyperellipticCurve(GF(101), [1, 0, 0, 0, 0, 1]).jacobian().zero(), 2**61 - 1)
    with pytest.raises(Infeasible, match=rf"a table of \d+\^2 entries, more than {LARGEST_TABLE}"):
        group._baby_steps(2)
