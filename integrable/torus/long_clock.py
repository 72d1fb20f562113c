"""Physical time at any distance: 1/g is a quasi-periodic function of the flow's own time, a Fourier series on a real
torus.

The motion is a straight line on the torus of real divisors with one point on either oval, D = D(0) + θ₁Λ₁ + θ₂Λ₂, with
Λ_k the real periods of (dx/y, x dx/y) over the ovals. Samples of 1/g on a grid of θ give t = ∫dτ/g as a mean rate times
τ and a bounded oscillation, whose inverse is found by Newton from the mean: no step of the motion is taken. (Fedorov
2009 gives the same functions as theta functions.)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from integrable.torus.long_grid import TorusGrid
from jacobian import MP, RR

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


class MultiprecisionTorusClock:
    """t(τ) and τ(t) for any τ, in the units of a :class:`~integrable.moving_point.setup.Setup`, to ``digits``: by
    default those of the set-up.

    Raises PrecisionLoss where the torus is degenerate or nearly so: that is for the clock that counts steps.
    """

    def __init__(self, setup: Setup, digits: int | None = None) -> None:
        self._setup = setup
        self.wide, self._work = setup.wide, MP(setup.digits)
        self._eps = self._work.coerce(10) ** -(digits or setup.digits)
        self._grid = TorusGrid(setup, digits)
        self.frequencies = self._grid.frequencies()
        grid, self.mean = self._grid.resolved()
        self._series = self._oscillating_part(grid)
        self._origin = self._oscillation([self._angles(setup.wide.zero)])[0][0]

    def time(self, tau: Any) -> Any:
        """t at τ, both wide."""
        swing = self._oscillation([self._angles(tau)])[0][0] - self._origin
        return tau * self.mean + self._setup.wide.coerce(swing)

    def tau(self, times: list[Any]) -> list[Any]:
        """τ at every t, all wide."""
        starts = [t / self.mean for t in times]
        shifts = self._shifts([self._angles(start) for start in starts])
        return [start + self._setup.wide.coerce(shift) for start, shift in zip(starts, shifts, strict=True)]

    def _angles(self, tau: Any) -> tuple[Any, Any]:
        """(θ₁, θ₂) modulo 1 on the grid, rounded after the whole turns are taken off."""
        number, floor = self._work.coerce, self._setup.wide.context.floor
        first, second = (tau * nu + origin for nu, origin in zip(self.frequencies, self._grid.origin, strict=True))
        return number(first - floor(first)), number(second - floor(second))

    def _shifts(self, angles: list[tuple[Any, Any]]) -> list[Any]:
        """s with mean·s + S(θ + νs) = S(0), by Newton: the oscillation of τ about its mean value."""
        rough = [(float(a), float(b)) for a, b in angles]
        shifts = self._newton(rough, [0.0] * len(angles), float, self._rough)
        return self._newton(angles, [self._work.coerce(s) for s in shifts], self._work.coerce, self._oscillation)

    def _newton(self, angles: list[Any], shifts: list[Any], number: Any, series: Any) -> list[Any]:
        mean, nu1, nu2 = number(self.mean), *map(number, self.frequencies)
        origin = number(self._origin)
        eps = RR.eps if number is float else self._eps
        # with more digits the slope still is a float's, and a step leaves that part of itself
        gain = 1 if number is float else 1e-13
        for _ in range(100):
            found = series([(a + nu1 * s, b + nu2 * s) for (a, b), s in zip(angles, shifts, strict=True)])
            steps = [(mean * s + swing - origin) / rate for (swing, rate), s in zip(found, shifts, strict=True)]
            shifts = [s - step for s, step in zip(shifts, steps, strict=True)]
            if gain * max(map(abs, steps), default=0) <= 4 * eps * (1 + max(map(abs, shifts), default=0)):
                break
        return shifts

    # --- the series

    def _oscillating_part(self, grid: Any) -> list[tuple[int, int, list[Any]]]:
        """S with dS/dτ = 1/g − mean: for k = 0, 1, … the coefficients of e^(2πi(kθ₁ + mθ₂)), as (k, first m, values).

        Those of −k, −m are their conjugates; ``_floats`` holds the same series and that of 1/g for floats.
        """
        setup = self._setup
        two_pi = 2 * setup.wide.context.pi
        rows, columns = len(grid), len(grid[0])
        noise = self._eps * abs(grid[0][0])
        lines = []
        for k in range(rows // 2):
            kept = [m for m in range(1 - columns // 2, columns // 2) if abs(grid[k][m]) > noise]
            if kept:
                span = range(min(kept), max(kept) + 1)
                phases = [two_pi * (k * self.frequencies[0] + m * self.frequencies[1]) for m in span]
                line = [grid[k][m] for m in span]
                swing = [c / (1j * self._work.coerce(x)) if x else 0 * c for c, x in zip(line, phases, strict=True)]
                lines.append((k, min(kept), swing, line))
        width = max(abs(m) for _, first, line, _ in lines for m in (first, first + len(line) - 1))
        self._floats = [np.zeros((lines[-1][0] + 1, 2 * width + 1), dtype=complex) for _ in range(2)]
        for k, first, *both in lines:
            for table, line in zip(self._floats, both, strict=True):
                table[k, first + width : first + width + len(line)] = [complex(c) for c in line]
        return [(k, first, swing) for k, first, swing, _ in lines]

    def _oscillation(self, angles: list[tuple[Any, Any]]) -> list[tuple[Any, Any]]:
        """(S, 1/g) at every (θ₁, θ₂): the oscillating part of t, and dt/dτ (to the digits of a float)."""
        rates = self._rough([(float(a), float(b)) for a, b in angles])
        return [(self._swing_at(*pair), rate) for pair, (_, rate) in zip(angles, rates, strict=True)]

    def _rough(self, angles: list[tuple[float, float]]) -> list[tuple[float, float]]:
        """The same in floats, all angles at once."""
        if not angles:
            return []
        first, second = np.array(angles).T
        rows, columns = self._floats[0].shape
        left = np.exp(2j * np.pi * np.outer(first, np.arange(rows)))
        left[:, 1:] *= 2  # for the conjugate half
        right = np.exp(2j * np.pi * np.outer(second, np.arange(columns) - columns // 2))
        swing, rate = (np.einsum("ij,ij->i", left @ series, right).real for series in self._floats)
        return list(zip(swing.tolist(), rate.tolist(), strict=True))

    def _swing_at(self, first: Any, second: Any) -> Any:
        """S at one (θ₁, θ₂), in multiprecision."""
        context: Any = self._work.context
        reach = max(max(-start, start + len(line)) for _, start, line in self._series)
        left = powers(context, first, self._series[-1][0] + 1)
        right = powers(context, second, reach + 1)
        right = [x.conjugate() for x in right[:0:-1]] + right
        total = context.zero
        for k, start, line in self._series:
            part = context.fdot(line, right[start + reach : start + reach + len(line)])
            total += (part * left[k]).real * (2 if k else 1)
        return total


def powers(context: Any, angle: Any, count: int) -> list[Any]:
    """e^(2πi·k·angle) for k = 0 … count − 1."""
    base = context.expjpi(2 * angle)
    powers = [context.mpc(1)]
    for _ in range(count - 1):
        powers.append(powers[-1] * base)
    return powers
