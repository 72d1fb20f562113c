"""Many motions of one kind: arrays of bodies and states in, arrays of states out, on all threads."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from integrable.ensembles.computing import COLUMNS, computed, held
from integrable.ensembles.members import Members, broadcast, time_rows, times_of_some
from integrable.ensembles.trajectories import Trajectories
from jacobian.errors import ArgumentError, flag, shown, whole

__all__ = ["Ensemble", "ensemble"]

CHUNK_BYTES = 1 << 26


def ensemble(system: Any, gamma: Any, M: Any, *, inertia: Any = None, d: Any = None, tilted: bool = False) -> Ensemble:
    """Many motions of ``system``, over RR: γ and M of shape (K, 3), and the moments ``inertia``, shape (K, 3), and
    ``d``, shape (K,), where the members differ in them; each may also be one for all.

    A member that a body or a flow refuses stops nobody: :meth:`Ensemble.at` says why. ArgumentError for shapes that do
    not broadcast, another field, and bodies of their own for a deformation.
    """
    return Ensemble(system, broadcast(system, gamma, M, inertia, d), flag(tilted, "tilted"))


class Ensemble(Members):
    """What :func:`ensemble` gives."""

    def at(self, times: Any, *, out: np.ndarray | None = None) -> Trajectories:
        """The states of all members at physical times, in any order, of any sign and size: shape (N,), the same for
        all, or (K, N).

        Few turns are short runs, whose clock is right to 2·10⁻¹³ and 4·10⁻¹⁶ of the way, the rest is what :meth:`flow`
        gives. A member or a time that is refused stops no other: :attr:`Trajectories.status`. ``out``, shape (K, N, 7),
        is written to and returned in the result (γ, M, τ): a ``numpy.memmap`` for what memory does not hold, or take
        :meth:`chunks`.
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

    def chunks(self, times: Any, members: int | None = None) -> Iterator[Trajectories]:
        """:meth:`at` for so many members at a time, in order: memory for those alone, 64 MB by default."""
        given = time_rows(times, len(self))
        if members is None:
            members = max(1, CHUNK_BYTES // (8 * COLUMNS * max(1, given.shape[1])))
        members = whole(members, "members", "an int ≥ 1 is needed", 1)
        for begin in range(0, len(self), members):
            part = slice(begin, begin + members)
            yield self[part].at(times_of_some(given, part))
