"""Sums of rows by explicit formulas of genus 2 and 3, one inversion for a block of rows: loops to be compiled.

A row of a DivisorArray is a column here: ``x[i, j]`` is the i-th coordinate (u₀ … u_{g−1}, v₀ … v_{g−1}) of row j. Thus
the same coordinate of neighbouring rows lies in neighbouring words, and LLVM can vectorise the loops. A block of BLOCK
rows goes through short loops: the first halves of the sums, up to the product to be inverted; Montgomery's
simultaneous inversion (1987), in CHAINS independent chains; the second halves. Rows that are not general (a weight
below g, a product that vanishes) take part in the inversion with a 1 and are reported to the caller. Equal summands are
doubled in the same pass.

All arrays of a block are parts of one scratch array at constant offsets, so that the compiler sees that they do not
overlap. The loops are the same for every kind of words (:mod:`jacobian.batch.libraries`), and run in Python unchanged.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.word_steps import STEPS
from jacobian.numbers.words import inverse

BLOCK = 256
CHAINS = 32
# where the parts of the scratch array begin: two divisors; the quotient (later the cubic or the quintic) and its
# product; the sum in genus 2, u' of jacobian.addition.genus3 in genus 3; and the chains
FIRST, SECOND, MIDDLE, PRODUCT, MEETING = 0, 6 * BLOCK, 12 * BLOCK, 16 * BLOCK, 17 * BLOCK
BEFORE, TAIL = 21 * BLOCK, 22 * BLOCK
SCRATCH = TAIL + CHAINS


def load(S: Any, at: Any, x: Any, start: Any, size: Any) -> None:
    """Copies the columns start … start + size − 1 of x into the scratch array, from offset ``at`` on."""
    for k in range(x.shape[0]):
        for j in range(size):
            S[at + k * BLOCK + j] = x[k, start + j]


def keep(S: Any, at: Any, j: Any, found: Any) -> None:
    """Stores the numbers ``found`` of row j in the scratch array, from offset ``at`` on."""
    for a in found:
        S[at + j] = a
        at += BLOCK


def three(S: Any, at: Any, j: Any) -> Any:
    return S[at + j], S[at + BLOCK + j], S[at + 2 * BLOCK + j]


def four(S: Any, at: Any, j: Any) -> Any:
    return S[at + j], S[at + BLOCK + j], S[at + 2 * BLOCK + j], S[at + 3 * BLOCK + j]


# --- what depends on the genus


def line(S: Any, at: Any, j: Any) -> Any:
    """The divisor of row j in genus 2, (a₁, a₀, b₁, b₀)."""
    a0, a1, b0, b1 = four(S, at, j)
    return a1, a0, b1, b0


def row(S: Any, at: Any, j: Any) -> Any:
    """The divisor of row j in genus 3, (a₂, a₁, a₀, b₂, b₁, b₀)."""
    a0, a1, a2 = three(S, at, j)
    b0, b1, b2 = three(S, at + 3 * BLOCK, j)
    return a2, a1, a0, b2, b1, b0


def close_lines(K: Any, C: Any, S: Any, second: Any) -> None:
    """Completes the sums of a block of rows in genus 2, from the quotients and the inverses of their products."""
    # several short loops let the processor work on more rows at once than one long loop
    for j in range(BLOCK):
        keep(S, MIDDLE, j, STEPS[type(C)].cubic(K, C, three(S, MIDDLE, j), S[PRODUCT + j], line(S, FIRST, j)))
    for j in range(BLOCK):
        e1, e0 = STEPS[type(C)].u(K, C, four(S, MIDDLE, j), line(S, FIRST, j), line(S, second, j))
        keep(S, MEETING, j, (e0, e1))
    for j in range(BLOCK):
        u = S[MEETING + BLOCK + j], S[MEETING + j]
        v1, v0 = STEPS[type(C)].v(K, C, four(S, MIDDLE, j), u, line(S, FIRST, j))
        keep(S, MEETING + 2 * BLOCK, j, (v0, v1))


def close_rows(K: Any, C: Any, S: Any, second: Any) -> None:
    """Completes the sums of a block of rows in genus 3, as :func:`close_lines` does in genus 2."""
    for j in range(BLOCK):
        keep(S, MIDDLE, j, STEPS[type(C)].bent(K, C, four(S, MIDDLE, j), S[PRODUCT + j]))
    for j in range(BLOCK):
        keep(S, MEETING, j, STEPS[type(C)].meeting(K, C, four(S, MIDDLE, j), row(S, FIRST, j), row(S, second, j)))
    for j in range(BLOCK):
        bent, meeting = four(S, MIDDLE, j), four(S, MEETING, j)
        keep(S, MIDDLE, j, STEPS[type(C)].middle(K, C, bent, meeting, row(S, FIRST, j), row(S, second, j)))
    for j in range(BLOCK):
        v = four(S, MIDDLE, j)
        u2, u1, u0 = STEPS[type(C)].u(K, C, four(S, MEETING, j), v)
        v2, v1, v0 = STEPS[type(C)].v(K, C, (u2, u1, u0), v)
        keep(S, SECOND, j, (u0, u1, u2, v0, v1, v2))


def divisor(C: Any, S: Any, at: Any, j: Any) -> Any:
    """The divisor of row j, in the order that the formulas use."""
    return line(S, at, j) if C.genus == 2 else row(S, at, j)


def close(K: Any, C: Any, S: Any, second: Any) -> None:
    """Completes the sums of a block of rows. The second summands begin at the offset ``second``."""
    if C.genus == 2:
        close_lines(K, C, S, second)
    else:
        close_rows(K, C, S, second)


def sums(C: Any) -> Any:
    """The offset of a block's sums in the scratch array. In genus 3 the sums overwrite the second summands."""
    return MEETING if C.genus == 2 else SECOND


