"""Points over GF(p^k), counted without the package: all elements are squared to mark the squares, and F is evaluated
everywhere. p is odd and divides neither a denominator of F nor its discriminant.
"""

from itertools import product

import numpy as np
from flint import nmod_poly


def modulus(p, k):
    """The ascending coefficients, without the leading 1, of a monic irreducible polynomial of degree k."""
    for low in product(range(p), repeat=k):
        factors = nmod_poly([*low[::-1], 1], p).factor()[1]
        if len(factors) == 1 and factors[0][1] == 1:
            return low[::-1]
    raise AssertionError


def times(a, b, low, p):
    """Products in GF(p)[t]/(t^k + …), coefficient by coefficient, of arrays or ints."""
    k = len(low)
    total = [sum(a[i] * b[n - i] for i in range(max(0, n - k + 1), min(n + 1, k))) for n in range(2 * k - 1)]
    for n in range(2 * k - 2, k - 1, -1):
        top = total[n] % p
        for i, c in enumerate(low):
            total[n - k + i] = total[n - k + i] - c * top
    return [c % p for c in total[:k]]


def points(F, p, k):
    """The points of y² = F(x), of degree 2g + 1 or 2g + 2, and those at infinity, over GF(p^k)."""
    F = [c.numerator * pow(c.denominator, -1, p) % p for c in F]
    low, number = modulus(p, k), np.arange(p**k)
    x = [number // p**i % p for i in range(k)]
    roots = np.zeros(p**k, np.int64)
    np.add.at(roots, sum(c * p**i for i, c in enumerate(times(x, x, low, p))), 1)
    value = [0 * number] * k
    for c in reversed(F):
        value = times(value, x, low, p)
        value[0] = (value[0] + c) % p
    # a leading coefficient that p divides is a branch point at infinity; else one y for each of its roots
    at_infinity = 1 if len(F) % 2 == 0 else int(roots[F[-1]])
    return at_infinity + int(roots[sum(c * p**i for i, c in enumerate(value))].sum())


def counts(L, p, most):
    """p^k + 1 − Σ α^k for k = 1 … most, where Π (1 − αT) = L has ascending coefficients: Newton's identities for all of
    L.
    """
    c = [*L, *[0] * most]
    sums = [0]
    for k in range(1, most + 1):
        sums.append(-k * c[k] - sum(c[i] * sums[k - i] for i in range(1, k)))
    return [p**k + 1 - sums[k] for k in range(1, most + 1)]
