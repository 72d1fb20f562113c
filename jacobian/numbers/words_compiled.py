"""The compiled versions of :mod:`jacobian.numbers.words`, registered with numba.

After this import a function compiled by numba may call mul, dot2, … with a context, whose class picks the version.
Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic, overload, register_jitable

from jacobian.numbers import words

INLINED = {"forceinline": True}


def opaque(builder: Any, x: Any) -> Any:
    """The same 64 bits, passed through an empty piece of assembly that LLVM cannot analyse."""
    return builder.call(ir.InlineAsm(ir.FunctionType(x.type, [x.type]), "", "=r,0"), [x])


@intrinsic
def _sign(typing, x):  # type: ignore[no-untyped-def]  # numba's own signature
    """−1 for x < 0, else 0: a mask that LLVM does not turn into a branch, which would be mispredicted half the time."""

    def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        return opaque(builder, builder.ashr(arguments[0], ir.Constant(arguments[0].type, 63)))

    return types.int64(types.int64), codegen


def _montgomery(bits: int) -> Any:
    """The intrinsic (terms, p, reciprocal) → Σ terms[2i]·terms[2i+1]·2^(−bits) modulo p, on signed words in int64."""

    @intrinsic
    def montgomery(typing, terms, p, reciprocal):  # type: ignore[no-untyped-def]  # numba's own signature
        def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
            word, double, full = ir.IntType(bits), ir.IntType(2 * bits), ir.IntType(64)

            def low(x: Any) -> Any:
                return builder.sext(x if x.type == word else builder.trunc(x, word), double)

            packed, p, reciprocal = arguments
            values = [builder.extract_value(packed, i) for i in range(signature.args[0].count)]
            products = [builder.mul(low(a), low(b)) for a, b in zip(values[::2], values[1::2], strict=True)]
            total = products[0]
            for product in products[1:]:
                total = builder.add(total, product)
            multiple = builder.mul(low(builder.mul(low(total), low(reciprocal))), low(p))
            # the low halves are equal: subtracting only the high ones cannot overflow
            shift = ir.Constant(double, bits)
            high = builder.sub(builder.ashr(total, shift), builder.ashr(multiple, shift))
            if double == full:
                return high
            # no vector instruction multiplies 64 by 64 bits; hide the product from LLVM, which would emulate it lane by
            # lane
            return opaque(builder, builder.trunc(high, full))

        return types.int64(terms, types.int64, types.int64), codegen

    return montgomery


_DOTS = {bits: _montgomery(bits) for bits in (32, 64)}


@intrinsic
def _rest(typing, a, b, p, reciprocal):  # type: ignore[no-untyped-def]
    """ab modulo p on floats, as ab − qp, where q is the integer nearest to the rounded ab/p.

    h + l = ab and h − qp are exact, the first by the fused product, the second because it is a small integer.
    """

    def codegen(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        a, b, p, reciprocal = arguments
        kind = a.type
        rounded = builder.module.declare_intrinsic("llvm.rint", [kind])
        high = builder.fmul(a, b)
        low = builder.fma(a, b, builder.fneg(high))
        quotient = builder.call(rounded, [builder.fmul(high, reciprocal)])
        return builder.fadd(builder.fma(builder.fneg(quotient), p, high), low)

    return types.float64(types.float64, types.float64, types.float64, types.float64), codegen


def _kind(K: Any) -> Any:
    """The context class that belongs to a numba type; None if it is no context of words."""
    found = getattr(K, "instance_class", None)
    return found if isinstance(found, type) and issubclass(found, words.WordContext | words.Double) else None


@overload(words.mul, jit_options=INLINED)
def _mul(K, a, b):  # type: ignore[no-untyped-def]  # numba compares the bare signatures, here and below
    if _kind(K) is words.Double:
        return lambda K, a, b: _rest(a, b, K.p, K.reciprocal)
    if _kind(K):
        dot = _DOTS[_kind(K).bits]
        return lambda K, a, b: dot((a, b), K.p, K.reciprocal)
    return None


@overload(words.dot2, jit_options=INLINED)
def _dot2(K, a, b, c, d):  # type: ignore[no-untyped-def]
    if _kind(K) is words.Double:
        return lambda K, a, b, c, d: words.mul(K, a, b) + words.mul(K, c, d)
    if _kind(K):
        dot = _DOTS[_kind(K).bits]
        return lambda K, a, b, c, d: dot((a, b, c, d), K.p, K.reciprocal)
    return None


@overload(words.dot3, jit_options=INLINED)
def _dot3(K, a, b, c, d, e, f):  # type: ignore[no-untyped-def]
    if _kind(K) is words.Double:
        return lambda K, a, b, c, d, e, f: words.dot2(K, a, b, c, d) + words.mul(K, e, f)
    if _kind(K):
        dot = _DOTS[_kind(K).bits]
        return lambda K, a, b, c, d, e, f: dot((a, b, c, d, e, f), K.p, K.reciprocal)
    return None


@overload(words.dot4, jit_options=INLINED)
def _dot4(K, a, b, c, d, e, f, g, h):  # type: ignore[no-untyped-def]
    if _kind(K) is words.Double:
        return lambda K, a, b, c, d, e, f, g, h: words.dot2(K, a, b, c, d) + words.dot2(K, e, f, g, h)
    if _kind(K):
        dot = _DOTS[_kind(K).bits]
        return lambda K, a, b, c, d, e, f, g, h: dot((a, b, c, d, e, f, g, h), K.p, K.reciprocal)
    return None


@overload(words.add, jit_options=INLINED)
def _add(K, x, y):  # type: ignore[no-untyped-def]
    return (lambda K, x, y: words.fit(K, x + y)) if _kind(K) else None


@overload(words.sub, jit_options=INLINED)
def _sub(K, x, y):  # type: ignore[no-untyped-def]
    return (lambda K, x, y: words.fit(K, x - y)) if _kind(K) else None


@overload(words.neg, jit_options=INLINED)
def _neg(K, x):  # type: ignore[no-untyped-def]
    return (lambda K, x: -x) if _kind(K) else None


def _is_scalar(K: Any) -> bool:
    """Whether loops over this context stay scalar: there LLVM would make branches of selections."""
    return _kind(K) is not words.Double and _kind(K).bits == 64


@overload(words.canonical, jit_options=INLINED)
def _canonical(K, x):  # type: ignore[no-untyped-def]
    if not _kind(K):
        return None
    if _kind(K) is words.Double:
        return lambda K, x: words.settled(K, x)

    def masked(K, x):  # type: ignore[no-untyped-def]
        # add p to negative x first, then subtract: nothing overflows for |x| ≤ p < 2^63
        x = x + (K.p & (x >> 63))
        return x - (K.p & _sign(K.half - x))

    def selected(K, x):  # type: ignore[no-untyped-def]
        x = x - K.p if x > K.half else x
        return x + K.p if x < -K.half else x

    return masked if _is_scalar(K) else selected


@overload(words.fit, jit_options=INLINED)
def _fit(K, x):  # type: ignore[no-untyped-def]
    if not _kind(K):
        return None
    wide = _kind(K) is not words.Double and _kind(K).wide
    return (lambda K, x: words.canonical(K, x)) if wide else (lambda K, x: x)


@overload(words.settled, jit_options=INLINED)
def _settled(K, x):  # type: ignore[no-untyped-def]
    if not _kind(K):
        return None
    if _kind(K) is not words.Double and _kind(K).wide:
        return lambda K, x: words.canonical(K, x)

    def masked(K, x):  # type: ignore[no-untyped-def]
        x = x + (3 * K.p & (x >> 63))
        return words.canonical(K, x - (3 * K.p & _sign(K.p + K.half - x)))

    def selected(K, x):  # type: ignore[no-untyped-def]
        far = K.p + K.half
        x = x - 3 * K.p if x > far else x
        x = x + 3 * K.p if x < -far else x
        x = x - K.p if x > K.half else x
        return x + K.p if x < -K.half else x

    return masked if _is_scalar(K) else selected


@register_jitable(error_model="numpy")
def modular_inverse(x, p):  # type: ignore[no-untyped-def]
    """1/x modulo p, of size below p, for x ≠ 0 with |x| < p < 2^63, by Euclid's algorithm.

    Unsigned words spare the division a sign correction. The cofactors wrap around; read as a signed word, the last one
    is within p.
    """
    a, b = np.uint64(p), np.uint64(abs(x))
    s, t = np.uint64(0), np.uint64(1)
    while b > np.uint64(1):
        q = a // b
        a, b = b, a - q * b
        s, t = t, s - q * t
    return np.int64(t) if x > 0 else -np.int64(t)


@overload(words.inverse)
def _inverse(K, x):  # type: ignore[no-untyped-def]
    if _kind(K) is words.Double:
        return lambda K, x: words.canonical(K, float(modular_inverse(np.int64(x), np.int64(K.p))))
    if _kind(K):
        return lambda K, x: words.canonical(K, words.mul(K, words.canonical(K, modular_inverse(x, K.p)), K.cube))
    return None


@overload(words.number, jit_options=INLINED)
def _number(K, x):  # type: ignore[no-untyped-def]
    # also for table contexts, whose words are stored in 16 bits
    return (lambda K, x: x) if _kind(K) is words.Double else (lambda K, x: np.int64(x))


@overload(words.encode)
def _encode(K, x):  # type: ignore[no-untyped-def]
    return (lambda K, x: words.canonical(K, words.mul(K, words.canonical(K, x), K.square))) if _kind(K) else None


@overload(words.decode)
def _decode(K, x):  # type: ignore[no-untyped-def]
    if not _kind(K):
        return None

    def decode(K, x):  # type: ignore[no-untyped-def]
        a = words.mul(K, x, 1)
        return a + K.p if a < 0 else a

    return decode
