"""Our flow beside other integrators on scenes S1, S2, S4a, S6, in one run: seconds and error of γ at one time T.

Everyone starts from the floats nearest to the scene's decimals, and so does the truth, our flow at 30 digits (which the
tests hold against tests/data/trajectories.json from the decimals). ``total`` is set-up and run of a fresh start, the
least of several; ``first use`` is the same the first time in this process, when numba loads compiled code from disk and
heyoka compiles its own. heyoka's rows need ``pip install 'jacobian-integrable[peers]'``.
"""

from __future__ import annotations

import json
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from integrable import ChaplyginBall, EulerTop
from integrable.oracles.methods import METHODS
from jacobian import MP, RR

SCENES = json.loads((Path(__file__).parents[1] / "tests" / "data" / "trajectories.json").read_text())["scenes"]
TIMES = {
    "S1": (1e1, 1e2, 1e3, 1e4, 1e6),
    "S2": (1e1, 1e2, 1e3, 1e4, 1e6),
    "S4a": (1e1, 1e2, 1e3),
    "S6": (1e1, 1e2, 1e3, 1e4),
}
TRUTH_DIGITS = 30
PATIENCE = 1.0
"""Seconds of repeats."""
PEERS: dict[str, tuple[float, float]] = {
    # setting, and the longest T that is asked for
    "Gauss-Legendre 16": (0.5, 1e6),
    "Gauss-Legendre 16, adaptive": (1e-18, 1e6),
    "Taylor, compiled": (1e-17, 1e6),
    "heyoka": (2.3e-16, 1e6),
    "heyoka, long double": (1e-19, 1e4),
    "closed elliptic form": (15, 1e12),
    "SciPy DOP853": (3e-14, 1e3),
    "SciPy LSODA": (1e-12, 1e3),
    "SciPy Radau": (1e-10, 1e2),
    "Gauss-Legendre 6": (0.05, 1e2),
    "Moser-Veselov, order 4": (0.02, 1e3),
    "implicit midpoint": (0.05, 1e2),
}


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


def truth(name: str, time: float, digits: int) -> np.ndarray:
    """γ and M at a time from the floats of the scene, by the flow at ``digits`` digits, rounded to floats."""
    K = MP(digits)
    system, state = problem(name, K)
    run = system.flow(state).at([K.coerce(time)])
    return np.concatenate([run.gamma[0], run.M[0]]).astype(float)


def ours(name: str, time: float) -> tuple[float, np.ndarray]:
    """Seconds, set-up included, and γ, M of the float flow."""
    begun = perf_counter()
    system, state = problem(name)
    run = system.flow(state).at([time])
    found = np.concatenate([run.gamma[0], run.M[0]])
    return perf_counter() - begun, found


def peer(name: str, time: float, method: str, setting: float) -> tuple[float, np.ndarray]:
    """The same of another integrator."""
    begun = perf_counter()
    system, state = problem(name)
    run = METHODS[method].solve(system, state, [time], setting)
    found = np.concatenate([run.gamma[0], run.M[0]]).astype(float)
    return perf_counter() - begun, found


def least(action: Any, patience: float) -> tuple[float, float, np.ndarray]:
    """Seconds the first time, the least seconds, and the answer: two runs at least, where that is no long wait."""
    first, found = action()
    best, spent, runs = first, first, 1
    while runs < 20 and (spent < patience or (runs == 1 and first < 5 * patience)):
        seconds, found = action()
        best, spent, runs = min(best, seconds), spent + seconds, runs + 1
    return first, best, found


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (scene, T, method, setting, total, first use, error γ, error M relative to |M|, ahead), the flow first.

    ``ahead``: the peer's seconds over ours where our error is no larger than theirs, else a dash.
    """
    rows: list[dict[str, object]] = []
    for name, times in TIMES.items():
        system, _ = problem(name)
        for time in [1.0] if smoke else times:
            wanted = truth(name, time, 20 if smoke else TRUTH_DIGITS)
            flow = measured(name, time, "divisor flow", None, lambda n=name, t=time: ours(n, t), wanted, smoke)
            rows.append(flow)
            for method, (setting, longest) in PEERS.items():
                if time > longest or not METHODS[method].takes(system):
                    continue
                action = lambda n=name, t=time, m=method, s=setting: peer(n, t, m, s)  # noqa: E731
                row = measured(name, time, method, setting, action, wanted, smoke)
                if row["error γ"] is not None and flow["error γ"] is not None and row["error γ"] >= flow["error γ"]:  # type: ignore[operator]
                    row["ahead"] = row["total s"] / flow["total s"]  # type: ignore[operator]
                rows.append(row)
    return rows


def measured(
    name: str, time: float, method: str, setting: Any, action: Any, wanted: np.ndarray, smoke: bool
) -> dict[str, object]:
    """One row; what cannot be done is a row with the reason."""
    row: dict[str, object] = {"scene": name, "T": time, "method": method, "setting": setting}
    try:
        first, total, found = least(action, 0.0 if smoke else PATIENCE)
    except (ArithmeticError, RuntimeError, ValueError) as error:
        return row | {"total s": None, "first use s": None, "error γ": None, "error M": None, "note": str(error)[:45]}
    off = np.abs(found - wanted)
    size = float(np.sqrt(np.sum(wanted[3:] ** 2))) or 1.0
    return row | {
        "total s": total,
        "first use s": first,
        "error γ": float(off[:3].max()),
        "error M": float(off[3:].max()) / size,
    }
