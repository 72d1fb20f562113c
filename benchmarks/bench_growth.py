"""How the time of an addition grows with the genus (2 … 50) and with log p: microseconds and fitted exponents.

The last row of each part holds the exponents: the least-squares slope of log time against log g for g ≥ 5 (from where
NUCOMP runs), and against log log p for p of 256 bits and more (below, the interpreter's own time hides the growth).
"""

from __future__ import annotations

from math import log
from random import Random
from typing import Any

import numpy as np

from benchmarks.curves import genuine_curve, microseconds, sum_of_points
from jacobian import GF, HyperellipticCurve
from jacobian.addition import cantor
from jacobian.addition.choice import python_kernel
from tests.jacobian.addition.flint_cantor import FlintCantor

MERSENNE = (31, 61, 127, 521, 1279, 2203, 4253)
"""Exponents of Mersenne primes."""


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each size, then the exponents."""
    genera = (2, 5) if smoke else (2, 3, 4, 5, 7, 10, 14, 20, 28, 39, 50)
    sizes = (61, 521) if smoke else MERSENNE
    rows: list[dict[str, object]] = []
    for label, start, curves in (
        ("g", 5, ((g, genuine_curve(GF(2**61 - 1), g, "ramified", Random(g))) for g in genera)),
        ("bits of p", 256, ((n, genuine_curve(GF(2**n - 1), 2, "ramified", Random(n))) for n in sizes)),
    ):
        part = [{"varied": label, "value": size, **times(C, smoke)} for size, C in curves]
        rows += part
        if not smoke:
            large = [row for row in part if row["value"] >= start]
            columns = [name for name in part[0] if name not in ("varied", "value")]
            rows.append({"varied": label, "value": "exponent", **{name: slope(large, name) for name in columns}})
    return rows


def times(C: HyperellipticCurve, smoke: bool) -> dict[str, Any]:
    """An addition by the group (on flint where it pays), without flint, by Cantor, by Cantor on flint objects."""
    rng = Random(3)
    flint = FlintCantor(C)
    python = python_kernel(C).sum_of
    D, E = sum_of_points(C, rng), sum_of_points(C, rng)
    a, b = (D.u, D.v, D.n), (E.u, E.v, E.n)
    x, y = flint.convert(a), flint.convert(b)
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
