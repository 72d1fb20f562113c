"""Many motions of one kind, computed on all threads from arrays of bodies and states."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, overload

import numpy as np

from integrable.ensembles.computing import COLUMNS, computed, held
from integrable.ensembles.members import Members, broadcast, time_rows, times_of_some
from integrable.ensembles.paths import PathEnsemble
from integrable.ensembles.trajectories import Trajectories
from integrable.mumford.system import MumfordSystem
from jacobian.element import Numbers, Table
from jacobian.errors import ArgumentError, flag, shown, whole

if TYPE_CHECKING:
    from integrable.deformations.hamiltonian import Hamiltonian
    from integrable.phase.space import PhaseSpace

__all__ = ["Ensemble", "ensemble"]

CHUNK_BYTES = 1 << 26


@overload
def ensemble(system: MumfordSystem, gamma: Table, M: Table, *, tolerance: float | None = ...) -> PathEnsemble: ...


@overload
def ensemble(
    system: PhaseSpace[float] | Hamiltonian,
    gamma: Table,
    M: Table,
    *,
    inertia: Table | None = ...,
    d: Numbers | None = ...,
    tilted: bool = ...,
) -> Ensemble: ...


def ensemble(
    system: PhaseSpace[float] | Hamiltonian | MumfordSystem,
    gamma: Table,
    M: Table,
    *,
    inertia: Table | None = None,
    d: Numbers | None = None,
    tilted: bool = False,
    tolerance: float | None = None,
) -> Ensemble | PathEnsemble:
    """Many motions of ``system`` over RR, with γ and M of shape (K, 3). If the bodies of members differ, give the
    moments ``inertia``, shape (K, 3), or ``d``, shape (K,); all members of a deformation have one body. Each argument
    may also be one value for all members. A refused member does not affect the others; the results of
    :meth:`Ensemble.at` have the reasons. ArgumentError for another field, shapes that do not broadcast, and ``inertia``
    or ``d`` for a deformation.

    For a system of any genus, such as ``TodaLattice(3)``, give q and p of shape (K, n), and perhaps the ``tolerance``
    of its flows. The members of the :class:`integrable.ensembles.paths.PathEnsemble` share the system's constants.
    """
    if isinstance(system, MumfordSystem):
        if not (inertia is None and d is None and tilted is False):
            raise ArgumentError(
                f"inertia, d, tilted: all members have the constants of {shown(system)}; leave these out"
            )
        return PathEnsemble(system, gamma, M, tolerance)
    if tolerance is not None:
        raise ArgumentError(f"tolerance = {shown(tolerance)}: the flow of a body is right to its last bits; give none")
    return Ensemble(system, broadcast(system, gamma, M, inertia, d), flag(tilted, "tilted"))


class Ensemble(Members):
    """Many motions of one kind of system, made by :func:`ensemble`."""

    def at(self, times: Numbers, *, out: np.ndarray | None = None) -> Trajectories:
        """The states of all members at physical times of any order, sign and size.

        Times have shape (N,), the same for all members, or (K, N). Motions over a few turns are short runs, whose times
        have an error of at most 2·10⁻¹³ plus 4·10⁻¹⁶ of the time; others come from :meth:`flow`. A refused member or
        time does not affect the others: see :attr:`Trajectories.status`. ``out``, shape (K, N, 7), receives γ, M and τ
        and is used in the result. For results larger than memory give a ``numpy.memmap``, or use :meth:`chunks`.
        """
        given = time_rows(times, len(self))
        shape = (len(self), given.shape[1], COLUMNS)
        if out is None:
            held(*shape, "take .chunks(times), or out=numpy.memmap(...)")
            out = np.empty(shape)
        elif not isinstance(out, np.ndarray) or out.shape != shape or out.dtype != np.float64:
            raise ArgumentError(f"out = {shown(out)}: an array of float64 of shape {shape} is needed")
        elif not out.flags.writeable:
            raise ArgumentError("out is read-only: an array that can be written to is needed")
        return Trajectories(self, given, out, computed(self.system, self.members, self.tilted, given, out))

    def chunks(self, times: Numbers, members: int | None = None) -> Iterator[Trajectories]:
        """Yields the results of :meth:`at` for ``members`` members at a time, in order.

        Memory is needed for one such chunk only, 64 MB by default.
        """
        given = time_rows(times, len(self))
        if members is None:
            members = max(1, CHUNK_BYTES // (8 * COLUMNS * max(1, given.shape[1])))
        members = whole(members, "members", "an int ≥ 1 is needed", 1)
        for begin in range(0, len(self), members):
            part = slice(begin, begin + members)
            yield self[part].at(times_of_some(given, part))
