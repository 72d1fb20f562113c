"""The closed form of :mod:`integrable.motion.symmetric` in multiprecision: two or three equal moments, at any time.

The same formulas with mpmath's R_F and R_J of Carlson, for one time after another. The digits are those requested, plus
those taken by the turns until the farthest time, plus those found missing when this time is computed again with more.
"""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.phase.equal_moments import Swing, Upright
from jacobian import MP
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from collections.abc import Callable

    from integrable.phase.space import PhaseSpace
    from integrable.phase.state import State

# digits beyond those of the field and of the turns; extra digits of the second computation of the farthest time; digits
# kept in a result
GUARD = 15
WIDER = 15
SPARE = 2
# largest number of missing digits that are added
MOST_LOST = 2000
PASSES = 400


class ClosedForm:
    """A motion in the numbers of one wide field: rows of γ and M, one time or τ at a time. τ grows like the elliptic
    integral F of dθ/√(cos²θ + ``square``·sin²θ), which is θ where ``flat``.
    """

    def __init__(self, context: Any, square: Any, flat: bool) -> None:
        self.context, self._square, self._flat = context, square, flat
        self._half = context.pi, 2 * self._first_kind(context.pi / 2)

    def turns(self, t: Any, of_flow: bool) -> Any:
        """The approximate number of radians by which all angles turn until a physical time, or until a time of the
        flow.
        """
        raise NotImplementedError

    def at(self, t: Any) -> tuple[list[Any], Any]:
        """γ and M side by side, and τ, at a physical time."""
        raise NotImplementedError

    def at_tau(self, tau: Any) -> tuple[list[Any], Any]:
        """γ and M side by side, and t, at a value of τ."""
        raise NotImplementedError

    def _integral(self, theta: Any) -> tuple[Any, Any, int]:
        """F(θ), θ less whole half turns, and their number."""
        pi, period = self._half
        count = self.context.nint(theta / pi)
        x = theta - pi * count
        return count * period + self._first_kind(x), x, count

    def _inverse(self, goal: Any) -> Any:
        """θ with F(θ) = goal."""
        pi, period = self._half
        if self._flat:
            return goal
        count = self.context.nint(goal / period)

        def gap(x: Any) -> tuple[Any, Any]:
            c, s = self.context.cos(x), self.context.sin(x)
            slope = 1 / self.context.sqrt(c * c + self._square * s * s)
            return self._first_kind(x) - (goal - count * period), slope

        return pi * count + self._root(gap, -pi / 2, pi / 2)

    def _root(self, gap: Callable[[Any], tuple[Any, Any]], low: Any, high: Any) -> Any:
        """The zero of an increasing function, given with its slope: Newton's method, with bisection if a step leaves
        the bracket.
        """
        x, least = (low + high) / 2, self.context.eps * (1 + abs(low) + abs(high))
        for _ in range(PASSES + self.context.prec):
            value, slope = gap(x)
            low, high = (low, x) if value > 0 else (x, high)
            better = x - value / slope
            if not low <= better <= high:
                better = (low + high) / 2
            if abs(better - x) <= least:
                return better
            x = better
        raise PrecisionLoss("the phase of a motion in closed form was not found; use more digits")

    def _first_kind(self, x: Any) -> Any:
        """F(x), |x| ≤ π/2."""
        if self._flat:
            return x
        c, s = self.context.cos(x), self.context.sin(x)
        return s * self.context.elliprf(c * c, c * c + self._square * s * s, 1)


