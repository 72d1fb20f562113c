"""Miller's loop on an elliptic curve over GF(p), p odd: the value of Miller's function at a point, without inversions.

For m·P = 0 this function f has the divisor m·P − m·∞ and the leading coefficient 1 at ∞. Each step of the loop doubles
or adds in Jacobian coordinates x = X/Z², y = Y/Z³ (Cohen, Miyaji and Ono 1998). It multiplies f by the equation of a
line, divided by that of a vertical line (Miller 2004). The loop is compiled by :mod:`jacobian.native` for p < 2^128,
and runs unchanged on Python's ints.
"""

from __future__ import annotations

from functools import cache
from itertools import count
from typing import Any

import numpy as np

from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.prime import PrimeField
from jacobian.law.divisor import Divisor
from jacobian.native.kinds import INTS, LONG, TupleKind
from jacobian.native.library import Library
from jacobian.native.modular import CONTEXT
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.two_words import BITS, Residues, two_words


def doubled(K: Any, cubic: Any, T: Any, x: Any, y: Any) -> Any:
    """(2T, numerator, denominator). The quotient is the value at (x, y) of the tangent at T, divided by that of the
    vertical line through 2T.

    T must not be 0; ``cubic`` is (a, b) of y² = x³ + ax² + bx + c.
    """
    (a, b), (X, Y, Z) = cubic, T
    zero, square, YY = K.sub(Z, Z), K.dot(Z, Z), K.dot(Y, Y)
    off = K.sub(K.dot(square, x), X)
    if zero == Y:
        return (K.one, K.one, zero), off, square
    XX, twice = K.dot(X, X), K.add(YY, YY)
    bent = K.dot(K.add(X, X), K.dot(a, square), K.dot(b, square), square)
    slope = K.add(K.add(XX, bent), K.add(XX, XX))
    z, four = K.dot(K.add(Y, Y), Z), K.add(twice, twice)
    zz, S = K.dot(z, z), K.dot(X, four)
    found = K.sub(K.sub(K.dot(slope, slope), K.dot(a, zz)), K.add(S, S))
    height = K.sub(K.dot(slope, K.sub(S, found)), K.dot(four, twice))
    line = K.sub(K.sub(K.dot(K.dot(z, square), y), twice), K.dot(slope, off))
    return (found, height, z), K.dot(line, z), K.dot(K.sub(K.dot(zz, x), found), square)


def added(K: Any, cubic: Any, T: Any, P: Any, x: Any, y: Any) -> Any:
    """T + P in the form of :func:`doubled`. For T = P, where a doubling is needed, the numerator is 0."""
    (X, Y, Z), (px, py) = T, P
    zero, square = K.sub(Z, Z), K.dot(Z, Z)
    H, r = K.sub(K.dot(px, square), X), K.sub(K.dot(py, K.dot(square, Z)), Y)
    if zero == Z:
        return (px, py, K.one), K.one, K.one
    if zero == H:
        return (K.one, K.one, zero), zero if r == zero else K.sub(x, px), K.one
    z, HH = K.dot(Z, H), K.dot(H, H)
    zz, XH, HHH = K.dot(z, z), K.dot(X, HH), K.dot(HH, H)
    found = K.sub(K.sub(K.dot(r, r), K.dot(cubic[0], zz)), K.add(HHH, K.add(XH, XH)))
    height = K.sub(K.dot(r, K.sub(XH, found)), K.dot(Y, HHH))
    line = K.sub(K.dot(z, K.sub(y, py)), K.dot(r, K.sub(x, px)))
    return (found, height, z), K.dot(line, z), K.sub(K.dot(zz, x), found)


def function_at(K: Any, cubic: Any, P: Any, Q: Any, bits: Any) -> Any:
    """(Z, numerator, denominator): the Jacobian coordinate Z of m·P, 0 if m·P = 0, and Miller's function of P at Q.

    ``bits`` are the bits of m after the first. The numerator or the denominator is 0 where a line of the loop passes
    through Q.
    """
    (x, y), over, under = Q, K.one, K.one
    T = P[0], P[1], K.one
    for k in range(len(bits)):
        over, under = K.dot(over, over), K.dot(under, under)
        if T[2] != K.sub(x, x):
            T, s, t = doubled(K, cubic, T, x, y)
            over, under = K.dot(over, s), K.dot(under, t)
        if bits[k] == 1:
            T, s, t = added(K, cubic, T, P, x, y)
            over, under = K.dot(over, s), K.dot(under, t)
    return T[2], over, under


PAIR = TupleKind((LONG, LONG))
LIBRARY = Library("miller", {"function_at": (function_at, (CONTEXT, PAIR, PAIR, PAIR, INTS))})


COLD = 1000
"""The number of runs of the loop in Python that take as long as its compilation, 0.4 s (``python -m benchmarks
pairing``).
"""
CALLS = count()


def _is_compiled() -> bool:
    return not interpreted() and (is_kept() or next(CALLS) >= COLD)


@cache
def is_kept() -> bool:
    """Whether the compiled loop was on disk when this function was first called."""
    return LIBRARY.is_kept()


class EllipticFunctions:
    """Miller's functions on a curve for which :func:`has_functions` is true."""

    def __init__(self, C: HyperellipticCurve) -> None:
        field: Any = C.field
        p = field.p
        self._half_h = tuple(c * (p + 1) // 2 for c in C.h)
        h = (*self._half_h, 0, 0)
        # Y = lead·(y + h/2) and X = lead·x: Y² = X³ + aX² + bX + c
        f, g = (*C.f, 0, 0), (h[0] * h[0], 2 * h[0] * h[1], h[1] * h[1], 0)
        _, linear, square, lead = (f[k] + g[k] for k in range(4))
        self._compiled = p.bit_length() <= BITS and _is_compiled()
        self._words = two_words(p) if self._compiled else Residues(p)
        self._lead, self._cubic = lead, self._pair(square, lead * linear)

    def _pair(self, x: int, y: int) -> tuple[int, int]:
        K = self._words
        return K.to_word(x % K.p), K.to_word(y % K.p)

    def _point(self, D: Divisor) -> tuple[int, int]:
        x, (y, *_) = -D.u[0], (*D.v, 0)
        height = y + sum(c * x**k for k, c in enumerate(self._half_h))
        return self._pair(self._lead * x, self._lead * height)

    def __call__(self, D: Divisor, E: Divisor, m: int) -> tuple[bool, int, int]:
        """Whether m·D = 0, and the numerator and the denominator of Miller's function for D and m at the point of E.

        D and E are not 0. If the numerator or the denominator is 0, another representative of E is needed.
        """
        bits = [int(bit) for bit in bin(m)[3:]]
        given = self._words, self._cubic, self._point(D), self._point(E)
        run = LIBRARY.function_at(*given, np.array(bits, np.int64)) if self._compiled else function_at(*given, bits)
        end, over, under = run
        return end == 0, self._words.from_word(over), self._words.from_word(under)


def has_functions(C: HyperellipticCurve) -> bool:
    """Whether C has genus 1 and one point at infinity, over GF(p) with p odd."""
    return C.genus == 1 and C.model == "ramified" and type(C.field) is PrimeField and C.field.p > 2
