"""Motions near a pair: their points compared with Picard's iteration on the equations of motion."""

import pytest

from integrable.mumford.series import PointMotion, through
from jacobian import poly
from jacobian.inexact.long_field import LongField
from tests.integrable.mumford.picard import taylor

BITS, ORDER = 300, 60


def case(K, genus, degree):
    """A curve, points of it, and a direction."""
    f = poly.from_roots(K, [K.coerce(x) for x in (-7, -4, -2, -1, 0, 1.5, 3, 4.5)[:degree]])
    xs = [K.coerce(6 + 2 * j) for j in range(genus)]
    return f, (xs, [K.sqrt(poly.evaluate(K, f, x)) for x in xs]), [K.coerce(c) for c in (1, -2, 3)[:genus]]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("genus", "degree"), [(1, 3), (2, 5), (2, 6), (3, 7), (3, 8)])
@pytest.mark.parametrize("complex", [False, True])
def test_points_move_as_the_equations_say(genus, degree, complex) -> None:
    with LongField(BITS, complex) as K:
        f, points, direction = case(K, genus, degree)
        other = K.coerce(-3)
        pair = through(K, *points)
        by_points = PointMotion(K, f, points, direction, [other], ORDER)
        by_equations = taylor(K, f, pair, direction, ORDER, [other])
        time = K.coerce(min(by_points.reach, by_equations.radius) / 2**8)
        for one, two in zip(by_points.at(time), by_equations.at(time), strict=True):
            one, two = (row if isinstance(row, (tuple, list)) else [row] for row in (one, two))
            size = max(abs(x) for x in two)
            assert all(abs(x - y) <= 2.0 ** (24 - BITS) * size for x, y in zip(one, two, strict=True))
