"""The constants of the motion of a body with two or three equal moments, in wide numbers.

The formulas are in :mod:`integrable.motion.symmetric`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from integrable.phase.body import Body, Vector
from integrable.phase.state import State, onto_constraints
from integrable.phase.upright import ChaplyginTransformation
from jacobian.element import Real
from jacobian.fields.multiprecision import Mpf
from jacobian.fields.protocol import Field

if TYPE_CHECKING:
    from integrable.phase.space import PhaseSpace


def symmetry_axis(inertia: Vector) -> int | None:
    """The index of the symmetry axis: the moments of the two other axes are equal. None if all three moments differ."""
    # this is written out for speed, since every new flow calls it twice
    x, y, z = inertia
    return 0 if y == z else 1 if z == x else 2 if x == y else None


class Swing(NamedTuple):
    """The constants r, r₃, δ, (a₃ − a)/a, |M|, κ, A, μ, Ω of the formulas, and θ and φ at the start."""

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
    def of(body: Body, gamma: Vector, M: Vector) -> Swing:
        """The constants of the motion through an upright state. The axes are in the order (equal, equal, other)."""
        K: Any = body.field
        (a, _, a3), (r, _, r3), (g1, g2, g3), (m1, m2, m3) = body.a, body.contact, gamma, M
        ratio = (body.inertia[0] - body.inertia[2]) * a3
        delta = body.d * a * ratio
        momentum, across = K.sqrt(K.dot(M, M)), g1 * m2 - g2 * m1
        square = K.dot(body.contact, [x * x for x in gamma])
        spin = m3 * m3 / square
        rest = momentum * momentum - spin * delta
        kappa2, size2 = spin * r3 / rest, max((m1 * m1 + m2 * m2 - spin * delta * g3 * g3) / rest, K.zero)
        mu = r3 + delta * kappa2 if delta > 0 else r - delta * size2
        kappa = K.sqrt(kappa2) * (1 if m3 > 0 else -1)
        rate = a * momentum * K.sqrt(r3 / mu)
        atan2 = K.context.atan2
        # A, ``size``, follows from γ₃ and its rate, since the difference in size2 loses all digits for a motion about
        # the axis
        size = K.sqrt(g3 * g3 + (a * across / rate) ** 2)
        theta = atan2(g3, a * across / rate) if size else K.zero
        swing = Swing(r, r3, delta, ratio, momentum, kappa, size, mu, rate, theta, K.zero)
        # φ turns the point of the ellipse of γ or of M, whichever is farther from the axis, to the given one
        c, s = K.context.cos(theta), K.context.sin(theta)
        before_gamma, before_M = swing.ellipse(c, s)
        found, before = ((g1, g2), before_gamma) if c * c + kappa2 * s * s >= 0.5 else ((m1, m2), before_M)
        return swing._replace(phi=atan2(found[1], found[0]) - atan2(before[1], before[0]))

    @property
    def spread(self) -> Real:
        """The range δA² of g⁻² = r − δA² sin²θ."""
        return self.delta * self.size * self.size

    @property
    def spin(self) -> Real:
        """The constant gM₃."""
        return self.momentum * self.kappa / _sqrt(self.mu)

    @property
    def factors(self) -> tuple[Real, Real]:
        """The factors of the elliptic integrals F and Π in −φ."""
        first = self.kappa * self.ratio / _sqrt(self.r * self.r3)
        return first, self.kappa * _sqrt(self.r3 / self.r)

    def clock(self, upright: Upright) -> tuple[Real, Real]:
        """The pair (Ω', ε) in Ω't = θ − θ₀ − ε(G(cos θ) − G(cos θ₀)), G(c) = ∫_0^c du/√(μ + δA²u²).

        t is the time of the user's body; ε = 0 if its state is not tilted.
        """
        alpha, beta = upright.clock
        return self.rate / alpha, beta * self.spin * upright.body.a[0] * self.ratio * self.size / alpha

    def ellipse(self, c: Real, s: Real) -> tuple[list[Real], list[Real]]:
        """γ and M before the turn by φ, at the phase θ with cos θ = c and sin θ = s."""
        root3, spread = _sqrt(self.r3), self.spread
        slow = _sqrt(self.mu + spread * c * c if self.delta > 0 else self.r - spread * s * s)
        lean, scale = self.kappa * self.delta * s / (slow + root3), self.momentum / _sqrt(self.mu)
        across = scale * self.size
        M = [-across * lean * c, across * (root3 + lean * self.kappa * s), scale * self.kappa * slow]
        return [c, -self.kappa * s, self.size * s], M


def _sqrt(x: Mpf) -> Mpf:
    """The square root of an mpf, with its own digits."""
    return x.context.sqrt(x)


class Upright(NamedTuple):
    """A body and a state with (γ, M) = 0 over the field K, |γ| = 1 to the last digit, with axes in the order (equal,
    equal, other).

    ``columns`` are the positions of the user's axes, ``clock`` is the pair (α, β) of dt/dt̃ = α + βñ, ñ = g̃²(γ̃, AM̃),
    with tildes for this body, and ``matrix`` maps back to the tilted body.
    """

    body: Body
    gamma: Vector
    M: Vector
    clock: tuple[Real, Real]
    matrix: tuple[Real, ...]
    columns: list[int]

    @staticmethod
    def of(system: PhaseSpace, state: State, K: Field) -> Upright:
        """The upright body and state that correspond to ``state``, by Chaplygin's transformation if it is tilted."""
        axis = symmetry_axis(system.inertia)
        assert axis is not None
        order = [(axis + 1) % 3, (axis + 2) % 3, axis]
        inertia, gamma, M = (tuple(v[i] for i in order) for v in (system.inertia, *state.vectors))
        body = Body.make(inertia, system.d, K)
        state = onto_constraints(body, State(gamma, M, tilted=state.tilted))
        clock, matrix = (K.one, K.zero), (K.one, K.zero, K.zero, K.one)
        if state.tilted:
            tilt = ChaplyginTransformation.of(body, *state.vectors)
            body, clock, matrix = tilt.upright, tilt.rate(), tilt.inverse_matrix()
            state = onto_constraints(body, State(*tilt.apply_vectors(*state.vectors)))
        return Upright(body, *state.vectors, clock, matrix, [order.index(i) for i in range(3)])
