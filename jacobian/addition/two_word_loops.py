"""Loops on numbers of two words, for :mod:`jacobian.native`: genus 2 and 3 over GF(p), genus 2 over GF(2^n), n ≤ 127.

The formulas are those of one word. The loops are the same for both genera, whose differences are in
:mod:`jacobian.addition.two_word_steps`. Loops over rows make one inversion for BLOCK rows (Montgomery 1987). For single
classes there are a sum, a double and a whole ladder. Special cases are reported and left to the caller. All loops also
run unchanged on Python ints.
"""

from __future__ import annotations

from typing import Any

from jacobian.addition.two_word_steps import (
    class_at,
    closed,
    decoded,
    encoded,
    negated,
    of_double,
    of_sum,
    quotient_at,
    to_invert,
)
from jacobian.numbers.two_words import long
from jacobian.numbers.words import add, decode, dot2, encode, inverse, mul, neg, sub

BLOCK = 256
SCRATCH = 6
"""Numbers of scratch for a row: the product to be inverted, the product of those of the earlier rows, the quotient."""

# --- rows


def keep(x: Any, j: Any, found: Any) -> None:
    """Store a class as row j."""
    g = len(found) >> 1
    k = g - 1
    for a in found:
        x[k, j] = a
        k = 2 * g - 1 if k == 0 else k - 1


def opened(K: Any, C: Any, S: Any, j: Any, total: Any, quotient: Any) -> Any:
    """Stores the first half of a row in the scratch array. Returns the running product times this row's product, unless
    that is 0.
    """
    multiple = to_invert(K, C, quotient)
    S[0, j], S[1, j] = multiple, total
    k = 2
    for a in quotient:
        S[k, j] = a
        k += 1
    return total if multiple == 0 else mul(K, total, multiple)


def closed_block(K: Any, C: Any, S: Any, block: Any, total: Any, rows: Any, special: Any, count: Any) -> Any:
    """Computes the sums of a block (start, size) from the product of all its general rows; ``rows`` is (x, y, out).

    Returns the number of special rows so far.
    """
    (start, size), (x, y, out) = block, rows
    back = inverse(K, total)
    for k in range(size):
        j = size - 1 - k
        if S[0, j] == 0:
            special[count] = start + j
            count += 1
        else:
            first, second = class_at(K, C, x, start + j), class_at(K, C, y, start + j)
            found = closed(K, C, quotient_at(K, C, S, j), mul(K, back, S[1, j]), first, second)
            back = mul(K, back, S[0, j])
            keep(out, start + j, found)
    return count


def is_same(x: Any, y: Any, j: Any) -> Any:
    """Whether row j is equal in x and y."""
    k = 0
    while k < x.shape[0] and x[k, j] == y[k, j]:
        k += 1
    return k == x.shape[0]


def add_rows(K: Any, C: Any, first: Any, second: Any, out: Any, span: Any, special: Any, S: Any) -> Any:
    """Sets out[:, j] = x[:, j] + y[:, j] for the general rows of a span (begin, end). Returns the number of other rows,
    whose indices are written into ``special``. ``first`` is x with its degrees in the span, ``second`` y likewise.
    """
    (x, x_degree), (y, y_degree), (begin, end) = first, second, span
    g, count = x.shape[0] >> 1, 0
    for start in range(begin, end, BLOCK):
        total, size = K.one, min(BLOCK, end - start)
        for j in range(size):
            i = start + j
            S[0, j] = 0
            if x_degree[i - begin] == g and y_degree[i - begin] == g:
                D = class_at(K, C, x, i)
                if is_same(x, y, i):
                    total = opened(K, C, S, j, total, of_double(K, C, D))
                else:
                    total = opened(K, C, S, j, total, of_sum(K, C, D, class_at(K, C, y, i)))
        count = closed_block(K, C, S, (start, size), total, (x, y, out), special, count)
    return count


def double_rows(K: Any, C: Any, first: Any, out: Any, span: Any, special: Any, S: Any) -> Any:
    """As :func:`add_rows`, for out[:, j] = 2x[:, j]."""
    (x, degree), (begin, end) = first, span
    g, count = x.shape[0] >> 1, 0
    for start in range(begin, end, BLOCK):
        total, size = K.one, min(BLOCK, end - start)
        for j in range(size):
            S[0, j] = 0
            if degree[start + j - begin] == g:
                total = opened(K, C, S, j, total, of_double(K, C, class_at(K, C, x, start + j)))
        count = closed_block(K, C, S, (start, size), total, (x, x, out), special, count)
    return count


def modulo_u(K: Any, a: Any, x: Any, j: Any, degree: Any, R: Any) -> None:
    """R[0] becomes the polynomial with coefficients a modulo the u of row j, by Horner's rule."""
    for k in range(R.shape[1]):
        R[0, k] = 0
    for k in range(len(a) if degree > 0 else 0):
        lead = R[0, degree - 1]
        for i in range(degree - 1):
            m = degree - 1 - i
            R[0, m] = sub(K, R[0, m - 1], mul(K, lead, x[m, j]))
        R[0, 0] = sub(K, a[len(a) - 1 - k], mul(K, lead, x[0, j]))


