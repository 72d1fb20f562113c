"""Integrals along a motion of functions of its state with mean 0, at any time, in multiprecision: a Fourier series on
the real torus, like that of 1/g in :mod:`integrable.torus.long_clock`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from integrable.moving_point import addition
from integrable.torus.long_clock import powers
from integrable.torus.long_grid import FINEST, MOST_SAMPLES, SAMPLES_A_DIGIT, TorusGrid, fourier, next_size, tails
from jacobian import MP
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

Pairs = Callable[[list[tuple[Any, ...]]], list[tuple[Any, Any]]]
"""Two numbers, bare reals, for each of some moving points."""

FIRST_SIZE = 32


class LongIntegral:
    """∫_0^τ F dτ for two functions F with mean 0, to ``digits`` beside their size; τ in the units of the set-up.

    F may change sign with an odd number of the γ_i. PrecisionLoss where the torus degenerates, or takes too many
    samples.
    """

    def __init__(self, setup: Setup, digits: int, function: Pairs) -> None:
        self._setup, self._work = setup, MP(setup.digits)
        self._grid = grid = _Grid(setup, digits, function)
        self._frequencies = grid.frequencies()
        self._series = self._integrated(grid.spectrum(), 10.0**-digits)
        self._start = self._sums(self._angles(setup.wide.zero))

    def at(self, tau: Any) -> tuple[Any, Any]:
        """Both integrals at τ, wide numbers."""
        first, second = self._sums(self._angles(tau))
        return first - self._start[0], second - self._start[1]

    def _integrated(self, spectrum: Any, noise: float) -> list[tuple[int, int, list[Any]]]:
        """The coefficients of the integral of F₁ + iF₂: (k, first m, those of m, m + 1, …) for k of either sign."""
        rows, columns = len(spectrum), len(spectrum[0])
        least = noise * max(abs(c) for line in spectrum for c in line)
        unit, lines = 2j * self._work.context.pi, []
        for k in range(1 - rows // 2, rows // 2):
            kept = [m for m in range(1 - columns // 2, columns // 2) if (k or m) and abs(spectrum[k][m]) > least]
            if not kept:
                continue
            line = []
            for m in range(min(kept), max(kept) + 1):
                turns = self._work.coerce(k * self._frequencies[0] + m * self._frequencies[1])
                line.append(spectrum[k][m] / (unit * turns) if turns and (k or m) else self._work.context.zero)
            lines.append((k, min(kept), line))
        return lines

    def _angles(self, tau: Any) -> tuple[Any, Any]:
        floor, coerce = self._setup.wide.context.floor, self._work.coerce
        first, second = (tau * nu + origin for nu, origin in zip(self._frequencies, self._grid.origin, strict=True))
        return coerce(first - floor(first)), coerce(second - floor(second))

    def _sums(self, angles: tuple[Any, Any]) -> tuple[Any, Any]:
        context: Any = self._work.context
        reach = [max((abs(k) for k, _, _ in self._series), default=0)]
        reach.append(max((max(abs(m), abs(m + len(line))) for _, m, line in self._series), default=0))
        left, right = (powers(context, angle, size + 1) for angle, size in zip(angles, reach, strict=True))
        left, right = ([x.conjugate() for x in row[:0:-1]] + row for row in (left, right))
        total = context.zero
        for k, first, line in self._series:
            place = first + reach[1]
            total += context.fdot(line, right[place : place + len(line)]) * left[k + reach[0]]
        return total.real, total.imag


class _Grid(TorusGrid):
    """Samples of F₁ + iF₂."""

    def __init__(self, setup: Setup, digits: int, function: Pairs) -> None:
        super().__init__(setup, digits, odd=True)
        self._function = function

    def spectrum(self) -> Any:
        """The Fourier coefficients of the first grid that holds the function to its digits: rows of mpc."""
        sizes, noise = [FIRST_SIZE, FIRST_SIZE], 32 * 10.0**-self._digits
        while sizes[0] * sizes[1] <= max(MOST_SAMPLES, SAMPLES_A_DIGIT * self._digits**2) and max(sizes) < 2**FINEST:
            grid = fourier(self._setup, self.samples(sizes[0], sizes[1]))
            most = max(abs(c) for line in grid for c in line)
            ends = [float(tail / most) if most else 0.0 for tail in tails(grid)]
            if max(ends) < noise:
                return grid
            sizes = [n if end < noise else next_size(n, end, noise) for n, end in zip(sizes, ends, strict=True)]
        raise PrecisionLoss(f"a grid of {sizes[0]} × {sizes[1]} is needed for an integral on the torus")

    def _values(self, point: tuple[Any, ...], steps: list[Any]) -> list[Any]:
        setup, context = self._setup, MP(self._setup.digits).context
        f, axes = setup.bare.f, setup.bare.axes
        pairs = self._function([point, *(addition.shift(f, axes, point, step) for step in steps)])
        real, imaginary = (setup.reals.elements(MP(setup.digits), part) for part in zip(*pairs, strict=True))
        return [context.mpc(x, y) for x, y in zip(real, imaginary, strict=True)]
