"""Loops over rows of any genus, to be compiled: conversions, negation, selection, and Cantor's algorithm.

Rows are stored as in :mod:`jacobian.batch.block_loops`: column i of ``x`` holds u₀ … u_{g−1} (with the leading 1 if deg
u < g) and v₀ … v_{g−1}; ``degree[i]`` is deg u and, on a split model, ``weight[i]`` its weight at ∞₊. Cantor's
algorithm is that of :mod:`jacobian.addition.cantor_words`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from jacobian.addition.cantor_words import add_classes, double_class, negate_class

# --- conversions


def encode_rows(K: Any, elements: Any, out: Any) -> None:
    """Writes the words of field elements, given as ints, to ``out``, which may be the array ``elements`` itself."""
    for k in range(elements.shape[0]):
        for i in range(elements.shape[1]):
            out[k, i] = K.to_word(elements[k, i])


def decode_rows(K: Any, x: Any, out: Any) -> None:
    """Writes the field elements, as ints, of the words x to ``out``, which may be the array x itself."""
    for k in range(x.shape[0]):
        for i in range(x.shape[1]):
            out[k, i] = K.from_word(x[k, i])


def reduced(K: Any, a: Any, c: Any, u: Any) -> Any:
    """a − cu, canonical."""
    return K.canonical(K.sub(a, K.canonical(K.dot(c, u))))


def modulo_u(K: Any, a: Any, x: Any, j: Any, degree: Any, R: Any) -> None:
    """Sets R[0] to the polynomial ``a`` modulo the u of row j, by Horner's rule."""
    for k in range(R.shape[1]):
        R[0, k] = 0
    for k in range(len(a) if degree > 0 else 0):
        lead = R[0, degree - 1]
        for i in range(degree - 1):
            m = degree - 1 - i
            R[0, m] = reduced(K, R[0, m - 1], lead, x[m, j])
        R[0, 0] = reduced(K, a[len(a) - 1 - k], lead, x[0, j])


def shift_rows(K: Any, shift: Any, x: Any, degree: Any, R: Any) -> None:
    """Replaces v by v + shift modulo u in every row. R (3, g) is scratch memory for polynomials."""
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        modulo_u(K, shift, x, j, degree[j], R)
        for k in range(g):
            x[g + k, j] = K.canonical(K.add(x[g + k, j], R[0, k]))


def scale_rows(K: Any, powers: Any, x: Any, degree: Any) -> None:
    """Replaces each point (x, y) of every row's divisor by (cx, c^g·y); powers[k] = c^k for k ≤ g."""
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        for k in range(g):
            if k < degree[j]:
                x[k, j] = K.canonical(K.dot(x[k, j], powers[degree[j] - k]))
            x[g + k, j] = K.canonical(K.dot(x[g + k, j], powers[g - k]))


def first_off_curve(K: Any, equation: Any, x: Any, degree: Any, R: Any) -> Any:
    """The first row whose u does not divide v(v + h) − f, or −1; ``equation`` is (h, f)."""
    h, f = equation
    g = x.shape[0] >> 1
    for j in range(x.shape[1]):
        d = degree[j]
        modulo_u(K, h, x, j, d, R)
        for k in range(g):
            R[1, k], R[2, k] = K.canonical(K.add(x[g + k, j], R[0, k])), 0
        # R[2] becomes v·R[1] modulo u, by Horner's rule
        for i in range(d):
            c, lead = x[g + d - 1 - i, j], R[2, d - 1]
            for n in range(d):
                m = d - 1 - n
                more = K.canonical(K.dot(c, R[1, m], K.neg(lead), x[m, j]))
                R[2, m] = K.canonical(K.add(R[2, m - 1], more)) if m > 0 else more
        modulo_u(K, f, x, j, d, R)
        for k in range(g):
            if R[0, k] != R[2, k]:
                return j
    return -1


# --- the group law


def negate_rows(K: Any, h: Any, first: Any, out: Any, span: Any, R: Any) -> None:
    """Writes the negatives (u, −v − h modulo u) of the rows of a span (begin, end); ``first`` is (x, degrees)."""
    (x, degree), (begin, end) = first, span
    g = x.shape[0] >> 1
    for k in range(g):
        for j in range(begin, end):
            out[k, j] = x[k, j]
            out[g + k, j] = K.neg(x[g + k, j])
    if len(h) > 0:
        for j in range(begin, end):
            modulo_u(K, h, x, j, degree[j], R)
            for k in range(g):
                out[g + k, j] = K.canonical(K.sub(out[g + k, j], R[0, k]))


def select_rows(tables: Any, choice: Any, out: Any) -> None:
    """Copies row i of table choice[i] into row i of ``out``; ``tables`` and ``out`` are (rows, degrees, weights)."""
    (data, degrees, weights), (x, degree, weight) = tables, out
    for k in range(x.shape[0]):
        for i in range(x.shape[1]):
            x[k, i] = data[choice[i], k, i]
    for i in range(x.shape[1]):
        degree[i] = degrees[choice[i], i]
    for i in range(len(weight)):
        weight[i] = weights[choice[i], i]


class Room(NamedTuple):
    """The memory of Cantor's algorithm: its scratch, and two classes."""

    scratch: Any
    a: Any
    b: Any


def take(K: Any, g: Any, rows: Any, i: Any, a: Any) -> None:
    """Writes row i to ``a``, as a class of :mod:`jacobian.addition.cantor_words`."""
    x, degree, weight = rows
    size = 0
    for k in range(g):
        a[3 + k] = x[k, i]
        a[4 + g + k] = x[g + k, i]
        if x[g + k, i] != 0:
            size = k + 1
    a[3 + g] = K.one if degree[i] == g else 0
    a[0], a[1], a[2] = degree[i] + 1, size, weight[i] if len(weight) > 0 else 0


def put(g: Any, a: Any, rows: Any, i: Any) -> None:
    """Stores the class ``a``, an array as in :mod:`jacobian.addition.cantor_words`, as row i."""
    out, degree, weight = rows
    degree[i] = a[0] - 1
    for k in range(g):
        out[k, i] = a[3 + k]
        out[g + k, i] = a[4 + g + k]
    if len(weight) > 0:
        weight[i] = a[2]


def cantor_add(K: Any, curve: Any, operands: Any, out: Any, chosen: Any, room: Any) -> None:
    """Sets out = first + second, the operands, in the rows whose indices are in ``chosen``."""
    (first, second), g = operands, curve[0]
    for i in chosen:
        take(K, g, first, i, room.a)
        take(K, g, second, i, room.b)
        add_classes(K, curve, room.scratch, room.a, room.b, room.a)
        put(g, room.a, out, i)


def cantor_double(K: Any, curve: Any, operands: Any, out: Any, chosen: Any, room: Any) -> None:
    """Sets out = 2·first, the only operand, in the rows whose indices are in ``chosen``."""
    g = curve[0]
    for i in chosen:
        take(K, g, operands[0], i, room.a)
        double_class(K, curve, room.scratch, room.a, room.a)
        put(g, room.a, out, i)


def cantor_negate(K: Any, curve: Any, operands: Any, out: Any, chosen: Any, room: Any) -> None:
    """Sets out = −first, the only operand, in the rows whose indices are in ``chosen``."""
    g = curve[0]
    for i in chosen:
        take(K, g, operands[0], i, room.a)
        negate_class(K, curve, room.scratch, room.a, room.a)
        put(g, room.a, out, i)
