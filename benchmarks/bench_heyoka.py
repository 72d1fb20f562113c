"""heyoka as a comparator of the report, and heyoka as its own users run it (``benchmarks/outside_heyoka.py``).

Times in µs are those of a start and its evaluation at 101 times up to T, in turn in one process. ``ours/outside`` must
be at most 1.3. One side has the equations of the package, the other equations written by hand. ``compact/default`` is
the time of evaluation in heyoka's ``compact_mode`` over that in its default mode; the seconds of building either
without a cache are listed too.
"""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np

from integrable.extras import installed
from integrable.oracles.heyoka_taylor import equations
from integrable.oracles.method import Spent
from integrable.oracles.methods import METHODS
from integrable.scene.doubles import in_doubles
from integrable.scene.file import load_scene
from integrable.study.rivals import at_times, method_once
from integrable.study.timing import Timed, interleaved

COMPACT = ("garnier",)
"""Scenes without equations written by hand, for which only the modes are compared."""


def run(smoke: bool) -> list[dict[str, Any]]:
    """Rows (scene, T, outside µs, ours µs, ours/outside, compact/default, build s, compact build s)."""
    if not installed("heyoka"):
        return []
    from benchmarks import outside_heyoka as outside

    rows = []
    for name in [*outside.CASES, *COMPACT][: 1 if smoke else None]:
        case = outside.CASES[name]() if name in outside.CASES else None
        scene = in_doubles(load_scene(name))
        problem, _ = method_once(scene, METHODS["heyoka"], outside.TOLERANCE)
        built = {mode: _built(problem, outside.TOLERANCE, mode) for mode in (False, True)}
        for T in outside.HORIZONS[: 1 if smoke else None]:
            times = outside.grid(T)
            runs = {"ours": method_once(at_times(scene, times), METHODS["heyoka"], outside.TOLERANCE)[1]}
            runs |= {f"compact {mode}": _modes(one, problem, times) for mode, (one, _) in built.items()}
            if case is not None:
                runs["outside"] = _outside(outside.once, case, times)
            found = {what: timing.total for what, timing in interleaved(runs, 50, 3.0).items()}
            theirs = found.get("outside")
            rows.append({
                "scene": name,
                "T": T,
                "outside µs": theirs and 1e6 * theirs,
                "ours µs": 1e6 * found["ours"],
                "ours/outside": theirs and found["ours"] / theirs,
                "compact/default": found["compact True"] / found["compact False"],
                "build s": built[False][1],
                "compact build s": built[True][1],
            })  # fmt: skip
    return rows


def _outside(once: Callable[..., tuple[float, float]], case: Any, times: list[float]) -> Callable[[], Timed]:
    def timed() -> Timed:
        seconds, last = once(case, times)
        return Spent(0.0, 0.0, 0.0, seconds), last

    return timed


def _built(problem: Any, tolerance: float, compact: bool) -> tuple[Any, float]:
    """An integrator of a problem with its parameters, and the seconds that building it took."""
    import heyoka

    heyoka.llvm_state.clear_memcache()
    heyoka.llvm_state.set_diskcache_enabled(False)
    begun = perf_counter()
    integrator = heyoka.taylor_adaptive(
        equations(problem.kind), np.zeros(problem.kind.size), tol=tolerance, compact_mode=compact
    )
    seconds = perf_counter() - begun
    integrator.pars[:] = problem.kind.coefficients_of(problem.system.constants)
    return integrator, seconds


def _modes(integrator: Any, problem: Any, times: list[float]) -> Callable[[], Timed]:
    start = np.array([float(x) for x in problem.start])

    def timed() -> Timed:
        begun = perf_counter()
        integrator.time = 0.0
        integrator.state[:] = start
        found = integrator.propagate_grid(times)[-1]
        return Spent(0.0, 0.0, 0.0, perf_counter() - begun), found

    return timed
