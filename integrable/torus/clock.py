"""Times on the torus of a motion: the range of times whose phases double-doubles resolve and, in genus 2, physical time
t(τ) from samples of dt/dτ.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import ceil, log2, log10
from typing import NamedTuple, TypeVar

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.arithmetic import MOST_TURNS, too_many_turns
from integrable.torus.clock_loops import Clock, ClockRoom, ClockSeries
from integrable.torus.clock_modes import MOST_LOUD, Cutoffs, Tables
from integrable.torus.lifts import TOGETHER, RateSums, Torus
from integrable.torus.loops import Loops
from integrable.torus.series import in_resonance
from integrable.torus.theta_series import float_circle
from jacobian.errors import PrecisionLoss

# a first grid has at least this many points in each direction
FIRST_SIZE = 16
# a first grid of 1/g has POINTS·digits/(the result of :func:`shortest`) points in each direction; a finer grid is
# rarely needed
POINTS = 1.8
# the largest number of samples of a rate; only a motion whose branch points nearly coincide needs more
MOST_SAMPLES = 1 << 18
# coefficients of 1/g below this fraction of its mean are omitted from the series that starts Newton's method
ROUGH = 1e-4
# a mode is loud, and is summed in double-doubles, if its amplitude in τ is LOUD·(least dt/dτ)/(mean dt/dτ) or more;
# floats would lose digits of τ in it. Amplitudes are in units of the time in which the body turns by about a radian
LOUD = 0.05
# slow modes are divided by their frequency. So the error of a spectrum is at most SLOW times the frequency of a phase,
# or EXTENDED if that is more. Modes below ROUNDING times the largest, which rounding may have made, are left out
SLOW = 1e-13
EXTENDED, ROUNDING = 2.0**-58, 2.0**-90
# a mode is dropped only if it moves τ by less than this fraction of the time in which the body turns by a radian: a
# slow mode may be small in 1/g and still move τ
LEAST_SWING = 1e-17
# turns of a phase at the times of :meth:`FarTimes.witnesses`: more than one in either direction, so that sign changes
# of the γ_i after a turn are tested
TURNS = (1.23, -1.38)
# beyond this number of turns of a phase, a time in floats no longer determines the fraction of a turn
FAR = 2.0**48


Samples = Callable[[tuple[int, int], "np.ndarray | None"], np.ndarray]
"""A function that computes values on a grid of the given sizes, except those known from a coarser grid, if any."""
Found = TypeVar("Found")
Transform = Callable[[np.ndarray], tuple[Found, tuple[int, int]]]
"""A function that returns a result computed from samples, and the shape of a grid that is fine enough."""


class FarTimes:
    """The times that a torus reaches, and those at which it is compared with another method.

    ``paces`` are the turns of the torus's phases per unit of time. Up to ``most`` turns of a phase, double-doubles
    resolve the fraction of a turn.
    """

    paces: Sequence[float]
    most = MOST_TURNS

    @property
    def witnesses(self) -> np.ndarray:
        """Two times for each phase, one positive and one negative, in which it makes more than one turn. So they test
        the sign changes of the γ_i after a turn.
        """
        # beyond ``farthest`` a time in floats does not determine the faster phase, so no sign needs a test there
        farthest = FAR / max(map(abs, self.paces))
        return np.array([min(max(turns / nu, -farthest), farthest) for nu in self.paces for turns in TURNS])

    def reaches(self, times: np.ndarray) -> bool:
        """Whether double-doubles resolve the fraction of a turn at all of these times."""
        return turns_in(times, self.paces) <= self.most


def turns_in(times: np.ndarray, paces: Sequence[float]) -> float:
    """The turns of the fastest phase in the longest of the times."""
    return float(np.abs(times).max(initial=0)) * max(map(abs, paces))


def check_turns(times: np.ndarray, paces: Sequence[float], most: float = MOST_TURNS) -> None:
    """Raises PrecisionLoss if a phase makes more than ``most`` turns in one of the times."""
    turns = turns_in(times, paces)
    if turns > most:
        raise too_many_turns(np.abs(times).max(), turns, most)


def samples_of(
    loops: Loops,
    torus: Torus,
    rate: RateSums,
    odd: tuple[bool, bool],
    sizes: tuple[int, int],
    known: np.ndarray | None = None,
) -> np.ndarray:
    """dt/dτ, as the sums ``rate`` define it, on a grid with ``sizes`` points per period of the divisor.

    Where ``odd``, the tilt term of ``rate`` changes its sign after that period. So the rate of a tilted body has twice
    the period, and twice as many points. Compiled loops give double-doubles with a last axis. ``known`` are the samples
    of a coarser grid.
    """
    (rows, columns), (down, across) = sizes, (1 + (rate.tilted and odd[0]), 1 + (rate.tilted and odd[1]))
    coarser = (0, 0) if known is None else (rows * down // known.shape[0], columns * across // known.shape[1])
    if coarser[1] > TOGETHER:
        coarser = 0, 0
    first, other = loops.room(rows * columns), loops.room(rows * columns)
    room = loops.room(rate.classes * torus[0].sizes[1] * (4 * TOGETHER + 2 * rows))
    loops.gridded(torus, loops.packed(rate), sizes, coarser, room, first, other)
    table = loops.samples(first, sizes)
    if (down, across) != (1, 1):
        beside = loops.samples(other, sizes)
        whole = np.empty((down, rows, across, columns, *table.shape[2:]), dtype=table.dtype)
        for i, j in np.ndindex(down, across):
            whole[i, :, j] = beside if (i * odd[0] + j * odd[1]) % 2 else table
        table = whole.reshape(down * rows, across * columns, *table.shape[2:])
    if known is not None:
        table[:: table.shape[0] // known.shape[0], :: table.shape[1] // known.shape[1]] = known
    return table


def first_grid(noise: float, decay: tuple[float, float]) -> tuple[int, int]:
    """The numbers of points of the first grid, powers of 2; ``decay`` is the result of :func:`shortest`."""
    points = -POINTS * log10(noise)
    first, second = (max(FIRST_SIZE, 2 ** ceil(log2(max(1, points / y)))) for y in decay)
    return first, second


def resolved(samples: Samples, transformed: Transform[Found], sizes: tuple[int, int], most: int) -> Found:
    """The result of ``transformed`` on the first grid that is fine enough; ``sizes`` are those of the coarsest grid.

    PrecisionLoss if more than ``most`` samples are needed.
    """
    known: np.ndarray | None = None
    while sizes[0] * sizes[1] <= most:
        known = samples(sizes, known)
        found, wanted = transformed(known)
        shape = known.shape[:2]
        if wanted == shape:
            return found
        sizes = (sizes[0] * wanted[0] // shape[0], sizes[1] * wanted[1] // shape[1])
    raise PrecisionLoss(f"a rate needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")


class RateSpectrum(NamedTuple):
    """Fourier coefficients of dt/dτ on a torus, in the layout of :mod:`integrable.torus.clock_modes`, and the shape of
    the grid that resolves them. ``least`` is the smallest sample divided by the mean: where dt/dτ is small, an error
    of t becomes a larger one of τ.
    """

    values: Row
    grid: tuple[int, int]
    least: float


def resolved_spectrum(
    loops: Loops,
    samples: Samples,
    sizes: tuple[int, int],
    most: int,
    turns: Sequence[float],
    scale: float,
    noise: float,
) -> RateSpectrum:
    """The spectrum of dt/dτ to ``noise`` of its largest mode, with more digits in the direction of a slow phase, since
    slow modes are divided by their frequencies.

    The first grid has ``sizes``, the last at most ``most`` points. ``turns`` are the turns of both phases per unit of
    τ, ``scale`` is as for :class:`TorusClock`.
    """

    def transformed(samples: np.ndarray) -> tuple[RateSpectrum, tuple[int, int]]:
        high = samples if samples.ndim == 2 else samples[:, :, 0]
        least = float(high.min() / high.mean())
        first, second = (min(noise, max(EXTENDED, min(noise * least, SLOW * abs(nu) / scale))) for nu in turns)
        values, wanted = loops.spectrum(samples, (first, second))
        return RateSpectrum(values, samples.shape[:2], least), wanted

    return resolved(samples, transformed, sizes, most)


class TorusClock:
    """t(τ) and τ(t) of a motion on a torus whose dt/dτ has a ``spectrum``, in the user's units.

    ``rates`` are the turns of both phases per unit of τ, the mean of dt/dτ, and 2π. In a time τ of 1/``scale`` the body
    turns by about a radian. Modes below ``noise`` times the largest are left out if they hardly move τ
    (:class:`~integrable.torus.clock_modes.Cutoffs`). ``doubled`` are the periods of dt/dτ in turns. PrecisionLoss where
    a mode is in resonance.

    Near a resonance τ − t·(mean dτ/dt) oscillates by many turns, which amplify the rounding of phases. As long as a
    phase makes at most ``most`` turns, this rounding changes γ by a few units of the last bit of a float.
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
        least = spectrum.least
        limits = Cutoffs(ROUNDING, noise * least, LEAST_SWING * least / scale, ROUGH, LOUD * least / scale)
        series, pace = series_between(loops, spectrum, (rates, doubled), limits)
        self._clock = loops.packed(Clock(doubled, *series, pace, loops.circle, float_circle()))
        self.most = MOST_TURNS / max(1.0, series[1].bound * float(np.abs(loops.floats(rates[:2])).max()) / 2)

    def phases(self, times: np.ndarray) -> tuple[Row, np.ndarray, np.ndarray]:
        """(phases in turns modulo 2, τ, τ − t·(mean dτ/dt)) at physical times; the phases of a time are adjacent."""
        phases, tau, delays = self._loops.room(2 * len(times)), np.empty(len(times)), np.empty(len(times))
        given = np.ascontiguousarray(times, dtype=np.float64)
        room = ClockRoom._make([*np.empty((5, len(times))), self._loops.room(len(times))])
        self._loops.phases_at_times(self._clock, given, (phases, tau, delays), room)
        return phases, tau, delays

    def times(self, tau: np.ndarray) -> np.ndarray:
        """Physical times at values of τ."""
        times = np.empty(len(tau))
        self._loops.times_at_tau(self._clock, tau, times)
        return times


