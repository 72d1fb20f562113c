"""Integrals along a motion, to any time, of functions of its state with mean 0. They are Fourier series on the real
torus, in floats, or in multiprecision as for 1/g in :mod:`integrable.torus.long_clock`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from operator import mul
from typing import NamedTuple, Protocol

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.setup import Setup
from integrable.torus.access import BodyTorus, TorusFlow
from integrable.torus.clock import resolved
from integrable.torus.lifts import frame_at
from integrable.torus.long_clock import phases
from integrable.torus.loops import ReadableLoops
from integrable.torus.series import LongSeries, TorusSeries, long_spectrum, needed_sizes, spectrum, together
from integrable.torus.states import third_of, whole_turns
from jacobian.element import Complex, Real
from jacobian.numbers.long_reals import BallReals

FIRST_SIZE = 32
# the largest number of samples in floats, for compiled and interpreted states; CHUNK states are computed at once
MOST_COMPILED, MOST_INTERPRETED, CHUNK = 1 << 18, 1 << 12, 1 << 13
# a mode in floats below this fraction of the largest is a rounding error
NOISE = 1e-15
TINY = 1e-300
# the largest number of samples in multiprecision, which take some seconds, or SAMPLES_A_DIGIT·digits² if that is more
MOST_SAMPLES, SAMPLES_A_DIGIT = 1 << 15, 32

Function = Callable[[np.ndarray], np.ndarray]
"""A function of states, γ and M side by side, shape (N, 6), that gives m numbers for each, shape (N, m)."""


class TimedRun(Protocol):
    """A run whose states were requested at physical ``times``, or at values of τ if ``given_in_tau``."""

    times: np.ndarray
    tau: np.ndarray
    given_in_tau: bool


class TorusIntegral:
    """∫_0^τ F dτ for a function F of the state, with several parts, each of mean 0.

    F may change its sign if an odd number of the γ_i do, so its periods are those of :func:`periods_of`. ``least``,
    shape (m,), is the size of rounding errors in F. PrecisionLoss where no grid of at most MOST_COMPILED points
    (MOST_INTERPRETED for interpreted states) resolves F.
    """

    def __init__(self, flow: TorusFlow, function: Function, least: np.ndarray) -> None:
        self._flow = flow

        def noise(sizes: np.ndarray) -> np.ndarray:
            return np.maximum(NOISE, least / np.maximum(np.maximum(sizes, least), TINY))

        most = MOST_COMPILED if flow.compiled else MOST_INTERPRETED
        found = resolved_samples(flow, function, noise, most)
        self._doubled = periods_of(flow)
        first, second = (x / n for x, n in zip(flow.frequencies, self._doubled, strict=True))
        self._series = [
            TorusSeries(grid, (first, second), noise=max(noise, flow.closure))
            for grid, noise in zip(found.grids, found.noises.tolist(), strict=True)
        ]

    def at(self, run: TimedRun) -> np.ndarray:
        """The integrals at the times of a :class:`~integrable.motion.trajectory.Trajectory`, shape (N, m). Where its
        physical times are given, they determine the phases, because τ is rounded.
        """
        physical = not run.given_in_tau
        times = run.times if physical else run.tau
        return together(self._series, *self._flow.phases(times, physical, self._doubled))

    def swings_and_rates(self, phases: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each part of the F of :class:`TorusIntegral`: S with dS/dτ = F − (mean of F), and F, both at phases in
        turns, shape (N, 2).
        """
        first, second = (phases / self._doubled).T
        return [series.swings_and_rates(first, second) for series in self._series]


def periods_of(flow: BodyTorus) -> tuple[int, int]:
    """The periods, in turns of both phases, of functions that may change sign where an odd number of the γ_i do so."""
    return 1 + flow.odd[0], 1 + flow.odd[1]


class ResolvedSamples(NamedTuple):
    """Samples of a function F of the state, on a grid over :func:`periods_of` that resolves F, shape (rows, columns,
    m).

    For each of the m parts of F, ``grids`` has the Fourier coefficients, and ``noises`` the fraction of the largest
    coefficient below which the others are rounding errors.
    """

    values: np.ndarray
    grids: list[np.ndarray]
    noises: np.ndarray


