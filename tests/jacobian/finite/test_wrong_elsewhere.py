"""Curves on which other programs gave wrong answers, checked by mathematics: points counted here one by one, and Weil's
bounds.

Magma's tracker has L-polynomials over GF(3) and GF(11) (issue 76) and a factor at 2 (issue 144); Sage had J(P, P) ≠ 0
on models with two points at infinity, and random elements of inert models of odd genus.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from jacobian import GF, QQ, HyperellipticCurve, NotRepresentable


def counted(p, f):
    """The numbers of points of y² = f of even degree over GF(p) and GF(p²), p ≡ 3 modulo 4: GF(p)(i)."""

    def times(a, b):
        return (a[0] * b[0] - a[1] * b[1]) % p, (a[0] * b[1] + a[1] * b[0]) % p

    def points(elements):
        squares = [times(y, y) for y in elements]

        def value(x):
            total = (0, 0)
            for c in reversed(f):
                total = times(total, x)
                total = (total[0] + c) % p, total[1]
            return total

        return sum(squares.count(value(x)) for x in elements) + squares.count((f[-1] % p, 0))

    return points([(a, 0) for a in range(p)]), points(list(product(range(p), repeat=2)))


@pytest.mark.parametrize(
    ("p", "f", "points", "L"),
    [
        (3, [1, 2, 0, 0, 0, 2, 2], (4, 8), [1, 0, -1, 0, 9]),
        (11, [4, 4, 8, 4, 3, 3, 5], (14, 118), [1, 2, 0, 22, 121]),
    ],
)
def test_l_polynomials_over_small_fields(p, f, points, L):
    """a_1 = N_1 − p − 1 and a_2 = (N_2 − p² − 1 + a_1²)/2, from both counts, and by every method of the package."""
    assert counted(p, f) == points
    first = points[0] - p - 1
    assert [1, first, (points[1] - p * p - 1 + first**2) // 2, p * first, p * p] == L
    C = HyperellipticCurve(GF(p), f)
    J = C.jacobian()
    assert C.count_points(2) == list(points)
    assert C.l_polynomial() == L
    assert J.order() == J.structure().order == sum(L) == len(set(J.points()))
    assert HyperellipticCurve(QQ, f).l_polynomials(20).polynomial(p) == L


def test_a_factor_at_two():
    """y² = 16x⁵ + 88x⁴ + 65x³ − 170x² + x has the L-polynomials of 834.a.1668.1; at the bad prime 2 no factor is
    returned.

    The factor 1 + T² − 2T³ = (1 − T)(1 + T + 2T²) has inverse roots of modulus 1 and √2.
    """
    C = HyperellipticCurve(QQ, [0, 1, -170, 65, 88, 16])
    E = HyperellipticCurve(QQ, [-1, 1, -1], [1, 0, 0, 1])
    found, expected = C.l_polynomials(800), E.l_polynomials(800)
    assert 2 in found.bad
    assert expected.bad == (2, 3, 139)
    common = set(found.p.tolist()) & set(expected.p.tolist())
    assert len(common) > 130
    assert all(found.polynomial(p) == expected.polynomial(p) for p in common)
    modulus = np.sort(np.abs(np.roots([1, 0, 1, -2])))
    assert np.allclose(modulus, [1, 2**0.5, 2**0.5])
    terms = expected.dirichlet_coefficients({2: [1, 0, 1, -2]})
    # of 1/(1 + T² − 2T³) = 1 − T² + 2T³ + T⁴ …
    assert [int(terms[2**k]) for k in range(5)] == [1, 0, -1, 2, 1]


@pytest.mark.parametrize(
    ("K", "f"),
    [
        (K, f)
        for K in (GF(7), GF(11), GF(3, 2))
        for f in ([1, 2, 0, 1, 1], [1, 1, 0, 0, 0, 0, 1], [1, 0, 1, 0, 1, 0, 2], [1, 2, 0, 0, 0, 0, 0, 0, 4])
    ],
)
def test_a_point_less_itself_is_zero(K, f):
    C = HyperellipticCurve(K, f)
    J, points = C.jacobian(), list(C.points())
    assert points
    for P in points:
        assert J(P, P) == J.zero()
        assert all(J(P, Q) == -J(Q, P) for Q in points[:6])


@pytest.mark.parametrize(("p", "f"), [(3, [1, 2, 0, 0, 0, 0, 0, 0, 2]), (7, [1, 2, 0, 0, 0, 0, 0, 0, 3])])
def test_an_inert_model_of_odd_genus_has_no_random_class(p, f):
    """Its classes have no unique pair (u, v), so that none is returned rather than a wrong one; the order is known."""
    C = HyperellipticCurve(GF(p), f)
    assert (C.genus, C.model) == (3, "inert")
    for call in (C.jacobian().zero, lambda: C.jacobian().random(np.random.default_rng(1))):
        with pytest.raises(NotRepresentable, match="odd genus"):
            call()
    assert C.jacobian().order() == sum(C.l_polynomial())
