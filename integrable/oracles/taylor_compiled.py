"""Taylor series in compiled floats, with variable steps (Jorba & Zou 2005) and compensated sums.

The recurrences for a kind's equations are written by :func:`integrable.oracles.generated.expansion`. A time inside a
step costs one evaluation of the step's polynomials.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from integrable.oracles.compiler import njit
from integrable.oracles.exact_floats import COMPILED, INLINED, two_sum

__all__ = ["convolved", "exponential", "quotient", "root", "taylor"]


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def convolved(s, x, y, k):  # type: ignore[no-untyped-def]
    """Coefficient k of the product of the series in rows x and y."""
    total = 0.0
    for j in range(k + 1):
        total += s[x, j] * s[y, k - j]
    return total


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def quotient(s, top, y, n, k):  # type: ignore[no-untyped-def]
    """Coefficient k of the quotient in row n. The divisor is row y, and ``top`` is coefficient k of the dividend."""
    for j in range(k):
        top -= s[n, j] * s[y, k - j]
    return top / s[y, 0]


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def exponential(s, x, n, k):  # type: ignore[no-untyped-def]
    """Coefficient k of e^x, whose series is row n."""
    if k == 0:
        return np.exp(s[x, 0])
    total = 0.0
    for j in range(1, k + 1):
        total += j * s[x, j] * s[n, k - j]
    return total / k


@register_jitable(fastmath={"contract", "reassoc"}, **INLINED)
def root(s, x, n, k):  # type: ignore[no-untyped-def]
    """Coefficient k of √x, whose series is row n."""
    if k == 0:
        return np.sqrt(s[x, 0])
    total = s[x, k]
    for j in range(1, k):
        total -= s[n, j] * s[n, k - j]
    return total / (2 * s[n, 0])


@register_jitable(**INLINED)
def _reach(series, half, order, tolerance):  # type: ignore[no-untyped-def]
    """The step at which the last two terms are ``tolerance`` times the size of each half of the state; inf at rest."""
    reach = np.inf
    for base in (0, half):
        scale = 0.0
        for n in range(base, base + half):
            scale = max(scale, abs(series[n, 0]))
        for k in (order - 1, order):
            size = 0.0
            for n in range(base, base + half):
                size = max(size, abs(series[n, k]))
            if size > 0:
                reach = min(reach, (tolerance * scale / size) ** (1.0 / k))
    return reach


@register_jitable(**INLINED)
def _increment(series, n, order, h):  # type: ignore[no-untyped-def]
    """The change of component n over a step h: Σ_{k ≥ 1} c_k h^k, where c_k is ``series[n, k]``."""
    value = 0.0
    for k in range(order, 0, -1):
        value = (value + series[n, k]) * h
    return value


ROWS = 0


def expand(c, order, s):  # type: ignore[no-untyped-def]
    """Fills columns 1 … order of the table s from column 0, the state.

    This is a stub: each kind's generated code defines its own ``expand`` and its number of ROWS.
    """
    raise NotImplementedError


# the text below the next line is copied into the generated module of a kind of system, which defines ``expand``
# --- copied into the module of each kind, with its slopes


@njit(**COMPILED)
def taylor(c, start, times, setting, out):  # type: ignore[no-untyped-def]
    """Writes the states at ascending positive ``times``, or at their negatives if the sign in ``setting`` is −1, into
    ``out``; returns the number of expansions.

    Returns −1 where a step is 0 or not a number: at a pole, or where the equations have no value.
    """
    sign, tolerance, order = setting
    size = len(start)
    series, y, rest = np.zeros((ROWS, order + 1)), start.copy(), np.zeros(size)
    now, now_low, t, expansions = 0.0, 0.0, 0, 0
    while t < len(times):
        for n in range(size):
            series[n, 0] = y[n]
        expand(c, order, series)
        expansions += 1
        step = _reach(series, size // 2, order, tolerance)
        if not now + step > now:
            return -1
        while t < len(times) and (times[t] - now) - now_low <= step:
            h = sign * ((times[t] - now) - now_low)
            for n in range(size):
                out[t, n] = y[n] + (rest[n] + _increment(series, n, order, h))
            t += 1
        if t < len(times):
            for n in range(size):
                y[n], rest[n] = two_sum(y[n], rest[n] + _increment(series, n, order, sign * step))
            now, error = two_sum(now, step)
            now_low += error
    return expansions
