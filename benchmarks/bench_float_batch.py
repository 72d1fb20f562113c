"""Batches in floats: one divisor added to N others, states of one ball or complex, compared with a bare loop in C.

ns are processor time of all threads, the least of several runs; "residual" is the largest of |f − V² mod U| over the
size of its terms, after the addition. The rows "1 thread" and "2 threads" have the elapsed time, and the processor time
of the busiest thread, which other programs disturb less.
"""

from __future__ import annotations

import ctypes
import shutil
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from random import Random
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.curves import c_library, in_turn, least_seconds
from integrable import ChaplyginBall
from jacobian import CC, RR, HyperellipticCurve, poly
from jacobian.batch import DivisorArray, set_threads
from jacobian.batch.sums import FloatSums

REPEATS = 25
SINGLE = 997
# f of degree 6, with coefficients of moderate size
COMPLEX = (0.5 + 1j, -1.0, 0.25j, 1 - 1j, 0.5, 1 + 0.5j, 0.75 - 0.25j)


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows: ns an addition for N divisors, by our compiler and by the C compiler; the residuals; two threads."""
    sizes = (1000,) if smoke else (10**3, 10**4, 10**5, 10**6)
    repeats = 1 if smoke else REPEATS
    found = []
    kinds: dict[str, Callable[[], DivisorArray]] = {
        "ball": _states,
        "complex, degree 5": partial(_random_divisors, CC, COMPLEX[:-1]),
        "complex, degree 6": partial(_random_divisors, CC, COMPLEX),
        "real, degree 6": partial(_random_divisors, RR, (3.0, 1.0, -2.0, 0.5, 1.0, -0.25, 1.0)),
    }
    for kind, make in list(kinds.items())[: 2 if smoke else None]:
        few = make()
        for size in sizes:
            found += [{"divisors": kind, **row} for row in _rows(few, size, repeats)]
        found += [{"divisors": kind, **row} for row in _threads(few, sizes[-1], repeats)]
    return found


def _states() -> DivisorArray:
    """The divisor of a step, and the divisors of states of one motion, three steps apart."""
    from integrable.moving_point.compiled import LIBRARY

    ball = ChaplyginBall((1, 2, 3), 0.7)
    setup = ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488))).setup
    problem, step = setup.floats, tuple(map(float, setup.translations.level(0)[1]))
    point = problem.start
    found = [step[:4]]
    for _ in range(997):
        point = LIBRARY.march(problem.f, problem.axes, point, step, 3)
        found.append(point[:4])
    rows = np.array(found)
    u = np.hstack([rows[:, :2], np.ones((len(rows), 1))])
    return DivisorArray.from_arrays(HyperellipticCurve(RR, problem.f).jacobian(), u, rows[:, 2:])


def _random_divisors(field: Any, f: tuple[complex, ...]) -> DivisorArray:
    curve, rng, points = HyperellipticCurve(field, f), Random(1), []
    while len(points) < 1996:
        x = field.random(rng)
        y2 = poly.evaluate(field, curve.f, x)
        if field == CC or y2 > 0.1:
            points.append((x, field.sqrt(y2)))
    J = curve.jacobian()
    return DivisorArray.stack([J.from_points(points[i : i + 2]) for i in range(0, len(points), 2)])


def _rows(few: DivisorArray, size: int, repeats: int) -> list[dict[str, object]]:
    curve = few.jacobian.curve
    f = np.array([*curve.f, *[0.0] * 7][: 6 if curve.field is RR and len(curve.f) == 6 else 7])
    E, A = few[0], few[np.resize(np.arange(1, len(few)), size)]
    first, second = _columns(A), _columns(DivisorArray.stack([E]))
    sums = FloatSums(curve)
    out, doubtful = sums.add(first, second)
    D = A[:SINGLE].to_list()
    single = _columns(DivisorArray.stack([a + E for a in D]))
    alone = least_seconds(lambda: [a + E for a in D], 1) / len(D)
    with tempfile.TemporaryDirectory() as folder:
        loop = _compiled(Path(folder), f, first, second)
        loops: dict[str, Callable[[], Any]] = {
            "A + E of a DivisorArray": lambda: A + E,
            "its kernel": lambda: sums.add(first, second)[0],
            "A.double()": A.double,
        }
        if loop is not None:
            loops["C"] = loop
            good = ~doubtful
            if not np.allclose(loop()[:, good], out[:, good], rtol=1e-9, atol=1e-9):
                raise AssertionError("the loop in C and the compiled one differ")
        seconds = in_turn(loops, repeats)
        rows: list[dict[str, object]] = [
            {"N": size, "loop": name, "ns": 1e9 * seconds[name] / size, "residual": residual(f, _columns(work()))}
            for name, work in loops.items()
        ]
    rows[0]["doubtful rows"] = int(doubtful.sum())
    if "C" in seconds:
        for row in rows[:2]:
            row["times C"] = seconds[str(row["loop"])] / seconds["C"]
    elif shutil.which("cc") is None:
        rows.append({"N": size, "loop": "C: no compiler here"})
    return [*rows, {"N": size, "loop": "single additions", "ns": 1e9 * alone, "residual": residual(f, single)}]


def _threads(few: DivisorArray, size: int, repeats: int) -> list[dict[str, object]]:
    E, A = few[0], few[np.resize(np.arange(1, len(few)), size)]
    elapsed, busiest = {1: float("inf"), 2: float("inf")}, {1: float("inf"), 2: float("inf")}
    for _ in range(repeats):
        for count in elapsed:
            set_threads(count)
            before, begun = _processor_seconds(), perf_counter()
            A + E
            elapsed[count] = min(elapsed[count], perf_counter() - begun)
            used = [seconds - before.get(thread, 0) for thread, seconds in _processor_seconds().items()]
            busiest[count] = min(busiest[count], max(used, default=float("inf")))
    set_threads(None)
    return [
        {
            "N": size,
            "loop": f"A + E, {count} thread{'s' * (count > 1)}",
            "ns": 1e9 * elapsed[count] / size,
            "busiest thread": 1e9 * busiest[count] / size if busiest[count] < float("inf") else None,
        }
        for count in elapsed
    ]


def _processor_seconds() -> dict[str, float]:
    """The seconds of processor time of every thread of this process, by its path under /proc (Linux only)."""
    return {str(path): int(path.read_text().split()[0]) / 1e9 for path in Path("/proc/self/task").glob("*/schedstat")}


def _compiled(folder: Path, f: Any, first: Any, second: Any) -> Callable[[], Any] | None:
    # there is no C loop for real numbers and degree 6
    if len(f) == 7 and first.dtype == np.float64:
        return None
    source = "complex_batch.c" if first.dtype == np.complex128 else "float_batch.c"
    library = c_library(source, folder / "batch.so", "-ffp-contract=fast", "-fcx-limited-range")
    if library is None:
        return None
    add = library.add_columns
    coefficients = f.astype(first.dtype)

    def loop() -> Any:
        out = np.empty(first.shape, first.dtype)
        arrays = (coefficients, first, second, out)
        add(*(ctypes.c_void_p(x.ctypes.data) for x in arrays), ctypes.c_long(first.shape[1]))
        return out

    return loop


def _columns(found: Any) -> Any:
    """The arrays u₀, u₁, v₀ and v₁ of the divisors of degree 2."""
    if not isinstance(found, DivisorArray):
        return found
    found = found[found.status == 0]
    found = found[found.degree == 2]
    return np.ascontiguousarray(np.vstack([found.u[:, :2].T, found.v.T]))


def residual(f: Any, columns: Any) -> float:
    """The largest |f − V² mod U| over all divisors, relative to the size of the terms of the division."""
    u0, u1, v0, v1 = columns
    ones = np.ones_like(u0)
    rest = [f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, *(c * ones for c in f[3:])]
    size = [abs(f[0]) + abs(v0 * v0), abs(f[1]) + 2 * abs(v0 * v1), abs(f[2]) + abs(v1 * v1)]
    size += [abs(c * ones) for c in f[3:]]
    for k in range(len(f) - 1, 1, -1):
        rest[k - 1], rest[k - 2] = rest[k - 1] - u1 * rest[k], rest[k - 2] - u0 * rest[k]
        size[k - 1], size[k - 2] = size[k - 1] + abs(u1) * size[k], size[k - 2] + abs(u0) * size[k]
    return float(max((abs(rest[0]) / size[0]).max(), (abs(rest[1]) / size[1]).max()))
