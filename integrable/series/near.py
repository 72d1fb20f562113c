"""States near the start in floats, by the compiled walk of the kind of system."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np

from integrable.series.kinds import Compiled, Kind
from integrable.series.steps import FINEST, SPARE, Reached, Steps, steps_for


class State(Protocol):
    """A state (q, p)."""

    @property
    def q(self) -> tuple[Any, ...]: ...
    @property
    def p(self) -> tuple[Any, ...]: ...


class Walked(Protocol):
    """The attributes of a system that a walk uses."""

    @property
    def size(self) -> int: ...
    @property
    def _kind(self) -> Kind | None: ...
    @property
    def _walk_constants(self) -> tuple[float, ...]: ...


class Near(NamedTuple):
    """The indices of the times that were reached, the states (q, p) there, of shape (N, 2, n), and an error estimate.

    The estimate is of the largest error, relative to the largest component of q, or of p.
    """

    places: np.ndarray
    states: np.ndarray
    error: float


def compiled_walk(system: Walked, steps: Steps) -> Compiled | None:
    """The compiled walk of the kind of system; None where nothing is compiled, or without equations on a tape."""
    kind = system._kind
    return None if kind is None else kind.walk(steps.orders)


def walked(system: Walked, state: State, times: np.ndarray, most: float, tolerance: float | None = None) -> Near:
    """The states at those times that are reached within about ``most`` microseconds.

    Where coarser steps miss the tolerance, the steps used are accurate to the last bits of a float.
    """
    found = _nowhere(system)
    for steps in steps_for(tolerance):
        found = _completed(found, system, state, times, steps, most)
    return found


def finished(system: Walked, state: State, times: np.ndarray, near: Near, most: float) -> Near:
    """``near`` with the remaining times added; they are computed by finer steps with more guard digits."""
    return _completed(near, system, state, times, FINEST, most)


def _completed(near: Near, system: Walked, state: State, times: np.ndarray, steps: Steps, most: float) -> Near:
    """``near`` with those of the remaining times added that ``steps`` reach."""
    left = np.setdiff1d(np.arange(len(times)), near.places)
    walk = compiled_walk(system, steps) if len(left) else None
    if walk is None:
        return near
    given, some = (*state.q, *state.p), most / walk.step_cost
    other = both_ways(_shape(system), times[left], steps, lambda t: walk(system._walk_constants, given, t, steps, some))
    places = np.concatenate([near.places, left[other.places]])
    return Near(places, np.concatenate([near.states, other.states]), max(near.error, other.error))


def both_ways(shape: tuple[int, int], times: np.ndarray, steps: Steps, walk: Callable[[np.ndarray], Reached]) -> Near:
    """The states that a walk reaches at times of either sign in any order; ``shape`` is the shape of one state."""
    places, rows, error = [np.empty(0, dtype=np.int64)], [np.empty((0, *shape))], 0.0
    for ahead in (times >= 0, times < 0):
        order = np.flatnonzero(ahead)
        order = order[np.argsort(np.abs(times[order]), kind="stable")]
        if len(order):
            found = walk(times[order])
            count = max(found.reached, 0)
            right = np.ones(count, dtype=bool) if found.wrong is None else ~found.wrong
            places.append(order[:count][right])
            rows.append(found.states[:count][right])
            error = max(error, min(found.gap, steps.agreed))
    return Near(np.concatenate(places), np.concatenate(rows), SPARE * error)


def _nowhere(system: Walked) -> Near:
    return Near(np.empty(0, dtype=np.int64), np.empty((0, *_shape(system))), 0.0)


def _shape(system: Walked) -> tuple[int, int]:
    """The shape of a state: q, p, and for some systems further parts, each of ``system.size`` numbers."""
    kind = system._kind
    return 2 if kind is None else kind.count // kind.half, system.size
