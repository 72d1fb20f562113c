"""Fields: axioms on raw elements, square roots, coercion of users' values, randomness, identity and pickling."""

import pickle
import sys
from fractions import Fraction
from random import Random

import galois
import mpmath
import numpy as np
import pytest

from jacobian import CC, GF, MP, QQ, RR, ArgumentError, Field, FieldError, NotASquare, PrecisionLoss
from jacobian.errors import Infeasible
from jacobian.fields.digits import DigitField
from jacobian.fields.irreducible import default_modulus, is_irreducible, prime_ring
from jacobian.fields.primality import is_prime, prime_power
from jacobian.fields.quadratic import quadratic_roots
from jacobian.fields.residue import ResidueField

FINITE = [
    GF(2), GF(7), GF(101), GF(2**61 - 1), GF(2**127 - 1), GF(13), GF(97),
    GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), GF(3, 5, (1, 2, 0, 0, 0, 1)), GF(7, 2, (3, 6, 1)), GF(5, 3, (3, 3, 0, 1)),
    GF(2, 61, (1, 1, 1, 0, 0, 1, *[0] * 55, 1)), GF(2**61 - 1, 2, (1, 0, 1)), GF(101, 3, (99, 3, 0, 1)),
]  # fmt: skip
INEXACT = [RR, CC, MP(30), MP(40, complex=True)]
FIELDS = [*FINITE, QQ, ResidueField(GF(7), (3, 6, 1)), ResidueField(GF(2, 2, (1, 1, 1)), (2, 1, 1))]


def name_of(K):
    return K.name


@pytest.mark.parametrize("K", FIELDS, ids=name_of)
def test_axioms(K):
    rng = Random(1)
    for _ in range(40):
        x, y, z = (K.random(rng) for _ in range(3))
        assert K.add(x, y) == K.add(y, x)
        assert K.add(K.add(x, y), z) == K.add(x, K.add(y, z))
        assert K.mul(x, y) == K.mul(y, x)
        assert K.mul(K.mul(x, y), z) == K.mul(x, K.mul(y, z))
        assert K.mul(x, K.add(y, z)) == K.add(K.mul(x, y), K.mul(x, z))
        assert K.sub(x, y) == K.add(x, K.neg(y))
        assert K.is_zero(K.sub(x, x))
        assert K.add(x, K.zero) == x == K.mul(x, K.one)
        assert K.dot((x, y, z), (y, z, x)) == K.add(K.add(K.mul(x, y), K.mul(y, z)), K.mul(z, x))
        assert K.from_key(K.key(x)) == x
        if not K.is_zero(x):
            assert K.mul(x, K.inv(x)) == K.one
            assert K.mul(K.div(y, x), x) == y
    with pytest.raises(ZeroDivisionError):
        K.inv(K.zero)


@pytest.mark.parametrize("K", FIELDS, ids=name_of)
def test_square_roots(K):
    rng = Random(2)
    squares = 0
    for _ in range(40):
        x = K.random(rng)
        root = K.sqrt(K.mul(x, x))
        assert root in (x, K.neg(x))
        try:
            squares += K.mul(K.sqrt(x), K.sqrt(x)) == x
        except NotASquare:
            assert K is QQ or not K.is_square(x)
    assert squares == 40 if K.characteristic == 2 else K is QQ or 5 < squares < 36


@pytest.mark.parametrize("K", FIELDS, ids=name_of)
def test_quadratic_equations(K):
    rng = Random(3)
    counts = set()
    for _ in range(60):
        b, y = K.random(rng), K.random(rng)
        c = K.mul(y, K.add(y, b))
        found = quadratic_roots(K, b, c)
        assert y in found
        assert all(K.mul(z, K.add(z, b)) == c for z in found)
        counts.add(len(quadratic_roots(K, b, K.random(rng))))
    assert counts >= {0, 2}


@pytest.mark.parametrize("K", [*FINITE, QQ, *INEXACT], ids=name_of)
def test_protocol_equality_and_pickling(K):
    assert isinstance(K, Field)
    again = pickle.loads(pickle.dumps(K))
    assert again == K
    assert hash(again) == hash(K)
    # a repr is the call that makes it
    assert eval(repr(K), {"GF": GF, "QQ": QQ, "RR": RR, "CC": CC, "MP": MP}) == K
    assert sum(other == K for other in [*FINITE, QQ, *INEXACT]) == 1


