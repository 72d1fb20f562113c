"""The motion of one separated variable along the bounded oval of Z'² = 4Π(Z − e_i): an addition of (℘(τ), ℘'(τ)).

The roots R_i = √|Z − e_i| determine the signs of γ. The addition formula extends to them:

    R_i(u + v) = (s_i(v)R_i'(u) + R_i(u)s_j(v)s_k(v))/(℘(v) − Z(u)),   s_i = √(℘ − e_i),   R_i' = ±R_jR_k.

τ is reduced modulo the real period, π divided by an arithmetic-geometric mean (Gauss). So the digits lost in an
addition do not grow with the time. s_i(v) is computed by doublings, each of which multiplies errors by up to 16; |v| is
at most half a period. (The addition formula is Weierstrass's.)
"""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Any


class SeparatedOval:
    """The curve with e_i = μ/I_i, from the sizes |R_i| at a point, in the order of the axes, and the sign of Z' there.

    ``low``, ``middle`` and ``high`` are the indices of the smallest, middle and largest e_i. ``period`` is the real
    period, after which R_low and R_middle have changed sign.
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
        """z = Z/μ at the roots R_i, computed from the smallest of the roots in ``among``."""
        i = min(among, key=lambda n: abs(r[n]))
        return (self.e[i] + self.signs[i] * r[i] * r[i]) / self.mu

    def moved(self, tau: Any) -> list[Any]:
        """The roots R_i after a time τ from the start."""
        turns = self.field.context.nint(tau / self.period)
        rest = tau - turns * self.period
        r = self.added(self.start, self.translation(rest)) if rest else list(self.start)
        if turns % 2:
            for i in (self.low, self.middle):
                r[i] = -r[i]
        return r

    def added(self, r: Sequence[Any], s: Sequence[Any]) -> list[Any]:
        """The roots R_i at the sum of a point with roots r and a translation s.

        It is the sum in :class:`jacobian.relatives.signed.SignedGroup` of D = (Z, 2R_1R_2R_3) and D' = (℘,
        −2s_1s_2s_3), written out because that is several times as fast. tests/integrable/deformations/test_oval.py
        compares them.
        """
        i = self.low
        # ℘(v) − Z(u) = s_i² ∓ R_i²; an i for which this is a sum avoids cancellation
        j = (i + 1) % 3
        down = s[j] * s[j] + r[j] * r[j]
        return [(s[n] * self.signs[n] * r[n - 2] * r[n - 1] + r[n] * s[n - 2] * s[n - 1]) / down for n in range(3)]

    def translation(self, v: Any) -> list[Any]:
        """s_i(v) = √(℘(v) − e_i), 0 < |v| ≤ half a period, from the Laurent series at v/2^m and m doublings."""
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
        """s_i(2v) from s_i(v), without differences except in s_high, which vanishes at half a period."""
        below, above = self.height_of_oval, self.above
        down = 2 * s[0] * s[1] * s[2]
        result = [self.field.zero] * 3
        middle = (s[self.middle] ** 4 + below * above) / down
        result[self.middle] = middle
        result[self.low] = root_of_rounded(self.field, middle * middle + below)
        result[self.high] = (s[self.high] ** 4 - self.breadth * above) / down
        return result

    def since_low(self) -> Any:
        """The time since Z = e_low, within ± half a period: an elliptic integral of the first kind."""
        context, r = self.field.context, self.start
        sine, cosine, delta = abs(r[self.low]), r[self.middle], r[self.high]
        high, breadth = self.height_of_oval, self.breadth
        time = sine / root_of_rounded(self.field, high) * context.elliprf(cosine**2 / high, delta**2 / breadth, 1)
        time = time / root_of_rounded(self.field, breadth)
        return time if r[0] * r[1] * r[2] >= 0 else -time

    def imaginary_half(self, z: Any) -> Any:
        """The imaginary time from Z = e_low down to Z = z; for None down to −∞, which is half the imaginary period."""
        integral = self.field.context.elliprf
        half = integral(0, self.height_of_oval, self.breadth)
        return half if z is None else half - integral(*(x - z for x in self.e))

    def at_low(self) -> list[Any]:
        """The roots R_i at Z = e_low."""
        r = [self.field.zero] * 3
        r[self.middle], r[self.high] = (
            root_of_rounded(self.field, self.height_of_oval),
            root_of_rounded(self.field, self.breadth),
        )
        return r


def root_of_rounded(K: Any, x: Any) -> Any:
    """√|x|, for an x that is nonnegative up to rounding."""
    return K.context.sqrt(abs(x))


def laurent(K: Any, g2: Any, g3: Any) -> list[Any]:
    """The Laurent coefficients c_0, c_1, … of ℘(v) = v⁻² + v²Σ c_n v^(2n), ℘'² = 4℘³ − g2℘ − g3."""
    count = ceil(0.5 * K.dps + 10)
    c = [K.zero, K.zero, g2 / 20, g3 / 28]
    for n in range(4, count + 2):
        # each product c_m·c_(n−m), m ≠ n − m, occurs twice
        middle = (n + 1) // 2
        total = 2 * K.dot(c[2:middle], c[n - 2 : n - middle : -1])
        if n % 2 == 0:
            total += c[middle] * c[middle]
        c.append(3 * total / ((2 * n + 1) * (n - 3)))
    return c[2:]
