"""The constants of a motion in closed form, in long numbers. The formulas are in :mod:`integrable.motion.symmetric`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import gmpy2

from integrable.moving_point.problem import SPARE_BITS, check, upright_motion
from integrable.phase.body import Vector, symmetry_axis
from integrable.phase.state import State, rotation_axis
from jacobian.element import Real
from jacobian.inexact.long_field import LongField

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace


class Swing(NamedTuple):
    """The constants r, r₃, δ, (a₃ − a)/a, |M|, κ, A, μ, Ω of :mod:`integrable.motion.symmetric`, and θ and φ at the
    start.
    """

    r: Real
    r3: Real
    delta: Real
    ratio: Real
    momentum: Real
    kappa: Real
    size: Real
    mu: Real
    rate: Real
    theta: Real
    phi: Real

    @staticmethod
    def of(upright: Upright) -> Swing:
        """The constants of the motion through an upright state."""
        (a, turning, _), (r, _, r3), ratio = upright.a, upright.contact, upright.ratio
        (g1, g2, g3), (m1, m2, m3) = upright.gamma, upright.M
        delta = upright.d * a * ratio
        h2, across = m1 * m1 + m2 * m2 + m3 * m3, turning * (g1 * m2 - g2 * m1)
        # for a rotation about axis 2 ``momentum`` has the sign of M₂, so that φ = 0
        momentum = m2 if m1 == m3 == 0 else gmpy2.sqrt(h2)
        spin = m3 * m3 / (r * (g1 * g1 + g2 * g2) + r3 * g3 * g3)
        rest = h2 - spin * delta
        kappa2, size2 = spin * r3 / rest, max((m1 * m1 + m2 * m2 - spin * delta * g3 * g3) / rest, 0 * rest)
        mu = r3 + delta * kappa2 if delta > 0 else r - delta * size2
        kappa = gmpy2.sqrt(kappa2) * (1 if m3 > 0 else -1)
        rate = turning * momentum * gmpy2.sqrt(r3 / mu)
        # A, ``size``, is computed from γ₃ and its rate: near a rotation about the axis, the difference in size2 loses
        # all digits
        size = gmpy2.sqrt(g3 * g3 + (across / rate) ** 2)
        theta = gmpy2.atan2(g3, across / rate)
        swing = Swing(r, r3, delta, ratio, momentum, kappa, size, mu, rate, theta, 0 * theta)
        # φ is the angle about axis 3 from the vector that :meth:`ellipse` returns to that of the start: for γ, or for M
        # where γ is near the axis
        c, s = gmpy2.cos(theta), gmpy2.sin(theta)
        before_gamma, before_M = swing.ellipse(c, s)
        near_axis = c * c + kappa2 * s * s < 0.5
        (x, y), (before_x, before_y, _) = ((m1, m2), before_M) if near_axis else ((g1, g2), before_gamma)
        return swing._replace(phi=gmpy2.atan2(before_x * y - before_y * x, before_x * x + before_y * y))

    @property
    def spread(self) -> Real:
        """The range δA² of g⁻² = r − δA² sin²θ."""
        return self.delta * self.size * self.size

    @property
    def spin(self) -> Real:
        """The constant gM₃."""
        return self.momentum * self.kappa / gmpy2.sqrt(self.mu)

    @property
    def factors(self) -> tuple[Real, Real]:
        """The factors of the elliptic integrals F and Π in −φ (:mod:`integrable.motion.symmetric`)."""
        first = self.kappa * self.ratio / gmpy2.sqrt(self.r * self.r3)
        return first, self.kappa * gmpy2.sqrt(self.r3 / self.r)

    def clock(self, upright: Upright) -> tuple[Real, Real]:
        """The pair (Ω', ε) in Ω't = θ − θ₀ − ε(G(cos θ) − G(cos θ₀)), G(c) = ∫_0^c du/√(μ + δA²u²).

        t is the time of the user's body; ε = 0 if its state is not tilted.
        """
        alpha, beta = upright.clock
        return self.rate / alpha, beta * self.spin * upright.a[0] * self.ratio * self.size / alpha

    def ellipse(self, c: Real, s: Real) -> tuple[Vector, Vector]:
        """γ and M at the phase θ, cos θ = c and sin θ = s, as they are where φ = 0."""
        root3, spread = gmpy2.sqrt(self.r3), self.spread
        slow = gmpy2.sqrt(self.mu + spread * c * c if self.delta > 0 else self.r - spread * s * s)
        lean, scale = self.kappa * self.delta * s / (slow + root3), self.momentum / gmpy2.sqrt(self.mu)
        across = scale * self.size
        M = -across * lean * c, across * (root3 + lean * self.kappa * s), scale * self.kappa * slow
        return (c, -self.kappa * s, self.size * s), M


class Upright(NamedTuple):
    """A body and a state with (γ, M) = 0, |γ| = 1 to the last digit, with axes in the order (equal, equal, other). If
    all moments differ, the motion is a rotation about the second axis.

    ``a``, ``contact`` and ``d`` are a_i, 1 − d·a_i and d of the body, ``ratio`` is (a₃ − a₁)/a₁. ``columns`` are the
    positions of the user's axes, ``clock`` is the pair (α, β) of dt/dt̃ = α + βñ, ñ = g̃²(γ̃, AM̃), with tildes for this
    body, and ``matrix`` maps back to the tilted body.
    """

    a: Vector
    contact: Vector
    d: Real
    ratio: Real
    gamma: Vector
    M: Vector
    clock: tuple[Real, Real]
    matrix: tuple[Real, ...]
    columns: list[int]

    @staticmethod
    def of(system: PhaseSpace, state: State, K: LongField) -> Upright:
        """The upright body and state that correspond to ``state``, by Chaplygin's transformation if it is tilted."""
        last, turning = symmetry_axis(system.inertia), rotation_axis(state)
        if last is None:
            assert turning is not None
            last = (turning + 1) % 3
        order, tilted = [(last + 1) % 3, (last + 2) % 3, last], state.tilted and turning is None
        inertia, gamma, M = ([K.coerce(v[i]) for i in order] for v in (system.inertia, *state.vectors))
        check(gamma, M, tilted, K.bits - SPARE_BITS)
        offset = K.coerce(system.d)
        a, (contact, d), start, momentum, (k, s, p, rise), _ = upright_motion((*inertia, offset, *gamma, *M), tilted)
        across, ratio = s * s / p, (inertia[0] - inertia[2]) * a[2]
        clock, matrix = (s, offset * k * across), (across, -(s * k), across * rise, s)
        return Upright(a, contact, d, ratio, start, momentum, clock, matrix, [order.index(i) for i in range(3)])
