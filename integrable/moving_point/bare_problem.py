"""The numbers of a :class:`MotionProblem` in bare reals, computed about ten times as fast; a torus starts from them."""

from __future__ import annotations

from typing import Any, NamedTuple

from integrable.moving_point.problem import at_rest
from integrable.moving_point.short_rows import NUMBERS
from integrable.moving_point.short_start import made_upright, moving_start, put_curve
from integrable.moving_point.translations import REACH
from integrable.phase.upright import parallel
from jacobian.numbers.long_reals import BareReals
from jacobian.numbers.roots import root

Real = Any
Row = tuple[Any, ...]
# positions in a :func:`problem_row` after f, the axes and the start
START, TIME_SCALE, RATIO, HEAVINESS, MOMENTUM, HALF_STEP, MATRIX, SLOWNESS = 14, 24, 25, 26, 27, 28, 29, 33
ROW = 34
# number of last bits in which |γ × M|/|M| has no significance
SPARE_BITS = 15


class BareProblem(NamedTuple):
    """The attributes of :class:`integrable.moving_point.problem.MotionProblem` as numbers of a :class:`BareReals`, and
    ``slowness``, the constant product of 1/g and √((1 − du₁)(1 − du₂)) of the upright motion.
    """

    f: Row
    axes: Row
    start: Row
    ratio: Real
    d: Real
    time_scale: Real
    momentum: Real
    half_step: Real
    matrix: Row | None
    slowness: Real

    @property
    def branch_points(self) -> Row:
        """The roots of f, computed inside a ``with reals`` block."""
        rest = () if self.d == 0 else (1 / self.d,)
        return (*self.axes[:3], self.ratio, *rest)

    @property
    def row(self) -> Row:
        """The same numbers as a :func:`problem_row`."""
        matrix = self.matrix or (1, 0, 0, 1)
        numbers = self.time_scale, self.ratio, self.d, self.momentum, self.half_step
        return (*self.f, *self.axes, *self.start, *numbers, *matrix, self.slowness)

    @staticmethod
    def of(reals: BareReals, given: Row, tilted: bool) -> BareProblem:
        """The problem of the moments, d, γ and M in ``given``. ArgumentError for M = 0; NotRepresentable for a tilted
        state with M ∥ γ.
        """
        with reals:
            row = reals.row(given)
            check(row[4:7], row[7:], tilted, reals.bits - SPARE_BITS)
            found = [reals.number(0)] * ROW
            problem_row(row, tilted, found, [0.0] * NUMBERS)
            scale, ratio, d, momentum, half_step = found[TIME_SCALE:MATRIX]
            matrix = tuple(found[MATRIX:SLOWNESS]) if tilted else None
            return BareProblem(
                tuple(found[:6]), tuple(found[6:START]), tuple(found[START:TIME_SCALE]), ratio, d, scale, momentum,
                half_step, matrix, found[SLOWNESS],
            )  # fmt: skip


def problem_row(given: Any, tilted: bool, out: Any, numbers: Any) -> None:
    """Writes the row of a :class:`BareProblem` to ``out``, from the moments, d, γ and M in ``given``. An upright state
    has the identity as its matrix. ``numbers`` is working memory for floats. The function is compiled unchanged.
    """
    a = (1 / (given[0] + given[3]), 1 / (given[1] + given[3]), 1 / (given[2] + given[3]))
    (I0, I1, I2, d), (x, y, u), M, (k, s, p, rise) = made_upright(given, a, tilted, numbers)
    tilt = x * M[0] + y * M[1] + u * M[2]
    M = (M[0] - tilt * x, M[1] - tilt * y, M[2] - tilt * u)
    contact = (I0 * a[0], I1 * a[1], I2 * a[2])
    top, spin = max(a[0], a[1], a[2]), root(M[0] * M[0] + M[1] * M[1] + M[2] * M[2])
    ratio = put_curve(given, a, (contact, d), (x, y, u), M, out)
    moving_start(a, (contact, d), (x, y, u), M, spin, out)
    across = s * s / p
    out[12], out[13] = s, given[3] * k * across * top * spin
    out[TIME_SCALE], out[RATIO], out[HEAVINESS], out[MOMENTUM] = 2 * top * spin, ratio, d * top, spin
    out[HALF_STEP] = 2 * REACH * min(out[6], out[7], out[8], ratio) / root(-out[0])
    out[MATRIX], out[MATRIX + 1], out[MATRIX + 2], out[MATRIX + 3] = across, -(s * k), across * rise, s
    # g² is Σσ², and (1 − du₁)(1 − du₂) = g²·Π(1 − dα_i)
    out[SLOWNESS] = s * root(contact[0] * contact[1] * contact[2])


def check(gamma: Row, M: Row, tilted: bool, bits: int) -> None:
    """Raises the errors of a motion without a curve; M ∥ γ is decided with this many bits."""
    (x, y, z), (a, b, c) = gamma, M
    square = a * a + b * b + c * c
    if square == 0:
        raise at_rest()
    u, v, w = y * c - z * b, z * a - x * c, x * b - y * a
    if tilted and (u * u + v * v + w * w) * (1 << 2 * bits) <= square:
        raise parallel(float(x * a + y * b + z * c))
