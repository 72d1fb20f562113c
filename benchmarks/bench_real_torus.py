"""Motions of genus 1 and 2 at distant times: a fresh flow with 101 times up to T = 1000 or with the one time 10⁶, many
points of one flow, and points by additions in long numbers.

Times are processor times, the least of several runs in turn with heyoka's. heyoka's integrator is built once, with the
constants as parameters; a run resets its state and time. The unit of time is |q| where |q| > 1, as for the earth's
geodesic, else 1. Errors are against the states by additions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks.curves import in_turn, least_seconds
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.henon_heiles import HenonHeiles
from integrable.classical.lagrange import LagrangeTop
from integrable.classical.neumann import Neumann
from integrable.classical.spherical_pendulum import SphericalPendulum
from integrable.classical.toda import TodaLattice
from integrable.classical.veselova import Veselova
from integrable.mumford.flow import Point
from integrable.oracles.methods import METHODS
from integrable.scene.classical import ClassicalSystem
from jacobian import RR

MOTIONS: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Neumann on S²": (Neumann((1, 2, 4)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Toda, three particles": (TodaLattice(3), (0, 0.5, -0.25), (1, -0.75, -0.25)),
    "Veselova's body": (Veselova((1, 2, 3)), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "Garnier, two axes": (Garnier((0, 1)), (0.3, 0.5), (0.2, -0.4)),
    "geodesic, a = 1, 2, 4": (Ellipsoid((1, 2, 4)), (1, 0, 0), (0, 0.6, 0.8)),
    "geodesic on the earth, km": (
        Ellipsoid((40681077.7, 40680197.6, 40408308.7)),
        (0, 0, 40408308.7**0.5),
        (0.6, 0.8, 0),
    ),
}
GENUS_1: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Lagrange's top": (LagrangeTop(0.7), (0.48, 0.6, 0.64), (0.384, 1.28, -1.488)),
    "spherical pendulum": (SphericalPendulum(), (0.6, 0, -0.8), (0.1, 0.9, 0.075)),
}
# integrators stop where q is infinite
PAST_INFINITY: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...]]] = {
    "Hénon–Heiles, over the saddle": (HenonHeiles((2.625,), -0.5, -0.25), (0.1, 0.05), (0, 0.1)),
}
TOLERANCE = 1e-15


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system."""
    return [_row(name, *motion, 1000 if smoke else 100_000, 1 if smoke else 9)
            for name, motion in (MOTIONS | GENUS_1 | PAST_INFINITY).items()]  # fmt: skip


def _row(name: str, system: Any, q: Any, p: Any, count: int, repeats: int) -> dict[str, object]:
    unit = max(1.0, float(np.linalg.norm(q)))
    times, far = np.linspace(0, 1000 * unit, 101), unit * np.linspace(0, 1e6, count)
    flow = system.flow(system.state(q, p))
    path, few = flow.at(far), by_additions(flow, far[-3:])

    def fresh(wanted: Any) -> Callable[[], Any]:
        # make a new system, since the previous one has cached results
        return lambda: (lambda made: made.flow(made.state(q, p)).at(wanted))(system.over(RR))

    runs, heyoka, peer = {"many": fresh(times), "one": fresh(far[-1:])}, METHODS["heyoka"], ClassicalSystem(system)
    if heyoka.takes(peer) and name not in PAST_INFINITY:
        run = heyoka.prepare(peer, peer.state(q, p), TOLERANCE)
        runs["heyoka"] = lambda: run(times.tolist())
    found = in_turn(runs, repeats)
    many, theirs = found["many"], found.get("heyoka")
    return {
        "system": name,
        "101 times to 1000, ms": 1e3 * many,
        "÷ heyoka": many / theirs if theirs else None,
        "one at 10⁶, ms": 1e3 * found["one"],
        "a point thereafter, µs": 1e6 * least_seconds(lambda: flow.at(far), min(repeats, 3)) / count,
        "by additions, ms": 1e3 * least_seconds(lambda: by_additions(flow, far[-3:]), min(repeats, 3)) / 3,
        "error": max(float(np.abs(x[-3:] - y).max() / np.abs(y).max()) for x, y in ((path.q, few.q), (path.p, few.p))),
    }


def by_additions(flow: Any, times: Any) -> Point:
    """q and p at times by additions in long numbers, whatever method the flow would choose."""
    rows = [flow._row(place) for place in flow._places([float(t) for t in times])]
    q, p = (np.array([[float(x) for x in row[i]] for row in rows]) for i in (0, 1))
    return Point(q, p)
