"""Arithmetic modulo an odd prime of word size: Montgomery's representation on signed words, reduced only where needed.

An element ``a`` is represented by a·2^w modulo p, w = 32 (p < 2^31) or 64 (p < 2^63), as a signed int that need not be
the least residue. Montgomery's reduction (1985) with a signed quotient maps a T with |T| < 2^(2w−1) to T/2^w modulo p,
of size at most |T|/2^w + p/2, without a comparison. So a sum of products is reduced once, and other sums only if words
have no spare bits. Numbers that are stored or compared are made *canonical*, −p/2 < x < p/2.

A *context* K holds p and its constants. Its class says how many spare bits a word has above p, and compiled code is
specialised by that class::

    K = word_context(p)              # Lazy32, Wide32, Lazy64 or Wide64
    x = K.to_word(a)                 # canonical, for 0 ≤ a < p; K.from_word(x) goes back for any x
    K.dot(x, y), K.dot(a, b, c, d)   # ab, ab + cd, …, up to four products, reduced once
    K.add(x, y), K.sub(x, y), K.neg(x)    # on Lazy bare sums, on Wide within p/2 for x and y within p/2
    K.fit(x)                         # on Wide within p/2, for |x| ≤ p; on Lazy x itself
    K.settled(x)                     # canonical, for |x| ≤ 4·p on Lazy, p on Wide
    K.canonical(x)                   # canonical, for |x| ≤ 1.5·p on Lazy, p on Wide
    inverse(K, x)                    # canonical, of a canonical x ≠ 0

Bounds: a word is at most 4·p on Lazy (p < 2^(w−3)) and p on Wide (p < 2^(w−1)). The products of one dot add up to at
most 2·p² on Wide and 32·p² on Lazy. The result is a word only if they add up to at most p² on Wide and 28·p² on Lazy.
Running a formula on intervals proves that it keeps these bounds (``tests/jacobian/numbers/word_bounds.py``).

For p < 2^49 a fifth context, :class:`Double`, keeps residues as floats: two fused multiply-adds and a rounded
quotient give the remainder of a product exactly. SIMD instructions do this for eight products at once; no SIMD
instruction multiplies 64-bit words. Each product of a dot is reduced on its own. A product must be below 16·p² and
a sum below 16·p; ``settled`` and ``canonical`` take |x| ≤ 4.5·p.

The contexts also run on Python ints, exactly; :mod:`jacobian.native` compiles them as they stand, except for the
functions that :mod:`jacobian.native.words` replaces by instructions. Importing this module does not import numpy.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.errors import ArgumentError

_Constants = namedtuple("_Constants", "p reciprocal one square cube half")
"""p; 1/p modulo 2^w, signed; 2^w, 2^(2w), 2^(3w) modulo p, canonical; (p − 1)/2."""


class WordContext(_Constants):
    """The operations that the four contexts of words share. ``dot`` and :func:`sign` have instructions of their own in
    compiled code; the rest is compiled as it stands.
    """

    __slots__ = ()
    bits: int
    wide: bool

    def to_word(self, a: int) -> int:
        """The canonical word that represents a residue."""
        return self.canonical(self.dot(a, self.square))

    def from_word(self, x: int) -> int:
        """The residue 0 ≤ a < p that a word represents."""
        a = self.dot(int(x), 1)
        return a + self.p if a < 0 else a

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

    def nearer(self, x: int, far: int, step: int) -> int:
        """x, moved by ``step`` towards 0 if it is beyond ±far."""
        x = x - step if x > far else x
        return x + step if x < -far else x

    def canonical(self, x: int) -> int:
        return self.nearer(x, self.half, self.p)

    def settled(self, x: int) -> int:
        return self.canonical(x if self.wide else self.nearer(x, self.p + self.half, 3 * self.p))

    def invert(self, x: int) -> int:
        return self.dot(self.cube, self.canonical(inverse_modulo(x, self.p)))


class Lazy32(WordContext):
    """The context of p < 2^29 on words of 32 bits."""

    __slots__ = ()
    bits, wide = 32, False


class Wide32(WordContext):
    """The context of p < 2^31 on words of 32 bits."""

    __slots__ = ()
    bits, wide = 32, True


class LongContext(WordContext):
    """The operations that the contexts on words of 64 bits share."""

    __slots__ = ()
    bits = 64

    def nearer(self, x: int, far: int, step: int) -> int:
        """x, plus ``step`` if it is negative; then minus ``step`` if it is beyond ``far``.

        Masks are used because a selection would become a branch in scalar loops, mispredicted half the time.
        """
        x = x + (step & x >> 63)
        return x - (step & sign(far - x))


class Lazy64(LongContext):
    """The context of p < 2^61 on words of 64 bits."""

    __slots__ = ()
    wide = False


class Wide64(LongContext):
    """The context of p < 2^63 on words of 64 bits."""

    __slots__ = ()
    wide = True


class SingleProducts:
    """The operations shared by the contexts that reduce each product of a dot on its own."""

    __slots__ = ()

    def dot(self: Any, *terms: Any) -> Any:
        """terms[0]·terms[1] + terms[2]·terms[3] + …"""
        first = self.product(terms[0], terms[1])
        return first if len(terms) == 2 else self.add(first, self.dot(*terms[2:]))


class Double(SingleProducts, namedtuple("Double", "p reciprocal one half")):
    """The context of p < 2^49 on floats; ``reciprocal`` is 1/p, rounded."""

    __slots__ = ()

    def balanced(self, a: Any) -> Any:
        """The canonical float of a residue, or of an array of them."""
        return a - self.p * (a > self.half)

    def product(self, x: float, y: float) -> float:
        """A residue of xy: the canonical one in Python. Compiled code computes another one by fused multiply-adds."""
        return float(self.balanced(int(x) * int(y) % int(self.p)))

    def add(self, x: float, y: float) -> float:
        return x + y

    def sub(self, x: float, y: float) -> float:
        return x - y

    def neg(self, x: float) -> float:
        return -x

    def fit(self, x: float) -> float:
        return x

    nearer: Any = WordContext.nearer

    def canonical(self, x: float) -> float:
        return self.nearer(self.nearer(x, self.p + self.half, 3 * self.p), self.half, self.p)

    settled = canonical

    def invert(self, x: float) -> float:
        return float(inverse_modulo(int(x), int(self.p)))


class OneWord(namedtuple("OneWord", "p one")):
    """The context of p < 2^30 on least residues. A sum of up to four products is reduced by a single division. Compiled
    loops over primes make such a context for each prime."""

    __slots__ = ()

    def total(self, *terms: int) -> int:
        """terms[0]·terms[1] + terms[2]·terms[3] + …, not reduced."""
        first = terms[0] * terms[1]
        return first if len(terms) == 2 else first + self.total(*terms[2:])

    def dot(self, *terms: int) -> int:
        return self.total(*terms) % self.p

    def add(self, x: int, y: int) -> int:
        return self.sub(x, self.p - y)

    def sub(self, x: int, y: int) -> int:
        total = x - y
        return total + self.p if total < 0 else total

    def neg(self, x: int) -> int:
        return self.p - x if x > 0 else x

    def canonical(self, x: int) -> int:
        return x

    fit = settled = canonical

    def invert(self, x: int) -> int:
        found = inverse_modulo(x, self.p)
        return found + self.p if found < 0 else found


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


def sign(x: Any) -> Any:
    """−1 for x < 0, else 0, for a word: a mask."""
    return x >> 63


def quotient(a: Any, b: Any) -> Any:
    """The whole part of a/b for words a ≥ 0 and b > 0."""
    return a // b


def inverse_modulo(x: Any, p: Any) -> Any:
    """1/x modulo p, of size below p, for x ≠ 0 with |x| < p < 2^63, by Euclid's algorithm."""
    a, b, s, t = p, abs(x), 0, 1
    while b > 1:
        q = quotient(a, b)
        a, b = b, a - q * b
        s, t = t, s - q * t
    return t if x > 0 else -t


def inverse(K: Any, x: Any) -> Any:
    """1/x, canonical, for a canonical x ≠ 0."""
    return K.canonical(K.invert(x))
