"""Many motions of one system of any genus, on all threads. Near their starts several motions are computed together, as
lanes of a vector; for other times each is computed by its own flow.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from integrable.ensembles.computing import Outcome, Said, gathered
from integrable.ensembles.members import AT, Contents, Starts, for_every_member, numbers, times_of, times_of_some
from integrable.ensembles.runs import Runs
from integrable.files.frame import Column, Frame
from integrable.files.quantities import Quantity, checked, columns, made_of
from integrable.motion.refusals import kept_rows
from integrable.motion.trajectory import WAYS
from integrable.mumford.flow import ADDITIONS, SERIES, TORUS, MumfordFlow, Path
from integrable.phase.run import ROUNDED
from jacobian import RR
from jacobian.element import Table
from jacobian.errors import ArgumentError, Infeasible, JacobianError, NotRepresentable, shown
from jacobian.numbers.compiler import interpreted

if TYPE_CHECKING:
    from integrable.mumford.system import MumfordSystem
    from integrable.series.kinds import Near
    from integrable.series.many import NearMany

# MANY is the least number of members whose walks run together: the code for this takes a second to compile, once per
# kind of system and machine. A thread computes AT_A_TIME members at a time
MANY, AT_A_TIME = 64, 256
# the names that ``ways`` may have: those of paths, alone or in combination, and those of bodies
OF_PATHS = [", ".join(words) for n in (1, 2, 3) for words in combinations((SERIES, TORUS, ADDITIONS), n)]
OF_SYSTEMS = tuple(dict.fromkeys([*OF_PATHS, *WAYS]))
PARTS = ("q", "p")


class Paths(Runs):
    """States of K motions of a system at N times each. ``runs[k]`` is one member, a
    :class:`integrable.mumford.flow.Path`, if none of its rows was refused. ``ways`` and ``estimates``, of length K, are
    the ways of the members and the estimates of their errors.
    """

    _arrays, _shared = (*Runs._arrays, "estimates"), ("system", "tolerance")

    def __init__(self, ensemble: PathEnsemble, times: np.ndarray, rows: np.ndarray, outcome: Outcome) -> None:
        super().__init__(ensemble, times, rows, outcome)
        self.estimates = outcome.estimates

    @property
    def q(self) -> np.ndarray:
        """The positions, shape (K, N, n)."""
        return self._rows[..., : self.ensemble.system.size]

    @property
    def p(self) -> np.ndarray:
        """The momenta or velocities, shape (K, N, n)."""
        return self._rows[..., self.ensemble.system.size :]

    @property
    def _usual(self) -> tuple[str, ...]:
        return PARTS

    def _one(self, member: int) -> Path:
        if self.status[member]:
            raise self._refusal(member)
        times, estimate = times_of(self._times, member), float(self.estimates[member])
        return Path(times, np.hstack([self.q[member], self.p[member]]), self.ways[member], estimate)

    def _frame(self, quantities: Iterable[str]) -> Frame:
        system, dims, among = self.ensemble.system, self._dims, self.ensemble._quantities
        arrays = {name: getattr(self, name) for name in checked(quantities, among)}
        estimate = Column(dims[:1], self.estimates, "1", "estimate of the largest error relative to q or p")
        return self._frame_of({**columns(dims, arrays, among), "estimate": estimate}, made_of(system, system.arguments))


class PathEnsemble(Starts[MumfordFlow, Paths]):
    """Many motions of one system of any genus over RR, made by :func:`integrable.ensemble`; ``q`` and ``p`` are the
    starts, of shape (K, n). ``tolerance`` is passed to ``system.flow``.

    A state consists of q and p. The states equal those of :meth:`flow` bit for bit.
    """

    _arrays, _runs = ("q", "p"), Paths

    def __init__(self, system: MumfordSystem, q: Table, p: Table, tolerance: float | None = None) -> None:
        if system.field is not RR:
            raise ArgumentError(
                f"system = {shown(system)}: an ensemble is of floats; use system.flow(...) for each member"
            )
        given = {name: numbers(x, name, system.size) for name, x in (("q", q), ("p", p))}
        (self.q, self.p), self.system = map(np.array, for_every_member(given)), system
        self.tolerance = system._tolerance(tolerance)

    @property
    def _columns(self) -> int:
        return 2 * int(self.system.size)

    def __repr__(self) -> str:
        return f"<PathEnsemble of {len(self)} motions of {self.system!r}>"

    @property
    def _contents(self) -> Contents:
        size, empty = self.system.size, np.empty(0)
        states, starts = (columns(dims, dict.fromkeys(PARTS, empty), self._quantities) for dims in (AT, AT[:1]))
        parts = {"q": slice(size), "p": slice(size, 2 * size)}
        parameters = {f"{name}_start": replace(x, values=getattr(self, name)) for name, x in starts.items()}
        attributes = made_of(self.system, self.system.arguments)
        identity = [attributes["system_stamp"], self.tolerance]
        return Contents(
            {name: (parts[name], states[name]) for name in PARTS}, parameters, attributes, identity, OF_SYSTEMS
        )

    @property
    def _quantities(self) -> dict[str, Quantity]:
        parts, names = tuple(map(str, range(self.system.size))), {"q": "position", "p": "momentum or velocity"}
        return {name: Quantity("coordinate", parts, "1", said) for name, said in names.items()}

    def flow(self, member: int) -> MumfordFlow:
        """The motion of one member; raises an error if the member is refused."""
        return self._alone(member)

    def _one(self, member: int) -> MumfordFlow:
        q, p = (tuple(x[member].tolist()) for x in (self.q, self.p))
        return self.system.flow(self.system.state(q, p), self.tolerance)

    def _computed(self, times: np.ndarray, out: np.ndarray, most: int | None = None) -> Outcome:
        def part(begin: int, end: int) -> list[Said]:
            flows: dict[int, MumfordFlow] = {}
            found: list[Said] = []
            for k in range(begin, end):
                try:
                    flows[k] = self._one(k)
                except JacobianError as error:
                    out[k] = np.nan
                    found.append(Said(k, "", str(error)))
            near = self._near(flows, times)
            for i, (k, flow) in enumerate(flows.items()):
                if near is not None and near.reached[i].all():
                    out[k] = near.states[i].reshape(-1, out.shape[2])
                    found.append(Said(k, SERIES, [], max(float(near.errors[i]), ROUNDED)))
                else:
                    found.append(_by_flow(k, flow, None if near is None else near.of(i), times_of(times, k), out))
            return found

        return gathered(len(self), times.shape[1], part, most, OF_SYSTEMS, AT_A_TIME)

    def _near(self, flows: dict[int, MumfordFlow], times: np.ndarray) -> NearMany | None:
        """The states near the start, computed for several members at once; None if the ensemble has few members."""
        kind, length = self.system._kind, times.shape[1]
        if len(self) < MANY or not (flows and length) or kind is None or interpreted():
            return None
        from integrable.series.many import walked_by_many

        starts = np.array([(*flow.start.q, *flow.start.p) for flow in flows.values()])
        own = np.broadcast_to(times_of_some(times, list(flows)), (len(flows), length))
        most = np.array([flow._budget(length) for flow in flows.values()])
        return walked_by_many(kind, self.system._walk_constants, starts, own, most, self.tolerance)


def _by_flow(member: int, flow: MumfordFlow, near: Near | None, times: np.ndarray, out: np.ndarray) -> Said:
    """Computes the states of one member, some of which ``near`` may contain already, and returns the outcome."""
    way, estimate = "", 0.0

    def computed(given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nonlocal way, estimate
        try:
            path = flow._after(near, given) if near is not None and len(given) == len(times) else flow.at(given)
        except NotRepresentable as error:
            # on an Infeasible error kept_rows asks again for the earlier ones of these times, whose states may be found
            raise Infeasible(str(error)) from error
        way, estimate = path.way, path.estimate
        return np.hstack([path.q, path.p]), given

    try:
        out[member], _, status, reasons = kept_rows(computed, times, np.nan, out.shape[2])
    except JacobianError as error:
        out[member] = np.nan
        return Said(member, "", str(error))
    whys = [] if status is None else [reasons[n] for n in status.tolist()]
    return Said(member, "", whys[0]) if len(times) and all(whys) else Said(member, way, whys, estimate)
