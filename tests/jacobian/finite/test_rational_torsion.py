"""Torsion over QQ against published groups: modular curves and Leprévost's curve."""

import pytest

from jacobian import GF, QQ, ArgumentError, FieldError, HyperellipticCurve, poly

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
    """X1(13) with a Weierstrass form without h, and with ∞₊ elsewhere."""
    F = HyperellipticCurve(QQ, [0, 0, 0, 0, 1, 1], [1, 1, 0, 1]).discriminant
    for C in (HyperellipticCurve(QQ, F), HyperellipticCurve(QQ, F[::-1])):
        assert C.jacobian().rational_torsion().found.invariants == (19,)


def test_what_is_not_found_is_not_called_proven():
    """With points of height 1 alone nothing of order 29 is seen, unless the bound says there is nothing."""
    f, _, _ = PUBLISHED["order 29"]
    shifted = poly.shift(QQ, tuple(map(QQ.coerce, f)), QQ.coerce("1/97"))
    torsion = HyperellipticCurve(QQ, shifted).jacobian().rational_torsion(height=1)
    assert torsion.bound == (29,)
    assert torsion.proven == (torsion.found.order == 29)


def test_what_is_refused():
    with pytest.raises(FieldError, match="torsion over QQ"):
        HyperellipticCurve(GF(7), [1, 0, 0, 0, 0, 1]).jacobian().rational_torsion()
    with pytest.raises(ArgumentError, match="height = 0"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().rational_torsion(0)
