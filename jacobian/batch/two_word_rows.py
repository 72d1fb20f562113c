"""Compiled batches on numbers of two words: genus 2 and 3 over GF(p), 2^63 < p < 2^128, and genus 2 over GF(2^n), 16 <
n < 128.

In genus 3 the model is ramified. The explicit formulas of :mod:`jacobian.addition.two_word_loops` add the general rows;
the kernel of single classes in Python adds the others, one by one. Importing this module needs no numba.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from jacobian.addition.cantor import Triple
from jacobian.addition.choice import python_kernel
from jacobian.addition.two_word_libraries import CONTEXTS, MODELS, ROW_LIBRARIES, context_of, equation_of
from jacobian.addition.two_word_loops import BLOCK, SCRATCH
from jacobian.batch.stored_rows import Rows, StoredRows
from jacobian.group import Jacobian
from jacobian.native.library import Packed
from jacobian.native.longs import WORDS, numbers_of, pairs, words_of


class TwoWordRows(StoredRows):
    """The operations on rows of one Jacobian."""

    compiled = False
    """Whether arrays of field elements are int64; here they are objects."""
    dtype, numbers, step = WORDS, object, 1 << 12

    def __init__(self, J: Jacobian) -> None:
        super().__init__(J)
        self.K = context_of(self.field)
        curve = self.equation.curve
        formulas = equation_of(curve, self.K.to_word)
        self._run = ROW_LIBRARIES[type(self.K), type(formulas)]
        self._context = Packed(self.K, CONTEXTS[type(self.K)])
        self._formulas = Packed(formulas, MODELS[type(formulas)])
        self._h, self._f = (pairs(words_of([self.K.to_word(c) for c in a])) for a in (curve.h, curve.f))
        self._one_by_one = python_kernel(curve)

    # --- conversion

    def _encoded(self, elements: Any) -> Any:
        found = words_of(elements).copy()
        self._run.encode_rows(self._context, pairs(found))
        return found

    def _decoded(self, words: Any) -> Any:
        found = words.copy()
        self._run.decode_rows(self._context, pairs(found))
        return numbers_of(found)

    def _shift(self, x: Rows, shift: Sequence[Any]) -> None:
        if any(shift):
            words = words_of([self.K.to_word(c) for c in shift])
            self._run.shift_rows(self._context, pairs(words), pairs(x.data), x.degree.astype(np.int64), self._room())

    def _scale(self, x: Rows, c: Any) -> None:
        if c != self.field.one:
            words = words_of([self.K.to_word(power) for power in self.equation.powers(c)])
            self._run.scale_rows(self._context, pairs(words), pairs(x.data), x.degree.astype(np.int64))

    def first_off_curve(self, x: Rows) -> int:
        """The first row that is not on the curve, or −1."""
        equation, degree = (self._h, self._f), x.degree.astype(np.int64)
        return int(self._run.first_off_curve(self._context, equation, pairs(x.data), degree, self._room()))

    def _room(self) -> Any:
        """Scratch for three polynomials modulo a u."""
        return np.empty((3, self.genus, 2), np.int64)

    # --- the group law

    def _add(self, x: Rows, y: Rows, out: Rows, begin: int, end: int) -> None:
        self._rows("add_rows", self._one_by_one.sum_of, (x, y), out, (begin, end))

    def _double(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        self._rows("double_rows", self._one_by_one.double, (x,), out, (begin, end))

    def _rows(
        self, name: str, single: Callable[..., Triple], operands: Sequence[Rows], out: Rows, span: tuple[int, int]
    ) -> None:
        """Computes the rows of a span by the loop of that name, and the special rows by ``single``."""
        begin, end = span
        special, scratch = np.empty(end - begin, np.int64), np.empty((SCRATCH, BLOCK, 2), np.int64)
        arrays = [(pairs(x.data), x.degree[begin:end].astype(np.int64)) for x in operands]
        loop = getattr(self._run, name)
        count = loop(self._context, self._formulas, *arrays, pairs(out.data), span, special, scratch)
        out.degree[begin:end] = self.genus
        if self.split:
            out.weight[begin:end] = 0
        if not count:
            return
        chosen = special[:count]
        triples = [
            single(*parts) for parts in zip(*(self._triples(self.take(x, chosen)) for x in operands), strict=True)
        ]
        self.put(out, chosen, self._from_triples(triples))

    def _triples(self, x: Rows) -> list[Triple]:
        """Rows as triples on the equation in which they are added."""
        columns = self._decoded(x.data).T.tolist()
        weights = x.weight.tolist() if self.split else [None] * len(x)
        found = []
        for column, degree, n in zip(columns, x.degree.tolist(), weights, strict=True):
            v = column[self.genus :]
            while v and not v[-1]:
                v.pop()
            found.append(((*column[:degree], 1), tuple(v), n))
        return found

    def _from_triples(self, triples: Sequence[Triple]) -> Rows:
        g = self.genus
        zeros = [0] * g
        elements = [[*u, *zeros][:g] + [*v, *zeros][:g] for u, v, _ in triples]
        weight = np.array([n for _, _, n in triples] if self.split else (), np.uint8)
        return Rows(
            self._encoded(np.array(elements, object).T), np.array([len(u) - 1 for u, _, _ in triples], np.uint8), weight
        )

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        first = pairs(x.data), x.degree[begin:end].astype(np.int64)
        self._run.negate_rows(
            self._context, self._formulas, self._h, first, pairs(out.data), (begin, end), self._room()
        )
        self._negate_weights(x, out, begin, end)

    def selected(self, stacked: Sequence[Any], choice: Any) -> Rows:
        """Row i of the part choice[i], from (data, degree, weight) of all parts, stacked."""
        data, degree, weight = stacked
        rows = np.arange(len(choice))
        return Rows(
            np.ascontiguousarray(data[choice, :, rows].T),
            degree[choice, rows],
            weight[choice, rows] if self.split else np.empty(0, np.uint8),
        )
