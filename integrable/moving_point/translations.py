"""Translations T(eps) of a flow by a time eps, to any precision: Σ∫dx/y = eps and Σ∫x dx/y = 0.

Over bare reals T(eps) is a power series in eps² (:func:`expand_orders`) within half a basic step; beyond, it is 2^k
times T(eps/2^k). Balls need bounds of truncation errors and therefore use Newton's iteration on the integrals in x
(:meth:`Translations.centre`); each iteration doubles the digits.
"""

from __future__ import annotations

from functools import cached_property
from math import ceil, frexp, inf, isqrt, log2
from typing import NamedTuple

from integrable.moving_point.addition import Row, centre, leading, opposite, shift, trust_of
from integrable.moving_point.legendre import doubling_precisions
from jacobian.element import Real
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

# the points of T(half step) lie at about this fraction of the distance from x = 0 to the nearest branch point; the
# terms of the series decrease like its powers
REACH = 0.3
# bits gained per term of the series at half a step, where the two points are at most at 1.4·REACH of that
# distance from 0. Each halving of eps gains another bit
TERM_BITS = -log2(1.4 * REACH)
FLOAT_BITS = 44
# the radius of an expansion is estimated from SCOUT terms. For more than FEW translations a longer series is computed,
# for which half a step is halved only once per HALVED_FROM bits
SCOUT = 24
HALVED_FROM = 2500
FEW = 6


