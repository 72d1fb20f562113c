"""Curves and classes to measure on, and the clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from math import inf
from random import Random
from statistics import median
from typing import Any

from jacobian import ArgumentError, Divisor, HyperellipticCurve, poly

LARGE_PRIME = 2**255 - 19


def genuine_curve(K: Any, genus: int, model: str, rng: Random) -> HyperellipticCurve:
    """A random curve with this genus and model over a finite field: monic f, h = 0 (in characteristic 2 any h)."""
    while True:
        even = K.characteristic == 2
        f = poly.random(K, 2 * genus + (1 if model == "ramified" else 2), rng, monic=True)
        h = poly.random(K, genus + (1 if model == "ramified" else 2), rng) if even else ()
        try:
            C = HyperellipticCurve(K, f, h)
        except ArgumentError:
            continue
        if C.genus == genus and C.model == model:
            return C


def sum_of_points(C: HyperellipticCurve, rng: Random) -> Divisor:
    """The class of g random points: of full weight, generic, and quick to make for any genus."""
    divisor: Divisor = C.jacobian().from_points([C.random_point(rng) for _ in range(C.genus)])
    return divisor


def microseconds(action: Callable[[], object], repeat: int) -> float:
    """The median over ``repeat`` samples of the time of one call, each sample of at least a few milliseconds."""
    action()
    begun = time.perf_counter()
    action()
    calls = max(1, int(0.004 / max(time.perf_counter() - begun, 1e-9)))
    samples = []
    for _ in range(repeat):
        begun = time.perf_counter()
        for _ in range(calls):
            action()
        samples.append((time.perf_counter() - begun) / calls)
    return 1e6 * median(samples)


def least_seconds(action: Callable[[], object], repeats: int, clock: Callable[[], float] = time.process_time) -> float:
    """The least time of ``repeats`` calls: of the processor, or by another clock."""
    return in_turn({"": action}, repeats, clock)[""]


def in_turn(
    actions: Mapping[str, Callable[[], object]], repeats: int, clock: Callable[[], float] = time.process_time
) -> dict[str, float]:
    """The least time of ``repeats`` calls of each, called in turn, so that a slow second disturbs all alike."""
    best = dict.fromkeys(actions, inf)
    for _ in range(repeats):
        for name, action in actions.items():
            begun = clock()
            action()
            best[name] = min(best[name], clock() - begun)
    return best
