"""Torsion over QQ compared with published groups: modular curves and Leprévost's curve."""

import pytest

from jacobian import GF, QQ, ArgumentError, FieldError, HyperellipticCurve, poly
from jacobian.relatives.kummer import kummer_surface
from jacobian.relatives.torsion_lifts import rational_class, rational_of
from tests.jacobian.law.test_reference_cases import curve_of, of_kind

# f, h and the torsion of the Jacobian. X0(N), N prime: cyclic of the order that is the numerator of (N − 1)/12 (Mazur
# 1977); X1(13), X1(16), X1(18): Ogg 1974; X0(26), X0(50): Ogg 1974; order 29: Leprévost 1993
PUBLISHED = {
    "X1(13)": ([0, 0, 0, 0, 1, 1], [1, 1, 0, 1], (19,)),
    "X1(16)": ([0, -1, 2, 0, 2, 1], [], (2, 10)),
    "X1(18)": ([1, 4, 10, 10, 5, 2, 1], [], (21,)),
    "X0(23)": ([-7, 10, -11, 2, 2, -8, 1], [], (11,)),
    "X0(26)": ([1, -8, 8, -18, 8, -8, 1], [], (21,)),
    "X0(29)": ([-7, 8, 8, 2, -12, -4, 1], [], (7,)),
    "X0(31)": ([-3, -14, -11, 18, 6, -8, 1], [], (5,)),
    "X0(37)": ([-4, 12, -24, 28, -20, 8, 1], [], (3,)),
    "X0(50)": ([1, -4, 0, -10, 0, -4, 1], [], (15,)),
    "order 29": ([4, -16, 20, -8, 1, -4, 4], [], (29,)),
}


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", PUBLISHED)
def test_published_groups(name):
    f, h, invariants = PUBLISHED[name]
    J = HyperellipticCurve(QQ, f, h).jacobian()
    torsion = J.rational_torsion()
    assert torsion.proven
    assert torsion.found.invariants == torsion.bound == invariants
    for d, D in zip(invariants, torsion.found.generators, strict=True):
        assert D.order() == d
    assert len(set(torsion.found.elements())) == torsion.found.order


@pytest.mark.thinned(3)
@pytest.mark.parametrize("case", of_kind("torsion"))
def test_groups_that_the_lmfdb_has(case):
    """The models of its pages, whose groups include 16, 18, 22, 27, 29, 2 × 12, 2 × 14, 2 × 2 × 4."""
    torsion = curve_of(case).jacobian().rational_torsion()
    assert torsion.proven
    assert list(torsion.found.invariants) == case["expected"]["torsion_structure"]


@pytest.mark.parametrize(
    ("f", "invariants"),
    [
        ([0, -1, 0, 0, 0, 1], (2, 2, 2)),
        ([1, 0, 0, 0, 0, 1], (10,)),
        ([1, 0, 0, 0, 0, 0, 1], (3, 6)),
        ([7, 1, 0, 0, 0, 1], ()),
        # genus 1: y² = x³ + 1; genus 3: y² = x⁷ + 1 with (0, 1) of order 7 and (−1, 0) of order 2
        ([1, 0, 0, 1], (6,)),
        ([1, 0, 0, 0, 0, 0, 0, 1], (14,)),
    ],
)
def test_groups_with_classes_of_order_two(f, invariants):
    torsion = HyperellipticCurve(QQ, f).jacobian().rational_torsion()
    assert torsion.proven
    assert torsion.found.invariants == invariants


def test_other_models_have_the_same_group():
    """X1(13) in a Weierstrass form without h, and with another point as ∞₊."""
    F = HyperellipticCurve(QQ, [0, 0, 0, 0, 1, 1], [1, 1, 0, 1]).discriminant
    for C in (HyperellipticCurve(QQ, F), HyperellipticCurve(QQ, F[::-1])):
        assert C.jacobian().rational_torsion().found.invariants == (19,)


