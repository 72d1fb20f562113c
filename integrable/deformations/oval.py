"""The rate of physical time on the two ovals of a tilde pair at d ≠ 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from integrable.deformations.oval_loops import height
from integrable.mumford.elliptic_torus import EllipticOval
from jacobian.element import FormulaField, Real
from jacobian.inexact.long_field import LongField


class Pace(NamedTuple):
    """The rate dt/dτ = 1/g of a tilde pair, g² = Σ weight_k(1 + dz_k), on the torus of two ovals.

    Both ``weights`` are positive, with the sum 1; ``levels`` give the heights z_k
    (:mod:`integrable.deformations.oval_loops`).
    """

    field: LongField
    d: Real
    curves: Sequence[EllipticOval]
    levels: Sequence[Sequence[Real]]
    weights: Sequence[Real]

    @property
    def period(self) -> Real:
        """The shorter period of the two curves."""
        return min(curve.period for curve in self.curves)

    def share(self, k: int, r: tuple[Real, Real, Real]) -> Real:
        """weight_k(1 + dz_k) at the roots R_i on curve k."""
        return self.weights[k] * (1 + self.d * height(self.levels[k], r))

    def at(self, times: Sequence[Real]) -> Real:
        """1/g after the points of the two curves have moved for these times."""
        one, two = (self.share(k, self.curves[k].moved(time)) for k, time in enumerate(times))
        return 1 / root_of_rounded(self.field, one + two)


def root_of_rounded(K: FormulaField, x: Real) -> Real:
    """The root √|x| of a number that is nonnegative up to rounding."""
    return K.sqrt(abs(x))
