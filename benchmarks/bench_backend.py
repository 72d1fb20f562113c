"""The Python kernels beside Cantor on python-flint with the conversions there and back: microseconds for an addition.

What jacobian.addition.cantor_flint.pays decides is read off this table: the last column is Python's time over flint's.
Over fields of word size both are what a group runs before it changes to compiled code (``python -m benchmarks
single``).
"""

from __future__ import annotations

from functools import partial
from random import Random

from benchmarks.bench_group import FIELDS
from benchmarks.curves import genuine_curve, microseconds, sum_of_points
from jacobian import GF
from jacobian.addition.cantor_flint import FlintCantor, pays
from jacobian.addition.choice import python_kernel

MORE = {"GF(2^521-1)": GF(2**521 - 1), "GF(3^40)": GF(3, 40, (2, 1, *[0] * 38, 1))}


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each field and genus, on split models."""
    rows: list[dict[str, object]] = []
    for name, K in FIELDS.items() if smoke else {**FIELDS, **MORE}.items():
        for genus in (2,) if smoke else (1, 2, 3, 5, 10):
            C = genuine_curve(K, genus, "split", Random(f"{name} {genus}"))
            rng = Random(1)
            a, b = ((D.u, D.v, D.n) for D in (sum_of_points(C, rng), sum_of_points(C, rng)))
            python, flint = python_kernel(C).sum_of, FlintCantor(C).sum_of
            if python(a, b) != flint(a, b):
                raise AssertionError(f"{C!r}: the two additions differ")
            times = [microseconds(partial(add, a, b), 1 if smoke else 7) for add in (python, flint)]
            row: dict[str, object] = {"field": name, "g": genus, "Python": times[0], "flint": times[1]}
            rows.append({**row, "ratio": times[0] / times[1], "chosen": "flint" if pays(C) else "Python"})
    return rows
