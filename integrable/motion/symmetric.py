"""The motion of a body with two or three equal moments in closed form, rolling or not, at any time.

Let axis 3 be the one of the other moment, a its two equal a_i, r_i = 1 − d·a_i, δ = d(a₃ − a) = r − r₃ and (γ, M) = 0.
gM₃ = K is constant, and γ₃ swings like a pendulum of small amplitude at *physical* times:

    γ₃ = A sin θ,  θ̇ = Ω = a|M|√(r₃/μ),  μ = r − δA²,  g⁻² = r − δγ₃².

With κ² = 1 − A², of the sign of K, so K = |M|κ/√μ, the other two are an ellipse that turns by an angle φ(t):

    γ₁ + iγ₂ = e^{iφ}(cos θ − iκ sin θ),  M₁ + iM₂ = e^{iφ}(A|M|/√μ)(i√r₃ + κδ sin θ(−cos θ + iκ sin θ)/(1/g + √r₃)),

    φ = φ₀ + arctan(κ tan θ) − κ√(r₃/r)·Π(A²; θ | m) − κ(a₃ − a)/(a√(r·r₃))·F(θ | m),  m = δA²/r,

with elliptic integrals of the third and the first kind; τ is the latter. F is its mean (2K/π)θ plus an oscillation P(θ)
of the size of m. Where the moments differ by many orders, φ turns that much faster than θ, so the mean is computed from
the time since the start.

Chaplygin (1903) integrates the ball with theta functions; with equal moments his curve has a double point, and this is
the limit. It is derived from γ̇ = γ×ω with the integral gM₃. At d = 0 both integrals are elementary: the free symmetric
top. Chaplygin's transformation brings a tilted body to (γ, M) = 0; its time is t up to a function of θ, an equation
like Kepler's.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.elliptic_integrals import FirstKind, carlson_j, complete
from integrable.moving_point.newton import step_inside
from integrable.phase.equal_moments import Swing, Upright
from integrable.phase.precisions import SET_UP_DIGITS
from integrable.phase.space import PhaseSpace
from jacobian import MP
from jacobian.errors import PrecisionLoss
from jacobian.numbers.double_double import exact_product, split
from jacobian.numbers.long_reals import BareReals

if TYPE_CHECKING:
    from integrable.phase.state import State

Long = np.longdouble
# beyond this many turns a float holds no digits of the phase
MOST_TURNS = 2.0**50
# the complete integrals converge to the square of this
NEAR = 1e-22
# up to this size θ − θ₀ is computed to full relative accuracy
NEARBY = 0.75
# Newton steps for the phase of a tilted body, with bisections among them
PASSES = 80


class SymmetricFlow:
    """γ and M at any times, in floats, from a state of a body that has a :func:`symmetry_axis`.

    Constants are computed in extended precision; phases are reduced in two floats, and the rest is in long doubles.
    PrecisionLoss beyond 2^50 turns.
    """

    way = "closed form"

    def __init__(self, system: PhaseSpace, state: State) -> None:
        K = self._wide = MP(SET_UP_DIGITS)
        self._rolls = system.body.rolls
        upright = Upright.of(system, state, K)
        self._columns, self._matrix = upright.columns, [long(x) for x in upright.matrix]
        swing = Swing.of(upright.body, upright.gamma, upright.M)
        self._shape(swing)
        self._phases(swing, *swing.clock(upright))

    def _shape(self, swing: Swing) -> None:
        """The constants of the states except θ and φ, as long doubles."""
        r, r3, delta, _, momentum, kappa, size, mu = swing[:8]
        sqrt = self._wide.sqrt
        # no curve is left at d = 0 and for three equal moments: F is θ, and Π with arctan is nothing
        self._flat = bool(delta == 0)
        self._kappa, self._size, self._root3 = map(long, (kappa, size, sqrt(r3)))
        self._delta, self._bulge, self._root_mu = map(long, (delta, swing.spread / mu, sqrt(mu)))
        # g⁻² at γ₃ = A plus the contribution of γ₃ = 0, or the reverse: a sum of two numbers ≥ 0
        self._least, self._more = long(mu if delta > 0 else r), long(abs(swing.spread))
        self._spin, self._across = long(swing.spin), long(momentum * size / sqrt(mu))
        # r₃/r, and the factors of F and Π in φ
        self._thin = long(r3 / r)
        first, third = swing.factors
        self._factors = long(first), long(third)

    def _phases(self, swing: Swing, rate: Any, kepler: Any) -> None:
        """The rates of the phases, in turns of θ and φ to a unit of t and of τ, and of φ to half a turn of θ."""
        K, pi = self._wide, self._wide.context.pi
        self._kepler, self._rate = long(kepler / (2 * pi)), rate / (2 * pi)
        # k = √(1 − m), and 1 − k
        modulus = K.sqrt(swing.mu / swing.r)
        missing = swing.spread / swing.r / (1 + modulus)
        quarter = _complete(K, modulus, K.one)
        self._first_kind = FirstKind(long(modulus), long(missing), long(quarter))
        self._flow_rate = swing.rate * K.sqrt(swing.r) / (4 * quarter)
        # φ in turns of θ, and with τ, but for what the third kind adds to each half turn
        first, third = swing.factors
        self._advance = -first * 2 * quarter / pi
        self._turning = self._advance * self._rate, self._advance * self._flow_rate
        self._third_advance = K.zero
        if swing.kappa and not self._flat:
            pole = _complete(K, modulus, swing.kappa * swing.kappa)
            self._third_advance = ((pi if swing.kappa > 0 else -pi) - 2 * third * pole) / (2 * pi)
        # their values at time 0
        count = int(K.context.nint(swing.theta / pi))
        x = long(swing.theta - count * pi)
        self._start_count, self._start_x = count, x
        self._start_angle = long(K.context.sin(swing.theta)), long(K.context.cos(swing.theta))
        self._start_lean = self._lean(np.cos(x) * (-1) ** count)
        self._start = swing.theta / (2 * pi) - wide(K, self._kepler * self._start_lean)
        self._start_swing = self._first_kind.swing(x)
        self._flow_start = swing.theta / (2 * pi) + wide(K, self._start_swing / (4 * self._first_kind.quarter))
        self._origin = swing.phi / (2 * pi) - count * self._third_advance
        self._origin -= wide(K, self._turned(x) / (2 * PI))

    # --- at times

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        count, x = self._at_times(times)
        delay, swing = self._delay(count, x), self._first_kind.swing(x) - self._start_swing
        _, turns = turns_of(times, self._turning[0], self._wide.zero)
        turned = turns + long(self._advance) * delay - self._factors[0] * swing / (2 * PI)
        rows = self._rows(
            count, x, self._turned_nearby(times, PI * (count - self._start_count) + (x - self._start_x), turned)
        )
        if not self._rolls:
            return rows, times
        gap = (delay + swing / (4 * self._first_kind.quarter)) / long(self._flow_rate)
        return rows, (times * long(self._rate / self._flow_rate) + gap).astype(float)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        if not self._rolls:
            return self.at(tau)[0]
        return self._rows(*self._at_tau(tau), turns_of(tau, self._turning[1], self._wide.zero)[1])

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        if not self._rolls:
            return tau
        count, x = self._at_tau(tau)
        gap = (self._first_kind.swing(x) - self._start_swing) / (4 * self._first_kind.quarter) + self._delay(count, x)
        times: np.ndarray = (tau * long(self._flow_rate / self._rate) - gap / long(self._rate)).astype(float)
        return times

    def _delay(self, count: np.ndarray, x: Any) -> Any:
        """What θ/2π has gone since the start beyond its mean, at θ = π·count + x."""
        return self._kepler * (self._lean(np.cos(x) * _sign(count)) - self._start_lean)

    def _at_times(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(half turns, x) with θ = π·(half turns) + x, |x| ≤ π/2."""
        whole, rest = turns_of(times, self._rate, self._start)
        low, high = rest - self._farthest_lean, rest + self._farthest_lean
        y = rest.copy()
        for _ in range(PASSES if self._kepler else 0):
            c, s = np.cos(2 * PI * y), np.sin(2 * PI * y)
            gap = y - self._kepler * self._lean(c) - rest
            slope = 1 + 2 * PI * self._kepler * s / (self._root_mu * np.sqrt(1 + self._bulge * c * c))
            better, low, high = step_inside(y, gap, slope, low, high)
            done = np.abs(better - y).max(initial=0) <= 4 * np.finfo(Long).eps
            y = better
            if done:
                break
        half, part = half_turns(y)
        return 2 * whole + half.astype(float), PI * part

    def _turned_nearby(self, times: np.ndarray, gap: Any, turned: Any) -> Any:
        """``turned``, but of F(θ) − F(θ₀) itself where θ − θ₀, about ``gap``, is small: φ may follow F a million times
        as fast, and the two F's are long doubles only. By the addition theorem F(θ) − F(θ₀) = F(ψ).
        """
        near = np.flatnonzero(np.abs(gap) < NEARBY)
        if self._flat or not len(near):
            return turned
        gap = self._gap(gap[near], 2 * PI * times[near] * long(self._rate))
        (s0, c0), (s, c) = self._start_angle, self._angle_at(gap)
        k2 = self._first_kind.k**2
        root0, root = np.sqrt(c0 * c0 + k2 * s0 * s0), np.sqrt(c * c + k2 * s * s)
        left, right = s * c0 * root0, s0 * c * root
        # sin ψ·(1 − m sin²θ sin²θ₀) is left − right, and its conjugate the difference of squares
        squares = -self._change_of_square(gap)
        with np.errstate(divide="ignore", invalid="ignore"):
            sine = np.where(left * right > 0, squares / (left + right), left - right)
        sine = np.where(left * right > 0, sine, sine / (c0 * c0 + s0 * s0 * (c * c + k2 * s * s)))
        small = (np.abs(sine) <= 0.5) & (c0 * c + s0 * s * root0 * root > 0)
        turned = turned.copy()
        turned[near[small]] = -self._factors[0] * self._first_kind.at(np.arcsin(sine[small])) / (2 * PI)
        return turned

    def _gap(self, gap: Any, goal: Any) -> Any:
        """θ − θ₀ to its last digit from a nearby value; it equals ``goal`` up to the effect of a tilted body's
        clock.
        """
        if not self._kepler:
            return goal
        _, c0 = self._start_angle
        for _ in range(PASSES):
            s, c = self._angle_at(gap)
            root0, root = (np.sqrt(1 + self._bulge * y * y) for y in (c0, c))
            # G(cos θ) − G(cos θ₀) is G of this
            with np.errstate(divide="ignore", invalid="ignore"):
                far = c0 * c <= 0
                difference = np.where(far, c * root0 - c0 * root, self._change_of_square(gap) / (c * root0 + c0 * root))
            missed = gap - goal - 2 * PI * self._kepler * self._lean(difference)
            step = missed / (1 + 2 * PI * self._kepler * s / (self._root_mu * root))
            gap = gap - step
            if (np.abs(step) <= 4 * np.finfo(Long).eps * np.abs(gap)).all():
                break
        return gap

    def _angle_at(self, gap: Any) -> tuple[Any, Any]:
        """sin θ and cos θ at θ₀ + gap."""
        (s0, c0), s, c = self._start_angle, np.sin(gap), np.cos(gap)
        return s0 * c + c0 * s, c0 * c - s0 * s

    def _change_of_square(self, gap: Any) -> Any:
        """cos²θ − cos²θ₀."""
        s, c = self._angle_at(gap)
        s0, c0 = self._start_angle
        return -np.sin(gap) * (s0 * c + c0 * s)

    @property
    def _farthest_lean(self) -> Any:
        """A bound of the difference between θ/2π and its mean."""
        return abs(self._kepler) * self._lean(Long(1))

    def _at_tau(self, tau: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The result of :meth:`_at_times`."""
        whole, rest = turns_of(tau, self._flow_rate, self._flow_start)
        half, part = half_turns(rest)
        return 2 * whole + half.astype(float), self._first_kind.inverse(2 * self._first_kind.quarter * part)

    def _lean(self, c: Any) -> Any:
        """G(c) = ∫_0^c du/√(μ + δA²u²)."""
        y = self._bulge * c * c
        far = np.sqrt(np.maximum(abs(y), Long(1e-9)))
        long = np.arcsinh(far) / far if self._bulge > 0 else np.arcsin(np.minimum(far, 1)) / far
        short = 1 - y / 6 + 3 * y * y / 40
        return c / self._root_mu * np.where(abs(y) < 1e-9, short, long)

    # --- states

    def _turned(self, x: Any) -> Any:
        """φ at θ = x, less φ at θ = 0 and what F adds."""
        if self._flat or self._kappa == 0:
            return 0 * x
        # the arctangent and Π, each of which turns by a half at π/2 within κ, see the same side of it
        s, c = np.sin(x), np.maximum(np.cos(x), 0)
        k2, n, square = self._first_kind.k**2, self._size**2, self._kappa**2
        far = np.maximum(c * c + square * s * s, np.finfo(Long).tiny)
        product = square * n * n * self._thin * s**6
        third = self._first_kind.at(x) + n / 3 * s**3 * carlson_j(c * c, c * c + k2 * s * s, 1 + 0 * s, far, product)
        return np.arctan2(self._kappa * s, c) - self._factors[1] * third

    def _rows(self, count: np.ndarray, x: np.ndarray, turned: Any) -> np.ndarray:
        """γ and M at θ = π·count + x, where F has turned φ by ``turned`` turns since the start, shape (N, 6)."""
        _, turns = turns_of(count, self._third_advance, self._origin)
        phi = 2 * PI * (turns + turned) + self._turned(x)
        s, c = (_sign(count) * y for y in (np.sin(x), np.cos(x)))
        p, q, kappa = np.cos(phi), np.sin(phi), self._kappa
        inverse = np.sqrt(self._least + self._more * (c * c if self._delta > 0 else s * s))
        lean = kappa * self._delta * s / (inverse + self._root3)
        y1, y2 = -lean * c, self._root3 + lean * kappa * s
        gamma = [p * c + q * kappa * s, q * c - p * kappa * s, self._size * s]
        M = [self._across * (p * y1 - q * y2), self._across * (q * y1 + p * y2), self._spin * inverse]
        gamma, M = ([v[i] for i in self._columns] for v in (gamma, M))
        a, b, e, d = self._matrix
        rows = [a * g + b * m for g, m in zip(gamma, M, strict=True)]
        rows += [e * g + d * m for g, m in zip(gamma, M, strict=True)]
        return np.stack(rows, axis=1).astype(float)


def _complete(K: Any, modulus: Any, p: Any) -> Any:
    """:func:`~integrable.moving_point.elliptic_integrals.complete` with a = b = 1, of numbers of K: by bare reals,
    some times as fast.
    """
    reals = BareReals(K.context.prec)
    with reals as numbers:
        one = numbers.number(1)
        k, pole, pi = map(numbers.number, (modulus, p, +K.context.pi))
        return numbers.element(K, complete(k, pole, one, one, pi, NEAR))


def turns_of(values: np.ndarray, rate: Any, start: Any) -> tuple[np.ndarray, Any]:
    """(whole turns, the rest in [−½, ½]) of values·rate + start, floats and long doubles; rate and start are wide."""
    # in a unit in which the rate is about 1: its parts and those of the products are floats
    exponent = int(rate.context.frexp(rate)[1])
    high, low = split(rate * rate.context.mpf(2) ** -exponent)
    with np.errstate(over="ignore"):
        scaled = np.ldexp(values if rate else 0 * values, exponent)
    if not np.abs(scaled).max(initial=0) < MOST_TURNS:
        farthest = float(np.abs(values).max())
        raise PrecisionLoss(
            f"time {farthest}: {farthest * float(rate):.1e} turns of a phase are more than the {MOST_TURNS:.1e} "
            "whose fractions double-double numbers hold; use more digits"
        )
    product, error = exact_product(scaled, high)
    whole = np.rint(product)
    rest = (product - whole).astype(Long) + error + scaled.astype(Long) * low + long(start)
    more = np.rint(rest)
    return whole + more.astype(float), rest - more


def half_turns(rest: Any) -> tuple[Any, Any]:
    """(half turns, the rest in [−½, ½] of one) of parts of a turn."""
    half = np.rint(2 * rest)
    return half, 2 * rest - half


def _sign(count: np.ndarray) -> np.ndarray:
    """(−1)^count."""
    sign: np.ndarray = 1.0 - 2.0 * (count % 2)
    return sign


def long(x: Any) -> Any:
    """A wide number as a long double."""
    high, low = split(x)
    return Long(high) + Long(low)


def wide(K: Any, x: Any) -> Any:
    """A long double as a wide number."""
    high = float(x)
    return K.coerce(high) + K.coerce(float(x - high))


PI = long(MP(SET_UP_DIGITS).context.pi)
