"""The base classes of ensembles and of their results, and functions for arguments that broadcast."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from integrable.ensembles.computing import Outcome, held
from integrable.files.frame import Column
from integrable.phase.run import Items, One
from jacobian.element import Numbers
from jacobian.errors import ArgumentError, floats, shown, whole

AT = "member", "time"
"""The dimensions of states in files."""
# the default size of the results of a chunk, in bytes
CHUNK_BYTES = 1 << 26

Found = TypeVar("Found")


class Many(Items[One]):
    """A sequence of K members."""

    _item = "member"

    def _number(self, which: object) -> int:
        return super()._number(which) % len(self)


class Contents(NamedTuple):
    """The content of a file about motions.

    ``states`` has a pair for each array of states, by the array's name: the places of its numbers in a state, and a
    :class:`Column` with axes and units but without values. ``parameters`` have a value for each member; ``attributes``
    apply to all members. ``identity`` is everything else on which the states depend. ``words`` are the names of the
    ways to compute the states.
    """

    states: dict[str, tuple[slice | int, Column]]
    parameters: dict[str, Column]
    attributes: dict[str, Any]
    identity: Any
    words: tuple[str, ...]


class Starts(Many[One], Generic[One, Found]):
    """K motions at time 0, whose states at given times are computed together."""

    _runs: Callable[..., Found]
    """The class of the results of :meth:`at`."""

    @property
    def _columns(self) -> int:
        """The number of floats of a state."""
        raise NotImplementedError

    @property
    def _contents(self) -> Contents:
        """The content of a file about these motions."""
        raise NotImplementedError

    def _alone(self, member: int) -> One:
        """One member; raises an error if it is refused, or if there is no member with this number, 0 … K − 1."""
        return self._one(whole(member, "member", f"the members are 0 … {len(self) - 1}", 0, len(self) - 1))

    def at(self, times: Numbers, *, out: np.ndarray | None = None) -> Found:
        """The states of all members at times of any order, sign and size: shape (N,), the same for all, or (K, N).

        The states of a member are those of its own motion, up to errors that the class states. A refused member or
        time does not affect the others: see ``status`` of the result. ``out``, an array of floats of shape (K, N, C)
        for states of C floats, receives the states, and the result refers to it. If the results are larger than the
        memory, give a ``numpy.memmap``, or use :meth:`chunks`. ArgumentError for times or an array of another shape.
        """
        given = time_rows(times, len(self))
        shape = len(self), given.shape[1], self._columns
        if out is None:
            held(*shape, "take .chunks(times), or out=numpy.memmap(...)")
            out = np.empty(shape)
        elif not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != np.float64:
            raise ArgumentError(f"out = {shown(out)}: an array of float64 of shape {shape} is needed")
        elif not out.flags.writeable:
            raise ArgumentError("out is read-only: an array that can be written to is needed")
        return self._runs(self, given, out, self._computed(given, out))

    def chunks(self, times: Numbers, members: int | None = None) -> Iterator[Found]:
        """Yields the results of :meth:`at` for ``members`` members at a time, in order.

        Memory is needed for one such chunk only, 64 MB by default.
        """
        given = time_rows(times, len(self))
        if members is None:
            members = max(1, CHUNK_BYTES // (8 * self._columns * max(1, given.shape[1])))
        members = whole(members, "members", "an int ≥ 1 is needed", 1)
        for begin in range(0, len(self), members):
            part = slice(begin, begin + members)
            yield self[part].at(times_of_some(given, part))

    def _computed(self, times: np.ndarray, out: np.ndarray, most: int | None = None) -> Outcome:
        """Writes the states of all members at ``times``, shape (1, N) or (K, N), into ``out``; at most ``most`` threads
        are used, by default all.
        """
        raise NotImplementedError


def for_every_member(parts: dict[str, np.ndarray]) -> list[np.ndarray]:
    """Arrays with a row for each member, from arrays that have such rows or one row for all; ArgumentError where they
    do not broadcast.
    """
    counts = {name: part.shape[0] for name, part in parts.items() if part.shape[0] != 1}
    if len(set(counts.values())) > 1:
        said = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise ArgumentError(f"members do not broadcast: {said}; give each one row, or one for every member")
    count = next(iter(counts.values()), 1)
    return [np.broadcast_to(part, (count, *part.shape[1:])) for part in parts.values()]


def numbers(values: Any, argument: str, width: int) -> np.ndarray:
    """The values as floats: a row for each member or one row for all, with ``width`` columns. Width 0 stands for one
    number for each member.
    """
    wanted = f"shape (K, {width}) or ({width},)" if width else "shape (K,) or one for all"
    found: np.ndarray = floats(values, argument, f"numbers of {wanted} are needed")
    found = found[..., None] if width == 0 else found
    if found.ndim not in (1, 2) or found.shape[-1] != max(width, 1):
        raise ArgumentError(f"{argument} has shape {np.shape(values)}: {wanted} is needed")
    return found[None] if found.ndim == 1 else found


def time_rows(times: Any, count: int) -> np.ndarray:
    """Times of ``count`` members: shape (1, N), the same for all, or (K, N)."""
    found = np.array(floats(times, "times", "numbers of shape (N,) or (K, N) are needed"))
    if found.ndim < 2:
        found = found.reshape(1, -1)
    if found.ndim != 2 or found.shape[0] not in (1, count):
        raise ArgumentError(f"times have shape {np.shape(times)}: (N,) or ({count}, N) is needed")
    if not np.isfinite(found).all():
        raise ArgumentError(f"times = {shown(times)}: finite numbers are needed")
    return found


def times_of(times: np.ndarray, member: int) -> np.ndarray:
    """The times of one member, shape (N,), from the array that :func:`time_rows` returns."""
    row: np.ndarray = times[member if len(times) > 1 else 0]
    return row


def times_of_some(times: np.ndarray, which: Any) -> np.ndarray:
    """The times of some members, from the array that :func:`time_rows` returns; shape (1, N) if all members have
    the same times.
    """
    return times[which] if len(times) > 1 else times
