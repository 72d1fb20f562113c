"""Periods of the second kind, ℘_ij and ζ_i: Legendre's relation, differential equations, FLINT's theta functions."""

from __future__ import annotations

from functools import cache

import flint
import pytest

from jacobian import MP, QQ, RR, ArgumentError, HyperellipticCurve, PrecisionLoss
from jacobian.periods.abel import AbelMap
from jacobian.periods.abel_balls import AbelBalls
from jacobian.periods.kleinian import KleinianFunctions
from jacobian.periods.matrix import periods
from jacobian.periods.proven import period_balls
from jacobian.periods.second_kind import second_kind

ALL = [
    ([-1, 1, 0, 2], [1]),
    ([1, 1, 0, 0, 2], []),
    ([1, 0, 0, 0, 0, 1], []),
    ([3, 1, 4, 1, 5, 2], [1, 2]),
    ([1, 2, 0, 0, 0, 0, 3], []),
    ([-1, 2, 0, 0, 1, 0, -3], [1, 2, 0, 1]),
    ([3, 1, 4, 1, -5, 9, 2, 6], []),
    ([1, 2, 3, 0, 1, 0, 0, 0, 5], []),
]
GENUS_2 = ALL[2:6]
# exact floats, also after a step of 2^-40
Z, STEP = (0.3125 + 0.21875j, -0.171875 + 0.328125j), 2.0**-40


def matrices(P):
    S = second_kind(P)
    g = P.cover.genus
    first, second = ([(*a, *b) for a, b in zip(X.A, X.B, strict=True)] for X in (P, S))

    def paired(v, w):
        return sum(v[k] * w[g + k] - v[g + k] * w[k] for k in range(g))

    return [[[paired(v, w) for w in rows] for v in others] for others, rows in ((first, second), (second, second))]


@pytest.mark.parametrize(("f", "h"), ALL)
def test_legendres_relation_in_balls(f, h):
    P = period_balls(HyperellipticCurve(QQ, f, h), 40)
    with P.cover.numbers.working():
        mixed, own = matrices(P)
        turn = flint.acb(0, 2) * flint.arb.pi()
        for i in range(len(mixed)):
            for j in range(len(mixed)):
                assert mixed[i][j].overlaps(turn * int(i == j))
                assert mixed[i][j].rad() < 1e-36
                assert own[i][j].contains(0)


@pytest.mark.parametrize(("f", "h"), ALL)
@pytest.mark.parametrize("field", [RR, MP(40)])
def test_legendres_relation_in_floats(f, h, field):
    P = periods(HyperellipticCurve(field, f, h))
    mixed, own = matrices(P)
    turn = P.cover.numbers.convert(2j) * P.cover.numbers.pi
    size = 1e-13 if field == RR else 1e-37
    for i in range(len(mixed)):
        for j in range(len(mixed)):
            assert abs(mixed[i][j] - turn * (i == j)) < size
            assert abs(own[i][j]) < size


@cache
def functions(f, h):
    A = AbelMap(HyperellipticCurve(MP(40, complex=True), f, h))
    return KleinianFunctions(A, None if A.curve.model == "ramified" else 3)


def frozen(rows):
    return [(tuple(f), tuple(h)) for f, h in rows]


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("f", "h"), frozen(GENUS_2))
def test_zeta_is_odd_and_its_slopes_are_wp(f, h):
    K = functions(f, h)
    wp, zeta = K.wp(Z), K.zeta(Z)
    slopes = []
    for j in range(2):
        ends = [K.zeta([x + sign * STEP * (i == j) for i, x in enumerate(Z)]) for sign in (1, -1)]
        slopes.append([(a - b) / (2 * STEP) for a, b in zip(*ends, strict=True)])
    for found, expected in zip(slopes, ((wp.p11, wp.p12), (wp.p12, wp.p22)), strict=True):
        assert all(abs(a + b) < 1e-20 for a, b in zip(found, expected, strict=True))
    minus = [-x for x in Z]
    assert all(abs(a - b) < 1e-36 for a, b in zip(wp, K.wp(minus), strict=True))
    assert all(abs(a + b) < 1e-36 for a, b in zip(zeta, K.zeta(minus), strict=True))


