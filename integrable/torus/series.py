"""The integral of a function on the torus along the flow: a mean rate and a Fourier series.

For F on the torus with samples on a grid, ∫F dτ = mean·τ + S, dS/dτ = F − mean, where S is again a function on the
torus. Its modes are those of F divided by the rates of their phases.
"""

from __future__ import annotations

from math import ceil, log2, pi
from typing import TYPE_CHECKING, NamedTuple

import gmpy2
import numpy as np

from integrable.torus.clock_modes import size_wanted
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals, BareReals

if TYPE_CHECKING:
    from flint import acb, acb_mat

# the number of phases at which a long series is summed at once
TOGETHER = 256
# sums at several phases are products of matrices of up to ONE_THREAD multiplications: for more, NumPy uses several
# threads, which wait in busy loops. If a product would have fewer than FEWEST phases, one product takes all phases, as
# large tables are slow to read
ONE_THREAD, FEWEST = 1 << 15, 4
# modes below TINY may underflow in floats
TINY = 1e-290
# the size up to which transforms of long numbers are direct sums
SHORT = 8
# guard bits of sums of many digits
SPARE_BITS = 40


class TorusSeries:
    """The function S on a torus with dS/dτ = F − (mean of F), and S = 0 at the phases (0, 0). ``grid`` is the
    :func:`spectrum` of F. ``frequencies`` are the turns of both phases per unit of τ, as wide numbers.

    Coefficients of F below ``noise`` times the largest are left out. PrecisionLoss where a mode (k, m) of F above
    ``rounding`` times the largest is in resonance: kν₁ + mν₂ = 0.
    """

    def __init__(
        self, grid: np.ndarray, frequencies: tuple[Real, Real], noise: float = 2.0**-54, rounding: float = 2.0**-49
    ) -> None:
        rows, columns = grid.shape
        self.frequencies, self._first, self.mean = frequencies, -(columns // 2), float(grid[0, 0].real)
        # modes with k > 0, or with k = 0 and m > 0, are doubled, since they stand for their conjugates too
        self._slope = np.roll(grid[: (rows + 1) // 2], columns // 2, axis=1)
        self._slope[1:] *= 2
        self._slope[0, columns // 2 + 1 :] *= 2
        sizes = np.abs(self._slope)
        largest = max(float(sizes[0, : 1 - self._first].max()), float(sizes[1:].max(initial=0)) / 2)
        self._kept = kept = sizes > rounding * largest
        kept[0, : columns // 2 + 1] = False
        turns = self._turns(kept)
        self._swing = np.zeros_like(self._slope)
        self._swing[kept] = self._slope[kept] / (2j * pi * turns[kept])
        kept &= sizes > noise * largest
        self._swing[~kept] = 0
        # S, which is 0 at the phases (0, 0), has the mean −origin
        self.origin = float(self._swing[kept].real.sum())
        self.bound = float(np.abs(self._swing).sum()) + abs(self.origin)

    def _turns(self, kept: np.ndarray) -> np.ndarray:
        """k·ν₁ + m·ν₂, from wide numbers where floats cancel."""
        rows, columns = kept.shape
        nu1, nu2 = map(float, self.frequencies)
        k, m = np.arange(rows)[:, None], np.arange(columns)[None, :] + self._first
        turns = k * nu1 + m * nu2
        close = kept & (np.abs(turns) < 2.0**-10 * (np.abs(k * nu1) + np.abs(m * nu2)))
        for i, j in np.argwhere(close).tolist():
            turns[i, j] = float(i * self.frequencies[0] + (j + self._first) * self.frequencies[1])
            if turns[i, j] == 0:
                raise in_resonance(i, j + self._first)
        return turns

    def at(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """The function S of :class:`TorusSeries` at arrays of phases, in turns."""
        return self._sums(first, second, self._swing)[0] - self.origin

    def on_grid(self, sizes: tuple[int, int]) -> np.ndarray:
        """The function S of :class:`TorusSeries` at the phases (i/rows, j/columns), an array of shape ``sizes`` =
        (rows, columns).
        """
        rows, columns = self._swing.shape
        left = np.exp(2j * pi / sizes[0] * (np.outer(np.arange(sizes[0]), np.arange(rows)) % sizes[0]))
        right = np.exp(
            2j * pi / sizes[1] * (np.outer(np.arange(columns) + self._first, np.arange(sizes[1])) % sizes[1])
        )
        return (left @ self._swing @ right).real - self.origin

    def swings_and_rates(self, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The functions S and F of :class:`TorusSeries` at arrays of phases, in turns."""
        swing, slope = self._sums(first, second, self._swing, np.where(self._kept, self._slope, 0))
        return swing - self.origin, self.mean + slope

    def _sums(self, first: np.ndarray, second: np.ndarray, *tables: np.ndarray) -> list[np.ndarray]:
        rows, columns = self._swing.shape
        found, size = np.empty((len(tables), len(first))), ONE_THREAD // (rows * columns)
        if size < FEWEST:
            size = max(1, len(first))
        for begin in range(0, len(first), size):
            some = slice(begin, begin + size)
            left = np.exp(2j * pi * np.outer(first[some], np.arange(rows)))
            right = np.exp(2j * pi * np.outer(second[some], np.arange(columns) + self._first))
            for sums, table in zip(found, tables, strict=True):
                sums[some] = np.einsum("ij,ij->i", left @ table, right).real
        return list(found)


def together(series: list[TorusSeries], first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The functions S of m :class:`TorusSeries`, all on the same grid, at arrays of phases in turns: shape (N, m)."""
    tables = np.array([x._swing for x in series])
    used = np.abs(tables).max(axis=0) > 0
    rows, columns = np.flatnonzero(used.any(axis=1)), np.flatnonzero(used.any(axis=0))
    left = np.exp(2j * pi * np.outer(first, rows))
    right = np.exp(2j * pi * np.outer(second, columns + series[0]._first))
    values = np.einsum("ni,mij,nj->nm", left, tables[:, rows][:, :, columns], right, optimize=True).real
    return values - [x.origin for x in series]


class SeriesLevel(NamedTuple):
    """The modes of a :class:`LongSeries` needed for a number of digits: the block ``modes`` of the (k, m) that are not
    too small, k ≥ 0 and m ≥ ``first``, in balls of ``bits`` bits.
    """

    first: int
    modes: acb_mat
    bits: int


class LongSeries:
    """The function S of a :class:`TorusSeries` in many digits, at many points at once; ``rough`` is the series in
    floats.

    ``rows[k]`` are the modes of the function F of the TorusSeries for k ≥ 0 and m = −most, …, most, in flint's balls.
    Modes below ``noise`` times the largest are left out. ``field`` is the MP field of the frequencies.
    """

    def __init__(
        self, rows: list[list[acb]], frequencies: tuple[Real, Real], field: MultiprecisionField, noise: float
    ) -> None:
        import flint

        self._flint, self._field = flint, field
        self._balls = BallReals(field.context.prec + 16)
        most = len(rows[0]) // 2
        grid = np.zeros((2 * len(rows) - 1, 2 * most + 1), dtype=complex)
        grid[: len(rows)] = np.roll(np.array([[complex(c) for c in row] for row in rows]), -most, axis=1)
        self.rough = TorusSeries(grid, frequencies, noise=noise, rounding=noise)
        kept = self.rough._kept
        if noise < TINY:
            # in floats modes below TINY may underflow, so no mode can be left out by its size
            kept = np.ones_like(kept)
            kept[0, : most + 1] = False
        self._kept, self._noise, self._size = kept, noise, float(np.abs(grid).max())
        self._levels: dict[int | None, SeriesLevel] = {}
        with self._balls as balls:
            nu1, nu2 = map(balls.number, frequencies)
            # the factor is 2/(2πi), since each mode counts with its conjugate
            factor = flint.acb(0, -1 / flint.arb.pi())
            self._modes = [
                [
                    c * factor / (k * nu1 + (m - most) * nu2) if here and not c.is_zero() else flint.acb(0)
                    for m, (c, here) in enumerate(zip(row, kept[k].tolist(), strict=True))
                ]
                for k, row in enumerate(rows)
            ]
            self._origin = sum((c.real for row in self._modes for c in row), flint.arb(0))
            # S, which is 0 at the phases (0, 0), has the mean −origin
            self.origin = balls.element(field, self._origin)

    def at(self, angles: list[tuple[Real, Real]], digits: int | None = None) -> list[Real]:
        """The function S of :class:`TorusSeries` at pairs of phases in turns; phases and results are numbers of the
        field. With ``digits``, S has only that many digits relative to the size of F.
        """
        if digits not in self._levels:
            self._levels[digits] = self._level(digits)
        level, found = self._levels[digits], []
        for begin in range(0, len(angles), TOGETHER):
            some = angles[begin : begin + TOGETHER]
            with self._balls.at(level.bits):
                left, right = zip(*(map(self._circle, pair) for pair in some), strict=True)
                down = self._flint.acb_mat([powers(z**0, z, level.modes.nrows()) for z in left]) * level.modes
                for row, z in zip(down.table(), right, strict=True):
                    total = self._flint.acb_poly(row)(z) * z**level.first
                    found.append(self._balls.element(self._field, total.real - self._origin))
        return found

    def _level(self, digits: int | None) -> SeriesLevel:
        """The modes for this many digits, None for all digits of the series. The others are together at most a quarter
        of a unit of the last digit.
        """
        kept, bits, middle = self._kept, self._balls.bits, -self.rough._first
        noise = self._noise if digits is None else 10.0**-digits
        if noise > TINY:
            bits = min(bits, ceil(-log2(noise)) + SPARE_BITS)
            kept = kept & (np.abs(self.rough._swing) > noise * self._size / (4 * kept.size))
        rows, columns = (np.flatnonzero(kept.any(axis=1 - k)).tolist() or [k * middle] for k in range(2))
        modes = [row[columns[0] : columns[-1] + 1] for row in self._modes[: rows[-1] + 1]]
        return SeriesLevel(columns[0] - middle, self._flint.acb_mat(modes), bits)

    def _circle(self, angle: Real) -> acb:
        x = 2 * self._balls.number(angle)
        return self._flint.acb(x.cos_pi(), x.sin_pi())


def powers(first: acb, base: acb, count: int) -> list[acb]:
    """first, first·base, first·base², …; radii of balls grow with the logarithm of the exponent only."""
    out = [first]
    while len(out) < count:
        out += [x * base for x in out]
        base = base * base
    return out[:count]


def in_resonance(k: int, m: int) -> PrecisionLoss:
    """The error for a mode with k·ν₁ + m·ν₂ = 0."""
    return PrecisionLoss(f"the mode ({k}, {m}) of a function on the torus is in resonance with the motion")


def spectrum(samples: np.ndarray) -> np.ndarray:
    """The Fourier coefficients of samples at the phases (i/rows, j/columns); same shape."""
    return np.fft.fft2(samples, norm="forward")


def long_spectrum(samples: np.ndarray, reals: BareReals) -> np.ndarray:
    """:func:`spectrum` for samples in bare reals, on a grid of powers of 2."""
    grid, size = samples, samples.size
    with reals.at(reals.bits + SPARE_BITS):
        circle = circle_of(max(samples.shape))
        for _ in range(2):
            grid = fourier(grid, circle).T
    with reals:
        found: np.ndarray = grid / size
    return found


def circle_of(count: int) -> np.ndarray:
    """e^(−2πik/count) for k < count, to the precision in force (:class:`~jacobian.numbers.long_reals.BareReals`)."""
    return np.array([gmpy2.root_of_unity(count, -k % count) for k in range(count)], dtype=object)


def fourier(values: np.ndarray, circle: np.ndarray) -> np.ndarray:
    """The transform Σ_j x_j·e^(−2πijk/n) along the first axis of n rows x_j of long numbers (Cooley & Tukey 1965).
    ``circle`` is the result of :func:`circle_of` for a multiple of n.
    """
    n, stride = len(values), len(circle) // len(values)
    if n % 2 or n <= SHORT:
        k = np.arange(n)
        return circle[np.outer(k, k) % n * stride] @ values
    even, odd = fourier(values[::2], circle), circle[: n // 2 * stride : stride, None] * fourier(values[1::2], circle)
    return np.concatenate([even + odd, even - odd])


def needed_sizes(grid: np.ndarray, noise: tuple[float, float]) -> tuple[int, int]:
    """The shape, powers of 2, of a grid that resolves a function: that of its :func:`spectrum` if the last modes are
    below ``noise`` times the largest in each direction. Otherwise a larger shape, extrapolated from the decay of the
    modes, or one with so many samples that the mean of their rounding errors is small enough.
    """
    grid = np.abs(grid.astype(complex))
    grid /= grid.max()
    rows, columns = (needed_size(np.maximum.reduce(grid, axis=1 - k), noise[k]) for k in range(2))
    return rows, columns


def needed_size(modes: np.ndarray, noise: float) -> int:
    """An entry of :func:`needed_sizes`; ``modes``: the largest mode of each row or column, relative to the largest."""
    half = len(modes) // 2
    folded = np.maximum(modes[: half + 1], np.roll(modes[::-1], 1)[: half + 1])
    return size_wanted(folded.tolist(), len(modes), noise)
