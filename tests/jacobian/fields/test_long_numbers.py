"""Long primes, long exponents and impossibly large counts: a quick answer, or a refusal by name."""

from random import Random

import pytest

from jacobian import GF, QQ, ArgumentError, HyperellipticCurve, Infeasible
from jacobian.fields.primality import is_prime


def test_primes_beyond_the_proven_bases():
    assert [n - 10**25 for n in range(10**25, 10**25 + 400) if is_prime(n)] == [13, 223, 343, 349]
    assert all(is_prime(2**k - 1) for k in (89, 107, 127, 521, 607))
    # a square, a product of two primes, a Carmichael number
    for n in ((2**89 - 1) ** 2, (2**89 - 1) * (2**107 - 1), 6 * (10**9 + 6) + 1):
        assert not is_prime(n)


def test_a_field_of_a_prime_of_4253_bits():
    K = GF(2**4253 - 1)
    assert K.mul(K.coerce("1/3"), 3) == 1
    with pytest.raises(ArgumentError, match="an int of 4253 bits is not prime"):
        GF(2**4253 - 3)


@pytest.mark.parametrize(
    ("p", "k", "modulus"),
    [
        (2**127 - 1, 2, (1, 0, 1)),
        (2**127 - 1, 3, (5, 0, 0, 1)),
        # no x^4 + c is irreducible, as p = 3 modulo 4, and no x^3 + c, as p = 2 modulo 3
        (2**127 - 1, 4, (3, 1, 0, 0, 1)),
        (2**89 - 1, 5, (3, 0, 0, 0, 0, 1)),
        (2**64 + 13, 3, None),
    ],
)
def test_extensions_of_long_primes(p, k, modulus):
    K = GF(p, k)
    assert modulus in (None, K.modulus)
    x = K.random(Random(1))
    assert K.power(x, K.order) == x != K.power(x, p)
    J = HyperellipticCurve(K, [1, 0, 0, 3, 0, 1]).jacobian()
    D = J.random(Random(2))
    assert 3 * D == D + D + D
    assert J.zero() == D - D


def test_counts_that_cannot_be_meant():
    J = HyperellipticCurve(GF(101), [1, 0, 0, 3, 0, 1]).jacobian()
    with pytest.raises(ArgumentError, match="multiplicities: 1000000000 points are added one by one, 100 at most"):
        J.from_points([(0, 1)], multiplicities=[10**9])
    C = HyperellipticCurve(QQ, [1, 0, 0, 3, 0, 1])
    for K in (J.curve, C):
        with pytest.raises(ArgumentError, match=r"bound = 2\.5: .* an int ≥ 1"):
            K.points(2.5)
    with pytest.raises(Infeasible, match="bound = 1000000"):
        C.points(1000000)
