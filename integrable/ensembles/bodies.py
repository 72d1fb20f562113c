"""The members of an ensemble of bodies as rows of numbers, and the computation of their states: by short runs of
compiled code for *plain* members, by flows for the other members.

The constructors of bodies, states and flows check one member at a time. The bounds of this module are checked for all
members at once. A member within them is never refused, and a short run of compiled code may be tried for it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from integrable.ensembles.computing import Outcome, Said, gathered
from integrable.ensembles.members import AT, for_every_member, numbers, times_of, times_of_some
from integrable.files.frame import Column
from integrable.files.quantities import columns
from integrable.motion.domain import HEAVIEST, LARGEST, WIDEST
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
from integrable.motion.trajectory import Motion
from integrable.phase.body import Body
from integrable.systems.euler_top import EulerTop
from integrable.systems.system import System
from jacobian import RR
from jacobian.errors import ArgumentError, JacobianError, shown
from jacobian.immutable import replaced
from jacobian.numbers.compiler import interpreted

COLUMNS = 7
"""The number of columns of γ, M and τ."""
_EMPTY = np.empty(0)
STATES: dict[str, tuple[slice | int, Column]] = {
    "gamma": (slice(0, 3), columns(AT, {"gamma": _EMPTY})["gamma"]),
    "M": (slice(3, 6), columns(AT, {"M": _EMPTY})["M"]),
    "tau": (6, Column(AT, _EMPTY, "s", "time of the flow, dτ = g dt")),
}
"""The arrays of states in files."""
# γ and M of a plain member satisfy their constraints to within HALF times the tolerance; the ratios of its moments, and
# of d to the least moment, are at most FAR_INSIDE times their bounds
HALF, FAR_INSIDE = 0.5, 1e-3
# DISTINCT is the least difference of two unequal moments of a plain member, relative to the largest moment plus d.
# ASIDE is the least distance, relative to |M|, of M from a principal axis and, for tilted states, from γ
DISTINCT, ASIDE = 1e-12, 1e-10


def broadcast(system: Any, gamma: Any, M: Any, inertia: Any, d: Any) -> np.ndarray:
    """Moments, d, γ and M of all members, shape (K, 10); ArgumentError for entries that are not numbers, and for shapes
    that do not broadcast.
    """
    if isinstance(system, type) or not hasattr(system, "motion_through"):
        raise ArgumentError(
            f"system = {shown(system)}: give a system, such as ChaplyginBall((1, 2, 3), 0.7); bodies of the laboratory "
            "are for laboratory_ensemble"
        )
    if system.field is not RR:
        raise ArgumentError(f"system = {shown(system)}: an ensemble is of floats; use system.flow(...) for each member")
    own = {"inertia": inertia is not None, "d": d is not None}
    for name, given in own.items():
        if given and not isinstance(system, System):
            raise ArgumentError(f"{name}: {type(system).__name__} has one body for all members; leave {name} out")
    if own["d"] and isinstance(system, EulerTop):
        raise ArgumentError(f"d = {shown(d)}: an EulerTop has d = 0; use a ChaplyginBall")
    x, m, moments, offsets = for_every_member({
        "gamma": numbers(gamma, "gamma", 3),
        "M": numbers(M, "M", 3),
        "inertia": numbers(system.body.inertia if inertia is None else inertia, "inertia", 3),
        "d": numbers(system.body.d if d is None else d, "d", 0),
    })  # fmt: skip
    return np.hstack([moments, offsets, x, m])


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
    """A mask of shape (K,), True for the *plain* members. The constructors accept every plain member. Its moments are
    well apart, or exactly two of them are equal, and M is not along a principal axis.
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


def computed(
    system: Any, members: np.ndarray, tilted: bool, times: np.ndarray, out: np.ndarray, most: int | None = None
) -> Outcome:
    """Writes γ, M and τ of all members into ``out``, shape (K, N, 7), and returns the outcome.

    ``times`` has shape (1, N) or (K, N). At most ``most`` threads are used, by default all.
    """
    count, length = out.shape[:2]
    body = isinstance(system, System) and not interpreted()
    quick = plain(members, tilted) if body and length <= MOST_TIMES else np.zeros(count, dtype=bool)
    # "auto" would try a short run, which has been tried already
    kernel = "compiled" if body else "auto"

    def part(begin: int, end: int) -> list[Said]:
        left = np.ones(end - begin, dtype=bool)
        for rolls in (True, False):
            which = begin + np.flatnonzero(quick[begin:end] & ((members[begin:end, 3] != 0) == rolls))
            if len(which):
                had, rows, tau = short_runs(members, tilted, rolls, times, which)
                out[had, :, :6], out[had, :, 6] = rows, tau
                left[had - begin] = False
        return [_one(motion, k, times, out) for k in (begin + np.flatnonzero(left)).tolist()]

    def motion(member: int) -> Motion:
        return motion_of(system, members[member], tilted, kernel)

    return gathered(count, length, part, most)


def computed_singly(motion: Callable[[int], Motion], times: np.ndarray, out: np.ndarray) -> Outcome:
    """:func:`computed` on one thread, for motions made one by one: ``motion(k)`` returns the motion of member k, or
    raises a JacobianError.
    """

    def part(begin: int, end: int) -> list[Said]:
        return [_one(motion, k, times, out) for k in range(begin, end)]

    return gathered(len(out), out.shape[1], part, 1)


def _one(motion: Callable[[int], Motion], member: int, times: np.ndarray, out: np.ndarray) -> Said:
    """Writes the states of one member, by its flow, into ``out``, and returns the outcome."""
    try:
        run = motion(member).at(times_of(times, member), strict=False)
    except JacobianError as error:
        out[member] = np.nan
        return Said(member, "", str(error))
    out[member, :, :6] = np.concatenate([run.gamma, run.M], axis=1)
    out[member, :, 6] = run.tau
    return Said(member, run.way, [run.reasons[n] for n in run.status.tolist()])


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
