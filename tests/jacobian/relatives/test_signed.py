"""The sign-resolved group: the axioms with their signs, the invariant of every pair, inexact against exact."""

from itertools import product
from random import Random

import pytest

from jacobian import GF, QQ, RR, ArgumentError, HyperellipticCurve, NotASquare, NotRepresentable, poly
from jacobian.fields import MP
from jacobian.relatives.conic import Representative, parameter
from jacobian.relatives.glued import GeneralizedJacobian
from jacobian.relatives.signed import SignedDivisor, SignedGroup, reflected, sheared
from tests.jacobian.rational_curves import QUARTIC, QUINTIC, known_points, pairs_of

PRIMES = (101, 10007, 2**61 - 1)
CASES = [pytest.param(p, degree, id=f"{p}-degree{degree}") for p in PRIMES for degree in (5, 4)]


def group_over(p, degree, rng):
    """A random curve over GF(p) with three rational branch points, and for degree 5 a square leading coefficient."""
    K = GF(p)
    while True:
        branch_points = [K.random(rng) for _ in range(3)]
        rest = poly.random(K, degree - 3, rng, monic=True)
        lead = K.random(rng)
        f = poly.mul(K, poly.from_roots(K, branch_points), poly.scale(K, K.mul(lead, lead), rest) if lead else ())
        try:
            return SignedGroup(HyperellipticCurve(K, f), branch_points)
        except ValueError:
            continue


def random_pair(group, rng):
    """A Mumford pair (u, v) of two random points."""
    curve = group.curve
    while True:
        P, Q = curve.random_point(rng), curve.random_point(rng)
        if P.x != Q.x:
            u, v = poly.through(group.field, (P, Q))
            return u, poly.trim(group.field, v)


def elements(group, rng, count):
    """Alternately lifts (where the roots exist), doubles of twists, and twists, which have κ ≠ 1."""
    found = []
    while len(found) < count:
        u, v = random_pair(group, rng)
        try:
            if len(found) % 3 == 0:
                found.append(group.lift(u, v, [rng.choice((1, -1)) for _ in group.branch_points]))
            else:
                twist = group.twist(u, v)
                found.append(twist if len(found) % 3 == 2 else group.double(twist))
        except (NotASquare, NotRepresentable):
            continue
    return found


def single_point(group, rng):
    """A lifted divisor of weight one."""
    while True:
        P = group.curve.random_point(rng)
        u, v = (group.field.neg(P.x), group.field.one), poly.trim(group.field, (P.y,))
        try:
            return group.lift(u, v, [rng.choice((1, -1)) for _ in group.branch_points])
        except NotASquare:
            continue


class Tried:
    """Counts the blocks ``with tried:`` that ended without a refusal: over GF(101) a sum may have less than full
    weight.
    """

    def __init__(self, p):
        self.p, self.count = p, 0

    def __enter__(self):
        pass

    def __exit__(self, kind, error, trace):
        self.count += kind is None
        return self.p == 101 and kind is NotRepresentable


def assert_pairs(group, D):
    """κσ² = U(e), κσν = V(e), κν² = −W(e)."""
    K = group.field
    w = poly.quotient(K, poly.sub(K, group.curve.f, poly.mul(K, D.v, D.v)), D.u)
    for e, (sigma, nu), kappa in zip(group.branch_points, D.pairs, D.kappas, strict=True):
        products = [K.mul(kappa, K.mul(x, y)) for x, y in ((sigma, sigma), (sigma, nu), (nu, nu))]
        assert products == [poly.evaluate(K, D.u, e), poly.evaluate(K, D.v, e), K.neg(poly.evaluate(K, w, e))]


def plain_sum(group, D, E):
    """(u, v) of D + E in the group without signs."""
    J = GeneralizedJacobian(group.curve) if len(group.curve.f) == 5 else group.curve.jacobian()
    total = J.from_mumford(D.u, D.v) + J.from_mumford(E.u, E.v)
    return total.u, total.v


