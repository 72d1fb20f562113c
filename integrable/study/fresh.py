"""Times to a first answer, each measured in a separate Python process with its own imports and caches."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from time import perf_counter
from typing import Any

from integrable.oracles.methods import METHODS

__all__ = ["first_answer"]

_START = """
import sys
from time import perf_counter
from integrable.scene.file import load_scene
scene = load_scene(sys.argv[1])
system, state = scene.start(15)
from integrable.oracles.methods import METHODS, time_scale
times = [time_scale(system, state)]
"""
_COMPILED = """
def once():
    return system.motion_through(state).at(times).gamma
"""
_METHOD = """
method = METHODS[%r]
def once():
    return method.solve(system, state, times, method.ladder(system, state)[-2])
"""
_TWICE = """
once(); begun = perf_counter(); once()
print(perf_counter() - begun)
"""


def _python(code: str, source: str, **environment: str) -> tuple[float, float]:
    """The seconds that ``code`` takes in a new Python process, the start of Python included, and those it prints."""
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
    return perf_counter() - begun, float(done.stdout.splitlines()[-1])


def first_answer(source: str, method: str) -> dict[str, Any]:
    """The seconds to a first answer, everything included. The answer is the state one time scale after the start.

    The result has three times: "cold" in a process for which nothing has been compiled, "disk" in one that finds
    compiled code on disk, and "process" at a second call in that process.
    """
    code = _START + (_METHOD % method if method in METHODS else _COMPILED) + _TWICE
    with tempfile.TemporaryDirectory() as cache:
        # heyoka also caches compiled code on disk
        kept = {"NUMBA_CACHE_DIR": cache, "HEYOKA_CACHE_DIR": cache}
        cold, _ = _python(code, source, **kept)
        warm, again = _python(code, source, **kept)
    return {"cold": cold, "disk": warm, "process": again}
