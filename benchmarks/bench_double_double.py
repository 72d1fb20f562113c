"""Double-double arithmetic compared with floats and mpf: an operation, an addition of divisors, the first call.

µs are processor time, the least of several runs; "error" is relative, against the same inputs at 60 digits.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from functools import partial
from typing import Any

import numpy as np

from benchmarks.curves import least_seconds
from integrable import ChaplyginBall
from integrable.moving_point import addition
from integrable.moving_point.compiled import LIBRARY, SPECIAL
from jacobian import MP
from jacobian.native.kinds import FLOATS, INT, WIDES
from jacobian.native.library import Library
from jacobian.numbers import double_double

REPEATS = 7


def products(x, y, rounds):  # type: ignore[no-untyped-def]
    """The sum of all products x_i y_i, computed ``rounds`` times, for numbers of any kind."""
    total = 0
    for _ in range(rounds):
        for i in range(len(x)):
            total += x[i] * y[i]
    return float(total)


def quotients(x, y, rounds):  # type: ignore[no-untyped-def]
    """The sum of all quotients x_i/y_i, computed ``rounds`` times, for numbers of any kind."""
    total = 0
    for _ in range(rounds):
        for i in range(len(x)):
            total += x[i] / y[i]
    return float(total)


def march(f, axes, point, step, count, out):  # type: ignore[no-untyped-def]
    """Writes the result of :func:`integrable.moving_point.addition.march` into ``out``."""
    addition.put(addition.march(f, axes, point, step, count), out, 0)


LOOPS = Library(
    "bench_double_double",
    {
        "products": (products, (WIDES, WIDES, INT)),
        "quotients": (quotients, (WIDES, WIDES, INT)),
        "products_of_floats": (products, (FLOATS, FLOATS, INT)),
        "march": (march, (WIDES, WIDES, WIDES, WIDES, INT, WIDES)),
    },
    SPECIAL,
)


def run(smoke: bool) -> list[dict[str, object]]:
    """Rows: µs of an operation and of an addition in float64, double-double and mpf; seconds of a first call."""
    return [*_operations(smoke), *_additions(smoke), *([] if smoke else _first_call())]


def _least(work: Any, count: int, smoke: bool) -> float:
    """The least processor time of ``work`` in µs, divided by the ``count`` of its items."""
    return 1e6 * least_seconds(work, 1 if smoke else REPEATS) / count


def _operations(smoke: bool) -> list[dict[str, object]]:
    """Rows for sums of products and of quotients, of arrays that fit into the first-level cache."""
    size, rounds = 500, 20 if smoke else 2000
    rng = np.random.default_rng(3)
    x, y = rng.uniform(1, 2, (2, size))
    pairs = double_double.pack(x), double_double.pack(y)
    cases = (
        ("x·y + z", "float64", LOOPS.products_of_floats, (x, y)),
        ("x·y + z", "double-double", LOOPS.products, pairs),
        ("x/y + z", "double-double", LOOPS.quotients, pairs),
    )
    return [
        {"what": what, "number": number, "us": _least(partial(loop, *given, rounds), size * rounds, smoke)}
        for what, number, loop, given in cases
    ]


def _additions(smoke: bool) -> list[dict[str, object]]:
    """Rows for the addition of a translation to a moving point with its three pairs."""
    K, count = MP(60), 50 if smoke else 20_000
    ball = ChaplyginBall((1, 2, 3), K.coerce("0.7"), field=K)
    setup = ball.flow(
        ball.state(*(map(K.coerce, v) for v in (("0.48", "0.6", "0.64"), ("0.384", "1.28", "-1.488"))))
    ).setup
    step = setup.reals.elements(setup.wide, setup.translations.level(0)[1])
    problem = setup.problem.f, setup.problem.axes, setup.problem.start, step
    packed = [double_double.pack(x) for x in problem]
    exact = [double_double.unpack(x, K.coerce) for x in packed]
    floats = [tuple(float(c) for c in x) for x in problem]
    true = addition.march(*exact, 1)
    out = np.empty((10, 2))
    LOOPS.march(*packed, 1, out)
    error = max(abs(x - y) / abs(y) for x, y in zip(double_double.unpack(out, K.coerce), true, strict=True))
    from_floats = LIBRARY.march(*floats, 1)
    rounded = addition.march(*[[K.coerce(float(c)) for c in x] for x in floats], 1)
    float_error = max(abs(x - y) / abs(y) for x, y in zip(map(K.coerce, from_floats), rounded, strict=True))
    narrow = MP(32)
    short = [[narrow.coerce(c) for c in x] for x in problem]
    steps = 5 if smoke else 200
    found: list[tuple[str, float, float | None]] = [
        ("float64", _least(lambda: LIBRARY.march(*floats, count), count, smoke), float(float_error)),
        ("double-double", _least(lambda: LOOPS.march(*packed, count, out), count, smoke), float(error)),
        ("mpf, 32 digits, interpreted", _least(lambda: addition.march(*short, steps), steps, smoke), None),
    ]
    return [
        {"what": "an addition with its pairs", "number": name, "us": us, "error": wrong} for name, us, wrong in found
    ]


FIRST_CALL = """
from time import perf_counter
begun = perf_counter()
from integrable import ChaplyginBall; import integrable.torus.compiled
imported = perf_counter()
ball = ChaplyginBall((1, 2, 3), 0.7)
ball.flow(ball.state((0.48, 0.6, 0.64), (0.384, 1.28, -1.488)), kernel="compiled").at_tau([1e4])
print(imported - begun, perf_counter() - imported)
"""


def _first_call() -> list[dict[str, object]]:
    """Rows with the seconds of the first call in a process with an empty cache, and in the next process."""
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
        for what in ("the flow: compiled", "the flow: from the cache on disk"):
            done = subprocess.run(
                [sys.executable, "-c", FIRST_CALL], env=environment, capture_output=True, text=True, check=True
            )
            imported, called = map(float, done.stdout.split())
            rows.append({"what": what, "number": "double-double", "import s": imported, "first call s": called})
    return rows
