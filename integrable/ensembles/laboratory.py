"""Many motions of one body in the laboratory, computed on all threads from arrays of orientations and ω."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.ensembles.bodies import plain, short_runs
from integrable.ensembles.computing import USUAL, Outcome, Said, gathered
from integrable.ensembles.members import Starts, for_every_member, numbers, times_of
from integrable.ensembles.runs import Runs
from integrable.files.frame import Frame
from integrable.files.quantities import status_column
from integrable.laboratory.bodies import NEARLY, RigidBody
from integrable.laboratory.in_files import about_body, columns_of
from integrable.laboratory.motion import LaboratoryMotion, LaboratoryRun, Orientations
from integrable.laboratory.tensor import ORTHOGONAL, Orientation, matrices_of
from integrable.motion.short import MOST_TIMES
from integrable.phase import attitude
from integrable.phase.body import Body
from jacobian import RR
from jacobian.element import Table
from jacobian.errors import ArgumentError, JacobianError, NotRepresentable, floats, shown
from jacobian.immutable import replaced
from jacobian.numbers.compiler import interpreted

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

__all__ = ["LaboratoryEnsemble", "LaboratoryRuns", "laboratory_ensemble"]

# the least ratio of the second largest to the largest component of ω for a short run; with a smaller ratio the motion
# is nearly a rotation about a principal axis
ASIDE = 1e-8
# floats of one state: the nine entries of an orientation, and ω
COLUMNS = 12
WANTED = "rotations of shape (K, 3, 3) or (3, 3), or SciPy's Rotation, are needed"
# the name of the way of a member that is computed by its own motion
OWN = "own motion"
IN_LABORATORY = (USUAL, OWN)


def laboratory_ensemble(
    body: RigidBody, orientation: Orientation, omega: Table, contact: Table | None = None
) -> LaboratoryEnsemble:
    """Many motions of a RollingBall or a RigidBody over RR.

    ``orientation`` has shape (K, 3, 3), or is a Rotation of SciPy with K entries; ``omega`` is in the laboratory, shape
    (K, 3), in rad/s; ``contact``, shape (K, 2), in m, is by default (0, 0). Each may also be one value for all members.
    A refused member does not affect the others: see :attr:`LaboratoryRuns.status`. ArgumentError for shapes that do not
    broadcast and another field.
    """
    if not isinstance(body, RigidBody) or body.field is not RR:
        raise ArgumentError(f"body = {shown(body)}: give a RollingBall or a RigidBody of floats")
    if contact is not None and body.radius is None:
        raise ArgumentError("contact: a free body has none; leave it out")
    own = for_every_member({
        "orientation": _rotations(orientation),
        "omega": numbers(omega, "omega", 3),
        "contact": numbers((0, 0) if contact is None else contact, "contact", 2),
    })  # fmt: skip
    return LaboratoryEnsemble(body, *map(np.array, own))


def _rotations(orientation: Any) -> np.ndarray:
    found: np.ndarray = floats(matrices_of(orientation), "orientation", WANTED)
    if found.ndim not in (2, 3) or found.shape[-2:] != (3, 3):
        raise ArgumentError(f"orientation has shape {found.shape}: {WANTED}")
    return found.reshape(-1, 3, 3)


class LaboratoryRuns(Orientations, Runs):
    """Orientations and ω of K motions at N times each, ``times`` in s. ``runs[k]`` is one member, a
    :class:`integrable.laboratory.motion.LaboratoryRun`; it raises ArgumentError for a refused member.
    """

    _shared = ("body",)

    @property
    def _motions(self) -> str:
        return "motions"

    @property
    def _body(self) -> Any:
        return self.ensemble.body

    @property
    def orientation(self) -> Rotation:
        """As for one motion, with K·N entries; NotRepresentable if a member was refused."""
        if self.status.any():
            raise NotRepresentable("orientation: some members were refused; take .kept.orientation")
        return super().orientation

    def _path(self) -> np.ndarray:
        found = np.full((*self._rows.shape[:2], 2), np.nan)
        for k in np.flatnonzero(self.status == 0).tolist():
            found[k] = self[k].contact
        return found

    def _one(self, member: int) -> LaboratoryRun:
        run = LaboratoryRun(self.ensemble.motion(member), times_of(self._times, member))
        if self.status[member]:
            raise self._refusal(member)
        return replaced(run, _rows=self._rows[member])

    def _frame(self, quantities: Iterable[str] | None) -> Frame:
        found = self._frame_of(columns_of(self._dims, self, quantities), about_body(self._body))
        status = status_column(self._dims[:1], self.status, self.reasons)
        variables = {name: x for name, x in found.variables.items() if name != "way"} | {"status": status}
        return replace(found, variables=variables)


class LaboratoryEnsemble(Starts[LaboratoryMotion, LaboratoryRuns]):
    """The result of :func:`laboratory_ensemble`: ``orientations`` (K, 3, 3), ``omega`` (K, 3) and ``contacts`` (K, 2)
    at time 0.

    A state consists of the nine entries of an orientation and ω in the axes of the inertia tensor. Motions over a few
    turns are short runs of compiled code, as in :class:`integrable.ensembles.ensemble.Ensemble`; the others are
    computed by :meth:`motion`.
    """

    _columns, _arrays, _runs = COLUMNS, ("orientations", "omega", "contacts"), LaboratoryRuns

    def __init__(self, body: RigidBody, orientations: np.ndarray, omega: np.ndarray, contacts: np.ndarray) -> None:
        self.body, self.orientations, self.omega, self.contacts = body, orientations, omega, contacts

    def __repr__(self) -> str:
        return f"<LaboratoryEnsemble of {len(self)} motions of {self.body!r}>"

    def _repr_html_(self) -> str:
        from jacobian.notebook import table

        heads = ["member", "ω_x, rad/s", "ω_y, rad/s", "ω_z, rad/s"]
        return table(repr(self), heads, [(k, *row) for k, row in enumerate(self.omega.tolist())])

    def motion(self, member: int) -> LaboratoryMotion:
        """The motion of one member; raises an error if the member is refused."""
        return self._alone(member)

    def _one(self, member: int) -> LaboratoryMotion:
        place = () if self.body.radius is None else (self.contacts[member],)
        found: LaboratoryMotion = self.body.motion(self.orientations[member], self.omega[member], *place)
        return found

    def _computed(self, times: np.ndarray, out: np.ndarray, most: int | None = None) -> Outcome:
        with np.errstate(all="ignore"):
            members, frames, quick = _principal(self)
        if interpreted() or times.shape[1] > MOST_TIMES:
            quick = np.zeros_like(quick)
        matrices, omega = out[..., :9].reshape(*out.shape[:2], 3, 3), out[..., 9:]
        rolls = self.body.radius is not None

        def part(begin: int, end: int) -> list[Said]:
            left = np.ones(end - begin, dtype=bool)
            which = begin + np.flatnonzero(quick[begin:end])
            if len(which):
                had, rows, _ = short_runs(members, rolls, rolls, times, which)
                matrices[had], omega[had] = self._in_laboratory(frames[had], rows)
                left[had - begin] = False
            return [own(k) for k in (begin + np.flatnonzero(left)).tolist()]

        def own(member: int) -> Said:
            try:
                out[member] = self.motion(member).at(times_of(times, member))._rows
            except JacobianError as error:
                out[member] = np.nan
                return Said(member, "", str(error))
            return Said(member, OWN, "")

        return gathered(len(self), times.shape[1], part, most, IN_LABORATORY)

    def _in_laboratory(self, frames: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Orientations and ω of H members, from ``rows``: their γ and M in principal axes, shape (H, N, 6).

        ``frames`` are the rotations from the axes of :mod:`integrable.phase.attitude` to the laboratory.
        """
        body, axes, shape = Body.make(self.body.moments, float(self.body._d), RR), self.body.axes, rows.shape[:2]
        gamma, M = rows[..., :3].reshape(-1, 3), rows[..., 3:].reshape(-1, 3)
        turned = frames[:, None] @ attitude.matrices(gamma, M).reshape(*shape, 3, 3) @ axes.T
        return turned, attitude.angular_velocities(body, gamma, M)[0].reshape(*shape, 3) @ axes.T


