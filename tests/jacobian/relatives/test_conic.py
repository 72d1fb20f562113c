"""Pencils of semi-reduced divisors of degree g+1: steps through plane points, against the Jacobian and extensions."""

import pickle
from itertools import product
from random import Random

import pytest

from jacobian import GF, MP, QQ, RR, ArgumentError, FieldError, HyperellipticCurve, NotOnCurve, NotRepresentable, poly
from jacobian.law.from_points import pair_of_points
from jacobian.law.sampling import _composed, _local_choices
from jacobian.relatives.conic import Representative, representative
from jacobian.relatives.fibre import FibreGroup
from jacobian.relatives.ray_class import RayClassGroup
from tests.jacobian.jacobian_rows import ROWS

EXACT = [row for row in ROWS if row.genus <= 4 and row.field in ("GF(101)", "GF(2^61-1)", "GF(2^8)", "GF(3^5)")]
BIG = [row for row in EXACT if row.field == "GF(2^61-1)"]


def _representative(C, rng):
    """g+1 random points, no two over one x."""
    points = {}
    while len(points) < C.genus + 1:
        point = C.random_point(rng)
        points[point.x] = point
    return Representative(C, *pair_of_points(C, list(points.values())))


def _plane_point(R, x0, rng):
    """A y0 through which a step can be made, or None."""
    K, fibre = R.curve.field, FibreGroup(R.curve, x0)
    for _ in range(40):
        y0 = K.random(rng)
        if fibre.is_unit((K.neg(y0), K.one)):
            try:
                R.step(x0, y0)
            except NotRepresentable:
                continue
            return y0
    return None


@pytest.mark.thinned(4)
@pytest.mark.parametrize("row", EXACT, ids=str)
def test_a_step_keeps_the_class_and_adds_in_the_generalized_jacobian(row):
    C, K, rng = row.curve, row.K, Random(f"conic {row}")
    R = _representative(C, rng)
    for x0 in (None, *[K.random(rng) for _ in range(3)]):
        y0 = _plane_point(R, x0, rng)
        if y0 is None:
            continue
        S = R.step(x0, y0)
        assert Representative(C, S.u, S.v) == S
        assert S.step(x0, K.neg(K.add(y0, FibreGroup(C, x0).h0))) == R
        if C.model == "inert":
            continue
        assert S.divisor() == R.divisor()
        if x0 is not None or C.genus % 2:
            G = RayClassGroup(C, x0)
            assert S.ray_class(x0) == R.ray_class(x0) + G.from_fibre(K.neg(y0), K.one)


@pytest.mark.parametrize("row", BIG, ids=str)
def test_steps_at_one_abscissa_compose_in_the_fibre_group(row):
    C, K, rng = row.curve, row.K, Random(f"law {row}")
    R = _representative(C, rng)
    for x0 in (None, K.random(rng)):
        fibre = FibreGroup(C, x0)
        y0, y1 = K.random(rng), K.random(rng)
        total = K.div(K.add(fibre.f0, K.mul(y0, y1)), K.add(K.add(y0, y1), fibre.h0))
        assert fibre.height(fibre.multiply(fibre.through(y0), fibre.through(y1))) == total
        assert R.step(x0, y0).step(x0, y1) == R.step(x0, total) == R.step(x0, y1).step(x0, y0)
        once, m = R, 7
        for _ in range(m):
            once = once.step(x0, y0)
        assert once == R.translate(x0, fibre.power(fibre.through(y0), m))
        if not C.h and fibre.f0 != K.zero:
            assert R.step(x0, 0).step(x0, 0) == R
        assert R.translate(x0, fibre.identity) == R.step(x0, None) == R


@pytest.mark.parametrize("f", [(1, 1, 0, 3, 1), (2, 1, 3, 1), (1, 0, 2, 1, 1, 4, 1), (1, 2, 0, 4, 1, 2)], ids=str)
def test_the_pencil_is_all_of_its_class(f):
    """All semi-reduced pairs of degree g+1 over GF(5), enumerated and grouped by their classes."""
    C = HyperellipticCurve(GF(5), f)
    K, classes = C.field, {}
    for lower in product(range(5), repeat=C.genus + 1):
        for pairs in product(*_local_choices(C, (*lower, 1))):
            R = Representative(C, *_composed(C, pairs))
            classes.setdefault(R.divisor(), set()).add(R)
    assert len(classes) > 1
    for members in classes.values():
        R = next(iter(members))
        found = list(R.members())
        assert len(found) == len(set(found))
        assert set(found) == members
    # q + 1 members, less those with a point at infinity
    assert {len(members) for members in classes.values()} <= set(range(K.order + 2))


