"""Many motions of one kind, computed on all threads from arrays of bodies and states."""

from __future__ import annotations

from typing import TYPE_CHECKING, overload

import numpy as np

from integrable.ensembles.bodies import COLUMNS, STATES, broadcast, computed, motion_of
from integrable.ensembles.computing import OF_BODIES, Outcome
from integrable.ensembles.members import Contents, Starts
from integrable.ensembles.paths import PathEnsemble
from integrable.ensembles.trajectories import Trajectories
from integrable.files.frame import Column
from integrable.files.quantities import AXES, about, stamp
from integrable.motion.trajectory import Motion
from integrable.mumford.system import MumfordSystem
from jacobian.element import Numbers, Table
from jacobian.errors import ArgumentError, flag, shown

if TYPE_CHECKING:
    from integrable.deformations.hamiltonian import Hamiltonian
    from integrable.phase.space import PhaseSpace

__all__ = ["Ensemble", "ensemble"]


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


class Ensemble(Starts[Motion, Trajectories]):
    """Many motions of bodies, made by :func:`ensemble`. ``members`` has the moments, d, γ and M of each, shape (K, 10).

    A state consists of γ, M and τ. Motions over a few turns are short runs. The error of their states is at most that
    of a change of t by 2·10⁻¹³/(2·max aᵢ·|M|) + 4·10⁻¹⁶·|t|, with aᵢ = 1/(Iᵢ + d). The other states are computed by
    :meth:`flow`.
    """

    _columns, _arrays, _runs = COLUMNS, ("members",), Trajectories

    def __init__(self, system: PhaseSpace[float] | Hamiltonian, members: np.ndarray, tilted: bool) -> None:
        self.system, self.members, self.tilted = system, members, tilted

    def __repr__(self) -> str:
        return f"<Ensemble of {len(self)} motions of {type(self.system).__name__}>"

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

    @property
    def _contents(self) -> Contents:
        parameters = {
            "inertia": Column(("member", "axis"), self.inertia, "kg m2", "principal moments of inertia", AXES),
            "d": Column(("member",), self.d, "kg m2", "mass times square of the radius"),
            "gamma_start": Column(("member", "axis"), self.gamma, "1", "gamma at time 0", AXES),
            "M_start": Column(("member", "axis"), self.M, "kg m2 s-1", "M at time 0", AXES),
        }
        attributes = about(self.system, tilted=int(self.tilted))
        return Contents(STATES, parameters, attributes, [stamp(self.system), self.tilted], OF_BODIES)

    def flow(self, member: int) -> Motion:
        """The motion of one member; raises an error if the member is refused."""
        return self._alone(member)

    def _one(self, member: int) -> Motion:
        return motion_of(self.system, self.members[member], self.tilted)

    def _computed(self, times: np.ndarray, out: np.ndarray, most: int | None = None) -> Outcome:
        return computed(self.system, self.members, self.tilted, times, out, most)
