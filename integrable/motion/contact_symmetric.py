"""The path of a rolling body with two equal moments, as a function of its state.

Axis 3 is the symmetry axis, q_i = 1 − d·a_i, and I, a, q belong to the other two axes. Let Δ = (I_3 − I)a·a_3, w = γ ×
M, m = |w|, c = (γ, M) and n = (γ, ω). Then γ̇_3 = a·w_3, M_3 = K/g − (dc/I)γ_3 with K constant (Routh 1905, article
244), and ẋ is a total derivative:

    x = −(Δ·q·K/(a·m)) ∫ dγ_3/√(q + d·Δ·γ_3²).

The bounded part of y is c/m times ∫(n − mean) dt = ∫ñ dt̃/p, ñ = g̃²(γ̃, AM̃), on the body of Chaplygin's
transformation (tildes), where γ̃_3 oscillates harmonically in t̃. With K̃ = M̃_3g̃, h = H̃2 + d̃ΔK̃² and z = −w̃_3/√h,
which is dγ̃_3/dφ for the phase φ,

    ∫ñ dt̃ = −(Δ·K̃/(a·√h)) ∫ dz/√(q̃_3H̃2/h − d̃Δz²).

The square roots in the two integrands are 1/g and 1/g̃.
"""

from __future__ import annotations

import numpy as np

from integrable.motion.trajectory import BodyMotion
from integrable.phase.body import cross, symmetry_axis
from integrable.phase.brackets import over
from integrable.phase.state import onto_constraints
from jacobian import RR
from jacobian.element import Real


class SymmetricPath:
    """The bounded part of the path (x, y), in radii, as a function of the state. Constants are computed in wide
    numbers.
    """

    def __init__(self, flow: BodyMotion) -> None:
        wide, tilt, self._field = flow.setup.wide, flow.setup.tilt, flow.system.field
        system = over(flow.system, wide)
        state, body = onto_constraints(system, flow.state), system.body
        gamma, M = state.vectors
        axis = symmetry_axis(body.inertia)
        assert axis is not None
        self._axis = i = axis
        other, a = body.inertia[i - 1], body.a[i - 1]
        difference = (body.inertia[i] - other) * a * body.a[i]
        w, c = cross(wide, gamma, M), wide.dot(gamma, M)
        routh = (M[i] + body.d * c / other * gamma[i]) / wide.sqrt(body.conformal(gamma))
        length = wide.sqrt(wide.dot(w, w))
        factor, lean = -difference * body.contact[i - 1] * routh / (a * length), c / length
        self._along: tuple[Real, Real, Real] = self._numbers(factor, body.d * difference, body.contact[i - 1])
        self._contact = np.array(self._numbers(*body.contact))

        k, s, p = (tilt.k, tilt.s, tilt.p) if tilt else (wide.zero, wide.one, wide.one)
        body, (gamma, M) = (tilt.upright, tilt.apply_vectors(gamma, M)) if tilt else (body, (gamma, M))
        routh, h2 = M[i] / wide.sqrt(body.conformal(gamma)), wide.dot(M, M)
        height = h2 + body.d * difference * routh * routh
        factor = -lean * difference * routh / (a * p * wide.sqrt(height))
        self._spin: tuple[Real, Real, Real] = self._numbers(factor, -body.d * difference, body.contact[i] * h2 / height)
        self._upright = np.array(self._numbers(*body.contact))
        self._change = self._numbers(p, p * k, -p / (s * wide.sqrt(height)))

    def at(self, gamma: np.ndarray, M: np.ndarray) -> np.ndarray:
        """The bounded part of the contact point's (x, y), up to a constant, at states (γ, M): shape (N, 2)."""
        i = self._axis
        lean = self._change[0] * gamma + self._change[1] * M
        z = self._change[2] * np.cross(gamma, M)[:, i]
        slow, slow_upright = (
            np.sum(q * x * x, axis=1) ** 0.5 for q, x in ((self._contact, gamma), (self._upright, lean))
        )
        return np.stack(
            [self._primitive(*self._along, gamma[:, i], slow), self._primitive(*self._spin, z, slow_upright)], axis=1
        )

    def _primitive(self, factor: Real, slope: Real, constant: Real, x: np.ndarray, root: np.ndarray) -> np.ndarray:
        """The integral factor·∫_0^x dx/√(constant + slope·x²); ``root`` is the value of the square root at x."""
        scale = abs(slope) ** 0.5
        if self._field is RR:
            asinh, atan2 = np.arcsinh, np.arctan2
        else:
            context = self._field.context
            asinh, atan2 = np.frompyfunc(context.asinh, 1, 1), np.frompyfunc(context.atan2, 2, 1)
        # x·scale and ``root`` are √constant times the sine and cosine of the arc: atan2 keeps digits near a right angle
        arc = asinh(x * (scale / constant**0.5)) if slope > 0 else atan2(x * scale, root)
        return factor / scale * arc

    def _numbers(self, x: Real, y: Real, z: Real) -> tuple[Real, Real, Real]:
        number = float if self._field is RR else self._field.coerce
        return number(x), number(y), number(z)
