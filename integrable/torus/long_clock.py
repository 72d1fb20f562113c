"""Physical time at any distance and to any digits: 1/g is a quasi-periodic function of the flow's own time, a Fourier
series on a real torus.

Samples of 1/g beside the corners of a torus (:mod:`integrable.torus.corners`) give t = ∫dτ/g as a mean rate times τ and
a bounded oscillation, whose inverse is found by Newton from the mean: no step of the motion is taken. (Fedorov 2009
gives the same functions as theta functions.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.torus.corners import Corners
from integrable.torus.loops import ReadableLoops
from integrable.torus.series import LongSeries, long_spectrum
from jacobian import RR
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# samples that take some seconds, and beyond them so many for the square of each digit
MOST_SAMPLES, SAMPLES_A_DIGIT = 1 << 15, 32
# a step of Newton whose slope is a float's leaves that part of itself
GAIN = 1e-13


class MultiprecisionTorusClock:
    """t(τ) and τ(t) for any τ, in the units of a :class:`~integrable.moving_point.setup.Setup`, to ``digits``: by
    default those of the set-up.

    Raises PrecisionLoss where the torus is degenerate or nearly so: that is for the clock that counts steps.
    """

    def __init__(self, setup: Setup, digits: int | None = None) -> None:
        digits = digits or setup.digits
        loops = ReadableLoops(setup, digits)
        self.wide, self._reals = setup.wide, loops.reals
        self._eps = self.wide.coerce(10) ** -digits
        corners = Corners(setup, loops, max(MOST_SAMPLES, SAMPLES_A_DIGIT * digits**2))
        if not corners.closure <= 1000 * loops.noise:
            raise PrecisionLoss(f"a period of this motion leads back to {corners.closure:.1e} only; use more digits")
        # turns of the periods of 1/g
        nu = [rate / n for rate, n in zip(corners.frequencies, corners.doubled, strict=True)]
        self.frequencies = nu[0] / setup.time_scale, nu[1] / setup.time_scale
        self.mean = corners.mean
        noise = 8 * loops.noise
        grid = corners.resolved(lambda samples: long_spectrum(samples, self.wide, self._reals), (noise, noise))
        self._series = LongSeries(grid, self.frequencies, self.wide, self._reals, loops.noise)

    def time(self, tau: Any) -> Any:
        """t at τ, both wide."""
        return tau * self.mean + self._swing(phases(tau, self.frequencies, self.wide))

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every t, all wide."""
        starts = [t / self.mean for t in times]
        return [start + shift for start, shift in zip(starts, self._shifts(starts), strict=True)]

    def _swing(self, angles: tuple[Any, Any]) -> Any:
        """S at some phases, wide."""
        return self._reals.element(self.wide, self._series.at(*angles))

    def _shifts(self, starts: list[Any]) -> list[Any]:
        """s with mean·s + S(θ + νs) = 0, by Newton: the oscillation of τ about its mean value. Floats first."""
        angles = [phases(start, self.frequencies, self.wide) for start in starts]
        rough = np.array(angles, dtype=float).reshape(-1, 2)
        nu, mean = np.array(self.frequencies, dtype=float), float(self.mean)
        found = np.zeros(len(starts))
        for _ in range(100):
            swings, rates = self._series.rough.swings_and_rates(*(rough + found[:, None] * nu).T)
            steps = (mean * found + swings) / rates
            found -= steps
            if np.abs(steps).max(initial=0) <= 4 * RR.eps * (1 + np.abs(found).max(initial=0)):
                break
        return [self._refined(*given) for given in zip(angles, found.tolist(), rates.tolist(), strict=True)]

    def _refined(self, angles: tuple[Any, Any], shift: float, rate: float) -> Any:
        wide, (nu1, nu2) = self.wide.coerce(shift), self.frequencies
        for _ in range(100):
            step = (self.mean * wide + self._swing((angles[0] + nu1 * wide, angles[1] + nu2 * wide))) / rate
            wide -= step
            if GAIN * abs(step) <= 4 * self._eps * (1 + abs(wide)):
                break
        return wide


def phases(tau: Any, frequencies: tuple[Any, Any], field: Any) -> tuple[Any, Any]:
    """The phases at τ in turns, without whole ones."""
    first, second = (tau * nu for nu in frequencies)
    floor = field.context.floor
    return first - floor(first), second - floor(second)