def resolved_samples(
    flow: BodyTorus,
    function: Function,
    noise: Callable[[np.ndarray], np.ndarray],
    most: int,
    transform: Callable[[np.ndarray], np.ndarray] = spectrum,
) -> ResolvedSamples:
    """The samples of F = ``function``. ``noise`` maps the largest Fourier coefficients of the m parts of F to the
    fractions of them that count as rounding. PrecisionLoss where more than ``most`` samples are needed.
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
        samples = np.empty((*sizes, parts[0].shape[1]), dtype=parts[0].dtype)
        samples[new] = np.concatenate(parts)
        if known is not None:
            samples[places] = known
        return samples

    def transformed(values: np.ndarray) -> tuple[ResolvedSamples, tuple[int, int]]:
        grids = [transform(part) for part in np.moveaxis(values, -1, 0)]
        noises = noise(np.array([np.abs(grid).max() for grid in grids], dtype=float))
        seen = [(grid, x) for grid, x in zip(grids, noises.tolist(), strict=True) if grid.any() and x < 1 / 64]
        wanted = [needed_sizes(grid, (x, x)) for grid, x in seen]
        rows, columns = zip(values.shape[:2], *wanted, strict=True)
        return ResolvedSamples(values, grids, noises), (max(rows), max(columns))

    rows, columns = (max(FIRST_SIZE, size) for size in flow.first_grid())
    return resolved(sampled, transformed, (rows, columns), most)


class LongIntegral:
    """∫_0^τ F dτ in multiprecision for a function F with several parts, each of mean 0. The result has ``digits``
    digits, relative to the largest part.

    F takes states of bare reals, and may change its sign if an odd number of the γ_i do. PrecisionLoss where the torus
    degenerates, or F needs too many samples.
    """

    def __init__(self, setup: Setup, digits: int, function: Function) -> None:
        loops = ReadableLoops(setup, digits)
        self._wide, self._reals = setup.wide, loops.reals
        most = max(MOST_SAMPLES, SAMPLES_A_DIGIT * digits**2)
        flow = LongStates(setup, loops)
        first, second = (rate / n for rate, n in zip(flow.frequencies, periods_of(flow), strict=True))
        self._frequencies = first, second
        with loops.reals:
            found = resolved_samples(
                flow,
                function,
                lambda sizes: 8 * loops.noise * sizes.max() / np.maximum(sizes, TINY),
                most,
                lambda samples: long_spectrum(samples, loops.reals),
            )
        self._series = [
            LongSeries(self._half_plane(grid), self._frequencies, self._wide, float(min(1, noise / 8)))
            for grid, noise in zip(found.grids, found.noises.tolist(), strict=True)
        ]

    def at(self, tau: Sequence[Real]) -> np.ndarray:
        """The integrals at values of τ, wide numbers, shape (N, m)."""
        angles = [phases(t, self._frequencies, self._wide) for t in tau]
        return np.array([series.at(angles) for series in self._series], dtype=object).T

    def _half_plane(self, grid: np.ndarray) -> list[list[Real]]:
        """The modes of a grid in the form that :class:`~integrable.torus.series.LongSeries` takes."""
        from flint import acb

        rows, most = (grid.shape[0] + 1) // 2, grid.shape[1] // 2 - 1
        element, wide, balls = self._reals.element, self._wide, BallReals(self._reals.bits)

        def number(c: Complex) -> acb:
            return acb(*(balls.number(element(wide, x)) for x in (c.real, c.imag)))

        with balls:
            return [[number(grid[k, m]) for m in range(-most, most + 1)] for k in range(rows)]


class LongStates(BodyTorus):
    """A torus whose states are not rounded: they have all digits of the numbers in which its loops compute."""

    def __init__(self, setup: Setup, loops: ReadableLoops) -> None:
        super().__init__(setup, loops)
        # (γ̃, w̃) of :func:`frame_at`, as found at a pair of phases; whole turns change only signs
        self._frames = dict[tuple[Real, Real], Row]()

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M at points of the torus, bare reals, shape (N, 6): ``phases`` are exact, in turns from the start."""
        number, rows, signs = self.loops.reals.number, [], self.turns.tolist()
        torus, (p, q, r, s) = self.torus
        for (first, turn1), (second, turn2) in (map(whole_turns, pair) for pair in phases.tolist()):
            if (first, second) not in self._frames:
                self._frames[first, second] = frame_at(torus, number(first), number(second))
            frame = self._frames[first, second]
            for turn, own in ((turn1, signs[0]), (turn2, signs[1])):
                frame = tuple(map(mul, frame, own + own)) if turn % 2 else frame
            pairs = list(zip(frame[:3], third_of(frame), strict=True))
            rows.append([*(p * x + q * y for x, y in pairs), *(r * x + s * y for x, y in pairs)])
        return np.array(rows, dtype=object).reshape(-1, 6)