class SymmetricForm(ClosedForm):
    """The closed form of a body with two or three equal moments."""

    def __init__(self, system: PhaseSpace, state: State, K: Any) -> None:
        c = K.context
        self._upright = upright = Upright.of(system, state, K)
        self._swing = s = Swing.of(upright.body, upright.gamma, upright.M)
        super().__init__(c, s.mu / s.r, bool(s.delta == 0))
        self._first, self._third = s.factors
        self._flow_rate = s.rate * K.sqrt(s.r)
        self._rate, self._kepler = s.clock(upright)
        self._bulge = s.spread / s.mu
        self._half_turn = 2 * self._angle(c.pi / 2)
        self._start = self._phases(s.theta)

    def turns(self, t: Any, of_flow: bool) -> Any:
        """The approximate number of radians by which all angles turn until a physical time, or until a time of the
        flow.
        """
        theta = abs(t) * (self._flow_rate * self.context.pi / self._half[1] if of_flow else self._rate)
        return theta * (1 + abs(self._first * self._half[1]) + abs(self._third) + abs(self._half_turn)) + 1

    def at(self, t: Any) -> tuple[list[Any], Any]:
        """γ and M side by side, and τ, at a physical time."""
        theta = self._theta(t)
        return self._row(theta), (self._phases(theta)[0] - self._start[0]) / self._flow_rate

    def at_tau(self, tau: Any) -> tuple[list[Any], Any]:
        """γ and M side by side, and t, at a value of τ."""
        theta = self._inverse(self._start[0] + self._flow_rate * tau)
        late = self._late(theta) - self._late(self._swing.theta)
        return self._row(theta), (theta - self._swing.theta - late) / self._rate

    def _theta(self, t: Any) -> Any:
        """θ: an equation like Kepler's where the body is tilted."""
        goal = self._swing.theta - self._late(self._swing.theta) + self._rate * t
        if not self._kepler:
            return goal
        far = abs(self._kepler) * self._lean(self.context.one)
        return self._root(lambda theta: (theta - self._late(theta) - goal, self._pace(theta)), goal - far, goal + far)

    def _late(self, theta: Any) -> Any:
        """The lead of t, in units of θ, over θ; 0 if the body is not tilted."""
        return self._kepler * self._lean(self.context.cos(theta)) if self._kepler else 0 * theta

    def _pace(self, theta: Any) -> Any:
        c, s = self.context.cos(theta), self.context.sin(theta)
        return 1 + self._kepler * s / self.context.sqrt(self._swing.mu * (1 + self._bulge * c * c))

    def _lean(self, c: Any) -> Any:
        """∫_0^c du/√(μ + δA²u²)."""
        context, y = self.context, self._bulge * c * c
        root = context.sqrt(abs(y))
        bent = (context.asinh(root) if y > 0 else context.asin(root)) / root if root else context.one
        return c / context.sqrt(self._swing.mu) * bent

    def _angle(self, x: Any) -> Any:
        """arctan(κ tan x) less its integral of the third kind, |x| ≤ π/2."""
        if self._flat or not self._swing.kappa:
            return 0 * x
        context, kappa, n = self.context, self._swing.kappa, self._swing.size**2
        c, s = context.cos(x), context.sin(x)
        j = context.elliprj(c * c, c * c + self._square * s * s, 1, c * c + kappa * kappa * s * s)
        third = self._first_kind(x) + n / 3 * s**3 * j
        return context.atan2(kappa * s, c) - self._third * third

    def _phases(self, theta: Any) -> tuple[Any, Any]:
        """F and the angle of the ellipse at θ."""
        first, x, count = self._integral(theta)
        return first, count * self._half_turn + self._angle(x) - self._first * first

    def _row(self, theta: Any) -> list[Any]:
        context, swing = self.context, self._swing
        phi = swing.phi + self._phases(theta)[1] - self._start[1]
        gamma, M = swing.ellipse(context.cos(theta), context.sin(theta))
        p, q = context.cos(phi), context.sin(phi)
        gamma, M = ([p * v[0] - q * v[1], q * v[0] + p * v[1], v[2]] for v in (gamma, M))
        a, b, e, d = self._upright.matrix
        pairs = [(gamma[i], M[i]) for i in self._upright.columns]
        return [*(a * g + b * m for g, m in pairs), *(e * g + d * m for g, m in pairs)]


class PreciseClosedForm:
    """γ and M at any times over MP(digits), to all digits, by closed forms that ``form`` makes in wider fields: like
    :class:`integrable.motion.symmetric.SymmetricFlow` and :class:`integrable.motion.rotation.PrincipalRotation`.
    ``field`` is the system's unless it is given.
    """

    way = "closed form"

    def __init__(
        self,
        system: PhaseSpace,
        state: State,
        form: Callable[[PhaseSpace, State, Any], ClosedForm] = SymmetricForm,
        field: Any = None,
    ) -> None:
        self._system, self._state, self._made = system, state, form
        self._field: Any = field or system.field
        self._forms: dict[int, ClosedForm] = {}

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,)."""
        return self._found(times, of_flow=False)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        return self._found(tau, of_flow=True)[0]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        return self._found(tau, of_flow=True)[1]

    def _form(self, digits: int) -> ClosedForm:
        if digits not in self._forms:
            self._forms[digits] = self._made(self._system, self._state, MP(digits))
        return self._forms[digits]

    def _found(self, times: np.ndarray, of_flow: bool) -> tuple[np.ndarray, np.ndarray]:
        rows, others = [], []
        if len(times):
            form = self._form(self._digits(max(times, key=abs), of_flow))
            for t in times:
                row, other = (form.at_tau if of_flow else form.at)(form.context.mpf(t))
                rows.append([self._field.coerce(x) for x in row])
                others.append(self._field.coerce(other))
        return np.array(rows, dtype=object).reshape(-1, 6), np.array(others, dtype=object)

    def _digits(self, t: Any, of_flow: bool) -> int:
        """Digits that suffice at the farthest time: two computations of it agree."""
        own = self._field.dps
        rough = self._form(own + GUARD)
        turned = rough.turns(rough.context.mpf(t), of_flow)
        # in steps of ten, so that few set-ups serve many calls
        digits = own + GUARD + 10 * ceil(max(0.0, float(rough.context.log10(turned))) / 10)
        while digits <= own + MOST_LOST + 2 * int(rough.context.log10(turned)):
            row, wide = (self._row(digits + more, t, of_flow) for more in (0, WIDER))
            size = max(map(abs, wide[3:]))
            gaps = [abs(x - y) / scale for x, y, scale in zip(row, wide, [1] * 3 + [size] * 3, strict=True)]
            context = self._form(digits).context
            missing = context.log10(max(gaps)) + own + SPARE if max(gaps) else -1
            if missing <= 0:
                return digits
            digits += max(10, 10 * ceil(float(missing) / 10))
        raise PrecisionLoss(f"time {t}: {digits} digits do not make {own} of the state there; give other units")

    def _row(self, digits: int, t: Any, of_flow: bool) -> list[Any]:
        form = self._form(digits)
        return (form.at_tau if of_flow else form.at)(form.context.mpf(t))[0]