@pytest.mark.thinned(4)
@pytest.mark.parametrize(("f", "h"), frozen(GENUS_2))
def test_zeta_has_the_periods_of_the_second_kind(f, h):
    K, n = functions(f, h), (1, -2, 0, 3)
    P, S = K.abel.periods, second_kind(K.abel.periods)
    moved = [x + sum(k * p for k, p in zip(n, row, strict=True)) for x, row in zip(Z, P.big, strict=True)]
    rows = [(*a, *b) for a, b in zip(S.A, S.B, strict=True)]
    for after, before, row in zip(K.zeta(moved), K.zeta(Z), rows, strict=True):
        assert abs(after - before + sum(k * p for k, p in zip(n, row, strict=True))) < 1e-36
    assert all(abs(a - b) < 1e-35 for a, b in zip(K.wp(moved), K.wp(Z), strict=True))


def from_theta(P, z, characteristic):
    """(℘_11, ℘_12, ℘_22, ζ_1, ζ_2) of σ = exp(½ zᵀκz)·θ[δ](A⁻¹z | τ), κ = −E·A⁻¹, by differences of FLINT's theta."""
    A, E = flint.acb_mat(P.A), flint.acb_mat(second_kind(P).A)
    inverse, tau = A.inv(), flint.acb_mat(P.tau)
    kappa, step = -E * inverse, flint.arb("1e-16")

    def value(i, j):
        return tau.theta(inverse * flint.acb_mat([[z[0] + i * step], [z[1] + j * step]]))[0, characteristic]

    middle = value(0, 0)
    ratio = {(i, j): (value(i, j) / middle).log() for i in (-1, 0, 1) for j in (-1, 0, 1)}
    slopes = [(ratio[1, 0] - ratio[-1, 0]) / (2 * step), (ratio[0, 1] - ratio[0, -1]) / (2 * step)]
    second = {
        (0, 0): (ratio[1, 0] + ratio[-1, 0]) / step**2,
        (1, 1): (ratio[0, 1] + ratio[0, -1]) / step**2,
        (0, 1): (ratio[1, 1] + ratio[-1, -1] - ratio[1, -1] - ratio[-1, 1]) / (4 * step**2),
    }
    wp = [-second[i, j] - kappa[i, j] for i, j in ((0, 0), (0, 1), (1, 1))]
    return [*wp, *(slopes[i] + kappa[i, 0] * z[0] + kappa[i, 1] * z[1] for i in range(2))]


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("f", "h"), GENUS_2)
def test_beside_theta(f, h):
    """One of the six odd characteristics, the same at all points, reproduces all five functions."""
    C = HyperellipticCurve(QQ, f, h)
    A = AbelBalls(C, 60)
    K = KleinianFunctions(A, None if C.model == "ramified" else 3)
    odd = [k for k in range(16) if bin((k >> 2) & k & 3).count("1") % 2 == 1]
    fitting = []
    for z in ((0.3, -0.17), (0.11 + 0.2j, 0.4 - 0.1j)):
        found = [*K.wp(z), *K.zeta(z)]
        with A.periods.cover.numbers.working():
            point = [flint.acb(x) for x in z]
            near = [
                k
                for k in odd
                if all(
                    abs(complex((x - y).mid())) < 1e-20 * (1 + abs(complex(x)))
                    for x, y in zip(from_theta(A.periods, point, k), found, strict=True)
                )
            ]
        assert len(near) == 1
        fitting += near
    assert len(odd) == 6
    assert len(set(fitting)) == 1


def test_what_has_no_kleinian_functions():
    ramified = AbelMap(HyperellipticCurve(RR, [1, 0, 0, 0, 0, 1]))
    split = AbelMap(HyperellipticCurve(RR, [1, 2, 0, 0, 0, 0, 3]))
    with pytest.raises(ArgumentError, match="genus 2"):
        KleinianFunctions(AbelMap(HyperellipticCurve(RR, [1, 0, 0, 1])))
    with pytest.raises(ArgumentError, match="infinity being it"):
        KleinianFunctions(ramified, 0)
    for number in (None, 6, True):
        with pytest.raises(ArgumentError, match=r"0 … 5"):
            KleinianFunctions(split, number)
    with pytest.raises(PrecisionLoss, match="poles"):
        KleinianFunctions(ramified).wp([0, 0])
    with pytest.raises(ArgumentError):
        KleinianFunctions(ramified).zeta([0.1])
