"""Inexact sums of points of any size: composition commutes with x → λx, and is as accurate as the last bits of the
summands.
"""

from fractions import Fraction
from itertools import permutations
from random import Random

import pytest

from jacobian import CC, MP, QQ, RR, HyperellipticCurve, PrecisionLoss, poly
from jacobian.relatives.glued import GeneralizedJacobian
from tests.jacobian.inexact import inexact_oracle as oracle

FIELDS = {"RR": RR, "CC": CC, "MP(30)": MP(30)}


def eps(K):
    return oracle.wide(K.eps)


def a_curve(rng, genus, low=-1, high=1):
    """f of degree 2g+1 with negative roots between 10^low and 10^high in size, as floats."""
    f = [rng.uniform(0.5, 4)]
    for _ in range(2 * genus + 1):
        root = -(10 ** rng.uniform(low, high))
        f = [a - root * b for a, b in zip([0.0, *f], [*f, 0.0], strict=True)]
    return f


def some_points(f, rng, count, low=-1, high=1):
    """Points (x, y) with a float x and y to many digits."""
    found, wide = [], [oracle.wide(c) for c in f]
    while len(found) < count:
        x = oracle.wide(10 ** rng.uniform(low, high) * rng.choice((1, 1, -1)))
        square = oracle.value(wide, x)
        if square > 0 and all(x != other for other, _ in found):
            found.append((x, rng.choice((1, -1)) * oracle.WIDE.sqrt(square)))
    return found


def into(J, points):
    K = J.field
    return J.from_points([(K.coerce(x), K.coerce(y)) for x, y in points])


def sums(K, genus, seed, count, low, high):
    """(curve, D, E, the sum or None where it is refused, the oracle's f, points of D, points of E)"""
    rng = Random(f"{seed} {genus}")
    for _ in range(count):
        f = a_curve(rng, genus, low, high)
        parts = [some_points(f, rng, rng.randint(1, genus), low, high) for _ in range(2)]
        J = HyperellipticCurve(K, f).jacobian()
        try:
            total = into(J, parts[0]) + into(J, parts[1])
        except PrecisionLoss:
            total = None
        yield total, [oracle.wide(c) for c in f], parts, rng


# --- earlier errors ------------------------------------------------------------------------------------------------


def test_a_near_point_and_a_far_one():
    J = HyperellipticCurve(RR, [1, 2, 0, 3, 0, 1]).jacobian()
    near, far = (J.curve.lift_x(x) for x in (1.5, 1e8))
    D = J.from_points([near]) + J.from_points([far])
    assert D == J.from_points([near, far]) == J.from_points([far, near])
    assert D.u == (1.5e8, -1.5 - 1e8, 1)


@pytest.mark.thinned(2)
@pytest.mark.parametrize(
    ("K", "genus", "size"),
    [(RR, 2, 1e8), (RR, 3, 1e4), (RR, 4, 1e3), (RR, 4, 1e30), (RR, 6, 1e20), (CC, 3, 1e5), (MP(30), 3, 1e10)],
    ids=str,
)
def test_large_points(K, genus, size):
    """y² = x^(2g+1) + … with points at |x| about ``size``."""
    rng = Random(f"{genus} {size}")
    f = [1.0, 2.0, 0.0, 3.0, *[0.0] * (2 * genus - 3), 1.0]
    wide = [oracle.wide(c) for c in f]
    J = HyperellipticCurve(K, f).jacobian()
    for _ in range(4):
        points = []
        for _ in range(2 * genus):
            x = oracle.wide(size * rng.uniform(0.5, 2))
            points.append((x, rng.choice((1, -1)) * oracle.WIDE.sqrt(oracle.value(wide, x))))
        parts = points[:genus], points[genus:]
        found = into(J, parts[0]) + into(J, parts[1])
        exact, shift = oracle.conditioning(wide, genus, parts, eps(K), rng)
        assert len(found.u) == genus + 1
        assert (
            oracle.share([[getattr(c, "real", c) for c in part] for part in (found.u, found.v)], exact, shift, eps(K))
            < 500
        )


