"""What a flow is set up with, once per state: computed in extended precision and rounded once."""

from __future__ import annotations

from functools import cached_property, lru_cache
from math import ceil, log
from typing import Any

from integrable.body import Body, Vector, cross
from integrable.chaplygin_transformation import ChaplyginTransformation
from integrable.flow_kernel import near_identity, shift
from jacobian import MP, RR, poly
from jacobian.errors import ArgumentError

# conjugate points of T(half step) at this part of the distance from x = 0 to the next branch point: the series converge
# like its powers
REACH = 0.3
FLOAT_DIGITS = 45
GUARD_DIGITS = 10
# neighbours of a doubled step count among which the best conditioned translation is taken
SEARCH = 6
NODE_COUNTS = (8, 12, 16, 20, 24, 28, 32, 40, 48, 64, 80, 96, 128, 160, 200, 256, 320, 400)


class Setup:
    """The curve, the start, the translations by 2^k basic steps and the quadrature nodes of one motion.

    Numbers are rounded to ``number`` (float, or mpf with guard digits). Units: x over X = max a_i, τ' = 2X|M|·τ, t' =
    2X|M|·t.
    """

    def __init__(self, body: Body, gamma: Vector, M: Vector, tilted: bool = False) -> None:
        field = body.field
        self.wide: Any
        self.work: Any
        if field == RR:
            self.wide, self.work, digits = MP(FLOAT_DIGITS), RR, 16
        elif type(field) is type(MP(15)) and not field.complex:
            digits = field.dps + GUARD_DIGITS
            self.wide, self.work = MP(digits + 20), MP(digits)
        else:
            raise ArgumentError(f"field = {field.name}: a flow runs over RR or MP(digits)")
        self.digits = digits
        self.tilt: ChaplyginTransformation | None = None
        self._wide_problem(Body.make(body.inertia, body.d, self.wide), gamma, M, tilted)
        number = self.number
        self.f, self.axes, self.start = (tuple(map(number, v)) for v in (self._f, self._axes, self._start))
        size = ceil(digits * log(10) / -log(1.4 * REACH)) + 4
        # steps of Newton from an estimate: floats start at leading order, multiprecision from floats
        self.passes = 6 if self.work is RR else max(1, ceil(log(digits / 14, 2)))
        self._series = power_series(self.wide, self._f, -1, size + ceil(1.3 * (self.wide.dps - digits)))
        self._roots = power_series(self.wide, self._f, 1, len(self._series))
        self.series, self.roots = (tuple(map(number, v[:size])) for v in (self._series, self._roots))
        self.half_step = number(self._half_step)
        self.counts = [1]
        self._levels = [self._translation(2 * self._half_step)]
        self._multiples = list(self._levels)
        self._table: dict[int, list[tuple[Any, ...]]] = {1: [], -1: []}

    def number(self, x: Any) -> Any:
        """x, rounded to the working numbers."""
        return float(x) if self.work is RR else self.work.coerce(x)

    def _wide_problem(self, body: Body, gamma: Vector, M: Vector, tilted: bool) -> None:
        K = self.wide
        gamma, M = (tuple(map(K.coerce, v)) for v in (gamma, M))
        # the constraints hold to rounding; make them hold to the last digit of the wide precision
        length = K.sqrt(K.dot(gamma, gamma))
        gamma = tuple(x / length for x in gamma)
        if tilted:
            self.tilt = ChaplyginTransformation.of(body, gamma, M)
            body, (gamma, M) = self.tilt.upright, self.tilt.apply_vectors(gamma, M)
        tilt = K.dot(gamma, M)
        M = tuple(m - tilt * x for m, x in zip(M, gamma, strict=True))
        h1, h2 = body.integrals(gamma, M)[2:]
        if h2 == 0:
            raise ArgumentError("M = (0, 0, 0): the body is at rest; a flow needs M ≠ 0")
        top, spin = max(body.a), K.sqrt(h2)
        alphas = tuple(a / top for a in body.a)
        kappas = (r * c / top**2 for r, c in zip(body.contact, body.differences, strict=True))
        self._axes = (*alphas, *kappas, *self._clock(top, spin))
        self.ratio, self._d = h1 / (h2 * top), body.d * top
        f = (-self.ratio, K.one)
        for a in alphas:
            f = poly.mul(K, f, (a, -K.one))
        self._f = (*poly.mul(K, f, (K.one, -self._d)),)
        self.clock = 2 * top * spin
        self.momentum = self.number(spin)
        self._start = self._moving_point(body, gamma, M, spin)
        branch = min(*alphas, self.ratio)
        self._half_step = 2 * REACH * branch / K.sqrt(-self._f[0])

    def _clock(self, top: Any, spin: Any) -> tuple[Any, Any]:
        """(α, β) of the clock, in the units of the flow."""
        if self.tilt is None:
            return self.wide.one, self.wide.zero
        upright, lean = self.tilt.clock()
        return upright, lean * top * spin

    def _moving_point(self, body: Body, gamma: Vector, M: Vector, spin: Any) -> tuple[Any, ...]:
        K = self.wide
        g = 1 / K.sqrt(body.conformal(gamma))
        w = cross(K, gamma, M)
        lean = 2 * g * body.d * sum(a * x * y for a, x, y in zip(body.a, gamma, w, strict=True)) / (2 * spin)
        sigma = tuple(g * x for x in gamma)
        nu = tuple(y / spin + lean * x for x, y in zip(sigma, w, strict=True))
        u, v = [K.zero] * 3, [K.zero] * 3
        for i, (r, x, y) in enumerate(zip(body.contact, sigma, nu, strict=True)):
            others = self._axes[(i + 1) % 3], self._axes[(i + 2) % 3]
            for k, c in enumerate((others[0] * others[1], -others[0] - others[1], 1)):
                u[k] += r * x * x * c
                v[k] += r * x * y * c
        return (u[0], u[1], v[0], v[1], *sigma, *nu)

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
        """α, κ and the clock's constants, as :mod:`integrable.flow_kernel` takes them."""
        return self._axes

    @property
    def wide_d(self) -> Any:
        """d·max a_i."""
        return self._d

    @property
    def wide_axes(self) -> tuple[Any, ...]:
        """α1, α2, α3."""
        return self._axes[:3]

    @property
    def wide_branch_points(self) -> tuple[Any, ...]:
        """The roots of f."""
        rest = () if self._d == 0 else (1 / self._d,)
        return (*self._axes[:3], self.ratio, *rest)

    @property
    def wide_passes(self) -> int:
        """Steps of Newton from a float to the wide precision."""
        return max(1, ceil(log(self.wide.dps / 14, 2)))

    def wide_series(self, f: tuple[Any, ...], power: int) -> tuple[Any, ...]:
        """The series of (f/f0)^(power/2), as long as the flow's own."""
        return power_series(self.wide, f, power, len(self._series))

    def combine(self, first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
        """The sum of two translations, as a moving point with κ = 1."""
        return shift(self._f, (*self._axes[:3], 1, 1, 1, 1, 0), first, second)

    def moved(self, step: tuple[Any, ...], point: tuple[Any, ...]) -> tuple[Any, ...]:
        """A wide moving point after a translation."""
        return shift(self._f, self._axes, point, step)

    # --- translations
    # -----------------------------------------------------------------------------------------------------------

    def _near(self, eps: Any) -> tuple[Any, ...]:
        return near_identity(self._series, self._roots, self._f[0], self._axes, eps, self.wide_passes)

    def near(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) in the working numbers, for |eps| up to half a step."""
        return near_identity(self.series, self.roots, self.f[0], self.axes, self.number(eps), self.passes)

    def _translation(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) for |eps| up to a full step: the double of half of it."""
        return self._double(self._near(eps / 2))

    def table(self, sign: int, steps: int) -> tuple[list[int], list[tuple[Any, ...]]]:
        """(counts, translations): sign·counts[k] basic steps each, ascending from 1 to beyond ``steps``."""
        while self.counts[-1] <= steps:
            self._add_level()
        rows = self._table[sign]
        rows.extend(self._signed(step, sign) for step in self._levels[len(rows) :])
        return self.counts, rows

    def _add_level(self) -> None:
        """About twice the last count: of some neighbours the translation that is best conditioned."""
        double = self._double(self._levels[-1])
        rough = {m: self._near_sum(double, m) for m in range(-min(SEARCH, self.counts[-1] - 1), SEARCH + 1)}
        best = max(rough, key=lambda m: conditioning(rough[m]))
        exact = double if best == 0 else self.combine(double, self._multiple(best))
        self.counts.append(2 * self.counts[-1] + best)
        self._levels.append(exact)

    def _near_sum(self, step: tuple[Any, ...], m: int) -> tuple[Any, ...]:
        """The translation by m further basic steps, roughly: in floats."""
        if m == 0:
            return tuple(map(float, step))
        axes = (*self._axes[:3], 1, 1, 1, 1, 0)
        floats = (tuple(map(float, row)) for row in (self._f, axes, step, self._multiple(m)))
        return shift(*floats)

    def _multiple(self, m: int) -> tuple[Any, ...]:
        """The translation by m basic steps, |m| ≤ SEARCH."""
        while len(self._multiples) < abs(m):
            last = self._multiples[-1]
            self._multiples.append(
                self._double(last) if len(self._multiples) == 1 else self.combine(last, self._multiples[0])
            )
        step = self._multiples[abs(m) - 1]
        return step if m > 0 else opposite(step)

    def _double(self, step: tuple[Any, ...]) -> tuple[Any, ...]:
        return self.combine(step, step)

    def _signed(self, step: tuple[Any, ...], sign: int) -> tuple[Any, ...]:
        rounded = tuple(map(self.number, step))
        return rounded if sign > 0 else opposite(rounded)

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
    def step_length(self) -> Any:
        """τ' of one basic step, in the wide precision."""
        return 2 * self._half_step


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


@lru_cache(maxsize=32)
def legendre_rule(K: Any, count: int) -> tuple[list[Any], list[list[Any]], list[Any]]:
    """(nodes, matrix from values at the nodes to a Legendre series, weights of ∫_0^1) on [−1, 1]."""
    x, w = gauss_legendre(K, count)
    columns = [legendre_polynomials(K, node, count) for node in x]
    rows = [[(2 * k + 1) * w[i] * columns[i][k] / 2 for i in range(count)] for k in range(count)]
    ends = [_half_integral(K, k) for k in range(count)]
    return x, rows, [sum(ends[k] * rows[k][i] for k in range(count)) for i in range(count)]


def power_series(K: Any, f: tuple[Any, ...], power: int, size: int) -> tuple[Any, ...]:
    """Coefficients of (f/f0)^(power/2) about 0, by the recurrence of its logarithmic derivative."""
    p = K.coerce(power) / 2
    ratios = [c / f[0] for c in f]
    series = [K.one]
    for k in range(1, size):
        total = K.zero
        for j in range(1, min(k, len(f) - 1) + 1):
            total += (p * j - (k - j)) * ratios[j] * series[k - j]
        series.append(total / k)
    return tuple(series)


def legendre_polynomials(K: Any, x: Any, count: int) -> list[Any]:
    """P_0(x), …, P_{count−1}(x)."""
    values = [K.one, x]
    for k in range(1, count - 1):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    return values[:count]


def gauss_legendre(K: Any, count: int) -> tuple[list[Any], list[Any]]:
    """Nodes (ascending) and weights of Gauss–Legendre quadrature on [−1, 1], by Newton from the cosine estimate."""
    nodes, weights = [], []
    for i in range(count):
        x = -K.context.cos(K.context.pi * (i + K.coerce("0.75")) / (count + K.coerce("0.5")))
        for _ in range(60):
            values = legendre_polynomials(K, x, count + 1)
            slope = count * (x * values[count] - values[count - 1]) / (x * x - 1)
            change = values[count] / slope
            x -= change
            if abs(change) < 64 * K.eps:
                break
        nodes.append(x)
        weights.append(2 / ((1 - x * x) * slope * slope))
    return nodes, weights


def _half_integral(K: Any, k: int) -> Any:
    """∫_0^1 P_k."""
    if k == 0:
        return K.one
    values = legendre_polynomials(K, K.zero, k + 2)
    return (values[k - 1] - values[k + 1]) / (2 * k + 1)
