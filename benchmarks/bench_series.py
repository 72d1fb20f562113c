"""Systems of any genus near their start: a fresh flow with 101 outputs by Taylor series, and by additions.

Processor time, the least of several; errors are the largest differences of q and p from the states of the additions,
relative to the largest there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.bench_real_torus import MOTIONS, by_additions
from benchmarks.curves import least_seconds
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice

BESIDE: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Neumann on S³": (Neumann((1, 2, 4, 7)), (0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1)),
    "Toda, eight particles": (TodaLattice(8), (0, 0.5, -0.25, 0, 0.5, 0, 0, 0.25), (1, -1, 0.5, -0.5, 0, 0, 0.25, 0)),
    "Hénon and Heiles, 1:6": (HenonHeiles.with_frequencies(1, 1.25), (0.05, 0.03), (0, 0.01)),
    "Lagrange's top": (LagrangeTop(0.7), (0.48, 0.6, 0.64), (0.3, 0.1, 1.5)),
    "spherical pendulum": (SphericalPendulum(), (0.6, 0, -0.8), (0.4, 0.5, 0.3)),
}
LENGTHS = (1, 10, 100)


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system; a unit of time is |q|/|p| at the start of the earth's geodesic, else 1."""
    return [_row(name, *motion, 1 if smoke else 9) for name, motion in (MOTIONS | BESIDE).items()]


def _row(name: str, system: Any, q: Any, p: Any, repeats: int) -> dict[str, object]:
    state = system.state(q, p)
    unit = max(1.0, float(np.linalg.norm(q)))
    spans = {T: np.linspace(0, unit * T, 101) for T in LENGTHS}
    found = {
        f"T = {T}, ms": 1e3 * least_seconds(lambda times=times: system.flow(state).at(times), repeats)
        for T, times in spans.items()
    }
    few, flow = spans[100][[50, 100]].tolist(), system.flow(state)
    path, far = flow.at(few), by_additions(flow, few)
    gaps = (np.abs(x - y).max() / np.abs(y).max() for x, y in ((path.q, far.q), (path.p, far.p)))
    return {
        "system": name,
        **found,
        "additions, first two points, ms": 1e3
        * least_seconds(lambda: by_additions(system.flow(state), few), min(repeats, 2)),
        "error at T = 100": float(max(gaps)),
    }
