"""Batches of genus 2 and 3 compared with genus 2 in C and python-flint's Cantor: nanoseconds for an addition or a
doubling.

Each row is one prime, operation and number N of rows. "kernel" is the compiled loop alone on one thread. "C" is the
loop of benchmarks/c/genus2_batch.c on the same words, compiled here with cc -O3 -march=native; the results are
compared. "array" is the operator on a DivisorArray on one thread, and "threads" the factor by which all threads speed
it up. "memory" is the largest amount that the operator allocates, in units of the result's array. The last rows are for
other curves: models of degree 6, primes of two words, GF(2^n) without tables, genus 3 (explicit on degree 7, Cantor on
degree 8), tables. "random" is ``J.random(rng, size=N)``, "single" is ``J.random(rng)``.
"""

from __future__ import annotations

import ctypes
import tempfile
import tracemalloc
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.curves import c_library, genuine_curve, least_seconds, microseconds, sum_of_points
from jacobian import GF
from jacobian.addition.cantor_flint import FlintCantor
from jacobian.batch import DivisorArray, set_threads, threads
from jacobian.batch.block_loops import SCRATCH
from jacobian.batch.random_rows import sampler
from jacobian.numbers.words import Double

PRIMES = {"2^29-3": 2**29 - 3, "2^31-1": 2**31 - 1, "2^49-81": 2**49 - 81, "2^61-1": 2**61 - 1, "2^63-25": 2**63 - 25}
OTHERS = {
    "2^61-1": (GF(2**61 - 1), 2, "ramified"),
    "2^31-1, split": (GF(2**31 - 1), 2, "split"),
    "2^61-1, split": (GF(2**61 - 1), 2, "split"),
    "2^89-1": (GF(2**89 - 1), 2, "ramified"),
    "2^127-1": (GF(2**127 - 1), 2, "ramified"),
    "2^127-1, split": (GF(2**127 - 1), 2, "split"),
    "2^128-159": (GF(2**128 - 159), 2, "ramified"),
    "2^29-3, genus 3": (GF(2**29 - 3), 3, "ramified"),
    "2^31-1, genus 3": (GF(2**31 - 1), 3, "ramified"),
    "GF(2^61)": (GF(2, 61, (1, 1, 1, 0, 0, 1, *[0] * 55, 1)), 2, "ramified"),
    "GF(2^89)": (GF(2, 89, (1, 0, 0, 1, 0, 1, 1, *[0] * 82, 1)), 2, "ramified"),
    "GF(2^127)": (GF(2, 127, (1, 1, *[0] * 125, 1)), 2, "ramified"),
    "2^61-1, genus 3": (GF(2**61 - 1), 3, "ramified"),
    "2^63-25, genus 3": (GF(2**63 - 25), 3, "ramified"),
    "2^89-1, genus 3": (GF(2**89 - 1), 3, "ramified"),
    "2^127-1, genus 3": (GF(2**127 - 1), 3, "ramified"),
    "2^61-1, genus 3, split": (GF(2**61 - 1), 3, "split"),
    "GF(3^5)": (GF(3, 5, (1, 2, 0, 0, 0, 1)), 2, "ramified"),
    "GF(2^8)": (GF(2, 8, (1, 0, 1, 1, 1, 0, 0, 0, 1)), 2, "ramified"),
}


def random_rows(C: Any, count: int, seed: int) -> DivisorArray:
    """``count`` sums 2(D + E) + F of classes from a pool: generic divisors, two of which are equal only by chance."""
    rng = Random(seed)
    pool = DivisorArray.stack([sum_of_points(C, rng) for _ in range(64)])
    draw = np.random.default_rng(seed)
    first, second = draw.integers(64, size=(2, count))
    scattered = pool[first] + pool[second]
    return scattered.double() + pool[draw.integers(64, size=count)]


class Compiled:
    """The compiled C program for one context; ``call`` is None without a compiler."""

    def __init__(self, K: Any, C: Any, directory: str) -> None:
        self.call: Any = None
        floats = isinstance(K, Double)
        bits, wide, number = (53, False, ctypes.c_double) if floats else (K.bits, K.wide, ctypes.c_int64)
        target = Path(directory) / f"{type(K).__name__}.so"
        library = c_library("genus2_batch.c", target, f"-DBITS={bits}", f"-DWIDE={int(wide)}")
        if library is None:
            return
        function = library.genus2_rows
        function.restype = ctypes.c_int64
        context, equation = (number * len(K))(*K), (number * 3)(*C)
        self.call = lambda count, *arrays: function(
            context, equation, ctypes.c_int64(count), *(ctypes.c_void_p(array.ctypes.data) for array in arrays)
        )


