"""A second Cantor, written straight from the paper on python-flint's polynomials, against this one."""

from random import Random

import pytest

from jacobian import QQ
from tests.jacobian.jacobian_rows import ROWS

flint = pytest.importorskip("flint")

RAMIFIED = [row for row in ROWS if row.model == "ramified" and row.K != QQ]
ADDITIONS = 100_000


def polynomials(K):
    """(to flint, from flint) for polynomials over K."""
    if getattr(K, "degree", 1) == 1:
        ring = flint.fmpz_mod_poly_ctx(K.p)
        return (lambda a: ring(list(a) or [0])), (lambda a: tuple(int(c) for c in a.coeffs()))
    base = flint.fmpz_mod_poly_ctx(K.p)
    field = flint.fq_default_ctx(modulus=base(list(K.modulus)), var="a")
    ring = flint.fq_default_poly_ctx(field)

    def into(a):
        return ring([field(K.coefficients(c)) for c in a] or [0])

    def back(a):
        return tuple(K.coerce([int(c) for c in x.to_list()]) for x in a.coeffs())

    return into, back


def cantor(u1, v1, u2, v2, f, h, genus):
    """Cantor 1987 with h as in Koblitz 1989: compose with two extended gcds, reduce one step after the other."""
    e, e1, e2 = u1.xgcd(u2)
    d, c1, c2 = e.xgcd(v1 + v2 + h)
    u = u1 * u2 // (d * d)
    v = (c1 * e1 * u1 * v2 + c1 * e2 * u2 * v1 + c2 * (v1 * v2 + f)) // d % u
    while u.degree() > genus:
        u = (f - h * v - v * v) // u
        v = (-h - v) % u
    u = u * (1 / u.leading_coefficient())
    return u, v % u


def compare(row, additions, rng):
    into, back = polynomials(row.K)
    f, h = into(row.curve.f), into(row.curve.h)
    A, B = row.pool[0], row.pool[1]
    for _ in range(additions):
        other = rng.choice([B, A, -A, rng.choice(row.pool)])
        expected = cantor(into(A.u), into(A.v), into(other.u), into(other.v), f, h, row.genus)
        total = A + other
        assert (total.u, total.v) == (back(expected[0]), back(expected[1])), (A, other)
        A, B = (total if total else B), A


@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in RAMIFIED])
def test_additions(row):
    compare(row, 60, Random(f"flint {row}"))


@pytest.mark.slow
@pytest.mark.parametrize("row", [pytest.param(row, id=str(row)) for row in RAMIFIED])
def test_many_additions(row):
    compare(row, ADDITIONS // len(RAMIFIED) + 1, Random(f"many {row}"))