def negate_rows(K: Any, C: Any, h: Any, first: Any, out: Any, span: Any, R: Any) -> None:
    """Negates the rows of a span: (u, v) → (u, −v − h modulo u). ``first`` is x with its degrees there. R (3, g) is
    scratch for polynomials, here and below.
    """
    (x, degree), (begin, end) = first, span
    g = x.shape[0] >> 1
    for j in range(begin, end):
        if degree[j - begin] == g:
            keep(out, j, negated(K, C, class_at(K, C, x, j)))
        else:
            modulo_u(K, h, x, j, degree[j - begin], R)
            for k in range(g):
                out[k, j], out[g + k, j] = x[k, j], neg(K, add(K, x[g + k, j], R[0, k]))


def encode_rows(K: Any, x: Any) -> None:
    """Replaces residues by their words."""
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            x[k, j] = encode(K, x[k, j])


def decode_rows(K: Any, x: Any) -> None:
    """Replaces words by their residues."""
    for k in range(x.shape[0]):
        for j in range(x.shape[1]):
            x[k, j] = decode(K, x[k, j])


def shift_rows(K: Any, shift: Any, x: Any, degree: Any, R: Any) -> None:
    """v → v + shift modulo u in every row, in place."""
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        modulo_u(K, shift, x, j, degree[j], R)
        for k in range(g):
            x[g + k, j] = add(K, x[g + k, j], R[0, k])


def scale_rows(K: Any, powers: Any, x: Any, degree: Any) -> None:
    """(x, y) → (cx, c^g·y) on the points of every row, in place, powers[k] = cᵏ."""
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        for k in range(g):
            if k < degree[j]:
                x[k, j] = mul(K, x[k, j], powers[degree[j] - k])
            x[g + k, j] = mul(K, x[g + k, j], powers[g - k])


def first_off_curve(K: Any, equation: Any, x: Any, degree: Any, R: Any) -> Any:
    """The first row whose u does not divide v(v + h) − f, or −1; ``equation`` is (h, f)."""
    h, f = equation
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        d = degree[j]
        modulo_u(K, h, x, j, d, R)
        for k in range(g):
            R[1, k], R[2, k] = add(K, x[g + k, j], R[0, k]), 0
        # R[2] = v·R[1] modulo u, by Horner's rule
        for i in range(d):
            c, lead = x[g + d - 1 - i, j], R[2, d - 1]
            for n in range(d):
                m = d - 1 - n
                before = R[2, m - 1] if m > 0 else long(0)
                R[2, m] = add(K, before, dot2(K, c, R[1, m], neg(K, lead), x[m, j]))
        modulo_u(K, f, x, j, d, R)
        for k in range(g):
            if R[0, k] != R[2, k]:
                return j
    return -1


# --- single classes


def sum_of_classes(K: Any, C: Any, quotient: Any, first: Any, second: Any) -> Any:
    """(whether the case is general, the sum), in words."""
    multiple = to_invert(K, C, quotient)
    if multiple == 0:
        return False, first
    return True, closed(K, C, quotient, inverse(K, multiple), first, second)


def add_classes(K: Any, C: Any, D: Any, E: Any) -> Any:
    """(whether the case is general, the sum), in residues."""
    first, second = encoded(K, C, D), encoded(K, C, E)
    general, found = sum_of_classes(K, C, of_sum(K, C, first, second), first, second)
    return general, decoded(K, C, found)


def double_class(K: Any, C: Any, D: Any) -> Any:
    """(whether the case is general, the double), in residues."""
    first = encoded(K, C, D)
    general, found = sum_of_classes(K, C, of_double(K, C, first), first, first)
    return general, decoded(K, C, found)


def multiple_of_class(K: Any, C: Any, D: Any, digits: Any, odd: Any) -> Any:
    """(whether all cases are general, m·D), in residues, for m = Σ digits[i]·2^i with a positive last digit.

    The digits are those of :func:`jacobian.addition.ladder.signed_digits`. ``odd`` is scratch with one row for each odd
    digit value.
    """
    first = encoded(K, C, D)
    keep(odd, 0, first)
    general, double = sum_of_classes(K, C, of_double(K, C, first), first, first)
    for i in range(1, odd.shape[1]):
        before = class_at(K, C, odd, i - 1)
        fine, found = sum_of_classes(K, C, of_sum(K, C, before, double), before, double)
        general = general and fine
        keep(odd, i, found)
    position = len(digits) - 1
    total = class_at(K, C, odd, digits[position] >> 1)
    while general and position > 0:
        position -= 1
        general, total = sum_of_classes(K, C, of_double(K, C, total), total, total)
        digit = digits[position]
        if digit != 0:
            term = class_at(K, C, odd, abs(digit) >> 1)
            if digit < 0:
                term = negated(K, C, term)
            fine, total = sum_of_classes(K, C, of_sum(K, C, total, term), total, term)
            general = general and fine
    return general, decoded(K, C, total)
