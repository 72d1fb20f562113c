"""Compiled batches on numbers of two words.

They exist in genus 2 and 3 over GF(p), 2^63 < p < 2^128, and in genus 2 over GF(2^n), 16 < n < 128.

In genus 3 the model is ramified. Explicit formulas add the general rows; the kernel of single classes in Python adds
the other rows, one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jacobian.addition.calls import two_word_context
from jacobian.addition.choice import python_kernel
from jacobian.addition.short import short_equation
from jacobian.batch.stored_rows import Rows, StoredRows
from jacobian.group import Jacobian
from jacobian.native.longs import WORDS, numbers_of, pairs, words_of

MOST = (1 << 64) - 1
"""The largest word."""


class TwoWordRows(StoredRows):
    """The operations on rows of one Jacobian over a field whose elements take two words."""

    compiled = False
    dtype, numbers, step = WORDS, object, 1 << 12

    def __init__(self, J: Jacobian) -> None:
        super().__init__(J)
        K, curve = two_word_context(self.field), self.equation.curve
        self._compute_with(K, K, short_equation(curve, K.to_word))
        self._one_by_one = python_kernel(curve)

    def view(self, words: Any) -> Any:
        """A view of an array of words as pairs of ints, the form that loops take."""
        return pairs(words)

    def memory(self, *shape: int) -> Any:
        """Uninitialised memory for pairs of ints."""
        return np.empty((*shape, 2), np.int64)

    def numbers_in_words(self, elements: Sequence[Any]) -> Any:
        """The words that represent field elements, as pairs of ints."""
        return pairs(words_of([self.words.to_word(c) for c in elements]))

    def encoded(self, elements: Any) -> Any:
        found = words_of(elements).copy()
        self._run.encode_rows(self._packed_words, pairs(found), pairs(found))
        return found

    def decoded(self, words: Any) -> Any:
        found = words.copy()
        self._run.decode_rows(self._packed_words, pairs(found), pairs(found))
        return numbers_of(found)

    def of_memory(self, words: Any) -> Any:
        """A view of pairs of ints as an array of words."""
        return words.view(WORDS)[..., 0]

    def uniform(self, draw: np.random.Generator, count: int) -> Any:
        """The words of uniform random elements of a prime field: the numbers below p among ``count`` draws."""
        p = self.field.p
        low, high = draw.integers(1 << 64, size=(2, count), dtype=np.uint64)
        mask = (1 << p.bit_length()) - 1
        low &= np.uint64(mask & MOST)
        high &= np.uint64(mask >> 64)
        top, bottom = np.uint64(p >> 64), np.uint64(p & MOST)
        below = (high < top) | ((high == top) & (low < bottom))
        return np.stack([low[below], high[below]], axis=1).view(np.int64)

    def _add_special(self, operands: Sequence[Rows], out: Rows, chosen: Any) -> None:
        single = self._one_by_one.sum_of if len(operands) == 2 else self._one_by_one.double
        parts = zip(*(self.triples(self.take(x, chosen)) for x in operands), strict=True)
        self.put(out, chosen, self.of_triples([single(*part) for part in parts]))
