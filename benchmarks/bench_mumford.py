"""Motions on Jacobians of genus 1 to 8. By additions: set-up, points near t = 1 and 10⁶, the error at 10⁶. By the
method that the flow chooses: the state at 10⁶ of a fresh system, and further states at random times up to 10⁶.

Neumann's system on S^n (genus n) with a = 1, 2, …, n + 1, the Toda lattice of n + 1 particles, Garnier's system with n
axes 1, 2, 4, 5, 7, … and geodesics on ellipsoids with n + 1 axes, in floats. Errors at 10⁶ are against 40 digits from
the same floats; times are processor times, the least of several. "÷ ball" is the time of a fresh state divided by that
of a ball, made in turn.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np

from benchmarks.bench_real_torus import by_additions
from benchmarks.curves import in_turn, least_seconds
from integrable import ChaplyginBall
from integrable.classical.ellipsoid import Ellipsoid
from integrable.classical.garnier import Garnier
from integrable.classical.neumann import Neumann
from integrable.classical.toda import TodaLattice
from integrable.mumford.flow import MumfordFlow
from jacobian import MP

GENERA = (1, 2, 3, 4, 5, 8)
# numbers of times in a call, and of repetitions
COUNTS = {1: 50, 100: 5, 1000: 3}


def run(smoke: bool) -> list[dict[str, object]]:
    """A row for each system and genus."""
    rows = [(make, genus) for make in (_neumann, _toda) for genus in (GENERA[:2] if smoke else GENERA)]
    rows += [(make, genus) for make in (_garnier, _geodesic) for genus in (3, *([] if smoke else [4, 5]))]
    return [_row(make, genus, 1 if smoke else 20) for make, genus in rows]


def _neumann(genus: int, *field: Any) -> Any:
    return Neumann(range(1, genus + 2), *field)


def _toda(genus: int, *field: Any) -> Any:
    return TodaLattice(genus + 1, *field)


def _garnier(genus: int, *field: Any) -> Any:
    return Garnier([1 + 3 * n // 2 for n in range(genus)], 1, 1, *field)


def _geodesic(genus: int, *field: Any) -> Any:
    return Ellipsoid([n * n + 2 for n in range(genus + 1)], *field)


def _start(make: Callable[..., Any], genus: int) -> tuple[np.ndarray, np.ndarray]:
    rng, size = Random(genus), make(genus).size
    q, p = (np.array([rng.uniform(-1, 1) for _ in range(size)]) for _ in range(2))
    if make in (_neumann, _geodesic):
        a = np.array(make(genus).constants) if make is _geodesic else np.ones(size)
        q /= np.sqrt(q @ (q / a))
        p -= q / a * (q / a @ p) / (q / a @ (q / a))
    return (q / 2, p / 2) if make is _garnier else (q, p)


def _row(make: Callable[..., Any], genus: int, repeats: int) -> dict[str, object]:
    system, (q, p) = make(genus), _start(make, genus)
    state = system.state(q, p)
    start = time.process_time()
    flow = system.flow(state)
    by_additions(flow, [1e6])
    near = time.process_time() - start
    K = MP(40)
    fine = make(genus, K)
    truth = MumfordFlow(fine, fine._inside(K, state)).at([1e6])
    return {
        "system": type(system).__name__,
        "genus": genus,
        "set-up and one point, ms": 1e3 * near,
        "a point near, ms": 1e3 * least_seconds(lambda: by_additions(flow, [1.25]), repeats),
        "a point at 1e6, ms": 1e3 * least_seconds(lambda: by_additions(flow, [1e6 + 0.25]), repeats),
        **_chosen(make, genus, repeats),
        "error at 1e6": float(np.abs(by_additions(flow, [1e6]).q - truth.q.astype(float)).max()),
        "bits beyond floats": flow._motion._extra,
    }


def _chosen(make: Callable[..., Any], genus: int, repeats: int) -> dict[str, object]:
    """The columns of states by the method that the flow chooses."""
    q, p = _start(make, genus)

    def fresh() -> Any:
        system = make(genus)
        return system.flow(system.state(q, p)).at([1e6])

    def ball() -> Any:
        body = ChaplyginBall((1, 2, 3), 0.7)
        return body.flow(body.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).at([1e6])

    first = in_turn({"fresh": fresh, "ball": ball}, min(repeats, 7))
    flow, rng = make(genus).flow(make(genus).state(q, p)), np.random.default_rng(1)
    times = {count: rng.uniform(9e5, 1e6, count) for count in COUNTS}
    again = {
        f"of {n}, µs": 1e6 * least_seconds(lambda t=t: flow.at(t), COUNTS[n] if repeats > 1 else 1) / n
        for n, t in times.items()
    }
    return {"way": fresh().way, "first, ms": 1e3 * first["fresh"], "÷ ball": first["fresh"] / first["ball"], **again}
