"""What a torus is made from, in bare reals: the numbers of a :class:`MotionProblem` some ten times as fast."""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.moving_point.problem import at_rest
from integrable.moving_point.short_rows import NUMBERS, WIDE
from integrable.moving_point.short_start import curve, made_upright, moving_start
from integrable.moving_point.translations import REACH
from integrable.phase.upright import parallel
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

Real = Any
Row = tuple[Any, ...]
# of |γ × M|/|M| nothing is known that is below so many of the last bits
SPARE_BITS = 15


class BareProblem(NamedTuple):
    """As :class:`integrable.moving_point.problem.MotionProblem` has them, numbers of a :class:`BareReals`."""

    f: Row
    axes: Row
    start: Row
    ratio: Real
    d: Real
    time_scale: Real
    momentum: Real
    half_step: Real
    matrix: Row | None

    @property
    def branch_points(self) -> Row:
        """The roots of f; operations take ``with reals``."""
        rest = () if self.d == 0 else (1 / self.d,)
        return (*self.axes[:3], self.ratio, *rest)

    @staticmethod
    def of(reals: BareReals, given: Row, tilted: bool) -> BareProblem:
        """That of the moments, d, γ and M in ``given``; ArgumentError for M = 0, NotRepresentable for tilted M ∥ γ."""
        with reals:
            row = reals.row(given)
            check(row[4:7], row[7:], tilted, reals.bits - SPARE_BITS)
            view = [reals.number(0)] * WIDE
            a = (1 / (row[0] + row[3]), 1 / (row[1] + row[3]), 1 / (row[2] + row[3]))
            (*moments, d), gamma, M, (k, s, p, rise) = made_upright(row, a, tilted, [0.0] * NUMBERS)
            tilt = gamma[0] * M[0] + gamma[1] * M[1] + gamma[2] * M[2]
            M = tuple(m - tilt * x for m, x in zip(M, gamma, strict=True))
            contact = tuple(moment * x for moment, x in zip(moments, a, strict=True))
            top, spin = max(a), root(M[0] * M[0] + M[1] * M[1] + M[2] * M[2])
            ratio = curve(row, a, (contact, d), gamma, M, view)
            moving_start(a, (contact, d), gamma, M, spin, view)
            upright = s * s / p
            axes = (*view[6:12], s, row[3] * k * upright * top * spin)
            half_step = 2 * REACH * min(*view[6:9], ratio) / root(-view[0])
            matrix = (upright, -(s * k), upright * rise, s) if tilted else None
            return BareProblem(
                tuple(view[:6]), axes, tuple(view[14:24]), ratio, d * top, 2 * top * spin, spin, half_step, matrix
            )


def check(gamma: Row, M: Row, tilted: bool, bits: int) -> None:
    """The errors of a motion that has no curve, M ∥ γ being told to so many bits."""
    (x, y, z), (a, b, c) = gamma, M
    square = a * a + b * b + c * c
    if square == 0:
        raise at_rest()
    u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
    if tilted and (u * u + v * v + w * w) * (1 << 2 * bits) <= square:
        raise parallel(float(x * a + y * b + z * c))
