"""The loops of :mod:`jacobian.finite.matrix_products`, compiled: residues modulo p < 2^49 as floats within ±p/2.

A matrix M(k) has the first row ((n + 1)i·c_i − k·c_i), i = 1 … d, with c_i = f_i/f_0 and n = (p − 1)/2, and k on its
subdiagonal. A product of d × d matrices at many points is an array (d², points): its entry (r, c) at point i is
``values[d·r + c, i]``.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from jacobian.numbers import transform_kernels as transforms
from jacobian.numbers.words import Double, inverse

BLOCK = 64
"""The number of points computed in one loop."""


class Room(NamedTuple):
    """Scratch memory of a loop over blocks of points, for d × d matrices: arrays of BLOCK and d·BLOCK numbers, and
    two of d²·BLOCK.
    """

    k: Any
    row: Any
    S: Any
    U: Any


def room_for(d: int) -> Room:
    return Room(np.empty(BLOCK), np.empty((d, BLOCK)), np.empty((d * d, BLOCK)), np.empty((d * d, BLOCK)))


@cache
def kernels() -> Any:
    """The loops of this module and those of :mod:`jacobian.numbers.transform_kernels`, compiled by
    :mod:`jacobian.native`.
    """
    from jacobian.native.kinds import FLOAT, FLOATS, INT, ArrayKind, TupleKind, record
    from jacobian.native.library import Library
    from jacobian.native.words import CONTEXTS

    P, table = CONTEXTS[Double], ArrayKind(FLOAT, 2)
    room = record(Room, FLOATS, table, table, table)
    entries = {
        "inverses": (inverses, (P, FLOAT, FLOATS)),
        "inverse_factorials": (inverse_factorials, (P, FLOATS)),
        "lagrange": (lagrange, (P, FLOATS, FLOATS)),
        "falling": (falling, (P, FLOAT, FLOATS, FLOATS)),
        "scaled": (scaled, (P, FLOATS, FLOATS, FLOATS)),
        "direct": (direct, (P, table, FLOAT, INT, table, INT, room)),
        "join": (join, (P, table, FLOAT, FLOAT, table, table, TupleKind((INT, INT)), room)),
        "chain": (chain, (P, table, FLOAT, INT, table, INT, FLOATS, FLOATS)),
        "walk": (walk, (P, table, INT, INT, FLOATS)),
        "forward": (transforms.forward, (P, FLOATS, FLOATS, FLOATS)),
        "backward": (transforms.backward, (P, FLOATS, FLOATS, FLOATS)),
        "factors": (transforms.factors, (P, FLOATS, FLOATS)),
        "multiply": (transforms.multiply, (P, FLOATS, FLOATS, FLOATS)),
        "combined": (transforms.combined, (P, TupleKind((P, P, P)), FLOATS, table, INT, FLOATS, FLOATS)),
    }
    return Library("matrix_products", entries)


def inverses(P: Any, a: Any, out: Any) -> None:
    """Sets out[t] = 1/(a + t), no a + t being 0 (Montgomery 1987)."""
    total = 1.0
    for t in range(len(out)):
        out[t] = total
        total = P.canonical(P.dot(total, P.canonical(P.dot(a + t, 1.0))))
    total = inverse(P, total)
    for t in range(len(out) - 1, -1, -1):
        out[t] = P.canonical(P.dot(total, out[t]))
        total = P.canonical(P.dot(total, P.canonical(P.dot(a + t, 1.0))))


def inverse_factorials(P: Any, out: Any) -> None:
    """Sets out[j] = 1/j!."""
    total = 1.0
    for j in range(1, len(out)):
        total = P.canonical(P.dot(total, float(j)))
    total = inverse(P, total)
    for j in range(len(out) - 1, -1, -1):
        out[j] = total
        total = P.canonical(P.dot(total, float(max(j, 1))))


def lagrange(P: Any, factorials: Any, out: Any) -> None:
    """Sets out[j] = (−1)^(k − j)/(j!(k − j)!), k = len(out) − 1: the weights of Lagrange's interpolation at 0 … k."""
    k = len(out) - 1
    for j in range(k + 1):
        weight = P.canonical(P.dot(factorials[j], factorials[k - j]))
        out[j] = -weight if (k - j) % 2 else weight


def falling(P: Any, a: Any, reciprocals: Any, out: Any) -> None:
    """Sets out[i] = Π (a + i − j), j = 0 … k, k = len(out) − 1; ``reciprocals``: 1/(a − k), 1/(a − k + 1), …"""
    size = len(out)
    total = 1.0
    for j in range(size):
        total = P.canonical(P.dot(total, a - j))
    for i in range(size):
        out[i] = total
        total = P.canonical(P.dot(P.dot(total, a + i + 1), reciprocals[i]))


