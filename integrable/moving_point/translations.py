"""Translations T(eps) of a flow by a time eps, to any precision: Σ∫dx/y = eps and Σ∫x dx/y = 0.

Over bare reals T(eps) is a power series in eps² (:func:`expand_orders`) within half a basic step; beyond, it is 2^k
times T(eps/2^k). Balls need bounds of truncation errors, which integrals in x give
(:mod:`integrable.moving_point.balls`).
"""

from __future__ import annotations

from math import ceil, inf, isqrt, log2
from typing import Any, NamedTuple

from integrable.moving_point.addition import Real, Row, leading, opposite, shift
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

# the points of T(half step) have this fraction of the distance from x = 0 to the next branch point: the terms of the
# series fall like its powers
REACH = 0.3
# SCOUT: number of terms from which the radius of an expansion is estimated. HALVED_FROM: for many translations half a
# step is halved once per so many bits. FEW: up to this number of translations a long series does not pay
SCOUT = 24
HALVED_FROM = 2500
FEW = 6


class Translations:
    """T(eps) of one curve, in bare reals. ``f`` and ``axes`` are those of :mod:`integrable.moving_point.addition`;
    ``half_step`` is half of a basic step, chosen by REACH.
    """

    def __init__(self, reals: BareReals, f: Any, axes: Any, half_step: Any) -> None:
        self.reals = reals
        self.f = reals.row(f)
        self.axes = (*reals.row(axes[:3]), *[reals.number(1)] * 4, reals.number(0))
        self.half_step = reals.number(half_step)
        # a halving costs an addition and saves terms; this number is near the optimum
        self._halvings = isqrt(reals.bits // 25)
        self._asked = 0
        self._expansions: dict[int, tuple[Expansion, float]] = {}

    def _expansion(self, rest: int) -> tuple[Expansion, float]:
        """The :class:`Expansion` for half a step halved ``rest`` times, and its radius in half steps."""
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
                # compared with the first coefficients that are not 0, of order 0 or 1
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

    def near(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) as a moving point with κ = 1, for eps ≠ 0 of any size."""
        reals = self.reals
        self._asked += 1
        # computing a long series pays for many translations
        rest = reals.bits // HALVED_FROM if self._asked > FEW else self._halvings
        with reals:
            eps = reals.number(eps)
            size = float(max(abs(eps) / self.half_step, 2.0**-500))
            doublings = max(0, ceil(log2(size)) + rest)
            rows, radius = self._expansion(rest)
            terms = min(self._terms(radius, size * 2.0**-doublings), len(rows.u0))
            step = near_identity(rows, self.axes, eps / 2**doublings, terms)
            for _ in range(doublings):
                step = reals.plain_row(shift(self.f, self.axes, step, step))
        return reals.plain_row(step)

    def sum(self, first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
        """The sum of two translations."""
        with self.reals:
            return self.reals.plain_row(shift(self.f, self.axes, first, second))

    def at_nodes(self, nodes: list[Any], length: int) -> list[tuple[Any, ...]]:
        """T at the nodes of a panel of ``length`` basic steps. ``nodes`` lie in [−1, 1], symmetric about 0, and do not
        include 0.
        """
        self._asked += len(nodes) // 2
        with self.reals:
            outer = [self.near(self.half_step * length * x) for x in nodes[: len(nodes) // 2]]
            return outer + [opposite(step) for step in outer[::-1]]


class Expansion(NamedTuple):
    """Rows for the coefficients of u0, u1, v0/eps and v1·eps of T(eps), power series in z = eps², and for auxiliary
    series: s0, (v1·eps)², and ``less``, the coefficients of w0 + v1²/z + u1w1 minus those of (v1·eps)² of the next
    order.
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
    """The same rows. In compiled code, the high parts of their double-doubles."""
    return Expansion(
        leading(rows.u0), leading(rows.u1), leading(rows.v0), leading(rows.v1), leading(rows.s0), leading(rows.squares),
        leading(rows.less),
    )  # fmt: skip


def expand_orders(f: Row, rows: Expansion, begin: int, end: int) -> None:
    """Computes the orders ``begin`` … ``end`` − 1 of an expansion from the earlier ones; compiled unchanged.

    They follow from u0' = v1u0 − u1v0, u1' = −v0, 2v0' = u1w0 − s0u0, 2v1' = w0 + u1w1 − s0u1 − w2u0, where
    W = (f − V²)/U and s0 = w1 − f5u0 (:meth:`integrable.motion.enclosure.BallMotion.velocity`). These equations leave
    two coefficients undetermined (resonance), so u0 = −f0z/4 + … and u1 = −f1z/12 + … are prescribed.
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


def near_identity(rows: Expansion, axes: Row, eps: Real, terms: int) -> Row:
    """T(eps) from that many terms of its expansion."""
    n, square, zero = terms - 1, eps * eps, 0 * eps
    u0, u1, v0, v1 = zero + rows.u0[n], zero + rows.u1[n], zero + rows.v0[n], zero + rows.v1[n]
    for _ in range(terms - 1):
        n -= 1
        u0, u1 = u0 * square + rows.u0[n], u1 * square + rows.u1[n]
        v0, v1 = v0 * square + rows.v0[n], v1 * square + rows.v1[n]
    return with_pairs(axes, u0, u1, v0 * eps, v1 / eps)


def with_pairs(axes: Row, u0: Real, u1: Real, v0: Real, v1: Real) -> Row:
    """The translation with this divisor. Near the identity σ_i is α_i − c, whatever the centre c: continued around α_i
    it has no branch.
    """
    a1, a2, a3 = axes[0], axes[1], axes[2]
    r1, r2, r3 = (
        signed_like(a1, root((a1 + u1) * a1 + u0)),
        signed_like(a2, root((a2 + u1) * a2 + u0)),
        signed_like(a3, root((a3 + u1) * a3 + u0)),
    )
    return u0, u1, v0, v1, r1, r2, r3, (v0 + v1 * a1) / r1, (v0 + v1 * a2) / r2, (v0 + v1 * a3) / r3


def signed_like(x: Real, size: Real) -> Real:
    """``size`` with the sign of x."""
    return -size if x < 0 else size
