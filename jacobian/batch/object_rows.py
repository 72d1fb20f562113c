"""Batches over fields without a compiled kernel, or with compilation switched off.

Rows are Divisors, and the Jacobian adds them one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from jacobian.group import Jacobian
from jacobian.law.divisor import Divisor

Rows = Any
"""A numpy array (N,) of Divisors."""


def _filled(divisors: Sequence[Divisor]) -> Rows:
    rows = np.empty(len(divisors), object)
    rows[:] = divisors
    return rows


class ObjectRows:
    """The operations on rows of one Jacobian, with the methods of
    :class:`~jacobian.batch.stored_rows.StoredRows`, which describes them.
    """

    compiled = False

    def __init__(self, J: Jacobian, dtype: type = object) -> None:
        self.jacobian, self._dtype = J, dtype

    def take(self, x: Rows, index: Any) -> Rows:
        return x[index].copy()

    def join(self, parts: Sequence[Rows]) -> Rows:
        return np.concatenate([np.empty(0, object), *parts])

    def repeat(self, x: Rows, count: int) -> Rows:
        return np.repeat(x, count)

    def equal(self, x: Rows, y: Rows) -> Any:
        return np.array([D == E for D, E in zip(x, y, strict=True)], bool)

    def zero(self, count: int) -> Rows:
        return _filled([self.jacobian.zero()] * count)

    def from_arrays(self, u: Any, v: Any, degree: Any, n: Any) -> Rows:
        weights = [None] * len(u) if n is None else n.tolist()
        rows = zip(u.tolist(), v.tolist(), degree.tolist(), weights, strict=True)
        return _filled([self.jacobian.from_mumford(a[: d + 1], b[:d], weight) for a, b, d, weight in rows])

    def to_arrays(self, x: Rows) -> tuple[Any, Any]:
        g = self.jacobian.curve.genus
        arrays: tuple[np.ndarray, np.ndarray] = (
            np.full((len(x), g + 1), self.jacobian.field.zero, self._dtype),
            np.full((len(x), g), self.jacobian.field.zero, self._dtype),
        )
        for i, D in enumerate(x):
            for array, a in zip(arrays, (D.u, D.v), strict=True):
                array[i, : len(a)] = a
        return arrays

    def from_divisors(self, divisors: Sequence[Divisor]) -> Rows:
        return _filled(divisors)

    def to_divisors(self, x: Rows) -> list[Divisor]:
        return list(x)

    def weights(self, x: Rows) -> Any:
        return np.array([D.n for D in x], np.int64) if self.jacobian.curve.model == "split" else None

    def first_off_curve(self, x: Rows) -> int:
        """Always −1, because :meth:`from_arrays` accepts only rows on the curve."""
        return -1

    def add(self, x: Rows, y: Rows) -> Rows:
        return _filled([self.jacobian.add(D, E) for D, E in zip(x, y, strict=True)])

    def double(self, x: Rows) -> Rows:
        return _filled([self.jacobian.double(D) for D in x])

    def negate(self, x: Rows) -> Rows:
        return _filled([self.jacobian.negate(D) for D in x])

    def multiply(self, x: Rows, scalars: int | Sequence[int]) -> Rows:
        each = [scalars] * len(x) if isinstance(scalars, int) else scalars
        return _filled([self.jacobian.multiply(m, D) for m, D in zip(each, x, strict=True)])