def scaled(P: Any, x: Any, y: Any, out: Any) -> None:
    """Sets out[j] = x[j]·y[j], as canonical residues."""
    for j in range(len(out)):
        out[j] = P.canonical(P.dot(x[j], y[j]))


def _step(P: Any, c: Any, d: Any, k: Any, S: Any, row: Any) -> None:
    """S ← M(k_j)·S for the BLOCK matrices S[:, j]. M(k) has the first row c[0] − k·c[1], k on its subdiagonal, else 0.
    ``row`` is scratch of shape (d, BLOCK).
    """
    for column in range(d):
        for j in range(BLOCK):
            row[column, j] = 0.0
        for i in range(d):
            high, low = c[0, i], c[1, i]
            for j in range(BLOCK):
                row[column, j] += P.dot(P.canonical(high - P.dot(k[j], low)), S[i * d + column, j])
    for i in range(d - 1, 0, -1):
        for column in range(d):
            for j in range(BLOCK):
                S[i * d + column, j] = P.canonical(P.dot(k[j], S[(i - 1) * d + column, j]))
    for column in range(d):
        for j in range(BLOCK):
            S[column, j] = P.canonical(P.dot(row[column, j], 1.0))


def direct(P: Any, c: Any, beta: Any, steps: Any, values: Any, points: Any, room: Any) -> None:
    """Writes M(x + steps)·…·M(x + 1), M of this module, at the first ``points`` of x = 0, β, 2β, … to ``values``."""
    k, row, S, d = room.k, room.row, room.S, c.shape[1]
    for begin in range(0, points, BLOCK):
        for e in range(d * d):
            for j in range(BLOCK):
                S[e, j] = 1.0 if e % (d + 1) == 0 else 0.0
        for step in range(1, steps + 1):
            for j in range(BLOCK):
                k[j] = P.canonical(P.dot(P.dot(float(begin + j), beta) + step, 1.0))
            _step(P, c, d, k, S, row)
        size = min(BLOCK, points - begin)
        for e in range(d * d):
            for j in range(size):
                values[e, begin + j] = S[e, j]


def join(P: Any, c: Any, beta: Any, middle: Any, upper: Any, values: Any, span: Any, room: Any) -> None:
    """Replaces ``values`` by upper·M(x + middle)·values at x = iβ, begin ≤ i < end, with the M(k) of :func:`_step`.
    ``span`` = (begin, end), multiples of BLOCK.
    """
    k, row, S, U, d = room.k, room.row, room.S, room.U, c.shape[1]
    begin, end = span
    for first in range(begin, end, BLOCK):
        for j in range(BLOCK):
            k[j] = P.canonical(P.dot(P.dot(float(first + j), beta) + middle, 1.0))
        for e in range(d * d):
            for j in range(BLOCK):
                S[e, j] = values[e, first + j]
                U[e, j] = upper[e, first + j]
        _step(P, c, d, k, S, row)
        for i in range(d):
            for column in range(d):
                for j in range(BLOCK):
                    k[j] = 0.0
                for inner in range(d):
                    for j in range(BLOCK):
                        k[j] += P.dot(U[i * d + inner, j], S[inner * d + column, j])
                for j in range(BLOCK):
                    values[i * d + column, first + j] = P.canonical(P.dot(k[j], 1.0))


def chain(P: Any, c: Any, beta: Any, first: Any, values: Any, points: Any, window: Any, new: Any) -> None:
    """For i = ``first``, ``first`` + 1, …, multiplies ``window`` by the product at the point iβ, then by M((i + 1)β).
    ``values`` has the products at ``points`` points, that at ``first``·β in its first column.
    """
    d = c.shape[1]
    for i in range(points):
        for r in range(d):
            total = 0.0
            for column in range(d):
                total += P.dot(values[r * d + column, i], window[column])
            new[r] = P.canonical(P.dot(total, 1.0))
        for r in range(d):
            window[r] = new[r]
        _turn(P, c, P.canonical(P.dot(float(first + i + 1), beta)), window)


def _turn(P: Any, c: Any, k: Any, window: Any) -> None:
    """Multiplies ``window`` by the matrix M(k), which the rows of ``c`` define as in :func:`_step`."""
    total = 0.0
    for i in range(len(window)):
        total += P.dot(P.canonical(c[0, i] - P.dot(k, c[1, i])), window[i])
    for i in range(len(window) - 1, 0, -1):
        window[i] = P.canonical(P.dot(k, window[i - 1]))
    window[0] = P.canonical(P.dot(total, 1.0))


def walk(P: Any, c: Any, begin: Any, end: Any, window: Any) -> None:
    """Multiplies ``window`` by the matrices M(begin), …, M(end − 1), one after the other (:func:`_turn`)."""
    for k in range(begin, end):
        _turn(P, c, P.canonical(P.dot(float(k), 1.0)), window)
