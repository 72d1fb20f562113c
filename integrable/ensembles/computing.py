"""The states of many motions: short runs of compiled code, range by range on all threads, and flows for the rest."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from integrable.ensembles.members import motion_of, plain, times_of, times_of_some
from integrable.motion.short import (
    DRIFT_OF_MANY,
    FREE,
    MOST_TIMES,
    PACE_OF_MANY,
    ROLLING,
    WORTH_OF_MANY,
    Asked,
    compiled_runs,
    panels_within,
)
from integrable.motion.trajectory import WAYS, Motion
from integrable.systems.system import System
from jacobian.errors import ArgumentError, JacobianError
from jacobian.numbers.compiler import interpreted
from jacobian.numbers.threads import in_ranges

COLUMNS = 7
"""The number of columns of γ, M and τ."""
# the numbers of states and of members in a range, which is the unit of work of a thread
STATES, MEMBERS = 1 << 16, 64
WORDS = tuple(WAYS)
SHORT = WORDS.index("short run")
REFUSED = -1


class Outcome(NamedTuple):
    """The outcome for all members, in numbers.

    ``status``, shape (K,), holds 0 or the number of a reason, ``ways`` the indices of the ways in ``WORDS``.
    ``partial`` maps each member that is refused in some rows to the reason numbers of all its rows.
    """

    status: np.ndarray
    ways: np.ndarray
    reasons: tuple[str, ...]
    partial: dict[int, np.ndarray]


class Said(NamedTuple):
    """The outcome for one member: the index of its way, and ``why``. If the member is refused as a whole, ``why`` is
    the reason; otherwise it has a reason for each row, "" where the row is not refused.
    """

    member: int
    way: int
    why: str | list[str]


def computed(
    system: Any, members: np.ndarray, tilted: bool, times: np.ndarray, out: np.ndarray, most: int | None = None
) -> Outcome:
    """Writes γ, M and τ of all members into ``out``, shape (K, N, 7), and returns the outcome.

    ``times`` has shape (1, N) or (K, N). At most ``most`` threads are used, by default all.
    """
    quick = np.zeros(len(members), dtype=bool)
    body = isinstance(system, System) and not interpreted()
    if body and out.shape[1] <= MOST_TIMES:
        quick = plain(members, tilted)
    # "auto" would try a short run, which has been tried already
    kernel = "compiled" if body else "auto"

    def motion(member: int) -> Motion:
        return motion_of(system, members[member], tilted, kernel)

    return _Work(members, tilted, quick, motion, times, out).outcome(most)


def computed_singly(motion: Callable[[int], Motion], times: np.ndarray, out: np.ndarray) -> Outcome:
    """:func:`computed` on one thread, for motions made one by one: ``motion(k)`` returns the motion of member k, or
    raises a JacobianError.
    """
    none = np.zeros(len(out), dtype=bool)
    return _Work(np.empty((len(out), 10)), False, none, motion, times, out).outcome(1)


class _Work(NamedTuple):
    members: np.ndarray
    tilted: bool
    quick: np.ndarray
    motion: Callable[[int], Motion]
    times: np.ndarray
    out: np.ndarray

    def outcome(self, most: int | None) -> Outcome:
        """Computes all members, range by range, and returns their outcome."""
        count, length = self.out.shape[:2]
        return gathered(count, length, self.part, most)

    def part(self, begin: int, end: int) -> list[Said]:
        """Computes the members of a range, and returns the outcome of those without a short run."""
        left = np.ones(end - begin, dtype=bool)
        for rolls in (True, False):
            which = begin + np.flatnonzero(self.quick[begin:end] & ((self.members[begin:end, 3] != 0) == rolls))
            if len(which):
                left[self.short_runs(which, rolls) - begin] = False
        return [self.one(k) for k in (begin + np.flatnonzero(left)).tolist()]

    def short_runs(self, which: np.ndarray, rolls: bool) -> np.ndarray:
        """Computes members by short runs, and returns which of them had one."""
        had, rows, tau = short_runs(self.members, self.tilted, rolls, self.times, which)
        self.out[had, :, :6], self.out[had, :, 6] = rows, tau
        return had

    def one(self, member: int) -> Said:
        """Computes the states of one member by its flow, and returns the outcome."""
        times = times_of(self.times, member)
        try:
            run = self.motion(member).at(times, strict=False)
        except JacobianError as error:
            self.out[member] = np.nan
            return Said(member, REFUSED, str(error))
        self.out[member, :, :6] = np.concatenate([run.gamma, run.M], axis=1)
        self.out[member, :, 6] = run.tau
        return Said(member, WORDS.index(run.way), [run.reasons[n] for n in run.status.tolist()])


def short_runs(
    members: np.ndarray, tilted: bool, rolls: bool, times: np.ndarray, which: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Short runs of the members ``which``.

    Returns the H members that have one, their γ and M of shape (H, N, 6), and τ of shape (H, N) or (1, N).

    ``times`` has shape (1, N), or (K, N) for K ``members``.
    """
    times = times_of_some(times, which)
    count, length = len(which), times.shape[1]
    rows, tau = np.empty((count, length, 6)), np.empty((count, length))
    most = panels_within(ROLLING if rolls else FREE, length, WORTH_OF_MANY)
    asked = Asked(members[which], tilted, rolls, False, most, DRIFT_OF_MANY, PACE_OF_MANY)
    status, _ = compiled_runs(asked, times, rows, tau)
    had = status == 0
    return which[had], rows[had], tau[had] if rolls else times_of_some(times, had)


def gathered(
    count: int,
    length: int,
    part: Callable[[int, int], list[Said]],
    most: int | None = None,
    members: int = MEMBERS,
) -> Outcome:
    """The outcome of ``count`` members at ``length`` times, from ``part(begin, end)`` for ranges of them, on all
    threads or on ``most``. A range has at most ``members``.

    Members that ``part`` does not report have all their states, from short runs.
    """
    size = max(1, min(members, STATES // max(1, length)))
    return _outcome(count, [said for found in in_ranges(count, size, part, most) for said in found])


def _outcome(count: int, said: list[Said]) -> Outcome:
    status, ways = np.zeros(count, dtype=np.intp), np.full(count, SHORT, dtype=np.int8)
    reasons: dict[str, int] = {"": 0}
    partial = {}
    for member, way, why in said:
        ways[member] = way
        if isinstance(why, str):
            status[member] = reasons.setdefault(why, len(reasons))
            continue
        numbers = np.array([reasons.setdefault(reason, len(reasons)) for reason in why], dtype=np.intp)
        if numbers.any():
            status[member] = numbers[numbers > 0][0]
            partial[member] = numbers
    return Outcome(status, ways, tuple(reasons), partial)


def statuses(status: np.ndarray, partial: dict[int, np.ndarray], length: int) -> np.ndarray:
    """The reason number of every row, shape (K, length), from two attributes of an :class:`Outcome`."""
    rows = np.repeat(status[:, None], length, axis=1)
    for member, numbers in partial.items():
        rows[member] = numbers
    return rows


def held(count: int, length: int, columns: int, instead: str) -> None:
    """Raises ArgumentError, which recommends ``instead``, if the result would not fit into memory.

    The result has ``columns`` floats for each of ``count`` members at ``length`` times.
    """
    size = 8.0 * count * length * columns
    if size > _memory():
        raise ArgumentError(f"times: {count} members at {length} times are {1e-9 * size:.0f} GB; {instead}")


def _memory() -> float:
    """The bytes of this machine's memory; infinity if unknown."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):
        return float("inf")
