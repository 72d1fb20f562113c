"""The members of an ensemble as rows of numbers, and a mask of the *plain* ones.

The constructors of bodies, states and flows check one member at a time. The bounds of this module are checked for all
members at once. A member within them is never refused, and a short run of compiled code may be tried for it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Generic, Self, TypeVar

import numpy as np

from integrable.motion.domain import HEAVIEST, LARGEST, WIDEST
from integrable.motion.trajectory import Motion
from integrable.phase.body import Body
from integrable.systems.euler_top import EulerTop
from integrable.systems.system import System
from jacobian import RR
from jacobian.element import Rows
from jacobian.errors import ArgumentError, chosen, floats, several, shown, whole
from jacobian.immutable import Record, replaced

# a plain member lies within the fraction HALF of the tolerance of γ and M, and within the fraction FAR_INSIDE of the
# bounds on moments and d
HALF, FAR_INSIDE = 0.5, 1e-3
# DISTINCT is the least difference of the extreme moments, relative to the largest plus d, ASIDE the least distance of M
# from γ and from a principal axis, relative to |M|
DISTINCT, ASIDE = 1e-12, 1e-10


One = TypeVar("One")


class Many(Record, Generic[One]):
    """K members, which are counted, chosen and iterated: ``many[k]`` is one, a slice or an array gives several."""

    def __len__(self) -> int:
        raise NotImplementedError

    def __getitem__(self, which: Rows) -> Any:
        """One member, or the members chosen by a slice, an array of indices or a Boolean mask."""
        if several(which):
            return self._some(np.arange(len(self))[chosen(which, len(self))])
        return self._one(member_number(which, len(self)))

    def __iter__(self) -> Iterator[One]:
        return map(self._one, range(len(self)))

    def _one(self, member: int) -> One:
        """The member with this number, 0 … K − 1; raises an error if it is refused."""
        raise NotImplementedError

    def _some(self, places: np.ndarray) -> Self:
        """The members with these numbers."""
        raise NotImplementedError


class Members(Many[Motion]):
    """Bodies and states of many motions. ``members`` has the moments, d, γ and M of each, shape (K, 10)."""

    def __init__(self, system: Any, members: np.ndarray, tilted: bool) -> None:
        self.system, self.members, self.tilted = system, members, tilted

    def __len__(self) -> int:
        return len(self.members)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} motions of {type(self.system).__name__}>"

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        heads = ["I1", "I2", "I3", "d", "γ1", "γ2", "γ3", "M1", "M2", "M3"]
        return table(repr(self), ["member", *heads], [(k, *row) for k, row in enumerate(self.members.tolist())])

    @property
    def inertia(self) -> np.ndarray:
        """The moments of inertia of each member, shape (K, 3)."""
        return self.members[:, :3]

    @property
    def d(self) -> np.ndarray:
        """d of each member, shape (K,)."""
        return self.members[:, 3]

    @property
    def gamma(self) -> np.ndarray:
        """γ at time 0, shape (K, 3)."""
        return self.members[:, 4:7]

    @property
    def M(self) -> np.ndarray:
        """M at time 0, shape (K, 3)."""
        return self.members[:, 7:]

    def flow(self, member: int) -> Motion:
        """The motion of one member; raises an error if the member is refused."""
        member = whole(member, "member", f"the members are 0 … {len(self) - 1}", 0, len(self) - 1)
        return self._one(member)

    def _one(self, member: int) -> Motion:
        return motion_of(self.system, self.members[member], self.tilted)

    def _some(self, places: np.ndarray) -> Self:
        return replaced(self, members=self.members[places])


def member_number(member: Any, count: int) -> int:
    """The index of a member as 0 … count − 1; a negative ``member`` counts from the end."""
    return whole(member, "member", f"the members are 0 … {count - 1}", -count, count - 1) % count


def broadcast(system: Any, gamma: Any, M: Any, inertia: Any, d: Any) -> np.ndarray:
    """Moments, d, γ and M of all members, shape (K, 10); ArgumentError for entries that are not numbers, and for shapes
    that do not broadcast.
    """
    if isinstance(system, type) or not hasattr(system, "motion_through"):
        raise ArgumentError(
            f"system = {shown(system)}: give a system, such as ChaplyginBall((1, 2, 3), 0.7); bodies of the laboratory "
            "are for laboratory_ensemble"
        )
    if system.field != RR:
        raise ArgumentError(f"system = {shown(system)}: an ensemble is of floats; use system.flow(...) for each member")
    own = {"inertia": inertia is not None, "d": d is not None}
    for name, given in own.items():
        if given and not isinstance(system, System):
            raise ArgumentError(f"{name}: {type(system).__name__} has one body for all members; leave {name} out")
    if own["d"] and isinstance(system, EulerTop):
        raise ArgumentError(f"d = {shown(d)}: an EulerTop has d = 0; use a ChaplyginBall")
    parts = {
        "gamma": numbers(gamma, "gamma", 3),
        "M": numbers(M, "M", 3),
        "inertia": numbers(system.body.inertia if inertia is None else inertia, "inertia", 3),
        "d": numbers(system.body.d if d is None else d, "d", 0),
    }
    count = common_count(parts)
    rows = [np.broadcast_to(parts[name], (count, parts[name].shape[1])) for name in ("inertia", "d", "gamma", "M")]
    return np.ascontiguousarray(np.hstack(rows))


def common_count(parts: dict[str, np.ndarray]) -> int:
    """The number of members, from arrays with one row in all or one for each member; ArgumentError where they do not
    broadcast.
    """
    counts = {name: part.shape[0] for name, part in parts.items() if part.shape[0] != 1}
    if len(set(counts.values())) > 1:
        said = ", ".join(f"{name} has {count}" for name, count in counts.items())
        raise ArgumentError(f"members do not broadcast: {said}; give each one row, or one for every member")
    return next(iter(counts.values()), 1)


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
    """The times of some members, from the array that :func:`time_rows` returns; shape (1, N) if all have the same."""
    return times[which] if len(times) > 1 else times


def system_of(system: Any, row: np.ndarray) -> Any:
    """The system of one member, whose body is in ``row``; ``system`` itself if it has the same body."""
    if not isinstance(system, System):
        return system
    inertia, d = tuple(row[:3].tolist()), float(row[3])
    if system.body.inertia == inertia and system.body.d == d:
        return system
    return replaced(system, body=Body.make(inertia, d, RR))


def motion_of(system: Any, row: np.ndarray, tilted: bool, kernel: str = "auto") -> Motion:
    """The motion of one member; raises an error if the member is refused. ``kernel`` is that of
    :class:`integrable.motion.flow.Flow`.
    """
    own = system_of(system, row)
    state = own.state(tuple(row[4:7].tolist()), tuple(row[7:].tolist()), **({"tilted": True} if tilted else {}))
    motion: Motion = own.flow(state, kernel) if isinstance(own, System) else own.motion_through(state)
    return motion


def plain(members: np.ndarray, tilted: bool) -> np.ndarray:
    """A mask of shape (K,) of the plain members.

    A plain member is certainly accepted. Its moments are well apart, or exactly two are equal, and M is not along a
    principal axis.
    """
    inertia, d, gamma, M = members[:, :3], members[:, 3], members[:, 4:7], members[:, 7:]
    with np.errstate(all="ignore"):
        least, most = inertia.min(axis=1), inertia.max(axis=1)
        size, ordered = np.sqrt((M * M).sum(axis=1)), np.sort(inertia, axis=1)
        tolerance = HALF * RR.eps**0.6
        good: np.ndarray = np.isfinite(members).all(axis=1)
        good &= (least > 1e3 / LARGEST) & (most < LARGEST / 1e3) & (most < FAR_INSIDE * WIDEST * least)
        good &= (d == 0) | ((d > 1e-40 * most) & (d < FAR_INSIDE * HEAVIEST * least))
        apart = np.diff(ordered, axis=1)
        good &= ((apart > DISTINCT * (most + d)[:, None]) | (apart == 0)).all(axis=1) & (least < most)
        good &= abs((gamma * gamma).sum(axis=1) - 1) < tolerance
        good &= (size > 1e3 / LARGEST) & (size < LARGEST / 1e3)
        good &= (np.sort(abs(M), axis=1)[:, 1] > ASIDE * size) & (np.abs(M).max(axis=1) > 1e3 / LARGEST)
        if tilted:
            across = np.cross(gamma, M)
            good &= np.sqrt((across * across).sum(axis=1)) > ASIDE * size
        else:
            good &= abs((gamma * M).sum(axis=1)) < tolerance * size
    return good
