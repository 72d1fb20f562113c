"""Period matrices of other programs, and the real period."""

from __future__ import annotations

from random import Random

import pytest

from jacobian import CC, QQ, RR, ArgumentError, HyperellipticCurve
from jacobian.periods.conventions import change_of_cycles, in_convention
from jacobian.periods.matrix import periods, real_periods
from jacobian.periods.proven import period_balls
from jacobian.periods.real import real_period

CURVES = [([1, 0, 0, 0, 0, 1], []), ([-1, 2, 0, 0, 1, 0, -3], [1, 2, 0, 1]), ([3, 1, 4, 1, -5, 9, 2, 6], [])]


def test_a_curve_with_h_is_half_as_large():
    """x^k dx/(2y + h) for Sage; for Magma x^k dx/y on y² = 4f + h², or, without h, on y² = f."""
    plain, C = (HyperellipticCurve(QQ, f, h) for f, h in CURVES[:2])
    for curve, program, size in ((plain, "magma", 1), (plain, "sage", 0.5), (C, "magma", 0.5), (C, "sage", 0.5)):
        P = period_balls(curve)
        found = in_convention(P, program)
        assert all(
            abs(complex(x) - size * complex(y)) < 1e-15
            for a, b in zip(found, P.big, strict=True)
            for x, y in zip(a, b, strict=True)
        )
    # the curve y² = 4f + h², as Magma has it, has the same lattice
    simplified = period_balls(HyperellipticCurve(QQ, C.discriminant))
    change_of_cycles(period_balls(C), simplified.big, "magma")


@pytest.mark.parametrize(("f", "h"), CURVES)
def test_a_change_of_cycles_is_found(f, h):
    """A change by products of elementary symplectic matrices, as another program may have made."""
    rng = Random(7)
    for P in (period_balls(HyperellipticCurve(QQ, f, h)), periods(HyperellipticCurve(CC, f, h))):
        g = P.cover.genus
        rows = [[complex(x) for x in row] for row in in_convention(P, "sage")]
        expected = [[int(i == j) for j in range(2 * g)] for i in range(2 * g)]
        for _ in range(6):
            k, m = rng.randrange(g), rng.choice((-2, -1, 1, 2))
            first, second = rng.sample([k, g + k], 2)
            for row in (*rows, *expected):
                row[first] += m * row[second]
        assert change_of_cycles(P, rows, "sage") == expected


def test_what_is_no_period_matrix():
    P = period_balls(HyperellipticCurve(QQ, *CURVES[0]))
    with pytest.raises(ArgumentError, match="cross"):
        change_of_cycles(P, [[*row[2:], *row[:2]] for row in P.big])
    with pytest.raises(ArgumentError, match="no period"):
        change_of_cycles(P, in_convention(P, "sage"))
    with pytest.raises(ArgumentError, match="2 rows of 4"):
        change_of_cycles(P, P.A)
    with pytest.raises(ArgumentError, match="magma"):
        in_convention(P, "maple")


def test_the_real_period_of_an_elliptic_curve():
    """37.a1 of the LMFDB has 5.9869172924639192596640199589: if all points of order two are real, this is twice the
    period of the oval.
    """
    found = real_period(period_balls(HyperellipticCurve(QQ, [0, -1, 0, 1], [1])))
    assert abs(float(found) - 5.9869172924639193) < 1e-14
    (oval,) = real_periods(HyperellipticCurve(RR, [0, -1, 0, 1], [1]))
    assert abs(2 * float(oval.periods[0]) / 2 - float(found)) < 1e-14


def test_the_real_period_is_a_sum_over_ovals():
    """With 2g + 1 real branch points, J(ℝ) has 2^g components, each of which is the torus of all ovals but one. Ω is
    2^g times the volume of this torus: the determinant of the periods of dx/(2y), x dx/(2y) along g bounded ovals.
    """
    f = [0, 4, 0, -5, 0, 1]
    ovals = real_periods(HyperellipticCurve(RR, f))
    a, b = (oval.periods for oval in ovals)
    found = real_period(period_balls(HyperellipticCurve(QQ, f)))
    assert abs(float(found) / (4 * abs(a[0] * b[1] - a[1] * b[0]) / 4) - 1) < 1e-13


def test_what_has_no_real_period():
    with pytest.raises(ArgumentError, match="balls"):
        real_period(periods(HyperellipticCurve(RR, *CURVES[0])))
    with pytest.raises(ArgumentError, match="QQ, RR"):
        real_period(period_balls(HyperellipticCurve(CC, [1j, 0, 0, 0, 0, 1])))
