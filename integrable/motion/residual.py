"""The distance of a moving point from its curve after many successive additions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from integrable.moving_point import addition
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import entries, shown, whole
from jacobian.numbers.compiler import interpreted

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# from this many additions on, the compiled loop is faster even if it must be compiled first
COMPILE_FROM = 100_000
# the largest number of additions, which take a minute in compiled code
MOST_COUNT = 100_000_000


def residual_growth(setup: Setup, counts: Iterable[int], kernel: str) -> list[tuple[int, Real]]:
    """The pairs (n, residual) for each n in ``counts``, after n additions of one basic step
    (:attr:`Setup.step_length`).
    """
    wanted = f"a sequence of ints ≥ 0, {MOST_COUNT} at most,"
    given = entries(counts, "counts", wanted)
    counts = [
        whole(n, f"counts = {shown(given)}: counts[{i}]", f"{wanted} is needed", 0, MOST_COUNT)
        for i, n in enumerate(given)
    ]
    compiled = kernel == "compiled" or (kernel == "auto" and max(counts, default=0) >= COMPILE_FROM)
    march: Any = addition.march
    floats = setup.body.field is RR
    problem, step = setup.problem, setup.reals.elements(setup.wide, setup.translations.level(0)[1])
    if floats:
        problem, step = setup.floats, tuple(map(float, step))
    if compiled and floats and not interpreted():
        from integrable.moving_point import compiled as loops

        march = loops.LIBRARY.march
    f, axes, point = problem.f, problem.axes, problem.start
    rows, done = [], 0
    for count in sorted(counts):
        point = march(f, axes, point, step, count - done)
        done = count
        rows.append((count, residual(f, point)))
    return rows


def residual(f: Sequence[Real], point: Sequence[Real]) -> Real:
    """The distance |f − V² mod U| of a moving point from its curve, relative to the largest coefficient of f."""
    u0, u1, v0, v1 = point[:4]
    rest = [f[0] - v0 * v0, f[1] - 2 * v0 * v1, f[2] - v1 * v1, f[3], f[4], f[5]]
    for k in range(5, 1, -1):
        rest[k - 1] -= u1 * rest[k]
        rest[k - 2] -= u0 * rest[k]
    return max(abs(rest[0]), abs(rest[1])) / max(abs(c) for c in f)
