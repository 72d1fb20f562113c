"""Random access to a motion: any τ and any t by the same two additions from the nearest corner of a cell of the torus.

The moving points at the corners are made once; a time of the flow is two phases, its whole turns are signs, and what is
left inside a cell is T(s₁, c₁s₁) + T(s₂, c₂s₂) with T a power series. Compiled, all this is done in double-double
numbers and rounded once, so that no error grows with the time; interpreted, with
more digits. Physical time t = ∫dτ/g is a mean rate and a Fourier series on the torus, inverted by Newton (Fedorov 2009
gives the same functions as theta functions).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.torus.clock_loops import Clock
from integrable.torus.corners import Corners
from integrable.torus.loops import NotClosed
from integrable.torus.panels import NODES, Panels, States, panel_length
from integrable.torus.series import TorusSeries, long_double, spectrum
from integrable.torus.witness import confirmed
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# more turns of a phase than this leave no digits of a float behind
MOST_TURNS = 2.0**50
MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this part of its mean are left out of the series that Newton starts with
ROUGH = 1e-4
# modes by which τ swings this much, in units in which the body turns by some part of a radian, are summed in
# double-double numbers: so many at most
LOUD = 0.05
MOST_LOUD = 8
# a direction of the torus is resolved to this part of its frequency, but not beyond what the long doubles of this
# machine hold
SLOW = 1e-13
EXTENDED = 32 * float(np.finfo(np.longdouble).eps)
# slow modes swing τ by less than this, in the same units, or are kept however small they are in 1/g
LEAST_SWING = 1e-17
# ascending times from this many on, and so many to a node, are read off panels
DENSE_FROM = 5000
DENSE = 3


class TorusFlow(Corners):
    """γ and M at any times of a motion, in the user's units, from a :class:`~integrable.moving_point.setup.Setup`.

    Raises PrecisionLoss where the torus is not compact, or needs too many cells or samples of 1/g (more than ``most``),
    NotClosed where the loops lose too many digits or a sign (:mod:`integrable.torus.witness`).
    """

    way = "torus"

    def __init__(self, setup: Setup, loops: Any, most: int = MOST_SAMPLES) -> None:
        super().__init__(setup, loops, most)
        self.clock: TorusClock | None = None
        self._lengths: dict[str, float] = {}
        if setup.bare_problem.d != 0:
            self.clock = TorusClock(self, self._rates())

    def _check_walk(self) -> None:
        # before the borders of cells: these say of a wrong sign that digits are lost
        if not confirmed(self.setup, self.frequencies, self._rows_at_tau, self.loops):
            raise NotClosed("the torus of this motion does not lead where its translations do; use more digits")
        super()._check_walk()

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(γ and M, τ) at physical times, shapes (N, 6) and (N,).

        Ascending times that are many to a panel of a Chebyshev series are read off such panels.
        """
        if not self.clock:
            return self.at_tau(times), times
        panels = self._panels(self._rows_at, times)
        if panels is None:
            rows, tau, _ = self.clock.at(times)
            return rows, tau
        rows = panels.at(times, self.loops.panel_values)
        return rows[:, :6], times / float(self.mean) + rows[:, 6]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        return self.clock.times(tau) if self.clock else tau

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        panels = self._panels(self._rows_at_tau, tau)
        return self._rows_at_tau(tau) if panels is None else panels.at(tau, self.loops.panel_values)

    def phases(self, times: np.ndarray, physical: bool, periods: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """The phases at times, or at values of τ unless ``physical``, in turns of so many periods in either direction;
        they do not lose what a rounded τ has lost.
        """
        rates, rest = self.frequencies, np.zeros(len(times))
        if physical and self.clock:
            rates, rest = self.clock.pace, self.clock.at(times)[2]
        found = []
        for n, rate, nu in zip(periods, rates, self.frequencies, strict=True):
            # wide numbers: the fractions of many turns
            turns = [x * rate / n for x in times.tolist()]
            found.append(np.array([float(x - int(x)) for x in turns]) + rest * float(nu / n))
        return found[0], found[1]

    def _panels(self, states: States, times: np.ndarray) -> Panels | None:
        """Panels for these times where they pay."""
        if len(times) < DENSE_FROM or not (np.diff(times) >= 0).all():
            return None
        start, end = float(times[0]), float(times[-1])
        if not start < end:
            return None
        length = self._panel_length(states, start, end)
        # so near that a rounded time is corrected for to first order
        near = np.spacing(max(abs(start), abs(end))) < 1e-9 * length
        if not near or len(times) < DENSE * NODES * (end - start) / length:
            return None
        try:
            return Panels(states, start, end, length)
        except PrecisionLoss:
            # passages too fast for panels; one by one they are as exact as ever
            return None

    def _panel_length(self, states: States, start: float, end: float) -> float:
        kind = states.__name__
        if kind not in self._lengths or end - start < self._lengths[kind]:
            self._lengths[kind] = panel_length(
                states, start, end, float(self.setup.step_length / self.setup.time_scale) / 8
            )
        return min(self._lengths[kind], end - start)

    def _rows_at(self, times: np.ndarray) -> np.ndarray:
        """γ, M and τ − t/mean, shape (N, 7)."""
        assert self.clock
        rows, _, delays = self.clock.at(times)
        return np.column_stack([rows, delays])

    def _rows_at_tau(self, tau: np.ndarray) -> np.ndarray:
        out = np.empty(6 * len(tau))
        self._check(tau, self.frequencies)
        self.loops.states_at_tau(self.torus, self._frequency_row, tau, out)
        return out.reshape(-1, 6)

    def _check(self, times: np.ndarray, rates: Any) -> None:
        turns = np.abs(times).max(initial=0) * max(abs(float(x)) for x in rates)
        if turns > MOST_TURNS:
            raise PrecisionLoss(
                f"time {np.abs(times).max()}: {turns:.1e} turns of a phase are more than the {MOST_TURNS:.1e} whose "
                "fractions double-double numbers hold; use more digits"
            )

    @cached_property
    def _frequency_row(self) -> Any:
        return self.loops.row(self.frequencies)

    def _rates(self) -> np.ndarray:
        """The spectrum of 1/g: in slow directions to more digits, they will be divided by its frequency."""
        slow = [SLOW * abs(float(nu) / float(self.setup.time_scale)) for nu in self.frequencies]
        noise = [min(self.loops.noise, max(EXTENDED, x)) for x in slow]
        return self.resolved(spectrum, (noise[0], noise[1]))


class TorusClock:
    """t(τ) and τ(t) of a TorusFlow, in the user's units."""

    def __init__(self, flow: TorusFlow, rates: np.ndarray) -> None:
        self._flow = flow
        row, scale, nu = flow.loops.row, float(flow.setup.time_scale), flow.frequencies
        first, second = (x / n for x, n in zip(nu, flow.doubled, strict=True))
        noise, least = max(flow.closure, flow.loops.noise / 64), LEAST_SWING / scale
        series = TorusSeries(rates, (first, second), long_double(flow.mean), noise, least)
        # the loops count phases in periods of 1/g
        modes, coefficients = series.loudest(LOUD / scale, MOST_LOUD)
        origin, parts = flow.loops.long_row((-sum(coefficients[::2]),)), flow.loops.long_row(coefficients)
        loud = flow.loops.joined(origin, row((2 * flow.setup.wide.context.pi,)), parts)
        packed = series.packed()
        quiet = series.packed(without=modes) if len(modes) else packed
        self.pace = tuple(x / flow.mean for x in nu)
        pace = row((*self.pace, *nu, 1 / flow.mean, flow.mean))
        clock = Clock(flow.doubled, series.packed(ROUGH), packed, quiet, modes, loud, pace)
        self._clock, self._room = flow.loops.packed(clock), 2 * max(part.width for part in clock[1:4])

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(γ and M, τ, τ − t·mean dτ/dt) at physical times, shapes (N, 6), (N,) and (N,)."""
        flow = self._flow
        flow._check(times, self.pace)
        out, tau, delays = np.empty(6 * len(times)), np.empty(len(times)), np.empty(len(times))
        room = np.empty(self._room)
        flow.loops.states_at_times(flow.torus, self._clock, times, tau, delays, out, room)
        return out.reshape(-1, 6), tau, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        flow = self._flow
        flow._check(tau, flow.frequencies)
        times = np.empty(len(tau))
        flow.loops.times_at_tau(self._clock, tau, times, np.empty(self._room))
        return times
