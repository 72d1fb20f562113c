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

__all__ = ["by_sign", "divided", "follow"]

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
    if not step > 0:
        raise ArgumentError(f"step = {step}: give a positive step")

    def reach(sign: int, distances: np.ndarray) -> tuple[list[Any], int]:
        y, memory, done, evaluations, rows = first, None, 0, 0, []
        for count, rest in (divided(distance, step) for distance in distances.tolist()):
            while done < count:
                y, memory, work = advance(y, sign * step, memory)
                done += 1
                evaluations += work
            rows.append(y)
            if rest:
                rows[-1], _, work = advance(y, sign * rest, None)
                evaluations += work
        return rows, evaluations

    kind = float if all(isinstance(x, float) for x in (*first, step)) else object
    return by_sign(np.array(first, dtype=kind), np.array(wanted, dtype=kind), reach)


def divided(distance: Any, step: Any) -> tuple[int, Any]:
    """(whole steps, rest) of a distance > 0. Floats are divided exactly."""
    if isinstance(step, float):
        count, left = divmod(Fraction(distance), Fraction(step))
        return count, float(left)
    count = floor(distance / step)
    return count, distance - count * step


def by_sign(start: np.ndarray, wanted: np.ndarray, reach: Callable[[int, np.ndarray], tuple[Any, int]]) -> Solution:
    """γ and M at ``wanted``, times of any order and sign; at time 0 they are ``start``. The arrays are of float64,
    or of objects if ``start`` is.

    ``reach(sign, distances)`` is called once per sign. It returns the rows at ascending positive distances from 0, and
    the number of evaluations.
    """
    kind = object if start.dtype == object else np.float64
    rows, half, work = np.empty((len(wanted), len(start)), dtype=kind), len(start) // 2, 0
    if len(wanted) and wanted[0] >= 0 and (wanted[1:] >= wanted[:-1]).all():  # ascending times ≥ 0, the usual case
        first = int(np.searchsorted(wanted, 0.0, "right"))
        rows[:first] = start
        if first < len(wanted):
            rows[first:], work = reach(1, wanted[first:])
        return Solution(rows[:, :half], rows[:, half:], work)
    for sign in (1, -1):
        chosen = np.flatnonzero(sign * wanted > 0)
        if len(chosen):
            chosen = chosen[np.argsort(np.abs(wanted[chosen]), kind="stable")]
            rows[chosen], cost = reach(sign, np.abs(wanted[chosen]))
            work += cost
    rows[wanted == 0] = start
    return Solution(rows[:, :half], rows[:, half:], work)
