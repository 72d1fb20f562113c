"""Ensembles of K = 10 … 10⁵ random balls compared with heyoka's ensembles of batches, on one thread and on two.

The balls have different moments in 1 … 3 and different d in 0 … 1, and |M| = 2; states are computed at 101 times from 0
to T. ``ms`` is the wall time per member, with the set-up of the members and without compilation; ``processor ms`` is
the processor time of all threads. ``error`` is the largest difference of γ and M/|M| of the first 20 members from their
motions by the compiled kernel. ``memory`` is the growth of the process in MB; chunks of 64 MB are requested. heyoka
runs batches of the processor's SIMD width at tolerance 1e-15 on as many threads, compiled before (``pip install
'jacobian-integrable[peers]'``). The benchmark takes two minutes on an idle machine.

The last rows are of systems of any genus: 1,000 starts of Neumann's point on S², and of three particles of Toda's
lattice, up to T = 100. Times are processor times on one thread. ``÷ one by one`` compares our default with heyoka,
built once, at tolerance 1e-15. ``÷ batches`` compares our tolerance 1e-12 with heyoka's batch mode at the same
tolerance.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from benchmarks.curves import in_turn
from integrable import ChaplyginBall, ensemble
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.ensembles.ensemble import Ensemble
from integrable.extras import installed
from integrable.oracles.body import body_equations
from integrable.oracles.heyoka_taylor import equations
from integrable.oracles.method import problem_of
from integrable.oracles.methods import METHODS
from integrable.scene.classical import ClassicalSystem
from jacobian.numbers.threads import set_threads

OUTPUTS = 101
CASES = (
    (10, 10.0),
    (10, 100.0),
    (10, 1e3),
    (100, 1e5),
    (1000, 10.0),
    (1000, 100.0),
    (1000, 1e3),
    (10**4, 100.0),
    (10**5, 10.0),
)
LONGEST_PEER = 1e3
# number of members whose results heyoka's ensembles keep in memory at a time
AT_A_TIME = 10_000
COMPARED = 20
TOLERANCE, LOOSE = 1e-15, 1e-12
SYSTEMS = {"Neumann on S²": (Neumann((1, 2, 4)), True), "Toda, three particles": (TodaLattice(3), False)}


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows (K, T, threads, then ms, error and memory of ours and of heyoka's)."""
    rows: list[dict[str, object]] = []
    warm(smoke)
    for count, until in CASES[:1] if smoke else CASES:
        many, times = members(count), np.linspace(0, until, 3 if smoke else OUTPUTS)
        wanted = truth(many, times)
        for threads in (1,) if smoke else (1, 2):
            row = ours(many, times, threads, wanted)
            if installed("heyoka") and until <= LONGEST_PEER and not smoke:
                row |= heyoka(many, times, threads, wanted)
            rows.append(row)
    set_threads(1)
    rows += [of_system(name, *case, smoke) for name, case in SYSTEMS.items()]
    set_threads(None)
    return rows


def of_system(name: str, system: Any, tangent: bool, smoke: bool) -> dict[str, object]:
    """The row of a system of any genus; ``tangent`` says that q lies on the unit sphere and p is tangent to it."""
    count, times = 4 if smoke else 1000, np.linspace(0, 100, OUTPUTS)
    q, p = np.random.default_rng(1).normal(size=(2, count, system.size)) / 2
    if tangent:
        q /= np.linalg.norm(q, axis=1)[:, None]
        p -= (p * q).sum(axis=1)[:, None] * q
    many, loose = ensemble(system, q, p), ensemble(system, q, p, tolerance=LOOSE)
    runs: dict[str, Callable[[], Any]] = {"ours": lambda: many.at(times), "loosely": lambda: loose.at(times)}
    if installed("heyoka"):
        peer, theirs = ClassicalSystem(system), METHODS["heyoka"]
        each = [
            theirs.prepare(peer, peer.state(*start), TOLERANCE) for start in zip(q.tolist(), p.tolist(), strict=True)
        ]
        runs |= {"each": lambda: [run(times.tolist()) for run in each], "batches": in_batches(peer, q, p, times)}
    found = in_turn(runs, 1 if smoke else 4, process_time)
    row: dict[str, object] = {"system": name, "K": count, "T": 100, "processor ms": 1e3 * found["ours"] / count}
    if "each" in found:
        row |= {"÷ one by one": found["ours"] / found["each"], "÷ batches": found["loosely"] / found["batches"]}
    return row


