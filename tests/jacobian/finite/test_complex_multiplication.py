"""y² = x⁵ + a and y² = x⁷ + a: compared with point counts, and at sizes where counting is impossible."""

from itertools import product
from random import Random

import pytest

from jacobian import GF, QQ, FieldError, HyperellipticCurve, Infeasible
from jacobian.fields.primality import is_prime
from jacobian.finite import complex_multiplication, counting
from jacobian.finite.weil import order_bounds


def cyclotomic(K, degree, a, lead=1):
    return HyperellipticCurve(K, [a, *[0] * (degree - 1), lead])


def next_prime(start, residue, modulus):
    """The least prime p > start with p ≡ residue modulo ``modulus``."""
    p = start - start % modulus + residue
    while p <= start or not is_prime(p):
        p += modulus
    return p


@pytest.mark.parametrize(("degree", "primes"), [(5, (31, 41, 71, 101, 13, 17, 19, 29, 59)), (7, (29, 43, 13, 19, 17))])
def test_small_primes_against_counted_points(degree, primes):
    for p in primes:
        assert is_prime(p)
        for a, lead in ((1, 1), (2, 1), (3, 1), (2, 5)):
            C = cyclotomic(GF(p), degree, a, lead)
            assert complex_multiplication.frobenius_polynomial(C) == counting.frobenius_polynomial(C)


def test_all_twists_come_out():
    """The ten curves y² = x⁵ + a over GF(p) have ten different Frobenius polynomials, each of them among the
    candidates.
    """
    p = next_prime(10**4, 1, 10)
    found = {tuple(cyclotomic(GF(p), 5, a).jacobian().frobenius_polynomial()) for a in range(1, 60)}
    assert found == set(map(tuple, complex_multiplication._candidates(p, 5)))
    assert len(found) == 10


@pytest.mark.thinned(3)
@pytest.mark.parametrize(("bits", "degree"), [(64, 5), (128, 5), (256, 5), (64, 7), (128, 7)])
def test_orders_at_cryptographic_sizes(bits, degree):
    p = next_prime(2**bits, 1, 2 * degree)
    C = cyclotomic(GF(p), degree, 3)
    J, twist, g = C.jacobian(), C.quadratic_twist().jacobian(), C.genus
    low, high = J.order_bounds()
    assert low <= J.order() <= high
    chi = J.frobenius_polynomial()
    # the order of the twist is χ(−1), and with it the number of points over GF(p²)
    assert twist.order() == sum(c * (-1) ** i for i, c in enumerate(chi))
    assert chi[:g] == [p ** (g - i) * c for i, c in enumerate(chi[:g:-1])]
    rng = Random(bits)
    assert not any(J.order() * J.random(rng) for _ in range(3))
    assert not any(twist.order() * twist.random(rng) for _ in range(3))


@pytest.mark.parametrize("residue", [2, 3, 4])
def test_supersingular_primes_of_any_size(residue):
    p = next_prime(2**127, residue, 5)
    J = cyclotomic(GF(p), 5, 7).jacobian()
    assert J.order() == ((p + 1) ** 2 if residue == 4 else p**2 + 1)
    assert J.is_supersingular()
    assert not J.order() * J.random(Random(1))


def test_other_curves_are_not_taken():
    p = next_prime(2**127, 1, 10)
    for f in ([1, 1, 0, 0, 0, 1], [1, 0, 0, 0, 0, 0, 1], [1] + [0] * 10 + [1]):
        with pytest.raises(Infeasible):
            HyperellipticCurve(GF(p), f).jacobian().order()
    # 2 is of order 3 modulo 7: neither split nor supersingular
    assert complex_multiplication.frobenius_polynomial(cyclotomic(GF(next_prime(100, 2, 7)), 7, 1)) is None


def test_bounds_of_orders():
    for q in (2, 3, 4, 5, 49, 121):
        for g in (1, 2, 3):
            low, high = order_bounds(q, g)
            root = q**0.5
            assert low - 1 < (root - 1) ** (2 * g) * (1 + 1e-12) + 1e-9
            assert abs(low - (root - 1) ** (2 * g)) < 1 + 1e-6
            assert abs(high - (root + 1) ** (2 * g)) < 1 + 1e-6
    # √49 is an int
    assert order_bounds(49, 2) == (6**4, 8**4)
    orders = {
        HyperellipticCurve(GF(7), [b, a, 0, 1]).jacobian().order()
        for a, b in product(range(7), range(1, 7))
        if (4 * a**3 + 27 * b**2) % 7
    }
    assert (min(orders), max(orders)) == order_bounds(7, 1)
    with pytest.raises(FieldError, match="finite fields"):
        HyperellipticCurve(QQ, [1, 0, 0, 0, 0, 1]).jacobian().order_bounds()
