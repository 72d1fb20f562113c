"""Exact operations on floats for compiled code. Importing this module imports numba."""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

__all__ = ["COMPILED", "INLINED", "split", "two_product", "two_sum", "whole_steps"]

# division by zero gives inf, which callers test for; fused operations are off, because two_sum and two_product would be
# inexact with them
COMPILED = {"nogil": True, "error_model": "numpy"}
INLINED = {"error_model": "numpy"}


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
    """(n, rest) with time = n·step + rest and 0 ≤ rest < step. The product n·step is computed without rounding."""
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
