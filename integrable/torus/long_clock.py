"""Physical time at any τ and to any digits. 1/g is a quasi-periodic function of the flow's own time, a Fourier series
on a real torus.

Its modes (:mod:`integrable.torus.oval_modes`) give t = ∫dτ/g as a mean rate times τ plus a bounded oscillation.
Newton's method inverts it, starting from the mean, without steps of the motion. (Fedorov 2009 writes t in theta
functions.)
"""

from __future__ import annotations

from math import inf, log10
from typing import TYPE_CHECKING

import numpy as np

from integrable.moving_point.arithmetic import step_inside
from integrable.torus.series import LongSeries
from jacobian import RR
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from flint import acb

    from integrable.torus.oval_modes import Modes

# a Newton step whose slope is a float multiplies the error by about GAIN; after the first step, in floats, sums are
# evaluated to FIRST_GOAL digits
GAIN, FIRST_GOAL = 1e-13, 28
# a mode is slow if |k·ν₁ + m·ν₂| is below RESONANT times |k·ν₁| + |m·ν₂|. Newton's method takes the slow modes of
# dt/dτ at its start value of τ; such slopes have the relative error SLOW_GAIN
RESONANT, SLOW_GAIN = 2.0**-20, 2.0**-16
# Newton steps in floats no longer help if they do not halve and are below this part of the oscillation of τ
SETTLED = 1e-9


class LongClock:
    """t(τ) and τ(t) for any τ, to ``digits``, from the modes of dt/dτ; results are numbers of ``wide``, an MP field. A
    nearly degenerate torus has too many modes; its motion needs a clock of panels
    (:class:`integrable.motion.precise_clock.PanelClock`). ``unit`` is the modes' unit of τ and t, in which phases
    should change little, so that Newton's method converges.

    Modes in or near resonance with the motion are integrated one by one; in the series they would have small divisors.
    """

    def __init__(self, modes: Modes, digits: int, wide: MultiprecisionField, unit: Real = 1) -> None:
        self.wide, self.digits, self._eps, self._scale = wide, digits, wide.coerce(10) ** -digits, unit
        self.frequencies, self.mean = modes.frequencies, modes.mean
        rows, self._slow = without_slow(modes, digits, wide)
        self._series = LongSeries(rows, self.frequencies, wide, 10.0**-digits)

    def times(self, tau: list[Real]) -> list[Real]:
        """t at every τ."""
        tau = [self.wide.coerce(t) / self._scale for t in tau]
        swings = self._series.at([phases(t, self.frequencies, self.wide) for t in tau])
        return [self._scale * (t * self.mean + self._slowly(t) + swing) for t, swing in zip(tau, swings, strict=True)]

    def tau(self, times: list[Real]) -> list[Real]:
        """τ at every t; exactly 0 at 0."""
        starts = [self._start(self.wide.coerce(t) / self._scale) for t in times]
        shifts = self._shifts(starts)
        return [self._scale * (x + shift) if x else x for x, shift in zip(starts, shifts, strict=True)]

    def _slowly(self, tau: Real) -> Real:
        """The contribution of the slow modes to t at τ."""
        context, total = self.wide.context, self.wide.zero
        for real, imaginary, nu in self._slow:
            c, s = context.cospi(nu * tau), context.sinpi(nu * tau)
            total += (real * c - imaginary * s) * (s / (context.pi * nu) if nu else tau)
        return total

    def _slow_rate(self, tau: Real) -> Real:
        """The contribution of the slow modes to dt/dτ at τ."""
        context, total = self.wide.context, self.wide.zero
        for real, imaginary, nu in self._slow:
            total += real * context.cospi(2 * nu * tau) - imaginary * context.sinpi(2 * nu * tau)
        return total

    def _start(self, t: Real) -> Real:
        """The τ at which mean·τ plus the contribution of the slow modes is t. This sum increases with τ."""
        x = t / self.mean
        if not self._slow or not t:
            return x
        near, far = self.wide.zero, 2 * x
        while abs(far * self.mean + self._slowly(far)) < abs(t):
            far *= 2
        for _ in range(200):
            miss, rate = x * self.mean + self._slowly(x) - t, self.mean + self._slow_rate(x)
            near, far = (near, x) if (miss > 0) == (t > 0) else (x, far)
            step = miss / rate if rate > 0 else 2 * abs(far) + 1
            inside = min(near, far) <= x - step <= max(near, far)
            x = x - step if inside else (near + far) / 2
            if inside and abs(step) <= self._eps * (1 + abs(x)):
                return x
        raise PrecisionLoss("the clock was not inverted: use more digits")

    def _shifts(self, starts: list[Real]) -> list[Real]:
        """The oscillations s of τ about ``starts``: the solutions of mean·s + S(θ + νs) = 0 by Newton's method, in
        floats first. S is the series of t, θ are the phases of a start, ν the frequencies; mean includes the slow rate.
        """
        angles = [phases(start, self.frequencies, self.wide) for start in starts]
        rough = np.array(angles, dtype=float).reshape(-1, 2)
        nu, slow = np.array(self.frequencies, dtype=float), np.array([float(self._slow_rate(x)) for x in starts])
        mean = float(self.mean) + slow
        found, reach = np.zeros(len(starts)), 2 * self._series.rough.bound / mean
        low, high, before = found - reach, found + reach, inf
        for _ in range(100):
            swings, rates = self._series.rough.swings_and_rates(*(rough + found[:, None] * nu).T)
            excess = mean * found + swings
            rates = rates + slow
            following, low, high = step_inside(found, excess, rates, low, high)
            steps, found = np.abs(following - found), following
            size, settled = steps.max(initial=0), SETTLED * np.min(reach, initial=inf)
            if size <= 8 * RR.eps * (1 + np.abs(found).max(initial=0)) or before / 2 < size < settled:
                break
            before = size
        return self._refined(starts, angles, list(map(self.wide.coerce, found.tolist())), rates.tolist())

    def _refined(
        self, starts: list[Real], angles: list[tuple[Real, Real]], shifts: list[Real], rates: list[float]
    ) -> list[Real]:
        """The oscillations of :meth:`_shifts` after Newton's method in multiprecision. Each step but the last uses only
        the digits it can gain.
        """
        nu1, nu2 = self.frequencies
        left, goal, gain = list(range(len(shifts))), FIRST_GOAL, SLOW_GAIN if self._slow else GAIN
        for _ in range(100):
            whole = goal >= self.digits
            places = [(angles[n][0] + nu1 * shifts[n], angles[n][1] + nu2 * shifts[n]) for n in left]
            rest, known = [], self.wide.coerce(10) ** -goal
            for n, swing in zip(left, self._series.at(places, None if whole else goal), strict=True):
                more = self._slowly(starts[n] + shifts[n]) - self._slowly(starts[n]) if self._slow else 0
                step = (self.mean * shifts[n] + more + swing) / rates[n]
                shifts[n] -= step
                error = gain * abs(step) / (1 + abs(shifts[n]))
                if not whole or error > 4 * self._eps:
                    rest.append(n)
                    known = max(known, error)
            left = rest
            if not left:
                return shifts
            if not whole:
                goal = int(-log10(2) * self.wide.exponent(known) - log10(gain))
        raise PrecisionLoss("the clock was not inverted: use more digits")


