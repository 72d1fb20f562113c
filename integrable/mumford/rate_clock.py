"""The clock of a motion of genus 2 whose time is no integral on the Jacobian: dt/dτ is a constant over
√((1 − X₁)(1 − X₂)), X = 1 a branch point beyond both ovals.

On a compact torus t is a mean rate times τ and a Fourier series, that of the ball's 1/g
(:mod:`integrable.torus.long_clock`) for any direction; where the ovals have met it is a quadrature along the way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from integrable.moving_point.addition import integrate_series
from integrable.moving_point.legendre import LegendreSeries
from integrable.torus.long_clock import MultiprecisionTorusClock
from jacobian.errors import PrecisionLoss
from jacobian.numbers.long_reals import BareReals

# digits of the field beyond those that a clock is good to
SPARE = 20
# panels of a quadrature at most, and the nodes of one for each digit
MOST_PANELS, NODES_A_DIGIT = 64, 2
MOST_STEPS = 100


class Unit(NamedTuple):
    """A body's curve as Y² = (X − ζ)Π(α_i − X)(1 − X): the α_i with the κ_i of their lifts, ζ, the start U_0, U_1, V_0,
    V_1, σ_1, σ_2, σ_3, ν_1, ν_2, ν_3, where 1/√Σσ² is dt/dτ, (ΣdX/Y, ΣXdX/Y) in a unit of τ, and |M| over that of the
    pairs (:func:`integrable.phase.coordinates.directions_of`).
    """

    alphas: tuple[Any, ...]
    kappas: tuple[Any, ...]
    zeta: Any
    start: tuple[Any, ...]
    direction: tuple[Any, Any]
    momentum: Any


class Problem(NamedTuple):
    """What the series takes of a :class:`integrable.moving_point.problem.MotionProblem`."""

    axes: tuple[Any, ...]
    ratio: Any
    d: Any
    start: tuple[Any, ...]
    half_step: Any


class Setup(NamedTuple):
    """What it takes of a :class:`integrable.moving_point.setup.Setup`."""

    problem: Problem
    wide: Any
    reals: BareReals
    digits: int


class SeriesClock:
    """τ(t) of a motion over ``wide`` to ``digits``.

    PrecisionLoss where the torus is not compact: the ovals have met.
    """

    def __init__(self, wide: Any, unit: Unit, digits: int) -> None:
        one, zero = wide.one, wide.zero
        axes = (*unit.alphas, one, one, one, one, zero)
        problem = Problem(axes, unit.zeta, one, unit.start, zero)
        setup = Setup(problem, wide, BareReals(wide.context.prec), digits)
        # Newton's method takes 1 for a time in which little turns, so t and τ are counted in such
        first, second = unit.direction
        self._unit = 1 / abs(first)
        direction = first * self._unit, second * self._unit
        self._clock = MultiprecisionTorusClock(setup, direction=direction)  # type: ignore[arg-type]

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every t, wide."""
        coerce = self._clock.wide.coerce
        return [tau * self._unit for tau in self._clock.tau([coerce(t) / self._unit for t in times])]


class PanelClock:
    """τ(t) by Legendre series of dt/dτ on panels of a ``length``: ``rate(τ)`` and the result are numbers of ``reals``,
    good to ``digits``, and nowhere above ``fastest``. PrecisionLoss for times beyond 64 panels, and where a panel is
    not resolved.
    """

    def __init__(
        self, rate: Callable[[Any], Any], reals: BareReals, digits: int, length: float, fastest: float
    ) -> None:
        self._longest = length * fastest
        self._rate, self._reals, self._digits = rate, reals, digits
        self._half = reals.number(length / 2)
        self._rule = LegendreSeries(reals, NODES_A_DIGIT * digits)
        self._panels: dict[int, tuple[list[Any], Any]] = {}

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every t."""
        with self._reals:
            return [self._at(self._reals.number(t)) for t in times]

    def _at(self, t: Any) -> Any:
        step = 1 if t >= 0 else -1
        if abs(t) > MOST_PANELS * self._longest:
            raise self._too_far(t)
        # what the clock shows at the near end of the panel
        panel, shown = min(step, 0), 0 * t
        while abs(t - shown) > self._panel(panel)[1]:
            shown += step * self._panel(panel)[1]
            panel += step
            if abs(panel) > MOST_PANELS:
                raise self._too_far(t)
        series, whole = self._panel(panel)
        target = (t - shown if step > 0 else whole + t - shown) / self._half + integrate_series(series, -1 + 0 * t)[0]
        x = 0 * t
        for _ in range(MOST_STEPS):
            angle, rate = integrate_series(series, x)
            move = (angle - target) / rate
            x = max(-1 + 0 * t, min(1 + 0 * t, x - move))
            if abs(move) <= self._reals.number(10) ** (-self._digits):
                return self._half * (2 * panel + 1 + x)
        raise PrecisionLoss("the clock was not inverted: use more digits")

    def _too_far(self, t: Any) -> PrecisionLoss:
        return PrecisionLoss(
            f"time {float(t)}: this motion is on a separatrix or too near one, where the way to a time is walked "
            f"over; that is more than {MOST_PANELS} steps of {2 * float(self._half):.3g} in τ"
        )

    def _panel(self, n: int) -> tuple[list[Any], Any]:
        """The series of dt/dτ from n to n + 1 lengths, and how long that takes."""
        if n not in self._panels:
            values = [self._rate(self._half * (2 * n + 1 + x)) for x in self._rule.nodes]
            series = self._rule.coefficients(values)
            if max(map(abs, series[-2:])) > abs(series[0]) * self._reals.number(10) ** -self._digits:
                raise PrecisionLoss("dt/dτ is not resolved on a step: the moments differ too much for this clock")
            self._panels[n] = series, 2 * self._half * series[0]
        return self._panels[n]
