"""Polynomials: identities, and the fast GF(p) versions compared with the plain ones."""

from random import Random

import pytest

from jacobian import GF, QQ, RR, FieldError, poly
from tests.jacobian.jacobian_rows import FIELDS


class Plain:
    """A field without its fast polynomial operations."""

    def __init__(self, K):
        self._K = K

    def __getattr__(self, name):
        if name.startswith("poly_"):
            raise AttributeError(name)
        return getattr(self._K, name)


def samples(K, rng, count=60):
    for _ in range(count):
        yield [poly.random(K, rng.randrange(0, 7), rng) for _ in range(3)]


@pytest.mark.parametrize("K", FIELDS.values(), ids=str)
def test_ring_identities(K):
    rng = Random(1)
    for a, b, c in samples(K, rng):
        assert poly.add(K, a, b) == poly.add(K, b, a)
        assert poly.sub(K, poly.add(K, a, b), b) == a
        assert poly.mul(K, a, poly.add(K, b, c)) == poly.add(K, poly.mul(K, a, b), poly.mul(K, a, c))
        assert poly.neg(K, poly.sub(K, a, b)) == poly.sub(K, b, a)
        if b:
            q, r = poly.divide(K, a, b)
            assert poly.add(K, poly.mul(K, q, b), r) == a
            assert len(r) < len(b)
            assert poly.quotient(K, poly.mul(K, a, b), b) == a
        if a or b:
            d, r, s = poly.xgcd(K, a, b)
            assert poly.add(K, poly.mul(K, r, a), poly.mul(K, s, b)) == d == poly.gcd(K, a, b)
            assert d[-1] == K.one
            assert not poly.mod(K, a, d)
            assert not poly.mod(K, b, d)


@pytest.mark.parametrize("K", FIELDS.values(), ids=str)
def test_evaluation_is_a_homomorphism(K):
    rng = Random(2)
    for a, b, _ in samples(K, rng, 20):
        x, c = K.random(rng), K.random(rng)
        assert poly.evaluate(K, poly.mul(K, a, b), x) == K.mul(poly.evaluate(K, a, x), poly.evaluate(K, b, x))
        assert poly.evaluate(K, poly.shift(K, a, c), x) == poly.evaluate(K, a, K.add(x, c))
        product = poly.add(K, poly.mul(K, poly.derivative(K, a), b), poly.mul(K, a, poly.derivative(K, b)))
        assert poly.derivative(K, poly.mul(K, a, b)) == product
        assert poly.evaluate(K, poly.from_roots(K, [x, c]), x) == K.zero


@pytest.mark.parametrize("p", [2, 3, 101, 2**61 - 1, 2**127 - 1])
def test_fast_operations_equal_the_plain_ones(p):
    K, rng = GF(p), Random(p)
    plain = Plain(K)
    for a, b, _ in samples(K, rng, 200):
        for operation in (poly.add, poly.sub, poly.mul):
            assert operation(K, a, b) == operation(plain, a, b)
        if b:
            assert poly.divide(K, a, b) == poly.divide(plain, a, b)


def test_division_by_zero():
    for K in (GF(7), QQ, RR):
        with pytest.raises(ZeroDivisionError, match=r"polynomial"):
            poly.divide(K, (K.one,), ())


def test_inexact_polynomials_are_not_trimmed():
    assert poly.sub(RR, (1.0, 2.0, 3.0), (0.0, 0.0, 3.0)) == (1.0, 2.0, 0.0)
    assert poly.mul(RR, (1.0, 0.0), (1.0, 0.0)) == (1.0, 0.0, 0.0)
    assert poly.divide(RR, (0.0, 0.0, 1.0), (0.0, 1.0)) == ((0.0, 1.0), (0.0,))
    assert poly.coerce(RR, [1, 0]) == (1.0, 0.0)
    assert poly.coerce(QQ, ["1/2", 0]) == (QQ.coerce("1/2"),)


def test_text():
    assert poly.text(GF(7), (1, 0, 3, 1)) == "x^3 + 3·x^2 + 1"
    assert poly.text(QQ, poly.coerce(QQ, ["-1/2", "-1"])) == "-1·x - 1/2"
    assert poly.text(GF(7), ()) == "0"


@pytest.mark.parametrize("values", [5, "12", None])
def test_what_is_not_a_polynomial(values):
    with pytest.raises(FieldError, match=r"^f = "):
        poly.coerce(GF(7), values, "f")


def test_the_coefficient_is_named():
    with pytest.raises(FieldError, match=r"f\[1\] = 0.5"):
        poly.coerce(GF(7), [1, 0.5], "f")
