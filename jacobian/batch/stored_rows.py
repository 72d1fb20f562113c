"""Storage, threads and multiples for rows of divisor classes in arrays of words of any kind.

Sums are in :mod:`jacobian.batch.compiled_rows` and :mod:`jacobian.batch.two_word_rows`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jacobian.batch.equation import Equation
from jacobian.batch.multiples import multiply_by_each, multiply_by_one
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor
from jacobian.numbers.threads import in_ranges

LADDER = 1 << 12
"""The number of rows in one ladder; the tables of so many rows fit into the processor's cache."""


@dataclass(frozen=True, slots=True)
class Rows:
    """N classes: ``data`` (2g, N) holds u₀ … u_{g−1}, v₀ … v_{g−1} in words; ``degree`` is (N,); ``weight`` is (N,), or
    (0,) if n is None."""

    data: Any
    degree: Any
    weight: Any

    def __len__(self) -> int:
        return len(self.degree)

    def __iter__(self) -> Iterator[Any]:
        return iter((self.data, self.degree, self.weight))


class StoredRows:
    """The operations on rows of one Jacobian that need no arithmetic of their own.

    ``dtype`` is the dtype of words, ``numbers`` that of arrays of field elements. One call of a kernel adds ``step``
    rows.
    """

    dtype: Any
    numbers: Any
    step: int

    def __init__(self, J: Jacobian) -> None:
        self.jacobian, self.genus, self.split = J, J.curve.genus, J.curve.model == "split"
        self.field: Any = J.field
        self.equation = Equation(J.curve)
        self.moved = any(c != self.field.zero for c in self.equation.shift) or self.equation.scale != self.field.one

    # --- what a kind of words supplies

    def _encoded(self, elements: Any) -> Any:
        """The words of field elements, ints."""
        raise NotImplementedError

    def _decoded(self, words: Any) -> Any:
        """The field elements, ints, of words."""
        raise NotImplementedError

    def _in_words(self, x: Rows) -> Rows:
        """Rows in words, from the stored form."""
        return x

    def stored(self, x: Rows) -> Rows:
        """The stored form of rows in words."""
        return x

    def _shift(self, x: Rows, shift: Sequence[Any]) -> None:
        """v → v + shift modulo u in every row, in place."""
        raise NotImplementedError

    def _scale(self, x: Rows, c: Any) -> None:
        """(x, y) → (cx, c^g·y) on the points of every row, in place."""
        raise NotImplementedError

    def _add(self, x: Rows, y: Rows, out: Rows, begin: int, end: int) -> None:
        """x + y in the rows from begin to end."""
        raise NotImplementedError

    def _double(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        """2x, likewise."""
        raise NotImplementedError

    def _negate(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        """−x, likewise."""
        raise NotImplementedError

    def _negate_weights(self, x: Rows, out: Rows, begin: int, end: int) -> None:
        """The degrees and weights of −x, for rows whose u it shares with x."""
        out.degree[begin:end] = x.degree[begin:end]
        if self.split:
            out.weight[begin:end] = self.genus - x.degree[begin:end] - x.weight[begin:end]

    # --- storage

    def empty(self, count: int) -> Rows:
        """Uninitialised rows."""
        weight = np.zeros(count if self.split else 0, np.uint8)
        return Rows(np.empty((2 * self.genus, count), self.dtype), np.empty(count, np.uint8), weight)

    def take(self, x: Rows, index: Any) -> Rows:
        """The rows of an index: a slice, a mask or an array of ints."""
        return Rows(
            np.ascontiguousarray(x.data[:, index]), x.degree[index], x.weight[index] if self.split else x.weight
        )

    def put(self, x: Rows, index: Any, part: Rows) -> None:
        """Replaces the rows of an array of ints by those of ``part``."""
        x.data[:, index], x.degree[index] = part.data, part.degree
        if self.split:
            x.weight[index] = part.weight

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

    def weights(self, x: Rows) -> Any:
        """n, (N,), or None on a model without."""
        return x.weight.astype(np.int64) if self.split else None

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
        u = np.empty((len(x), g + 1), self.numbers)
        u[:, :g] = elements[:g].T
        u[:, g] = x.degree == g
        return u, np.ascontiguousarray(elements[g:].T)

    def from_divisors(self, divisors: Sequence[Divisor]) -> Rows:
        """Rows of Divisors of this Jacobian."""
        g = self.genus
        u, v = np.zeros((len(divisors), g + 1), self.numbers), np.zeros((len(divisors), g), self.numbers)
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
        in_ranges(count, self.step, lambda begin, end: work(begin, end, out))
        return out

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

    def replaced(self, x: Rows, index: Any, part: Rows) -> Rows:
        """x with the rows of an array of ints replaced by those of ``part``."""
        out = Rows(x.data.copy(), x.degree.copy(), x.weight.copy())
        self.put(out, index, part)
        return out
