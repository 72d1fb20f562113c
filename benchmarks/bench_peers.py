"""A fresh flow beside other integrators on scenes S1, S2, S4a, S6, in one run: one time T, and 101 times up to T.

Everyone starts from the floats nearest to the scene's decimals, and so does the truth: our flow at 30 digits (which the
tests hold against tests/data/trajectories.json from the decimals), for 101 times the torus in double-doubles (right to
3e-17, docs/flow.md). ``ms`` is set-up and run of a fresh start, processor time, the least of several; ``first use`` the
same the first time, when compiled code is loaded from disk and heyoka compiles its own. ``way`` is what "auto" has
taken, ``other way`` how long the torus, or a short run of any length, takes instead: the cost model of
:mod:`integrable.motion.short` is right where that is more. ``of ours`` is a peer's time over that of the flow, and in
the flow's row the least of them among the peers that are as near to the truth as we are, or to 1e-15; a dash where none
is. heyoka's rows need ``pip install 'jacobian-integrable[peers]'``.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import inf
from pathlib import Path
from time import thread_time
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np

from integrable import ChaplyginBall, EulerTop
from integrable.motion import short
from integrable.motion.flow import Flow
from integrable.oracles.methods import METHODS
from jacobian import MP, RR

SCENES = json.loads((Path(__file__).parents[1] / "tests" / "data" / "trajectories.json").read_text())["scenes"]
LONGEST = {"S1": 1e6, "S2": 1e6, "S4a": 1e3, "S6": 1e4}
"""The longest T of a scene."""
TIMES = {101: (1e0, 1e1, 1e2, 1e3, 1e4), 1: (1e1, 1e2, 1e3, 1e4, 1e6)}
"""By the number of outputs."""
TRUTH_DIGITS = 30
PATIENCE, LONG_WAIT = 0.3, 20.0
"""Seconds of repeats, and those from which on one run is enough."""
GOOD = 1e-15


class Peer(NamedTuple):
    """A method of METHODS: its settings for one time, the longest T of that, and the settings for 101 times."""

    alone: tuple[float, ...]
    longest: float
    dense: tuple[float, ...] = ()


PEERS = {
    "Gauss-Legendre 16": Peer((0.5,), 1e6),
    "Gauss-Legendre 16, adaptive": Peer((1e-18,), 1e6, (1e-15, 1e-16, 1e-18)),
    "Taylor, compiled": Peer((1e-17,), 1e6, (1e-14, 1e-15, 1e-16, 1e-17)),
    "heyoka": Peer((2.3e-16,), 1e6, (2.3e-16,)),
    "heyoka, long double": Peer((1e-19,), 1e4),
    "closed elliptic form": Peer((15,), 1e12),
    "SciPy DOP853": Peer((3e-14,), 1e3),
    "SciPy LSODA": Peer((1e-12,), 1e3),
    "SciPy Radau": Peer((1e-10,), 1e2),
    "Gauss-Legendre 6": Peer((0.05,), 1e2),
    "Moser-Veselov, order 4": Peer((0.02,), 1e3),
    "implicit midpoint": Peer((0.05,), 1e2),
}
Row = dict[str, Any]


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (scene, T, outputs, method, setting, ms, first use, error γ, error M relative to |M|, way, other way ms,
    of ours), the flow first.
    """
    rows: list[dict[str, object]] = []
    for name in ("S1",) if smoke else LONGEST:
        for outputs, times in TIMES.items():
            for time in [1.0] if smoke else [t for t in times if t <= LONGEST[name]]:
                rows += compared(name, np.array([time]) if outputs == 1 else np.linspace(0, time, outputs), smoke)
    return rows


