"""Curves: models at infinity, smoothness, points, values; every bad argument by name."""

import pickle
from random import Random

import galois
import numpy as np
import pytest

from jacobian import (
    CC,
    GF,
    MP,
    QQ,
    RR,
    AffinePoint,
    ArgumentError,
    CurveMismatch,
    FieldError,
    HyperellipticCurve,
    JacobianError,
    NotASquare,
    NotOnCurve,
    NotRepresentable,
    PointAtInfinity,
    PrecisionLoss,
    SingularCurve,
)
from jacobian.errors import Infeasible
from jacobian.finite.counting import count_points
from tests.jacobian.jacobian_rows import ROWS

K7 = GF(7)
RAMIFIED = HyperellipticCurve(K7, [1, 1, 0, 0, 0, 3])
SPLIT = HyperellipticCurve(K7, [1, 1, 0, 0, 0, 0, 1])
INERT = HyperellipticCurve(K7, [1, 0, 2, 0, 0, 0, 3])


@pytest.mark.parametrize(
    ("K", "f", "h", "model", "genus"),
    [
        (QQ, [1, 0, 0, 0, 0, 1], (), "ramified", 2),
        (QQ, [1, 0, 0, 0, 0, 1], [0, 0, 0, 1], "split", 2),
        (QQ, [1, 0, 0, 0, 0, 0, 2], (), "inert", 2),
        (QQ, [1, 0, 0, 0, 0, 0, 4], (), "split", 2),
        (QQ, [1, 0, 0, 0, 0, 1, -1], [0, 0, 0, 2], "ramified", 2),
        (QQ, [1, 1, 0, 2], (), "ramified", 1),
        (RR, [1, 0, 0, 0, 0, 0, 2], (), "split", 2),
        (RR, [1, 0, 0, 0, 0, 0, -2], (), "inert", 2),
        (CC, [1, 0, 0, 0, 0, 0, -2], (), "split", 2),
        (RR, [1, 0, 0, 0, 0, 1, -1], [0, 0, 0, 2], "ramified", 2),
        (MP(30), ["0.5", 0, 0, 0, 0, 0, 0, "1.5"], (), "ramified", 3),
        (GF(2), [1, 1, 0, 1], [1], "ramified", 1),
        (GF(2), [1, 0, 0, 0, 0, 0, 0], [1, 0, 0, 1], "split", 2),
        (GF(2), [0, 0, 0, 0, 0, 0, 1], [1, 0, 0, 1], "inert", 2),
    ],
)
def test_models(K, f, h, model, genus):
    C = HyperellipticCurve(K, f, h)
    assert (C.model, C.genus) == (model, genus)
    for z in {C.infinity_plus, C.infinity_minus} - {None}:
        top = K.add(K.mul(z, z), K.mul(z, C.h[genus + 1] if len(C.h) > genus + 1 else K.zero))
        expected = C.f[2 * genus + 2] if len(C.f) > 2 * genus + 2 else K.zero
        assert top == expected if K.exact else abs(top - expected) <= 8 * K.eps * abs(expected)


def test_exact_zeros_at_the_top_are_cut_off():
    C = HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1, 0.0, 0.0], [0.0])
    assert (C.genus, C.model, len(C.f), C.h) == (2, "ramified", 6, ())


def test_galois_polynomials_are_turned_round():
    G = galois.GF(7)
    C = HyperellipticCurve(K7, galois.Poly([3, 0, 0, 0, 1, 1], field=G), galois.Poly([2, 1], field=G))
    assert C.f == (1, 1, 0, 0, 0, 3)
    assert C.h == (1, 2)
    D = C.jacobian().from_points([P for P in C.points() if isinstance(P, AffinePoint)][:1])
    u, v = galois.Poly(D.u[::-1], field=G), galois.Poly(D.v[::-1] or [0], field=G)
    assert C.jacobian().from_mumford(u, v) == D


