"""The algorithms of double-double numbers, as instructions (:mod:`jacobian.native.code` writes them).

Without underflow and overflow the relative errors are at most, with u = 2^-53: sum 3u² + 13u³, product 4u², quotient
9.8u² (Joldes, Muller & Popescu 2017, algorithms 6, 12, 18; product: Muller & Rideau 2022). If y is a float, the bounds
of x + y, xy, x/y are 2u², 2u², 3u² (algorithms 4, 9, 15). The bound of the square root is 25u²/8 (Lefèvre, Louvet,
Muller, Picot & Rideau 2023, algorithm SQRTDWtoDW). The error-free sums are Knuth's (two_sum) and Dekker's
(fast_two_sum); the error-free product is by a fused multiply-add (Hida, Li & Bailey 2001). No instruction may have a
fast-math flag, with which LLVM would replace the error terms by zero.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

Float = Any  # operands and results of instructions: LLVM's values, or their names
Pair = tuple[Float, Float]


class Instructions(Protocol):
    """The interface of a writer of float instructions; each method appends one and returns its result."""

    @property
    def one(self) -> Float: ...
    def fadd(self, x: Float, y: Float) -> Float: ...
    def fsub(self, x: Float, y: Float) -> Float: ...
    def fmul(self, x: Float, y: Float) -> Float: ...
    def fdiv(self, x: Float, y: Float) -> Float: ...
    def fneg(self, x: Float) -> Float: ...
    def fma(self, x: Float, y: Float, z: Float) -> Float: ...
    def fsqrt(self, x: Float) -> Float: ...
    def unless_zero(self, x: Float, y: Float) -> Float:
        """y if x ≠ 0, and x itself if x = 0."""


def two_sum(b: Instructions, x: Float, y: Float) -> Pair:
    """The rounded sum of x and y, and its exact rounding error."""
    s = b.fadd(x, y)
    z = b.fsub(s, x)
    return s, b.fadd(b.fsub(x, b.fsub(s, z)), b.fsub(y, z))


def fast_two_sum(b: Instructions, x: Float, y: Float) -> Pair:
    """The rounded sum of x and y, and its exact rounding error, if |x| ≥ |y| or x = 0."""
    s = b.fadd(x, y)
    return s, b.fsub(y, b.fsub(s, x))


def two_product(b: Instructions, x: Float, y: Float) -> Pair:
    """The rounded product of x and y, and its exact rounding error."""
    p = b.fmul(x, y)
    return p, b.fma(x, y, b.fneg(p))


def total(b: Instructions, xh: Float, xl: Float, yh: Float, yl: Float) -> Pair:
    """x + y."""
    sh, sl = two_sum(b, xh, yh)
    th, tl = two_sum(b, xl, yl)
    vh, vl = fast_two_sum(b, sh, b.fadd(sl, th))
    return fast_two_sum(b, vh, b.fadd(tl, vl))


def total_float(b: Instructions, xh: Float, xl: Float, y: Float) -> Pair:
    """x + y for a float y."""
    sh, sl = two_sum(b, xh, y)
    return fast_two_sum(b, sh, b.fadd(xl, sl))


def product(b: Instructions, xh: Float, xl: Float, yh: Float, yl: Float) -> Pair:
    """x·y."""
    ch, c1 = two_product(b, xh, yh)
    c2 = b.fma(xl, yh, b.fma(xh, yl, b.fmul(xl, yl)))
    return fast_two_sum(b, ch, b.fadd(c1, c2))


def product_float(b: Instructions, xh: Float, xl: Float, y: Float) -> Pair:
    """x·y for a float y."""
    ch, cl = two_product(b, xh, y)
    return fast_two_sum(b, ch, b.fma(xl, y, cl))


def plus_product(b: Instructions, th: Float, tl: Float, xh: Float, xl: Float, yh: Float, yl: Float) -> Pair:
    """t + x·y, one step of a long sum. The two parts may overlap until :func:`joined` ends the sum."""
    ph, pl = two_product(b, xh, yh)
    sh, sl = two_sum(b, th, ph)
    return sh, b.fadd(tl, b.fadd(sl, b.fma(xl, yh, b.fma(xh, yl, pl))))


def joined(b: Instructions, xh: Float, xl: Float, yh: Float, yl: Float) -> Pair:
    """x + y of two sums built by :func:`plus_product`; the two parts of the result do not overlap."""
    sh, sl = two_sum(b, xh, yh)
    return fast_two_sum(b, sh, b.fadd(sl, b.fadd(xl, yl)))


def reciprocal(b: Instructions, yh: Float, yl: Float) -> Pair:
    """1/y."""
    th = b.fdiv(b.one, yh)
    rest = b.fma(b.fneg(yh), th, b.one)
    eh, el = fast_two_sum(b, rest, b.fneg(b.fmul(yl, th)))
    dh, dl = product_float(b, eh, el, th)
    return total_float(b, dh, dl, th)


def quotient(b: Instructions, xh: Float, xl: Float, yh: Float, yl: Float) -> Pair:
    """x/y."""
    return product(b, *reciprocal(b, yh, yl), xh, xl)


def quotient_of_float(b: Instructions, yh: Float, yl: Float, x: Float) -> Pair:
    """x/y for a float x."""
    return product_float(b, *reciprocal(b, yh, yl), x)


def quotient_by_float(b: Instructions, xh: Float, xl: Float, y: Float) -> Pair:
    """x/y for a float y."""
    th = b.fdiv(xh, y)
    ph, pl = two_product(b, th, y)
    rest = b.fadd(b.fsub(b.fsub(xh, ph), pl), xl)
    return fast_two_sum(b, th, b.fdiv(rest, y))


def square_root(b: Instructions, xh: Float, xl: Float) -> Pair:
    """√x."""
    sh = b.fsqrt(xh)
    rest = b.fadd(xl, b.fma(b.fneg(sh), sh, xh))
    return fast_two_sum(b, sh, b.unless_zero(xh, b.fdiv(rest, b.fadd(sh, sh))))


FUNCTIONS: dict[str, tuple[Callable[..., Pair], int]] = {
    "sum": (total, 4),
    "sum_float": (total_float, 3),
    "product": (product, 4),
    "product_float": (product_float, 3),
    "quotient": (quotient, 4),
    "quotient_of_float": (quotient_of_float, 3),
    "quotient_by_float": (quotient_by_float, 3),
    "root": (square_root, 2),
}
"""The functions by their names in a compiled module, each with its number of float arguments.

They are not inlined. An addition of divisors calls some 600 of them; inlining would double the compilation time and
save a few per cent of the run time.
"""