def run(smoke: bool) -> list[dict[str, object]]:
    """Additions and doublings for each prime, N = 10³ … 10⁶, then the other kinds of rows."""
    sizes = (1024,) if smoke else (1024, 10_000, 100_000, 1_000_000)
    rows: list[dict[str, object]] = []
    processors = threads()
    with tempfile.TemporaryDirectory() as directory:
        for name, p in list(PRIMES.items())[:: 4 if smoke else 1]:
            C = genuine_curve(GF(p), 2, "ramified", Random(name))
            for count in sizes:
                A, B = random_rows(C, count, 1), random_rows(C, count, 2)
                for operation in ("A + B", "2·A"):
                    rows.append({"p": name, "operation": operation, "N": count})
                    rows[-1].update(_measured(A, B, operation, directory, processors, smoke))
    for name, (K, genus, model) in OTHERS.items():
        if smoke and name != "2^61-1, genus 3":
            continue
        C = genuine_curve(K, genus, model, Random(name))
        count = 1024 if smoke else 100_000
        A, B = random_rows(C, count, 1), random_rows(C, count, 2)
        rows.append(
            {"p": name, "operation": "A + B", "N": count, **_on_arrays(lambda A=A, B=B: A + B, A, processors, smoke)}
        )
        rows[-1]["flint"] = _flint(A, B)
        if not sampler(A._engine).possible:
            # in characteristic 2 the points of a long field are not computed in arrays
            continue
        rows.append({"p": name, "operation": "random", "N": count})
        rows[-1] |= _on_arrays(partial(A.jacobian.random, Random(1), size=count), A, processors, smoke)
        rows[-1] |= {"single": 1e3 * microseconds(partial(A.jacobian.random, Random(1)), 3), "flint": rows[-2]["flint"]}
    return rows


def _measured(
    A: DivisorArray, B: DivisorArray, operation: str, directory: str, processors: int, smoke: bool
) -> dict[str, object]:
    run, x, y = A._engine, A._rows, B._rows if operation == "A + B" else A._rows
    count = len(A)
    repeat = 3 if smoke else max(5, 4_000_000 // count)
    rows, out = np.empty(count, np.int64), run.empty(count)
    first, second = (x.data, x.degree), (y.data, y.degree)
    if operation == "A + B":
        action: Callable[[], object] = lambda: A + B  # noqa: E731
        arrays, loop = (first, second), run._sums.add_rows
    else:
        action = A.double
        arrays, loop = (first,), run._sums.double_rows
    room = rows, np.zeros(SCRATCH, run.dtype)
    ours = lambda: loop(*run._constants, *arrays, out.data, (0, count), room)  # noqa: E731
    found: dict[str, object] = {"kernel": 1e9 * least_seconds(ours, repeat, perf_counter) / count}
    special = rows[: int(ours())]
    program = Compiled(run.K, run.formulas, directory)
    if program.call is None:
        found.update({"C": None, "kernel/C": "no C compiler"})
    else:
        theirs = np.empty_like(out.data)
        seconds = least_seconds(lambda: program.call(count, x.data, y.data, theirs), repeat, perf_counter)
        differ = np.flatnonzero((theirs != out.data).any(axis=0))
        if set(differ) - set(special):
            raise AssertionError(f"{A.jacobian!r}: the C program differs in row {differ[0]}")
        found.update({"C": 1e9 * seconds / count, "kernel/C": found["kernel"] / (1e9 * seconds / count)})  # type: ignore[operator]
    found.update(_on_arrays(action, A, processors, smoke))
    found["flint"] = _flint(A, B if operation == "A + B" else A)
    return found


def _on_arrays(action: Callable[[], Any], A: DivisorArray, processors: int, smoke: bool) -> dict[str, object]:
    """The columns of an operator on arrays: nanoseconds a row on one thread, gain from all processors, memory."""
    repeat = 3 if smoke else max(5, 4_000_000 // len(A))
    try:
        set_threads(1)
        one = least_seconds(action, repeat, perf_counter)
        set_threads(None)
        all_ = least_seconds(action, repeat, perf_counter)
        tracemalloc.start()
        result = action()
        memory = tracemalloc.get_traced_memory()[1] / sum(array.nbytes for array in result._rows)
    finally:
        tracemalloc.stop()
        set_threads(None)
    return {"array": 1e9 * one / len(A), f"{processors} threads": one / all_, "memory": memory}


def _flint(A: DivisorArray, B: DivisorArray) -> float:
    """The nanoseconds that Cantor's algorithm on python-flint takes for one addition."""
    D, E = ((F.u, F.v, F.n) for F in (A[0], B[0]))
    add = FlintCantor(A.jacobian.curve).sum_of
    return 1e3 * microseconds(lambda: add(D, E), 3)