# --- x → λx ---------------------------------------------------------------------------------------------------------


def scaled(K, f, x, y):
    """f in units in which x was multiplied by 2^x and y by 2^y."""
    return [K.shift(c, 2 * y - x * i) for i, c in enumerate(f)]


@pytest.mark.thinned(4)
@pytest.mark.parametrize("K", FIELDS.values(), ids=FIELDS)
@pytest.mark.parametrize("genus", [2, 3, 4, 5, 6])
def test_powers_of_two_change_no_bit(genus, K):
    rng = Random(f"powers of two {genus}")
    for x, y in ((40, 3), (-33, 20)):
        f = [K.coerce(c) for c in a_curve(rng, genus)]
        here = HyperellipticCurve(K, f).jacobian()
        there = HyperellipticCurve(K, scaled(K, f, x, y)).jacobian()
        points = some_points(f if K is RR else [c.real for c in f], rng, 2 * genus - 1)
        D, E = into(here, points[:genus]), into(here, points[genus:])

        def across(D, J=there, x=x, y=y):
            m = len(D.u) - 1
            u = [K.shift(c, x * (m - i)) for i, c in enumerate(D.u)]
            return J.from_mumford(u, [K.shift(c, y - x * i) for i, c in enumerate(D.v)])

        assert across(D) + across(E) == across(D + E)
        assert across(D).double() == across(D.double())
        assert across(D) - across(E) == across(D - E)


@pytest.mark.parametrize("genus", [2, 3, 4])
def test_other_factors_to_rounding(genus):
    rng = Random(f"other factors {genus}")
    for unit in (1e-9, 3e-3, 7.0, 1e12):
        f = a_curve(rng, genus)
        parts = [some_points(f, rng, genus) for _ in range(2)]
        far = [c / unit**i for i, c in enumerate(f)]
        here, there = (HyperellipticCurve(RR, c).jacobian() for c in (f, far))
        found = into(here, parts[0]) + into(here, parts[1])
        exact, shift = oracle.conditioning([oracle.wide(c) for c in f], genus, parts, eps(RR), rng)
        moved = [[(x * oracle.wide(unit), y) for x, y in part] for part in parts]
        total = into(there, moved[0]) + into(there, moved[1])
        back = [c / unit ** (genus - i) for i, c in enumerate(total.u)], [c * unit**i for i, c in enumerate(total.v)]
        # the curve itself is rounded in the other units
        assert oracle.share((found.u, found.v), exact, shift, eps(RR)) < 500
        assert oracle.share(back, exact, shift, eps(RR)) < 1e5


# --- against exact sums ---------------------------------------------------------------------------------------------


@pytest.mark.thinned(2)
@pytest.mark.parametrize("K", FIELDS.values(), ids=FIELDS)
@pytest.mark.parametrize("genus", [2, 3, 4, 5, 6])
def test_exact_sums_of_rational_points(genus, K):
    """y² = p² + c·Π(x − x_i) has 2g+1 rational points; their sums with signs, by Cantor over QQ, from 2⁻³⁰ to 2³⁰."""
    rng = Random(f"rational {genus}")
    decided = 0
    for unit in (Fraction(1, 2**30), Fraction(1), Fraction(2**30)):
        xs = rng.sample([x for x in range(-9, 10) if x], 2 * genus + 1)
        p = [Fraction(rng.randint(-9, 9)) for _ in range(genus)]
        f = poly.add(QQ, poly.mul(QQ, p, p), poly.from_roots(QQ, map(Fraction, xs)))
        ys = [poly.evaluate(QQ, p, Fraction(x)) for x in xs]
        f = tuple(c / unit**i for i, c in enumerate(f))
        C = HyperellipticCurve(QQ, f)
        points = [(x * unit, rng.choice((1, -1)) * y) for x, y in zip(xs, ys, strict=True) if y]
        exact, J = C.jacobian(), HyperellipticCurve(K, f).jacobian()
        for _ in range(3):
            parts = [rng.sample(points, rng.randint(1, genus)) for _ in range(2)]
            D, E = (exact.from_points(part) for part in parts)
            sides = [J.from_mumford(X.u, [*X.v, *[0] * (len(X.u) - 1 - len(X.v))]) for X in (D, E)]
            try:
                total = sides[0] + sides[1]
            except PrecisionLoss:
                continue
            u, v = (D + E).u, [*(D + E).v, *[0] * (len((D + E).u) - 1 - len((D + E).v))]
            assert len(total.u) == len(u)
            decided += 1
            for found, true, power in ((total.u, u, len(u) - 1), (total.v, v, 0)):
                weights = [oracle.wide(unit) ** (i - power) for i in range(len(true))]
                true = [oracle.wide(c) * w for c, w in zip(true, weights, strict=True)]
                size = max(1, *map(abs, true))
                for a, b, w in zip(found, true, weights, strict=True):
                    assert abs(oracle.wide(a.real) * w - b) <= 1e6 * eps(K) * size**2
                    assert abs(oracle.wide(a.imag)) * w <= 1e6 * eps(K) * size**2
    assert decided >= 7


