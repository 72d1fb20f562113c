"""Kummer surfaces over QQ, canonical heights, regulators and relations in genus 2."""

from fractions import Fraction
from math import gcd, log, prod

import pytest

from jacobian import GF, QQ, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve
from jacobian.periods.balls import ball_numbers
from jacobian.relatives.doubling_bounds import bad_part, real_bounds, tropes
from jacobian.relatives.heights import canonical_height, height_pairing, regulator, relation
from jacobian.relatives.kummer import kummer_surface

# (f, h, points): degree 6, degree 5, with h, with fractions, degree 6 with h of degree 3
CURVES = {
    "split": ([4, 1, 0, 0, 0, 0, 1], (), [(0, 2), (0, 2)]),
    "ramified": ([1, 2, 0, 0, 0, 1], (), [(0, 1), (1, 2)]),
    "with h": ([0, 0, 0, -1, 0, 1], (1, 0, 1), [(0, 0)]),
    "fractions": ([1, "1/2", 0, -5, 3, 2], (), [(0, 1)]),
    "split with h": ([0, 1, 0, -1, 1], (1, 1, 0, 1), [(0, 0)]),
}
# LMFDB, elliptic curve 37.a1 (Cremona's 37a1), regulator; 389.a1 likewise
REGULATOR_37, REGULATOR_389 = 0.0511114082399688, 0.152460177943144


def _class(name):
    f, h, points = CURVES[name]
    J = HyperellipticCurve(QQ, f, h).jacobian()
    return J.from_points(points)


def _primitive(x):
    common = gcd(*x) * (1 if next(c for c in x if c) > 0 else -1)
    return tuple(c // common for c in x)


@pytest.mark.parametrize("name", CURVES)
def test_the_forms_double_all_points(name):
    D = _class(name)
    surface = kummer_surface(D.jacobian.curve)
    E = D.jacobian.zero()
    for _ in range(7):
        doubled = surface.double(surface.point(E))
        assert _primitive(doubled) == _primitive(surface.point(E + E))
        assert bad_part(surface) % gcd(*doubled) == 0
        assert surface.point(E) == surface.point(-E)
        E = E + D


@pytest.mark.parametrize("n", [0, 2])
def test_both_points_at_infinity(n):
    J = HyperellipticCurve(QQ, [4, 1, 0, 3, 0, 5, 1]).jacobian()
    D = J.from_mumford([1], [], n=n)
    surface = kummer_surface(J.curve)
    assert _primitive(surface.double(surface.point(D))) == _primitive(surface.point(D + D))
    E = J.from_points([(0, 2)])
    for G in (E, E - D, E + D):
        assert _primitive(surface.double(surface.point(G))) == _primitive(surface.point(G + G))


@pytest.mark.parametrize("name", ["split", "ramified"])
def test_forms_at_the_tropes_are_squares(name):
    D = _class(name)
    surface, numbers = kummer_surface(D.jacobian.curve), ball_numbers(200)
    low, high = real_bounds(surface)
    with numbers.working():
        pairs = list(tropes(surface, numbers))
        assert len(pairs) == 10
        for m in range(1, 6):
            x = surface.point(m * D)
            doubled = surface.double(x)
            for linear, y in pairs:
                value = sum(c * prod(a**e for a, e in zip(x, k, strict=True)) for k, c in y.items())
                gap = sum(a * b for a, b in zip(linear, doubled, strict=True)) - value**2
                assert gap.contains(0)
            growth = log(max(map(abs, doubled))) - 4 * log(max(map(abs, x)))
            assert low < growth < high


@pytest.mark.parametrize("name", CURVES)
def test_heights_are_quadratic(name):
    D = _class(name)
    height = canonical_height(D)
    assert height > 0
    assert height.rad() < 1e-20
    for n in (-1, 2, 3, 5):
        assert (canonical_height(n * D) - n * n * height).contains(0)
    exact, few = canonical_height(D, 40), canonical_height(D, 5)
    assert height.contains(exact)
    assert few.contains(height)
    # its definition as a limit
    surface = kummer_surface(D.jacobian.curve)
    assert abs(log(max(map(abs, surface.point(32 * D)))) / 1024 - float(height)) < 0.02


def test_the_parallelogram_law_and_the_pairing():
    J = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]).jacobian()
    D, E = J.from_points([(0, 1)]), J.from_points([(1, 2)])
    heights = [canonical_height(G) for G in (D + E, D - E, D, E)]
    assert (heights[0] + heights[1] - 2 * heights[2] - 2 * heights[3]).contains(0)
    assert (height_pairing(2 * D, E) - 2 * height_pairing(D, E)).contains(0)
    assert height_pairing(D, D).overlaps(canonical_height(D))


