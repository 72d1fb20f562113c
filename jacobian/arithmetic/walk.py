"""The coefficients of x^(p−1), x^(p−2), … in f^((p−1)/2), for many primes side by side, from d coefficients of lower
powers.

The recurrence of :mod:`jacobian.arithmetic.forest`, divided by 2k·f_0, is

    c_k = (1/k)·Σ (i·f_i/2f_0) c_(k−i) − Σ (f_i/f_0) c_(k−i)  (mod p)

It is computed on residues within ±p/2, as floats: for p < 2^24 and d ≤ 120 every sum is an integer below 2^53. A vector
instruction computes for eight primes. GROUPS such groups of primes run at once, because their operations are
independent. The inverses of ROUND successive k take one exponentiation (Montgomery 1987; Fermat).
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from jacobian.native.code import LANES
from jacobian.numbers.threads import in_ranges

MOST_PRIME, MOST_DEGREE = 1 << 24, 120
GROUPS = 4
TOGETHER = GROUPS * LANES
ROUND = 256
WHOLE = 6755399441055744.0
"""3·2^51: adding and then subtracting it rounds a float below 2^51 in size to the nearest integer."""


class Walks(NamedTuple):
    """The data of N walks, one for each prime, ascending; each has T translates of f, of degree d.

    ``ratios``: f_i/f_0 modulo p, i = d … 1, (N, T, d); ``window``: the coefficients of x^(start−d+1), …, x^start in
    f^((p−1)/2), times a common factor, (N, T, d).
    """

    primes: Any
    ratios: Any
    start: int
    window: Any


def last_coefficients(walks: Walks, count: int) -> tuple[Any, Any]:
    """The c_(p−1), …, c_(p−count) of the module's docstring, (N, T, count), and Π_{start<k<p} k, (N,), modulo p. The
    c_k contain the same factor as those in ``walks.window``.
    """
    primes, ratios, start, window = walks
    size, translates, d = ratios.shape
    groups = -(-size // TOGETHER)
    rows = np.minimum(np.arange(groups * TOGETHER), size - 1)
    p = primes[rows]
    halves = (p + 1) // 2
    weights = ratios[rows] * (np.arange(d, 0, -1) * halves[:, None] % p[:, None])[:, None, :] % p[:, None, None]
    moduli = _lanes(p[:, None].astype(float), groups)
    plain, weighted = (_lanes(_balanced(x, p), groups) for x in (ratios[rows], weights))
    windows = _lanes(_balanced(window[rows], p), groups)
    length = int(p[-1]).bit_length()
    bits = (p[:, None] - 2) >> np.arange(length - 1, -1, -1) & 1
    power = np.ascontiguousarray(_lanes(bits.astype(float), groups).swapaxes(1, 2))
    found, products = np.empty((groups, TOGETHER, translates, count)), np.empty((groups, TOGETHER))

    def work(begin: int, end: int) -> None:
        room = Room(_room(translates * GROUPS * (ROUND + d)), _room(ROUND * GROUPS), *(_room(GROUPS) for _ in range(3)))
        out, total = _room(TOGETHER * translates * count), _room(TOGETHER)
        own = np.arange(TOGETHER)
        for i in range(begin, end):
            ends = p[i * TOGETHER : (i + 1) * TOGETHER] - 1
            given = moduli[i], 1 / moduli[i], power[i], plain[i], weighted[i], windows[i]
            group = Group(*(np.ascontiguousarray(x).reshape(-1, LANES) for x in given))
            library().walk((start, d, count, translates), ends, group, room, out, total)
            # whenever the walk arrives at one of its primes, it writes values for all; those for this prime are taken
            found[i] = out.reshape(TOGETHER, translates, count, LANES)[own, :, :, own % LANES]
            products[i] = total.reshape(TOGETHER, LANES)[own, own % LANES]

    in_ranges(groups, max(1, groups // 64), work)
    p = p[:, None]
    columns = found.reshape(len(p), -1).astype(np.int64) % p
    totals = products.reshape(-1, 1).astype(np.int64) % p
    return columns[:size].reshape(size, translates, count), totals[:size, 0]


def _balanced(values: Any, p: Any) -> Any:
    """Residues 0 … p − 1, (N, …), as floats within ±p/2, (N, k)."""
    flat, p = values.reshape(len(p), -1), p[:, None]
    return (flat - p * (2 * flat > p)).astype(float)


def _lanes(values: Any, groups: int) -> Any:
    """The array (N, k) rearranged to (groups, GROUPS, k, LANES), N = groups·GROUPS·LANES."""
    return values.reshape(groups, GROUPS, LANES, -1).swapaxes(2, 3)


def _room(items: int) -> Any:
    """An array of ``items`` rows of LANES floats, aligned so that no row crosses a cache line."""
    memory = np.zeros((items + 1) * LANES)
    begin = -memory.ctypes.data // 8 % LANES
    return memory[begin : begin + items * LANES].reshape(items, LANES)


# --- compiled


class Group(NamedTuple):
    """The data of GROUPS·LANES primes p in rows of LANES floats; ``inverses``: 1/p, ``bits``: the bits of p − 2.

    ``plain`` and ``weighted``: f_i/f_0 and i·f_i/2f_0, i = d … 1; ``window``: the coefficients before the walk.
    """

    primes: Any
    inverses: Any
    bits: Any
    plain: Any
    weighted: Any
    window: Any


class Room(NamedTuple):
    """The memory of a walk: the coefficients c_k of a round (``states``) and the inverses of its k (``reciprocals``).

    For each row of LANES primes: ``product``, the product of the k of the round; ``power``, its inverse; ``run``, the
    product of the k of all rounds.
    """

    states: Any
    reciprocals: Any
    product: Any
    power: Any
    run: Any


def walk(shape: Any, ends: Any, group: Any, room: Any, out: Any, total: Any) -> None:
    """Computes c_k up to k = ends[n] for each n in turn. There it writes the last ``count`` c_k to ``out`` and Π k from
    start + 1 on to ``total``, for the LANES primes of which prime n is one. ``shape`` = (start, d, count, translates).
    """
    start, d, count, translates = shape
    states, groups = room.states, len(group.primes)
    length = len(states) // (translates * groups)
    for s in range(translates * groups):
        for i in range(d):
            states[s * length + i] = group.window[s * d + i]
    for q in range(groups):
        room.run[q] = group.primes[q] * 0.0 + 1.0
    k = start
    for n in range(len(ends)):
        while k < ends[n]:
            size = min(len(room.reciprocals) // groups, ends[n] - k)
            invert(k, size, group, room)
            steps(size, shape, group, room)
            for s in range(translates * groups):
                for i in range(d):
                    states[s * length + i] = states[s * length + size + i]
            k += size
        q = n // LANES
        total[n] = room.run[q]
        for s in range(translates):
            for i in range(count):
                out[(n * translates + s) * count + i] = states[(q * translates + s) * length + d - 1 - i]


def rest(x: Any, p: Any, r: Any) -> Any:
    """The residue of x modulo p, within ±p/2 up to the rounding of r = 1/p."""
    return x - ((x * r + WHOLE) - WHOLE) * p


def invert(k: int, size: int, group: Any, room: Any) -> None:
    """Writes 1/(k + 1), …, 1/(k + size) modulo each prime to ``room``; multiplies its ``run`` by (k + 1)⋯(k + size)."""
    P, R, bits, groups = group.primes, group.inverses, group.bits, len(group.primes)
    product, power = room.product, room.power
    for q in range(groups):
        product[q] = P[q] * 0.0 + 1.0
        power[q] = P[q] * 0.0 + 1.0
    for m in range(size):
        factor = float(k + 1 + m)
        for q in range(groups):
            room.reciprocals[m * groups + q] = product[q]
            product[q] = rest(product[q] * factor, P[q], R[q])
    for b in range(len(bits) // groups):
        for q in range(groups):
            square = rest(power[q] * power[q], P[q], R[q])
            power[q] = rest(square * (1.0 + bits[b * groups + q] * (product[q] - 1.0)), P[q], R[q])
    for q in range(groups):
        room.run[q] = rest(room.run[q] * product[q], P[q], R[q])
    for n in range(size):
        m = size - 1 - n
        factor = float(k + 1 + m)
        for q in range(groups):
            place = m * groups + q
            room.reciprocals[place] = rest(room.reciprocals[place] * power[q], P[q], R[q])
            power[q] = rest(power[q] * factor, P[q], R[q])


def steps(size: int, shape: Any, group: Any, room: Any) -> None:
    """Makes ``size`` steps of the recurrence: coefficient m + d of each walk from coefficients m … m + d − 1."""
    P, R, plain, weighted, states = group.primes, group.inverses, group.plain, group.weighted, room.states
    _, d, _, translates = shape
    groups = len(P)
    length = len(states) // (translates * groups)
    for m in range(size):
        for q in range(groups):
            for s in range(translates):
                at, place = (q * translates + s) * d, (q * translates + s) * length + m
                x = states[place]
                a, b = plain[at] * x, weighted[at] * x
                for i in range(1, d):
                    x = states[place + i]
                    a += plain[at + i] * x
                    b += weighted[at + i] * x
                inverted = room.reciprocals[m * groups + q]
                states[place + d] = rest(rest(b, P[q], R[q]) * inverted - a, P[q], R[q])


@cache
def library() -> Any:
    """The loops of this module, compiled."""
    from jacobian.native.kinds import EIGHTS, INT, INTS, TupleKind, record
    from jacobian.native.library import Library

    kinds = TupleKind((INT,) * 4), INTS, record(Group, *[EIGHTS] * 6), record(Room, *[EIGHTS] * 5), EIGHTS, EIGHTS
    return Library("walks_to_p", {"walk": (walk, kinds)})
