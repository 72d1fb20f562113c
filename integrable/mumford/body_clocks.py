"""Clocks t(τ) of the bodies of :mod:`integrable.mumford.bodies`, to any number of digits.

For these bodies dt/dτ is a constant divided by √((1 − X₁)(1 − X₂)), where X₁ and X₂ are the abscissas of the moving
points, and X = 1 is a branch point beyond both ovals. The mean of dt/dτ is a determinant of elliptic integrals, and t
is this mean times τ plus a Fourier series (:mod:`integrable.torus.long_clock`). If the ovals meet, t is computed by
quadrature along the motion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from integrable.moving_point.addition import integrate_series
from integrable.moving_point.legendre import LegendreSeries, place_on
from integrable.torus.lattice import RateCurve
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BareReals

# guard digits of the field in which a clock is computed
SPARE = 20
# a quadrature has at most MOST_PANELS panels in each direction of time, each with NODES_A_DIGIT nodes per digit
MOST_PANELS, NODES_A_DIGIT = 64, 2


class RateSource(NamedTuple):
    """The data from which the modes of dt/dτ are made: a :class:`integrable.torus.oval_modes.ModesSource`."""

    problem: RateCurve
    wide: MultiprecisionField
    reals: BareReals

    def reached(self, sign: int, steps: int) -> tuple[Real, ...]:
        """Never called: points of the motion would determine a sign on which dt/dτ does not depend."""
        raise NotImplementedError


class WalkedClock:
    """τ(t) from Legendre series of dt/dτ on panels of ``length`` in τ.

    ``rate(τ)`` returns dt/dτ, which is at most ``fastest``. Rates and results are numbers of ``reals``, accurate to
    ``digits`` digits. PrecisionLoss for times beyond 64 panels, and if a panel is not resolved.
    """

    def __init__(
        self, rate: Callable[[Real], Real], reals: BareReals, digits: int, length: float, fastest: float
    ) -> None:
        self._longest = length * fastest
        self._rate, self._reals, self._digits = rate, reals, digits
        self._half = reals.number(length / 2)
        self._rule = LegendreSeries(reals, NODES_A_DIGIT * digits)
        self._panels: dict[int, tuple[list[Real], Real]] = {}

    def tau(self, times: list[Real]) -> list[Real]:
        """τ at each of the times."""
        with self._reals:
            return [self._at(self._reals.number(t)) for t in times]

    def _at(self, t: Real) -> Real:
        step = 1 if t >= 0 else -1
        if abs(t) > MOST_PANELS * self._longest:
            raise self._too_far(t)
        # ``shown`` is t at that end of the panel which is nearer to the start
        panel, shown = min(step, 0), 0 * t
        while abs(t - shown) > self._panel(panel)[1]:
            shown += step * self._panel(panel)[1]
            panel += step
            if abs(panel) > MOST_PANELS:
                raise self._too_far(t)
        series, whole = self._panel(panel)
        target = (t - shown if step > 0 else whole + t - shown) / self._half + integrate_series(series, -1 + 0 * t)[0]
        return self._half * (2 * panel + 1 + place_on(series, target, self._reals, self._digits))

    def _too_far(self, t: Real) -> PrecisionLoss:
        return PrecisionLoss(
            f"time {float(t)}: this motion is on a separatrix or too near one, where the way to a time is walked "
            f"over; that is more than {MOST_PANELS} steps of {2 * float(self._half):.3g} in τ"
        )

    def _panel(self, n: int) -> tuple[list[Real], Real]:
        """The series of dt/dτ on panel n, from τ = n·``length`` to (n + 1)·``length``, and the panel's length in t."""
        if n not in self._panels:
            values = [self._rate(self._half * (2 * n + 1 + x)) for x in self._rule.nodes]
            series = self._rule.coefficients(values)
            if max(map(abs, series[-2:])) > abs(series[0]) * self._reals.number(10) ** -self._digits:
                raise PrecisionLoss("dt/dτ is not resolved on a step: the moments differ too much for this clock")
            self._panels[n] = series, 2 * self._half * series[0]
        return self._panels[n]
