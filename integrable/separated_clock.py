"""Physical time along a tilde flow at d ≠ 0: t = ∫dτ/g by Gauss–Legendre quadrature on steps of equal length in τ.

g depends on the abscissas ũ_k of the two curves alone: g⁻² = H2(1 − dũ1)(1 − dũ2)/(H2 − dH1), with H2 = (λ1 − λ2)/(ũ2 −
ũ1) and H1 = λ1 + ũ1H2. Each step keeps 1/g as a Legendre series, so that τ(t) is a Newton
iteration on one of them.
"""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING, Any

from integrable.flow_kernel import integrate_series
from integrable.flow_setup import legendre_rule
from jacobian.errors import ArgumentError, PrecisionLoss

if TYPE_CHECKING:
    from integrable.separated_flow import SeparatedFlow

MOST_STEPS = 200_000
NEWTON = 60
TRIALS = 12


class SeparatedClock:
    """t(τ) and τ(t) of one flow, in its wide numbers; each direction of time grows as far as it is asked for."""

    def __init__(self, flow: SeparatedFlow, digits: int) -> None:
        self._flow = flow
        K = flow.system.field
        # even, so that no node is the middle of its step
        count = 2 * (digits // 2 + 4)
        self._nodes, self._rows, _ = legendre_rule(K, count)
        self._small = K.coerce(10) ** -(digits + 2)
        self._translations: dict[Any, list[tuple[Any, Any]]] = {}
        self.step = self._step()
        self._series: dict[int, list[list[Any]]] = {1: [], -1: []}
        self._knots: dict[int, list[Any]] = {1: [K.zero], -1: [K.zero]}

    def tau(self, t: Any) -> Any:
        """τ at a physical time t of either sign."""
        K = self._flow.system.field
        if t == 0:
            return K.zero
        sign, rest = (1, t) if t > 0 else (-1, -t)
        knots = self._knots[sign]
        while knots[-1] <= rest:
            self._extend(sign)
        k = bisect_right(knots, rest) - 1
        series = self._series[sign][k]
        half = self.step / 2
        target = (rest - knots[k]) / half + integrate_series(series, -K.one)[0]
        # 1/g is positive: time rises along the step
        x = 2 * (rest - knots[k]) / (knots[k + 1] - knots[k]) - 1
        for _ in range(NEWTON):
            reached, rate = integrate_series(series, x)
            change = (reached - target) / rate
            x = x - change
            if abs(change) <= self._small:
                return sign * (self.step * k + half * (1 + x))
        raise PrecisionLoss(f"times: the flow's own time at t = {float(t):g} has not converged")

    def _extend(self, sign: int) -> None:
        series, knots = self._series[sign], self._knots[sign]
        if len(series) >= MOST_STEPS:
            raise ArgumentError(
                f"times: a time beyond |t| = {float(knots[-1]):.3g} takes more than {MOST_STEPS} steps of this clock"
            )
        series.append(self._legendre(sign * self.step * (2 * len(series) + 1) / 2, sign * self.step / 2))
        knots.append(knots[-1] + self.step * series[-1][0])

    def _legendre(self, centre: Any, half: Any) -> list[Any]:
        """Coefficients of 1/g over the step around τ = ``centre``, of half length ``half`` (negative: backwards)."""
        one, two = self._flow.curves
        first, second = one.moved(centre), two.moved(centre)
        if half not in self._translations:
            self._translations = {half: [(one.translation(half * x), two.translation(half * x)) for x in self._nodes]}
        values = [self._flow.pace(one.added(first, s), two.added(second, r)) for s, r in self._translations[half]]
        return [sum(c * y for c, y in zip(row, values, strict=True)) for row in self._rows]

    def _step(self) -> Any:
        """A length whose series converge around points spread over the motion."""
        size = max(max(map(abs, curve.centred)) for curve in self._flow.curves)
        K = self._flow.system.field
        step = 2 / size ** (K.one / 2)
        for _ in range(TRIALS):
            spread = [step * x / 8 for x in (0, 5, 11, 18, 27, 39)]
            tails = (self._legendre(x, step / 2) for x in spread)
            if all(max(map(abs, c[-2:])) < self._small * abs(c[0]) for c in tails):
                return step
            step = step / 2
        raise PrecisionLoss("1/g is not resolved by a quadrature: the moments or d differ too much for this clock")
