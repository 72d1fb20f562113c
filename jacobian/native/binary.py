"""The arithmetic of :mod:`jacobian.numbers.binary` in compiled loops.

Polynomials over GF(2) are stored as the bits of words (64 bits) or of longs (128 bits). A carry-less product is a
product of such polynomials. That of two words is one instruction on processors that have PCLMULQDQ. On others
:func:`jacobian.numbers.binary.product_of_words` is compiled from its source.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import Any

from jacobian.native.kinds import INT, LONG, Value, record
from jacobian.native.machine import features
from jacobian.native.modular import halves
from jacobian.native.operators import Operators
from jacobian.numbers import binary

CONTEXTS: dict[type, Any] = {
    kind: record(kind, *[LONG] * 4, INT) for kind in (binary.BinaryWord, binary.BinaryTwoWords)
}
"""The kind of each context class."""
PAIR = "<2 x i64>"


def plus(b: Operators, *terms: str) -> str:
    """The sum of polynomials over GF(2): the exclusive or of all terms."""
    return reduce(lambda x, y: b.write(f"xor i128 {x}, {y}"), terms)


def in_one_instruction(b: Operators, x: Value, y: Value) -> Value | None:
    """The carry-less product of two words by the processor's instruction; None if it has none."""
    if "+pclmul" not in features().split(","):
        return None
    parts = [b.write(f"bitcast i128 {z.parts[0]} to {PAIR}") for z in (x, y)]
    found = b.write(f"call {PAIR} @llvm.x86.pclmulqdq({PAIR} {parts[0]}, {PAIR} {parts[1]}, i8 0)")
    return Value(LONG, (b.write(f"bitcast {PAIR} {found} to i128"),))


def times(b: Any, x: str, y: str) -> str:
    """The product of two polynomials over GF(2) of degree below 64, given as longs whose upper 64 bits are 0."""
    return str(b.call(binary.product_of_words, [Value(LONG, (x,)), Value(LONG, (y,))]).parts[0])


def product(b: Any, x: str, y: str) -> tuple[str, str]:
    """The low and high 128 bits of a carry-less product of two 128-bit integers.

    It is made from three products of words (Karatsuba and Ofman 1962).
    """
    (x0, x1), (y0, y1) = halves(b, x), halves(b, y)
    low, high = times(b, x0, y0), times(b, x1, y1)
    if x == y:
        return low, high
    middle = plus(b, times(b, plus(b, x0, x1), plus(b, y0, y1)), low, high)
    return plus(b, low, b.write(f"shl i128 {middle}, 64")), plus(b, high, b.write(f"lshr i128 {middle}, 64"))


def low_product(b: Any, x: str, y: str) -> str:
    """The low 128 bits of a carry-less product of two 128-bit integers."""
    (x0, x1), (y0, y1) = halves(b, x), halves(b, y)
    crossed = plus(b, times(b, x0, y1), times(b, x1, y0))
    return plus(b, times(b, x0, y0), b.write(f"shl i128 {crossed}, 64"))


def dot(b: Any, K: Value, *terms: Value) -> Value:
    """terms[0]·terms[1] + terms[2]·terms[3] + …, reduced once."""
    parts = [b.cast(x, LONG).parts[0] for x in terms]
    modulus, reciprocal = K.parts[:2]
    pairs = zip(parts[::2], parts[1::2], strict=True)
    if K.kind.named is binary.BinaryWord:
        total = plus(b, *(times(b, x, y) for x, y in pairs))
        quotient = halves(b, times(b, halves(b, total)[0], reciprocal))[0]
        return Value(LONG, (halves(b, plus(b, total, times(b, quotient, modulus)))[1],))
    products = [product(b, x, y) for x, y in pairs]
    low, high = (plus(b, *halves_of_all) for halves_of_all in zip(*products, strict=True))
    return Value(LONG, (plus(b, high, product(b, low_product(b, low, reciprocal), modulus)[1]),))


BINARY: dict[Any, Callable[..., Value | None]] = {
    binary.BinaryContext.dot: dot,
    binary.product_of_words: in_one_instruction,
}
"""Functions of this package, and the instructions that replace them."""
