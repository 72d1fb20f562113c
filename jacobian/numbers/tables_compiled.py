"""The compiled operations of :mod:`jacobian.numbers.words` on the contexts of :mod:`jacobian.numbers.tables`.

Importing this module imports numba.
"""

from __future__ import annotations

from typing import Any

from numba.extending import overload

from jacobian.numbers import words
from jacobian.numbers.tables import BinaryTable, OddTable

# numba compares the bare signatures of an overload with those of the function: no annotations below


def _tables(K: Any) -> Any:
    """The context class that belongs to a numba type; None if it is no context of tables."""
    found = getattr(K, "instance_class", None)
    return found if found in (BinaryTable, OddTable) else None


@overload(words.mul)
def _mul(K, a, b):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, a, b: K.powers[K.logarithms[a] + K.logarithms[b]]
    return None


@overload(words.add)
def _add(K, x, y):  # type: ignore[no-untyped-def]
    if _tables(K) is BinaryTable:
        return lambda K, x, y: x ^ y
    if _tables(K) is OddTable:

        def add(K, x, y):  # type: ignore[no-untyped-def]
            first = K.logarithms[x]
            return K.powers[first + K.zech[K.logarithms[y] - first + 2 * K.size]]

        return add
    return None


@overload(words.neg)
def _neg(K, x):  # type: ignore[no-untyped-def]
    if _tables(K) is BinaryTable:
        return lambda K, x: x
    if _tables(K) is OddTable:
        return lambda K, x: K.powers[K.logarithms[x] + K.half]
    return None


@overload(words.sub)
def _sub(K, x, y):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, x, y: words.add(K, x, words.neg(K, y))
    return None


@overload(words.dot2)
def _dot2(K, a, b, c, d):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, a, b, c, d: words.add(K, words.mul(K, a, b), words.mul(K, c, d))
    return None


@overload(words.dot3)
def _dot3(K, a, b, c, d, e, f):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, a, b, c, d, e, f: words.add(K, words.dot2(K, a, b, c, d), words.mul(K, e, f))
    return None


@overload(words.dot4)
def _dot4(K, a, b, c, d, e, f, g, h):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, a, b, c, d, e, f, g, h: words.add(K, words.dot2(K, a, b, c, d), words.dot2(K, e, f, g, h))
    return None


@overload(words.inverse)
def _inverse(K, x):  # type: ignore[no-untyped-def]
    if _tables(K):
        return lambda K, x: K.powers[K.size - K.logarithms[x]]
    return None


@overload(words.encode)
@overload(words.decode)
@overload(words.fit)
@overload(words.canonical)
@overload(words.settled)
def _same(K, x):  # type: ignore[no-untyped-def]
    return (lambda K, x: x) if _tables(K) else None