def test_points_of_finite_order_have_height_zero():
    J = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian()
    for points in ([(0, 1)], [(-1, 0)], [(0, 1), (-1, 0)], []):
        height = canonical_height(J.from_points(points))
        assert height.contains(0)
        assert height.rad() < 1e-20


def test_a_split_jacobian_has_the_height_of_its_elliptic_curve():
    """(x, y) → (x², y) to 37a, y² = 4X³ − 4X + 1: P − P' with P' = (−x, −y) has twice the height of the image of P."""
    J = HyperellipticCurve(QQ, [1, 0, -4, 0, 0, 0, 4]).jacobian()
    # the image (0, 1) is a generator of 37a, and (1, 1) twice that up to its sign
    for x, square in ((0, 1), (1, 4)):
        D = J.curve.point(x, 1), J.curve.point(-x, -1)
        assert abs(float(canonical_height(J(*D))) - 2 * square * REGULATOR_37) < 1e-14


def test_a_regulator_of_rank_two():
    """The same for 389a, y² = 4X³ + 4X² − 8X + 1, with points above X = 0 and 1: pairings are doubled."""
    J = HyperellipticCurve(QQ, [1, 0, -8, 0, 4, 0, 4]).jacobian()
    classes = [J(J.curve.point(x, 1), J.curve.point(-x, -1)) for x in (0, 1)]
    found = regulator(classes)
    assert abs(float(found) - 4 * REGULATOR_389) < 1e-13
    assert found.rad() < 1e-17
    assert relation(classes) is None
    assert regulator([]) == 1


def test_relations_are_found_and_exact():
    J = HyperellipticCurve(QQ, [1, 2, 0, 0, 0, 1]).jacobian()
    D, E = J.from_points([(0, 1)]), J.from_points([(1, 2)])
    assert relation([D, E]) is None
    found = relation([D, E, 3 * D - 2 * E])
    assert [abs(m) for m in found] == [3, 2, 1]
    torsion = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().from_points([(0, 1)])
    assert relation([torsion]) in ([1], [-1])
    assert relation([]) is None


def test_heights_do_not_depend_on_the_equation():
    """They are unchanged by y → 3y/2 and x → x + 1."""
    heights = []
    for f, x in (
        ([1, 2, 0, 0, 0, 1], 0),
        ([Fraction(9, 4), Fraction(9, 2), 0, 0, 0, Fraction(9, 4)], 0),
        ([4, 7, 10, 10, 5, 1], -1),
    ):
        J = HyperellipticCurve(QQ, f).jacobian()
        heights.append(canonical_height(J.from_points([J.curve.lift_x(x)])))
    assert heights[0].overlaps(heights[1])
    assert heights[0].overlaps(heights[2])


def test_what_has_no_height_is_refused_by_name():
    J = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian()
    with pytest.raises(FieldError, match="genus 2 over QQ"):
        canonical_height(HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).jacobian().zero())
    with pytest.raises(FieldError, match="genus 2 over QQ"):
        canonical_height(HyperellipticCurve(QQ, [1, 0, 0, 1]).jacobian().zero())
    with pytest.raises(ArgumentError, match="divisor class"):
        canonical_height(3)
    with pytest.raises(ArgumentError, match="E = 3: a divisor class"):
        height_pairing(J.zero(), 3)
    for wrong in (3, [1], J):
        with pytest.raises(ArgumentError, match="curve = "):
            kummer_surface(wrong)
    with pytest.raises(ArgumentError, match="D = 3"):
        kummer_surface(J.curve).point(3)
    with pytest.raises(CurveMismatch, match="D = "):
        kummer_surface(J.curve).point(_class("ramified"))
    with pytest.raises(ArgumentError, match="digits"):
        canonical_height(J.zero(), 0)
    with pytest.raises(CurveMismatch):
        regulator([J.zero(), _class("ramified")])
