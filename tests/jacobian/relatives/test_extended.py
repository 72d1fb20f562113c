"""Extensions of Jacobians of any genus: the axioms with all data, and comparison with the Jacobian."""

from random import Random

import pytest

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, NotRepresentable, PrecisionLoss, poly
from jacobian.inexact.long_field import LongField
from jacobian.relatives.extended import Extended, ExtendedGroup, Lift, PointLift, SecondKind, ThirdKind, scaled
from jacobian.relatives.signed import SignedGroup

K = GF(2**61 - 1)
DEGREES = pytest.mark.parametrize("degree", range(3, 12))


def power(x, m):
    result = K.one
    for _ in range(abs(m)):
        result = K.mul(result, x)
    return result if m >= 0 else K.inv(result)


def group_of(degree, rng):
    """A group with two branch points in the field, a point and the datum at infinity, and its curve."""
    while True:
        branch_points = [K.random(rng) for _ in range(2)]
        lead = K.random(rng)
        lead = lead if degree % 2 else K.mul(lead, lead)
        rest = poly.scale(K, lead, poly.random(K, degree - 2, rng, monic=True))
        f = poly.mul(K, poly.from_roots(K, branch_points), rest)
        try:
            curve = HyperellipticCurve(K, f)
            P = curve.random_point(rng)
            infinity = SecondKind() if degree % 2 else ThirdKind(K.sqrt(lead))
            return ExtendedGroup(K, f, (*map(Lift, branch_points), PointLift(P.x, P.y), infinity)), curve
        except ValueError:
            continue


def element(group, curve, rng):
    """A random divisor of g points with random data."""
    points = {}
    while len(points) < group.genus:
        P = curve.random_point(rng)
        points[P.x] = P.y
    u, v = poly.from_roots(K, points), ()
    for x, y in points.items():
        others = poly.from_roots(K, [z for z in points if z != x])
        v = poly.add(K, v, poly.scale(K, K.div(y, poly.evaluate(K, others, x)), others))
    sigma = K.random(rng)
    at_point = poly.evaluate(K, u, group.kinds[2].x)
    at_point = at_point if len(u) % 2 else K.neg(at_point)
    lifts = [kind.of(group, u, v, K.random(rng)) for kind in group.kinds[:2]]
    return Extended(u, v, (*lifts, (K.one, sigma, K.div(at_point, sigma)), K.random(rng)))


def same(group, D, E):
    """Whether two are equal: lifts up to (κ/c², cσ, cν), with c a power of ℓ on odd models and any c on even ones."""
    assert (D.u, D.v) == (E.u, E.v)
    for kind, x, y in zip(group.kinds, D.data, E.data, strict=True):
        if isinstance(kind, Lift):
            c = K.div(y[1], x[1])
            assert y == scaled(K, x, c)
            if group.odd:
                assert c in [power(group.f[-1], m) for m in range(-4, 5)]
        elif isinstance(kind, PointLift):
            assert K.mul(x[0], K.mul(x[1], x[2])) == K.mul(y[0], K.mul(y[1], y[2]))
            assert K.mul(x[1], y[2]) == K.mul(y[1], x[2])
        else:
            assert x == y
    return True


@DEGREES
def test_associative_commutative_with_an_inverse(degree) -> None:
    rng = Random(degree)
    for _ in range(5):
        group, curve = group_of(degree, rng)
        A, B, C = (element(group, curve, rng) for _ in range(3))
        assert same(group, group.add(group.add(A, B), C), group.add(A, group.add(B, C)))
        assert same(group, group.add(A, B), group.add(B, A))
        assert same(group, group.add(group.add(A, B), group.negate(B)), A)
        zero = group.add(A, group.negate(A))
        assert same(group, zero, group.zero())


@DEGREES
def test_data_keep_their_invariants(degree) -> None:
    """κσ² = U(e), κσν = V(e); κσσ̄ = Π(x_i − x₀); multiples by doubling equal repeated sums."""
    rng = Random(degree)
    group, curve = group_of(degree, rng)
    A = element(group, curve, rng)
    three = group.add(group.add(A, A), A)
    assert same(group, group.multiple(3, A), three)
    for D in (three, group.add(A, A), group.multiple(-5, A)):
        for kind, (kappa, sigma, nu) in zip(group.kinds[:2], D.data[:2], strict=True):
            assert K.mul(kappa, K.mul(sigma, sigma)) == poly.evaluate(K, D.u, kind.e)
            assert K.mul(kappa, K.mul(sigma, nu)) == poly.evaluate(K, D.v, kind.e)
        kappa, sigma, bar = D.data[2]
        value = poly.evaluate(K, D.u, group.kinds[2].x)
        assert K.mul(kappa, K.mul(sigma, bar)) == (value if len(D.u) % 2 else K.neg(value))


