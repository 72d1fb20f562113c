"""How the time of an addition grows with the genus, with log p and, over QQ, with the heights: microseconds.

"add" is the group's (on flint where it pays, with conversions), "Python" the kernel that it has without flint, "Cantor"
the plain algorithm, "flint" the same on flint's objects, without conversions; the two are compared first. A row
"exponent" holds the least-squares slope of log time against log g for g ≥ 5 (from where NUCOMP runs), and against log
log p for p of 256 bits and more (below, the interpreter's own time hides the growth). Heights are those of 2ᵏP on
y² = x⁵ + x³ − 3x² + 2x + 1, to which P is added: bits of the largest denominator in u.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import log
from random import Random
from typing import Any

import numpy as np

from benchmarks.curves import genuine_curve, microseconds, sum_of_points
from jacobian import GF, QQ, Divisor, HyperellipticCurve
from jacobian.addition import cantor
from jacobian.addition.choice import python_kernel
from tests.jacobian.addition.flint_cantor import FlintCantor

MERSENNE = (31, 61, 127, 521, 1279, 2203, 4253)
"""Exponents of Mersenne primes."""

Sums = Iterator[tuple[int, Divisor, Divisor]]


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each size, then the exponents."""
    rows: list[dict[str, object]] = []
    for label, start, sums in (
        ("g", 5, of_genus((2, 5) if smoke else (2, 3, 4, 5, 7, 10, 14, 20, 28, 39, 50))),
        ("bits of p", 256, of_bits((61, 521) if smoke else MERSENNE)),
        ("bits of u", None, of_height(2 if smoke else 7)),
    ):
        part = [{"varied": label, "value": size, **times(D, E, smoke)} for size, D, E in sums]
        rows += part
        if start and not smoke:
            large = [row for row in part if row["value"] >= start]
            columns = [name for name in part[0] if name not in ("varied", "value")]
            rows.append({"varied": label, "value": "exponent", **{name: slope(large, name) for name in columns}})
    return rows


def of_genus(genera: tuple[int, ...]) -> Sums:
    """Summands on curves over GF(2⁶¹ − 1)."""
    for g in genera:
        C = genuine_curve(GF(2**61 - 1), g, "ramified", Random(g))
        rng = Random(3)
        yield g, sum_of_points(C, rng), sum_of_points(C, rng)


def of_bits(sizes: tuple[int, ...]) -> Sums:
    """Summands in genus 2 modulo Mersenne primes."""
    for n in sizes:
        C = genuine_curve(GF(2**n - 1), 2, "ramified", Random(n))
        rng = Random(3)
        yield n, sum_of_points(C, rng), sum_of_points(C, rng)


def of_height(doublings: int) -> Sums:
    """P and 2ᵏP for P = 3·(0, 1) over QQ."""
    P = 3 * HyperellipticCurve(QQ, [1, 2, -3, 1, 0, 1]).jacobian().from_points([(0, 1)])
    D = P
    for _ in range(doublings):
        D = D.double()
        yield max(c.denominator.bit_length() for c in D.u), P, D


def times(D: Divisor, E: Divisor, smoke: bool) -> dict[str, Any]:
    """An addition by each kernel."""
    C = D.jacobian.curve
    flint, python = FlintCantor(C), python_kernel(C).sum_of
    a, b = (D.u, D.v, D.n), (E.u, E.v, E.n)
    x, y = flint.convert(a), flint.convert(b)
    if flint.convert_back(flint.add(x, y)) != ((D + E).u, (D + E).v, None):
        raise AssertionError(f"two additions differ: {D!r} + {E!r}")
    repeat = 1 if smoke else 5
    return {
        "add": microseconds(lambda: D + E, repeat),
        "Python": microseconds(lambda: python(a, b), repeat),
        "Cantor": microseconds(lambda: cantor.sum_of(C, a, b), repeat),
        "flint": microseconds(lambda: flint.add(x, y), repeat),
    }


def slope(rows: list[dict[str, Any]], name: str) -> float:
    """The exponent of row[name] as a power of row["value"]."""
    return float(np.polyfit([log(row["value"]) for row in rows], [log(row[name]) for row in rows], 1)[0])
