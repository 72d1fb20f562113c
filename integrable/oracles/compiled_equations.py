"""The ball's equations and exact float operations for the compiled comparators. Importing it imports numba."""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import register_jitable

from integrable.oracles.reference import is_body
from jacobian.errors import ArgumentError

__all__ = ["COMPILED", "INLINED", "ball_constants", "slopes", "split", "two_product", "two_sum", "whole_steps"]

# a division by zero gives inf, which the callers see; no contraction here: two_sum and two_product are exact as written
COMPILED = {"nogil": True, "error_model": "numpy"}
INLINED = {"error_model": "numpy"}


def ball_constants(system: Any) -> np.ndarray:
    """(a_1, a_2, a_3, I_1a_1, I_2a_2, I_3a_3, d) as float64: what :func:`slopes` needs of a body.

    ArgumentError for a system that is no body.
    """
    if not is_body(system):
        raise ArgumentError(f"{system!r}: only the ball's and the top's equations are compiled")
    moments, d = [float(x) for x in system.inertia], float(system.d)
    a = [1 / (x + d) for x in moments]
    return np.array([*a, *(x * y for x, y in zip(moments, a, strict=True)), d])


@register_jitable(fastmath={"contract"}, **INLINED)
def slopes(c, y, out):  # type: ignore[no-untyped-def]  # numba infers the types
    """ẏ for the columns of y, shape (6, n), into ``out``."""
    for k in range(y.shape[1]):
        x1, x2, x3, m1, m2, m3 = y[0, k], y[1, k], y[2, k], y[3, k], y[4, k], y[5, k]
        w1, w2, w3 = c[0] * m1, c[1] * m2, c[2] * m3
        spin = c[6] * (x1 * w1 + x2 * w2 + x3 * w3) / (c[3] * x1 * x1 + c[4] * x2 * x2 + c[5] * x3 * x3)
        w1 += spin * c[0] * x1
        w2 += spin * c[1] * x2
        w3 += spin * c[2] * x3
        out[0, k] = x2 * w3 - x3 * w2
        out[1, k] = x3 * w1 - x1 * w3
        out[2, k] = x1 * w2 - x2 * w1
        out[3, k] = m2 * w3 - m3 * w2
        out[4, k] = m3 * w1 - m1 * w3
        out[5, k] = m1 * w2 - m2 * w1


@register_jitable(**INLINED)
def two_sum(a, b):  # type: ignore[no-untyped-def]
    """(s, e) with s = fl(a + b) and s + e = a + b (Knuth 1969)."""
    s = a + b
    part = s - a
    return s, (a - (s - part)) + (b - part)


@register_jitable(**INLINED)
def split(a):  # type: ignore[no-untyped-def]
    """(high, low) with 26 bits each and high + low = a (Veltkamp 1968)."""
    c = 134217729.0 * a
    high = c - (c - a)
    return high, a - high


@register_jitable(**INLINED)
def two_product(a, b):  # type: ignore[no-untyped-def]
    """(p, e) with p = fl(ab) and p + e = ab (Dekker 1971)."""
    p = a * b
    a1, a0 = split(a)
    b1, b0 = split(b)
    return p, ((a1 * b1 - p) + a1 * b0 + a0 * b1) + a0 * b0


@register_jitable(**INLINED)
def whole_steps(time, step):  # type: ignore[no-untyped-def]
    """(n, rest) with time = n·step + rest, 0 ≤ rest < step, the product taken exactly."""
    count = np.floor(time / step)
    product, error = two_product(count, step)
    rest = (time - product) - error
    if rest < 0:
        count -= 1
        product, error = two_product(count, step)
        rest = (time - product) - error
    elif rest >= step:
        count += 1
        rest -= step
    return count, rest
