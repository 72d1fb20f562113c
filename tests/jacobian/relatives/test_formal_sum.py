"""Formal sums, divisors of functions and Abel's polynomial, compared with series at points, with classes, and with each
other.
"""

from collections import Counter
from random import Random

import pytest

from jacobian import (
    GF,
    QQ,
    RR,
    AffinePoint,
    ArgumentError,
    CurveMismatch,
    FieldError,
    HyperellipticCurve,
    Infeasible,
    NotRepresentable,
    poly,
)
from jacobian.relatives.fibre import conjugate, multiply
from jacobian.relatives.formal_sum import FormalSum, intersection, principal_divisor
from jacobian.relatives.glued import GeneralizedJacobian
from tests.jacobian.jacobian_rows import ROWS

TABLE = [row for row in ROWS if row.genus <= 3 and row.field in ("GF(7)", "GF(2^8)", "GF(2^61-1)")]
TABLE += [row for row in ROWS if row.genus == 2 and row.field == "QQ"]
# all numbers of points at infinity: one, two, none
SMALL = {
    "ramified": HyperellipticCurve(GF(7), [1, 2, 0, 3, 0, 1]),
    "split": HyperellipticCurve(GF(7), [1, 2, 0, 3, 0, 0, 1]),
    "inert": HyperellipticCurve(GF(7), [1, 2, 0, 3, 0, 0, 3]),
    "h": HyperellipticCurve(GF(2, 3), [0, 1, 1, 0, 0, 1], [1, 1]),
}


def function_of(K, rng, most=6):
    while True:
        a, b = (poly.random(K, rng.randrange(1, size), rng) for size in (most + 1, most - 2))
        if rng.random() < 0.3:
            common = poly.random(K, 3, rng, monic=True)
            a, b = poly.mul(K, a, common), poly.mul(K, b, common)
        if a or b:
            return a, b


TERMS = 16


def times(K, p, q):
    return [K.dot(p[: i + 1], q[i::-1]) for i in range(TERMS)]


def value_of(K, coefficients, x):
    total = [K.zero] * TERMS
    for c in reversed(coefficients):
        total = times(K, total, x)
        total[0] = K.add(total[0], c)
    return total


def series(C, P):
    """(x − x_P, y) at an affine point: power series in x − x_P, at a branch point in y − y_P."""
    K, zero = C.field, [C.field.zero] * (TERMS - 2)
    f, h = (poly.shift(K, part, P.x) for part in (C.f, C.h))
    slope = K.add(K.add(P.y, P.y), h[0] if h else K.zero)
    if slope != K.zero:
        x, y = [K.zero, K.one, *zero], [P.y, K.zero, *zero]
        unknown = y
    else:
        x, y = [K.zero, K.zero, *zero], [P.y, K.one, *zero]
        unknown, slope = x, K.sub(K.mul(P.y, h[1] if len(h) > 1 else K.zero), f[1])
    for i in range(1, TERMS):
        # while the coefficient is missing, the residual of the equation is the coefficient times the slope
        left = [K.add(p, q) for p, q in zip(times(K, y, y), times(K, value_of(K, h, x), y), strict=True)]
        unknown[i] = K.div(K.sub(value_of(K, f, x)[i], left[i]), slope)
    return x, y


def order(C, function, P, local):
    """The order of a + by at P, from its power series."""
    K, (x, y) = C.field, local
    a, b = (value_of(K, poly.shift(K, part, P.x), x) for part in function)
    value = [K.add(p, q) for p, q in zip(a, times(K, b, y), strict=True)]
    return next(i for i, c in enumerate(value) if c != K.zero)


@pytest.mark.parametrize("name", SMALL)
def test_multiplicities_are_orders_of_power_series(name):
    """At every rational affine point, including branch points and common factors."""
    C, rng = SMALL[name], Random(f"series {name}")
    K, orders = C.field, Counter()
    local = {P: series(C, P) for P in C.points() if isinstance(P, AffinePoint)}
    for _ in range(20):
        function = function_of(K, rng)
        found = principal_divisor(C, *function)
        assert found.degree == 0
        for P, at in local.items():
            expected = order(C, function, P, at)
            assert found.multiplicity(P) == expected
            orders[expected] += 1
    assert min(orders[0], orders[1], orders[2]) > 1


