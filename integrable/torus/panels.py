"""Chebyshev series on panels for many states in one interval of time, from states at their nodes; the integrals and the
zeros of such series (Trefethen 2013, chapters 18 and 19).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev

from jacobian.errors import PrecisionLoss

# the number of nodes of a panel is a compromise: with more nodes panels are longer, and their evaluation slower
NODES = 28
# a panel of states has converged if its last coefficients are at most this, relative to the largest of their column
TOLERANCE = 2e-15
# on motions with fast passages, the rounding errors of the states are at most this, relative to the largest of their
# column
NOISE = 1e-13
# panel_length tries lengths from LONGEST·least on, on PROBES panels each; a panel is halved at most MOST_HALVINGS times
PROBES, LONGEST = 8, 1024
MOST_HALVINGS = 12
# if the last coefficients are below ROUGH times the largest of their column but do not decrease, they may be rounding
# errors, which halving does not reduce; after MOST_IN_VAIN halvings without progress this is certain
ROUGH, MOST_IN_VAIN = 1e-8, 4
# coefficients below this part of the largest count as zero in the search for zeros
LEVEL = 1e-14

States = Callable[[np.ndarray], np.ndarray]


class Panels:
    """Values, between two times, of a function ``states`` that maps times of shape (N,) to rows of shape (N, width).

    ``length`` is the first length of a panel; panels whose series has not converged are halved. A series has converged
    if its last coefficients are below ``tolerance`` times the largest of their column, or below ``least``, the size of
    rounding errors.
    """

    def __init__(
        self,
        states: States,
        start: float,
        end: float,
        length: float,
        tolerance: float = TOLERANCE,
        least: float | np.ndarray = 0.0,
    ) -> None:
        count = max(1, int(np.ceil((end - start) / length)))
        left = np.linspace(start, end, count + 1)[:-1]
        half = np.full(count, (end - start) / (2 * count))
        middle = left + half
        middles, halves, series, in_vain = [], [], [], 0
        for _ in range(MOST_HALVINGS):
            found = _coefficients(states, middle, half)
            good, rounded = _judged(found, tolerance, least)
            in_vain = in_vain + 1 if rounded[~good].all() else 0
            middles.append(middle[good])
            halves.append(half[good])
            series.append(found[good])
            if good.all():
                break
            if in_vain == MOST_IN_VAIN:
                raise PrecisionLoss(
                    f"the states between {start} and {end} are too rough for Chebyshev series: rounding is more than "
                    f"{NOISE:.0e} of them; use more digits"
                )
            middle, half = middle[~good], half[~good] / 2
            middle, half = np.concatenate([middle - half, middle + half]), np.concatenate([half, half])
        else:
            raise PrecisionLoss(f"the states between {start} and {end} are no Chebyshev series on any panel")
        order = np.argsort(np.concatenate(middles))
        self.middles, self.halves = (np.concatenate(rows)[order] for rows in (middles, halves))
        self.coefficients = np.ascontiguousarray(np.concatenate(series)[order])

    def at(self, times: np.ndarray, evaluate: Callable[..., object]) -> np.ndarray:
        """The rows at times in the interval, by :func:`integrable.torus.clock_loops.panel_values` or its compiled
        version.
        """
        width = self.coefficients.shape[2]
        out = np.empty((len(times), width))
        evaluate(self.middles, self.halves, self.coefficients, times, np.empty((2, width)), out)
        return out


def panel_length(states: States, least: float) -> float:
    """A length at which most panels converge. The search begins with LONGEST·``least``, and halves it."""
    length = LONGEST * least
    middle = length * (np.arange(PROBES) + 0.5)
    while length > least:
        if _judged(_coefficients(states, middle, np.full(PROBES, length / 2)))[0].mean() > 0.7:
            break
        length /= 2
    return length


def _coefficients(states: States, middle: np.ndarray, half: np.ndarray) -> np.ndarray:
    """The Chebyshev coefficients of ``states`` on panels of these middles and half-lengths, (panels, NODES, width)."""
    nodes, matrix, slopes = _rule()
    offsets = half[:, None] * nodes
    times = middle[:, None] + offsets
    # a time at a node is rounded; ``off`` is its error (two-sum), for which the values are corrected to first order
    back = times - middle[:, None]
    off = (offsets - back) + (middle[:, None] - (times - back))
    values = states(times.ravel()).reshape(len(middle), NODES, -1)
    rates = np.einsum("kn,pnw->pkw", slopes, values, optimize=True) / half[:, None, None]
    values = values + off[:, :, None] * rates
    return np.einsum("kn,pnw->pkw", matrix, values, optimize=True)


def _judged(
    coefficients: np.ndarray, tolerance: float = TOLERANCE, least: float | np.ndarray = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """For each panel: whether its series has converged, and whether its last terms may be only rounding errors.

    A series has converged if its last terms are below ``tolerance`` or ``least``, or below NOISE without decreasing.
    They may be rounding errors if they are below NOISE, or below ROUGH without decreasing.
    """
    size = np.abs(coefficients)
    sizes, tails = size.max(axis=(0, 1)), size[:, -3:].max(axis=1)
    level = tails > size[:, -10:-3].max(axis=1) / 8
    good = (tails <= np.maximum(tolerance * sizes, least)) | level & (tails <= NOISE * sizes)
    return np.all(good, axis=1), np.all(level & (tails <= ROUGH * sizes) | (tails <= NOISE * sizes), axis=1)


@lru_cache(maxsize=1)
def _rule() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Chebyshev nodes, and the matrices from values there to coefficients and to derivatives."""
    # the angles are reduced to one turn as integers, hence exactly
    turns = np.outer(np.arange(NODES), 2 * np.arange(NODES) + 1) % (4 * NODES)
    cosines = np.cos(np.pi / (2 * NODES) * np.arange(4 * NODES))
    matrix = 2 / NODES * cosines[turns]
    matrix[0] /= 2
    nodes = cosines[2 * np.arange(NODES) + 1]
    # T_k' = k·sin(kθ)/sin θ
    angles = np.arccos(nodes)
    derivatives = np.arange(NODES) * np.sin(np.outer(angles, np.arange(NODES))) / np.sin(angles)[:, None]
    return nodes, matrix, derivatives @ matrix


