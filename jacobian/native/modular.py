"""The arithmetic of :mod:`jacobian.numbers.two_words` for compiled loops: residues of two words modulo p.

Each function of the arithmetic takes the context as its first argument and writes instructions without branches.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from typing import Any

from jacobian.native.kinds import INT, LONG, Value, record
from jacobian.native.operators import Operators
from jacobian.numbers import two_words
from jacobian.numbers.two_words import TwoWords

CONTEXT = record(TwoWords, *[LONG] * 5)
"""The kind of a two-word context: five longs."""
LOW = str((1 << 64) - 1)


def halves(b: Operators, x: str) -> tuple[str, str]:
    """The low and high 64 bits of a long, as longs: LLVM then multiplies two of them in one instruction."""
    return b.write(f"and i128 {x}, {LOW}"), b.write(f"lshr i128 {x}, 64")


def total(b: Operators, *terms: str) -> str:
    return reduce(lambda x, y: b.write(f"add i128 {x}, {y}"), terms)


def product(b: Operators, x: str, y: str) -> tuple[str, str]:
    """The low and the high 128 bits of a product of longs."""
    (x0, x1), (y0, y1) = halves(b, x), halves(b, y)
    low, first, second, high = (b.write(f"mul i128 {s}, {t}") for s, t in ((x0, y0), (x0, y1), (x1, y0), (x1, y1)))
    (low, carried), (a0, a1), (b0, b1) = halves(b, low), halves(b, first), halves(b, second)
    middle = total(b, carried, a0, b0)
    shifted = b.write(f"shl i128 {middle}, 64")
    carried = b.write(f"lshr i128 {middle}, 64")
    return b.write(f"or i128 {shifted}, {low}"), total(b, high, a1, b1, carried)


def difference(b: Operators, p: str, x: str, y: str) -> str:
    """x − y modulo p, for x < p and y ≤ p."""
    plain, below = b.write(f"sub i128 {x}, {y}"), b.write(f"icmp ult i128 {x}, {y}")
    more = b.write(f"select i1 {below}, i128 {p}, i128 0")
    return total(b, plain, more)


def addition(b: Operators, p: str, x: str, y: str) -> str:
    """x + y modulo p."""
    return difference(b, p, x, b.write(f"sub i128 {p}, {y}"))


def dot(b: Operators, K: Value, *terms: Value) -> Value:
    """terms[0]·terms[1] + terms[2]·terms[3] + …, reduced once."""
    p, reciprocal = str(K.parts[0]), K.parts[1]
    parts = [b.cast(x, LONG).parts[0] for x in terms]
    low, high = product(b, parts[0], parts[1])
    for x, y in zip(parts[2::2], parts[3::2], strict=True):
        more, rest = product(b, x, y)
        low = total(b, low, more)
        carry = b.write(f"icmp ult i128 {low}, {more}")
        rest = total(b, rest, b.write(f"zext i1 {carry} to i128"))
        high = addition(b, p, high, rest)
    quotient = b.write(f"mul i128 {low}, {reciprocal}")
    return Value(LONG, (difference(b, p, high, product(b, quotient, p)[1]),))


def add(b: Operators, K: Value, x: Value, y: Value) -> Value:
    return Value(LONG, (addition(b, K.parts[0], x.parts[0], y.parts[0]),))


def sub(b: Operators, K: Value, x: Value, y: Value) -> Value:
    return Value(LONG, (difference(b, K.parts[0], x.parts[0], y.parts[0]),))


def neg(b: Operators, K: Value, x: Value) -> Value:
    return Value(LONG, (difference(b, K.parts[0], "0", x.parts[0]),))


def trailing_zeros(b: Operators, x: Value) -> Value:
    """The exponent of 2 in x > 0, in one instruction."""
    count = b.write(f"call i128 @llvm.cttz.i128(i128 {x.parts[0]}, i1 true)")
    return Value(INT, (b.write(f"trunc i128 {count} to i64"),))


MODULAR: dict[Any, Callable[..., Value]] = {
    TwoWords.dot: dot,
    TwoWords.canonical: lambda b, K, x: x,
    TwoWords.add: add,
    TwoWords.sub: sub,
    TwoWords.neg: neg,
    two_words.trailing_zeros: trailing_zeros,
    two_words.long: lambda b, x: b.cast(x, LONG),
}
"""Functions of this package, and the instructions that replace them on two words."""
