"""The start of a short run in wide numbers: curve, axes, moving point and Chaplygin's transformation of one motion.

The quantities are those of :class:`integrable.moving_point.problem.MotionProblem`. The code runs on bare reals and is
compiled unchanged.
"""

from __future__ import annotations

from math import sqrt
from typing import Any

from integrable.moving_point.addition import moving_point, put, rate_at
from integrable.moving_point.short_rows import (
    AHEAD,
    BEGIN,
    CLOCK,
    CLOSE,
    CONTACT,
    FASTEST,
    INVARIANTS,
    LIFT,
    MATRIX,
    MOMENTUM,
    PHYSICAL,
    RADIAN,
    REACH,
    SHAPE,
    TAU_UNIT,
    TIME_UNIT,
    axes_of,
)  # fmt: skip
from integrable.moving_point.short_steps import OFF_BY, contact_of, framed, gamma_and_w, levelled, on_pairs
from jacobian.numbers.roots import root

Real = Any
Row = Any


def set_up(given: Row, tilted: bool, wide: Row, numbers: Row, point: Row) -> None:
    """Writes the data of a motion, from the moments, d, γ and M in ``given``: f, the axes, the start and the units of
    time in wide numbers to ``wide``; f, the axes and derived quantities in floats to ``numbers``.
    """
    d = given[3]
    a = (1 / (given[0] + d), 1 / (given[1] + d), 1 / (given[2] + d))
    (I0, I1, I2, e), gamma, M, (k, s, p, rise) = made_upright(given, a, tilted, numbers)
    x, y, u = gamma
    tilt = x * M[0] + y * M[1] + u * M[2]
    M = (M[0] - tilt * x, M[1] - tilt * y, M[2] - tilt * u)
    contact = (I0 * a[0], I1 * a[1], I2 * a[2])
    top, spin = max(a[0], a[1], a[2]), root(M[0] * M[0] + M[1] * M[1] + M[2] * M[2])
    ratio = put_curve(given, a, (contact, e), gamma, M, wide)
    wide[CONTACT], wide[CONTACT + 1], wide[CONTACT + 2] = contact
    # time is scaled by s, so that the rest of the clock rate averages 1
    wide[12], wide[13] = 1 + 0 * s, d * k * s / p * top * spin
    moving_start(a, (contact, e), gamma, M, spin, wide)
    wide[TAU_UNIT] = 2 * top * spin
    wide[TIME_UNIT] = wide[TAU_UNIT] / s
    gamma_and_w(moving_point(wide, 14), point, BEGIN, 1)
    rate = float(rate_at(axes_of(wide), moving_point(wide, 14)))
    for i in range(14):
        numbers[i] = float(wide[i])
    numbers[CLOCK], numbers[PHYSICAL] = float(wide[TAU_UNIT]), float(wide[TIME_UNIT])
    numbers[MOMENTUM] = float(spin)
    across = s * s / p
    numbers[MATRIX], numbers[MATRIX + 1] = float(across), float(-(s * k))
    numbers[MATRIX + 2], numbers[MATRIX + 3] = float(across * rise), float(s)
    # how much an error of the upright motion may grow in γ or M/|M|, over 4
    length = root(given[7] * given[7] + given[8] * given[8] + given[9] * given[9])
    lift = max(across + abs(s * k) * spin, (abs(across * rise) + s * spin) / length)
    numbers[LIFT] = max(1.0, float(lift) / 4)
    pace(float(ratio), float(e * top), numbers)
    fastest(float(ratio), float(e * top), abs(rate), wide, numbers)


