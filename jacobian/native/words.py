"""The operations of :mod:`jacobian.numbers.words` that have instructions of their own in compiled loops.

The other operations of a context, and all of :mod:`jacobian.numbers.tables`, are compiled from their Python source.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from jacobian.native import binary, modular
from jacobian.native.kinds import FLOAT, INT, INTS, Value, record
from jacobian.native.operators import Operators
from jacobian.numbers import tables, words
from jacobian.numbers.two_words import TwoWords

CONTEXTS: dict[type, Any] = {
    **{kind: record(kind, *[INT] * 6) for kind in (words.Lazy32, words.Wide32, words.Lazy64, words.Wide64)},
    **{kind: record(kind, *[INTS] * 3, *[INT] * 3) for kind in (tables.BinaryTable, tables.OddTable)},
    words.Double: record(words.Double, *[FLOAT] * 4),
    words.OneWord: record(words.OneWord, INT, INT),
    TwoWords: modular.CONTEXT,
    **binary.CONTEXTS,
}
"""The kind of each context class."""


def opaque(b: Operators, x: str) -> str:
    """Passes the 64 bits x through an empty piece of assembly, so that LLVM cannot analyse where they come from."""
    return b.write(f'call i64 asm "", "=r,0"(i64 {x})')


def dot(b: Operators, K: Value, *terms: Value) -> Value:
    """terms[0]·terms[1] + terms[2]·terms[3] + …, by Montgomery's reduction on signed words."""
    bits = K.kind.named.bits
    word, double = f"i{bits}", f"i{2 * bits}"

    def low(x: str, leaf: str) -> str:
        """The lowest word of an integer of type ``leaf``, sign-extended to a double word."""
        short = x if leaf == word else b.write(f"trunc {leaf} {x} to {word}")
        return b.write(f"sext {word} {short} to {double}")

    p, reciprocal, *factors = (low(x.parts[0], "i64") for x in (K.item(0), K.item(1), *terms))
    total = ""
    for x, y in zip(factors[::2], factors[1::2], strict=True):
        product = b.write(f"mul {double} {x}, {y}")
        total = b.write(f"add {double} {total}, {product}") if total else product
    quotient = b.write(f"mul {double} {low(total, double)}, {reciprocal}")
    multiple = b.write(f"mul {double} {low(quotient, double)}, {p}")
    # the low halves are equal: subtracting only the high ones cannot overflow
    high, less = (b.write(f"ashr {double} {x}, {bits}") for x in (total, multiple))
    found = b.write(f"sub {double} {high}, {less}")
    if bits == 32:
        return Value(INT, (found,))
    # without ``opaque`` LLVM would emulate this product lane by lane: no vector instruction multiplies 64 by 64 bits
    return Value(INT, (opaque(b, b.write(f"trunc i128 {found} to i64")),))


def sign(b: Operators, x: Value) -> Value:
    """The mask −1 for x < 0, else 0, in a form that LLVM does not turn into a branch."""
    return Value(INT, (opaque(b, b.write(f"ashr i64 {x.parts[0]}, 63")),))


def quotient(b: Operators, x: Value, y: Value) -> Value:
    """The quotient of two non-negative numbers, by an unsigned division, which needs no correction of signs."""
    return Value(INT, (b.write(f"udiv i64 {x.parts[0]}, {y.parts[0]}"),))


def rest(b: Operators, K: Value, x: Value, y: Value) -> Value:
    """xy modulo p on floats, as xy − qp, where q is the integer nearest to the rounded xy/p.

    Let h be the rounded product xy. One fused multiply-add computes l = xy − h exactly. A second one computes h − qp,
    which is a small integer. The result is (h − qp) + l. LLVM may not contract these instructions with others.
    """
    p, reciprocal = K.parts[0], K.parts[1]
    first, second = (b.cast(z, FLOAT).parts[0] for z in (x, y))
    high = b.fmul(first, second)
    low = b.fma(first, second, b.fneg(high))
    nearest = b.intrinsic("rint", b.fmul(high, reciprocal))
    return Value(FLOAT, (b.fadd(b.fma(b.fneg(nearest), p, high), low),))


ARITHMETIC: dict[Any, Callable[..., Value | None]] = {
    words.WordContext.dot: dot,
    words.sign: sign,
    words.quotient: quotient,
    words.Double.product: rest,
    **modular.MODULAR,
    **binary.BINARY,
}
"""Functions of :mod:`jacobian.numbers`, and the instructions that replace them."""
