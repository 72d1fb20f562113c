"""Genus 2 over GF(p), p of two words, and GF(2^n), n ≤ 127: the formulas of :mod:`jacobian.addition.genus2_words`,
compiled by :mod:`jacobian.native`.

Loops over rows, one inversion for BLOCK of them (Montgomery 1987), and single classes: a sum, a double, a whole ladder.
What is not general is reported and left to the caller. A class of weight 2 is its line (a₁, a₀, b₁, b₀) in words; rows
are columns of arrays (4, N) in the order u₀, u₁, v₀, v₁. All run as they stand on Python ints too.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.genus2_words import (
    STEPS,
    BinaryQuintic,
    BinarySextic,
    Quintic,
    Sextic,
    chord,
    cubic,
    opposite,
    product,
    sum_u,
    sum_v,
    tangent,
)  # fmt: skip
from jacobian.native import binary, modular
from jacobian.native.kinds import INT, INTS, LONG, LONGS, ArrayKind, TupleKind, record
from jacobian.native.library import Library
from jacobian.numbers.binary import BinaryContext, binary_context
from jacobian.numbers.two_words import TwoWords, long, two_words
from jacobian.numbers.words import add, decode, dot2, encode, inverse, mul, neg, sub

BLOCK = 256
SCRATCH = 5
"""Words of scratch for a row."""

# --- rows


def line(x: Any, j: Any) -> Any:
    """Row j as a line."""
    return x[1, j], x[0, j], x[3, j], x[2, j]


def keep(x: Any, j: Any, found: Any) -> None:
    """A line as row j."""
    x[1, j], x[0, j], x[3, j], x[2, j] = found


def opened(K: Any, C: Any, S: Any, j: Any, total: Any, quotient: Any) -> Any:
    """The first half of a row, kept in the scratch array, and the product of all so far with that of this row; 0 is
    left out.
    """
    multiple = product(K, C, quotient)
    S[0, j], S[1, j], S[2, j] = quotient
    S[3, j], S[4, j] = multiple, total
    return total if multiple == 0 else mul(K, total, multiple)


def closed(K: Any, C: Any, S: Any, j: Any, back: Any, first: Any, second: Any) -> Any:
    """(the sum, what the rows before are inverted by): the second half of a row."""
    bent = cubic(K, C, (S[0, j], S[1, j], S[2, j]), mul(K, back, S[4, j]), first)
    u = sum_u(K, C, bent, first, second)
    return (*u, *sum_v(K, C, bent, u, first)), mul(K, back, S[3, j])


def closed_block(K: Any, C: Any, S: Any, block: Any, total: Any, rows: Any, special: Any, count: Any) -> Any:
    """The sums of a block (start, size) of ``rows``, (x, y, out), from the product of all that are general; the number
    of special ones so far.
    """
    (start, size), (x, y, out) = block, rows
    back = inverse(K, total)
    for k in range(size):
        j = size - 1 - k
        if S[3, j] == 0:
            special[count] = start + j
            count += 1
        else:
            found, back = closed(K, C, S, j, back, line(x, start + j), line(y, start + j))
            keep(out, start + j, found)
    return count


def add_rows(K: Any, C: Any, first: Any, second: Any, out: Any, span: Any, special: Any, S: Any) -> Any:
    """out[:, j] = x[:, j] + y[:, j] for the general rows of a span (begin, end); the others go into ``special``, and
    their number is returned. ``first`` is x with its degrees in the span, ``second`` y with its.
    """
    (x, x_degree), (y, y_degree), (begin, end) = first, second, span
    count = 0
    for start in range(begin, end, BLOCK):
        total, size = K.one, min(BLOCK, end - start)
        for j in range(size):
            i = start + j
            S[3, j] = 0
            if x_degree[i - begin] == 2 and y_degree[i - begin] == 2:
                D, E = line(x, i), line(y, i)
                if D[0] == E[0] and D[1] == E[1] and D[2] == E[2] and D[3] == E[3]:
                    total = opened(K, C, S, j, total, tangent(K, C, D))
                else:
                    total = opened(K, C, S, j, total, chord(K, D, E))
        count = closed_block(K, C, S, (start, size), total, (x, y, out), special, count)
    return count


def double_rows(K: Any, C: Any, first: Any, out: Any, span: Any, special: Any, S: Any) -> Any:
    """As :func:`add_rows`, for out[:, j] = 2x[:, j]."""
    (x, degree), (begin, end) = first, span
    count = 0
    for start in range(begin, end, BLOCK):
        total, size = K.one, min(BLOCK, end - start)
        for j in range(size):
            S[3, j] = 0
            if degree[start + j - begin] == 2:
                total = opened(K, C, S, j, total, tangent(K, C, line(x, start + j)))
        count = closed_block(K, C, S, (start, size), total, (x, x, out), special, count)
    return count


def negate_rows(K: Any, h: Any, first: Any, out: Any, span: Any) -> None:
    """(u, v) → (u, −v − h modulo u) for the rows of a span, ``first`` being x with its degrees there."""
    (x, degree), (begin, end) = first, span
    for j in range(begin, end):
        high, low = modulo_u(K, h, x, j, degree[j - begin])
        out[0, j], out[1, j] = x[0, j], x[1, j]
        out[2, j], out[3, j] = neg(K, add(K, x[2, j], low)), neg(K, add(K, x[3, j], high))


def encode_rows(K: Any, x: Any) -> None:
    """The words of residues, in place."""
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            x[k, j] = encode(K, x[k, j])


def decode_rows(K: Any, x: Any) -> None:
    """The residues of words, in place."""
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            x[k, j] = decode(K, x[k, j])


def modulo_u(K: Any, a: Any, x: Any, j: Any, degree: Any) -> Any:
    """(c₁, c₀): the polynomial with the coefficients a modulo the u of row j, by Horner's rule."""
    high, low = long(0), long(0)
    if degree == 0:
        return high, low
    for k in range(len(a)):
        c = a[len(a) - 1 - k]
        if degree == 2:
            high, low = sub(K, low, mul(K, high, x[1, j])), sub(K, c, mul(K, high, x[0, j]))
        else:
            low = sub(K, c, mul(K, low, x[0, j]))
    return high, low


