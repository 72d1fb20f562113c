"""Batches over fields of word size, compiled: GF(p) for an odd p < 2^63, GF(p^k) of at most 2^16 elements.

In genus 2 with h = 0 (after :mod:`jacobian.batch.equation`) the explicit formulas take the general rows, and Cantor the
others; elsewhere all rows are Cantor's. Importing this module imports numba.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jacobian.addition.cantor_words import packed_curve
from jacobian.addition.genus2_words import Quintic, Sextic
from jacobian.batch import genus2_kernels, row_kernels
from jacobian.batch.equation import Equation
from jacobian.batch.multiples import multiply_by_each, multiply_by_one
from jacobian.batch.threads import in_ranges
from jacobian.fields.prime import PrimeField
from jacobian.fields.table import TableField
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from jacobian.numbers.tables import table_context
from jacobian.numbers.words import Wide32, Wide64, double_context, word_context

FAST = 1 << 14
"""Rows that one call of a kernel takes where formulas are explicit."""
SLOW = 1 << 10
"""Rows that one call of Cantor takes."""
LADDER = 1 << 12
"""Rows that are multiplied together: their tables stay in the processor's cache."""


@dataclass(frozen=True, slots=True)
class Rows:
    """``data`` (2g, N): u₀ … u_{g−1}, v₀ … v_{g−1} in words; ``degree`` (N,); ``weight`` (N,), (0,) where n is None."""

    data: Any
    degree: Any
    weight: Any

    def __len__(self) -> int:
        return len(self.degree)

    def __iter__(self) -> Iterator[Any]:
        return iter((self.data, self.degree, self.weight))


