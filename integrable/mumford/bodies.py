"""Common formulas of the Chaplygin ball, the Euler top and Veselova's body: γ' = γ×ω, M' = M×ω at (γ, M) = 0.

Let a_i be three constants, A = diag a_i, l(x) = p + qx a linear function, c_i = l(a_i) and w = γ×M. The ball and the
top have p = 1, q = −d. Veselova's body has p = 0, q = 1; it is the ball's limit d → ∞ at fixed a_i. The formulas are

    ω = A(M − q(γ, AM)γ/s),   s = Σc_iγ_i²,   f = 4l(x)Π(a_i − x)(xH₂ − H₁),   H₁ = (ω, M), H₂ = (M, M)
    U = Σc_iσ_i²(x − a_j)(x − a_k),   V = Σc_iσ_iν_i(x − a_j)(x − a_k),   σ = γ/√s,   ν = 2w − 2(Σc_iγ_iw_i)γ/s

(σ_i, ν_i) is the lift at a_i. The direction is e_0 in τ, and dt = √s dτ. For the zeros x_k of U,
s = Πc_i/(l(x_1)l(x_2)). So t is a mean rate times τ plus a function on the torus. (Tsiganov's coordinates of the ball;
Veselov & Veselova 1986 for p = 0.)
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from math import ceil, hypot, log2, log10
from typing import NamedTuple

import numpy as np

from integrable.mumford.flow import BY_ADDITIONS, SERIES, MumfordFlow, Point, element
from integrable.mumford.motion import Start, Vectors, settled_digits
from integrable.mumford.surfaces import SurfaceSystem
from integrable.mumford.system import IntegralsByName, Spectral, all_of
from integrable.mumford.taylor import integrate
from integrable.mumford.theta_torus import Rate, ThetaTorus
from integrable.phase.body import Vector, cross
from integrable.phase.enclosure import Enclosure
from integrable.phase.ways import Cost, StatesReached
from integrable.portrait.point_ovals import Form, Separation
from integrable.series.tape import recorded
from integrable.torus.lattice import RateCurve
from integrable.torus.long_clock import LongClock
from integrable.torus.oval_modes import modes_of_rate
from jacobian import MP, RR, poly
from jacobian.element import FormulaField, Real, Value
from jacobian.errors import ArgumentError, Infeasible, PrecisionLoss, shown
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.fields.protocol import Field
from jacobian.inexact.long_field import LongField
from jacobian.numbers.long_reals import BareReals
from jacobian.relatives.extended import Extended, Lift

# guard digits of the field in which a clock is computed
SPARE = 20
# guard digits of τ; far times get more, in steps of DIGITS_APART, so that few series are computed
GUARD, DIGITS_APART = 6, 4
# largest rotation, in radians, for which a clock is set up
FARTHEST = 1e100
# largest rotation, in radians, over which a motion without a clock is integrated in floats: half a second
NEAR = 64
# periods lose DIGITS_A_GAP digits for each leading digit that two branch points share; up to MOST_SHARED shared digits
# are counted
DIGITS_A_GAP, MOST_SHARED = 3, 100
# of the digits of long numbers, the number that the steps of an integration may lose
STEP_DIGITS = 4


class RateSource(NamedTuple):
    """The data from which the modes of dt/dτ are made: a :class:`integrable.torus.oval_modes.ModesSource`."""

    problem: RateCurve
    wide: MultiprecisionField
    reals: BareReals

    def reached(self, sign: int, steps: int) -> tuple[Real, ...]:
        """Never called: points of the motion would determine a sign on which dt/dτ does not depend."""
        raise NotImplementedError


class BodyFlow(MumfordFlow):
    """The motion of a body from a state. On a separatrix it is computed only at times near the start.

    The flow computes τ at a given time from a Fourier series of t(τ), and then the state at τ. On a separatrix it
    integrates the equations of motion.
    """

    system: BodySystem
    _cost = Cost(30_000, BY_ADDITIONS.each)
    _clock = None

    @cached_property
    def _clocks(self) -> dict[int, LongClock | None]:
        """The last clock, None where the ovals meet or nearly meet; its key is its number of digits."""
        return {}

    def _clock_of(self, times: list[Real]) -> LongClock | None:
        """The clock with the digits that the state at the farthest time needs."""
        last = max([abs(float(t)) for t in times], default=0.0)
        far = last * self._pace
        if not far < FARTHEST:
            raise PrecisionLoss(
                f"time {last}: {far:.1e} radians are more than the {FARTHEST:.0e} of this clock; nearer times are "
                "within reach"
            )
        digits = self.digits + GUARD + DIGITS_APART * ceil(log10(1 + far) / DIGITS_APART)
        # the dictionary is kept in a variable, since another thread may replace it
        clocks = self._clocks if digits in self._clocks else {digits: self._made(digits)}
        vars(self)["_clocks"] = clocks
        return clocks[digits]

    def _places(self, times: list[Real]) -> list[Real]:
        clock = self._clock_of(times)
        assert clock
        return clock.tau(times)

    def _by_additions(self, times: np.ndarray) -> StatesReached:
        if self._clock_of(times.tolist()):
            return super()._by_additions(times)
        far = float(abs(times).max(initial=0)) * self._pace
        if self.system.field is RR and far > NEAR:
            raise PrecisionLoss(
                f"times: this motion is on a separatrix or too near one for its clock, and {far:.1e} radians are more "
                f"than the {NEAR} for which it is integrated in floats; use nearer times or MP(digits)"
            )
        try:
            found = settled_digits(lambda N: self._integrated(N, times), self.digits)
        except Infeasible as error:
            raise PrecisionLoss(f"{error}; this motion is on a separatrix, or too near one for its clock") from None
        states = [[element(self.system.field, x) for x in vector] for vector in found]
        return StatesReached(SERIES, np.array(states, dtype=times.dtype).reshape(len(times), 2, 3))

    def _integrated(self, N: LongField, times: np.ndarray) -> Vectors:
        """γ, then M, at each time, by Taylor series of the equations of motion."""
        K, (gamma, M) = MP(int(N.bits / log2(10))), self._inner(N)

        def rates(y: Sequence[Real]) -> list[Real]:
            moved = self.system._vector_field(N, Point(tuple(y[:3]), tuple(y[3:])))
            return [*moved.q, *moved.p]

        given = [K.coerce(t) for t in times.tolist()]
        rows = integrate(K, recorded(rates, 6), [*gamma, *M], given, K.dps - STEP_DIGITS)
        return [[N.coerce(x) for x in row[k : k + 3]] for row in rows for k in (0, 3)]

    def _enclosed(self, times: list[Real], digits: int, in_tau: bool) -> Enclosure:
        if in_tau:
            return super()._enclosed(times, digits, in_tau)
        raise ArgumentError(
            f"times = {shown(times)}: the clock of {self.system!r} has no proven bounds; enclosure_at_tau has them, at "
            "values of τ, dt = √s dτ"
        )

    def _made(self, digits: int) -> LongClock | None:
        try:
            wide = MP(digits + SPARE + self.system.close_digits(MP(digits + MOST_SHARED)))
            curve, (first, second) = self.system._rate_curve(wide, self._inner(wide))
            source, unit = RateSource(curve, wide, BareReals(wide.context.prec)), 1 / abs(first)
            return LongClock(modes_of_rate(source, digits, (first * unit, second * unit)), digits, wide, unit)
        except PrecisionLoss:
            return None

    def _made_torus(self) -> ThetaTorus:
        return ThetaTorus(self._place, self.system._rate_at)

    @cached_property
    def _pace(self) -> float:
        """The approximate angular velocity of the body, in radians per unit time."""
        return float(max(self.system._constants_in(RR)) * hypot(*map(float, self._inner(RR).p)))


class BodySystem(SurfaceSystem):
    """Base class of the ball, the top and Veselova's body; a state has q = γ and p = M, both in the body frame."""

    size, clocked, flow_type = 3, True, BodyFlow
    _constraint_names = ("|γ| = 1", "(γ, M) = 0", "M ≠ 0")

    def _light(self, N: FormulaField) -> tuple[Real, Real]:
        """Defined by subclasses: the coefficients (p, q) of the linear function l(x) = p + qx."""
        raise NotImplementedError

    def _weights(self, N: FormulaField) -> tuple[Real, ...]:
        """Defined by subclasses: the c_i = l(a_i), computed without cancellation."""
        raise NotImplementedError

    # --- derived from the methods above

    def _set_up_moments(self, field: Field, inertia: Iterable[Value]) -> None:
        """Sets ``field`` and ``constants``; the constants must be three different nonzero numbers."""
        self._set_up(field, inertia, "inertia", 3)
        if self.size != 3 or self.field.zero in self.constants:
            raise ArgumentError(f"inertia = {shown(inertia)}: three different numbers other than 0 are needed")

    def _omega(self, N: FormulaField, state: Point) -> Vector:
        a, (gamma, M) = self._constants_in(N), state
        turned = tuple(e * m for e, m in zip(a, M, strict=True))
        pull = self._light(N)[1] * N.dot(gamma, turned) / self._stretch(N, gamma)
        return tuple(x - pull * e * y for x, e, y in zip(turned, a, gamma, strict=True))

    def _stretch(self, N: FormulaField, gamma: Sequence[Real]) -> Real:
        """s = Σc_iγ_i² = (dt/dτ)²."""
        return N.dot(self._weights(N), [x * x for x in gamma])

    def _vector_field(self, N: FormulaField, state: Point) -> Point:
        omega = self._omega(N, state)
        return Point(*(cross(N, part, omega) for part in state))

    def _integrals(self, N: FormulaField, state: Point) -> IntegralsByName:
        """The integrals H1 = (ω, M) and H2 = (M, M)."""
        return {"H1": N.dot(self._omega(N, state), state.p), "H2": N.dot(state.p, state.p)}

    def _pairs(self, N: FormulaField, state: Point) -> tuple[tuple[Real, Real], ...]:
        """The lifts (σ_i, ν_i) at the a_i."""
        gamma, w = state.q, cross(N, *state)
        stretch = self._stretch(N, gamma)
        lean = N.dot(self._weights(N), [x * y for x, y in zip(gamma, w, strict=True)]) / stretch
        root = N.sqrt(stretch)
        return tuple((x / root, 2 * (y - lean * x)) for x, y in zip(gamma, w, strict=True))

    def _spectral(self, N: FormulaField, state: Point) -> Spectral:
        pairs, weights = self._pairs(N, state), self._weights(N)
        u = self._sums(N, [c * x * x for c, (x, _) in zip(weights, pairs, strict=True)])
        v = self._sums(N, [c * x * y for c, (x, y) in zip(weights, pairs, strict=True)])
        h1, h2 = self._integrals(N, state).values()
        f: poly.Poly = (-4 * h1, 4 * h2)
        for e in self._constants_in(N):
            f = poly.mul(N, f, (e, -N.one))
        # if q = 0, l is constant, and f has degree 4
        light = self._light(N)
        f = poly.mul(N, f, light if light[1] != N.zero else light[:1])
        return all_of(N, (f, (*u[:2], N.one), v[:2]), 2)

    def _genus(self) -> int:
        return 2

    def _direction(self, N: FormulaField, genus: int) -> Sequence[Real]:
        return N.one, N.zero

    def _rate_at(self, N: FormulaField) -> Rate:
        """dt/dτ = √(Πc_i/(q²U(−p/q))) for l(x) = p + qx, q ≠ 0, and c_i = l(a_i)."""
        (p, q), (first, second, third) = self._light(N), self._weights(N)
        return Rate(-p / q, -1, N.sqrt(first * second * third) / abs(q))

    def _separation(self, N: FormulaField, state: Point) -> Separation:
        forms, rate = [Form((N.one,)), Form((N.zero, N.one))], self._rate_at(N)
        return Separation(forms, self._direction(N, 2), slow=(rate.e, rate.factor))

    def _start(self, N: FormulaField, state: Point) -> Start:
        f, u, v = self._spectral(N, state)
        a = self._constants_in(N)
        slopes, axes = poly.derivative(N, poly.from_roots(N, a)), zip(a, self._weights(N), strict=True)
        kappas = [c * poly.evaluate(N, slopes, e) for e, c in axes]
        data = tuple((kappa, *pair) for kappa, pair in zip(kappas, self._pairs(N, state), strict=True))
        return Start(f, u, v, self._direction(N, 2), [*map(Lift, a)], data)

    def _back(self, N: FormulaField, start: Point, D: Extended, time: Real) -> Point:
        _, sigma, nu = zip(*D.data, strict=True)
        square = N.dot(sigma, sigma)
        lean, root = N.dot(sigma, nu) / square, N.sqrt(square)
        gamma = tuple(x / root for x in sigma)
        w = tuple((y - lean * x) / 2 for x, y in zip(sigma, nu, strict=True))
        return Point(gamma, cross(N, w, gamma))

    def close_digits(self, N: MultiprecisionField) -> int:
        """The number of digits beyond SPARE that periods lose because branch points are close.

        The c_i are close together for a light ball, and one is close to 0 for a thin body. Returns 0 if two of the
        c_i coincide over N.
        """
        # the c_i are the values of l at three branch points; the root of l, with the value 0, is another one
        weights = [N.zero, *sorted(self._weights(N))]
        gap = min(y - x for x, y in pairwise(weights)) / weights[-1]
        return max(0, ceil(-DIGITS_A_GAP * float(N.context.log10(gap))) - SPARE) if gap else 0

    def _rate_curve(self, N: FormulaField, state: Point) -> tuple[RateCurve, tuple[Real, Real]]:
        """The motion on Y² = (X − ζ)Π(α_i − X)(1 − X) for a :class:`LongClock`, and d/dτ of Σ∫dX/Y and Σ∫X dX/Y.

        X = 1 − l(x)/L with L = 2 max c_i; ζ and α_i are the values of X at H₁/H₂ and at the a_i. The ``start`` of the
        result is U_0, U_1, V_0, V_1, σ_1, σ_2, σ_3, ν_1, ν_2, ν_3, where dt/dτ = 1/√Σσ_i².
        """
        (p, q), weights = self._light(N), self._weights(N)
        h1, h2 = self._integrals(N, state).values()
        size = 2 * max(weights)
        momentum = N.sqrt(size * h2)
        height = 2 * momentum * (size / q) ** 2
        pairs = self._pairs(N, state)
        _, u, v = self._spectral(N, state)
        slope = v[1] / q
        lights = (2 * p - q * u[1], p * p - p * q * u[1] + q * q * u[0])
        X = (1 - lights[0] / size + lights[1] / size**2, lights[0] / size - 2)
        Y = ((v[0] + slope * (size - p)) / height, -slope * size / height)
        pace, alphas = -q * height / size, tuple(1 - c / size for c in weights)
        nus = (nu / (2 * momentum) for _, nu in pairs)
        start = (*X, *Y, *(sigma for sigma, _ in pairs), *nus)
        axes, zeta = (*alphas, *[N.one] * 4, N.zero), 1 - (p + q * h1 / h2) / size
        return RateCurve(axes, zeta, N.one, start, N.zero), (pace, pace * (1 - p / size))
