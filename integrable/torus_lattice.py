"""The real torus of a motion as a lattice, cut into cells that two small translations reach across.

The motion is a straight line on D(0) + θ₁Λ₁ + θ₂Λ₂, Λ_k the real periods of (dx/y, x dx/y). Any small translation is
T(s₁, c₁s₁) + T(s₂, c₂s₂) for two fixed centres c₁, c₂ below all branch points, where f < 0; both are power series in s.
The basis is reduced and the centres are chosen so that the cells, in which the series converge, are few.
"""

from __future__ import annotations

from functools import cached_property
from math import inf, prod, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from integrable.periods import REACH, ovals
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.flow_setup import Setup

MOST_CELLS = 1 << 16
# so many centres are tried, at distances from the least branch point in geometric progression up to FARTHEST·max a
CENTRES = 12
FARTHEST = 2.0


class Chart(NamedTuple):
    """A way to cut the torus: two centres, the largest s for either, integer rows of a basis, cells in either
    direction.
    """

    centres: tuple[float, float]
    reaches: tuple[float, float]
    basis: tuple[tuple[int, int], tuple[int, int]]
    cells: tuple[int, int]


class TorusLattice:
    """The periods, frequencies and cells of a motion's torus, in the units of a flow's set-up.

    PrecisionLoss where the torus is not compact, or needs more than MOST_CELLS cells.
    """

    def __init__(self, setup: Setup) -> None:
        self._setup = setup
        given = [oval.periods for oval in ovals(setup)]
        self.chart = _best_chart(setup, [[float(x) for x in row] for row in given])
        self.periods = [tuple(m * x + n * y for x, y in zip(*given, strict=True)) for m, n in self.chart.basis]

    @property
    def cells(self) -> tuple[int, int]:
        """The number of cells in either direction, powers of 2."""
        return self.chart.cells

    @cached_property
    def frequencies(self) -> tuple[Any, Any]:
        """ν with (τ, 0) = τ(ν₁Λ₁ + ν₂Λ₂), wide."""
        (p, q), (r, s) = self.periods
        determinant = p * s - q * r
        return s / determinant, -q / determinant

    @cached_property
    def parts(self) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
        """((s₁ of Λ₁, s₁ of Λ₂), (s₂ of Λ₁, s₂ of Λ₂)): what the translation by Λ_k takes in either direction, wide."""
        c1, c2 = map(self._setup.wide.coerce, self.chart.centres)
        rows = [_parts(c1, c2, *period) for period in self.periods]
        return (rows[0][0], rows[1][0]), (rows[0][1], rows[1][1])


def _parts(c1: Any, c2: Any, a: Any, b: Any) -> tuple[Any, Any]:
    """(s₁, s₂) with (a, b) = s₁(1, c₁) + s₂(1, c₂)."""
    second = (b - c1 * a) / (c2 - c1)
    return a - second, second


def _best_chart(setup: Setup, periods: list[list[float]]) -> Chart:
    least = float(min(setup.wide_branch_points))
    nearest = min(least, float(max(setup.wide_axes) - min(setup.wide_axes))) / 4
    ratio = (FARTHEST / nearest) ** (1 / (CENTRES - 1))
    centres = [least - nearest * ratio**k for k in range(CENTRES)]
    # from the roots, near which the coefficients of f cancel
    lead = abs(float(setup.wide_f[5] or setup.wide_f[4]))
    reaches = {
        c: 2 * REACH * (least - c) / sqrt(lead * prod(float(e - c) for e in setup.wide_branch_points)) for c in centres
    }
    best, fewest = None, inf
    for i, c1 in enumerate(centres):
        for c2 in centres[:i]:
            scaled = [
                tuple(s / reaches[c] for s, c in zip(_parts(c1, c2, *row), (c1, c2), strict=True)) for row in periods
            ]
            basis = _reduced(scaled)
            cells = _cells([tuple(m * x + n * y for x, y in zip(*scaled, strict=True)) for m, n in basis])
            if cells[0] * cells[1] < fewest:
                fewest, best = cells[0] * cells[1], Chart((c1, c2), (reaches[c1], reaches[c2]), basis, cells)
    if best is None or fewest > MOST_CELLS:
        raise PrecisionLoss(f"{fewest} cells are needed on the torus of this motion, which is nearly not compact")
    return best


def _reduced(rows: list[Any]) -> tuple[tuple[int, int], tuple[int, int]]:
    """Integer rows of a basis of two short vectors (Lagrange 1773)."""
    first, second = (1, 0), (0, 1)
    for _ in range(200):
        v, w = ([m * x + n * y for x, y in zip(*rows, strict=True)] for m, n in (first, second))
        if v[0] * v[0] + v[1] * v[1] > w[0] * w[0] + w[1] * w[1]:
            first, second, v, w = second, first, w, v
        turns = round((v[0] * w[0] + v[1] * w[1]) / (v[0] * v[0] + v[1] * v[1]))
        if turns == 0:
            break
        second = (second[0] - turns * first[0], second[1] - turns * first[1])
    return first, second


def _cells(rows: list[Any]) -> tuple[int, int]:
    """The fewest cells, powers of 2 in either direction, whose corners are within reach of their centres."""
    best, fewest = (1 << 30, 1 << 30), 1 << 60
    sizes = [[abs(x) / 2 for x in row] for row in rows]
    first = 2
    while first <= MOST_CELLS:
        # what is left of the reach in either direction
        left = [1 - x / first for x in sizes[0]]
        if min(left) > 0:
            second = 2
            while second <= MOST_CELLS and any(x / second > room for x, room in zip(sizes[1], left, strict=True)):
                second *= 2
            if first * second < fewest:
                best, fewest = (first, second), first * second
        first *= 2
    return best
