"""Curves and divisors for benchmarks, measurement of times, and the C compiler."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import time
from collections.abc import Callable, Mapping
from math import inf
from pathlib import Path
from random import Random
from typing import Any

from jacobian import ArgumentError, Divisor, HyperellipticCurve, poly

LARGE_PRIME = 2**255 - 19


def c_library(source: str, target: Path, *flags: str) -> ctypes.CDLL | None:
    """The library ``target``, compiled from a file of benchmarks/c unless it exists; None without a compiler."""
    compiler = shutil.which("cc")
    if compiler is None:
        return None
    if not target.exists():
        path = Path(__file__).parent / "c" / source
        options = ("-O3", "-march=native", "-shared", "-fPIC", *flags)
        subprocess.run([compiler, *options, str(path), "-o", str(target), "-lm"], check=True)
    return ctypes.CDLL(str(target))


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
    """The class of g random points: a generic divisor that is quick to make for any genus."""
    divisor: Divisor = C.jacobian().from_points([C.random_point(rng) for _ in range(C.genus)])
    return divisor


def microseconds(action: Callable[[], object], repeat: int) -> float:
    """The least over ``repeat`` samples of the time of one call, each sample of a few milliseconds."""
    return least({"": action}, repeat)[""]


def least(
    actions: Mapping[str, Callable[[], object]], repeat: int, clock: Callable[[], float] = time.perf_counter
) -> dict[str, float]:
    """Microseconds of a call of each action: the least of ``repeat`` samples of a few milliseconds, taken in turn."""

    def of_many(action: Callable[[], object]) -> tuple[Callable[[], object], int]:
        action()
        begun = clock()
        action()
        count = max(1, int(0.003 / max(clock() - begun, 1e-7)))
        return (lambda: [action() for _ in range(count)]), count

    many = {name: of_many(action) for name, action in actions.items()}
    found = in_turn({name: sample for name, (sample, _) in many.items()}, repeat, clock)
    return {name: 1e6 * found[name] / count for name, (_, count) in many.items()}


def least_seconds(action: Callable[[], object], repeats: int, clock: Callable[[], float] = time.process_time) -> float:
    """The least time of ``repeats`` calls, by the processor's clock or another ``clock``."""
    return in_turn({"": action}, repeats, clock)[""]


def in_turn(
    actions: Mapping[str, Callable[[], object]], repeats: int, clock: Callable[[], float] = time.process_time
) -> dict[str, float]:
    """The least time of ``repeats`` calls of each action, called in turn, so that a slow second disturbs all alike."""
    best = dict.fromkeys(actions, inf)
    for _ in range(repeats):
        for name, action in actions.items():
            begun = clock()
            action()
            best[name] = min(best[name], clock() - begun)
    return best
