"""The Abel–Jacobi map in balls and its proven inverse."""

import pickle
from fractions import Fraction
from random import Random

import pytest
from flint import arb

from jacobian import CC, MP, QQ, ArgumentError, CurveMismatch, HyperellipticCurve, NotRepresentable, PrecisionLoss, poly
from jacobian.periods.abel import AbelMap
from jacobian.periods.abel_balls import AbelBalls
from tests.jacobian.periods.ball_curves import random_curve

CASES = {
    "genus 1": ([-2, 0, 0, 1], (), [(3, 5)]),
    "ramified": ([1, 0, 0, 0, 0, 1], (), [(0, 1), (-1, 0)]),
    "split": ([4, 1, 0, 0, 0, 0, 1], (), [(0, 2), (0, 2)]),
    "with h": ([1, 0, 1, 0, 0, 1], (0, 1), [(0, 1), (0, 1)]),
    "genus 3": ([0, 4, 0, -5, 0, 0, 0, 1], (), [(0, 0), (1, 0)]),
    "genus 3, split": ([1, 1, 0, 0, 0, 0, 0, 0, 1], (), [(0, 1)]),
}


def _case(name):
    f, h, points = CASES[name]
    C = HyperellipticCurve(QQ, f, h)
    return AbelBalls(C, 25), C.jacobian().from_points(points)


def _is_period(A, z):
    """Whether the balls may contain a period, and are small."""
    with A.periods.cover.numbers.working():
        coordinates = A.periods.coordinates(z)
        return all((c - round(float(c))).contains(0) and float(c.rad()) < 1e-12 for c in coordinates)


@pytest.mark.parametrize("name", CASES)
def test_it_is_additive(name):
    A, D = _case(name)
    with A.periods.cover.numbers.working():
        for m, n in ((1, 1), (1, 2), (2, 5)):
            total = [x + y - z for x, y, z in zip(A(m * D), A(n * D), A((m + n) * D), strict=True)]
            assert _is_period(A, total)
    assert _is_period(A, A(D.jacobian.zero()))


@pytest.mark.parametrize("name", CASES)
def test_it_is_what_floats_approximate(name):
    A, D = _case(name)
    f, h, points = CASES[name]
    M = AbelMap(HyperellipticCurve(MP(30), f, h))
    found = M(M.given.jacobian().from_points(points))
    with A.periods.cover.numbers.working():
        gap = [x - A.periods.cover.numbers.convert(y) for x, y in zip(A(D), found, strict=True)]
        assert max(abs(float(c - round(float(c)))) for c in A.periods.coordinates(gap)) < 1e-25


@pytest.mark.parametrize("name", ["genus 1", "ramified", "split", "with h", "genus 3, split"])
def test_the_inverse_contains_the_divisor(name):
    A, D = _case(name)
    E = next(m * D for m in range(3, 9) if len((m * D).u) == D.jacobian.curve.genus + 1)
    found = A.inverse(A(E))
    numbers = A.periods.cover.numbers
    with numbers.working():
        for got, expected in ((found.u, E.u), (found.v, E.v)):
            for i, c in enumerate(got):
                exact = numbers.convert(expected[i] if i < len(expected) else 0)
                assert c.overlaps(exact)
                assert abs(c - exact) < 1e-15 * (1 + abs(exact))


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("g", "kind"), [(2, "small"), (2, "complex"), (2, "cluster"), (3, "small"), (3, "complex")])
def test_random_images_have_divisors_with_those_images(g, kind):
    rng = Random(f"inverse {g} {kind}")
    C = random_curve(rng, g, kind)
    A, finer = AbelBalls(C, 15), AbelBalls(C, 30)
    z = [complex(rng.uniform(-1, 1), rng.uniform(-1, 1)) for _ in range(g)]
    found, exact = A.inverse(z), finer.inverse(z)
    order = sorted(range(g), key=lambda i: complex(found.points[i][0]).real)
    other = sorted(range(g), key=lambda i: complex(exact.points[i][0]).real)
    for i, j in zip(order, other, strict=True):
        assert all(x.contains(y) for x, y in zip(found.points[i], exact.points[j], strict=True))


def test_balls_that_are_given_come_back_larger():
    A, D = _case("ramified")
    z = [x + arb(0, 1e-10) for x in A(3 * D)]
    found = A.inverse(z)
    assert 1e-12 < float(found.u[0].rad()) < 1e-8
    assert all(c.contains(arb(int(e))) for c, e in zip(found.u, (3 * D).u, strict=True))


def test_a_branch_point_in_a_cluster_has_an_image_of_order_two():
    roots = [0, 1, Fraction(1000001, 10**6), Fraction(1000003, 10**6), 3]
    C = HyperellipticCurve(QQ, poly.from_roots(QQ, list(map(Fraction, roots))))
    A = AbelBalls(C, 15)
    for e in roots:
        assert _is_period(A, [2 * x for x in A(C.jacobian().from_points([(e, 0)]))])


def test_radii_are_as_asked_for():
    C = HyperellipticCurve(CC, [1 + 1j, 2, 0, 0.5, 1j, 1])
    A, finer = AbelBalls(C, 10), AbelBalls(C, 40)
    point = C.lift_x(0.25)
    D = C.jacobian().from_points([point])
    largest = max(abs(complex(x)) for row in A.periods.big for x in row)
    assert max(float(x.rad()) for x in A(D)) < 1e-10 * largest
    assert max(float(x.rad()) for x in finer(D)) < 1e-40 * largest
    assert all(x.overlaps(y) for x, y in zip(A(D), finer(D), strict=True))


def test_what_has_no_proof_is_refused_by_name():
    A, D = _case("ramified")
    for z in ([0, 0], A(5 * D - 5 * D), [row[1] for row in A.periods.big]):
        with pytest.raises(PrecisionLoss, match="period"):
            A.inverse(z)
    with pytest.raises(ArgumentError, match="2 numbers"):
        A.inverse([1])
    for x in ("one", None, float("nan"), float("inf")):
        with pytest.raises(ArgumentError, match=r"z\[1\]"):
            A.inverse([1, x])
    with pytest.raises(CurveMismatch):
        A(_case("split")[1])
    with pytest.raises(NotRepresentable, match="inert"):
        AbelBalls(HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 0, 0, 0, 2]), 10).inverse([1, 2, 3])


@pytest.mark.slow
def test_points_on_branch_points_have_no_proof():
    A, D = _case("ramified")
    with pytest.raises(PrecisionLoss):
        A.inverse(A(D))


def test_it_can_be_pickled():
    A, _ = _case("genus 1")
    assert pickle.loads(pickle.dumps(A)) == A
