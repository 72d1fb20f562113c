"""Split models of odd genus over floats and long numbers, including points at infinity, agree with those over QQ."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from jacobian import CC, MP, RR
from tests.jacobian.inexact.test_composition import assert_equal, into, rational_points, rounded, size
from tests.jacobian.jacobian_rows import Row

FIELDS = {"RR": RR, "MP(30)": MP(30), "CC": CC}


def classes(curve, rng):
    """Classes of every weight, made of points, some of them opposite, and of either point at infinity."""
    J, points, far = curve.jacobian(), rational_points(curve), curve.points_at_infinity()
    found = [J.zero(), *(J.from_points([P] * curve.genus) for P in far)]
    for weight in range(1, curve.genus + 1):
        chosen, rest = rng.choices(points, k=weight), curve.genus - weight
        found += [J.from_points(chosen), J.from_points([*chosen, *rng.choices(far, k=rest)])]
        found.append(J.from_points([*map(curve.involution, chosen[:1]), *chosen[1:], *rng.choices(far, k=rest)]))
    return found


@pytest.mark.thinned(2)
@pytest.mark.parametrize("K", FIELDS.values(), ids=FIELDS)
@pytest.mark.parametrize("with_h", [False, True])
@pytest.mark.parametrize("genus", [1, 3, pytest.param(5, marks=pytest.mark.slow)])
def test_sums_and_opposites_are_those_over_the_rationals(genus, with_h, K):
    C = Row("QQ", "split", genus, with_h).curve
    J, rng = rounded(K, C), Random(f"at infinity {genus}")
    found = classes(C, rng)
    for D in rng.sample(found, min(8, len(found))):
        assert_equal(-into(J, D), -D, size(D))
    pairs = list(product(found, repeat=2))
    for D, E in rng.sample(pairs, 12):
        assert_equal(into(J, D) + into(J, E), D + E, size(D) * size(E))
        # all points of D − D are in opposite pairs P + ιP
        assert into(J, D) - into(J, D) == J.zero()


@pytest.mark.parametrize("m", [-3, 5])
def test_multiples_in_odd_genus(m):
    C = Row("QQ", "split", 3, False).curve
    D = C.jacobian().from_points(rational_points(C)[:3])
    J = rounded(MP(60), C)
    assert_equal(m * into(J, D), m * D, size(D, m * D) ** 2)
