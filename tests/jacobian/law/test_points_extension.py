"""Points to divisors and back: multiplicities, conjugate points over an extension, support, polynomials of galois."""

from collections import Counter
from fractions import Fraction
from random import Random

import galois
import pytest

from jacobian import (
    GF,
    QQ,
    RR,
    ArgumentError,
    FieldError,
    HyperellipticCurve,
    Infeasible,
    NotOnCurve,
    NotRepresentable,
    poly,
)
from jacobian.curve.points import INFINITY_MINUS, INFINITY_PLUS
from jacobian.fields.change import embedding
from jacobian.fields.factor import roots
from jacobian.law.conjugates import splitting_degree
from tests.jacobian.jacobian_rows import ROWS

FINITE = [
    pytest.param(row, id=str(row))
    for row in ROWS
    if row.field in ("GF(7)", "GF(101)", "GF(2^8)", "GF(3^5)") and row.genus <= 4
]


def extension_of(K, degree):
    return GF(K.characteristic, K.degree * degree) if K.degree * degree > 1 else K


def rebuilt(J, found, extension=None):
    return J.from_points([P for P, _ in found], multiplicities=[m for _, m in found], extension=extension)


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", FINITE)
def test_support_and_back(row):
    """Every class of the pool is the sum of its points, found over the field in which u splits."""
    J = row.curve.jacobian()
    for D in row.pool:
        L = extension_of(row.K, splitting_degree(D))
        if L.order > 10**12:
            continue
        found = D.support(L)
        assert sum(m for P, m in found if P not in (INFINITY_PLUS, INFINITY_MINUS)) == D.degree
        if row.curve.model == "split":
            assert sum(m for _, m in found) == row.genus
        assert rebuilt(J, found, L) == D


def test_support_of_random_classes(rng):
    degrees = Counter()
    for K, f, h in (
        (GF(7), [1, 2, 0, 3, 1, 0, 1], ()),
        (GF(7), [1, 2, 0, 3, 1, 0, 0, 1], ()),
        (GF(3, 2, (2, 2, 1)), [1, 5, 0, 3, 1, 1, 0, 1], [1, 2]),
        (GF(2, 2, (1, 1, 1)), [1, 0, 3, 2, 0, 1, 0, 1], [1, 1, 2]),
    ):
        C = HyperellipticCurve(K, f, h)
        J = C.jacobian()
        for _ in range(12):
            D = J.random(rng)
            m = splitting_degree(D)
            degrees[m] += 1
            L = extension_of(K, m)
            assert rebuilt(J, D.support(L), L) == D
            assert rebuilt(J, D.support(extension_of(K, 2 * m)), extension_of(K, 2 * m)) == D
    assert {1, 2, 3} <= set(degrees)


def test_conjugate_points_of_an_extension_sum_to_a_class_over_the_field(rng):
    C = HyperellipticCurve(GF(101), [3, 1, 4, 1, 5, 9, 2, 1])
    J, L = C.jacobian(), GF(101, 3)
    inclusion = embedding(GF(101), L)
    P = C.change_ring(L).random_point(rng)
    orbit = [P]
    for _ in range(2):
        orbit.append(tuple(inclusion.frobenius(c) for c in orbit[-1]))
    D = J.from_points(orbit, extension=L)
    assert D.degree == 3
    assert Counter(dict(D.support(L))) == Counter(map(tuple, orbit))
    assert J.from_points(orbit, multiplicities=[2, 2, 2], extension=L) == 2 * D
    opposite = [C.change_ring(L).involution(Q) for Q in orbit]
    assert J.from_points(orbit + opposite, extension=L) == J.zero()
    with pytest.raises(NotRepresentable, match=r"give all conjugates of a point alike"):
        J.from_points(orbit[:2], extension=L)
    with pytest.raises(NotRepresentable, match=r"is given 2 times and its conjugate"):
        J.from_points([orbit[0], *orbit], extension=L)
    with pytest.raises(NotOnCurve, match="point"):
        J.from_points([(P.x, L.add(P.y, 1))], extension=L)
    with pytest.raises(NotRepresentable, match=r"give the extension of degree 3 of GF\(101\)"):
        D.support()


