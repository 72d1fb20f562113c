"""Rows of divisor classes in arrays of words of any kind, and the compiled loops over them.

The methods that depend on the kind of words are in :mod:`jacobian.batch.compiled_rows` and
:mod:`jacobian.batch.two_word_rows`.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jacobian import poly
from jacobian.addition.cantor import Triple
from jacobian.addition.ladder import multiple
from jacobian.batch import libraries
from jacobian.batch.block_loops import SCRATCH
from jacobian.batch.equation import Equation
from jacobian.batch.multiples import multiply_by_each
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from jacobian.native.library import Packed
from jacobian.native.words import CONTEXTS
from jacobian.numbers.threads import in_ranges

MOST = 1 << 14
"""The largest number of rows in one call of a loop."""
LADDER = 1 << 12
"""The number of rows in one ladder; the tables of so many rows fit into the processor's cache."""


@dataclass(frozen=True, slots=True)
class Rows:
    """N classes: ``data`` (2g, N) holds u₀ … u_{g−1}, v₀ … v_{g−1} in words, ``degree`` (N,) deg u, and ``weight`` (N,)
    the weight n at ∞₊; ``weight`` is (0,) where n is None.
    """

    data: Any
    degree: Any
    weight: Any

    def __len__(self) -> int:
        return len(self.degree)

    def __iter__(self) -> Iterator[Any]:
        return iter((self.data, self.degree, self.weight))


