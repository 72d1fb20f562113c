"""Loops over rows of genus 3: the formulas of :mod:`jacobian.addition.genus3_words`, in the blocks and with the
simultaneous inversion of :mod:`jacobian.batch.genus2_kernels`. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from jacobian.addition.genus3_words import chord, next_u, next_v, product, quintic, sum_u, sum_v, tangent
from jacobian.batch.genus2_kernels import BLOCK, FIRST, JIT, PRODUCT, TAIL, adding, doubling, quadruple
from jacobian.numbers.compiler import njit
from jacobian.numbers.words import canonical, number
from jacobian.numbers.words_compiled import INLINED

# the products have the same place as in genus 2, because the same loop inverts them; the quotient precedes them
MIDDLE, SECOND = PRODUCT - 4 * BLOCK, TAIL + BLOCK
MEETING = SECOND + 6 * BLOCK
SCRATCH = MEETING + 4 * BLOCK


@register_jitable(**INLINED)
def row(K, S, at, j):  # type: ignore[no-untyped-def]  # compiled, as all below
    """The divisor of row j as (a₂, a₁, a₀, b₂, b₁, b₀)."""
    a0, a1, a2, b0 = quadruple(K, S, at, j)
    return a2, a1, a0, number(K, S[at + 5 * BLOCK + j]), number(K, S[at + 4 * BLOCK + j]), b0


@register_jitable(**INLINED)
def keep(S, at, j, found):  # type: ignore[no-untyped-def]
    """Stores four numbers of row j."""
    S[at + j], S[at + BLOCK + j], S[at + 2 * BLOCK + j], S[at + 3 * BLOCK + j] = found


@register_jitable(**INLINED)
def keep_quotient(K, S, j, quotient):  # type: ignore[no-untyped-def]
    """Stores the first half of row j and its product."""
    keep(S, MIDDLE, j, quotient)
    S[PRODUCT + j] = canonical(K, product(K, quotient))


@register_jitable(**INLINED)
def keep_chord(K, C, S, j):  # type: ignore[no-untyped-def]
    """The first half of the sum in row j."""
    keep_quotient(K, S, j, chord(K, row(K, S, FIRST, j), row(K, S, SECOND, j)))


@register_jitable(**INLINED)
def keep_tangent(K, C, S, j):  # type: ignore[no-untyped-def]
    """The first half of the double in row j."""
    keep_quotient(K, S, j, tangent(K, C, row(K, S, FIRST, j)))


@register_jitable(**INLINED)
def close_block(K, C, S, second, out, start, size):  # type: ignore[no-untyped-def]
    """The second halves of a block, from its inverses, in short loops."""
    for j in range(BLOCK):
        keep(S, MIDDLE, j, quintic(K, quadruple(K, S, MIDDLE, j), number(K, S[PRODUCT + j])))
    for j in range(BLOCK):
        bent = quadruple(K, S, MIDDLE, j)
        keep(S, MEETING, j, next_u(K, C, bent, row(K, S, FIRST, j), row(K, S, second, j)))
    for j in range(BLOCK):
        first, meeting = row(K, S, FIRST, j), quadruple(K, S, MEETING, j)
        keep(S, MIDDLE, j, next_v(K, quadruple(K, S, MIDDLE, j), meeting, first, row(K, S, second, j)))
    for j in range(BLOCK):
        v = quadruple(K, S, MIDDLE, j)
        u2, u1, u0 = sum_u(K, C, quadruple(K, S, MEETING, j), v)
        v2, v1, v0 = sum_v(K, (u2, u1, u0), v)
        keep(S, SECOND, j, (u0, u1, u2, v0))
        S[SECOND + 4 * BLOCK + j], S[SECOND + 5 * BLOCK + j] = v1, v2
    for k in range(6):
        for j in range(size):
            out[k, np.uint64(start) + np.uint64(j)] = S[SECOND + k * BLOCK + j]


_add = adding(3, SECOND, SCRATCH, keep_chord, keep_tangent, close_block)
_double = doubling(3, SCRATCH, keep_tangent, close_block)


@njit(**JIT)
def add_rows(K, C, first, second, out, begin, end, special):  # type: ignore[no-untyped-def]
    """:func:`jacobian.batch.genus2_kernels.add_rows` in genus 3."""
    return _add(K, C, first, second, out, begin, end, special)


@njit(**JIT)
def double_rows(K, C, first, out, begin, end, special):  # type: ignore[no-untyped-def]
    """The same for out[:, j] = 2x[:, j]."""
    return _double(K, C, first, out, begin, end, special)
