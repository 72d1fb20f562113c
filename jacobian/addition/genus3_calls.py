"""One addition, doubling or multiple in genus 3 over GF(p), p < 2^63 odd, each in a single compiled call.

The explicit formulas of :mod:`jacobian.addition.genus3_words` handle the general case on y² = f, f monic of degree 7.
Special cases go to the compiled Cantor of :mod:`jacobian.addition.calls`, and so does any multiple whose ladder meets
one. Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import typeof, types

from jacobian.addition.calls import JIT, SCALAR, LineKernel, compiled, entry, window_of, windows_of_bytes
from jacobian.addition.cantor import Triple
from jacobian.addition.genus3_words import chord, closed, product, short_equation, tangent
from jacobian.curve.curve import HyperellipticCurve
from jacobian.numbers.compiler import njit
from jacobian.numbers.words import canonical, decode, encode, inverse, neg

# compiled code is typed by its arguments: the functions below have no annotations of their own


@compiled
def _row(K, u, v):  # type: ignore[no-untyped-def]
    return encode(K, u[2]), encode(K, u[1]), encode(K, u[0]), encode(K, v[2]), encode(K, v[1]), encode(K, v[0])


@compiled
def _closed(K, C, quotient, first, second):  # type: ignore[no-untyped-def]
    """(whether the case is general, the row of the sum)."""
    multiple = canonical(K, product(K, quotient))
    if multiple == 0:
        return False, first
    return True, closed(K, C, quotient, inverse(K, multiple), first, second)


@compiled
def _sum(K, C, first, second):  # type: ignore[no-untyped-def]
    return _closed(K, C, chord(K, first, second), first, second)


@compiled
def _twice(K, C, first):  # type: ignore[no-untyped-def]
    return _closed(K, C, tangent(K, C, first), first, first)


@compiled
def _returned(K, general, row):  # type: ignore[no-untyped-def]
    """(u, v) in residues; v₂ = 0 marks a special case, which the caller must add by the general algorithm."""
    u2, u1, u0, v2, v1, v0 = row
    v = (decode(K, v0), decode(K, v1), decode(K, v2)) if general else (0, 0, 0)
    return (decode(K, u0), decode(K, u1), decode(K, u2), 1), v


@njit(**JIT)
def add_cubics(K, C, u1, v1, u2, v2):  # type: ignore[no-untyped-def]
    """(u, v) of the sum of two classes of weight 3; v₂ = 0 means that the general algorithm has to add them."""
    general, row = _sum(K, C, _row(K, u1, v1), _row(K, u2, v2))
    return _returned(K, general, row)


@njit(**JIT)
def double_cubic(K, C, u, v):  # type: ignore[no-untyped-def]
    """As :func:`add_cubics`, for doubling one class."""
    general, row = _twice(K, C, _row(K, u, v))
    return _returned(K, general, row)


@compiled
def _at(odd, i):  # type: ignore[no-untyped-def]
    return odd[i, 0], odd[i, 1], odd[i, 2], odd[i, 3], odd[i, 4], odd[i, 5]


@compiled
def _keep(odd, i, row):  # type: ignore[no-untyped-def]
    odd[i, 0], odd[i, 1], odd[i, 2], odd[i, 3], odd[i, 4], odd[i, 5] = row


@njit(nogil=True, **JIT)
def multiple_of_cubic(K, C, u, v, scalar):  # type: ignore[no-untyped-def]
    """As :func:`add_cubics`, for the multiple of one class by a scalar > 0 given as little-endian bytes."""
    window = window_of(scalar)
    digits, odd = windows_of_bytes(scalar, window), np.empty((1 << (window - 2), 6), np.int64)
    first = _row(K, u, v)
    _keep(odd, 0, first)
    general, double = _twice(K, C, first) if len(odd) > 1 else (True, first)
    for i in range(1, len(odd)):
        fine, found = _sum(K, C, _at(odd, i - 1), double)
        general = general and fine
        _keep(odd, i, found)
    position = len(digits) - 1
    while digits[position] == 0:
        position -= 1
    total = _at(odd, digits[position] >> 1)
    while general and position > 0:
        position -= 1
        general, total = _twice(K, C, total)
        digit = digits[position]
        if digit != 0 and general:
            a2, a1, a0, b2, b1, b0 = _at(odd, abs(digit) >> 1)
            if digit < 0:
                b2, b1, b0 = neg(K, b2), neg(K, b1), neg(K, b0)
            general, total = _sum(K, C, total, (a2, a1, a0, b2, b1, b0))
    return _returned(K, general, total)


class CubicKernel(LineKernel):
    """Addition, doubling and multiples of reduced triples on one curve y² = f of genus 3, f monic of degree 7."""

    _kernels = add_cubics, double_cubic

    def __init__(self, C: HyperellipticCurve) -> None:
        super().__init__(C)
        u, v = types.UniTuple(types.int64, 4), types.UniTuple(types.int64, 3)
        self._multiple = entry(multiple_of_cubic, typeof(self._K), typeof(self._equation), u, v, SCALAR)

    def _short_equation(self, C: HyperellipticCurve) -> Any:
        return short_equation(C, self._K.to_word)

    def multiple(self, m: int, a: Triple) -> Triple:
        """The reduced triple of m·a, m > 0."""
        u, v, _ = a
        if len(v) == 3:
            u, v = self._multiple(self._K, self._equation, u, v, m.to_bytes((m.bit_length() + 7) >> 3, "little"))
            if v[-1]:
                return u, v, None
        return super().multiple(m, a)
