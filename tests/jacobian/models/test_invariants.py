"""Invariants of curves of genus 2 against published values, discriminants and isomorphisms."""

from random import Random

import pytest

from jacobian import CC, GF, MP, QQ, RR, ArgumentError, FieldError, HyperellipticCurve, JacobianError, poly
from jacobian.models.invariants import g2_invariants, igusa_clebsch_invariants, igusa_invariants
from jacobian.models.isomorphism import Isomorphism

FIELDS = (GF(2), GF(3), GF(5), GF(101), GF(2**61 - 1), GF(2, 5), GF(3, 4), GF(5, 2), QQ)


def power(K, x, n):
    result = K.one
    for _ in range(n):
        result = K.mul(result, x)
    return result


@pytest.mark.parametrize("K", [QQ, RR, CC, MP(30)], ids=lambda K: K.name)
def test_the_modular_curve_of_level_13(K):
    """X1(13), curve 169.a.169.1 of the LMFDB: (I2, I4, I6, I10) = (4, 793, 3757, −21632) up to weights."""
    C = HyperellipticCurve(K, [0, 0, 0, 0, 1, 1], [1, 1, 0, 1])
    for found, expected in zip(igusa_invariants(C), (1, -33, -43, -283, -169), strict=True):
        assert found == expected if K.exact else abs(found - expected) < 1e-12
    published = (8, 4 * 793, 8 * 3757, -32 * 21632)
    for found, expected in zip(igusa_clebsch_invariants(C), published, strict=True):
        assert found == expected if K.exact else abs(found / expected - 1) < 1e-13


@pytest.mark.parametrize("K", FIELDS, ids=lambda K: K.name)
def test_they_go_with_isomorphisms_and_the_last_is_the_discriminant(K):
    rng, tried = Random(3), 0

    def number():
        return K.coerce(rng.randint(-4, 4)) if K.order is None else K.random(rng)

    while tried < 6:
        try:
            C = HyperellipticCurve(K, [number() for _ in range(7)], [number() for _ in range(4)])
            iso = Isomorphism(C, [number() for _ in range(4)], number(), [number() for _ in range(4)])
        except JacobianError:
            continue
        if C.genus != 2:
            continue
        tried += 1
        weight = K.div(K.mul(iso.scale, iso.scale), power(K, iso.determinant, 3))
        before, after = igusa_invariants(C), igusa_invariants(iso.target)
        for k, x, y in zip((2, 4, 6, 8, 10), before, after, strict=True):
            assert K.mul(power(K, weight, k), x) == y
        assert before[4] != K.zero
        if K.characteristic == 2:
            continue
        twist = C.quadratic_twist(2 if K == QQ else None)
        assert g2_invariants(C) == g2_invariants(iso.target) == g2_invariants(twist)
        F = C.discriminant
        slope = poly.derivative(K, F)
        if len(F) == 7 and len(slope) == 6:
            # disc F = (−1)^(n(n−1)/2) Res(F, F')/lead
            discriminant = K.neg(K.div(poly.resultant(K, F, slope), F[-1]))
            assert igusa_clebsch_invariants(C)[3] == discriminant


def test_the_curve_whose_invariants_vanish():
    """For y² = x⁵ + 1 all invariants but the last vanish; y² = x⁵ − x and y² = x⁶ + 1 are other curves."""
    C = HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1])
    assert igusa_invariants(C)[:4] == (0, 0, 0, 0)
    assert g2_invariants(C) == (0, 0, 0)
    others = [HyperellipticCurve(QQ, f) for f in ([0, -1, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1])]
    assert len({g2_invariants(E) for E in (C, *others)}) == 3


def test_the_second_and_third_kind_of_invariants():
    """J2 = 0 ≠ J4 and J2 = J4 = 0 ≠ J6 over a small field: the other invariants distinguish the curves."""
    K, rng, kinds = GF(7), Random(1), {}
    while len(kinds) < 3:
        try:
            C = HyperellipticCurve(K, poly.random(K, 6, rng))
        except JacobianError:
            continue
        if C.genus == 2:
            j2, j4, j6, _, _ = igusa_invariants(C)
            found = g2_invariants(C)
            kind = next((i for i, x in enumerate((j2, j4, j6)) if x), 3)
            assert [bool(x) for x in found[:kind]] == [False] * min(kind, 3)
            assert kind == 3 or found[kind] != 0
            kinds[kind] = found


def test_other_curves_are_refused():
    with pytest.raises(ArgumentError, match="genus 3"):
        igusa_invariants(HyperellipticCurve(GF(101), [1, 1, 0, 0, 0, 0, 0, 1]))
    with pytest.raises(FieldError, match="characteristic 2"):
        igusa_clebsch_invariants(HyperellipticCurve(GF(2, 3), [1, 0, 0, 0, 0, 1], [1]))
    with pytest.raises(FieldError, match="exact fields"):
        g2_invariants(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]))