def in_batches(peer: Any, q: np.ndarray, p: np.ndarray, times: np.ndarray) -> Callable[[], Any]:
    """A function that runs heyoka's batch mode from all starts, with an integrator built before the first run."""
    import heyoka as hy

    width, starts = hy.recommended_simd_size(), np.hstack([q, p])
    problem = problem_of(peer, peer.state(q[0].tolist(), p[0].tolist()))
    constants = np.array(problem.kind.coefficients_of(problem.system.constants, float))
    parameters = np.repeat(constants[:, None], width, axis=1)
    first = np.repeat(starts[0][:, None], width, axis=1)
    batch = hy.taylor_adaptive_batch(equations(problem.kind), first, tol=LOOSE, pars=parameters)
    order = np.resize(np.arange(len(q)), -(-len(q) // width) * width)

    def begun_with(integrator: Any, i: int) -> Any:
        integrator.set_time(0.0)
        integrator.state[:] = starts[order[i * width : (i + 1) * width]].T
        return integrator

    return lambda: hy.ensemble_propagate_grid_batch(batch, times, len(order) // width, begun_with, max_workers=1)


def warm(smoke: bool) -> None:
    """Loads compiled code."""
    members(2).at([1.0])
    if not smoke:
        members(1).flow(0).system.flow(members(1).flow(0).state, "compiled").at([1.0])


def members(count: int) -> Ensemble:
    """An ensemble of ``count`` random balls."""
    rng = np.random.default_rng(1)
    gamma, M = rng.normal(size=(2, count, 3))
    gamma /= np.linalg.norm(gamma, axis=1)[:, None]
    M -= (M * gamma).sum(axis=1)[:, None] * gamma
    M *= 2 / np.linalg.norm(M, axis=1)[:, None]
    ball = ChaplyginBall((1, 2, 3), 0.7)
    return ensemble(ball, gamma, M, inertia=rng.uniform(1, 3, (count, 3)), d=rng.uniform(0, 1, count))


def truth(many: Ensemble, times: np.ndarray) -> np.ndarray:
    """γ and M/|M| of the first members, shape (K, N, 6)."""
    found = []
    for k in range(min(len(many), COMPARED)):
        flow = many.flow(k)
        one = flow.system.flow(flow.state, "compiled").at(times)  # type: ignore[attr-defined]
        found.append(np.hstack([one.gamma, one.M / 2]))
    return np.array(found)


def error(gamma: np.ndarray, M: np.ndarray, wanted: np.ndarray) -> float:
    """The largest difference of γ and M/|M| from the reference values."""
    count = len(wanted)
    return float(abs(np.concatenate([gamma[:count], M[:count] / 2], axis=2) - wanted).max())


def ours(many: Ensemble, times: np.ndarray, threads: int, wanted: np.ndarray) -> dict[str, object]:
    """The row of our own ensemble, without heyoka's columns. Large results are computed in chunks."""
    set_threads(threads)
    before, begun, ways, off = resident(), clocks(), Counter[str](), 0.0
    peak = before
    for i, part in enumerate(many.chunks(times)):
        ways.update(part.ways)
        peak = max(peak, resident())
        off = error(part.gamma, part.M, wanted) if i == 0 else off
    wall, processor = spent_since(begun, len(many))
    said = ", ".join(f"{way} {n}" for way, n in ways.most_common())
    return {
        "K": len(many), "T": times[-1], "threads": threads, "ms": wall, "processor ms": processor, "error": off,
        "memory": (peak - before) / 1e6, "ways": said,
    }  # fmt: skip


def heyoka(many: Ensemble, times: np.ndarray, threads: int, wanted: np.ndarray) -> dict[str, object]:
    """The columns of heyoka in a row."""
    import heyoka as hy

    width = hy.recommended_simd_size()
    variables = hy.make_vars("x1", "x2", "x3", "m1", "m2", "m3")
    rates = body_equations([hy.par[0], hy.par[1], hy.par[2]], hy.par[3])(variables)
    equations = list(zip(variables, rates, strict=True))
    start = np.zeros((6, width)) + np.array([[1.0], [0], [0], [0], [1], [0]])
    batch = hy.taylor_adaptive_batch(equations, start, tol=TOLERANCE, pars=np.ones((4, width)))
    before, begun, off, grown = resident(), clocks(), 0.0, 0
    for first in range(0, len(many), AT_A_TIME):
        part = many.members[first : first + AT_A_TIME]
        # the last batch is filled up with the first members
        order = np.resize(np.arange(len(part)), -(-len(part) // width) * width)

        def begun_with(integrator: Any, i: int, part: Any = part, order: Any = order) -> Any:
            which = part[order[i * width : (i + 1) * width]]
            integrator.set_time(0.0)
            integrator.state[:], integrator.pars[:] = which[:, 4:].T, which[:, :4].T
            return integrator

        found = hy.ensemble_propagate_grid_batch(batch, times, len(order) // width, begun_with, max_workers=threads)
        rows = np.concatenate([np.moveaxis(one[-1], 2, 0) for one in found])[: len(part)]
        grown = max(grown, resident() - before)
        off = error(rows[:, :, :3], rows[:, :, 3:], wanted) if first == 0 else off
    wall, processor = spent_since(begun, len(many))
    return {
        "heyoka's ms": wall, "processor ms of it": processor, "its error": off, "its memory": grown / 1e6,
        "batches of": width,
    }  # fmt: skip


def clocks() -> tuple[float, float]:
    """The time of the wall clock and that of the processors."""
    return perf_counter(), process_time()


def spent_since(begun: tuple[float, float], count: int) -> tuple[float, float]:
    """Milliseconds for a member by both clocks, since they showed ``begun``."""
    wall, processor = (1e3 * (now - then) / count for now, then in zip(clocks(), begun, strict=True))
    return wall, processor


def resident() -> int:
    """The bytes of memory that this process occupies now; 0 where the system does not report it."""
    try:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0
