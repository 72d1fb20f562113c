"""Measurements in a fresh process: a first answer, and the libraries that a scene leaves unused.

Each measurement is a Python process of its own, with its own imports, caches and memory.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from time import perf_counter
from typing import Any

from integrable.oracles.methods import METHODS

__all__ = ["HEAVY", "first_answer", "left_out"]

HEAVY = ("numpy", "mpmath", "numba", "galois", "scipy", "matplotlib", "tqdm")
"""Libraries that cost time and memory to import."""

_START = """
import json, sys
from time import perf_counter
begun = perf_counter()
from integrable.scene.file import load_scene
scene = load_scene(sys.argv[1])
system, state = scene.start(15)
times = scene.times.floats()
"""
_ASKED = """
flow = system.motion_through(state)
trajectory = flow.at(times)
trajectory.gamma, trajectory.M
"""
_EVERYTHING = """
import galois, matplotlib, mpmath, numba, scipy.integrate, tqdm
flow = system.flow(state, kernel="compiled") if scene.rolls_or_spins else system.motion_through(state)
trajectory = flow.at(times)
from jacobian.errors import JacobianError
for name in ("gamma", "M", "omega", "integrals", "attitude", "quaternion", "contact", "times"):
    try:
        getattr(trajectory, name, None)
    except JacobianError:  # a top has no contact point
        pass
if scene.rolls_or_spins:
    flow.at_tau([0.0]).times
    flow.residual_growth([100_000])
from integrable.study.plot import sphere
if scene.rolls_or_spins and len(times) > 2:
    import io
    sphere(trajectory.gamma, trajectory.times, scene.title).savefig(io.BytesIO(), format="png", dpi=200)
"""
_END = """
def peak():
    # of this program alone: what getrusage counts begins with the process that started it
    try:
        with open("/proc/self/status") as status:
            return next(1024 * int(line.split()[1]) for line in status if line.startswith("VmHWM"))
    except OSError:
        pass
    try:
        import resource
    except ImportError:  # Windows
        return None
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
found = {
    "seconds": perf_counter() - begun,
    "memory": peak(),
    "modules": len(sys.modules),
    "heavy": [name for name in %r if name in sys.modules],
}
print(json.dumps({**found, "way": trajectory.way}))
"""
_COMPILED = """
def once():
    return system.motion_through(state).at(times).gamma
"""
_METHOD = """
from integrable.oracles.methods import METHODS
method = METHODS[%r]
def once():
    return method.solve(system, state, times, method.ladder(system, state)[-2])
"""
_ONE_TIME = """
from integrable.oracles.methods import time_scale
times = [time_scale(system, state)]
"""
_TWICE = """
first = perf_counter(); once(); second = perf_counter(); once(); last = perf_counter()
print(json.dumps({"first": second - first, "second": last - second}))
"""


def _python(code: str, source: str, **environment: str) -> tuple[float, dict[str, Any]]:
    """Seconds of a whole process, its start included, and what it printed."""
    begun = perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", code, source],
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "the process has failed")
    return perf_counter() - begun, json.loads(done.stdout.splitlines()[-1])


def left_out(source: str) -> dict[str, Any]:
    """Imports and memory of γ and M at the scene's times, beside everything the package could compute of them."""
    found: dict[str, Any] = {}
    # the second takes many times as long as the first, and is measured once
    for name, part, times in (("asked", _ASKED, 2), ("everything", _EVERYTHING, 1)):
        runs = [_python(_START + part + _END % (HEAVY,), source) for _ in range(times)]
        wall, data = min(runs, key=lambda run: run[0])
        found[name] = {"total": wall, **data}
    return found


def first_answer(source: str, method: str) -> dict[str, Any]:
    """Seconds to a first answer, one time scale after the start, everything included.

    "cold": a process where nothing has been compiled; "disk": compiled code is on disk; "process": a call in a process
    that has run before.
    """
    code = _START + _ONE_TIME + (_METHOD % method if method in METHODS else _COMPILED) + _TWICE
    with tempfile.TemporaryDirectory() as cache:
        # heyoka keeps what it compiles on disk too
        kept = {"NUMBA_CACHE_DIR": cache, "HEYOKA_CACHE_DIR": cache}
        cold, _ = _python(code, source, **kept)
        warm, found = _python(code, source, **kept)
    return {"cold": cold, "disk": warm, "process": found["second"]}
