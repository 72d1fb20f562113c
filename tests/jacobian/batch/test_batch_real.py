"""Batches over the floats compared with single additions: generic and special rows, unusual units, h ≠ 0."""

from fractions import Fraction
from random import Random

import numpy as np
import pytest

from jacobian import (
    MP,
    QQ,
    RR,
    Divisor,
    FieldError,
    HyperellipticCurve,
    NotOnCurve,
    PrecisionLoss,
    poly,
)
from jacobian.batch import DivisorArray
from jacobian.batch.float_kernels import BLOCK
from jacobian.batch.sums import RANGE, FloatSums

K = MP(50)
# roots −2, −1/2, 0, 1, 3/2; the unit of x, that of y, h
CURVES = {
    "easy": (1.0, 1.0, ()),
    "with h": (1.0, 1.0, (0.5, -1.0, 0.25)),
    "x in thousands": (1024.0, 1.0, ()),
    "small x, large y, h": (2.0**-9, 2.0**12, (2.0**10, 2.0**18)),
}


def curves(name):
    """The curve over RR and over 50 digits, with the same coefficients, and the unit of x."""
    unit, scale, h = CURVES[name]
    f = poly.from_roots(QQ, [QQ.coerce(x) for x in ("-2", "-1/2", "0", "1", "3/2")])
    whole = [c * Fraction(scale) ** 2 / Fraction(unit) ** k for k, c in enumerate(f)]
    half = tuple(Fraction(c) / 2 for c in h)
    rest = poly.sub(QQ, tuple(whole), poly.mul(QQ, half, half))
    rows = [float(c) for c in rest]
    assert [Fraction(c) for c in rows] == list(rest)
    return HyperellipticCurve(RR, rows, h), HyperellipticCurve(K, rows, h), unit


def random_point(curve, unit, rng):
    """A point away from the branch points, so that its multiples stay in the range of floats for a while."""
    while True:
        x = K.coerce(rng.uniform(-2, 3) * unit)
        h = poly.evaluate(K, curve.h, x)
        square = poly.evaluate(K, curve.f, x) + h * h / 4
        if square > abs(curve.f[5]) * unit**5 / 2:
            return x, rng.choice((-1, 1)) * K.sqrt(square) - h / 2


