"""Physical time to many digits: t = ∫dτ/g by Gauss–Legendre quadrature on panels of the flow's own time.

A *cell* is an interval of one basic step (:attr:`Setup.step_length`), centred at a multiple of the step. On a cell 1/g
is stored as a Legendre series, which gives t(τ) and its inverse. Far from the start one rule integrates nine cells at
once, without a series and with fewer nodes than nine rules.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from math import ceil, inf, log10
from operator import mul
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from integrable.moving_point import addition
from integrable.moving_point.legendre import LegendreSeries, gauss_legendre, place_on
from integrable.moving_point.translations import Translations
from jacobian.element import Real
from jacobian.errors import PrecisionLoss
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

if TYPE_CHECKING:
    from integrable.moving_point.addition import Row
    from integrable.moving_point.setup import Setup

Found = TypeVar("Found")

# a long panel has LONG cells, intervals of one basic step (Setup.step_length). Their number is odd, so that the centre
# of the panel is that of a cell. The first NEAR_CELLS cells belong to no long panel
LONG = 9
NEAR_CELLS = 27
# estimates of the work allow for a clock that runs this many times faster or slower on the first cells
UNEVEN = 4
# long panels are used only if each Legendre coefficient is smaller than the one before by more than this many decimal
# digits
SLOWEST_LONG = 0.12
KEPT_SERIES = 4096
# 1/g of an upright state is computed from U(1/d) if all I_i/(I_i + d) exceed LIGHT: this costs up to three guard digits
LIGHT = 1e-3
# the last panel of :class:`OneTime` has the length τ·10^−END_DIGITS, so the start value of τ needs more than END_DIGITS
# correct digits
END_DIGITS = 12
# the decrease of the Legendre coefficients of 1/g, up to the last one that exceeds LEAST_SEEN, is measured with as many
# nodes as SCOUT_NODES says: first for a basic step (Setup.step_length), then for a longer panel
SCOUT_NODES, LEAST_SEEN = (24, 80), 1e-12
SCOUT_BITS = 240
# if all coefficients except the mean of 1/g are below FLAT times the mean, their decrease is measured relative to the
# largest of them
FLAT = 1e-6
SAMPLES = range(0, 512, 61)


class ClockLimits(NamedTuple):
    """Limits on a clock: the number of values of 1/g between the start and a time, and the number of digits."""

    most: float = inf
    digits: float = inf


NONE = ClockLimits()


class Nodes(NamedTuple):
    """Translations from the centre of a panel to its nodes, and the ``roots`` of
    :func:`integrable.moving_point.addition.upright_rates`. ``roots`` is None where that function would lose digits.
    """

    steps: list[Row]
    roots: list[Real] | None


class Unresolved(ArithmeticError):
    """Raised if the Legendre series of a cell has not converged."""


def digits_a_node(setup: Setup, sign: int, length: int) -> float:
    """The number of decimal digits per degree by which the Legendre coefficients of 1/g decrease, on the worst of some
    panels of ``length`` steps (Setup.step_length); ``sign`` is the direction of time. It is measured once for a motion.
    """
    if (sign, length) not in setup.decays:
        sizes = _sizes(setup, sign, length)
        most = max(sizes[1:])
        if 0 < most < FLAT:
            sizes = [size / most for size in sizes]
        last = max((k for k in range(1, len(sizes)) if sizes[k] > LEAST_SEEN), default=1)
        setup.decays[sign, length] = -log10(max(sizes[last], LEAST_SEEN)) / last
    return setup.decays[sign, length]


def _sizes(setup: Setup, sign: int, length: int) -> list[float]:
    """The largest size of each Legendre coefficient over some panels, relative to the coefficient of degree 0."""
    problem, bare, reals = setup.problem, setup.bare, BareReals(SCOUT_BITS)
    series = LegendreSeries(reals, SCOUT_NODES[length > 1])
    translations = Translations(reals, problem.f, problem.axes, problem.half_step)
    steps, sizes = translations.at_nodes(series.nodes, sign * length), [0.0] * len(series.nodes)
    for cell in SAMPLES:
        point = setup.reached(sign, cell)
        with reals:
            values = [addition.rate_after(bare.f, bare.axes, point, step) for step in steps]
            found = [abs(float(c)) for c in series.coefficients(values)]
        sizes = [max(a, b / found[0]) for a, b in zip(sizes, found, strict=True)]
    return sizes


class RatePanels:
    """1/g on panels of the flow's own time in one direction, in the units and bare reals of a setup."""

    def __init__(self, setup: Setup, sign: int, limits: ClockLimits = NONE) -> None:
        self._setup = setup
        self._sign = sign
        self._digits = min(setup.digits, limits.digits)
        self._half, self._d = setup.bare.half_step, setup.reals.number(setup.problem.d)

    def _at_nodes(self, nodes: list[Real], length: Real) -> Nodes:
        """The :class:`Nodes` of a panel of ``length`` cells; ``nodes`` lie in [−1, 1], symmetric about 0, and do not
        contain 0.
        """
        steps = self._setup.translations.at_nodes(nodes, self._sign * length)
        roots, d = None, self._d
        if not self._setup.tilt and min(1 - d * x for x in self._setup.bare.axes[:3]) > LIGHT:
            with self._setup.reals:
                roots = [root(1 + d * (step[1] + d * step[0])) for step in steps]
        return Nodes(steps, roots)

    def _rates_at(self, point: Row, nodes: Nodes) -> list[Real]:
        bare = self._setup.bare
        if nodes.roots is not None:
            return addition.upright_rates(bare.f, bare.axes, self._d, point, nodes.steps, nodes.roots)
        return [addition.rate_after(bare.f, bare.axes, point, step) for step in nodes.steps]

    def _node_count(self, rate: float) -> int:
        """An even number of nodes that suffices for the clock's digits if each node adds ``rate`` digits."""
        return 2 * int(0.525 * (self._digits + 6) / rate) + 8

    def _resolves(self, first: Real, tail: list[Real], digits: float) -> bool:
        """Whether the last coefficients of a series are negligible relative to its first."""
        return bool(max(map(abs, tail)) <= abs(first) * self._small(digits + 3))

    def _small(self, digits: float) -> Real:
        return self._setup.reals.number(10) ** -ceil(digits)


