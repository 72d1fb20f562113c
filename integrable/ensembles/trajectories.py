"""The states of many motions at given times, and the outcome for each."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from integrable.ensembles.computing import WORDS, Outcome, statuses
from integrable.ensembles.members import Members, member_number, motion_of, system_of, times_of
from integrable.ensembles.runs import Runs, joined_times
from integrable.files.exported import Exported
from integrable.files.frame import Column, Frame
from integrable.files.quantities import AXES, QUANTITIES, about, checked, columns, reasons_text, status_column
from integrable.motion.refusals import common_reasons
from integrable.motion.trajectory import Trajectory
from integrable.phase import attitude
from jacobian.errors import ArgumentError
from jacobian.immutable import read_only, replaced

__all__ = ["Trajectories"]


class Trajectories(Runs, Exported):
    """States of K motions at N times each. ``times`` has shape (N,), or (K, N) where every member has its own.

    ``status``, shape (K,), is 0 for a member all of whose states were computed, otherwise n > 0 with the reason
    ``reasons[n]``. γ, M and τ of refused rows are NaN, and :meth:`row_status` tells which rows these are. ``runs[k]``
    is one member, a :class:`integrable.motion.trajectory.Trajectory`; a slice or an array gives the Trajectories of
    several, :attr:`kept` the Trajectories of all members with status 0.
    """

    def __init__(self, ensemble: Members, times: np.ndarray, rows: np.ndarray, outcome: Outcome) -> None:
        self.ensemble = ensemble
        self._times, self._rows = times, rows
        self.status, self._ways = outcome.status, outcome.ways
        self.reasons, self._partial = outcome.reasons, outcome.partial

    def __repr__(self) -> str:
        return self._told(f"motions of {type(self.ensemble.system).__name__}")

    @property
    def gamma(self) -> np.ndarray:
        """The vertical γ in the body frame, shape (K, N, 3)."""
        return self._rows[:, :, :3]

    @property
    def M(self) -> np.ndarray:
        """The angular momentum M in the body frame, shape (K, N, 3)."""
        return self._rows[:, :, 3:6]

    @property
    def tau(self) -> np.ndarray:
        """Values of the flow's own time τ, shape (K, N)."""
        return self._rows[:, :, 6]

    @cached_property
    def omega(self) -> np.ndarray:
        """The angular velocity ω in the body frame, shape (K, N, 3)."""
        return read_only(self._along("omega"))

    @cached_property
    def quaternion(self) -> np.ndarray:
        """The rotations from the body frame to space as unit quaternions (w, x, y, z), shape (K, N, 4)."""
        return read_only(self._along("quaternion"))

    @cached_property
    def contact(self) -> np.ndarray:
        """(x, y) of the points where the balls touch the plane, shape (K, N, 2)."""
        return read_only(self._along("contact"))

    @property
    def ways(self) -> list[str]:
        """The way of each member, a word of :data:`integrable.motion.trajectory.WAYS`; "" for a member refused as a
        whole.
        """
        return [WORDS[way] if way >= 0 else "" for way in self._ways.tolist()]

    def row_status(self, member: int) -> np.ndarray:
        """0, or the number of the reason, for every row of a member: shape (N,)."""
        member = member_number(member, len(self))
        if member in self._partial:
            return read_only(self._partial[member])
        return read_only(np.full(self._rows.shape[1], self.status[member]))

    def _one(self, member: int) -> Trajectory:
        many = self.ensemble
        flow = motion_of(many.system, many.members[member], many.tilted)
        way = self._ways[member]
        if way < 0:
            raise self._refusal(member)
        refused = self.status[member] > 0
        status, reasons = (self.row_status(member), self.reasons) if refused else (None, ("",))
        rows, tau = np.array(self._rows[member, :, :6]), np.array(self._rows[member, :, 6])
        return Trajectory(flow, times_of(self._times, member), tau, rows, WORDS[way], status, reasons)

    def concatenated(self, *others: Trajectories) -> Trajectories:
        """These members, then the members of ``others``, which have the same system and the same number of times."""
        every = (self, *others)
        for other in others:
            if not isinstance(other, Trajectories) or other.ensemble.tilted != self.ensemble.tilted:
                raise ArgumentError(f"others: {other!r} given; Trajectories of such motions are needed")
            if other.ensemble.system != self.ensemble.system or other._rows.shape[1] != self._rows.shape[1]:
                raise ArgumentError(f"others: {other!r} given; the same system and number of times are needed")
        return joined(every, joined_times(every))

    def _along(self, name: str) -> np.ndarray:
        """The values of the quantity ``name`` at every state, NaN in refused rows."""
        parts = len(QUANTITIES[name].parts)
        found = np.full((*self._rows.shape[:2], parts), np.nan)
        for k in np.flatnonzero(self._ways >= 0).tolist():
            had = self.row_status(k) == 0
            found[k, had] = self._of_member(name, k, self._rows[k, had])
        return found

    def _of_member(self, name: str, member: int, rows: np.ndarray) -> np.ndarray:
        """An attribute of a member's Trajectory; a flow is made only if the attribute needs one."""
        if name == "contact":
            points: np.ndarray = self[member].kept.contact
            return points
        system, (gamma, M) = system_of(self.ensemble.system, self.ensemble.members[member]), (rows[:, :3], rows[:, 3:6])
        if name == "omega":
            rates: np.ndarray = system._omega_along(gamma, M)
            return rates
        return attitude.quaternions(system._attitude_along(gamma, M))

    def _frame(self, quantities: Iterable[str] | None) -> Frame:
        dims, coordinates = self._dimensions()
        rows = statuses(self.status, self._partial, self._rows.shape[1])
        words = ("refused", *WORDS)
        many = self.ensemble
        variables = {
            **columns(dims, {name: getattr(self, name) for name in checked(quantities)}),
            "tau": Column(dims, self.tau, "s", "time of the flow, dτ = g dt"),
            "status": status_column(dims, rows, self.reasons),
            "way": Column(dims[:1], (self._ways + 1).astype(np.int32), "1", "what has computed the member", (), words),
            "inertia": Column((dims[0], "axis"), many.inertia, "kg m2", "principal moments of inertia", AXES),
            "d": Column(dims[:1], many.d, "kg m2", "mass times square of the radius"),
        }
        about_all = about(many.system, tilted=int(many.tilted), reasons=reasons_text(self.reasons))
        return Frame(dims, coordinates, variables, about_all)

    def _of_some(self, places: np.ndarray) -> dict[str, Any]:
        partial = {i: self._partial[k] for i, k in enumerate(places.tolist()) if k in self._partial}
        return {"_rows": self._rows[places], "_ways": self._ways[places], "_partial": partial}

    def _value(self) -> tuple[object, ...]:
        # NaN, which is unequal to itself, is replaced in refused rows, so that equal results compare as equal
        rows = tuple(np.nan_to_num(self._rows).ravel().tolist())
        return self.ensemble, self._times.shape, tuple(self._times.ravel().tolist()), rows, tuple(self.status.tolist())


def joined(every: tuple[Trajectories, ...], times: np.ndarray) -> Trajectories:
    """All members of ``every``, one after the other, at ``times``."""
    numbers, reasons = common_reasons([part.reasons for part in every])
    status, partial, begin = [], {}, 0
    for mine, part in zip(numbers, every, strict=True):
        status.append(mine[part.status])
        partial.update({begin + k: mine[rows] for k, rows in part._partial.items()})
        begin += len(part)
    first = every[0]
    ensemble = replaced(first.ensemble, members=np.concatenate([part.ensemble.members for part in every]))
    ways = np.concatenate([part._ways for part in every])
    outcome = Outcome(np.concatenate(status), ways, reasons, partial)
    return type(first)(ensemble, times, np.concatenate([part._rows for part in every]), outcome)