def test_the_same_arguments_give_the_same_object():
    assert GF(7) is GF(7)
    assert GF(np.int64(7)) is GF(7)
    assert GF(7, 2, (3, 6, 1)) is GF(7, 2, [3, 6, 1])
    assert GF(7, 2) is GF(7, 2, (3, 6, 1))
    assert MP(30) is MP(30)
    assert MP(30) != MP(31)
    assert GF(7, 2, (3, 6, 1)) != GF(7, 2, (1, 0, 1))


def test_large_extension_fields_are_made_at_once():
    K = GF(2**61 - 1, 2, modulus=(1, 0, 1))
    a = K.coerce([0, 1])
    assert K.mul(a, a) == K.coerce([-1])
    assert K.coefficients(K.inv(K.coerce([3, 4]))) == [K.base.div(3, 25), K.base.div(-4, 25)]
    assert GF(1000003, 2).degree == 2


@pytest.mark.parametrize(
    "K",
    [
        # galois compiles its arithmetic for seconds, once for each characteristic
        pytest.param(K, marks=pytest.mark.slow if K.order == 49 else ())
        for K in FINITE
        if getattr(K, "degree", 1) > 1 and K.order < 1 << 17
    ],
    ids=name_of,
)
def test_tables_equal_digits_and_galois(K):
    slow = DigitField(K.base, K.modulus)
    # two fields are enough of galois
    G = K.galois if K.order in (49, 256) else None
    rng = Random(4)
    for _ in range(50):
        x, y = K.random(rng), K.random(rng)
        for operation in ("add", "sub", "mul"):
            assert getattr(K, operation)(x, y) == getattr(slow, operation)(x, y)
        assert K.neg(x) == slow.neg(x)
        if x:
            assert K.inv(x) == slow.inv(x)
        if G:
            assert K.add(x, y) == int(G(x) + G(y))
            assert K.mul(x, y) == int(G(x) * G(y))
            assert x == 0 or K.inv(x) == int(G(1) / G(x))
        assert K.power(x, 13) == slow.power(x, 13)


# --- galois's elements as users' values


def test_galois_classes_and_scalars():
    assert GF(galois.GF(7)) is GF(7)
    G = galois.GF(7**2)
    K = GF(G)
    assert K.galois is G
    assert K is GF(7, 2)
    assert K.coerce(G(9)) == 9
    assert K.coerce(G([1, 2])[1]) == 2
    assert K.coerce(galois.GF(7)(5)) == 5
    assert GF(7).coerce(galois.GF(7)(5)) == 5
    assert list(K.to_galois([3, 48])) == [G(3), G(48)]
    assert list(GF(7).to_galois([3, 4])) == [3, 4]


def test_scalars_of_another_galois_field_are_refused():
    with pytest.raises(FieldError, match=r"value = 3 lies in GF\(5\), not in GF\(7\)"):
        GF(7).coerce(galois.GF(5)(3))
    with pytest.raises(FieldError, match=r"lies in GF\(7\^2\)"):
        GF(7).coerce(galois.GF(7**2)(3))


@pytest.mark.slow
def test_scalars_by_another_modulus_are_refused():
    other = galois.GF(7**2, irreducible_poly="x^2 + 1")
    with pytest.raises(FieldError, match=r"lies in GF\(7\^2\), not in GF\(7\^2"):
        GF(7, 2, (3, 6, 1)).coerce(other(9))


# --- coercion and its errors


def test_coercion():
    assert GF(7).coerce(-3) == 4
    assert GF(7).coerce(np.int64(9)) == 2
    assert GF(7).coerce(Fraction(1, 2)) == 4
    assert QQ.coerce("-3/4") == Fraction(-3, 4)
    assert QQ.coerce(np.int32(5)) == 5
    assert RR.coerce(np.float32(0.5)) == 0.5
    assert RR.coerce(Fraction(1, 4)) == 0.25
    assert CC.coerce(1) == 1 + 0j
    assert MP(50).coerce("0.1") == MP(50).context.mpf("0.1")
    assert MP(50).coerce(Fraction(1, 3)) * 3 == 1
    assert MP(50).coerce(np.float64(0.5)) == 0.5
    assert MP(50).coerce(np.int64(3)) == 3
    assert MP(20).coerce(mpmath.mpf(1) / 3) == mpmath.mpf(1) / 3
    assert MP(20, complex=True).coerce(1j) == 1j
    K = GF(7, 2, (3, 6, 1))
    assert K.coerce(48) == 48
    assert K.coerce([-1, 2]) == 6 + 14