@pytest.mark.parametrize(
    ("K", "f", "h", "where"),
    [
        (QQ, [0, 0, 1, 0, 0, 1], (), r"x = 0|x\^?.* = 0"),
        (K7, [0, 0, 1, 0, 0, 1], (), "singular point"),
        (K7, [1, 0, 0, 0, 0, 0, 0, 1], (), "singular point"),
        (GF(2), [1, 1, 0, 0, 0, 1], (), "h = 0"),
        (GF(2), [0, 0, 0, 0, 0, 1], [0, 1], "singular point"),
        (GF(2), [1, 1, 1, 1, 1, 0, 1], [1], "singular at infinity"),
        (QQ, [1, 0, 0, 0, 1, 0, 1], [0, 0, 0, 0], None),
        (QQ, [1, 0, 0, 0, 0, 0, -1], [0, 0, 0, 2], "singular at infinity"),
        (RR, [1, 0, 0, 0, 0, 0, -1], [0, 0, 0, 2], "singular at infinity"),
    ],
)
def test_singular_curves(K, f, h, where):
    if where is None:
        assert HyperellipticCurve(K, f, h).genus == 2
        return
    with pytest.raises(SingularCurve, match=where):
        HyperellipticCurve(K, f, h)


@pytest.mark.parametrize(
    ("K", "f", "h", "message"),
    [
        (K7, [], (), "genus 0"),
        (K7, [1, 1, 1], (), "genus 0"),
        (K7, [1], [1, 1], "genus 0"),
        (RR, [0.0, 0.0], (), "genus 0"),
        (K7, [1, 0.5, 0, 1], (), r"f\[1\] = 0.5"),
        (K7, [1, 0, 0, 1], ["a"], r"h\[0\] = 'a'"),
        (K7, "1001", (), "f = '1001'"),
        (K7, 5, (), "f = 5"),
        (RR, [1, float("nan"), 0, 1], (), r"f\[1\] = nan"),
        (7, [1, 0, 0, 1], (), "K = 7"),
    ],
)
def test_bad_equations(K, f, h, message):
    with pytest.raises(ArgumentError, match=message):
        HyperellipticCurve(K, f, h)


def test_naming_infinity():
    assert (SPLIT.infinity_plus, SPLIT.infinity_minus) == (1, 6)
    assert HyperellipticCurve(K7, SPLIT.f, infinity_plus=-1).infinity_plus == 6
    assert HyperellipticCurve(QQ, [1, 1, 0, 0, 1]).infinity_plus == 1
    assert HyperellipticCurve(RR, [1, 1, 0, 0, 2], infinity_plus=-(2**0.5)).infinity_plus < 0
    with pytest.raises(ArgumentError, match=r"infinity_plus = 3: .* 1 and 6"):
        HyperellipticCurve(K7, SPLIT.f, infinity_plus=3)
    with pytest.raises(ArgumentError, match=r"infinity_plus = 3: .* is ramified"):
        HyperellipticCurve(K7, RAMIFIED.f, infinity_plus=3)


@pytest.mark.thinned(4)
@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in ROWS if row.model == "split"])
def test_principal_parts_agree_with_y_at_infinity(row):
    from jacobian import poly

    C, K, g = row.curve, row.K, row.genus
    for z, part in zip((C.infinity_plus, C.infinity_minus), C.principal_parts, strict=True):
        assert (part[g + 1] if len(part) > g + 1 else K.zero) == z
        assert len(poly.sub(K, poly.mul(K, part, poly.add(K, part, C.h)), C.f)) <= g + 1


