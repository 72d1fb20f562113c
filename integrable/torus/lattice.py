"""The real torus of a motion as a lattice, divided into cells. Two small translations reach any point of a cell.

The motion is a straight line on D(0) + θ₁Λ₁ + θ₂Λ₂, Λ_k the real periods of (dx/y, x dx/y). Any small translation is
T(s₁, c₁s₁) + T(s₂, c₂s₂) for two fixed centres c₁, c₂ below all branch points, where f < 0; both are power series in s.
The basis is reduced and the centres are chosen so that the cells, in which the series converge, are few.
"""

from __future__ import annotations

from math import floor, log2
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import HEAVINESS, RATIO, TIME_SCALE, problem_row
from integrable.torus import survey as torus_survey
from integrable.torus.walks import Curve
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField

if TYPE_CHECKING:
    from integrable.moving_point.problem import Problem
    from jacobian.numbers.long_reals import BareReals


# if α1, α2 and α3 differ by at most this, the abscissa has an origin and a unit of its own
CLOSE = 2.0**-6
# with the origin 0 a motion has enough digits if neighbouring branch points differ by more than the fraction APART of
# the larger one, and |γ × M|² is more than this part of |M|²
APART = 2.0**-6
# sizes up to this, and their reciprocals, have powers within the range of floats
FAR = 1e30


class RateCurve(NamedTuple):
    """The attributes of a :class:`~integrable.moving_point.problem.Problem` from which the modes of a rate are made."""

    axes: tuple[Real, ...]
    ratio: Real
    d: Real
    start: tuple[Real, ...]
    half_step: Real


class Source(Protocol):
    """The data of a torus: the motion in bare reals, wide numbers for results, and the given floats, from which
    compiled loops may start (:class:`integrable.moving_point.setup.Setup`).
    """

    @property
    def bare(self) -> Problem: ...
    @property
    def wide(self) -> MultiprecisionField: ...
    @property
    def reals(self) -> BareReals: ...
    @property
    def floats_given(self) -> tuple[np.ndarray, bool] | None: ...


class TimedSource(Source, Protocol):
    """A source with a clock: the length of a unit of τ, and that of a basic step, in the flow's own time."""

    @property
    def time_scale(self) -> Real: ...
    @property
    def step_length(self) -> Real: ...


class Chart(NamedTuple):
    """A division of the torus into cells: two centres, the largest |s| for each, the integer rows of a basis, and the
    numbers of cells in both directions, powers of 2.
    """

    centres: tuple[float, float]
    reaches: tuple[float, float]
    basis: tuple[tuple[int, int], tuple[int, int]]
    cells: tuple[int, int]


class TorusLattice:
    """The periods, frequencies and cells of a motion's torus, in the units of ``motion``, a :func:`motion_row`.

    ``periods`` are Λ₁ and Λ₂, ``frequencies`` ν with (τ, 0) = τ(ν₁Λ₁ + ν₂Λ₂). ``parts`` are s₁ of Λ₁ and Λ₂ over the
    reach of s₁, then s₂ of both over its reach. ``found`` is filled by :func:`integrable.torus.survey.survey`. All are
    rows of numbers of ``loops``. ``turns`` are :func:`signs_of_periods`. PrecisionLoss where too many cells are needed.
    """

    def __init__(self, loops: Any, motion: Row) -> None:
        found, points = loops.room(11), np.zeros(4 + int(loops.floats(motion[8:9])[0] != 0))
        c1, c2, reach1, reach2, m1, n1, m2, n2, rows, columns = loops.survey(motion, loops.short, points, found)
        if not 0 < rows * columns <= torus_survey.MOST_CELLS:
            raise PrecisionLoss(
                f"more than {torus_survey.MOST_CELLS} cells are needed on the torus of this motion, which is nearly "
                "not compact"
            )
        self.chart = Chart((c1, c2), (reach1, reach2), ((m1, n1), (m2, n2)), (rows, columns))
        self.periods, self.frequencies, self.parts = (found[:2], found[2:4]), found[4:6], found[6:10]
        self.found = found
        self.turns = signs_of_periods(motion[4:8], self.chart.basis)

    @property
    def cells(self) -> tuple[int, int]:
        """The number of cells in each direction."""
        return self.chart.cells