@pytest.mark.parametrize(
    ("K", "value"),
    [
        (GF(7), 0.5), (GF(7), "3x"), (GF(7), None), (GF(7), 1j), (GF(7), Fraction(1, 7)),
        (GF(7, 2, (3, 6, 1)), 49), (GF(7, 2, (3, 6, 1)), -1), (GF(7, 2, (3, 6, 1)), 0.5),
        (GF(7, 2, (3, 6, 1)), [1, 2, 3]),
        (GF(7, 2, (3, 6, 1)), [1, 0.5]), (QQ, 0.5), (QQ, "x"), (QQ, "1/0"), (QQ, None),
        (RR, float("nan")), (RR, float("inf")), (RR, 1j), (RR, "1x"), (RR, None),
        (CC, complex("nan")), (CC, complex(0, float("inf"))), (CC, "1x"), (CC, None),
        (MP(30), float("nan")), (MP(30), float("inf")), (MP(30), 1j), (MP(30), "one"), (MP(30), None), (MP(30), [1]),
        (MP(30, complex=True), complex("nan")), (MP(30, complex=True), None),
    ],
)  # fmt: skip
def test_what_is_not_an_element(K, value):
    with pytest.raises(FieldError, match=r"^gamma(\[1\])? = "):
        K.coerce(value, "gamma")


@pytest.mark.parametrize("p", [-7, 0, 1, 4, 9, 91, 2**61 - 3, (2**61 - 1) ** 2, 561, 3215031751])
def test_composite_p(p):
    with pytest.raises(ArgumentError, match=f"^p = {p} is not prime") as error:
        GF(p)
    power = prime_power(p) if p > 1 else None
    assert ("prime power" if power else "the next one is") in str(error.value)


@pytest.mark.parametrize("p", [7.0, "7", None, [7]])
def test_what_is_not_a_prime(p):
    with pytest.raises(ArgumentError, match=r"^p = "):
        GF(p)


@pytest.mark.parametrize("k", [0, -1, 2.0, True, "2"])
def test_degree_of_a_field(k):
    with pytest.raises(ArgumentError, match=r"^k = "):
        GF(7, k)


def test_the_default_modulus_is_the_conway_polynomial_of_galois(monkeypatch):
    """Also where galois's table is elsewhere, as it may be in another version."""
    found = {(p, k): default_modulus(GF(p), k) for p, k in ((2, 8), (3, 1), (7, 2), (7, 10))}
    monkeypatch.setitem(sys.modules, "galois._databases", None)
    default_modulus.cache_clear()
    for (p, k), modulus in found.items():
        conway = galois.conway_poly(p, k)
        assert modulus == default_modulus(GF(p), k) == tuple(int(c) for c in conway.coeffs[::-1])


@pytest.mark.parametrize(
    ("k", "modulus", "message"),
    [
        (2, (1, 1), "modulus = "),
        (2, (1, 0, 2), "modulus = "),
        (2, (6, 0, 1), "reducible"),
        (1, (0, 1), "modulus"),
        (2, 5, "modulus"),
    ],
)
def test_moduli(k, modulus, message):
    with pytest.raises(ArgumentError, match=message):
        GF(7, k, modulus)


@pytest.mark.parametrize("dps", [0, -5, 1.5, "30", True, None])
def test_digits(dps):
    with pytest.raises(ArgumentError, match=r"^dps = "):
        MP(dps)


# --- inexact fields


@pytest.mark.parametrize("K", INEXACT, ids=name_of)
def test_zero_against_a_scale(K):
    scale = 100
    for factor in (0, 1, 15.9):
        assert K.is_zero(K.coerce(1) * factor * K.eps * scale, scale)
    for factor in (4097, 1e6):
        assert not K.is_zero(K.coerce(-1) * factor * K.eps * scale, scale)
    for factor in (17, 4095):
        with pytest.raises(PrecisionLoss, match=r"x = .*scale = 100"):
            K.is_zero(K.coerce(1) * factor * K.eps * scale, scale)
    assert K.is_zero(K.zero)
    assert not K.is_zero(K.eps)


