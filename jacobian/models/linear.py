"""Small linear systems over a field."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def echelon(K: Any, rows: Sequence[Sequence[Any]], unknowns: int) -> list[tuple[int, list[Any]]]:
    """(column of the pivot, row with a one there) of the reduced system; only the first ``unknowns`` columns have
    pivots.
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
    """The only solution of a system with as many equations as unknowns, or None."""
    size = len(rows)
    pivots = echelon(K, [[*row, x] for row, x in zip(rows, right, strict=True)], size)
    if len(pivots) < size:
        return None
    return [row[-1] for _, row in sorted(pivots, key=lambda item: item[0])]
