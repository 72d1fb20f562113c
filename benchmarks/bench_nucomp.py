"""NUCOMP compared with Cantor's step-by-step reduction by genus: microseconds for an addition and a doubling.

The constant NUCOMP_GENUS of jacobian/addition/choice.py is read off this table.
"""

from __future__ import annotations

from functools import partial
from random import Random

from benchmarks.curves import LARGE_PRIME, genuine_curve, microseconds, sum_of_points
from jacobian import GF
from jacobian.addition import cantor, nucomp

FIELDS = {
    "GF(2^61-1)": GF(2**61 - 1),
    "GF(p), 256 bits": GF(LARGE_PRIME),
    "GF(2^8)": GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)),
}


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each field, model and genus."""
    rows: list[dict[str, object]] = []
    for name, K in FIELDS.items():
        for model in ("ramified", "split"):
            for genus in (3,) if smoke else (3, 4, 5, 6, 7, 8, 10, 20):
                rng = Random(f"{name} {genus} {model}")
                C = genuine_curve(K, genus, model, rng)
                a, b = ((D.u, D.v, D.n) for D in (sum_of_points(C, rng), sum_of_points(C, rng)))
                row: dict[str, object] = {"field": name, "model": model, "g": genus}
                for label, kernel in (("Cantor", cantor), ("NUCOMP", nucomp)):
                    row[f"add {label}"] = microseconds(partial(kernel.sum_of, C, a, b), 1 if smoke else 9)
                    row[f"double {label}"] = microseconds(partial(kernel.double, C, a), 1 if smoke else 9)
                rows.append(row)
    return rows
