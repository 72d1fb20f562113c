"""Sums, doublings and multiples of single classes: loops to be compiled, for every context and equation.

Explicit formulas add two classes in general position. In a special case Cantor's algorithm takes over. Over fields of
word size it is compiled too (:mod:`jacobian.addition.cantor_words`), so that one call computes any multiple. In
other contexts the loop reports the special case to its caller. Without compilation the same functions run in Python.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.addition import cantor_words
from jacobian.addition.word_steps import STEPS, keep
from jacobian.numbers.words import inverse


class Plain(namedtuple("Plain", "")):
    """Stands for an equation without explicit formulas: Cantor's algorithm computes all sums."""

    genus = 0


TOTAL, OTHER, ODD = cantor_words.ROWS, cantor_words.ROWS + 1, cantor_words.ROWS + 2
"""The rows of a scratch array for two classes and, from ODD on, for the odd multiples of a ladder."""
ROWS = ODD + 8

# --- by explicit formulas


def sum_of(K: Any, C: Any, first: Any, second: Any) -> Any:
    """Adds two classes, given as tuples of words. Returns (True, the sum), or (False, ``first``) if the explicit
    formulas do not apply.
    """
    return from_quotient(K, C, STEPS[type(C)].chord(K, C, first, second), first, second)


def double_of(K: Any, C: Any, first: Any) -> Any:
    """Doubles a class, given as a tuple of words; returns a pair as :func:`sum_of` does."""
    return from_quotient(K, C, STEPS[type(C)].tangent(K, C, first), first, first)


def from_quotient(K: Any, C: Any, quotient: Any, first: Any, second: Any) -> Any:
    """The result of :func:`sum_of` or :func:`double_of`, from the quotient that ``chord`` or ``tangent`` returned."""
    multiple = K.canonical(STEPS[type(C)].product(K, C, quotient))
    if multiple == 0:
        return False, first
    return True, STEPS[type(C)].closed(K, C, quotient, inverse(K, multiple), first, second)


def returned(K: Any, C: Any, general: Any, found: Any) -> Any:
    """Returns (u, v, valid): u and v are the class ``found`` as residues; ``valid`` says whether the formulas applied
    (``general``) and v has degree g − 1.
    """
    u, v = STEPS[type(C)].decoded(K, C, found)
    return u, v, general and v[len(v) - 1] != 0


def add_classes(K: Any, C: Any, u: Any, v: Any, other_u: Any, other_v: Any) -> Any:
    """Adds two classes of weight g, given as residues; returns the triple of :func:`returned`."""
    general, found = sum_of(K, C, STEPS[type(C)].encoded(K, C, u, v), STEPS[type(C)].encoded(K, C, other_u, other_v))
    return returned(K, C, general, found)


def double_class(K: Any, C: Any, u: Any, v: Any) -> Any:
    """Doubles a class of weight g, given as residues; returns the triple of :func:`returned`."""
    general, found = double_of(K, C, STEPS[type(C)].encoded(K, C, u, v))
    return returned(K, C, general, found)


def multiple_of_class(K: Any, C: Any, u: Any, v: Any, scalar: Any, digits: Any, odd: Any) -> Any:
    """Multiplies a class of weight g by a scalar > 0 in little-endian bytes; returns the triple of :func:`returned`.

    Scratch memory: ``digits`` has a zero for each bit of the scalar and one more, ``odd`` a column for each odd
    multiple.
    """
    position, first = signed_windows(scalar, 5, digits), STEPS[type(C)].encoded(K, C, u, v)
    keep(odd, 0, first)
    general, double = double_of(K, C, first)
    for i in range(1, odd.shape[1]):
        fine, found = sum_of(K, C, STEPS[type(C)].class_at(K, C, odd, i - 1), double)
        general = general and fine
        keep(odd, i, found)
    total = STEPS[type(C)].class_at(K, C, odd, digits[position] >> 1)
    while general and position > 0:
        position -= 1
        general, total = double_of(K, C, total)
        digit = digits[position]
        if digit != 0:
            term = STEPS[type(C)].class_at(K, C, odd, abs(digit) >> 1)
            if digit < 0:
                term = STEPS[type(C)].opposite(K, C, term)
            fine, total = sum_of(K, C, total, term)
            general = general and fine
    return returned(K, C, general, total)


def signed_windows(scalar: Any, width: int, digits: Any) -> Any:
    """Writes the :func:`jacobian.addition.ladder.signed_digits` of a scalar > 0 into ``digits``, an array of zeros.
    Returns the index of the most significant digit.
    """
    size, position, carry, last = 8 * len(scalar), 0, 0, 0
    while position <= size:
        bit = scalar[position >> 3] >> (position & 7) & 1 if position < size else 0
        if (bit + carry) & 1 == 0:
            position += 1
        else:
            digit = carry
            for i in range(min(width, size - position)):
                digit += (scalar[(position + i) >> 3] >> ((position + i) & 7) & 1) << i
            carry = digit >> (width - 1)
            digits[position] = digit - (carry << width)
            last = position
            position += width
    return last


