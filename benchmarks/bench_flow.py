"""The exact flow: error against T for the reference scenes, far times, and the cost of a point."""

from __future__ import annotations

import json
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from integrable import ChaplyginBall, EulerTop
from integrable.flow import Flow
from jacobian import MP

SCENES = json.loads((Path(__file__).parents[1] / "tests" / "data" / "trajectories.json").read_text())["scenes"]
FAR = (1e4, 1e6, 1e9, 1e12)


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows of three kinds: error at the reference's times, error at far times, seconds for set-up and µs a point."""
    rows: list[dict[str, object]] = []
    for name in ("S1", "S2", "S6"):
        rows += _against_reference(name, smoke)
    rows += _far(smoke)
    rows += _costs(smoke)
    return rows


def _flow(name: str, field: Any = None) -> tuple[Flow, list[int]]:
    scene = SCENES[name]
    convert = (lambda values: [float(x) for x in values]) if field is None else list
    options = {} if field is None else {"field": field}
    d = convert([str(scene["d"])])[0]
    inertia = convert(scene["I"])
    system = ChaplyginBall(inertia, d, **options) if float(d) else EulerTop(inertia, **options)
    state = system.state(convert(scene["gamma0"]), convert(scene["M0"]), tilted=name == "S6")
    return system.flow(state), sorted(map(int, scene["states"]))


def _against_reference(name: str, smoke: bool) -> list[dict[str, object]]:
    flow, times = _flow(name)
    gamma = flow.at(times[:2] if smoke else times).gamma
    rows = []
    for t, found in zip(times, gamma, strict=False):
        truth = np.array(SCENES[name]["states"][str(t)]["gamma"], dtype=float)
        rows.append(
            {"what": f"{name} against the reference", "T": t, "error gamma": float(np.abs(found - truth).max())}
        )
    return rows


def _far(smoke: bool) -> list[dict[str, object]]:
    """S1's ball from floats that 45 digits take as they are."""
    times = FAR[:1] if smoke else FAR
    gamma, M = (0.6, 0.0, 0.8), (0.8, 0.5, -0.6)
    ball = ChaplyginBall((1, 2, 3), 0.7)
    found = ball.flow(ball.state(gamma, M)).at(times).gamma
    K = MP(20 if smoke else 45)
    x, m = ([K.coerce(c) for c in v] for v in (gamma, M))
    size = K.sqrt(K.dot(x, x))
    x = [c / size for c in x]
    tilt = K.dot(x, m)
    precise = ChaplyginBall((1, 2, 3), 0.7, field=K)
    truth = precise.flow(precise.state(x, [a - tilt * b for a, b in zip(m, x, strict=True)])).at(times).gamma
    errors = np.abs(found - truth.astype(float)).max(axis=1)
    return [
        {"what": f"far, against {K.dps} digits", "T": t, "error gamma": float(error)}
        for t, error in zip(times, errors, strict=True)
    ]


def _costs(smoke: bool) -> list[dict[str, object]]:
    count = 20 if smoke else 2000
    times = np.random.default_rng(7).uniform(0, 4000, count)
    rows = []
    for name in ("S1", "S2"):
        setups, points = [], []
        for _ in range(1 if smoke else 3):
            begun = perf_counter()
            flow, _ = _flow(name)
            first = flow.at(times[:1]) if name == "S2" else flow.at([1000.0])
            assert len(first.gamma) == 1
            ready = perf_counter()
            assert len(flow.at(times).gamma) == count
            points.append((perf_counter() - ready) / count)
            setups.append(ready - begun)
        rows.append(
            {
                "what": f"{name}, {count} scattered times up to 4000",
                "set-up and first point s": median(setups),
                "us a point": 1e6 * median(points),
            }
        )
    return rows
