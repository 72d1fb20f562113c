"""Systems near their start beside heyoka built once: a fresh system, state and flow with 101 outputs, ÷ heyoka.

heyoka: constants as ``par``, state and time reset, ``propagate_grid``, tolerance 1e-15. The least of repeats in turns.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median
from typing import Any

import numpy as np

from benchmarks.bench_real_torus import MOTIONS
from benchmarks.bench_series import BESIDE
from benchmarks.bench_short import problem
from integrable.deformations.equations import kind_in
from integrable.extras import installed
from integrable.oracles.methods import METHODS
from integrable.scene.classical import ClassicalSystem
from integrable.series.steps import MIDDLE, PLAIN, WIDE

LENGTHS = (1, 10, 100, 1000)
DEFORMED = ("check", "hat", "tilde", "tilde_poles", "gyroscopic")
TOLERANCE, LOOSE = 1e-15, 1e-12


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system, the median and the worst of these, and of deformations; none without heyoka, the extra
    ``peers``.
    """
    if not installed("heyoka"):
        return []
    motions = list((MOTIONS | BESIDE).items())[: 1 if smoke else None]
    rows = [_row(name, *motion, (1,) if smoke else LENGTHS) for name, motion in motions]
    deformed = [_deformed(name, (1,) if smoke else LENGTHS[:-1]) for name in DEFORMED[: 1 if smoke else None]]
    names = [name for name in rows[0] if name != "system"]
    for word, what in (("median", median), ("worst", max)):
        rows.append(
            {"system": word, **{name: what([float(str(row[name])) for row in rows[: len(motions)]]) for name in names}}
        )
    return [*rows, *deformed]


def _deformed(scene: str, lengths: tuple[int, ...]) -> dict[str, object]:
    """A deformation of a scene."""
    system, state = problem(scene)
    kind_in(system, True).walk(WIDE, compiles=True)
    heyoka = METHODS["heyoka"].prepare(system, state, TOLERANCE)
    row: dict[str, object] = {"system": scene}
    for length in lengths:
        times = np.linspace(0, length, 101)

        def ours(times: np.ndarray = times) -> Any:
            made = type(system)(**system.arguments)
            return made.motion_through(made.state(state.gamma, state.M)).at(times)

        found = _least([lambda: heyoka(times), ours], 20)  # noqa: B023
        row[f"T = {length}"] = round(found[1] / found[0], 2)
    return row


def _row(name: str, system: Any, q: Any, p: Any, lengths: tuple[int, ...]) -> dict[str, object]:
    for orders in (WIDE, MIDDLE, PLAIN):
        system._kind.walk(orders, compiles=True)
    state, arguments, kind = system.state(q, p), system.arguments, type(system)
    unit, peer = max(1.0, float(np.linalg.norm(q))), ClassicalSystem(system)
    heyoka = METHODS["heyoka"].prepare(peer, peer.state(q, p), TOLERANCE)
    row: dict[str, object] = {"system": name}
    for length in lengths:
        times = np.linspace(0, unit * length, 101)

        def ours(tolerance: float | None = None, times: np.ndarray = times) -> Any:
            made = kind(**arguments)
            return made.flow(made.state(state.q, state.p), tolerance=tolerance).at(times)

        found = _least([lambda: heyoka(times), ours, lambda: ours(LOOSE)], 60 if length < 100 else 7)  # noqa: B023
        row[f"T = {length}"] = round(found[1] / found[0], 2)
        row[f"T = {length}, tolerance 1e-12"] = round(found[2] / found[0], 2)
    return row


def _least(functions: list[Callable[[], Any]], repeats: int) -> list[float]:
    """The least seconds of each, in turns."""
    found = [np.inf] * len(functions)
    for _ in range(repeats):
        for i, each in enumerate(functions):
            begin = time.perf_counter()
            each()
            found[i] = min(found[i], time.perf_counter() - begin)
    return found
