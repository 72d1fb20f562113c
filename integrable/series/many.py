"""States of many motions of a system near their starts, by walks that run together as lanes of one vector.

Every motion has the states that :meth:`integrable.series.kinds.Kind.walked` finds for it alone, to the bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from integrable.series.kinds import Kind, Near
from integrable.series.room import WIDEST
from integrable.series.steps import SPARE, Steps, exhausted, steps_for
from integrable.series.walk import FARTHEST, Many


class NearMany(NamedTuple):
    """The states of K motions at N times, shape (K, N, parts, n), and which of these were reached. ``errors`` are
    for each motion as in :class:`integrable.series.kinds.Near`.
    """

    states: np.ndarray
    reached: np.ndarray
    errors: np.ndarray

    def of(self, member: int) -> Near:
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
    states, none = np.empty((count, length, parts, kind.half)), np.zeros((count, length), dtype=bool)
    found = NearMany(states, none, np.zeros(count))
    walks = _Walks(kind, np.array(constants, dtype=float), starts, times, most)
    for steps in steps_for(tolerance):
        walks.tiers[:] = 0
        while walks.add(found, steps):
            pass
    return found


class _Walks:
    """The walks of K motions. A motion has one walk if its times are in order, else one for each direction of time.

    The rows are the states of all walks. Row r belongs to the walk w = ``walk_of``[r] of the motion ``members``[w], and
    to the motion's time number ``columns``[r]. ``left`` marks the rows that are not yet reached. ``tiers`` are the
    bounds that each walk tries next, and ``over`` tells which walks would take too long.
    """

    def __init__(
        self, kind: Kind, constants: np.ndarray, starts: np.ndarray, times: np.ndarray, most: np.ndarray
    ) -> None:
        self._kind, self._constants, self._starts, self._times, self._most = kind, constants, starts, times, most
        count, length = times.shape
        order = np.argsort(np.abs(times), axis=1, kind="stable")
        ahead = np.where(times[:, -1:] < 0, -times, times)
        # the motions with one walk: their times are of one sign and ascend in size
        whole = (ahead[:, 0] >= 0) & (np.diff(ahead, axis=1) >= 0).all(axis=1) & (ahead[:, -1] < FARTHEST)
        behind = np.take_along_axis(times < 0, order, axis=1) & ~whole[:, None]
        # motion m has walk 2m; if one walk is not enough, it also has walk 2m + 1 for its times < 0
        number = (2 * np.arange(count)[:, None] + behind).ravel()
        rows = np.argsort(number, kind="stable")
        self.walk_of, self.columns = number[rows], order.ravel()[rows]
        self.members = np.repeat(np.arange(count), 2)
        self.left, self.tiers = np.ones(count * length, dtype=bool), np.zeros(2 * count, dtype=np.int64)
        self.over = np.zeros(2 * count, dtype=bool)

    def add(self, found: NearMany, steps: Steps) -> bool:
        """Adds what each walk reaches with its next tier of ``steps``; False if no walk has rows and tiers left."""
        walk = self._kind.walk(steps.orders, WIDEST)
        going = ~self.over & (self.tiers < len(steps.tiers))
        rows = np.flatnonzero(self.left & going[self.walk_of])
        if walk is None or not len(rows):
            return False
        which, count = np.unique(self.walk_of[rows], return_counts=True)
        members, ends = self.members[which], np.concatenate([[0], np.cumsum(count)])
        most = self._most[members] / walk.step_cost
        asked = Many(self._constants, self._starts[members].reshape(-1), ends, self.tiers[which], most)
        places = self.members[self.walk_of[rows]], self.columns[rows]
        results, states, wrong = walk.of_many(asked, self._times[places], steps)
        reached, failed, lost, gap, _, tier = results.T
        right = np.arange(len(rows)) < np.repeat(ends[:-1] + reached, count)
        right &= ~wrong | np.repeat(failed == 0, count)
        found.states[places[0][right], places[1][right]] = states[right]
        found.reached[places[0][right], places[1][right]] = True
        self.left[rows[right]] = False
        self.tiers[which] = tier + 1
        self.over[which] = exhausted(reached, count, lost, tier, steps)
        # the errors of walks that have found no state do not count
        had = np.add.reduceat(right, ends[:-1]) > 0
        np.maximum.at(found.errors, members[had], SPARE * np.minimum(gap[had], steps.tiers[0].agreed))
        return True