class PanelClock(RatePanels):
    """t(τ) and τ(t) of a setup in one direction of time, in the setup's units and bare reals, extended on request.

    Cells are numbered 0, 1, …; a place is (cell, x), x in [−1, 1] across the cell. PrecisionLoss if 1/g is too uneven
    for Legendre series with at most 6 nodes per digit, or if a time needs more values of 1/g than ``limits`` allow.
    """

    def __init__(self, setup: Setup, sign: int, limits: ClockLimits = NONE) -> None:
        super().__init__(setup, sign, limits)
        self._most = limits.most
        self._use(self._node_count(digits_a_node(self._setup, self._sign, 1)))
        self._long: tuple[Nodes, list[Real]] | None = None

    def place(self, t: Real) -> tuple[int, Real]:
        """The place, (cell, x), at which the clock shows t ≥ 0."""
        return self._resolved(lambda: self._inverse(t))

    def time(self, cell: int, x: Real) -> Real:
        """t at the place (cell, x), −1 ≤ x ≤ 1."""
        return self._resolved(lambda: self._time(cell, x))

    def _resolved(self, compute: Callable[[], Found]) -> Found:
        """The result of ``compute``, repeated with more nodes as long as a cell on the way needs them."""
        while True:
            try:
                with self._setup.reals:
                    return compute()
            except Unresolved:
                self._use(2 * (len(self._nodes.steps) * 5 // 8) + 8)

    def _use(self, count: int) -> None:
        """Starts again with ``count`` nodes a cell; PrecisionLoss if these are too many."""
        setup = self._setup
        if count > max(64, 6 * self._digits):
            raise PrecisionLoss(
                f"1/g is not resolved by {6 * self._digits} nodes a step: the moments or d differ too much for this "
                "clock"
            )
        self._rule = LegendreSeries(setup.reals, count)
        self._nodes = self._at_nodes(self._rule.nodes, 1)
        self._series: dict[int, list[Real]] = {}
        self._means: dict[int, Real] = {}
        # t at the upper ends of the cells −1, 0, 1, …
        self._ends: list[Real] = []
        # t at the ends of long panels
        self._far: list[Real] = []

    # --- t, the integral of 1/g

    def _time(self, cell: int, x: Real) -> Real:
        series = self._coefficients(cell)
        whole = addition.integrate_series(series, -1 + 0 * x)[0]
        return self._end(cell - 1) + self._half * (addition.integrate_series(series, x)[0] - whole)

    def _inverse(self, t: Real) -> tuple[int, Real]:
        cell = self._cell(t)
        series = self._coefficients(cell)
        base = addition.integrate_series(series, -1 + 0 * t)[0]
        target = (t - self._end(cell - 1)) / self._half + base
        return cell, place_on(series, target, self._setup.reals, self._digits)

    def _cell(self, t: Real) -> int:
        """The cell in which the clock shows t."""
        while self._end(len(self._ends) - 2) <= t and len(self._ends) <= NEAR_CELLS + 1:
            self._end(len(self._ends) - 1)
        if self._ends[-1] <= t:
            # the number of cells is estimated from the mean rate on the known cells
            self._afford(float(t / self._ends[-1]) * len(self._ends))
        if self._ends[-1] > t or not self._far_reaches(t):
            while self._ends[-1] <= t:
                self._end(len(self._ends) - 1)
            return max(0, bisect_right(self._ends, t) - 1)
        first = NEAR_CELLS + LONG * (bisect_right(self._far, t) - 1) + 1
        return next((cell for cell in range(first, first + LONG - 1) if self._end(cell) > t), first + LONG - 1)

    def _end(self, cell: int) -> Real:
        """t at the upper end of a cell. Cell −1 ends where cell 0 begins, at a negative time."""
        if not self._ends:
            self._ends.append(self._half * addition.integrate_series(self._coefficients(0), -1 + 0 * self._half)[0])
        if cell > NEAR_CELLS:
            self._afford(cell)
        if cell <= NEAR_CELLS or not self._long_panels():
            while len(self._ends) < cell + 2:
                self._ends.append(self._ends[-1] + 2 * self._half * self._mean(len(self._ends) - 1))
            return self._ends[cell + 1]
        panels, rest = divmod(cell - NEAR_CELLS, LONG)
        self._wind(panels)
        total = self._far[panels]
        for inner in range(cell - rest + 1, cell + 1):
            total += 2 * self._half * self._mean(inner)
        return total

    def _far_reaches(self, t: Real) -> bool:
        """Extends the long panels beyond t; returns False if the clock has no long panels."""
        if not self._long_panels():
            return False
        while not self._far or self._far[-1] <= t:
            self._wind(len(self._far))
            # the estimate is repeated, since the mean over more cells is more accurate than that over the first cells
            cells = NEAR_CELLS + LONG * (len(self._far) - 1)
            self._afford(float(t / self._far[-1]) * cells, 1 + UNEVEN * NEAR_CELLS / cells)
        return True

    def _wind(self, panels: int) -> None:
        """Extends the table of t at the ends of long panels to the first ``panels`` of them."""
        if not self._far:
            self._far.append(self._end(NEAR_CELLS))
        nodes, weights = self._long_rule()
        self._afford(NEAR_CELLS + LONG * panels)
        while len(self._far) <= panels:
            centre = NEAR_CELLS + LONG * (len(self._far) - 1) + (LONG + 1) // 2
            values = self._rates_at(self._setup.reached(self._sign, centre), nodes)
            total = sum(map(mul, weights, values))
            self._far.append(self._far[-1] + LONG * self._half * total)

    def _afford(self, cells: float, uneven: float = 1) -> None:
        """Raises PrecisionLoss if the work of a clock of this many ``cells`` exceeds ``uneven`` times its limit."""
        work = cells * (len(self._long_rule()[0].steps) / LONG if self._long_panels() else len(self._nodes.steps))
        if work > uneven * self._most:
            raise PrecisionLoss(
                f"floats and double-double numbers do not carry this motion, and to {self._digits} digits the "
                f"way there takes {work:.3g} values of 1/g, where floats take {self._most:.3g}: MP(digits) goes there "
                "in its time, and nearer times are within reach; other units change nothing"
            )

    def _long_panels(self) -> bool:
        return digits_a_node(self._setup, self._sign, LONG) > SLOWEST_LONG

    def _long_rule(self) -> tuple[Nodes, list[Real]]:
        """The nodes, as translations, and the weights of the rule of a long panel."""
        if self._long is None:
            x, weights = gauss_legendre(
                self._setup.reals, self._node_count(2 * digits_a_node(self._setup, self._sign, LONG))
            )
            self._long = self._at_nodes(x, LONG), weights
        return self._long

    # --- 1/g on one cell

    def _mean(self, cell: int) -> Real:
        if cell not in self._means:
            values = self._rates_at(self._setup.reached(self._sign, cell), self._nodes)
            self._means[cell] = sum(map(mul, self._rule.weights, values)) / 2
        return self._means[cell]

    def _coefficients(self, cell: int) -> list[Real]:
        """The Legendre series of 1/g over a cell; Unresolved if its last coefficients are too large."""
        if cell not in self._series:
            values = self._rates_at(self._setup.reached(self._sign, cell), self._nodes)
            series = self._rule.coefficients(values)
            if not self._resolves(series[0], series[-2:], self._digits):
                raise Unresolved
            if len(self._series) >= KEPT_SERIES:
                self._series.clear()
            self._series[cell] = series
        return self._series[cell]


class OneTime(RatePanels):
    """τ at one physical time to very many digits, without a series of the clock; ``point(τ)`` is the moving point.

    If τ is known to some digits, a Gauss rule from 0 to τ gives the physical time there, with half the nodes of an
    equally accurate series. A short panel at its end then corrects τ.
    """

    def tau(self, t: Real, start: Real, point: Callable[[Real], Row]) -> Real | None:
        """|τ| at |t| = ``t`` > 0, from an approximation ``start`` with more than END_DIGITS correct digits. None if |τ|
        exceeds NEAR_CELLS cells, or if 1/g is not resolved on the way.
        """
        if start > 2 * NEAR_CELLS * self._half:
            return None
        shown = self._time(start, point)
        if shown is None:
            return None
        end = start * self._small(END_DIGITS)
        rule = LegendreSeries(self._setup.reals, 2 * ceil(self._digits / END_DIGITS / 2) + 8)
        rates = self._rates_at(point(self._sign * start), self._at_nodes(rule.nodes, end / self._half))
        series = rule.coefficients(rates)
        x = place_on(series, (t - shown) / end, self._setup.reals, self._digits)
        return start + end * x if abs(x) < 1 and self._resolves(series[0], series[-2:], self._digits) else None

    def _time(self, tau: Real, point: Callable[[Real], Row]) -> Real | None:
        """The physical time at τ > 0, by a Gauss rule on panels that are no longer than a cell."""
        count = ceil(float(tau / (2 * self._half)))
        nodes, weights = gauss_legendre(
            self._setup.reals, self._node_count(2 * digits_a_node(self._setup, self._sign, 1))
        )
        n, panel = len(nodes), tau / (2 * count)
        steps, total = self._at_nodes(nodes, panel / self._half), 0 * tau
        # ``last`` is w_i·P_(n − 1)(x_i), from P_(n − 1)² = 2(1 − x²)/(n²w) at the nodes; ``other`` is w_i·P_(n −
        # 2)(x_i), from P_n(x_i) = 0 and the recurrence
        pairs = list(zip(nodes, weights, strict=True))
        last = [(1 - 2 * (k % 2)) * root(2 * (1 - x * x) * w) / n for k, (x, w) in enumerate(pairs)]
        other = [(2 * n - 1) * x * y / (n - 1) for x, y in zip(nodes, last, strict=True)]
        for k in range(count):
            rates = self._rates_at(point(self._sign * (2 * k + 1) * panel), steps)
            whole = sum(map(mul, weights, rates))
            tail = [(2 * n - 1) * sum(map(mul, row, rates)) for row in (last, other)]
            # if the last coefficients are small to n digits, the Gauss rule is accurate to 2n digits
            if not self._resolves(whole, tail, self._digits / 2):
                return None
            total += whole
        return panel * total