@pytest.mark.parametrize(("p", "degree"), CASES)
def test_a_commutative_group_law(p, degree):
    rng = Random(f"lift {p} {degree}")
    group = group_over(p, degree, rng)
    tried = Tried(p)
    for A, B, C in zip(*[iter(elements(group, rng, 60))] * 3, strict=True):
        with tried:
            total = group.add(A, B)
            assert group.add(B, A) == total
            assert_pairs(group, total)
            assert (total.u, total.v) == plain_sum(group, A, B)
            assert total.kappas == tuple(group.field.mul(a, b) for a, b in zip(A.kappas, B.kappas, strict=True))
            assert group.add(total, C) == group.add(A, group.add(B, C)) == group.add(group.add(C, A), B)
    assert tried.count >= 14


@pytest.mark.parametrize("p", PRIMES)
def test_points_of_an_elliptic_curve(p):
    """deg f = 3, weight one, κ = −1: the axioms, doubling and multiples, signs included."""
    rng = Random(f"elliptic {p}")
    tried = Tried(p)
    while tried.count < 14:
        group = group_over(p, 3, rng)
        A, B, C = (single_point(group, rng) for _ in range(3))
        with tried:
            total, double = group.add(A, B), group.double(A)
            assert_pairs(group, total)
            assert_pairs(group, double)
            assert (total.u, total.v) == plain_sum(group, A, B)
            assert total.kappas == double.kappas == A.kappas
            assert group.add(B, A) == total
            assert group.add(total, C) == group.add(A, group.add(B, C))
            assert group.add(total, group.negate(B)) == A
            assert group.add(double, B) == group.add(A, total)
            assert group.multiple(5, A) == group.add(group.double(double), A)
    with pytest.raises(NotRepresentable, match="below one"):
        group.add(A, A._replace(v=poly.neg(group.field, A.v)))


@pytest.mark.parametrize(("p", "degree"), CASES)
def test_inverses_undo_additions(p, degree):
    rng = Random(f"inverse {p} {degree}")
    group = group_over(p, degree, rng)
    tried = Tried(p)
    for A, B in zip(*[iter(elements(group, rng, 40))] * 2, strict=True):
        assert_pairs(group, group.negate(B))
        if set(B.kappas) != {group.field.one}:
            continue
        with tried:
            assert group.add(group.add(A, B), group.negate(B)) == A
    assert tried.count >= 8


@pytest.mark.parametrize("p", PRIMES)
def test_single_points(p):
    """One point and infinity: a commutative action, undone by the inverse, signs included."""
    rng = Random(f"single {p}")
    group = group_over(p, 5, rng)
    tried = Tried(p)
    for A, B in zip(*[iter(elements(group, rng, 40))] * 2, strict=True):
        P, Q = single_point(group, rng), single_point(group, rng)
        assert_pairs(group, P)
        assert_pairs(group, group.negate(P))
        with tried:
            total = group.add(A, P)
            assert_pairs(group, total)
            assert (total.u, total.v) == plain_sum(group, A, P)
            assert total.kappas == A.kappas
            assert group.add(P, A) == total
            assert group.add(total, group.negate(P)) == A
            assert group.add(total, Q) == group.add(group.add(A, Q), P)
            assert group.add(total, B) == group.add(group.add(A, B), P)
    assert tried.count >= 14


@pytest.mark.parametrize("p", PRIMES)
def test_two_single_points_add_up_as_if_one_by_one(p):
    """A general Q, Q = P, and a branch point Q, where σ = 0; a point and its opposite are refused."""
    rng = Random(f"two single {p}")
    group = group_over(p, 5, rng)
    K, checked = group.field, 0
    for A in elements(group, rng, 20):
        P = single_point(group, rng)
        for Q in (single_point(group, rng), P, *_branch_points_of(group)):
            try:
                total = group.add(P, Q)
                one_by_one = group.add(group.add(A, P), Q)
                both = group.add(A, total)
            except NotRepresentable:
                assert p == 101
                continue
            assert_pairs(group, total)
            assert group.add(Q, P) == total
            assert both == one_by_one
            checked += 1
        with pytest.raises(NotRepresentable, match="opposite points"):
            group.add(P, P._replace(v=poly.neg(K, P.v)))
    assert checked >= 35


