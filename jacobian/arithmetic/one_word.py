"""Arithmetic modulo an odd prime below 2^30 on plain words, for compiled loops: least residues, one remainder for a sum
of up to four products.

The operations are those of :mod:`jacobian.numbers.words`. LLVM compiles these loops in a tenth of the time of numba's,
which are for primes of any size.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from jacobian.native.kinds import INT, Value, record
from jacobian.numbers import words


class OneWord(NamedTuple):
    """The prime, and 1."""

    p: int
    one: int


CONTEXT = record(OneWord, INT, INT)


def mul(K: Any, a: Any, b: Any) -> Any:
    return a * b % K.p


def dot2(K: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    return (a * b + c * d) % K.p


def dot3(K: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> Any:
    return (a * b + c * d + e * f) % K.p


def dot4(K: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any, h: Any) -> Any:
    return (a * b + c * d + e * f + g * h) % K.p


def add(K: Any, x: Any, y: Any) -> Any:
    total = x + y - K.p
    return total + K.p if total < 0 else total


def sub(K: Any, x: Any, y: Any) -> Any:
    total = x - y
    return total + K.p if total < 0 else total


def neg(K: Any, x: Any) -> Any:
    return K.p - x if x > 0 else x


def inverse(K: Any, x: Any) -> Any:
    """1/x modulo p, by Euclid's algorithm."""
    a, b, s, t = K.p, x, 0, 1
    while b > 1:
        quotient = a // b
        a, b = b, a - quotient * b
        s, t = t, s - quotient * t
    return t + K.p if t < 0 else t


def _called(function: Any) -> Callable[..., Value]:
    return lambda b, *arguments: b.call(function, list(arguments))


def _itself(b: Any, K: Value, x: Value) -> Value:
    return x


OPERATIONS: dict[Any, Callable[..., Value]] = {
    words.mul: _called(mul),
    words.dot2: _called(dot2),
    words.dot3: _called(dot3),
    words.dot4: _called(dot4),
    words.add: _called(add),
    words.sub: _called(sub),
    words.neg: _called(neg),
    words.inverse: _called(inverse),
    **dict.fromkeys((words.canonical, words.fit, words.settled), _itself),
}
"""Functions of this package, and the instructions that replace them on a one-word context."""