class CompiledRows:
    """The operations on rows of one Jacobian."""

    compiled = True

    def __init__(self, J: Jacobian) -> None:
        K: Any = J.field
        C = J.curve
        self.jacobian, self.field, self.genus = J, K, C.genus
        self.equation = Equation(C)
        curve = self.equation.curve
        # eight products of floats at a time beat one of 64-bit words
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
            # canonical words are words of a wide context too: what matters less is compiled for that alone
            self.slow_K = (Wide32 if self.K.bits == 32 else Wide64)(*self.K)
            if self.floats:
                self.K, self.dtype = double_context(K.p), np.float64
        self.split = C.model == "split"
        self.packed = packed_curve(curve, self.to_word)
        self.formulas: Any = None
        if self.genus == 2 and not curve.h:
            numbers = [self.K.balanced(c) if self.floats else self.to_word(c) for c in (*curve.f, K.zero)]
            self.formulas = Quintic(*numbers[2:5]) if curve.model == "ramified" else Sextic(*numbers[2:7])
        self.plain_negation = not curve.h and (not self.split or self.genus % 2 == 0)
        self.sampler: Any = None
        self.moved = any(c != K.zero for c in self.equation.shift) or self.equation.scale != K.one

    # --- storage

    def empty(self, count: int) -> Rows:
        """Rows to be written."""
        weight = np.zeros(count if self.split else 0, np.uint8)
        return Rows(np.empty((2 * self.genus, count), self.dtype), np.empty(count, np.uint8), weight)

    def take(self, x: Rows, index: Any) -> Rows:
        """The rows of an index: a slice, a mask or an array of ints."""
        return Rows(
            np.ascontiguousarray(x.data[:, index]), x.degree[index], x.weight[index] if self.split else x.weight
        )

    def join(self, parts: Sequence[Rows]) -> Rows:
        """The rows of all parts."""
        return Rows(
            np.concatenate([x.data for x in parts], axis=1),
            np.concatenate([x.degree for x in parts]),
            np.concatenate([x.weight for x in parts]),
        )

    def repeat(self, x: Rows, count: int) -> Rows:
        """One row, ``count`` times."""
        return Rows(np.repeat(x.data, count, axis=1), np.repeat(x.degree, count), np.repeat(x.weight, count))

    def equal(self, x: Rows, y: Rows) -> Any:
        """Which rows are equal, (N,)."""
        same = (x.degree == y.degree) & np.all(x.data == y.data, axis=0)
        return same & (x.weight == y.weight) if self.split else same

    # --- conversion: from the curve's own coordinates and back

    def from_arrays(self, u: Any, v: Any, n: Any) -> Rows:
        """Rows of field elements as ints, u (N, g + 1) and v (N, g); n (N,) on a split model. Nothing is checked."""
        g = self.genus
        degree = (g - np.argmax(u[:, ::-1] != 0, axis=1)).astype(np.uint8)
        elements = np.concatenate([u[:, :g].T, v.T])
        rows = Rows(self._encoded(elements), degree, np.asarray(n if self.split else (), np.uint8))
        if self.moved:
            self._shift(rows, self.equation.shift)
            self._scale(rows, self.equation.scale)
        return self.stored(rows)

    def to_arrays(self, x: Rows) -> tuple[Any, Any]:
        """(u, v): field elements as ints, (N, g + 1) and (N, g)."""
        g, K = self.genus, self.field
        x = self._in_words(x)
        if self.moved:
            x = Rows(x.data.copy(), x.degree, x.weight)
            self._scale(x, K.inv(self.equation.scale))
            self._shift(x, [K.neg(c) for c in self.equation.shift])
        elements = self._decoded(x.data)
        u = np.empty((len(x), g + 1), np.int64)
        u[:, :g] = elements[:g].T
        u[:, g] = x.degree == g
        return u, np.ascontiguousarray(elements[g:].T)

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
        """What is stored of rows in words: least residues if floats are."""
        return Rows(self.K.balanced(self._decoded(x.data)), x.degree, x.weight) if self.floats else x

    def _shift(self, x: Rows, shift: Sequence[Any]) -> None:
        words = np.array([self.to_word(c) for c in shift], np.int64)
        if words.any():
            row_kernels.shift_rows(self.slow_K, self.genus, words, x.data, x.degree)

    def _scale(self, x: Rows, c: Any) -> None:
        if c != self.field.one:
            powers = np.array([self.to_word(power) for power in self.equation.powers(c)], np.int64)
            row_kernels.scale_rows(self.slow_K, self.genus, powers, x.data, x.degree)

    def from_divisors(self, divisors: Sequence[Divisor]) -> Rows:
        """Rows of Divisors of this Jacobian."""
        g = self.genus
        u, v = np.zeros((len(divisors), g + 1), np.int64), np.zeros((len(divisors), g), np.int64)
        for i, D in enumerate(divisors):
            u[i, : len(D.u)] = D.u
            v[i, : len(D.v)] = D.v
        return self.from_arrays(u, v, [D.n for D in divisors] if self.split else None)

    def to_divisors(self, x: Rows) -> list[Divisor]:
        """The rows as Divisors."""
        trim = np.trim_zeros
        u, v = self.to_arrays(x)
        weights = x.weight.tolist() if self.split else [None] * len(x)
        return [
            Divisor(self.jacobian, tuple(trim(a, "b").tolist()), tuple(trim(b, "b").tolist()), n)
            for a, b, n in zip(u, v, weights, strict=True)
        ]

    def weights(self, x: Rows) -> Any:
        """n, (N,), or None on a model without."""
        return x.weight.astype(np.int64) if self.split else None

    def first_off_curve(self, x: Rows) -> int:
        """The first row that is not on the curve, or −1."""
        curve, g, zero = self.equation.curve, self.genus, self.field.zero
        f = np.array([self.to_word(c) for c in (*curve.f, *[zero] * (2 * g + 3 - len(curve.f)))], np.int64)
        h = np.array([self.to_word(c) for c in (*curve.h, *[zero] * (g + 2 - len(curve.h)))], np.int64)
        return int(row_kernels.first_off_curve(self.slow_K, g, f, h, self._in_words(x).data, x.degree))

    # --- the group law

    def add(self, x: Rows, y: Rows) -> Rows:
        """x + y, row by row, on all threads."""
        return self._on_threads(len(x), lambda begin, end, out: self._add(x, y, out, begin, end))

    def double(self, x: Rows) -> Rows:
        """2x, row by row, on all threads."""
        return self._on_threads(len(x), lambda begin, end, out: self._double(x, out, begin, end))

    def negate(self, x: Rows) -> Rows:
        """−x, row by row."""
        return self._on_threads(len(x), lambda begin, end, out: self._negate(x, out, begin, end))

    def _on_threads(self, count: int, work: Callable[[int, int, Rows], None]) -> Rows:
        out = self.empty(count)
        in_ranges(count, SLOW if self.formulas is None else FAST, lambda begin, end: work(begin, end, out))
        return out

    def _add(self, x: Rows, y: Rows, out: Rows, begin: int, end: int) -> None:
        rows = np.empty(end - begin, np.int64)
        if self.formulas is None:
            rows[:] = range(begin, end)
        else:
            out.degree[begin:end] = 2
            count = genus2_kernels.add_rows(
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
            out.degree[begin:end] = 2
            count = genus2_kernels.double_rows(self.K, self.formulas, (x.data, x.degree), out.data, begin, end, rows)
            rows = rows[:count]
        if len(rows):
            self._cantor(row_kernels.cantor_double, (x,), out, rows)

    def _cantor(self, kernel: Any, operands: Sequence[Rows], out: Rows, rows: Any) -> None:
        """A kernel of Cantor's algorithm on the rows of an array of ints."""
        if not self.floats:
            kernel(self.slow_K, self.packed, *map(tuple, operands), tuple(out), rows)
            return
        parts = [self._in_words(self.take(x, rows)) for x in operands]
        found = Rows(np.empty_like(parts[0].data), np.empty_like(parts[0].degree), parts[0].weight.copy())
        kernel(self.slow_K, self.packed, *map(tuple, parts), tuple(found), np.arange(len(rows)))
        out.data[:, rows], out.degree[rows] = self.stored(found).data, found.degree
        if self.split:
            out.weight[rows] = found.weight

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        if not self.plain_negation:
            self._cantor(row_kernels.cantor_negate, (x,), out, np.arange(begin, end))
            return
        row_kernels.negate_v(self.K, x.data, out.data, self.genus, begin, end)
        out.degree[begin:end] = x.degree[begin:end]
        if self.split:
            out.weight[begin:end] = self.genus - x.degree[begin:end] - x.weight[begin:end]

    # --- multiples

    def multiply(self, x: Rows, scalars: int | Sequence[int]) -> Rows:
        """m·x for one m, or m_i·x_i, on all threads."""

        def work(begin: int, end: int) -> Rows:
            part = self.take(x, slice(begin, end))
            if isinstance(scalars, int):
                return multiply_by_one(self, part, scalars)
            return multiply_by_each(self, part, scalars[begin:end])

        return self.join([self.empty(0), *in_ranges(len(x), LADDER, work)])

    def add_here(self, x: Rows, y: Rows) -> Rows:
        """x + y on the calling thread."""
        out = self.empty(len(x))
        self._add(x, y, out, 0, len(x))
        return out

    def double_here(self, x: Rows) -> Rows:
        """2x on the calling thread."""
        out = self.empty(len(x))
        self._double(x, out, 0, len(x))
        return out

    def negate_here(self, x: Rows) -> Rows:
        """−x on the calling thread."""
        out = self.empty(len(x))
        self._negate(x, out, 0, len(x))
        return out

    def zero(self, count: int) -> Rows:
        """The identity, ``count`` times."""
        return self.repeat(self.from_divisors([self.jacobian.zero()]), count)

    def selected(self, stacked: Sequence[Any], choice: Any) -> Rows:
        """Row i of the part choice[i], from (data, degree, weight) of all parts, stacked."""
        out = self.empty(len(choice))
        row_kernels.select_rows(*stacked, choice, *out)
        return out

    def replaced(self, x: Rows, index: Any, part: Rows) -> Rows:
        """x with the rows of an array of ints replaced by those of ``part``."""
        data, degree, weight = x.data.copy(), x.degree.copy(), x.weight.copy()
        data[:, index], degree[index] = part.data, part.degree
        if self.split:
            weight[index] = part.weight
        return Rows(data, degree, weight)