def signs_of_periods(points: Row, basis: tuple[tuple[int, int], tuple[int, int]]) -> np.ndarray:
    """The sign changes of γ1, γ2, γ3 in either period of a basis, shape (2, 3); ``points`` are α1, α2, α3 and ζ.

    γ_i vanishes and changes sign where u₁ or u₂ passes α_i, once per round of the oval that ends there. The γ_i of
    α_min changes sign on the first oval, that of α_max on the second, and that of α_mid on the oval that does not end
    at ζ.
    """
    # the sort is stable, so that α_i that are equal in floats are ordered by their index
    *axes, zeta = points.tolist() if isinstance(points, np.ndarray) else points
    low, middle, high = sorted(range(3), key=lambda i: axes[i])
    rounds = {low: 0, middle: 1 if zeta < axes[middle] else 0, high: 1}
    return np.array([[-1.0 if row[rounds[i]] % 2 else 1.0 for i in range(3)] for row in basis])


class Units(NamedTuple):
    """A torus's own abscissa ξ: x = origin + length·ξ, y = length²·lift·η, so that η² is f(ξ) with the last
    factor (r − dξ), (r, d) = (1 − d·origin, d·length)/lift². Length and lift are powers of two, so nothing is rounded.
    """

    origin: Real = 0
    length: float = 1.0
    lift: float = 1.0

    @property
    def time(self) -> float:
        """The value of Σ∫dξ/η over a path with Σ∫dx/y = 1."""
        return self.length * self.lift

    @staticmethod
    def of(setup: Source) -> Units:
        """Units for branch points that are all close together, as for nearly equal moments or a heavy ball. For other
        motions length and lift are 1.
        """
        problem = setup.bare
        with setup.reals:
            origin, axes = best_origin(setup), problem.axes[:3]
            length = _near_power(float(max(axes) - min(axes)))
            rest = max(float(1 - problem.d * origin), float(problem.d) * length)
        return Units(origin, length, _near_power(rest**0.5))

    def of_point(self, point: tuple[Real, ...]) -> tuple[Real, ...]:
        """A moving point in these units, to be called within ``with setup.reals``."""
        u0, u1, v0, v1, *pairs = point
        x, length, lift = self.origin, self.length, self.lift
        u0, u1, v0 = u0 + (u1 + x) * x, u1 + 2 * x, v0 + v1 * x
        high = length * length * lift
        return (u0 / (length * length), u1 / length, v0 / high, v1 / (length * lift), *pairs[:3],
                *(nu / lift for nu in pairs[3:]))  # fmt: skip


def _near_power(x: float) -> float:
    """The largest power of two up to x if x is small, else 1."""
    return 1.0 if x > CLOSE else 2.0 ** floor(log2(x))


def motion_row(setup: Source, units: Units) -> tuple[Real, ...]:
    """The motion as :mod:`integrable.torus.survey` takes it, in bare reals: the ends of both ovals, α1, α2, α3, ζ, d,
    π, r and the origin, in the given units.

    PrecisionLoss where the torus is not compact.
    """
    (origin, length, lift), problem, reals = units, setup.bare, setup.reals
    with reals:
        first, second = oval_ends(problem, reals.number(1) / (1 << int(0.75 * setup.wide.context.prec)))
        abscissae = ((x - origin) / length for x in (*first, *second, *problem.axes[:3], problem.ratio))
        square, d, pi = lift * lift, problem.d, reals.number(+setup.wide.context.pi)
        return (*abscissae, d * length / square, pi, (1 - d * origin) / square, origin / length)


def best_origin(setup: Source) -> Real:
    """The origin, 0 or one of the a_i, that keeps the most digits of the distances between close branch
    points; within ``with setup.reals``.
    """
    points = setup.bare.branch_points
    gaps = [(i, j, abs(float(points[i] - points[j]))) for i in range(len(points)) for j in range(i)]

    def digits(origin: Real) -> float:
        far = [abs(float(x - origin)) for x in points]
        return min(gap / max(far[i], far[j]) for i, j, gap in gaps if gap)

    return max((setup.reals.number(0), *setup.bare.axes[:3]), key=digits)


