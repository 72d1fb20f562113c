"""Random access to a motion: a state at any τ or t takes two phases and three theta functions.

Whole turns of the phases change signs only. Compiled loops use double-doubles and round once, so no error grows with
the time; interpreted loops use more digits. Physical time t = ∫dτ/g is a mean rate times τ plus a Fourier series on the
torus, inverted by Newton's method. (Fedorov 2009 writes t in theta functions.)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.arithmetic import MOST_TURNS
from integrable.moving_point.problem import HALF_STEP, HEAVINESS, TIME_SCALE
from integrable.torus.body_torus import BodyTorus, Transform
from integrable.torus.clock_loops import Clock, ClockSeries
from integrable.torus.clock_modes import MOST_LOUD, Cutoffs, Tables
from integrable.torus.loops import BEYOND, Loops, NotClosed
from integrable.torus.panels import NODES, Panels, States, panel_length
from integrable.torus.series import in_resonance
from integrable.torus.states import Torus
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.native.library import Packed

if TYPE_CHECKING:
    from integrable.torus.lattice import Source

MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this fraction of its mean are omitted from the series that starts Newton's method
ROUGH = 1e-4
# modes that move τ by at least this, times the least dt/dτ relative to its mean, are summed in double-doubles, since
# floats would lose digits of τ. The unit is the time in which the body turns by about a radian
LOUD = 0.05
# the accuracy of a spectrum is SLOW times the frequency of a phase, since slow modes are divided by their frequencies,
# but at best EXTENDED, the accuracy of samples in long doubles
SLOW = 1e-13
EXTENDED = 32 * float(np.finfo(np.longdouble).eps)
ROUNDING = EXTENDED / 4
# a mode is dropped only if it moves τ by less than this, in the unit of LOUD, because a slow mode may be small in 1/g
LEAST_SWING = 1e-17
# from DENSE_FROM ascending times on, with at least DENSE of them per node, interpolation on panels is faster
DENSE_FROM = 5000
DENSE = 3


class TorusFlow(BodyTorus):
    """γ and M at any times of a motion, in the user's units, from a :class:`~integrable.moving_point.setup.Setup`.

    PrecisionLoss where the torus is not compact, or needs more than ``most`` samples of 1/g. NotClosed where the loops
    lose too many digits. ``exact`` are loops with more digits for the set-up.
    """

    way = "torus"

    def __init__(self, setup: Source, loops: Loops, most: int = MOST_SAMPLES, exact: Loops | None = None) -> None:
        super().__init__(setup, loops, most, exact)
        time_scale, half_step = loops.floats(self._problem[TIME_SCALE : HALF_STEP + 1])[
            :: HALF_STEP - TIME_SCALE
        ].tolist()
        # a basic step in units of τ
        self._step = 2 * half_step / time_scale
        self.clock: TorusClock | None = None
        self._lengths: dict[str, float] = {}
        if self._rolls:
            spectrum = resolved_spectrum(loops, self.resolved, self._turns, self._scale, loops.noise)
            noise = max(self.closure, loops.noise / 64)
            self.clock = TorusClock(loops, spectrum, self.rates[4:], self._scale, noise, self.doubled)

    def _check(self, found: Row) -> None:
        if not all(map(isfinite, self._of_rates(4 if self._rolls else 6, 8))):
            raise NotClosed(BEYOND)
        super()._check(found)

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """γ and M, and τ, at physical times: arrays of shapes (N, 6) and (N,).

        Ascending times are interpolated by panels of Chebyshev series if there are many per panel.
        """
        if not self.clock:
            return self.at_tau(times), times
        panels = self._panels(self._rows_at, times)
        if panels is None:
            rows, tau, _ = self._rows_of_clock(times)
            return rows, tau
        rows = panels.at(times, self.loops.panel_values)
        return rows[:, :6], times / float(self.mean) + rows[:, 6]

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        if not self.clock:
            return tau
        self._within(tau, self._turns)
        return self.clock.times(tau)

    def at_tau(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ, shape (N, 6)."""
        panels = self._panels(self._rows_at_tau, tau)
        return self._rows_at_tau(tau) if panels is None else panels.at(tau, self.loops.panel_values)

    def phases(self, times: np.ndarray, physical: bool, periods: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Both phases at physical times, or at values of τ unless ``physical``, each divided by its entry of
        ``periods``, modulo 1. They keep the digits that a rounded τ has lost.
        """
        rates: Sequence[Real]
        rates, rest = self.frequencies, np.zeros(len(times))
        if physical and self.clock:
            rates, rest = self.loops.wide(self.rates[4:6], self.setup.wide), self._rows_of_clock(times)[2]
        found = []
        for n, rate, nu in zip(periods, rates, self.frequencies, strict=True):
            # wide numbers keep the fractions of many turns
            turns = [x * rate / n for x in times.tolist()]
            found.append(np.array([float(x - int(x)) for x in turns]) + rest * float(nu / n))
        return found[0], found[1]

    def _panels(self, states: States, times: np.ndarray) -> Panels | None:
        """Panels over these times; None where evaluation time by time is faster or panels do not converge."""
        if len(times) < DENSE_FROM or not (np.diff(times) >= 0).all():
            return None
        start, end = float(times[0]), float(times[-1])
        if not start < end:
            return None
        length = self._panel_length(states, start, end)
        # panels account for the rounding of a time to first order only, which is enough if the rounding is this small
        near = np.spacing(max(abs(start), abs(end))) < 1e-9 * length
        if not near or len(times) < DENSE * NODES * (end - start) / length:
            return None
        try:
            return Panels(states, start, end, length)
        except PrecisionLoss:
            # motions with fast passages need too many panels; evaluation time by time is as accurate
            return None

    def _panel_length(self, states: States, start: float, end: float) -> float:
        kind = states.__name__
        if kind not in self._lengths or end - start < self._lengths[kind]:
            self._lengths[kind] = panel_length(states, start, end, self._step / 8)
        return min(self._lengths[kind], end - start)

    def _rows_at(self, times: np.ndarray) -> np.ndarray:
        """γ, M and τ − t/mean, shape (N, 7)."""
        rows, _, delays = self._rows_of_clock(times)
        return np.column_stack([rows, delays])

    def _rows_of_clock(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        assert self.clock
        self._within(times, self._of_rates(4, 6))
        return self.clock.at(self.torus, times)

    def _rows_at_tau(self, tau: np.ndarray) -> np.ndarray:
        out = np.empty(6 * len(tau))
        self._within(tau, self._turns)
        self.loops.states_at_tau(self.torus, self.rates[6:8], tau, out)
        return out.reshape(-1, 6)

    def _within(self, times: np.ndarray, rates: list[float]) -> None:
        turns = np.abs(times).max(initial=0) * max(map(abs, rates))
        if turns > MOST_TURNS:
            raise PrecisionLoss(
                f"time {np.abs(times).max()}: {turns:.1e} turns of a phase are more than the {MOST_TURNS:.1e} whose "
                "fractions double-double numbers hold; use more digits"
            )

    @property
    def _rolls(self) -> bool:
        """Whether the body rolls, so that physical time differs from τ."""
        return bool(self.loops.floats(self._problem[HEAVINESS : HEAVINESS + 1])[0] != 0)

    @cached_property
    def _scale(self) -> float:
        """One unit of τ in units of the flow's own time."""
        return float(self.loops.floats(self._problem[TIME_SCALE : TIME_SCALE + 1])[0])

    @cached_property
    def _turns(self) -> list[float]:
        """The turns of each phase per unit of τ."""
        return self._of_rates(6, 8)

    def _of_rates(self, begin: int, end: int) -> list[float]:
        found: list[float] = self.loops.floats(self.rates[begin:end]).tolist()
        return found


class RateSpectrum(NamedTuple):
    """Fourier coefficients of dt/dτ on a torus, in the layout of :mod:`integrable.torus.clock_modes`, and the shape of
    the grid that resolves them. ``least`` is the smallest sample divided by the mean: where dt/dτ is small, τ amplifies
    errors of t.
    """

    values: Row
    grid: tuple[int, int]
    least: float


def resolved_spectrum(
    loops: Loops,
    resolved: Callable[[Transform[RateSpectrum]], RateSpectrum],
    turns: Sequence[float],
    scale: float,
    noise: float,
) -> RateSpectrum:
    """The spectrum of dt/dτ to ``noise`` of its largest mode, with more digits in the direction of a slow phase, since
    slow modes are divided by their frequencies.

    ``resolved(transformed)`` returns the result of ``transformed`` on a grid that is fine enough. ``turns`` are the
    turns of both phases per unit of τ, ``scale`` is as for :class:`TorusClock`.
    """

    def transformed(samples: np.ndarray) -> tuple[RateSpectrum, tuple[int, int]]:
        high = samples if samples.ndim == 2 else samples[:, :, 0]
        least = float(high.min() / high.mean())
        first, second = (min(noise, max(EXTENDED, min(noise * least, SLOW * abs(nu) / scale))) for nu in turns)
        values, wanted = loops.spectrum(samples, (first, second))
        return RateSpectrum(values, samples.shape[:2], least), wanted

    return resolved(transformed)


class TorusClock:
    """t(τ) and τ(t) of a motion on a torus whose dt/dτ has a ``spectrum``, in the user's units.

    ``rates`` are what :func:`integrable.torus.theta_setup.surveyed_rates` writes after the matrix. In a time τ of
    1/``scale`` the body turns by about a radian. Modes below ``noise`` of the largest are left out; ``doubled`` are the
    periods of dt/dτ in turns. PrecisionLoss where a mode is in resonance.
    """

    def __init__(
        self,
        loops: Loops,
        spectrum: RateSpectrum,
        rates: Row,
        scale: float,
        noise: float,
        doubled: tuple[int, int] = (1, 1),
    ) -> None:
        self._loops = loops
        values, grid, least = spectrum
        limits = Cutoffs(ROUNDING, noise * least, LEAST_SWING * least / scale, ROUGH, LOUD * least / scale)
        # the loops count phases in periods of dt/dτ
        series = series_between(loops, values, grid, rates[6:], limits)
        self._clock = loops.packed(Clock(doubled, *series, rates[:6]))
        self._room = 2 * max(part.width for part in series[:2])

    def at(self, torus: Torus | Packed, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(γ and M, τ, τ − t·mean dτ/dt) at physical times, of shapes (N, 6), (N,) and (N,). ``torus`` is packed."""
        out, tau, delays = np.empty(6 * len(times)), np.empty(len(times)), np.empty(len(times))
        room = np.empty(self._room), self._loops.room(2 * len(times)), np.empty(2 * len(times), dtype=np.int64)
        self._loops.states_at_times(torus, self._clock, times, (tau, delays, out), room)
        return out.reshape(-1, 6), tau, delays

    def phases(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(phases in turns, τ − t·mean dτ/dt) at physical times; the two phases of a time are adjacent."""
        phases, delays = self._loops.room(2 * len(times)), np.empty(len(times))
        self._loops.phases_at_times(self._clock, times, phases, delays, np.empty(self._room))
        return phases, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        times = np.empty(len(tau))
        self._loops.times_at_tau(self._clock, tau, times, np.empty(self._room))
        return times


def series_between(
    loops: Loops, values: Row, grid: tuple[int, int], rates: Row, limits: Cutoffs
) -> tuple[ClockSeries, ClockSeries, ClockSeries, np.ndarray, Row]:
    """The fields ``rough``, ``series``, ``quiet``, ``modes`` and ``loud`` of a :class:`Clock`, from a spectrum of 1/g.

    PrecisionLoss where a mode is in resonance.
    """
    size, height = grid[0] // 2 * grid[1], grid[0] // 2
    floats, lines = np.empty((4, 4 * size)), np.empty((2, 3 * height), dtype=np.int64)
    pairs, counts = np.empty(2 * MOST_LOUD, dtype=np.int64), np.empty(9, dtype=np.int64)
    tables, loud = (
        Tables(floats[0], lines[0], floats[1], lines[1], floats[2], floats[3], pairs, counts),
        loops.room(2 + 2 * MOST_LOUD),
    )
    bound, origin, rest, mean = loops.clock_series(values, grid, rates, limits, tables, loud)
    *found, count = counts.tolist()
    if count < 0:
        k, i = divmod(-1 - count, grid[1])
        raise in_resonance(k, i - grid[1] // 2)
    first, second = loops.floats(rates[:2]).tolist()

    def packed(sizes: list[int], own: np.ndarray, parts: np.ndarray, origin: float) -> ClockSeries:
        # the used parts are copied, so that the working memory is freed
        least, width, used, total = sizes
        kept = own[: 3 * used].copy(), parts[: 4 * total].copy()
        return ClockSeries(*kept, least, width, (first, second), bound, origin, mean)

    whole, rough = packed(found[:4], lines[0], floats[1], origin), packed(found[4:], lines[1], floats[2], origin)
    quiet = packed(found[:4], lines[0], floats[3], rest) if count else whole
    return rough, whole, quiet, pairs[: 2 * count], loud[: 2 + 2 * count]
