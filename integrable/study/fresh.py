"""What a fresh process does: the first use of a flow, compilation, and what a scene leaves out.

Each measurement is a Python of its own, so that imports, caches and memory are those of one piece of work.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
from time import perf_counter
from typing import Any

from integrable.oracles.methods import METHODS

__all__ = ["HEAVY", "compilation", "first_use", "left_out"]

HEAVY = ("numpy", "mpmath", "numba", "galois", "scipy", "matplotlib", "tqdm")
"""Libraries that cost time and memory to import."""
REPEAT = 3

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
    flow = system.flow(state, kernel="compiled")
    return flow.at(times[:1]).gamma
"""
_METHOD = """
from integrable.oracles.methods import METHODS
def once():
    method = METHODS[%r]
    return method.solve(system, state, times[:1], method.ladder(system, state)[0])
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


def first_use(source: str) -> dict[str, Any]:
    """Median seconds of a fresh process from its start to γ and M at the scene's times, and of its work alone."""
    runs = [_python(_START + _ASKED + _END % (HEAVY,), source) for _ in range(REPEAT)]
    return {
        "total": statistics.median(wall for wall, _ in runs),
        "setup": statistics.median(found["seconds"] for _, found in runs),
        "runs": REPEAT,
    }


def left_out(source: str) -> dict[str, Any]:
    """What γ and M at the scene's times import and take, beside everything that the package could compute of them."""
    found: dict[str, Any] = {}
    # the second takes many times the first, and is measured once
    for name, part, times in (("asked", _ASKED, 2), ("everything", _EVERYTHING, 1)):
        runs = [_python(_START + part + _END % (HEAVY,), source) for _ in range(times)]
        wall, data = min(runs, key=lambda run: run[0])
        found[name] = {"total": wall, **data}
    return found


def compilation(source: str, method: str) -> dict[str, Any]:
    """Seconds of a first call with an empty cache of compiled code, of one that loads it, and of a call after that."""
    code = _START + (_METHOD % method if method in METHODS else _COMPILED) + _TWICE
    with tempfile.TemporaryDirectory() as cache:
        _, cold = _python(code, source, NUMBA_CACHE_DIR=cache)
        _, warm = _python(code, source, NUMBA_CACHE_DIR=cache)
    return {"total": cold["first"], "setup": warm["first"], "evaluation": warm["second"], "runs": 1}
