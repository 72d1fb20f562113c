"""The choice of the method that computes the states of a motion, the same for every system.

A motion lists its methods, called ways, in the order of their cost: a walk near the start, a closed form or a torus,
and additions with as many digits as needed. A way is set up only if the ways before it have not reached all times.
Results do not depend on earlier calls.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import isfinite
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from jacobian import RR
from jacobian.element import Numbers
from jacobian.errors import PrecisionLoss, one_or_more
from jacobian.fields.protocol import Field

Answer = TypeVar("Answer")
FLOATS = np.dtype(np.float64)


class Cost(NamedTuple):
    """The microseconds that a way takes: for its set-up, and for each time."""

    set_up: float
    each: float

    def of(self, count: int) -> float:
        """The microseconds that the way takes for ``count`` times, set-up included."""
        return self.set_up + count * self.each


class Way(Protocol):
    """A method of computing the states of a motion over its field; ``way`` is its name. Its functions return None if it
    does not reach all times. They raise PrecisionLoss or Infeasible if no later way should be tried.
    """

    way: str

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        """γ and M side by side at values of τ: shape (N, 6)."""

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        """The physical times t(τ) at values of τ: shape (N,)."""


class InOrder:
    """Tries ``ways()`` in order until one of them reaches all times; ``way`` is the name of the last one tried."""

    way: str

    def __init__(self, ways: Callable[[], Iterator[Way]]) -> None:
        self._ways = ways

    def first(self, asked: Callable[[Way], Answer | None]) -> Answer:
        """The value of ``asked`` for the first way that reaches all times; PrecisionLoss if none does."""
        for way in self._ways():
            self.way = way.way
            found = asked(way)
            if found is not None:
                return found
        raise PrecisionLoss("times: no way of this motion reaches them")


class StatesReached(NamedTuple):
    """States of a motion, as q and p of shape (N, 2, n), and the name of the ``way`` that computed them.

    ``places`` are the indices of the times of these states; None means all times, in order. ``error`` estimates
    their largest error, relative to the largest component of q, or of p.
    """

    way: str
    states: np.ndarray
    places: np.ndarray | None = None
    error: float = 0.0


def filled(ways: Iterable[Callable[[np.ndarray], StatesReached | None]], times: np.ndarray) -> StatesReached:
    """The states at all times: every way computes the states that the ways before it have not reached. The last way
    reaches all times or raises an error.
    """
    parts: list[tuple[StatesReached, np.ndarray]] = []
    left = None
    for way in ways:
        found = way(times if left is None else times[left])
        if found is None:
            continue
        if found.places is None and not parts:
            return found
        left = np.arange(len(times)) if left is None else left
        reached = slice(None) if found.places is None else found.places
        if len(left[reached]):
            parts.append((found, left[reached]))
            left = np.delete(left, reached)
        if parts and not len(left):
            break
    states = np.empty((len(times), *parts[0][0].states.shape[1:]))
    for part, places in parts:
        states[places] = part.states
    # a way may itself name several
    names = dict.fromkeys(name for part, _ in parts for name in part.way.split(", "))
    return StatesReached(", ".join(names), states, None, max(part.error for part, _ in parts))


def times_in(field: Field, values: Numbers, argument: str) -> np.ndarray:
    """``values`` as a new one-dimensional array of finite numbers of RR or MP(digits)."""
    if field is RR:
        if type(values) is list and _finite_sum(values):
            return np.array(values, dtype=FLOATS)
        if type(values) is np.ndarray and values.dtype == FLOATS and values.ndim == 1:
            found = values.copy()
            # counting takes half as long as all()
            if np.count_nonzero(np.isfinite(found)) == len(found):
                return found
    items = [field.coerce(value, f"{argument}[{i}]") for i, value in enumerate(one_or_more(values, argument))]
    return np.array(items, dtype=FLOATS if field is RR else object)


def rounded(field: Field, values: Any) -> np.ndarray:
    """An array of numbers of any kind, or nested sequences of them, as an array of numbers of RR or MP(digits)."""
    if field is RR:
        found = np.array(values, dtype=FLOATS)
        if np.isfinite(found).all():
            return found
    # this raises FieldError for an infinite value
    return np.frompyfunc(field.coerce, 1, 1)(np.array(values, dtype=object))


def _finite_sum(values: list[Any]) -> bool:
    """Whether the sum of a list is a finite float. Then all of its values are finite real numbers."""
    try:
        # np.array is slower at finding the type of the values, and reads strings as floats
        total = sum(values)
    except Exception:
        return False
    return isinstance(total, float) and isfinite(total)