def test_values():
    again = HyperellipticCurve(K7, [8, 1, 0, 0, 0, 3, 0])
    assert again == RAMIFIED
    assert hash(again) == hash(RAMIFIED)
    assert again.jacobian() == RAMIFIED.jacobian()
    assert again.jacobian() is again.jacobian()
    assert hash(again.jacobian()) == hash(RAMIFIED.jacobian())
    assert RAMIFIED != SPLIT
    assert HyperellipticCurve(GF(11), [1, 1, 0, 0, 0, 3]) != RAMIFIED
    assert repr(RAMIFIED) == "y^2 = 3·x^5 + x + 1 over GF(7)"
    assert repr(HyperellipticCurve(QQ, [0, 1, 0, 1], ["1/2", 1])) == "y^2 + (x + 1/2)·y = x^3 + x over QQ"
    assert repr(RAMIFIED.jacobian()) == "Jacobian of y^2 = 3·x^5 + x + 1 over GF(7)"


@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in ROWS if row.genus == 2])
def test_pickling(row):
    D = row.pool[0]
    again = pickle.loads(pickle.dumps(D))
    assert again == D
    assert again + D == D.double()
    assert pickle.loads(pickle.dumps(row.curve)) == row.curve


@pytest.mark.parametrize("K", [RR, CC, MP(40), MP(40, complex=True)], ids=str)
@pytest.mark.parametrize("f", [[1, 0, 0, 0, 2, 3], [1, 0, 0, 0, 0, 0, 2]])
def test_inexact_divisors_are_built_and_pickled(K, f):
    C = HyperellipticCurve(K, f)
    J = C.jacobian()
    D = J.random(Random(1))
    again = pickle.loads(pickle.dumps(D))
    assert again == D
    assert hash(again) == hash(D)
    assert len(D.u) == 3
    assert D.u[-1] == 1
    assert len(D.v) == 2
    assert J.from_mumford(D.u, D.v) == D
    negative = -D
    assert -negative == D
    assert not J.zero()
    assert D + J.zero() == D
    P = C.random_point(Random(2))
    assert not J.from_points([P, C.involution(P)])
    double = J.from_points([P, P])
    assert J.from_mumford(double.u, double.v) == double
    with pytest.raises(NotOnCurve, match=r"remainder"):
        J.from_mumford(D.u, [c * (1 + 1e-6) for c in D.v])


# --- points


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in ROWS if row.K != QQ and row.genus <= 3])
def test_lifting_x(row):
    C, K = row.curve, row.K
    rng = Random(str(row))
    counts = set()
    for _ in range(30):
        x = K.random(rng)
        points = C.lift_x(x, all=True)
        counts.add(len(points))
        assert all(C.is_on(P) and C.residual(*P) == K.zero for P in points)
        assert {C.involution(P) for P in points} == set(points)
        if points:
            assert C.lift_x(x) == points[0]
            assert C.lift_x(x).x == x
        else:
            with pytest.raises(NotASquare, match=r"^x = "):
                C.lift_x(x)
    assert counts >= {0, 2} or K.order == 7


def test_points_over_rationals_within_a_bound():
    C = HyperellipticCurve(QQ, [1, 0, 0, 1])
    assert set(C.points(bound=3)) == {PointAtInfinity(0), (0, 1), (0, -1), (-1, 0), (2, 3), (2, -3)}
    with pytest.raises(ArgumentError, match=r"bound = None"):
        list(C.points())
    with pytest.raises(FieldError, match=r"field = RR"):
        list(HyperellipticCurve(RR, [1, 0, 0, 1]).points())


def test_random_points_are_uniform(rng):
    counts = {P: 0 for P in SPLIT.points() if isinstance(P, AffinePoint)}
    for _ in range(100 * len(counts)):
        counts[SPLIT.random_point(rng)] += 1
    assert sum((c - 100) ** 2 / 100 for c in counts.values()) < len(counts) + 5 * (2 * len(counts)) ** 0.5


def test_points_at_infinity():
    assert [repr(P) for C in (RAMIFIED, SPLIT, INERT) for P in C.points_at_infinity()] == ["∞", "∞₊", "∞₋"]
    assert RAMIFIED.involution(PointAtInfinity(0)) == PointAtInfinity(0)
    assert SPLIT.is_on(PointAtInfinity(1))
    assert not SPLIT.is_on(PointAtInfinity(0))
    with pytest.raises(NotOnCurve, match=r"point = ∞ is not on"):
        SPLIT.jacobian().from_points([PointAtInfinity(0)])