def test_points_of_great_height_are_not_needed():
    """No point has height 1, and still the whole group is found."""
    f, _, _ = PUBLISHED["order 29"]
    shifted = poly.shift(QQ, tuple(map(QQ.coerce, f)), QQ.coerce("1/97"))
    torsion = HyperellipticCurve(QQ, shifted).jacobian().rational_torsion(height=1)
    assert torsion.found.invariants == torsion.bound == (29,)


def test_what_is_not_found_is_not_called_proven():
    """y² = x⁷ + 1 with x + 1/97 for x: in genus 3 only points are searched for."""
    f = poly.shift(QQ, tuple(map(QQ.coerce, [1, 0, 0, 0, 0, 0, 0, 1])), QQ.coerce("1/97"))
    torsion = HyperellipticCurve(QQ, f).jacobian().rational_torsion(height=1)
    assert torsion.bound == (14,)
    assert torsion.found.invariants == (2,)
    assert not torsion.proven


# A search for points of small height alone did not find, or not prove, the groups of these curves. y² = f(x²) has the
# quotients y² = f(x) and y² = x³f(1/x). These curves are glued from quotients with the given orders along their classes
# of order two (Howe, Leprévost & Poonen 2000, proposition 4), or are Richelot-isogenous to such curves; the one of
# order 63 is from that paper
FAR_FROM_POINTS = [
    ([375, 0, 97, 0, 8], [0, 1, 0, 1], (24,)),
    ([-146398496, 0, 79136353, 0, -197570, 0, 897], [], (63,)),
    ([-14457225, 0, 348933249, 0, 326354400, 0, -348000000], [], (2, 4, 8)),
    ([191426853049061, 0, -281366900894339, 0, -445714822693400, 0, 27078931250000], [], (2, 4, 4)),
    ([-18954339261, 0, 36721202661, 0, -20448113400, 0, 2681250000], [], (2, 2, 2, 4)),
    ([-12, 0, 19, 0, -8, 0, 1], [], (2, 2, 8)),
    ([211128848, 0, 1782031105, 0, 113907886, 0, 209729], [], (8, 8)),
    ([126, 0, -473, 0, 456, 0, -45], [], (2, 48)),
    ([6, 0, 1, 0, -4, 0, 1], [], (4, 8)),
    ([126, 0, -566, 0, 114, 0, 1350], [], (6, 6)),
]


@pytest.mark.thinned(5)
@pytest.mark.parametrize(("f", "h", "invariants"), FAR_FROM_POINTS)
def test_groups_far_from_small_points(f, h, invariants):
    torsion = HyperellipticCurve(QQ, f, h).jacobian().rational_torsion(height=1)
    assert torsion.proven
    assert torsion.found.invariants == invariants
    assert len(set(torsion.found.elements())) == torsion.found.order
    assert [D.order() for D in torsion.found.generators] == list(invariants)


@pytest.mark.parametrize("name", ["X1(13)", "X0(26)", "X1(16)"])
def test_classes_come_back_from_the_kummer_surface(name):
    """Classes of all weights on a split and a ramified model; points of another curve's surface have no class."""
    f, h, _ = PUBLISHED[name]
    J = HyperellipticCurve(QQ, f, h).jacobian()
    surface = kummer_surface(J.curve)
    for D in J.rational_torsion().found.elements():
        assert rational_class(surface, J, surface.point(D)) in (D, -D)
    assert rational_class(surface, J, (1, 2, 5, 7)) is None


def test_fractions_from_residues():
    modulus = 7**40
    for n, d in ((3, 5), (-11, 13), (0, 1), (10**6, 999983)):
        assert rational_of(n * pow(d, -1, modulus) % modulus, modulus, 10**7) == (n, d)
    assert rational_of(3**70 % modulus, modulus, 10**7) is None


def test_what_is_refused():
    with pytest.raises(FieldError, match="torsion over QQ"):
        HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).jacobian().rational_torsion()
    with pytest.raises(ArgumentError, match="height = 0"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().rational_torsion(0)