def series_between(
    loops: Loops, spectrum: RateSpectrum, given: tuple[Row, tuple[int, int]], limits: Cutoffs
) -> tuple[tuple[ClockSeries, ClockSeries, ClockSeries, np.ndarray, Row], Row]:
    """The fields ``rough``, ``series``, ``quiet``, ``modes`` and ``loud`` of a :class:`Clock`, and its ``pace``.
    ``given`` are the ``rates`` and the periods of a :class:`TorusClock`.

    PrecisionLoss where a mode is in resonance.
    """
    (values, grid, _), pace = spectrum, loops.room(6)
    size, height = grid[0] // 2 * grid[1], grid[0] // 2
    floats, lines = np.empty((4, 4 * size)), np.empty((2, 3 * height), dtype=np.int64)
    pairs, counts = np.empty(2 * MOST_LOUD, dtype=np.int64), np.empty(7, dtype=np.int64)
    tables, loud = (
        Tables(floats[0], lines[0], floats[1], lines[1], floats[2], floats[3], pairs, counts),
        loops.room(1 + 2 * MOST_LOUD),
    )
    bound, origin, rest, mean = loops.clock_series(values, grid, given, limits, tables, loud, pace)
    *found, count = counts.tolist()
    if count < 0:
        k, i = divmod(-1 - count, grid[1])
        raise in_resonance(k, i - grid[1] // 2)
    first, second = (loops.floats(given[0][:2]) / given[1]).tolist()

    def packed(sizes: list[int], own: np.ndarray, parts: np.ndarray, origin: float) -> ClockSeries:
        # the used parts are copied, so that the working memory is freed
        least, used, total = sizes
        kept = own[: 3 * used].copy(), parts[: 4 * total].copy()
        return ClockSeries(*kept, least, (first, second), bound, origin, mean)

    whole, rough = packed(found[:3], lines[0], floats[1], origin), packed(found[3:], lines[1], floats[2], origin)
    quiet = packed(found[:3], lines[0], floats[3], rest) if count else whole
    return (rough, whole, quiet, pairs[: 2 * count], loud[: 1 + 2 * count]), pace
