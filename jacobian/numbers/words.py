"""Arithmetic modulo an odd prime of word size: Montgomery's representation on signed words, reduced only where needed.

An element a is represented by a·2^w modulo p with w = 32 (p < 2^31) or 64 (p < 2^63), as a signed int that need not be
the least residue: Montgomery's reduction (1985) with a signed quotient maps a T with |T| < 2^(2w−1) to T/2^w modulo p
of size at most |T|/2^w + p/2, without a comparison. So sums stay as they are, sums of products are reduced once, and
only what is stored or compared is made *canonical*, −p/2 < x < p/2.

A *context* K holds p and its constants. Its class says how many spare bits a word has above p, and compiled code is
specialised by that class::

    K = word_context(p)              # Lazy32, Wide32, Lazy64 or Wide64
    x = K.to_word(a)                 # canonical, for 0 ≤ a < p; K.from_word(x) goes back for any x
    mul(K, x, y), dot2(K, a, b, c, d), dot3, dot4     # ab, ab + cd, …
    add(K, x, y), sub(K, x, y), neg(K, x)             # on Lazy bare sums, on Wide within p/2 for x and y within p/2
    fit(K, x)                        # on Wide within p/2, for |x| ≤ p; on Lazy x itself
    settled(K, x)                    # canonical, for |x| ≤ 4·p on Lazy, p on Wide
    canonical(K, x)                  # canonical, for |x| ≤ 1.5·p on Lazy, p on Wide
    inverse(K, x)                    # canonical, of a canonical x ≠ 0

Bounds: a word is at most 4·p on Lazy (p < 2^(w−3)) and p on Wide (p < 2^(w−1)). The products of one dot add up to at
most 2·p² on Wide and 32·p² on Lazy. The result is a word only if they add up to at most p² on Wide and 28·p² on Lazy.
Running a formula on intervals proves that it keeps these bounds (``tests/jacobian/numbers/word_bounds.py``).

For p < 2^49 a fifth context, :class:`Double`, keeps least residues as floats: the remainder of a product is computed
exactly from two fused multiplications and a rounded quotient. SIMD instructions do this for eight products at once; for
products of 64-bit words there are none. Each product of a dot is reduced on its own. A product must be below 16·p² and
a sum below 16·p; ``settled`` and ``canonical`` take |x| ≤ 4.5·p.

The functions also run on Python ints, exactly; :mod:`jacobian.numbers.words_compiled` registers their compiled
versions. Importing this module imports neither numba nor numpy.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.errors import ArgumentError

_Constants = namedtuple("_Constants", "p reciprocal one square cube half")
"""p; 1/p modulo 2^w, signed; 2^w, 2^(2w), 2^(3w) modulo p, canonical; (p − 1)/2."""


class WordContext(_Constants):
    """The conversions and the operations on Python ints that the four contexts share."""

    __slots__ = ()
    bits: int
    wide: bool

    def to_word(self, a: int) -> int:
        """The canonical word of a residue."""
        return self.canonical((a << self.bits) % self.p)

    def from_word(self, x: int) -> int:
        """The residue 0 ≤ a < p of any word."""
        return int(x) * pow(2, -self.bits, self.p) % self.p

    def dot(self, *terms: int) -> int:
        """terms[0]·terms[1] + terms[2]·terms[3] + …, by Montgomery's reduction."""
        total = sum(a * b for a, b in zip(terms[::2], terms[1::2], strict=True))
        quotient = _signed(total * self.reciprocal, self.bits)
        return (total - quotient * self.p) >> self.bits

    def add(self, x: int, y: int) -> int:
        return self.fit(x + y)

    def sub(self, x: int, y: int) -> int:
        return self.fit(x - y)

    def neg(self, x: int) -> int:
        return -x

    def fit(self, x: int) -> int:
        return self.canonical(x) if self.wide else x

    def canonical(self, x: int) -> int:
        return x - self.p if x > self.half else x + self.p if x < -self.half else x

    def settled(self, x: int) -> int:
        if not self.wide:
            x -= 3 * self.p if 2 * x > 3 * self.p else -3 * self.p if 2 * x < -3 * self.p else 0
        return self.canonical(x)

    def invert(self, x: int) -> int:
        return self.dot(self.cube, self.canonical(pow(x, -1, self.p)))


class Lazy32(WordContext):
    """The context of p < 2^29 on words of 32 bits."""

    __slots__ = ()
    bits, wide = 32, False


