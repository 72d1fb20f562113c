"""The Weil and Tate pairings: the laws on full m-torsion, over every model, and compared with Frobenius."""

from itertools import combinations, count, product
from random import Random

import pytest

from jacobian import GF, QQ, ArgumentError, CurveMismatch, FieldError, HyperellipticCurve, poly
from jacobian.fields.primality import is_prime
from jacobian.finite import miller, pairing
from jacobian.finite.pairing import tate_pairing, weil_pairing
from tests.jacobian.group_curves import random_curve

# y² = x⁵ + 1 with p ≡ 4 modulo 5: Frobenius over GF(p²) is −p, and J(GF(p²)) = (Z/(p+1))⁴ (all its torsion)
FIVE = [1, 0, 0, 0, 0, 1]


def from_roots(p, xs):
    return poly.from_roots(GF(p), xs)


def split_product(p, xs, last):
    """Π (x − x_i) · last, of even degree."""
    return poly.scale(GF(p), last, from_roots(p, xs))


FULL = [
    pytest.param((GF(19, 2), FIVE, 5), id="m = 5, ramified"),
    pytest.param((GF(19, 2), FIVE, 4), id="m = 4, ramified"),
    pytest.param((GF(29, 2), FIVE, 3), id="m = 3, ramified"),
    pytest.param((GF(29, 2), FIVE, 6), id="m = 6, ramified"),
    pytest.param((GF(7), from_roots(7, range(5)), 2), id="m = 2, ramified, GF(7)"),
    pytest.param((GF(101), from_roots(101, range(5)), 2), id="m = 2, ramified"),
    pytest.param((GF(101), split_product(101, range(6), 1), 2), id="m = 2, split"),
    pytest.param((GF(101), split_product(101, range(6), 2), 2), id="m = 2, inert"),
    pytest.param((GF(101), from_roots(101, range(7)), 2), id="m = 2, genus 3, ramified"),
    pytest.param((GF(101), split_product(101, range(8), 1), 2), id="m = 2, genus 3, split"),
]


@pytest.fixture(params=FULL)
def full(request):
    """(J, m, generators): where all of J[m] is rational."""
    K, f, m = request.param
    J = HyperellipticCurve(K, f).jacobian()
    T = J.torsion(m)
    assert T.invariants == (m,) * (2 * J.curve.genus)
    return J, m, T.generators


@pytest.mark.thinned(3)
def test_weil_is_bilinear_alternating_and_non_degenerate(full):
    J, m, basis = full
    K, rng = J.field, Random(1)
    table = {(i, j): J.weil_pairing(basis[i], basis[j], m) for i, j in product(range(len(basis)), repeat=2)}
    for (i, j), value in table.items():
        assert K.power(value, m) == K.one
        assert K.mul(value, table[j, i]) == K.one
        assert i != j or value == K.one
    # the value for sums and multiples is that from the table
    for _ in range(2):
        a, b = ([rng.randrange(m) for _ in basis] for _ in range(2))
        expected = K.one
        for (i, j), value in table.items():
            expected = K.mul(expected, K.power(value, a[i] * b[j] % m))
        assert J.weil_pairing(J.combination(a, basis), J.combination(b, basis), m) == expected
    # no combination of two generators pairs trivially with all the others
    for coefficients in product(range(m), repeat=2) if m < 5 else ():
        for i, j in combinations(range(len(basis)), 2):
            if any(coefficients):
                a, b = coefficients
                values = [K.mul(K.power(table[i, k], a), K.power(table[j, k], b)) for k in range(len(basis))]
                assert any(value != K.one for value in values)


def test_the_value_does_not_depend_on_the_shifts(full):
    _, m, basis = full
    D, E = basis[0], basis[-1] + basis[0]
    assert len({weil_pairing(D, E, m, Random(seed)) for seed in range(3)}) == 1
    assert len({tate_pairing(D, E, m, Random(seed)) for seed in range(4)}) == 1


def test_tate_is_bilinear_and_of_order_m(full):
    J, m, basis = full
    K, rng = J.field, Random(2)
    D, E = basis[0], basis[1]
    F, G = J.random(rng), J.random(rng)
    t = J.tate_pairing
    assert t(D + E, F, m) == K.mul(t(D, F, m), t(E, F, m))
    assert t(D, F + G, m) == K.mul(t(D, F, m), t(D, G, m))
    assert t(D, m * F, m) == K.one
    assert K.power(t(D, F, m), m) == K.one
    # non-degenerate: some class of J pairs non-trivially with D
    assert any(t(D, J.random(rng), m) != K.one for _ in range(40))


