"""The real torus of a motion as a lattice, cut into cells that two small translations reach across.

The motion is a straight line on D(0) + θ₁Λ₁ + θ₂Λ₂, Λ_k the real periods of (dx/y, x dx/y). Any small translation is
T(s₁, c₁s₁) + T(s₂, c₂s₂) for two fixed centres c₁, c₂ below all branch points, where f < 0; both are power series in s.
The basis is reduced and the centres are chosen so that the cells, in which the series converge, are few.
"""

from __future__ import annotations

from math import floor, log2
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from integrable.torus import survey as torus_survey
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.setup import Setup


# branch points that are as close as this, in the unit of the largest, count from an origin and in a unit of their own
CLOSE = 2.0**-6


class Chart(NamedTuple):
    """A way to cut the torus: two centres, the largest s for either, integer rows of a basis, cells in either
    direction, powers of 2.
    """

    centres: tuple[float, float]
    reaches: tuple[float, float]
    basis: tuple[tuple[int, int], tuple[int, int]]
    cells: tuple[int, int]


class TorusLattice:
    """The periods, frequencies and cells of a motion's torus, in the units of ``motion``.

    ``periods`` are Λ₁ and Λ₂, ``frequencies`` ν with (τ, 0) = τ(ν₁Λ₁ + ν₂Λ₂), ``parts`` s₁ of Λ₁ and Λ₂ and s₂ of both
    over their reaches, ``slowness`` the mean of 1/√((1 − du₁)(1 − du₂)): rows of numbers of ``loops``, as are those of
    ``motion``, a :func:`motion_row`. ``turns`` are :func:`signs_of_periods`. PrecisionLoss where too many cells are
    needed.
    """

    def __init__(self, setup: Setup, loops: Any, motion: Any) -> None:
        found, points = loops.room(11), [0.0] * len(setup.problem.branch_points)
        c1, c2, reach1, reach2, m1, n1, m2, n2, rows, columns = loops.survey(motion, loops.short, points, found)
        if not 0 < rows * columns <= torus_survey.MOST_CELLS:
            raise PrecisionLoss(
                f"more than {torus_survey.MOST_CELLS} cells are needed on the torus of this motion, which is nearly "
                "not compact"
            )
        self.chart = Chart((c1, c2), (reach1, reach2), ((m1, n1), (m2, n2)), (rows, columns))
        self.periods, self.frequencies, self.parts = (found[:2], found[2:4]), found[4:6], found[6:10]
        self.slowness = found[10:]
        self.turns = signs_of_periods(setup, self.chart.basis)

    @property
    def cells(self) -> tuple[int, int]:
        """The number of cells in either direction."""
        return self.chart.cells


def signs_of_periods(setup: Setup, basis: tuple[tuple[int, int], tuple[int, int]]) -> np.ndarray:
    """The signs that γ1, γ2, γ3 change by in either period of a basis, shape (2, 3).

    γ_i vanishes where u₁ or u₂ passes α_i, which is once in a round of the oval that ends there, and its sign changes:
    that of α_min on the first round, of α_max on the second, of α_mid with the oval that ζ does not end.
    """
    # axes that are one float are told apart
    order = sorted(range(3), key=lambda i: setup.problem.axes[:3][i])
    middle = setup.problem.axes[:3][order[1]]
    rounds = np.zeros((3, 2), dtype=int)
    rounds[order] = (1, 0), (0, 1) if setup.problem.ratio < middle else (1, 0), (0, 1)
    # the parity of long integers is found before they become those of numpy
    parities = np.array([[n % 2 for n in row] for row in basis])
    signs: np.ndarray = 1.0 - 2.0 * (parities @ rounds.T % 2)
    return signs


class Units(NamedTuple):
    """An abscissa ξ of its own for a torus: x = origin + length·ξ, y = length²·lift·η, so that η² is f(ξ) with the last
    factor (r − dξ), (r, d) = (1 − d·origin, d·length)/lift². Powers of two: nothing is rounded.
    """

    origin: Any = 0
    length: float = 1.0
    lift: float = 1.0

    @property
    def time(self) -> float:
        """Σ∫dξ/η in Σ∫dx/y = 1."""
        return self.length * self.lift

    @staticmethod
    def of(setup: Setup) -> Units:
        """Those in which branch points that all are close together, of nearly equal moments or a heavy ball, are not.

        Ordinary ones are left alone.
        """
        origin, axes = best_origin(setup), setup.problem.axes[:3]
        length = _near_power(float(max(axes) - min(axes)))
        rest = max(float(1 - setup.problem.d * origin), float(setup.problem.d) * length)
        return Units(origin, length, _near_power(rest**0.5))

    def of_point(self, point: tuple[Any, ...]) -> tuple[Any, ...]:
        """A moving point in these units."""
        u0, u1, v0, v1, *pairs = point
        x, length, lift = self.origin, self.length, self.lift
        u0, u1, v0 = u0 + (u1 + x) * x, u1 + 2 * x, v0 + v1 * x
        high = length * length * lift
        return (u0 / (length * length), u1 / length, v0 / high, v1 / (length * lift), *pairs[:3],
                *(nu / lift for nu in pairs[3:]))  # fmt: skip


def _near_power(x: float) -> float:
    """The power of two below x, but 1 for what is not small."""
    return 1.0 if x > CLOSE else 2.0 ** floor(log2(x))


def motion_row(setup: Setup, units: Units) -> tuple[Any, ...]:
    """What :mod:`integrable.torus.survey` takes, wide: the ends of both ovals, α1, α2, α3, ζ, d, π, r and x/ξ at the
    origin, in the given units.

    PrecisionLoss where the torus is not compact.
    """
    origin, length, lift = units
    first, second = oval_ends(setup)
    abscissae = ((x - origin) / length for x in (*first, *second, *setup.problem.axes[:3], setup.problem.ratio))
    square, d = lift * lift, setup.problem.d
    return (*abscissae, d * length / square, +setup.wide.context.pi, (1 - d * origin) / square, origin / length)


def best_origin(setup: Setup) -> Any:
    """0 or the axis whose abscissa, taken as the origin, leaves branch points that are close together the most digits
    of their distance.
    """
    points = setup.problem.branch_points
    gaps = [(i, j, abs(float(points[i] - points[j]))) for i in range(len(points)) for j in range(i)]

    def digits(origin: Any) -> float:
        far = [abs(float(x - origin)) for x in points]
        return min(gap / max(far[i], far[j]) for i, j, gap in gaps if gap)

    return max((setup.wide.zero, *setup.problem.axes[:3]), key=digits)


def oval_ends(setup: Setup) -> tuple[tuple[Any, Any], tuple[Any, Any]]:
    """The ovals [α_min, min(ζ, α_mid)] and [max(ζ, α_mid), α_max] that u1 and u2 run through, ζ = h1/(h2·max a).

    PrecisionLoss where they meet (the separatrix) or both are one point: there the motion is not a line on a compact
    torus of dimension two.
    """
    low, middle, high = sorted(setup.problem.axes[:3])
    first, second = (low, min(setup.problem.ratio, middle)), (max(setup.problem.ratio, middle), high)
    if second[0] - first[1] <= setup.wide.eps**0.75:
        raise PrecisionLoss("the ovals of the curve have met: the torus of this motion is not compact")
    return first, second
