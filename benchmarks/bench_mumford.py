"""Motions on Jacobians of genus 1 to 8 by additions: set-up, points near t = 1 and 10⁶, the error at 10⁶; then 50 or
1000 points up to 10⁶ by the method that the flow chooses.

Neumann's system on S^n (genus n) with a = 1, 2, …, n + 1 and the Toda lattice of n + 1 particles, in floats. Errors at
10⁶ are against 40 digits from the same floats; times are processor times, the least of several.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

from benchmarks.bench_real_torus import by_additions
from benchmarks.curves import least_seconds
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford.flow import MumfordFlow
from jacobian import MP

GENERA = (1, 2, 3, 4, 5, 8)


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system and genus."""
    genera = GENERA[:2] if smoke else GENERA
    return [_row(make, genus, 1 if smoke else 20) for make in (_neumann, _toda) for genus in genera]


def _neumann(genus: int, *field: Any) -> Any:
    return Neumann(range(1, genus + 2), *field)


def _toda(genus: int, *field: Any) -> Any:
    return TodaLattice(genus + 1, *field)


def _row(make: Callable[..., Any], genus: int, repeats: int) -> dict[str, object]:
    rng, system = Random(genus), make(genus)
    q, p = (np.array([rng.uniform(-1, 1) for _ in range(genus + 1)]) for _ in range(2))
    if make is _neumann:
        q /= np.linalg.norm(q)
        p -= q * (q @ p)
    state = system.state(q, p)
    start = time.process_time()
    flow = system.flow(state)
    by_additions(flow, [1e6])
    near = time.process_time() - start
    K = MP(40)
    fine = make(genus, K)
    truth = MumfordFlow(fine, fine._inside(K, state)).at([1e6])
    return {
        "system": type(system).__name__,
        "genus": genus,
        "set-up and one point, ms": 1e3 * near,
        "a point near, ms": 1e3 * least_seconds(lambda: by_additions(flow, [1.25]), repeats),
        "a point at 1e6, ms": 1e3 * least_seconds(lambda: by_additions(flow, [1e6 + 0.25]), repeats),
        **_many(flow, 10 if repeats == 1 else 1000 if make is _neumann and genus < 8 else 50),
        "error at 1e6": float(np.abs(by_additions(flow, [1e6]).q - truth.q.astype(float)).max()),
        "bits beyond floats": flow._motion._extra,
    }


def _many(flow: MumfordFlow, count: int) -> dict[str, object]:
    """The columns of ``count`` points up to 10⁶: a first call, which sets up the torus, and a second call."""
    times = np.random.default_rng(1).uniform(-1e6, 1e6, count)
    start = time.process_time()
    flow.at(times)
    first = time.process_time() - start
    again = least_seconds(lambda: flow.at(times), 2)
    return {"points": count, "all of them, ms": 1e3 * first, "one of them again, ms": 1e3 * again / count}
