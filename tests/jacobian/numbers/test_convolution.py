"""Convolutions by transforms on floats, compared with integers at the limits of every bound."""

import numpy as np
import pytest

from jacobian.fields.primality import is_prime
from jacobian.finite.product_kernels import kernels
from jacobian.numbers.convolution import LONGEST, PRIMES, Convolutions, balanced


def test_the_primes_have_roots_of_unity_of_every_length():
    for q, g in PRIMES.items():
        assert is_prime(q)
        assert q < 1 << 49
        assert (q - 1) % LONGEST == 0
        assert pow(g, (q - 1) // 2, q) == q - 1


def cyclic(a, b):
    """The convolution over the integers, by one product of long numbers (Kronecker 1882)."""
    from flint import fmpz_poly

    product = [int(c) for c in (fmpz_poly([int(x) for x in a]) * fmpz_poly([int(x) for x in b])).coeffs()]
    found = [0] * len(b)
    for i, c in enumerate(product):
        found[i % len(b)] += c
    return found


@pytest.mark.thinned(3)
@pytest.mark.parametrize("p", [10007, 2**31 - 1, 10**12 + 39, 2**49 - 81])
@pytest.mark.parametrize("length", [1 << 10, 1 << 11, 1 << 12, 1 << 17])
@pytest.mark.parametrize("extreme", [False, True])
def test_convolutions_are_those_of_integers(p, length, extreme):
    assert is_prime(p)
    rng, half = np.random.default_rng(length), p // 2
    a, b = (rng.integers(-half, half + 1, size) for size in (length // 2, length))
    if extreme:
        # as large as the sums can be
        a, b = np.full(length // 2, half), np.full(length, half)
    work = Convolutions(p, length, kernels())
    assert len(work.used) == (2 if p < 2**40 else 3)
    scale = rng.integers(-half, half + 1, length - 5)
    out = np.empty(length - 5)
    work.product(work.transform(a, length), work.transform(b, length), 5, scale.astype(float), out)
    wanted = [balanced(c * int(s), p) for c, s in zip(cyclic(a, b)[5:], scale, strict=True)]
    assert out.tolist() == wanted


def test_a_shorter_length_takes_the_factors_of_the_longest():
    p = 1_000_003
    rng = np.random.default_rng(1)
    a, b = rng.integers(0, 1000, 512), rng.integers(0, 1000, 1024)
    out = np.empty(1024)
    work = Convolutions(p, 1 << 14, kernels())
    work.product(work.transform(a, 1024), work.transform(b, 1024), 0, np.ones(1024), out)
    assert out.tolist() == [balanced(c, p) for c in cyclic(a, b)]