def test_rational_points_may_be_given_over_an_extension(rng):
    C = HyperellipticCurve(GF(3, 2, (2, 2, 1)), [1, 5, 0, 3, 1, 0, 1])
    assert C.model == "split"
    J, L = C.jacobian(), GF(3, 6)
    inclusion = embedding(C.field, L)
    points = [C.random_point(rng) for _ in range(2)]
    lifted = [(inclusion(P.x), inclusion(P.y)) for P in points]
    assert J.from_points(lifted, extension=L) == J.from_points(points)
    assert J.from_points([*lifted, INFINITY_PLUS], extension=L) == J.from_points([*points, INFINITY_PLUS])


@pytest.mark.parametrize("f", [[3, 1, 4, 1, 5, 9, 2, 1], [3, 1, 4, 1, 5, 9, 1], [3, 1, 4, 1, 5, 9, 2]])
def test_many_conjugate_points(f, rng):
    """They are added orbit by orbit, whatever the model over the extension."""
    C = HyperellipticCurve(GF(101), f)
    J, L = C.jacobian(), GF(101, 3)
    inclusion = embedding(GF(101), L)
    points, total = [], J.zero()
    for _ in range(8):
        x, y = C.change_ring(L).random_point(rng)
        orbit = [(x, y)]
        orbit.append(tuple(map(inclusion.frobenius, orbit[-1])))
        orbit.append(tuple(map(inclusion.frobenius, orbit[-1])))
        P = C.random_point(rng)
        four = [*orbit, (inclusion(P.x), inclusion(P.y))]
        points += four
        total = total + J.from_points(four, extension=L)
    rng.shuffle(points)
    assert J.from_points(points, extension=L) == total


@pytest.mark.thinned(3)
@pytest.mark.parametrize("row", FINITE)
def test_many_equal_points_are_a_multiple(row, rng):
    """Compared with sums of two points at a time, which are sums in the group on every model."""
    C, J = row.curve, row.curve.jacobian()
    points = [C.random_point(rng) for _ in range(2)] * (5 * C.genus) + [C.random_point(rng)] * (8 * C.genus + 3)
    points += [*C.points_at_infinity()[:1], C.random_point(rng)] * 3
    points = points[: len(points) // 2 * 2]
    rng.shuffle(points)
    total = J.zero()
    for two in zip(points[::2], points[1::2], strict=True):
        total = total + J.from_points(two)
    assert J.from_points(points) == total
    if C.model != "inert":
        assert J.from_points([*points, points[0]]) == total + J.from_points(points[:1])


def test_equal_points_over_the_rationals_are_a_multiple():
    """Added one after the other, 2000 of them never ended; their partial sums are too long to write down."""
    J = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]).jacobian()
    assert J.from_points([(0, 1)] * 2000 + [(0, -1)] * 1993) == 7 * J((0, 1))


@pytest.mark.parametrize("model", [[1, 2, 0, 0, 0, 1], pytest.param([1, 0, 3, 0, 0, 0, 1], marks=pytest.mark.slow)])
def test_sums_too_long_to_write_down_are_refused(model):
    with pytest.raises(Infeasible, match=r"points: partial sums have .* more than 150000 bits over QQ, .*fewer"):
        HyperellipticCurve(QQ, model).jacobian().from_points([(0, 1)] * 20000)


def test_multiplicities(rng):
    for row in FINITE[:24]:
        C, J = row.values[0].curve, row.values[0].curve.jacobian()
        P, Q = C.random_point(rng), C.random_point(rng)
        assert J.from_points([P, Q], multiplicities=[3, 1]) == J.from_points([P, P, Q, P])
        assert J.from_points([P, Q], multiplicities=[0, 2]) == J.from_points([Q, Q])
    with pytest.raises(ArgumentError, match=r"2 of them are needed"):
        J.from_points([P, Q], multiplicities=[1])
    for wrong in (-1, 1.0, True, "2"):
        with pytest.raises(ArgumentError, match=r"multiplicities: .* is not an int ≥ 0"):
            J.from_points([P], multiplicities=[wrong])


def test_multiplicities_in_the_support(rng):
    C = HyperellipticCurve(GF(101), [3, 1, 4, 1, 5, 9, 2, 1])
    J = C.jacobian()
    P, Q = C.lift_x(28), C.lift_x(2)
    D = J.from_points([P, Q], multiplicities=[2, 1])
    assert dict(D.support()) == {P: 2, Q: 1}
    assert J.zero().support() == []


