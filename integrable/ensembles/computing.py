"""The outcome for many members, which are computed range by range on all threads."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from integrable.motion.trajectory import WAYS
from jacobian.errors import ArgumentError
from jacobian.numbers.threads import in_ranges

# the largest numbers of states and of members in a range; a thread computes one range at a time
STATES, MEMBERS = 1 << 16, 64
REFUSED = -1


class Outcome(NamedTuple):
    """The outcome for all K members, as arrays of numbers.

    ``status``, shape (K,), holds 0 or the index of a reason in ``reasons``. ``ways`` holds the index of each member's
    way in ``words``, the names of the ways. ``partial`` maps each member that is refused in some rows to the reason
    numbers of all its rows. ``estimates`` holds an estimate of the error of each member.
    """

    status: np.ndarray
    ways: np.ndarray
    reasons: tuple[str, ...]
    partial: dict[int, np.ndarray]
    words: tuple[str, ...]
    estimates: np.ndarray


class Said(NamedTuple):
    """The outcome for one member: its way, and ``why``. If the member is refused as a whole, ``why`` is the reason and
    the way is "". Otherwise ``why`` is a list of the reasons of all rows, "" for a row that is not refused; it may be
    empty if no row is refused. ``estimate`` is an estimate of the error, 0 if there is none.
    """

    member: int
    way: str
    why: str | list[str]
    estimate: float = 0.0


USUAL = "short run"
"""The way of each member whose outcome a :data:`Part` leaves out."""
OF_BODIES = tuple(WAYS)
Part = Callable[[int, int], list[Said]]
"""A function that computes the members from ``begin`` to ``end`` − 1, and returns the outcome of some of them."""


def gathered(
    count: int, length: int, part: Part, most: int | None = None, words: tuple[str, ...] = OF_BODIES,
    members: int = MEMBERS,
) -> Outcome:  # fmt: skip
    """The outcome of ``count`` members at ``length`` times. ``part`` is called for ranges of at most ``members``,
    on all threads or on ``most``. ``words`` are the names of all ways.

    A member whose outcome ``part`` does not return has all its states, computed by the usual way.
    """
    size = max(1, min(members, STATES // max(1, length)))
    status, ways = np.zeros(count, dtype=np.intp), np.full(count, words.index(USUAL), dtype=np.int8)
    estimates, reasons, partial = np.zeros(count), {"": 0}, {}
    for member, way, why, estimates[member] in (said for found in in_ranges(count, size, part, most) for said in found):
        ways[member] = words.index(way) if way else REFUSED
        if isinstance(why, str):
            status[member] = reasons.setdefault(why, len(reasons))
            continue
        numbers = np.array([reasons.setdefault(reason, len(reasons)) for reason in why], dtype=np.intp)
        if numbers.any():
            status[member] = numbers[numbers > 0][0]
            partial[member] = numbers
    return Outcome(status, ways, tuple(reasons), partial, words, estimates)


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
