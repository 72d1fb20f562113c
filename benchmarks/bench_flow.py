"""The exact flow: error against T, set-up, the cost of scattered and of dense times, and of a stream to a file."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.curves import least_seconds
from integrable import ChaplyginBall, EulerTop
from integrable.motion.flow import Flow
from integrable.motion.precise import PreciseFlow
from integrable.systems.system import System

SCENES = json.loads((Path(__file__).parents[1] / "tests" / "data" / "trajectories.json").read_text())["scenes"]
FAR = (1e2, 1e4, 1e6, 1e9, 1e12)
START = ((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))
# moments, d and starts of hard bodies, in addition to the reference scenes
HARD: dict[str, tuple[tuple[float, ...], float, Any, Any]] = {
    "thinner, I1 = 1e-8": ((1e-8, 1, 1.5), 1, *START),
    "1 : 10^4 : 10^8": ((1, 1e4, 1e8), 1, *START),
    "heavy, d = 1000": ((1, 2, 3), 1000, *START),
    "equal moments": ((1, 1, 2), 0.7, *START),
    "equal to 1e-12": ((1, 1 + 1e-12, 2), 0.7, *START),
    "1e-4 from the separatrix": ((1, 2, 3), 0.7, (0, 0, 1), (1e-2, (1 - 1e-4) ** 0.5, 0)),
    "1e-8 from the separatrix": ((1, 2, 3), 0.7, (0, 0, 1), (1e-4, (1 - 1e-8) ** 0.5, 0)),
    "|M| = 2e4": ((1, 2, 3), 0.7, START[0], (3840, 12800, -14880)),
}

# cases whose series on the torus has so few terms that the kernel "python" computes it in seconds
READABLE = ("S1", "S6", "1 : 10^4 : 10^8", "equal moments", "equal to 1e-12", "|M| = 2e4")


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows: error at the reference's times; error at distant times against other computations; cost; memory of a
    stream.

    Seconds and microseconds are processor time, the best of several repeats; loading the compiled loops is a row of its
    own.
    """
    begun = perf_counter()
    _flow("S1").at([1000.0])
    rows: list[dict[str, object]] = [
        {"what": "compiled loops loaded, S1 and a first point", "s": perf_counter() - begun}
    ]
    for name in ("S1", "S2") if smoke else SCENES:
        rows += _against_reference(name)
    for name in ("S1",) if smoke else (*SCENES, *HARD):
        rows += _far(name, smoke)
        rows.append(_cost(name, smoke))
    rows.append(_stream(20_000 if smoke else 10_000_000))
    return rows


def system_of(name: str) -> tuple[System, Any]:
    if name in HARD:
        moments, given, gamma, M = HARD[name]
        hard = ChaplyginBall(moments, given)
        return hard, hard.state(gamma, M)
    scene = SCENES[name]
    inertia, d = [float(x) for x in scene["I"]], float(scene["d"])
    system = ChaplyginBall(inertia, d) if d else EulerTop(inertia)
    gamma, M = ([float(x) for x in scene[key]] for key in ("gamma0", "M0"))
    return system, system.state(gamma, M, tilted=name == "S6")


def _flow(name: str) -> Flow:
    system, state = system_of(name)
    return system.flow(state, kernel="compiled")


def _against_reference(name: str) -> list[dict[str, object]]:
    """Rows of differences from the reference, which include the effect of rounding the decimal inputs to floats."""
    times = sorted(map(int, SCENES[name]["states"]))
    gamma = _flow(name).at(times).gamma
    rows: list[dict[str, object]] = []
    for t, found in zip(times, gamma, strict=True):
        truth = np.array(SCENES[name]["states"][str(t)]["gamma"], dtype=float)
        rows.append({"what": f"{name}, reference", "T": t, "error": float(np.abs(found - truth).max())})
    return rows


def _far(name: str, smoke: bool) -> list[dict[str, object]]:
    """Errors for the same floats, taken as exact. The reference is :class:`PreciseFlow` at 25 digits for τ = T/|M|, and
    the kernel "python" for t = T/|M|.
    """
    system, state = system_of(name)
    times = np.array(FAR[:2] if smoke else FAR) / float(np.linalg.norm(state.M))
    flow = system.flow(state, kernel="compiled")
    precise = PreciseFlow(system.body, state, 25)
    truth = precise.vectors(precise.at_tau(times.tolist()))
    found = flow.at_tau(times).gamma.tolist()
    errors = [
        max(abs(float(x - y)) for x, y in zip(gamma, true, strict=True))
        for gamma, (true, _) in zip(found, truth, strict=True)
    ]
    rows: list[dict[str, object]] = [
        {"what": name, "T |M|": t, "error in tau": e} for t, e in zip(FAR, errors, strict=False)
    ]
    if name in READABLE:
        readable = system.flow(state, kernel="python").at(times).gamma
        for row, error in zip(rows, np.abs(flow.at(times).gamma - readable).max(axis=1), strict=True):
            row["error in t"] = float(error)
    return rows


def _cost(name: str, smoke: bool) -> dict[str, object]:
    system, state = system_of(name)
    spin = float(np.linalg.norm(state.M))
    count, repeats = (100, 1) if smoke else (20_000, 3)
    times = np.random.default_rng(7).uniform(-1e4, 1e4, count) / spin
    far = times * 1e8
    dense = np.linspace(0, 400 / spin, 20 * count)
    row: dict[str, object] = {"what": f"{name}, cost"}
    uses = {
        "set-up ms": (lambda: system.flow(state, kernel="compiled").at(times[:1]), 1e3),
        "us a point in tau": (lambda: flow.at_tau(times), 1e6 / count),
        "in t": (lambda: flow.at(times), 1e6 / count),
        "in t, to 1e12": (lambda: flow.at(far), 1e6 / count),
        "dense ns a point": (lambda: flow.at(dense), 1e9 / len(dense)),
    }
    flow = system.flow(state, kernel="compiled")
    for label, (call, unit) in uses.items():
        row[label] = unit * least_seconds(call, repeats)
    return row


_STREAM = """
import resource, sys
from integrable import ChaplyginBall
ball = ChaplyginBall((1, 2, 3), 0.7)
flow = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)), kernel="compiled")
flow.stream(sys.argv[1], 0, 1, 1000)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
flow.stream(sys.argv[1], 0, float(sys.argv[2]) / 1000, int(sys.argv[2]))
used = resource.getrusage(resource.RUSAGE_SELF)
print(before, used.ru_maxrss, used.ru_utime + used.ru_stime)
"""


def _stream(count: int) -> dict[str, object]:
    """S1 at 1000 points per unit time, in a separate process: peak memory before and with the stream."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.npy"
        command = [sys.executable, "-c", _STREAM, str(path), str(count)]
        before, after, seconds = map(float, subprocess.run(command, check=True, capture_output=True).stdout.split())
        size = path.stat().st_size
    # ru_maxrss is in kilobytes, on macOS in bytes
    unit = 1024.0 if sys.platform != "darwin" else 1024.0 * 1024
    return {
        "what": f"stream of {count} states",
        "file MB": size / 1e6,
        "peak MB before": before / unit,
        "peak MB with it": after / unit,
        "processor s": seconds,
    }
