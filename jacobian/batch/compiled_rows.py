"""Batches over fields of word size, compiled: GF(p) for an odd p < 2^63, GF(p^k) of at most 2^16 elements.

Explicit formulas add the general rows in genus 2, and on ramified models of genus 3 over GF(p); in odd characteristic
:mod:`jacobian.batch.equation` first makes h = 0. Cantor's algorithm adds the other rows, and all rows of other curves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jacobian.addition.cantor_words import ROWS, packed_curve, width
from jacobian.addition.short import short_equation
from jacobian.batch import libraries
from jacobian.batch.row_loops import Room
from jacobian.batch.stored_rows import MOST, Rows, StoredRows
from jacobian.fields.prime import PrimeField
from jacobian.fields.table import TableField
from jacobian.group import Jacobian
from jacobian.numbers.tables import table_context
from jacobian.numbers.words import Wide32, Wide64, double_context, word_context

SLOW = 1 << 10
"""The number of rows in one call of a loop with Cantor's algorithm."""


class CompiledRows(StoredRows):
    """The operations on rows of one Jacobian over a word-size field."""

    compiled = True
    numbers = np.int64

    def __init__(self, J: Jacobian) -> None:
        K: Any = J.field
        super().__init__(J)
        curve = self.equation.curve
        # the processor multiplies eight floats at once, in SIMD lanes, but 64-bit words one after the other
        self.floats = type(K) is PrimeField and self.genus == 2 and 31 < K.p.bit_length() <= 49
        words: Any
        own: Any
        if isinstance(K, TableField):
            words = own = table_context(K)
            self.word_dtype: Any = np.uint16
        else:
            own = word_context(K.p)
            self.word_dtype = np.int32 if own.bits == 32 else np.int64
            # only sums gain from the spare bits of small primes: all other loops are compiled once, for Wide contexts
            words = (Wide32 if own.bits == 32 else Wide64)(*own)
        self.dtype = np.float64 if self.floats else self.word_dtype
        if self.floats:
            own = double_context(K.p)
        to_word = own.balanced if self.floats else words.to_word
        self._compute_with(own, words, short_equation(curve, to_word))
        self.step = SLOW if self.formulas is None else MOST
        self._packed = packed_curve(curve, words.to_word)
        self._cantor_loops = libraries.cantor(self.kind)

    def numbers_in_words(self, elements: Sequence[Any]) -> Any:
        return np.array([self.words.to_word(c) for c in elements], np.int64)

    def encoded(self, elements: Any) -> Any:
        words = np.empty(elements.shape, self.word_dtype)
        self._run.encode_rows(self._packed_words, elements, words)
        return words

    def decoded(self, words: Any) -> Any:
        elements = np.empty(words.shape, np.int64)
        self._run.decode_rows(self._packed_words, words, elements)
        return elements

    def bits(self, words: Any) -> Any:
        """``words`` for loops that only copy numbers: an array of floats is viewed as integers with the same bits."""
        return words.view(np.int64) if self.floats else words

    def of_memory(self, words: Any) -> Any:
        """An int64 array of words, converted to the type in which rows are stored."""
        return words.astype(self.word_dtype)

    def uniform(self, draw: np.random.Generator, count: int) -> Any:
        """The words of ``count`` uniform random elements of a prime field."""
        p = self.field.p
        return draw.integers(p, size=count) - p // 2

    def _in_words(self, x: Rows) -> Rows:
        """The rows x in words, converted from the form in which rows are stored."""
        return Rows(self.encoded(x.data.astype(np.int64)), x.degree, x.weight) if self.floats else x

    def stored(self, x: Rows) -> Rows:
        """The stored form of rows in words: balanced residues as floats where rows are floats, else the words."""
        return Rows(self.K.balanced(self.decoded(x.data)), x.degree, x.weight) if self.floats else x

    def _add_special(self, operands: Sequence[Rows], out: Rows, chosen: Any) -> None:
        self._cantor("cantor_add" if len(operands) == 2 else "cantor_double", operands, out, chosen)

    def _cantor(self, name: str, operands: Sequence[Rows], out: Rows, chosen: Any) -> None:
        """Runs a loop of Cantor's algorithm on the rows whose indices are in ``chosen``."""
        g, rows, found = self.genus, chosen, out
        if self.floats:
            operands = [self._in_words(self.take(x, chosen)) for x in operands]
            first, rows = operands[0], np.arange(len(chosen))
            found = Rows(np.empty_like(first.data), np.empty_like(first.degree), first.weight.copy())
        room = Room(np.empty((ROWS, 4 * g + 8), np.int64), np.zeros(width(g), np.int64), np.zeros(width(g), np.int64))
        loop = getattr(self._cantor_loops, name)
        loop(self._packed_words, self._packed, tuple(map(tuple, operands)), tuple(found), rows, room)
        if self.floats:
            self.put(out, chosen, self.stored(found))

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        if self.split and self.genus % 2 == 1:
            self._cantor("cantor_negate", (x,), out, np.arange(begin, end))
        elif self.floats:
            out.data[:, begin:end] = x.data[:, begin:end]
            out.data[self.genus :, begin:end] *= -1
            self._negate_weights(x, out, begin, end)
        else:
            super()._negate(x, out, begin, end)