@pytest.mark.parametrize("genus", [2, 3, 4, 5, 6])
def test_points_of_every_size(genus):
    """|x| from 1e-9 to 1e9: accurate to the last bits of the summands, or refused."""
    refused = 0
    for total, f, parts, rng in sums(RR, genus, "every size", 8, -9, 9):
        if total is None:
            refused += 1
            continue
        exact, shift = oracle.conditioning(f, genus, parts, eps(RR), rng)
        assert len(total.u) == len(exact[0])
        assert oracle.share((total.u, total.v), exact, shift, eps(RR)) < 500
    assert refused < 8


# --- clusters -------------------------------------------------------------------------------------------------------


def a_cluster(rng, genus):
    """f, and the points of two divisors, all of them within 1e-8 … 1e-1 of each other."""
    f, found = a_curve(rng, genus), []
    wide, middle = [oracle.wide(c) for c in f], 10 ** rng.uniform(-1, 1)
    first, second = rng.randint(1, genus), rng.randint(1, genus)
    while len(found) < first + second:
        x = oracle.wide(middle * (1 + rng.uniform(-1, 1) * 10 ** rng.uniform(-8, -1)))
        square = oracle.value(wide, x)
        if square > 0 and all(x != other for other, _ in found):
            found.append((x, rng.choice((1, -1)) * oracle.WIDE.sqrt(square)))
    return f, [found[:first], found[first:]]


def share_of_rounding(f, genus, parts, rng):
    """The largest relative change of a coefficient of the sum for one unit in the last place of the summands."""
    (u, v), shift = oracle.conditioning([oracle.wide(c) for c in f], genus, parts, eps(RR), rng)
    if shift is None:
        return 1
    return max(float(s / abs(c)) for s, c in zip([*shift[: len(u) - 1], *shift[len(u) :]], [*u[:-1], *v], strict=True))


@pytest.mark.parametrize("genus", [2, 3, 4, 5])
def test_clusters_lose_a_degree_only_where_rounding_decides_it(genus):
    rng, refused, count = Random(f"one cluster {genus}"), 0, 60
    for _ in range(count):
        f, parts = a_cluster(rng, genus)
        J = HyperellipticCurve(RR, f).jacobian()
        try:
            total = into(J, parts[0]) + into(J, parts[1])
        except PrecisionLoss:
            refused += 1
            continue
        exact = oracle.total([oracle.wide(c) for c in f], genus, [P for part in parts for P in part])
        if len(total.u) != len(exact[0]):
            assert len(total.u) < len(exact[0])
            assert share_of_rounding(f, genus, parts, rng) > 1 / 16
    assert refused <= count // 3


