"""Helpers that give states at times of any order and sign: for integrators that need ascending times, and for fixed
steps in plain Python.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from math import floor
from typing import Any

import numpy as np

from integrable.oracles.body import Solution
from jacobian.errors import ArgumentError

__all__ = ["by_sign", "follow", "split_times"]

Advance = Callable[[list[Any], Any, Any], tuple[list[Any], Any, int]]
"""(y, h, memory) ↦ (y after a step h, memory, evaluations). The memory speeds up the next step of the same h; None
stands for an empty memory.
"""


def follow(advance: Advance, start: Iterable[Any], times: Iterable[Any], step: Any) -> Solution:
    """γ and M, or q and p, at ``times``, by steps of length ``step`` from time 0, forwards and backwards.

    A time that is not a multiple of the step is reached by an extra, shorter step from the last multiple. So the
    error at a time does not depend on the other times. The arrays are of float64 for floats, and of mpf otherwise.
    """
    first, wanted = list(start), list(times)
    rows: list[list[Any]] = [first] * len(wanted)
    evaluations = 0
    for sign in (1, -1):
        y, memory, done = first, None, 0
        for i, count, rest in split_times(wanted, step, sign):
            while done < count:
                y, memory, work = advance(y, sign * step, memory)
                done += 1
                evaluations += work
            rows[i] = y
            if rest:
                rows[i], _, work = advance(y, sign * rest, None)
                evaluations += work
    kind = np.float64 if all(isinstance(x, float) for row in rows for x in row) else object
    table = np.array(rows, dtype=kind).reshape(len(rows), len(first))
    half = len(first) // 2
    return Solution(table[:, :half], table[:, half:], evaluations)


def split_times(times: list[Any], step: Any, sign: int) -> list[tuple[int, int, Any]]:
    """(index, whole steps, rest) of each time of one sign, sorted by size. Floats are divided exactly.

    Raises ArgumentError unless the step is positive.
    """
    if not step > 0:
        raise ArgumentError(f"step = {step}: give a positive step")
    found = []
    for i, time in enumerate(times):
        if not sign * time > 0:
            continue
        if isinstance(step, float):
            count, rest = divmod(abs(Fraction(time)), Fraction(step))
            found.append((i, count, float(rest)))
        else:
            count = floor(abs(time) / step)
            found.append((i, count, abs(time) - count * step))
    return sorted(found, key=lambda entry: entry[1:])


def by_sign(
    start: np.ndarray, wanted: np.ndarray, reach: Callable[[float, np.ndarray], tuple[np.ndarray, int]]
) -> Solution:
    """γ and M in float64 at ``wanted``, times of any order and sign; at time 0 they are ``start``.

    ``reach(sign, distances)`` is called once per sign. It returns the rows at ascending positive distances from 0, and
    the number of evaluations.
    """
    rows, half, work = np.empty((len(wanted), len(start))), len(start) // 2, 0
    if len(wanted) and wanted[0] >= 0 and (wanted[1:] >= wanted[:-1]).all():  # ascending times ≥ 0, the usual case
        first = int(np.searchsorted(wanted, 0.0, "right"))
        rows[:first] = start
        if first < len(wanted):
            rows[first:], work = reach(1.0, wanted[first:])
        return Solution(rows[:, :half], rows[:, half:], work)
    for sign in (1.0, -1.0):
        chosen = np.flatnonzero(sign * wanted > 0)
        if len(chosen):
            chosen = chosen[np.argsort(np.abs(wanted[chosen]), kind="stable")]
            rows[chosen], cost = reach(sign, np.abs(wanted[chosen]))
            work += cost
    rows[wanted == 0] = start
    return Solution(rows[:, :half], rows[:, half:], work)
