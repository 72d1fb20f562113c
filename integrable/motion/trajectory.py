"""The states of a run, computed when they are asked for."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from integrable.moving_point.setup import Setup
from integrable.phase.body import Integrals
from integrable.phase.space import PhaseSpace
from integrable.phase.state import State
from jacobian.immutable import Immutable, Record, read_only

Times = np.ndarray[tuple[int], np.dtype[Any]]
"""Shape (N,)."""
Vectors = np.ndarray[tuple[int, int], np.dtype[Any]]
"""Shape (N, 3), or as said."""
Matrices = np.ndarray[tuple[int, int, int], np.dtype[Any]]
"""Shape (N, 3, 3)."""


class Motion(Immutable):
    """The motion through one state, as its results see it: base of :class:`integrable.motion.flow.Flow`."""

    system: PhaseSpace
    state: State

    def __init__(self, system: PhaseSpace, state: State) -> None:
        raise NotImplementedError

    def at(self, times: Any) -> Trajectory:
        """The states at physical times."""
        raise NotImplementedError

    def at_tau(self, tau: Any) -> Trajectory:
        """The states at values of the flow's own time."""
        raise NotImplementedError

    def physical_time(self, tau: Any) -> Times:
        """t(τ) for an array of τ."""
        raise NotImplementedError

    @cached_property
    def setup(self) -> Setup:
        """What the motion is computed from."""
        raise NotImplementedError

    def _contact_points(self, run: Trajectory) -> np.ndarray:
        """What :attr:`Trajectory.contact` is."""
        raise NotImplementedError

    @cached_property
    def contact_on_torus(self) -> Any:
        """The same far from the start, or None; kept from one run to the next."""
        raise NotImplementedError

    @cached_property
    def _torus(self) -> Any:
        """Random access to the states, or None."""
        raise NotImplementedError


class Trajectory(Record):
    """States at given times; every quantity is computed on first use.

    ``times`` has shape (N,), vectors (N, 3); floats give float64 arrays, multiprecision object arrays of mpf. ``tau``
    is the time of the flow, dτ = g dt. ``report`` is the report of a scene's run, or None; ``error`` and ``digits`` are
    what :meth:`integrable.motion.flow.Flow.certify` found, else None. No array can be written to: ``.copy()`` can.
    """

    def __init__(self, flow: Motion, times: np.ndarray | None, tau: np.ndarray, rows: np.ndarray) -> None:
        self.flow = flow
        self._times = times
        self.tau = tau
        # γ and M side by side, shape (N, 6)
        self._rows = rows
        self.report: Any = None
        # set by Flow.certify
        self.error: np.ndarray | None = None
        self.digits: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self._rows)

    def __repr__(self) -> str:
        return f"<Trajectory of {len(self)} states of {self.flow.system!r}>"

    @cached_property
    def times(self) -> Times:
        """Physical times t, shape (N,)."""
        return read_only(self.flow.physical_time(self.tau)) if self._times is None else self._times

    @property
    def given_in_tau(self) -> bool:
        """Whether the states were asked for at values of τ."""
        return self._times is None

    @property
    def gamma(self) -> Vectors:
        """The vertical γ in the body frame, shape (N, 3)."""
        return self._rows[:, :3]

    @property
    def M(self) -> Vectors:
        """The angular momentum M about the contact point in the body frame, shape (N, 3)."""
        return self._rows[:, 3:]

    @cached_property
    def omega(self) -> Vectors:
        """The angular velocity ω in the body frame, shape (N, 3)."""
        from integrable.phase import attitude

        return read_only(attitude.angular_velocities(self.flow.system.body, self.gamma, self.M)[0])

    @cached_property
    def attitude(self) -> Matrices:
        """Rotation matrices from the body frame to space, shape (N, 3, 3): rows are the axes of space in the body
        frame, z = γ vertical, x along the horizontal part of M, which rests in space
        (:mod:`integrable.phase.attitude`).
        """
        from integrable.phase import attitude

        return read_only(attitude.matrices(self.gamma, self.M))

    @cached_property
    def quaternion(self) -> Vectors:
        """The same rotations as unit quaternions (w, x, y, z) with w ≥ 0, shape (N, 4)."""
        from integrable.phase import attitude

        return read_only(attitude.quaternions(self.attitude))

    @cached_property
    def contact(self) -> Vectors:
        """(x, y) of the point where the ball touches the plane, in the axes of :attr:`attitude`, shape (N, 2).

        (0, 0) at t = 0; in the unit of the ball's radius, or in radii if d alone was given. NotRepresentable for a body
        that does not roll (:mod:`integrable.motion.contact`).
        """
        return read_only(self.flow._contact_points(self))

    @cached_property
    def integrals(self) -> Integrals:
        """C1, C2, H1, H2 along the run, each of shape (N,)."""
        g, m = self.gamma, self.M
        return Integrals(
            *(read_only(np.sum(x * y, axis=1)) for x, y in ((g, g), (g, m), (self.omega, m), (m, m))),
        )