@pytest.mark.parametrize(("p", "m"), [(19, 5), (29, 3), (29, 5), (19, 4)])
def test_tate_is_the_weil_pairing_with_frobenius_minus_one(p, m):
    # t_m(D, F) = e_m(D, (π − 1)F') with m·F' = F (Schaefer 2005), and π − 1 = −(p + 1) here
    J = HyperellipticCurve(GF(p, 2), FIVE).jacobian()
    rng = Random(p + m)
    for _ in range(3):
        D, F = (p + 1) // m * J.random(rng), J.random(rng)
        E = -((p + 1) // m) * F
        assert J.tate_pairing(D, F, m) == J.weil_pairing(D, E, m)


@pytest.mark.thinned(4)
@pytest.mark.parametrize(
    ("q", "genus", "model"),
    [
        ((101,), 2, "ramified"),
        ((101,), 2, "split"),
        ((101,), 2, "inert"),
        ((2, 8), 2, "ramified"),
        ((2, 8), 2, "split"),
        ((3, 5), 2, "split"),
        ((31,), 3, "split"),
        ((7,), 2, "ramified"),
        ((2, 4), 2, "inert"),
        ((2, 3), 2, "split"),
        ((3, 2), 3, "ramified"),
        ((3, 2), 2, "inert"),
    ],
)
def test_tate_over_every_model(q, genus, model):
    K, rng = GF(*q), Random(3)
    found = 0
    for seed in range(40):
        J = random_curve(K, genus, f"tate {seed}", model=model, with_h=seed % 2 == 0).jacobian()
        for m in (2, 3, 5, 7, 11, 13):
            if (K.order - 1) % m == 0 and J.order() % m == 0 and found < 2:
                (D, *_) = J.torsion(m).generators
                E, F = J.random(rng), J.random(rng)
                t = J.tate_pairing
                assert t(D, E + F, m) == K.mul(t(D, E, m), t(D, F, m))
                assert t(2 * D, E, m) == K.power(t(D, E, m), 2)
                assert any(t(D, J.random(rng), m) != K.one for _ in range(40))
                found += 1
    assert found == 2


def test_the_weil_pairing_of_branch_points_counts_those_in_common():
    p = 101
    xs = range(6)
    J = HyperellipticCurve(GF(p), split_product(p, xs, 1)).jacobian()
    for (a, b), (c, d) in list(product(combinations(xs, 2), repeat=2))[::5]:
        D, E = J.from_points([(a, 0), (b, 0)]), J.from_points([(c, 0), (d, 0)])
        # (−1)^(number of points in common) (Mumford 1984)
        assert J.weil_pairing(D, E, 2) == pow(-1, len({a, b} & {c, d}), p)


def test_a_resultant_is_the_product_over_the_roots():
    K, rng = GF(101), Random(4)
    for _ in range(200):
        xs = [K.random(rng) for _ in range(rng.randrange(0, 5))]
        c = poly.random(K, len(xs), rng) or (K.one,)
        expected = K.one
        for x in xs:
            expected = K.mul(expected, poly.evaluate(K, c, x))
        assert poly.resultant(K, poly.from_roots(K, xs), c) == expected


@pytest.mark.parametrize(("q", "model", "m"), [((101,), "split", 5), ((31,), "ramified", 5), ((2, 6), "inert", 7)])
def test_an_extension_for_the_shifts_does_not_change_the_value(q, model, m, monkeypatch):
    rng = Random(5)
    curves = (random_curve(GF(*q), 2, seed, model=model) for seed in range(400))
    J = next(C.jacobian() for C in curves if C.jacobian().order() % m == 0)
    D = J.torsion(m).generators[0]
    classes = [J.random(rng) for _ in range(3)]
    values = []
    for room in (0, 100):
        monkeypatch.setattr(pairing, "ROOM", room)
        degree = pairing._Extension(J.curve, m, m).degree
        assert (degree > 1) == (room > 0)
        values.append([tate_pairing(D, E, m) for E in classes] + [weil_pairing(D, 3 * D, m)])
    assert degree % m != 1
    assert values[0] == values[1]
    assert any(value != 1 for value in values[0])


def with_full_torsion(m, least):
    """y² = x³ + ax over p = A² + 1 with m | A ≥ least: one of its twists has the group (Z/A)² (multiplication by i)."""
    A = next(A for A in count(least - least % m, m) if is_prime(A * A + 1))
    curves = (HyperellipticCurve(GF(A * A + 1), [0, a, 0, 1]) for a in count(1))
    return next((C, A, m) for C in curves if not any(A * C.jacobian().random(Random(i)) for i in range(3)))


def small(p, f, h, m):
    return HyperellipticCurve(GF(p), f, h), m, m


ELLIPTIC = [
    pytest.param(small(7, [4, 4, 1, 3], [], 3), id="GF(7)"),
    pytest.param(small(7, [2, 1, 1, 3], [1, 2], 3), id="GF(7), h"),
    pytest.param(small(13, [0, 2, 1, 3], [], 2), id="two-torsion"),
    pytest.param(small(61, [0, 9, 1, 3], [], 4), id="m = 4"),
    pytest.param(small(61, [0, 39, 1, 3], [1, 2], 4), id="m = 4, h"),
    pytest.param(small(31, [5, 27, 1, 3], [1, 2], 5), id="m = 5, h"),
    pytest.param(with_full_torsion(65537, 2**20), id="one word"),
    pytest.param(with_full_torsion(65537, 2**50), id="two words"),
    pytest.param(with_full_torsion(6, 2**65), id="more than two words"),
]


@pytest.mark.thinned(2)
@pytest.mark.parametrize("compiled", [False, True], ids=["in Python", "compiled"])
@pytest.mark.parametrize("curve", ELLIPTIC)
def test_genus_one_without_shifts_is_what_shifts_over_an_extension_give(curve, compiled, monkeypatch):
    # the loops without shifts are for prime fields; over GF(p³) Tate's power is 1 + p + p² ≡ 3 modulo m times as large
    monkeypatch.setattr(miller, "COLD", 0 if compiled else 10**9)
    monkeypatch.setattr(miller, "is_kept", lambda: False)
    C, A, m = curve
    J, L, rng = C.jacobian(), GF(C.field.p, 3), Random(1)
    D, E = J.torsion(m).generators if m == A else (A // m * J.random(Random(i)) for i in (1, 2))
    values = set()
    for first, second in product((D, D + 2 * E), (D, -D, E, J.random(rng))):
        wide = first.change_ring(L), second.change_ring(L)
        assert pow(J.tate_pairing(first, second, m), 3, C.field.p) == tate_pairing(*wide, m)
        if not m * second:
            values.add(J.weil_pairing(first, second, m))
            assert J.weil_pairing(first, second, m) == weil_pairing(*wide, m)
    assert len(values) > 1


def test_genus_one_refuses_what_m_does_not_annihilate():
    C, A, m = with_full_torsion(65537, 2**50)
    D = A // m * C.jacobian().random(Random(1))
    with pytest.raises(ArgumentError, match=r"D = .*: m·D must be 0, which it is not for m = 2"):
        C.jacobian().tate_pairing(D, D, 2)
    with pytest.raises(ArgumentError, match=r"E = .*: m·E must be 0"):
        C.jacobian().weil_pairing(D, C.jacobian().random(Random(2)), m)


def test_trivial_pairings():
    J = HyperellipticCurve(GF(19, 2), FIVE).jacobian()
    D = J.torsion(5).generators[0]
    assert J.weil_pairing(D, J.zero(), 5) == J.weil_pairing(J.zero(), D, 5) == 1
    assert J.weil_pairing(J.zero(), J.zero(), 1) == 1
    assert J.tate_pairing(D, J.zero(), 5) == 1


def test_errors_of_pairings():
    J = HyperellipticCurve(GF(19, 2), FIVE).jacobian()
    D, E = J.torsion(5).generators[:2]
    with pytest.raises(ArgumentError, match=r"D = .*: m·D must be 0, which it is not for m = 4"):
        J.weil_pairing(D, E, 4)
    with pytest.raises(ArgumentError, match=r"E = .*: m·E must be 0"):
        J.weil_pairing(D, J.torsion(4).generators[0], 5)
    with pytest.raises(ArgumentError, match=r"m = 19: a positive integer prime to the characteristic 19"):
        J.weil_pairing(D, E, 19)
    with pytest.raises(ArgumentError, match=r"m = 0"):
        J.tate_pairing(D, E, 0)
    with pytest.raises(ArgumentError, match=r"m = 7 does not divide q − 1 = 360"):
        J.tate_pairing(D, E, 7)
    with pytest.raises(CurveMismatch, match=r"E = .* does not lie in"):
        J.weil_pairing(D, HyperellipticCurve(GF(29, 2), FIVE).jacobian().zero(), 5)
    other = HyperellipticCurve(GF(19, 2), (2, *FIVE[1:])).jacobian().zero()
    for paired in (weil_pairing, tate_pairing):
        with pytest.raises(CurveMismatch, match="D and E lie on two curves"):
            paired(D, other, 5)
    rational = HyperellipticCurve(QQ, FIVE).jacobian().zero()
    with pytest.raises(FieldError, match="finite fields"):
        weil_pairing(rational, rational, 5)
