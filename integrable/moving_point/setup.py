"""What a flow is set up with, once per state: computed in extended precision and rounded once."""

from __future__ import annotations

from functools import cached_property
from math import ceil, log, log10
from typing import Any

from integrable.moving_point.kernel import near_identity, rate_at, shift
from integrable.moving_point.legendre import legendre_rule
from integrable.moving_point.problem import MotionProblem
from integrable.moving_point.translations import REACH, Translations, series_of
from integrable.phase.body import Body, Vector
from integrable.phase.precisions import EPS_DIGITS, SET_UP_DIGITS
from jacobian import MP, RR
from jacobian.errors import ArgumentError
from jacobian.numbers.long_reals import BareReals

GUARD_DIGITS = 10
WIDER = 20
GUARD_BITS = 10
# neighbours of a doubled step count among which the best conditioned translation is taken
SEARCH = 6
NODE_COUNTS = (8, 12, 16, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 160, 200, 256, 320, 400)


class Setup:
    """The curve, the start, the translations by 2^k basic steps and the quadrature nodes of one motion.

    Numbers are rounded to ``number`` (float, or mpf with guard digits); units are those of
    :class:`~integrable.moving_point.problem.MotionProblem`. ``digits`` asks for that many digits whatever the field of
    the body, whose numbers are taken as exact.
    """

    def __init__(self, body: Body, gamma: Vector, M: Vector, tilted: bool = False, digits: int | None = None) -> None:
        field = body.field
        self.wide: Any
        self.work: Any
        if field != RR and (type(field) is not type(MP(15)) or field.complex):
            raise ArgumentError(f"field = {field.name}: a flow runs over RR or MP(digits)")
        if field == RR and digits is None:
            self.wide, self.work, digits = MP(SET_UP_DIGITS + digits_of_closeness(body)), RR, EPS_DIGITS
        else:
            digits = (field.dps if digits is None else digits) + GUARD_DIGITS
            self.wide, self.work = MP(digits + WIDER), MP(digits)
        self.digits = digits
        self.body = body
        coerce = self.wide.coerce
        (g1, g2, g3), (m1, m2, m3) = map(coerce, gamma), map(coerce, M)
        problem = MotionProblem(Body.make(body.inertia, body.d, self.wide), (g1, g2, g3), (m1, m2, m3), tilted)
        self.tilt, self.ratio, self.clock = problem.tilt, problem.ratio, problem.clock
        self._f, self._axes, self._start, self._d = problem.f, problem.axes, problem.start, problem.d
        self._half_step, self.wide_momentum = problem.half_step, problem.momentum
        self.wide_branch_points = problem.branch_points
        number = self.number
        self.f, self.axes, self.start = (tuple(map(number, v)) for v in (self._f, self._axes, self._start))
        # steps of Newton from an estimate: floats start at leading order, multiprecision from floats
        self.passes = 6 if self.work is RR else max(1, ceil(log(digits / 14, 2)))
        self.reals = BareReals(self.wide.context.prec + GUARD_BITS)
        self.half_step, self.momentum = number(self._half_step), number(problem.momentum)
        self.counts = [1]
        self._bare_table: dict[int, list[tuple[Any, ...]]] = {1: [], -1: []}
        self._table: dict[int, list[tuple[Any, ...]]] = {1: [], -1: []}

    @cached_property
    def translations(self) -> Translations:
        """T(eps) for eps of any size."""
        return Translations(self.reals, self._f, self._axes, self._half_step)

    @cached_property
    def _levels(self) -> list[tuple[Any, ...]]:
        """The translations by ``counts`` basic steps."""
        return [self.translations.near(2 * self._half_step)]

    @cached_property
    def _multiples(self) -> list[tuple[Any, ...]]:
        """The translations by 1, 2, … basic steps."""
        return self._levels[:1]

    @cached_property
    def series(self) -> tuple[Any, ...]:
        """The power series of 1/√(f/f0) about 0, as long as ``near`` needs at half a step."""
        return tuple(map(self.number, self.wide_series(self._f, -1)[: self._size]))

    @cached_property
    def roots(self) -> tuple[Any, ...]:
        """The power series of √(f/f0)."""
        return tuple(map(self.number, self.wide_series(self._f, 1)[: self._size]))

    @property
    def _size(self) -> int:
        return ceil(self.digits * log(10) / -log(1.4 * REACH)) + 4

    def number(self, x: Any) -> Any:
        """x, rounded to the working numbers."""
        return float(x) if self.work is RR else self.work.coerce(x)

    # --- what the torus is built from, in the wide precision

    @property
    def wide_f(self) -> tuple[Any, ...]:
        """f, ascending."""
        return self._f

    @property
    def wide_start(self) -> tuple[Any, ...]:
        """The moving point at time 0."""
        return self._start

    @property
    def wide_all_axes(self) -> tuple[Any, ...]:
        """α, κ and the clock's constants, as :mod:`integrable.moving_point.kernel` takes them."""
        return self._axes

    @property
    def wide_half_step(self) -> Any:
        """Half of a basic step, in τ'."""
        return self._half_step

    @property
    def wide_d(self) -> Any:
        """d·max a_i."""
        return self._d

    @property
    def wide_axes(self) -> tuple[Any, ...]:
        """α1, α2, α3."""
        return self._axes[:3]

    @property
    def wide_passes(self) -> int:
        """Steps of Newton from a float to the wide precision."""
        return max(1, ceil(log(self.wide.dps / 14, 2)))

    @property
    def wide_terms(self) -> int:
        """How many terms of a series bring the wide precision within REACH."""
        return self._size + ceil(1.3 * (self.wide.dps - self.digits))

    def wide_series(self, f: tuple[Any, ...], power: int) -> tuple[Any, ...]:
        """The series of (f/f0)^(power/2), to the wide precision within REACH."""
        with self.reals:
            return self.reals.elements(self.wide, series_of(self.reals.row(f), power, self.wide_terms))

    def combine(self, first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
        """The sum of two translations, as a moving point with κ = 1."""
        row = self.reals.row
        return self.reals.elements(self.wide, self.translations.sum(row(first), row(second)))

    def moved(self, step: tuple[Any, ...], point: tuple[Any, ...]) -> tuple[Any, ...]:
        """A wide moving point after a translation."""
        reals = self.reals
        with reals:
            return reals.elements(self.wide, shift(*self.bare_problem, reals.row(point), reals.row(step)))

    # --- the same in bare reals

    @cached_property
    def bare_problem(self) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """(f, axes)."""
        return self.reals.row(self._f), self.reals.row(self._axes)

    @cached_property
    def bare_start(self) -> tuple[Any, ...]:
        """The moving point at time 0."""
        return self.reals.row(self._start)

    def bare_table(self, sign: int, steps: int) -> tuple[list[int], list[tuple[Any, ...]]]:
        """As :meth:`table`."""
        while self.counts[-1] <= steps:
            self._add_level()
        rows = self._bare_table[sign]
        with self.reals:
            rows.extend(step if sign > 0 else opposite(step) for step in self._levels[len(rows) :])
        return self.counts, rows

    def bare_point(self, sign: int, steps: int) -> tuple[Any, ...]:
        """The moving point after sign·``steps`` basic steps, as :func:`integrable.moving_point.kernel.reach`."""
        reals, point = self.reals, self.bare_start
        counts, table = self.bare_table(sign, steps)
        for count, step in zip(counts[::-1], table[::-1], strict=True):
            while steps >= count:
                point = reals.plain_row(shift(*self.bare_problem, point, step))
                steps -= count
        return point

    # --- translations
    # -----------------------------------------------------------------------------------------------------------

    def near(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) in the working numbers, for |eps| up to half a step."""
        return near_identity(self.series, self.roots, self.f[0], self.axes, self.number(eps), self.passes)

    def table(self, sign: int, steps: int) -> tuple[list[int], list[tuple[Any, ...]]]:
        """(counts, translations): sign·counts[k] basic steps each, ascending from 1 to beyond ``steps``."""
        counts, bare = self.bare_table(sign, steps)
        rows = self._table[sign]
        rows.extend(self._rounded(step) for step in bare[len(rows) :])
        return counts, rows

    def _add_level(self) -> None:
        """About twice the last count: of some neighbours the translation that is best conditioned."""
        double = self.translations.double(self._levels[-1])
        rough = {m: self._near_sum(double, m) for m in range(-min(SEARCH, self.counts[-1] - 1), SEARCH + 1)}
        best = max(rough, key=lambda m: conditioning(rough[m]))
        exact = double if best == 0 else self.translations.sum(double, self._multiple(best))
        self.counts.append(2 * self.counts[-1] + best)
        self._levels.append(exact)

    def _near_sum(self, step: tuple[Any, ...], m: int) -> tuple[Any, ...]:
        """The translation by m further basic steps, roughly: in floats."""
        if m == 0:
            return tuple(map(float, step))
        floats = (tuple(map(float, row)) for row in (self._f, self.translations.axes, step, self._multiple(m)))
        return shift(*floats)

    def _multiple(self, m: int) -> tuple[Any, ...]:
        """The translation by m basic steps, |m| ≤ SEARCH."""
        while len(self._multiples) < abs(m):
            self._multiples.append(self.translations.sum(self._multiples[-1], self._multiples[0]))
        step = self._multiples[abs(m) - 1]
        with self.reals:
            return step if m > 0 else opposite(step)

    def _rounded(self, step: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(map(float, step)) if self.work is RR else self.reals.elements(self.work, step)

    def quadrature(self, count: int, sign: int) -> Quadrature:
        """Gauss–Legendre nodes over one basic step, as translations."""
        return Quadrature(self, count, sign)

    # --- times
    # ------------------------------------------------------------------------------------------------------------------

    def split(self, t: Any) -> tuple[Any, Any]:
        """A wide number as (high, low) of working numbers."""
        high = self.number(t)
        return high, self.number(t - self.wide.coerce(high))

    def unscaled(self, t: Any) -> Any:
        """A time in the user's units, rounded."""
        return self.number(self.wide.coerce(t) / self.clock)

    @cached_property
    def step_time(self) -> float:
        """How long a basic step takes at the start, in the user's units of physical time.

        The step is as long as power series about a state reach, whatever the moments: the scale on which states vary.
        """
        return abs(float(self.step_length * rate_at(self._axes, self._start) / self.clock))

    @cached_property
    def step_length(self) -> Any:
        """τ' of one basic step, in the wide precision."""
        return 2 * self._half_step


def digits_of_closeness(body: Body) -> int:
    """How many more digits a divisor takes where all moments are nearly equal, or nearly nothing beside d: U vanishes
    like the square of what they differ by, V like its third power.
    """
    most, least = max(body.inertia), min(body.inertia)
    return 0 if most == least else ceil(3 * log10((most + body.d) / (most - least)))


def opposite(step: tuple[Any, ...]) -> tuple[Any, ...]:
    """The inverse of a translation."""
    return (*step[:2], -step[2], -step[3], *step[4:7], *(-x for x in step[7:]))


def conditioning(step: tuple[Any, ...]) -> float:
    """How well a translation adds, larger is better: its points away from the branch points, and not far out."""
    return float(min(abs(s) for s in step[4:7]) / (1 + max(abs(c) for c in step[:4])))


class Quadrature:
    """Nodes of one step as translations, weights of its halves, the matrix from values to a Legendre series."""

    def __init__(self, setup: Setup, count: int, sign: int) -> None:
        number, half = setup.number, setup._half_step
        x, rows, right = legendre_rule(setup.wide, count)
        outer = [setup.near(sign * half * node) for node in x[: (count + 1) // 2]]
        # the nodes are symmetric about 0, and T(−eps) = −T(eps)
        self.nodes = outer + [opposite(step) for step in outer[: count // 2][::-1]]
        self.right = [number(half * c) for c in right]
        self.left = self.right[::-1]
        self.legendre = [[number(c) for c in row] for row in rows]
