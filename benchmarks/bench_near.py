"""Motions up to T = 1000: a fresh system, state and flow with 101 outputs, compared with heyoka, built once, and with
additions.

``ms`` is the least time of several runs. ``÷ heyoka`` is its ratio to the time of heyoka at tolerance 1e-15, which runs
in turn with ours; columns with 1e-12 are for our flow at that tolerance. The code of short runs is compiled before.
Errors are the largest differences of q and p at T = 50 and 100 from the states by additions, relative to the largest
component there. The unit of time is |q| where |q| > 1, as for the earth's geodesic, else 1.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.bench_real_torus import MOTIONS, by_additions
from benchmarks.bench_short import problem
from benchmarks.curves import in_turn, least_seconds
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.motion.near import kind_in
from integrable.oracles.methods import METHODS
from integrable.scene.classical import ClassicalSystem
from integrable.series.steps import FINE, MIDDLE, PLAIN, WIDE

BESIDE: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Neumann on S³": (Neumann((1, 2, 4, 7)), (0.5, 0.5, 0.5, 0.5), (0.3, -0.4, 0.2, -0.1)),
    "Toda, eight particles": (TodaLattice(8), (0, 0.5, -0.25, 0, 0.5, 0, 0, 0.25), (1, -1, 0.5, -0.5, 0, 0, 0.25, 0)),
    "Hénon and Heiles, 1:6": (HenonHeiles.with_frequencies(1, 1.25), (0.05, 0.03), (0, 0.01)),
    "Lagrange's top": (LagrangeTop(0.7), (0.48, 0.6, 0.64), (0.3, 0.1, 1.5)),
    "spherical pendulum": (SphericalPendulum(), (0.6, 0, -0.8), (0.4, 0.5, 0.3)),
}
LENGTHS = (1, 10, 100, 1000)
BODIES = ("chaplygin", "tilted_ball", "euler_top", "thin_ball")
DEFORMED = ("check", "hat", "tilde", "tilde_poles", "gyroscopic")
TOLERANCE, LOOSE = 1e-15, 1e-12
Row = dict[str, object]


def run(smoke: bool) -> list[Row]:
    """A row for each system, the median and the worst of their ratios, and rows of bodies and deformations."""
    lengths, few = ((1,), 1) if smoke else (LENGTHS, None)
    rows = [_classical(name, *motion, lengths) for name, motion in list((MOTIONS | BESIDE).items())[:few]]
    ratios = [name for name, ratio in rows[0].items() if name.endswith("÷ heyoka") and ratio is not None]
    summary: list[Row] = [
        {"system": word, **{name: what([float(str(row[name])) for row in rows]) for name in ratios}}
        for word, what in (("median", median), ("worst", max))
    ]
    scenes = (*((scene, lengths) for scene in BODIES[:few]), *((scene, lengths[:3]) for scene in DEFORMED[:few]))
    return [*rows, *summary, *(_of_scene(*scene) for scene in scenes)]


def _classical(name: str, system: Any, q: Any, p: Any, lengths: tuple[int, ...]) -> Row:
    for orders in (WIDE, FINE.orders, MIDDLE, PLAIN):
        system._kind.walk(orders)
    state, peer, arguments = system.state(q, p), ClassicalSystem(system), system.arguments
    unit = max(1.0, float(np.linalg.norm(q)))

    def fresh() -> tuple[Any, Any]:
        made = type(system)(**arguments)
        return made, made.state(state.q, state.p)

    row: Row = {"system": name} | _beside(fresh, peer, peer.state(q, p), unit, lengths)
    few, flow = [50 * unit, 100 * unit], system.flow(state)
    path, far = flow.at(few), by_additions(flow, few)
    gaps = (np.abs(x - y).max() / np.abs(y).max() for x, y in ((path.q, far.q), (path.p, far.p)))
    seconds = least_seconds(lambda: by_additions(system.flow(state), few), 2)
    return row | {"additions, two points, ms": 1e3 * seconds, "error": float(max(gaps))}


def _of_scene(scene: str, lengths: tuple[int, ...]) -> Row:
    """The row of a scene."""
    system, state = problem(scene)
    arguments, given = system.arguments, {"tilted": True} if state.tilted else {}
    for orders in (WIDE, FINE.orders):
        kind_in(system, True, state.tilted).walk(orders)

    def fresh() -> tuple[Any, Any]:
        made = type(system)(**arguments)
        return made, made.state(*state.vectors, **given)

    return {"system": scene} | _beside(fresh, system, state, 1.0, lengths)


def _beside(
    fresh: Callable[[], tuple[Any, Any]], peer: Any, start: Any, unit: float, lengths: tuple[int, ...]
) -> dict[str, object]:
    """The columns for each length; columns of heyoka are included where heyoka is installed."""
    heyoka, row = METHODS["heyoka"], dict[str, object]()
    theirs = heyoka.prepare(peer, start, TOLERANCE) if heyoka.takes(peer) else None
    for length in lengths:
        times = (unit * np.linspace(0, length, 101)).tolist()

        def ours(times: list[float] = times) -> Any:
            made, state = fresh()
            return (
                made.motion_through(state).at(times) if hasattr(made, "motion_through") else made.flow(state).at(times)
            )

        def loosely(times: list[float] = times) -> Any:
            made, state = fresh()
            return made.flow(state, tolerance=LOOSE).at(times)

        classical = isinstance(peer, ClassicalSystem)
        runs: dict[str, Callable[[], Any]] = {"ours": ours} | ({"loosely": loosely} if classical else {})
        runs |= {"heyoka": lambda: theirs(times)} if theirs else {}  # noqa: B023
        found = in_turn(runs, 60 if length < 100 else 7, perf_counter)
        row[f"T = {length}, ms"] = 1e3 * found["ours"]
        row[f"{length}: ÷ heyoka"] = found["ours"] / found["heyoka"] if theirs else None
        if classical:
            row[f"{length}, 1e-12: ÷ heyoka"] = found["loosely"] / found["heyoka"] if theirs else None
    return row
