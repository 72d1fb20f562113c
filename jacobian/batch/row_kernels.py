"""Loops over rows of any genus: the compiled Cantor of :mod:`jacobian.addition.cantor_words`, and conversions.

Rows are (x, degree, weight), stored as in :mod:`jacobian.batch.genus2_kernels`: column i of ``x`` holds u₀ … u_{g−1}
(with the leading 1 if deg u < g) and v₀ … v_{g−1}; ``degree[i]`` is its degree and, on a split model, ``weight[i]`` its
weight at ∞₊. Importing this module imports numba.
"""

from __future__ import annotations

import numpy as np
from numba.extending import register_jitable

from jacobian.addition.cantor_words import add_classes, double_class, negate_class, scratch, width
from jacobian.batch.genus2_kernels import JIT
from jacobian.numbers import tables_compiled, words_compiled  # noqa: F401  # the compiled operations of words and tables
from jacobian.numbers.compiler import njit
from jacobian.numbers.words import add, canonical, decode, encode, mul, neg, number, sub

register_jitable(width)


@register_jitable
def take(K, g, rows, i, a):  # type: ignore[no-untyped-def]  # compiled, as all below
    """Row i as a class of :mod:`jacobian.addition.cantor_words`."""
    x, degree, weight = rows
    d = np.int64(degree[i])
    size = 0
    for k in range(g):
        a[3 + k] = x[k, i]
        a[4 + g + k] = x[g + k, i]
        if x[g + k, i] != 0:
            size = k + 1
    if d == g:
        a[3 + g] = K.one
    a[0], a[1], a[2] = d + 1, size, weight[i] if len(weight) else 0


@register_jitable
def put(g, a, rows, i):  # type: ignore[no-untyped-def]
    """Stores a class as row i."""
    out, degree, weight = rows
    degree[i] = a[0] - 1
    for k in range(g):
        out[k, i] = a[3 + k]
        out[g + k, i] = a[4 + g + k]
    if len(weight):
        weight[i] = a[2]


@njit(**JIT)
def cantor_add(K, curve, first, second, out, chosen):  # type: ignore[no-untyped-def]
    """Sets out = first + second in the rows whose indices are in ``chosen``."""
    g, S = curve[0], scratch(curve)
    a, b, c = np.zeros(width(g), np.int64), np.zeros(width(g), np.int64), np.zeros(width(g), np.int64)
    for i in chosen:
        take(K, g, first, i, a)
        take(K, g, second, i, b)
        add_classes(K, curve, S, a, b, c)
        put(g, c, out, i)


@njit(**JIT)
def cantor_double(K, curve, rows, out, chosen):  # type: ignore[no-untyped-def]
    """Sets out = 2·rows in the rows whose indices are in ``chosen``."""
    g, S = curve[0], scratch(curve)
    a = np.zeros(width(g), np.int64)
    for i in chosen:
        take(K, g, rows, i, a)
        double_class(K, curve, S, a, a)
        put(g, a, out, i)


@njit(**JIT)
def cantor_negate(K, curve, rows, out, chosen):  # type: ignore[no-untyped-def]
    """Sets out = −rows in the rows whose indices are in ``chosen``."""
    g, S = curve[0], scratch(curve)
    a = np.zeros(width(g), np.int64)
    for i in chosen:
        take(K, g, rows, i, a)
        negate_class(K, curve, S, a, a)
        put(g, a, out, i)


@njit(**JIT)
def negate_v(K, x, out, g, begin, end):  # type: ignore[no-untyped-def]
    """(u, v) → (u, −v), which is −D where h = 0, for the rows from begin to end."""
    for k in range(g):
        for i in range(begin, end):
            out[k, i] = x[k, i]
            out[g + k, i] = neg(K, number(K, x[g + k, i]))


@njit(**JIT)
def select_rows(tables, degrees, weights, choice, out, degree, weight):  # type: ignore[no-untyped-def]
    """Copies row i of table choice[i] into row i of out, for every i."""
    for k in range(out.shape[0]):
        for i in range(out.shape[1]):
            out[k, i] = tables[choice[i], k, i]
    for i in range(out.shape[1]):
        degree[i] = degrees[choice[i], i]
        if len(weight):
            weight[i] = weights[choice[i], i]


@register_jitable
def reduce_by_monic(K, a, top, u, d):  # type: ignore[no-untyped-def]
    """Reduces a, of degree at most ``top``, modulo xᵈ + u_{d−1}x^(d−1) + …, in place; higher coefficients become 0."""
    for i in range(top, d - 1, -1):
        c = a[i]
        a[i] = 0
        for j in range(d):
            a[i - d + j] = canonical(K, sub(K, a[i - d + j], canonical(K, mul(K, c, u[j]))))


@njit(**JIT)
def shift_rows(K, g, shift, x, degree):  # type: ignore[no-untyped-def]
    """v → v + shift modulo u in every row, in place; ``shift`` has g + 2 coefficients."""
    a, u = np.zeros(g + 2, np.int64), np.zeros(g, np.int64)
    for i in range(x.shape[1]):
        for k in range(g):
            u[k] = x[k, i]
            a[k] = canonical(K, add(K, np.int64(x[g + k, i]), shift[k]))
        a[g], a[g + 1] = shift[g], shift[g + 1]
        reduce_by_monic(K, a, g + 1, u, np.int64(degree[i]))
        for k in range(g):
            x[g + k, i] = a[k]


@njit(**JIT)
def scale_rows(K, g, powers, x, degree):  # type: ignore[no-untyped-def]
    """(x, y) → (cx, c^g·y) on the points of every row, in place; powers[k] = c^k for k ≤ g."""
    for i in range(x.shape[1]):
        d = np.int64(degree[i])
        for k in range(g):
            if k < d:
                x[k, i] = canonical(K, mul(K, np.int64(x[k, i]), powers[d - k]))
            x[g + k, i] = canonical(K, mul(K, np.int64(x[g + k, i]), powers[g - k]))


@njit(**JIT)
def first_off_curve(K, g, f, h, x, degree):  # type: ignore[no-untyped-def]
    """The first row whose u does not divide v² + hv − f, or −1; f has 2g + 3 coefficients, h g + 2."""
    a, u, v = np.zeros(2 * g + 3, np.int64), np.zeros(g, np.int64), np.zeros(g, np.int64)
    for i in range(x.shape[1]):
        for k in range(g):
            u[k], v[k] = x[k, i], x[g + k, i]
        for k in range(2 * g + 3):
            a[k] = neg(K, f[k])
        for j in range(g):
            for k in range(g + 2):
                c = canonical(K, add(K, h[k], v[k])) if k < g else h[k]
                a[j + k] = canonical(K, add(K, a[j + k], canonical(K, mul(K, v[j], c))))
        d = np.int64(degree[i])
        reduce_by_monic(K, a, 2 * g + 2, u, d)
        for k in range(d):
            if a[k] != 0:
                return i
    return -1


@njit(**JIT)
def encode_rows(K, elements, out):  # type: ignore[no-untyped-def]
    """The words of field elements, ints."""
    for k in range(elements.shape[0]):
        for i in range(elements.shape[1]):
            out[k, i] = encode(K, np.int64(elements[k, i]))


@njit(**JIT)
def decode_rows(K, x, out):  # type: ignore[no-untyped-def]
    """The field elements, ints, of words."""
    for k in range(x.shape[0]):
        for i in range(x.shape[1]):
            out[k, i] = decode(K, np.int64(x[k, i]))
