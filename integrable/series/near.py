"""States near the start in floats: by the compiled walk of the kind of system, by its tape until that is compiled."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter
from typing import Any, NamedTuple, Protocol

import numpy as np

from integrable.series.kinds import Compiled, Kind
from integrable.series.steps import FINE, FINEST, SPARE, Reached, Steps, steps_for, weight
from jacobian.numbers.compiler import interpreted

# number of compiled steps that take as long as one step on an interpreted tape
FASTER = 4


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
    def _walk_constants(self) -> np.ndarray: ...


class Near(NamedTuple):
    """The indices of the times that were reached, the states (q, p) there, of shape (N, 2, n), and an error estimate.

    The estimate is of the largest error, relative to the largest component of q, or of p.
    """

    places: np.ndarray
    states: np.ndarray
    error: float


def compiled_walk(system: Walked, steps: Steps) -> Compiled | None:
    """The compiled walk of the kind of system; None where it is not available."""
    kind = system._kind
    return None if kind is None else kind.walk(steps.orders)


def walked(system: Walked, state: State, times: np.ndarray, most: float, tolerance: float | None = None) -> Near:
    """The states at those times that are reached at the cost of about ``most`` standard steps on an interpreted tape.

    :func:`integrable.series.steps.weight` defines a standard step. The compiled walk is used where it is available.
    Where coarser steps miss the tolerance, the steps used are accurate to the last bits of a float.
    """
    found = _nowhere(system)
    for steps in steps_for(tolerance):
        if steps is FINE or compiled_walk(system, steps) is not None:
            found = _completed(found, system, state, times, steps, most)
    return found


def finished(system: Walked, state: State, times: np.ndarray, near: Near, most: float) -> Near:
    """``near`` with the remaining times added; they are computed by finer steps with more guard digits."""
    return _completed(near, system, state, times, FINEST, most)


def quickly(system: Walked, state: State, times: np.ndarray, most: float, tolerance: float | None) -> Reached | None:
    """The states at times that ascend or descend from 0; None without a compiled walk, or if any state is not right.

    A state is right if both walks agree on it.
    """
    given = (*state.q, *state.p)
    for steps in steps_for(tolerance):
        walk = compiled_walk(system, steps)
        if walk is not None:
            found = walk(system._walk_constants, given, times, steps, FASTER * most / walk.weight)
            if found.reached == len(times) and found.wrong is None:
                return found
    return None


def _completed(near: Near, system: Walked, state: State, times: np.ndarray, steps: Steps, most: float) -> Near:
    """``near`` with the remaining times added; they are computed by ``steps``."""
    left = np.setdiff1d(np.arange(len(times)), near.places)
    if not len(left):
        return near
    other = _walked(system, state, times[left], steps, most)
    places = np.concatenate([near.places, left[other.places]])
    return Near(places, np.concatenate([near.states, other.states]), max(near.error, other.error))


def _walked(system: Walked, state: State, times: np.ndarray, steps: Steps, most: float) -> Near:
    """The states by the compiled walk, or on the tape until its run time justifies compiling."""
    kind, walk = system._kind, compiled_walk(system, steps)
    if kind is None or interpreted():
        return _nowhere(system)
    given, begin = (*state.q, *state.p), perf_counter()
    some = most / weight(kind.rates, steps.orders) * (1 if walk is None else FASTER)
    along = walk or kind.on_tape
    found = both_ways(_shape(system), times, steps, lambda t: along(system._walk_constants, given, t, steps, some))
    if walk is None:
        kind.pay(perf_counter() - begin)
    return found


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
