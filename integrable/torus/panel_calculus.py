"""Integrals and zeros of functions that are Chebyshev series on panels (Trefethen 2013, chapters 18 and 19)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev

if TYPE_CHECKING:
    from integrable.torus.panels import Panels

__all__ = ["integrals", "zeros"]

# coefficients of a panel below this part of its largest are rounding
NOISE = 1e-14


def integrals(panels: Panels, times: np.ndarray) -> np.ndarray:
    """∫ of every column from the start of the panels to each of ``times`` inside, shape (N, width)."""
    series = chebyshev.chebint(panels.coefficients, lbnd=-1, axis=1) * panels.halves[:, None, None]
    # the value at the end of a panel is the sum of the coefficients
    ends = np.cumsum(series.sum(axis=1), axis=0)
    before = np.concatenate([np.zeros_like(ends[:1]), ends])
    panel = np.clip(np.searchsorted(panels.middles - panels.halves, times, side="right") - 1, 0, len(series) - 1)
    x = (times - panels.middles[panel]) / panels.halves[panel]
    inside = chebyshev.chebval(x[:, None], series[panel].transpose(1, 0, 2), tensor=False)
    result: np.ndarray = before[panel] + inside
    return result


def zeros(panels: Panels) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(times, slopes, halves) at all simple zeros of the first column, ascending, each of shape (N,); ``halves`` are
    half the lengths of the panels that they were found on.

    A zero at which the function does not change sign may be missed, or be found as two.
    """
    times, slopes, halves = [np.empty(0)], [np.empty(0)], [np.empty(0)]
    series = panels.coefficients[:, :, 0]
    size = np.abs(series)
    # a series whose constant outweighs the rest has no zero
    for k in np.flatnonzero(size[:, 0] <= size[:, 1:].sum(axis=1) * (1 + 1e-12)):
        found = chebyshev.chebroots(chebyshev.chebtrim(series[k], NOISE * size[k].max()))
        real = np.sort(found[np.abs(found.imag) < 1e-7].real)
        inside = np.clip(real[np.abs(real) < 1 + 1e-9], -1, 1)
        times.append(panels.middles[k] + panels.halves[k] * inside)
        slopes.append(chebyshev.chebval(inside, chebyshev.chebder(series[k])) / panels.halves[k])
        halves.append(np.full(len(inside), panels.halves[k]))
    return distinct(np.concatenate(times), np.concatenate(slopes), np.concatenate(halves))


def distinct(times: np.ndarray, slopes: np.ndarray, halves: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The zeros of which none is another's copy: one at an edge is found in both panels, with slopes of one sign.

    On the scale of the panels, and of the floats at that time: zeros of a fast motion may be close together.
    """
    near = 2e-8 * halves + 4 * np.spacing(np.abs(times))
    kept = (np.diff(times, prepend=-np.inf) > near) | (slopes * np.roll(slopes, 1) < 0)
    return times[kept], slopes[kept], halves[kept]
