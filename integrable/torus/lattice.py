"""The branch points and the start from which the torus of a motion is made, in the :class:`Units` of the motion."""

from __future__ import annotations

from math import floor, log2
from typing import TYPE_CHECKING, Any, NamedTuple

from integrable.moving_point.addition import Row
from integrable.moving_point.problem import HEAVINESS, RATIO, TIME_SCALE, problem_row
from integrable.torus.lifts import SMALLEST
from jacobian.element import Real
from jacobian.errors import PrecisionLoss

if TYPE_CHECKING:
    from integrable.moving_point.problem import Problem
    from integrable.moving_point.setup import Setup


# :func:`_near_power` gives a length or a lift above CLOSE the unit 1
CLOSE = 2.0**-6
# a motion has enough digits in the coordinate x itself, without another origin, if neighbouring branch points differ by
# more than the fraction APART of the larger one, and |γ × M|² is more than APART·|M|²
APART = 2.0**-6
# for numbers between 1/FAR and FAR the products that the set-up computes are in the range of floats
FAR = 1e30


class RateCurve(NamedTuple):
    """Attributes of a :class:`~integrable.moving_point.problem.Problem` from which Fourier modes of dt/dτ are made."""

    axes: tuple[Real, ...]
    ratio: Real
    d: Real
    start: tuple[Real, ...]
    half_step: Real


class Units(NamedTuple):
    """The coordinates (ξ, η) of the curve of a torus: x = origin + length·ξ, y = length²·lift·η.

    The curve in ξ and η has the factor r − d'ξ in place of 1 − dx, (r, d') = (1 − d·origin, d·length)/lift². Length and
    lift are powers of two, so multiplication by them does not round.
    """

    origin: Real = 0
    length: float = 1.0
    lift: float = 1.0

    @property
    def time(self) -> float:
        """The value of Σ∫dξ/η over a path with Σ∫dx/y = 1, (ξ, η) being the coordinates of this class."""
        return self.length * self.lift

    @staticmethod
    def of(problem: Problem) -> Units:
        """Units for branch points that are all close together, as for nearly equal moments or large m r². For other
        motions length and lift are 1. Like :meth:`of_point`, it must be called inside ``with setup.reals``.
        """
        origin, axes = best_origin(problem), problem.axes[:3]
        length = _near_power(float(max(axes) - min(axes)))
        rest = max(float(1 - problem.d * origin), float(problem.d) * length)
        return Units(origin, length, _near_power(rest**0.5))

    def of_point(self, point: tuple[Real, ...]) -> tuple[Real, ...]:
        """A moving point in these units."""
        u0, u1, v0, v1, *pairs = point
        x, length, lift = self.origin, self.length, self.lift
        u0, u1, v0 = u0 + (u1 + x) * x, u1 + 2 * x, v0 + v1 * x
        high = length * length * lift
        return (u0 / (length * length), u1 / length, v0 / high, v1 / (length * lift), *pairs[:3],
                *(nu / lift for nu in pairs[3:]))  # fmt: skip


def _near_power(x: float) -> float:
    """The unit of a length or a lift of size x: 1 for x above CLOSE, otherwise the largest power of two up to x."""
    return 1.0 if x > CLOSE else 2.0 ** floor(log2(x))


def motion_row(problem: Problem, setup: Setup, units: Units) -> tuple[Real, ...]:
    """The motion as :mod:`integrable.torus.theta_setup` takes it, in bare reals: the ends of both ovals, α1, α2, α3, ζ,
    d', π, r and origin/length, in the coordinates of :class:`Units`, which defines d' (d in that module) and r.

    PrecisionLoss where the torus is not compact.
    """
    (origin, length, lift), reals = units, setup.reals
    with reals:
        first, second = oval_ends(problem, reals.number(1) / (1 << int(0.75 * setup.wide.context.prec)))
        abscissae = ((x - origin) / length for x in (*first, *second, *problem.axes[:3], problem.ratio))
        square, d, pi = lift * lift, problem.d, reals.number(+setup.wide.context.pi)
        return (*abscissae, d * length / square, pi, (1 - d * origin) / square, origin / length)


