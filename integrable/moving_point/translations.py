"""Translations T(eps) of a flow by a time eps, to any precision: Σ∫dx/y = eps and Σ∫x dx/y = 0.

T(eps) is a power series in eps² (:func:`expand_orders`) within half a basic step. For larger eps it is 2^k times
T(eps/2^k). :class:`integrable.moving_point.balls.BallTranslations` bounds the remainder of the series.
"""

from __future__ import annotations

from functools import cached_property
from math import ceil, inf, isqrt, log2
from typing import NamedTuple

from integrable.moving_point.addition import Row, leading, opposite, shift, trust_of
from jacobian.element import Real
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

# the points of T(half step) lie at about this fraction of the distance from x = 0 to the nearest branch point
REACH = 0.3
# the radius of an expansion is estimated from SCOUT terms. More than FEW translations are computed by a longer series,
# whose argument, half a step, is halved only once per HALVED_FROM bits
SCOUT = 24
HALVED_FROM = 2500
FEW = 6


class Translations:
    """The translations T(eps) of one curve, in bare reals. ``f`` and ``axes`` are as in
    :mod:`integrable.moving_point.addition`. ``half_step``, half of a basic step, is the largest eps of the series.
    """

    few: float = FEW
    """The number of translations up to which halvings cost less than a longer series."""

    def __init__(self, reals: BareReals, f: Row, axes: Row, half_step: Real) -> None:
        self.reals = reals
        self.f = reals.row(f)
        self.axes = (*reals.row(axes[:3]), *[reals.number(1)] * 4, reals.number(0))
        self.half_step = reals.number(half_step)
        # a halving costs an addition and saves terms; this number is near the optimum
        self._halvings = isqrt(reals.bits // 25)
        self._asked = 0
        self._expansions: dict[int, tuple[Expansion, float]] = {}

    def _expansion(self, rest: int) -> tuple[Expansion, float]:
        """The :class:`Expansion` for half a step divided by 2^``rest``, and its radius in half steps."""
        if rest in self._expansions:
            return self._expansions[rest]
        radius = self._estimated_radius()
        while True:
            count = self._terms(radius, 2.0**-rest)
            rows = expansion_of([self.reals.number(0)] * (7 * count))
            with self.reals:
                expand_orders(self.f, rows, 0, count)
                if self._ends(rows, (self.half_step / 2**rest) ** 2, radius):
                    self._expansions[rest] = rows, radius
                    return rows, radius
            radius *= 0.75

    def _estimated_radius(self) -> float:
        """The radius of the expansion in half steps, from the decrease of its first coefficients in floats."""
        with self.reals:
            # if half a step is the unit of time, the curve is f·half_step²
            f = tuple(float(c * self.half_step * self.half_step) for c in self.f)
        rows = expansion_of([0.0] * (7 * SCOUT))
        expand_orders(f, rows, 0, SCOUT)
        falls = [abs(row[SCOUT // 2] / row[-1]) for row in rows[:4] if row[-1] != 0]
        return min(falls) ** (0.5 / (SCOUT - 1 - SCOUT // 2)) if falls else inf

    def _ends(self, rows: Expansion, square: Real, radius: float) -> bool:
        """Whether the last coefficients are negligible at eps² = ``square``. They are compared with the first nonzero
        coefficients, of order 0 or 1.
        """
        least = square ** (len(rows.u0) - 1) * 2**self.reals.bits
        return all(abs(row[-1]) * least <= max(abs(row[0]), abs(row[1]) * square) for row in rows[:4])

    def _terms(self, radius: float, size: float) -> int:
        """The number of terms that give all digits of T(eps) at |eps| = ``size``, by a series that converges up to
        ``radius``. The unit of both is half a basic step.
        """
        return max(4, int(self.reals.bits / (2 * log2(max(min(radius / size, 2.0**500), 1.01)))) + 6)

    def near(self, eps: Real) -> tuple[Real, ...]:
        """T(eps) as a moving point with κ = 1, for eps ≠ 0 of any size."""
        reals = self.reals
        self._asked += 1
        # a longer series with fewer halvings costs less for many translations
        rest = reals.bits // HALVED_FROM if self._asked > self.few else self._halvings
        with reals:
            eps = reals.number(eps)
            size = float(max(abs(eps) / self.half_step, 2.0**-500))
            doublings = max(0, ceil(log2(size)) + rest)
            rows, radius = self._expansion(rest)
            step = self._summed(rows, self._terms(radius, size * 2.0**-doublings), eps / 2**doublings)
            for _ in range(doublings):
                step = self.sum(step, step)
        return step

    def _summed(self, rows: Expansion, terms: int, eps: Real) -> tuple[Real, ...]:
        """T(eps) by its expansion."""
        square = eps * eps
        u0, u1, v0, v1 = (0 * eps,) * 4
        for a, b, c, d in zip(*(row[min(terms, len(row)) - 1 :: -1] for row in rows[:4]), strict=True):
            u0, u1, v0, v1 = u0 * square + a, u1 * square + b, v0 * square + c, v1 * square + d
        u0, u1, v0, v1 = self._whole((u0, u1, v0, v1), terms, square)
        v0, v1 = v0 * eps, v1 / eps
        sigma = [root((a + u1) * a + u0) for a in self.axes[:3]]
        nu = ((v0 + v1 * a) / x for a, x in zip(self.axes[:3], sigma, strict=True))
        return u0, u1, v0, v1, *sigma, *nu

    def _whole(self, sums: Row, terms: int, square: Real) -> Row:
        """The four series at eps² = ``square``, from the ``sums`` of their first ``terms`` terms. In this class
        later terms do not change the last digit; a subclass adds bounds of the remainders.
        """
        return sums

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
            found: tuple[Real, ...] = shift(self.f, self.axes, first, second)
        return found

    def at_nodes(self, nodes: list[Real], length: int) -> list[tuple[Real, ...]]:
        """T at the nodes of a panel of ``length`` basic steps. ``nodes`` lie in [−1, 1], symmetric about 0, and do not
        include 0.
        """
        self._asked += len(nodes) // 2
        with self.reals:
            outer = [self.near(self.half_step * length * x) for x in nodes[: len(nodes) // 2]]
            return outer + [opposite(step) for step in outer[::-1]]


class Expansion(NamedTuple):
    """Rows for the coefficients of u0, u1, v0/eps and v1·eps of T(eps), power series in z = eps², and for auxiliary
    series: s0, ``squares`` = (v1·eps)², and ``less`` = w0 + 4/z, with s0 and w0 as in :func:`expand_orders`.
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
    (f − V²)/U and s0 = w1 − f5u0 (``BallMotion._velocity`` in :mod:`integrable.motion.enclosure`). These equations
    leave two coefficients undetermined (resonance), so u0 = −f0z/4 + … and u1 = −f1z/12 + …, z = eps², are prescribed.
    """
    f0, f1, f2, f3, f4, f5 = f
    u0, u1, v0, v1, s0, squares, less = rows
    zero = 0 * f0
    if begin == 0:
        u0[0], u1[0], v0[0], v1[0] = zero, zero, f1 / 6, 2 + zero
    for k in range(max(begin, 1), end):
        # sums of equal length share a loop, so that their independent additions overlap
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
