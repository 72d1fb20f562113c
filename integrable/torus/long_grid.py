"""Samples of 1/g on a grid of the real torus of a motion, and their Fourier coefficients."""

from __future__ import annotations

from math import log2
from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.moving_point import addition
from integrable.torus.lattice import TorusLattice
from integrable.torus.long_periods import combine, moved, ovals, translation
from jacobian import MP
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup

FIRST_SIZE = 16
# samples that take some seconds, and beyond them so many for the square of each digit
MOST_SAMPLES, SAMPLES_A_DIGIT = 1 << 15, 32
# translations by Λ_k/2^j are made for j up to this
FINEST = 9
# coefficients of U' beyond this cost digits
FARTHEST = 1000
# the grid starts at these parts of the periods from D(0), in units of 2^-FINEST: odd, so that no grid point is D(0),
# which may be at a branch point like the half periods
OFFSET = (109, 191)


class TorusGrid:
    """The torus D(0) + θ₁Λ₁ + θ₂Λ₂ of a motion, Λ_k the real periods over its two ovals.

    1/g is to be resolved to ``digits``, by default those of the set-up. ``odd``: whether the function on the torus
    notices that an odd number of γ_i have turned; 1/g does where the body is tilted. PrecisionLoss where an oval has
    shrunk to a point.
    """

    def __init__(self, setup: Setup, digits: int | None = None, odd: bool | None = None) -> None:
        self._setup = setup
        self._odd = setup.tilt is not None if odd is None else odd
        self._digits = digits or setup.digits
        # the reduced basis needs fewest samples; the halves of its periods may lie far out (d → 0)
        for periods in (TorusLattice(setup).periods, [oval.periods for oval in ovals(setup)]):
            self.periods = periods
            self._parts = [self._halved(period) for period in periods]
            if all(abs(x) < FARTHEST for parts in self._parts for step in parts[1:] for x in step[:2]):
                break
        self._base = self._generic_point()
        self.turns = [self._turn(parts[1]) for parts in self._parts]
        # θ of D(0) on the grid, in periods of 1/g
        unit = setup.wide.coerce(2) ** FINEST
        self.origin = [-part / unit / len(turns) for part, turns in zip(OFFSET, self.turns, strict=True)]

    def frequencies(self) -> tuple[Any, Any]:
        """(ν₁, ν₂) with (τ, 0) = τ(ν₁Λ₁ + ν₂Λ₂), Λ the periods of the function, wide."""
        (p, q), (r, s) = (
            tuple(c * len(turns) for c in period) for period, turns in zip(self.periods, self.turns, strict=True)
        )
        determinant = p * s - q * r
        return s / determinant, -q / determinant

    def resolved(self) -> tuple[Any, Any]:
        """(Fourier coefficients of 1/g, its mean) from the first grid that holds it to rounding.

        The coefficients are rows of mpc; the mean is summed in the wide precision.
        """
        setup = self._setup
        sizes = [FIRST_SIZE, FIRST_SIZE]
        while sizes[0] * sizes[1] <= max(MOST_SAMPLES, SAMPLES_A_DIGIT * self._digits**2) and max(sizes) < 2**FINEST:
            samples = self.samples(sizes[0], sizes[1])
            grid = fourier(setup, samples)
            ends = [float(tail / abs(grid[0][0])) for tail in tails(grid)]
            noise = 32 * 10.0**-self._digits
            if max(ends) < noise:
                return grid, self.mean(samples)
            sizes = [n if tail < noise else next_size(n, tail, noise) for n, tail in zip(sizes, ends, strict=True)]
        raise PrecisionLoss(f"1/g needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")

    def mean(self, samples: list[list[Any]]) -> Any:
        """The mean of samples, wide."""
        total = sum(self._setup.wide.coerce(x) for line in samples for x in line)
        return total / (len(samples) * len(samples[0]))

    def samples(self, rows: int, columns: int) -> list[list[Any]]:
        """1/g at D(0) + OFFSET + (i/rows)Λ₁ + (j/columns)Λ₂: one addition each to a point that few additions made.

        Rows and columns are powers of 2.
        """
        setup = self._setup
        down, across = (
            self._multiples(k, size // len(turns))
            for k, (size, turns) in enumerate(zip((rows, columns), self.turns, strict=True))
        )
        reals = setup.reals
        steps = [reals.row(step) for step in across]
        points = [reals.row(point) for point in (self._base, *(moved(setup, step, self._base) for step in down))]
        table: list[list[Any]] = []
        for turn in self.turns[0]:
            for point in points:
                line = []
                with reals:
                    for second in self.turns[1]:
                        here = tuple(a * b * x for a, b, x in zip(turn, second, point, strict=True))
                        line.extend(self._values(here, steps))
                table.append(line)
        return table

    def _values(self, point: tuple[Any, ...], steps: list[Any]) -> list[Any]:
        """The function at a moving point and after each of some translations of it, all bare reals."""
        setup = self._setup
        f, axes = setup.bare.f, setup.bare.axes
        rates = [addition.rate_at(axes, point), *(addition.rate_after(f, axes, point, step) for step in steps)]
        return list(setup.reals.elements(MP(setup.digits), rates))

    def _halved(self, period: tuple[Any, ...]) -> list[Any]:
        """T(period/2^j) for j = 0 … FINEST, the first of them (the identity) None."""
        unit = self._setup.wide.coerce(2) ** FINEST
        parts = [translation(self._setup, (period[0] / unit, period[1] / unit))]
        for _ in range(FINEST - 1):
            parts.append(combine(self._setup, parts[-1], parts[-1]))
        return [None, *parts[::-1]]

    def _multiples(self, k: int, count: int) -> list[Any]:
        """T(Λ_k/count), T(2Λ_k/count), …, count − 1 of them, wide."""
        step = self._parts[k][int(log2(count))]
        rows = [step]
        for _ in range(count - 2):
            rows.append(combine(self._setup, rows[-1], step))
        return rows

    def _generic_point(self) -> Any:
        """The moving point at which the grid starts, wide."""
        point = self._setup.problem.start
        for part, parts in zip(OFFSET, self._parts, strict=True):
            for bit in range(FINEST):
                if part >> bit & 1:
                    point = moved(self._setup, parts[FINEST - bit], point)
        return point

    def _turn(self, half: Any) -> list[tuple[int, ...]]:
        """The signs that the pairs have in every period of the divisor that a period of 1/g is made of: one or two.

        An odd number of turned γ_i is noticed by an ``odd`` function, whose period is then twice that of the divisor.
        """
        setup = self._setup
        floats = setup.floats
        base, half = (tuple(map(float, row)) for row in (self._base, half))
        again = addition.shift(floats.f, floats.axes, addition.shift(floats.f, floats.axes, base, half), half)
        # γ_i and its rate are not zero together
        signs = [1 if again[i] * base[i] + again[i + 3] * base[i + 3] > 0 else -1 for i in range(4, 7)]
        kept = (1,) * 10
        if not self._odd or signs[0] * signs[1] * signs[2] > 0:
            return [kept]
        return [kept, (1, 1, 1, 1, *signs, *signs)]


def fourier(setup: Setup, samples: list[list[Any]]) -> Any:
    """Two-dimensional discrete Fourier transform, normalised: rows of mpc, the coefficient (0, 0) is the mean."""
    import gmpy2

    context: Any = MP(setup.digits).context
    reals, most = setup.reals, max(len(samples), len(samples[0]))

    def bare(x: Any) -> Any:
        z = context.mpc(x)
        return gmpy2.mpc(reals.number(z.real), reals.number(z.imag))

    with reals:
        turns = [bare(context.expjpi(-context.mpf(2 * k) / most)) for k in range(most // 2)]
        lines = [_transform([bare(x) for x in line], turns) for line in samples]
        columns = [_transform(list(column), turns) for column in zip(*lines, strict=True)]
        size = len(lines) * len(columns)
        field = MP(setup.digits)
        parts = [[reals.elements(field, ((x / size).real, (x / size).imag)) for x in line] for line in columns]
    return [[context.mpc(*pair) for pair in line] for line in zip(*parts, strict=True)]


def _transform(values: list[Any], turns: list[Any]) -> list[Any]:
    """The discrete Fourier transform of 2^k numbers (Cooley & Tukey 1965); ``turns`` are e^(−2πik/2^m), k < 2^(m−1),
    2^m ≥ 2^k.
    """
    n = len(values)
    if n == 1:
        return values
    even, odd = _transform(values[::2], turns), _transform(values[1::2], turns)
    turned = [factor * x for factor, x in zip(turns[:: 2 * len(turns) // n], odd, strict=True)]
    return [x + y for x, y in zip(even, turned, strict=True)] + [x - y for x, y in zip(even, turned, strict=True)]


def tails(grid: Any) -> tuple[Any, Any]:
    """The largest coefficient in the last eighth of the modes of either direction."""
    rows, columns = len(grid), len(grid[0])
    far_rows, far_columns = ({k % n for k in range(n // 2 - n // 16, n // 2 + n // 16 + 1)} for n in (rows, columns))
    return (
        max(abs(grid[i][j]) for i in far_rows for j in range(columns)),
        max(abs(grid[i][j]) for i in range(rows) for j in far_columns),
    )


def next_size(n: int, tail: float, noise: float) -> int:
    """The power of 2 at which a geometric decay to ``tail`` at n/2 modes reaches ``noise``, at least 2n."""
    if not 0 < tail < 0.5:
        return 4 * n
    wanted = 0.8 * n * log2(noise) / log2(tail)
    return int(max(2 * n, 2 ** int(np.ceil(log2(wanted)))))