def test_bad_points():
    with pytest.raises(NotOnCurve, match=r"point = \(1, 1\) .* is 3"):
        RAMIFIED.point(1, 1)
    with pytest.raises(NotOnCurve, match=r"point = \(1, 1\)"):
        RAMIFIED.jacobian().from_points([(1, 1)])
    for point in (5, (1, 2, 3), None):
        with pytest.raises(ArgumentError, match=r"^point = "):
            RAMIFIED.jacobian().from_points([point])
    with pytest.raises(FieldError, match=r"^x = 0.5"):
        RAMIFIED.lift_x(0.5)
    assert not RAMIFIED.is_on((1, 1))


@pytest.mark.parametrize("x", [1e62, 1e100, -1e300])
@pytest.mark.parametrize(("f", "h"), [([1, 0, 2, 0, 0, 1], []), ([1, 8, -2, -7, 16, 1, -6, 4, 1], [1, 1])])
@pytest.mark.parametrize("K", [RR, CC], ids=str)
def test_what_floats_do_not_reach_is_on_no_curve(K, f, h, x):
    """Where f(x) is infinite, y = 0 used to be found, and every pair counted as on the curve."""
    C = HyperellipticCurve(K, f, h)
    with pytest.raises(PrecisionLoss):
        C.lift_x(x)
    for pair in ((x, 1.0), (1.0, 1e200)):
        with pytest.raises(PrecisionLoss, match=f"beyond the range of {K.name}; use MP"):
            C.point(*pair)
    with pytest.raises(PrecisionLoss, match=f"beyond the range of {K.name}; use MP"):
        C.jacobian().from_mumford([-x, 1], [1.0])
    wide = HyperellipticCurve(MP(30), f, h)
    assert not wide.is_on((x, 1.0))
    assert wide.is_on(wide.lift_x(abs(x)))


def test_no_point_at_all():
    # y² = −1 times a sum of squares has no real point
    C = HyperellipticCurve(RR, [-1, 0, -1, 0, -1, 0, -1])
    with pytest.raises(NotRepresentable, match=r"no affine point"):
        C.random_point(Random(1))
    with pytest.raises(NotRepresentable, match=r"no affine point"):
        HyperellipticCurve(QQ, [-1, 0, -1, 0, -1, 0, -1]).random_point(Random(1))


# --- divisors: what is refused


J = RAMIFIED.jacobian()
S = SPLIT.jacobian()


@pytest.mark.parametrize(
    ("u", "v", "n", "error", "message"),
    [
        ([], [], None, ArgumentError, "^u = 0"),
        ([1, 0, 2], [], None, ArgumentError, "u = .* is not monic: .* 2"),
        ([1, 1], [3], None, NotOnCurve, r"\(x \+ 1, 3\) is not on .* remainder [1-6] modulo u"),
        ([0, 0.5, 1], [], None, FieldError, r"u\[1\] = 0.5"),
        ([0, 1], ["one"], None, FieldError, r"v\[0\] = 'one'"),
        ("01", [], None, FieldError, "u = '01'"),
        ([0, 1], [1], 0, ArgumentError, "n = 0: a ramified model"),
    ],
)
def test_bad_pairs(u, v, n, error, message):
    with pytest.raises(error, match=message):
        J.from_mumford(u, v, n)


@pytest.mark.parametrize(
    ("n", "message"), [(-1, "n = -1: .* 0 … 1"), (2, "n = 2: .* 0 … 1"), (0.5, "n = 0.5"), ("1", "n = '1'")]
)
def test_bad_weights(n, message):
    with pytest.raises(ArgumentError, match=message):
        S.from_mumford([0, 1], [1], n)