def cast_shadow(wide: Row, ahead: Row) -> None:
    """Writes the start, and the shadow's start, whose pairs deviate by :data:`OFF_BY`, to the last two rows of
    ``ahead``.
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


def made_upright(given: Row, a: Any, tilted: bool, numbers: Row) -> tuple[Any, Any, Any, Any]:
    """The moments and d, γ and M of the upright motion, and (k, s, p, dkH1) of Chaplygin's transformation. Data of the
    given motion are written to ``numbers``.
    """
    I0, I1, I2, d = given[0], given[1], given[2], given[3]
    length = 1 / root(given[4] * given[4] + given[5] * given[5] + given[6] * given[6])
    x, y, u = given[4] * length, given[5] * length, given[6] * length
    m0, m1, m2 = given[7], given[8], given[9]
    xi, h2 = x * a[0] * m0 + y * a[1] * m1 + u * a[2] * m2, m0 * m0 + m1 * m1 + m2 * m2
    h1 = a[0] * m0 * m0 + a[1] * m1 * m1 + a[2] * m2 * m2
    h1 += d * xi * xi / (I0 * a[0] * x * x + I1 * a[1] * y * y + I2 * a[2] * u * u)
    numbers[INVARIANTS], numbers[INVARIANTS + 1] = float(h1), float(h2)
    for i in range(3):
        numbers[SHAPE + i], numbers[SHAPE + 3 + i] = float(a[i]), float(given[i] * a[i])
    numbers[SHAPE + 6] = float(d)
    most = max(I0, I1, I2)
    numbers[CLOSE] = float((most + d) / (most - min(I0, I1, I2)))
    zero = 0 * d
    k, s, p, rise, e = zero, 1 + zero, 1 + zero, zero, d
    if tilted:
        c = x * m0 + y * m1 + u * m2
        w0, w1, w2 = y * m2 - u * m1, u * m0 - x * m2, x * m1 - y * m0
        k, rest, s, rise = transformation(c, h1, h2, w0 * w0 + w1 * w1 + w2 * w2, d)
        p = s / root(rest)
        x, y, u, m0, m1, m2 = (
            p * (x + k * m0), p * (y + k * m1), p * (u + k * m2),
            s * (m0 - rise * x), s * (m1 - rise * y), s * (m2 - rise * u),
        )  # fmt: skip
        less = d * k * c
        I0, I1, I2, e = I0 - less, I1 - less, I2 - less, d * rest
    return (I0, I1, I2, e), (x, y, u), (m0, m1, m2), (k, s, p, rise)


def transformation(c: Real, h1: Real, h2: Real, square: Real, d: Real) -> tuple[Real, Real, Real, Real]:
    """(k, 1 + kc, s, dkH1) of Chaplygin's transformation from the integrals and |γ × M|²
    (:mod:`integrable.phase.upright`).
    """
    if d == 0:
        return -(c / h2), square / h2, 1 + 0 * c, 0 * c
    rolling, double = d * h1, 2 * c
    rest = h2 - rolling
    whole = root(rest * rest + double * double * rolling)
    # (whole + rest)(whole − rest) = 4c²dH1, likewise below: sums without cancellation
    total = rest + whole if rest > 0 else double * double * rolling / (whole - rest)
    k = -(double / total)
    below = rest - double * c
    left = 1 + k * c if below > 0 else double * double * square / ((whole - below) * total)
    rise = k * rolling
    return k, left, 1 / root(1 + k * rise), rise


def put_curve(given: Row, a: Any, body: Any, gamma: Any, M: Any, wide: Row) -> Real:
    """Writes the coefficients of f = (x − ratio)·Π(α_i − x)·(1 − dX·x), ascending, then α_i and κ_i to ``wide``.
    Returns the ratio H1/(H2·X).
    """
    contact, d = body
    xi, square, h1, h2 = 0 * d, 0 * d, 0 * d, 0 * d
    for i in range(3):
        xi += gamma[i] * a[i] * M[i]
        square += contact[i] * gamma[i] * gamma[i]
        h1 += a[i] * M[i] * M[i]
        h2 += M[i] * M[i]
    top = max(a[0], a[1], a[2])
    ratio = (h1 + d * xi * xi / square) / (h2 * top)
    wide[0], wide[1] = -ratio, 1 + 0 * ratio
    for i in range(2, 6):
        wide[i] = 0 * ratio
    for j in range(4):
        constant, slope = 1 + 0 * ratio, -d * top
        if j < 3:
            constant, slope = a[j] / top, -1 + 0 * ratio
            wide[6 + j] = constant
        for i in range(j + 2, 0, -1):
            wide[i] = constant * wide[i] + slope * wide[i - 1]
        wide[0] = constant * wide[0]
    # differences of the a_i, from those of the moments, which are exact
    d01, d12 = (given[1] - given[0]) * a[0] * a[1], (given[2] - given[1]) * a[1] * a[2]
    d20, unit = (given[0] - given[2]) * a[2] * a[0], 1 / (top * top)
    wide[9] = -contact[0] * d01 * d20 * unit
    wide[10] = -contact[1] * d12 * d01 * unit
    wide[11] = -contact[2] * d20 * d12 * unit
    return ratio


def moving_start(a: Any, body: Any, gamma: Any, M: Any, spin: Real, wide: Row) -> None:
    """Writes the moving point of γ and M to ``wide``."""
    (r0, r1, r2), d = body
    x, y, u = gamma
    g = 1 / root(r0 * x * x + r1 * y * y + r2 * u * u)
    w0, w1, w2 = (y * M[2] - u * M[1]) / spin, (u * M[0] - x * M[2]) / spin, (x * M[1] - y * M[0]) / spin
    lean = g * d * (a[0] * x * w0 + a[1] * y * w1 + a[2] * u * w2)
    s0, s1, s2 = g * x, g * y, g * u
    n0, n1, n2 = w0 + lean * s0, w1 + lean * s1, w2 + lean * s2
    al0, al1, al2 = wide[6], wide[7], wide[8]
    wide[14] = r0 * s0 * s0 * al1 * al2 + r1 * s1 * s1 * al2 * al0 + r2 * s2 * s2 * al0 * al1
    wide[15] = -(r0 * s0 * s0 * (al1 + al2) + r1 * s1 * s1 * (al2 + al0) + r2 * s2 * s2 * (al0 + al1))
    wide[16] = r0 * s0 * n0 * al1 * al2 + r1 * s1 * n1 * al2 * al0 + r2 * s2 * n2 * al0 * al1
    wide[17] = -(r0 * s0 * n0 * (al1 + al2) + r1 * s1 * n1 * (al2 + al0) + r2 * s2 * n2 * (al0 + al1))
    wide[18], wide[19], wide[20], wide[21], wide[22], wide[23] = s0, s1, s2, n0, n1, n2


def scaled(times: Row, wide: Row, unit: int, high: Row, low: Row) -> None:
    """Writes ``times`` in the units of the motion, as the sum of two floats each. ``unit`` is the position in ``wide``
    of the unit of τ or of physical time.
    """
    for i in range(len(times)):
        t = wide[unit] * times[i]
        high[i] = float(t)
        low[i] = float(t - high[i])


def at_start(given: Row, tilted: bool, times: Row, out: Row, other: Row) -> None:
    """Writes γ and M of the start, projected onto the constraints, wherever a time is 0, and 0 as the ``other`` time.
    This avoids the interpolant's error there.
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


