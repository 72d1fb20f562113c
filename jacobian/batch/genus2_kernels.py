"""Loops over rows of genus 2: the formulas of :mod:`jacobian.addition.genus2_words`, one inversion for a block of rows.

A row of the group is a column here: ``x[i, j]`` is the i-th coordinate (u₀, u₁, v₀, v₁) of row j. Thus the same
coordinate of neighbouring rows lies in neighbouring words, and LLVM can vectorise the loops. A block of BLOCK rows goes
through short loops: the first halves; Montgomery's simultaneous inversion (1987), in LANES independent chains; the
second halves.
Rows that are not general (a weight below 2, a product that vanishes) take part with a 1 in the inversion and are
reported to the caller; equal rows in an addition are doubled on the spot.

All arrays of a block are rows of one scratch array at constant offsets, so that the compiler sees that they do not
overlap. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from jacobian.addition import genus2_words_compiled  # noqa: F401  # the compiled formulas
from jacobian.addition.genus2_words import chord, cubic, product, sum_u, sum_v, tangent
from jacobian.numbers.compiler import njit
from jacobian.numbers.words import canonical, inverse, mul, number
from jacobian.numbers.words_compiled import INLINED

JIT = {"nogil": True, "error_model": "numpy"}
BLOCK = 256
LANES = 32
# where the rows of the scratch array begin: two divisors, the quotient with the product (later the cubic), the chains
FIRST, SECOND, MIDDLE, BEFORE, TAIL = 0, 4 * BLOCK, 8 * BLOCK, 12 * BLOCK, 13 * BLOCK
PRODUCT = MIDDLE + 3 * BLOCK
SCRATCH = TAIL + LANES


@register_jitable(**INLINED)
def quadruple(K, S, at, j):  # type: ignore[no-untyped-def]  # compiled, as all below
    """The four numbers of row j that begin at offset ``at`` of the scratch array."""
    return (
        number(K, S[at + j]),
        number(K, S[at + BLOCK + j]),
        number(K, S[at + 2 * BLOCK + j]),
        number(K, S[at + 3 * BLOCK + j]),
    )


@register_jitable(**INLINED)
def line(K, S, at, j):  # type: ignore[no-untyped-def]
    """The divisor of row j as (a₁, a₀, b₁, b₀)."""
    a0, a1, b0, b1 = quadruple(K, S, at, j)
    return a1, a0, b1, b0


@register_jitable(**INLINED)
def load(S, at, x, start, size):  # type: ignore[no-untyped-def]
    """Copies a block into the scratch array. The index is unsigned so that numba does not test for negative indices."""
    for k in range(x.shape[0]):
        for j in range(size):
            S[at + k * BLOCK + j] = x[k, np.uint64(start) + np.uint64(j)]


@register_jitable(**INLINED)
def keep_quotient(K, C, S, j, quotient):  # type: ignore[no-untyped-def]
    """Stores the first half of row j and its product."""
    r, s1, s0 = quotient
    S[MIDDLE + j] = r
    S[MIDDLE + BLOCK + j] = s1
    S[MIDDLE + 2 * BLOCK + j] = s0
    S[PRODUCT + j] = canonical(K, product(K, C, quotient))


@register_jitable(**INLINED)
def keep_chord(K, C, S, j):  # type: ignore[no-untyped-def]
    """The first half of the sum in row j."""
    keep_quotient(K, C, S, j, chord(K, line(K, S, FIRST, j), line(K, S, SECOND, j)))


@register_jitable(**INLINED)
def keep_tangent(K, C, S, j):  # type: ignore[no-untyped-def]
    """The first half of the double in row j."""
    keep_quotient(K, C, S, j, tangent(K, C, line(K, S, FIRST, j)))


@register_jitable(**INLINED)
def all_general(S, g, x_degree, y_degree, start, size):  # type: ignore[no-untyped-def]
    """Whether every row of a block has weight g in both summands and a product ≠ 0. There is no branch for each row."""
    special = 0
    for j in range(size):
        i = np.uint64(start) + np.uint64(j)
        special |= (S[PRODUCT + j] == 0) | (x_degree[i] != g) | (y_degree[i] != g)
    return special == 0


@register_jitable
def invert_products(K, S):  # type: ignore[no-untyped-def]
    """Replaces the BLOCK products, canonical and not 0, by their inverses."""
    for j in range(LANES):
        S[TAIL + j] = S[PRODUCT + j]
    for start in range(LANES, BLOCK, LANES):
        for j in range(LANES):
            S[BEFORE + start + j] = S[TAIL + j]
            S[TAIL + j] = mul(K, S[TAIL + j], S[PRODUCT + start + j])
    total = K.one
    for j in range(LANES):
        S[BEFORE + j] = total
        total = mul(K, total, S[TAIL + j])
    back = inverse(K, canonical(K, total))
    for j in range(LANES - 1, -1, -1):
        end = S[TAIL + j]
        S[TAIL + j] = mul(K, back, S[BEFORE + j])
        back = mul(K, back, end)
    for start in range(BLOCK - LANES, 0, -LANES):
        for j in range(LANES):
            x = S[PRODUCT + start + j]
            S[PRODUCT + start + j] = mul(K, S[TAIL + j], S[BEFORE + start + j])
            S[TAIL + j] = mul(K, S[TAIL + j], x)
    for j in range(LANES):
        S[PRODUCT + j] = S[TAIL + j]


@register_jitable(**INLINED)
def close_block(K, C, S, second, out, start, size):  # type: ignore[no-untyped-def]
    """Computes the second halves of a block from its inverses. The loops are short so that the processor works on more
    rows at once."""
    for j in range(BLOCK):
        r, s1, s0, inverted = quadruple(K, S, MIDDLE, j)
        found = cubic(K, C, (r, s1, s0), inverted, line(K, S, FIRST, j))
        S[MIDDLE + j], S[MIDDLE + BLOCK + j], S[MIDDLE + 2 * BLOCK + j], S[MIDDLE + 3 * BLOCK + j] = found
    for j in range(BLOCK):
        e1, e0 = sum_u(K, C, quadruple(K, S, MIDDLE, j), line(K, S, FIRST, j), line(K, S, second, j))
        S[SECOND + j], S[SECOND + BLOCK + j] = e0, e1
    for j in range(BLOCK):
        u = number(K, S[SECOND + BLOCK + j]), number(K, S[SECOND + j])
        v1, v0 = sum_v(K, C, quadruple(K, S, MIDDLE, j), u, line(K, S, FIRST, j))
        S[SECOND + 2 * BLOCK + j], S[SECOND + 3 * BLOCK + j] = v0, v1
    for k in range(4):
        for j in range(size):
            out[k, np.uint64(start) + np.uint64(j)] = S[SECOND + k * BLOCK + j]


@register_jitable(**INLINED)
def same(S, one, other, columns, j):  # type: ignore[no-untyped-def]
    """Whether row j is equal in the parts of the scratch array that begin at ``one`` and ``other``."""
    apart = False
    for k in range(columns):
        apart |= S[one + k * BLOCK + j] != S[other + k * BLOCK + j]
    return not apart


def adding(g, second_at, scratch, keep_chord, keep_tangent, close_block):  # type: ignore[no-untyped-def]
    """The loop of :func:`add_rows` in genus g, built from the formulas' functions for row j and for a block.

    The scratch array has ``scratch`` numbers; the second summand begins at ``second_at``.
    """

    def loop(K, C, first, second, out, begin, end, special):  # type: ignore[no-untyped-def]
        (x, x_degree), (y, y_degree) = first, second
        S = np.zeros(scratch, x.dtype)
        count = 0
        for start in range(begin, end, BLOCK):
            size = min(BLOCK, end - start)
            load(S, FIRST, x, start, size)
            load(S, second_at, y, start, size)
            for j in range(BLOCK):
                keep_chord(K, C, S, j)
            if not all_general(S, g, x_degree, y_degree, start, size):
                for j in range(size):
                    if x_degree[start + j] == g and y_degree[start + j] == g:
                        if S[PRODUCT + j] == 0 and same(S, FIRST, second_at, 2 * g, j):
                            keep_tangent(K, C, S, j)
                        if S[PRODUCT + j] != 0:
                            continue
                    S[PRODUCT + j] = K.one
                    special[count] = start + j
                    count += 1
            S[PRODUCT + size : PRODUCT + BLOCK] = K.one
            invert_products(K, S)
            close_block(K, C, S, second_at, out, start, size)
        return count

    return register_jitable(**INLINED)(loop)


def doubling(g, scratch, keep_tangent, close_block):  # type: ignore[no-untyped-def]
    """As :func:`adding`, for :func:`double_rows`."""

    def loop(K, C, first, out, begin, end, special):  # type: ignore[no-untyped-def]
        x, x_degree = first
        S = np.zeros(scratch, x.dtype)
        count = 0
        for start in range(begin, end, BLOCK):
            size = min(BLOCK, end - start)
            load(S, FIRST, x, start, size)
            for j in range(BLOCK):
                keep_tangent(K, C, S, j)
            if not all_general(S, g, x_degree, x_degree, start, size):
                for j in range(size):
                    if x_degree[start + j] != g or S[PRODUCT + j] == 0:
                        S[PRODUCT + j] = K.one
                        special[count] = start + j
                        count += 1
            S[PRODUCT + size : PRODUCT + BLOCK] = K.one
            invert_products(K, S)
            close_block(K, C, S, FIRST, out, start, size)
        return count

    return register_jitable(**INLINED)(loop)


_add = adding(2, SECOND, SCRATCH, keep_chord, keep_tangent, close_block)
_double = doubling(2, SCRATCH, keep_tangent, close_block)


# numba's cache watches the file of the entry function only, so each genus has its own


@njit(**JIT)
def add_rows(K, C, first, second, out, begin, end, special):  # type: ignore[no-untyped-def]
    """Sets out[:, j] = x[:, j] + y[:, j] for the general rows j with begin ≤ j < end. Returns the number of other rows,
    whose indices are written into ``special``. ``first`` is x with its degrees, ``second`` y likewise.
    """
    return _add(K, C, first, second, out, begin, end, special)


@njit(**JIT)
def double_rows(K, C, first, out, begin, end, special):  # type: ignore[no-untyped-def]
    """As :func:`add_rows`, for out[:, j] = 2x[:, j]."""
    return _double(K, C, first, out, begin, end, special)
