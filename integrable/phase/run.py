"""States of a motion at given times: the base class of the results of all flows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, ClassVar, Generic, Self, TypeVar, overload

import numpy as np

from jacobian.errors import chosen, several, whole
from jacobian.immutable import Record, replaced

# largest relative error of a correctly rounded float
ROUNDED = 2.0**-53

One = TypeVar("One")
"""The type of one state."""


class Run(Record, Generic[One]):
    """N states of a motion, the base of :class:`integrable.motion.trajectory.Trajectory` (γ and M of a body) and
    :class:`integrable.mumford.flow.Path` (q and p of another system).

    ``run[k]`` is one state; a slice or an array of indices or booleans gives a run of several states.
    """

    way: str
    estimate: float = ROUNDED
    error: np.ndarray | None
    digits: np.ndarray | None
    _times: np.ndarray | None
    # row k: both vectors of state k side by side
    _rows: np.ndarray
    _arrays: ClassVar[tuple[str, ...]] = ("_times", "_rows", "error", "digits")
    """The attributes with an entry for each state, or None."""

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} states, by {self.way}>"

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[One]:
        return map(self._state, range(len(self)))

    @overload
    def __getitem__(self, which: int | np.integer) -> One: ...

    @overload
    def __getitem__(self, which: slice | Sequence[int] | np.ndarray) -> Self: ...

    def __getitem__(self, which: object) -> One | Self:
        if several(which):
            return self._some(np.arange(len(self))[chosen(which, len(self))])
        return self._state(whole(which, "row", f"the rows are 0 … {len(self) - 1}", -len(self), len(self) - 1))

    def _state(self, row: int) -> One:
        """The state of one row; defined by subclasses."""
        raise NotImplementedError

    def _some(self, places: np.ndarray) -> Self:
        parts = {name: value[places] for name in self._arrays if (value := getattr(self, name)) is not None}
        return replaced(self, **parts)

    @property
    def times(self) -> np.ndarray:
        """The times of the states, shape (N,)."""
        found: Any = self._times
        return found

    @property
    def q(self) -> np.ndarray:
        """The first vector of every state, positions or γ, shape (N, n)."""
        return self._rows[:, : self._rows.shape[1] // 2]

    @property
    def p(self) -> np.ndarray:
        """The second vector of every state, momenta, velocities or M, shape (N, n)."""
        return self._rows[:, self._rows.shape[1] // 2 :]
