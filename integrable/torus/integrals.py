"""Integrals along a motion of functions of its state with mean 0, at any time: Fourier series on the real torus, in
floats, and in multiprecision like that of 1/g in :mod:`integrable.torus.long_clock`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from integrable.moving_point.addition import Row, moving_point, shift
from integrable.torus.corners import Corners, resolved
from integrable.torus.long_clock import phases
from integrable.torus.loops import ReadableLoops
from integrable.torus.series import LongSeries, TorusSeries, long_spectrum, needed_sizes, spectrum, together
from integrable.torus.states import turned
from integrable.torus.walks import KNOWN
from jacobian.element import Real
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup
    from integrable.torus.access import TorusFlow

FIRST_SIZE = 32
# largest number of samples in floats, if states are compiled, and if interpreted; states computed together
MOST_COMPILED, MOST_INTERPRETED, CHUNK = 1 << 18, 1 << 12, 1 << 13
# modes in floats below this fraction of the largest are rounding
NOISE = 1e-15
TINY = 1e-300
# number of samples in multiprecision that takes some seconds; beyond it, the number per squared digit
MOST_SAMPLES, SAMPLES_A_DIGIT = 1 << 15, 32

Function = Callable[[np.ndarray], np.ndarray]
"""A function of states, γ and M side by side, shape (N, 6), that gives m numbers for each, shape (N, m)."""
Pairs = Callable[[list[Row]], Sequence[Sequence[Real]]]
"""A function that gives two bare reals for each of several moving points."""


class TimedRun(Protocol):
    """A run of states at physical times, or at values of τ."""

    times: np.ndarray
    tau: np.ndarray
    given_in_tau: bool


class TorusIntegral:
    """∫_0^τ F dτ for F with mean 0.

    F may change sign with an odd number of the γ_i: its periods are then twice those of the divisor. ``least`` (m) is
    the size of rounding errors in F. PrecisionLoss where no grid of at most MOST_COMPILED points resolves F.
    """

    def __init__(self, flow: TorusFlow, function: Function, least: np.ndarray) -> None:
        self._flow = flow

        def noise(most: np.ndarray) -> np.ndarray:
            return np.maximum(NOISE, least / np.maximum(np.maximum(most, least), TINY))

        samples, noises = resolved_samples(flow, function, noise)
        self._doubled = periods_of(flow)
        first, second = (x / n for x, n in zip(flow.frequencies, self._doubled, strict=True))
        self._series = [
            TorusSeries(spectrum(part), (first, second), noise=max(noise, flow.closure))
            for part, noise in zip(np.moveaxis(samples, -1, 0), noises, strict=True)
        ]

    def at(self, run: TimedRun) -> np.ndarray:
        """The integrals at the times of a run, shape (N, m); the phases keep digits that a rounded τ has lost."""
        physical = not run.given_in_tau
        times = run.times if physical else run.tau
        return together(self._series, *self._flow.phases(times, physical, self._doubled))

    def swings_and_rates(self, phases: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each part of F, its integral less the mean rate, and F, both at phases (N, 2) in turns."""
        first, second = (phases / self._doubled).T
        return [series.swings_and_rates(first, second) for series in self._series]


def periods_of(flow: TorusFlow) -> tuple[int, int]:
    """The periods, in turns of both phases, of functions that may change sign with an odd number of the γ_i."""
    first, second = (2 if np.prod(row) < 0 else 1 for row in flow.turns)
    return first, second