def shift_rows(K: Any, shift: Any, x: Any, degree: Any) -> None:
    """v → v + shift modulo u in every row, in place."""
    for j in range(x.shape[1]):
        high, low = modulo_u(K, shift, x, j, degree[j])
        x[3, j], x[2, j] = add(K, x[3, j], high), add(K, x[2, j], low)


def scale_rows(K: Any, powers: Any, x: Any, degree: Any) -> None:
    """(x, y) → (cx, c²·y) on the points of every row, in place, powers[k] = cᵏ."""
    for j in range(x.shape[1]):
        for k in range(2):
            if k < degree[j]:
                x[k, j] = mul(K, x[k, j], powers[degree[j] - k])
            x[2 + k, j] = mul(K, x[2 + k, j], powers[2 - k])


def first_off_curve(K: Any, equation: Any, x: Any, degree: Any) -> Any:
    """The first row whose u does not divide v(v + h) − f, or −1; ``equation`` is (h, f)."""
    h, f = equation
    for j in range(x.shape[1]):
        high, low = modulo_u(K, f, x, j, degree[j])
        b1, b0 = x[3, j], x[2, j]
        w1, w0 = modulo_u(K, h, x, j, degree[j])
        w1, w0 = add(K, w1, b1), add(K, w0, b0)
        if degree[j] == 2:
            square = mul(K, b1, w1)
            high = sub(K, high, sub(K, dot2(K, b1, w0, b0, w1), mul(K, square, x[1, j])))
            low = sub(K, low, sub(K, mul(K, b0, w0), mul(K, square, x[0, j])))
        elif degree[j] == 1:
            low = sub(K, low, mul(K, b0, w0))
        if high != 0 or low != 0:
            return j
    return -1


# --- single classes: residues in and out


def sum_of_lines(K: Any, C: Any, quotient: Any, first: Any, second: Any) -> Any:
    """(whether the case is the general one, the line of the sum)."""
    multiple = product(K, C, quotient)
    if multiple == 0:
        return False, first
    bent = cubic(K, C, quotient, inverse(K, multiple), first)
    u = sum_u(K, C, bent, first, second)
    return True, (*u, *sum_v(K, C, bent, u, first))


def add_lines(K: Any, C: Any, D: Any, E: Any) -> Any:
    """(whether the case is the general one, the line of the sum)."""
    first, second = encoded(K, D), encoded(K, E)
    general, found = sum_of_lines(K, C, chord(K, first, second), first, second)
    return general, decoded(K, found)


def double_line(K: Any, C: Any, D: Any) -> Any:
    """The same for the double."""
    first = encoded(K, D)
    general, found = sum_of_lines(K, C, tangent(K, C, first), first, first)
    return general, decoded(K, found)


