"""Sato–Tate groups: their moments, and curves with known groups; pictures, Dirichlet coefficients, the command."""

from __future__ import annotations

from fractions import Fraction
from math import comb

import numpy as np
import pytest

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, Infeasible
from jacobian.__main__ import main
from jacobian.arithmetic.command import bound_of, curve_of, polynomial_of
from jacobian.arithmetic.sato_tate import groups, moment, moments_of_groups, over_the_rationals, sato_tate_groups

# identity components U(1)², SU(2), U(1), SU(2)², U(1) × SU(2), USp(4); those of E² and X₁(13) are known by construction
KNOWN = [
    ([1, -1, 0, 0, 0, 1], [], "USp(4)"),
    ([1, 0, 0, 0, 0, 1], [], "Fac"),
    ([0, 0, 0, 0, 1, 1], [1, 1, 0, 1], "E6"),
    ([1, 0, 1, 0, 1, 0, 2], [], "G3,3"),
]


def test_there_are_52_groups_with_integral_moments():
    """Moments of a_1^i·a_2^j are means of characters, hence integers; they distinguish all 52 groups."""
    found = groups(2)
    assert len(found) == 52
    assert len(over_the_rationals(2)) == 37
    means = {}
    for name, parts in found.items():
        values = [moment(parts, i, j) for i in range(0, 15, 2) for j in range(7)]
        assert values[0] == pytest.approx(1, abs=1e-12)
        assert np.allclose(values, np.round(values), rtol=1e-13, atol=1e-7)
        means[name] = tuple(round(x) for x in values)
    assert len(set(means.values())) == 52


def test_moments_that_are_counted_otherwise():
    """Moments of a_1 by combinatorics: for USp(4), closed walks in its Weyl chamber; for SU(2) and U(1), Catalan and
    central binomial numbers.
    """
    found = moments_of_groups(8)
    assert found["USp(4)"][:4] == [_walks(n) for n in (2, 4, 6, 8)]
    one = groups(1)
    for k in range(5):
        assert moment(one["SU(2)"], 2 * k) == pytest.approx(comb(2 * k, k) // (k + 1))
        assert moment(one["U(1)"], 2 * k) == pytest.approx(comb(2 * k, k))
    # moments of the sum over two independent angles
    assert found["G3,3"][1] == sum(comb(4, i) * (1, 0, 1, 0, 2)[i] * (1, 0, 1, 0, 2)[4 - i] for i in range(5))
    assert found["F"][0] == 4


def _walks(n):
    """The number of walks of n steps ±e₁, ±e₂ from (2, 1) back to it within x > y > 0 (Grabiner and Magyar 1993)."""
    counts = {(2, 1): 1}
    for _ in range(n):
        after = {}
        for (x, y), c in counts.items():
            for a, b in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                if a > b > 0:
                    after[a, b] = after.get((a, b), 0) + c
        counts = after
    return counts[2, 1]


@pytest.mark.parametrize(("f", "h", "group"), KNOWN)
def test_groups_of_curves(f, h, group):
    L = HyperellipticCurve(QQ, f, h).l_polynomials(1 << 13)
    verdicts = sato_tate_groups(L)
    assert verdicts[0].group == group
    assert verdicts[0].probability > 0.01
    assert verdicts[0].primes == 0
    assert all(other.probability < 0.9 for other in verdicts[1:])


def test_groups_of_elliptic_curves():
    for f, group in (([1, -1, 0, 1], "SU(2)"), ([0, -1, 0, 1], "N(U(1))")):
        assert [v.group for v in sato_tate_groups(HyperellipticCurve(QQ, f).l_polynomials(1 << 12))] == [group]


def test_what_is_too_few_or_not_known():
    with pytest.raises(ArgumentError, match="too few"):
        sato_tate_groups(HyperellipticCurve(QQ, KNOWN[0][0]).l_polynomials(500))
    with pytest.raises(Infeasible, match="genus 3"):
        sato_tate_groups(HyperellipticCurve(QQ, [1, 1, 0, 0, 0, 0, 0, 1]).l_polynomials(200))


# --- Dirichlet coefficients


def test_dirichlet_coefficients():
    """They are multiplicative and satisfy the recurrence of each Euler factor; those of y² + y = x³ − x belong to its
    newform of level 37.
    """
    C = HyperellipticCurve(QQ, [0, -1, 0, 1], [1])
    L = C.l_polynomials(200)
    # 37 is a prime of multiplicative reduction: 1 − a_37 T, a_37 = 37 − the number of affine smooth points of the cubic
    smooth = [(x, y) for x in range(37) for y in range(37) if (y * y + y - x**3 + x) % 37 == 0]
    node = [(x, y) for x, y in smooth if (2 * y + 1) % 37 == 0 and (3 * x * x - 1) % 37 == 0]
    assert len(node) == 1
    a = L.dirichlet_coefficients({37: [1, -(37 - len(smooth))]})
    # Cremona's table: 37a
    assert a[:12].tolist() == [0, 1, -2, -3, 2, -2, 6, -1, 0, 6, 4, -5]
    assert all(a[m * n] == a[m] * a[n] for m in range(2, 14) for n in range(2, 14) if np.gcd(m, n) == 1)
    assert a[49] == a[7] ** 2 - 7
    assert a[8] == a[2] ** 3 - 2 * 2 * a[2]
    assert L.dirichlet_coefficients()[37 * 2] == 0
    with pytest.raises(ArgumentError, match="no bad prime"):
        L.dirichlet_coefficients({5: [1]})


def test_dirichlet_coefficients_of_genus_2():
    """The coefficient at p² is a_1² − a_2, from the power series of 1/L_p and the number of points over GF(p²)."""
    L = HyperellipticCurve(QQ, [1, -1, 0, 0, 0, 1]).l_polynomials(2000)
    a = L.dirichlet_coefficients()
    for p in (3, 5, 7, 11, 43):
        points = HyperellipticCurve(GF(p), [1, -1, 0, 0, 0, 1]).count_points(2)
        sums = [p + 1 - points[0], p * p + 1 - points[1]]
        assert a[p] == sums[0]
        assert a[p * p] == (sums[0] ** 2 + sums[1]) // 2
    assert a[2] == a[19] == a[38] == 0


# --- pictures, and the command


@pytest.mark.parametrize(
    "f",
    [[1, -1, 0, 1], [1, -1, 0, 0, 0, 1], pytest.param([1, 0, 1, 0, 0, 0, 0, 1], marks=pytest.mark.slow)],
    ids=["genus 1", "genus 2", "genus 3"],
)
def test_pictures(tmp_path, f):
    from jacobian.arithmetic.pictures import draw, figure

    L = HyperellipticCurve(QQ, f).l_polynomials(1000)
    g = L.curve.genus
    axes = figure(L).axes
    assert len(axes) == g + (g > 1)
    assert sum(patch.get_height() for patch in axes[0].patches) > 0
    draw(L, tmp_path / "picture.png")
    assert (tmp_path / "picture.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x^5-x+1", [1, -1, 0, 0, 0, 1]),
        ("3/2*x^6 - 2x + x", [0, -1, 0, 0, 0, 0, Fraction(3, 2)]),
        ("-x**3", [0, 0, 0, -1]),
        ("[1, 0, 2]", [1, 0, 2]),
    ],
)
def test_polynomials_as_they_are_written(text, expected):
    assert polynomial_of(text) == expected