def panel_integrals(panels: Panels, times: np.ndarray) -> np.ndarray:
    """The integral of every column from the start of the panels to each of ``times``, shape (N, width)."""
    series = chebyshev.chebint(panels.coefficients, lbnd=-1, axis=1) * panels.halves[:, None, None]
    # T_n(1) = 1, so that the value at the end of a panel is the sum of the coefficients
    ends = np.cumsum(series.sum(axis=1), axis=0)
    before = np.concatenate([np.zeros_like(ends[:1]), ends])
    panel = np.clip(np.searchsorted(panels.middles - panels.halves, times, side="right") - 1, 0, len(series) - 1)
    x = (times - panels.middles[panel]) / panels.halves[panel]
    inside = chebyshev.chebval(x[:, None], series[panel].transpose(1, 0, 2), tensor=False)
    return before[panel] + inside


def zeros(panels: Panels) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(times, slopes, halves) at all simple zeros of the first column, ascending, each of shape (N,); ``halves`` are
    half the lengths of the panels that they were found on.

    A zero at which the function does not change sign may be missed, or be found as two.
    """
    times, slopes, halves = [np.empty(0)], [np.empty(0)], [np.empty(0)]
    series = panels.coefficients[:, :, 0]
    size = np.abs(series)
    # a series has no zero if its constant term exceeds the sum of the sizes of the others
    for k in np.flatnonzero(size[:, 0] <= size[:, 1:].sum(axis=1) * (1 + 1e-12)):
        found = chebyshev.chebroots(chebyshev.chebtrim(series[k], LEVEL * size[k].max()))
        real = np.sort(found[np.abs(found.imag) < 1e-7].real)
        inside = np.clip(real[np.abs(real) < 1 + 1e-9], -1, 1)
        times.append(panels.middles[k] + panels.halves[k] * inside)
        slopes.append(chebyshev.chebval(inside, chebyshev.chebder(series[k])) / panels.halves[k])
        halves.append(np.full(len(inside), panels.halves[k]))
    return distinct(np.concatenate(times), np.concatenate(slopes), np.concatenate(halves))


def distinct(times: np.ndarray, slopes: np.ndarray, halves: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The zeros without duplicates: a zero at an edge is found in both panels, with slopes of equal sign.

    Two zeros count as one only if they differ by rounding, of the panel or of the time: zeros of a fast motion may be
    close together.
    """
    near = 2e-8 * halves + 4 * np.spacing(np.abs(times))
    kept = (np.diff(times, prepend=-np.inf) > near) | (slopes * np.roll(slopes, 1) < 0)
    return times[kept], slopes[kept], halves[kept]
