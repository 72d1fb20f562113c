"""Translations of a flow by short times, to any precision: T(eps) with Σ∫dx/y = eps and Σ∫x dx/y = 0.

The power series of :func:`integrable.moving_point.addition.centre` are short when eps is small: T(eps) is the 2^k-fold
of T(eps/2^k), and the digits of Newton's iteration double from pass to pass.
"""

from __future__ import annotations

from math import frexp, isqrt, log2
from typing import Any

from integrable.moving_point.addition import Row, centre, conjugate_points, opposite, shift
from integrable.moving_point.legendre import doubling_precisions
from jacobian.numbers.long_reals import BareReals

# conjugate points of T(half step) at this part of the distance from x = 0 to the next branch point: the series converge
# like its powers
REACH = 0.3
# bits that a term of the series brings at half a step: the two points are at most 1.4·REACH away from 0, and another
# one for every halving of eps
TERM_BITS = -log2(1.4 * REACH)
FLOAT_BITS = 44


class Translations:
    """T(eps) of one curve, in bare reals. ``f`` and ``axes`` are those of :mod:`integrable.moving_point.addition`,
    ``half_step`` fits REACH.
    """

    def __init__(self, reals: BareReals, f: Any, axes: Any, half_step: Any) -> None:
        self.reals = reals
        self.f = reals.row(f)
        self.axes = (*reals.row(axes[:3]), *[reals.number(1)] * 4, reals.number(0))
        self.half_step = reals.number(half_step)
        # a halving costs an addition and saves terms: about the best
        self._halvings = isqrt(reals.bits // 25)
        size = int(reals.bits / (TERM_BITS + self._halvings)) + 6
        with reals:
            self.series, self.roots = (series_of(self.f, power, size) for power in (-1, 1))
        self._floats = tuple(map(float, self.series))

    def near(self, eps: Any) -> tuple[Any, ...]:
        """T(eps) as a moving point with κ = 1, for eps ≠ 0 of any size."""
        reals = self.reals
        with reals:
            eps = reals.number(eps)
            doublings, term_bits = self.plan(eps)
            eps = eps / 2**doublings
            m, r = self.centre(eps, term_bits)
            step = conjugate_points(self.roots[: self.terms(reals.bits, term_bits)], self.f[0], self.axes, eps, m, r)
            for _ in range(doublings):
                step = reals.plain_row(shift(self.f, self.axes, step, step))
        return reals.plain_row(step)

    def sum(self, first: tuple[Any, ...], second: tuple[Any, ...]) -> tuple[Any, ...]:
        """The sum of two translations."""
        with self.reals:
            return self.reals.plain_row(shift(self.f, self.axes, first, second))

    def at_nodes(self, nodes: list[Any], length: int) -> list[tuple[Any, ...]]:
        """T at nodes of [−1, 1], symmetric about 0 and without it, of a panel of ``length`` basic steps."""
        with self.reals:
            outer = [self.near(self.half_step * length * x) for x in nodes[: len(nodes) // 2]]
            return outer + [opposite(step) for step in outer[::-1]]

    def plan(self, eps: Any) -> tuple[int, float]:
        """How often to halve eps, and the bits that a term of the series brings then."""
        exponent = frexp(float(max(abs(eps) / self.half_step, 2.0**-500)))[1]
        doublings = max(0, exponent + self._halvings)
        return doublings, TERM_BITS + doublings - exponent

    def centre(self, eps: Any, term_bits: float) -> tuple[Any, Any]:
        """(m, r) of T(eps), its points at m ± √r: Newton from floats or, for a tiny eps, from the leading order."""
        reals, f0 = self.reals, self.f[0]
        r = f0 * eps * eps / 4
        m = -self.series[1] * r / 3
        known = int(2 * term_bits)
        if term_bits < 100:
            known = FLOAT_BITS
            passes = max(2, 2 + int(log2(27 / term_bits)))
            floats = (float(f0), float(eps), float(m), float(r))
            m, r = map(reals.number, centre(self._floats[: self.terms(53, term_bits)], *floats, passes))
        for bits in doubling_precisions(reals.bits, known):
            with reals.at(bits + 16):
                m, r = map(reals.plain, centre(self.series[: self.terms(bits, term_bits)], f0, eps, m, r, 1))
        return m, r

    def terms(self, bits: int, term_bits: float) -> int:
        """How many terms of the series bring that many bits."""
        return min(len(self.series), int(bits / term_bits) + 6)


def series_of(f: tuple[Any, ...], power: int, size: int) -> tuple[Any, ...]:
    """The first coefficients of (f/f0)^(power/2) about 0."""
    out = [f[0]] * size
    power_series(f, power, out)
    return tuple(out)


def power_series(f: Row, power: int, out: Row) -> None:
    """Coefficients of (f/f0)^(power/2) about 0 into ``out``, by the recurrence of its logarithmic derivative; f has six
    coefficients, ascending.
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
