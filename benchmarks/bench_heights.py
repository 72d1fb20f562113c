"""Divisors over QQ whose heights grow: P, 2P, 4P, … on y² = x⁵ + x³ − 3x² + 2x + 1, genus 2, microseconds.

"bits" is the size of the largest denominator in u; the sum is that with 3·(0, 1). "add" is the group's (on flint, with
conversions), "explicit" and "Cantor" are in Python, "flint" is Cantor without conversions.
"""

from __future__ import annotations

from benchmarks.curves import microseconds
from jacobian import QQ, HyperellipticCurve
from jacobian.addition import cantor
from jacobian.addition.choice import python_kernel
from tests.jacobian.addition.flint_cantor import FlintCantor


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each doubling."""
    C = HyperellipticCurve(QQ, [1, 2, -3, 1, 0, 1])
    flint = FlintCantor(C)
    explicit = python_kernel(C).sum_of
    P = 3 * C.jacobian().from_points([(0, 1)])
    start, x = (P.u, P.v, P.n), flint.convert((P.u, P.v, P.n))
    rows: list[dict[str, object]] = []
    D = P.double()
    for doublings in range(1, 3 if smoke else 8):
        a = (D.u, D.v, D.n)
        y = flint.convert(a)
        if flint.convert_back(flint.add(x, y)) != ((P + D).u, (P + D).v, None):
            raise AssertionError("the two additions differ")
        rows.append(
            {
                "doublings": doublings,
                "bits": max(c.denominator.bit_length() for c in D.u),
                "add": microseconds(lambda D=D: P + D, 3),
                "explicit": microseconds(lambda a=a: explicit(start, a), 3),
                "Cantor": microseconds(lambda a=a: cantor.sum_of(C, start, a), 3),
                "flint": microseconds(lambda y=y: flint.add(x, y), 3),
            }
        )
        D = D.double()
    return rows
