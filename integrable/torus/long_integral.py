"""Integrals along a motion of functions of its state with mean 0, at any time, in multiprecision: a Fourier series on
the real torus, like that of 1/g in :mod:`integrable.torus.long_clock`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point.addition import moving_point, shift
from integrable.torus.corners import Corners
from integrable.torus.long_clock import phases
from integrable.torus.loops import ReadableLoops
from integrable.torus.series import LongSeries, long_spectrum, needed_sizes
from integrable.torus.states import turned
from integrable.torus.walks import KNOWN
from jacobian.numbers.long_reals import BallReals

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

# number of samples that takes some seconds; beyond it, the number per squared digit
MOST_SAMPLES, SAMPLES_A_DIGIT = 1 << 15, 32

Pairs = Callable[[list[tuple[Any, ...]]], list[tuple[Any, Any]]]
"""A function that gives two bare reals for each of several moving points."""


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

        def transformed(samples: Any) -> tuple[np.ndarray, tuple[int, int]]:
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

    def at(self, tau: Any) -> tuple[Any, Any]:
        """Both integrals at τ, wide numbers."""
        angles = phases(tau, self._frequencies, self._wide)
        first, second = (series.at([angles])[0] for series in self._series)
        return first, second

    def _half_plane(self, grid: np.ndarray) -> list[list[Any]]:
        """The modes of a grid in the form that :class:`~integrable.torus.series.LongSeries` takes."""
        from flint import acb

        rows, most = (grid.shape[0] + 1) // 2, grid.shape[1] // 2 - 1
        element, wide, balls = self._reals.element, self._wide, BallReals(self._reals.bits)

        def number(c: Any) -> Any:
            return acb(*(balls.number(element(wide, x)) for x in (c.real, c.imag)))

        with balls:
            return [[number(grid[k, m]) for m in range(-most, most + 1)] for k in range(rows)]


class _Values(Corners):
    """Samples of F₁ + iF₂."""

    def __init__(self, setup: Setup, loops: Any, most: int, function: Pairs) -> None:
        super().__init__(setup, loops, most)
        self._function = function
        self.doubled = (1 + self.odd[0], 1 + self.odd[1])

    def samples(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> Any:
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

    def _points(
        self, sizes: tuple[int, int], known: np.ndarray | None
    ) -> Iterator[tuple[tuple[int, int], tuple[Any, ...]]]:
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

    def _turned(self, point: tuple[Any, ...], first: int, second: int) -> tuple[Any, ...]:
        """The point one period further in the first direction, then in the second."""
        if first:
            point = turned(point, self.signs, 0)
        return turned(point, self.signs, 3) if second else point