@pytest.mark.parametrize("p", PRIMES)
def test_a_point_is_added_by_a_reflection(p):
    """c = (Y' − V(x'))/U(x') and ρ = −√f₅σ': this is the sum of the general law, signs included, also if D' is a branch
    point.
    """
    rng = Random(f"reflection {p}")
    group = group_over(p, 5, rng)
    K, checked = group.field, 0
    for A in elements(group, rng, 30):
        for P in (single_point(group, rng), *_branch_points_of(group)):
            x = K.neg(P.u[0])
            try:
                c = parameter(K, (A.u, A.v), x, poly.evaluate(K, P.v, x))
                total = group.add(A, P)
            except NotRepresentable:
                continue
            # at the added branch point both σ and ν of the parabola vanish
            kept = [i for i, e in enumerate(group.branch_points) if e != x]
            lead = K.neg(K.sqrt(group.curve.f[5]))
            turned = reflected(K, [sheared(K, A.pairs, c)[i] for i in kept], [K.mul(lead, P.pairs[i][0]) for i in kept])
            # V'' = −P + cU''
            assert sheared(K, turned, c) == tuple(total.pairs[i] for i in kept)
            checked += 1
    assert checked >= 25


@pytest.mark.parametrize("p", PRIMES)
def test_a_step_of_the_conic_group_is_a_reflection(p):
    """ρ² = c² − f₄: the pairs belong to the member of the pencil, c² = f₄ being a point at infinity."""
    rng = Random(f"pencil {p}")
    group = group_over(p, 4, rng)
    K, checked = group.field, 0
    for A in elements(group, rng, 30):
        x0, y0 = rng.choice((None, K.random(rng))), K.random(rng)
        try:
            c = parameter(K, (A.u, A.v), x0, y0)
            image = Representative(group.curve, A.u, A.v).step(x0, y0)
            rho = K.sqrt(K.sub(K.mul(c, c), group.curve.f[4]))
        except (NotRepresentable, NotASquare, ArgumentError):
            continue
        pairs = reflected(K, sheared(K, A.pairs, c), [rho] * 3)
        # −P = Ṽ − cŨ
        assert_pairs(group, SignedDivisor(image.u, image.v, sheared(K, pairs, c), A.kappas))
        checked += 1
    assert checked >= 8


def _branch_points_of(group):
    """Lifted divisors (e, 0) of the branch points where the roots exist."""
    for e in group.branch_points:
        try:
            yield group.lift((group.field.neg(e), group.field.one), ())
        except NotASquare:
            continue


@pytest.mark.parametrize(("p", "degree"), CASES)
def test_multiples(p, degree):
    rng = Random(f"multiples {p} {degree}")
    group = group_over(p, degree, rng)
    tried = Tried(p)
    while not tried.count:
        D = elements(group, rng, 1)[0]
        with tried:
            multiples = [None, D]
            for _ in range(11):
                multiples.append(group.add(multiples[-1], D))
            for m in range(1, 12):
                assert group.multiple(m, D) == multiples[m]
                assert group.multiple(-m, D) == group.negate(multiples[m])
                if m < 6:
                    assert group.double(multiples[m]) == multiples[2 * m]
    u, v = random_pair(group, rng)
    twist = group.twist(u, v)
    assert group.double(twist).kappas == (group.field.one,) * 3
    assert_pairs(group, group.double(twist))
    with pytest.raises(NotRepresentable, match="m = 0"):
        group.multiple(0, D)


