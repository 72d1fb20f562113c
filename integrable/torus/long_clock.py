"""Physical time at any τ and to any digits. 1/g is a quasi-periodic function of the flow's own time, a Fourier series
on a real torus.

Its modes (:mod:`integrable.torus.oval_modes`) give t = ∫dτ/g as a mean rate times τ plus a bounded oscillation.
Newton's method inverts it, starting from the mean, without steps of the motion. (Fedorov 2009 gives the same functions
as theta functions.)
"""

from __future__ import annotations

from math import log10
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.newton import step_inside
from integrable.torus.oval_modes import MOST_WORK, modes_of_rate
from integrable.torus.series import LongSeries
from jacobian import RR
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.torus.oval_modes import ModesSource

# a Newton step with a slope in floats reduces the error to this fraction; the first step, in floats, gives this many
# digits
GAIN, FIRST_GOAL = 1e-13, 28


class MultiprecisionTorusClock:
    """t(τ) and τ(t) for any τ, in the units of a :class:`~integrable.moving_point.setup.Setup`, to ``digits``, by
    default those of the set-up. ``after`` limits the digits after the point, as far times have no more.

    Raises the errors of :func:`~integrable.torus.oval_modes.modes_of_rate` if the torus is degenerate or nearly so.
    Such motions are left to the clock that counts steps.
    """

    def __init__(
        self,
        setup: ModesSource,
        digits: int | None = None,
        direction: tuple[Any, Any] = (1, 0),
        most_work: float = MOST_WORK,
        after: int | None = None,
    ) -> None:
        whole = digits or setup.digits
        digits = min(after or whole, whole)
        self.wide = setup.wide
        self._digits, self._eps = digits, self.wide.coerce(10) ** -digits
        modes = modes_of_rate(setup, digits, direction, most_work, whole)
        self.frequencies, self.mean = modes.frequencies, modes.mean
        self._series = LongSeries(modes.rows, self.frequencies, self.wide, 10.0**-digits)

    def times(self, tau: list[Any]) -> list[Any]:
        """t at every τ, all wide."""
        swings = self._series.at([phases(t, self.frequencies, self.wide) for t in tau])
        return [t * self.mean + swing for t, swing in zip(tau, swings, strict=True)]

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every t, all wide."""
        starts = [t / self.mean for t in times]
        return [start + shift for start, shift in zip(starts, self._shifts(starts), strict=True)]

    def _shifts(self, starts: list[Any]) -> list[Any]:
        """s with mean·s + S(θ + νs) = 0, by Newton's method, in floats first: the oscillation of τ about its mean
        value.
        """
        angles = [phases(start, self.frequencies, self.wide) for start in starts]
        rough = np.array(angles, dtype=float).reshape(-1, 2)
        nu, mean = np.array(self.frequencies, dtype=float), float(self.mean)
        found, reach = np.zeros(len(starts)), 2 * self._series.rough.bound / mean
        low, high = found - reach, found + reach
        for _ in range(100):
            swings, rates = self._series.rough.swings_and_rates(*(rough + found[:, None] * nu).T)
            excess = mean * found + swings
            following, low, high = step_inside(found, excess, rates, low, high)
            steps, found = np.abs(following - found), following
            if steps.max(initial=0) <= 8 * RR.eps * (1 + np.abs(found).max(initial=0)):
                break
        return self._refined(angles, list(map(self.wide.coerce, found.tolist())), rates.tolist())

    def _refined(self, angles: list[tuple[Any, Any]], shifts: list[Any], rates: list[float]) -> list[Any]:
        """The shifts after Newton's method in multiprecision. Each step but the last uses only the digits it can
        gain.
        """
        nu1, nu2 = self.frequencies
        left, goal = list(range(len(shifts))), FIRST_GOAL
        for _ in range(100):
            whole = goal >= self._digits
            places = [(angles[n][0] + nu1 * shifts[n], angles[n][1] + nu2 * shifts[n]) for n in left]
            rest, known = [], self.wide.coerce(10) ** -goal
            for n, swing in zip(left, self._series.at(places, None if whole else goal), strict=True):
                step = (self.mean * shifts[n] + swing) / rates[n]
                shifts[n] -= step
                error = GAIN * abs(step) / (1 + abs(shifts[n]))
                if not whole or error > 4 * self._eps:
                    rest.append(n)
                    known = max(known, error)
            left = rest
            if not left:
                return shifts
            if not whole:
                goal = int(-log10(2) * self.wide.exponent(known) - log10(GAIN))
        raise PrecisionLoss("the clock was not inverted: use more digits")


def phases(tau: Any, frequencies: tuple[Any, Any], field: Any) -> tuple[Any, Any]:
    """The phases at τ in turns, reduced modulo 1."""
    first, second = (tau * nu for nu in frequencies)
    floor = field.context.floor
    return first - floor(first), second - floor(second)
