"""The moving points at the corners of a torus, computed once. Any state, and 1/g on grids of its periods, is computed
from them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property
from math import asinh, ceil, copysign, cos, inf, log2, pi, sqrt
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from integrable.moving_point.addition import Row
from integrable.torus.lattice import TorusLattice, beginning
from integrable.torus.loops import CompiledLoops, Loops, NotClosed
from integrable.torus.states import Torus
from integrable.torus.survey import RATES, REACH
from integrable.torus.tables import SmallSteps, TableRoom
from integrable.torus.walks import Fine, Walk
from integrable.torus.witness import BORDERS, LEAST, SEAM, TERMS, Line
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.numbers.double_double import EPS

if TYPE_CHECKING:
    from integrable.moving_point.addition import Row
from integrable.torus.lattice import Source

# a single walk over the corners must close to within ROUND; otherwise two walks that meet are made, and must close to
# within CLOSED
ROUND = 1e-17
CLOSED = 1e-13
# the largest number of cells that one step of a walk over the corners spans
MOST_AT_ONCE = 7
# if the relative gap of the ovals is below NEAR, two walks over the corners meet, because errors grow away from the
# unstable rotation
NEAR = 2.0**-23
# number of quadrature nodes on the path from the start to the column at which the two walks meet
QUADRATURE = 32
# 1/g is computed from the factor r − dx of f if at every α_i this factor is at least this part of the sum of the sizes
# of its terms. A smaller factor has lost digits. A larger one is better than U, which loses twice as many digits near
# its root, and than the sum for 1/g, which loses three times as many
LEAST_REST = 2.0**-14
# the first grid of 1/g has at least FIRST_SIZE points in each direction. For ovals with a relative gap below PASSING it
# has at least PASSAGES·(s₁ + s₂) columns, with the s₁ and s₂ of Λ₂ in units of the distance to the next branch point
FIRST_SIZE = 16
PASSING = 2.0**-7
PASSAGES = 3.1

Samples = Callable[[tuple[int, int], "np.ndarray | None"], np.ndarray]
"""A function that gives values on a grid of given sizes; values on a coarser grid may be known."""
Found = TypeVar("Found")
Transform = Callable[[np.ndarray], tuple[Found, tuple[int, int]]]
"""A function of samples that returns a result of them and the shape of a grid that is fine enough."""


@cache
def nodes(count: int) -> tuple[float, ...]:
    """The Chebyshev nodes in z = (s/reach)², from 0 to 1, rounded to floats, which then count as exact."""
    return tuple((1 + cos(pi * (k + 0.5) / count)) / 2 for k in range(count))


class Corners:
    """The moving points at the corners of a torus's cells, by loops of :mod:`integrable.torus.loops`.

    ``units`` are those of the abscissa, ``lattice`` has the periods and cells, ``turns`` the sign changes over a
    period. ``closure`` is the error with which periods lead back to the start; ``doubled`` are the periods of 1/g in
    units of those of the divisor. PrecisionLoss where the torus is not compact, or needs more than ``most`` cells or
    samples of 1/g. NotClosed where walks do not lead back, or cells of compiled loops do not fit at their borders.
    """

    def __init__(self, setup: Source, loops: Loops, most: int) -> None:
        self.setup, self.loops, self._most = setup, loops, most
        self.units, motion, self.curve, self._start, self._problem = beginning(setup, loops)
        self._motion = motion
        self.lattice = lattice = TorusLattice(loops, motion)
        self.sizes, self.turns = lattice.cells, lattice.turns
        self.signs = tuple(self.turns.ravel().tolist())
        odd = [signs.count(-1.0) % 2 == 1 for signs in self.turns.tolist()]
        self.odd = odd[0], odd[1]
        # for a tilted body, a sign change of an odd number of γ_i changes 1/g, whose period is then twice the divisor's
        leans = loops.floats(self.curve.axes[7:])[0] != 0
        self.doubled = (1 + odd[0], 1 + odd[1]) if leans else (1, 1)
        self.rates = self._made_rates(motion)
        tables, self._halves = self._translations(motion)
        self._rest = loops.room(2) if leans else rest_of(motion, loops)
        self.small = SmallSteps(self.curve.unit_axes, lattice.chart.centres, tables, loops.terms, lattice.parts)
        if self.sizes[0] * self.sizes[1] > most:
            raise PrecisionLoss(f"the torus of this motion needs {self.sizes[0]} × {self.sizes[1]} cells")
        self._walk_over(motion)
        self._check_walk()

    def _made_rates(self, motion: Row) -> Row:
        """The result of :func:`integrable.torus.survey.surveyed_rates`."""
        rates, units = self.loops.room(RATES), (self.units.length, self.units.lift)
        self.loops.rates(self._problem, self.lattice.found, motion, units, self.doubled, rates)
        return rates

    def _check_walk(self) -> None:
        """Raises NotClosed if the states at the corners are not reliable."""
        if not self.compiled:
            return
        kappa = float(np.abs(self.loops.floats(self.curve.axes[3:6])).min())
        if not self.loops.seam(self.torus, np.empty(2 * BORDERS)) <= SEAM * min(1, max(10 * kappa, LEAST)):
            raise NotClosed("the cells of this motion's torus do not fit to rounding; use more digits")

    @property
    def compiled(self) -> bool:
        """Whether the loops are compiled. A state then takes microseconds, a thousandth of the interpreted time."""
        return isinstance(self.loops, CompiledLoops)

    @cached_property
    def frequencies(self) -> tuple[Real, Real]:
        """Turns of each phase per unit of τ, wide."""
        nu1, nu2 = self.loops.wide(self.rates[6:8], self.setup.wide)
        return nu1, nu2

    @cached_property
    def mean(self) -> Real:
        """The mean of 1/g over the torus, wide: a determinant of elliptic integrals, independent of samples.

        A tilt does not change it: the tilt term changes sign around an oval with one end at an a_i, so its mean is 0.
        """
        return self.loops.wide(self.rates[9:10], self.setup.wide)[0]

    @cached_property
    def torus(self) -> Any:
        """The :class:`~integrable.torus.states.Torus`, packed for the loops."""
        curve, small = self._packed_curve, self._packed_small
        return self.loops.packed(Torus(curve, self.rates[:4], self.states, small, self.signs, self.sizes))

    def reached(self, tau: np.ndarray) -> np.ndarray:
        """γ and M at values of τ by additions to the start, without periods and corners: shape (N, 6)."""
        out = np.empty(6 * len(tau))
        self.loops.reached(*self._line(tau), out)
        return out.reshape(-1, 6)

    def _line(self, tau: np.ndarray) -> tuple[Line, np.ndarray, TableRoom, Row]:
        """The arguments, with working memory, for the loops that reach these times by additions to the start."""
        room = self.loops.room
        # branch points in a cluster are all far from the flow's centre, and translations about this centre then lose
        # digits
        far = self.units.length < 1
        line = Line(self._packed_curve, self._start, self._motion, self.rates, self.lattice.chart.centres, far)
        return line, tau, TableRoom(room(TERMS), room(TERMS), room(9), room(0)), room(10 * len(tau))

    def at_phases(self, phases: np.ndarray) -> np.ndarray:
        """γ and M at points of the torus, shape (N, 6): ``phases`` in turns from the start, shape (N, 2)."""
        out = np.empty(6 * len(phases))
        self.loops.states_at_phases(self.torus, np.ascontiguousarray(phases, dtype=np.float64).ravel(), out)
        return out.reshape(-1, 6)

    def resolved(self, transformed: Transform[Found]) -> Found:
        """The spectrum of 1/g on a grid of its periods that resolves it: ``transformed(samples)`` returns the spectrum
        and the shape of a grid that is fine enough.
        """
        return resolved(self.samples, transformed, self.first_grid(), self._most)

    def first_grid(self) -> tuple[int, int]:
        """The first grid. Where ovals nearly meet, its columns are as many as a passage near the separatrix needs."""
        (rows, columns), loops = self.sizes, self.loops
        first, low, high, last = loops.floats(self._motion[:4]).tolist()
        if high - low > PASSING * (last - first):
            return max(FIRST_SIZE, rows), max(FIRST_SIZE, columns)
        extent = REACH * float(np.abs(loops.floats(self.lattice.parts)[1::2]).sum())
        return max(2 * FIRST_SIZE, rows), max(columns, 2 ** ceil(log2(PASSAGES * extent)))

    def samples(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> np.ndarray:
        """1/g on a grid of its periods, with ``sizes`` points per period of the divisor. Compiled loops give
        double-doubles with a last axis; interpreted ones give long doubles, or their own numbers where these have more
        digits. ``known`` are the samples of a coarser grid.
        """
        loops, fine = self.loops, self.fine(sizes, known)
        first, other = loops.room(sizes[0] * sizes[1]), loops.room(sizes[0] * sizes[1])
        loops.gridded(self._packed_curve, self._packed_small, self.states, fine, first, other)
        table = loops.samples(first, sizes)
        if self.doubled == (1, 1):
            return self.completed(table, known)
        beside, (rows, columns), (down, across) = loops.samples(other, sizes), sizes, self.doubled
        whole = np.empty((down, rows, across, columns, *table.shape[2:]), dtype=table.dtype)
        for i, j in np.ndindex(self.doubled):
            whole[i, :, j] = beside if (i * self.odd[0] + j * self.odd[1]) % 2 else table
        return self.completed(whole.reshape(down * rows, across * columns, *table.shape[2:]), known)

    def completed(self, samples: np.ndarray, known: np.ndarray | None) -> np.ndarray:
        """The samples with those of a coarser grid filled in."""
        if known is not None:
            samples[:: samples.shape[0] // known.shape[0], :: samples.shape[1] // known.shape[1]] = known
        return samples

    def fine(self, sizes: tuple[int, int], known: np.ndarray | None = None) -> Fine:
        """The :class:`~integrable.torus.walks.Fine` of a grid, with memory for its translations. It omits the points of
        a coarser grid, whose samples are ``known``.
        """
        cells = self.sizes
        finer = sizes[0] // cells[0], sizes[1] // cells[1]
        steps, counts = self.loops.room(20 * finer[0] * finer[1]), np.zeros(finer[0] * finer[1], dtype=np.int64)
        coarser = (0, 0)
        if known is not None:
            coarser = sizes[0] * self.doubled[0] // known.shape[0], sizes[1] * self.doubled[1] // known.shape[1]
        return Fine(cells, finer, self.odd, steps, counts, coarser, self._rest)

    # --- set-up

    @cached_property
    def _packed_curve(self) -> Any:
        return self.loops.packed(self.curve)

    @cached_property
    def _packed_small(self) -> Any:
        return self.loops.packed(self.small)

    def _translations(self, motion: Row) -> tuple[Row, Row]:
        """The tables of both directions, one after the other, and the translations by half a cell."""
        loops = self.loops
        tables, halves = loops.room(8 * loops.terms), loops.room(40)
        loops.directions(motion, self.lattice.chart, self.lattice.parts, nodes(loops.terms), tables, halves)
        return tables, halves

    def _walk_over(self, motion: Row) -> None:
        """Walk over the corners of the cells; NotClosed where the walks do not lead back."""
        # near the separatrix errors decrease towards the unstable rotation and grow away from it. So two walks go
        # towards it, and meet in the column nearest to it
        motion, start, periods = map(self.loops.floats, (motion, self._start, self.lattice.found[:4]))
        first, low, high, last = motion[:4].tolist()
        self._near = bool(high - low < NEAR * (last - first))
        if not self._near:
            self._walk(self.sizes[1], MOST_AT_ONCE)
        if self._near or not self.closure <= ROUND:
            self._walk(nearest_column(motion, start, periods, self.sizes[1]), 1)
        if not self.closure <= CLOSED:
            raise NotClosed(f"a period of this motion leads back to {self.closure:.1e} only; use more digits")

    def _walk(self, forward: int, most: int) -> None:
        loops, cells = self.loops, self.sizes
        ends, known = loops.room(10 * (cells[0] + 1)), loops.room(10 * (cells[0] + 1))
        self.states = loops.room(10 * cells[0] * cells[1])
        walk = Walk(cells, forward, most, self.signs, self._halves, loops.room(40))
        self.closure = loops.corners(self._packed_curve, self._start, loops.packed(walk), self.states, ends, known)


def resolved(samples: Samples, transformed: Transform[Found], sizes: tuple[int, int], most: int) -> Found:
    """:meth:`Corners.resolved`, from a first grid of ``sizes``; PrecisionLoss beyond ``most`` samples."""
    known: np.ndarray | None = None
    while sizes[0] * sizes[1] <= most:
        known = samples(sizes, known)
        found, wanted = transformed(known)
        shape = known.shape[:2]
        if wanted == shape:
            return found
        sizes = (sizes[0] * wanted[0] // shape[0], sizes[1] * wanted[1] // shape[1])
    raise PrecisionLoss(f"a rate needs a grid of {sizes[0]} × {sizes[1]} on the torus of this motion")


def rest_of(motion: Row, loops: Loops) -> Row:
    """(d, r) of the factor r − dx of f, in the loops' numbers. (0, 0) if the factor is so small at an α_i, relative to
    its terms, that it loses digits which a grid of 1/g needs.
    """
    floats = loops.floats(motion)
    axes, d, r = floats[4:7], floats[8], floats[10]
    if (r - d * axes).min() < LEAST_REST * (abs(r) + d * np.abs(axes).max()):
        return loops.room(2)
    return loops.joined(motion[8:9], motion[10:11])


def nearest_column(motion: np.ndarray, start: np.ndarray, periods: np.ndarray, columns: int) -> int:
    """The column of corners at which a motion is nearest to the unstable rotation, kept away from the column of the
    start.

    ``motion`` is a :func:`~integrable.torus.lattice.motion_row`, ``periods`` are (a₁, b₁, a₂, b₂). At that column one
    point of the divisor is at one of the ends that nearly meet, the other at the far end of its oval: half a period of
    the columns from where both are at the near ends. With x = end ± gap·sinh²(t) on the path, dx/y is smooth.
    """
    first, low, high, last = motion[:4].tolist()
    # the gap may be 0 in floats, and lines below divide by it
    gap, d, r = max(high - low, EPS * (last - first)), motion[8], motion[10]
    u0, u1, v0, v1 = start[:4].tolist()
    half, passed = sqrt(max(0.25 * u1 * u1 - u0, 0.0)), np.zeros(2)
    z, weights = legendre(QUADRATURE)
    for sign, end in ((-1, low), (1, high)):
        x = sign * half - 0.5 * u1
        t = asinh(sqrt(abs(x - end) / gap))
        # the nodes are sparse at the far end of the path, since that end of the oval may be a branch point
        xs = end + sign * gap * np.sinh(t * z * (2 - z)) ** 2
        others = np.maximum(xs - first, gap) * np.maximum(last - xs, gap) * np.maximum(r - d * xs, d * gap)
        rates = weights * (1 - z) / np.sqrt(others)
        passed += copysign(4 * t, -sign * (v0 + v1 * x)) * np.array([rates.sum(), rates @ xs])
    a1, b1, a2, b2 = periods.tolist()
    area = a1 * b2 - b1 * a2
    if not 0 < abs(area) < inf:
        return columns // 2
    turns = 0.5 + float(a1 * passed[1] - b1 * passed[0]) / area
    # if the start is near the column where the walks meet, one of the walks would end where errors are largest
    least = columns // 8
    return max(1, least, min(round(columns * turns) % columns, columns - least))


@cache
def legendre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss's nodes and weights on [0, 1]."""
    x, weights = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, weights / 2