def oval_ends(problem: Problem | RateCurve, near: Real) -> tuple[tuple[Real, Real], tuple[Real, Real]]:
    """The ovals [α_min, min(ζ, α_mid)] and [max(ζ, α_mid), α_max] on which u1 and u2 move, ζ = h1/(h2·max a).

    PrecisionLoss if they come ``near`` each other (the separatrix) or shrink to points: the motion is then not a line
    on a compact torus of dimension two.
    """
    low, middle, high = sorted(problem.axes[:3])
    first, second = (low, min(problem.ratio, middle)), (max(problem.ratio, middle), high)
    if second[0] - first[1] <= near:
        raise PrecisionLoss("the ovals of the curve have met: the torus of this motion is not compact")
    return first, second


class Beginning(NamedTuple):
    """The data from which a torus is made, in rows of numbers of its loops. They are a :func:`motion_row` and its
    ``units``, the curve and the start in these units, and a :func:`~integrable.moving_point.problem.problem_row` in the
    set-up's units, of which only the entries from TIME_SCALE on are needed.
    """

    units: Units
    motion: Row
    curve: Curve
    start: Row
    problem: Row


def beginning(setup: Source, loops: Any) -> Beginning:
    """The rows of a motion. The loops compute them if branch points are well separated; otherwise numbers with more
    digits are used.
    """
    found: Beginning | None = loops.begun(setup)
    if found is not None:
        return found
    units = Units.of(setup)
    motion, curve, row, problem = loops.row(motion_row(setup, units)), loops.room(9), loops.row, setup.bare
    loops.about_centre(motion, 0.0, 1.0, curve)
    *kappas, alpha, beta = problem.axes[3:]
    with setup.reals:
        kappas = [kappa / (units.length * units.length) for kappa in kappas]
        start, others = row(units.of_point(problem.start)), row((*kappas, alpha, beta * units.time, 1, 1, 1, 1, 0))
    axes, joined = curve[6:], loops.joined
    whole = Curve(curve[:6], joined(axes, others[:5]), joined(axes, others[5:]))
    return Beginning(units, motion, whole, start, row((0,) * TIME_SCALE + problem.row[TIME_SCALE:]))


def begun_rows(given: Row, tilted: bool, constants: Row, problem: Row, motion: Row) -> bool:
    """Fills a ``problem`` row and a ``motion`` row with the origin 0 from moments, d, γ and M (``given``). Returns
    whether the numbers have enough digits: sizes near 1 and well-separated branch points. ``constants`` are π and 1.
    """
    x, y, z, a, b, c = (float(given[4]), float(given[5]), float(given[6]),
                        float(given[7]), float(given[8]), float(given[9]))  # fmt: skip
    least, most = min(given[0], given[1], given[2]), max(given[0], given[1], given[2])
    square, u, v, w = a * a + b * b + c * c, y * c - z * b, z * a - x * c, x * b - y * a
    if least < 1 / FAR or most + given[3] > FAR or not 1 / FAR < square < FAR or 0 < given[3] < 1 / FAR:
        return False
    if (u * u + v * v + w * w) < APART * square:
        return False
    problem_row(given, tilted, problem)
    first, second, third, zeta, d = problem[6], problem[7], problem[8], problem[RATIO], problem[HEAVINESS]
    low, high = min(first, second, third), max(first, second, third)
    middle = max(min(first, second), min(max(first, second), third))
    one = constants[1]
    motion[0], motion[1], motion[2], motion[3] = low, min(zeta, middle), max(zeta, middle), high
    motion[4], motion[5], motion[6], motion[7] = first, second, third, zeta
    motion[8], motion[9], motion[10], motion[11] = d, constants[0], one, 0 * one
    for k in range(3):
        if not motion[k + 1] - motion[k] > APART * motion[k + 1]:
            return False
    return low > 0 and one - d * high > APART
