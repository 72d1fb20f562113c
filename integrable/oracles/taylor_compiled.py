"""Taylor series of balls and tops in compiled floats: variable step (Jorba & Zou 2005), compensated sums.

The same recurrences as :func:`integrable.oracles.reference.taylor`, which is for any number of digits. Times inside a
step cost one evaluation of its polynomials.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import ceil, log
from typing import Any

import numpy as np
from numba.extending import register_jitable

from integrable.oracles.compiled_equations import COMPILED, INLINED, ball_constants, two_sum
from integrable.oracles.reference import Solution
from integrable.oracles.stepping import by_sign
from jacobian.errors import ArgumentError
from jacobian.numbers.compiler import njit

__all__ = ["compiled_taylor"]


def compiled_taylor(system: Any, state: Any, times: Iterable[float], *, tolerance: float) -> Solution:
    """γ and M at ``times``, any order and sign; a step neglects about ``tolerance`` of γ and of M.

    ``evaluations`` counts expansions; the order is ½ ln(1/tolerance) + 1. ArgumentError unless 0 < tolerance < 1.
    """
    if not 0 < tolerance < 1:
        raise ArgumentError(f"tolerance = {tolerance}: give a number between 0 and 1")
    wanted = np.array([float(t) for t in times])
    constants = ball_constants(system)
    order = max(4, ceil(-log(tolerance) / 2 + 1))
    start = np.array([float(x) for x in (*state.gamma, *state.M)])

    def reach(sign: float, distances: np.ndarray) -> tuple[np.ndarray, int]:
        out = np.empty((len(distances), 6))
        return out, int(_march(constants, start, distances, sign, tolerance, order, out))

    return by_sign(start, wanted, reach)


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def _convolved(x, y, k):  # type: ignore[no-untyped-def]
    """Coefficient k of the product of two series."""
    total = 0.0
    for j in range(k + 1):
        total += x[j] * y[k - j]
    return total


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def _expand(c, y, order, series, spin, below, above):  # type: ignore[no-untyped-def]
    """Coefficients of γ, M (rows 0 to 5 of ``series``) and ω (rows 6 to 8) at y; the other three are for scratch."""
    for n in range(6):
        series[n, 0] = y[n]
    for k in range(order):
        if c[6] != 0:
            top, square = 0.0, 0.0
            for i in range(3):
                top += c[i] * _convolved(series[3 + i], series[i], k)
                square += c[3 + i] * _convolved(series[i], series[i], k)
            above[k], below[k] = top, square
            for j in range(k):
                top -= spin[j] * below[k - j]
            spin[k] = top / below[0]
        for i in range(3):
            turn = series[3 + i, k]
            if c[6] != 0:
                turn += c[6] * _convolved(spin, series[i], k)
            series[6 + i, k] = c[i] * turn
        for base in (0, 3):
            for i in range(3):
                u, v = (i + 1) % 3, (i + 2) % 3
                rate = _convolved(series[base + u], series[6 + v], k) - _convolved(series[base + v], series[6 + u], k)
                series[base + i, k + 1] = rate / (k + 1)


@register_jitable(**INLINED)
def _reach(series, order, tolerance):  # type: ignore[no-untyped-def]
    """The step whose last two terms are ``tolerance`` of γ and of M; inf where nothing moves."""
    reach = np.inf
    for base in (0, 3):
        scale = max(abs(series[base, 0]), abs(series[base + 1, 0]), abs(series[base + 2, 0]))
        for k in (order - 1, order):
            size = max(abs(series[base, k]), abs(series[base + 1, k]), abs(series[base + 2, k]))
            if size > 0:
                reach = min(reach, (tolerance * scale / size) ** (1.0 / k))
    return reach


@register_jitable(**INLINED)
def _increment(series, n, order, h):  # type: ignore[no-untyped-def]
    """Σ_{k ≥ 1} c_k h^k of component n."""
    value = 0.0
    for k in range(order, 0, -1):
        value = (value + series[n, k]) * h
    return value


@njit(**COMPILED)
def _march(c, start, times, sign, tolerance, order, out):  # type: ignore[no-untyped-def]
    """The states at ascending positive times (negative ones for sign −1), into ``out``; the number of expansions."""
    series = np.zeros((9, order + 1))
    spin, below, above = np.zeros(order + 1), np.zeros(order + 1), np.zeros(order + 1)
    y, rest = start.copy(), np.zeros(6)
    now, now_low, t, expansions = 0.0, 0.0, 0, 0
    while t < len(times):
        _expand(c, y, order, series, spin, below, above)
        expansions += 1
        step = _reach(series, order, tolerance)
        while t < len(times) and (times[t] - now) - now_low <= step:
            h = sign * ((times[t] - now) - now_low)
            for n in range(6):
                out[t, n] = y[n] + (rest[n] + _increment(series, n, order, h))
            t += 1
        if t < len(times):
            for n in range(6):
                y[n], rest[n] = two_sum(y[n], rest[n] + _increment(series, n, order, sign * step))
            now, error = two_sum(now, step)
            now_low += error
    return expansions