def without_slow(
    modes: Modes, digits: int, wide: MultiprecisionField
) -> tuple[list[list[acb]], list[tuple[Real, Real, Real]]]:
    """The rows of the modes without those that are nearly in resonance, and the slow modes as (real, imaginary, turns
    per τ).
    """
    rows, most = [*modes.rows], len(modes.rows[0]) // 2
    nu = [float(x) for x in modes.frequencies]
    first, second = np.arange(len(rows))[:, None] * nu[0], np.arange(-most, most + 1)[None, :] * nu[1]
    close = np.abs(first + second) < RESONANT * (np.abs(first) + np.abs(second))
    slow, least = [], wide.coerce(10) ** -digits * abs(modes.mean)
    for k, m in np.argwhere(close).tolist():
        c = modes.rows[k][m]
        # each mode counts with its conjugate
        real, imaginary = (2 * x for x in BallReals(wide.context.prec).elements(wide, (c.real, c.imag)))
        if abs(real) + abs(imaginary) > least:
            slow.append((real, imaginary, k * modes.frequencies[0] + (m - most) * modes.frequencies[1]))
            rows[k] = [*rows[k][:m], type(c)(0), *rows[k][m + 1 :]]
    return rows, slow


def phases(tau: Real, frequencies: tuple[Real, Real], field: MultiprecisionField) -> tuple[Real, Real]:
    """The phases at τ in turns, reduced modulo 1."""
    first, second = (tau * nu for nu in frequencies)
    floor = field.context.floor
    return first - floor(first), second - floor(second)
