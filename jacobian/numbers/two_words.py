"""Arithmetic modulo an odd prime below 2^128 on two words: Montgomery's representation, always the least residue.

An element ``a`` is represented by a·2^128 modulo p, an int in [0, p). Least residues need no spare bits, so one context
serves every prime of two words. A sum is computed as the difference x − (p − y), and p is added if it is negative.
Montgomery's reduction (1985) subtracts: with m = T/p modulo 2^128 the low halves of T and mp are equal, and the
difference of the high halves lies between −p and p. Sums of products add up modulo 2^128·p before they are reduced.

The functions of :mod:`jacobian.numbers.words` accept a :class:`TwoWords` too: in Python unchanged, and compiled by
:mod:`jacobian.native.modular`. Formulas written with them therefore run on one word and on two.
"""

from __future__ import annotations

import operator
from collections import namedtuple
from collections.abc import Sequence
from typing import Any

from jacobian.errors import ArgumentError

BITS = 128


class LeastResidues:
    """Operations of contexts whose words are least residues modulo p."""

    __slots__ = ()
    p: int

    def add(self, x: int, y: int) -> int:
        return (x + y) % self.p

    def sub(self, x: int, y: int) -> int:
        return (x - y) % self.p

    def neg(self, x: int) -> int:
        return -x % self.p

    def canonical(self, x: int) -> int:
        return x % self.p

    fit = settled = canonical


class TwoWords(namedtuple("TwoWords", "p reciprocal one square cube"), LeastResidues):
    """The context of p. Its fields: p, 1/p modulo 2^128, and 2^128, 2^256, 2^384 modulo p."""

    __slots__ = ()

    def to_word(self, a: int) -> int:
        """The word that represents a residue."""
        return self.dot(a, self.square)

    def from_word(self, x: int) -> int:
        """The residue 0 ≤ a < p that a word represents."""
        return self.dot(x, 1)

    def dot(self, *terms: int) -> int:
        """terms[0]·terms[1] + terms[2]·terms[3] + …, by Montgomery's reduction."""
        total = sum_of_products(terms)
        quotient = total * self.reciprocal % (1 << BITS)
        return (total - quotient * self.p >> BITS) % self.p

    def invert(self, x: int) -> int:
        return inverse(self, x)


class Residues(namedtuple("Residues", "p one", defaults=(1,)), LeastResidues):
    """The context of a modulus p of any size, for functions that run in Python. A residue is its own word."""

    __slots__ = ()

    def to_word(self, a: int) -> int:
        return a

    from_word = to_word

    def dot(self, *terms: int) -> int:
        return sum_of_products(terms) % self.p

    def invert(self, x: int) -> int:
        return pow(x, -1, self.p)


def sum_of_products(terms: Sequence[int]) -> int:
    """terms[0]·terms[1] + terms[2]·terms[3] + …"""
    return sum(map(operator.mul, terms[::2], terms[1::2]))


def two_words(p: int) -> TwoWords:
    """The context of an odd prime p < 2^128."""
    if p < 3 or p % 2 == 0 or p.bit_length() > BITS:
        raise ArgumentError(f"p = {p}: two words take an odd prime below 2^128")
    return TwoWords(p, pow(p, -1, 1 << BITS), *((1 << BITS * i) % p for i in (1, 2, 3)))


def long(n: Any) -> Any:
    """n ≥ 0 as a number of two words; in Python this is n itself."""
    return n


def trailing_zeros(x: Any) -> Any:
    """The exponent of 2 in x > 0."""
    return (x & -x).bit_length() - 1


def inverse(K: Any, x: Any) -> Any:
    """1/x for a word x ≠ 0, by the binary extended Euclidean algorithm. The k halvings are corrected at the end
    (Kaliski 1995).

    ``us + vr = p`` throughout, so that neither r nor s outgrows p; ``sx = 2^k·v`` and ``rx = −2^k·u`` modulo p.
    """
    k = trailing_zeros(x)
    u, v, r, s = K.p, x >> k, long(0), long(1)
    while u != v:
        if u > v:
            u -= v
            r += s
            zeros = trailing_zeros(u)
            u >>= zeros
            s <<= zeros
        else:
            v -= u
            s += r
            zeros = trailing_zeros(v)
            v >>= zeros
            r <<= zeros
        k += zeros
    # 2^256/x is s·2^(256 − k) = 2s·2^(255 − k), and 2^(255 − k), k ≥ 1, is a product of two powers below 2^128
    rest = 2 * BITS - 1 - k
    half = rest >> 1
    lifted = K.dot(K.add(s, s), long(1) << half)
    return K.canonical(K.dot(K.dot(lifted, long(1) << (rest - half)), K.cube))
