"""The motion of a body with three equal moments: it turns uniformly about a fixed axis, rolling or not.

With A = a·E, γ̇ = γ×ω and Ṁ = M×ω have (γ, M) and g constant, so ω = aM + d·a²·g²(γ, M)γ is constant too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.flow_setup import FLOAT_DIGITS
from jacobian import MP

if TYPE_CHECKING:
    from integrable.state import State
    from integrable.systems.system import System


class UniformRotation:
    """γ and M at any times, in floats, the angle reduced in extended precision."""

    def __init__(self, system: System, state: State) -> None:
        K = self._wide = MP(FLOAT_DIGITS)
        body = type(system.body).make(system.inertia, system.d, K)
        gamma, M = ([K.coerce(x) for x in v] for v in (state.gamma, state.M))
        length = K.sqrt(K.dot(gamma, gamma))
        gamma = [x / length for x in gamma]
        if not state.tilted:
            tilt = K.dot(gamma, M)
            M = [m - tilt * x for m, x in zip(M, gamma, strict=True)]
        omega = body.omega((gamma[0], gamma[1], gamma[2]), (M[0], M[1], M[2]))
        self._rate = K.sqrt(K.dot(omega, omega))
        axis = [x / self._rate for x in omega]
        # dτ/dt = g
        self._pace = 1 / K.sqrt(body.contact[0])
        self._rows = [self._parts(axis, v) for v in (gamma, M)]

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        K = self._wide
        return self._turned([K.coerce(t) for t in times.tolist()]), times * float(self._pace)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        return self._turned([self._wide.coerce(t) / self._pace for t in tau.tolist()])

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        return tau / float(self._pace)

    def _parts(self, axis: Any, v: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The parts of a vector along the axis and across it, and across both."""
        K = self._wide
        height = K.dot(axis, v)
        along = [height * x for x in axis]
        across = [x - y for x, y in zip(v, along, strict=True)]
        both = [across[i - 2] * axis[i - 1] - across[i - 1] * axis[i - 2] for i in range(3)]
        first, second, third = (np.array([float(x) for x in part]) for part in (along, across, both))
        return first, second, third

    def _turned(self, times: list[Any]) -> np.ndarray:
        angles = [self._rate * t for t in times]
        cosine, sine = (
            np.array([float(function(x)) for x in angles])[:, None]
            for function in (self._wide.context.cos, self._wide.context.sin)
        )
        return np.hstack([along + cosine * across + sine * both for along, across, both in self._rows])
