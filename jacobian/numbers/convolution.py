"""Cyclic convolutions modulo a prime p < 2^49 by transforms modulo two or three other primes, on arrays of floats.

Residues are canonical: whole floats within ±p/2. A convolution is computed over the integers from its residues; its
entries are smaller than half the product of the primes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from jacobian.numbers.transform_kernels import LEAST
from jacobian.numbers.words import double_context

__all__ = ["LEAST", "LONGEST", "Convolutions", "balanced"]

LONGEST = 1 << 25
PRIMES = {(2**24 - 13) * LONGEST + 1: 5, (2**24 - 20) * LONGEST + 1: 3, (2**24 - 32) * LONGEST + 1: 3}
"""The three largest primes ≡ 1 modulo 2^25 below 2^49, each with a non-residue."""
CONTEXTS = tuple(double_context(q) for q in PRIMES)


class Convolutions:
    """Cyclic convolutions modulo p; their lengths are powers of 2 from LEAST to ``longest`` ≤ LONGEST.

    At least half of the entries of one factor must be 0. ``loops`` holds the compiled functions of
    :mod:`jacobian.numbers.transform_kernels`.
    """

    def __init__(self, p: int, longest: int, loops: Any) -> None:
        self.p, self.P, self.loops = p, double_context(p), loops
        primes = list(PRIMES)
        # an entry of the convolution is a sum of at most longest/2 products, each of size at most (p/2)²
        count = 2 if longest * p * p < 4 * primes[0] * primes[1] else 3
        self.used = list(PRIMES.items())[:count]
        # a shorter transform uses only the first part of these factors
        self.down = [_factors(loops, q, g, longest) for q, g in self.used]
        self.up = [_factors(loops, q, pow(g, -1, q), longest) for q, g in self.used]

    def transform(self, values: Any, length: int) -> Any:
        """The transforms of ``values``, padded with zeros, modulo each prime in use; shape (2 or 3, length)."""
        found = np.zeros((len(self.used), length))
        for Q, W, row in zip(CONTEXTS, self.down, found, strict=False):
            row[: len(values)] = values
            self.loops.forward(Q, W, row, np.empty(LEAST))
        return found

    def product(self, a: Any, b: Any, begin: int, scale: Any, out: Any) -> None:
        """Sets out[i] = scale[i]·(a ∗ b)[begin + i] modulo p; ``a`` and ``b`` are given by their transforms."""
        residues = np.empty_like(a)
        for Q, W, x, y, row in zip(CONTEXTS, self.up, a, b, residues, strict=False):
            self.loops.multiply(Q, x, y, row)
            self.loops.backward(Q, W, row, np.empty(LEAST))
        constants = self._constants(residues.shape[1])
        self.loops.combined(self.P, CONTEXTS, constants, residues, begin, scale, out)

    def _constants(self, length: int) -> Any:
        """The constants of :func:`jacobian.numbers.transform_kernels.combined`, with 1/length for each prime, because a
        transform followed by its inverse multiplies by the length.
        """
        a, b, c = PRIMES
        pairs = [(pow(length, -1, q), q) for q in PRIMES]
        pairs += [(pow(a, -1, b), b), (a, self.p), (pow(a, -1, c), c), (pow(b, -1, c), c), (a * b, self.p)]
        return np.array([balanced(*pair) for pair in pairs])


def balanced(a: int, p: int) -> float:
    """The canonical residue of ``a`` modulo p, as a float."""
    a %= p
    return float(a - p if 2 * a > p else a)


def _factors(loops: Any, q: int, g: int, length: int) -> Any:
    roots = [balanced(pow(g, (q - 1) >> (i + 2), q), q) for i in range(length.bit_length() - 2)]
    W = np.empty(length // 2)
    loops.factors(double_context(q), np.array(roots), W)
    return W
