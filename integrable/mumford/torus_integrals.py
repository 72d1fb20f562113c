"""Integrals of functions of U along a motion on a real torus of genus 2: time, data of the second and third kind.

The mean of such a function is that of its values on a grid, in double-double numbers; what is beside it is a Fourier
series (:mod:`integrable.torus.series`), as for the clock of the ball.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from integrable.mumford.columns import Column, Columns
from integrable.torus.access import resolved_spectrum
from integrable.torus.corners import Corners
from integrable.torus.series import TorusSeries, spectrum
from jacobian.relatives.extended import Kind, SecondKind, ThirdKind

# phases that a series is summed at together
TOGETHER = 4096
# what differs by less, beside its size, is the same
SAME = 2.0**-80


class GridRate:
    """A ``rate`` of pairs of phases in turns, shape (2N, 2), that does not notice whole ones: its ``values``, a column,
    on the grid of the torus that resolves it, its ``spectrum`` and ``scale`` as for
    :class:`~integrable.torus.access.TorusClock`, and its ``mean``, a wide number.
    """

    def __init__(self, torus: Corners, rate: Callable[[np.ndarray], Column], scale: float) -> None:
        self._rate = rate
        self.spectrum = resolved_spectrum(torus, list(map(float, torus.frequencies)), scale, self._samples)
        total = self.values
        while len(total.hi) > 1:
            half = len(total.hi) // 2
            total = Column(total.hi[:half], total.lo[:half]) + Column(total.hi[half:], total.lo[half:])
        wide = torus.setup.wide
        self.mean = (wide.coerce(float(total.hi[0])) + wide.coerce(float(total.lo[0]))) / len(self.values.hi)

    def _samples(self, sizes: tuple[int, int], _: np.ndarray | None) -> np.ndarray:
        places = [np.arange(n) / n for n in sizes]
        phases = np.stack(np.meshgrid(*places, indexing="ij"), axis=-1).ravel()
        # a constant as a column too
        self.values = self._rate(np.stack([phases, np.zeros_like(phases)], axis=-1)) + Column(
            np.zeros(len(phases) // 2)
        )
        self.table: np.ndarray = (self.values.hi.astype(np.longdouble) + self.values.lo).reshape(sizes)
        return self.table


class TorusIntegral:
    """∫F dτ from the start of a motion; a multiple of the time where F is one of the ``clock``'s rate."""

    def __init__(self, rate: GridRate, clock: GridRate | None, frequencies: tuple[Any, Any]) -> None:
        self._mean, self._ratio = Column.of(rate.mean), None
        if clock is not None and len(clock.values.hi) == len(rate.values.hi):
            ratio = Column.of(rate.mean / clock.mean)
            if np.abs((rate.values - ratio * clock.values).hi).max() <= SAME * np.abs(rate.values.hi).max():
                self._ratio = ratio
                return
        self._series = TorusSeries(spectrum(rate.table), frequencies)

    def at(self, times: np.ndarray, tau: Column, phases: np.ndarray) -> Column:
        """The integral at times, which are ``tau`` and ``phases``, shape (2N, 2), in turns."""
        if self._ratio is not None:
            return Column(times) * self._ratio
        turns = (phases[:, 0] - np.floor(phases[:, 0]) + phases[:, 1]).reshape(-1, 2)
        swings = [self._series.at(*turns[n : n + TOGETHER].T) for n in range(0, len(turns), TOGETHER)]
        return tau * self._mean + Column(np.concatenate(swings))


def datum_after(kind: Kind, first: Column, omega: Column) -> Column:
    """The datum of the second or third kind where ∫Σx^g dx/y from the start is ``omega``."""
    if isinstance(kind, SecondKind):
        return first + omega
    assert isinstance(kind, ThirdKind)
    return first * Columns.context.exp(kind.r * omega)