class Translations:
    """T(eps) of one curve, in bare reals. ``f`` and ``axes`` are those of :mod:`integrable.moving_point.addition`;
    ``half_step`` is half of a basic step, chosen by REACH.
    """

    def __init__(self, reals: BareReals, f: Row, axes: Row, half_step: Real) -> None:
        self.reals = reals
        self.f = reals.row(f)
        self.axes = (*reals.row(axes[:3]), *[reals.number(1)] * 4, reals.number(0))
        self.half_step = reals.number(half_step)
        # a halving costs an addition and saves terms; this number is near the optimum
        self._halvings = isqrt(reals.bits // 25)
        self._asked = 0
        self._expansions: dict[int, tuple[Expansion, float]] = {}

    @cached_property
    def series(self) -> tuple[Real, ...]:
        """The coefficients of 1/√(f/f0) about x = 0."""
        size = int(self.reals.bits / (TERM_BITS + self._halvings)) + 6
        with self.reals:
            return series_of(self.f, -1, size)

    def _expansion(self, rest: int) -> tuple[Expansion, float]:
        """The :class:`Expansion` for half a step divided by 2^``rest``, and its radius in half steps."""
        if rest not in self._expansions:
            self._expansions[rest] = self._expanded(rest)
        return self._expansions[rest]

    def _expanded(self, rest: int) -> tuple[Expansion, float]:
        half = self.half_step
        with self.reals.at(64):
            square = half * half
            scaled = [[x * square**k for k, x in enumerate(row)] for row in self._orders(SCOUT)[:4]]
            falls = [abs(row[SCOUT // 2] / row[-1]) for row in scaled if row[-1] != 0]
            known = SCOUT - 1 - SCOUT // 2
            radius = float(min(falls)) ** (0.5 / known) if falls else inf
        while True:
            size = self._terms(radius, 2.0**-rest)
            with self.reals:
                found = self._orders(size)
                square = (half / 2**rest) ** 2
                least = square ** (size - 1) * 2**self.reals.bits
                # the last coefficients are compared with the first that are not 0, of order 0 or 1
                if all(abs(row[-1]) * least <= max(abs(row[0]), abs(row[1]) * square) for row in found[:4]):
                    return found, radius
            radius = 1 + 0.8 * (radius - 1)

    def _orders(self, count: int) -> Expansion:
        """The first orders of the expansion."""
        rows = expansion_of([self.reals.number(0)] * (7 * count))
        expand_orders(self.f, rows, 0, count)
        return rows

    def _terms(self, radius: float, size: float) -> int:
        """The number of terms that give all digits at an eps of this ``size``. ``size`` and the expansion's ``radius``
        are in half steps.
        """
        return max(4, int(self.reals.bits / (2 * log2(max(min(radius / size, 2.0**500), 1.01)))) + 6)

    def near(self, eps: Real) -> tuple[Real, ...]:
        """T(eps) as a moving point with κ = 1, for eps ≠ 0 of any size."""
        reals = self.reals
        self._asked += 1
        # a longer series with fewer halvings costs less for many translations
        rest = reals.bits // HALVED_FROM if self._asked > FEW else self._halvings
        with reals:
            eps = reals.number(eps)
            size = float(max(abs(eps) / self.half_step, 2.0**-500))
            doublings = max(0, ceil(log2(size)) + rest)
            rows, radius = self._expansion(rest)
            step = self._summed(rows, self._terms(radius, size * 2.0**-doublings), eps / 2**doublings)
            for _ in range(doublings):
                step = reals.plain_row(shift(self.f, self.axes, step, step))
        return reals.plain_row(step)

    def _summed(self, rows: Expansion, terms: int, eps: Real) -> tuple[Real, ...]:
        """T(eps) by its expansion."""
        square = eps * eps
        u0, u1, v0, v1 = (0 * eps,) * 4
        for a, b, c, d in zip(*(row[min(terms, len(row)) - 1 :: -1] for row in rows[:4]), strict=True):
            u0, u1, v0, v1 = u0 * square + a, u1 * square + b, v0 * square + c, v1 * square + d
        v0, v1 = v0 * eps, v1 / eps
        sigma = [root((a + u1) * a + u0) for a in self.axes[:3]]
        return (u0, u1, v0, v1, *sigma, *((v0 + v1 * a) / x for a, x in zip(self.axes[:3], sigma, strict=True)))

    def level(self, k: int) -> tuple[int, tuple[Real, ...]]:
        """(n, the translation by n basic steps): n = 1 for k = 0, and about 2n for the next k.

        The next n is the one among 2n − 1, 2n and 2n + 1 whose translation loses the fewest digits in an addition.
        """
        for i in range(len(self._levels), k + 1):
            (n, last), (_, first) = self._levels[i - 1], self._levels[0]
            with self.reals:
                double, back = self.sum(last, last), opposite(first)
            near = [(2 * n, double), (2 * n + 1, self.sum(double, first))]
            if n > 1:
                near.append((2 * n - 1, self.sum(double, back)))
            self._levels[i] = max(near, key=lambda level: trust_of(level[1]))
        return self._levels[k]

    @cached_property
    def _levels(self) -> dict[int, tuple[int, tuple[Real, ...]]]:
        with self.reals:
            return {0: (1, self.near(2 * self.half_step))}

    def sum(self, first: tuple[Real, ...], second: tuple[Real, ...]) -> tuple[Real, ...]:
        """The sum of two translations."""
        with self.reals:
            return self.reals.plain_row(shift(self.f, self.axes, first, second))

    def at_nodes(self, nodes: list[Real], length: int) -> list[tuple[Real, ...]]:
        """T at the nodes of a panel of ``length`` basic steps. ``nodes`` lie in [−1, 1], symmetric about 0, and do not
        include 0.
        """
        self._asked += len(nodes) // 2
        with self.reals:
            outer = [self.near(self.half_step * length * x) for x in nodes[: len(nodes) // 2]]
            return outer + [opposite(step) for step in outer[::-1]]

    def plan(self, eps: Real) -> tuple[int, float]:
        """(number of halvings of eps, bits gained per term of the series after them)."""
        exponent = frexp(float(max(abs(eps) / self.half_step, 2.0**-500)))[1]
        doublings = max(0, exponent + self._halvings)
        return doublings, TERM_BITS + doublings - exponent

    def centre(self, eps: Real, term_bits: float) -> tuple[Real, Real]:
        """(m, r) of T(eps), whose points are at m ± √r, by Newton's method. It starts from floats or, for a tiny eps,
        from the leading order.
        """
        reals, f0 = self.reals, self.f[0]
        r = f0 * eps * eps / 4
        m = -self.series[1] * r / 3
        known = int(2 * term_bits)
        if term_bits < 100:
            known = FLOAT_BITS
            series = tuple(map(float, self.series[: self.terms(53, term_bits)]))
            passes = max(2, 2 + int(log2(27 / term_bits)))
            floats = (float(f0), float(eps), float(m), float(r))
            m, r = map(reals.number, centre(series, *floats, passes))
        for bits in doubling_precisions(reals.bits, known):
            with reals.at(bits + 16):
                m, r = map(reals.plain, centre(self.series[: self.terms(bits, term_bits)], f0, eps, m, r, 1))
        return m, r

    def terms(self, bits: int, term_bits: float) -> int:
        """The number of terms of the series that give ``bits`` bits, if each gains ``term_bits``."""
        return min(len(self.series), int(bits / term_bits) + 6)


class Expansion(NamedTuple):
    """Rows for the coefficients of u0, u1, v0/eps and v1·eps of T(eps), power series in z = eps², and for auxiliary
    series: s0 and ``squares`` = (v1·eps)² (:func:`expand_orders`), and ``less``, the coefficients of w0 + 4/z.
    """

    u0: Row
    u1: Row
    v0: Row
    v1: Row
    s0: Row
    squares: Row
    less: Row


def expansion_of(row: Row) -> Expansion:
    """An :class:`Expansion` whose rows are seven equal parts of a row."""
    n = len(row) // 7
    return Expansion(
        row[:n], row[n : 2 * n], row[2 * n : 3 * n], row[3 * n : 4 * n], row[4 * n : 5 * n], row[5 * n : 6 * n],
        row[6 * n :],
    )  # fmt: skip


def high_parts(rows: Expansion) -> Expansion:
    """The rows of an expansion, unchanged; in compiled code, the high parts of their double-doubles."""
    return Expansion(
        leading(rows.u0), leading(rows.u1), leading(rows.v0), leading(rows.v1), leading(rows.s0), leading(rows.squares),
        leading(rows.less),
    )  # fmt: skip


def expand_orders(f: Row, rows: Expansion, begin: int, end: int) -> None:
    """Computes the orders ``begin`` … ``end`` − 1 of an expansion from the earlier ones; compiled unchanged.

    The orders follow from u0' = v1u0 − u1v0, u1' = −v0, 2v0' = u1w0 − s0u0, 2v1' = w0 + u1w1 − s0u1 − w2u0, where W =
    (f − V²)/U and s0 = w1 − f5u0 (:meth:`integrable.motion.enclosure.BallMotion.velocity`). These equations leave two
    coefficients undetermined (resonance), so u0 = −f0z/4 + … and u1 = −f1z/12 + … are prescribed.
    """
    f0, f1, f2, f3, f4, f5 = f
    u0, u1, v0, v1, s0, squares, less = rows
    zero = 0 * f0
    if begin == 0:
        u0[0], u1[0], v0[0], v1[0] = zero, zero, f1 / 6, 2 + zero
    for k in range(max(begin, 1), end):
        # sums of equal length share a loop: their terms do not wait for one another
        s, t, own, straight, mixed, bent = zero, zero, zero, zero, zero, zero
        for i in range(1, k):
            s += v1[i] * u0[k - i]
            t += u1[i] * v0[k - 1 - i]
            own += v1[i] * v1[k - i]
        for i in range(1, k - 1):
            straight += u1[i] * u1[k - 1 - i]
            mixed += u0[i] * u1[k - 1 - i]
        u0[k] = -f0 / 4 if k == 1 else (s - t) / (2 * k - 2)
        u1[k] = -v0[k - 1] / (2 * k)
        s0[k - 1] = f5 * (straight - 2 * u0[k - 1]) - f4 * u1[k - 1] + (f3 if k == 1 else zero)
        for i in range(1, k):
            bent += u1[i] * s0[k - 1 - i]
        rest = (f2 if k == 1 else zero) - bent - f4 * u0[k - 1]
        v1[k] = (rest - f4 * u0[k - 1] + 2 * f5 * mixed - own) / (4 * k + 2)
        squares[k] = 4 * v1[k] + own
        less[k - 1] = rest - squares[k]
        s, t = zero, zero
        for i in range(1, k + 1):
            s += u1[i] * less[k - i]
            t += u0[i] * s0[k - i]
        v0[k] = (s - t) * (k + 1) / (2 * k * (2 * k + 3))


def series_of(f: tuple[Real, ...], power: int, size: int) -> tuple[Real, ...]:
    """The first coefficients of (f/f0)^(power/2) about 0."""
    out = [f[0]] * size
    power_series(f, power, out)
    return tuple(out)


def power_series(f: Row, power: int, out: Row) -> None:
    """Writes the coefficients of (f/f0)^(power/2) about 0 to ``out``, by the recurrence from its logarithmic
    derivative. f has six coefficients, ascending.
    """
    one = f[0] / f[0]
    out[0] = one
    r1, r2, r3, r4, r5 = f[1] / f[0], f[2] / f[0], f[3] / f[0], f[4] / f[0], f[5] / f[0]
    for k in range(1, len(out)):
        total = (power + 2 - 2 * k) * r1 * out[k - 1]
        if k > 1:
            total += (2 * (power + 2) - 2 * k) * r2 * out[k - 2]
        if k > 2:
            total += (3 * (power + 2) - 2 * k) * r3 * out[k - 3]
        if k > 3:
            total += (4 * (power + 2) - 2 * k) * r4 * out[k - 4]
        if k > 4:
            total += (5 * (power + 2) - 2 * k) * r5 * out[k - 5]
        out[k] = total / (2 * k)