def test_rational_support():
    C = HyperellipticCurve(QQ, [Fraction(9, 4), 0, 0, 1, 0, 1, 0, 1])
    J = C.jacobian()
    P = C.point(0, Fraction(3, 2))
    D = J.from_points([P, P])
    assert D.support() == [(P, 2)]
    E = 5 * D
    with pytest.raises(NotRepresentable, match=r"no more than 0 of its 3 roots in QQ$"):
        E.support()
    with pytest.raises(FieldError, match=r"field = QQ: points are conjugate over finite fields"):
        D.support(GF(7))
    over_RR = HyperellipticCurve(RR, [0.0, 4.0, 0.0, 0.0, 0.0, 1.0]).jacobian()
    with pytest.raises(FieldError, match=r"field = RR: multiplicities"):
        over_RR.zero().support()


def test_rational_roots_are_found_whatever_their_height():
    rng = Random(3)
    for _ in range(30):
        known = sorted({Fraction(rng.randrange(-(10**6), 10**6), rng.randrange(1, 10**4)) for _ in range(3)})
        a = poly.from_roots(QQ, [*known, known[0]])
        a = poly.mul(QQ, a, tuple(map(Fraction, (rng.randrange(1, 9), 0, rng.randrange(1, 9)))))
        assert roots(QQ, a) == known
    assert roots(QQ, (Fraction(0), Fraction(3, 7))) == [0]
    assert roots(QQ, (Fraction(-2), Fraction(0), Fraction(1))) == []


def test_embeddings_are_homomorphisms(rng):
    for K, L in (
        (GF(7), GF(7, 3)),
        (GF(2, 2), GF(2, 6)),
        (GF(2, 4, (1, 0, 0, 1, 1)), GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1))),
        (GF(3, 5, (1, 2, 0, 0, 0, 1)), GF(3, 10)),
        (GF(101, 2), GF(101, 4)),
    ):
        inclusion = embedding(K, L)
        for _ in range(20):
            x, y = K.random(rng), K.random(rng)
            assert inclusion(K.mul(x, y)) == L.mul(inclusion(x), inclusion(y))
            assert inclusion(K.add(x, y)) == L.add(inclusion(x), inclusion(y))
            assert inclusion.back(inclusion(x)) == x
            assert inclusion.frobenius(inclusion(x)) == inclusion(x)
        outside = next(y for y in L.elements() if inclusion.frobenius(y) != y)
        with pytest.raises(FieldError, match="does not lie in"):
            inclusion.back(outside)
    with pytest.raises(FieldError, match="does not contain"):
        embedding(GF(2, 2), GF(2, 3))
    with pytest.raises(FieldError, match="does not contain"):
        embedding(GF(7), GF(11))


def test_galois_polynomials_in_and_out(rng):
    F = galois.GF(3**5)
    K = GF(F)
    f = galois.Poly([1, 0, 5, 77, 2, 1], field=F)
    C = HyperellipticCurve(K, f)
    assert HyperellipticCurve(K, [1, 2, 77, 5, 0, 1]) == C
    J = C.jacobian()
    D = J.random(rng)
    u, v = D.to_galois()
    assert u.field is F
    assert [int(c) for c in u.coeffs[::-1]] == list(D.u)
    assert J.from_mumford(u, v) == D
    zero_u, zero_v = J.zero().to_galois()
    assert (zero_u.degree, zero_v) == (0, galois.Poly([0], field=F))
    assert J.from_mumford(zero_u, zero_v) == J.zero()
    over_p = HyperellipticCurve(GF(galois.GF(7)), [1, 0, 0, 0, 0, 1]).jacobian().from_points([(0, 1)])
    assert over_p.to_galois() == (galois.Poly([1, 0], field=galois.GF(7)), galois.Poly([1], field=galois.GF(7)))
    with pytest.raises(FieldError, match="galois has finite fields only"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().from_points([(0, 1)]).to_galois()


def test_more_points_than_the_genus_in_floats():
    C = HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1])
    J, points = C.jacobian(), [C.lift_x(x) for x in (0, 1, 2, 3.5, -0.5)]
    D, E = J.from_points(points), sum((J.from_points([P]) for P in points), J.zero())
    assert max(abs(x - y) for x, y in zip((*D.u, *D.v), (*E.u, *E.v), strict=True)) < 1e-12
    assert J.from_points(points[::-1]) == D
