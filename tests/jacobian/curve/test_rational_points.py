"""Points of small height over QQ, compared with a search through all x."""

from fractions import Fraction
from random import Random

import pytest

from jacobian import QQ, HyperellipticCurve, Infeasible
from tests.fuzz.curves import MODELS, random_curve


def tried(C, bound):
    """The points at infinity, then those over every x in order."""
    xs = {Fraction(a, b) for b in range(1, bound + 1) for a in range(-bound, bound + 1)}
    return [*C.points_at_infinity(), *(P for x in sorted(xs) for P in C.lift_x(x, all=True))]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("genus", [1, 2, 3])
def test_against_every_x(model, genus):
    for seed in range(2):
        C = random_curve(Random(seed), "QQ", genus, model).C
        for bound in (1, 2, 9, 17):
            assert list(C.points(bound)) == tried(C, bound), (C, bound)


def test_denominators_of_the_equation():
    C = HyperellipticCurve(QQ, ["1/4", "-7/9", 0, "2/3", 0, "1/49"], ["1/2", "1/3"])
    assert list(C.points(30)) == tried(C, 30)


def test_a_million_points_are_tried():
    """points(1000) used to take 53 s to the first point; for y² = 278271081x² … (Stahlke 1997), 19 points up to height
    10^4 are known.
    """
    C = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1])
    found = list(C.points(10_000))
    assert found[1:] == [(-1, 0), (0, 1), (0, -1)]
    with pytest.raises(Infeasible, match=r"bound = 10001: up to 10000"):
        next(C.points(10_001))


def test_points_of_large_height_are_found():
    """The points are chosen: f = v² − (ax − b)·w has (b/a, v(b/a))."""
    for a, b in ((997, 1000), (1000, -999), (9973, 9967)):
        # v = 1 + x, w = x⁴ + 3
        f = [1 + 3 * b, 2 - 3 * a, 1, 0, b, -a]
        C = HyperellipticCurve(QQ, f)
        x = Fraction(b, a)
        assert (x, 1 + x) in list(C.points(max(a, abs(b))))
