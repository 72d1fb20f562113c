"""Integrals along a motion of functions of its state, at any time: a mean and a Fourier series on the torus."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from integrable.torus_series import TorusSeries, needed_sizes, spectrum
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.torus_flow import TorusFlow

FIRST_SIZE = 32
MOST_SAMPLES = 1 << 18
# relative: modes below this are rounding
NOISE = 1e-15


class TorusIntegral:
    """∫_0^τ F dτ, F = ``function`` of states (γ and M side by side, shape (N, 6)) with values of shape (N, m).

    F may change sign with an odd number of the γ_i: its periods are then twice those of the divisor. PrecisionLoss
    where no grid of at most MOST_SAMPLES points resolves F.
    """

    def __init__(self, flow: TorusFlow, function: Callable[[np.ndarray], np.ndarray]) -> None:
        doubled = [2 if np.prod(row) < 0 else 1 for row in flow.turns]
        self._frequencies = tuple(x / n for x, n in zip(flow.frequencies, doubled, strict=True))
        sizes = FIRST_SIZE, FIRST_SIZE
        while sizes[0] * sizes[1] <= MOST_SAMPLES:
            phases = [n * np.arange(size) / size for n, size in zip(doubled, sizes, strict=True)]
            grid = np.stack(np.meshgrid(*phases, indexing="ij"), axis=-1).reshape(-1, 2)
            samples = function(flow.at_phases(grid)).reshape(*sizes, -1)
            grids = [spectrum(part) for part in np.moveaxis(samples, -1, 0)]
            wanted = [needed_sizes(grid, (NOISE, NOISE)) for grid in grids if grid.any()]
            larger = (max(n for n, _ in wanted), max(n for _, n in wanted))
            if larger == sizes:
                break
            sizes = larger
        else:
            raise PrecisionLoss(f"a grid of {sizes[0]} × {sizes[1]} is needed for an integral on the torus")
        self._series = [
            TorusSeries(grid, (self._frequencies[0], self._frequencies[1]), noise=max(NOISE, flow.closure))
            for grid in grids
        ]

    def __call__(self, tau: np.ndarray) -> np.ndarray:
        """The integrals at times of the flow, shape (N, m)."""
        turns = [[x * nu for x in tau.tolist()] for nu in self._frequencies]
        # wide numbers: the fractions of many turns
        first, second = (np.array([float(x - int(x)) for x in row]) for row in turns)
        return np.stack([series.mean * tau + series.at(first, second) for series in self._series], axis=1)
