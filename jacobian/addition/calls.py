"""One addition, doubling or multiple of reduced triples over a word-size field, each in a single compiled call.

In genus 2, with h = 0 for odd p and a monic f on a ramified model, the explicit formulas handle the general case.
Everything else runs Cantor's algorithm (:mod:`jacobian.addition.cantor_words`), also compiled. A multiple is a whole
ladder of signed windows in one call, special cases included; in characteristic 2 it uses Cantor's algorithm only.
Importing this module imports numba; what it compiles stays on disk, in numba's cache.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from struct import Struct
from time import perf_counter
from typing import Any

import numpy as np
from numba import typeof, types
from numba.extending import register_jitable

from jacobian.addition import genus2_words_compiled  # noqa: F401  # the compiled formulas
from jacobian.addition.cantor import Triple
from jacobian.addition.cantor_words import (
    add_classes,
    double_class,
    equation,
    negate_class,
    packed_curve,
    scratch,
    width,
)
from jacobian.addition.genus2_words import (
    Quintic,
    Sextic,
    chord,
    cubic,
    product,
    short_equation,
    sum_u,
    sum_v,
    tangent,
)
from jacobian.curve.curve import HyperellipticCurve
from jacobian.fields.table import TableField
from jacobian.numbers.compiler import njit
from jacobian.numbers.tables import table_context
from jacobian.numbers.words import Wide64, canonical, decode, encode, inverse, word_context

log = logging.getLogger("jacobian")

JIT: dict[str, Any] = {"error_model": "numpy"}
compiled = register_jitable(error_model="numpy")

# compiled code is typed by its arguments: the functions below have no annotations of their own


# --- genus 2: bare coordinates in and out


@compiled
def _line(K, u, v):  # type: ignore[no-untyped-def]
    return encode(K, u[1]), encode(K, u[0]), encode(K, v[1]), encode(K, v[0])


@compiled
def _sum_of_lines(K, C, quotient, first, second):  # type: ignore[no-untyped-def]
    """(whether the case is general, (u₁, u₀, v₁, v₀) of the sum)."""
    multiple = canonical(K, product(K, C, quotient))
    if multiple == 0:
        return False, first
    bent = cubic(K, C, quotient, inverse(K, multiple), first)
    u = sum_u(K, C, bent, first, second)
    return True, (*u, *sum_v(K, C, bent, u, first))


@compiled
def _returned(K, general, line):  # type: ignore[no-untyped-def]
    """(u, v) in residues; v₁ = 0 marks a special case, which the caller must add by the general algorithm."""
    e1, e0, v1, v0 = line
    v = (decode(K, v0), decode(K, v1)) if general else (0, 0)
    return (decode(K, e0), decode(K, e1), 1), v


@njit(**JIT)
def add_lines(K, C, u1, v1, u2, v2):  # type: ignore[no-untyped-def]
    """(u, v) of the sum of two classes of weight 2; v₁ = 0 means that the general algorithm has to add them."""
    first, second = _line(K, u1, v1), _line(K, u2, v2)
    general, line = _sum_of_lines(K, C, chord(K, first, second), first, second)
    return _returned(K, general, line)


@njit(**JIT)
def double_line(K, C, u, v):  # type: ignore[no-untyped-def]
    """As :func:`add_lines`, for doubling one class."""
    first = _line(K, u, v)
    general, line = _sum_of_lines(K, C, tangent(K, C, first), first, first)
    return _returned(K, general, line)


# --- any genus: packed classes


@compiled
def _entered(K, g, data, header, begin, a):  # type: ignore[no-untyped-def]
    """Reads a class from ``data`` into a; returns the index after its last coefficient.

    Its lengths and weight stand at ``header``; its coefficients begin at ``begin``.
    """
    nu, nv = data[header], data[header + 1]
    a[:] = 0
    a[0], a[1], a[2] = nu, nv, data[header + 2]
    for i in range(nu):
        a[3 + i] = encode(K, data[begin + i])
    for i in range(nv):
        a[4 + g + i] = encode(K, data[begin + nu + i])
    return begin + nu + nv


@compiled
def _left(K, g, data, a):  # type: ignore[no-untyped-def]
    """Writes the class a into data, with its words converted to field elements."""
    data[:3] = a[:3]
    for i in range(3, width_of(g)):
        data[i] = decode(K, a[i])


width_of = compiled(width)


@compiled
def window_of(scalar):  # type: ignore[no-untyped-def]
    """The window width in bits for a scalar given as bytes."""
    return 2 if len(scalar) < 2 else 4 if len(scalar) < 24 else 5


@compiled
def windows_of_bytes(scalar, width):  # type: ignore[no-untyped-def]
    """The :func:`jacobian.addition.ladder.signed_digits` of a scalar given as bytes."""
    size = 8 * len(scalar)
    digits = np.zeros(size + 1, np.int64)
    position = carry = 0
    while position <= size:
        bit = scalar[position >> 3] >> (position & 7) & 1 if position < size else 0
        if (bit + carry) & 1 == 0:
            position += 1
            continue
        digit = carry
        for i in range(min(width, size - position)):
            digit += (scalar[(position + i) >> 3] >> ((position + i) & 7) & 1) << i
        carry = digit >> (width - 1)
        digits[position] = digit - (carry << width)
        position += width
    return digits


@compiled
def _line_of(g, a):  # type: ignore[no-untyped-def]
    return a[4], a[3], a[5 + g], a[4 + g]


@compiled
def _keep(K, a, line):  # type: ignore[no-untyped-def]
    """Writes a general sum of genus 2 into the class a, whose weight at infinity is 0."""
    a[4], a[3], a[7], a[6] = line
    a[5] = K.one
    a[0], a[1], a[2] = 3, 2 if a[7] != 0 else 1 if a[6] != 0 else 0, 0


@compiled
def _closed(K, curve, S, quotient, a, b, result):  # type: ignore[no-untyped-def]
    """Whether the case is general; if it is, sets result to a + b by the explicit formulas."""
    f, nf, _, _ = equation(curve)
    first, second = _line_of(2, a), _line_of(2, b)
    general, line = False, first
    if nf == 7:
        general, line = _sum_of_lines(K, Sextic(f[2], f[3], f[4], f[5], f[6]), quotient, first, second)
    elif f[5] == K.one:
        general, line = _sum_of_lines(K, Quintic(f[2], f[3], f[4]), quotient, first, second)
    if general:
        _keep(K, result, line)
    return general


@compiled
def _add(K, curve, S, a, b, result):  # type: ignore[no-untyped-def]
    """result = a + b; the three may be one array."""
    explicit = curve[0] == 2 and curve[3] == 0 and a[0] == 3 and b[0] == 3
    if not (explicit and _closed(K, curve, S, chord(K, _line_of(2, a), _line_of(2, b)), a, b, result)):
        add_classes(K, curve, S, a, b, result)


@compiled
def _double(K, curve, S, a, result):  # type: ignore[no-untyped-def]
    """result = a + a; the two may be one array."""
    explicit = curve[0] == 2 and curve[3] == 0 and a[0] == 3
    if not (explicit and _closed(K, curve, S, _tangent(K, curve, _line_of(2, a)), a, a, result)):
        double_class(K, curve, S, a, result)


@compiled
def _tangent(K, curve, first):  # type: ignore[no-untyped-def]
    f, nf, _, _ = equation(curve)
    if nf == 7:
        return tangent(K, Sextic(f[2], f[3], f[4], f[5], f[6]), first)
    return tangent(K, Quintic(f[2], f[3], f[4]), first)


@njit(nogil=True, **JIT)
def packed(K, curve, data, scalar):  # type: ignore[no-untyped-def]
    """Replaces the class in ``data`` by its multiple. The scalar > 0 is given as little-endian bytes. If there are no
    bytes, ``data`` holds two classes and receives their sum.

    A single function serves all curves over a field, so that the functions it calls are compiled once.
    """
    g, words, S = curve[0], np.frombuffer(data, np.int64), scratch(curve)
    window = window_of(scalar)
    odd = np.empty((1 << (window - 2), width_of(g)), np.int64)
    total, other = np.empty(width_of(g), np.int64), np.empty(width_of(g), np.int64)
    if len(scalar) == 0:
        _entered(K, g, words, 3, _entered(K, g, words, 0, 6, total), other)
        _add(K, curve, S, total, other, total)
    else:
        _entered(K, g, words, 0, 3, odd[0])
        _climb(K, curve, S, odd, windows_of_bytes(scalar, window), total, other)
    _left(K, g, words, total)


@compiled
def _climb(K, curve, S, odd, digits, total, other):  # type: ignore[no-untyped-def]
    """Sets total to m times the class odd[0]; ``digits`` are the signed digits of m. ``other`` and the other rows of
    ``odd`` are scratch."""
    for i in range(len(odd)):
        if i == 1:
            _double(K, curve, S, odd[0], other)
        if i > 0:
            _add(K, curve, S, odd[i - 1], other, odd[i])
    position = len(digits) - 1
    while digits[position] == 0:
        position -= 1
    total[:] = odd[digits[position] >> 1]
    while position > 0:
        position -= 1
        _double(K, curve, S, total, total)
        digit = digits[position]
        if digit > 0:
            _add(K, curve, S, total, odd[digit >> 1], total)
        elif digit < 0:
            negate_class(K, curve, S, odd[-digit >> 1], other)
            _add(K, curve, S, total, other, total)


# --- from Python

_DATA = types.ByteArray(types.uint8, 1, "C")
SCALAR = types.Bytes(types.uint8, 1, "C", readonly=True)
_CURVE = types.Array(types.int64, 1, "C")


def entry(function: Any, *arguments: Any) -> Callable[..., Any]:
    """The compiled version of a kernel for these argument types, loaded from disk or compiled now.

    Calling it bypasses numba's dispatch on argument types, which costs more than an addition.
    """
    if arguments not in function.overloads:
        begun = perf_counter()
        function.compile(arguments)
        if function.stats.cache_misses.get(arguments):
            log.info("compiled %s in %.1f s for %s", function.__name__, perf_counter() - begun, arguments[0])
    return function.get_overload(arguments)


class WordKernel:
    """Addition, doubling and multiples of reduced triples on one curve, an arithmetic model."""

    def __init__(self, C: HyperellipticCurve) -> None:
        self._K = context(C.field)
        self._curve = packed_curve(C, self._K.to_word)
        self._split = C.model == "split"
        self._packed = entry(packed, typeof(self._K), _CURVE, _DATA, SCALAR)
        size = width(C.genus)
        self._result, self._middle = Struct(f"{size}q"), 4 + C.genus
        # one struct for each number of words, up to two classes of full weight and space for the result
        most = 6 + 2 * (2 * C.genus + 1)
        self._structs = [Struct(f"{count}q{8 * max(0, size - count)}x") for count in range(most + 1)]

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        """The reduced triple of a + b."""
        (u1, v1, n1), (u2, v2, n2) = a, b
        count = 6 + len(u1) + len(v1) + len(u2) + len(v2)
        pack = self._structs[count].pack
        data = bytearray(pack(len(u1), len(v1), n1 or 0, len(u2), len(v2), n2 or 0, *u1, *v1, *u2, *v2))
        self._packed(self._K, self._curve, data, b"")
        return self._unpacked(data)

    def double(self, a: Triple) -> Triple:
        """The reduced triple of a + a."""
        return self.multiple(2, a)

    def multiple(self, m: int, a: Triple) -> Triple:
        """The reduced triple of m·a, m > 0."""
        u, v, n = a
        data = bytearray(self._structs[3 + len(u) + len(v)].pack(len(u), len(v), n or 0, *u, *v))
        self._packed(self._K, self._curve, data, m.to_bytes((m.bit_length() + 7) >> 3, "little"))
        return self._unpacked(data)

    def _unpacked(self, data: bytearray) -> Triple:
        words = self._result.unpack_from(data)
        nu, nv, n = words[:3]
        middle = self._middle
        return words[3 : 3 + nu], words[middle : middle + nv], n if self._split else None


class LineKernel(WordKernel):
    """The kernel of a curve of genus 2 with a short equation. Two classes of full weight are passed without packing."""

    def __init__(self, C: HyperellipticCurve) -> None:
        super().__init__(C)
        self._equation, self._full = self._short_equation(C), C.genus
        u, v = types.UniTuple(types.int64, C.genus + 1), types.UniTuple(types.int64, C.genus)
        kind, model = typeof(self._K), typeof(self._equation)
        add, double = self._kernels
        self._add_lines = entry(add, kind, model, u, v, u, v)
        self._double_line = entry(double, kind, model, u, v)
        self._weight = 0 if self._split else None

    _kernels = add_lines, double_line

    def _short_equation(self, C: HyperellipticCurve) -> Any:
        return short_equation(C, self._K.to_word)

    def sum_of(self, a: Triple, b: Triple) -> Triple:
        """The reduced triple of a + b."""
        (u1, v1, _), (u2, v2, _) = a, b
        # a class whose v has that many coefficients has full weight
        if len(v1) == self._full == len(v2):
            u, v = self._add_lines(self._K, self._equation, u1, v1, u2, v2)
            if v[-1]:
                return u, v, self._weight
        return super().sum_of(a, b)

    def double(self, a: Triple) -> Triple:
        """The reduced triple of a + a."""
        u, v, _ = a
        if len(v) == self._full:
            u, v = self._double_line(self._K, self._equation, u, v)
            if v[-1]:
                return u, v, self._weight
        return super().double(a)


def context(K: Any) -> Any:
    """The context of a word-size field. The class is the same for all primes, because each class needs a compilation
    of its own and a narrower one would save only a tenth of a multiple's time.
    """
    return table_context(K) if isinstance(K, TableField) else Wide64(*word_context(K.p, 64))


def word_kernel(C: HyperellipticCurve) -> WordKernel:
    """The compiled kernel of a curve, an arithmetic model over GF(p), p < 2^63 odd, or over a TableField."""
    return WordKernel(C) if short_equation(C, int) is None else LineKernel(C)


def is_kept(kernel: Any) -> bool:
    """Whether numba's cache seems to hold a kernel. Only file names are looked at; nothing is compiled."""
    folder = kernel.stats.cache_path
    return folder is not None and any(Path(folder).glob(f"*.{kernel.__name__}-*.nbi"))


def is_cached() -> bool:
    """Whether the cache seems to hold the kernels of every curve."""
    return is_kept(packed)
