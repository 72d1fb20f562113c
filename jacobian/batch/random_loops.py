"""Loops for random classes, to be compiled: points over many x at once, and Mumford pairs through g points.

Points have their coordinates in words; rows of a DivisorArray are columns, as in :mod:`jacobian.batch.row_loops`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from jacobian.batch.block_loops import BLOCK
from jacobian.batch.row_loops import reduced
from jacobian.numbers.words import inverse

CHAINS = 16
"""The number of powers computed in one loop. A product depends only on the one before it in its own chain, so the
processor overlaps the chains."""


class Powers(NamedTuple):
    """The memory in which :func:`powers` works on CHAINS numbers at once: their values and results, (CHAINS,), and
    their odd powers up to 15, (8, CHAINS).
    """

    value: Any
    power: Any
    odd: Any


def powers(K: Any, windows: Any, room: Any) -> None:
    """Sets room.power = room.value^e for CHAINS numbers, from the :func:`jacobian.batch.random_rows.windows` of e."""
    value, power, odd = room
    for j in range(CHAINS):
        odd[0, j] = value[j]
        power[j] = K.dot(value[j], value[j])
    for i in range(1, odd.shape[0]):
        for j in range(CHAINS):
            odd[i, j] = K.dot(odd[i - 1, j], power[j])
    for j in range(CHAINS):
        power[j] = K.one
    for digit in windows:
        for j in range(CHAINS):
            power[j] = K.dot(power[j], power[j])
        if digit > 0:
            for j in range(CHAINS):
                power[j] = K.dot(power[j], odd[digit >> 1, j])


def square_root(K: Any, a: Any, power: Any, generator: Any, twos: Any) -> Any:
    """A square root of ``a`` modulo p, or 0 if there is none (Tonelli 1891, Shanks 1973).

    With p − 1 = m·2^twos, m odd, ``power`` is a^((m − 1)/2), and ``generator`` has order 2^twos.
    """
    root = K.canonical(K.dot(a, power))
    rest = K.canonical(K.dot(root, power))
    size = twos
    while rest != K.one:
        order, square = 0, rest
        while square != K.one and order < size:
            square = K.canonical(K.dot(square, square))
            order += 1
        if order >= size:
            return K.sub(K.one, K.one)
        for _ in range(size - order - 1):
            generator = K.canonical(K.dot(generator, generator))
        root = K.canonical(K.dot(root, generator))
        generator = K.canonical(K.dot(generator, generator))
        rest = K.canonical(K.dot(rest, generator))
        size = order
    return root


def lift(K: Any, f: Any, roots: Any, x: Any, y: Any, second: Any, found: Any, room: Any) -> None:
    """Sets y[i] to a root of y² = f(x[i]) in GF(p), or to the other root if second[i] is 1. found[i] becomes 1, or 0 if
    there is no such root; y = 0 has no other root. ``roots`` is the result of
    :func:`jacobian.batch.random_rows._root_constants`.
    """
    windows, generator, twos = roots
    value = room.value
    for start in range(0, len(x), CHAINS):
        size = min(CHAINS, len(x) - start)
        for j in range(CHAINS):
            value[j] = f[len(f) - 1]
        for j in range(size):
            for k in range(len(f) - 1):
                more = K.canonical(K.dot(value[j], x[start + j]))
                value[j] = K.canonical(K.add(more, f[len(f) - 2 - k]))
        powers(K, windows, room)
        for j in range(size):
            i = start + j
            if value[j] == 0:
                y[i], found[i] = 0, 1 - second[i]
                continue
            root = square_root(K, value[j], room.power[j], generator, twos)
            y[i], found[i] = K.canonical(K.neg(root)) if second[i] > 0 else root, root != 0


class Differences(NamedTuple):
    """The memory of Newton's interpolation: for a block of rows the numbers to be inverted and their products."""

    values: Any
    before: Any


def through_points(K: Any, points: Any, out: Any, double: Any, room: Any) -> None:
    """Writes N Mumford pairs (u, v), each through the g points of a column of x and y (g, N), by Newton's interpolation
    with one inversion for a block. Sets double[i] to 1 for columns with equal x, whose pairs are undefined.
    """
    (x, y), (values, before) = points, room
    g, count = x.shape[0], x.shape[1]
    for i in range(count):
        out[0, i], out[g, i] = K.canonical(K.neg(x[0, i])), y[0, i]
    for d in range(1, g):
        for start in range(0, count, BLOCK):
            size = min(BLOCK, count - start)
            total = K.one
            for j in range(size):
                before[j] = total
                values[j] = value_at(K, out, 0, d, start + j, x[d, start + j], K.one)
                if values[j] == 0:
                    double[start + j] = 1
                    values[j] = K.one
                total = K.canonical(K.dot(total, values[j]))
            back = inverse(K, total)
            for k in range(size):
                j = size - 1 - k
                i = start + j
                slope = K.canonical(K.sub(y[d, i], value_at(K, out, g, d, i, x[d, i], 0)))
                slope = K.canonical(K.dot(slope, K.canonical(K.dot(back, before[j]))))
                back = K.canonical(K.dot(back, values[j]))
                join(K, out, g, d, i, x[d, i], slope)


def value_at(K: Any, rows: Any, at: Any, d: Any, i: Any, x: Any, lead: Any) -> Any:
    """lead·x^d + rows[at + d − 1, i]·x^(d−1) + … + rows[at, i]."""
    total = lead
    for k in range(d):
        total = K.canonical(K.add(K.canonical(K.dot(total, x)), rows[at + d - 1 - k, i]))
    return total


def join(K: Any, rows: Any, g: Any, d: Any, i: Any, x: Any, slope: Any) -> None:
    """Replaces v by v + slope·u, and u, of degree d, by u·(X − x)."""
    for k in range(d):
        rows[g + k, i] = K.canonical(K.add(rows[g + k, i], K.canonical(K.dot(slope, rows[k, i]))))
    rows[g + d, i] = slope
    rows[d, i] = K.canonical(K.sub(rows[d - 1, i], x))
    for n in range(d - 1):
        k = d - 1 - n
        rows[k, i] = reduced(K, rows[k - 1, i], x, rows[k, i])
    rows[0, i] = K.canonical(K.neg(K.canonical(K.dot(x, rows[0, i]))))