# --- over fields of word size: classes and curve are arrays of :mod:`jacobian.addition.cantor_words`


def plus(K: Any, C: Any, curve: Any, S: Any, a: Any, b: Any, result: Any) -> None:
    """result = a + b by explicit formulas where they apply, else by Cantor's algorithm; the three may be one array."""
    g = curve[0]
    if C.genus > 0:  # noqa: SIM102  # known at compile time: the steps below are not compiled for Plain
        if a[0] == g + 1 and b[0] == g + 1:
            general, found = sum_of(K, C, STEPS[type(C)].class_in(K, C, a), STEPS[type(C)].class_in(K, C, b))
            if general:
                put(K, g, found, result)
                return
    cantor_words.add_classes(K, curve, S, a, b, result)


def twice(K: Any, C: Any, curve: Any, S: Any, a: Any, result: Any) -> None:
    """result = a + a by explicit formulas where they apply, else by Cantor's algorithm; ``result`` may be a."""
    g = curve[0]
    if C.genus > 0:  # noqa: SIM102  # known at compile time: the steps below are not compiled for Plain
        if a[0] == g + 1:
            general, found = double_of(K, C, STEPS[type(C)].class_in(K, C, a))
            if general:
                put(K, g, found, result)
                return
    cantor_words.double_class(K, curve, S, a, result)


def put(K: Any, g: Any, found: Any, result: Any) -> None:
    """Writes ``found``, the words of a class with deg u = g and n = 0, to ``result``, an array as in
    :mod:`jacobian.addition.cantor_words`.
    """
    place = g + 2
    for x in found:
        result[place] = x
        place = place - 1 if place > 3 else 2 * g + 3
    size = g
    while size > 0 and result[g + 3 + size] == 0:
        size -= 1
    result[0], result[1], result[2], result[g + 3] = g + 1, size, 0, K.one


def enter(K: Any, g: Any, data: Any, header: Any, begin: Any, a: Any) -> Any:
    """Reads a class from ``data`` into the array ``a``; returns the index after its last coefficient.

    In ``data`` the lengths and the weight begin at index ``header``, the coefficients at index ``begin``.
    """
    nu, nv = data[header], data[header + 1]
    for i in range(2 * g + 4):
        a[i] = 0
    a[0], a[1], a[2] = nu, nv, data[header + 2]
    for i in range(nu):
        a[3 + i] = K.to_word(data[begin + i])
    for i in range(nv):
        a[4 + g + i] = K.to_word(data[begin + nu + i])
    return begin + nu + nv


def leave(K: Any, g: Any, a: Any, data: Any) -> None:
    """Writes the class ``a`` into ``data``, its words decoded to field elements."""
    data[0], data[1], data[2] = a[0], a[1], a[2]
    for i in range(3, 2 * g + 4):
        data[i] = K.from_word(a[i])


def sum_in_place(K: Any, C: Any, curve: Any, S: Any, data: Any) -> None:
    """Replaces two classes in ``data`` by their sum; S is working memory of ROWS rows."""
    g, total, other = curve[0], S[TOTAL], S[OTHER]
    enter(K, g, data, 3, enter(K, g, data, 0, 6, total), other)
    cantor_words.add_classes(K, curve, S, total, other, total)
    leave(K, g, total, data)


def multiple_in_place(K: Any, C: Any, curve: Any, S: Any, data: Any, scalar: Any, digits: Any) -> None:
    """Multiplies the class in ``data``; ``scalar`` and ``digits`` are as in :func:`multiple_of_class`."""
    g, total, other = curve[0], S[TOTAL], S[OTHER]
    width = 2 if len(scalar) < 2 else 4 if len(scalar) < 24 else 5
    position = signed_windows(scalar, width, digits)
    enter(K, g, data, 0, 3, S[ODD])
    if width > 2:
        twice(K, C, curve, S, S[ODD], other)
    for i in range(1, 1 << (width - 2)):
        plus(K, C, curve, S, S[ODD + i - 1], other, S[ODD + i])
    start = S[ODD + (digits[position] >> 1)]
    for i in range(2 * g + 4):
        total[i] = start[i]
    while position > 0:
        position -= 1
        twice(K, C, curve, S, total, total)
        digit = digits[position]
        if digit > 0:
            plus(K, C, curve, S, total, S[ODD + (digit >> 1)], total)
        elif digit < 0:
            cantor_words.negate_class(K, curve, S, S[ODD + (-digit >> 1)], other)
            plus(K, C, curve, S, total, other, total)
    leave(K, g, total, data)
