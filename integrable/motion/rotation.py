"""Rotations about principal axis i, with M along that axis and γ orthogonal to it: closed form, at any time.

Then (γ, AM) = 0, so ω = a_iM is constant, and γ_j = cos θ, γ_k = −sin θ with θ = θ₀ + a_iM_it and (i, j, k) cyclic.
This holds for the unstable middle axis too. With g⁻² = r_j cos²θ + r_k sin²θ, r_i = 1 − da_i, τ is an elliptic
integral of the first kind.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from integrable.motion.symmetric import complete_over, half_turns
from integrable.moving_point.arithmetic import LONG, LongDoubles, Multiprecision
from integrable.moving_point.elliptic_integrals import FirstKind
from integrable.phase.body import Body
from integrable.phase.state import State, rotation_axis
from jacobian.element import Real

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace


class PrincipalRotation:
    """γ and M at any times from a state with a :func:`rotation_axis`, in the arithmetic N of
    :mod:`integrable.moving_point.arithmetic`. PrecisionLoss for so many turns that N does not resolve a fraction of
    one.
    """

    way = "closed form"

    def __init__(self, system: PhaseSpace, state: State, N: LongDoubles | Multiprecision = LONG) -> None:
        self.numbers, K = N, N.field
        axis = rotation_axis(state)
        assert axis is not None
        self._order = i, j, k = axis, (axis + 1) % 3, (axis + 2) % 3
        gamma, M = state.vectors
        momentum, y, z = map(K.coerce, (M[i], gamma[j], gamma[k]))
        self._momentum, self._rolls = N.number(momentum), system.body.rolls
        body = Body.make(system.inertia, system.d, K)
        pi, start = K.context.pi, K.context.atan2(-z, y)
        rate = body.a[i] * momentum
        self._turning = rate / (2 * pi), start / (2 * pi)
        root = K.sqrt(body.contact[j])
        modulus = K.sqrt(body.contact[k]) / root
        less = body.d * (body.inertia[j] - body.inertia[k]) * body.a[j] * body.a[k] / body.contact[j]
        quarter = complete_over(K, modulus, K.one)
        self._first_kind = FirstKind(N, *map(N.number, (modulus, less / (1 + modulus), quarter)))
        self._speed, self._pace = N.number(root * rate), N.number(2 * quarter / (pi * root))
        count = int(K.context.nint(start / pi))
        self._start = self._first_kind.swing(np.array([N.number(start - count * pi)]))
        self._flow_turning = root * rate / (4 * quarter), start / (2 * pi) + N.wide(self._start[0]) / (4 * quarter)

    def radians(self, t: Real, of_flow: bool) -> Real:
        """The approximate angle in radians by which γ turns until t: a τ if ``of_flow``, else a physical time."""
        rate = self._flow_turning[0] if of_flow else self._turning[0]
        return 2 * self.numbers.field.context.pi * abs(t * rate) + 1

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The pair (γ and M side by side, τ) at physical times: shapes (N, 6) and (N,)."""
        N = self.numbers
        half, part = half_turns(N, N.turns_of(times, *self._turning)[1])
        x = N.pi * part
        if not self._rolls:
            return self._rows(half, x), times
        tau = times * self._pace + (self._first_kind.swing(x) - self._start) / self._speed
        return self._rows(half, x), N.result(tau)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M side by side at values of τ: shape (N, 6)."""
        return self._rows(*self._at_tau(tau)) if self._rolls else self.at(tau)[0]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """The physical times t(τ) at values of τ: shape (N,)."""
        if not self._rolls:
            return tau
        _, x = self._at_tau(tau)
        found: np.ndarray = (tau - (self._first_kind.swing(x) - self._start) / self._speed) / self._pace
        return self.numbers.result(found)

    def _at_tau(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        N = self.numbers
        half, part = half_turns(N, N.turns_of(tau, *self._flow_turning)[1])
        return half, self._first_kind.inverse(2 * self._first_kind.quarter * part)

    def _rows(self, half: np.ndarray, x: np.ndarray) -> np.ndarray:
        (i, j, k), N, sign = self._order, self.numbers, 1 - 2 * (half % 2)
        rows = np.zeros((len(x), 6)) + 0 * x[:, None]
        rows[:, j], rows[:, k], rows[:, 3 + i] = sign * N.cos(x), -sign * N.sin(x), self._momentum
        found: np.ndarray = N.result(rows)
        return found
