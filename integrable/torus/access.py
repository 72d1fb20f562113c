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
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.bare_problem import HEAVINESS, TIME_SCALE
from integrable.torus.clock_loops import Clock, Series
from integrable.torus.clock_modes import MOST_LOUD, Limits, Tables
from integrable.torus.corners import Corners, Samples
from integrable.torus.loops import BEYOND, NotClosed
from integrable.torus.panels import NODES, Panels, States, panel_length
from integrable.torus.series import in_resonance
from integrable.torus.tables import Room
from integrable.torus.witness import ALIKE, TERMS, Line, confirmed, witnesses
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# more turns of a phase than this leave no digits of a float behind
MOST_TURNS = 2.0**50
MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this part of its mean are left out of the series that Newton starts with
ROUGH = 1e-4
# modes by which τ swings this much, in units in which the body turns by some part of a radian, are summed in
# double-double numbers
LOUD = 0.05
# a direction of the torus is resolved to this part of its frequency, but not beyond what the long doubles of this
# machine hold
SLOW = 1e-13
EXTENDED = 32 * float(np.finfo(np.longdouble).eps)
ROUNDING = EXTENDED / 4
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
        if self._rolls:
            spectrum = resolved_spectrum(self, self._turns, self._scale)
            self.clock = TorusClock(self, *spectrum, self.rates[4:], self._scale)

    def _check_walk(self) -> None:
        if not all(map(isfinite, self._of_rates(4 if self._rolls else 6, 8))):
            raise NotClosed(BEYOND)
        # before the borders of cells: these say of a wrong sign that digits are lost
        tau = witnesses(self._turns)
        out = np.empty(12 * len(tau))
        near = self.loops.departure(self.torus, *self._line(tau), out) <= ALIKE
        if not near and not confirmed(self.setup, tau, *out.reshape(2, -1, 6)):
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
            rates, rest = self.loops.wide(self.rates[4:6], self.setup.wide), self.clock.at(times)[2]
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
        self._check(tau, self._turns)
        self.loops.states_at_tau(self.torus, self.rates[6:8], tau, out)
        return out.reshape(-1, 6)

    def reached(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ by additions to the start, without periods and corners: shape (N, 6)."""
        out = np.empty(6 * len(tau))
        self.loops.reached(*self._line(tau), out)
        return out.reshape(-1, 6)

    def _line(self, tau: np.ndarray) -> tuple[Line, np.ndarray, Room, Any]:
        """What the loops take to add to the start up to these times, with room for that."""
        room = self.loops.room
        # where branch points had been close together, the flow's own centre is far from all of them
        far = self.units.length < 1
        line = Line(self._packed_curve, self._start, self._motion, self.rates, self.lattice.chart.centres, far)
        return line, tau, Room(room(TERMS), room(TERMS), room(9), room(0)), room(10 * len(tau))

    def _check(self, times: np.ndarray, rates: list[float]) -> None:
        turns = np.abs(times).max(initial=0) * max(map(abs, rates))
        if turns > MOST_TURNS:
            raise PrecisionLoss(
                f"time {np.abs(times).max()}: {turns:.1e} turns of a phase are more than the {MOST_TURNS:.1e} whose "
                "fractions double-double numbers hold; use more digits"
            )

    @property
    def _rolls(self) -> bool:
        """Whether there is a clock."""
        return bool(self.loops.floats(self._problem[HEAVINESS : HEAVINESS + 1])[0] != 0)

    @cached_property
    def _scale(self) -> float:
        """Units of the flow's own time in one of τ."""
        return float(self.loops.floats(self._problem[TIME_SCALE : TIME_SCALE + 1])[0])

    @cached_property
    def _turns(self) -> list[float]:
        """Of both phases in a unit of τ."""
        return self._of_rates(6, 8)

    def _of_rates(self, begin: int, end: int) -> list[float]:
        found: list[float] = self.loops.floats(self.rates[begin:end]).tolist()
        return found


def resolved_spectrum(
    torus: Corners, turns: Sequence[float], scale: float, samples: Samples | None = None
) -> tuple[Any, tuple[int, int]]:
    """The spectrum of 1/g, or of what has other ``samples``, as :mod:`integrable.torus.clock_modes` has it, and the
    shape of its grid: in slow directions to more digits, they will be divided by its frequency. ``turns`` are those of
    both phases in a unit of τ, ``scale`` is as for :class:`TorusClock`.
    """
    loops = torus.loops
    first, second = (min(loops.noise, max(EXTENDED, SLOW * abs(nu) / scale)) for nu in turns)

    def transformed(samples: np.ndarray) -> tuple[Any, tuple[int, int]]:
        values, wanted = loops.spectrum(samples, (first, second))
        return (values, samples.shape[:2]), wanted

    found: tuple[Any, tuple[int, int]] = torus.resolved(transformed, samples)
    return found


class TorusClock:
    """t(τ) and τ(t) of a flow on a torus, in the user's units, of the spectrum of dt/dτ and the shape of its grid.

    ``rates`` are those of :func:`integrable.torus.survey.rates` without the matrix; in the unit 1/``scale`` of τ the
    motion moves by some part of a radian.
    """

    def __init__(self, flow: Any, values: Any, grid: tuple[int, int], rates: Any, scale: float) -> None:
        self._flow = flow
        noise = max(flow.closure, flow.loops.noise / 64)
        limits = Limits(ROUNDING, noise, LEAST_SWING / scale, ROUGH, LOUD / scale)
        # the loops count phases in periods of 1/g
        series = series_of(flow.loops, values, grid, rates[6:], limits)
        self._clock = flow.loops.packed(Clock(flow.doubled, *series, rates[:6]))
        self._room = 2 * max(part.width for part in series[:2])

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(γ and M, τ, τ − t·mean dτ/dt) at physical times, shapes (N, 6), (N,) and (N,)."""
        flow = self._flow
        flow._check(times, flow._of_rates(4, 6))
        out, tau, delays = np.empty(6 * len(times)), np.empty(len(times)), np.empty(len(times))
        room = np.empty(self._room), flow.loops.room(2 * len(times)), np.empty(2 * len(times), dtype=np.int64)
        flow.loops.states_at_times(flow.torus, self._clock, times, (tau, delays, out), room)
        return out.reshape(-1, 6), tau, delays

    def phases(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(the phases in turns, as the loops' numbers one pair after the other, τ − t·mean dτ/dt) at physical times."""
        loops, delays = self._flow.loops, np.empty(len(times))
        phases = loops.room(2 * len(times))
        loops.phases_at_times(self._clock, times, phases, delays, np.empty(self._room))
        return phases, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        flow = self._flow
        flow._check(tau, flow._turns)
        times = np.empty(len(tau))
        flow.loops.times_at_tau(self._clock, tau, times, np.empty(self._room))
        return times


def series_of(
    loops: Any, values: Any, grid: tuple[int, int], rates: Any, limits: Limits
) -> tuple[Series, Series, Series, np.ndarray, Any]:
    """What a :class:`Clock` has between ``doubled`` and ``pace``, of a spectrum of 1/g (:func:`clock_series`).

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

    def packed(sizes: list[int], own: np.ndarray, parts: np.ndarray, origin: float) -> Series:
        # of the room only what is used is kept
        least, width, used, total = sizes
        kept = own[: 3 * used].copy(), parts[: 4 * total].copy()
        return Series(*kept, least, width, (first, second), bound, origin, mean)

    whole, rough = packed(found[:4], lines[0], floats[1], origin), packed(found[4:], lines[1], floats[2], origin)
    quiet = packed(found[:4], lines[0], floats[3], rest) if count else whole
    return rough, whole, quiet, pairs[: 2 * count], loud[: 2 + 2 * count]