# --- a block


def keep_quotient(K: Any, C: Any, S: Any, j: Any, quotient: Any) -> None:
    """Stores the quotient, which the first half of the sum in row j computes, and the number that this sum inverts."""
    S[PRODUCT + j] = K.canonical(STEPS[type(C)].product(K, C, quotient))
    keep(S, MIDDLE, j, quotient)


def keep_tangent(K: Any, C: Any, S: Any, j: Any) -> None:
    """Computes the first half of the double of row j, and stores it as :func:`keep_quotient` does."""
    keep_quotient(K, C, S, j, STEPS[type(C)].tangent(K, C, divisor(C, S, FIRST, j)))


def all_general(S: Any, g: Any, first: Any, second: Any, start: Any, size: Any) -> Any:
    """Whether in every row of a block both summands have weight g and the product to be inverted is not 0. The loop has
    no branches.
    """
    special = 0
    for j in range(size):
        special |= (S[PRODUCT + j] == 0) | (first[start + j] != g) | (second[start + j] != g)
    return special == 0


def is_same(S: Any, j: Any, columns: Any) -> Any:
    """Whether row j is the same divisor in both summands."""
    apart = 0
    for k in range(columns):
        apart |= S[FIRST + k * BLOCK + j] != S[SECOND + k * BLOCK + j]
    return apart == 0


def invert_products(K: Any, S: Any) -> None:
    """Replaces the BLOCK products, canonical and not 0, by their inverses."""
    for j in range(CHAINS):
        S[TAIL + j] = S[PRODUCT + j]
    for start in range(CHAINS, BLOCK, CHAINS):
        for j in range(CHAINS):
            S[BEFORE + start + j] = S[TAIL + j]
            S[TAIL + j] = K.dot(S[TAIL + j], S[PRODUCT + start + j])
    total = K.one
    for j in range(CHAINS):
        S[BEFORE + j] = total
        total = K.dot(total, S[TAIL + j])
    back = inverse(K, K.canonical(total))
    for i in range(CHAINS):
        j = CHAINS - 1 - i
        end = S[TAIL + j]
        S[TAIL + j] = K.dot(back, S[BEFORE + j])
        back = K.dot(back, end)
    for start in range(BLOCK - CHAINS, 0, -CHAINS):
        for j in range(CHAINS):
            x = S[PRODUCT + start + j]
            S[PRODUCT + start + j] = K.dot(S[TAIL + j], S[BEFORE + start + j])
            S[TAIL + j] = K.dot(S[TAIL + j], x)
    for j in range(CHAINS):
        S[PRODUCT + j] = S[TAIL + j]


def finish(K: Any, C: Any, S: Any, second: Any, out: Any, start: Any, size: Any) -> None:
    """Writes the sums of a block to ``out``, from the quotients and products that :func:`keep_quotient` stored."""
    for j in range(size, BLOCK):
        S[PRODUCT + j] = K.one
    invert_products(K, S)
    close(K, C, S, second)
    for k in range(out.shape[0]):
        for j in range(size):
            out[k, start + j] = S[sums(C) + k * BLOCK + j]


# --- rows


def add_rows(K: Any, C: Any, first: Any, second: Any, out: Any, span: Any, room: Any) -> Any:
    """Sets out[:, j] = x[:, j] + y[:, j] for the general rows j of a span (begin, end). Returns the number of other
    rows, whose indices are written into ``special``. ``first`` is (x, degrees), ``second`` is (y, degrees), and
    ``room`` (special, S). S must be initialised, since the loops also compute on unused rows of a block.
    """
    (x, x_degree), (y, y_degree), (begin, end), (special, S) = first, second, span, room
    g, count = x.shape[0] >> 1, 0
    for start in range(begin, end, BLOCK):
        size = min(BLOCK, end - start)
        load(S, FIRST, x, start, size)
        load(S, SECOND, y, start, size)
        for j in range(BLOCK):
            keep_quotient(K, C, S, j, STEPS[type(C)].chord(K, C, divisor(C, S, FIRST, j), divisor(C, S, SECOND, j)))
        if not all_general(S, g, x_degree, y_degree, start, size):
            for j in range(size):
                if x_degree[start + j] == g and y_degree[start + j] == g:
                    if S[PRODUCT + j] == 0 and is_same(S, j, 2 * g):
                        keep_tangent(K, C, S, j)
                    if S[PRODUCT + j] != 0:
                        continue
                S[PRODUCT + j] = K.one
                special[count] = start + j
                count += 1
        finish(K, C, S, SECOND, out, start, size)
    return count


def double_rows(K: Any, C: Any, first: Any, out: Any, span: Any, room: Any) -> Any:
    """Sets out[:, j] = 2x[:, j], with the arguments and the result of :func:`add_rows`."""
    (x, degree), (begin, end), (special, S) = first, span, room
    g, count = x.shape[0] >> 1, 0
    for start in range(begin, end, BLOCK):
        size = min(BLOCK, end - start)
        load(S, FIRST, x, start, size)
        for j in range(BLOCK):
            keep_tangent(K, C, S, j)
        if not all_general(S, g, degree, degree, start, size):
            for j in range(size):
                if degree[start + j] != g or S[PRODUCT + j] == 0:
                    S[PRODUCT + j] = K.one
                    special[count] = start + j
                    count += 1
        finish(K, C, S, FIRST, out, start, size)
    return count
