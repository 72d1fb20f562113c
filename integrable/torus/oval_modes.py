"""The Fourier coefficients of 1/g on a torus, from integrals over each oval, without a grid of states.

The phases of a divisor are the sums of the phases of its two points, the invariant measure is
(u₂ − u₁)du₁du₂/(y₁y₂), and 1/g is a constant over √((1 − du₁)(1 − du₂)). So a coefficient, the mean of
(1/g)·e^(−2πi(kθ₁ + mθ₂)), is a determinant of integrals over one oval each,

    constant·(P₀Q₁ − P₁Q₀)/(area of the lattice),  P_j, Q_j = ∮ u^j e^(−2πi(kθ₁ + mθ₂)) du/(y√(1 − du)),

P over the first oval and Q over the second. 1/g of a tilted body has one more term, the *tilt term*, a multiple of the
next sum. Its coefficients are such determinants too: with A(u) = Π(α_i − u) and R = ±√|A|, analytic along the oval,

    Σ(α_k − α_j)ν_iσ_jσ_k = ±Π_{i<j}(α_j − α_i)·(y₁R₂/R₁ + y₂R₁/R₂)/((u₂ − u₁)√|κ₁κ₂κ₃|).

As functions of an elliptic argument of u the integrands are periodic and analytic, and the trapezoidal rule converges
geometrically. Numbers are python-flint's balls, whose radii show the loss from close branch points.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, inf
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeAlias

from integrable.torus.lattice import RateCurve, oval_ends
from integrable.torus.ovals import Oval, exponent
from integrable.torus.series import powers
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.fields.multiprecision import MultiprecisionField
from jacobian.numbers.long_reals import BallReals, BareReals

if TYPE_CHECKING:
    from flint import acb, arb

    from integrable.moving_point.problem import Problem

# the largest number of multiplications for the tables, which take half a minute at 50 digits
MOST_WORK = 1 << 26
# the first tables have SCOUT_DIGITS digits and MODES_A_DIGIT modes per digit in either direction; the next have BEYOND
# times the number that the decay of the first suggests. The nodes of the first tables suffice for HELD more digits,
# because aliasing would hide the decay
SCOUT_DIGITS, MODES_A_DIGIT, BEYOND, HELD = 8, 0.6, 1.05, 4
# the sign of σ₁σ₂σ₃ is read at the start, or after 1, 2, …, STEPS − 1 basic steps (Setup.step_length), wherever
# |σ₁σ₂σ₃| is largest: at one of these points a σ may be too small to have a sign
STEPS = 4


Table: TypeAlias = "list[list[acb]]"


class Modes(NamedTuple):
    """The modes of the real sum Σ c·e^(2πi(kθ₁ + mθ₂)): ``rows[k]`` has c for m = −most, …, most, in balls, for k ≥ 0
    only.

    The function has the periods ``doubled``, each 1 or 2, in units of the divisor's periods. θ₁ and θ₂ count from the
    start, in turns of these periods of the function. ``frequencies`` are the turns of θ₁ and θ₂ per unit of the
    set-up's τ. ``frequencies`` and ``mean`` are wide.
    """

    rows: Table
    doubled: tuple[int, int]
    frequencies: tuple[Real, Real]
    mean: Real


class TooManyModes(PrecisionLoss):
    """Raised when tables with ``size`` modes would take at least ``work`` multiplications, more than the limit."""

    def __init__(self, size: tuple[int, int], work: int) -> None:
        super().__init__(
            f"1/g needs {size[0]} × {size[1]} modes on the torus of this motion, which is nearly not compact"
        )
        self.work = work


def modes_of_rate(
    setup: ModesSource,
    digits: int,
    direction: tuple[Real, Real] = (1, 0),
    most_work: float = MOST_WORK,
    mean_digits: int = 0,
) -> Modes:
    """The modes of 1/g down to 10^(−digits) of its mean; frequencies and mean to ``mean_digits`` if that is more.

    τ is the time in which (Σdx/y, Σx dx/y) increases at the rate ``direction``. TooManyModes where tables take more
    than ``most_work`` multiplications; PrecisionLoss where the torus is not compact, or so close to that case that
    digits are lost.
    """
    balls = BallReals(setup.reals.bits + 32)
    with balls:
        # this torus is made first, because it raises if digits are lost
        whole = OvalTorus(setup, balls, max(digits, mean_digits), direction)
        # far from 0, t is nearly τ times its mean rate, which needs ``mean_digits``; phases need only ``digits``
        torus = whole if mean_digits <= digits else OvalTorus(setup, balls, digits, direction)
        few = min(SCOUT_DIGITS, digits)
        scout = OvalTorus(setup, balls, min(few + HELD, digits), direction)
        begin = ceil(MODES_A_DIGIT * few)
        size = _resolved(scout, (begin, begin), few, most_work).wanted(digits, few)
        # this call is outside of ``try``, because inside it TooManyModes means that digits are lost
        torus.use(size, most_work)
        try:
            found = _resolved(torus, size, digits, most_work)
        except TooManyModes:
            raise PrecisionLoss("the modes of 1/g end in lost digits: use more digits") from None
        modes = torus.modes(found.upright, found.leaning, found.size)
        return modes if torus is whole else whole.rates_of(modes)


class FoundModes(NamedTuple):
    """Tables of modes, of this ``size``. ``leaning`` has those of the tilt term of 1/g
    (:mod:`integrable.torus.oval_modes`), ``upright`` those of the rest of 1/g.
    """

    size: tuple[int, int]
    upright: Table
    leaning: Table | None

    def wanted(self, digits: int, held: int) -> tuple[int, int]:
        """The numbers of modes in both directions beyond which modes are below 10^(−digits) of the mean. In a direction
        in which the last modes of the tables are that small, the number is that of ``size``. The rate of decay is
        measured where modes exceed 10^(−``held``). PrecisionLoss where the last modes are only rounding errors, so that
        further modes would be no smaller.
        """
        rows, columns = self.size
        tables = [self.upright] if self.leaning is None else [self.upright, self.leaning]
        lead = exponent(self.upright[0][columns])

        def row(k: int) -> acb:
            return max((c for table in tables for c in table[k]), key=exponent)

        def column(m: int) -> acb:
            ends = columns - m, m - columns - 1
            return max((row[j] for table in tables for row in table for j in ends), key=exponent)

        found = []
        for most, largest in ((rows, row), (columns, column)):
            end, middle = largest(most), most // 2
            last, before = (exponent(c) - lead for c in (end, largest(middle)))
            if last >= -digits and end.contains(0):
                raise PrecisionLoss("the modes of 1/g end in lost digits: use more digits")
            # the decay shows only in modes above 10^(−held); for small d, all modes except the mean are of order d
            while before < -held:
                middle -= 1
                before = exponent(largest(middle)) - lead
            if last < -digits:
                found.append(most)
            elif last >= before - 0.5:
                found.append(2 * most)
            else:
                rate = (before - last) / (most - middle)
                found.append(most + ceil(BEYOND * (last + digits) / rate) + 2)
        return found[0], found[1]


def _resolved(torus: OvalTorus, size: tuple[int, int], digits: int, most_work: float) -> FoundModes:
    """The tables of the modes of 1/g down to 10^(−digits) of its mean. The number of modes is
    ``size`` at first, and is enlarged until the last modes are that small.
    """
    while True:
        torus.use(size, most_work)
        found = FoundModes(size, torus.upright(), torus.leaning())
        wanted = found.wanted(digits, digits)
        if wanted == size:
            return found
        size = wanted


class ModesSource(Protocol):
    """The data from which modes are made (:class:`integrable.moving_point.setup.Setup`): the motion over the ``wide``
    field, and for a tilted body the moving points ``reached`` after some steps, in bare reals.
    """

    @property
    def problem(self) -> Problem | RateCurve: ...
    @property
    def wide(self) -> MultiprecisionField: ...
    @property
    def reals(self) -> BareReals: ...
    def reached(self, sign: int, steps: int) -> tuple[Real, ...]: ...


class OvalTorus:
    """Both ovals of a motion, and tables of e^(2πiθ) at their nodes."""

    def __init__(self, setup: ModesSource, balls: BallReals, digits: int, direction: tuple[Real, Real]) -> None:
        import flint

        self.flint, self._setup, self._balls, self.digits = flint, setup, balls, digits
        self._size = (0, 0)
        self.pi = flint.arb.pi()
        problem, ends = setup.problem, oval_ends(setup.problem, setup.wide.eps**0.75)
        self.d, self.axes = self.ball(problem.d), [self.ball(x) for x in problem.axes]
        self.low = problem.ratio < sorted(problem.axes[:3])[1]
        exact = [[self.ball(x) for x in oval] for oval in ends]
        self.ovals = [Oval(self, exact[k], exact[1 - k], k == 0) for k in (0, 1)]
        (a0, a1), (b0, b1) = (oval.period for oval in self.ovals)
        self.area = a0 * b1 - a1 * b0
        self.frequencies = self.phases(*map(self.ball, direction))
        if not self.area.rel_accuracy_bits() > 3.33 * digits:
            raise PrecisionLoss("branch points are too close together for these digits; use more digits")
        self._place()

    def ball(self, x: Real) -> arb:
        """A number of the set-up's wide field as a ball; the radius accounts for its finite number of digits."""
        middle = self._balls.number(x)
        return middle + self.flint.arb(0, abs(middle) * self.flint.arb(2) ** -self._setup.wide.context.prec)

    def phases(self, first: arb, second: arb) -> tuple[arb, arb]:
        """The phases (θ₁, θ₂), in turns, from the integrals ``first`` of dx/y and ``second`` of x dx/y."""
        (a0, a1), (b0, b1) = (oval.period for oval in self.ovals)
        return (first * b1 - second * b0) / self.area, (second * a0 - first * a1) / self.area

    def _place(self) -> None:
        """Sets ``start``, the phases of the start; ``constant``, the factor constant/(area of the lattice) of the
        module's formula; and the sign of σ₁σ₂σ₃ at the phases 0.
        """
        setup, axes = self._setup, self.axes
        count = 1 if axes[7].mid() == 0 else STEPS
        points = [[self.ball(x) for x in setup.problem.start]]
        for n in range(1, count):
            with setup.reals:
                reached = setup.reached(1, n)
            points.append([self.ball(x) for x in setup.reals.elements(setup.wide, reached)])
        n = max(range(count), key=lambda n: abs(float(points[n][4] * points[n][5] * points[n][6])))
        point = points[n]
        middle, square = -point[1] / 2, point[1] * point[1] / 4 - point[0]
        # at a double root, rounding may make the square negative
        spread = self.flint.arb(max(square.mid(), 0)).sqrt()
        angles, blurs = zip(
            *(
                oval.angle(u, point[2] + point[3] * u)
                for oval, u in zip(self.ovals, (middle - spread, middle + spread), strict=True)
            ),
            strict=True,
        )
        # on a tiny oval the angle has no correct digits. The integrals hardly depend on it, except those of the tilt
        # term if the oval lies between two α_i
        if count > 1 and not blurs[self.low] < 10.0**-self.digits:
            raise PrecisionLoss("two moments of this body are equal, or all but equal, to these digits; use more")
        sums = [oval.node(angle).sums for oval, angle in zip(self.ovals, angles, strict=True)]
        found = self.phases(*(x + y for x, y in zip(*sums, strict=True)))
        back = 2 * n * self.ball(setup.problem.half_step)
        self.start = tuple(x - nu * back for x, nu in zip(found, self.frequencies, strict=True))
        sigma = point[4:7]
        square = sum(x * x for x in sigma)
        self.constant = ((1 + self.d * (point[1] + self.d * point[0])) / square).sqrt() / self.area
        signs = [oval.sign(angle) for oval, angle in zip(self.ovals, angles, strict=True)]
        self._sign = signs[0] * signs[1] * (-1 if sigma[0] * sigma[1] * sigma[2] < 0 else 1)

    def use(self, size: tuple[int, int], most_work: float) -> None:
        """Makes tables for ``size`` modes, with enough nodes for the highest; TooManyModes beyond ``most_work``."""
        if size == self._size:
            return
        for oval in self.ovals:
            half = oval.harmonics // 2 + sum(size)
            while True:
                work = half * size[0] * (2 * size[1] + 1)
                if work > most_work:
                    raise TooManyModes(size, work)
                oval.sample(half)
                if oval.alias(self, size) < -self.digits:
                    break
                half = half * 5 // 4 + 2
            oval.turn(self, size)
        self._size = size

    def upright(self) -> Table:
        """The Fourier coefficients of 1/g without its tilt term (:mod:`integrable.torus.oval_modes`). Phases count from
        ends of the ovals, not from the start.
        """
        first, second = ([oval.integrals(part, 0, 0) for part in oval.moments()] for oval in self.ovals)
        factor = self.constant * self.axes[6]
        return _combined(factor, (first[0], second[1]), (first[1], second[0]), -1)

    def rates_of(self, modes: Modes) -> Modes:
        """The given modes, with frequencies and mean to the digits of this torus."""
        self.use((1, 1), inf)
        *nu, mean = self._balls.elements(
            self._setup.wide,
            (*(x / n for x, n in zip(self.frequencies, modes.doubled, strict=True)), self.upright()[0][1].real),
        )
        return modes._replace(frequencies=(nu[0], nu[1]), mean=mean)

    def leaning(self) -> Table | None:
        """The Fourier coefficients of the tilt term of 1/g (:mod:`integrable.torus.oval_modes`), at k + ½ or m + ½;
        None for an upright body. Phases count from ends of the ovals, not from the start.
        """
        if self.axes[7].mid() == 0:
            return None
        half = (1, 0) if self.low else (0, 1)
        first, second = ([oval.integrals(part, *half) for part in oval.roots()] for oval in self.ovals)
        a1, a2, a3, k1, k2, k3 = self.axes[:6]
        factor = self.axes[7] * self.constant * self._sign * (a2 - a1) * (a3 - a2) * (a3 - a1)
        factor /= abs(k1 * k2 * k3).sqrt()
        return _combined(factor, (first[0], second[1]), (first[1], second[0]), 1)

    def modes(self, upright: Table, leaning: Table | None, size: tuple[int, int]) -> Modes:
        """The modes of 1/g from tables of its coefficients; phases count from the start, in turns of its periods."""
        acb, wide, balls = self.flint.acb, self._setup.wide, self._balls
        doubled = (1, 1) if leaning is None else ((2, 1) if self.low else (1, 2))
        one, other = (acb((2 * x / n).cos_pi(), (2 * x / n).sin_pi()) for x, n in zip(self.start, doubled, strict=True))
        most = doubled[1] * size[1] + (doubled[1] - 1)
        rows = [[acb(0)] * (2 * most + 1) for _ in range(doubled[0] * size[0] + doubled[0])]
        for k, row in enumerate(upright):
            for m, c in enumerate(row):
                rows[doubled[0] * k][most + doubled[1] * (m - size[1])] = c
        for k, row in enumerate(leaning or ()):
            for m, c in enumerate(row):
                place = most + (m - size[1] if self.low else 2 * (m - size[1]) - 1)
                rows[2 * k + 1 if self.low else k][place] = c
        down, across = powers(acb(1), one, len(rows)), powers(other**-most, other, 2 * most + 1)
        rows = [[c * x * y for c, y in zip(row, across, strict=True)] for row, x in zip(rows, down, strict=True)]
        nu = balls.elements(wide, (x / n for x, n in zip(self.frequencies, doubled, strict=True)))
        return Modes(rows, doubled, (nu[0], nu[1]), balls.element(wide, upright[0][size[1]].real))


def _combined(factor: arb, first: Sequence[Table], second: Sequence[Table], sign: int) -> Table:
    """factor·(w·x + sign·y·z), elementwise, for the matrices (w, x) = ``first`` and (y, z) = ``second``."""
    other = sign * factor
    return [
        [factor * (w * x) + other * (y * z) for w, x, y, z in zip(*row, strict=True)]
        for row in zip(*first, *second, strict=True)
    ]
