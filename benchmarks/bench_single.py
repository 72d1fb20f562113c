"""One class at a time: D + E, 2D and a 122-bit multiple by the operators, compared with Cantor on python-flint's
polynomials.

Microseconds, the least of several samples; flint computes on its own objects, without conversions, and multiplies by
doubling and adding. "call" is the compiled code called on bare coordinates, "kernel" the addition of triples (u, v, n).
A group uses compiled code only after a certain amount of work. Until then it uses "Python" or "converted", which is
Cantor's algorithm on python-flint with conversions of arguments and results. These two columns justify the rule of
jacobian.addition.cantor_flint.pays, whose choice is in the column "before". Results are compared first.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from random import Random
from typing import Any

from benchmarks.curves import LARGE_PRIME, genuine_curve, least, sum_of_points
from jacobian import GF
from jacobian.addition import cantor_flint
from jacobian.addition.choice import python_kernel
from tests.jacobian.addition.flint_cantor import FlintCantor

FIELDS = {
    "GF(2^61-1)": GF(2**61 - 1),
    "GF(p), 256 bits": GF(LARGE_PRIME),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
    "GF(3^5)": GF(3, 5, (1, 2, 0, 0, 0, 1)),
    "GF((2^61-1)^2)": GF(2**61 - 1, 2, (1, 0, 1)),
    "GF(2^127)": GF(2, 127, (1, 1, *[0] * 125, 1)),
}
MORE = {
    "GF(2^63-25)": GF(2**63 - 25),
    "GF(2^89-1)": GF(2**89 - 1),
    "GF(2^127-1)": GF(2**127 - 1),
    "GF(2^128-159)": GF(2**128 - 159),
    "GF(2^521-1)": GF(2**521 - 1),
    "GF(3^40)": GF(3, 40, (2, 1, *[0] * 38, 1)),
}
SCALAR = (1 << 122) - 0x1_2345_6789_ABCD_EF01
LENGTHS = (17, 31, 61, 89, 127, 255, 521, 1279)
"""The bits of the primes for which ints are compared with gmpy2's integers."""


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each field, model and genus, and one for each length of p."""
    rows = []
    for name, K in list(FIELDS.items())[:2] if smoke else {**FIELDS, **MORE}.items():
        for model in ("ramified",) if smoke else ("ramified", "split"):
            for genus in (2,) if smoke else (2, 3, 5, 10):
                C = genuine_curve(K, genus, model, Random(f"{name} {genus} {model}"))
                rows.append({"field": name, "model": model, "g": genus, **measure(C, Random(1), smoke)})
    return [*rows, *([] if smoke else map(integers, LENGTHS))]


def measure(C: Any, rng: Random, smoke: bool) -> dict[str, object]:
    """A row with the times of all operations on one curve."""
    J, flint = C.jacobian(), FlintCantor(C)
    D, E = sum_of_points(C, rng), sum_of_points(C, rng)
    first, second = (D.u, D.v, D.n), (E.u, E.v, E.n)
    a, b = map(flint.convert, (first, second))
    python, converted = python_kernel(C).sum_of, cantor_flint.FlintCantor(C).sum_of
    J.compile()
    total, multiple = D + E, SCALAR * D
    if {python(first, second), converted(first, second)} != {(total.u, total.v, total.n)}:
        raise AssertionError(f"{C!r}: the kernels differ")
    for ours, theirs in ((total, flint.add(a, b)), (multiple, flint.multiply(SCALAR, a))):
        if flint.convert_back(theirs) != (ours.u, ours.v, ours.n):
            raise AssertionError(f"{C!r}: the two results differ")
    owner = getattr(J._sum_of, "__self__", None)
    actions: dict[str, Callable[[], object]] = {
        "D + E": lambda: D + E,
        "D.double()": D.double,
        "kernel": partial(J._sum_of, first, second),
        "Python": partial(python, first, second),
        "converted": partial(converted, first, second),
        "flint": partial(flint.add, a, b),
        "flint 2D": partial(flint.add, a, a),
        "m·D": lambda: SCALAR * D,
        "flint m·D": partial(flint.multiply, SCALAR, a),
    }
    call = getattr(owner, "_add", None)
    if call:
        actions["call"] = partial(call, D.u, D.v, E.u, E.v)
    times = least(actions, 3 if smoke else 30)
    before = "converted" if cantor_flint.pays(C) else "Python"
    return {**times, "before": before, "flint/ours": times["flint"] / times["D + E"]}


def integers(bits: int) -> dict[str, object]:
    """A row for a prime of ``bits`` bits, with the times of the explicit formulas on ints and on gmpy2's integers."""
    from jacobian.addition.explicit import GmpFormulas, PrimeFormulas
    from jacobian.fields.primality import is_prime

    p = next(p for p in range((1 << bits) - 1, 0, -2) if is_prime(p))
    C = genuine_curve(GF(p), 2, "ramified", Random(bits))
    rng = Random(1)
    first, second = ((D.u, D.v, D.n) for D in (sum_of_points(C, rng), sum_of_points(C, rng)))
    kernels = {"ints": PrimeFormulas(C).sum_of, "gmpy2": GmpFormulas(C).sum_of, "chosen": python_kernel(C).sum_of}
    times = least({name: partial(add, first, second) for name, add in kernels.items()}, 30)
    return {"field": f"p of {bits} bits", "model": "ramified", "g": 2, **times}
