"""Integrals along a motion of functions of the state with mean 0, by a Fourier series on the torus."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from integrable.torus.corners import resolved
from integrable.torus.series import TorusSeries, needed_sizes, spectrum

if TYPE_CHECKING:
    from integrable.motion.trajectory import Trajectory
    from integrable.torus.access import TorusFlow

FIRST_SIZE = 32
# largest number of samples if states are compiled, and if interpreted
MOST_SAMPLES, MOST_INTERPRETED = 1 << 18, 1 << 12
# modes below this fraction of the largest are rounding
NOISE = 1e-15
TINY = 1e-300


class TorusIntegral:
    """∫_0^τ F dτ for F with mean 0, F = ``function`` of states (γ and M side by side, shape (N, 6)), of shape (N, m).

    F may change sign with an odd number of the γ_i: its periods are then twice those of the divisor. ``least`` (m) is
    the size of rounding errors in F. PrecisionLoss where no grid of at most MOST_SAMPLES points resolves F.
    """

    def __init__(self, flow: TorusFlow, function: Callable[[np.ndarray], np.ndarray], least: np.ndarray) -> None:
        self._flow, self._function = flow, function
        self._doubled = [2 if np.prod(row) < 0 else 1 for row in flow.turns]

        def transformed(samples: np.ndarray) -> tuple[list[tuple[np.ndarray, float]], tuple[int, int]]:
            grids = [spectrum(part) for part in np.moveaxis(samples, -1, 0)]
            noises = [
                max(NOISE, x / max(np.abs(grid).max(), x, TINY)) for x, grid in zip(least.tolist(), grids, strict=True)
            ]
            found = list(zip(grids, noises, strict=True))
            wanted = [needed_sizes(grid, (x, x)) for grid, x in found if grid.any() and x < 1 / 64]
            shape = samples.shape[:2]
            return found, (max([shape[0], *(n for n, _ in wanted)]), max([shape[1], *(n for _, n in wanted)]))

        most = MOST_SAMPLES if flow.compiled else MOST_INTERPRETED
        found = resolved(self._sampled, transformed, (FIRST_SIZE, FIRST_SIZE), most)
        first, second = (x / n for x, n in zip(flow.frequencies, self._doubled, strict=True))
        self._series = [TorusSeries(grid, (first, second), noise=max(x, flow.closure)) for grid, x in found]

    def _sampled(self, sizes: tuple[int, int], known: np.ndarray | None) -> np.ndarray:
        """The samples of F on a grid over its periods, shape (*sizes, m); ``known`` are those on a coarser grid."""
        phases = [n * np.arange(size) / size for n, size in zip(self._doubled, sizes, strict=True)]
        grid = np.stack(np.meshgrid(*phases, indexing="ij"), axis=-1)
        new = np.ones(sizes, dtype=bool)
        if known is not None:
            places = tuple(slice(None, None, n // m) for n, m in zip(sizes, known.shape, strict=False))
            new[places] = False
        values = self._function(self._flow.at_phases(grid[new]))
        samples = np.empty((*sizes, values.shape[1]))
        samples[new] = values
        if known is not None:
            samples[places] = known
        return samples

    def at(self, run: Trajectory) -> np.ndarray:
        """The integrals at the times of a run, shape (N, m); the phases keep digits that a rounded τ has lost."""
        physical = not run.given_in_tau
        phases = self._flow.phases(run.times if physical else run.tau, physical, self._doubled)
        return np.stack([series.at(*phases) for series in self._series], axis=1)
