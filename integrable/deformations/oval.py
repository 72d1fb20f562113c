"""The motion of one separated variable along the bounded oval of Z'² = 4Π(Z − e_i), by theta functions to any digits.

The roots R_i = √|Z − e_i|, with Z' = 2R_1R_2R_3, determine the signs of γ. On the oval they are R_low = √(e_middle −
e_low)sn u, R_middle = √(e_middle − e_low)cn u and R_high = √(e_high − e_low)dn u with u = √(e_high − e_low)τ. So digits
are lost only when τ is reduced to a fraction of a period (:mod:`integrable.mumford.elliptic_torus`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from integrable.deformations.oval_loops import Track, height
from integrable.mumford.elliptic_torus import theta_quotients, theta_rows
from jacobian.element import FormulaField, Real
from jacobian.inexact.long_numbers import LongNumbers


class SeparatedOval:
    """The oval of the curve with branch points ``e``, from all |R_i| at the start and the sign of Z' there.

    ``gap(i, j)`` returns e_i − e_j, to all digits. ``low``, ``middle`` and ``high`` are the indices of the smallest,
    middle and largest e_i. ``period`` is the real period, after which R_low and R_middle have changed sign. ``table``
    and ``factors`` give R_low, R_middle and R_high from the phase in turns of the period, counted from Z = e_low.
    """

    def __init__(
        self, K: LongNumbers, e: Sequence[Real], gap: Callable[[int, int], Real], sizes: Sequence[Real], turn: int
    ) -> None:
        self.field, self.e = K, e
        # on the bounded oval, e_low ≤ Z ≤ e_middle ≤ e_high
        self.low, self.middle, self.high = sorted(range(3), key=lambda i: e[i])
        self.signs = [1 if i == self.low else -1 for i in range(3)]
        self.start = list(sizes)
        self.start[self.low] *= turn
        # rounding may make a small gap negative, such as the width of an oval that is a point
        self.swing, self.breadth, self.above = (
            abs(gap(i, j)) for i, j in ((self.middle, self.low), (self.high, self.low), (self.high, self.middle))
        )
        root, agm = K.context.sqrt, K.context.agm
        wide = root(self.breadth)
        self._mean = agm(wide, root(self.above))
        self.period = K.context.pi / self._mean
        self.nome = K.context.exp(-K.context.pi * self._mean / agm(wide, root(self.swing))) if self.swing else K.zero
        count = 1
        while self.nome ** (count * count) > K.eps:
            count += 1
        self.table, (two, three, four) = theta_rows(K, self.nome, count + 1)
        swing = root(self.swing)
        self.factors = swing * three / two, swing * four / two, wide * four / three
        self.since = self._since_low() if self.swing else K.zero

    def ordered(self, r: Sequence[Real]) -> tuple[Real, Real, Real]:
        """R_low, R_middle and R_high of the roots R_i."""
        return r[self.low], r[self.middle], r[self.high]

    def track(self, scale: Real, shift: Real) -> Track:
        """The constants for :mod:`integrable.deformations.oval_loops`, where Z = ``scale``·z + ``shift``."""
        numbers = [*self.factors, self.since / self.period, *((x - shift) / scale for x in self.ordered(self.e))]
        return Track([*numbers, 1 / scale], self.table, None)

    def moved(self, tau: Real) -> list[Real]:
        """The roots R_i after a time τ from the start."""
        return self.at((tau + self.since) / self.period)

    def at(self, turns: Real) -> list[Real]:
        """The roots R_i at a phase."""
        context = self.field.context
        turns = turns - 2 * context.nint(turns / 2)
        found = theta_quotients(self.table, context.cospi(turns), context.sinpi(turns))
        r = [self.field.zero] * 3
        for i, factor, x in zip((self.low, self.middle, self.high), self.factors, found, strict=True):
            r[i] = factor * x
        return r

    def _since_low(self) -> Real:
        """The time since Z = e_low, between −½ and ½ period, as an elliptic integral of the first kind."""
        context, r = self.field.context, self.start
        cosine, delta = r[self.middle] ** 2 / self.swing, r[self.high] ** 2 / self.breadth
        time = r[self.low] / context.sqrt(self.swing) * context.elliprf(cosine, delta, 1)
        return time / context.sqrt(self.breadth)

    def imaginary_half(self, z: Real | None) -> Real:
        """The imaginary time from Z = e_low down to Z = z; if z is None, down to −∞: half the imaginary period."""
        integral = self.field.context.elliprf
        half = integral(0, self.swing, self.breadth)
        return half if z is None else half - integral(*(x - z for x in self.e))


class Pace(NamedTuple):
    """The rate dt/dτ = 1/g of a tilde pair, g² = Σ weight_k(1 + dz_k), on the torus of two ovals with Z_k = μ_kz_k.

    Both ``weights`` are positive, with the sum 1.
    """

    field: LongNumbers
    d: Real
    curves: Sequence[SeparatedOval]
    tracks: Sequence[Track]
    mu: Sequence[Real]
    weights: Sequence[Real]

    @property
    def period(self) -> Real:
        """The shorter period of the two curves."""
        return min(curve.period for curve in self.curves)

    def share(self, k: int, r: Sequence[Real]) -> Real:
        """weight_k(1 + dz_k) at the roots R_i on curve k."""
        return self.weights[k] * (1 + self.d * height(self.tracks[k], self.curves[k].ordered(r)))

    def at(self, times: Sequence[Real]) -> Real:
        """1/g after the points of the two curves have moved for these times."""
        one, two = (self.share(k, self.curves[k].moved(time)) for k, time in enumerate(times))
        return 1 / root_of_rounded(self.field, one + two)


def root_of_rounded(K: FormulaField, x: Real) -> Real:
    """The root √|x| of a number that is nonnegative up to rounding."""
    return K.sqrt(abs(x))