@pytest.mark.parametrize(("p", "degree"), CASES)
def test_branch_points_inside_a_summand(p, degree):
    """σ = 0 there, but the sum still has the right sign, which associativity checks."""
    rng = Random(f"branch {p} {degree}")
    group = group_over(p, degree, rng)
    K, checked = group.field, 0
    e = group.branch_points[0]
    for _ in range(400):
        P = group.curve.random_point(rng)
        if P.x in group.branch_points:
            continue
        slope = K.div(P.y, K.sub(P.x, e))
        try:
            D = group.lift(poly.from_roots(K, (P.x, e)), poly.trim(K, (K.neg(K.mul(slope, e)), slope)))
            assert D.pairs[0][0] == K.zero
            assert_pairs(group, D)
            A, B = elements(group, rng, 2)
            assert group.add(group.add(A, D), B) == group.add(A, group.add(D, B)) == group.add(group.add(A, B), D)
            assert group.add(group.add(A, D), group.negate(D)) == A
            checked += 1
        except NotASquare:
            continue
        except NotRepresentable:
            assert p == 101
            continue
        if checked == 5:
            break
    assert checked == 5


def test_named_errors():
    rng = Random("errors")
    group = group_over(10007, 5, rng)
    K = group.field
    D = elements(group, rng, 1)[0]
    with pytest.raises(NotRepresentable, match="weight below two"):
        group.add(D, group.negate(D))
    e = group.branch_points[0]
    P, Q = group.curve.random_point(rng), group.curve.random_point(rng)

    def beside(P):
        slope = K.div(P.y, K.sub(P.x, e))
        u = poly.from_roots(K, (P.x, e))
        return u, poly.trim(K, (K.neg(K.mul(slope, e)), slope))

    with pytest.raises(NotRepresentable, match="vanishes at a branch point"):
        group.twist(*beside(P))
    # two divisors through one branch point, which the sum does not contain, in either order
    first, second = (SignedDivisor(*beside(X), ((K.one, K.one),) * 3, (K.one,) * 3) for X in (P, Q))
    with pytest.raises(NotRepresentable):
        group.add(first, second)
    refused = 0
    for _ in range(40):
        u, v = random_pair(group, rng)
        try:
            group.lift(u, v)
        except NotASquare:
            refused += 1
    assert 20 < refused < 40
    with pytest.raises(ArgumentError, match="h = 0"):
        SignedGroup(HyperellipticCurve(K, [1, 0, 0, 0, 2, 3], [1]), [0])
    with pytest.raises(ArgumentError, match="deg f"):
        SignedGroup(HyperellipticCurve(K, [1, 0, 0, 0, 0, 0, 3]), [0])
    with pytest.raises(ArgumentError, match="not a root"):
        SignedGroup(group.curve, [next(x for x in range(K.order) if poly.evaluate(K, group.curve.f, x))])


# --- inexact against exact ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("K", [RR, MP(30)], ids=["RR", "MP(30)"])
@pytest.mark.parametrize(
    ("curve", "branch_points"), [(QUINTIC, (0, 1, -2)), (QUARTIC, (0, 1))], ids=["quintic", "quartic"]
)
def test_inexact_sums_equal_exact_ones(curve, branch_points, K):
    exact = SignedGroup(curve, branch_points)
    # the leading coefficients are no squares in QQ, but b is p's own for summands of weight two
    group = SignedGroup(HyperellipticCurve(K, curve.f), branch_points)
    twists = []
    for u, v in pairs_of(curve, known_points(curve)):
        try:
            twists.append(exact.twist(u, poly.trim(QQ, v)))
        except NotRepresentable:
            continue

    def rounded(D):
        v = [*D.v, *[0] * (2 - len(D.v))]
        return SignedDivisor(
            *(tuple(map(K.coerce, x)) for x in (D.u, v)),
            *((tuple(tuple(map(K.coerce, pair)) for pair in D.pairs), tuple(map(K.coerce, D.kappas)))),
        )

    compared = 0
    for D, E in product(twists[::2], repeat=2):
        try:
            total = exact.add(D, E)
        except NotRepresentable:
            continue
        found, total = group.add(rounded(D), rounded(E)), rounded(total)
        numbers, expected = ([c for x in (S.u, S.v, *S.pairs, S.kappas) for c in x] for S in (found, total))
        size = max(1, *map(abs, expected)) ** 2
        # (b, σ'', ν'') and (−b, −σ'', −ν'') belong to q·y − p and its negative
        assert max(abs(x - y) for x, y in zip(numbers, expected, strict=True)) < 1e6 * K.eps * size
        compared += 1
    assert compared > 50
