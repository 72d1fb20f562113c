"""Sums on Kummer surfaces compared with the group of the curve: microseconds of processor time each, on one thread.

"sum" and "ladder" are single calls; "sum, array" and "ladder, array" are times per point of an array of 500. "m·D" is
the same multiple in the group, compiled where possible, and "m·D, array" its time per class of an array. "flint m·D" is
the multiple by doubling and adding with Cantor's algorithm on python-flint's polynomials. "set-up" is the time for the
forms of a curve, in seconds, spent once.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from time import process_time

from benchmarks.bench_single import SCALAR
from benchmarks.curves import genuine_curve, least
from jacobian import GF, HyperellipticCurve
from jacobian.batch import DivisorArray, set_threads
from jacobian.relatives.pseudo_group import PseudoGroup
from tests.jacobian.addition.flint_cantor import FlintCantor

COUNT = 500
PRIMES = {"2^61-1": 2**61 - 1, "2^127-1": 2**127 - 1, "2^128-159": 2**128 - 159}


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each prime and equation."""
    rows = []
    for name, p in list(PRIMES.items())[: 1 if smoke else None]:
        curves = {"x^5 + 5x^2 + 3x + 7": HyperellipticCurve(GF(p), [7, 3, 5, 0, 0, 1])}
        if not smoke:
            curves["split"] = genuine_curve(GF(p), 2, "split", Random(name))
        rows += [{"p": name, "equation": equation, **measure(C, smoke)} for equation, C in curves.items()]
    return rows


def measure(C: HyperellipticCurve, smoke: bool) -> dict[str, object]:
    """A row with the times of all operations on one curve."""
    J = C.jacobian()
    J.compile()
    D, E = J.random(Random(1)), J.random(Random(2))
    begun = process_time()
    S = PseudoGroup(C)
    x, y, difference = S.point(D), S.point(E), S.point(D - E)
    if S.add(x, y, difference) != S.point(D + E) or S.multiple(SCALAR, x) != S.point(SCALAR * D):
        raise AssertionError(f"{C!r}: the surface differs from the group")
    found: dict[str, object] = {"set-up": process_time() - begun}
    flint = FlintCantor(C)
    a, classes = flint.convert((D.u, D.v, D.n)), DivisorArray.stack([D, E] * (COUNT // 2))
    arrays = [[point] * COUNT for point in (x, y, difference)]
    actions: dict[str, Callable[[], object]] = {
        "sum": lambda: S.add(x, y, difference),
        "sum, array": lambda: S.add(*arrays),
        "ladder": lambda: S.multiple(SCALAR, x),
        "ladder, array": lambda: S.multiple(SCALAR, arrays[0]),
        "m·D": lambda: SCALAR * D,
        "m·D, array": lambda: SCALAR * classes,
        "flint m·D": lambda: flint.multiply(SCALAR, a),
    }
    set_threads(1)
    try:
        times = least(actions, 2 if smoke else 12, process_time)
    finally:
        set_threads(None)
    return found | {name: t / COUNT if name.endswith("array") else t for name, t in times.items()}
