"""Addition, doubling and a 64-bit multiple of divisor classes, beside a straightforward Cantor on python-flint.

Microseconds. Both sides compute on their own objects, without conversions, and their results are compared first. The
multiple on flint's side is by doubling and adding.
"""

from __future__ import annotations

from random import Random
from typing import Any

from benchmarks.curves import LARGE_PRIME, genuine_curve, microseconds, sum_of_points
from jacobian import GF
from tests.jacobian.addition.flint_cantor import FlintCantor

FIELDS = {
    "GF(2^61-1)": GF(2**61 - 1),
    "GF(p), 256 bits": GF(LARGE_PRIME),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
    "GF((2^61-1)^2)": GF(2**61 - 1, 2, (1, 0, 1)),
    "GF(2^127)": GF(2, 127, (1, 1, *[0] * 125, 1)),
}
SCALAR = 0xF3A5_96C7_1B2D_8E4F


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each field, model at infinity and genus."""
    rows = []
    for name, K in FIELDS.items():
        for model in ("ramified", "split"):
            for genus in (2,) if smoke else (2, 3, 5, 10):
                C = genuine_curve(K, genus, model, Random(f"{name} {genus} {model}"))
                rows.append({"field": name, "model": model, "g": genus, **measure(C, Random(1), smoke)})
    return rows


def measure(C: Any, rng: Random, smoke: bool) -> dict[str, object]:
    """Medians of one addition, one doubling and one multiple, here and on flint."""
    J, flint = C.jacobian(), FlintCantor(C)
    D, E = sum_of_points(C, rng), sum_of_points(C, rng)
    a, b = (flint.convert((X.u, X.v, X.n)) for X in (D, E))
    total = D + E
    if flint.convert_back(flint.add(a, b)) != (total.u, total.v, total.n):
        raise AssertionError(f"{C!r}: the two additions differ")
    repeat = 1 if smoke else 7
    result: dict[str, object] = {
        "add": microseconds(lambda: J.add(D, E), repeat),
        "flint add": microseconds(lambda: flint.add(a, b), repeat),
        "double": microseconds(lambda: J.double(D), repeat),
        "flint double": microseconds(lambda: flint.add(a, a), repeat),
    }
    if not smoke:
        result["multiple"] = microseconds(lambda: SCALAR * D, 3)
        result["flint multiple"] = microseconds(lambda: flint.multiply(SCALAR, a), 3)
    return result
