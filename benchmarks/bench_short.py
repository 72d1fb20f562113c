"""A fresh flow with 101 outputs beside compiled integrators, T = 1 … 10⁴, on four bodies, in one run.

Everyone starts from the floats nearest to the scene's decimals, set-up included; seconds are of processor time, the
least of several, compilation apart. The truth is the torus in double-doubles (right to 3e-17, docs/flow.md). ``way``
is what "auto" has taken, ``other way`` how long the torus, or a short run of any length, takes instead: the cost model
of :mod:`integrable.motion.short` is right where that is more. ``ahead`` is the least time of a peer over ours, among
all settings that are as near to the truth as we are, or to 1e-15; a dash where none is.
"""

from __future__ import annotations

from time import thread_time
from typing import Any
from unittest.mock import patch

import numpy as np

from benchmarks.bench_peers import problem
from integrable.motion import short
from integrable.motion.flow import Flow
from integrable.oracles.methods import METHODS

SCENES = ("S1", "S2", "S4a", "S6")
TIMES = (1.0, 10.0, 100.0, 1e3, 1e4)
OUTPUTS = 101
PATIENCE = 0.3
"""Seconds of repeats."""
PEERS: dict[str, tuple[float, ...]] = {
    "Taylor, compiled": (1e-14, 1e-15, 1e-16, 1e-17),
    "Gauss-Legendre 16, adaptive": (1e-15, 1e-16, 1e-18),
    "heyoka": (2.3e-16,),
}
GOOD = 1e-15
LONGEST_PEER = {"S4a": 1e3}


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (scene, T, method, setting, ms, error, way, other way ms, ahead): ours, then the peers'."""
    rows: list[dict[str, object]] = []
    for name in SCENES[:1] if smoke else SCENES:
        for time in TIMES[:1] if smoke else TIMES:
            rows += _compared(name, np.linspace(0, time, 3 if smoke else OUTPUTS), smoke)
    return rows


def _compared(name: str, times: np.ndarray, smoke: bool) -> list[dict[str, object]]:
    system, state = problem(name)
    truth = Flow(system, state, "compiled").at(times)
    wanted, size = np.hstack([truth.gamma, truth.M]), float(np.linalg.norm(state.M))
    # numba is there: nothing is interpreted
    ours, run = _least(lambda: _fresh(name, "auto").at(times), smoke)
    error = _error(run, wanted, size)
    row: dict[str, object] = {
        "scene": name, "T": times[-1], "method": "divisor flow", "setting": None, "ms": 1e3 * ours, "error": error,
        "way": run.way, "other way ms": _other_way(name, times, run.way, smoke),
    }  # fmt: skip
    peers: list[dict[str, object]] = []
    fair = [
        (method, setting)
        for method, settings in PEERS.items()
        for setting in settings
        if METHODS[method].takes(system) and times[-1] <= LONGEST_PEER.get(name, np.inf)
    ]
    best = np.inf
    for method, setting in fair[:1] if smoke else fair:
        seconds, found = _least(lambda m=method, s=setting: METHODS[m].solve(*problem(name), times, s), smoke)  # type: ignore[misc]
        off = _error(found, wanted, size)
        peers.append(
            {"scene": name, "T": times[-1], "method": method, "setting": setting, "ms": 1e3 * seconds, "error": off}
        )
        if off <= max(error, GOOD):
            best = min(best, seconds)
    row["ahead"] = best / ours if best < np.inf else None
    return [row, *peers]


def _fresh(name: str, kernel: str) -> Flow:
    return Flow(*problem(name), kernel)


def _other_way(name: str, times: np.ndarray, way: str, smoke: bool) -> float | None:
    """Milliseconds of the torus where a short run was taken, of a short run where the torus was."""
    if way == "short run":
        return 1e3 * _least(lambda: _fresh(name, "compiled").at(times), smoke)[0]
    with patch.object(short, "panels_within", lambda *_: 10**6):
        seconds, run = _least(lambda: _fresh(name, "auto").at(times), smoke)
    return 1e3 * seconds if run.way == "short run" else None


def _least(action: Any, smoke: bool) -> tuple[float, Any]:
    """The least processor time of several calls, and what the last gave."""
    action()
    spent, best = 0.0, np.inf
    while spent < (0 if smoke else PATIENCE) or best == np.inf:
        begun = thread_time()
        found = action()
        seconds = thread_time() - begun
        spent, best = spent + seconds, min(best, seconds)
    return best, found


def _error(run: Any, wanted: np.ndarray, size: float) -> float:
    """The largest error of γ and of M/|M|."""
    gaps = np.abs(np.hstack([np.asarray(run.gamma, float), np.asarray(run.M, float)]) - wanted)
    return float(max(gaps[:, :3].max(), gaps[:, 3:].max() / size))