@pytest.mark.parametrize("u", [[float("nan"), 0, 1], [float("inf"), 0, 1]])
def test_nan_in_a_divisor(u):
    with pytest.raises(FieldError, match=r"u\[0\] = (nan|inf)"):
        HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]).jacobian().from_mumford(u, [0, 0])


def test_weights_by_default():
    assert S.from_mumford([1], []).n == 1
    assert S.from_mumford([1], []) == S.zero()
    assert S.from_mumford([0, 1], [1]).n == 1
    assert S.from_mumford([0, 1], [1], 0).n == 0


@pytest.mark.parametrize("scalar", [0.5, 2.0, "2", None, True, 1j, [1]])
def test_scalars_that_are_not_integers(scalar):
    D = J.from_points([(0, 1)])
    with pytest.raises(ArgumentError, match=r"^scalar = "):
        D * scalar
    with pytest.raises(ArgumentError, match=r"^scalar = "):
        scalar * D


def test_numpy_scalars():
    D = J.from_points([(0, 1)])
    assert np.int64(3) * D == D * np.int32(3) == D + D + D


def test_divisors_of_two_curves():
    D, E = J.from_points([(0, 1)]), S.from_points([(0, 1)])
    for operation in (lambda: D + E, lambda: D - E):
        with pytest.raises(CurveMismatch, match=r"two curves .* 3·x\^5 .* x\^6"):
            operation()
    assert D != E
    twin = HyperellipticCurve(K7, RAMIFIED.f).jacobian().from_points([(0, 1)])
    assert D + twin == D.double()


def test_other_types():
    D = J.from_points([(0, 1)])
    for other in (1, "D", None):
        with pytest.raises(TypeError):
            D + other
        with pytest.raises(TypeError):
            D - other
    with pytest.raises(TypeError):
        D * D
    assert D != 0
    assert J(0) == J(np.int64(0)) == J(np.uint8(0)) == J.zero()


def test_divisors_are_immutable():
    D = J.from_points([(0, 1)])
    with pytest.raises(AttributeError, match=r"u cannot be set"):
        D.u = (1,)
    with pytest.raises(AttributeError, match=r"u cannot be deleted"):
        del D.u
    with pytest.raises(AttributeError):
        D.extra = 1
    assert repr(D) == "(x, 1)"
    assert repr(S.zero()) == "(1, 0, n=1)"
    assert +D == D
    assert D.degree == 1


def test_counting_has_limits():
    large = HyperellipticCurve(GF(2**61 - 1), [1, 1, 0, 0, 0, 1])
    with pytest.raises(Infeasible, match=r"field = GF\(2305843009213693951\).* up to 562949953421312"):
        large.jacobian().order()
    with pytest.raises(FieldError, match=r"field = QQ"):
        HyperellipticCurve(QQ, [1, 0, 0, 1]).jacobian().order()
    with pytest.raises(FieldError, match=r"field = QQ"):
        count_points(HyperellipticCurve(QQ, [1, 0, 0, 1]))
    with pytest.raises(NotRepresentable, match=r"QQ is infinite"):
        list(HyperellipticCurve(QQ, [1, 0, 0, 1]).jacobian().points())
    with pytest.raises(ArgumentError, match=r"^rng = 'seed'"):
        J.random("seed")
    assert issubclass(Infeasible, JacobianError)


def test_random_classes_need_no_generator():
    large = HyperellipticCurve(GF(2**61 - 1), [1, 1, 0, 0, 0, 1]).jacobian()
    first, second = large.random(), large.random()
    assert first != second
    assert large.from_mumford(first.u, first.v) == first
    assert len(large.random(size=5)) == 5


def test_semi_reduced_pairs_over_inexact_fields():
    C = HyperellipticCurve(RR, [1, 0, 0, 1])
    with pytest.raises(NotRepresentable, match=r"u has degree 2 > g = 1"):
        C.jacobian().from_mumford([0, -2, 1], [1, 1])