def test_negative_numbers_have_no_real_root():
    for K in (RR, MP(30), QQ):
        with pytest.raises(NotASquare, match=r"-2"):
            K.sqrt(K.coerce(-2))
    assert CC.sqrt(-4 + 0j) == 2j
    with pytest.raises(NotASquare, match=r"2 is not the square"):
        QQ.sqrt(Fraction(2))


def test_precision_is_local():
    before = mpmath.mp.dps
    K = MP(60)
    third = K.div(K.one, K.coerce(3))
    assert mpmath.mp.dps == before
    assert abs(third * 3 - 1) < K.context.mpf(10) ** -59
    assert K.context is not mpmath.mp
    assert K.eps == K.context.mpf(2) ** (1 - K.context.prec)
    assert K.dps == 60


@pytest.mark.parametrize("K", INEXACT, ids=name_of)
def test_real_quadratics_do_not_cancel(K):
    big, small = K.coerce(1e8), K.coerce(1e-8)
    found = sorted(quadratic_roots(K, -(big + small), -big * small), key=abs)
    assert abs(found[0] - small) <= 8 * K.eps * abs(small)
    assert abs(found[1] - big) <= 8 * K.eps * abs(big)


# --- randomness


@pytest.mark.parametrize("K", [*FINITE, QQ, *INEXACT], ids=name_of)
def test_random_is_seeded_by_either_generator(K):
    for maker in (Random, np.random.default_rng):
        first, second = ([K.random(rng) for _ in range(5)] for rng in (maker(1), maker(1)))
        assert first == second
        assert all(K.coerce(x) == x for x in first)
    with pytest.raises((ArgumentError, AttributeError), match=r"rng|random"):
        K.random(None)


def test_random_is_uniform_over_a_prime_that_fills_no_byte(rng):
    counts = np.bincount([GF(101).random(rng) for _ in range(10100)])
    assert ((counts - 100) ** 2 / 100).sum() < 100 + 5 * 200**0.5


def test_primality():
    sieve = [n for n in range(2, 2000) if all(n % d for d in range(2, int(n**0.5) + 1))]
    assert [n for n in range(2000) if is_prime(n)] == sieve
    assert is_prime(2**127 - 1)
    assert is_prime(2**521 - 1)
    assert not is_prime(2**523 - 1)
    assert not is_prime(318665857834031151167461)
    assert prime_power(3**20) == (3, 20)
    assert prime_power(6) is None


@pytest.mark.parametrize("k", [1001, 10**18, 10**30])
def test_a_degree_without_a_modulus_to_be_found_is_refused_at_once(k):
    with pytest.raises(Infeasible, match=f"k = {k}: no irreducible polynomial is looked for beyond degree 1000"):
        GF(101, k)


def test_large_degrees_are_found_or_refused():
    """GF(3, 500) used to take minutes; the two tests of irreducibility agree."""
    K = GF(3, 500)
    assert K.order == 3**500
    with pytest.raises(Infeasible, match=r"k = 1000: .* takes minutes or hours; give a modulus"):
        GF(2**127 - 1, 1000)
    base, rng = GF(5), Random(1)
    for _ in range(200):
        low = (*(rng.randrange(5) for _ in range(8)), 1)
        assert is_irreducible(base, low) == bool(prime_ring(5)(list(low)).is_irreducible())


def test_sums_of_floats_overflow_only_where_they_are_beyond_floats() -> None:
    large = (1e154, 1e154, -1e154)
    assert RR.dot(large, (1e154,) * 3) == 1e154 * 1e154
    assert RR.dot(large, large) == float("inf")


@pytest.mark.parametrize(
    ("K", "value", "message"),
    [
        (RR, 10**400, "beyond the range of RR"),
        (CC, "1e400", "beyond the range of CC"),
        (MP(30), np.longdouble("inf"), r"beyond the range of MP\(30\)"),
        (RR, "1e200000", "powers of ten"),
        (MP(30), "1e200000", "powers of ten"),
        (MP(30), float("inf"), "is not finite"),
        (CC, complex("nan"), "is not finite"),
    ],
)
def test_numbers_that_are_too_large(K, value, message):
    with pytest.raises(FieldError, match=f"^size = .*{message}"):
        K.coerce(value, "size")