def columns(divisors):
    return np.array([[float(c) for c in (*D.u[:2], *D.v)] for D in divisors]).T.copy()


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", CURVES)
def test_sums_of_random_divisors(name):
    """One to one, one to many, doubles, in more than one block."""
    curve, precise, unit = curves(name)
    rng, J = Random(name), precise.jacobian()
    size = BLOCK + 40

    def random_divisors(count):
        some = [J.from_points([random_point(precise, unit, rng) for _ in range(2)]) for _ in range(count)]
        return (some * (size // count + 1))[:size]

    # 60·59 different pairs
    first, second = random_divisors(60), random_divisors(59)
    sums = FloatSums(curve)
    cases = {
        "each": (columns(second), list(zip(first, second, strict=True))),
        "one": (columns(second[:1]), [(D, second[0]) for D in first]),
        "double": (columns(first), [(D, D) for D in first]),
    }
    # the sizes of u0, u1, v0, v1
    units = np.array([unit**2, unit, CURVES[name][1], CURVES[name][1] / unit])
    for kind, (right, pairs) in cases.items():
        found, doubtful = sums.add(columns(first), right)
        assert doubtful.mean() < 0.05
        errors = []
        for j in range(0, size, 16):
            if doubtful[j]:
                continue
            true = columns([pairs[j][0] + pairs[j][1]])[:, 0] / units
            size_of = max(1, *abs(true)) * max(1, *(abs(columns(pairs[j][:1]))[:, 0] / units))
            errors.append(max(abs(found[:, j] / units - true)) / size_of**2)
        assert max(errors) < 1e-9, kind
        assert np.median(errors) < 1e-13, kind


@pytest.mark.parametrize("name", ["easy", "with h"])
def test_sums_that_drop_in_weight_are_reported(name):
    """Sums that are 0 or one point are reported; sums of weight 2 with opposite points are right."""
    curve, precise, unit = curves(name)
    rng, J = Random(7), precise.jacobian()
    sums = FloatSums(curve)
    P, Q, R, S = (random_point(precise, unit, rng) for _ in range(4))
    D = J.from_points([P, Q])
    opposite = J.from_points([precise.involution(Q), R])
    one_point = J.from_points([S]) - D
    first = columns([D, D, D])
    found, doubtful = sums.add(first, columns([-D, one_point, opposite]))
    assert doubtful.tolist() == [True, True, False]
    true = columns([J.from_points([P, R])])[:, 0]
    assert np.abs(found[:, 2] - true).max() < 1e-12 * max(1, *abs(true))


# --- DivisorArray -----------------------------------------------------------------------------------------------------


def divisors_of_every_weight(name, count=12):
    """(J over RR, divisors of weight 2, 1 and 0 as floats, the same with 50 digits)."""
    curve, precise, unit = curves(name)
    rng, wide = Random(name), precise.jacobian()
    J = curve.jacobian()
    true = [wide.from_points([random_point(precise, unit, rng) for _ in range(2 - i % 4 // 2)]) for i in range(count)]
    true.append(wide.zero())
    return J, [rounded(J, D) for D in true], true


def rounded(J, D):
    return Divisor(J, tuple(map(float, D.u)), tuple(map(float, D.v)), None)


def distance(found, true):
    """The distance of the coefficients of two divisors of the same weight."""
    assert len(found.u) == len(true.u)
    size = max(1, *(abs(float(x)) for x in (*true.u, *true.v)))
    return max(abs(float(x - y)) / size for x, y in zip((*found.u, *found.v), (*true.u, *true.v), strict=True))


@pytest.mark.thinned(2)
@pytest.mark.parametrize("name", ["easy", "with h"])
def test_arrays_of_every_weight(name):
    """Every pair of divisors of weight 2, 1 and 0, including opposite ones, agrees with 50 digits."""
    _, found, true = divisors_of_every_weight(name)
    pairs = [(i, j) for i in range(len(true)) for j in range(len(true))]
    first, second = (DivisorArray.stack([found[pair[k]] for pair in pairs]) for k in (0, 1))
    assert second.degree.tolist() == [true[j].degree for _, j in pairs]
    sums, differences = first + second, first - second
    for (i, j), total in zip(pairs, sums, strict=True):
        assert distance(total, true[i] + true[j]) < 1e-10
    for (i, j), total in zip(pairs, differences.to_list(), strict=True):
        if i != j:
            assert distance(total, true[i] - true[j]) < 1e-10
        else:
            assert not total
    A = DivisorArray.stack(found)
    for D, total, opposite in zip(true, A.double(), -A, strict=True):
        assert distance(total, D + D) < 1e-10
        assert distance(opposite, -D) < 1e-12
    assert not sums.status.any()


def test_multiples_and_sums():
    """They are as accurate as single ones: multiples come near infinity, where any arithmetic loses digits."""
    _, found, true = divisors_of_every_weight("easy")
    A = DivisorArray.stack(found)
    scalars = [0, 1, -1, 2, 3, -4, 3, 2, -2, -3, 4, 0, 4]
    for totals, each in ((A * scalars, scalars), (-3 * A, [-3] * len(A))):
        for total, m, D, E in zip(totals, each, true, found, strict=True):
            assert distance(total, m * D) < 1e-12 + 1e3 * distance(m * E, m * D)
    assert not any(0 * A)
    assert distance(A[:4].sum(), true[0] + true[1] + true[2] + true[3]) < 1e-10
    one = A + found[0]
    assert (one == A + DivisorArray.stack([found[0]] * len(A))).all()


def test_arrays_and_divisors_are_the_same_numbers():
    J, found, _ = divisors_of_every_weight("with h")
    A = DivisorArray.stack(found)
    assert A.to_list() == found
    assert A.u.dtype == A.v.dtype == np.float64
    again = DivisorArray.from_arrays(J, A.u, A.v)
    assert (again == A).all()
    assert A[3] == found[3]
    assert A[A.degree == 1].to_list() == [D for D in found if D.degree == 1]
    for k in (0, 2):
        v = A.v.copy()
        v[k, 0] += 0.125
        with pytest.raises(NotOnCurve, match=f"row {k}"):
            DivisorArray.from_arrays(J, A.u, v)
    with pytest.raises(FieldError):
        DivisorArray.from_arrays(J, A.u * np.nan, A.v)


def test_a_row_without_digits_is_lost_alone():
    """If E is a few units in the last place from −D, D + E cannot be decided; only this row is lost."""
    J, found, _ = divisors_of_every_weight("easy")
    D = next(D for D in found if D.degree == 2)
    near = Divisor(J, D.u, (-D.v[0], -D.v[1] * (1 + 4 * RR.eps)), None)
    first, second = DivisorArray.stack([D, D, D]), DivisorArray.stack([D, near, D])
    try:
        alone = J.add(D, near)
    except PrecisionLoss:
        alone = None
    total = first + second
    if alone is None:
        assert total.status.tolist() == [0, 1, 0]
        assert (total + first).status.tolist() == [0, 1, 0]
        assert (total == total).tolist() == [True, False, True]
        assert not total.u[1].any()
        with pytest.raises(PrecisionLoss, match="row 1"):
            total.to_list()
    else:
        assert total[1] == alone
    assert distance(total[2], D + D) < 1e-12


def test_large_arrays_go_over_the_threads():
    _, found, _ = divisors_of_every_weight("easy")
    few = DivisorArray.stack([D for D in found if D.degree == 2])
    count = 3 * RANGE // len(few)
    many = few[np.tile(np.arange(len(few)), count)]
    total = many + found[1]
    once = few + found[1]
    assert len(total) > 2 * RANGE
    assert (total == once[np.tile(np.arange(len(few)), count)]).all()
