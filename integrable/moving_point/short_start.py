"""The start of a short run: the :class:`~integrable.moving_point.problem.Problem` of one motion in wide numbers, and
derived quantities in floats. The code runs on bare reals and is compiled unchanged.
"""

from __future__ import annotations

from math import sqrt

from integrable.moving_point.addition import Row, moving_point, put, rate_at
from integrable.moving_point.problem import (
    HALF_STEP,
    HEAVINESS,
    INVARIANTS,
    MATRIX,
    MOMENTUM,
    RATIO,
    START,
    TIME_SCALE,
    problem_row,
)
from integrable.moving_point.short_rows import AHEAD, BEGIN, TIME_UNIT, FloatMotion, axes_of
from integrable.moving_point.short_steps import OFF_BY, contact_of, framed, levelled, on_pairs, put_gamma_and_w
from jacobian.numbers.roots import root


def set_up(given: Row, tilted: bool, wide: Row, point: Row) -> FloatMotion:
    """The motion in floats, from the moments, d, γ and M in ``given``. Writes a
    :func:`~integrable.moving_point.problem.problem_row` and the units of time in wide numbers to ``wide``, and γ and
    w = γ × M/|M| of the start to ``point``.
    """
    problem_row(given, tilted, wide)
    s, spin, start, d = wide[12], wide[MOMENTUM], moving_point(wide, START), given[3]
    # time is scaled by s, so that α = 1 in :func:`~integrable.moving_point.addition.rate_at`
    wide[12], wide[13] = 1 + 0 * s, wide[13] / s
    wide[TIME_UNIT] = wide[TIME_SCALE] / s
    put_gamma_and_w(start, point, BEGIN, 1)
    total = given[0] + d, given[1] + d, given[2] + d
    least, most = min(given[0], given[1], given[2]), max(given[0], given[1], given[2])
    length = root(given[7] * given[7] + given[8] * given[8] + given[9] * given[9])
    lift = max(
        abs(wide[MATRIX]) + abs(wide[MATRIX + 1]) * spin, (abs(wide[MATRIX + 2]) + wide[MATRIX + 3] * spin) / length
    )
    # |ω|² ≤ H1/min I bounds the rate of turning, and dτ/dt = g ≥ 1
    radian = 2 * sqrt(max(0.0, float((1 - wide[HEAVINESS]) / wide[RATIO])))
    rate = abs(float(rate_at(axes_of(wide), start)))
    return FloatMotion(
        (float(wide[0]), float(wide[1]), float(wide[2]), float(wide[3]), float(wide[4]), float(wide[5])),
        (float(wide[6]), float(wide[7]), float(wide[8]), float(wide[9]),
         float(wide[10]), float(wide[11]), float(wide[12]), float(wide[13])),
        (float(1 / total[0]), float(1 / total[1]), float(1 / total[2])),
        (float(given[0] / total[0]), float(given[1] / total[1]), float(given[2] / total[2])),
        float(d), (float(wide[INVARIANTS]), float(wide[INVARIANTS + 1])), float(spin),
        (float(wide[MATRIX]), float(wide[MATRIX + 1]), float(wide[MATRIX + 2]), float(wide[MATRIX + 3])),
        float(wide[TIME_SCALE]), float(wide[TIME_UNIT]), float((most + d) / (most - least)),
        max(1.0, float(lift) / 4), float(wide[HALF_STEP]), radian, fastest(wide, rate),
    )  # fmt: skip


def cast_shadow(wide: Row, ahead: Row) -> None:
    """Writes two moving points to the last two rows of ``ahead``: the start of the motion, and that of the shadow
    (:mod:`integrable.moving_point.short`), whose pairs deviate by :data:`OFF_BY`.
    """
    start, beside, r = 20 * AHEAD, 20 * AHEAD + 10, contact_of(wide)
    sigma, nu = 0 * wide[14], 0 * wide[14]
    for i in range(3):
        sigma, nu = sigma + abs(wide[18 + i]), nu + abs(wide[21 + i])
    for i in range(10):
        ahead[start + i] = wide[14 + i]
    for i in range(3):
        ahead[beside + 4 + i] = wide[18 + i] + sigma * ((1 + i) * OFF_BY)
        ahead[beside + 7 + i] = wide[21 + i] + nu * ((5 - i * i) * OFF_BY)
    x, y, _ = framed(wide, r, moving_point(ahead, beside))
    put(on_pairs(wide, r, x, levelled(wide, r, x, y, OFF_BY)), ahead, beside)


def scaled(times: Row, wide: Row, unit: int, high: Row, low: Row) -> None:
    """Writes ``times`` in the units of the motion as ``high`` + ``low``. ``unit`` is the position in ``wide`` of the
    unit of τ or of physical time.
    """
    for i in range(len(times)):
        t = wide[unit] * times[i]
        high[i] = float(t)
        low[i] = float(t - high[i])


def at_start(given: Row, tilted: bool, times: Row, out: Row, other: Row) -> None:
    """Writes γ and M of the start, projected onto the constraints, and 0 as the ``other`` time, to the rows whose time
    is 0. These rows are then free of the interpolant's error.
    """
    length = 1 / root(given[4] * given[4] + given[5] * given[5] + given[6] * given[6])
    x, y, u, m0, m1, m2 = given[4] * length, given[5] * length, given[6] * length, given[7], given[8], given[9]
    if not tilted:
        tilt = x * m0 + y * m1 + u * m2
        m0, m1, m2 = m0 - tilt * x, m1 - tilt * y, m2 - tilt * u
    for i in range(len(times)):
        if times[i] == 0:
            out[6 * i], out[6 * i + 1], out[6 * i + 2] = float(x), float(y), float(u)
            out[6 * i + 3], out[6 * i + 4], out[6 * i + 5] = float(m0), float(m1), float(m2)
            other[i] = 0.0


def fastest(wide: Row, rate: float) -> float:
    """A bound of 1/g from its value ``rate`` at the start. For an upright body 1/g is largest where (1 − du₁)(1 − du₂)
    is least, at the upper ends of both ovals. The result is 2·``rate`` for a tilted body or if the bound is larger;
    the run itself then detects larger values.
    """
    dX, ratio, first, second, third = (
        float(wide[HEAVINESS]), float(wide[RATIO]), float(wide[6]), float(wide[7]), float(wide[8]),
    )  # fmt: skip
    low, high = min(first, second, third), max(first, second, third)
    middle = first + second + third - low - high
    least, here = (1 - dX * min(middle, ratio)) * (1 - dX * high), 1 + dX * (float(wide[15]) + dX * float(wide[14]))
    upright = wide[13] == 0 and here < 4 * least
    return rate * (sqrt(here / least) if upright else 2.0)