def test_sums_that_the_summands_decide_are_not_refused():
    """Two divisors of points of all sizes that differ in a few last bits: intermediate quantities are noise, but the
    sum is not.
    """
    f = [
        1.9735734294493752, -1.736960634477068, 1.5636799215323527, -0.8108116040666382, -0.44489478676557326,
        0.7944302569668134, -0.25958515457707243, 0.9236749056709566, 1.0996278811842428, 0.5591945599402299,
        -0.9287085660501266, 1.1782623256979443,
    ]  # fmt: skip
    wide, J = [oracle.wide(c) for c in f], HyperellipticCurve(RR, f).jacobian()
    xs = (-0.0005574512572347635, 20026.160418464482, 3.1635001584177336e-06, -0.006736874596037922)
    points = [(oracle.wide(x), oracle.WIDE.sqrt(oracle.value(wide, oracle.wide(x)))) for x in xs]
    near = [
        (x, oracle.WIDE.sqrt(oracle.value(wide, x))) for x in (x * (1 + oracle.WIDE.mpf(2) ** -50) for x, _ in points)
    ]
    near = [(oracle.wide(float(x)), oracle.WIDE.sqrt(oracle.value(wide, oracle.wide(float(x))))) for x, _ in near]
    found = into(J, points) + into(J, near)
    exact, shift = oracle.conditioning(wide, 5, [points, near], eps(RR), Random(1))
    assert oracle.share((found.u, found.v), exact, shift, eps(RR)) < 500


def test_the_way_onto_the_curve_may_be_crooked():
    """Newton's steps towards the curve may grow before they shrink, here below the square of the last bit."""
    f = [
        3.028795767581607e-07, 40.46867485942532, 1133409851.0197961, 224865646476367.2, 1.6317994498519421e+18,
        1.1638457281341593e+21, 1.5271320651646106e+23, 2.0133989447325077e+23, 6.48184771030601e+22,
        3.5699891618326936e+21, 5.835474377445281e+18, 60515176389333.914, 29634555.951663442, 3.7185193249900297,
    ]  # fmt: skip
    first = [
        (2.607294382984643e-08, 1), (5.671685014325861, 1), (0.3656322887581507, -1),
    ]  # fmt: skip
    second = [
        (8.37986344095832e-07, 1), (-9.492279287828342e-07, 1), (8.815788584512843e-09, -1), (898184948.0352241, -1),
        (376362.1044430729, 1), (-1.3543680928825399e-07, 1),
    ]  # fmt: skip
    wide = [oracle.wide(c) for c in f]
    parts = [
        [(oracle.wide(x), sign * oracle.WIDE.sqrt(oracle.value(wide, oracle.wide(x)))) for x, sign in part]
        for part in (first, second)
    ]
    J = HyperellipticCurve(RR, f).jacobian()
    found = into(J, parts[0]) + into(J, parts[1])
    exact, shift = oracle.conditioning(wide, 6, parts, eps(RR), Random(1))
    assert oracle.share((found.u, found.v), exact, shift, eps(RR)) < 500


@pytest.mark.parametrize("genus", [2, 3, 4])
def test_a_summand_taken_away_again(genus):
    """D + E − E is D or is refused, since D + E was rounded; points near infinity may be added to D."""
    rng, refused = Random(f"away again {genus}"), 0
    for _ in range(8):
        f = a_curve(rng, genus)
        J = HyperellipticCurve(RR, f).jacobian()
        D, E = (into(J, some_points(f, rng, count)) for count in (genus - 1, rng.randint(1, genus)))
        try:
            back = D + E - E
        except PrecisionLoss:
            refused += 1
            continue
        assert len(back.u) >= len(D.u)
        if len(back.u) == len(D.u):
            assert max(abs(a - b) for a, b in zip(back.u, D.u, strict=True)) < 1e-3 * max(map(abs, D.u))
    assert refused <= 4