def with_open_ovals(problem: Problem, closest: Real) -> Problem:
    """The motion with ovals of at least the length ``closest``, relative to the largest difference of the branch points
    α_i = a_i/max a. This changes states by about √``closest``. An oval is a point if two α_i are equal, and for a
    rotation about an axis.
    """
    axes, zeta = list(problem.axes[:3]), problem.ratio
    low, middle, high = sorted(range(3), key=lambda i: axes[i])
    least = closest * (axes[high] - axes[low])
    if axes[middle] - axes[low] < least:
        axes[middle] = axes[low] + least
    elif axes[high] - axes[middle] < least:
        axes[middle] = axes[high] - least
    zeta = max(axes[low] + least, min(zeta, axes[high] - least))
    return problem._replace(axes=(*axes, *problem.axes[3:]), ratio=zeta)


def best_origin(problem: Problem) -> Real:
    """The origin, 0 or one of the roots α_i = a_i/max a of f, that keeps the most digits of the distances between
    branch points.
    """
    points = problem.branch_points
    gaps = [(i, j, abs(float(points[i] - points[j]))) for i in range(len(points)) for j in range(i)]

    def digits(origin: Real) -> float:
        far = [abs(float(x - origin)) for x in points]
        return min(gap / max(far[i], far[j]) for i, j, gap in gaps if gap)

    return max((0 * problem.d, *problem.axes[:3]), key=digits)


def oval_ends(problem: Problem | RateCurve, near: Real) -> tuple[tuple[Real, Real], tuple[Real, Real]]:
    """The ovals [α_min, min(ζ, α_mid)] and [max(ζ, α_mid), α_max] on which the roots u1 and u2 of U move. Here α_i =
    a_i/max a and ζ = h1/(h2·max a).

    PrecisionLoss if the distance of the ovals is at most ``near``: next to a separatrix the motion is not a line on a
    compact torus of dimension two.
    """
    low, middle, high = sorted(problem.axes[:3])
    first, second = (low, min(problem.ratio, middle)), (max(problem.ratio, middle), high)
    if second[0] - first[1] <= near:
        raise PrecisionLoss("the ovals of the curve have met: the torus of this motion is not compact")
    return first, second


class Beginning(NamedTuple):
    """The data from which a torus is made, as rows of the numbers with which its loops compute.

    ``motion`` is a :func:`motion_row` in ``units``. ``tilt`` is (α, β) of
    :func:`integrable.moving_point.addition.rate_at`. ``start`` is the start in these units. ``problem`` is a
    :func:`~integrable.moving_point.problem.problem_row` in the set-up's units; only the entries from TIME_SCALE on are
    needed. ``smallest``: see :class:`integrable.torus.lifts.Limits`.
    """

    units: Units
    motion: Row
    tilt: Row
    start: Row
    problem: Row
    smallest: float = 0.0


def beginning(setup: Setup, loops: Any) -> Beginning:
    """The :class:`Beginning` of a motion for ``loops``, computed in the bare reals of the set-up."""
    row = loops.row
    with setup.reals:
        problem = with_open_ovals(setup.bare, setup.reals.number(loops.closest))
        units = Units.of(problem)
        motion = row(motion_row(problem, setup, units))
        start, tilt = row(units.of_point(problem.start)), row((problem.axes[6], problem.axes[7] * units.time))
    smallest = 0.0 if problem == setup.bare else SMALLEST
    return Beginning(units, motion, tilt, start, row((0,) * TIME_SCALE + problem.row[TIME_SCALE:]), smallest)


def begun_rows(given: Row, tilted: bool, constants: Row, problem: Row, motion: Row) -> bool:
    """Fills the rows ``problem`` (:func:`~integrable.moving_point.problem.problem_row`) and ``motion``
    (:func:`motion_row` for :class:`Units` with the origin 0) from moments, d, γ and M (``given``). Returns whether the
    numbers have enough digits: sizes near 1 and well-separated branch points. ``constants`` are π and 1.
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
