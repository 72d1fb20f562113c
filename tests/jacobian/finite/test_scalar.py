"""Fixed bases, linear combinations and Frobenius compared with plain sums, over the table of fields and models."""

from random import Random

import numpy as np
import pytest

from jacobian import GF, QQ, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve
from jacobian.finite.scalar import best_bucket_window, pippenger, pippenger_cost, straus, straus_cost
from tests.jacobian.group_curves import random_curve
from tests.jacobian.jacobian_rows import ROWS

FINITE = [
    pytest.param(row, id=str(row))
    for row in ROWS
    if row.K != QQ and (row.genus == 2 or (row.genus in (1, 3) and row.field in ("GF(7)", "GF(2^8)")))
]


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", FINITE)
def test_fixed_base_is_the_multiple(row):
    rng, J = Random(f"fixed {row}"), row.curve.jacobian()
    for D in row.pool[:2]:
        table = J.fixed_base(D, 4)
        for m in (0, -1, 8, 9, -15, 16, rng.getrandbits(40)):
            assert table(m) == m * table == m * D


@pytest.mark.parametrize("window", [2, 3, 8])
def test_fixed_base_of_every_window(window):
    D = ROWS[0].pool[0]
    table = D.jacobian.fixed_base(D, window)
    assert all(table(m) == m * D for m in range(-300, 300))
    assert np.int64(77) * table == 77 * D


def test_fixed_base_over_the_rationals():
    D = next(row for row in ROWS if row.K == QQ and row.genus == 2).pool[2]
    table = D.jacobian.fixed_base(D, 2)
    assert [table(m) for m in range(-4, 5)] == [m * D for m in range(-4, 5)]


@pytest.mark.thinned(5)
@pytest.mark.parametrize("row", FINITE)
def test_combinations_are_sums(row):
    rng, J = Random(f"combination {row}"), row.curve.jacobian()
    for count in (2, 5):
        Ds = [rng.choice(row.pool) for _ in range(count)]
        ms = [rng.randrange(-(1 << 30), 1 << 30) for _ in range(count)]
        expected = J.zero()
        for m, D in zip(ms, Ds, strict=True):
            expected = expected + m * D
        assert J.combination(ms, Ds) == expected
        pairs = [(m, D) if m > 0 else (-m, -D) for m, D in zip(ms, Ds, strict=True) if m]
        assert straus(J, pairs) == expected
        for window in (2, 5):
            assert pippenger(J, pairs, window) == expected


def test_degenerate_combinations():
    D = ROWS[0].pool[0]
    J = D.jacobian
    assert J.combination([], []) == J.zero()
    assert J.combination([0, 5, 0], [D, J.zero(), -D]) == J.zero()
    assert J.combination([3, -3], [D, D]) == J.zero()
    assert J.combination([1] * 200, [D] * 200) == 200 * D


class Counted:
    """The integers as a group whose operations are counted."""

    operations = 0

    def __init__(self, value):
        self.value = value

    def __add__(self, other):
        if self.value and other.value:
            Counted.operations += 1
        return Counted(self.value + other.value)

    def __neg__(self):
        return Counted(-self.value)

    def __bool__(self):
        return bool(self.value)

    def double(self):
        return self + self

    def zero(self):
        return Counted(0)


@pytest.mark.parametrize(("terms", "bits"), [(1, 64), (2, 256), (16, 64), (64, 128), (300, 64), (1000, 128)])
def test_the_predicted_costs_are_the_counted_ones(terms, bits):
    rng, J = Random(terms), Counted(0)
    pairs = [(rng.getrandbits(bits) | 1 << (bits - 1), Counted(rng.getrandbits(200) + 1)) for _ in range(terms)]
    expected = sum(m * D.value for m, D in pairs)
    window = best_bucket_window(terms, bits)
    for method, cost in (
        (lambda: straus(J, pairs), straus_cost(terms, bits)),
        (lambda: pippenger(J, pairs, window), pippenger_cost(terms, bits, window)),
    ):
        Counted.operations = 0
        assert method().value == expected
        assert 0.55 * cost < Counted.operations < 1.15 * cost + 10


def test_errors_of_combinations():
    D, E = ROWS[0].pool[0], ROWS[-1].pool[0]
    J = D.jacobian
    with pytest.raises(ArgumentError, match=r"2 scalars beside 1 divisors"):
        J.combination([1, 2], [D])
    with pytest.raises(CurveMismatch, match=r"divisors\[1\]"):
        J.combination([1, 2], [D, E])
    with pytest.raises(ArgumentError, match=r"scalars\[0\] = 1\.5"):
        J.combination([1.5], [D])
    with pytest.raises(ArgumentError, match=r"window = 1"):
        J.fixed_base(D, 1)
    with pytest.raises(ArgumentError, match=r"m = '3'"):
        J.fixed_base(D)("3")


SUBFIELD = [
    (GF(2, 7), [1, 0, 1, 0, 0, 1], [0, 1]),
    (GF(2, 5), [1, 1, 0, 1, 0, 0, 1, 1], [1, 0, 1]),
    (GF(7, 3), [1, 2, 0, 3, 0, 1], []),
    (GF(7, 2), [1, 2, 0, 1, 0, 0, 3], []),
    (GF(3, 5), [1, 2, 0, 0, 1, 0, 1, 0, 1], []),
    (GF(3, 4), [1, 2, 0, 1, 1, 0, 1, 0, 2], []),
    (GF(5, 2), [1, 0, 1, 1, 0, 0, 0, 0, 2], [0, 1]),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize(("K", "f", "h"), SUBFIELD)
def test_frobenius_is_an_endomorphism_that_its_polynomial_annihilates(K, f, h):
    C = HyperellipticCurve(K, f, h)
    J, rng = C.jacobian(), Random(3)
    below = HyperellipticCurve(GF(K.characteristic), f, h).jacobian()
    chi = below.frobenius_polynomial()
    for _ in range(6):
        D, E = J.random(rng), J.random(rng)
        image = J.frobenius(D)
        assert J.from_mumford(image.u, image.v, image.n) == image
        assert J.frobenius(D + E) == image + J.frobenius(E)
        assert J.frobenius(D, 2) == J.frobenius(image)
        assert J.frobenius(D, K.degree) == D == J.frobenius(D, 0)
        assert J.combination(chi, [J.frobenius(D, i) for i in range(len(chi))]) == J.zero()


def test_frobenius_exchanges_the_points_at_infinity():
    # 3 is not a square modulo 7, so ∞₊ and ∞₋ are conjugate over GF(49)
    J = HyperellipticCurve(GF(7, 2), [1, 2, 0, 1, 0, 0, 3]).jacobian()
    plus, minus = J.curve.points_at_infinity()
    assert J.frobenius(J(plus, minus)) == J(minus, plus)


def test_frobenius_refuses_curves_that_it_moves():
    K = GF(7, 2)
    C = random_curve(K, 2, "moved", model="ramified")
    D = C.jacobian().random(Random(0))
    with pytest.raises(CurveMismatch, match=r"power = 1: .* conjugate is another curve"):
        C.jacobian().frobenius(D)
    assert C.jacobian().frobenius(D, 2) == D
    with pytest.raises(ArgumentError, match=r"power = -1"):
        C.jacobian().frobenius(D, -1)
    with pytest.raises(FieldError, match="QQ"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().frobenius(
            HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().zero()
        )