def _principal(many: LaboratoryEnsemble) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each member the moments, d, γ and M in principal axes, shape (K, 10); the rotation from the axes of
    :mod:`integrable.phase.attitude` to the laboratory; and whether a short run is tried.

    They are computed in floats for all members together, as :mod:`integrable.laboratory.bodies` does for one.
    """
    body, given = many.body, many.orientations
    flipped = given.transpose(0, 2, 1)
    off = abs(given @ flipped - np.eye(3)).max(axis=(1, 2))
    start = given @ (3 * np.eye(3) - flipped @ given) / 2 @ body.axes
    spin = np.einsum("kji,kj->ki", start, many.omega)
    inertia, d, rolls = np.array(body.moments), float(body._d), body.radius is not None
    M = (inertia + d) * spin
    if rolls:
        gamma = start[:, 2]
        M -= d * np.sum(gamma * spin, axis=1)[:, None] * gamma
    else:
        gamma = np.cross(M, np.eye(3)[abs(M).argmin(axis=1)])
        gamma /= np.linalg.norm(gamma, axis=1)[:, None]
    # orientation = frame · attitude at every time, and the orientation at time 0 is ``start``
    frames = start @ attitude.matrices(gamma, M).transpose(0, 2, 1)
    rows = np.hstack([np.broadcast_to([*inertia, d], (len(many), 4)), gamma, M])
    aside = np.sort(abs(spin), axis=1)
    quick = np.linalg.norm(np.cross(gamma, M), axis=1) > 2 * NEARLY * np.linalg.norm(M, axis=1)
    quick &= (off < ORTHOGONAL / 2) & (np.linalg.det(given) > 0) & (aside[:, 1] > ASIDE * aside[:, 2])
    return rows, frames, quick & plain(rows, rolls)