class StoredRows:
    """The operations on rows of one Jacobian.

    ``K`` is the context of the explicit formulas, ``words`` the context of all other loops: both store numbers in the
    same form unless rows are floats. ``dtype`` is the dtype of rows, ``numbers`` the dtype of arrays of field elements.
    ``formulas`` is the short equation that the explicit formulas use, or None. One call of a loop adds at most ``step``
    rows.
    """

    compiled: bool
    """Whether arrays of field elements are int64; else they are objects."""
    dtype: Any
    numbers: Any
    step: int

    def __init__(self, J: Jacobian) -> None:
        self.jacobian, self.genus, self.split = J, J.curve.genus, J.curve.model == "split"
        self.field: Any = J.field
        self.equation = Equation(J.curve)
        self.moved = any(c != self.field.zero for c in self.equation.shift) or self.equation.scale != self.field.one
        self.sampler: Any = None
        self._of_thread = threading.local()

    def _compute_with(self, K: Any, words: Any, formulas: Any) -> None:
        """Sets the contexts and the short equation of the formulas, and finds the compiled loops."""
        self.K, self.words, self.formulas = K, words, formulas
        self.kind = words.__class__
        self._packed_words = Packed(words, CONTEXTS[self.kind])
        self._run = libraries.conversions(self.kind)
        if formulas is not None:
            kinds = K.__class__, formulas.__class__
            self._sums = libraries.sums(*kinds)
            self._constants = Packed(K, CONTEXTS[kinds[0]]), Packed(formulas, libraries.equation(*kinds))
        self._h, self._f = (self.numbers_in_words(a) for a in (self.equation.curve.h, self.equation.curve.f))

    # --- methods that depend on the kind of words

    def view(self, words: Any) -> Any:
        """An array of words in the form that loops take: a view of the same memory, as pairs of ints for numbers of two
        words.
        """
        return words

    def bits(self, words: Any) -> Any:
        """An array of stored rows in the form taken by loops that only copy numbers."""
        return self.view(words)

    def memory(self, *shape: int) -> Any:
        """Uninitialised memory for numbers, in the form that loops take."""
        return np.empty(shape, np.int64)

    def numbers_in_words(self, elements: Sequence[Any]) -> Any:
        """The words that represent field elements, in the form that loops take."""
        raise NotImplementedError

    def of_memory(self, words: Any) -> Any:
        """An array of words, converted from the form that loops take."""
        raise NotImplementedError

    def uniform(self, draw: np.random.Generator, count: int) -> Any:
        """The words of at most ``count`` uniform random elements of a prime field, in the form that loops take."""
        raise NotImplementedError

    def encoded(self, elements: Any) -> Any:
        """The words that represent field elements, given as ints."""
        raise NotImplementedError

    def decoded(self, words: Any) -> Any:
        """The field elements, as ints, that words represent."""
        raise NotImplementedError

    def _in_words(self, x: Rows) -> Rows:
        """The rows x in words, converted from the form in which rows are stored."""
        return x

    def stored(self, x: Rows) -> Rows:
        """The rows x, given in words, in the form in which rows are stored."""
        return x

    def _add_special(self, operands: Sequence[Rows], out: Rows, chosen: Any) -> None:
        """Writes the sums of two operands, or the double of one, to the rows of ``out`` with the indices ``chosen``."""
        raise NotImplementedError

    # --- storage

    def empty(self, count: int) -> Rows:
        """``count`` uninitialised rows."""
        weight = np.zeros(count if self.split else 0, np.uint8)
        return Rows(np.empty((2 * self.genus, count), self.dtype), np.empty(count, np.uint8), weight)

    def take(self, x: Rows, index: Any) -> Rows:
        """The rows that ``index`` selects: a slice, a mask or an array of ints."""
        data, degree = np.ascontiguousarray(x.data[:, index]), np.ascontiguousarray(x.degree[index])
        return Rows(data, degree, np.ascontiguousarray(x.weight[index]) if self.split else x.weight)

    def put(self, x: Rows, index: Any, part: Rows) -> None:
        """Replaces the rows of x whose indices are in ``index``, an array of ints, by the rows of ``part``."""
        x.data[:, index], x.degree[index] = part.data, part.degree
        if self.split:
            x.weight[index] = part.weight

    def join(self, parts: Sequence[Rows]) -> Rows:
        """The rows of all parts, concatenated."""
        return Rows(
            np.concatenate([x.data for x in parts], axis=1),
            np.concatenate([x.degree for x in parts]),
            np.concatenate([x.weight for x in parts]),
        )

    def repeat(self, x: Rows, count: int) -> Rows:
        """The row x ``count`` times."""
        return Rows(np.repeat(x.data, count, axis=1), np.repeat(x.degree, count), np.repeat(x.weight, count))

    def equal(self, x: Rows, y: Rows) -> Any:
        """Whether the rows of x and y are equal, (N,)."""
        same = (x.degree == y.degree) & np.all(x.data == y.data, axis=0)
        return same & (x.weight == y.weight) if self.split else same

    def weights(self, x: Rows) -> Any:
        """The weight n at ∞₊ of each row, (N,); None where divisors have no such weight."""
        return x.weight.astype(np.int64) if self.split else None

    # --- conversion: from the curve's own coordinates and back

    def from_arrays(self, u: Any, v: Any, degree: Any, n: Any) -> Rows:
        """Rows of field elements as ints, u (N, g + 1) of degrees ``degree`` (N,) and v (N, g); n (N,) on a split
        model. Nothing is checked.
        """
        words = self.encoded(np.ascontiguousarray(np.concatenate([u[:, : self.genus].T, v.T])))
        rows = Rows(words, degree.astype(np.uint8), np.asarray(n if self.split else (), np.uint8))
        if self.moved:
            self._shift(rows, self.equation.shift)
            self._scale(rows, self.equation.scale)
        return self.stored(rows)

    def to_arrays(self, x: Rows) -> tuple[Any, Any]:
        """The coefficients (u, v) as field elements, ints, of shapes (N, g + 1) and (N, g)."""
        g, K = self.genus, self.field
        x = self._in_words(x)
        if self.moved:
            x = Rows(x.data.copy(), x.degree, x.weight)
            self._scale(x, K.inv(self.equation.scale))
            self._shift(x, [K.neg(c) for c in self.equation.shift])
        elements = self.decoded(x.data)
        u = np.empty((len(x), g + 1), self.numbers)
        u[:, :g] = elements[:g].T
        u[:, g] = x.degree == g
        return u, np.ascontiguousarray(elements[g:].T)

    def from_divisors(self, divisors: Sequence[Divisor]) -> Rows:
        """The rows that hold the given Divisors of this Jacobian."""
        g = self.genus
        u, v = np.zeros((len(divisors), g + 1), self.numbers), np.zeros((len(divisors), g), self.numbers)
        for i, D in enumerate(divisors):
            u[i, : len(D.u)] = D.u
            v[i, : len(D.v)] = D.v
        degree = np.array([len(D.u) - 1 for D in divisors], int)
        return self.from_arrays(u, v, degree, [D.n for D in divisors] if self.split else None)

    def to_divisors(self, x: Rows) -> list[Divisor]:
        """The rows as Divisors."""
        u, v = (part.tolist() for part in self.to_arrays(x))
        weights = x.weight.tolist() if self.split else [None] * len(x)
        return [
            Divisor(self.jacobian, tuple(a[: d + 1]), poly.trim(self.field, b[:d]), n)
            for a, b, d, n in zip(u, v, x.degree.tolist(), weights, strict=True)
        ]

    def _room(self) -> Any:
        return self.memory(3, self.genus)

    def _shift(self, x: Rows, shift: Sequence[Any]) -> None:
        """Replaces v by v + shift modulo u in every row."""
        if any(c != self.field.zero for c in shift):
            words = self.numbers_in_words(shift)
            self._run.shift_rows(self._packed_words, words, self.view(x.data), x.degree, self._room())

    def _scale(self, x: Rows, c: Any) -> None:
        """Replaces each point (x, y) of every row's divisor by (cx, c^g·y)."""
        if c != self.field.one:
            powers = self.numbers_in_words(self.equation.powers(c))
            self._run.scale_rows(self._packed_words, powers, self.view(x.data), x.degree)

    def first_off_curve(self, x: Rows) -> int:
        """The index of the first row that is not on the curve, or −1."""
        rows = self.view(self._in_words(x).data)
        return int(self._run.first_off_curve(self._packed_words, (self._h, self._f), rows, x.degree, self._room()))

    def triples(self, x: Rows) -> list[Triple]:
        """The rows as triples (u, v, n) on the equation on which rows are added."""
        columns = self.decoded(self._in_words(x).data).T.tolist()
        weights = x.weight.tolist() if self.split else [None] * len(x)
        return [
            ((*column[:degree], 1), poly.trim(self.field, column[self.genus :]), n)
            for column, degree, n in zip(columns, x.degree.tolist(), weights, strict=True)
        ]

    def of_triples(self, triples: Sequence[Triple]) -> Rows:
        """The rows that hold triples (u, v, n) on the equation on which rows are added."""
        zeros = [0] * self.genus
        elements = [[*u, *zeros][: self.genus] + [*v, *zeros][: self.genus] for u, v, _ in triples]
        weight = np.array([n for _, _, n in triples] if self.split else (), np.uint8)
        words = self.encoded(np.ascontiguousarray(np.array(elements, self.numbers).T))
        return self.stored(Rows(words, np.array([len(u) - 1 for u, _, _ in triples], np.uint8), weight))

    # --- the group law

    def add(self, x: Rows, y: Rows) -> Rows:
        """The rows x_i + y_i, computed on all threads."""
        return self._on_threads(len(x), lambda begin, end, out: self._sum((x, y), out, begin, end))

    def double(self, x: Rows) -> Rows:
        """The rows 2x_i, computed on all threads."""
        return self._on_threads(len(x), lambda begin, end, out: self._sum((x,), out, begin, end))

    def negate(self, x: Rows) -> Rows:
        """The rows −x_i."""
        return self._on_threads(len(x), lambda begin, end, out: self._negate(x, out, begin, end))

    def _sum(self, operands: Sequence[Rows], out: Rows, begin: int, end: int) -> Rows:
        """Writes the sums of two operands, or the double of one, to the rows of ``out`` from begin to end; returns
        ``out``.
        """
        if self.formulas is None:
            self._add_special(operands, out, np.arange(begin, end))
            return out
        out.degree[begin:end] = self.genus
        loop = self._sums.add_rows if len(operands) == 2 else self._sums.double_rows
        arrays = [(self.view(x.data), x.degree) for x in operands]
        room = self._room_of_sums()
        count = loop(*self._constants, *arrays, self.view(out.data), (begin, end), room)
        if count:
            self._add_special(operands, out, room[0][:count].copy())
        return out

    def _room_of_sums(self) -> Packed:
        """The calling thread's memory for sums, made once and used for one sum after the other."""
        found: Packed | None = getattr(self._of_thread, "room", None)
        if found is None:
            room = np.empty(MOST, np.int64), self.view(np.zeros(SCRATCH, self.dtype))
            found = self._of_thread.room = Packed(room, libraries.room_of_sums(type(self.K)))
        return found

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        """Writes −x to the rows of ``out`` from begin to end; not valid on split models of odd genus."""
        first = self.view(x.data), x.degree
        self._run.negate_rows(self._packed_words, self._h, first, self.view(out.data), (begin, end), self._room())
        self._negate_weights(x, out, begin, end)

    def _negate_weights(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        """Writes the degrees and weights of −x to ``out``, for rows whose negation does not change u."""
        out.degree[begin:end] = x.degree[begin:end]
        if self.split:
            out.weight[begin:end] = self.genus - x.degree[begin:end] - x.weight[begin:end]

    def selected(self, stacked: Sequence[Any], choice: Any) -> Rows:
        """Row i of the part number choice[i], for each i. ``stacked`` = (data, degree, weight) holds all parts."""
        out = self.empty(len(choice))
        (data, *others), (x, *rest) = stacked, out
        self._run.select_rows((self.bits(data), *others), choice, (self.bits(x), *rest))
        return out

    def _on_threads(self, count: int, work: Callable[[int, int, Rows], Any]) -> Rows:
        out = self.empty(count)
        in_ranges(count, self.step, lambda begin, end: work(begin, end, out))
        return out

    # --- multiples

    def multiply(self, x: Rows, scalars: int | Sequence[int]) -> Rows:
        """The rows m·x_i for one int m, or m_i·x_i for a sequence of ints, computed on all threads."""

        def work(begin: int, end: int) -> Rows:
            part = self.take(x, slice(begin, end))
            if isinstance(scalars, int):
                zero = self.zero(len(part))
                return multiple(scalars, part, self.add_here, self.double_here, self.negate_here, zero)
            return multiply_by_each(self, part, scalars[begin:end])

        return self.join([self.empty(0), *in_ranges(len(x), LADDER, work)])

    def add_here(self, x: Rows, y: Rows) -> Rows:
        """The rows x_i + y_i, computed on the calling thread."""
        return self._sum((x, y), self.empty(len(x)), 0, len(x))

    def double_here(self, x: Rows) -> Rows:
        """The rows 2x_i, computed on the calling thread."""
        return self._sum((x,), self.empty(len(x)), 0, len(x))

    def negate_here(self, x: Rows) -> Rows:
        """The rows −x_i, computed on the calling thread."""
        out = self.empty(len(x))
        self._negate(x, out, 0, len(x))
        return out

    def zero(self, count: int) -> Rows:
        """``count`` rows of the identity."""
        return self.repeat(self.from_divisors([self.jacobian.zero()]), count)

    def replaced(self, x: Rows, index: Any, part: Rows) -> Rows:
        """A copy of x in which the rows at ``index``, an array of ints, are replaced by the rows of ``part``."""
        out = Rows(x.data.copy(), x.degree.copy(), x.weight.copy())
        self.put(out, index, part)
        return out
