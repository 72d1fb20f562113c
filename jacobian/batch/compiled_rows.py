"""Batches over fields of word size, compiled: GF(p) for an odd p < 2^63, GF(p^k) of at most 2^16 elements.

Explicit formulas add the general rows in genus 2, and on ramified models of genus 3 over GF(p); in odd characteristic
:mod:`jacobian.batch.equation` first makes h = 0. Cantor's algorithm adds the other rows, and all rows elsewhere.
Importing this module imports numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jacobian.addition import genus2_words, genus3_words
from jacobian.addition.cantor_words import packed_curve
from jacobian.batch import genus2_kernels, genus3_kernels, row_kernels
from jacobian.batch.stored_rows import Rows, StoredRows
from jacobian.fields.prime import PrimeField
from jacobian.fields.table import TableField
from jacobian.group import Jacobian
from jacobian.numbers.tables import table_context
from jacobian.numbers.words import Wide32, Wide64, double_context, word_context

FAST = 1 << 14
"""The number of rows in one call of an explicit-formula kernel."""
SLOW = 1 << 10
"""The number of rows in one call of a kernel of Cantor's algorithm."""


class CompiledRows(StoredRows):
    """The operations on rows of one Jacobian over a word-size field."""

    compiled = True
    numbers = np.int64

    def __init__(self, J: Jacobian) -> None:
        K: Any = J.field
        super().__init__(J)
        curve = self.equation.curve
        # eight products of floats in SIMD lanes are faster than one product of 64-bit words after the other
        self.floats = type(K) is PrimeField and self.genus == 2 and 31 < K.p.bit_length() <= 49
        self.K: Any
        self.slow_K: Any
        self.dtype: Any
        self.word_dtype: Any
        self.to_word: Any = int
        if isinstance(K, TableField):
            self.K = self.slow_K = table_context(K)
            self.dtype = self.word_dtype = np.uint16
        else:
            self.K = word_context(K.p)
            self.dtype = self.word_dtype = np.int32 if self.K.bits == 32 else np.int64
            self.to_word = self.K.to_word
            # canonical words are valid in a wide context too: rarely used kernels are compiled for that one only
            self.slow_K = (Wide32 if self.K.bits == 32 else Wide64)(*self.K)
            if self.floats:
                self.K, self.dtype = double_context(K.p), np.float64
        self.packed = packed_curve(curve, self.to_word)
        to_word = self.K.balanced if self.floats else self.to_word
        self.formulas: Any = genus2_words.short_equation(curve, to_word)
        self._explicit: Any = genus2_kernels
        if self.genus == 3:
            self.formulas, self._explicit = genus3_words.short_equation(curve, self.to_word), genus3_kernels
        self.plain_negation = not curve.h and (not self.split or self.genus % 2 == 0)
        self.sampler: Any = None
        self.step = SLOW if self.formulas is None else FAST

    def _encoded(self, elements: Any) -> Any:
        """The words of field elements, ints."""
        if self.word_dtype == np.uint16:
            return elements.astype(np.uint16)
        words = np.empty(elements.shape, self.word_dtype)
        row_kernels.encode_rows(self.slow_K, elements, words)
        return words

    def _decoded(self, words: Any) -> Any:
        """The field elements, ints, of words."""
        elements = words.astype(np.int64)
        if self.word_dtype != np.uint16:
            row_kernels.decode_rows(self.slow_K, words, elements)
        return elements

    def _in_words(self, x: Rows) -> Rows:
        """Rows in words, from what is stored."""
        return Rows(self._encoded(x.data.astype(np.int64)), x.degree, x.weight) if self.floats else x

    def stored(self, x: Rows) -> Rows:
        """The stored form of rows in words: balanced residues as floats where rows are floats, else the words."""
        return Rows(self.K.balanced(self._decoded(x.data)), x.degree, x.weight) if self.floats else x

    def _shift(self, x: Rows, shift: Sequence[Any]) -> None:
        words = np.array([self.to_word(c) for c in shift], np.int64)
        if words.any():
            row_kernels.shift_rows(self.slow_K, self.genus, words, x.data, x.degree)

    def _scale(self, x: Rows, c: Any) -> None:
        if c != self.field.one:
            powers = np.array([self.to_word(power) for power in self.equation.powers(c)], np.int64)
            row_kernels.scale_rows(self.slow_K, self.genus, powers, x.data, x.degree)

    def first_off_curve(self, x: Rows) -> int:
        """The first row that is not on the curve, or −1."""
        curve, g, zero = self.equation.curve, self.genus, self.field.zero
        f = np.array([self.to_word(c) for c in (*curve.f, *[zero] * (2 * g + 3 - len(curve.f)))], np.int64)
        h = np.array([self.to_word(c) for c in (*curve.h, *[zero] * (g + 2 - len(curve.h)))], np.int64)
        return int(row_kernels.first_off_curve(self.slow_K, g, f, h, self._in_words(x).data, x.degree))

    def _add(self, x: Rows, y: Rows, out: Rows, begin: int, end: int) -> None:
        rows = np.empty(end - begin, np.int64)
        if self.formulas is None:
            rows[:] = range(begin, end)
        else:
            out.degree[begin:end] = self.genus
            count = self._explicit.add_rows(
                self.K, self.formulas, (x.data, x.degree), (y.data, y.degree), out.data, begin, end, rows
            )
            rows = rows[:count]
        if len(rows):
            self._cantor(row_kernels.cantor_add, (x, y), out, rows)

    def _double(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        rows = np.empty(end - begin, np.int64)
        if self.formulas is None:
            rows[:] = range(begin, end)
        else:
            out.degree[begin:end] = self.genus
            count = self._explicit.double_rows(self.K, self.formulas, (x.data, x.degree), out.data, begin, end, rows)
            rows = rows[:count]
        if len(rows):
            self._cantor(row_kernels.cantor_double, (x,), out, rows)

    def _cantor(self, kernel: Any, operands: Sequence[Rows], out: Rows, rows: Any) -> None:
        """Runs a kernel of Cantor's algorithm on the rows whose indices are in ``rows``."""
        if not self.floats:
            kernel(self.slow_K, self.packed, *map(tuple, operands), tuple(out), rows)
            return
        parts = [self._in_words(self.take(x, rows)) for x in operands]
        found = Rows(np.empty_like(parts[0].data), np.empty_like(parts[0].degree), parts[0].weight.copy())
        kernel(self.slow_K, self.packed, *map(tuple, parts), tuple(found), np.arange(len(rows)))
        self.put(out, rows, self.stored(found))

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        if not self.plain_negation:
            self._cantor(row_kernels.cantor_negate, (x,), out, np.arange(begin, end))
            return
        row_kernels.negate_v(self.K, x.data, out.data, self.genus, begin, end)
        self._negate_weights(x, out, begin, end)

    def selected(self, stacked: Sequence[Any], choice: Any) -> Rows:
        """The rows whose row i is row i of part choice[i]; ``stacked`` is (data, degree, weight) of all parts."""
        out = self.empty(len(choice))
        row_kernels.select_rows(*stacked, choice, *out)
        return out