@pytest.mark.parametrize("text", ["", "x^5+y", "x5", "2^x", "x^5 - - x", "[1, x]", "x^99999", "x^5)"])
def test_what_is_no_polynomial(text):
    with pytest.raises(ArgumentError):
        polynomial_of(text)


def test_curves_and_bounds_as_they_are_written():
    C = HyperellipticCurve(QQ, [0, 0, 0, 0, 1, 1], [1, 1, 0, 1])
    assert curve_of("[x^5+x^4, x^3+x+1]") == curve_of("[[0,0,0,0,1,1],[1,1,0,1]]") == C
    assert curve_of("x^5+1") == curve_of("[[1,0,0,0,0,1],[]]") == HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1])
    assert (bound_of("1000"), bound_of("2^10"), bound_of("2**10")) == (1000, 1024, 1024)
    for text in ("2^", "-3", "1e6", "2^100"):
        with pytest.raises(ArgumentError):
            bound_of(text)


def test_the_command(tmp_path, capsys):
    table, picture = tmp_path / "L.csv", tmp_path / "L.svg"
    options = ["--bound", "2^12", "--csv", str(table), "--picture", str(picture)]
    assert main(["sato-tate", "x^5-x+1", *options]) == 0
    said = capsys.readouterr().out
    assert "561 primes up to 4096; bad: 2, 19, 151" in said
    assert "  USp(4): " in said
    assert table.read_text().startswith("p,a1,a2\n3,3,7\n")
    assert "<svg" in picture.read_text(encoding="utf-8")
    assert main(["sato-tate", "x^5-x+1", "--bound", "3"]) == 0
    assert "too few primes" in capsys.readouterr().out
    assert main(["sato-tate", "x+1"]) == 2
    assert main(["sato-tate", "x^5-x+1", "--bound", "2^99"]) == 2
    assert main(["sato-tate", "x^5-x+1", "--csv", str(tmp_path / "none" / "L.csv"), "--bound", "50"]) == 2
    assert capsys.readouterr().err.count("jacobian: error: ") == 3
