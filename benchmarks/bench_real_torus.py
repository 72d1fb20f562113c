"""Motions of genus 2: many points on the compiled torus, and the same by additions in long numbers.

100 000 times up to 10⁶, processor time, the least of several; errors are beside the states of the additions.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from benchmarks.curves import least_seconds
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova

MOTIONS: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Neumann on S²": (Neumann((1, 2, 4)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Toda, three particles": (TodaLattice(3), (0, 0.5, -0.25), (1, -0.75, -0.25)),
    "Veselova's body": (Veselova((1, 2, 3)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Garnier, two axes": (Garnier((0, 1)), (0.3, 0.5), (0.2, -0.4)),
    "geodesic, a = 1, 2, 4": (Ellipsoid((1, 2, 4)), (1, 0, 0), (0, 0.6, 0.8)),
    "geodesic on the earth, km": (
        Ellipsoid((40681077.7, 40680197.6, 40408308.7)),
        (0, 0, 40408308.7**0.5),
        (0.6, 0.8, 0),
    ),
}


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system."""
    return [_row(name, 1000 if smoke else 100_000, 1 if smoke else 3) for name in MOTIONS]


def _row(name: str, count: int, repeats: int) -> dict[str, object]:
    system, q, p = MOTIONS[name]
    state, times = system.state(q, p), np.linspace(0, 1e6, count)
    first = system.flow(state)
    first.at(times[:24])
    begun = time.process_time()
    flow = system.flow(state)
    flow.at(times[:24])
    ready = time.process_time() - begun
    path, few = flow.at(times), flow.at(times[-10:])
    return {
        "system": name,
        "by additions, ms a point": 1e3 * least_seconds(lambda: flow.at(times[-10:]), repeats) / 10,
        "on the torus, µs a point": 1e6 * least_seconds(lambda: flow.at(times), repeats) / count,
        "set-up, ms": 1e3 * ready,
        "error": float(max(np.abs(path.q[-10:] - few.q).max(), np.abs(path.p[-10:] - few.p).max())),
    }
