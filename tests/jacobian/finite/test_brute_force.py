"""Points, zeta functions and twists compared with a search through all pairs (x, y), in tables that share nothing with
the package's fields.
"""

from functools import cache
from itertools import product
from random import Random

import numpy as np
import pytest

from jacobian import GF
from tests.jacobian.group_curves import next_curve

# p, k: the genera of curves over GF(p^k)
FIELDS = {
    **dict.fromkeys([(2, 1), (3, 1)], (1, 2, 3, 4)),
    **dict.fromkeys([(5, 1), (7, 1), (2, 2), (2, 3)], (1, 2, 3)),
    **dict.fromkeys([(11, 1), (13, 1), (19, 1), (2, 4), (3, 2)], (1, 2)),
    **dict.fromkeys([(31, 1), (101, 1), (2, 5), (2, 7), (3, 3), (5, 2), (5, 3), (7, 2)], (1,)),
}
MODELS = ("ramified", "split", "inert")


@cache
def tables(p, n):
    """(sums, products) of GF(p^n); its elements are ints, the coefficients in base p of polynomials in a generator."""
    q, weights = p**n, p ** np.arange(n)
    digits = np.arange(q)[:, None] // weights % p
    sums = (digits[:, None] + digits) % p @ weights
    for low in product(range(p), repeat=n):
        powers, power = [1], weights * 0
        power[0] = 1
        # times the generator, xⁿ = −low
        while (last := int(_times_x(power, low, p) @ weights)) not in (0, 1) and len(powers) < q:
            powers.append(last)
            power = _times_x(power, low, p)
        if last == 1 and len(powers) == q - 1:
            break
    logarithms = np.zeros(q, int)
    logarithms[powers] = np.arange(q - 1)
    products = np.array(powers)[(logarithms[:, None] + logarithms) % (q - 1)]
    products[0] = products[:, 0] = 0
    return sums, products


def _times_x(power, low, p):
    return (np.concatenate(([0], power[:-1])) - power[-1] * np.array(low)) % p


def value(field, coefficients, x):
    """Of a polynomial at every element of the array x."""
    sums, products = field
    total = np.zeros_like(x)
    for c in reversed(coefficients):
        total = sums[products[total, x], c]
    return total


@cache
def embedding(K, n):
    """The elements of K as elements of the tables of GF(q^n): the generator of K is a root of its modulus there."""
    p, k = K.characteristic, K.degree
    field, x = tables(p, n * k), np.arange(p ** (n * k))
    root = x[value(field, K.modulus, x) == 0][0] if k > 1 else 0
    return [int(value(field, K.coefficients(a) if k > 1 else (a,), root)) for a in range(K.order)]


def points(C, n):
    """The number of points over GF(q^n): all pairs (x, y), and all values of y/x^(g+1) at infinity."""
    K, g = C.field, C.genus
    into, field = embedding(K, n), tables(K.characteristic, n * K.degree)
    sums, products = field
    f, h = ([into[c] for c in a] for a in (C.f, C.h))
    x = np.arange(len(sums))
    squares = products[x, x]
    affine = sums[squares, products[value(field, h, x)][:, x]] == value(field, f, x)[:, None]
    f, h = f + [0] * (2 * g + 3 - len(f)), h + [0] * (g + 2 - len(h))
    infinite = sums[squares, products[h[g + 1], x]] == f[2 * g + 2]
    return int(affine.sum() + infinite.sum())


@pytest.mark.thinned(2)
@pytest.mark.parametrize("count", [3, pytest.param(15, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("p", "k"), FIELDS)
def test_every_pair(p, k, count):
    K, rng = GF(p, k), Random(f"{p} {k} {count}")
    q = K.order
    for g, model, i in product(FIELDS[p, k], MODELS, range(count)):
        C = next_curve(K, g, rng, model=model, with_h=i % 2)
        assert C.count_points(g) == [points(C, n) for n in range(1, g + 1)]
        # with the functional equation these numbers determine L
        L = C.l_polynomial()
        assert [1, *L[1 : g + 1], *[q**i * L[g - i] for i in range(1, g + 1)]] == L
        assert C.jacobian().order() == sum(L)
        assert points(C, 1) + points(C.quadratic_twist(), 1) == 2 * q + 2
