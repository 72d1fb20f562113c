"""Rotations about a principal axis, M along it and γ across it: in closed form, at any time. Then (γ, AM) = 0, so ω =
a_iM is constant and γ turns by θ = θ₀ + a_i|M|t, γ_j + iγ_k = e^(∓iθ), also about the unstable middle axis. With g⁻² =
r_j cos²θ + r_k sin²θ, r = 1 − da, τ is an elliptic integral of the first kind.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.motion.symmetric import NEAR, PI, half_turns, long, turns_of, wide
from integrable.motion.symmetric_precise import ClosedForm
from integrable.moving_point.elliptic_integrals import FirstKind, complete
from integrable.phase.body import Body
from integrable.phase.precisions import SET_UP_DIGITS
from integrable.phase.state import State, rotation_axis
from jacobian import MP

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace


class PrincipalRotation:
    """γ and M at any times, in floats, from a state with a :func:`rotation_axis`; PrecisionLoss beyond 2^50 turns."""

    way = "closed form"

    def __init__(self, system: PhaseSpace, state: State) -> None:
        K = MP(SET_UP_DIGITS)
        axis = rotation_axis(state)
        assert axis is not None
        self._order = i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
        self._momentum, self._rolls = float(state.M[i]), system.body.rolls
        body, (y, z) = Body.make(system.inertia, system.d, K), (K.coerce(state.gamma[n]) for n in (j, k))
        pi, start = K.context.pi, K.context.atan2(-z, y)
        rate = body.a[i] * K.coerce(state.M[i])
        self._turning = rate / (2 * pi), start / (2 * pi)
        root = K.sqrt(body.contact[j])
        modulus = K.sqrt(body.contact[k]) / root
        less = body.d * (body.inertia[j] - body.inertia[k]) * body.a[j] * body.a[k] / body.contact[j]
        quarter = complete(modulus, K.one, K.one, K.one, pi, NEAR)
        self._first_kind = FirstKind(long(modulus), long(less / (1 + modulus)), long(quarter))
        self._speed, self._pace = long(root * rate), long(2 * quarter / (pi * root))
        count = int(K.context.nint(start / pi))
        self._start = self._first_kind.swing(np.array([long(start - count * pi)]))
        self._flow_turning = root * rate / (4 * quarter), start / (2 * pi) + wide(K, self._start[0]) / (4 * quarter)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        half, part = half_turns(turns_of(times, *self._turning)[1])
        x = PI * part
        if not self._rolls:
            return self._rows(half, x), times
        tau = times * self._pace + (self._first_kind.swing(x) - self._start) / self._speed
        return self._rows(half, x), tau.astype(float)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        return self._rows(*self._at_tau(tau)) if self._rolls else self.at(tau)[0]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        if not self._rolls:
            return tau
        _, x = self._at_tau(tau)
        found: np.ndarray = (tau - (self._first_kind.swing(x) - self._start) / self._speed) / self._pace
        return found.astype(float)

    def _at_tau(self, tau: np.ndarray) -> tuple[Any, Any]:
        half, part = half_turns(turns_of(tau, *self._flow_turning)[1])
        return half, self._first_kind.inverse(2 * self._first_kind.quarter * part)

    def _rows(self, half: Any, x: Any) -> np.ndarray:
        i, j, k = self._order
        rows, sign = np.zeros((len(x), 6)), 1 - 2 * (half % 2)
        rows[:, j], rows[:, k], rows[:, 3 + i] = sign * np.cos(x), -sign * np.sin(x), self._momentum
        return rows


class RotationForm(ClosedForm):
    """The same formulas in the numbers of a wide field K."""

    def __init__(self, system: PhaseSpace, state: State, K: Any) -> None:
        axis = rotation_axis(state)
        assert axis is not None
        self._order = i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
        body, self._rolls = Body.make(system.inertia, system.d, K), system.body.rolls
        super().__init__(K.context, body.contact[k] / body.contact[j], not self._rolls)
        self._momentum = K.coerce(state.M[i])
        self._rate = body.a[i] * self._momentum
        self._flow_rate = self._rate * K.sqrt(body.contact[j])
        self._start = K.context.atan2(-K.coerce(state.gamma[k]), K.coerce(state.gamma[j]))
        self._origin = self._integral(self._start)[0]

    def turns(self, t: Any, of_flow: bool) -> Any:
        pi, period = self._half
        return abs(t * (self._flow_rate * pi / period if of_flow else self._rate)) + 1

    def at(self, t: Any) -> tuple[list[Any], Any]:
        theta = self._start + self._rate * t
        tau = (self._integral(theta)[0] - self._origin) / self._flow_rate
        return self._row(theta), tau

    def at_tau(self, tau: Any) -> tuple[list[Any], Any]:
        theta = self._inverse(self._origin + self._flow_rate * tau)
        return self._row(theta), (theta - self._start) / self._rate

    def _row(self, theta: Any) -> list[Any]:
        i, j, k = self._order
        row = [0 * theta] * 6
        row[j], row[k], row[3 + i] = self.context.cos(theta), -self.context.sin(theta), self._momentum
        return row
