"""States of a motion of genus 3 and more at many times in floats: from tables, or from sums in long numbers.

The digits lost in a sum of double-doubles are measured. Every time is computed from two starts, with different rows of
the tables. The state is accepted if both agree to more digits than a float has; otherwise two more starts are tried.
New tables are compared with sums in long numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from integrable.mumford.columns import Column
from integrable.mumford.motion import Start
from integrable.mumford.pair_tables import STARTS, PairTables
from jacobian.errors import ArgumentError, PrecisionLoss
from jacobian.relatives.extended import Extended

# number of times from which tables pay off; number of the farthest times that are compared with sums in long numbers
MANY, WITNESSES = 200, 4
# allowed differences relative to the largest component: between two starts; from sums in long numbers at the farthest
# times
AGREED, RIGHT = 2.0**-57, 2.0**-50

Vectors = Sequence[Sequence[Any]]


class TabledStates:
    """States at many times of the motion that ``place`` starts.

    ``read(times, D)`` returns their vectors as columns; ``by_additions(time)`` returns them in floats at one time.
    """

    def __init__(
        self,
        place: Callable[[Any], Start],
        read: Callable[[np.ndarray, Extended], Vectors],
        by_additions: Callable[[float], Vectors],
    ) -> None:
        self._place, self._read, self._by_additions = place, read, by_additions
        self._tables: PairTables | None = None
        self._refused = False
        # number of requested times beyond the present tables
        self._beyond = 0

    def at(self, times: np.ndarray) -> list[np.ndarray]:
        """The vectors at N times, each of shape (N, …), accurate to the last bits of floats."""
        reach = self._tables.reach if self._tables else -1.0
        self._beyond += int((np.abs(times) > reach).sum())
        if self._beyond >= MANY and not self._refused:
            self._beyond = 0
            made = self._made_for(times)
            # if none can be made, the previous tables remain for nearer times
            self._tables, self._refused = made or self._tables, made is None
        rows = self._from_tables(self._tables, times) if self._tables else {}
        whole = [rows[i] if i in rows else self._by_additions(t) for i, t in enumerate(times.tolist())]
        return [np.array(part) for part in zip(*whole, strict=True)]

    def _made_for(self, times: np.ndarray) -> PairTables | None:
        """Tables that reach these times; None if they cannot be made, or if a state differs from that by additions.

        Also None if the tables do not settle more than half of the farthest times.
        """
        far = times[np.argsort(-np.abs(times))[:WITNESSES]]
        try:
            tables = PairTables(self._place, float(np.abs(far[0])))
            rows = self._from_tables(tables, far)
            for i, row in rows.items():
                for found, true in zip(row, self._by_additions(float(far[i])), strict=True):
                    if not np.abs(found - np.array(true)).max() <= RIGHT * np.abs(found).max():
                        return None
        except (PrecisionLoss, ZeroDivisionError, ArgumentError):
            # ArgumentError: the entries are beyond the range of floats
            return None
        return tables if 2 * len(rows) > len(far) else None

    def _from_tables(self, tables: PairTables, times: np.ndarray) -> dict[int, Vectors]:
        """The vectors of those times at which two starts agree, by index of the time."""
        rows: dict[int, Vectors] = {}
        left = np.flatnonzero(np.abs(times) <= tables.reach)
        for begin in range(0, STARTS, 2):
            if not len(left):
                break
            with np.errstate(all="ignore"):
                one, two = (self._read(times[left], tables.at(times[left], k)) for k in (begin, begin + 1))
                agree = np.logical_and.reduce([_agree(a, b) for a, b in zip(one, two, strict=True)])
            parts = [np.stack([np.broadcast_to(x.hi, left.shape) for x in part], axis=1) for part in one]
            for i in np.flatnonzero(agree):
                rows[int(left[i])] = [part[i] for part in parts]
            left = left[~agree]
        return rows


def _agree(one: Sequence[Column], two: Sequence[Column]) -> np.ndarray:
    """For each row, whether two vectors of columns agree to all digits of floats."""
    size = np.max([np.abs(x.hi) for x in one], axis=0)
    found: np.ndarray = np.max([np.abs((x - y).hi) for x, y in zip(one, two, strict=True)], axis=0) <= AGREED * size
    return found