def test_the_member_through_a_point():
    C = next(row for row in BIG if row.model == "split" and row.genus == 3 and row.with_h).curve
    K, rng = C.field, Random(5)
    R, point = _representative(C, rng), C.random_point(rng)
    S = R.containing(point)
    assert poly.evaluate(K, S.u, point.x) == K.zero
    assert poly.evaluate(K, S.v, point.x) == point.y
    assert S.divisor() == R.divisor()
    assert S.containing(point) is S


@pytest.mark.parametrize("row", [row for row in BIG if row.model != "inert" and row.model != "moved"], ids=str)
def test_a_representative_of_a_given_class(row):
    C, rng = row.curve, Random(f"representative {row}")
    D = C.jacobian().random(rng)
    point, other = C.random_point(rng), C.random_point(rng)
    R, S = representative(D, point), representative(D, other)
    assert R.divisor() == D
    assert R.containing(other) == S


def test_rational_numbers_and_pickles():
    C = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1])
    R = Representative(C, *pair_of_points(C, [C.lift_x(x) for x in (0, 1, -1)]))
    S = R.step(3, 5).step("1/2", 1)
    assert S.divisor() == R.divisor()
    assert R.step(3, 0).step(3, 0) == R
    assert pickle.loads(pickle.dumps(S)) == S
    assert len({S, pickle.loads(pickle.dumps(S))}) == 1


@pytest.mark.parametrize("K", [RR, MP(40)], ids=str)
def test_real_steps(K):
    """y² = −4(x−1)(x−2)(x−3)(x−4) and a sextic: steps have inverses, and two give their composition."""
    for roots in ((1, 2, 3, 4), (1, 2, 3, 4, 5, 7)):
        f = poly.scale(K, K.coerce(-4), poly.from_roots(K, map(K.coerce, roots)))
        C = HyperellipticCurve(K, f)
        xs = [K.coerce(r) + K.coerce("0.25" if K is not RR else 0.25) for r in roots[::2]]
        R = Representative(C, *pair_of_points(C, [C.lift_x(x) for x in xs]))
        for x0 in (None, K.zero, K.coerce(-3)):
            there = R.step(x0, 5).step(x0, 2)
            fibre = FibreGroup(C, x0)
            direct = R.translate(x0, fibre.multiply(fibre.through(5), fibre.through(2)))
            back = there.step(x0, -2).step(x0, -5)
            for X, Y in ((there, direct), (back, R)):
                error = max(abs(a - b) for a, b in zip((*X.u, *X.v), (*Y.u, *Y.v), strict=True))
                assert error < 1e7 * K.eps


def test_bad_input():
    C = HyperellipticCurve(GF(101), (1, 0, 0, 0, 2, 0, 4))
    R = _representative(C, Random(1))
    point = C.random_point(Random(2))
    with pytest.raises(ArgumentError, match="degree g \\+ 1 = 3"):
        Representative(C, (1, 1), (1,))
    with pytest.raises(NotOnCurve, match="remainder"):
        Representative(C, (1, 1, 0, 1), (1,))
    with pytest.raises(ArgumentError, match="monic"):
        Representative(C, (1, 1, 0, 2), (1,))
    with pytest.raises(ArgumentError, match="point of"):
        R.step(*point)
    with pytest.raises(NotRepresentable, match="infinity"):
        R.member(2)  # c² = f_6
    with pytest.raises(ArgumentError, match="point of"):
        R.step(None, 2)
    root = next(x for x in range(101) if poly.evaluate(C.field, R.u, x) == 0)
    with pytest.raises(NotRepresentable, match=f"x0 = {root}"):
        R.step(root, 0 if C.f and poly.evaluate(C.field, C.f, root) else 1)
    with pytest.raises(FieldError, match="x0"):
        R.step(0.5, 1)
    with pytest.raises(FieldError, match="infinite"):
        list(Representative(HyperellipticCurve(QQ, [0, -1, 0, 1]), (0, -1, 1), (0,)).members())
    with pytest.raises(AttributeError, match="immutable"):
        R.u = ()
