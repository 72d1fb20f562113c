"""The motion of a body in closed form, rolling or not, at any time: for two or three equal moments, or for a rotation
about a principal axis.

Axis 3 is the symmetry axis, a = a₁ = a₂, r_i = 1 − d·a_i, r = r₁ = r₂, δ = d(a₃ − a) = r − r₃ and (γ, M) = 0. Then gM₃
is constant, and γ₃ oscillates harmonically in *physical* time:

    γ₃ = A sin θ,  θ̇ = Ω = a|M|√(r₃/μ),  μ = r − δA²,  g⁻² = r − δγ₃².

gM₃ = |M|κ/√μ, where κ = ±√(1 − A²) has the sign of M₃. The other two components trace an ellipse turned by an angle
φ(t):

    γ₁ + iγ₂ = e^{iφ}(cos θ − iκ sin θ),  M₁ + iM₂ = e^{iφ}(A|M|/√μ)(i√r₃ + κδ sin θ(−cos θ + iκ sin θ)/(1/g + √r₃)),

    φ = φ₀ + arctan(κ tan θ) − κ√(r₃/r)·Π(A²; θ | m) − κ(a₃ − a)/(a√(r·r₃))·F(θ | m),  m = δA²/r,

with elliptic integrals Π of the third and F of the first kind; τ is proportional to F. F is the sum of its mean
(2K(m)/π)θ and an oscillation of order m. Where the moments are of very different sizes, φ turns much faster than θ, so
the mean is computed from the time since the start.

Chaplygin (1903) integrates the ball with theta functions; with equal moments his curve has a double point, and the
formulas above are the limit. The formulas are derived from γ̇ = γ×ω with the integral gM₃. For the free symmetric top
(d = 0), F and Π are elementary. Chaplygin's transformation maps a tilted state to an upright motion, whose time is t
plus a function of θ, so θ(t) solves an equation like Kepler's.

If M lies along a principal axis i and γ is orthogonal to it, (γ, AM) = 0 and ω = a_iM is constant, also for the
unstable middle axis. γ and M are then given by the formulas above with κ = 0, A = 1, constant φ and θ̇ = a_iM_i, where
axis 2 is i and the moments of the axes 1 and 3 may differ.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gmpy2
import numpy as np

from integrable.motion.swing import Swing, Upright
from integrable.moving_point.arithmetic import LONG, PASSES, LongDoubles, Multiprecision, step_inside
from integrable.moving_point.elliptic_integrals import FirstKind, carlson_j, complete
from integrable.phase.space import PhaseSpace
from jacobian.element import Real

if TYPE_CHECKING:
    from integrable.phase.state import State

# where |θ − θ₀| is below this, F(θ) − F(θ₀) is computed without cancellation
NEARBY = 0.75


class SymmetricFlow:
    """The :class:`integrable.phase.ways.Way` to γ and M from a state with a :func:`rotation_axis`, or of a body with a
    :func:`symmetry_axis`. N is an arithmetic of :mod:`integrable.moving_point.arithmetic`: long doubles, whose results
    are rounded to floats, or bare reals.

    Constants are computed in wide numbers. PrecisionLoss for so many turns that N does not resolve fractions of a turn.
    """

    way = "closed form"

    def __init__(self, system: PhaseSpace, state: State, N: LongDoubles | Multiprecision = LONG) -> None:
        self.numbers, self._rolls = N, system.body.rolls
        with N.field as K:
            upright = Upright.of(system, state, K)
            self._columns, self._matrix = upright.columns, [N.number(x) for x in upright.matrix]
            swing = Swing.of(upright)
            self._shape(swing)
            self._phases(swing, *swing.clock(upright))

    def _shape(self, swing: Swing) -> None:
        """Sets the constants of the formulas for γ and M, other than the phases θ and φ."""
        r, r3, delta, _, momentum, kappa, size, mu = swing[:8]
        number, sqrt = self.numbers.number, gmpy2.sqrt
        # at δ = 0, that is for d = 0 or three equal moments, φ is a linear function of θ; at κ = 0 it is constant
        self._flat = bool(delta == 0 or kappa == 0)
        self._kappa, self._size, self._root3 = map(number, (kappa, size, sqrt(r3)))
        self._delta, self._bulge, self._root_mu = map(number, (delta, swing.spread / mu, sqrt(mu)))
        # g⁻² = μ + |δ|A²cos²θ for δ > 0, otherwise r + |δ|A²sin²θ: a sum of positive numbers
        self._least, self._more = number(mu if delta > 0 else r), number(abs(swing.spread))
        self._spin, self._across = number(swing.spin), number(momentum * size / sqrt(mu))
        self._thin = number(r3 / r)
        first, third = swing.factors
        self._factors = number(first), number(third)

    def _phases(self, swing: Swing, rate: Real, kepler: Real) -> None:
        """Sets the rates of θ and φ in turns per unit of t and of τ, the turns of φ per half turn of θ due to
        arctan(κ tan θ) and Π, and the phases at the start.
        """
        N, number, pi, near = self.numbers, self.numbers.number, gmpy2.const_pi(), self.numbers.field.root_of_eps
        self._kepler, self._rate = number(kepler / (2 * pi)), rate / (2 * pi)
        # ``modulus`` is k = √(1 − m), and ``missing`` is 1 − k, computed without cancellation
        one, modulus = N.field.one, gmpy2.sqrt(swing.mu / swing.r)
        missing = swing.spread / swing.r / (1 + modulus)
        quarter = complete(modulus, one, one, one, pi, near)
        self._first_kind = FirstKind(N, number(modulus), number(missing), number(quarter))
        self._flow_rate = swing.rate * gmpy2.sqrt(swing.r) / (4 * quarter)
        # ``_advance`` is the advance of φ due to the elliptic integral F, in turns per turn of θ; ``_turning`` are its
        # turns per unit of t and of τ
        first, third = swing.factors
        self._advance = -first * 2 * quarter / pi
        self._turning = self._advance * self._rate, self._advance * self._flow_rate
        # the mean rates dτ/dt and dt/dτ
        self.paces = number(self._rate / self._flow_rate), number(self._flow_rate / self._rate)
        self._third_advance = 0 * pi
        if not self._flat:
            pole = complete(modulus, swing.kappa * swing.kappa, one, one, pi, near)
            self._third_advance = ((pi if swing.kappa > 0 else -pi) - 2 * third * pole) / (2 * pi)
        count = N.field.nearest(swing.theta / pi)
        x: Any = number(swing.theta - count * pi)
        self._start_count, self._start_x = count, x
        self._start_angle = number(gmpy2.sin(swing.theta)), number(gmpy2.cos(swing.theta))
        self._start_lean = self._lean(N.cos(x) * (-1) ** count)
        self._start = swing.theta / (2 * pi) - N.wide(self._kepler * self._start_lean)
        self._start_swing = self._first_kind.swing(x)
        self._flow_start = swing.theta / (2 * pi) + N.wide(self._start_swing / (4 * self._first_kind.quarter))
        self._origin = swing.phi / (2 * pi) - count * self._third_advance
        self._origin -= N.wide(self._turned(x) / (2 * N.pi))

    def radians(self, tau: Real) -> Real:
        """The approximate sum of the angles, in radians, by which θ and φ turn until τ."""
        turns = abs(tau * self._flow_rate)
        factors = (
            abs(self._advance) + 2 * abs(self._third_advance) + sum(abs(self.numbers.wide(x)) for x in self._factors)
        )
        return 2 * gmpy2.const_pi() * turns * (1 + factors) + 1

    # --- states at given times

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        N, number = self.numbers, self.numbers.number
        count, x = self._at_times(times)
        delay, swing = self._delay(count, x), self._first_kind.swing(x) - self._start_swing
        _, turns = N.turns_of(times, self._turning[0], 0)
        turned = turns + number(self._advance) * delay - self._factors[0] * swing / (2 * N.pi)
        gap = N.pi * (count - self._start_count) + (x - self._start_x)
        rows = self._rows(count, x, self._turned_nearby(times, gap, turned))
        if not self._rolls:
            return rows, times
        gap = (delay + swing / (4 * self._first_kind.quarter)) / number(self._flow_rate)
        return rows, N.result(times * self.paces[0] + gap)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        if not self._rolls:
            return self.at(tau)[0]
        N = self.numbers
        return self._rows(*self._at_tau(tau), N.turns_of(tau, self._turning[1], 0)[1])

    def times(self, tau: np.ndarray) -> np.ndarray:
        if not self._rolls:
            return tau
        N, number = self.numbers, self.numbers.number
        count, x = self._at_tau(tau)
        gap = (self._first_kind.swing(x) - self._start_swing) / (4 * self._first_kind.quarter) + self._delay(count, x)
        return N.result(tau * self.paces[1] - gap / number(self._rate))

    def _delay(self, count: np.ndarray, x: np.ndarray) -> np.ndarray:
        """(θ − θ₀)/2π minus the mean rate of θ/2π times the time since the start, at θ = π·count + x."""
        return self._kepler * (self._lean(self.numbers.cos(x) * _sign(count)) - self._start_lean)

    def _at_times(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The phase θ = π·n + x at physical times, as (n, x) with n whole and |x| ≤ π/2."""
        N = self.numbers
        whole, rest = N.turns_of(times, self._rate, self._start)
        # the function G of :meth:`_lean` is odd and increasing, so that |G(cos θ)| ≤ G(1)
        farthest = abs(self._kepler) * self._lean(1 + 0 * self._root_mu)
        low, high = rest - farthest, rest + farthest
        y = rest.copy()
        for _ in range(N.passes if self._kepler else 0):
            c, s = N.cos(2 * N.pi * y), N.sin(2 * N.pi * y)
            gap = y - self._kepler * self._lean(c) - rest
            slope = 1 + 2 * N.pi * self._kepler * s / (self._root_mu * N.sqrt(1 + self._bulge * c * c))
            better, low, high = step_inside(y, gap, slope, low, high)
            done = np.abs(better - y).max(initial=0) <= 4 * N.eps
            y = better
            if done:
                break
        half, part = half_turns(N, y)
        return 2 * whole + N.result(half), N.pi * part

    def _turned_nearby(self, times: np.ndarray, gap: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """``turned``, the turns of φ since the start due to its term with the elliptic integral F(θ | m), computed anew
        where θ − θ₀, about ``gap``, is small.

        The factor of F may be a million, and the difference F(θ) − F(θ₀) of two values loses digits. By the addition
        theorem the difference is F(ψ) for an angle ψ whose sine is a function of θ and θ₀.
        """
        near, N = np.flatnonzero(np.abs(gap) < NEARBY), self.numbers
        if self._flat or not len(near):
            return turned
        gap = self._gap(gap[near], 2 * N.pi * times[near] * N.number(self._rate))
        (s0, c0), (s, c) = self._start_angle, self._angle_at(gap)
        k2 = self._first_kind.k**2
        root0, root = N.sqrt(c0 * c0 + k2 * s0 * s0), N.sqrt(c * c + k2 * s * s)
        left, right = s * c0 * root0, s0 * c * root
        # sin ψ·(1 − m sin²θ sin²θ₀) = left − right; if left and right have the same sign, sin ψ = (sin²θ −
        # sin²θ₀)/(left + right), and sin²θ − sin²θ₀ = sin(θ − θ₀) sin(θ + θ₀)
        alike = left * right > 0
        sine = np.where(alike, N.sin(gap) * (s0 * c + c0 * s) / np.where(alike, left + right, 1), left - right)
        sine = np.where(alike, sine, sine / (c0 * c0 + s0 * s0 * (c * c + k2 * s * s)))
        small = (np.abs(sine) <= 0.5) & (c0 * c + s0 * s * root0 * root > 0)
        turned = turned.copy()
        turned[near[small]] = -self._factors[0] * self._first_kind.at(N.arcsin(sine[small])) / (2 * N.pi)
        return turned

    def _gap(self, gap: np.ndarray, goal: np.ndarray) -> np.ndarray:
        """θ − θ₀ to its last digit, near ``gap``: the solution of θ − θ₀ − ε(G(cos θ) − G(cos θ₀)) = ``goal``, with
        the ε and G of :meth:`integrable.motion.swing.Swing.clock`; ε = 0 for an upright body.
        """
        if not self._kepler:
            return goal
        N, (s0, c0) = self.numbers, self._start_angle
        for _ in range(PASSES):
            s, c = self._angle_at(gap)
            root0, root = (N.sqrt(1 + self._bulge * y * y) for y in (c0, c))
            # by the addition theorem G(cos θ) − G(cos θ₀), with G of :meth:`_lean`, is G of one argument
            alike = c0 * c > 0
            below = np.where(alike, c * root0 + c0 * root, 1)
            difference = np.where(alike, -N.sin(gap) * (s0 * c + c0 * s) / below, c * root0 - c0 * root)
            missed = gap - goal - 2 * N.pi * self._kepler * self._lean(difference)
            step = missed / (1 + 2 * N.pi * self._kepler * s / (self._root_mu * root))
            gap = gap - step
            if (np.abs(step) <= 4 * N.eps * np.abs(gap)).all():
                break
        return gap

    def _angle_at(self, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """sin θ and cos θ at θ₀ + gap."""
        (s0, c0), s, c = self._start_angle, self.numbers.sin(gap), self.numbers.cos(gap)
        return s0 * c + c0 * s, c0 * c - s0 * s

    def _at_tau(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The phase θ = π·n + x at values of τ, as (n, x) like :meth:`_at_times`."""
        N = self.numbers
        whole, rest = N.turns_of(tau, self._flow_rate, self._flow_start)
        half, part = half_turns(N, rest)
        return 2 * whole + N.result(half), self._first_kind.inverse(2 * self._first_kind.quarter * part)

    def _lean(self, c: np.ndarray) -> np.ndarray:
        """G(c) = ∫_0^c du/√(μ + δA²u²); 0 for an upright body, whose clock has no such part."""
        if not self._kepler:
            return 0 * c
        y, N = self._bulge * c * c, self.numbers
        # below ``small`` three terms of the series are right to the last digit
        small = N.eps ** (1 / 3)
        far = N.sqrt(np.maximum(abs(y), small))
        long = N.arcsinh(far) / far if self._bulge > 0 else N.arcsin(np.minimum(far, 1)) / far
        short = 1 - y / 6 + 3 * y * y / 40
        return c / self._root_mu * np.where(abs(y) < small, short, long)

    def _turned(self, x: np.ndarray) -> np.ndarray:
        """φ − φ₀ at θ = x without the term of F: arctan(κ tan θ) − κ√(r₃/r)·Π(A²; θ | m)."""
        if self._flat:
            return 0 * x
        # at θ = π/2 the arctangent and Π each change by half a turn within a distance of about κ; cos ≥ 0 keeps both on
        # the same side of π/2
        N = self.numbers
        s, c = N.sin(x), np.maximum(N.cos(x), 0)
        k2, n, square = self._first_kind.k**2, self._size**2, self._kappa**2
        far = np.maximum(c * c + square * s * s, N.tiny)
        product = square * n * n * self._thin * s**6
        third = self._first_kind.at(x) + n / 3 * s**3 * carlson_j(N, c * c, c * c + k2 * s * s, 1 + 0 * s, far, product)
        return N.arctan2(self._kappa * s, c) - self._factors[1] * third

    def _rows(self, count: np.ndarray, x: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """γ and M at θ = π·count + x, where F has turned φ by ``turned`` turns since the start, shape (N, 6)."""
        N = self.numbers
        _, turns = N.turns_of(count, self._third_advance, self._origin)
        phi = 2 * N.pi * (turns + turned) + self._turned(x)
        s, c = (_sign(count) * y for y in (N.sin(x), N.cos(x)))
        p, q, kappa = N.cos(phi), N.sin(phi), self._kappa
        inverse = N.sqrt(self._least + self._more * (c * c if self._delta > 0 else s * s))
        lean = kappa * self._delta * s / (inverse + self._root3)
        y1, y2 = -lean * c, self._root3 + lean * kappa * s
        gamma = [p * c + q * kappa * s, q * c - p * kappa * s, self._size * s]
        M = [self._across * (p * y1 - q * y2), self._across * (q * y1 + p * y2), self._spin * inverse]
        gamma, M = ([v[i] for i in self._columns] for v in (gamma, M))
        a, b, e, d = self._matrix
        rows = [a * g + b * m for g, m in zip(gamma, M, strict=True)]
        rows += [e * g + d * m for g, m in zip(gamma, M, strict=True)]
        return N.result(np.stack(rows, axis=1))


def half_turns(N: LongDoubles | Multiprecision, rest: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Splits angles ``rest``, in turns, into n + r half turns: returns (n, r) with n whole and r in [−½, ½]."""
    half = N.nearest(2 * rest)
    return half, 2 * rest - half


def _sign(count: np.ndarray) -> np.ndarray:
    return 1 - 2 * (count % 2)
