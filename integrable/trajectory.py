"""The states of a run, computed when they are asked for."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.body import Integrals

if TYPE_CHECKING:
    from integrable.flow import Flow


class Trajectory:
    """States at given times; every quantity is computed on first use.

    ``times`` has shape (N,), vectors (N, 3); floats give float64 arrays, multiprecision object arrays of mpf. ``tau``
    is the time of the flow, dτ = g dt. ``report`` is the report of a scene's run, or None.
    """

    def __init__(self, flow: Flow, times: np.ndarray | None, tau: np.ndarray, points: np.ndarray) -> None:
        self.flow = flow
        self._times = times
        self.tau = self._rounded(tau)
        self._points = points
        self.report: Any = None

    def __len__(self) -> int:
        return len(self._points)

    def __repr__(self) -> str:
        return f"<Trajectory of {len(self)} states of {self.flow.system!r}>"

    @cached_property
    def times(self) -> np.ndarray:
        """Physical times t, shape (N,)."""
        if self._times is None:
            return self._rounded(self.flow.physical_time(self.tau))
        return self._times

    @cached_property
    def gamma(self) -> np.ndarray:
        """The vertical γ in the body frame, shape (N, 3)."""
        return self._rounded(self._original[0])

    @cached_property
    def M(self) -> np.ndarray:
        """The angular momentum M about the contact point in the body frame, shape (N, 3)."""
        return self._rounded(self._original[1])

    @cached_property
    def _original(self) -> tuple[np.ndarray, np.ndarray]:
        """(γ, M) of the given body, which for a tilted state is not that of the divisor."""
        setup = self.flow.setup
        if setup.tilt is None:
            return self._upright_gamma, self._upright_M
        matrix = [setup.number(x) for x in setup.tilt.inverse_matrix()]
        g, m = self._upright_gamma, self._upright_M
        return matrix[0] * g + matrix[1] * m, matrix[2] * g + matrix[3] * m

    @cached_property
    def _upright_gamma(self) -> np.ndarray:
        return self._points[:, 4:7] / self._lengths[:, None]

    @cached_property
    def _upright_M(self) -> np.ndarray:
        sigma, nu = self._points[:, 4:7], self._points[:, 7:10]
        lean = np.sum(sigma * nu, axis=1) / self._lengths**2
        w = (nu - lean[:, None] * sigma) * self.flow.setup.momentum
        g = self._upright_gamma
        i, j = [1, 2, 0], [2, 0, 1]
        return w[:, i] * g[:, j] - w[:, j] * g[:, i]

    @cached_property
    def omega(self) -> np.ndarray:
        """The angular velocity ω in the body frame, shape (N, 3)."""
        body = self.flow.system.body
        a, contact = np.array(body.a), np.array(body.contact)
        moved = a * self.M
        if not body.rolls:
            return moved
        spin = body.d * np.sum(self.gamma * moved, axis=1) / np.sum(contact * self.gamma**2, axis=1)
        return moved + spin[:, None] * a * self.gamma

    @cached_property
    def attitude(self) -> np.ndarray:
        """Rotation matrices from the body frame to space, shape (N, 3, 3): rows are the axes of space in the body
        frame, z = γ vertical, x along the horizontal part of M, which rests in space (:mod:`integrable.attitude`).
        """
        from integrable import attitude

        return attitude.matrices(self.gamma, self.M)

    @cached_property
    def quaternion(self) -> np.ndarray:
        """The same rotations as unit quaternions (w, x, y, z) with w ≥ 0, shape (N, 4)."""
        from integrable import attitude

        return attitude.quaternions(self.attitude)

    @cached_property
    def integrals(self) -> Integrals:
        """C1, C2, H1, H2 along the run, each of shape (N,)."""
        g, m = self.gamma, self.M
        return Integrals(
            *(np.sum(x * y, axis=1) for x, y in ((g, g), (g, m), (self.omega, m), (m, m))),
        )

    def _rounded(self, values: np.ndarray) -> np.ndarray:
        """Multiprecision numbers without the guard digits of the flow."""
        if values.dtype != object:
            return values
        result: np.ndarray = np.frompyfunc(self.flow.system.field.coerce, 1, 1)(values)
        return result

    @cached_property
    def _lengths(self) -> np.ndarray:
        square = np.sum(self._points[:, 4:7] ** 2, axis=1)
        return square**0.5