def resolved_samples(
    flow: TorusFlow, function: Function, noise: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Samples of F on a grid over :func:`periods_of` that resolves it, (rows, columns, m), and the noise of each part.

    ``noise`` gives it from the largest modes, (m,): modes below this fraction of the largest are rounding.
    """
    doubled = periods_of(flow)

    def sampled(sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
        counts = [n * np.arange(size) / size for n, size in zip(doubled, sizes, strict=True)]
        grid = np.stack(np.meshgrid(*counts, indexing="ij"), axis=-1)
        new = np.ones(sizes, dtype=bool)
        if known is not None:
            places = tuple(slice(None, None, n // m) for n, m in zip(sizes, known.shape, strict=False))
            new[places] = False
        rest = grid[new]
        parts = [function(flow.at_phases(rest[begin : begin + CHUNK])) for begin in range(0, len(rest), CHUNK)]
        samples = np.empty((*sizes, parts[0].shape[1]))
        samples[new] = np.concatenate(parts)
        if known is not None:
            samples[places] = known
        return samples

    def transformed(samples: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray], tuple[int, int]]:
        grids = [np.abs(spectrum(part)) for part in np.moveaxis(samples, -1, 0)]
        noises = noise(np.array([grid.max() for grid in grids]))
        seen = [(grid, x) for grid, x in zip(grids, noises.tolist(), strict=True) if grid.any() and x < 1 / 64]
        wanted = [needed_sizes(grid, (x, x)) for grid, x in seen]
        rows, columns = zip(samples.shape[:2], *wanted, strict=True)
        return (samples, noises), (max(rows), max(columns))

    found: tuple[np.ndarray, np.ndarray] = resolved(
        sampled, transformed, (FIRST_SIZE, FIRST_SIZE), MOST_COMPILED if flow.compiled else MOST_INTERPRETED
    )
    return found


class LongIntegral:
    """∫_0^τ F dτ for two functions F with mean 0, to ``digits`` relative to their size; τ in the units of the set-up.

    F may change sign with an odd number of the γ_i. PrecisionLoss where the torus degenerates, or takes too many
    samples.
    """

    def __init__(self, setup: Setup, digits: int, function: Pairs) -> None:
        loops = ReadableLoops(setup, digits)
        self._wide, self._reals = setup.wide, loops.reals
        corners = _Values(setup, loops, max(MOST_SAMPLES, SAMPLES_A_DIGIT * digits**2), function)
        nu = [rate / n / setup.time_scale for rate, n in zip(corners.frequencies, corners.doubled, strict=True)]
        self._frequencies = nu[0], nu[1]
        noise = 8 * loops.noise

        def transformed(samples: np.ndarray) -> tuple[np.ndarray, tuple[int, int]]:
            grid = long_spectrum(samples, loops.reals)
            return grid, needed_sizes(grid, (noise, noise))

        both = corners.resolved(transformed)
        # separate the modes of the real and the imaginary part: c and the conjugate of its opposite
        with loops.reals:
            other = np.roll(both[::-1, ::-1], (1, 1), axis=(0, 1))
            other = np.frompyfunc(lambda c: c.conjugate(), 1, 1)(other)
            parts = (both + other) / 2, (both - other) / (2 * loops.reals.i)
        most = np.abs(both).max()
        self._series = []
        for grid in parts:
            size = np.abs(grid).max()
            least = float(min(1, loops.noise * most / size)) if size else 1.0
            self._series.append(LongSeries(self._half_plane(grid), self._frequencies, self._wide, least))

    def at(self, tau: Real) -> tuple[Real, Real]:
        """Both integrals at τ, wide numbers."""
        angles = phases(tau, self._frequencies, self._wide)
        first, second = (series.at([angles])[0] for series in self._series)
        return first, second

    def _half_plane(self, grid: np.ndarray) -> list[list[Real]]:
        """The modes of a grid in the form that :class:`~integrable.torus.series.LongSeries` takes."""
        from flint import acb

        rows, most = (grid.shape[0] + 1) // 2, grid.shape[1] // 2 - 1
        element, wide, balls = self._reals.element, self._wide, BallReals(self._reals.bits)

        def number(c: Any) -> acb:
            return acb(*(balls.number(element(wide, x)) for x in (c.real, c.imag)))

        with balls:
            return [[number(grid[k, m]) for m in range(-most, most + 1)] for k in range(rows)]


class _Values(Corners):
    """Samples of F₁ + iF₂."""

    def __init__(self, setup: Setup, loops: ReadableLoops, most: int, function: Pairs) -> None:
        super().__init__(setup, loops, most)
        self._function = function
        self.doubled = (1 + self.odd[0], 1 + self.odd[1])

    def samples(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> np.ndarray:
        places, points = zip(*self._points(sizes, known), strict=True)
        blocks = []
        with self.loops.reals as reals:
            for i in range(self.doubled[0]):
                for j in range(self.doubled[1]):
                    here = [self._turned(point, i, j) for point in points]
                    values = [x + reals.i * y for x, y in self._function(here)]
                    table = np.empty(sizes, dtype=object)
                    for place, value in zip(places, values, strict=True):
                        table[place] = value
                    blocks.append(table)
        width = self.doubled[1]
        whole = np.block([blocks[width * i : width * (i + 1)] for i in range(self.doubled[0])])
        return self.completed(whole, known)

    def _points(self, sizes: tuple[int, int], known: np.ndarray | None) -> Iterator[tuple[tuple[int, int], Row]]:
        """((row, column), moving point) for every point of the grid whose value is not known."""
        (rows, columns), fine = self.sizes, self.fine(sizes, known)
        self.loops.offsets(self._packed_curve, self._packed_small, fine)
        above, left = (fine.finer[0] - 1) // 2, (fine.finer[1] - 1) // 2
        # ν in the units of the set-up
        lift, f, axes = self.units.lift, self.curve.f, self.curve.axes
        for i, j in np.ndindex(rows, columns):
            corner = moving_point(self.states, (i * columns + j) * 10)
            for n, (a, b) in enumerate(np.ndindex(*fine.finer)):
                if fine.counts[n] == KNOWN:
                    continue
                point = corner
                with self.loops.reals:
                    for k in range(fine.counts[n]):
                        point = shift(f, axes, point, moving_point(fine.steps, 20 * n + 10 * k))
                    point = (*point[:7], *(lift * x for x in point[7:]))
                    row, column = i * fine.finer[0] + a - above, j * fine.finer[1] + b - left
                    point = self._turned(point, row < 0, column < 0)
                yield (row % sizes[0], column % sizes[1]), point

    def _turned(self, point: Row, first: int, second: int) -> Row:
        """The point one period further in the first direction, then in the second."""
        if first:
            point = turned(point, self.signs, 0)
        return turned(point, self.signs, 3) if second else point
