"""Loops for random classes: points over many x at once, and Mumford pairs through g points.

Points have their coordinates in words; rows of the group are columns, as in :mod:`jacobian.batch.row_kernels`.
Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from jacobian.batch.genus2_kernels import BLOCK, JIT
from jacobian.numbers import tables_compiled, words_compiled  # noqa: F401  # the compiled operations of words and tables
from jacobian.numbers.compiler import njit
from jacobian.numbers.words import add, canonical, inverse, mul, neg, sub

LANES = 16
"""The number of powers computed in one loop. A product depends only on the one before it in its own lane, so the
processor overlaps the lanes."""


@register_jitable
def power_lanes(K, a, windows, odd, out):  # type: ignore[no-untyped-def]  # compiled, as all below
    """out = a^e lane by lane, from the :func:`jacobian.batch.random_rows.windows` of e; ``odd`` is scratch."""
    for j in range(LANES):
        odd[0, j] = a[j]
        out[j] = mul(K, a[j], a[j])
    for i in range(1, len(odd)):
        for j in range(LANES):
            odd[i, j] = mul(K, odd[i - 1, j], out[j])
    out[:] = K.one
    for digit in windows:
        for j in range(LANES):
            out[j] = mul(K, out[j], out[j])
        if digit:
            for j in range(LANES):
                out[j] = mul(K, out[j], odd[digit >> 1, j])


@register_jitable
def square_root(K, a, power, generator, twos):  # type: ignore[no-untyped-def]
    """A root of a, or 0 where there is none, from power = a^((m − 1)/2), p − 1 = m·2^twos (Tonelli 1891, Shanks 1973).

    ``generator``: of order 2^twos.
    """
    root = canonical(K, mul(K, a, power))
    rest = canonical(K, mul(K, root, power))
    size = twos
    while rest != K.one:
        order, square = 0, rest
        while square != K.one and order < size:
            square = canonical(K, mul(K, square, square))
            order += 1
        if order >= size:
            return 0
        for _ in range(size - order - 1):
            generator = canonical(K, mul(K, generator, generator))
        root = canonical(K, mul(K, root, generator))
        generator = canonical(K, mul(K, generator, generator))
        rest = canonical(K, mul(K, rest, generator))
        size = order
    return root


@njit(**JIT)
def lift(K, f, windows, generator, twos, x, y, second):  # type: ignore[no-untyped-def]
    """Sets y[i] to an ordinate over x[i] on y² = f(x) in GF(p), or to the other one if second[i] is true. Returns a
    mask (N,) of those that exist; a branch point has no second ordinate.
    """
    found = np.zeros(len(x), np.bool_)
    value, power, odd = np.empty(LANES, np.int64), np.empty(LANES, np.int64), np.empty((8, LANES), np.int64)
    for start in range(0, len(x), LANES):
        size = min(LANES, len(x) - start)
        value[:] = 0
        for j in range(size):
            total = f[len(f) - 1]
            for k in range(len(f) - 2, -1, -1):
                total = canonical(K, add(K, canonical(K, mul(K, total, x[start + j])), f[k]))
            value[j] = total
        power_lanes(K, value, windows, odd, power)
        for j in range(size):
            i = start + j
            if value[j] == 0:
                y[i], found[i] = 0, not second[i]
                continue
            root = square_root(K, value[j], power[j], generator, twos)
            y[i], found[i] = -root if second[i] else root, root != 0
    return found


@njit(**JIT)
def through_points(K, g, x, y, out):  # type: ignore[no-untyped-def]
    """Writes the Mumford pairs (u, v) through g points each, from arrays x and y (g, N), by Newton's interpolation with
    one inversion for a block. Returns a mask (N,) of the columns with equal x, whose pairs are undefined.
    """
    count = x.shape[1]
    double = np.zeros(count, np.bool_)
    for i in range(count):
        out[0, i], out[g, i] = neg(K, x[0, i]), y[0, i]
    values, before = np.empty(BLOCK, np.int64), np.empty(BLOCK, np.int64)
    for d in range(1, g):
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            total = K.one
            for j in range(size):
                before[j] = total
                values[j] = _value(K, out, 0, d, start + j, x[d, start + j], K.one)
                if values[j] == 0:
                    double[start + j] = True
                    values[j] = K.one
                total = canonical(K, mul(K, total, values[j]))
            back = inverse(K, total)
            for j in range(size - 1, -1, -1):
                i = start + j
                slope = canonical(K, sub(K, y[d, i], _value(K, out, g, d, i, x[d, i], 0)))
                slope = canonical(K, mul(K, slope, canonical(K, mul(K, back, before[j]))))
                back = canonical(K, mul(K, back, values[j]))
                _join(K, out, g, d, i, x[d, i], slope)
    return double


@register_jitable
def _value(K, rows, at, d, i, x, lead):  # type: ignore[no-untyped-def]
    """lead·x^d + rows[at + d − 1, i]·x^(d−1) + … + rows[at, i]."""
    total = lead
    for k in range(d - 1, -1, -1):
        total = canonical(K, add(K, canonical(K, mul(K, total, x)), rows[at + k, i]))
    return total


@register_jitable
def _join(K, rows, g, d, i, x, slope):  # type: ignore[no-untyped-def]
    """Replaces v by v + slope·u and u, of degree d, by u·(x − x₀)."""
    for k in range(d):
        rows[g + k, i] = canonical(K, add(K, rows[g + k, i], canonical(K, mul(K, slope, rows[k, i]))))
    rows[g + d, i] = slope
    rows[d, i] = canonical(K, sub(K, rows[d - 1, i], x))
    for k in range(d - 1, 0, -1):
        rows[k, i] = canonical(K, sub(K, rows[k - 1, i], canonical(K, mul(K, x, rows[k, i]))))
    rows[0, i] = neg(K, canonical(K, mul(K, x, rows[0, i])))