def pace(ratio: float, dX: float, numbers: Row) -> None:
    """Writes to ``numbers`` half of a basic step, and a lower bound of the τ in which the body turns by a radian."""
    low = min(numbers[6], numbers[7], numbers[8])
    # |ω|² ≤ H1/min I, and g ≥ 1
    numbers[RADIAN] = 2 * sqrt(max(0.0, 1 - dX) / ratio)
    numbers[REACH] = 0.6 * min(low, ratio) / sqrt(-numbers[0])


def fastest(ratio: float, dX: float, rate: float, wide: Row, numbers: Row) -> None:
    """Writes to ``numbers`` an upper bound of 1/g, whose value at the start is ``rate``. For an upright body 1/g is
    proportional to √((1 − du₁)(1 − du₂)), which is largest at the lower ends of both ovals. For a tilted body, or if
    that bound exceeds twice ``rate``, it writes twice ``rate``; larger values show during the run.
    """
    low, high = min(numbers[6], numbers[7], numbers[8]), max(numbers[6], numbers[7], numbers[8])
    middle = numbers[6] + numbers[7] + numbers[8] - low - high
    most, here = (1 - dX * low) * (1 - dX * max(middle, ratio)), 1 + dX * (float(wide[15]) + dX * float(wide[14]))
    upright = wide[13] == 0 and most < 4 * here
    numbers[FASTEST] = rate * (sqrt(most / here) if upright else 2.0)
