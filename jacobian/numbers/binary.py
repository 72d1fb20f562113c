"""Arithmetic in GF(2^n), n ≤ 127, on one word or two: polynomials over GF(2) as bits, in Montgomery's representation.

An element ``a`` is represented by a·x^w modulo the modulus M, w = 64 for n < 64 and 128 otherwise (Koç and Acar 1998).
Let T be a product of two representatives, and q = T/M modulo x^w. Then the low halves of T and qM are equal. The high
half of T + qM is T/x^w modulo M. This half has a degree below n for every M, so no comparison with M is needed. Sums
are exclusive ors; sums of products are reduced once.

The functions of :mod:`jacobian.numbers.words` accept these contexts too: in Python unchanged, and compiled by
:mod:`jacobian.native.binary`.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

from jacobian.errors import ArgumentError
from jacobian.numbers.two_words import long

MOST_DEGREE = 127
FIFTHS = sum(1 << i for i in range(0, 65, 5))
"""Every fifth bit of a word, from the lowest."""

_Constants = namedtuple("_Constants", "modulus reciprocal one square degree")
"""M; 1/M modulo x^w; x^w and x^(2w) modulo M; n."""


class BinaryContext(_Constants):
    """The methods that the contexts of one and of two words share."""

    __slots__ = ()
    bits: int

    def to_word(self, a: int) -> int:
        """The word that represents an element."""
        return self.dot(a, self.square)

    def from_word(self, x: int) -> int:
        """The element that a word represents."""
        return self.dot(x, 1)

    def dot(self, *terms: int) -> int:
        """terms[0]·terms[1] + terms[2]·terms[3] + …, by Montgomery's reduction."""
        total = 0
        for a, b in zip(terms[::2], terms[1::2], strict=True):
            total ^= carryless_product(a, b)
        low = (1 << self.bits) - 1
        quotient = carryless_product(total & low, self.reciprocal) & low
        return (total ^ carryless_product(quotient, self.modulus)) >> self.bits

    def add(self, x: int, y: int) -> int:
        return x ^ y

    sub = add

    def neg(self, x: int) -> int:
        return x

    fit = settled = canonical = neg

    def invert(self, x: int) -> int:
        return inverse(self, x)


class BinaryWord(BinaryContext):
    """The context of GF(2^n) on one word: n < 64."""

    __slots__ = ()
    bits = 64


class BinaryTwoWords(BinaryContext):
    """The context of GF(2^n) on two words: n < 128."""

    __slots__ = ()
    bits = 128


def binary_context(modulus: int) -> BinaryContext:
    """The context of GF(2)[x]/M. The bits of ``modulus`` are the coefficients of M, irreducible of degree 2 to 127."""
    degree = modulus.bit_length() - 1
    if not 2 <= degree <= MOST_DEGREE or modulus % 2 == 0:
        raise ArgumentError(
            f"modulus = {modulus:#b}: two words take an irreducible polynomial of degree 2 to {MOST_DEGREE}"
        )
    kind = BinaryWord if degree < 64 else BinaryTwoWords
    reciprocal = 1
    for _ in range(kind.bits.bit_length() - 1):
        reciprocal = carryless_product(carryless_product(reciprocal, reciprocal), modulus) & ((1 << kind.bits) - 1)
    one, square = (_remainder(1 << kind.bits * i, modulus) for i in (1, 2))
    return kind._make((modulus, reciprocal, one, square, degree))


def _remainder(x: int, modulus: int) -> int:
    while (shift := x.bit_length() - modulus.bit_length()) >= 0:
        x ^= modulus << shift
    return x


def carryless_product(x: int, y: int) -> int:
    """The product of two polynomials over GF(2) given as bit masks, four bits of y at a time."""
    multiples = [0, x]
    for i in range(1, 8):
        multiples += [multiples[i] << 1, multiples[i] << 1 ^ x]
    product = 0
    for position in range(0, y.bit_length(), 4):
        product ^= multiples[y >> position & 15] << position
    return product


def product_of_words(x: Any, y: Any) -> Any:
    """The carry-less product of x, y < 2^64, from integer products of x and y restricted to every fifth bit.

    At most 13 terms fall on one bit position, so their sum fits into five bits and no carry reaches the next (Pornin
    2017).
    """
    found = long(0)
    for i in range(5):
        part = long(0)
        for j in range(5):
            part ^= (x & (long(FIFTHS) << j)) * (y & (long(FIFTHS) << ((i + 5 - j) % 5)))
        found ^= part & ((long(FIFTHS) | long(FIFTHS) << 65) << i)
    return found


def inverse(K: Any, x: Any) -> Any:
    """1/x = x^(2^n − 2) for a word x ≠ 0 (Itoh and Tsujii 1988).

    x^(2^k − 1) is computed in turn for the numbers k that the first, the first two, … binary digits of n − 1 form.
    """
    bit = 1
    while 2 * bit < K.degree:
        bit *= 2
    found, k = x, 1
    while bit > 1:
        bit >>= 1
        power = found
        for _ in range(k):
            power = K.dot(power, power)
        found = K.dot(found, power)
        k *= 2
        if (K.degree - 1) & bit != 0:
            found = K.dot(K.dot(found, found), x)
            k += 1
    return K.dot(found, found)