@pytest.mark.parametrize("size", [1e-20, 1e20, 1e-160, 1e160])
def test_curves_of_any_size(size):
    rng = Random(f"{size}")
    f = a_curve(rng, 3)
    parts = [some_points(f, rng, 3) for _ in range(2)]
    exact, shift = oracle.conditioning([oracle.wide(c) for c in f], 3, parts, eps(RR), rng)
    J = HyperellipticCurve(RR, [c * size for c in f]).jacobian()
    root = oracle.WIDE.sqrt(oracle.wide(size))
    D, E = (into(J, [(x, y * root) for x, y in part]) for part in parts)
    total = D + E
    v = [oracle.wide(c) / root for c in total.v]
    assert oracle.share((total.u, v), exact, shift, eps(RR)) < 1e4


def test_multiples_at_far_points():
    """5D by the ladder and by additions, for D of one far and one near point."""
    K = MP(60)
    for field, tolerance in ((RR, 1e-9), (MP(30), 1e-23)):
        J, wide = (HyperellipticCurve(F, [1, 2, 0, 3, 0, 1, 0, 1]).jacobian() for F in (field, K))
        points = [J.curve.lift_x(field.coerce(x)) for x in (1.5, 3e4)]
        D, E = J.from_points(points), wide.from_points([wide.curve.lift_x(K.coerce(x)) for x in (1.5, 3e4)])
        for m in (2, 3, 5):
            found, exact = m * D, m * E
            scale = max(map(abs, (*exact.u, *exact.v)))
            assert all(
                abs(K.coerce(a) - b) < tolerance * scale
                for a, b in zip((*found.u, *found.v), (*exact.u, *exact.v), strict=True)
            )


def test_the_generalized_jacobian_takes_far_points():
    for field in (RR, MP(30)):
        G = GeneralizedJacobian(HyperellipticCurve(field, [1, 2, 0, 3, 1]))
        wide = GeneralizedJacobian(HyperellipticCurve(MP(80), [1, 2, 0, 3, 1]))
        found, exact = (
            H.from_points([H.curve.lift_x(x) for x in (1.5, 1e7)])
            + H.from_points([H.curve.lift_x(x) for x in (3e7, 2.5)])
            for H in (G, wide)
        )
        for a, b in zip((*found.u, *found.v), (*exact.u, *exact.v), strict=True):
            assert abs(wide.field.coerce(a) / b - 1) < 1e5 * field.eps


# --- from points ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("K", FIELDS.values(), ids=FIELDS)
def test_the_order_of_points_does_not_matter(K):
    J = HyperellipticCurve(K, [1, 2, 0, 3, 0, 1, 0, 1]).jacobian()
    for xs in ((1e6, 1.5, 2.25), (1e-9, 1.0, 1e3), (1.0, 1.0000001, 1.0000002), (2.0, 2.0, 5e4), (0.5, 0.5, 0.5)):
        points = [J.curve.lift_x(K.coerce(x)) for x in xs]
        found = {J.from_points(order) for order in permutations(points)}
        assert len(found) == 1
        (D,) = found
        J.from_mumford(D.u, D.v)
        for x, y in points:
            terms = sum(abs(c * x**i) for i, c in enumerate(D.v))
            assert abs(poly.evaluate(K, D.v, x) - y) <= 8 * K.eps * terms


def test_a_repeated_point_and_its_opposite_cancel_to_rounding():
    J = HyperellipticCurve(RR, [1, 2, 0, 3, 0, 1, 0, 1]).jacobian()
    x, y = J.curve.lift_x(1.3)
    assert not J.from_points([(x, y), (x, -y * (1 + 1e-15))])
    assert J.from_points([(x, y), (x, y * (1 + 1e-15))]).degree == 2


def test_points_that_coefficients_cannot_hold_are_refused():
    """v through x = 2, 3e8 and 1e9 has the size 1e22, which in floats does not determine y(2) = 12."""
    J = HyperellipticCurve(RR, [1, 2, 0, 3, 0, 1, 0, 1]).jacobian()
    points = [J.curve.lift_x(x) for x in (2.0, 3e8, 1e9)]
    with pytest.raises(PrecisionLoss, match=r"x=2\.0"):
        J.from_points(points)
