"""States of a motion at given times: the base classes of the results of all flows."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, ClassVar, Generic, Self, TypeVar, overload

import numpy as np

from jacobian.errors import chosen, several, whole
from jacobian.immutable import Record, replaced

# largest relative error of a correctly rounded float
ROUNDED = 2.0**-53

One = TypeVar("One")
"""The type of one item."""


class Items(Record, Generic[One]):
    """A sequence of N items that are stored as rows of arrays. ``items[k]`` is one item; a slice or an array of indices
    or booleans gives several, as a value of the same type.
    """

    _arrays: ClassVar[tuple[str, ...]]
    """The attributes with an entry for each item, or None; the first is no cached result."""
    _item: ClassVar[str] = "row"
    """The word for one item in messages."""

    def __len__(self) -> int:
        return len(getattr(self, self._arrays[0]))

    def __iter__(self) -> Iterator[One]:
        return map(self._one, range(len(self)))

    @overload
    def __getitem__(self, which: int | np.integer) -> One: ...

    @overload
    def __getitem__(self, which: slice | Sequence[int] | np.ndarray) -> Self: ...

    def __getitem__(self, which: Any) -> One | Self:
        if several(which):
            return self._some(np.arange(len(self))[chosen(which, len(self))])
        return self._one(self._number(which))

    def _number(self, which: object) -> int:
        """The index of an item, −N … N − 1; ArgumentError for other values."""
        count = len(self)
        return whole(which, self._item, f"the {self._item}s are 0 … {count - 1}", -count, count - 1)

    def _one(self, place: int) -> One:
        """The item at this place; raises an error if it was refused."""
        raise NotImplementedError

    def _some(self, places: np.ndarray) -> Self:
        # arrays that were not computed yet are not computed here
        parts = {name: x[places] for name in self._arrays if (x := vars(self).get(name)) is not None}
        return replaced(self, **parts)

    def _joined(self, others: Iterable[Self]) -> Self:
        every = (self, *others)
        return replaced(self, **{name: np.concatenate([getattr(x, name) for x in every]) for name in self._arrays})


class Run(Items[One]):
    """N states of a motion, the base of :class:`integrable.motion.trajectory.Trajectory` (γ and M of a body) and
    :class:`integrable.mumford.flow.Path` (q and p of another system).
    """

    way: str
    estimate: float = ROUNDED
    error: np.ndarray | None
    digits: np.ndarray | None
    _times: np.ndarray | None
    # row k: both vectors of state k side by side
    _rows: np.ndarray
    _arrays: ClassVar[tuple[str, ...]] = ("_rows", "_times", "error", "digits")

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} states, by {self.way}>"

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
