"""Many motions of one system of any genus on all threads, near their starts as lanes of one vector, else one by one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from integrable.ensembles.computing import REFUSED, Said, gathered, held
from integrable.ensembles.members import Many, common_count, member_number, numbers, time_rows, times_of, times_of_some
from integrable.ensembles.runs import Runs
from integrable.mumford.flow import ROUNDED, SERIES, MumfordFlow, Path
from jacobian import RR
from jacobian.element import Numbers, Table
from jacobian.errors import ArgumentError, JacobianError, shown
from jacobian.immutable import replaced
from jacobian.numbers.compiler import interpreted

if TYPE_CHECKING:
    from integrable.mumford.system import MumfordSystem
    from integrable.series.many import NearMany

# from this number of members on, walks run together: their code takes a second to compile, once per kind of systems and
# machine. AT_A_TIME members are the unit of work of a thread
MANY, AT_A_TIME = 64, 256


class PathEnsemble(Many[MumfordFlow]):
    """Many motions of one system of any genus over RR, made by :func:`integrable.ensemble`; ``q`` and ``p`` are the
    starts, of shape (K, n). ``tolerance`` is passed to ``system.flow``.
    """

    def __init__(self, system: MumfordSystem, q: Table, p: Table, tolerance: float | None = None) -> None:
        if system.field != RR:
            raise ArgumentError(
                f"system = {shown(system)}: an ensemble is of floats; use system.flow(...) for each member"
            )
        parts = {name: numbers(x, name, system.size) for name, x in (("q", q), ("p", p))}
        count, self.system, self.tolerance = common_count(parts), system, system._tolerance(tolerance)
        self.q, self.p = (np.broadcast_to(part, (count, system.size)).copy() for part in parts.values())

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return f"<PathEnsemble of {len(self)} motions of {self.system!r}>"

    def flow(self, member: int) -> MumfordFlow:
        """The motion of one member; raises an error if the member is refused."""
        return self._one(member_number(member, len(self)))

    def _one(self, member: int) -> MumfordFlow:
        q, p = (tuple(x[member].tolist()) for x in (self.q, self.p))
        return self.system.flow(self.system.state(q, p), self.tolerance)

    def _some(self, places: np.ndarray) -> Self:
        return replaced(self, q=self.q[places], p=self.p[places])

    def at(self, times: Numbers) -> Paths:
        """The states of all members at times of any order, sign and size: shape (N,), the same for all, or (K, N).

        They equal the states of :meth:`flow` to the bit. A member that is refused at one of its times has no states,
        and does not affect the others: see :attr:`Paths.status`. ArgumentError for times of another shape and for
        results larger than the memory.
        """
        given = time_rows(times, len(self))
        count, length = len(self), given.shape[1]
        held(count, length, 2 * self.system.size, "ask for some of the members, many[:1000]")
        work = _Work(self, given, np.empty((count, length, 2, self.system.size)), np.zeros(count), [""] * count)
        outcome = gathered(count, length, work.part, members=AT_A_TIME)
        return Paths(self, given, work.states, (work.estimates, tuple(work.ways)), outcome.status, outcome.reasons)


class _Work(NamedTuple):
    """The times of K members, and the arrays for their states, estimates and ways."""

    many: PathEnsemble
    times: np.ndarray
    states: np.ndarray
    estimates: np.ndarray
    ways: list[str]

    def part(self, begin: int, end: int) -> list[Said]:
        """Computes the members of a range, and returns the refused ones."""
        flows: dict[int, MumfordFlow] = {}
        refused: list[Said] = []
        for k in range(begin, end):
            with self.refusing(k, refused):
                flows[k] = self.many._one(k)
        near = self.near(flows)
        for i, (k, flow) in enumerate(flows.items()):
            if near and near.reached[i].all():
                self.put(k, near.states[i], SERIES, max(near.errors[i], ROUNDED))
                continue
            with self.refusing(k, refused):
                times = times_of(self.times, k)
                path = flow.at(times) if near is None else flow._after(near.of(i), times)
                self.put(k, np.stack([path.q, path.p], axis=1), path.way, path.estimate)
        return refused

    def near(self, flows: dict[int, MumfordFlow]) -> NearMany | None:
        """The states near the start, computed for several members at once; None for few members."""
        kind, length = self.many.system._kind, self.times.shape[1]
        if len(self.many) < MANY or not (flows and length) or kind is None or interpreted():
            return None
        from integrable.series.many import walked_by_many

        starts = np.array([(*flow.start.q, *flow.start.p) for flow in flows.values()])
        times = np.broadcast_to(times_of_some(self.times, list(flows)), (len(flows), length))
        most = np.array([flow._budget(length) for flow in flows.values()])
        return walked_by_many(kind, self.many.system._walk_constants, starts, times, most, self.many.tolerance)

    def put(self, member: int, states: np.ndarray, way: str, estimate: float) -> None:
        """Stores the states of a member."""
        self.states[member], self.ways[member], self.estimates[member] = states, way, estimate

    @contextmanager
    def refusing(self, member: int, refused: list[Said]) -> Iterator[None]:
        """A member whose computation is refused has no states, and its reason is added to ``refused``."""
        try:
            yield
        except JacobianError as error:
            self.states[member] = np.nan
            refused.append(Said(member, REFUSED, str(error)))


class Paths(Runs):
    """States of K motions of a system at N times: ``q`` and ``p`` have shape (K, N, n). ``ways`` and ``estimates`` have
    the ``way`` and the ``estimate`` of each member's :class:`integrable.mumford.flow.Path`.

    ``status``, shape (K,), is 0 for a member that was computed, otherwise n > 0 with the reason ``reasons[n]``; its q
    and p are NaN. ``runs[k]`` is the Path of one member; a slice or an array gives the Paths of several, :attr:`kept`
    the Paths of all members with status 0.
    """

    def __init__(
        self,
        ensemble: PathEnsemble,
        times: np.ndarray,
        states: np.ndarray,
        how: tuple[np.ndarray, tuple[str, ...]],
        status: np.ndarray,
        reasons: tuple[str, ...],
    ) -> None:
        self.ensemble, self._times, self.status, self.reasons = ensemble, times, status, reasons
        (self.q, self.p), (self.estimates, self.ways) = (states[:, :, part] for part in (0, 1)), how

    def __repr__(self) -> str:
        return self._told(f"motions of {type(self.ensemble.system).__name__}")

    def _one(self, member: int) -> Path:
        if self.status[member]:
            raise self._refusal(member)
        times, estimate = times_of(self._times, member), float(self.estimates[member])
        return Path(times, self.q[member], self.p[member], self.ways[member], estimate)

    def _of_some(self, places: np.ndarray) -> dict[str, Any]:
        parts = {name: getattr(self, name)[places] for name in ("q", "p", "estimates")}
        return {**parts, "ways": tuple(self.ways[k] for k in places.tolist())}

    def _value(self) -> tuple[object, ...]:
        # NaN, which is unequal to itself, is replaced in refused rows, so that equal results compare as equal
        states = np.nan_to_num(np.stack([self.q, self.p])).ravel().tolist()
        return self.ensemble, tuple(self._times.ravel().tolist()), tuple(states), tuple(self.status.tolist())
