"""Positions where formulas break: 2-torsion, opposite and common points, weights below g, infinity, transformed
equations.
"""

import pytest

from jacobian import GF, QQ, HyperellipticCurve, NotRepresentable, PointAtInfinity, poly
from jacobian.addition import cantor
from jacobian.fields.factor import roots
from jacobian.law.from_points import _cancel_opposites, pair_of_points
from tests.jacobian.group_curves import inner, outside
from tests.jacobian.jacobian_rows import ROWS, moved

FINITE = [pytest.param(row, id=str(row)) for row in ROWS if row.K != QQ and row.genus <= 4]


def affine(row, rng, count):
    return [row.curve.random_point(rng) for _ in range(count)]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", FINITE)
def test_a_point_and_its_opposite_cancel(row, rng):
    C, J = row.curve, row.curve.jacobian()
    P, Q = affine(row, rng, 2)
    assert not J.from_points([P, C.involution(P)])
    assert not J(P, P)
    assert J(P, Q) == -J(Q, P)
    assert J.from_points([P, Q]) + J.from_points([C.involution(P), C.involution(Q)]) == J.zero()
    assert J.from_points([P, Q, C.involution(Q), Q]) == J.from_points([P, Q])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", FINITE)
def test_sums_of_points_are_sums_of_classes(row, rng):
    C, J = row.curve, row.curve.jacobian()
    points = affine(row, rng, 2) * 2 + affine(row, rng, 2)
    pairs = [J.from_points(points[i : i + 2]) for i in (0, 2, 4)]
    assert J.from_points(points) == pairs[0] + pairs[1] + pairs[2]
    if C.model == "ramified":
        total = J.zero()
        for point in points:
            total = total + J(point)
        assert total == J.from_points(points)
        assert J(points[0]) == J(points[0], C.points_at_infinity()[0])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", FINITE)
def test_many_points_are_one_semi_reduced_pair(row, rng):
    """More than g points are added in parts; one pair of all of them, reduced, is the same class."""
    C, J, g = row.curve, row.curve.jacobian(), row.curve.genus
    for count in (g + 1, 2 * g + 1, 5 * g, 5 * g + 3):
        if C.model == "inert" and count % 2:
            continue
        points = affine(row, rng, count)
        kept, cancelled = _cancel_opposites(C, points)
        n = None if C.model != "split" else cancelled + (g - count + 1) // 2
        triple = (*pair_of_points(C, kept), n)
        assert J.from_points(points) == outside(J, cantor.reduce(J.curve.arithmetic_model, inner(J, *triple)))


def test_thousands_of_points(rng):
    """As a single pair they would take hours, since the time grows with the cube of their number."""
    C = HyperellipticCurve(GF(101), [1, 2, 0, 3, 0, 0, 1])
    J, P, Q = C.jacobian(), C.random_point(rng), C.random_point(rng)
    assert C.model == "split"
    assert J.from_points([P, Q] * 2000) == 2000 * J.from_points([P, Q])
    assert J.from_points([P, Q] * 2000 + [P]) == 2000 * J.from_points([P, Q]) + J.from_points([P])


@pytest.mark.thinned(2)
@pytest.mark.parametrize("row", FINITE)
def test_common_points_and_tangents(row, rng):
    J = row.curve.jacobian()
    P, Q, R = affine(row, rng, 3)
    assert J.from_points([P, Q]) + J.from_points([P, R]) == J.from_points([P, P, Q, R])
    assert J.from_points([P, Q]).double() == J.from_points([P, P, Q, Q])
    assert J.from_points([P, P]) + J.from_points([P, P]) == J.from_points([P] * 4) == J.from_points([P, P]).double()
    assert J.from_points([P, Q]) - J.from_points([P, R]) == J(Q, R)


@pytest.mark.thinned(3)
@pytest.mark.parametrize("row", [row for row in FINITE if row.values[0].model != "inert"])
def test_branch_points_have_order_two(row):
    C, J = row.curve, row.curve.jacobian()
    K = C.field
    locus = C.h if K.characteristic == 2 else C.discriminant
    points = [C.lift_x(x) for x in roots(K, locus)] if len(locus) > 1 else []
    for point in points:
        assert C.involution(point) == point
        assert not J.from_points([point, point])
        if C.model == "ramified":
            assert J(point)
            assert not J(point).double()
            assert J(point) == -J(point)


