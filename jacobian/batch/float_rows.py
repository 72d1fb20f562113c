"""Batches over the floats and the complex numbers in genus 2.

Compiled code adds divisors of weight 2; the Jacobian's own addition adds other divisors. If
:mod:`jacobian.inexact.composition` cannot decide a sum, or if the sum has a point at infinity of a split model, only
the row of this sum is lost; the other rows stay valid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from jacobian.addition.ladder import multiple
from jacobian.batch.sums import FloatSums
from jacobian.errors import NotOnCurve, NotRepresentable, PrecisionLoss
from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor

# kinds of rows: PAIR (two points), POINT + n (one) and NONE + n (none) with the weight n at ∞₊, LOST (unknown class)
PAIR, POINT, NONE, LOST, AT_INFINITY = 0, 1, 3, 6, 7
DEGREES = np.array([2, 1, 1, 0, 0, 0, 0, 0])
WEIGHTS = np.array([0, 0, 1, 0, 1, 2, 0, 0])
STATUS = np.array([0, 0, 0, 0, 0, 0, 1, 2], np.uint8)
FIRST = np.array([NONE, POINT, PAIR])
"""A row of degree k and weight n at ∞₊ has the kind FIRST[k] + n."""


@dataclass(frozen=True, slots=True)
class Rows:
    """N = ``count`` divisors. ``data`` (4, N) holds u₀, u₁, v₀, v₁, with zeros beyond the degree; it is (4, 1) for N
    equal rows. ``kind`` (N,) holds PAIR, POINT + n, NONE + n (n is the weight at ∞₊), LOST or AT_INFINITY; it is None
    if every row has two points.
    """

    data: Any
    kind: Any
    count: int

    def __len__(self) -> int:
        return self.count

    @property
    def kinds(self) -> Any:
        """The kind of each row, (N,), also where ``kind`` is None."""
        return np.zeros(self.count, np.uint8) if self.kind is None else self.kind


def _rows(data: Any, kind: Any) -> Rows:
    return Rows(data, kind if kind.any() else None, len(kind))


class FloatRows:
    """The operations on rows of one Jacobian, with the methods of
    :class:`~jacobian.batch.stored_rows.StoredRows`, which describes them.
    """

    compiled = False

    def __init__(self, J: Jacobian) -> None:
        self.jacobian = J
        self.sums = FloatSums(J.curve)
        self._h = [*J.curve.h, 0.0, 0.0, 0.0, 0.0][:4]
        self._weighted = J.curve.model == "split"
        self._zero = NONE + (J.weight_of_zero or 0)

    # --- storage

    def take(self, x: Rows, index: Any) -> Rows:
        data = np.ascontiguousarray(x.data[:, index])
        return Rows(data, None, data.shape[1]) if x.kind is None else _rows(data, x.kind[index].copy())

    def join(self, parts: Sequence[Rows]) -> Rows:
        parts = [self.zero(0), *parts]
        return _rows(np.concatenate([x.data for x in parts], axis=1), np.concatenate([x.kinds for x in parts]))

    def repeat(self, x: Rows, count: int) -> Rows:
        """The row x ``count`` times, stored once."""
        return Rows(x.data, None if x.kind is None else np.repeat(x.kind, count), count)

    def equal(self, x: Rows, y: Rows) -> Any:
        """Whether the rows of x and y have equal numbers, (N,); False for lost rows."""
        kinds = x.kinds
        return (kinds == y.kinds) & (kinds < LOST) & np.all(x.data == y.data, axis=0)

    def zero(self, count: int) -> Rows:
        return Rows(np.zeros((4, count), self.sums.dtype), np.full(count, self._zero, np.uint8), count)

    # --- conversion

    def from_arrays(self, u: Any, v: Any, degree: Any, n: Any) -> Rows:
        """Rows from the coefficients u (N, 3), monic of degrees ``degree`` (N,), v (N, 2), and n (N,) or None."""
        data = np.concatenate([u[:, :2].T, v.T]).astype(self.sums.dtype)
        data[0, degree == 0] = 0
        data[1, degree < 2] = 0
        return _rows(data, (FIRST[degree] + (0 if n is None else n)).astype(np.uint8))

    def to_arrays(self, x: Rows) -> tuple[Any, Any]:
        """The coefficients (u, v), of shapes (N, 3) and (N, 2); zeros for lost rows."""
        kinds = x.kinds
        u = np.zeros((len(x), 3), self.sums.dtype)
        u[:, :2] = x.data[:2].T
        known = np.flatnonzero(kinds < LOST)
        u[known, DEGREES[kinds[known]]] = 1
        return u, np.ascontiguousarray(x.data[2:].T)

    def from_divisors(self, divisors: Sequence[Divisor]) -> Rows:
        if not divisors:
            return self.zero(0)
        data = np.array([_column(D) for D in divisors], self.sums.dtype).T
        return _rows(np.ascontiguousarray(data), np.array([_kind(D) for D in divisors], np.uint8))

    def to_divisors(self, x: Rows) -> list[Divisor]:
        """The rows as Divisors. The first lost row raises PrecisionLoss or NotRepresentable."""
        lost = np.flatnonzero(x.kinds >= LOST)
        if len(lost):
            name = self.jacobian.field.name
            if x.kind[lost[0]] == LOST:
                raise PrecisionLoss(f"row {lost[0]}: a sum too close to a special position for {name}")
            raise NotRepresentable(
                f"row {lost[0]}: a sum with a point at infinity, which split models over {name} do not carry; use an "
                "exact field"
            )
        return [self._divisor(column, kind) for column, kind in zip(x.data.T.tolist(), x.kinds.tolist(), strict=True)]

    def _divisor(self, column: list[Any], kind: int) -> Divisor:
        k = int(DEGREES[kind])
        weight = int(WEIGHTS[kind]) if self._weighted else None
        return Divisor(self.jacobian, (*column[:k], self.jacobian.field.one), tuple(column[2 : 2 + k]), weight)

    def weights(self, x: Rows) -> Any:
        return WEIGHTS[x.kinds] if self._weighted else None

    def status(self, x: Rows) -> Any:
        """The status of each row, (N,): 0 if valid, 1 for lost digits, 2 for a point at infinity."""
        return STATUS[x.kinds]

    def first_off_curve(self, x: Rows) -> int:
        kinds = x.kinds
        full = np.flatnonzero(kinds == PAIR)
        found = self.sums.first_off_curve(np.ascontiguousarray(x.data[:, full]))
        wrong = [int(full[found])] if found >= 0 else []
        for i in np.flatnonzero(DEGREES[kinds] == 1).tolist():
            D = self._divisor(x.data[:, i].tolist(), kinds[i])
            try:
                self.jacobian.from_mumford(D.u, D.v, D.n)
            except NotOnCurve:
                wrong.append(i)
                break
        return min(wrong, default=-1)

    # --- the group law

    def add(self, x: Rows, y: Rows) -> Rows:
        data, special = self.sums.add(x.data, y.data)
        if x.kind is None and y.kind is None and not special.any():
            return Rows(data, None, len(x))
        kinds = [x.kinds, y.kinds]
        kind = np.maximum(*kinds)
        special |= kind > 0
        columns = np.broadcast_to(y.data, x.data.shape)
        lost = kind >= LOST
        data[:, lost] = 0
        special &= ~lost
        for summand, summand_kind, other in ((columns, kinds[1], kinds[0]), (x.data, kinds[0], kinds[1])):
            same = (other == self._zero) & ~lost
            data[:, same], kind[same] = summand[:, same], summand_kind[same]
            special &= ~same
        for i in np.flatnonzero(special).tolist():
            D, E = (self._divisor(a[:, i].tolist(), k[i]) for a, k in zip((x.data, columns), kinds, strict=True))
            data[:, i], kind[i] = _result(self.jacobian.add, D, E)
        return _rows(data, kind)

    def double(self, x: Rows) -> Rows:
        return self.add(x, x)

    def negate(self, x: Rows) -> Rows:
        """The rows −x_i: v becomes −(v + h) modulo u."""
        u0, u1, v0, v1 = x.data
        h0, h1, h2, h3 = self._h
        high = h2 - u1 * h3
        data = np.array([u0, u1, -(v0 + (h0 - u0 * high)), -(v1 + (h1 - u1 * high - u0 * h3))])
        if x.kind is None:
            return Rows(data, None, len(x))
        low = np.flatnonzero(x.kind != PAIR)
        if data.shape[1] != len(x):
            data = np.repeat(data, len(x), axis=1)
        source = np.broadcast_to(x.data, data.shape)
        kind = x.kind.copy()
        for i in low[kind[low] < LOST].tolist():
            data[:, i], kind[i] = _result(self.jacobian.negate, self._divisor(source[:, i].tolist(), kind[i]))
        data[:, kind >= LOST] = 0
        return Rows(data, kind, len(x))

    def multiply(self, x: Rows, scalars: int | Sequence[int]) -> Rows:
        nothing = self.zero(len(x))
        # 0·x is the identity, except for lost rows of x, which stay lost
        nothing = Rows(nothing.data, np.where(x.kinds < LOST, nothing.kind, x.kinds), len(x))
        if isinstance(scalars, int):
            return multiple(scalars, x, self.add, self.double, self.negate, nothing)
        base = self._chosen(np.array([m < 0 for m in scalars], bool), self.negate(x), x)
        result = nothing
        for k in range(max((abs(m).bit_length() for m in scalars), default=0) - 1, -1, -1):
            result = self.double(result)
            bits = np.array([abs(m) >> k & 1 for m in scalars], bool)
            result = self.add(result, self._chosen(bits, base, nothing))
        return result

    def _chosen(self, mask: Any, first: Rows, second: Rows) -> Rows:
        return _rows(np.where(mask, first.data, second.data), np.where(mask, first.kinds, second.kinds))


def _column(D: Divisor) -> list[Any]:
    """The column u₀, u₁, v₀, v₁ of D, with zeros beyond the degree."""
    return [*D.u[:-1], *[0] * (3 - len(D.u)), *D.v, *[0] * (2 - len(D.v))]


def _kind(D: Divisor) -> int:
    return int(FIRST[len(D.u) - 1]) + (D.n or 0)


def _result(operation: Callable[..., Divisor], *operands: Divisor) -> tuple[list[Any], int]:
    try:
        found = operation(*operands)
    except PrecisionLoss:
        return [0] * 4, LOST
    except NotRepresentable:
        return [0] * 4, AT_INFINITY
    return _column(found), _kind(found)