def multiple_line(K: Any, C: Any, D: Any, digits: Any, odd: Any) -> Any:
    """The same for Σ digits[i]·2^i times D, the last digit positive (:func:`jacobian.addition.ladder.signed_digits`);
    ``odd`` has room for as many rows as there are odd digits.
    """
    first = encoded(K, D)
    keep(odd, 0, first)
    general, double = sum_of_lines(K, C, tangent(K, C, first), first, first)
    for i in range(1, odd.shape[1]):
        before = line(odd, i - 1)
        fine, found = sum_of_lines(K, C, chord(K, before, double), before, double)
        general = general and fine
        keep(odd, i, found)
    position = len(digits) - 1
    total = line(odd, digits[position] >> 1)
    while general and position > 0:
        position -= 1
        general, total = sum_of_lines(K, C, tangent(K, C, total), total, total)
        digit = digits[position]
        if digit != 0:
            term = line(odd, abs(digit) >> 1)
            if digit < 0:
                term = opposite(K, C, term)
            fine, total = sum_of_lines(K, C, chord(K, total, term), total, term)
            general = general and fine
    return general, decoded(K, total)


def encoded(K: Any, D: Any) -> Any:
    """A line of residues in words."""
    return encode(K, D[0]), encode(K, D[1]), encode(K, D[2]), encode(K, D[3])


def decoded(K: Any, D: Any) -> Any:
    """The residues of a line."""
    return decode(K, D[0]), decode(K, D[1]), decode(K, D[2]), decode(K, D[3])


# --- compiled

COEFFICIENTS = {Quintic: 3, Sextic: 5, BinaryQuintic: 6, BinarySextic: 9}
MODELS = {model: record(model, *[LONG] * count) for model, count in COEFFICIENTS.items()}
CONTEXTS: dict[type, Any] = {TwoWords: modular.CONTEXT, **binary.CONTEXTS}
LINE, ROWS = TupleKind((LONG,) * 4), ArrayKind(LONG, 2, 2)
WITH_DEGREES, SPAN = TupleKind((ROWS, INTS)), TupleKind((INT, INT))


def context_of(K: Any) -> TwoWords | BinaryContext:
    """That of GF(p), p odd, or GF(2^n), n > 1."""
    if K.characteristic == 2:
        return binary_context(sum(c << i for i, c in enumerate(K.modulus)))
    return two_words(K.p)


def _chosen(step: Any) -> Any:
    """A step of each model, known when it is compiled."""
    return lambda b, K, C, *arguments: b.call(STEPS[step][C.kind.named], [K, C, *arguments])


def _library(name: str, context: type, model: type, entries: dict[str, Any]) -> Library:
    operations = modular.MODULAR if context is TwoWords else binary.binary_functions()
    special = operations | {step: _chosen(step) for step in STEPS}
    return Library(f"{model.__name__.lower()}_{name}_of_{context.__name__.lower()}", entries, special)


def _single(context: type, model: type) -> Library:
    K, C = CONTEXTS[context], MODELS[model]
    entries = {
        "add_lines": (add_lines, (K, C, LINE, LINE)),
        "double_line": (double_line, (K, C, LINE)),
        "multiple_line": (multiple_line, (K, C, LINE, INTS, ROWS)),
    }
    return _library("classes", context, model, entries)


def _rows(context: type, model: type) -> Library:
    K, C = CONTEXTS[context], MODELS[model]
    entries = {
        "add_rows": (add_rows, (K, C, WITH_DEGREES, WITH_DEGREES, ROWS, SPAN, INTS, ROWS)),
        "double_rows": (double_rows, (K, C, WITH_DEGREES, ROWS, SPAN, INTS, ROWS)),
        "negate_rows": (negate_rows, (K, LONGS, WITH_DEGREES, ROWS, SPAN)),
        "encode_rows": (encode_rows, (K, ROWS)),
        "decode_rows": (decode_rows, (K, ROWS)),
        "shift_rows": (shift_rows, (K, LONGS, ROWS, INTS)),
        "scale_rows": (scale_rows, (K, LONGS, ROWS, INTS)),
        "first_off_curve": (first_off_curve, (K, TupleKind((LONGS, LONGS)), ROWS, INTS)),
    }
    return _library("rows", context, model, entries)


_KINDS = [
    (context, model) for context in CONTEXTS for model in MODELS
    if (context is TwoWords) == (model in (Quintic, Sextic))
]  # fmt: skip
SINGLE_LIBRARIES = {kinds: _single(*kinds) for kinds in _KINDS}
"""The entries for single classes, by the types of context and equation."""
ROW_LIBRARIES = {kinds: _rows(*kinds) for kinds in _KINDS}
"""Those for rows."""
