"""Small linear systems: over a field, and of rounded numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def echelon(K: Any, rows: Sequence[Sequence[Any]], unknowns: int) -> list[tuple[int, list[Any]]]:
    """The reduced echelon form: (column of the pivot, row with 1 in this column and 0 in the other pivots' columns) for
    each of its rows, in no particular order. Only the first ``unknowns`` columns have pivots.
    """
    pivots: list[tuple[int, list[Any]]] = []
    for given in rows:
        row = list(given)
        for column, pivot in pivots:
            row = _without(K, row, pivot, column)
        column = next((i for i, x in enumerate(row[:unknowns]) if not K.is_zero(x)), -1)
        if column >= 0:
            inverse = K.inv(row[column])
            row = [K.mul(inverse, x) for x in row]
            pivots = [(k, _without(K, other, row, column)) for k, other in pivots] + [(column, row)]
    return pivots


def _without(K: Any, row: list[Any], pivot: list[Any], column: int) -> list[Any]:
    return [K.sub(x, K.mul(row[column], y)) for x, y in zip(row, pivot, strict=True)]


def solution(K: Any, rows: Sequence[Sequence[Any]], right: Sequence[Any]) -> list[Any] | None:
    """The solution x of rows·x = right, at least as many equations as unknowns; None unless there is exactly one."""
    unknowns = len(rows[0])
    # a row with its pivot in the last column is an equation 0 = 1
    pivots = sorted(echelon(K, [[*row, x] for row, x in zip(rows, right, strict=True)], unknowns + 1))
    return [row[-1] for _, row in pivots] if [k for k, _ in pivots] == list(range(unknowns)) else None


def pivoted(rows: list[list[Any]]) -> list[Any] | None:
    """The solution of a square system of numbers, by elimination with row exchanges; None if a pivot is zero or not a
    number. ``rows`` = [matrix | right side] are overwritten.
    """
    size = len(rows)
    for i in range(size):
        best = max(range(i, size), key=lambda j: abs(rows[j][i]))
        rows[i], rows[best] = rows[best], rows[i]
        pivot = rows[i]
        if not pivot[i] or pivot[i] != pivot[i]:
            return None
        for row in rows[i + 1 :]:
            factor = row[i] / pivot[i]
            for j in range(i + 1, size + 1):
                row[j] -= factor * pivot[j]
    found: list[Any] = []
    for i in range(size - 1, -1, -1):
        row = rows[i]
        value = row[size]
        for j, x in enumerate(found):
            value -= row[size - 1 - j] * x
        found.append(value / row[i])
    return found[::-1]
