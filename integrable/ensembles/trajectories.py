"""The states of many motions at given times, and the outcome for each."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np

from integrable.ensembles.bodies import motion_of, system_of
from integrable.ensembles.members import times_of
from integrable.ensembles.runs import Runs
from integrable.files.frame import Column, Frame
from integrable.files.quantities import QUANTITIES, checked, columns
from integrable.motion.trajectory import Trajectory
from integrable.phase import attitude
from jacobian.immutable import read_only

__all__ = ["Trajectories"]


class Trajectories(Runs):
    """States of K bodies at N times each: γ, M and τ. ``runs[k]`` is one member, a
    :class:`integrable.motion.trajectory.Trajectory`. ``ways`` are from :data:`integrable.motion.trajectory.WAYS`.
    """

    _shared = ("system", "tilted")

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

    def _one(self, member: int) -> Trajectory:
        many = self.ensemble
        flow = motion_of(many.system, many.members[member], many.tilted)
        way = self._ways[member]
        if way < 0:
            raise self._refusal(member)
        refused = self.status[member] > 0
        status, reasons = (self.row_status(member), self.reasons) if refused else (None, ("",))
        rows, tau = np.array(self._rows[member, :, :6]), np.array(self._rows[member, :, 6])
        return Trajectory(flow, times_of(self._times, member), tau, rows, self._words[way], status, reasons)

    def _along(self, name: str) -> np.ndarray:
        """The values of the quantity ``name`` at every state, NaN in refused rows."""
        parts = len(QUANTITIES[name].parts)
        found = np.full((*self._rows.shape[:2], parts), np.nan)
        for k in np.flatnonzero(self._ways >= 0).tolist():
            had = self.row_status(k) == 0
            found[k, had] = self._of_member(name, k, self._rows[k, had])
        return found

    def _of_member(self, name: str, member: int, rows: np.ndarray) -> np.ndarray:
        """The attribute ``name`` of a member's Trajectory; a flow is made only if the attribute needs one."""
        if name == "contact":
            points: np.ndarray = self[member].kept.contact
            return points
        system, (gamma, M) = system_of(self.ensemble.system, self.ensemble.members[member]), (rows[:, :3], rows[:, 3:6])
        if name == "omega":
            rates: np.ndarray = system._omega_along(gamma, M)
            return rates
        return attitude.quaternions(system._attitude_along(gamma, M))

    def _frame(self, quantities: Iterable[str] | None) -> Frame:
        dims, contents = self._dims, self.ensemble._contents
        variables = {
            **columns(dims, {name: getattr(self, name) for name in checked(quantities)}),
            "tau": Column(dims, self.tau, "s", "time of the flow, dτ = g dt"),
            **{name: contents.parameters[name] for name in ("inertia", "d")},
        }
        return self._frame_of(variables, contents.attributes)