def compared(name: str, times: np.ndarray, smoke: bool) -> list[Row]:
    """Our row, then those of the peers."""
    system, _ = problem(name)
    wanted = truth(name, times, smoke)
    ours, run = measured(lambda: fresh(name, "auto").at(times), wanted, smoke)
    row = {"method": "divisor flow", "setting": None, **ours, "way": run.way}
    row["other way ms"] = other_way(name, times, run.way, smoke)
    row["of ours"] = None
    peers: list[Row] = []
    for method, peer in PEERS.items():
        settings = peer.alone if len(times) == 1 else peer.dense
        if times[-1] > peer.longest or not METHODS[method].takes(system):
            continue
        for setting in settings[:1] if smoke else settings:
            peers.append({"method": method, "setting": setting})
            action = lambda m=method, s=setting: METHODS[m].solve(*problem(name), times, s)  # noqa: E731
            try:
                peers[-1] |= measured(action, wanted, smoke)[0]
            except (ArithmeticError, RuntimeError, ValueError) as error:
                peers[-1]["note"] = str(error)[:45]
                continue
            peers[-1]["of ours"] = peers[-1]["ms"] / row["ms"]
    equal = [x["of ours"] for x in peers if "ms" in x and worst(x) <= max(worst(row), GOOD)]
    row["of ours"] = min(equal, default=None)
    return [{"scene": name, "T": times[-1], "outputs": len(times), **x} for x in (row, *peers)]


def problem(name: str, field: Any = RR) -> tuple[Any, Any]:
    """The system and the state of a scene, its decimals rounded to floats first; over MP the same floats, γ made a unit
    vector there."""
    scene = SCENES[name]
    d = float(scene["d"])
    options = {} if field is RR else {"field": field}
    inertia = [float(x) for x in scene["I"]]
    system = ChaplyginBall(inertia, d, **options) if d else EulerTop(inertia, **options)
    gamma, M = ([field.coerce(float(x)) for x in scene[key]] for key in ("gamma0", "M0"))
    if field is not RR:
        size = field.sqrt(field.dot(gamma, gamma))
        gamma = [x / size for x in gamma]
    return system, system.state(gamma, M, tilted=True)


def fresh(name: str, kernel: str) -> Flow:
    """The flow of a scene, from nothing."""
    return Flow(*problem(name), kernel)


def truth(name: str, times: np.ndarray, smoke: bool) -> np.ndarray:
    """γ and M side by side from the floats of the scene, rounded to floats."""
    if len(times) > 1:
        return states(fresh(name, "compiled").at(times))
    K = MP(20 if smoke else TRUTH_DIGITS)
    return states(Flow(*problem(name, K)).at([K.coerce(t) for t in times]))


def states(run: Any) -> np.ndarray:
    """γ and M side by side in floats, shape (N, 6)."""
    return np.hstack([run.gamma, run.M]).astype(float)


def measured(action: Callable[[], Any], wanted: np.ndarray, smoke: bool) -> tuple[Row, Any]:
    """The columns of one row, and what the last of some runs gave: two runs at least, where that is no long wait."""
    first, found = timed(action)
    best, spent, runs = first, 0.0, 1
    while (runs == 1 and first < LONG_WAIT) or spent < (0 if smoke else PATIENCE):
        seconds, found = timed(action)
        best, spent, runs = min(best, seconds), spent + seconds, runs + 1
    off, size = np.abs(states(found) - wanted), float(np.linalg.norm(wanted[0, 3:])) or 1.0
    errors = {"error γ": float(off[:, :3].max()), "error M": float(off[:, 3:].max()) / size}
    return {"ms": 1e3 * best, "first use ms": 1e3 * first, **errors}, found


def timed(action: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of the processor, and what came out."""
    begun = thread_time()
    found = action()
    return thread_time() - begun, found


def worst(row: Row) -> float:
    """The larger error."""
    return max(row.get("error γ", inf), row.get("error M", inf))


def other_way(name: str, times: np.ndarray, way: str, smoke: bool) -> float | None:
    """Milliseconds of the torus where a short run was taken, of a short run where the torus was."""
    wanted = np.zeros((len(times), 6))
    if way == "short run":
        return float(measured(lambda: fresh(name, "compiled").at(times), wanted, smoke)[0]["ms"])
    with patch.object(short, "panels_within", lambda *_: 10**6):
        columns, run = measured(lambda: fresh(name, "auto").at(times), wanted, smoke)
    return float(columns["ms"]) if run.way == "short run" else None