@pytest.mark.parametrize("degree", [3, 5, 7, 9, 11])
def test_the_pairs_add_as_in_the_jacobian(degree) -> None:
    rng = Random(degree)
    group, curve = group_of(degree, rng)
    J = curve.jacobian()
    A, B = (element(group, curve, rng) for _ in range(2))
    total = group.add(A, B)
    assert J.from_mumford(A.u, A.v) + J.from_mumford(B.u, B.v) == J.from_mumford(total.u, total.v)


def test_lifts_are_the_pairs_of_the_signed_group() -> None:
    """In genus 2: the sign-resolved group is a special case; signs agree up to a common sign."""
    rng = Random(1)
    group, curve = group_of(5, rng)
    signed = SignedGroup(curve, [kind.e for kind in group.kinds[:2]])
    A, B = (element(group, curve, rng) for _ in range(2))
    lifted = [signed.twist(D.u, D.v) for D in (A, B)]
    ours = [Extended(D.u, D.v, tuple(kind.of(group, D.u, D.v) for kind in group.kinds[:2])) for D in (A, B)]
    total = signed.add(*lifted)
    found = ExtendedGroup(K, group.f, group.kinds[:2]).add(*ours)
    assert (found.u, found.v) == (total.u, total.v)
    signs = set()
    for (kappa, sigma, nu), pair, other in zip(found.data, total.pairs, total.kappas, strict=True):
        assert kappa == other
        signs.add(1 if (sigma, nu) == pair else -1 if (K.neg(sigma), K.neg(nu)) == pair else 0)
    assert signs in ({1}, {-1})


@pytest.mark.parametrize("degree", [5, 6, 7, 9])
def test_long_numbers_against_rational_ones(degree) -> None:
    """A sum, a double and their data over QQ agree with those in 400 bits."""
    from fractions import Fraction

    kinds = [Lift(Fraction(0)), SecondKind() if degree % 2 else ThirdKind(Fraction(1))]
    # V is chosen, and f so that it fits: f = V² + U₁U₂·top, with a root at 0
    g = (degree - 1) // 2
    u1, u2 = (poly.from_roots(QQ, map(Fraction, xs)) for xs in (range(1, g + 1), range(-g, 0)))
    v = tuple(Fraction(k + 2, k + 1) for k in range(g))
    square = poly.mul(QQ, v, v)
    product = poly.mul(QQ, u1, u2)
    top = [Fraction(5)] * (degree - 2 * g) + [Fraction(1)]
    top[0] = -square[0] / product[0]
    f = poly.add(QQ, square, poly.mul(QQ, product, tuple(top)))
    exact = ExtendedGroup(QQ, f, kinds)
    A, B = (
        Extended(u, poly.mod(QQ, v, u), (kinds[0].of(exact, u, poly.mod(QQ, v, u)), kinds[1].zero(exact)))
        for u in (u1, u2)
    )
    B = exact.negate(B)
    with LongField(400) as L:

        def real(a):
            return tuple(L.coerce(x.numerator) / x.denominator for x in a)

        long_kinds = [Lift(L.zero), kinds[1] if degree % 2 else ThirdKind(L.one)]
        group = ExtendedGroup(L, real(f), long_kinds)
        a, b = (Extended(real(D.u), real(D.v), (real(D.data[0]), real([D.data[1]])[0])) for D in (A, B))
        for ours, theirs in ((group.add(a, b), exact.add(A, B)), (group.add(a, a), exact.add(A, A))):
            flat = [*theirs.u, *theirs.v, *theirs.data[0], theirs.data[1]]
            for x, y in zip([*ours.u, *ours.v, *ours.data[0], ours.data[1]], real(flat), strict=True):
                assert abs(x - y) <= 1e-90 * (1 + abs(y))


