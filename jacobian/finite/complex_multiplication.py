"""Frobenius of y² = bx^ℓ + a, ℓ = 2g + 1 = 5 or 7, over GF(p) for p of any size. For ℓ = 7 the primes p ≡ 2 or 4
modulo 7, which have order 3, are excluded.

The automorphism x → ζx, ζ an ℓ-th root of unity, makes Z[ζ] act on the Jacobian. For p ≡ 1 modulo ℓ Frobenius is an
element π of Z[ζ] with ππ̄ = p (Weil 1952). The ideal of π is that of α₁·…·α_g, where α generates a prime ideal over p
and α_t is its conjugate by ζ → ζ^(1/t) (Stickelberger; Shimura and Taniyama 1961). Z[ζ] is principal, and its units of
absolute value 1 are ±ζ^i. So π is one of 2ℓ known elements; lattice reduction finds α (Buhler and Koblitz 1998). Random
classes decide which one it is: the value of the right characteristic polynomial at 1 annihilates every class. So a
candidate that remains alone is proven.

An element of Z[ζ] is a polynomial in ζ of degree below ℓ − 1, python-flint's ``fmpz_poly``.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import comb
from random import Random
from typing import Any

from jacobian.curve.curve import HyperellipticCurve
from jacobian.errors import shown
from jacobian.fields.prime import PrimeField
from jacobian.finite.elimination import alone

DEGREES = (5, 7)


def frobenius_polynomial(C: HyperellipticCurve) -> list[int] | None:
    """The characteristic polynomial of Frobenius, ascending. None for curves or p that this module does not treat, or
    where several candidates remain.
    """
    K: Any = C.field
    degree = 2 * C.genus + 1
    if type(K) is not PrimeField or degree not in DEGREES or C.h or len(C.f) != degree + 1 or any(C.f[1:-1]):
        return None
    p, g = K.p, C.genus
    if p % degree == degree - 1:
        # a is an ℓ-th power and a square in GF(p²), so the curve is a quotient of the Hermitian curve, hence maximal
        return [comb(g, k // 2) * p ** (g - k // 2) * (1 - k % 2) for k in range(2 * g + 1)]
    if all(pow(p, i, degree) != 1 for i in range(1, degree - 1)):
        # x → x^ℓ is bijective on GF(p^i) for all i < 2g, so the curve has p^i + 1 points over this field
        return [p**g, *[0] * (2 * g - 1), 1]
    if p % degree != 1:
        return None
    return alone(list(_candidates(p, degree)), [(C.jacobian(), sum)], Random(0))


def _candidates(p: int, degree: int) -> Iterator[list[int]]:
    """The characteristic polynomials of the 2ℓ elements of Z[ζ], ℓ = ``degree``, one of which is Frobenius."""
    from flint import fmpz_poly

    cyclotomic, x = fmpz_poly([1] * degree), fmpz_poly([0, 1])
    alpha = _generator(p, degree)
    pi = fmpz_poly([1])
    for t in range(1, (degree + 1) // 2):
        # the factor α_t of π is α with ζ^(1/t) in place of ζ
        pi = pi * alpha(x ** pow(t, -1, degree)) % cyclotomic
    for _ in range(degree):
        pi = pi * x % cyclotomic
        chi = [int(c) for c in _multiplication(pi, degree).charpoly()]
        yield chi
        yield [c * (-1) ** k for k, c in enumerate(chi)]


def _generator(p: int, degree: int) -> Any:
    """An element of Z[ζ] of norm p, for p ≡ 1 modulo ℓ, from short vectors in the lattice of a prime ideal over p."""
    from flint import fmpz_mat, fmpz_poly

    root = next(r for r in (pow(a, (p - 1) // degree, p) for a in range(2, p)) if r != 1)
    size = degree - 1
    rows = [[p, *[0] * (size - 1)]]
    rows += [[-pow(root, i, p), *[int(j == i) for j in range(1, size)]] for i in range(1, size)]
    basis = fmpz_mat(rows).lll()
    for multiples in sorted(product((0, 1, -1, 2, -2), repeat=size), key=lambda m: sum(map(abs, m))):
        found = fmpz_poly((fmpz_mat([multiples]) * basis).entries())
        if _multiplication(found, degree).det() == p:
            return found
    raise AssertionError(f"no generator of an ideal over {shown(p)} near its reduced basis")


def _multiplication(a: Any, degree: int) -> Any:
    """The matrix of the multiplication by a on Z[ζ]: its determinant is the norm of a, its characteristic polynomial
    that of a.
    """
    from flint import fmpz_mat, fmpz_poly

    cyclotomic, size = fmpz_poly([1] * degree), degree - 1
    rows = [a * fmpz_poly([*[0] * i, 1]) % cyclotomic for i in range(size)]
    return fmpz_mat([[row[j] for j in range(size)] for row in rows])
