"""States near the start in floats, computed by the compiled walk of a kind of systems."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np

from integrable.series.kinds import Kind
from integrable.series.steps import FINEST, SPARE, Reached, Steps, steps_for


class PhasePoint(Protocol):
    """A state (q, p)."""

    @property
    def q(self) -> tuple[float, ...]: ...
    @property
    def p(self) -> tuple[float, ...]: ...


class Walked(Protocol):
    """The attributes of a system that a walk uses."""

    @property
    def size(self) -> int: ...
    @property
    def _kind(self) -> Kind | None: ...
    @property
    def _walk_constants(self) -> tuple[float, ...]: ...


class Near(NamedTuple):
    """The states at those times that were reached, of shape (N, parts, n): q, p and any further parts.

    ``error`` estimates the largest error, relative to the largest component of q, or of p. ``places`` are the indices
    of the times, None for all times in order. ``begun`` is False if the last walk took no step, as the farthest time is
    beyond its reach; finer steps, each of which costs more, would not reach it either.
    """

    places: np.ndarray | None
    states: np.ndarray
    error: float
    begun: bool = True

    def lacks(self, count: int) -> bool:
        """Whether some of ``count`` times were not reached."""
        return self.places is not None and len(self.places) < count


def walked(system: Walked, state: PhasePoint, times: np.ndarray, most: float, tolerance: float | None = None) -> Near:
    """The states at those times that are reached within about ``most`` microseconds.

    Where coarse steps miss the tolerance, states are computed again with steps accurate to the last bits of floats.
    """
    kind, given = system._kind, (*state.q, *state.p)
    found = None
    for steps in steps_for(tolerance):
        walk = None if kind is None or not len(times) else kind.walk(steps.orders)
        if walk is None:
            break
        if found is None or not len(found.states):
            # times are mostly in order, so all of them are tried in one walk first
            first = walk(system._walk_constants, given, times, steps, most / walk.step_cost)
            if first.reached == len(times) and first.wrong is None:
                return Near(None, first.states, SPARE * first.gap)
            if first.reached >= 0:
                found = _right(first, np.arange(len(times)), steps)
                continue
        found = _completed(found or _nothing(system), system, state, times, steps, most)
    return found or _nothing(system)


def finished(system: Walked, state: PhasePoint, times: np.ndarray, near: Near, most: float) -> Near:
    """Adds the states at the remaining times to ``near``, computed by finer steps with more guard digits."""
    return _completed(near, system, state, times, FINEST, most)


def _completed(near: Near, system: Walked, state: PhasePoint, times: np.ndarray, steps: Steps, most: float) -> Near:
    """Adds to ``near`` the states at remaining times that ``steps`` reach; times have either sign and any order."""
    if near.places is None or not near.lacks(len(times)):
        return near
    left = np.setdiff1d(np.arange(len(times)), near.places)
    kind = system._kind
    walk = None if kind is None or not len(left) else kind.walk(steps.orders)
    if walk is None:
        return near
    found, given = [near], (*state.q, *state.p)
    for ahead in (times[left] >= 0, times[left] < 0):
        order = left[ahead]
        order = order[np.argsort(np.abs(times[order]), kind="stable")]
        if len(order):
            reached = walk(system._walk_constants, given, times[order], steps, most / walk.step_cost)
            found.append(_right(reached, order, steps))
    places, states = np.concatenate([x.places for x in found]), np.concatenate([x.states for x in found])
    return Near(places, states, max(x.error for x in found), any(x.begun for x in found[1:]))


def _right(found: Reached, order: np.ndarray, steps: Steps) -> Near:
    """The states that a walk reached and did not mark as wrong; ``order`` are the indices of its times."""
    count, error, begun = max(found.reached, 0), SPARE * min(found.gap, steps.agreed), found.steps > 0
    if found.wrong is None:
        return Near(order[:count], found.states[:count], error, begun)
    return Near(order[:count][~found.wrong], found.states[:count][~found.wrong], error, begun)


def _nothing(system: Walked) -> Near:
    kind = system._kind
    parts = 2 if kind is None else kind.count // kind.half
    return Near(np.empty(0, dtype=np.int64), np.empty((0, parts, system.size)), 0.0)