def test_a_pair_comes_back_onto_its_curve() -> None:
    """Newton's method squares the remainder of f − V² modulo U, down to rounding."""
    with LongField(300) as L:
        group = ExtendedGroup(L, poly.from_roots(L, map(L.coerce, (-1, 0, 1, 2, 3, 5, 8))))
        xs = [L.coerce(x) for x in (9, 10, 12)]
        u, v = poly.from_roots(L, xs), (L.zero,) * 3
        for x in xs:
            others = poly.from_roots(L, [z for z in xs if z is not x])
            scale = L.sqrt(poly.evaluate(L, group.f, x)) / poly.evaluate(L, others, x)
            v = tuple(a + scale * b for a, b in zip(v, others, strict=True))
        moved = Extended(u, (v[0] + L.coerce(2.0**-20), *v[1:]))
        sizes = []
        for _ in range(5):
            rest = poly.mod(L, poly.sub(L, group.f, poly.mul(L, moved.v, moved.v)), moved.u)
            sizes.append(float(max(abs(c) for c in rest) / max(abs(c) for c in group.f)))
            moved = group.retracted(moved)
        assert sizes[0] > 1e-8
        assert sizes[4] < 1e-75


def test_a_lift_comes_back_onto_its_curve() -> None:
    """A lift moved by 2⁻⁴⁰ comes back to κσ² = U(e), κσν = V(e) and κν² = −W(e), at a zero of U too."""
    with LongField(300) as L:
        roots = tuple(map(L.coerce, (-1, 0, 1, 2, 3, 5, 8)))
        group = ExtendedGroup(L, poly.from_roots(L, roots), tuple(map(Lift, roots)))
        xs = [L.coerce(x) for x in (0, 10, 12)]
        u, v = poly.from_roots(L, xs), (L.zero,) * 3
        for x in xs[1:]:
            others = poly.from_roots(L, [z for z in xs if z is not x])
            scale = L.sqrt(poly.evaluate(L, group.f, x)) / poly.evaluate(L, others, x)
            v = tuple(a + scale * b for a, b in zip(v, others, strict=True))
        w, lifts = group.cofactor(u, v), []
        for e in roots:
            above, slope, below = (poly.evaluate(L, a, e) for a in (u, v, w))
            # κ = 4·sign, so that σ² = |U(e)|/4
            kappa = 4 * (L.one if above > 0 or (above == 0 and below < 0) else -L.one)
            sigma = L.sqrt(above / kappa)
            lifts.append((kappa, sigma, slope / (kappa * sigma) if sigma else -L.sqrt(-below / kappa)))
        near = 1 + L.coerce(2.0**-40)
        found = Extended(u, v, tuple((k, s * near + (near - 1), n * near) for k, s, n in lifts))
        for _ in range(3):
            found = group.with_true_lifts(found)
        for true, back in zip(lifts, found.data, strict=True):
            assert max(abs(x - y) for x, y in zip(true, back, strict=True)) < 1e-80


def test_what_is_refused() -> None:
    with pytest.raises(ArgumentError, match="f = "):
        ExtendedGroup(K, [1, 1])
    with LongField(100) as L:
        group = ExtendedGroup(L, tuple(map(L.coerce, (0, -1, 0, 0, 0, 1))))
        D = Extended((L.zero, L.zero, L.one), (L.zero, L.one))
        with pytest.raises(PrecisionLoss, match="point in common"):
            group.add(D, Extended(D.u, D.v))
    # f − V² has degree 5, not 6: y − V has a zero at infinity
    u, v = poly.from_roots(K, (1, 2, 3, 4)), (1, 0, 0, 1)
    f = poly.add(K, poly.mul(K, v, v), poly.mul(K, u, (5, 1)))
    with pytest.raises(NotRepresentable, match="infinity"):
        ExtendedGroup(K, f).reduce(Extended(u, v))


def test_summands_that_share_a_branch_point_with_a_lift_are_refused_by_name() -> None:
    """4D − D was a raw ZeroDivisionError."""
    K = GF(13)
    f = poly.from_roots(K, [4, 10, 3, 7, 11])
    group = ExtendedGroup(K, f, (Lift(4),))
    D = Extended((5, 7, 1), (9, 10), ((1, 7, K.div(poly.evaluate(K, (9, 10), 4), 7)),))
    with pytest.raises(NotRepresentable, match="branch point x = 4"):
        group.multiple(3, D)
