"""Start-up times in seconds, each the least of several runs in a fresh interpreter.

"processor" is the processor time, which other processes disturb less; "above Python" is the same less the start
of Python itself. The first compilation runs with an empty cache.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time

from jacobian.addition.choice import READY

ADDITION = """
from jacobian import GF, HyperellipticCurve
J = HyperellipticCurve(GF(2**61 - 1), [1, 2, 0, 0, 0, 1]).jacobian()
D = J.from_points([(0, 1), (1, 2)])
"""
COMPILED = f"{ADDITION}\nJ.compile()\nD + D"
ORDER = "from jacobian import GF, HyperellipticCurve\nHyperellipticCurve(GF({}), [7, 2, 0, 3, 0, 1]).jacobian().order()"
STARTS = {
    "Python itself": "pass",
    "import jacobian": "import jacobian",
    "and one addition": f"{ADDITION}\nD + D",
    "and one compiled addition, from the cache": COMPILED,
    "import numba": "import numba",
    **{f"the order of a group at p = {p}": ORDER.format(p) for p in (10007, 100003, 1000003)},
}


def run(smoke: bool) -> list[dict[str, object]]:
    """One row for each start; the last ones, with an empty cache, are left out of a smoke run."""
    subprocess.run([sys.executable, "-c", COMPILED], check=True)
    repeat = 1 if smoke else 15
    python = seconds(STARTS["Python itself"], repeat)[1]
    starts = [(name, code, repeat, None) for name, code in list(STARTS.items())[: 4 if smoke else None]]
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as empty:
        if not smoke:
            additions = f"{ADDITION}\nE = D\nfor _ in range({READY}): D, E = D + E, D"
            starts.append((f"{READY} additions before the change", additions, 3, None))
            starts.append(("and one compiled addition, compiled now", COMPILED, 1, {"NUMBA_CACHE_DIR": empty}))
        for name, code, times, environment in starts:
            wall, processor = seconds(code, times, environment)
            rows.append({"start": name, "s": wall, "processor": processor, "above Python": processor - python})
    return rows


def seconds(code: str, repeat: int, environment: dict[str, str] | None = None) -> tuple[float, float]:
    """The least seconds of several runs of the code, by the clock and by the processor."""
    walls, processors = [], []
    for _ in range(repeat):
        begun, before = time.perf_counter(), os.times()
        subprocess.run([sys.executable, "-c", code], check=True, env={**os.environ, **(environment or {})})
        after = os.times()
        walls.append(time.perf_counter() - begun)
        processors.append(after.children_user + after.children_system - before.children_user - before.children_system)
    return min(walls), min(processors)