@pytest.mark.parametrize("row", [row for row in FINITE if row.values[0].model == "split"])
def test_both_points_at_infinity(row, rng):
    C, J, g = row.curve, row.curve.jacobian(), row.genus
    plus, minus = C.points_at_infinity()
    (P,) = affine(row, rng, 1)
    difference = J(plus, minus)
    assert not J(plus, plus)
    assert not J(minus, minus)
    assert not J.from_points([plus, minus])
    assert difference == -J(minus, plus)
    assert J(P, minus) - J(P, plus) == difference
    assert J(P, plus) + J(plus, P) == J.zero()
    assert J.from_points([plus, plus]) == difference
    assert J.from_points([P, plus]) + J.from_points([C.involution(P), minus]) == J.zero()
    assert C.involution(plus) == minus
    # steps by a class at infinity: n runs through its whole range and returns
    total = J.zero()
    for m in range(1, 3 * g + 4):
        total = total + difference
        assert 0 <= total.n <= g - len(total.u) + 1
        assert total == m * difference
        assert total - m * difference == J.zero()


@pytest.mark.parametrize(
    "row", [row for row in FINITE if row.values[0].model == "split" and row.values[0].genus % 2 == 0]
)
def test_the_other_name_for_infinity_is_the_same_group(row, rng):
    """Exchanging ∞₊ and ∞₋: for even g, where D∞ is symmetric, the reduced pairs are the same and the weights are
    exchanged.
    """
    C = row.curve
    twin = HyperellipticCurve(C.field, C.f, C.h, infinity_plus=C.infinity_minus)
    assert twin != C
    assert (twin.infinity_plus, twin.infinity_minus) == (C.infinity_minus, C.infinity_plus)
    J, K = C.jacobian(), twin.jacobian()
    flip = {1: -1, -1: 1}

    def across(points):
        return [PointAtInfinity(flip[P.sign]) if isinstance(P, PointAtInfinity) else P for P in points]

    P, Q, R, S = affine(row, rng, 4)
    plus, minus = C.points_at_infinity()
    for first, second in (([P, Q], [R, S]), ([P, plus], [R, R]), ([plus, plus], [minus, Q])):
        here, there = (
            J.from_points(first) + J.from_points(second),
            K.from_points(across(first)) + K.from_points(across(second)),
        )
        assert (here.u, here.v) == (there.u, there.v)
        assert here.n + there.n == C.genus - len(here.u) + 1


def test_semi_reduced_pairs_are_reduced(rng):
    C = HyperellipticCurve(GF(101), [3, 1, 4, 1, 5, 9, 4])
    J = C.jacobian()
    points = [C.random_point(rng) for _ in range(6)]
    kept, cancelled = _cancel_opposites(C, points)
    u, v = pair_of_points(C, kept)
    assert cancelled == 0
    assert len(u) == 7
    assert J.from_mumford(u, v) == J.from_points(points)
    assert J.from_mumford(u, v, 5) == J.from_mumford(u, v) + 7 * J(*C.points_at_infinity())


@pytest.mark.parametrize("row", [row for row in FINITE if row.values[0].model == "moved"])
def test_a_moved_equation_is_the_same_group(row, rng):
    """(u, v) ↦ (u, v − z₀x^(g+1) mod u) is an isomorphism onto the curve without the superfluous top degree."""
    C = row.curve
    D = C.arithmetic_model
    assert len(C.f) == 2 * C.genus + 3
    assert len(D.f) == 2 * C.genus + 2
    assert D.arithmetic_model is D
    K, z = C.field, C.infinity_plus
    assert moved(D, z) == C

    def across(A):
        return D.jacobian().from_mumford(A.u, poly.sub(K, A.v, poly.monomial(K, z, C.genus + 1)))

    A, B = C.jacobian().random(rng), C.jacobian().random(rng)
    assert across(A + B) == across(A) + across(B)
    assert across(17 * A) == 17 * across(A)
    assert across(-B) == -across(B)


def test_inert_models_take_points_in_pairs():
    C = HyperellipticCurve(GF(7), [1, 0, 2, 0, 0, 0, 3])
    J = C.jacobian()
    assert C.model == "inert"
    assert C.points_at_infinity() == ()
    P = next(iter(C.points()))
    assert C.involution(P) != P
    with pytest.raises(NotRepresentable, match=r"points: 1 of them"):
        J(P)
    with pytest.raises(NotRepresentable, match=r"u of degree 1"):
        J.from_mumford([-P.x, 1], [P.y])
    assert J.from_points([P, P]).n is None
    assert J.zero().n is None


def test_small_vectors_by_hand():
    # y² = x³ + 1 over QQ: (2, 3) has order 6, with multiples (0, 1), (−1, 0), (0, −1), (2, −3)
    C = HyperellipticCurve(QQ, [1, 0, 0, 1])
    J = C.jacobian()
    D = J(C.point(2, 3))
    expected = [(2, 3), (0, 1), (-1, 0), (0, -1), (2, -3)]
    for m, (x, y) in enumerate(expected, 1):
        assert m * D == J((x, y))
    assert not 6 * D
