"""The motion of one separated variable along the bounded oval of Z'² = 4Π(Z − e_i): an addition of (℘(τ), ℘'(τ)).

The signs of γ come from the roots R_i = √|Z − e_i|, which the addition moves too:

    R_i(u + v) = (s_i(v)R_i'(u) + R_i(u)s_j(v)s_k(v))/(℘(v) − Z(u)),   s_i = √(℘ − e_i),   R_i' = ±R_jR_k.

τ is taken modulo the real period, π over an arithmetic-geometric mean (Gauss), so the digits lost in an addition do not
grow with the time. Each doubling on the way to s_i(v) multiplies every error by up to 16, and only those within half a
period are needed. (The addition: Weierstrass.)
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any


class SeparatedOval:
    """The curve with e_i = μ/I_i, from the roots |R_i| of a point, in any order, and the sign of Z' there.

    The indices of the least, middle and largest e_i are ``low``, ``middle`` and ``high``, ``period`` is the real
    period, in which R_low and R_middle change their signs, ``half`` what Z moves by.
    """

    def __init__(self, K: Any, inertia: Sequence[Any], mu: Any, sizes: Sequence[Any], turn: int) -> None:
        self.field = K
        self.mu = mu
        self.e = [mu / x for x in inertia]
        # on the bounded oval, e_low ≤ Z ≤ e_middle ≤ e_high
        self.low, self.middle, self.high = sorted(range(3), key=lambda i: self.e[i])
        self.signs = [1 if i == self.low else -1 for i in range(3)]
        # Z' = 2R_1R_2R_3
        self.start = [turn * sizes[0], *sizes[1:]]

        def gap(i: int, j: int) -> Any:
            return mu * (inertia[j] - inertia[i]) / (inertia[i] * inertia[j])

        self.height_of_oval = gap(self.middle, self.low)
        self.breadth, self.above = gap(self.high, self.low), gap(self.high, self.middle)
        self.period = K.context.pi / K.context.agm(root_of_rounded(K, self.breadth), root_of_rounded(K, self.above))
        mean = sum(self.e) / 3
        self.centred = [x - mean for x in self.e]
        one, two, three = self.centred
        self.series = laurent(K, -4 * (one * two + two * three + three * one), 4 * one * two * three)

    def height(self, r: Sequence[Any], among: Sequence[int] = (0, 1, 2)) -> Any:
        """z = Z/μ at the roots R_i, computed from the root that gives the smallest terms."""
        i = min(among, key=lambda n: abs(r[n]))
        return (self.e[i] + self.signs[i] * r[i] * r[i]) / self.mu

    def moved(self, tau: Any) -> list[Any]:
        """The roots R_i a time τ later."""
        turns = self.field.context.nint(tau / self.period)
        rest = tau - turns * self.period
        r = self.added(self.start, self.translation(rest)) if rest else list(self.start)
        if turns % 2:
            for i in (self.low, self.middle):
                r[i] = -r[i]
        return r

    def added(self, r: Sequence[Any], s: Sequence[Any]) -> list[Any]:
        """The roots R_i at the sum of a point with roots r and a translation s.

        It is the sum of :class:`jacobian.relatives.signed.SignedGroup` on the curve, D = (Z, 2R_1R_2R_3), D' = (℘,
        −2s_1s_2s_3), written out: several times as fast (tests/integrable/deformations/test_oval.py holds them equal).
        """
        i = self.low
        # ℘(v) − Z(u) = s_i² ∓ R_i², a sum where the sign of R_i² is −
        j = (i + 1) % 3
        down = s[j] * s[j] + r[j] * r[j]
        return [(s[n] * self.signs[n] * r[n - 2] * r[n - 1] + r[n] * s[n - 2] * s[n - 1]) / down for n in range(3)]

    def translation(self, v: Any) -> list[Any]:
        """s_i(v) = √(℘(v) − e_i), 0 < |v| ≤ half a period: the Laurent series at v/2^m, then m doublings."""
        K, size, halvings = self.field, max(map(abs, self.centred)), 0
        sign, v = (1, v) if v > 0 else (-1, -v)
        while v * v * size > 1 / 16:
            v, halvings = v / 2, halvings + 1
        square = v * v
        tail = K.zero
        for c in reversed(self.series):
            tail = tail * square + c
        # v²(℘ − e) = 1 − v²e + v⁴·tail
        s = [root_of_rounded(K, 1 - square * e + square * square * tail) / v for e in self.centred]
        for _ in range(halvings):
            s = self._doubled(s)
        return [sign * x for x in s]

    def _doubled(self, s: Sequence[Any]) -> list[Any]:
        """s_i(2v), without a difference except that of s_high, which vanishes at half a period."""
        below, above = self.height_of_oval, self.above
        down = 2 * s[0] * s[1] * s[2]
        result = [self.field.zero] * 3
        middle = (s[self.middle] ** 4 + below * above) / down
        result[self.middle] = middle
        result[self.low] = root_of_rounded(self.field, middle * middle + below)
        result[self.high] = (s[self.high] ** 4 - self.breadth * above) / down
        return result

    def since_low(self) -> Any:
        """The time since Z = e_low, between plus and minus half a period: an elliptic integral of the first kind."""
        context, r = self.field.context, self.start
        sine, cosine, delta = abs(r[self.low]), r[self.middle], r[self.high]
        high, breadth = self.height_of_oval, self.breadth
        time = sine / root_of_rounded(self.field, high) * context.elliprf(cosine**2 / high, delta**2 / breadth, 1)
        time = time / root_of_rounded(self.field, breadth)
        return time if r[0] * r[1] * r[2] >= 0 else -time

    def imaginary_half(self, z: Any) -> Any:
        """The imaginary time from Z = e_low down to Z = z, or to −∞ (half the imaginary period) where z is None."""
        integral = self.field.context.elliprf
        half = integral(0, self.height_of_oval, self.breadth)
        return half if z is None else half - integral(*(x - z for x in self.e))

    def at_low(self) -> list[Any]:
        """The roots R_i where Z = e_low."""
        r = [self.field.zero] * 3
        r[self.middle], r[self.high] = (
            root_of_rounded(self.field, self.height_of_oval),
            root_of_rounded(self.field, self.breadth),
        )
        return r


def root_of_rounded(K: Any, x: Any) -> Any:
    """√x of a number that is positive up to rounding."""
    return K.context.sqrt(abs(x))


def laurent(K: Any, g2: Any, g3: Any) -> list[Any]:
    """c_0, c_1, … with ℘(v) = v⁻² + v²Σ c_n v^(2n), ℘'² = 4℘³ − g2℘ − g3."""
    count = ceil(0.5 * K.dps + 10)
    c = [K.zero, K.zero, g2 / 20, g3 / 28]
    for n in range(4, count + 2):
        # the products c_m·c_(n−m) occur twice
        middle = (n + 1) // 2
        total = 2 * K.dot(c[2:middle], c[n - 2 : n - middle : -1])
        if n % 2 == 0:
            total += c[middle] * c[middle]
        c.append(3 * total / ((2 * n + 1) * (n - 3)))
    return c[2:]