class Wide32(WordContext):
    """The context of p < 2^31 on words of 32 bits."""

    __slots__ = ()
    bits, wide = 32, True


class Lazy64(WordContext):
    """The context of p < 2^61 on words of 64 bits."""

    __slots__ = ()
    bits, wide = 64, False


class Wide64(WordContext):
    """The context of p < 2^63 on words of 64 bits."""

    __slots__ = ()
    bits, wide = 64, True


class Double(namedtuple("Double", "p reciprocal one half")):
    """The context of p < 2^49 on floats; ``reciprocal`` is 1/p, rounded."""

    __slots__ = ()

    def balanced(self, a: Any) -> Any:
        """The canonical float of a residue, or of an array of them."""
        return a - self.p * (a > self.half)


def double_context(p: int) -> Double:
    """The context of floats for an odd prime p < 2^49."""
    if p < 3 or p % 2 == 0 or p.bit_length() > 49:
        raise ArgumentError(f"p = {p}: floats take an odd prime below 2^49")
    return Double(float(p), 1 / p, 1.0, float(p // 2))


def word_context(p: int, bits: int | None = None) -> WordContext:
    """The context of an odd prime p < 2^63, on words of 32 bits if p < 2^31 unless ``bits`` is 64."""
    if p < 3 or p % 2 == 0 or p.bit_length() > 63:
        raise ArgumentError(f"p = {p}: words take an odd prime below 2^63")
    if bits is None:
        bits = 32 if p.bit_length() <= 31 else 64
    if bits not in (32, 64) or p.bit_length() >= bits:
        raise ArgumentError(f"bits = {bits}: 32 (for p < 2^31) or 64 are possible for p = {p}")
    lazy = p.bit_length() <= bits - 3
    kind = (Lazy32 if lazy else Wide32) if bits == 32 else (Lazy64 if lazy else Wide64)
    powers = [pow(2, bits * i, p) for i in (1, 2, 3)]
    powers = [x - p if x > p // 2 else x for x in powers]
    return kind._make((p, _signed(pow(p, -1, 1 << bits), bits), *powers, p // 2))


def _signed(x: int, bits: int) -> int:
    """The residue of x modulo 2^bits in [−2^(bits−1), 2^(bits−1))."""
    half = 1 << (bits - 1)
    return ((x + half) & (2 * half - 1)) - half


def mul(K: Any, a: Any, b: Any) -> Any:
    """ab."""
    return K.dot(a, b)


def dot2(K: Any, a: Any, b: Any, c: Any, d: Any) -> Any:
    """ab + cd, reduced once."""
    return K.dot(a, b, c, d)


def dot3(K: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any) -> Any:
    """ab + cd + ef, reduced once."""
    return K.dot(a, b, c, d, e, f)


def dot4(K: Any, a: Any, b: Any, c: Any, d: Any, e: Any, f: Any, g: Any, h: Any) -> Any:
    """ab + cd + ef + gh, reduced once."""
    return K.dot(a, b, c, d, e, f, g, h)


def add(K: Any, x: Any, y: Any) -> Any:
    """x + y; within p/2 on a wide context."""
    return K.add(x, y)


def sub(K: Any, x: Any, y: Any) -> Any:
    """x − y; within p/2 on a wide context."""
    return K.sub(x, y)


def neg(K: Any, x: Any) -> Any:
    """−x."""
    return K.neg(x)


def fit(K: Any, x: Any) -> Any:
    """x on a lazy context; on a wide one the residue of x within p/2, for |x| ≤ p."""
    return K.fit(x)


def canonical(K: Any, x: Any) -> Any:
    """The residue of x in (−p/2, p/2), for |x| ≤ 1.5·p (on a wide context |x| ≤ p)."""
    return K.canonical(x)


def settled(K: Any, x: Any) -> Any:
    """The residue of x in (−p/2, p/2), for any word x."""
    return K.settled(x)


def inverse(K: Any, x: Any) -> Any:
    """1/x, canonical, for a canonical x ≠ 0."""
    return K.canonical(K.invert(x))


def number(K: Any, x: Any) -> Any:
    """A stored number in the type that the context computes with: int64, or float64 on :class:`Double`."""
    return x


def encode(K: Any, x: Any) -> Any:
    """The canonical word of a field element."""
    return K.to_word(x)


def decode(K: Any, x: Any) -> Any:
    """The field element of a canonical word."""
    return K.from_word(x)
