"""States of many motions of a system near their starts, whose walks run together as lanes of one vector.

Every motion has the states that :meth:`integrable.series.kinds.Kind.walked` finds for it alone, to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from integrable.series.kinds import Kind, Near
from integrable.series.room import WIDEST
from integrable.series.steps import SPARE, Steps, steps_for
from integrable.series.walk import FARTHEST, Many


class NearMany(NamedTuple):
    """The states of K motions at N times, shape (K, N, parts, n), which of these were reached, and the estimates of
    their errors, as in :class:`integrable.series.kinds.Near`.
    """

    states: np.ndarray
    reached: np.ndarray
    errors: np.ndarray

    def of(self, member: int) -> Near:
        """The states of one motion."""
        places = np.flatnonzero(self.reached[member])
        return Near(places, self.states[member, places], float(self.errors[member]))


def walked_by_many(
    kind: Kind, constants: Sequence[float], starts: np.ndarray, times: np.ndarray, most: np.ndarray,
    tolerance: float | None,
) -> NearMany:  # fmt: skip
    """The states of motions from ``starts``, shape (K, 2n), at ``times``, shape (K, N), that are reached within about
    ``most`` microseconds each.
    """
    (count, length), parts = times.shape, kind.count // kind.half
    found = NearMany(
        np.empty((count, length, parts, kind.half)), np.zeros((count, length), dtype=bool), np.zeros(count)
    )
    walks = _Walks(kind, np.array(constants, dtype=float), starts, times, most)
    for steps in steps_for(tolerance):
        if not found.reached.all():
            walks.add(found, steps)
    return found


class _Walks:
    """The walks of K motions; ``_order`` has the indices of the times of each motion, in ascending size."""

    def __init__(
        self, kind: Kind, constants: np.ndarray, starts: np.ndarray, times: np.ndarray, most: np.ndarray
    ) -> None:
        self._kind, self._constants, self._starts, self._times, self._most = kind, constants, starts, times, most
        sizes = np.abs(times)
        self._order = np.argsort(sizes, axis=1, kind="stable")
        ahead = np.where(times[:, -1:] < 0, -times, times)
        # whether the times of a motion are in the order that a walk needs: of one sign, and ascending in size
        self._whole = (ahead[:, 0] >= 0) & (np.diff(ahead, axis=1) >= 0).all(axis=1) & (ahead[:, -1] < FARTHEST)

    def add(self, found: NearMany, steps: Steps) -> None:
        """Adds the states at remaining times that ``steps`` reach."""
        walk = self._kind.walk(steps.orders, WIDEST)
        if walk is None:
            return
        # times that are in order are tried in one walk until a state is found
        at_first = self._whole & ~found.reached.any(axis=1)
        behind = (self._times < 0) & ~at_first[:, None]
        members, places, counts = [], [], []
        for left in (~found.reached & ~behind, ~found.reached & behind):
            rows, columns = np.nonzero(np.take_along_axis(left, self._order, axis=1))
            members.append(np.unique(rows))
            places.append(np.stack([rows, self._order[rows, columns]]))
            counts.append(np.bincount(rows)[members[-1]])
        which, count, (rows, columns) = np.concatenate(members), np.concatenate(counts), np.hstack(places)
        ends = np.concatenate([[0], np.cumsum(count)])
        asked = Many(self._constants, self._starts[which].reshape(-1), ends, self._most[which] / walk.step_cost)
        results, states, wrong = walk.of_many(asked, self._times[rows, columns], steps)
        right = np.arange(len(rows)) < np.repeat(ends[:-1] + results[:, 0], count)
        right &= ~wrong | np.repeat(results[:, 1] == 0, count)
        found.states[rows[right], columns[right]] = states[right]
        found.reached[rows[right], columns[right]] = True
        errors = SPARE * np.minimum(results[:, 2], steps.bounds.agreed)
        # estimates of walks that found no state are discarded
        found.errors[at_first] = 0
        np.maximum.at(found.errors, which, errors)
