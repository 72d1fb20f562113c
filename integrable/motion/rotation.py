"""Rotations about a principal axis, M along it and γ across it: in closed form, at any time.

There (γ, AM) = 0, so that ω = a_iM is constant and γ turns by θ = θ₀ + a_i|M|t, γ_j + iγ_k = e^(∓iθ), also about the
middle axis, where every other motion is lost. With g⁻² = r_j cos²θ + r_k sin²θ, r = 1 − da, τ is an elliptic integral
of the first kind.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.motion.symmetric import NEAR, PI, long, turns_of
from integrable.moving_point.elliptic_integrals import amplitude, first_kind_swing
from integrable.phase.body import Body
from integrable.phase.precisions import SET_UP_DIGITS
from integrable.torus.survey import complete
from jacobian import MP

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State


def rotation_axis(state: State) -> int | None:
    """The axis i with M along it and γ_i = 0, all exactly; None where there is none."""
    x, m = state.gamma, state.M
    return next((i for i in range(3) if m[i] != 0 and m[i - 1] == m[i - 2] == x[i] == 0), None)


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
        self._modulus, self._missing = long(modulus), long(less / (1 + modulus))
        quarter = complete(modulus, K.one, K.one, K.one, pi, NEAR)
        self._quarter, self._speed = long(quarter), long(root * rate)
        self._pace = long(2 * quarter / (pi * root))
        count = int(K.context.nint(start / pi))
        self._start = self._swing(np.array([long(start - count * pi)]))
        origin = K.coerce(float(self._start[0])) + K.coerce(float(self._start[0] - float(self._start[0])))
        self._flow_turning = root * rate / (4 * quarter), start / (2 * pi) + origin / (4 * quarter)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        half, x = _halves(turns_of(times, *self._turning)[1])
        if not self._rolls:
            return self._rows(half, x), times
        tau = times * self._pace + (self._swing(x) - self._start) / self._speed
        return self._rows(half, x), tau.astype(float)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        return self._rows(*self._at_tau(tau)) if self._rolls else self.at(tau)[0]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        if not self._rolls:
            return tau
        _, x = self._at_tau(tau)
        found: np.ndarray = (tau - (self._swing(x) - self._start) / self._speed) / self._pace
        return found.astype(float)

    def _at_tau(self, tau: np.ndarray) -> tuple[Any, Any]:
        half, part = _halves(turns_of(tau, *self._flow_turning)[1])
        v, k = part * 2 * self._quarter / PI, self._modulus
        x = amplitude(v, k) if k <= 1 else PI / 2 - amplitude(k * (self._quarter - v), 1 / k)
        # a step of Newton, for what the transformations have rounded
        first = 2 * self._quarter / PI * x + self._swing(x)
        return half, x - (first - v) * np.sqrt(np.cos(x) ** 2 + (k * np.sin(x)) ** 2)

    def _swing(self, x: Any) -> Any:
        """F(x) − (2K/π)x."""
        return first_kind_swing(x, self._modulus, self._missing) if self._missing else 0 * x

    def _rows(self, half: Any, x: Any) -> np.ndarray:
        i, j, k = self._order
        rows, sign = np.zeros((len(x), 6)), 1 - 2 * (half % 2)
        rows[:, j], rows[:, k], rows[:, 3 + i] = sign * np.cos(x), -sign * np.sin(x), self._momentum
        return rows


def _halves(rest: Any) -> tuple[Any, Any]:
    """(half turns, x) of a part of a turn: π·(half turns) + x is its angle, |x| ≤ π/2."""
    half = np.rint(2 * rest)
    return half, PI * (2 * rest - half)
