"""The choice among the ways to the states of a motion, the same for every system.

A motion names its ways in the order of their cost: a walk near the start, a closed form or a torus, additions to as
many digits as needed. A way is made when those before it have left times. No way uses what earlier calls have computed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol, TypeVar

import numpy as np

from jacobian.errors import PrecisionLoss

Answer = TypeVar("Answer")


class Cost(NamedTuple):
    """The microseconds that a way takes: for its set-up, and for each time."""

    set_up: float
    each: float

    def of(self, count: int) -> float:
        """The microseconds for that many times."""
        return self.set_up + count * self.each


class Way(Protocol):
    """A method of computing the states of a motion over its field; ``way`` is its name. It returns None where it does
    not reach all times, and raises PrecisionLoss or Infeasible where no later way is to be asked.
    """

    way: str

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""

    def at_tau(self, tau: np.ndarray) -> np.ndarray | None:
        """γ and M side by side at values of τ: shape (N, 6)."""

    def times(self, tau: np.ndarray) -> np.ndarray | None:
        """The physical times t(τ) at values of τ: shape (N,)."""


class InOrder:
    """The states by the first of ``ways()`` that reaches all times; ``way`` is the name of the way asked last."""

    way: str

    def __init__(self, ways: Callable[[], Iterator[Way]]) -> None:
        self._ways = ways

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""
        return self._first(lambda way: way.at(times))

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M side by side at values of τ: shape (N, 6)."""
        return self._first(lambda way: way.at_tau(tau))

    def times(self, tau: np.ndarray) -> np.ndarray:
        """The physical times t(τ) at values of τ: shape (N,)."""
        return self._first(lambda way: way.times(tau))

    def _first(self, asked: Callable[[Way], Answer | None]) -> Answer:
        for way in self._ways():
            found = asked(way)
            self.way = way.way
            if found is not None:
                return found
        raise PrecisionLoss("times: no way of this motion reaches them")