@pytest.mark.thinned(7)
@pytest.mark.parametrize("row", TABLE, ids=str)
def test_the_divisor_of_a_product(row):
    """div(FG) = div F + div G, also at infinity; div F is principal, and the divisor of the conjugate is its mirror
    image.
    """
    C, rng = row.curve, Random(f"product {row}")
    for _ in range(4):
        F, G = function_of(C.field, rng), function_of(C.field, rng)
        first, second = principal_divisor(C, *F), principal_divisor(C, *G)
        assert first + second == principal_divisor(C, *multiply(C, F, G))
        assert first + principal_divisor(C, *conjugate(C, F)) == principal_divisor(
            C, multiply(C, F, conjugate(C, F))[0]
        )
        assert first.degree == 0
        if not (C.model == "inert" and C.genus % 2):
            assert first.is_principal()
            assert (2 * first - second).is_principal()


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", TABLE, ids=str)
def test_formal_sums_are_a_group_above_the_jacobian(row):
    """Classes of every shape: single points, 2-torsion, opposite and common points, doubling, points at infinity."""
    J, rng = row.curve.jacobian(), Random(f"sums {row}")
    for D in rng.sample(row.pool, min(7, len(row.pool))):
        E, F = rng.choice(row.pool), rng.choice(row.pool)
        A, B, C = map(FormalSum.from_divisor, (D, E, F))
        assert A.divisor() == D
        assert (A + B) + C == A + (B + C)
        assert A + B == B + A
        assert not A - A
        assert -(A + B) == -A - B
        assert 3 * A == A + A + A
        assert -2 * A == -(A + A)
        assert (A + B).divisor() == D + E
        assert (A - 2 * B).divisor() == D - 2 * E
        assert (A - B).is_principal() == (D == E)
        assert (0 * A) == FormalSum.zero(row.curve) == sum([A, -A])
        assert J.zero() == (A - A).divisor()


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", TABLE, ids=str)
def test_abel_s_polynomial_and_the_intersection_divisor(row):
    """D + E + rest ~ 0 by the function fibres·(y − P), for classes of every shape."""
    C, rng = row.curve, Random(f"abel {row}")
    K, J = C.field, C.jacobian()
    for D in rng.sample(row.pool, min(7, len(row.pool))):
        E = rng.choice([*row.pool, D, -D])
        found = intersection(D, E)
        assert found == intersection(E, D)
        both = FormalSum.from_divisor(D) + FormalSum.from_divisor(E)
        assert (both + found.rest).is_principal()
        assert found.rest.divisor() == -(D + E)
        # these are the points where y = P(x) meets the curve, including those of both divisors
        assert found.abel == poly.sub(K, poly.mul(K, found.P, poly.add(K, found.P, C.h)), C.f)
        assert found.points.degree == len(found.abel) - 1
        assert found.points.effective
        affine = FormalSum(C, (both.u, both.v), (both.numerator, both.denominator), found.points.weights)
        fibres = FormalSum(C, ((K.one,), ()), (found.fibres, (K.one,)), found.points.weights)
        assert (found.points + fibres - affine).effective
    assert intersection(J.zero(), J.zero()).P == ()


def test_the_cubic_of_genus_two():
    """General position: P of degree three, six points in all, ψ = (b₃² − a₆)UU'U''."""
    rng = Random(3)
    for C in (HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 9]), HyperellipticCurve(GF(10007), [3, 1, 4, 1, 5, 9, 4])):
        K, J = C.field, C.jacobian()
        D, E = J.random(rng), J.random(rng)
        found, total = intersection(D, E), D + E
        assert len(found.P) == 4
        lead = K.sub(K.mul(found.P[3], found.P[3]), C.f[6] if len(C.f) == 7 else 0)
        assert found.abel == poly.scale(K, lead, poly.mul(K, poly.mul(K, D.u, E.u), total.u))
        assert total.v == poly.neg(K, poly.mod(K, found.P, total.u))


def test_points_and_multiplicities():
    C = SMALL["split"]
    plus, minus = C.points_at_infinity()
    P = next(P for P in C.points() if isinstance(P, AffinePoint) and C.involution(P) != P)
    A = FormalSum.from_points(C, [P, C.involution(P), plus, minus], [3, -2, 4, -1])
    assert [A.multiplicity(Q) for Q in (P, C.involution(P), plus, minus)] == [3, -2, 4, -1]
    assert A.support() == [*sorted([(P, 3), (C.involution(P), -2)]), (plus, 4), (minus, -1)]
    assert A.degree == 4
    assert not A.effective
    assert FormalSum.from_points(C, [P, P]).effective
    assert FormalSum.from_points(C, *map(list, zip(*A.support(), strict=True))) == A
    branch = [P for P in SMALL["ramified"].points() if isinstance(P, AffinePoint) and P.y == 0]
    assert FormalSum.from_points(SMALL["ramified"], branch[:1], [5]).multiplicity(branch[0]) == 5
    assert repr(FormalSum.zero(C)) == "0"
    # y = 0 meets the curve in its branch points
    over_q = HyperellipticCurve(QQ, [0, 4, 0, -5, 0, 1])
    assert [x for (x, _), m in principal_divisor(over_q, (), (1,)).support()[:5]] == [-2, -1, 0, 1, 2]


def test_on_the_generalized_jacobian_of_an_elliptic_curve():
    K, rng = GF(10007), Random(4)
    G = GeneralizedJacobian(HyperellipticCurve(K, [3, 1, 4, 1, 9]))
    D, E = G.random(rng), G.random(rng)
    found, total = intersection(D, E), D + E
    assert len(found.P) == 4
    assert found.abel == poly.scale(K, K.mul(found.P[3], found.P[3]), poly.mul(K, poly.mul(K, D.u, E.u), total.u))


def test_named_errors():
    C = SMALL["ramified"]
    K, J = C.field, C.jacobian()
    P = next(P for P in C.points() if isinstance(P, AffinePoint))
    A = FormalSum.from_points(C, [P])
    with pytest.raises(ArgumentError, match="degree 1"):
        A.divisor()
    assert not A.is_principal()
    with pytest.raises(ArgumentError, match="a = b = 0"):
        principal_divisor(C, (), ())
    with pytest.raises(ArgumentError, match="multiplicities"):
        FormalSum.from_points(C, [P], [1, 2])
    with pytest.raises(FieldError, match="inexact"):
        FormalSum.zero(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]))
    with pytest.raises(CurveMismatch, match="two curves"):
        A + FormalSum.zero(SMALL["split"])
    with pytest.raises(CurveMismatch):
        intersection(J.zero(), SMALL["split"].jacobian().zero())
    with pytest.raises(ArgumentError, match="a Divisor"):
        intersection(J.zero(), 3)
    with pytest.raises(Infeasible, match="scalar"):
        10**9 * A
    empty = next(x for x in K.elements() if not C.lift_x(x, all=True))
    with pytest.raises(NotRepresentable, match="not all"):
        principal_divisor(C, (K.neg(empty), 1)).support()
